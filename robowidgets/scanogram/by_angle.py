"""Mapping scans with several geometries to the rays of one of them, by angle."""

from __future__ import annotations

from math import copysign, pi

import numpy as np
from numpy.typing import NDArray

from .scans import Sweep


def rays_at(of: Sweep, on: Sweep) -> NDArray[np.int64]:
    """Return for each ray of ``on`` the index of the nearest ray of ``of``, or -1 if no ray points there.

    A ray covers half a step on either side.
    """
    step = abs(of.angle_increment) or abs(on.angle_increment)
    angles = on.angle_min + np.arange(on.ray_count) * on.angle_increment
    ahead = (angles - of.angle_min) * copysign(1.0, of.angle_increment) + step / 2
    known = (ahead >= 0) & (ahead < of.ray_count * step)
    # An angle outside of the sweep may lie in it a full turn later.
    index = np.floor(np.where(known, ahead, ahead % (2 * pi)) / (step or 1.0)).astype(np.int64)
    index[index >= of.ray_count] = -1
    return index


def keeps_indices(rays: NDArray[np.int64]) -> bool:
    """Return True if each mapped ray keeps its index."""
    return bool(((rays == np.arange(rays.size)) | (rays < 0)).all())


def on_rays(ranges: NDArray[np.float32], rays: NDArray[np.int64]) -> NDArray[np.float32]:
    """Return ranges in metres, shape (N, R), on the rays of another sweep, shape (N, rays); NaN if no ray fits."""
    if not ranges.shape[1]:
        return np.full((len(ranges), rays.size), np.nan, np.float32)
    return np.where(rays >= 0, ranges[:, rays], np.float32(np.nan))
