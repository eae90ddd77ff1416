"""Taking everything that a robot sends, the speeds that it gets, and the states and text of its program."""

from __future__ import annotations

import threading
from abc import ABC, abstractmethod
from collections import Counter
from functools import partial
from typing import TYPE_CHECKING, Any, TypeVar

from ..behaviors.machine import Machine
from ..behaviors.program import ENDED
from ..behaviors.version import Version
from ..kinds import is_undecided
from ..recordings.gaps import Gaps
from ..recordings.live_writer import QueuedWriter
from ..recordings.program_log import ASSISTANT, PROGRAM, TEXT, program_text, state_topic
from ..runtime.coalesced_call import CoalescedCall
from ..runtime.text import many
from ._subscription import Target
from ._topics import YOURS, FeedTopic, no_such
from .middleware import FeedError, HasOutlet

if TYPE_CHECKING:
    from ._connection import Connection


T = TypeVar("T", bound="FeedTap")


class FeedTap(ABC):
    """The messages of some topics of a feed, and the texts of its program, as they come, for a writer.

    Args:
        connection: the connection of the feed.
        writer: gets them. Its methods never wait.
        topics: names of topics, or none for topics that the subclass chooses.

    Attributes:
        refresh: takes topics that have appeared. The feed calls it.
    """

    def __init__(self, connection: Connection, writer: QueuedWriter, topics: tuple[str, ...]) -> None:
        self._connection, self._writer, self._names = connection, writer, topics
        self._targets: dict[str, Target] = {}
        self._missed: Counter[str] = Counter()
        """By topic, the number of messages that did not arrive here."""
        # A simulated robot and a recording lose no messages in transit.
        self._gaps: dict[str, Gaps] | None = {} if isinstance(connection.middleware, HasOutlet) else None
        self._reported = max((number for number, _ in [*connection.programs.reports]), default=-1)
        """The number of the last report that was taken, or that came before."""
        self._version: Version | None = None
        self._states: dict[str, str] = {}
        self._lock = threading.Lock()
        """Held for microseconds, while the state of the program is compared."""
        self._closed = False
        self.refresh = CoalescedCall(self._refresh)

    @property
    def closed(self) -> bool:
        """True once it takes no more. The end of the file may still be unwritten."""
        return self._closed

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

    @abstractmethod
    def close(self) -> None:
        """Take no more. Calling it again does nothing. It waits for the disk for at most two seconds."""

    def __enter__(self: T) -> T:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _begin(self) -> None:
        self._writer.start()
        self._connection.observe(self.refresh)
        self._connection.programs.observe(self._on_step)
        self.refresh()
        self._on_step()

    def _leave(self) -> None:
        """End the subscriptions, and complete the file."""
        self._connection.programs.unobserve(self._on_step)
        self._connection.unobserve(self.refresh)
        for topic, target in list(self._targets.items()):
            self._connection.detach(topic, target)
        self._writer.close()

    # -- in the threads of the feed and of the program: they never wait ------------------------------------------------

    @abstractmethod
    def _is_wanted(self, topic: FeedTopic) -> bool:
        """Return True if a topic is to be taken."""

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

    def _take(self, name: str, type_name: str, message: Any) -> None:
        if self._gaps is not None:
            self._gaps.setdefault(name, Gaps()).see(message)
        self._writer.add(name, type_name, self._writer.now_ns(), message)

    def _miss(self, name: str, count: int) -> None:
        self._missed[name] += count

    def _on_step(self) -> None:
        """Take commands of assistants, a new version of the program, and changes of its states."""
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


def is_shown(topic: FeedTopic) -> bool:
    """Return True if a widget can show a topic, or if only its messages will decide that."""
    return bool(topic.widget) or is_undecided(topic.type)
