"""The laser scanner of the simulated robot."""

from __future__ import annotations

from dataclasses import dataclass
from math import pi, radians

import numpy as np
from numpy.typing import NDArray

from ..samples import Scan
from ..samples.checks import finite, to_radians
from ..samples.scan import MAX_RAYS
from ._raycast import cast_rays
from .world import World

WALL_INTENSITY = 200.0
OBSTACLE_INTENSITY = 80.0
_HALF_INTENSITY = 4.0
"""Metres at which the scanner receives half of the light."""


@dataclass(frozen=True)
class Scanner:
    """A scanner in the middle of the robot, looking forward; it sweeps counter-clockwise, all rays at one moment.

    Its ranges follow REP-117: +inf if nothing is within range_max, -inf if an object is closer than range_min, NaN if
    the measurement failed.

    Args:
        ray_count: rays in a scan.
        field_of_view: radians from the first ray to the last, or degrees as text (``"270deg"``), half on each side of
            forward. At 2 pi the last ray stops one step before the first one.
        range_min: least distance that is measured, metres.
        range_max: greatest distance that is measured, metres.
        noise: standard deviation of a reading, metres.
        resolution: readings are rounded to multiples of this, metres; 0 does not round.
        dropout: share of the rays that give NaN, 0 to 1.
        rate: scans per second.
        intensities: whether to send intensities: 200 for a wall close by, 80 for an obstacle, half of that at 4 m.
        frame_id: coordinate frame of the scans.

    Raises:
        TypeError: something is not a number.
        ValueError: a value is out of range.

    Example:
        >>> pr2 = Scanner(ray_count=1040, field_of_view="259.75deg", range_max=30.0)
    """

    ray_count: int = 541
    field_of_view: float = radians(270)
    range_min: float = 0.1
    range_max: float = 6.0
    noise: float = 0.01
    resolution: float = 0.001
    dropout: float = 0.002
    rate: float = 10.0
    intensities: bool = False
    frame_id: str = "laser"

    def __post_init__(self) -> None:
        if isinstance(self.ray_count, bool) or not isinstance(self.ray_count, (int, np.integer)):
            raise TypeError(f"ray_count: expected a whole number, got {self.ray_count!r}")
        if not 1 <= self.ray_count <= MAX_RAYS:
            raise ValueError(f"ray_count: expected 1 to {MAX_RAYS:,}, got {self.ray_count:,}")
        for name, unit in (("range_min", "metres"), ("noise", "metres"), ("resolution", "metres")):
            if finite(name, getattr(self, name), unit) < 0:
                raise ValueError(f"{name}: expected {unit}, 0 or more, got {getattr(self, name)!r}")
        if finite("range_max", self.range_max, "metres") <= self.range_min:
            raise ValueError(f"range_max: expected metres above range_min ({self.range_min:g}), got {self.range_max!r}")
        field_of_view = finite("field_of_view", to_radians("field_of_view", self.field_of_view), "radians")
        object.__setattr__(self, "field_of_view", field_of_view)
        if not 0 <= field_of_view <= 2 * pi:
            raise ValueError(f"field_of_view: expected 0 to 2 pi radians, got {field_of_view!r}")
        if self.ray_count > 1 and self.field_of_view == 0:
            raise ValueError(f"field_of_view: expected radians above 0 for {self.ray_count} rays, got 0")
        if not 0 <= finite("dropout", self.dropout, "rays in all") <= 1:
            raise ValueError(f"dropout: expected a share from 0 to 1, got {self.dropout!r}")
        if not 0 < finite("rate", self.rate, "scans per second") <= 1000:
            raise ValueError(f"rate: expected scans per second, above 0 and at most 1000, got {self.rate!r}")

    @property
    def angle_min(self) -> float:
        """Angle of ray 0, radians."""
        return -self.field_of_view / 2

    @property
    def angle_increment(self) -> float:
        """Radians from one ray to the next."""
        steps = self.ray_count if self.field_of_view == 2 * pi else self.ray_count - 1
        return self.field_of_view / max(steps, 1)

    def measure(
        self, world: World, x: float, y: float, yaw: float, rng: np.random.Generator, stamp_ns: int | None = None
    ) -> Scan:
        """The scan taken at a pose (metres, radians), with noise and dropouts from a random generator."""
        indices = np.arange(self.ray_count, dtype=np.float64)
        walls, obstacles = cast_rays(world, x, y, yaw + self.angle_min + indices * self.angle_increment)
        distance: NDArray[np.float64] = np.minimum(walls, obstacles)
        ranges = self._limited(self._blurred(distance, rng))
        ranges[rng.random(self.ray_count) < self.dropout] = np.nan
        intensities = np.empty(0)
        if self.intensities:
            surface = np.where(obstacles < walls, OBSTACLE_INTENSITY, WALL_INTENSITY)
            returned = np.round(surface / (1 + (distance / _HALF_INTENSITY) ** 2))
            intensities = np.where(np.isfinite(ranges), returned, 0.0)
        return Scan(
            ranges=ranges,
            angle_min=self.angle_min,
            angle_increment=self.angle_increment,
            range_min=self.range_min,
            range_max=self.range_max,
            intensities=intensities.astype(np.float32),
            stamp_ns=stamp_ns,
            frame_id=self.frame_id,
        )

    def _blurred(self, distance: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float32]:
        measured = distance + self.noise * rng.standard_normal(distance.size)
        if self.resolution:
            measured = np.round(measured / self.resolution) * self.resolution
        return measured.astype(np.float32)

    def _limited(self, ranges: NDArray[np.float32]) -> NDArray[np.float32]:
        ranges[ranges < np.float32(self.range_min)] = -np.inf
        ranges[ranges > np.float32(self.range_max)] = np.inf
        return ranges
