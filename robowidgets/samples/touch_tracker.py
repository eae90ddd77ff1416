"""What is known of touch sensors over time: states, counts and timed releases."""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import inf

from . import Touch, TouchMode, TouchState
from .numbers import number

_STATES = {True: TouchState.TOUCHED, False: TouchState.FREE, None: TouchState.UNKNOWN}


@dataclass(frozen=True)
class TouchSensor:
    """What is known of one sensor.

    Args:
        state: see `TouchState`.
        touches: how often it went from free or unknown to touched.
        since_ns: when it came into its state; None while nothing was said of it.
        seen_ns: when a PRESENCE source last listed it; None while none does.
        missed: whether a later message of that source left it out.
    """

    state: TouchState = TouchState.UNKNOWN
    touches: int = 0
    since_ns: int | None = None
    seen_ns: int | None = None
    missed: bool = False

    def became(self, state: TouchState, at_ns: int) -> TouchSensor:
        """The sensor in a state: timed, and counted, only when it is another one than before."""
        if state is self.state:
            return self if self.seen_ns is None else replace(self, seen_ns=None, missed=False)
        return TouchSensor(state, self.touches + (state is TouchState.TOUCHED), at_ns)

    def no_later_than(self, now_ns: int) -> TouchSensor:
        """The sensor without times that lie ahead of now."""
        since, seen = (None if t is None else min(t, now_ns) for t in (self.since_ns, self.seen_ns))
        return self if (since, seen) == (self.since_ns, self.seen_ns) else replace(self, since_ns=since, seen_ns=seen)


class TouchTracker:
    """Keeps what touch sensors said, in the three modes of `TouchMode`.

    EVENT and LEVEL states hold until the next word on the same sensor. In PRESENCE mode nobody says "released": a
    sensor that later messages leave out is free ``hold`` after the last one that listed it, which bridges the gaps of
    sources that flicker. Sources that publish only while something touches fall silent at the release instead: after
    ``timeout`` of silence their sensors are free too.

    It has no clock: every call is told the time, in nanoseconds from any start. When that goes back (a bag played
    again, a simulation started anew), what was noted of later times counts as noted now: states and counts stay,
    durations begin again, and no release is further away than its hold or timeout.

    Args:
        hold: seconds, 0 or more; longer than the pause between two messages of the slowest source.
        timeout: seconds, 0 or more, infinite to wait for ever; None: the same as ``hold``.

    ``newest`` is what was taken in last; None before the first message.

    Raises:
        TypeError: a time is not a number.
        ValueError: a time is negative or NaN, or the hold infinite.

    Example:
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
        """Seconds that a touch outlasts the last message that listed it. Settable, at once in force."""
        return self._hold

    @hold.setter
    def hold(self, seconds: float) -> None:
        value = number("hold", seconds)
        if not 0 <= value < inf:
            raise ValueError(f"hold: expected seconds, 0 or more, got {value!r}")
        self._hold = value

    @property
    def timeout(self) -> float | None:
        """Seconds of silence after which a touch is over. Settable, at once in force."""
        return self._timeout

    @timeout.setter
    def timeout(self, seconds: float | None) -> None:
        value = None if seconds is None else number("timeout", seconds)
        if value is not None and not value >= 0:
            raise ValueError(f"timeout: expected seconds, 0 or more, or None, got {value!r}")
        self._timeout = value

    def apply(self, touch: Touch, now_ns: int) -> None:
        """Take in what a message said at a time."""
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
        """Every sensor as it is known at a time, in the order of their first mention."""
        return {name: self._at(sensor, now_ns) for name, sensor in self._sensors.items()}

    def next_change_ns(self, now_ns: int) -> int | None:
        """When the next release is due if no message comes; None when none is."""
        due = (self._release_ns(sensor) for sensor in self.states(now_ns).values())
        return min((at for at in due if at is not None), default=None)

    def reset(self) -> None:
        """Forget what was said and counted; the names stay, in their order."""
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
