"""The states of a touch widget whose looks are kept."""

from __future__ import annotations

from robowidgets import TouchWidget

from ...looks import Look


def _touched(**options: object) -> TouchWidget:
    touch = TouchWidget(title="/bumper", **options)
    touch.update({"left": True, "right": False, "cliff": None})
    return touch


def _around() -> TouchWidget:
    return _touched(angles={"left": 0.9, "right": -0.9})


LOOKS = {
    "touch/empty": Look(make=lambda: TouchWidget(title="/bumper")),
    "touch/touched": Look(make=_touched),
    "touch/around_the_robot": Look(make=_around),
}
