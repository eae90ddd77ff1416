"""Lines and surfaces in the frame of a camera, projected to its picture."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from .model import CameraModel

Floats = NDArray[np.float64]

_NEAR = 0.02
"""Metres ahead of the camera up to which nothing is drawn."""

_MARGIN = 0.1
"""Margin around the picture that is drawn too, as a part of its size."""

_PIECE = 0.04
"""The longest straight piece of a line that a lens bends, in units of the distance ahead."""

_MOST_PIECES = 200


class Outlines:
    """Projects the visible part of lines and surfaces by a camera model, with a margin around the picture."""

    def __init__(self, model: CameraModel) -> None:
        self._model = model
        width, height = model.size
        across, down = width * _MARGIN, height * _MARGIN
        x, y = np.linspace(-across, width + across, 21), np.linspace(-down, height + down, 21)
        edge = np.concatenate(
            [
                *(np.column_stack([x, np.full(21, row)]) for row in (y[0], 0.0, height - 1.0, y[-1])),
                *(np.column_stack([np.full(21, column), y]) for column in (x[0], 0.0, width - 1.0, x[-1])),
            ]
        )
        rays = model.rays(edge)
        rays = rays[np.isfinite(rays).all(axis=1)]
        (left, top, _), (right, bottom, _) = rays.min(axis=0), rays.max(axis=0)
        # A point p is in view if all n.p + c of these are 0 or more.
        self._normals = np.array([[0, 0, 1], [1, 0, -left], [-1, 0, right], [0, 1, -top], [0, -1, bottom]], np.float64)
        self._offsets = np.array([-_NEAR, 0.0, 0.0, 0.0, 0.0])

    def surface(self, corners: Floats) -> Floats:
        """Return the pixels of the outline of a surface, shape (N, 2), in one piece, or empty if it is out of view.

        Args:
            corners: metres in the frame of the camera, shape (M, 3).
        """
        points = corners + self._model.shift
        for normal, offset in zip(self._normals, self._offsets, strict=True):
            if not len(points):
                break
            points = _cut(points, points @ normal + offset)
        return self._pixels(points, is_closed=True)

    def line(self, places: Floats) -> list[Floats]:
        """Return the pixels of the visible pieces of a line, shape (N, 2) each.

        Args:
            places: metres in the frame of the camera, shape (M, 3).
        """
        points = places + self._model.shift
        starts, ends = points[:-1], points[1:]
        low, high = np.zeros(len(starts)), np.ones(len(starts))
        for normal, offset in zip(self._normals, self._offsets, strict=True):
            before, after = starts @ normal + offset, ends @ normal + offset
            with np.errstate(all="ignore"):
                at = before / (before - after)
            low = np.where(before < 0, np.maximum(low, np.where(after < 0, np.inf, at)), low)
            high = np.where((after < 0) & (before >= 0), np.minimum(high, at), high)
        pieces: list[list[Floats]] = []
        last_end = 0.0
        for start, end, a, b in zip(starts, ends, low.tolist(), high.tolist(), strict=True):
            if not a < b:
                last_end = 0.0
                continue
            if last_end < 1.0 or a > 0.0:
                pieces.append([start + a * (end - start)])
            pieces[-1].append(start + b * (end - start))
            last_end = b
        return [self._pixels(np.array(piece), is_closed=False) for piece in pieces]

    def _pixels(self, points: Floats, *, is_closed: bool) -> Floats:
        """Return the pixels of the points that the lens shows, with points between them if it bends straight lines."""
        if not len(points):
            return np.empty((0, 2))
        if self._model.bends:
            points = _finer(points, is_closed=is_closed)
        pixels = self._model.project(points - self._model.shift, beyond=True)
        return pixels[np.isfinite(pixels).all(axis=1)]


def _cut(points: Floats, side: Floats) -> Floats:
    """Return a surface without the part that is behind a plane, where `side` is below 0 (Sutherland and Hodgman)."""
    after, next_side = np.roll(points, -1, axis=0), np.roll(side, -1)
    is_in = side >= 0
    crosses = is_in != (next_side >= 0)
    with np.errstate(all="ignore"):
        share = np.where(crosses, side / (side - next_side), 0.0)
    cuts = points + share[:, None] * (after - points)
    # For each corner: itself, if it is in view, and the point at which the edge after it crosses the plane.
    both = np.stack([points, cuts], axis=1).reshape(-1, 3)
    kept: Floats = both[np.stack([is_in, crosses], axis=1).ravel()]
    return kept


def _finer(points: Floats, *, is_closed: bool) -> Floats:
    """Return the points of a line with points between them, so that each piece looks short."""
    after = np.roll(points, -1, axis=0) if is_closed else points[1:]
    before = points if is_closed else points[:-1]
    seen = np.abs(after[:, :2] / after[:, 2:] - before[:, :2] / before[:, 2:]).max(axis=1, initial=0.0)
    counts = np.clip(np.ceil(seen / _PIECE), 1, _MOST_PIECES).astype(int)
    which = np.repeat(np.arange(len(counts)), counts)
    share = (np.arange(len(which)) - np.repeat(counts.cumsum() - counts, counts)) / counts[which]
    finer = before[which] + share[:, None] * (after[which] - before[which])
    return finer if is_closed else np.vstack([finer, points[-1:]])
