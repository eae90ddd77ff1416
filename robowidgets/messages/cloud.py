"""Conversion of PointCloud2 and PointCloud messages, and of arrays of points."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Cloud, Problem
from ..samples.checks import number
from ..samples.cloud import AXES, check_count
from .byte_fields import byte_array, owned
from .fields import MISSING, describe, frame_id, get, has, stamp_ns, unwrap

CLOUD_TYPES = frozenset({"sensor_msgs/msg/PointCloud2", "sensor_msgs/msg/PointCloud"})

_FORMATS = {1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 8: "f8"}
_NEEDED = ("height", "width", "fields", "is_bigendian", "point_step", "row_step", "data")
_MOST_BYTES = 1 << 31
_PACKETS = "; packets of a scanner are not decoded: its driver has a node that publishes them as PointCloud2"


def to_cloud(message: Any) -> Cloud:
    """Return the cloud in a message or an array.

    The points are a view of the message if that cannot change, else a copy.

    Args:
        message: an object or dictionary with the fields of sensor_msgs/PointCloud2 or PointCloud; numbers of shape
            (N, 3), or (H, W, 3) for a cloud organized in rows; a structured array of shape (N,) or (H, W) with the
            fields x, y and z; a `Cloud` is returned as it is.

    Raises:
        TypeError: the message has another type; the text says what came and what was expected.
        ValueError: its fields, steps and bytes do not describe points, or there are more than five million.

    Examples:
        >>> to_cloud([[1.0, 0.0, 0.5], [0.0, 2.0, float("nan")]])
        <Cloud of 2 points, nearest 1.12 m at points[0]>
    """
    message = unwrap(message)
    if isinstance(message, Cloud):
        return message
    if isinstance(message, (list, tuple)) or hasattr(message, "__array__"):
        return _of_array(message)
    if is_cloud(message):
        return _of_bytes(message) if has(message, "point_step") else _of_points(message)
    raise TypeError(
        "expected a message like sensor_msgs/PointCloud2 or PointCloud, or numbers of shape (N, 3); "
        f"got {describe(message)}{_PACKETS if has(message, 'packets') else ''}"
    )


def is_cloud(message: Any) -> bool:
    """Return True for a cloud or a message with one, but not for arrays, which may be something else."""
    message = unwrap(message)
    return (
        isinstance(message, Cloud) or has(message, "fields", "point_step", "data") or has(message, "points", "channels")
    )


def _of_array(given: Any) -> Cloud:
    try:
        array = np.ma.filled(given, np.nan) if isinstance(given, np.ma.MaskedArray) else np.asarray(given)
    except (TypeError, ValueError):
        raise ValueError("points: expected numbers of shape (N, 3), got rows of different lengths") from None
    if array.dtype.names is not None:
        if array.ndim not in (1, 2):
            raise ValueError(f"points: expected a structured array of shape (N,) or (H, W), got {array.shape}")
        rows = array.shape[0] if array.ndim == 2 and array.size else 1
        return Cloud(owned(array).reshape(-1), rows)
    if not array.size and array.ndim < 2:
        array = array.reshape(0, 3)
    if array.ndim not in (2, 3) or array.shape[-1] != 3:
        raise ValueError(f"points: expected numbers of shape (N, 3), or (H, W, 3), got shape {array.shape}")
    if array.dtype.kind not in "fiu":
        raise TypeError(f"points: expected numbers of shape (N, 3), got {array.dtype}")
    check_count(array.size // 3)
    kind = array.dtype if array.dtype in (np.float32, np.float64) else np.dtype(np.float64)
    own = np.array(array, kind, order="C")
    rows = array.shape[0] if array.ndim == 3 and array.size else 1
    return Cloud(own.reshape(-1).view([(axis, kind) for axis in AXES]), rows)


def _of_bytes(message: Any) -> Cloud:
    """Return the cloud in a PointCloud2."""
    missing = [name for name in _NEEDED if get(message, name, MISSING) is MISSING]
    if missing:
        raise TypeError(
            f"expected a message like sensor_msgs/PointCloud2, with {', '.join(_NEEDED)}; "
            f"got {describe(message)} (missing: {', '.join(missing)})"
        )
    height, width, step, row_step = (_count(message, name) for name in ("height", "width", "point_step", "row_step"))
    check_count(height * width)
    data = byte_array("data", get(message, "data"))
    kind, problems = _kind(get(message, "fields"), step, bool(get(message, "is_bigendian")))
    odd = list(problems)
    if height > 1 and row_step < width * step:
        odd.append(
            Problem(
                f"row_step is {row_step:,} for rows of {width:,} points of {step} bytes: not used",
                "rows are taken one right after the other; the driver should send width * point_step, or more",
            )
        )
        row_step = width * step
    elif height > 1 and row_step == height * width * step == data.size:
        # Some drivers send the size of all rows together.
        row_step = width * step
    needed = (height - 1) * row_step + width * step if height and width else 0
    if data.size < needed:
        raise ValueError(
            f"data: expected {needed:,} bytes for {height:,} x {width:,} points of {step} bytes, got {data.size:,}"
        )
    if data.size > max(needed, height * row_step):
        odd.append(
            Problem(
                f"{data.size - needed:,} bytes after the last point: not used",
                "height, width and point_step should cover all points",
            )
        )
    if not needed:
        points: NDArray[Any] = np.empty(0, kind)
    else:
        grid: NDArray[Any] = np.ndarray((height, width), kind, data, strides=(row_step, step))
        # A view, except for rows with bytes between them.
        points = grid.reshape(-1)
    return Cloud(points, height if needed else 1, stamp_ns(message), frame_id(message), tuple(odd))


def _kind(fields: Any, step: int, is_big: bool) -> tuple[np.dtype[Any], tuple[Problem, ...]]:
    """Return the NumPy type of one point, and problems of the fields."""
    if not isinstance(fields, Sequence) or isinstance(fields, (str, bytes)):
        raise TypeError(f"fields: expected a list of sensor_msgs/PointField, got {describe(fields)}")
    names: list[str] = []
    formats: list[Any] = []
    offsets: list[int] = []
    odd: list[Problem] = []
    ends: list[tuple[int, int, str]] = []
    for field in fields:
        name, code, offset = str(get(field, "name", "")), _count(field, "datatype"), _count(field, "offset")
        if code not in _FORMATS:
            raise ValueError(f"field {name!r}: expected a datatype from 1 to 8, got {code}")
        # Old drivers send 0 for one number.
        count = _count(field, "count") or 1
        item = np.dtype((">" if is_big else "<") + _FORMATS[code])
        end = offset + count * item.itemsize
        if end > step:
            raise ValueError(f"field {name!r}: it ends at byte {end} of a point, but point_step is {step}")
        if not name or name in names:
            odd.append(Problem(f"field {name!r} comes twice" if name else "a field has no name", "only one is read"))
            continue
        over = next((other for first, last, other in ends if offset < last and first < end), "")
        if over:
            odd.append(
                Problem(f"the fields {over} and {name} share bytes", "each is read as if the other did not exist")
            )
        ends.append((offset, end, name))
        names.append(name)
        formats.append(item if count == 1 else (item, (count,)))
        offsets.append(offset)
    if not names:
        raise ValueError("fields: expected at least x, y and z, got none")
    spec: Any = {"names": names, "formats": formats, "offsets": offsets, "itemsize": step}
    return np.dtype(spec), tuple(odd)


def _of_points(message: Any) -> Cloud:
    """Return the cloud in a PointCloud, the older type: a list of points, and channels with one number per point."""
    given, channels = get(message, "points"), get(message, "channels")
    check_count(len(given))
    columns: dict[str, Any] = {axis: [get(point, axis, None) for point in given] for axis in AXES}
    odd: list[Problem] = []
    for channel in channels:
        name, values = str(get(channel, "name", "")), get(channel, "values", ())
        if not name or name in columns or len(values) != len(given):
            odd.append(
                Problem(
                    f"channel {name!r} has {len(values):,} values for {len(given):,} points: not used"
                    if name and name not in columns
                    else f"channel {name!r} comes twice"
                    if name
                    else "a channel has no name",
                    "the driver should send one value of each channel for each point",
                )
            )
            continue
        columns[name] = values
    points = np.empty(len(given), [(name, np.float32) for name in columns])
    for name, values in columns.items():
        points[name] = _floats(name, values)
    return Cloud(points, 1, stamp_ns(message), frame_id(message), tuple(odd))


def _floats(name: str, values: Any) -> NDArray[np.float32]:
    try:
        # JSON has no NaN.
        return np.array(values, object).astype(np.float32)
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected numbers, got {describe(values)}") from None


def _count(message: Any, name: str) -> int:
    """Return a field as a whole number that is 0 or more."""
    value = number(name, get(message, name, None))
    if not (0 <= value < _MOST_BYTES and value == int(value)):
        raise ValueError(f"{name}: expected a whole number, 0 or more, got {value!r}")
    return int(value)
