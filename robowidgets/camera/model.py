"""Projection of points in the frame of a camera to the pixels of its picture, and back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..samples.camera_info import CameraInfo

Floats = NDArray[np.float64]

_STEPS = 60
"""The most steps to undo a distortion."""

_CLOSE = 1e-6
"""The largest error of an undone distortion at its pixel, in units of the focal length."""

FISHEYE = ("equidistant", "fisheye")
"""Names of the distortion model of fisheye lenses, which has 4 coefficients."""

_WIDEST = 10.0
"""Tangent of the largest angle from the axis for which a lens is modelled: 84 degrees."""


class CameraModel:
    """The projection of a camera by its calibration, in pixels of its pictures.

    Pixels are (column, row), and the centre of the first pixel is (0, 0), as in OpenCV. Points are in metres in the
    frame of the camera: x to the right, y down, z ahead (REP-103).

    Args:
        info: the calibration.
        rectified: True for a rectified picture (``image_rect``), in which straight lines are straight; False for a
            picture as the lens shows it (``image_raw``).
        size: width and height of the picture, if it is a scaled copy of the calibrated picture.

    Attributes:
        size: width and height of the picture in pixels.
        focus: the focal lengths across and down, in pixels.
        shift: metres that are added to points, because the second camera of a stereo pair is not at the origin.
        bends: True if straight lines are not straight in the picture.
        middle: the principal point, a pixel.

    Raises:
        ValueError: the camera is not calibrated, its distortion model is unknown, or the calibration is for another
            picture.

    Source: sensor_msgs/CameraInfo, image_geometry, OpenCV (calib3d, fisheye).

    Examples:
        >>> model = CameraModel(CameraInfo(640, 480, [500, 0, 319.5, 0, 500, 239.5, 0, 0, 1]))
        >>> model.project([[0.0, 0.0, 2.0], [1.0, 0.0, 2.0], [0.0, 0.0, -2.0]]).tolist()
        [[319.5, 239.5], [569.5, 239.5], [nan, nan]]
        >>> model.points([[569.5, 239.5]], 2.0).tolist()
        [[1.0, 0.0, 2.0]]
    """

    def __init__(self, info: CameraInfo, *, rectified: bool = False, size: tuple[int, int] | None = None) -> None:
        if not info.is_calibrated:
            raise ValueError(
                "the camera is not calibrated: k of its camera_info is all 0; calibrate it with camera_calibration"
            )
        self.info = info
        k, p = (np.array(matrix).reshape(3, -1) for matrix in (info.k, info.p))
        if not p[0, 0]:
            p = np.column_stack([k, np.zeros(3)])
        elif not k[0, 0]:
            k = p[:, :3]
        self.size = size or info.size
        expected = info.size
        scale = np.ones(2) if 0 in expected else np.array(self.size) / expected
        if abs(scale[0] * expected[1] - scale[1] * expected[1]) > 1:
            raise ValueError(
                "camera_info is for another picture: of {} x {} pixels, and this one has {} x {}".format(
                    *expected, *self.size
                )
            )
        # The second camera of a stereo pair is shifted from the origin of the frame, and turned by r.
        self.shift = np.array([p[0, 3] / p[0, 0], p[1, 3] / p[1, 1], 0.0])
        turn = np.array(info.r).reshape(3, 3)
        self._turn = turn if turn.any() and not rectified else np.eye(3)
        self._distort: Distort = _same
        self._undistort: Distort = _same
        self._widest = np.inf
        # An ideal fisheye lens bends straight lines even if all its coefficients are 0.
        is_fisheye = info.distortion_model in FISHEYE and info.d.size == 4
        self.bends = bool(not rectified and (info.d.any() or is_fisheye))
        if self.bends:
            self._distort, self._widest = _lens(info)
            self._undistort = self._undone
        self.focus, self.middle = _in_picture(p if rectified else k, info, scale)

    def project(self, points: ArrayLike, *, beyond: bool = False) -> Floats:
        """Return the pixels of points, shape (N, 2); NaN for points behind the camera or outside the picture.

        Args:
            points: metres in the frame of the camera, shape (N, 3).
            beyond: True to return pixels outside the picture too, up to the limits of the lens.
        """
        x, y, z = ((np.asarray(points, np.float64).reshape(-1, 3) + self.shift) @ self._turn).T
        with np.errstate(all="ignore"):
            ideal = np.array([x / z, y / z])
            ideal[:, ~((z > 0) & (np.hypot(*ideal) < self._widest))] = np.nan
            pixels: Floats = self._distort(ideal).T * self.focus + self.middle
            is_in = ((pixels >= -0.5) & (pixels < np.array(self.size) - 0.5)).all(axis=1)
        if not beyond:
            pixels[~is_in] = np.nan
        return pixels

    def rays(self, pixels: ArrayLike) -> Floats:
        """Return the points 1 m ahead that pixels, shape (N, 2), show, shape (N, 3); NaN beyond the lens."""
        ideal = self._undistort((np.asarray(pixels, np.float64).reshape(-1, 2) - self.middle).T / self.focus[:, None])
        turned = np.vstack([ideal, np.ones(ideal.shape[1])]).T @ self._turn.T
        with np.errstate(all="ignore"):
            rays: Floats = np.where(turned[:, 2:] > 0, turned / turned[:, 2:], np.nan)
            return rays

    def points(self, pixels: ArrayLike, depth: ArrayLike) -> Floats:
        """Return the points, shape (N, 3), at pixels, shape (N, 2), with depths in metres (REP-118), shape (N,)."""
        ahead = np.broadcast_to(np.asarray(depth, np.float64), (len(np.reshape(pixels, (-1, 2))),))
        found: Floats = self.rays(pixels) * ahead[:, None] - self.shift
        return found

    @property
    def view(self) -> tuple[float, float]:
        """The fields of view in radians: from the left to the right edge, and from the upper to the lower edge."""
        (width, height), (column, row) = self.size, self.middle
        ends = [(-0.5, row), (width - 0.5, row), (column, -0.5), (column, height - 0.5)]
        left, right, top, bottom = self.rays(ends)
        across = np.arctan2(right[0], right[2]) - np.arctan2(left[0], left[2])
        return float(across), float(np.arctan2(bottom[1], bottom[2]) - np.arctan2(top[1], top[2]))

    def _undone(self, distorted: Floats) -> Floats:
        """Return undistorted coordinates by Newton's method with limited steps, or NaN if it does not converge."""
        with np.errstate(all="ignore"):
            ideal = distorted.copy()
            radius = np.hypot(*ideal)
            ideal *= np.minimum(1.0, 0.9 * self._widest / np.maximum(radius, 1e-12))
            for _ in range(_STEPS):
                off = self._distort(ideal) - distorted
                if not (np.abs(off) > _CLOSE * 1e-6).any():
                    break
                ideal = self._step(ideal, off)
            off = np.hypot(*(self._distort(ideal) - distorted))
            found: Floats = np.where((off < _CLOSE) & (np.hypot(*ideal) <= self._widest), ideal, np.nan)
            return found

    def _step(self, ideal: Floats, off: Floats) -> Floats:
        small = 1e-7
        here = self._distort(ideal)
        by_x = (self._distort(ideal + np.array([[small], [0.0]])) - here) / small
        by_y = (self._distort(ideal + np.array([[0.0], [small]])) - here) / small
        det = by_x[0] * by_y[1] - by_y[0] * by_x[1]
        step = np.array([off[0] * by_y[1] - off[1] * by_y[0], off[1] * by_x[0] - off[0] * by_x[1]]) / det
        length = np.hypot(*step)
        nearer: Floats = ideal - step * np.minimum(1.0, 0.5 * (1.0 + np.hypot(*ideal)) / np.maximum(length, 1e-12))
        return nearer


