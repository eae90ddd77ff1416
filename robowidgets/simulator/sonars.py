"""The ring of sonars of the simulated robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import floor, inf, pi, radians

import numpy as np

from ..samples import Pose, Range
from ..samples.checks import finite, not_negative, to_radians
from ._raycast import cast_rays
from .world import World, to_pose


@dataclass(frozen=True)
class Sonars:
    """Sonars on the robot, which measure in turn. Each measures the distance to the nearest thing in its cone.

    Ranges follow REP-117: +inf if nothing is within max_range, -inf if something is closer than min_range.

    Args:
        poses: by the name of a sensor, its pose on the robot: (x, y, yaw) in metres and radians.
        field_of_view: the opening angle of each cone in radians, or degrees as text (``"30deg"``), above 0, at most pi.
        min_range: the shortest measured distance, metres.
        max_range: the longest measured distance, metres.
        noise: standard deviation of a reading, metres.
        noise_share: standard deviation as a share of the distance, added to `noise`.
        rate: readings of each sensor per second.

    Raises:
        TypeError: something is not a number.
        ValueError: a value is out of range.

    Examples:
        >>> three = Sonars({"left": (0.1, 0.1, 0.8), "front": (0.15, 0.0, 0.0), "right": (0.1, -0.1, -0.8)})
        >>> world = World(walls=[(2.0, -3.0, 2.0, 3.0)])
        >>> round(three.nearest(world, Pose(0.0, 0.0, 0.0), "front"), 2)
        1.85
    """

    poses: Mapping[str, tuple[float, float, float]] = field(default_factory=dict)
    field_of_view: float = radians(30)
    min_range: float = 0.1
    max_range: float = 5.0
    noise: float = 0.005
    noise_share: float = 0.005
    rate: float = 1 / 0.32

    def __post_init__(self) -> None:
        placed = {name: to_pose(f"poses[{name!r}]", pose) for name, pose in self.poses.items()}
        object.__setattr__(self, "poses", placed)
        opening = finite("field_of_view", to_radians("field_of_view", self.field_of_view), "radians")
        object.__setattr__(self, "field_of_view", opening)
        if not 0 < opening <= pi:
            raise ValueError(f"field_of_view: expected radians above 0, at most pi, got {opening!r}")
        for name, unit in (("min_range", "metres"), ("noise", "metres"), ("noise_share", "a share of the distance")):
            not_negative(name, getattr(self, name), unit)
        if finite("max_range", self.max_range, "metres") <= self.min_range:
            raise ValueError(f"max_range: expected metres above min_range ({self.min_range:g}), got {self.max_range!r}")
        if not 0 < finite("rate", self.rate, "readings per second") <= 1000:
            raise ValueError(f"rate: expected readings per second, above 0 and at most 1000, got {self.rate!r}")

    def number_at(self, name: str, time_ns: int) -> int:
        """Return the number of readings of a sensor up to a time in nanoseconds. Sensors take turns in each period.

        Raises:
            KeyError: the robot has no sensor with this name.
        """
        if name not in self.poses:
            known = f"there are: {', '.join(self.poses)}" if self.poses else "it has none; the model 'pioneer' has some"
            raise KeyError(f"the robot has no sonar {name!r}; {known}")
        turn = [*self.poses].index(name) / len(self.poses)
        return floor(time_ns * self.rate / 1e9 - turn) + 1

    def nearest(self, world: World, robot: Pose, name: str) -> float:
        """Return the metres from a sensor to the nearest thing in its cone, for a robot at a pose; inf without one."""
        x, y, yaw = robot.offset(*self.poses[name])
        part = world.near(x, y, self.max_range)
        # The nearest point of each thing. If it lies outside the cone, the nearest point inside is at an edge of it.
        dx, dy = (part.nearest_points(x, y) - (x, y)).T
        aside = np.abs((np.arctan2(dy, dx) - yaw + pi) % (2 * pi) - pi)
        inside = np.hypot(dx, dy)[aside <= self.field_of_view / 2]
        walls, obstacles = cast_rays(part, x, y, yaw + self.field_of_view / 2 * np.array((-1.0, 0.0, 1.0)))
        return float(np.min(np.concatenate((inside, walls, obstacles)), initial=inf))

    def measure(self, world: World, robot: Pose, name: str, rng: np.random.Generator, stamp_ns: int) -> Range:
        """Return the reading of a sensor with the robot at a pose, with noise by a random generator."""
        distance = self.nearest(world, robot, name)
        if distance < inf:
            distance += (self.noise + self.noise_share * distance) * float(rng.standard_normal())
        measured = -inf if distance < self.min_range else inf if distance > self.max_range else round(distance, 3)
        return Range(
            measured,
            self.min_range,
            self.max_range,
            self.field_of_view,
            "ultrasound",
            stamp_ns,
            f"sonar_{name}",
            pose=Pose(*self.poses[name]),
        )
