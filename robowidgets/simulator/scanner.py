"""The laser scanner of the simulated robot."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf, nan, pi, radians

import numpy as np
from numpy.typing import NDArray

from ..samples import Mount, Pose, Scan
from ..samples.checks import finite, not_negative, number, to_radians
from ..samples.scan import MAX_RAYS
from ._raycast import cast_rays
from .world import World, to_pose

WALL_INTENSITY = 200.0
OBSTACLE_INTENSITY = 80.0
_HALF_INTENSITY = 4.0
"""The distance in metres at which the scanner receives half of the light."""


@dataclass(frozen=True)
class Scanner:
    """A scanner on the robot. By default it is in its middle and looks forward. It measures all rays at one moment.

    By default its ranges follow REP-117: +inf if nothing is within range_max, -inf if an object is closer than
    range_min, NaN if the measurement failed.

    Args:
        ray_count: the number of rays in a scan.
        field_of_view: radians from the first ray to the last, or degrees as text (``"270deg"``), half on each side of
            forward. At 2 pi the last ray stops one step before the first one.
        range_min: the shortest measured distance, metres.
        range_max: the longest measured distance, metres.
        noise: standard deviation of a reading, metres.
        resolution: readings are rounded to multiples of this, metres; 0 does not round.
        dropout: share of the failed rays, 0 to 1.
        rate: scans per second.
        intensities: True to send intensities: 200 for a wall close by, 80 for an obstacle, half of that at 4 m.
        frame_id: coordinate frame of the scans.
        first_angle: angle of ray 0 in radians, or degrees as text; None for half of the field of view to the right.
        noise_share: standard deviation as a share of the distance, added to `noise`.
        nothing: the value for a distance beyond range_max; some drivers send 0 or codes.
        too_close: the value for a distance below range_min.
        failed: the values for a failed measurement, chosen at random.
        count_spread: the largest variation of the number of rays in a scan.
        period_spread: the largest relative variation of the time from scan to scan, 0 to 0.5.
        mount: (x, y, yaw) of the scanner on the robot, metres and radians.
        upside_down: True for a scanner that is mounted upside down without knowing it. It sweeps clockwise, so that
            left and right are swapped in its measurements. Scans of a `Robot` correct this: they have the angles of the
            robot.

    Raises:
        TypeError: something is not a number.
        ValueError: a value is out of range.

    Examples:
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
    first_angle: float | None = None
    noise_share: float = 0.0
    nothing: float = inf
    too_close: float = -inf
    failed: tuple[float, ...] = (nan,)
    count_spread: int = 0
    period_spread: float = 0.0
    mount: tuple[float, float, float] = (0.0, 0.0, 0.0)
    upside_down: bool = False

    def __post_init__(self) -> None:
        if isinstance(self.ray_count, bool) or not isinstance(self.ray_count, (int, np.integer)):
            raise TypeError(f"ray_count: expected a whole number, got {self.ray_count!r}")
        if not 1 <= self.ray_count <= MAX_RAYS:
            raise ValueError(f"ray_count: expected 1 to {MAX_RAYS:,}, got {self.ray_count:,}")
        for name, unit in (
            ("range_min", "metres"),
            ("noise", "metres"),
            ("resolution", "metres"),
            ("noise_share", "a share of the distance"),
        ):
            not_negative(name, getattr(self, name), unit)
        if finite("range_max", self.range_max, "metres") <= self.range_min:
            raise ValueError(f"range_max: expected metres above range_min ({self.range_min:g}), got {self.range_max!r}")
        field_of_view = finite("field_of_view", to_radians("field_of_view", self.field_of_view), "radians")
        object.__setattr__(self, "field_of_view", field_of_view)
        if not 0 <= field_of_view <= 2 * pi:
            raise ValueError(
                f'field_of_view: expected 0 to 2 pi radians, got {field_of_view!r}; degrees are written as "270deg"'
            )
        if self.ray_count > 1 and self.field_of_view == 0:
            raise ValueError(f"field_of_view: expected radians above 0 for {self.ray_count} rays, got 0")
        if self.first_angle is not None:
            first = finite("first_angle", to_radians("first_angle", self.first_angle), "radians")
            object.__setattr__(self, "first_angle", first)
        if not self.failed:
            raise ValueError("failed: expected one number or more, got none")
        for name in ("nothing", "too_close"):
            number(name, getattr(self, name))
        for code in self.failed:
            number("failed", code)
        if not isinstance(self.count_spread, int) or not 0 <= self.count_spread < self.ray_count:
            raise ValueError(f"count_spread: expected fewer rays than ray_count, got {self.count_spread!r}")
        if not 0 <= finite("period_spread", self.period_spread, "the period") <= 0.5:
            raise ValueError(f"period_spread: expected a share from 0 to 0.5, got {self.period_spread!r}")
        object.__setattr__(self, "mount", to_pose("mount", self.mount))
        if not 0 <= finite("dropout", self.dropout, "rays in all") <= 1:
            raise ValueError(f"dropout: expected a share from 0 to 1, got {self.dropout!r}")
        if not 0 < finite("rate", self.rate, "scans per second") <= 1000:
            raise ValueError(f"rate: expected scans per second, above 0 and at most 1000, got {self.rate!r}")

    @property
    def angle_min(self) -> float:
        """Angle of ray 0, radians."""
        return -self.field_of_view / 2 if self.first_angle is None else self.first_angle

    @property
    def angle_increment(self) -> float:
        """Radians from one ray to the next, in a scan of `ray_count` rays."""
        return self._increment(self.ray_count)

    def _increment(self, count: int) -> float:
        return self.field_of_view / max(count if self.field_of_view == 2 * pi else count - 1, 1)

    @property
    def stands(self) -> Mount:
        """Its mount on the robot."""
        return Mount.by_hand(self.mount[2], upside_down=self.upside_down)

    def placed(self, x: float, y: float, yaw: float) -> tuple[float, float, float]:
        """Return the pose of the scanner on a robot at a pose, metres and radians."""
        return Pose(x, y, yaw).offset(*self.mount)

    def period_ns(self, seed: Sequence[int]) -> int:
        """Return the nanoseconds from one scan to the next, which depend on a seed."""
        spread = self.period_spread * np.random.default_rng(seed).uniform(-1, 1) if self.period_spread else 0.0
        return round(1e9 / self.rate * (1 + spread))

    def measure(
        self, world: World, x: float, y: float, yaw: float, rng: np.random.Generator, stamp_ns: int | None = None
    ) -> Scan:
        """Return a scan of the robot at a pose (metres, radians), with noise and dropouts by a random generator."""
        count = self.ray_count
        if self.count_spread:
            count += int(rng.integers(-self.count_spread, self.count_spread, endpoint=True))
        x, y, yaw = self.placed(x, y, yaw)
        increment = self._increment(count)
        angles = self.angle_min + np.arange(count, dtype=np.float64) * increment
        walls, obstacles = cast_rays(world, x, y, yaw - angles if self.upside_down else yaw + angles)
        distance: NDArray[np.float64] = np.minimum(walls, obstacles)
        ranges = self._limited(self._blurred(distance, rng))
        has_failed = rng.random(count) < self.dropout
        ranges[has_failed] = rng.choice(self.failed, int(has_failed.sum())) if len(self.failed) > 1 else self.failed[0]
        intensities = np.empty(0)
        if self.intensities:
            surface = np.where(obstacles < walls, OBSTACLE_INTENSITY, WALL_INTENSITY)
            returned = np.round(surface / (1 + (distance / _HALF_INTENSITY) ** 2))
            is_read = (ranges >= self.range_min) & (ranges <= self.range_max)
            intensities = np.where(is_read, returned, 0.0)
        return Scan(
            ranges=ranges,
            angle_min=self.angle_min,
            angle_increment=increment,
            range_min=self.range_min,
            range_max=self.range_max,
            intensities=intensities.astype(np.float32),
            stamp_ns=stamp_ns,
            frame_id=self.frame_id,
        )

    def _blurred(self, distance: NDArray[np.float64], rng: np.random.Generator) -> NDArray[np.float32]:
        spread = self.noise + self.noise_share * np.minimum(distance, self.range_max)
        measured = distance + spread * rng.standard_normal(distance.size)
        if self.resolution:
            measured = np.round(measured / self.resolution) * self.resolution
        return measured.astype(np.float32)

    def _limited(self, ranges: NDArray[np.float32]) -> NDArray[np.float32]:
        is_close, is_beyond = ranges < np.float32(self.range_min), ranges > np.float32(self.range_max)
        ranges[is_close] = self.too_close
        ranges[is_beyond] = self.nothing
        return ranges
