"""Any one file of messages, told by how it starts, and the files of a folder that has no list of them."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from tempfile import TemporaryDirectory

from ..recordings.chain import Chain
from . import _bag as bag
from . import _mcap as mcap
from . import _sqlite as sqlite
from . import _sqlite_file as sqlite_file
from ._inflate import ZSTD_MAGIC, inflate_to
from ._report import foreign
from ._stretch import FileStretch
from .source import RecordingError, SavedSource

SUFFIXES = (".bag", ".db3", ".mcap")
_OPENERS: dict[str, Callable[[Path], SavedSource]] = {
    ".bag": bag.open_bag,
    ".db3": sqlite.open_sqlite,
    ".mcap": mcap.open_mcap,
}
_MAGICS = {b"#ROS": ".bag", sqlite_file.MAGIC: ".db3", mcap.MAGIC: ".mcap"}
_ZSTD_SUFFIXES = (".zstd", ".zst")
_BLOCK = 1 << 20
_MOST_UNPACKED = 1 << 30
_MOST_RATIO = 256


def open_file(path: Path) -> SavedSource:
    """Whatever can be saved of one file: a ROS 1 bag, an MCAP file or a rosbag2 database, by itself or in zstd.

    How the file starts decides, and its name only where that says nothing.

    Args:
        path: the file.

    Raises:
        RecordingError: it is none of these, or holds nothing that can be saved.
    """
    left_behind = path.with_name(f"{path.name}-wal")
    if left_behind.is_file() and left_behind.stat().st_size:
        return sqlite.open_sqlite(path)
    head = _head(path)
    if head.startswith(ZSTD_MAGIC):
        return _open_packed(path)
    suffix = next((suffix for magic, suffix in _MAGICS.items() if head.startswith(magic)), path.suffix)
    if suffix not in _OPENERS:
        raise foreign(path.name, "a ROS 1 bag, an MCAP file or a rosbag2 database", head)
    return _OPENERS[suffix](path)


def find_files(folder: Path) -> list[Path]:
    """The recordings that lie in a folder, in the order a person counts: ``drive_2.db3`` before ``drive_10.db3``."""
    return sorted((path for path in folder.iterdir() if _is_recording(path)), key=lambda path: _natural(path.name))


def _is_recording(path: Path) -> bool:
    name = path.with_suffix("") if path.suffix in _ZSTD_SUFFIXES else path
    return name.suffix in SUFFIXES and path.is_file()


def _natural(name: str) -> list[tuple[bool, int, str]]:
    parts = re.findall(r"\d+|\D+", name)
    return [(part.isdecimal(), int(part) if part.isdecimal() else 0, part) for part in parts]


def _head(path: Path) -> bytes:
    file = FileStretch(path)
    try:
        return file.read(0, 64)
    finally:
        file.close()


def _open_packed(path: Path) -> SavedSource:
    """A file that was compressed as a whole: what of it decompresses, from a temporary copy."""
    folder = TemporaryDirectory(prefix="robowidgets-")
    try:
        copy = Path(folder.name, path.name.removesuffix(path.suffix) if path.suffix in _ZSTD_SUFFIXES else path.name)
        limit = max(_MOST_UNPACKED, _MOST_RATIO * path.stat().st_size)
        with path.open("rb") as packed, copy.open("wb") as unpacked:
            whole = inflate_to(unpacked.write, "zstd", iter(lambda: packed.read(_BLOCK), b""), limit)
        if not copy.stat().st_size:
            raise RecordingError(f"{path.name}: its zstd data is damaged or cut off where it starts; copy it again")
        if _head(copy).startswith(ZSTD_MAGIC):
            raise RecordingError(f"{path.name}: expected a recording in zstd, got zstd within zstd")
        source = open_file(copy)
        problems = () if whole or source.problems else ("its zstd data is damaged or cut off: read what comes before",)
        return Chain([("", source)], problems, folder.cleanup)
    except BaseException as error:
        folder.cleanup()
        if isinstance(error, OSError):
            raise RecordingError(f"{path.name}: cannot be unpacked: {error.strerror or error}") from None
        raise
