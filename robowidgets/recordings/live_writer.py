"""Writing messages to the disk while they come, in a separate thread."""

from __future__ import annotations

import logging
import threading
import time
from abc import ABC, abstractmethod
from collections import Counter, deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

from ..kinds import kind_of_sample
from ..messages.channel import Channel
from ..messages.decoding import channel_of, store_of
from ..messages.encoding import encode
from ..messages.standard import ToMessage, mount_message
from ..repair.write import McapWriter
from ..runtime.clock import Clock, Detached, Threads, Ticket
from ..runtime.sizes import approximate_bytes
from ..runtime.text import many
from ..runtime.waiters import Waiters

log = logging.getLogger("robowidgets")

MOST_WAITING = 1000
"""The maximum number of messages of one topic that wait to be written; further ones are dropped."""

MOST_BYTES = 64_000_000
"""The approximate maximum number of bytes of all messages that wait to be written; further ones are dropped."""

FLUSH = 1.0
"""Seconds after which messages are in the file, so that they are not lost if the process dies."""

TF_STATIC = "/tf_static"
"""The topic for fixed transforms on a robot, such as the poses of its sensors."""

CLOSE_TIMEOUT = 2.0
"""The maximum time in seconds that closing waits for the remaining messages to be written."""


class QueuedWriter(ABC):
    """A recording to which any thread adds messages and samples without waiting for the disk.

    A thread of its own writes them, as messages of ROS 2 with their definitions.

    Args:
        path: the file or folder, for the log.
        clock: the clock for the times of messages and for flushing.

    Attributes:
        written: by topic, the number of messages that were written.
    """

    def __init__(self, path: Path, clock: Clock) -> None:
        self._path, self._clock = path, clock
        self.written: Counter[str] = Counter()
        self._dropped: Counter[str] = Counter()
        self._unwritable: dict[str, str] = {}
        self._channels: dict[tuple[str, str], Channel] = {}
        self._to_message: dict[str, ToMessage] = {}
        self._mounted: set[str] = set()
        """The frames of sensors whose poses are written."""
        # If the system clock is set meanwhile, the times of messages stay consistent.
        self._epoch_ns = time.time_ns() - int(self._clock.now() * 1e9)
        self._queue: deque[str] = deque()
        """The topics of the waiting messages, in their order."""
        self._waiting: dict[str, deque[tuple[str, int, Any]]] = {}
        """The waiting messages by topic."""
        self._sizes: dict[str, int] = {}
        """The approximate bytes of a message by topic, of the newest one that had to wait; the others are alike."""
        self._flush_at: float | None = None
        """The time at which written messages must be flushed to the file, or None if all are."""
        self._is_closed = self._has_ended = False
        self._ending = threading.RLock()
        self._waiters = Waiters(self._ending, self._clock)
        self._ticket: Ticket | None = None
        self._thread: threading.Thread | None = None
        """The thread that writes, once it runs."""

    def start(self) -> None:
        """Start the writing thread."""
        self._ticket = Threads(self._clock).start(self._turn, "robowidgets-recorder")

    @property
    def problems(self) -> tuple[str, ...]:
        """One line for each problem that leaves messages out of the file."""
        dropped = (
            f"{topic}: {many(count, 'message')} dropped, because writing did not keep up"
            for topic, count in list(self._dropped.items())
        )
        return (*dropped, *self._unwritable.values())

    def now_ns(self) -> int:
        """Return the time of a message that comes now, in nanoseconds since 1970."""
        return self._epoch_ns + int(self._clock.now() * 1e9)

    def add(self, topic: str, type_name: str, time_ns: int, message: Any, *, can_be_dropped: bool = True) -> None:
        """Write a message or a sample, given with the type of its topic; drop it if too many wait."""
        waiting = self._waiting.setdefault(topic, deque())
        if waiting or topic not in self._sizes:
            self._sizes[topic] = approximate_bytes(message)
        if can_be_dropped and waiting and (len(waiting) >= MOST_WAITING or self._waiting_bytes > MOST_BYTES):
            self._dropped[topic] += 1
            return
        waiting.append((type_name, time_ns, message))
        self._queue.append(topic)
        if self._ticket is not None:
            self._ticket.wake()

    @property
    def _waiting_bytes(self) -> int:
        return sum(len(waiting) * self._sizes.get(topic, 0) for topic, waiting in list(self._waiting.items()))

    def close(self) -> None:
        """Complete the file; nothing may be added afterwards. This waits for the disk for two seconds at most.

        A call in the thread that writes does not wait.
        """
        self._is_closed = True
        if self._ticket is None or self._has_ended:
            return
        self._ticket.wake()
        if self._thread is threading.current_thread():
            return
        if self._waiters.wait_for(lambda: self._has_ended or None, CLOSE_TIMEOUT) is None:
            log.warning(
                "%s: the disk is slow: the file is not complete yet; wait before you open or copy it", self._path
            )

    # -- in the thread that writes -------------------------------------------------------------------------------------

    def _turn(self) -> float | None:
        self._thread = threading.current_thread()
        return self._run()

    @abstractmethod
    def _run(self) -> float | None:
        """Write the waiting messages; return the time of the next turn."""

    @abstractmethod
    def _put_bytes(self, channel: Channel, time_ns: int, data: bytes) -> None:
        """Write an encoded message. A channel that is new has not been registered yet."""

    def _write_waiting(self, most: int | None = None) -> None:
        """Write the messages that wait now, or some of them. Messages that come meanwhile wait for the next turn."""
        waiting = len(self._queue)
        for _ in range(waiting if most is None else min(waiting, most)):
            topic = self._queue.popleft()
            self._write(topic, *self._waiting[topic].popleft())
            if self._flush_at is None:
                self._flush_at = self._clock.now() + FLUSH
            self._flush_if_due()

    @abstractmethod
    def _flush_if_due(self) -> None:
        """Flush the written messages if it is time."""

    def _end(self) -> None:
        """Wake the threads that wait in `close`."""
        with self._ending:
            self._has_ended = True
            self._waiters.wake()

    def _write(self, topic: str, topic_type: str, time_ns: int, message: Any) -> None:
        mount = mount_message(message, time_ns)
        if mount and message.frame_id not in self._mounted:
            self._mounted.add(message.frame_id)
            self._put(TF_STATIC, time_ns, *mount)
        self._put(topic, time_ns, *self._standard(topic, topic_type, time_ns, message))

    def _put(self, topic: str, time_ns: int, type_name: str, fields: Any) -> None:
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
        self._put_bytes(channel, time_ns, data)

    def _standard(self, topic: str, topic_type: str, time_ns: int, message: Any) -> tuple[str, Any]:
        """Return the type and the fields of a message, or of a standard message for a sample."""
        kind = kind_of_sample(message)
        if kind is None or kind.to_message is None:
            return topic_type, message
        if topic not in self._to_message:
            self._to_message[topic] = kind.to_message()
        return self._to_message[topic](message, time_ns, topic_type)


