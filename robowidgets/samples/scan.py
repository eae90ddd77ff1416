"""One sweep of a laser scanner, with the geometry that follows from it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field, fields, replace
from enum import IntEnum
from functools import cached_property
from math import atan2, cos, isfinite, pi, sin
from operator import index as as_index
from typing import Any, NamedTuple, TypeGuard

import numpy as np
from numpy.typing import ArrayLike, NDArray

MAX_RAYS = 1_000_000
_FLOAT32 = np.dtype(np.float32)
_FARTHEST = float(np.finfo(np.float32).max)
_ANGLE_ROUNDING = 1e-6

MILLIMETRES = 25
"""Times range_max that lies beyond what drivers send for rays that saw nothing."""

OF_DEGREES = "math.radians() makes them of degrees"


class Validity(IntEnum):
    """What a range says (REP-117). The five never mix: not in a picture, a pop-up or a count."""

    READING = 0
    TOO_CLOSE = 1
    NOTHING_IN_RANGE = 2
    NO_MEASUREMENT = 3
    OUTSIDE_LIMITS = 4


class Ray(NamedTuple):
    """One ray of a scan, as a program meets it.

    ``index`` is the index in ``ranges``; ``range`` is in metres, as measured (it may be NaN or infinite); ``angle`` is
    in radians within ±pi, counter-clockwise from forward; ``x`` and ``y`` are in metres and None when there is no
    reading; ``intensity`` is in device units and None when the scanner sent none.
    """

    index: int  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    range: float
    angle: float
    x: float | None
    y: float | None
    intensity: float | None
    validity: Validity


@dataclass(frozen=True, eq=False)
class Scan:
    """One sweep of a laser scanner.

    Ray ``i`` points at ``angle_min + i * angle_increment``; ``angle_max`` of a message is never used for geometry,
    because drivers disagree on what it means. A negative increment is a clockwise scanner. Arrays are read-only.

    Args:
        ranges: R distances in metres, any real dtype, kept as float32. NaN: no measurement; -inf: too close; +inf:
            nothing in range (REP-117). None in a list counts as NaN (JSON has no NaN).
        angle_min: angle of ray 0 in radians, counter-clockwise from forward.
        angle_increment: radians from one ray to the next; NaN or 0 only where there is at most one ray.
        range_min, range_max: metres; a range within them, both included, is a reading. Kept at float32's precision, so
            that a limit and a reading sent as the same number are equal. A range_max of inf, as some converters of
            point clouds send it, sets no limit: it is kept as the largest number that there is.
        intensities: nothing, or R values in device units. Another length is noted and the values are not used.
        stamp_ns: time of the first ray in nanoseconds since the epoch, or None.
        frame_id: coordinate frame of the scanner.
        notes: sentences about what was odd in the message, for a person to read.

    Raises:
        TypeError: something is not a number.
        ValueError: wrong shape, limits the wrong way round, or a value that is not finite.

    Source: sensor_msgs/LaserScan, REP-103, REP-117.

    Example:
        >>> scan = Scan([1.0, 2.5, float("inf")], angle_min=-0.5, angle_increment=0.5, range_min=0.1, range_max=30.0)
        >>> scan.nearest().index
        0
    """

    ranges: NDArray[np.float32]
    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float
    intensities: NDArray[np.float32] = field(default_factory=lambda: np.empty(0, np.float32))
    stamp_ns: int | None = None
    frame_id: str = ""
    notes: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        put = object.__setattr__
        notes = list(self.notes)
        ranges = _floats("ranges", self.ranges)
        if ranges.size > MAX_RAYS:
            raise ValueError(f"ranges: expected at most {MAX_RAYS:,} rays, got {ranges.size:,}")
        put(self, "ranges", ranges)
        intensities = _floats("intensities", self.intensities)
        if intensities.size not in (0, ranges.size):
            notes.append(f"{intensities.size} intensities for {ranges.size} rays: not used")
            intensities = _floats("intensities", ())
        put(self, "intensities", intensities)

        put(self, "angle_min", finite("angle_min", self.angle_min, "radians"))
        increment = number("angle_increment", self.angle_increment)
        if ranges.size <= 1:
            if ranges.size == 1 and not isfinite(increment):
                notes.append("one ray, angle_increment is not a number: drawn at angle_min")
            increment = increment if isfinite(increment) else 0.0
        elif not isfinite(increment) or increment == 0:
            raise ValueError(
                f"angle_increment: expected a finite step in radians other than 0 for {ranges.size} rays, "
                f"got {increment!r}"
            )
        if abs(increment) * (ranges.size - 1) > 2 * pi + 2 * abs(increment):
            notes.append("the rays sweep more than a full circle")
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
        notes += _about_metres(ranges, low, high)
        put(self, "notes", tuple(dict.fromkeys(notes)))

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
            range=float(self.ranges[i]),
            angle=_within_half_turn(float(self.angles[i])),
            x=float(self.x[i]) if reading else None,
            y=float(self.y[i]) if reading else None,
            intensity=float(self.intensities[i]) if self.intensities.size else None,
            validity=validity,
        )

    def __iter__(self) -> Iterator[Ray]:
        return (self[i] for i in range(len(self)))

    def again(
        self,
        ranges: ArrayLike,
        intensities: ArrayLike | None,
        stamp_ns: int | None,
        *,
        keep: bool = False,
    ) -> Scan:
        """The next sweep of the same scanner: what is not given stays as it is, and is not checked again.

        Args:
            ranges: as many as this scan has.
            intensities: the same, or None to keep those of this scan.
            stamp_ns: time of the first ray in nanoseconds since the epoch, or None.
            keep: whether arrays of float32 that are read-only are kept, not copied.

        Raises:
            TypeError: no numbers. ValueError: another number of rays, or of intensities.
        """
        scan = object.__new__(Scan)
        values = scan.__dict__
        values.update(self._settings)
        values["stamp_ns"] = stamp_ns
        for name, given in (("ranges", ranges), ("intensities", intensities)):
            if given is not None:
                array = given if keep and _is_frozen(given) else _floats(name, given)
                if array.size != values[name].size:
                    raise ValueError(
                        f"{name}: expected {values[name].size:,} values as in the scan before, got {array.size:,}"
                    )
                values[name] = array
        return scan

    @cached_property
    def angles(self) -> NDArray[np.float64]:
        """Angle of every ray as the scanner counts it, in radians, shape (R,): a full circle may run from 0 to 2 pi."""
        return _frozen(self.angle_min + np.arange(len(self)) * self.angle_increment)

    @cached_property
    def validity(self) -> NDArray[np.uint8]:
        """The class of every ray, shape (R,), values of `Validity`, in the order that REP-117 asks for."""
        r = self.ranges
        conditions = [(self.range_min <= r) & (r <= self.range_max), r == -np.inf, r == np.inf, np.isnan(r)]
        kinds = [Validity.READING, Validity.TOO_CLOSE, Validity.NOTHING_IN_RANGE, Validity.NO_MEASUREMENT]
        return _frozen(np.select(conditions, kinds, Validity.OUTSIDE_LIMITS).astype(np.uint8))

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """True where there is a reading, shape (R,)."""
        return _frozen(self.validity == Validity.READING)

    @cached_property
    def counts(self) -> dict[Validity, int]:
        """How many rays there are of each class."""
        counted = np.bincount(self.validity, minlength=len(Validity))
        return {kind: int(counted[kind]) for kind in Validity}

    @cached_property
    def x(self) -> NDArray[np.float64]:
        """Metres forward, shape (R,); NaN where there is no reading."""
        return _frozen(self._distances * np.cos(self.angles))

    @cached_property
    def y(self) -> NDArray[np.float64]:
        """Metres to the left, shape (R,); NaN where there is no reading."""
        return _frozen(self._distances * np.sin(self.angles))

    @property
    def xy(self) -> NDArray[np.float64]:
        """Points of the readings only, shape (N, 2), metres forward and to the left."""
        return np.column_stack((self.x, self.y))[self.valid]

    def nearest(self) -> Ray | None:
        """The reading at the smallest distance, the first of equals; None when there is no reading."""
        if not self.valid.any():
            return None
        return self[int(np.nanargmin(self._distances))]

    def at(self, angle: float) -> Ray | None:
        """The ray that points closest to an angle in radians; None more than half a step outside the sweep.

        Raises:
            TypeError: no number. ValueError: it is beyond ±2 pi and all angles of the scan, as degrees are.
        """
        angle = finite("angle", angle, "radians")
        if abs(angle) > np.abs(self.angles).max(initial=0.0):
            in_radians("angle", angle)
        off = np.abs((self.angles - angle + pi) % (2 * pi) - pi)
        if not off.size or off.min() > abs(self.angle_increment) / 2 + _ANGLE_ROUNDING:
            return None
        return self[int(off.argmin())]

    def turned(self, angle: float) -> Scan:
        """The same scan with every ray turned by an angle in radians, counter-clockwise."""
        return replace(self, angle_min=self.angle_min + angle) if angle else self

    @cached_property
    def _settings(self) -> dict[str, Any]:
        return {f.name: getattr(self, f.name) for f in fields(self)} | {"angles": self.angles}

    @cached_property
    def _distances(self) -> NDArray[np.float64]:
        return np.where(self.valid, self.ranges, np.nan).astype(np.float64)


def _within_half_turn(angle: float) -> float:
    return angle if abs(angle) <= pi + _ANGLE_ROUNDING else atan2(sin(angle), cos(angle))


def number(name: str, value: Any) -> float:
    """A float, NaN and inf included; TypeError when it is no number."""
    if type(value) is float:
        return value
    if isinstance(value, (str, bytes, bool)):
        raise TypeError(f"{name}: expected a number, got {value!r}")
    try:
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number, got {_short(value)}") from None


def finite(name: str, value: Any, unit: str) -> float:
    """A finite float; ValueError when it is NaN or infinite."""
    result = number(name, value)
    if not isfinite(result):
        raise ValueError(f"{name}: expected a finite number of {unit}, got {result!r}")
    return result


def in_radians(name: str, value: Any) -> float:
    """An angle within ±2 pi; ValueError beyond it, where it is in degrees."""
    angle = finite(name, value, "radians")
    if not is_angle(angle):
        raise ValueError(f"{name}: expected radians within ±2 pi, got {angle!r}; {OF_DEGREES}")
    return angle


def is_angle(value: float) -> bool:
    """Whether this is within ±2 pi, as radians are."""
    return abs(value) <= 2 * pi + _ANGLE_ROUNDING


def _floats(name: str, values: ArrayLike | Any) -> NDArray[np.float32]:
    """A read-only float32 copy of a one-dimensional array."""
    array: NDArray[np.float32] | None
    if type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1:
        array = values.copy()  # as scanners send it: nothing to guard against
        array.setflags(write=False)
        return array
    try:
        given = np.asarray(_unmasked(values) if isinstance(values, np.ma.MaskedArray) else values)
        with np.errstate(over="ignore"):
            array = given.astype(np.float32) if given.dtype.kind in "fiuO" else None
    except (TypeError, ValueError, OverflowError):
        array = None
    if array is None:
        raise TypeError(f"{name}: expected a one-dimensional array of numbers, got {_short(values)}")
    if array.ndim != 1:
        raise ValueError(f"{name}: expected a one-dimensional array, got shape {array.shape}")
    return _frozen(array)


def _about_metres(ranges: NDArray[np.float32], low: float, high: float) -> list[str]:
    """What is said of ranges none of which is a reading, and most of which lie as far out as millimetres do."""
    if ((low <= ranges) & (ranges <= high)).any():
        return []
    finite = ranges[np.isfinite(ranges)]
    usual = float(np.median(finite)) if finite.size else 0.0
    if usual <= MILLIMETRES * high:
        return []
    return [f"ranges are around {usual:,.0f} where range_max is {high:g} m: are they in millimetres? They go in metres"]


def _unmasked(values: np.ma.MaskedArray[Any, Any]) -> NDArray[np.float32]:
    """What is masked as NaN: there is no measurement."""
    return np.ma.filled(values.astype(np.float32), np.nan)


def _is_frozen(values: Any) -> TypeGuard[NDArray[np.float32]]:
    """Whether this is a read-only one-dimensional array of float32."""
    return type(values) is np.ndarray and values.dtype is _FLOAT32 and values.ndim == 1 and not values.flags.writeable


def _frozen(array: NDArray[Any]) -> NDArray[Any]:
    array.setflags(write=False)
    return array


def _short(value: object) -> str:
    text = repr(value)
    return f"{text[:60]}…" if len(text) > 60 else text
