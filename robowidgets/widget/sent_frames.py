"""A copy in Python of the frames that the page of a notebook keeps, for a page in a file."""

from __future__ import annotations

from collections import deque
from typing import Any

from .timed_frame import TimedFrame

PER_SECOND = 20
"""Frames kept for each second of history. A faster source fills them in less time. The page has the same rule."""

MOST_BYTES = 8_000_000
"""The most bytes of frames that are kept. The page has the same rule."""


class SentFrames:
    """The last frames that were sent to the page, oldest first; they are shared with the traits, not copied."""

    def __init__(self) -> None:
        self._frames: deque[TimedFrame] = deque()
        self._bytes = 0

    def add(self, sent: TimedFrame, seconds: float) -> None:
        """Add a frame, and drop frames that are beyond a history of so many seconds."""
        frames = self._frames
        frames.append(sent)
        self._bytes += len(sent.frame)
        while frames and (
            len(frames) > PER_SECOND * seconds or self._bytes > MOST_BYTES or sent.seconds - frames[0].seconds > seconds
        ):
            self._bytes -= len(frames.popleft().frame)

    def __iter__(self) -> Any:
        return iter(tuple(self._frames))
