"""The newest ranges of several sensors."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import inf, nan
from types import MappingProxyType
from typing import Any

from .age import HasAge, arrival_of, note_arrival
from .range import Range

_NUMBERS = re.compile(r"(\d+)")


class NoSensorError(KeyError):
    """The sensor is unknown, or has not sent anything yet."""


@dataclass(frozen=True, eq=False, repr=False)
class Ranges(HasAge, Mapping[str, Range]):
    """The newest range of each sensor by name, sorted so that ``front_2`` comes before ``front_10``.

    Args:
        readings: sensor name to its newest range.
        times: sensor name to the time of its range, in seconds of one clock, or -inf if it has not come yet. If empty,
            the times of arrival in this process.

    Examples:
        >>> sonars = Ranges({"front": Range(0.42), "left": Range(1.5)})
        >>> sonars["front"].distance, sonars.nearest
        (0.42, 'front')
    """

    readings: Mapping[str, Range]
    times: Mapping[str, float] = field(default_factory=dict)

    def __post_init__(self) -> None:
        readings = {name: self.readings[name] for name in sorted(self.readings, key=_by_number)}
        object.__setattr__(self, "readings", MappingProxyType(readings))
        times = self.times or {name: arrival_of(reading) for name, reading in readings.items()}
        object.__setattr__(self, "times", MappingProxyType({name: times[name] for name in readings}))
        note_arrival(self, arrival_of(self.newest) if self.newest else None)

    def __getitem__(self, name: str) -> Range:
        try:
            return self.readings[name]
        except KeyError:
            known = f"there are: {', '.join(self)}" if self.readings else "no sensor has sent anything yet"
            raise NoSensorError(f"no sensor {name!r}; {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self.readings)

    def __len__(self) -> int:
        return len(self.readings)

    def __repr__(self) -> str:
        count = f"{len(self)} sensor{'' if len(self) == 1 else 's'}"
        name = self.nearest
        near = f", nearest {self[name].distance:.2f} m at {name}" if name else ""
        return f"<Ranges of {count}{near}>"

    def __getstate__(self) -> dict[str, Any]:
        return {**vars(self), "readings": dict(self.readings), "times": dict(self.times)}

    def __setstate__(self, state: dict[str, Any]) -> None:
        frozen = {name: MappingProxyType(state[name]) for name in ("readings", "times")}
        vars(self).update(state, **frozen)

    @property
    def newest(self) -> Range | None:
        """The range that came last, or None if no range has come."""
        return self[max(self, key=self.times.__getitem__)] if self.readings else None

    @property
    def stamp_ns(self) -> int | None:
        """The stamp of the range that came last, or None."""
        return self.newest.stamp_ns if self.newest else None

    @property
    def nearest(self) -> str | None:
        """The name of the sensor with the least distance, or None if nothing is in range or all is unknown."""
        near = {name: reading.distance for name, reading in self.items() if reading.distance < inf}
        return min(near, key=near.__getitem__, default=None)

    @property
    def behind(self) -> dict[str, float]:
        """Seconds by which the range of each sensor is older than the newest, or inf if it has not come yet."""
        newest = max(self.times.values(), default=0.0)
        return {name: newest - time if time > -inf else inf for name, time in self.times.items()}

    def updated(self, readings: Mapping[str, Range]) -> Ranges:
        """Return a copy with newer ranges for some sensors, with their times of arrival in this process."""
        times = {name: arrival_of(reading) for name, reading in readings.items()}
        return Ranges({**self.readings, **readings}, {**self.times, **times})

    def expecting(self, names: Iterable[str]) -> Ranges:
        """Return a copy that also has these sensors; ranges that have not come yet are NaN."""
        new = {name: Range(nan) for name in names if name not in self.readings}
        for reading in new.values():
            note_arrival(reading, -inf)
        return self.updated(new)


def _by_number(name: str) -> tuple[Any, ...]:
    """Return a key that sorts names by the numbers in them."""
    parts = _NUMBERS.split(name)
    return tuple((int(part), "") if i % 2 else (-1, part) for i, part in enumerate(parts)), name
