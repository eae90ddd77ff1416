"""A point cloud, with every field that its sensor measured."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, isfinite, pi, tau
from operator import index as as_index
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .age import HasAge, note_arrival
from .checks import frozen, in_radians, metres, not_negative, shortest
from .echoes import Sources
from .problem import Problem
from .scan import MAX_RAYS, Scan

MAX_POINTS = 5_000_000
AXES = ("x", "y", "z")
Band = tuple[float, float]
"""The lower and upper bound, both included; each may be infinite."""


class Point(NamedTuple):
    """One point of a cloud.

    ``index`` is the index of the point in the message, from 0. ``row`` and ``column`` are None if the cloud is not
    organized in rows. ``x``, ``y``, ``z`` and ``distance`` (from the origin of the frame) are in metres, and NaN if
    nothing was measured. ``fields`` maps the name of every field to its value.
    """

    index: int  # type: ignore[assignment]  # hides tuple.index
    row: int | None
    column: int | None
    x: float
    y: float
    z: float
    distance: float
    fields: Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class Cloud(HasAge):
    """Points in a frame of REP-103, x forward, y left, z up, in metres, in the order of their message.

    Arrays are read-only, and views of the message if it cannot change.

    Args:
        points: shape (N,), a structured array with the measured fields, including ``x``, ``y`` and ``z``, in any byte
            order.
        rows: the number of rows of equal length for a cloud that is organized like a picture; else 1.
        stamp_ns: time of the cloud in nanoseconds since the epoch, or None.
        frame_id: coordinate frame of the points.
        problems: problems of the message.

    Raises:
        TypeError: points is not a structured array.
        ValueError: x, y or z is missing or not a number, there are too many points, or they do not fit into the rows.

    Source: sensor_msgs/PointCloud2, REP-103.

    Examples:
        >>> from robowidgets.messages import to_cloud
        >>> cloud = to_cloud([[1.0, 0.0, 0.2], [3.0, 4.0, 0.0]])
        >>> len(cloud), cloud[1].distance, cloud.points[(cloud.z > 0.1) & (cloud.z < 0.5)].size
        (2, 5.0, 1)
    """

    points: NDArray[Any]
    rows: int = 1
    stamp_ns: int | None = None
    frame_id: str = ""
    problems: tuple[Problem, ...] = ()

    def __post_init__(self) -> None:
        points = self.points
        if not isinstance(points, np.ndarray) or points.dtype.names is None or points.ndim != 1:
            raise TypeError("points: expected a one-dimensional structured array; to_cloud makes it from other data")
        if points.dtype.hasobject:
            raise TypeError(f"points: expected fields of numbers, got {points.dtype}")
        check_count(points.size)
        missing = [axis for axis in AXES if axis not in points.dtype.names]
        if missing:
            raise ValueError(
                f"expected points with x, y and z; got the fields {', '.join(points.dtype.names)} "
                f"(missing: {', '.join(missing)})"
            )
        for axis in AXES:
            if points.dtype[axis].kind not in "fiu":
                raise ValueError(f"{axis}: expected one number for each point, got {points.dtype[axis]}")
        if self.rows < 1 or points.size % self.rows:
            raise ValueError(f"rows: expected rows of equal lengths for {points.size:,} points, got {self.rows!r}")
        view = points.view()
        object.__setattr__(self, "points", frozen(view))
        note_arrival(self)

    def __len__(self) -> int:
        return int(self.points.size)

    def __repr__(self) -> str:
        rows = f" in {self.rows:,} rows" if self.rows > 1 else ""
        near = self.nearest()
        how = f"nearest {metres(near.distance, 10.0)} at points[{near.index}]" if near else "none measured"
        return f"<Cloud of {len(self):,} point{'' if len(self) == 1 else 's'}{rows}, {how}>"

    def __getitem__(self, index: int) -> Point:
        try:
            i = as_index(index)
        except TypeError:
            raise TypeError(f"expected the index of one point, got {index!r}; .points has fields and parts") from None
        if not -len(self) <= i < len(self):
            raise IndexError(f"index {i}: this cloud has {len(self):,} points")
        i %= len(self)
        fields = {name: _plain(self.points[name][i]) for name in self.fields}
        x, y, z = (float(fields[axis]) for axis in AXES)
        row, column = divmod(i, self.columns) if self.rows > 1 else (None, None)
        return Point(i, row, column, x, y, z, shortest(self.distance[i]), fields)

    def __iter__(self) -> Iterator[Point]:
        return (self[i] for i in range(len(self)))

    def __getstate__(self) -> dict[str, Any]:
        """Return the measured values without the cached ones."""
        names = ("points", "rows", "stamp_ns", "frame_id", "problems", "_arrived")
        return {name: getattr(self, name) for name in names}

    def __setstate__(self, state: dict[str, Any]) -> None:
        vars(self).update(state)
        frozen(self.points)  # a copy of a read-only array is not

    @property
    def fields(self) -> tuple[str, ...]:
        """The names of the fields of each point."""
        return self.points.dtype.names or ()

    @property
    def columns(self) -> int:
        """The number of points in each row; the number of all points if the cloud is not organized in rows."""
        return len(self) // self.rows

    @property
    def x(self) -> NDArray[Any]:
        """Metres forward, shape (N,), as sent."""
        return self.points["x"]

    @property
    def y(self) -> NDArray[Any]:
        """Metres to the left, shape (N,), as sent."""
        return self.points["y"]

    @property
    def z(self) -> NDArray[Any]:
        """Metres up, shape (N,), as sent."""
        return self.points["z"]

    @cached_property
    def distance(self) -> NDArray[np.float32]:
        """Metres from the origin of the frame, shape (N,), float32; NaN where nothing was measured."""
        with np.errstate(over="ignore", invalid="ignore"):
            squares = sum(self.points[axis].astype(np.float64) ** 2 for axis in AXES)
            return frozen(np.sqrt(squares).astype(np.float32))

    @cached_property
    def valid(self) -> NDArray[np.bool_]:
        """True for each point that was measured: x, y and z are finite numbers, shape (N,)."""
        return frozen(np.isfinite(self.distance))

    def inside(self, /, **bands: Band) -> NDArray[np.bool_]:
        """Return True for each point within bounds, shape (N,): ``cloud.inside(x=(0, 2), z=(0.1, 0.5))``.

        Args:
            **bands: a lower and an upper bound, both included, for any field or for ``distance``.

        Raises:
            ValueError: the cloud does not have the field, or the bounds are not a pair in ascending order.
        """
        found = self.valid.copy()
        for name, band in bands.items():
            low, high = to_band(name, band)
            if name != "distance" and name not in self.fields:
                raise ValueError(f"{name}: this cloud has the fields {', '.join(self.fields)}, and a distance")
            values = self.distance if name == "distance" else self.points[name]
            if values.ndim != 1:
                raise ValueError(f"{name}: expected a field with one number for each point")
            found &= (values >= low) & (values <= high)
        return found

    def nearest(self, /, **bands: Band) -> Point | None:
        """Return the point nearest to the origin of the frame, the first of equals, or None if no point was measured.

        Args:
            **bands: bounds as in `inside`; other points are ignored.
        """
        away = np.where(self.inside(**bands), self.distance, np.inf)
        i = int(away.argmin()) if away.size else 0
        return self[i] if away.size and away[i] < np.inf else None

    def scan(
        self,
        z: Band = (-inf, inf),
        *,
        angle_min: float | str = -pi,
        angle_increment: float | str = pi / 360,
        ray_count: int | None = None,
        range_min: float = 0.0,
        range_max: float = inf,
    ) -> Scan:
        """Return the points between two heights as a scan: the range of each ray is the distance to its nearest point.

        A ray takes the points from its angle up to the angle of the next ray, as pointcloud_to_laserscan does. Its
        range is the distance on the ground from the origin of the frame, without the height. ``scan.sources`` and
        ``ray.source`` have the index of its point in the cloud. A ray without a point is +inf: nothing in range.

        Args:
            z: the lower and the upper bound in metres, both included.
            angle_min: angle of ray 0, in radians or as text (``"-90deg"``).
            angle_increment: angle from one ray to the next, above 0; the default is half a degree.
            ray_count: the number of rays, or None for a full circle.
            range_min: metres; points nearer than this on the ground are left out.
            range_max: metres; points farther away on the ground are left out.

        Raises:
            TypeError: a value is not a number. ValueError: a band, an angle or a limit is out of range.

        Source: the ROS node pointcloud_to_laserscan.

        Examples:
            >>> from robowidgets.messages import to_cloud
            >>> scan = to_cloud([[1.0, 0.0, 0.2], [2.0, 0.0, 0.2], [0.5, 0.0, 1.7]]).scan(z=(0.1, 0.5))
            >>> scan.at(0).range, scan.at(0).source
            (1.0, 0)
        """
        low, high = to_band("z", z)
        first = in_radians("angle_min", angle_min)
        step = in_radians("angle_increment", angle_increment)
        if not step > 0:
            raise ValueError(f"angle_increment: expected radians above 0, got {step!r}")
        count = ceil(tau / step - 1e-6) if ray_count is None else ray_count
        if not 1 <= count <= MAX_RAYS:
            raise ValueError(f"ray_count: expected 1 to {MAX_RAYS:,} rays, got {count!r}")
        near = not_negative("range_min", range_min, "metres")
        x, y = self.x.astype(np.float64), self.y.astype(np.float64)
        with np.errstate(invalid="ignore", over="ignore"):
            away = np.hypot(x, y)
            chosen = np.flatnonzero(self.inside(z=(low, high)) & (away >= near) & (away <= range_max))
        # The node divides by the float32 values of its message.
        turned = (np.arctan2(y[chosen], x[chosen]) - float(np.float32(first))) % tau
        rays = (turned / float(np.float32(step))).astype(np.intp)
        # If a full circle is not a whole number of steps, the last ray or the first takes the points beyond the last.
        chosen, rays = chosen[rays < count], rays[rays < count]
        # The nearest point of each ray is written last.
        order = np.argsort(-away[chosen], kind="stable")
        chosen, rays = chosen[order], rays[order]
        ranges = np.full(count, np.inf, np.float32)
        numbers = np.full(count, -1, np.int32)
        ranges[rays], numbers[rays] = away[chosen], chosen
        lit = self.points["intensity"] if "intensity" in self.fields else None
        intensities = np.empty(0, np.float32)
        if lit is not None and lit.ndim == 1:
            intensities = np.full(count, np.nan, np.float32)
            intensities[rays] = lit[chosen]
        made = Scan(
            ranges=ranges,
            angle_min=first,
            angle_increment=step,
            range_min=near,
            range_max=range_max,
            intensities=intensities,
            stamp_ns=self.stamp_ns,
            frame_id=self.frame_id,
            sources=Sources(_describe_band(low, high), "points[{number}]", numbers),
        )
        note_arrival(made, self._arrived)
        return made


def check_count(points: int) -> None:
    """Raise ValueError for more points than a cloud may have, before any point is copied."""
    if points > MAX_POINTS:
        raise ValueError(
            f"expected at most {MAX_POINTS:,} points, got {points:,}; take every n-th, or a filter such as a voxel grid"
        )


def to_band(name: str, band: Any) -> Band:
    """Return a lower and an upper bound, which may be infinite.

    Raises:
        ValueError: these are not two numbers in ascending order.
    """
    try:
        low, high = (float(bound) for bound in band)
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected a lower and an upper bound, got {band!r}") from None
    if not low <= high:
        raise ValueError(f"{name}: expected the lower bound first, got {low:g} and {high:g}")
    return low, high


def _describe_band(low: float, high: float) -> str:
    if not isfinite(low) and not isfinite(high):
        return "points of all heights"
    bounds = [f"from {low:.3g} m" if isfinite(low) else "", f"to {high:.3g} m" if isfinite(high) else ""]
    return f"points {' '.join(filter(None, bounds))} high"


def _plain(value: Any) -> Any:
    """Return a number of NumPy as a number of Python, float32 with the fewest decimals."""
    if isinstance(value, np.ndarray):
        return tuple(map(_plain, value))
    return shortest(value) if value.dtype.kind == "f" and value.itemsize == 4 else value.item()
