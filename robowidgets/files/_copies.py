"""Local copies of remote recordings, in a folder of limited size."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp

from ..repair import RecordingError
from ..runtime.cache_folder import cache_folder
from ..runtime.text import megabytes

try:
    import fcntl
except ImportError:  # Windows does not move or remove open files
    fcntl = None  # type: ignore[assignment]

SIZE = "ROBOWIDGETS_CACHE_SIZE"
"""The environment variable with the maximum size of all copies."""

_USUAL = "10 GB"
_UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12}
_LOCK = ".lock"
_PART = ".part-"
_LEFT_BEHIND = 60.0 if fcntl else 86_400.0
"""Seconds after which an unlocked partial copy is left over from a process that ended: a live one locks its copy at
once."""


class Copy:
    """A copy that is not removed before this object is closed.

    Args:
        folder: the folder of the copy.
        lock: a descriptor of the lock file, which stays locked while the copy is used, or None if the system has no
            locks.
    """

    def __init__(self, folder: Path, lock: int | None) -> None:
        self.folder, self._lock = folder, lock

    def close(self) -> None:
        """Allow the copy to be removed when room is needed; closing it again does nothing."""
        lock, self._lock = self._lock, None
        if lock is not None:
            os.close(lock)

    def __del__(self) -> None:
        self.close()


def most_bytes() -> int:
    """Return the maximum size of all copies in bytes.

    Raises:
        RecordingError: the environment variable is not a size.
    """
    text = os.environ.get(SIZE) or _USUAL
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kmgt]?)b?\s*", text, re.IGNORECASE)
    if found is None:
        raise RecordingError(f"{SIZE}: expected a size such as '20 GB', got {text!r}")
    return int(float(found[1]) * _UNITS[found[2].lower()])


def copies_folder() -> Path:
    """Return the folder of the copies."""
    return cache_folder() / "remote"


def holding(path: Path) -> Copy | None:
    """Return the copy that a path lies in, which stays until it is closed, or None for any other path."""
    with suppress(ValueError):
        return find(path.relative_to(copies_folder()).parts[0])
    return None


def find(key: str) -> Copy | None:
    """Return the copy of this name and note its use, or None if it does not exist."""
    folder = copies_folder() / key
    try:
        lock = _locked(folder)
        os.utime(folder / _LOCK)
    except OSError:  # missing, or just removed
        return None
    return Copy(folder, lock)


def make(key: str, size: int, write: Callable[[Path], None]) -> Copy:
    """Make a new copy. It appears under its name when it is complete; after an error nothing is left.

    Args:
        key: the name of the copy.
        size: the approximate size in bytes; the least recently used copies that are not open are removed to make room.
        write: writes the recording into a folder.

    Raises:
        RecordingError: the copy is larger than the limit for all copies, or the disk is full.
        OSError: the folder cannot be written.
    """
    limit, root = most_bytes(), copies_folder()
    if size > limit:
        raise RecordingError(
            f"it has {megabytes(size)}, and copies may take {megabytes(limit)}: set {SIZE} higher, as in '50 GB'"
        )
    root.mkdir(parents=True, exist_ok=True)
    _make_room(root, limit - size)
    free = shutil.disk_usage(root).free
    if size > free:
        raise RecordingError(f"it has {megabytes(size)}, and the disk of {root} has {megabytes(free)} left: free some")
    part = Path(mkdtemp(prefix=_PART, dir=root))
    copy = Copy(part, None)
    try:
        (part / _LOCK).touch()
        copy = Copy(part, _locked(part))
        write(part)
        try:
            part.rename(root / key)
        except OSError:
            there = find(key)  # another process was faster
            if there is None:
                raise
            shutil.rmtree(part)
            copy.close()
            return there
    except BaseException:
        copy.close()
        shutil.rmtree(part, ignore_errors=True)
        raise
    copy.folder = root / key
    return copy


def _locked(folder: Path, alone: bool = False) -> int | None:
    """Lock a copy: shared by its readers, or alone to remove it.

    Raises:
        OSError: the copy does not exist, or another process has locked it.
    """
    if fcntl is None:
        (folder / _LOCK).stat()
        return None
    lock = os.open(folder / _LOCK, os.O_RDWR)
    try:
        fcntl.flock(lock, (fcntl.LOCK_EX if alone else fcntl.LOCK_SH) | fcntl.LOCK_NB)
        if not os.path.samestat(os.fstat(lock), (folder / _LOCK).stat()):
            raise FileNotFoundError(str(folder))
    except BaseException:
        os.close(lock)
        raise
    return lock


def _make_room(root: Path, most: int) -> None:
    """Remove the least recently used copies until the others take no more than some bytes."""
    found = sorted(_ages_and_sizes(root))
    total = sum(size for _, size, _ in found)
    for used, size, folder in found:
        is_left_behind = folder.name.startswith(_PART) and used < time.time() - _LEFT_BEHIND
        if is_left_behind or (total > most and not folder.name.startswith(_PART)):
            with suppress(OSError):  # another process reads it
                _remove(folder)
                total -= size


def _remove(folder: Path) -> None:
    lock = Copy(folder, _locked(folder, alone=True))
    try:
        gone = Path(mkdtemp(prefix=_PART, dir=folder.parent), "gone")
        folder.rename(gone)
        shutil.rmtree(gone.parent)
    finally:
        lock.close()


def _ages_and_sizes(root: Path) -> Iterator[tuple[float, int, Path]]:
    for folder in root.iterdir():
        with suppress(OSError):
            used = (folder / _LOCK).stat().st_mtime
            yield used, sum(file.stat().st_size for file in folder.rglob("*") if file.is_file()), folder
