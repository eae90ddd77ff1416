"""One picture of a camera, with the number of every pixel."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from math import nan
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .age import HasAge, note_arrival
from .checks import frozen

MOST_PIXELS = 100_000_000
"""The limit for one picture; no camera has more."""

CHANNELS = {
    **dict.fromkeys(("rgb8", "rgb16"), "rgb"),
    **dict.fromkeys(("bgr8", "bgr16", "8UC3", "16UC3"), "bgr"),
    **dict.fromkeys(("rgba8", "rgba16"), "rgba"),
    **dict.fromkeys(("bgra8", "bgra16", "8UC4", "16UC4"), "bgra"),
    **dict.fromkeys(("yuv422", "uyvy", "yuv422_yuy2", "yuyv"), "yuv"),
}
"""The letters of the channels by encoding, in the order of the pixels. Other encodings number their channels."""

BAYER = ("bayer_rggb", "bayer_bggr", "bayer_gbrg", "bayer_grbg")


@dataclass(frozen=True, eq=False)
class Image(HasAge):
    """The pixels of one picture, as they were measured.

    ``image[row, column]`` is a pixel and ``image[120:180, 300:360]`` a region, as in an array of NumPy: row 0 is at the
    top, column 0 at the left.

    Args:
        values: shape (rows, columns), or (rows, columns, channels) in the order of the encoding; None for a compressed
            picture, whose pixels are unpacked on first use.
        encoding: a name of REP-118 or cv_bridge: "rgb8", "16UC1" ...
        stamp_ns: nanoseconds since the epoch, or None.
        frame_id: the coordinate frame of the camera: z points ahead, x to the right and y down.
        compressed: the JPEG or PNG as it came, or empty if the picture is not compressed.
        size: rows and columns of a compressed picture.
        unpack: returns the pixels of a compressed picture.
        depth_scale: metres per unit of a depth image, or 0 for other images.
        step: bytes of a row in the data of the message, or 0 without such data.
        is_gray: True if a compressed picture has one channel.

    Raises:
        ValueError: the picture has no pixels, or too many.

    Source: sensor_msgs/Image, REP-118.

    Examples:
        >>> image = Image(np.array([[0, 1500], [2000, 65535]], np.uint16), "16UC1", depth_scale=0.001)
        >>> image.depth[0].tolist(), image.distance(1, 0)
        ([nan, 1.5], 2.0)
    """

    values: NDArray[Any] | None
    encoding: str
    stamp_ns: int | None = None
    frame_id: str = ""
    compressed: bytes = field(default=b"", repr=False)
    size: tuple[int, int] = (0, 0)
    unpack: Callable[[bytes], NDArray[Any]] | None = field(default=None, repr=False)
    depth_scale: float = 0.0
    step: int = 0
    is_gray: bool = False

    def __post_init__(self) -> None:
        note_arrival(self)
        if self.values is not None:
            object.__setattr__(self, "values", frozen(np.asarray(self.values)))
            object.__setattr__(self, "size", self.values.shape[:2])
        rows, columns = self.size
        if not 0 < rows * columns <= MOST_PIXELS:
            raise ValueError(f"expected a picture of 1 to {MOST_PIXELS:,} pixels, got {rows} rows x {columns} columns")

    @property
    def shape(self) -> tuple[int, int]:
        """Rows and columns."""
        return self.size

    @cached_property
    def pixels(self) -> NDArray[Any]:
        """The `values`; a compressed picture is unpacked.

        Raises:
            ImportError: Pillow is needed to unpack it, and not installed. ValueError: the picture is damaged.
        """
        if self.values is not None:
            return self.values
        if self.unpack is None:
            raise ValueError("expected values, or a function in unpack")
        return frozen(self.unpack(self.compressed))

    @property
    def channels(self) -> tuple[str, ...]:
        """The names of the channels, or empty for a single channel without a name."""
        count = 1 if self.pixels.ndim == 2 else self.pixels.shape[2]
        return tuple(CHANNELS.get(self.encoding, "0123"[:count] if count > 1 else ""))

    @property
    def is_depth(self) -> bool:
        """True if the pixels are distances."""
        return self.depth_scale > 0

    @cached_property
    def depth(self) -> NDArray[np.float32]:
        """Metres along the optical axis of the camera, shape (rows, columns); NaN where nothing was measured.

        Raises:
            ValueError: this is not a depth image.
        """
        self._check_depth()
        return frozen(to_depth(self.pixels, self.depth_scale))

    def distance(self, row: int, column: int) -> float:
        """Return metres at a pixel of a depth image; NaN if nothing was measured. Negative indices count from the end.

        Raises:
            ValueError: this is not a depth image. IndexError: the pixel is outside the image.
        """
        self._check_depth()
        return float(to_depth(np.atleast_1d(self.pixels[row, column]), self.depth_scale)[0])

    def _check_depth(self) -> None:
        if not self.is_depth:
            raise ValueError(f"expected a depth image (16UC1 or 32FC1), got {self.encoding}")

    def __getitem__(self, where: Any) -> Any:
        return self.pixels[where]

    def __repr__(self) -> str:
        rows, columns = self.size
        packed = f", {len(self.compressed):,} bytes" if self.compressed else ""
        return f"<Image: {columns} x {rows} {self.encoding}{packed}>"


def to_depth(values: NDArray[Any], scale: float) -> NDArray[np.float32]:
    """Return depth values in metres; NaN for 0, which means "nothing", and for NaN, infinite or negative values."""
    metres = values.astype(np.float32)
    if scale != 1.0:
        # Computed in float64, so that 1500 mm become the float32 nearest to 1.5 m.
        metres = (values * np.float64(scale)).astype(np.float32)
    metres[~np.isfinite(metres) | (metres <= 0)] = nan
    return metres
