"""Local copies of recordings that lie elsewhere, in a folder of limited size."""

from __future__ import annotations

import os
import re
import shutil
import time
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path
from tempfile import mkdtemp

from .._core.cache_folder import cache_folder
from .._core.text import megabytes
from ..repair import RecordingError

try:
    import fcntl
except ImportError:  # Windows moves and removes no file that is open
    fcntl = None  # type: ignore[assignment]

SIZE = "ROBOWIDGETS_CACHE_SIZE"
"""The environment variable with the most bytes that the copies take."""

_USUAL = "10 GB"
_UNITS = {"": 1, "k": 10**3, "m": 10**6, "g": 10**9, "t": 10**12}
_LOCK = ".lock"
_PART = ".part-"
_LEFT_BEHIND = 60.0 if fcntl else 86_400.0
"""Seconds after which a part that nobody holds is one whose process ended: by then, whoever made it holds it."""


class Copy:
    """A copy that stays while this is not closed.

    Args:
        folder: what holds it.
        lock: a descriptor of the file that is locked as long as the copy is used; None where there are no locks.
    """

    def __init__(self, folder: Path, lock: int | None) -> None:
        self.folder, self._lock = folder, lock

    def close(self) -> None:
        """Let it be removed when room is needed; doing it again does nothing."""
        lock, self._lock = self._lock, None
        if lock is not None:
            os.close(lock)

    def __del__(self) -> None:
        self.close()


def most_bytes() -> int:
    """The most bytes that the copies take.

    Raises:
        RecordingError: the environment variable is no size.
    """
    text = os.environ.get(SIZE) or _USUAL
    found = re.fullmatch(r"\s*(\d+(?:\.\d+)?)\s*([kmgt]?)b?\s*", text, re.IGNORECASE)
    if found is None:
        raise RecordingError(f"{SIZE}: expected a size such as '20 GB', got {text!r}")
    return int(float(found[1]) * _UNITS[found[2].lower()])


def copies_folder() -> Path:
    """Where the copies are."""
    return cache_folder() / "remote"


def holding(path: Path) -> Copy | None:
    """The copy that a path lies in, which stays until it is closed; None for any other path."""
    with suppress(ValueError):
        return find(path.relative_to(copies_folder()).parts[0])
    return None


def find(key: str) -> Copy | None:
    """The copy of this name, which is now the last that was used; None without one."""
    folder = copies_folder() / key
    try:
        lock = _locked(folder)
        os.utime(folder / _LOCK)
    except OSError:  # not there, or just removed
        return None
    return Copy(folder, lock)


def make(key: str, size: int, write: Callable[[Path], None]) -> Copy:
    """A new copy, there under its name when it is complete. After an error nothing of it is left.

    Args:
        key: its name.
        size: about how many bytes it takes: for these, those go that were used longest ago, but for open ones.
        write: writes it into a folder.

    Raises:
        RecordingError: it is larger than all copies may be, or the disk is full.
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
        raise RecordingError(f"it has {megabytes(size)}, and the disk of {root} has {megabytes(free)} left")
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
    """A lock on a copy, which many hold who read it, and one alone who removes it.

    Raises:
        OSError: there is no such copy, or others hold it.
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
    """Remove those used longest ago until the others take no more than some bytes."""
    found = sorted(_ages_and_sizes(root))
    total = sum(size for _, size, _ in found)
    for used, size, folder in found:
        is_left_behind = folder.name.startswith(_PART) and used < time.time() - _LEFT_BEHIND
        if is_left_behind or (total > most and not folder.name.startswith(_PART)):
            with suppress(OSError):  # somebody reads it
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
