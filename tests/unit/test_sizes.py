"""The report of `make check` on the size of the front end."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType

import pytest

SCRIPT = Path(__file__).parents[2] / "scripts" / "sizes.py"


@pytest.fixture
def sizes() -> ModuleType:
    spec = spec_from_file_location("sizes", SCRIPT)
    assert spec
    assert spec.loader
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_a_widget_that_becomes_heavier_is_reported_with_its_size_and_no_other(sizes: ModuleType) -> None:
    assert sizes.told({"laser": 50_262, "stop": 9_700}, {"laser": 48_262, "stop": 9_583}) == [
        "laser 50.3 kB: warning, 2.0 kB more than in sizes.csv; a page shows its first one 1.6 ms later. "
        "If this is worth it, add a row with the reason.",
        "stop 9.7 kB",
    ]
    assert sizes.told({"camera": 5_000}, {}) == ["camera 5.0 kB: new. Give it a row in sizes.csv."]


def test_each_widget_has_a_row_in_the_table(sizes: ModuleType) -> None:
    assert sizes.sizes().keys() == sizes.known().keys()
