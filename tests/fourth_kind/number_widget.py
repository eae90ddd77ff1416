"""The widget of numbers."""

from __future__ import annotations

import os
import struct
import subprocess
import sys
from pathlib import Path
from typing import Any

from robowidgets.widget.front_end import bundle
from robowidgets.widget.robot_widget import RobotWidget

from ..conftest import ROOT
from .number import Number, to_number

JS = ROOT / "robowidgets" / "js"
_VALUE = struct.Struct("<d")


class NumberWidget(RobotWidget[Number]):
    """The newest number with its unit, in large type."""

    _esm, _css = "export default {}", ""
    """Replaces the front end that `build` makes, which needs Node."""

    def update(self, message: Any) -> None:
        """Show a number in the next animation frame."""
        try:
            number = to_number(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._show(number, self.frame_of(number)[0])

    @property
    def number(self) -> Number | None:
        """The number on show: the frozen one while paused, else the newest, or None before the first."""
        return self._sample_on_show()

    def frame_of(self, sample: Number) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"unit": sample.unit}, self._pack(sample)

    def _pack(self, sample: Number) -> bytes:
        return _VALUE.pack(sample.value)

    def _unpack(self, frame: bytes) -> Number:
        return Number(*_VALUE.unpack(frame[-_VALUE.size :]))


def build(folder: Path) -> tuple[Any, Any]:
    """Build the script and stylesheet of the widget into a folder, with the project's own build."""
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    command = ["node", "build.mjs", str(Path(__file__).parent / "js"), str(folder)]
    subprocess.run(command, cwd=JS, env={**os.environ, "PATH": path}, check=True)
    return bundle("number_widget", folder)
