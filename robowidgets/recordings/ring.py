"""The folder of a black box: short MCAP files of the last minute, which are joined into one when something happens.

Each kernel has a folder of its own for them, `.ring_` and four digits, and locks it. A folder that no process locks is
left over from a kernel that died. Once its messages are in a file, it is called `.done_`, and its files are deleted.
"""

from __future__ import annotations

import errno
import os
import re
import time
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager, suppress
from heapq import merge
from pathlib import Path
from secrets import token_hex
from typing import Any, NamedTuple
from weakref import WeakSet

from ..messages.channel import Channel
from ..messages.encoding import encode
from ..notebook.progress import without_bars
from ..repair import Message, RecordingError, find_files, open_repaired
from ..repair.write import McapWriter
from ..runtime.output_file import whole_file
from ..samples.event import Level
from .cut import is_lasting, is_static

try:
    import fcntl
except ImportError:  # Windows does not remove open files
    fcntl = None  # type: ignore[assignment]

CAUSES = "/robowidgets/black_box"
"""The topic with the causes, as warnings of a log, so that players mark them."""

LOG = "rcl_interfaces/msg/Log"
DIED = "the kernel ended without closing"

_RING, _DONE = ".ring_", ".done_"
_NEW = ".new_"
_LOCK = "lock"
_FOLDER = re.compile(r"\.(ring|done)_[0-9a-f]{4}")
_SEGMENT = re.compile(r"([0-9]+)_([0-9]+)\.mcap")
_SAVED = re.compile(
    r"[0-9]{4}(-[0-9]{2}){2}_[0-9]{2}(-[0-9]{2}){2}_[a-z0-9-]*_blackbox-(?P<number>[0-9]+)-[0-9a-f]{4}\.mcap"
)
_PART = re.compile(_SAVED.pattern + r"\.[0-9]+\.part")
_HEADER = 64
"""The maximum number of bytes of a short file that has no message yet."""

_LONGEST = 40
"""Characters of a cause in the name of a file."""


class Cause(NamedTuple):
    """The reason for a file: its time in nanoseconds since 1970, and its text."""

    time_ns: int
    text: str


def cause_message(cause: Cause) -> dict[str, Any]:
    """Return the fields of the log line of a cause."""
    stamp = {"sec": cause.time_ns // 10**9, "nanosec": cause.time_ns % 10**9}
    about = {"level": Level.WARN.value, "name": "black box", "msg": cause.text}
    return {"stamp": stamp, **about, "file": "", "function": "", "line": 0}


class Ring:
    """The folder in which a kernel keeps the last minute, locked until it is closed or the kernel ends.

    Args:
        folder: the folder of the black box, which must exist.

    Raises:
        OSError: the folder cannot be written.
    """

    def __init__(self, folder: Path) -> None:
        while True:
            self.token = token_hex(2)
            self.path = folder / f"{_RING}{self.token}"
            new = folder / f"{_NEW}{self.token}"
            if self.path.exists() or _done(self.path).exists():
                continue
            with suppress(FileExistsError):
                new.mkdir()
                break
        self._lock: int | None = os.open(new / _LOCK, os.O_RDWR | os.O_CREAT)
        if fcntl is not None:
            with suppress(OSError):  # a disk without locks: no kernel takes the folder of another there
                fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            new.rename(self.path)
        else:  # Windows renames no folder with an open file
            os.close(self._lock)
            new.rename(self.path)
            self._lock = os.open(self.path / _LOCK, os.O_RDWR)
        _rings.add(self)

    def remove(self) -> None:
        """Remove the folder, unless it is released already; raise OSError if that is impossible."""
        if not self.is_held:
            return
        if fcntl is None:
            self.release()
        _remove(self.path)
        self.release()

    @property
    def is_held(self) -> bool:
        """True until it is released."""
        return self._lock is not None

    def release(self) -> None:
        """Release the lock, so that another kernel may take what is in the folder."""
        lock, self._lock = self._lock, None
        if lock is not None:
            os.close(lock)


_rings: WeakSet[Ring] = WeakSet()


def _release_all() -> None:
    """Close the locks in a forked process, which may live longer than the kernel."""
    for ring in list(_rings):
        ring.release()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_release_all)


def segment_name(number: int, start_ns: int) -> str:
    """Return the name of a short file; its first messages repeat what still holds, at its start."""
    return f"{number}_{start_ns}.mcap"


