"""What the package calls its own."""

from __future__ import annotations

import builtins

import pytest

import robowidgets


def test_a_star_import_leaves_the_names_of_python_alone() -> None:
    assert not set(robowidgets.__all__) & set(dir(builtins))
    assert all(hasattr(robowidgets, name) for name in [*robowidgets.__all__, "open"])


@pytest.mark.parametrize(
    ("word", "meant"),
    [("Laser", "LaserWidget"), ("Touc", "Touch"), ("simulater", "simulator"), ("laserwidget", "LaserWidget")],
)
def test_a_name_that_is_not_there_leads_to_one_that_is(word: str, meant: str) -> None:
    with pytest.raises(AttributeError, match=rf"has no attribute '{word}'; did you mean '{meant}'\?$"):
        getattr(robowidgets, word)


def test_a_private_name_that_is_not_there_is_said_plainly() -> None:
    with pytest.raises(AttributeError, match=r"has no attribute '__path_hooks__'$"):
        robowidgets.__path_hooks__  # noqa: B018
