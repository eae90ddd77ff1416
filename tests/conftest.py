"""What every test may ask for."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[1]


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of real recordings, named by ROBOWIDGETS_DATA or lying in ../shared/data beside the checkout."""
    folder = Path(os.environ.get("ROBOWIDGETS_DATA") or ROOT.parent / "shared" / "data")
    if not folder.is_dir():
        pytest.skip(f"no real recordings here: {folder} is missing; ROBOWIDGETS_DATA may name another folder")
    return folder