def saved_files(folder: Path) -> list[Path]:
    """Return the files that black boxes wrote into a folder, oldest first."""
    with suppress(OSError):  # removed, or not to be read
        return [path for _, path in sorted(_numbered(folder)) if _is_plain_file(path)]
    return []


def _numbered(folder: Path) -> Iterator[tuple[int, Path]]:
    for path in folder.iterdir():
        if match := _SAVED.fullmatch(path.name):
            yield int(match["number"]), path


def _is_plain_file(path: Path) -> bool:
    return path.is_file() and not path.is_symlink()


def delete_oldest(folder: Path, most_files: int, most_bytes: int, new: Path) -> None:
    """Delete the oldest files of black boxes until the others keep the limits. The new file always stays."""
    sizes = {}
    for path in saved_files(folder):
        with suppress(FileNotFoundError):  # another kernel was faster
            sizes[path] = path.stat().st_size
    for path in [path for path in sizes if path != new]:
        if len(sizes) > most_files or sum(sizes.values()) > most_bytes:
            path.unlink(missing_ok=True)
            del sizes[path]


def new_name(folder: Path, token: str, cause: Cause) -> Path:
    """Return the path of a file that does not exist: its date, its cause, its number, and the digits of its kernel.

    The number orders the files, because the clock of a robot may go back.
    """
    day = time.strftime("%Y-%m-%d_%H-%M-%S", time.localtime(cause.time_ns / 1e9))
    about = re.sub(r"[^a-z0-9]+", "-", cause.text.partition(":")[0].lower())[:_LONGEST].strip("-")
    number = 1 + max((number for number, _ in _numbered(folder)), default=0)
    return folder / f"{day}_{about}_blackbox-{number}-{token}.mcap"


def has_messages(segment: Path) -> bool:
    """Return True if a short file exists and has more than its header, so that it has or had messages."""
    with suppress(FileNotFoundError):
        return segment.stat().st_size > _HEADER
    return False


def join(
    segments: Sequence[Path],
    target: Path,
    causes: Iterable[Cause] | None,
    meanwhile: Callable[[], object] = lambda: None,
) -> tuple[str, ...]:
    """Join short files into one, which appears once it is complete. Return a line for each that cannot be read.

    A line begins with the name of the short file and a colon.

    Args:
        segments: the files, in their order; a killed kernel leaves the last one unfinished.
        target: the file to write.
        causes: the causes to mark, or None for the causes in the files, and that the kernel died.
        meanwhile: called after each message.

    Raises:
        OSError: the file cannot be written. RecordingError: no message can be read.
    """
    if not segments:
        raise RecordingError("no message is kept")
    with without_bars(), closing(open_repaired(segments)) as source:
        if source.end_ns is None:
            raise RecordingError("no message can be read")
        channels = [channel for channel in source.channels if channel.topic != CAUSES]
        if causes is None:
            causes = [*_causes_in(source), Cause(source.end_ns, DIED)]
        about = Channel(1 + max((one.id for one in channels), default=0), CAUSES, LOG, "cdr", "", 0)
        in_order = sorted(causes, key=lambda one: one.time_ns)
        marks = ((about, one.time_ns, encode("cdr", LOG, cause_message(one), "")) for one in in_order)
        starts = {int(path.stem.partition("_")[2]) for path in segments}
        messages = _without_repeats(source.messages(channels), starts)
        with whole_file(target) as file:
            writer = McapWriter(file, {"cdr"})
            for channel in (*channels, about):
                writer.register(channel)
            for message in merge(messages, marks, key=lambda one: one[1]):
                writer.add(*message)
                meanwhile()
            writer.finish()
        return source.unread


def is_black_box(folder: Path) -> bool:
    """Return True if a black box runs in a folder, or a dead kernel left messages there, or it has only their files."""
    files = find_files(folder)
    return bool(_rings_in(folder)) or (bool(files) and set(files) <= set(saved_files(folder)))


def _rings_in(folder: Path) -> list[Path]:
    there = (path for path in folder.iterdir() if _FOLDER.fullmatch(path.name))
    return sorted(path for path in there if path.is_dir() and not path.is_symlink())


