"""Opening files: from a path to one clean source of messages."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, closing, suppress
from itertools import pairwise
from pathlib import Path, PurePath

from ..repair import (
    LEAP_NS,
    RESET_NS,
    SUFFIX,
    RecordingError,
    Source,
    find_files,
    has_clock_step,
    is_being_written,
    open_repaired,
)
from ..repair.mcap_records import MAGIC
from ..runtime.text import listed, many
from ..samples.staleness import PARTS_PAUSE
from . import _rosbags
from ._bag import MAGIC as BAG_MAGIC
from ._chain import Chain
from ._fallback import FallbackSource
from ._plain import in_ros as in_ros

_OPENERS: dict[bytes, Callable[[Path], _rosbags.RosbagsSource]] = {
    BAG_MAGIC: _rosbags.open_bag,
    MAGIC: _rosbags.open_mcap,
    b"SQLite format 3\0": _rosbags.open_sqlite,
}
METADATA = "metadata.yaml"
NO_SUCH_PATH = "no such file or folder"
_NUMBER = re.compile(r"\d+")
_HEAD = re.compile(r"^rosbag2_bagfile_information:", re.MULTILINE)
_NAMED = re.compile(r"^\s*-\s+(?:path:\s+)?['\"]?([^'\"\n]*\.(?:db3|mcap)(?:\.zstd)?)['\"]?\s*$", re.MULTILINE)
_COUNT = re.compile(r"^  message_count:\s*(\d+)", re.MULTILINE)
_START = re.compile(r"^  starting_time:\s*\n\s+nanoseconds_since_epoch:\s*(\d+)", re.MULTILINE)
_DURATION = re.compile(r"^  duration:\s*\n\s+nanoseconds:\s*(\d+)", re.MULTILINE)
_SECOND = 1_000_000_000
_NAMED_AT_MOST = 5


def open_source(path: Path) -> Source:
    """Open a file or folder as a source of messages with a clock that never goes back.

    rosbags reads complete files. `repair` reads all others, and continues where rosbags meets damage.

    Raises:
        RecordingError: the path does not exist, or no part of it can be read. The text gives the reason.
    """
    try:
        return _open(path.parent if path.name == METADATA else path)
    except OSError as error:
        raise RecordingError(f"{path}: cannot be read: {error.strerror or error}") from None


def _open(path: Path) -> Source:
    if not path.exists():
        raise RecordingError(f"{path}: {'a link that leads nowhere' if path.is_symlink() else NO_SUCH_PATH}")
    if path.is_dir():
        return _open_folder(path)
    if not path.is_file():
        raise RecordingError(f"{path}: expected a file or a folder, got a pipe or a device")
    return _whole(lambda: _open_by_rosbags(path), [path]) or open_repaired([path])


def _whole(
    open_first: Callable[[], _rosbags.RosbagsSource | Chain], files: Sequence[Path], problems: Sequence[str] = ()
) -> Source | None:
    """Return a source that rosbags reads, or None unless the file is complete and its clock was never set."""
    try:
        with ExitStack() as stack:
            source = open_first()
            stack.callback(source.close)
            if not has_clock_step(source.arrivals):
                stack.pop_all()
                return FallbackSource(source, lambda: open_repaired(files, problems))
    except Exception:  # rosbags raises anything; repair reports the damage
        pass
    return None


def _open_by_rosbags(path: Path) -> _rosbags.RosbagsSource:
    unsaved = path.with_name(f"{path.name}-wal")
    if unsaved.exists() and unsaved.stat().st_size:
        raise RecordingError(f"{path}: rosbags leaves out messages that its recorder had not yet put into it")
    if is_being_written(path):
        raise RecordingError(f"{path}: rosbags does not detect that it is being written")
    with path.open("rb") as file:
        head = file.read(64)
    opener = next((opener for magic, opener in _OPENERS.items() if head.startswith(magic)), None)
    if opener is None:
        raise RecordingError(f"{path}: not a file that rosbags reads by itself")
    return opener(path)


def _open_folder(path: Path) -> Source:
    """Open a rosbag2 folder: the files that its metadata name, else all files."""
    metadata, problems = _metadata(path)
    named = _names_in(metadata or "")
    files = find_files(path)
    files = [file for file in files if file.name in named] or files
    if not files:
        lost = " (a link that leads nowhere)"
        names = sorted(entry.name + ("" if entry.exists() else lost) for entry in path.iterdir())
        there = listed(names, _NAMED_AT_MOST) or "nothing"
        raise RecordingError(f"{path}: no recording in this folder: expected .db3, .mcap or .bag files, got {there}")
    if metadata is None and not _are_parts(files):
        there = listed([file.name for file in files], _NAMED_AT_MOST)
        raise RecordingError(f"{path}: {len(files)} recordings in this folder: open one of them: {there}")
    missing = sorted(name for name in named if not (path / name).exists())
    if missing:
        problems.append(f"{METADATA} names {', '.join(missing)}, not in the folder: read the files that are")

    def open_chain() -> Chain:
        chain = _open_chain(files)
        chain.problems = tuple(problems or _disagreement(metadata or "", chain))
        return chain

    return _whole(open_chain, files, problems) or open_repaired(files, problems)


def is_one_recording(folder: Path) -> bool:
    """Return True if a folder is one recording: it has rosbag2 metadata, or several files, all of them parts of one."""
    if _metadata(folder)[0] is not None:
        return True
    files = find_files(folder)
    return len(files) > 1 and _are_parts(files)


def _are_parts(files: Sequence[Path]) -> bool:
    return counts_up([file.name for file in files]) and _follow_on(files)


def counts_up(names: Sequence[str]) -> bool:
    """Return True if the names are equal except for a last number, which counts up: parts of one recording."""
    stems = [SUFFIX.sub("", name) for name in names]
    numbers = [int(found[-1]) for stem in stems if (found := _NUMBER.findall(stem))]
    alike = len({_NUMBER.sub("", stem) for stem in stems}) == 1
    first = min(numbers, default=0)
    return len(names) == 1 or (alike and numbers == list(range(first, first + len(names))))


def _follow_on(files: Sequence[Path]) -> bool:
    """Return True if each readable file shares most topics with the one before, and continues at its end.

    A file lists only topics with messages in it, so parts may lack different topics with rare messages. The clock may
    have been set meanwhile, back or far ahead. A file that starts no later than the one before is a copy of it. A file
    that starts minutes after the end of the one before is another drive.
    """
    return all(
        2 * len(topics & later_topics) >= min(len(topics), len(later_topics))
        and later_start >= max(end - RESET_NS, min(start + 1, end))
        and not PARTS_PAUSE * _SECOND < later_start - end <= LEAP_NS
        for (topics, start, end), (later_topics, later_start, _) in pairwise(_parts(files))
    )


def _parts(files: Sequence[Path]) -> Iterator[tuple[set[tuple[str, str]], int, int]]:
    """Yield the topics of each readable file, with its start and its end."""
    for file in files if len(files) > 1 else ():
        with suppress(RecordingError), closing(_open(file)) as source:
            if source.start_ns is not None and source.end_ns is not None:
                yield {(c.topic, c.type) for c in source.channels}, source.start_ns, source.end_ns


def _open_chain(files: Sequence[Path]) -> Chain:
    with ExitStack() as stack:
        sources = []
        for file in files:
            sources.append(_open_by_rosbags(file))
            stack.callback(sources[-1].close)
        stack.pop_all()
        return Chain(sources)


def is_described(names: Sequence[str], source: Source, metadata: str) -> bool:
    """Return True if the text of rosbag2 metadata names these files, and agrees with the messages in them."""
    return _names_in(metadata) == {*names} and not _disagreement(metadata, source)


def _names_in(metadata: str) -> set[str]:
    """Return the names of the files in the text of rosbag2 metadata."""
    return {PurePath(name).name for name in _NAMED.findall(metadata)}


def _disagreement(metadata: str, source: Source) -> list[str]:
    """Return a line if the metadata belong to other files, or were written before the last message."""
    count, start, end = sum(channel.count for channel in source.channels), source.start_ns, source.end_ns
    stated_count, stated_start, stated_ns = (line.search(metadata) for line in (_COUNT, _START, _DURATION))
    if stated_count and int(stated_count[1]) != count:
        stated = f"{many(int(stated_count[1]), 'message')}, the files hold {count:,}"
    elif start is None or end is None:
        return []
    elif stated_start and abs(int(stated_start[1]) - start) > _SECOND:
        stated = "another start than the files have"
    elif stated_ns and abs(int(stated_ns[1]) - (end - start)) > _SECOND:
        stated = f"{int(stated_ns[1]) / 1e9:,.1f} s, the files hold {(end - start) / 1e9:,.1f} s"
    else:
        return []
    return [f"{METADATA} states {stated}: read the files"]


def _metadata(path: Path) -> tuple[str | None, list[str]]:
    """Return the text of the rosbag2 metadata, and a line if a file of this name is of no use.

    The text is None without such a file, or for a file of another kind, for example of a collection of recordings.
    """
    try:
        text = (path / METADATA).read_text(errors="replace")
    except FileNotFoundError:
        return None, []
    except OSError as error:
        return "", [f"{METADATA} cannot be read ({error.strerror or error}): read the files without it"]
    if _NAMED.search(text) or _COUNT.search(text):
        return text, []
    problems = [f"{METADATA} is not rosbag2 metadata, or is damaged: read the files without it"]
    return None if text.strip("\0 \r\n") and not _HEAD.search(text) else text, problems