def _in_picture(matrix: Floats, info: CameraInfo, scale: Floats) -> tuple[Floats, Floats]:
    """Return the focal lengths and the principal point of a matrix, in pixels of the received pictures."""
    binning, offset = np.array(info.binning, np.float64), np.array(info.roi[:2], np.float64)
    focus = np.array([matrix[0, 0], matrix[1, 1]]) / binning * scale
    middle = (np.array([matrix[0, 2], matrix[1, 2]]) - offset) / binning
    return focus, (middle + 0.5) * scale - 0.5


def _same(ideal: Floats) -> Floats:
    return ideal


Distort = Callable[[Floats], Floats]
"""A function from undistorted to distorted coordinates, shape (2, N), in units of the focal length."""


def _lens(info: CameraInfo) -> tuple[Distort, float]:
    """Return the distortion of a lens, and the radius up to which it is valid: beyond, its formula folds back."""
    name, d = info.distortion_model, info.d
    if name in ("", "plumb_bob", "rational_polynomial") and d.size in (4, 5, 8):
        k1, k2, p1, p2, k3, k4, k5, k6 = np.pad(d, (0, 8 - d.size))

        def along(r2: Floats) -> Floats:
            above, below = ((a * r2 + b) * r2 + c for a, b, c in ((k3, k2, k1), (k6, k5, k4)))
            factor: Floats = (1 + above * r2) / (1 + below * r2)
            return factor

        def distort(ideal: Floats) -> Floats:
            x, y = ideal
            r2 = x * x + y * y
            factor = along(r2)
            return np.array(
                [
                    x * factor + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
                    y * factor + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
                ]
            )

        return distort, _monotone(lambda radius: radius * along(radius * radius))
    if name in FISHEYE and d.size == 4:

        def bend(radius: Floats) -> Floats:
            theta = np.arctan(radius)
            t2 = theta * theta
            bent: Floats = theta * (1 + t2 * (d[0] + t2 * (d[1] + t2 * (d[2] + t2 * d[3]))))
            return bent

        def distort_fisheye(ideal: Floats) -> Floats:
            radius = np.hypot(*ideal)
            return np.where(radius > 0, ideal * (bend(radius) / np.where(radius > 0, radius, 1.0)), ideal)

        return distort_fisheye, _monotone(bend)
    raise ValueError(
        f"distortion_model {name!r} with {d.size} numbers is not supported: expected plumb_bob (5), "
        "rational_polynomial (8) or equidistant (4); a rectified picture does not need one"
    )


def _monotone(at: Callable[[Floats], Floats]) -> float:
    """Return the radius up to which a distortion increases."""
    radii = np.linspace(0.0, _WIDEST, 20_001)
    with np.errstate(all="ignore"):
        grows = np.diff(at(radii)) > 0
    return _WIDEST if grows.all() else float(radii[np.argmin(grows)])