def recover(folder: Path, meanwhile: Callable[[], object] = lambda: None) -> tuple[list[Path], list[str]]:
    """Write what dead kernels have left in the folder of a black box. Return the files, and lines on failures."""
    written: list[Path] = []
    problems = []
    held = {ring.path for ring in list(_rings) if ring.is_held}
    for ring in _rings_in(folder):
        try:
            if ring.name.startswith(_DONE):
                _remove(ring)
            elif ring not in held:
                with _taken(ring) as is_left:
                    if is_left:
                        _recover(folder, ring, meanwhile, written)
        except Exception as error:  # noqa: PERF203  # the others are written
            if not isinstance(error, FileNotFoundError) or ring.exists():  # else another kernel was faster
                why = getattr(error, "strerror", None) or error
                if isinstance(error, RecordingError):
                    why = f"{why}; delete the folder if you do not need it"
                problems.append(f"{ring.name}, the last minute of an earlier kernel, stays: {why}")
    return written, problems


def _recover(folder: Path, ring: Path, meanwhile: Callable[[], object], written: list[Path]) -> None:
    token = ring.name.removeprefix(_RING)
    for part in folder.glob(f"*-{token}.mcap.*.part"):
        if _PART.fullmatch(part.name):
            part.unlink(missing_ok=True)
    # The last one may have been opened just before the end.
    segments = [path for path in _segments_in(ring) if has_messages(path)]
    if segments:
        target = new_name(folder, token, Cause(segments[-1].stat().st_mtime_ns, DIED))
        unread = join(segments, target, None, meanwhile)
        written.append(target)
        if unread:
            names = {line.partition(":")[0] for line in unread}
            for path in segments:
                if path.name not in names:
                    path.unlink()
            raise RecordingError("; ".join(unread))
    _remove(ring)


def _segments_in(ring: Path) -> list[Path]:
    """Return the short files in a folder, in their order."""
    there = ((_SEGMENT.fullmatch(path.name), path) for path in ring.iterdir())
    found = [(int(match[1]), path) for match, path in there if match and _is_plain_file(path)]
    return [path for _, path in sorted(found)]


def _done(ring: Path) -> Path:
    return ring.with_name(ring.name.replace(_RING, _DONE))


def _remove(ring: Path) -> None:
    """Remove the folder of short files that are written or not needed; raise OSError if it has other files."""
    segments, lock = _segments_in(ring), ring / _LOCK
    others = sorted(path.name for path in ring.iterdir() if path not in (*segments, lock))
    if segments or not others:
        done = _done(ring)
        ring.rename(done)  # first: whatever fails now, no start writes a file of it again
        for path in segments:
            (done / path.name).unlink(missing_ok=True)
        if not others:
            (done / _LOCK).unlink(missing_ok=True)
            done.rmdir()
    if others:
        raise OSError(errno.ENOTEMPTY, f"it has files of other programs: {', '.join(others[:3])}")


def _causes_in(source: Any) -> Iterator[Cause]:
    from ..messages.decoding import decoder_of

    for channel in source.channels:
        if channel.topic == CAUSES:
            decode = decoder_of(channel)
            for _, time_ns, data in source.messages([channel]):
                yield Cause(time_ns, decode(data).msg)


def _without_repeats(messages: Iterable[Message], starts: Collection[int]) -> Iterator[Message]:
    """Yield messages without those that a later file repeats at its start."""
    static: set[tuple[int, bytes]] = set()
    last: dict[int, bytes] = {}
    for channel, time_ns, data in messages:
        key = channel.id, data
        if is_static(channel):
            if time_ns in starts and key in static:
                continue
            static.add(key)
        elif is_lasting(channel):
            if time_ns in starts and last.get(channel.id) == data:
                continue
            last[channel.id] = data
        yield channel, time_ns, data


@contextmanager
def _taken(ring: Path) -> Iterator[bool]:
    """Lock the folder of a kernel that has ended; give False while it lives, or if another process has locked it."""
    path = ring / _LOCK
    if fcntl is None:
        try:
            path.unlink()  # fails while a process has it open
        except PermissionError:
            yield False
            return
        except OSError as error:
            raise _unknown(error) from None
        try:
            yield True
        except BaseException:
            with suppress(OSError):
                path.touch()  # for the next attempt
            raise
        return
    try:
        lock = os.open(path, os.O_RDWR)
    except OSError as error:
        raise _unknown(error) from None
    try:
        yield _is_locked_now(lock, path)
    finally:
        os.close(lock)


def _unknown(error: OSError) -> OSError:
    return OSError(error.errno, f"it is not known if that kernel runs ({_LOCK}: {error.strerror})")


def _is_locked_now(lock: int, path: Path) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:  # by its kernel
        return False
    except OSError as error:
        raise _unknown(error) from None
    with suppress(FileNotFoundError):  # another kernel was faster
        return os.path.samestat(os.fstat(lock), path.stat())
    return False
