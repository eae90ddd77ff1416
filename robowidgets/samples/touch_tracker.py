"""The states of touch sensors over time, with counts and timed releases."""

from __future__ import annotations

import time
from dataclasses import dataclass, replace
from math import inf

from . import Touch, TouchMode, TouchState
from .checks import number

_STATES = {True: TouchState.TOUCHED, False: TouchState.FREE, None: TouchState.UNKNOWN}


@dataclass(frozen=True)
class TouchSensor:
    """The state of one sensor, with its history.

    Args:
        state: see `TouchState`.
        touches: number of changes from free or unknown to touched.
        since_ns: start of the state; None before the first message about it.
        seen_ns: time at which a PRESENCE source last listed it, or None while it is not listed.
        missed: True if a later message of that source does not list it.
    """

    state: TouchState = TouchState.UNKNOWN
    touches: int = 0
    since_ns: int | None = None
    seen_ns: int | None = None
    missed: bool = False

    def became(self, state: TouchState, at_ns: int) -> TouchSensor:
        """Return the sensor in a state; if the state differs, with a new start, and counted if it is TOUCHED."""
        if state is self.state:
            return self if self.seen_ns is None else replace(self, seen_ns=None, missed=False)
        return TouchSensor(state, self.touches + (state is TouchState.TOUCHED), at_ns)

    def no_later_than(self, now_ns: int) -> TouchSensor:
        """Return the sensor, with times later than now replaced by now."""
        since, seen = (None if t is None else min(t, now_ns) for t in (self.since_ns, self.seen_ns))
        return self if (since, seen) == (self.since_ns, self.seen_ns) else replace(self, since_ns=since, seen_ns=seen)


class TouchTracker:
    """The current states of touch sensors, in the three modes of `TouchMode`.

    EVENT and LEVEL states last until the next message about the sensor. In PRESENCE mode no message reports a release:
    a sensor that later messages do not list is free ``hold`` seconds after the last message that did. This bridges gaps
    of sources that flicker. Sources that publish only while something touches fall silent at the release instead: after
    ``timeout`` seconds of silence their sensors are free too.

    The tracker has no clock: the caller passes the time, in nanoseconds from any start. If the time goes back (a bag is
    played again, a simulation restarts), later times are replaced by the new time: states and counts stay, durations
    begin again, and no release is further away than its hold or timeout.

    Args:
        hold: seconds, 0 or more; longer than the pause between two messages of the slowest source.
        timeout: seconds, 0 or more, infinite to wait for ever, or None for the same as ``hold``.

    ``newest`` is the last message; None before the first one.

    Raises:
        TypeError: a time is not a number.
        ValueError: a time is negative or NaN, or the hold infinite.

    Examples:
        >>> tracker = TouchTracker()
        >>> tracker.apply(Touch({"left": True, "right": False}), now_ns=0)
        >>> tracker.states(now_ns=10)["left"].touches
        1
    """

    def __init__(self, hold: float = 0.15, timeout: float | None = None) -> None:
        self.hold = hold
        self.timeout = timeout
        self.newest: Touch | None = None
        self._sensors: dict[str, TouchSensor] = {}

    @property
    def hold(self) -> float:
        """Seconds for which a touch lasts after the last message that listed it. Settable; applies at once."""
        return self._hold

    @hold.setter
    def hold(self, seconds: float) -> None:
        value = number("hold", seconds)
        if not 0 <= value < inf:
            raise ValueError(f"hold: expected seconds, 0 or more, got {value!r}")
        self._hold = value

    @property
    def timeout(self) -> float | None:
        """Seconds of silence after which a touch is over. Settable; applies at once."""
        return self._timeout

    @timeout.setter
    def timeout(self, seconds: float | None) -> None:
        value = None if seconds is None else number("timeout", seconds)
        if value is not None and not value >= 0:
            raise ValueError(f"timeout: expected seconds, 0 or more, or None, got {value!r}")
        self._timeout = value

    def apply(self, touch: Touch, now_ns: int) -> None:
        """Apply a message that arrived at this time."""
        known = {name: s.no_later_than(now_ns) for name, s in self.states(now_ns).items()}
        for name in touch.sensors:
            known.setdefault(name, TouchSensor())
        for name, touched in touch.touched.items():
            known[name] = known[name].became(_STATES[touched], now_ns)
        if touch.mode is TouchMode.PRESENCE:
            for name, sensor in known.items():
                if touch.touched.get(name):
                    known[name] = replace(sensor, seen_ns=now_ns)
                elif sensor.seen_ns is not None:
                    known[name] = replace(sensor, missed=True)
                elif name in touch.sensors and name not in touch.touched:
                    known[name] = sensor.became(TouchState.FREE, now_ns)
        self._sensors, self.newest = known, touch

    def states(self, now_ns: int) -> dict[str, TouchSensor]:
        """Return all sensors at a time, in the order of their first mention."""
        return {name: self._at(sensor, now_ns) for name, sensor in self._sensors.items()}

    def next_change_ns(self, now_ns: int) -> int | None:
        """Return the time of the next release without further messages, or None if no release is due."""
        due = (self._release_ns(sensor) for sensor in self.states(now_ns).values())
        return min((at for at in due if at is not None), default=None)

    def reset(self) -> None:
        """Reset states and counts; the names stay, in their order."""
        self._sensors = {name: TouchSensor() for name in self._sensors}

    def _at(self, sensor: TouchSensor, now_ns: int) -> TouchSensor:
        due = self._release_ns(sensor)
        return sensor if due is None or now_ns < due else sensor.became(TouchState.FREE, due)

    def _release_ns(self, sensor: TouchSensor) -> int | None:
        if sensor.seen_ns is None:
            return None
        silence = self.hold if self.timeout is None else self.timeout
        wait = self.hold if sensor.missed else silence
        return None if wait == inf else sensor.seen_ns + round(wait * 1e9)


class TouchesBetween:
    """The states of all touch sensors; each sensor that was touched since the last `take` counts as touched."""

    def __init__(self) -> None:
        self._tracker = TouchTracker()
        self._touched: set[str] = set()

    def add(self, touch: Touch) -> None:
        """Apply a message that has arrived."""
        self._touched |= {sensor for sensor, state in touch.touched.items() if state}
        self._tracker.apply(touch, time.monotonic_ns())

    def take(self) -> Touch:
        """Return the states by name; the next call counts touches from now on."""
        touched, self._touched = self._touched, set()
        states = self._tracker.states(time.monotonic_ns())
        return Touch({**{name: one.state.as_bool for name, one in states.items()}, **dict.fromkeys(touched, True)})
