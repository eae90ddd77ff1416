"""Frames, with their header and their times, for pages that play."""

from __future__ import annotations

import struct
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

FRAME_HEADER = struct.Struct("<ddqd")
"""Each frame starts with its sequence number, samples per second (NaN if unknown), the stamp in ns (0 without one), and
its time of arrival in seconds of Python's monotonic clock."""


class TimedFrame(NamedTuple):
    """A frame with its time, the texts on the sample, and its bytes, which docs/developers/frames.md describes.

    ``seconds`` counts from the start of a recording, and is negative before the first measurement. For a frame that was
    sent, it is the time at which its sample arrived, by the monotonic clock.
    """

    seconds: float
    about: dict[str, Any]
    frame: bytes


def table_of(frames: Sequence[TimedFrame]) -> tuple[list[dict[str, Any]], NDArray[np.float64]]:
    """Return the distinct texts of frames, and a row for each frame: its time, the index of its texts, and its end.

    The rows have shape (N, 3). The end is in bytes from the start of the first frame.
    """
    abouts: list[dict[str, Any]] = []
    rows = np.zeros((len(frames), 3))
    end = 0
    for row, timed in zip(rows, frames, strict=True):
        if timed.about not in abouts:
            abouts.append(timed.about)
        end += len(timed.frame)
        row[:] = timed.seconds, abouts.index(timed.about), end
    return abouts, rows
