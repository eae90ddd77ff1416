"""From a path to what is recorded there: what kind of file it is, and who reads it."""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path, PurePath

from .._core.text import listed
from ..repair import find_files, open_file
from ..repair._carmen import CarmenLog
from ..repair._carmen_lines import word_of
from ..repair._one_clock import in_order, was_set
from ..repair._report import kind
from ..repair.source import RecordingError, Source
from . import ros_files
from .chain import Chain, open_chain
from .message_timeline import MessageTimeline
from .relay import Relay
from .timeline import Timeline

_EXPECTED = "a ROS bag (.bag), a rosbag2 folder, a .db3, an .mcap or a CARMEN log (.log, .clf, gzipped or not)"
_QUICK = {
    b"#ROSBAG V2.0\n": ros_files.open_bag,
    b"\x89MCAP0\r\n": ros_files.open_mcap,
    b"SQLite format 3\0": ros_files.open_sqlite,
}
_SALVAGED = (".bag", ".db3", ".mcap", ".zst", ".zstd", ".active")
_GZIP = b"\x1f\x8b"
_METADATA = "metadata.yaml"
_OWN = re.compile(r"\d+|\.zstd?$")
_NAMED = re.compile(r"^\s*-\s+(?:path:\s+)?['\"]?([^'\"\n]*\.(?:db3|mcap)(?:\.zstd)?)['\"]?\s*$", re.MULTILINE)
_PACKED = re.compile(r"^\s*compression_mode:\s*['\"]?(file|message)", re.MULTILINE | re.IGNORECASE)
_NAMED_AT_MOST = 5
_BLOCK = 1 << 16
_LOOKED_AT = 1 << 20
_SMALL = 1 << 26
_RATIO = 20
"""Bytes of text from one of a gzipped log, at most: real ones give ten. Up to `_SMALL` any do."""


def open_timeline(path: Path) -> Timeline:
    """What is recorded in a file or folder.

    Raises:
        RecordingError: there is nothing, or nothing of it can be read; the text says why.
    """
    try:
        return _open(path.parent if path.name == _METADATA else path)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from None


def _open(path: Path) -> Timeline:
    if not path.exists():
        raise RecordingError(f"{path}: no such file or folder")
    if path.is_dir():
        return MessageTimeline(_open_folder(path))
    if not path.is_file():
        raise RecordingError(f"{path}: expected a file or a folder, got a pipe or a device")
    with path.open("rb") as file:
        head = file.read(64)
    if path.suffix in _SALVAGED or any(head.startswith(magic) for magic in _QUICK):
        return MessageTimeline(_open_file(path))
    return _open_log(path, head)


def _open_file(path: Path) -> Source:
    """A file of messages: by rosbags where it can, else by the reader made for damage, which knows their order."""
    patient = partial(open_file, path)
    return _running(lambda: _open_quick(path), patient) or in_order(patient())


def _running(open_quick: Callable[[], Source], patient: Callable[[], Source]) -> Source | None:
    """A source that rosbags can read, and whose clock was never set."""
    try:
        with ExitStack() as stack:
            quick = open_quick()
            stack.callback(quick.close)
            if not was_set(quick):
                stack.pop_all()
                return Relay(quick, patient)
    except Exception:  # rosbags raises what it stumbles over; what is wrong, the patient reader finds out and tells
        pass
    return None


def _open_quick(path: Path) -> Source:
    unsaved = path.with_name(f"{path.name}-wal")
    if unsaved.exists() and unsaved.stat().st_size:
        raise RecordingError(f"{path}: rosbags leaves out what its recorder had not yet put into it")
    with path.open("rb") as file:
        head = file.read(64)
    opener = next((opener for magic, opener in _QUICK.items() if head.startswith(magic)), None)
    if opener is None:
        raise RecordingError(f"{path}: not a file that rosbags reads by itself")
    return opener(path)


def _open_folder(path: Path) -> Source:
    """A rosbag2 folder, by its metadata or, where they are missing or of no use, file by file."""
    files = find_files(path)
    if (path / _METADATA).exists() and not _is_packed(path):
        patient = partial(open_chain, files, open_file)
        if quick := _running(lambda: ros_files.open_folder(path), patient):
            return quick
    if not files:
        held = listed(sorted(entry.name for entry in path.iterdir()), _NAMED_AT_MOST) or "nothing"
        raise RecordingError(f"{path}: no recording in this folder: expected .db3, .mcap or .bag files, got {held}")
    if not (path / _METADATA).exists() and len({_OWN.sub("", file.name) for file in files}) > 1:
        held = listed([file.name for file in files], _NAMED_AT_MOST)
        raise RecordingError(f"{path}: {len(files)} recordings in this folder: open one of them: {held}")
    source = open_chain(files, _open_file)
    if len(files) > 1 and was_set(source):
        source.close()
        source = open_chain(files, open_file)
        in_order(source)
    missing = _missing(path)
    return Chain([("", source)], problems=[missing]) if missing else source


def _is_packed(path: Path) -> bool:
    """Whether the metadata say that files or messages are compressed by themselves.

    rosbags unpacks these for as long as there is room; the readers for single files know where to stop.
    """
    try:
        return bool(_PACKED.search((path / _METADATA).read_text(errors="replace")))
    except OSError:
        return False


def _missing(path: Path) -> str:
    """A line about the files that the metadata name and that are not there; empty when there are none."""
    try:
        text = (path / _METADATA).read_text(errors="replace")
    except OSError:
        return ""
    names = {PurePath(name).name for name in _NAMED.findall(text)}
    missing = sorted(name for name in names if not (path / name).exists())
    return f"{_METADATA} names {', '.join(missing)}, not in the folder: read the files that are" if missing else ""


def _open_log(path: Path, head: bytes) -> CarmenLog:
    if not head:
        raise RecordingError(f"{path.name}: the file is empty: expected {_EXPECTED}")
    packed = head.startswith(_GZIP)
    with path.open("rb") as file:
        start = file.read(_LOOKED_AT)
        start = _gunzip(start, _LOOKED_AT)[0] if packed else start
        if not any(word_of(line) for line in start.splitlines()):
            raise RecordingError(f"{path.name}: expected {_EXPECTED}, got {_kind(start, head)}")
        file.seek(0)
        text = file.read()
    if not packed:
        return CarmenLog(text)
    limit = max(_SMALL, _RATIO * len(text))
    text, whole = _gunzip(text, limit)
    if len(text) == limit and not whole:
        return CarmenLog(
            text, [f"more than {_RATIO} times its size comes out of the file: read the first {limit:,} bytes"]
        )
    return CarmenLog(text, [] if whole else ["the file was cut off or is damaged: read what could be decompressed"])


def _kind(start: bytes, head: bytes) -> str:
    """What a file is that is no CARMEN log, by its start, decompressed if it was gzipped, and by its first bytes."""
    if not head.startswith(_GZIP) or not start:
        return kind(head)
    return f"{kind(start[:64])} in gzip: unpack it with gunzip"


def _gunzip(data: bytes, limit: int) -> tuple[bytes, bool]:
    """What can be decompressed, up to a limit, and whether that is all of it."""
    text = bytearray()
    stream = zlib.decompressobj(wbits=31)
    try:
        for start in range(0, len(data), _BLOCK):
            text += stream.decompress(data[start : start + _BLOCK], limit - len(text) + 1)
            if len(text) > limit:
                return bytes(text[:limit]), False
    except zlib.error:
        return bytes(text), False
    return bytes(text), stream.eof
