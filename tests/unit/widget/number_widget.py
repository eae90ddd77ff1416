"""The smallest possible widget, and the data of its frames."""

from __future__ import annotations

import struct
import threading
from dataclasses import dataclass
from typing import Any

import traitlets

from robowidgets.widget.robot_widget import NO_TEXTS, RobotWidget
from robowidgets.widget.timed_frame import FRAME_HEADER


@dataclass(frozen=True)
class Number:
    value: int
    stamp_ns: int | None = None


class NumberWidget(RobotWidget[Number]):
    """The smallest possible widget."""

    _esm = "export default {}"
    color = traitlets.Unicode("red").tag(sync=True)

    def update(self, value: object) -> None:
        if not isinstance(value, int):
            self._refuse(TypeError(f"expected a whole number, got {value!r}"))
        else:
            self.show(Number(value), {"value": value})

    def show(self, number: Number, about: dict[str, Any] = NO_TEXTS, *, counts: bool = True) -> None:
        """Show a number as subclasses show their samples."""
        self._show(number, about, counts=counts)

    def _pack(self, sample: Number) -> bytes:
        return struct.pack("<q", sample.value)


def number_in(frame: bytes) -> int | None:
    return struct.unpack_from("<q", frame, FRAME_HEADER.size)[0] if frame else None


def head_of(frame: bytes) -> tuple[float, float, int, float]:
    """Sequence number, rate, stamp and arrival."""
    return FRAME_HEADER.unpack_from(frame)


def in_a_thread(call: object, *args: object) -> None:
    thread = threading.Thread(target=call, args=args)
    thread.start()
    thread.join()
