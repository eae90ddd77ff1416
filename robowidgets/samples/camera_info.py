"""The calibration of a camera: the mapping from points in space to pixels."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .age import HasAge
from .checks import frozen

Floats = NDArray[np.float64]


class PixelBox(NamedTuple):
    """A part of a picture, in pixels of the whole picture. Width and height 0 mean the whole picture."""

    x_offset: int = 0
    y_offset: int = 0
    width: int = 0
    height: int = 0


ALL = PixelBox()


@dataclass(frozen=True, eq=False)
class CameraInfo(HasAge):
    """The calibration of a camera, for the whole picture of its sensor.

    The camera looks along z of its frame, with x to the right and y down (REP-103, a frame that ends in ``_optical``).
    The centre of the first pixel is at (0, 0).

    Args:
        width, height: pixels of the whole picture, before `binning` and `roi`, or 0 if unknown.
        k: the matrix of the raw picture, 9 numbers by rows; all 0 if the camera is not calibrated.
        d: the distortion coefficients, as many as the model has.
        r: the rotation from the camera to the rectified picture, 9 numbers; all 0 counts as no rotation.
        p: the matrix of the rectified picture, 12 numbers; all 0 counts as `k`.
        distortion_model: "plumb_bob", "rational_polynomial", "equidistant", or empty.
        binning: the number of sensor pixels per pixel of the picture, across and down.
        roi: the part of the sensor that the picture shows.
        stamp_ns: nanoseconds since the epoch, or None.
        frame_id: the coordinate frame of the camera.

    Raises:
        TypeError: a value is not a number.
        ValueError: a matrix has the wrong number of values, or a value is not finite.

    Source: sensor_msgs/CameraInfo.
    """

    width: int
    height: int
    k: Floats
    d: Floats = field(default_factory=lambda: np.empty(0))
    r: Floats = field(default_factory=lambda: np.zeros(9))
    p: Floats = field(default_factory=lambda: np.zeros(12))
    distortion_model: str = ""
    binning: tuple[int, int] = (1, 1)
    roi: PixelBox = ALL
    stamp_ns: int | None = None
    frame_id: str = ""

    def __post_init__(self) -> None:
        super().__post_init__()
        put = object.__setattr__
        for name, size in (("k", 9), ("d", None), ("r", 9), ("p", 12)):
            put(self, name, _numbers(name, getattr(self, name), size))
        for name in ("width", "height"):
            put(self, name, _count(name, getattr(self, name)))
        put(self, "binning", tuple(max(1, _count("binning", value)) for value in self.binning))
        put(self, "roi", PixelBox(*(_count("roi", value) for value in self.roi)))

    @property
    def is_calibrated(self) -> bool:
        """True if the camera is calibrated: `k` or `p` has focal lengths."""
        return bool(self.k[0] > 0 and self.k[4] > 0) or bool(self.p[0] > 0 and self.p[5] > 0)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height of the pictures after `roi` and `binning`, in pixels."""
        width, height = (self.roi.width, self.roi.height) if self.roi.width else (self.width, self.height)
        return width // self.binning[0], height // self.binning[1]


def _numbers(name: str, values: Any, size: int | None) -> Floats:
    try:
        array = np.array(values, np.float64).ravel()
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected an array of numbers, got {repr(values)[:60]}") from None
    if size is not None and array.size == 0:
        array = np.zeros(size)
    if size is not None and array.size != size:
        raise ValueError(f"{name}: expected {size} numbers, got {array.size}")
    if not np.isfinite(array).all():
        raise ValueError(f"{name}: expected finite numbers, got {array.tolist()}")
    return frozen(array)


def _count(name: str, value: Any) -> int:
    try:
        count = int(value)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"{name}: expected a number of pixels, got {value!r}") from None
    if count < 0:
        raise ValueError(f"{name}: expected pixels, 0 or more, got {count}")
    return count
