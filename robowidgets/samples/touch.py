"""The states of touch sensors in one message."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum, IntEnum
from types import MappingProxyType
from typing import Any

import numpy as np

from .age import HasAge, note_arrival


class TouchState(IntEnum):
    """The state of one touch sensor. Only TOUCHED is true: ``if touch.states["left"]: stop()``."""

    FREE = 0
    TOUCHED = 1
    UNKNOWN = 2

    def __bool__(self) -> bool:
        return self is TouchState.TOUCHED

    @property
    def as_bool(self) -> bool | None:
        """True, False, or None if unknown, as in `Touch.touched`."""
        return None if self is TouchState.UNKNOWN else bool(self)


class TouchMode(Enum):
    """The meaning of the messages of a source.

    EVENT: one message per change, only for the sensors that it names. LEVEL: each message has the states of all
    sensors. PRESENCE: each message lists the touched sensors; all others are free.
    """

    EVENT = "event"
    LEVEL = "level"
    PRESENCE = "presence"


@dataclass(frozen=True, eq=False)
class Touch(HasAge):
    """The states of touch sensors in one message.

    Args:
        touched: sensor name to True (touched), False (free) or None (the source does not know). In PRESENCE mode it
            has only touched sensors.
        mode: the meaning of the messages, see `TouchMode`.
        sensors: every known sensor of this source, from the robot's left to its right; sensors that the message did not
            name are shown as unknown (or, in PRESENCE mode, as free).
        stamp_ns: time in nanoseconds since the epoch, or None.
        dialect: the message type that it was read from, for users to read.

    Raises:
        TypeError: a name is not a string, or a state is not True, False or None.
        ValueError: the mode is unknown.
    """

    touched: Mapping[str, bool | None]
    mode: TouchMode = TouchMode.LEVEL
    sensors: tuple[str, ...] = ()
    stamp_ns: int | None = None
    dialect: str = ""

    def __post_init__(self) -> None:
        if not isinstance(self.touched, Mapping):
            raise TypeError(f"touched: expected a mapping of sensor names to True, False or None, got {self.touched!r}")
        for name, state in self.touched.items():
            if not isinstance(name, str):
                raise TypeError(f"touched: expected sensor names as strings, got {name!r}")
            if state is not None and not isinstance(state, (bool, np.bool_)):
                raise TypeError(f"touched[{name!r}]: expected True, False or None, got {state!r}")
        if isinstance(self.sensors, str) or not all(isinstance(name, str) for name in self.sensors):
            raise TypeError(f"sensors: expected sensor names as strings in a tuple, got {self.sensors!r}")
        touched = {name: None if state is None else bool(state) for name, state in self.touched.items()}
        object.__setattr__(self, "mode", TouchMode(self.mode))
        object.__setattr__(self, "touched", MappingProxyType(touched))
        known = dict.fromkeys(self.sensors) | dict.fromkeys(touched)
        object.__setattr__(self, "sensors", tuple(known))
        note_arrival(self)

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "touched": dict(self.touched)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state, touched=MappingProxyType(state["touched"]))
