"""The code in the notebook's kernel: a cell that repeatedly makes and shows a widget."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipywidgets
import numpy as np
from IPython.display import display

import robowidgets

from .rivals import bare

MAKERS: dict[str, Callable[[], Any]] = {
    "bare": lambda: bare.make(np.ones(1040, np.float32))[0],
    "laser": robowidgets.LaserWidget,
    "speed": robowidgets.SpeedWidget,
    "touch": robowidgets.TouchWidget,
    "drive": robowidgets.DriveWidget,
    "player": lambda: robowidgets.open(robowidgets.SAMPLE).show(),
}


class Source:
    """A source of widgets of one kind. ipywidgets keeps them until they are closed."""

    def __init__(self, name: str, _count: int) -> None:
        self._make = MAKERS[name]

    def show(self) -> None:
        """Make a new widget and display it."""
        display(self._make())  # type: ignore[no-untyped-call]

    def close(self) -> None:
        """Close every widget."""
        ipywidgets.Widget.close_all()
