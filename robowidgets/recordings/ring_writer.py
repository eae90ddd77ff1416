"""Keeping the last minute of a robot on the disk, in short MCAP files, and writing it to one file for a cause."""

from __future__ import annotations

import logging
from collections import deque
from collections.abc import Callable, Iterable
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO, NamedTuple

from ..messages.channel import Channel
from ..repair import RecordingError
from ..repair.write import McapWriter
from ..runtime.clock import Clock, Detached
from ..runtime.text import many, megabytes
from .cut import is_lasting, is_static
from .live_writer import FLUSH, QueuedWriter
from .ring import (
    CAUSES,
    LOG,
    Cause,
    Ring,
    cause_message,
    delete_oldest,
    has_messages,
    join,
    new_name,
    recover,
    segment_name,
)

log = logging.getLogger("robowidgets")

PARTS = 6
"""The last minute is kept in this number of short files; one more is being written."""

LONGEST_PART = 10.0
"""The longest duration of a short file in seconds."""

REPEATED = 600.0
"""Seconds in which an error that comes again begins no file; each time is a mark in the next one."""

BETWEEN = 15.0
"""The shortest time between two files in seconds. Causes in between share the next file."""

RETRY = 5.0
"""Seconds after which a disk that was full is tried again."""

RING_SHARE = 4
"""One part in this number of the megabytes is for the short files, half of them for the files of causes."""

SHARE = 3
"""The maximum number of new messages that are written for each message of a file."""

MOST_CAUSES = 1000
"""The maximum number of causes that are kept, and of fixed transforms that are repeated."""


class FoundCause(NamedTuple):
    """The text of a cause. An error that comes again and again begins one file."""

    text: str
    is_error: bool = False


@dataclass(frozen=True)
class Finder:
    """The functions that a writer of the last minute calls, in its thread.

    Args:
        causes_in: returns the causes that a message reports; called with its topic, type, time and content.
        on_second: called about each second.
        on_change: called when the files or the troubles have changed.
    """

    causes_in: Callable[[str, str, int, Any], Iterable[FoundCause]]
    on_second: Callable[[], None]
    on_change: Callable[[], None]


@dataclass(frozen=True)
class RingLimits:
    """The limits of a black box.

    Args:
        seconds: the time before a cause that a file has at least.
        after: the time after a cause.
        files: the largest number of files in the folder.
        size: the bytes of all files and of the last minute.
    """

    seconds: float
    after: float
    files: int
    size: int


@dataclass
class _Pending:
    """A file that is due: the clock times of its first and its last cause.

    It is urgent once the short files with its first cause would soon be deleted.
    """

    cause: Cause
    first: float
    last: float
    is_urgent: bool = False


@dataclass
class _Segment:
    """A short file: its path, the time of its first message, and the clock times of its first and its last one.

    Messages that it only repeats have `repeated` bytes, which do not count as its size.
    """

    path: Path
    start_ns: int
    began: float
    ended: float = 0.0
    size: int = 0
    repeated: int = 0
    registered: set[int] = field(default_factory=set)


