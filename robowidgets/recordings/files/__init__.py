"""The door to files: from a path to one clean source of messages."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from contextlib import ExitStack
from pathlib import Path, PurePath

from ..._core.text import listed
from ...repair import RecordingError, Source, find_files, open_repaired, was_set
from . import _rosbags
from ._chain import Chain
from ._fallback import FallbackSource

_OPENERS = {
    b"#ROSBAG V2.0\n": _rosbags.open_bag,
    b"\x89MCAP0\r\n": _rosbags.open_mcap,
    b"SQLite format 3\0": _rosbags.open_sqlite,
}
_METADATA = "metadata.yaml"
_OWN = re.compile(r"\d+|\.zstd?$")
_NAMED = re.compile(r"^\s*-\s+(?:path:\s+)?['\"]?([^'\"\n]*\.(?:db3|mcap)(?:\.zstd)?)['\"]?\s*$", re.MULTILINE)
_PACKED = re.compile(r"^\s*compression_mode:\s*['\"]?(file|message)", re.MULTILINE | re.IGNORECASE)
_NAMED_AT_MOST = 5


def open_source(path: Path) -> Source:
    """The messages in a file or folder, by a clock that never goes back.

    rosbags reads whole files. `repair` reads all others, and takes over where reading meets damage.

    Raises:
        RecordingError: there is nothing, or nothing of it can be read; the text says why.
    """
    try:
        return _open(path.parent if path.name == _METADATA else path)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from None


def _open(path: Path) -> Source:
    if not path.exists():
        raise RecordingError(f"{path}: no such file or folder")
    if path.is_dir():
        return _open_folder(path)
    if not path.is_file():
        raise RecordingError(f"{path}: expected a file or a folder, got a pipe or a device")
    return _whole(lambda: _open_by_rosbags(path), [path]) or open_repaired([path])


def _whole(
    open_first: Callable[[], _rosbags.RosbagsSource | Chain], files: Sequence[Path], problems: Sequence[str] = ()
) -> Source | None:
    """A source that rosbags can read, and whose clock was never set; None where there is damage."""
    try:
        with ExitStack() as stack:
            source = open_first()
            stack.callback(source.close)
            if not was_set(source.arrivals()):
                stack.pop_all()
                return FallbackSource(source, lambda: open_repaired(files, problems))
    except Exception:  # rosbags raises anything; repair finds out what is wrong
        pass
    return None


def _open_by_rosbags(path: Path) -> _rosbags.RosbagsSource:
    unsaved = path.with_name(f"{path.name}-wal")
    if unsaved.exists() and unsaved.stat().st_size:
        raise RecordingError(f"{path}: rosbags leaves out what its recorder had not yet put into it")
    with path.open("rb") as file:
        head = file.read(64)
    opener = next((opener for magic, opener in _OPENERS.items() if head.startswith(magic)), None)
    if opener is None:
        raise RecordingError(f"{path}: not a file that rosbags reads by itself")
    return opener(path)


def _open_folder(path: Path) -> Source:
    """A rosbag2 folder, by its metadata or, where they are missing or of no use, file by file."""
    files = find_files(path)
    metadata = _metadata(path)
    # rosbags unpacks compressed files and messages for as long as there is room.
    if metadata and not _PACKED.search(metadata) and (source := _whole(lambda: _rosbags.open_folder(path), files)):
        return source
    if not files:
        there = listed(sorted(entry.name for entry in path.iterdir()), _NAMED_AT_MOST) or "nothing"
        raise RecordingError(f"{path}: no recording in this folder: expected .db3, .mcap or .bag files, got {there}")
    if metadata is None and len({_OWN.sub("", file.name) for file in files}) > 1:
        there = listed([file.name for file in files], _NAMED_AT_MOST)
        raise RecordingError(f"{path}: {len(files)} recordings in this folder: open one of them: {there}")
    problems = _missing(path, metadata or "")
    return _whole(lambda: _open_chain(files, problems), files, problems) or open_repaired(files, problems)


def _open_chain(files: Sequence[Path], problems: Sequence[str]) -> Chain:
    with ExitStack() as stack:
        sources = []
        for file in files:
            sources.append(_open_by_rosbags(file))
            stack.callback(sources[-1].close)
        stack.pop_all()
        return Chain(sources, problems)


def _metadata(path: Path) -> str | None:
    """The text of the metadata, empty where it cannot be read; None where there is none."""
    file = path / _METADATA
    try:
        return file.read_text(errors="replace") if file.exists() else None
    except OSError:  # the files are read without it
        return ""


def _missing(path: Path, metadata: str) -> list[str]:
    """A line about the files that the metadata name and that are not there."""
    names = {PurePath(name).name for name in _NAMED.findall(metadata)}
    missing = sorted(name for name in names if not (path / name).exists())
    return [f"{_METADATA} names {', '.join(missing)}, not in the folder: read the files that are"] if missing else []
