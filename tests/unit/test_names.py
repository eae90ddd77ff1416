"""What the package calls its own."""

from __future__ import annotations

import builtins

import robowidgets


def test_a_star_import_leaves_the_names_of_python_alone() -> None:
    assert not set(robowidgets.__all__) & set(dir(builtins))
    assert all(hasattr(robowidgets, name) for name in [*robowidgets.__all__, "open"])
