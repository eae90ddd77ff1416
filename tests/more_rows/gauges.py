"""Gauges: numbers of a namespace that share one widget."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

from robowidgets import kinds
from robowidgets.kinds import KINDS, Kind, Role
from robowidgets.messages.fields import describe, get, has, stamp_ns, unwrap
from robowidgets.samples import HasAge
from robowidgets.simulator import Robot
from robowidgets.simulator.offers import Offer
from robowidgets.widget.robot_widget import RobotWidget

FLOAT64 = "std_msgs/msg/Float64"


@dataclass(frozen=True)
class Number(HasAge):
    """One number."""

    value: float
    stamp_ns: int | None = None


def to_number(message: Any) -> Number:
    """Return the number in a Float64; return a `Number` as it is."""
    message = unwrap(message)
    if isinstance(message, Number):
        return message
    if not has(message, "data"):
        raise TypeError(f"expected a message like std_msgs/Float64, got {describe(message)}")
    return Number(float(get(message, "data")), stamp_ns(message))


@dataclass(frozen=True, eq=False)
class Numbers(HasAge, Mapping[str, Number]):
    """The newest number of each sensor by its name, and when each came."""

    numbers: Mapping[str, Number]
    seconds: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    stamp_ns: int | None = None

    def __getitem__(self, sensor: str) -> Number:
        return self.numbers[sensor]

    def __iter__(self) -> Iterator[str]:
        return iter(sorted(self.numbers))

    def __len__(self) -> int:
        return len(self.numbers)


class GaugesWidget(RobotWidget[Numbers]):
    """The newest number of each sensor."""

    _esm, _css = "export default {}", ""
    sample_name = "gauges"

    def update(self, sensor: Any, message: Any = None) -> None:
        """Show the number of a sensor, or the numbers of all."""
        try:
            if isinstance(sensor, Numbers):
                self._show(sensor, self.frame_of(sensor)[0])
                return
            before = self._newest.sample or Numbers({})
            numbers = Numbers({**before, sensor: to_number(message)})
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._show(numbers, self.frame_of(numbers)[0])

    @property
    def gauges(self) -> Numbers | None:
        """The numbers on show."""
        return self._newest.sample

    def frame_of(self, sample: Numbers) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`."""
        return {"sensors": list(sample)}, self._pack(sample)

    def _pack(self, sample: Numbers) -> bytes:
        return struct.pack(f"<{len(sample)}d", *(number.value for number in sample.values()))


def simulated(robot: Robot) -> list[Offer]:
    """The topics of the simulated robot, and the position of the robot."""
    return [
        Offer("/tank/left", FLOAT64, lambda: Number(robot.pose.x)),
        Offer("/tank/right", FLOAT64, lambda: Number(robot.pose.y)),
    ]


GAUGE = Kind(
    name="gauge",
    sample_name="gauge",
    noun="gauges",
    sample=Number,
    read=to_number,
    types=frozenset({FLOAT64}),
    widget=lambda: GaugesWidget,
    nothing=Number(float("nan")),
    roles=(Role(name="gauges", combine=Numbers),),
    to_message=lambda: lambda number, _time_ns, _type: (FLOAT64, {"data": number.value}),
    simulated=simulated,
)


@contextmanager
def added() -> Iterator[Kind]:
    """Add gauges to the table of kinds for a while."""
    before = dict(KINDS)
    kinds.add(GAUGE)
    try:
        yield GAUGE
    finally:
        KINDS.clear()
        KINDS.update(before)
