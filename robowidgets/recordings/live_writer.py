"""Writing an MCAP file while its messages come, in a thread of its own."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter, deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from .._core.clock import Clock, Left, Threads, Ticket
from .._core.text import many
from .._core.waiters import Waiters
from ..kinds import kind_of_sample
from ..messages.channel import Channel
from ..messages.decoding import channel_of, store_of
from ..messages.encoding import encode
from ..messages.standard import ToMessage, mount_message
from ..repair.write import McapWriter

log = logging.getLogger("robowidgets")

MOST_WAITING = 1000
"""Messages of one topic that wait to be written; if writing does not keep up, further ones are dropped."""

FLUSH = 1.0
"""Seconds after which messages are in the file, where they are not lost when the process dies."""

TF_STATIC = "/tf_static"
"""The topic of what does not move on a robot, such as the places of its sensors."""

CLOSE_TIMEOUT = 2.0
"""Seconds for which closing waits for what is still to be written."""


class LiveWriter:
    """An MCAP file to which any thread adds messages and samples, none of which waits for the disk.

    They are written as messages of ROS 2, with their definitions.

    Args:
        path: the file, which must not exist yet.
        on_failed: called when it cannot be written any more, in the thread that writes.
        clock: the time of messages, and that by which they are in the file.

    Attributes:
        written: by topic, the number of messages that were written.
        is_complete: True once the file has its end, and with it everything that was added and not dropped.

    Raises:
        OSError: the file exists, or cannot be written.
    """

    def __init__(self, path: Path, on_failed: Callable[[], object], clock: Clock) -> None:
        self._path, self._on_failed = path, on_failed
        self._clock = clock
        self.written: Counter[str] = Counter()
        self._dropped: Counter[str] = Counter()
        self._unwritable: dict[str, str] = {}
        self._failed = ""
        self._channels: dict[tuple[str, str], Channel] = {}
        self._to_message: dict[str, ToMessage] = {}
        self._mounted: set[str] = set()
        """The frames of sensors whose places are written."""
        # A clock that is set meanwhile moves no message.
        self._epoch_ns = time.time_ns() - int(self._clock.now() * 1e9)
        self._queue: deque[str] = deque()
        """The topics of the messages that wait, in their order."""
        self._waiting: dict[str, deque[tuple[str, int, Any]]] = {}
        """The messages that wait, by topic."""
        self._file = path.open("xb")
        self._writer = McapWriter(self._file, {"cdr"})
        self._flush_at: float | None = None
        """When what was written is to be in the file; None while all of it is."""
        self._is_closed = self._has_ended = self.is_complete = False
        self._ending = threading.RLock()
        self._waiters = Waiters(self._ending, self._clock)
        self._ticket: Ticket | None = None

    def start(self) -> None:
        """Begin to write."""
        self._ticket = Threads(self._clock).start(self._run, "robowidgets-recorder")

    @property
    def problems(self) -> tuple[str, ...]:
        """What is missing in the file, one line each."""
        dropped = (
            f"{topic}: {many(count, 'message')} dropped, because writing did not keep up"
            for topic, count in list(self._dropped.items())
        )
        return tuple(filter(None, (self._failed, *dropped, *self._unwritable.values())))

    @property
    def has_failed(self) -> bool:
        """True if the file cannot be written any more."""
        return bool(self._failed)

    def now_ns(self) -> int:
        """The time of a message that comes now, in nanoseconds since 1970."""
        return self._epoch_ns + int(self._clock.now() * 1e9)

    def add(self, topic: str, type_name: str, time_ns: int, message: Any, *, can_be_dropped: bool = True) -> None:
        """Write a message or a sample, given with the type of its topic; drop it if too many of the topic wait."""
        waiting = self._waiting.setdefault(topic, deque())
        if can_be_dropped and len(waiting) >= MOST_WAITING:
            self._dropped[topic] += 1
            return
        waiting.append((type_name, time_ns, message))
        self._queue.append(topic)
        if self._ticket is not None:
            self._ticket.wake()

    def close(self) -> None:
        """Complete the file, to which nothing may be added any more. It waits for the disk for two seconds at most."""
        self._is_closed = True
        if self._ticket is None or self._has_ended:
            return
        self._ticket.wake()
        if self._waiters.wait_for(lambda: self._has_ended or None, CLOSE_TIMEOUT) is None:
            log.warning("%s: the disk is slow: the file is not complete yet", self._path)

    # -- in the thread that writes -------------------------------------------------------------------------------------

    def _run(self) -> float | None:
        """Write what waits; returns when that is to be in the file."""
        try:
            is_closed = self._is_closed  # nothing is added after that
            while self._queue:
                topic = self._queue.popleft()
                self._write(self._writer, topic, *self._waiting[topic].popleft())
                if self._flush_at is None:
                    self._flush_at = self._clock.now() + FLUSH
                self._flush_if_due()
            self._flush_if_due()
            if not is_closed:
                return self._flush_at
            self._writer.finish()
            self._file.close()
            self.is_complete = True
        except Exception as error:  # a full disk, above all
            self._failed = f"recording has ended: {getattr(error, 'strerror', None) or error}"
            log.error("%s: %s; the robot and its program go on", self._path, self._failed)
            with suppress(OSError):
                self._file.close()
            self._end()
            self._on_failed()
        if self._dropped:
            log.warning("%s: %s dropped", self._path, many(sum(self._dropped.values()), "message"))
        self._end()
        raise Left

    def _flush_if_due(self) -> None:
        if self._flush_at is not None and self._clock.now() >= self._flush_at:
            self._writer.flush()
            self._flush_at = None

    def _end(self) -> None:
        """Wake whoever closes it."""
        with self._ending:
            self._has_ended = True
            self._waiters.wake()

    def _write(self, writer: McapWriter, topic: str, topic_type: str, time_ns: int, message: Any) -> None:
        mount = mount_message(message, time_ns)
        if mount and message.frame_id not in self._mounted:
            self._mounted.add(message.frame_id)
            self._put(writer, TF_STATIC, time_ns, *mount)
        self._put(writer, topic, time_ns, *self._standard(topic, topic_type, time_ns, message))

    def _put(self, writer: McapWriter, topic: str, time_ns: int, type_name: str, fields: Any) -> None:
        channel = self._channels.get((topic, type_name))
        definition = _definition(type_name, fields) if channel is None else channel.definition
        try:
            data = encode("cdr", type_name, fields, definition)
        except ValueError as error:
            if topic not in self._unwritable:
                self._unwritable[topic] = f"{topic} cannot be recorded: {error}"
                log.warning("%s: %s", self._path, self._unwritable[topic])
            return
        if channel is None:
            channel = Channel(len(self._channels), topic, type_name, "cdr", definition, 0)
            self._channels[topic, type_name] = channel
            writer.register(channel)
        writer.add(channel, time_ns, data)
        self.written[topic] += 1

    def _standard(self, topic: str, topic_type: str, time_ns: int, message: Any) -> tuple[str, Any]:
        """The type and the fields of a message; those of a standard type for a sample."""
        kind = kind_of_sample(message)
        if kind is None or kind.to_message is None:
            return topic_type, message
        if topic not in self._to_message:
            self._to_message[topic] = kind.to_message()
        return self._to_message[topic](message, time_ns, topic_type)


def _definition(type_name: str, message: Any) -> str:
    """The definition by which a message was read, as ROS 2 writes it; empty for one that its robot did not define."""
    source = channel_of(message)
    if source is None or source.type != type_name or not source.definition.strip():
        return ""
    text: str = store_of(source).generate_msgdef(type_name, ros_version=2)[0]
    return text
