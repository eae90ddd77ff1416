"""One sweep of a laser scanner, and its geometry."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from functools import cached_property
from math import atan2, cos, degrees, isfinite, pi, sin
from operator import index as as_index
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import scan_problems
from .age import HasAge, arrival_of, note_arrival
from .checks import ANGLE_ROUNDING, finite, floats, frozen, in_radians, is_frozen, metres, number, shortest, to_radians
from .distances import angles_of, difference, distances, inside, ray_distances
from .echoes import Echoes, Sources, check_choice
from .mount import Mount
from .problem import Problem
from .ray import Ray, Validity
from .sector import ALL_ROUND, SectorLike, order_in_sector, to_sector

MAX_RAYS = 1_000_000
_FARTHEST = float(np.finfo(np.float32).max)


@dataclass(frozen=True, eq=False)
class Scan(HasAge):
    """One sweep of a laser scanner.

    Ray ``i`` points at ``angle_min + i * angle_increment``. The ``angle_max`` of a message is never used for geometry,
    because drivers disagree on its meaning. A negative increment is a clockwise scanner. Arrays are read-only.

    Args:
        ranges: R distances in metres, any real dtype, kept as float32. NaN: no measurement; -inf: too close; +inf:
            nothing in range (REP-117). None in a list counts as NaN (JSON has no NaN).
        angle_min: angle of ray 0 in radians, counter-clockwise from forward.
        angle_increment: radians from one ray to the next; NaN or 0 only for a scan with at most one ray.
        range_min, range_max: metres; a range within them, both included, is a reading. Kept at float32's precision, so
            that a limit and a reading sent as the same number are equal. A range_max of inf, which some converters of
            point clouds send, sets no limit: it is kept as the largest float32.
        intensities: no values, or R values in device units. Another length is a problem, and the values are not used.
        stamp_ns: time of the first ray in nanoseconds since the epoch, or None.
        frame_id: coordinate frame of the scanner.
        header_problems: problems of the message other than its ranges; `problems` returns these and the range problems.
        echoes: all echoes of each ray, if the scanner sends several; `echo` selects one of them.
        sources: the position of each range in the data that the scan was made from, or None if that is ``ranges``.
        mount: the mount of the scanner on the robot, or None if unknown. With a mount all angles are the robot's;
            `mounted` returns such a scan, and `unmounted` one with the scanner's angles.

    Raises:
        TypeError: a value is not a number.
        ValueError: a shape is wrong, the limits are swapped, or a value is not finite.

    Source: sensor_msgs/LaserScan, REP-103, REP-117.

    Examples:
        >>> scan = Scan([1.0, 2.5, float("inf")], angle_min=-0.5, angle_increment=0.5, range_min=0.1, range_max=30.0)
        >>> scan.distance(), scan.distance("left")
        (1.0, nan)
    """

    ranges: NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    intensities: NDArray[np.float32] = field(default_factory=lambda: np.empty(0, np.float32))
    stamp_ns: int | None = None
    frame_id: str = ""
    header_problems: tuple[Problem, ...] = ()
    echoes: Echoes | None = None
    sources: Sources | None = None
    mount: Mount | None = None

    def __post_init__(self) -> None:
        put = object.__setattr__
        odd = list(self.header_problems)
        ranges = floats("ranges", self.ranges)
        if ranges.size > MAX_RAYS:
            raise ValueError(f"ranges: expected at most {MAX_RAYS:,} rays, got {ranges.size:,}")
        put(self, "ranges", ranges)
        intensities = floats("intensities", self.intensities)
        if intensities.size not in (0, ranges.size):
            odd.append(scan_problems.of_intensities(intensities.size, ranges.size))
            intensities = floats("intensities", ())
        put(self, "intensities", intensities)
        for name, count in (
            ("echoes", self.echoes and len(self.echoes.counts)),
            ("sources", self.sources and self.sources.numbers.size),
        ):
            if count is not None and count != ranges.size:
                raise ValueError(f"{name}: expected {ranges.size:,}, one for each ray, got {count:,}")

        put(self, "angle_min", finite("angle_min", to_radians("angle_min", self.angle_min), "radians"))
        increment = to_radians("angle_increment", self.angle_increment)
        if ranges.size <= 1:
            if ranges.size == 1 and not isfinite(increment):
                odd.append(Problem("one ray, angle_increment is not a number: drawn at angle_min", "it may send 0"))
            increment = increment if isfinite(increment) else 0.0
        elif not isfinite(increment) or increment == 0:
            raise ValueError(
                f"angle_increment: expected a finite step in radians other than 0 for {ranges.size} rays, "
                f"got {increment!r}"
            )
        odd += scan_problems.of_geometry(ranges.size, increment)
        put(self, "angle_increment", increment)

        far = min(number("range_max", self.range_max), _FARTHEST)
        limits = (("range_min", self.range_min), ("range_max", far))
        low, high = (float(np.float32(finite(*limit, "metres"))) for limit in limits)
        if low < 0:
            raise ValueError(f"range_min: expected metres, 0 or more, got {low!r}")
        if high <= low:
            raise ValueError(
                f"range_max: expected metres above range_min ({low:.4g}), got {high:.4g}; are the two swapped?"
            )
        put(self, "range_min", low)
        put(self, "range_max", high)
        put(self, "header_problems", tuple(dict.fromkeys(odd)))
        note_arrival(self)

    def __len__(self) -> int:
        return int(self.ranges.size)

    def __getitem__(self, index: int) -> Ray:
        try:
            index = as_index(index)
        except TypeError:
            raise TypeError(f"expected the index of one ray, got {index!r}; for several, index scan.ranges") from None
        if not -len(self) <= index < len(self):
            raise IndexError(f"index {index}: this scan has {len(self)} rays")
        i = index % len(self)
        validity = Validity(int(self.validity[i]))
        reading = validity is Validity.READING
        return Ray(
            index=i,
            range=shortest(self.ranges[i]),
            angle=_within_half_turn(float(self.angles[i])),
            x=float(self.x[i]) if reading else None,
            y=float(self.y[i]) if reading else None,
            intensity=float(self.intensities[i]) if self.intensities.size else None,
            validity=validity,
            source=int(self.sources.numbers[i]) if self.sources and self.sources.numbers[i] >= 0 else None,
        )

    def __getstate__(self) -> dict[str, Any]:
        """Return the fields and the time of arrival, without cached values."""
        return {**{field.name: getattr(self, field.name) for field in fields(self)}, "_arrived": self._arrived}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        for array in (self.ranges, self.intensities):
            frozen(array)  # a copy of a read-only array is not

    def __repr__(self) -> str:
        rays = f"{len(self):,} ray{'' if len(self) == 1 else 's'}"
        # Adding 0.0 removes the sign of -0.0, which turning may produce.
        ends = [round(degrees(float(self.angles[i])), 1) + 0.0 for i in (0, -1)] if len(self) else []
        sweep = f" from {ends[0]:.1f}° to {ends[1]:.1f}°" if ends else ""
        near = self.nearest()
        how = "no readings"
        if near:
            how = f"nearest {metres(near.range, self._reach)}" if near.validity is Validity.READING else "too close"
            how += f" at ranges[{near.index}]"
        return f"<Scan of {rays}{sweep}, {how}>"

    def __iter__(self) -> Iterator[Ray]:
        return (self[i] for i in range(len(self)))

    def __sub__(self, other: Scan) -> NDArray[np.float32]:
        """Return the distance of each ray minus its distance in another scan, in metres, shape (R,).

        Each ray counts as in `distance`: 0 if it is too close, inf if nothing is in range, NaN if that is unknown. So
        the difference is inf if nothing is in range any more, -inf if nothing was in range before, 0 if nothing is in
        range in both, and NaN if either is unknown. Rays are compared by index if both scans have the same angles,
        else by angle with the closest ray of the other scan, or NaN if that is more than half a step away.
        """
        if not isinstance(other, Scan):
            return NotImplemented
        return difference(self, other)

    def again(self, ranges: ArrayLike, intensities: ArrayLike | None, stamp_ns: int | None) -> Scan:
        """Return the next sweep of the same scanner; all other fields stay as they are, and are not checked again.

        It has no echoes and no sources.

        Args:
            ranges: as many as this scan has. They are copied, unless they are float32 and read-only.
            intensities: the same, or None to keep the intensities of this scan.
            stamp_ns: time of the first ray in nanoseconds since the epoch, or None.

        Raises:
            TypeError: a value is not a number. ValueError: the number of rays or of intensities differs.
        """
        scan = object.__new__(Scan)
        values = scan.__dict__
        values.update(self._settings)
        values["stamp_ns"], values["_arrived"] = stamp_ns, time.monotonic()
        values["echoes"] = values["sources"] = None
        for name, given in (("ranges", ranges), ("intensities", intensities)):
            if given is not None:
                array = given if is_frozen(given) else floats(name, given)
                if array.size != values[name].size:
                    raise ValueError(
                        f"{name}: expected {values[name].size:,} values as in the scan before, got {array.size:,}"
                    )
                values[name] = array
        return scan

    @cached_property
    def angles(self) -> NDArray[np.float64]:
        """The angle of every ray in radians, shape (R,). A full circle may run from 0 to 2 pi."""
        return angles_of(self.angle_min, self.angle_increment, len(self))

    @cached_property
    def validity(self) -> NDArray[np.uint8]:
        """The class of every ray as a value of `Validity`, shape (R,), tested in the order of REP-117."""
        r = self.ranges
        conditions = [(self.range_min <= r) & (r <= self.range_max), r == -np.inf, r == np.inf, np.isnan(r)]
        validities = [Validity.READING, Validity.TOO_CLOSE, Validity.NOTHING_IN_RANGE, Validity.NO_MEASUREMENT]
        return frozen(np.select(conditions, validities, Validity.OUTSIDE_LIMITS).astype(np.uint8))

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """True for each ray with a reading, shape (R,)."""
        return frozen(self.validity == Validity.READING)

    @cached_property
    def counts(self) -> dict[Validity, int]:
        """The number of rays of each class."""
        counted = np.bincount(self.validity, minlength=len(Validity))
        return {validity: int(counted[validity]) for validity in Validity}

    @cached_property
    def x(self) -> NDArray[np.float64]:
        """Metres forward, shape (R,); NaN for rays without a reading."""
        return frozen(self._distances * np.cos(self.angles))

    @cached_property
    def y(self) -> NDArray[np.float64]:
        """Metres to the left, shape (R,); NaN for rays without a reading."""
        return frozen(self._distances * np.sin(self.angles))

    @property
    def xy(self) -> NDArray[np.float64]:
        """The points of the readings, shape (N, 2), metres forward and to the left."""
        return np.column_stack((self.x, self.y))[self.valid]

    def distance(self, sector: SectorLike = ALL_ROUND, *, percentile: float | None = None) -> float:
        """Return metres to the nearest thing: inf if nothing is in range, 0 if it is too close, NaN if unknown.

        Each ray counts by its range, and the least value is the distance:

        =============================================  ==========================================
        range                                          counts as
        =============================================  ==========================================
        within range_min and range_max                 that distance
        -inf, or 0.02 m and more but below range_min   0: too close to measure
        +inf, or a number above range_max              inf: nothing is in range
        below 0.02 m and below range_min, as 0.0       inf: a code for nothing seen; see below
        NaN                                            nothing, unless all are NaN: then NaN
        =============================================  ==========================================

        Scanners send the same code for things that are too far, too dark or too close. So the distance is NaN for a
        sector with only codes, or codes and NaN, and for a sector without rays. A loop "go while distance > x" stops
        at NaN.

        Args:
            sector: a `Sector`; two angles in radians, or in degrees as text (``("-15deg", "15deg")``), from the first
                counter-clockwise to the second; "front", "left", "back" or "right", the quarter of the circle round
                that direction; or the selection of a laser widget. The default is all rays.
            percentile: 0 to 100, a percentile of these values instead of the least: 5 is robust against single wrong
                rays. It is never interpolated: between two rays the nearer one counts.

        Raises:
            TypeError: the sector is not a pair of numbers (None, for example), or the percentile is not a number.
            ValueError: the sector is unknown, an angle is beyond a full turn, or the percentile is not 0 to 100.
        """
        return shortest(distances(self.ranges, self, sector, percentile))

    def nearest(self, sector: SectorLike = ALL_ROUND) -> Ray | None:
        """Return the ray to the nearest thing, the first of equals, or None if `distance` is inf or NaN.

        A thing that is too close to measure is nearest of all: its ray has a range of -inf, or below range_min.

        Args:
            sector: as in `distance`, with the same errors.
        """
        away = ray_distances(self.ranges, self)
        away[~((away < np.inf) & inside(self, sector))] = np.inf
        found = int(away.argmin()) if away.size else 0
        return self[found] if away.size and away[found] < np.inf else None

    def indices(self, sector: SectorLike = ALL_ROUND) -> NDArray[np.intp]:
        """Return the indices of the rays in a sector, from its first angle counter-clockwise to its second.

        They go on across the seam of a full circle, and decrease for a clockwise scanner.

        Args:
            sector: as in `distance`, with the same errors.

        Examples:
            >>> scan = Scan([1.0, 2.0, 3.0, 4.0], 0.0, 1.5708, 0.1, 30.0)
            >>> scan.indices(("-100deg", "10deg"))
            array([3, 0])
        """
        return np.arange(len(self)) if sector is ALL_ROUND else order_in_sector(self.angles, to_sector(sector))

    def at(self, angle: float | str) -> Ray | None:
        """Return the ray that points closest to an angle in radians, or in degrees as text (``"20deg"``).

        Return None if the angle is more than half a step outside the sweep.

        Raises:
            TypeError: the value is not an angle.
            ValueError: it is beyond ±2 pi and beyond all angles of the scan, as degrees without a unit are.
        """
        asked = finite("angle", to_radians("angle", angle), "radians")
        if abs(asked) > np.abs(self.angles).max(initial=0.0):
            in_radians("angle", asked)
        off = np.abs((self.angles - asked + pi) % (2 * pi) - pi)
        if not off.size or off.min() > abs(self.angle_increment) / 2 + ANGLE_ROUNDING:
            return None
        return self[int(off.argmin())]

    def problems(self) -> tuple[Problem, ...]:
        """Return the problems of this scan, the worst first, each with its remedy; the widget shows the same.

        Problems are a header that disagrees with its array, angles in degrees, impossible times, an empty frame_id, a
        wrong number of intensities, no reading at all, and a third or more of the rays outside the limits. A clockwise
        scanner is not a problem, nor are codes for "nothing seen", such as 0.0.

        Examples:
            >>> scan = Scan([0.0, 0.0], angle_min=0.0, angle_increment=0.5, range_min=0.1, range_max=3.5)
            >>> for problem in scan.problems():
            ...     print(problem)
            no readings: all 2 rays say 0 m, outside 0.1 m to 3.5 m; the scanner sees nothing, or is covered
        """
        of_ranges = scan_problems.of_ranges(self.ranges, self.range_min, self.range_max)
        # A problem without a remedy explains an empty scan: nothing has been measured yet.
        is_explained = not len(self) and any(not problem.remedy for problem in self.header_problems)
        of_sources = self.sources.problems if self.sources else ()
        return tuple(dict.fromkeys((*of_sources, *(() if is_explained else of_ranges), *self.header_problems)))

    def echo(self, which: str) -> Scan:
        """Return the same scan, of the same age, with the first, last or strongest echo of each ray as its range.

        A scan without several echoes is returned as it is.

        Args:
            which: ``"first"``, ``"last"`` or ``"strongest"``.

        Raises:
            ValueError: which is another value.

        Examples:
            >>> from robowidgets.messages import to_scan
            >>> rays = [{"echoes": [1.0, 4.5]}, {"echoes": [2.0]}]
            >>> limits = {"range_min": 0.1, "range_max": 9.0}
            >>> glass = to_scan({"ranges": rays, "angle_min": 0.0, "angle_increment": 0.1, **limits})
            >>> glass.ranges.tolist(), glass.echo("last").ranges.tolist(), glass.echo("last")[0].source
            ([1.0, 2.0], [4.5, 2.0], 1)
        """
        check_choice(which)
        if self.echoes is None or (self.sources and self.sources.made_of == f"{which} echo"):
            return self
        sources = self.echoes.sources(which)
        ranges, intensities = self.echoes.at(sources.numbers)
        return _changed(self, ranges=ranges, intensities=intensities, sources=sources)

    def with_echoes(self, echoes: Echoes) -> Scan:
        """Return the same scan with echoes; the first echo of each ray is its range."""
        return _changed(self, echoes=echoes, sources=echoes.sources("first"))

    def turned(self, angle: float | str) -> Scan:
        """Return the same scan, of the same age, with every ray turned by an angle, counter-clockwise.

        Args:
            angle: radians, or degrees as text (``"20deg"``).

        Raises:
            TypeError: the angle is neither a number nor degrees. ValueError: it is not finite.
        """
        by = finite("angle", to_radians("angle", angle), "radians")
        if not by:
            return self
        return _changed(self, angle_min=self.angle_min + by)

    def mounted(self, mount: Mount | None) -> Scan:
        """Return the same scan, of the same age, with a mount of the scanner on its robot.

        All its angles are the robot's. Rays keep their indices, and distances are still measured from the scanner.

        Args:
            mount: the mount, which replaces the present one, or None if unknown, as for `unmounted`.

        Examples:
            >>> scan = Scan([1.0, 2.0], angle_min=0.0, angle_increment=1.5708, range_min=0.1, range_max=30.0)
            >>> turned = scan.mounted(Mount.by_hand("90deg"))
            >>> scan.distance("front"), turned.distance("front"), turned.distance("left")
            (1.0, nan, 1.0)
        """
        own = self.unmounted()
        if mount is None or not (mount.turns_angles or mount.problems):
            return own
        problems = (*own.header_problems, *mount.problems)
        if not mount.turns_angles:
            return _changed(own, mount=mount, header_problems=problems)
        step = -own.angle_increment if mount.upside_down else own.angle_increment
        wound = mount.wound(own.angle_min, own.angle_min + max(0, len(own) - 1) * own.angle_increment)
        first = wound.to_robot(own.angle_min)
        return _changed(own, mount=wound, angle_min=first, angle_increment=step, header_problems=problems)

    def unmounted(self) -> Scan:
        """Return the same scan, of the same age, with the scanner's angles."""
        mount = self.mount
        if mount is None:
            return self
        problems = tuple(problem for problem in self.header_problems if problem not in mount.problems)
        if not mount.turns_angles:
            return _changed(self, mount=None, header_problems=problems)
        step = -self.angle_increment if mount.upside_down else self.angle_increment
        first = mount.to_scanner(self.angle_min)
        return _changed(self, mount=None, angle_min=first, angle_increment=step, header_problems=problems)

    @property
    def _reach(self) -> float:
        """Metres that a picture of this scan reaches: range_max, or the farthest reading if range_max is unlimited."""
        return self.range_max if self.range_max < _FARTHEST else float(self.ranges[self.valid].max(initial=0)) or 1.0

    @cached_property
    def _settings(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in fields(self)} | {"angles": self.angles}

    @cached_property
    def _distances(self) -> NDArray[np.float64]:
        return np.where(self.valid, self.ranges, np.nan).astype(np.float64)


def _changed(scan: Scan, **values: Any) -> Scan:
    """Return the same scan, of the same age, with other values."""
    changed = replace(scan, **values)
    note_arrival(changed, arrival_of(scan))
    return changed


def _within_half_turn(angle: float) -> float:
    return angle if abs(angle) <= pi + ANGLE_ROUNDING else atan2(sin(angle), cos(angle))