class LiveWriter(QueuedWriter):
    """An MCAP file that is written while its messages come.

    Args:
        path: the file, which must not exist yet.
        on_failed: called in the writing thread when the file cannot be written any more.
        clock: as for `QueuedWriter`.

    Attributes:
        is_complete: True once the file is finished, and contains everything that was added and not dropped.

    Raises:
        OSError: the file exists, or cannot be written.
    """

    def __init__(self, path: Path, on_failed: Callable[[], object], clock: Clock) -> None:
        super().__init__(path, clock)
        self._on_failed = on_failed
        self._failed = ""
        self.is_complete = False
        self._registered: set[int] = set()
        """The ids of the channels in the file."""
        self._file = path.open("xb")
        self._writer = McapWriter(self._file, {"cdr"})

    @property
    def problems(self) -> tuple[str, ...]:
        """See `QueuedWriter`."""
        return tuple(filter(None, (self._failed, *super().problems)))

    @property
    def has_failed(self) -> bool:
        """True if the file cannot be written any more."""
        return bool(self._failed)

    def _run(self) -> float | None:
        """See `QueuedWriter`."""
        try:
            is_closed = self._is_closed  # nothing is added after closing
            self._write_waiting()
            self._flush_if_due()
            if not is_closed:
                return self._flush_at
            self._writer.finish()
            self._file.close()
            self.is_complete = True
        except Exception as error:  # most likely a full disk
            self._failed = f"recording has ended: {getattr(error, 'strerror', None) or error}"
            log.error("%s: %s; the robot and its program continue", self._path, self._failed)
            with suppress(OSError):
                self._file.close()
            self._end()
            self._on_failed()
        if self._dropped:
            log.warning(
                "%s: %s dropped, as writing was too slow; record fewer topics",
                self._path,
                many(sum(self._dropped.values()), "message"),
            )
        self._end()
        raise Detached

    def _flush_if_due(self) -> None:
        if self._flush_at is not None and self._clock.now() >= self._flush_at:
            self._writer.flush()
            self._flush_at = None

    def _put_bytes(self, channel: Channel, time_ns: int, data: bytes) -> None:
        if channel.id not in self._registered:
            self._writer.register(channel)
            self._registered.add(channel.id)
        self._writer.add(channel, time_ns, data)
        self.written[channel.topic] += 1


def _definition(type_name: str, message: Any) -> str:
    """Return the definition by which a message was read, as ROS 2 writes it, or an empty text if it has none."""
    source = channel_of(message)
    if source is None or source.type != type_name or not source.definition.strip():
        return ""
    text: str = store_of(source).generate_msgdef(type_name, ros_version=2)[0]
    return text
