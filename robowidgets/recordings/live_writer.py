"""Writing an MCAP file while its messages come, in a thread of its own."""

from __future__ import annotations

import logging
import threading
import time
from collections import Counter
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from queue import Empty, SimpleQueue
from typing import Any

from .._core.text import many
from ..kinds import kind_of_sample
from ..messages.channel import Channel
from ..messages.encoding import encode
from ..messages.standard import ToMessage, mount_message
from ..repair.write import McapWriter

log = logging.getLogger("robowidgets")

MOST_WAITING = 1000
"""Messages that wait to be written; when the disk is slower, more are dropped."""

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

    Attributes:
        written: by topic, the number of messages that were written.

    Raises:
        OSError: the file exists, or cannot be written.
    """

    def __init__(self, path: Path, on_failed: Callable[[], object]) -> None:
        self._path, self._on_failed = path, on_failed
        self.written: Counter[str] = Counter()
        self._dropped: Counter[str] = Counter()
        self._unwritable: dict[str, str] = {}
        self._failed = ""
        self._channels: dict[tuple[str, str], Channel] = {}
        self._to_message: dict[str, ToMessage] = {}
        self._mounted: set[str] = set()
        """The frames of sensors whose places are written."""
        # A clock that is set meanwhile moves no message.
        self._epoch_ns = time.time_ns() - time.monotonic_ns()
        self._queue: SimpleQueue[tuple[str, str, int, Any] | None] = SimpleQueue()
        self._file = path.open("xb")
        self._thread = threading.Thread(target=self._run, name="robowidgets-recorder", daemon=True)

    def start(self) -> None:
        """Begin to write."""
        self._thread.start()

    @property
    def problems(self) -> tuple[str, ...]:
        """What is missing in the file, one line each."""
        dropped = (
            f"{topic}: {many(count, 'message')} dropped, because writing did not keep up"
            for topic, count in list(self._dropped.items())
        )
        return tuple(filter(None, (self._failed, *dropped, *self._unwritable.values())))

    def now_ns(self) -> int:
        """The time of a message that comes now, in nanoseconds since 1970."""
        return self._epoch_ns + time.monotonic_ns()

    def add(self, topic: str, type_name: str, time_ns: int, message: Any, *, can_be_dropped: bool = True) -> None:
        """Write a message or a sample, given with the type of its topic; drop it if too many wait already."""
        if can_be_dropped and self._queue.qsize() >= MOST_WAITING:
            self._dropped[topic] += 1
        else:
            self._queue.put((topic, type_name, time_ns, message))

    def close(self) -> None:
        """Complete the file, to which nothing may be added any more. It waits for the disk for two seconds at most."""
        self._queue.put(None)
        if self._thread is not threading.current_thread():
            self._thread.join(CLOSE_TIMEOUT)
            if self._thread.is_alive():
                log.warning("%s: the disk is slow: the file is not complete yet", self._path)

    # -- in the thread that writes -------------------------------------------------------------------------------------

    def _run(self) -> None:
        try:
            with self._file:
                writer, flushed = McapWriter(self._file, {"cdr"}), time.monotonic()
                while True:
                    with suppress(Empty):
                        entry = self._queue.get(timeout=FLUSH)
                        if entry is None:
                            break
                        self._write(writer, *entry)
                    if time.monotonic() > flushed + FLUSH:
                        writer.flush()
                        flushed = time.monotonic()
                writer.finish()
        except Exception as error:  # a full disk, above all
            self._failed = f"recording has ended: {getattr(error, 'strerror', None) or error}"
            log.error("%s: %s; the robot and its program go on", self._path, self._failed)
            self._on_failed()
        if self._dropped:
            log.warning("%s: %s dropped", self._path, many(sum(self._dropped.values()), "message"))

    def _write(self, writer: McapWriter, topic: str, topic_type: str, time_ns: int, message: Any) -> None:
        mount = mount_message(message, time_ns)
        if mount and message.frame_id not in self._mounted:
            self._mounted.add(message.frame_id)
            self._put(writer, TF_STATIC, time_ns, *mount)
        self._put(writer, topic, time_ns, *self._standard(topic, topic_type, time_ns, message))

    def _put(self, writer: McapWriter, topic: str, time_ns: int, type_name: str, fields: Any) -> None:
        try:
            data = encode("cdr", type_name, fields)
        except ValueError as error:
            if topic not in self._unwritable:
                self._unwritable[topic] = f"{topic} cannot be recorded: {error}"
                log.warning("%s: %s", self._path, self._unwritable[topic])
            return
        channel = self._channels.get((topic, type_name))
        if channel is None:
            channel = Channel(len(self._channels), topic, type_name, "cdr", "", 0)
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
