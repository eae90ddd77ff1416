"""Writing a widget as a page in a file, with the samples that the page of the notebook keeps, too."""

from __future__ import annotations

import os
from collections import deque
from importlib import import_module
from pathlib import Path
from typing import Any

from .output_file import checked_output
from .timed_frame import TimedFrame

PER_SECOND = 20
"""Frames kept for each second of history; a faster source fills it in less time. The page has the same rule."""

MOST_BYTES = 8_000_000
"""Most bytes of frames that are kept. The page has the same rule."""

PAGES = "robowidgets.export.widget_page"
"""Makes the pages. Named as entry points do: it lies in a layer above the widgets."""


class SentFrames:
    """The last frames that were sent to the page, oldest first; they are shared with the traits, not copied."""

    def __init__(self) -> None:
        self._frames: deque[TimedFrame] = deque()
        self._bytes = 0

    def add(self, sent: TimedFrame, seconds: float) -> None:
        """Add a frame, and forget those that a history of so many seconds does not hold."""
        frames = self._frames
        frames.append(sent)
        self._bytes += len(sent.frame)
        while frames and (
            len(frames) > PER_SECOND * seconds or self._bytes > MOST_BYTES or sent.seconds - frames[0].seconds > seconds
        ):
            self._bytes -= len(frames.popleft().frame)

    def __iter__(self) -> Any:
        return iter(tuple(self._frames))


class WritesPage:
    """A widget that can be written as a page. Subclasses implement `sent_frames`."""

    def to_html(self, path: str | os.PathLike[str], *, title: str = "", note: str = "") -> Path:
        """Write a page with the widget as it is, and its history to play: one file, without a kernel or the web.

        Args:
            path: the file, such as ``"wall.html"``; an existing one is replaced.
            title: of the page; empty: the title of the widget.
            note: a text under the title, which is shown as it is.

        Returns:
            The path of the file.

        Raises:
            TypeError: no path. ValueError: a name that does not end in .html. OSError: the file cannot be written.

        Example:
            >>> laser.to_html("wall.html", note="The reading that it stopped for.")  # doctest: +SKIP
        """
        target = checked_output("to_html", path, (".html", ".htm"))
        written: Path = import_module(PAGES).write(self, target, title, note)
        return written

    def sent_frames(self) -> list[TimedFrame]:
        """The frames of its history, oldest first; the last one is that of the newest sample."""
        raise NotImplementedError
