"""A span of a recording as an MCAP file that stands alone: its messages unchanged, and before them what still holds."""

from __future__ import annotations

import os
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

from ..messages.channel import Channel
from ..messages.event import LOG_TYPES
from ..repair import Message, RecordingError, Source, find_files
from ..runtime.inform import inform
from ..runtime.output_file import checked_output
from ..runtime.text import megabytes
from .program_log import PROGRAM, STATES

if TYPE_CHECKING:
    from mcap.records import Attachment

METADATA = "robowidgets cut"
"""The name of the record with the origin of a cut: its file, and its first and last second there."""

_STATIC = "/tf_static"
_DESCRIPTION = "/robot_description"
_MAP = "nav_msgs/msg/OccupancyGrid"
_ROSBAG2 = "rosbag2"
"""The name of a record with the counts of the whole file, which do not hold for a part."""
_FIRST_LOOK_NS = 1_000_000_000
_MOST_ATTACHED = 100_000_000

NamedValues = tuple[str, dict[str, str]]


def checked_target(call: str, path: str | os.PathLike[str], recording: Path, overwrite: bool) -> Path:
    """Return the absolute path of a cut.

    Raises:
        FileExistsError: the file exists and may not be overwritten, or it belongs to the recording. Others: as
            `checked_output`.
    """
    target = checked_output(call, path, (".mcap",))
    source = Path(os.path.realpath(recording))
    if target == source or (source.is_dir() and target.parent == source):
        raise FileExistsError(f"{call}(): {str(target)!r} is part of the recording itself; name another file")
    if target.exists() and not overwrite:
        raise FileExistsError(f"{call}(): {str(target)!r} exists; name another file, or give overwrite=True")
    return target


def write_cut(source: Source, recording: Path, target: Path, start_ns: int | None, stop_ns: int | None) -> None:
    """Write the messages of all topics from a time up to, not including, another.

    The first time also has the messages that a node would get there which subscribes then: all of /tf_static, and the
    last one of each latched topic, map, robot description and program. The file appears once it is complete.

    Args:
        source: the messages as the recording has them.
        recording: its file or folder.
        target: the file, from `checked_target`.
        start_ns: the start by the clock of the recording, or None for its start.
        stop_ns: the end, or None to include its last message.

    Raises:
        ValueError: the span has no message, or lies outside of the recording. RecordingError: the file cannot be
            written.
    """
    from ..repair.write import write_messages  # Imported lazily: reading samples needs no mcap.

    begin_ns, last_ns = source.start_ns or 0, source.end_ns or 0
    start_ns = begin_ns if start_ns is None else max(start_ns, begin_ns)
    end_ns = last_ns if stop_ns is None else stop_ns
    start, end, length = ((time_ns - begin_ns) / 1e9 for time_ns in (start_ns, end_ns, last_ns))
    for name, seconds, is_beyond in (("start", start, start > length), ("end", end, end < 0)):
        if is_beyond:
            raise ValueError(f"{name}: expected seconds from 0 to {length:.2f}, got {seconds:g}")
    messages = source.messages(source.channels, start_ns, stop_ns)
    first = next(messages, None)
    if first is None:
        raise ValueError(f"{recording.name}: no message from {start:.3f} s to {end:.3f} s; name a longer span")

    def in_order() -> Iterator[Message]:
        yield from ((channel, start_ns, data) for channel, _, data in _still_valid(source, start_ns))
        yield first
        yield from messages

    origin = {"recording": recording.name, "start": f"{start:.9f}", "end": f"{min(end, length):.9f}"}
    records, attachments, problems = _extras(recording)
    written = write_messages(source, target, in_order(), None, [*records, (METADATA, origin)], attachments)
    for line in (*problems, *written.problems):
        inform(f"{target.name}: {line}")


def _still_valid(source: Source, start_ns: int) -> list[Message]:
    """Return the messages before a time that still hold at it, in the order of time."""
    found: list[Message] = []
    static = [channel for channel in source.channels if is_static(channel)]
    # Each publisher sends its own transforms, some of them again and again: each message counts once.
    known = {(message[0].id, message[2]): message for message in source.messages(static, None, start_ns)}
    found += known.values()
    for channel in source.channels:
        if channel not in static and is_lasting(channel) and (last := _last(source, channel, start_ns)):
            found.append(last)
    return sorted(found, key=lambda message: message[1])


def is_static(channel: Channel) -> bool:
    """Return True if all messages of a channel hold from then on, until one of them comes again."""
    return channel.topic.endswith(_STATIC)


def is_lasting(channel: Channel) -> bool:
    """Return True if the last message of a channel holds until the next one."""
    return (
        (channel.is_latched and channel.type not in LOG_TYPES)
        or channel.type == _MAP
        or channel.topic.endswith(_DESCRIPTION)
        or channel.topic == PROGRAM
        or channel.topic.startswith(STATES)
    )


def _last(source: Source, channel: Channel, start_ns: int) -> Message | None:
    """Return the last message of a channel before a time, or None without one."""
    begin, look = start_ns, _FIRST_LOOK_NS
    while channel.count and begin > (source.start_ns or 0):
        end, begin = begin, max(source.start_ns or 0, begin - look)
        last = None
        for last in source.messages([channel], begin, end):  # noqa: B007  # the last one counts
            pass
        if last is not None:
            return last
        look *= 4
    return None


def _extras(recording: Path) -> tuple[list[NamedValues], list[Attachment], list[str]]:
    """Return the metadata records and the attachments of the MCAP files of a recording, and lines on lost ones."""
    if not recording.exists():
        return (
            [],
            [],
            [f"attachments and metadata of {recording.name} are left out: it is read from its server in parts"],
        )
    from mcap.exceptions import McapError
    from mcap.reader import make_reader

    records: list[NamedValues] = []
    attachments: list[Attachment] = []
    problems = []
    for path in find_files(recording) if recording.is_dir() else [recording]:
        with path.open("rb") as file:
            if file.read(5) != b"\x89MCAP":
                continue
            file.seek(0)
            try:
                reader = make_reader(file)
                summary = reader.get_summary()
                if summary is None:
                    continue
                records += [(one.name, dict(one.metadata)) for one in reader.iter_metadata() if one.name != _ROSBAG2]
                size = sum(one.data_size for one in summary.attachment_indexes)
                if size > _MOST_ATTACHED:
                    problems.append(f"attachments of {path.name} are left out: they have {megabytes(size)}")
                else:
                    attachments += reader.iter_attachments()
            except (
                McapError,
                ValueError,
                OSError,
                struct.error,
            ) as error:  # of a damaged file: its messages are read nevertheless
                problems.append(f"attachments and metadata of {path.name} cannot be read: {error}")
    return records, attachments, problems


def cut(
    source: Source,
    recording: Path,
    call: str,
    path: str | os.PathLike[str],
    span_ns: tuple[int | None, int | None],
    overwrite: bool,
) -> Path:
    """Check the path of a cut, write it, and return its path; see `checked_target` and `write_cut`."""
    if source.start_ns is None:
        raise RecordingError(f"{recording.name} has no message, so there is nothing to cut")
    target = checked_target(call, path, recording, overwrite)
    write_cut(source, recording, target, *span_ns)
    return target
