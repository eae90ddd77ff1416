"""Conversion of rows of a depth image to a scan."""

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
"""Metres. The default limits of depthimage_to_laserscan."""

_CODE = "image.depth.flat[{number}]"
"""Code that reads a pixel."""


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
    """Return a scan of a row, or of a band of rows, of a depth image, as depthimage_to_laserscan sends it.

    The scan lies in the plane of the camera, x ahead and y to the left. It has as many rays as the image has columns,
    at equal angles; index 0 is at the right. If several readings fall on one ray, the nearest counts; a ray without a
    reading is NaN. `depth_rays` returns the ray of each column, and ``scan[index].source`` is the pixel of a ray,
    counted by rows: ``image.depth.flat[source]``.

    Args:
        depth: the image, shape (H, W): integers are millimetres, others metres (REP-118), and 0 and NaN are not
            readings. Or a sensor_msgs/Image, or an `Image`.
        camera_info: a sensor_msgs/CameraInfo, or a `CameraInfo`.
        rows: the number of rows around the optical axis, or the first row and the row after the last: ``(230, 250)``.
        range_min: metres; nearer readings are left out.
        range_max: metres; farther readings are left out.
        frame_id: the frame of the scan, whose x is z of the camera's frame. The default is the camera's frame without
            ``_optical``.
        stamp_ns: nanoseconds since the epoch. The default is the stamp of the image, or else of the calibration.

    Raises:
        TypeError: the image does not have numbers, or the calibration has another type.
        ValueError: the shape is wrong, the rows are not in the image, or the calibration is for another image.

    Source: depthimage_to_laserscan, REP-118.

    Examples:
        >>> from robowidgets import CameraInfo
        >>> info = CameraInfo(5, 3, [4, 0, 2, 0, 4, 1, 0, 0, 1], frame_id="depth_optical_frame")
        >>> scan = depth_scan(np.full((3, 5), 2.0), info)
        >>> len(scan), scan.ranges.round(2).tolist(), scan.frame_id
        (5, [2.059999942779541, nan, 2.0, 2.059999942779541, 2.240000009536743], 'depth_frame')
    """
    if isinstance(depth, Image) or has(depth, "encoding", "data"):
        picture = to_image(depth)
        depth, stamp_ns = picture.depth, stamp_ns or picture.stamp_ns
        if picture.pixels.dtype.kind == "f":
            # `Image.depth` has NaN for everything that was not measured.
            depth = np.where(np.isposinf(picture.pixels), np.float32(np.inf), depth)
    image = np.asarray(depth)
    if image.dtype.kind not in "uif":
        raise TypeError(f"depth: expected metres as floats, or millimetres as whole numbers, got {image.dtype}")
    if image.ndim != 2:
        raise ValueError(f"depth: expected an image of shape (H, W), got shape {image.shape}")
    info = to_camera_info(camera_info)
    height, width = image.shape
    # Drivers send rectified depth images, and depthimage_to_laserscan uses p.
    model = CameraModel(info, rectified=True, size=(width, height))
    first, last = _band(rows, height, float(model.middle[1]))
    rays = depth_rays(model)
    ahead = image[first:last] * np.float64(0.001 if image.dtype.kind in "ui" else 1.0)
    # In float32, as in the C++ code of the node.
    column = np.arange(width, dtype=np.float32) - np.float32(model.middle[0])
    aside = column * np.float32(1.0 / model.focus[0])
    with np.errstate(invalid="ignore"):  # infinity on the axis
        lengths = np.hypot(ahead * aside, ahead).astype(np.float32)
    is_seen = (np.float32(range_min) <= lengths) & (lengths <= np.float32(range_max))
    is_seen &= np.isfinite(lengths) & (lengths > 0)
    lengths = np.where(is_seen, lengths, np.float32(np.inf))
    row = lengths.argmin(axis=0)
    nearest = lengths[row, np.arange(width)]
    # The nearest reading of each ray is written last.
    order = np.argsort(-nearest, kind="stable")
    ranges, pixels = np.full(width, np.inf, np.float32), np.full(width, -1, np.int32)
    ranges[rays[order]] = nearest[order]
    pixels[rays[order]] = ((first + row) * width + np.arange(width))[order]
    pixels[np.isinf(ranges)] = -1
    # Sensors may send inf for things that are too far, which says more than NaN.
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
    """Return the index of the ray of `depth_scan` for each column of an image, shape (W,)."""
    width = model.size[0]
    start, step = _sweep(model)
    column = np.arange(width, dtype=np.float32) - np.float32(model.middle[0])
    angles = -np.arctan2(column.astype(np.float64) * np.float32(1.0 / model.focus[0]), 1.0)
    return np.clip(((angles - np.float64(start)) / np.float64(step)).astype(np.intp), 0, width - 1)


def _sweep(model: CameraModel) -> tuple[np.float32, np.float32]:
    """Return the first angle and the step, in float32 as in a message."""
    (width, _), (middle, _) = model.size, model.middle
    if width < 2:
        raise ValueError(f"depth: expected an image of 2 columns or more, got {width}")
    # The node uses unsigned angles between rays, so the optical axis has to be in the image.
    low, high = (
        np.float32(-abs(np.arctan((width - 1 - middle) / model.focus[0]))),
        np.float32(abs(np.arctan(middle / model.focus[0]))),
    )
    return low, np.float32((np.float64(high) - np.float64(low)) / (width - 1))


def _band(rows: int | tuple[int, int], height: int, axis: float) -> tuple[int, int]:
    """Return the first row and the row after the last."""
    if isinstance(rows, tuple):
        first, last = (int(row) for row in rows)
    else:
        # The node uses integer division, and truncates.
        first = int(axis - int(rows) // 2)
        last = first + int(rows)
    if not 0 <= first < last <= height:
        raise ValueError(f"rows: expected rows of an image of {height}, got {first} to {last}")
    return first, last
