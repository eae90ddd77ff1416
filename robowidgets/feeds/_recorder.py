"""Writing what a robot sends, the speeds it gets, and the states and text of its program into an MCAP file."""

from __future__ import annotations

import logging
import os
import threading
import time
from collections import Counter
from contextlib import suppress
from functools import partial
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any

from .._core.cells import take_the_place
from .._core.coalesced_call import CoalescedCall
from .._core.output_file import checked_output
from .._core.tables import many
from ..behaviors.machine import Machine
from ..behaviors.program import ENDED, Version
from ..kinds import is_undecided
from ..messages import standard
from ..messages.channel import Channel
from ..recordings.program_log import PROGRAM, TEXT, program_text, state_topic
from ..repair.write import McapWriter
from ..samples import Scan, Speed, Touch
from ..samples.touch_tracker import TouchTracker
from ._encode import encode
from ._subscription import Target
from ._topics import YOURS, Topic, no_such
from .middleware import FeedError

if TYPE_CHECKING:
    from ._connection import Connection

log = logging.getLogger("robowidgets")

MOST_WAITING = 1000
"""Messages that wait to be written; when the disk is slower, more are dropped."""

FLUSH = 1.0
"""Seconds after which messages are in the file, where they are not lost when the process dies."""

CLOSE_TIMEOUT = 2.0
"""Seconds for which closing waits for what is still to be written."""


