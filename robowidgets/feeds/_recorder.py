"""Recording everything that a robot sends, the speeds that it gets, and the states and text of its program."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING

from ..messages.infrastructure import is_infrastructure
from ..notebook.cells import take_the_place
from ..recordings.live_writer import LiveWriter
from ..runtime.output_file import checked_output
from ..runtime.text import many
from ._tap import FeedTap, is_shown
from ._topics import FeedTopic

if TYPE_CHECKING:
    from ._connection import Connection

_MOST_NAMED = 12
"""The largest number of omitted topics that the text of a recorder names."""


class Recorder(FeedTap):
    """A file that records a feed until it is closed. `Feed.record` returns it.

    A thread that sends speeds never waits for the disk. As a context manager it closes the file at the end. Closing the
    feed or running its cell again closes the file, too.

    Args:
        connection: the connection of the feed.
        path: the file.
        topics: names of topics, or none for all topics that a widget shows.
        everything: True to record, without names, all topics with a known type.

    Attributes:
        path: the file.
        refresh: begins to record topics that have appeared. The feed calls it.
    """

    _writer: LiveWriter

    def __init__(
        self, connection: Connection, path: str | os.PathLike[str], topics: tuple[str, ...], everything: bool
    ) -> None:
        self._everything = everything
        self.path = checked_output("record", path, (".mcap",))
        self._left_out: tuple[str, ...] | None = None
        """The names of the topics that were omitted when it was closed, or None while it records."""
        try:
            writer = LiveWriter(self.path, self.close, connection.clock)
        except FileExistsError:
            raise FileExistsError(f"record(): {str(self.path)!r} exists; delete it, or name another file") from None
        super().__init__(connection, writer, topics)
        take_the_place(self)
        self._begin()

    @property
    def left_out(self) -> tuple[str, ...]:
        """The names of the published topics that this file does not contain, now or when it was closed."""
        if self._left_out is not None:
            return self._left_out
        topics = (topic.name for topic in self._connection.topics if topic.offered)
        return tuple(name for name in topics if name not in self._targets and not is_infrastructure(name))

    def close(self) -> None:
        """Complete the file. Calling it again does nothing. It waits for the disk for at most two seconds."""
        with self._lock:
            if self._closed:
                return
            self._closed, self._left_out = True, self.left_out
        self._leave()

    def __repr__(self) -> str:
        count = many(sum(self.written.values()), "message")
        lines = [f"{self.path}: {count}, {self._state}", *(f"⚠ {problem}" for problem in self.problems)]
        if not self._names and (left_out := self.left_out):
            more = ", …" if len(left_out) > _MOST_NAMED else ""
            names = f"{', '.join(left_out[:_MOST_NAMED])}{more}"
            lines.append(f"not recorded: {names} (everything=True records all topics)")
        return "\n".join(lines)

    @property
    def _state(self) -> str:
        if not self._closed:
            return "recording"
        if self._writer.is_complete:
            return "closed"
        return "incomplete" if self._writer.has_failed else "still being written"

    def _is_wanted(self, topic: FeedTopic) -> bool:
        if self._names:
            return topic.name in self._names
        return self._everything or is_shown(topic)
