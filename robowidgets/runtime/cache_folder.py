"""The folder for files that are kept from one run to the next."""

from __future__ import annotations

import os
from pathlib import Path

FOLDER = "ROBOWIDGETS_CACHE"
"""The environment variable that names the folder."""


def cache_folder() -> Path:
    """Return the folder that ``ROBOWIDGETS_CACHE`` names, else the one in the system's cache folder."""
    if given := os.environ.get(FOLDER):
        return Path(given).expanduser().absolute()
    base = os.environ.get("LOCALAPPDATA" if os.name == "nt" else "XDG_CACHE_HOME")
    return (Path(base) if base else Path.home() / ".cache") / "robowidgets"
