"""The folder of a black box: short MCAP files of the last minute, which are joined into one when something happens.

Each kernel has a folder of its own for them, `.ring_` and a few digits, and locks it. A folder that no process locks is
left over from a kernel that died.
"""

from __future__ import annotations

import os
import re
import shutil
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

_RING = ".ring_"
_NEW = ".new_"
_LOCK = "lock"
_SAVED = re.compile(r"\d{4}(-\d\d){2}_\d\d(-\d\d){2}_[a-z0-9-]*_([0-9a-f]+)(_\d+)?\.mcap")
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
        """Remove the folder; raise OSError if that is impossible."""
        if fcntl is None:
            self.release()
        shutil.rmtree(self.path)
        self.release()

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
        return sorted(path for path in folder.iterdir() if _SAVED.fullmatch(path.name))
    return []


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
    """Return the path of a file that does not exist: its date, its cause, and the digits of its kernel."""
    day = time.strftime("%Y-%m-%d_%H-%M-%S", time.localtime(cause.time_ns / 1e9))
    about = re.sub(r"[^a-z0-9]+", "-", cause.text.partition(":")[0].lower())[:_LONGEST].strip("-")
    stem, number = f"{day}_{about}_{token}", 1
    while (path := folder / f"{stem}{'' if number == 1 else f'_{number}'}.mcap").exists():
        number += 1
    return path


def join(
    segments: Sequence[Path],
    target: Path,
    causes: Iterable[Cause] | None,
    meanwhile: Callable[[], object] = lambda: None,
) -> bool:
    """Join short files into one, which appears once it is complete. Return False if they have no message.

    Args:
        segments: the files, in their order; a killed kernel leaves the last one unfinished.
        target: the file to write.
        causes: the causes to mark, or None for the causes in the files, and that the kernel died.
        meanwhile: called after each message.

    Raises:
        OSError: the file cannot be written. RecordingError: no file can be read.
    """
    with without_bars(), closing(open_repaired(segments)) as source:
        if source.end_ns is None:
            return False
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
    return True


def has_rings(folder: Path) -> bool:
    """Return True if a black box runs in a folder, or a dead kernel has left messages there."""
    return next(folder.glob(f"{_RING}*"), None) is not None


def recover(folder: Path, meanwhile: Callable[[], object] = lambda: None) -> tuple[list[Path], list[str]]:
    """Write what dead kernels have left in the folder of a black box. Return the files, and lines on failures."""
    written: list[Path] = []
    problems = []
    for ring in sorted(folder.glob(f"{_RING}*")):
        try:
            with _taken(ring) as is_left:
                written += _recover(folder, ring, meanwhile) if is_left else ()
        except (OSError, RecordingError) as error:  # noqa: PERF203  # the others are written
            problems.append(f"{ring.name} of a kernel that ended stays: {getattr(error, 'strerror', None) or error}")
    return written, problems


def _recover(folder: Path, ring: Path, meanwhile: Callable[[], object]) -> Iterator[Path]:
    token = ring.name.removeprefix(_RING)
    for part in folder.glob(f"*_{token}*.mcap.*.part"):
        part.unlink(missing_ok=True)
    segments = find_files(ring)
    # The last one may have been opened just before the end.
    while segments and not _has_messages(segments[-1]):
        segments.pop()
    if segments:
        target = new_name(folder, token, Cause(segments[-1].stat().st_mtime_ns, DIED))
        if join(segments, target, None, meanwhile):
            yield target
    shutil.rmtree(ring)


def _has_messages(segment: Path) -> bool:
    try:
        with without_bars(), closing(open_repaired([segment])) as source:
            return source.end_ns is not None
    except RecordingError:
        return False


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
        except OSError:
            yield False
        else:
            yield True
        return
    try:
        lock = os.open(path, os.O_RDWR)
    except OSError:
        yield False
        return
    try:
        yield _is_locked_now(lock, path)
    finally:
        os.close(lock)


def _is_locked_now(lock: int, path: Path) -> bool:
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return os.path.samestat(os.fstat(lock), path.stat())
    except OSError:  # locked by its kernel, or removed
        return False