class Recorder:
    """A file that records a feed until it is closed; `Feed.record` returns it.

    Messages are written as those of ROS 2, with their definitions, in a thread of their own: what carries speeds never
    waits for the disk. As a context manager it closes the file; so do closing the feed, and running its cell again.

    Args:
        connection: that of the feed.
        path: the file.
        topics: names of topics; none: all that a widget shows.

    Attributes:
        path: the file.
        written: by topic, the number of messages that were written.
        refresh: begins to record topics that have appeared; the feed calls it.
    """

    def __init__(self, connection: Connection, path: str | os.PathLike[str], topics: tuple[str, ...]) -> None:
        self._connection, self._names = connection, topics
        self.path = checked_output("record", path, (".mcap",))
        self.written: Counter[str] = Counter()
        self._dropped: Counter[str] = Counter()
        self._unwritable: dict[str, str] = {}
        self._failed = ""
        self._targets: dict[str, Target] = {}
        self._touches: dict[str, TouchTracker] = {}
        self._version: Version | None = None
        self._states: dict[str, str] = {}
        self._lock = threading.Lock()
        """Held while the state of the program is compared, for microseconds."""
        self._closed = False
        # A clock that is set while it records moves no message.
        self._epoch_ns = time.time_ns() - time.monotonic_ns()
        self._queue: SimpleQueue[tuple[Topic, int, Any] | None] = SimpleQueue()
        try:
            self._file = self.path.open("xb")
        except FileExistsError:
            raise FileExistsError(f"record(): {str(self.path)!r} exists; delete it, or name another file") from None
        take_the_place(self)
        self._thread = threading.Thread(target=self._run, name="robowidgets-recorder", daemon=True)
        self._thread.start()
        self.refresh = CoalescedCall(self._refresh)
        connection.watch(self.refresh)
        connection.programs.watch(self._on_step)
        self.refresh()
        self._on_step()

    @property
    def closed(self) -> bool:
        """Whether it records no more."""
        return self._closed

    @property
    def problems(self) -> tuple[str, ...]:
        """What is missing in the file, one line each."""
        dropped = (
            f"{topic}: {many(count, 'message')} dropped, because writing did not keep up"
            for topic, count in list(self._dropped.items())
        )
        missing = (
            no_such(name, [t.name for t in self._connection.topics])
            for name in self._names
            if name not in self._targets
        )
        return tuple(filter(None, (self._failed, *dropped, *self._unwritable.values(), *missing)))

    def close(self) -> None:
        """Complete the file; doing it again does nothing. It waits for the disk for two seconds at most."""
        with self._lock:
            if self._closed:
                return
            self._closed = True
        self._detach()
        self._queue.put(None)
        if self._thread is not threading.current_thread():
            self._thread.join(CLOSE_TIMEOUT)
            if self._thread.is_alive():
                log.warning("%s: the disk is slow: the file is not complete yet", self.path)

    def __enter__(self) -> Recorder:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        count = many(sum(self.written.values()), "message")
        return "\n".join(
            (f"{self.path}: {count}, {'closed' if self._closed else 'recording'}", *(f"⚠ {p}" for p in self.problems))
        )

    # -- in the threads of the feed and of the program: they wait for nothing ------------------------------------------

    def _refresh(self) -> None:
        if self._connection.is_closed:
            self.close()
        for topic in () if self._closed else self._connection.topics:
            if topic.name not in self._targets and topic.type and self._is_wanted(topic):
                one = topic._replace(type=topic.type.split(", ")[0])
                try:
                    self._targets[topic.name] = self._connection.attach(topic.name, partial(self._take, one))
                except FeedError:  # closed meanwhile, of which it tells in a moment
                    return

    def _is_wanted(self, topic: Topic) -> bool:
        return topic.name in self._names if self._names else bool(topic.widget) or is_undecided(topic.type)

    def _take(self, topic: Topic, message: Any) -> None:
        if self._queue.qsize() < MOST_WAITING:
            self._queue.put((topic, self._now_ns(), message))
        else:
            self._dropped[topic.name] += 1

    def _on_step(self) -> None:
        """Note another version of the program, and the states that it is in now."""
        program = self._connection.programs.current
        if program is None or self._closed:
            return
        with self._lock:
            version, states = program.version, {}
            if isinstance(version.function, Machine) and program.mode != ENDED:
                states = {machine: name for machine, (name, _) in version.function.last_step.states.items()}
            if version is not self._version:
                self._version = version
                self._put_text(PROGRAM, self._now_ns(), program_text(program.name, version.number, version.text))
            now_ns = self._now_ns()
            for machine in sorted(self._states.keys() | states.keys()):
                if states.get(machine) != self._states.get(machine):
                    self._put_text(state_topic(machine), now_ns, states.get(machine, ""))
            self._states = states

    def _put_text(self, topic: str, now_ns: int, text: str) -> None:
        self._queue.put((Topic(topic, TEXT, None, False, True, None), now_ns, {"data": text}))

    def _now_ns(self) -> int:
        return self._epoch_ns + time.monotonic_ns()

    def _detach(self) -> None:
        self._connection.programs.forget(self._on_step)
        self._connection.forget(self.refresh)
        for topic, target in list(self._targets.items()):
            self._connection.detach(topic, target)

    # -- in the thread that writes -------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            with self._file:
                writer = McapWriter(self._file, {"cdr"})
                channels: dict[tuple[str, str], Channel] = {}
                flushed = time.monotonic()
                while True:
                    with suppress(Empty):
                        entry = self._queue.get(timeout=FLUSH)
                        if entry is None:
                            break
                        self._write(writer, channels, *entry)
                    if time.monotonic() > flushed + FLUSH:
                        writer.flush()
                        flushed = time.monotonic()
                writer.finish()
        except Exception as error:  # a full disk, above all
            self._failed = f"recording has ended: {getattr(error, 'strerror', None) or error}"
            log.error("%s: %s; the robot and its program go on", self.path, self._failed)
            self.close()
        if self._dropped:
            log.warning("%s: %s dropped", self.path, many(sum(self._dropped.values()), "message"))

    def _write(
        self, writer: McapWriter, channels: dict[tuple[str, str], Channel], topic: Topic, time_ns: int, message: Any
    ) -> None:
        type_name, fields = self._standard(topic, message, time_ns)
        try:
            data = encode("cdr", type_name, fields)
        except ValueError as error:
            if topic.name not in self._unwritable:
                self._unwritable[topic.name] = f"{topic.name} cannot be recorded: {error}"
                log.warning("%s: %s", self.path, self._unwritable[topic.name])
            return
        channel = channels.get((topic.name, type_name))
        if channel is None:
            # A topic of ROS has no blanks in its name.
            channel = Channel(len(channels), topic.name.replace(YOURS, "_by_program"), type_name, "cdr", "", 0)
            channels[topic.name, type_name] = channel
            writer.register(channel)
        writer.add(channel, time_ns, data)
        self.written[topic.name] += 1

    def _standard(self, topic: Topic, message: Any, time_ns: int) -> tuple[str, Any]:
        """The type and the fields of a message; those of a standard type for a sample."""
        if isinstance(message, Scan):
            return standard.LASER_SCAN, standard.scan_fields(message, time_ns)
        if isinstance(message, Speed):
            return standard.speed_message(message, time_ns, topic.type)
        if isinstance(message, Touch):
            touches = self._touches.setdefault(topic.name, TouchTracker())
            touches.apply(message, time_ns)
            return standard.CONTACTS, standard.contact_fields(touches, time_ns)
        return topic.type, message