class RingWriter(QueuedWriter):
    """The last minute of a robot on the disk, and the files for causes.

    Each short file is whole by itself, and what a killed kernel has left is written to a file at the next start. If the
    disk is full, it drops messages, reports that, and tries again; it deletes nothing to make room.

    Args:
        folder: the folder of the files, which must exist.
        limits: what it keeps.
        finder: finds causes in the messages.
        clock: as for `QueuedWriter`.

    Raises:
        OSError: the folder cannot be written.
    """

    def __init__(self, folder: Path, limits: RingLimits, finder: Finder, clock: Clock) -> None:
        super().__init__(folder, clock)
        self._limits, self._finder = limits, finder
        self._ring = Ring(folder)
        self._full, self._unsaved = "", ""
        """The reasons why nothing is kept now, and why the pending file is not written, or empty."""
        self._lost: list[str] = []
        """Lines on what dead kernels left and cannot be written, and on short files that cannot be read."""
        self._unread: list[Path] = []
        """Short files that cannot be read."""
        self._keeps_from = self._saves_from = float("-inf")
        """The times at which the disk is tried again."""
        self._segments: deque[_Segment] = deque()
        self._number = 0
        self._file: BinaryIO | None = None
        self._writer: McapWriter | None = None
        self._lasting: dict[tuple[int, bytes], tuple[Channel, bytes]] = {}
        """The messages that still hold, for the start of each short file."""
        self._causes: deque[Cause] = deque(maxlen=MOST_CAUSES)
        self._errors: dict[str, float] = {}
        """The clock times at which errors came last, by text."""
        self._cause_flushed_at = float("-inf")
        self._pending: _Pending | None = None
        self._saved_at = float("-inf")
        self._has_begun = self._is_saving = False
        self.is_cut_short = False
        """True while the last minute has more bytes than it may, so that only a part of it is kept."""

    @property
    def problems(self) -> tuple[str, ...]:
        """See `QueuedWriter`."""
        return (*self.trouble, *self._lost, *super().problems)

    @property
    def trouble(self) -> tuple[str, ...]:
        """The reasons why nothing is kept now, or a file is not written."""
        return tuple(filter(None, (self._full, self._unsaved)))

    @property
    def kept(self) -> float:
        """The seconds of the past that are on the disk."""
        first = next(iter(list(self._segments)), None)
        return min(self._clock.now() - first.began, self._limits.seconds) if first is not None else 0.0

    def add_cause(self, text: str, *, is_error: bool = False) -> None:
        """Write a file for a cause, or mark it in the next one. Any thread may call this."""
        self.add(CAUSES, LOG, self.now_ns(), FoundCause(text, is_error), can_be_dropped=False)

    def close(self) -> None:
        """See `QueuedWriter`. A writer that has not started removes its short files."""
        super().close()
        if self._ticket is None:
            self._close_ring()

    # -- in the thread that writes -------------------------------------------------------------------------------------

    def _run(self) -> float | None:
        """See `QueuedWriter`."""
        is_closed = self._is_closed  # nothing is added after closing
        try:
            self._keep(is_closed)
        except Exception:
            if not is_closed:
                raise
            log.exception("%s: error while closing", self._path)
        finally:
            if is_closed:
                self._close_ring()
                self._end()
        if is_closed:
            raise Detached
        if self._is_closed:  # in this turn, perhaps by this thread
            return self._clock.now()
        due = None if self._pending is None or self._full else self._due
        times = (self._flush_at, due, self._tries_at)
        return min((at for at in times if at is not None), default=None)

    def _keep(self, is_closed: bool) -> None:
        """Write what waits, and the file that is due."""
        if not self._has_begun:
            self._has_begun = True
            self._take_left()
        self._write_waiting()
        if self._tries_at is not None and self._clock.now() >= self._tries_at:
            self._try_disk()
        self._flush_if_due()
        # A full disk has no room for a file either; its cause waits.
        if self._pending is not None and (is_closed or (not self._full and self._clock.now() >= self._due)):
            self._save()
        self._trim()

    @property
    def _due(self) -> float:
        """The time at which the pending file is written, or tried again."""
        pending = self._pending
        assert pending is not None
        if pending.is_urgent:
            return self._saves_from
        last = min(pending.last + self._limits.after, pending.first + max(self._limits.seconds, self._limits.after))
        return max(last, self._saved_at + BETWEEN, self._saves_from)

    def _write_some(self) -> None:
        """Write a few waiting messages between the messages of a file, which is complete soon even under overload."""
        self._write_waiting(SHARE)

    def _take_left(self) -> None:
        """Write what dead kernels have left in the folder."""
        written, self._lost = recover(self._path, self._write_some)
        for path in written:
            log.warning("%s: written from what a kernel left that ended without closing", path)
            self._delete_oldest(path)
        for line in self._lost:
            log.error("%s: %s", self._path, line)
        if written or self._lost:
            self._finder.on_change()

    def _write(self, topic: str, topic_type: str, time_ns: int, message: Any) -> None:
        if topic == CAUSES:
            self._note(time_ns, message)
            return
        try:
            super()._write(topic, topic_type, time_ns, message)
            for found in self._finder.causes_in(topic, topic_type, time_ns, message):
                self._note(time_ns, found)
        except Exception as error:  # one bad message must not end the black box
            if topic not in self._unwritable:
                self._unwritable[topic] = f"{topic} cannot be recorded: {error}"
                log.exception("%s: %s", self._path, self._unwritable[topic])

    def _note(self, time_ns: int, found: FoundCause) -> None:
        now = self._clock.now()
        # Half a surrogate pair cannot be written.
        cause = Cause(time_ns, found.text.encode("utf-8", "replace").decode())
        self._causes.append(cause)
        if not (found.is_error and self._is_repeated(cause.text, now)):
            if self._pending is None:
                self._pending = _Pending(cause, now, now)
            self._pending.last = now
        self._put(CAUSES, cause.time_ns, LOG, cause_message(cause))
        if now >= self._cause_flushed_at + FLUSH:
            self._cause_flushed_at = self._flush_at = now  # the kernel may die of it

    def _is_repeated(self, error: str, now: float) -> bool:
        """Return True if an error has come in the last ten minutes, and note that it has come now."""
        before = self._errors.pop(error, float("-inf"))
        self._errors[error] = now
        if len(self._errors) > MOST_CAUSES:
            del self._errors[next(iter(self._errors))]
        return now - before < REPEATED

    def _put_bytes(self, channel: Channel, time_ns: int, data: bytes) -> None:
        try:
            if self._clock.now() < self._keeps_from:
                return
            segment, writer = self._segment(time_ns)
            if channel.id not in segment.registered:
                segment.registered.add(channel.id)
                writer.register(channel)
            writer.add(channel, time_ns, data)
            segment.ended = self._clock.now()
            self.written[channel.topic] += 1
        except OSError as error:
            self._fail(error)
        finally:
            self._keep_lasting(channel, data)

    def _keep_lasting(self, channel: Channel, data: bytes) -> None:
        if is_static(channel):
            key = channel.id, data
        elif is_lasting(channel):
            key = channel.id, b""
        else:
            return
        self._lasting.pop(key, None)
        if len(data) > self._most:
            return
        self._lasting[key] = channel, data
        if len(self._lasting) > MOST_CAUSES:
            del self._lasting[next(iter(self._lasting))]

    def _segment(self, time_ns: int) -> tuple[_Segment, McapWriter]:
        """Return the short file that is being written, a new one if it is time."""
        if self._writer is not None and self._file is not None:
            segment = self._segments[-1]
            lasts = min(self._limits.seconds / PARTS, LONGEST_PART)
            if self._clock.now() - segment.began < lasts and self._file.tell() - segment.repeated < self._most:
                return segment, self._writer
            self._close_segment()
        if not self._ring.path.is_dir():  # the user has deleted it
            self._path.mkdir(parents=True, exist_ok=True)
            self._ring.release()
            self._ring = Ring(self._path)
            self._segments.clear()
        self._number += 1
        path = self._ring.path / segment_name(self._number, time_ns)
        segment = _Segment(path, time_ns, self._clock.now())
        self._file = path.open("xb")
        self._segments.append(segment)
        self._writer = McapWriter(self._file, {"cdr"})
        for channel, data in self._lasting.values():
            if channel.id not in segment.registered:
                segment.registered.add(channel.id)
                self._writer.register(channel)
            self._writer.add(channel, time_ns, data)
        if self._lasting:
            self._writer.flush()
            segment.repeated = self._file.tell()
        return segment, self._writer

    @property
    def _most(self) -> float:
        """The bytes of a short file."""
        return self._limits.size / RING_SHARE / PARTS

    def _close_segment(self) -> None:
        writer, file = self._writer, self._file
        self._writer = self._file = None
        if writer is None or file is None:
            return
        self._segments[-1].ended = self._clock.now()
        try:
            writer.finish()
        finally:
            self._segments[-1].size = file.tell() - self._segments[-1].repeated
            file.close()

    @property
    def _tries_at(self) -> float | None:
        """The time at which a disk that was full is tried if no message comes until then."""
        return self._keeps_from + RETRY if self._full and self._flush_at is None else None

    def _try_disk(self) -> None:
        try:
            self._segment(self.now_ns())
        except OSError as error:
            self._fail(error)
        else:
            self._flush_at = self._clock.now()

    def _flush_if_due(self) -> None:
        if self._flush_at is None or self._clock.now() < self._flush_at:
            return
        self._flush_at = None
        if self._writer is not None:
            try:
                self._writer.flush()
                if not self._ring.path.is_dir():
                    self._close_segment()  # the next message makes it again
            except OSError as error:
                self._fail(error)
            else:
                if self._clock.now() >= self._keeps_from + RETRY:  # after one failure, the next is likely
                    self._report(full="")
        self._trim()
        self._finder.on_second()

    def _fail(self, error: OSError) -> None:
        """Note that the disk is full, or fails for another reason, and try again in a moment."""
        file, self._writer, self._file = self._file, None, None
        if file is not None:
            with suppress(OSError):
                file.close()
            with suppress(OSError):
                self._segments[-1].size = self._segments[-1].path.stat().st_size - self._segments[-1].repeated
        self._keeps_from = self._clock.now() + RETRY
        self._report(full=f"nothing is kept: {self._why(error)}")

    def _why(self, error: Exception) -> str:
        return f"{getattr(error, 'strerror', None) or error} in {self._path}; it tries again every {RETRY:g} s"

    def _report(self, *, full: str | None = None, unsaved: str | None = None) -> None:
        """Show why nothing is kept, or a file is not written, and log it once."""
        before = self.trouble
        self._full = self._full if full is None else full
        self._unsaved = self._unsaved if unsaved is None else unsaved
        if self.trouble == before:
            return
        if not before:
            log.error("black box: %s", self.trouble[0])
        elif not self.trouble:
            log.warning("black box: it keeps the last %g s again, in %s", self._limits.seconds, self._path)
        self._finder.on_change()

    def _trim(self) -> None:
        """Delete the short files that are too old, or too many bytes."""
        if self._is_saving:
            return
        since = self._clock.now() if self._pending is None else self._pending.first
        most = self._limits.size / RING_SHARE
        is_cut_short = False
        while len(self._segments) > 1:
            segment = self._segments[0]
            is_old = segment.ended < since - self._limits.seconds
            is_large = not is_old and sum(one.size for one in self._segments) > most
            if not is_old and not is_large:
                break
            middle = self._segments[len(self._segments) // 2]
            pending = None if self._unsaved else self._pending
            if is_large and pending is not None and middle.ended >= pending.first:
                pending.is_urgent = True  # half of its time is before the cause, and half after it
                break
            is_cut_short |= is_large
            try:
                segment.path.unlink(missing_ok=True)
            except OSError as error:
                self._fail(error)
                break
            self._segments.popleft()
        if is_cut_short and not self.is_cut_short:
            log.warning(
                "black box: the last %g s have more than %s, so it keeps less; name fewer topics, or raise megabytes",
                self._limits.seconds,
                megabytes(int(most)),
            )
        if is_cut_short != self.is_cut_short and (is_cut_short or self.kept >= self._limits.seconds):
            self.is_cut_short = is_cut_short
            self._finder.on_change()

    def _save(self) -> None:
        """Write the pending file."""
        pending, self._pending = self._pending, None
        assert pending is not None
        self._is_saving = True
        try:
            self._close_segment()
            target = new_name(self._path, self._ring.token, pending.cause)
            segments = [one for one in self._segments if has_messages(one.path)]
            first_ns = min([pending.cause.time_ns, *(one.start_ns for one in segments)])
            causes = dict.fromkeys([pending.cause, *(one for one in self._causes if one.time_ns >= first_ns)])
            unread = join([one.path for one in segments], target, causes, self._write_some)
        except Exception as error:
            if self._pending is not None:
                pending.last = self._pending.last
            self._pending, self._saves_from = pending, self._clock.now() + RETRY
            if not isinstance(error, (OSError, RecordingError)):
                log.exception("black box: no file for “%s”", pending.cause.text)
            self._report(unsaved=f"the file for “{pending.cause.text}” waits: {self._why(error)}")
            return
        finally:
            self._is_saving = False
        self._saved_at = self._clock.now()
        self._report(unsaved="")
        log.info("%s: written for %s", target, many(len(causes), "cause"))
        for line in unread:
            self._lost.append(f"{target.name} lacks a part: {line}")
            log.error("%s: %s", self._path, self._lost[-1])
            self._unread.append(self._ring.path / line.partition(":")[0])
        self._delete_oldest(target)
        self._finder.on_change()

    def _delete_oldest(self, new: Path) -> None:
        try:
            delete_oldest(self._path, self._limits.files, self._limits.size // 2, new)
        except OSError as error:
            log.error("%s: old files cannot be deleted: %s; delete them by hand", self._path, error.strerror or error)

    def _close_ring(self) -> None:
        """Remove the short files. If one cannot be read, or a file not be written, they stay for the next start."""
        try:
            with suppress(OSError):
                self._close_segment()
            if self._pending is None and not any(path.exists() for path in self._unread):
                self._ring.remove()
        except Exception as error:
            log.error(
                "%s: cannot be removed: %s; delete it by hand",
                self._ring.path,
                getattr(error, "strerror", None) or error,
            )
        finally:
            self._ring.release()
