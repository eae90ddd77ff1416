"""Rows of a depth image as the scan of a laser scanner."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..messages.camera_info import to_camera_info
from ..messages.fields import has
from ..messages.image import to_image
from ..samples import Image, Scan
from ..samples.echoes import Sources
from .model import CameraModel

NEAREST, FARTHEST = 0.45, 10.0
"""Metres: the limits of depthimage_to_laserscan where nobody sets others."""

_CODE = "image.depth.flat[{number}]"
"""How a program gets at a pixel."""


def depth_scan(
    depth: ArrayLike | Any,
    camera_info: Any,
    rows: int | tuple[int, int] = 1,
    *,
    range_min: float = NEAREST,
    range_max: float = FARTHEST,
    frame_id: str = "",
    stamp_ns: int | None = None,
) -> Scan:
    """A row, or a band of rows, of a depth image as a scan: the one that depthimage_to_laserscan sends.

    The scan lies in the plane of the camera, x ahead and y to the left. It has as many rays as the image has columns,
    at equal angles; index 0 is at the right. Of the readings that fall on one ray the nearest counts; a ray on which
    there is none is NaN. `depth_rays` tells on which ray a column falls, and ``scan.at(index).source`` which pixel a
    ray is, counted by rows: ``image.depth.flat[source]``.

    Args:
        depth: the image, shape (H, W): integers are millimetres, others metres (REP-118). 0 and NaN are no reading. Or
            a sensor_msgs/Image, or an `Image`.
        camera_info: a sensor_msgs/CameraInfo, or a `CameraInfo`.
        rows: how many rows, around the optical axis; or the first row, and the one after the last:
            ``(230, 250)``.
        range_min: metres; what is nearer is left out.
        range_max: metres; what is farther is left out.
        frame_id: of the scan; x of that frame is z of the camera's. Empty: that of the camera without ``_optical``.
        stamp_ns: nanoseconds since the epoch; None: that of the image, else of the calibration.

    Raises:
        TypeError: no image of numbers, or no calibration. ValueError: another shape, rows that are not in the image,
            or a calibration of another image.

    Source: depthimage_to_laserscan, REP-118.

    Examples:
        >>> info = CameraInfo(5, 3, [4, 0, 2, 0, 4, 1, 0, 0, 1], frame_id="depth_optical_frame")
        >>> scan = depth_scan(np.full((3, 5), 2.0), info)
        >>> len(scan), scan.ranges.round(2).tolist(), scan.frame_id
        (5, [2.240000009536743, 2.059999942779541, 2.0, 2.059999942779541, 2.240000009536743], 'depth_frame')
    """
    if isinstance(depth, Image) or has(depth, "encoding", "data"):
        picture = to_image(depth)
        depth, stamp_ns = picture.depth, stamp_ns or picture.stamp_ns
    image = np.asarray(depth)
    if image.dtype.kind not in "uif":
        raise TypeError(f"depth: expected an image of metres, or of whole millimetres, got {image.dtype}")
    if image.ndim != 2:
        raise ValueError(f"depth: expected an image of shape (H, W), got shape {image.shape}")
    info = to_camera_info(camera_info)
    height, width = image.shape
    # A depth image is rectified where it comes from, and its node reads it by p.
    model = CameraModel(info, rectified=True, size=(width, height))
    first, last = _band(rows, height, float(model.middle[1]))
    rays = depth_rays(model)
    ahead = image[first:last] * np.float64(0.001 if image.dtype.kind in "ui" else 1.0)
    # As in its C++: what it sends is compared to the last index.
    column = np.arange(width, dtype=np.float32) - np.float32(model.middle[0])
    aside = column * np.float32(1.0 / model.focus[0])
    lengths = np.hypot(ahead * aside, ahead).astype(np.float32)
    is_seen = (np.float32(range_min) <= lengths) & (lengths <= np.float32(range_max)) & np.isfinite(lengths)
    lengths = np.where(is_seen, lengths, np.float32(np.inf))
    row = lengths.argmin(axis=0)
    nearest = lengths[row, np.arange(width)]
    # Of what falls on one ray, the nearest is written last.
    order = np.argsort(-nearest, kind="stable")
    ranges, pixels = np.full(width, np.inf, np.float32), np.full(width, -1, np.int32)
    ranges[rays[order]] = nearest[order]
    pixels[rays[order]] = ((first + row) * width + np.arange(width))[order]
    pixels[np.isinf(ranges)] = -1
    # What is farther than the sensor can see may come as inf: that says more than NaN.
    beyond = np.zeros(width, bool)
    np.logical_or.at(beyond, rays, np.isposinf(ahead).any(axis=0))
    ranges[np.isinf(ranges) & ~beyond] = np.nan
    start, step = _sweep(model)
    return Scan(
        ranges,
        angle_min=float(start),
        angle_increment=float(step),
        range_min=range_min,
        range_max=range_max,
        stamp_ns=stamp_ns or info.stamp_ns,
        frame_id=frame_id or info.frame_id.replace("_optical", ""),
        sources=Sources(f"row {first}" if last == first + 1 else f"rows {first} to {last - 1}", _CODE, pixels),
    )


def depth_rays(model: CameraModel) -> NDArray[np.intp]:
    """On which ray of `depth_scan` each column of an image falls, shape (W,)."""
    width = model.size[0]
    start, step = _sweep(model)
    column = np.arange(width, dtype=np.float32) - np.float32(model.middle[0])
    angles = -np.arctan2(column.astype(np.float64) * np.float32(1.0 / model.focus[0]), 1.0)
    return np.clip(((angles - np.float64(start)) / np.float64(step)).astype(np.intp), 0, width - 1)


def _sweep(model: CameraModel) -> tuple[np.float32, np.float32]:
    """The first angle and the step, as they fit into a message."""
    (width, _), (middle, _) = model.size, model.middle
    if width < 2:
        raise ValueError(f"depth: expected an image of 2 columns or more, got {width}")
    # The node goes by angles between rays, which have no sign: the axis has to be in the image.
    low, high = (
        np.float32(-abs(np.arctan((width - 1 - middle) / model.focus[0]))),
        np.float32(abs(np.arctan(middle / model.focus[0]))),
    )
    return low, np.float32((np.float64(high) - np.float64(low)) / (width - 1))


def _band(rows: int | tuple[int, int], height: int, axis: float) -> tuple[int, int]:
    """The first row and the one after the last."""
    if isinstance(rows, tuple):
        first, last = (int(row) for row in rows)
    else:
        # The node divides whole numbers, and cuts off what is left.
        first = int(axis - int(rows) // 2)
        last = first + int(rows)
    if not 0 <= first < last <= height:
        raise ValueError(f"rows: expected rows of an image of {height}, got {first} to {last}")
    return first, last
