"""What tells whether a function is the one whose results were kept."""

from __future__ import annotations

import importlib.metadata
import json
import subprocess
import sys
import textwrap
from collections import Counter
from fractions import Fraction
from functools import cache, partial, wraps
from pathlib import Path
from types import MethodType
from typing import Any

import pytest

from robowidgets import conditions
from robowidgets.fleet._identity import NotIdentifiedError, identity_of

CLASS = """
    from dataclasses import dataclass
    @dataclass
    class Near:
        limit: float = 0.3
        def __call__(self, scan): return scan.distance() {} self.limit
    def near(scan): return Near()(scan)
"""
TRIED = """
    def near(scan):
        try:
            x = scan.one
            y = scan.two
        except AttributeError:
            return True
        return x + y
"""
TRIED_IN_PART = """
    def near(scan):
        try:
            x = scan.one
        except AttributeError:
            return True
        else:
            y = scan.two
        return x + y
"""
ENUM = """
    from enum import Enum
    class Mode(Enum):
        A = 1
        def of(self, scan): return scan.distance() {} 0.3
    def near(scan, mode=Mode.A): return mode.of(scan)
"""
NAMED_TUPLE = """
    from typing import NamedTuple
    class Near(NamedTuple):
        limit: float = 0.3
        def of(self, scan): return scan.distance() {} self.limit
    NEAR = Near()
    def near(scan): return NEAR.of(scan)
"""
PARTIAL = """
    from functools import partial
    def f(scan, f=1, a=1): return scan.distance() {} f
    near = partial(f, f=1)
"""
ENCLOSED = """
    limit = {}
    def made():
        limit = {}
        def near(scan):
            def inner():
                global limit
                return limit
            return scan.distance() < limit + inner()
        return near
    near = made()
"""
DEFAULTS = "near = lambda scan{}: scan.distance() < 0.3"
WRAPPED = """
    import json
    from functools import wraps
    @wraps(json.dumps)
    def near(scan): return scan.distance() {} 0.3
"""


def made(text: str, *with_: str) -> Any:
    """The function ``near`` of a text, as a cell of a notebook makes it."""
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(textwrap.dedent(text).format(*with_), names)
    return names["near"]


def told(value: Any) -> str | None:
    try:
        return identity_of(value)
    except NotIdentifiedError:
        return None


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (made(CLASS, "<"), made(CLASS, ">")),
        (made(TRIED), made(TRIED_IN_PART)),
        (made(ENUM, "<"), made(ENUM, ">")),
        (made(NAMED_TUPLE, "<"), made(NAMED_TUPLE, ">")),
        (made(PARTIAL, "<"), made(PARTIAL, ">")),
        (made(ENCLOSED, "1", "2"), made(ENCLOSED, "3", "2")),
        (made(DEFAULTS, ", limit=1"), made(DEFAULTS, ", limit=2")),
        (made(DEFAULTS, ", x=1, *, defaults=2"), made(DEFAULTS, ", x=3, *, defaults=2")),
        (made(WRAPPED, "<"), made(WRAPPED, ">")),
        (partial(json.dumps, 1), partial(json.dumps, 2)),
        (partial(json.dumps, a=1), partial(json.dumps, b=1)),
        (Counter("a").most_common, Counter("b").most_common),
        (Fraction(1, 2).limit_denominator, Fraction(1, 3).limit_denominator),
        (MethodType(made(DEFAULTS, ""), 1), MethodType(made(DEFAULTS, ""), 2)),
        (json.dumps, cache(json.dumps)),
        (json.dumps, wraps(json.dumps)(lambda scan: scan)),
        (conditions.nearest_below(0.3), conditions.nearest_below(0.4)),
    ],
)
def test_what_computes_something_else_is_told_from_it(one: Any, other: Any) -> None:
    assert told(one) is None or told(one) != told(other)


@pytest.mark.parametrize(
    "text", ["near = lambda scan: scan.distance() < 0.3", TRIED, PARTIAL.format("<"), ENCLOSED.format("1", "2")]
)
def test_what_a_cell_makes_again_is_the_same(text: str) -> None:
    assert identity_of(made(text)) == identity_of(made(text))


@pytest.mark.parametrize("value", [json.dumps, partial(json.dumps, indent=1), conditions.nearest_below(0.3), Fraction])
def test_what_is_installed_is_known(value: Any) -> None:
    assert identity_of(value) == identity_of(value)


def test_a_dataclass_of_a_notebook_whose_field_has_no_default_is_not_known() -> None:
    near = made("from dataclasses import dataclass\n@dataclass\nclass Near:\n  limit: float\nnear = lambda _: Near")
    with pytest.raises(NotIdentifiedError):
        identity_of(near)


@pytest.mark.slow
def test_a_package_that_was_built_anew_under_the_same_version_is_another(tmp_path: Path) -> None:
    about = tmp_path / "site-packages" / "labtools-0.1.dist-info"
    about.mkdir(parents=True)
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: labtools\nVersion: 0.1\n")
    (about / "top_level.txt").write_text("labtools\n")
    (about.parent / "labtools.py").write_text("def near(scan): return False\n")
    program = (
        f"import sys; sys.path.append({str(about.parent)!r})\n"
        "from robowidgets.fleet._identity import identity_of\n"
        "import labtools; print(identity_of(labtools.near))"
    )

    def installed(digest: str) -> str:
        (about / "RECORD").write_text(f"labtools.py,sha256={digest},29\n")
        return subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True).stdout

    first = installed("YQ")
    assert "labtools 0.1" in first
    assert installed("YQ") == first
    assert installed("Yg") != first


def test_the_version_of_what_is_installed_is_part_of_it() -> None:
    assert f"numpy.linalg {importlib.metadata.version('numpy')} " in identity_of(__import__("numpy").linalg.norm)
