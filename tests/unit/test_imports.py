"""The report of `make check` on the modules that a first widget imports."""

from __future__ import annotations

from importlib.util import module_from_spec, spec_from_file_location

from ..conftest import ROOT


def test_modules_are_reported_once_they_are_a_tenth_more_than_before() -> None:
    spec = spec_from_file_location("imports", ROOT / "scripts" / "imports.py")
    assert spec
    assert spec.loader
    imports = module_from_spec(spec)
    spec.loader.exec_module(imports)
    assert imports.report(109, 100) == "a first LaserWidget imports 109 modules"
    assert imports.report(111, 100) == (
        "a first LaserWidget imports 111 modules: warning, 11 more than in imports.py. "
        "If they are worth it, change the number there."
    )
    assert "warning" not in imports.report(imports.count(), imports.KEPT)
