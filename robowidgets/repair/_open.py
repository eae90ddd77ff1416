"""Opening the files of one recording, recognised by their first bytes, as one clean source."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from errno import EAGAIN
from pathlib import Path
from tempfile import TemporaryDirectory

from ..messages.compression import ZSTD_MAGIC, inflate_to
from . import _bag, _mcap, _sqlite
from ._carmen import walk_carmen
from ._found_messages import Walk
from ._indexed import IndexedSource
from ._report import HEAD, damage_lines, foreign
from .mcap_records import MAGIC
from .source import RecordingError

_WALKS: dict[str, Callable[[Path], Walk]] = {
    ".bag": _bag.walk_bag,
    ".db3": _sqlite.walk_sqlite,
    ".mcap": _mcap.walk_mcap,
}
_MAGICS = {b"#ROS": ".bag", _sqlite.MAGIC: ".db3", MAGIC: ".mcap"}
_ZSTD_SUFFIXES = (".zstd", ".zst")
SUFFIX = re.compile(r"(?<=.)\.(bag|db3|mcap)(\.active|\.zstd?)?$", re.IGNORECASE)
"""Suffixes of recordings. A recorder that was killed leaves a bag as ``drive.bag.active``."""
_BLOCK = 1 << 20
_MOST_UNPACKED = 1 << 30
_MOST_RATIO = 256


def open_repaired(paths: Sequence[Path], problems: Sequence[str] = ()) -> IndexedSource:
    """Return all readable messages of the files of one recording, on a clock that never goes back.

    Each file is read once, with a progress bar; an index of 40 bytes per message stays in memory. If some of several
    files cannot be read, each of these becomes a line in the problems.

    Args:
        paths: the files, in their order: ROS 1 bags, MCAP files, rosbag2 databases, any of them in zstd, CARMEN logs.
        problems: lines to put before all others.

    Raises:
        RecordingError: no file can be read; the text is about the first file.
    """
    found = [_attempt(path) for path in paths]
    errors = [error for error in found if isinstance(error, str)]
    walks = [walk for walk in found if isinstance(walk, Walk)]
    if not walks:
        raise RecordingError(errors[0])
    return IndexedSource(walks, (*problems, *errors))


def find_files(folder: Path) -> list[Path]:
    """Return the recordings in a folder, with numbers in numerical order: ``drive_2.db3`` before ``drive_10.db3``."""
    found = (path for path in folder.iterdir() if SUFFIX.search(path.name) and path.is_file())
    return sorted(found, key=lambda path: natural(path.name))


def is_being_written(path: Path) -> bool:
    """Return True if a program, this one or another, has the file open for writing.

    This is known only on Linux, which refuses a lease on such a file.
    """
    try:
        from fcntl import F_RDLCK, F_SETLEASE, F_SETSIG, F_UNLCK, fcntl
    except ImportError:
        return False
    with path.open("rb") as file:
        try:
            # If a program opens the file for writing between the next lines, a signal comes: use one without an effect.
            fcntl(file, F_SETSIG, signal.SIGURG)
            fcntl(file, F_SETLEASE, F_RDLCK)
            fcntl(file, F_SETLEASE, F_UNLCK)
        except OSError as error:  # other errors mean a file of another user, or a disk without leases
            return error.errno == EAGAIN
    return False


def is_finished(path: Path) -> bool:
    """Return True if a file has the end that its recorder writes last, and no program is known to write to it.

    A file that was compressed as a whole, and a CARMEN log, have no such end.

    Raises:
        OSError: the file cannot be read.
    """
    size = path.stat().st_size
    if not size or is_being_written(path) or _sqlite.files_beside(path) or path.suffix == ".active":
        return False
    with path.open("rb") as file:
        head = file.read(HEAD)
        file.seek(-min(size, len(MAGIC)), os.SEEK_END)
        tail = file.read()
    if head.startswith(MAGIC):
        return size > len(MAGIC) and tail == MAGIC
    if head.startswith(_bag.MAGIC):
        return 0 < _bag.index_in(head) < size
    return not (head.startswith(_sqlite.MAGIC) and _sqlite.is_cut(path))


def _attempt(path: Path) -> Walk | str:
    try:
        written = is_being_written(path)
        walk = _walk_file(path)
        walk.damage.written = written
        return walk
    except RecordingError as error:
        return str(error)
    except OSError as error:
        return f"{path.name}: cannot be opened: {error.strerror or error}"


def _walk_file(path: Path) -> Walk:
    """Walk through one file. Its first bytes decide its format; its suffix decides only if they do not."""
    left_behind = path.with_name(f"{path.name}-wal")
    if left_behind.is_file() and left_behind.stat().st_size:
        return _sqlite.walk_sqlite(path)
    with path.open("rb") as file:
        head = file.read(HEAD)
    if head.startswith(ZSTD_MAGIC):
        return _walk_packed(path)
    own = path.suffix.lower()
    suffix = next((suffix for magic, suffix in _MAGICS.items() if head.startswith(magic)), own)
    if suffix in _WALKS:
        return _WALKS[suffix](path)
    if suffix in (*_ZSTD_SUFFIXES, ".active"):
        raise foreign(path.name, "a ROS 1 bag, an MCAP file or a rosbag2 database", head)
    return walk_carmen(path)


def _walk_packed(path: Path) -> Walk:
    """Walk through a file that was compressed as a whole, by a temporary copy of the decompressed data."""
    try:
        with ExitStack() as stack:
            folder = stack.enter_context(TemporaryDirectory(prefix="robowidgets-"))
            name = path.stem if path.suffix.lower() in _ZSTD_SUFFIXES else path.name
            copy = Path(folder, name)
            limit = max(_MOST_UNPACKED, _MOST_RATIO * path.stat().st_size)
            with path.open("rb") as packed, copy.open("wb") as unpacked:
                whole = inflate_to(unpacked.write, "zstd", iter(lambda: packed.read(_BLOCK), b""), limit)
            if not copy.stat().st_size:
                raise RecordingError(f"{path.name}: its zstd data is damaged or cut off at its start; copy it again")
            with copy.open("rb") as file:
                if file.read(4) == ZSTD_MAGIC:
                    raise RecordingError(f"{path.name}: expected a recording in zstd, got zstd within zstd")
            walk = _walk_file(copy)
            stack.callback(walk.close)
            walk.close = stack.pop_all().close
    except OSError as error:
        raise RecordingError(f"{path.name}: cannot be unpacked: {error.strerror or error}") from None
    if not whole and not damage_lines(walk.damage, 0, 0):
        walk.problems += ("its zstd data is damaged or cut off: read what comes before",)
    return walk


def natural(name: str) -> list[tuple[bool, int, str]]:
    """Return a key that sorts names with numbers in numerical order."""
    parts = re.findall(r"\d+|\D+", name)
    return [(part.isdecimal(), int(part) if part.isdecimal() else 0, part) for part in parts]
