"""Recording everything that a robot sends, the speeds that it gets, and the states and text of its program."""

from __future__ import annotations

import os
import threading
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any

from ..behaviors.machine import Machine
from ..behaviors.program import ENDED
from ..behaviors.version import Version
from ..kinds import is_undecided
from ..messages.infrastructure import is_infrastructure
from ..notebook.cells import take_the_place
from ..recordings.gaps import Gaps
from ..recordings.live_writer import LiveWriter
from ..recordings.program_log import ASSISTANT, PROGRAM, TEXT, program_text, state_topic
from ..runtime.coalesced_call import CoalescedCall
from ..runtime.output_file import checked_output
from ..runtime.text import many
from ._subscription import Target
from ._topics import YOURS, FeedTopic, no_such
from .middleware import FeedError, HasOutlet

if TYPE_CHECKING:
    from ._connection import Connection

_MOST_NAMED = 12
"""The largest number of omitted topics that the text of a recorder names."""


class Recorder:
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

    def __init__(
        self, connection: Connection, path: str | os.PathLike[str], topics: tuple[str, ...], everything: bool
    ) -> None:
        self._connection, self._names, self._everything = connection, topics, everything
        self.path = checked_output("record", path, (".mcap",))
        self._targets: dict[str, Target] = {}
        self._missed: Counter[str] = Counter()
        """By topic, the number of messages that did not arrive here."""
        # A simulated robot and a recording lose no messages in transit.
        self._gaps: dict[str, Gaps] | None = {} if isinstance(connection.middleware, HasOutlet) else None
        self._reported = max((number for number, _ in [*connection.programs.reports]), default=-1)
        """The number of the last report that was recorded, or that came before."""
        self._version: Version | None = None
        self._states: dict[str, str] = {}
        self._lock = threading.Lock()
        """Held for microseconds, while the state of the program is compared."""
        self._closed = False
        self._left_out: tuple[str, ...] | None = None
        """The names of the topics that were omitted when it was closed, or None while it records."""
        self.refresh = CoalescedCall(self._refresh)
        try:
            self._writer = LiveWriter(self.path, self.close, connection.clock)
        except FileExistsError:
            raise FileExistsError(f"record(): {str(self.path)!r} exists; delete it, or name another file") from None
        take_the_place(self)
        self._writer.start()
        connection.observe(self.refresh)
        connection.programs.observe(self._on_step)
        self.refresh()
        self._on_step()

    @property
    def closed(self) -> bool:
        """True once it records no more. The end of the file may still be unwritten, as the recorder's text shows."""
        return self._closed

    @property
    def left_out(self) -> tuple[str, ...]:
        """The names of the published topics that this file does not contain, now or when it was closed."""
        if self._left_out is not None:
            return self._left_out
        topics = (topic.name for topic in self._connection.topics if topic.offered)
        return tuple(name for name in topics if name not in self._targets and not is_infrastructure(name))

    @property
    def written(self) -> Counter[str]:
        """By topic, the number of messages that were written."""
        return self._writer.written

    @property
    def problems(self) -> tuple[str, ...]:
        """The problems of the file and what it lacks, one line each."""
        there = [topic.name for topic in self._connection.topics]
        missing = (no_such(name, there) for name in self._names if name not in self._targets)
        missed = (
            f"{name}: {many(count, 'message')} lost on the way, or came faster than {'it' if count == 1 else 'they'} "
            "could be read"
            for name, count in list(self._missed.items())
        )
        gaps = (
            f"{name}: {many(count, 'message')} missing, by "
            f"{'their numbers' if one.by_number else 'the pace of the others'}"
            for name, one in list((self._gaps or {}).items())
            if (count := one.missing - self._missed[name]) > 0
        )
        unread = filter(None, map(self._connection.trouble_of, list(self._targets)))
        return (*self._writer.problems, *missed, *gaps, *missing, *unread)

    def close(self) -> None:
        """Complete the file. Calling it again does nothing. It waits for the disk for at most two seconds."""
        with self._lock:
            if self._closed:
                return
            self._closed, self._left_out = True, self.left_out
        self._connection.programs.unobserve(self._on_step)
        self._connection.unobserve(self.refresh)
        for topic, target in list(self._targets.items()):
            self._connection.detach(topic, target)
        self._writer.close()

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

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

    # -- in the threads of the feed and of the program: they never wait ------------------------------------------------

    def _refresh(self) -> None:
        if self._connection.is_closed:
            self.close()
        for topic in () if self._closed else self._connection.topics:
            if topic.name not in self._targets and topic.type and self._is_wanted(topic):
                # A ROS topic has one type, and no spaces in its name.
                name, type_name = topic.name.replace(YOURS, "_by_program"), topic.type.split(", ")[0]
                take = partial(self._take, name, type_name)
                try:
                    miss = partial(self._miss, name)
                    self._targets[topic.name] = self._connection.attach(topic.name, take, miss)
                except FeedError:  # the feed was closed in the meantime, and will report it
                    return

    def _is_wanted(self, topic: FeedTopic) -> bool:
        if self._names:
            return topic.name in self._names
        return self._everything or bool(topic.widget) or is_undecided(topic.type)

    def _take(self, name: str, type_name: str, message: Any) -> None:
        if self._gaps is not None:
            self._gaps.setdefault(name, Gaps()).see(message)
        self._writer.add(name, type_name, self._writer.now_ns(), message)

    def _miss(self, name: str, count: int) -> None:
        self._missed[name] += count

    def _on_step(self) -> None:
        """Record commands of assistants, a new version of the program, and changes of its states."""
        if self._closed:
            return
        programs = self._connection.programs
        with self._lock:
            for number, text in list(programs.reports):
                if number > self._reported:
                    self._reported = number
                    self._put_text(ASSISTANT, self._writer.now_ns(), text)
        program = programs.current
        if program is None:
            return
        with self._lock:
            version, states = program.version, {}
            if isinstance(version.function, Machine) and program.mode != ENDED:
                states = {machine: name for machine, (name, _) in version.function.last_step.states.items()}
            now_ns = self._writer.now_ns()
            if version is not self._version:
                self._version = version
                self._put_text(PROGRAM, now_ns, program_text(program.name, version.number, version.text))
            for machine in sorted(self._states.keys() | states.keys()):
                if states.get(machine) != self._states.get(machine):
                    self._put_text(state_topic(machine), now_ns, states.get(machine, ""))
            self._states = states

    def _put_text(self, topic: str, now_ns: int, text: str) -> None:
        self._writer.add(topic, TEXT, now_ns, {"data": text}, can_be_dropped=False)
