"""Errors and problems of files that are damaged, or are not recordings."""

from __future__ import annotations

from ..runtime.text import many
from ._found_messages import Damage, Walk
from .mcap_records import MAGIC
from .source import RecordingError

_FORMATS = {
    b"#ROSBAG V": "a ROS 1 bag",
    MAGIC: "an MCAP file",
    b"SQLite format 3\0": "an SQLite database (a rosbag2 .db3)",
    b"\x28\xb5\x2f\xfd": "zstd data",
    b"\x1f\x8b": "gzip data",
    b"BZh": "bzip2 data; unpack it first",
    b"\xfd7zXZ": "xz data; unpack it first",
    b"7z\xbc\xaf\x27\x1c": "a 7z archive; unpack it first",
    b"PK\x03\x04": "a zip archive; unpack it first",
    b"\x89HDF": "an HDF5 file",
    b"PAR1": "a Parquet file; robowidgets.drives() opens an index of drives",
    b"version https://git-lfs": "a pointer of Git LFS, not the file; `git lfs pull` in the checkout fetches it",
}
_BY_GIT = "whose line ends git has changed for good: copy the original again, with `*.{0} binary` in .gitattributes"
_CHANGED_BY_GIT = {
    b"\x89MCAP0\n": f"one {_BY_GIT.format('mcap')}",
    b"#ROSBAG V2.0\r\n": f"one {_BY_GIT.format('bag')}",
}
"""First bytes of files in which git changed CR LF to LF, or LF to CR LF, everywhere in binary data."""
_TAR_AT = 257
HEAD = _TAR_AT + 8
"""The number of bytes at the start of a file that determine its format."""


def format_of(head: bytes) -> str:
    """Return the format of a file by its first bytes, or a description of them; archives with advice to unpack them."""
    for magic, name in (*_CHANGED_BY_GIT.items(), *_FORMATS.items()):
        if head.startswith(magic):
            return name
    if head[_TAR_AT:].startswith(b"ustar"):
        return "a tar archive; unpack it first, with tar -xf"
    shown = head[:16].split(b"\n")[0]
    if shown and all(32 <= byte < 127 or byte == 9 for byte in shown):
        return f"text that starts with {shown.decode()!r}"
    return f"bytes that start with {head[:8].hex(' ')}"


def foreign(name: str, expected: str, head: bytes) -> RecordingError:
    """Return the error for a file that is not a recording in the expected format."""
    return RecordingError(f"{name}: expected {expected}, got {format_of(head)}")


def nothing_readable(walk: Walk) -> RecordingError:
    """Return the error for a file without a readable message."""
    name, damage = walk.name, walk.damage
    if damage.written:
        return RecordingError(f"{name}: is being written, and has no message so far: open it again later")
    if damage.compressions:
        shown = ", ".join(sorted(damage.compressions))
        return RecordingError(f"{name}: compressed with {shown}, which cannot be read: expected none, bz2, lz4 or zstd")
    why = "was cut off before its first message" if damage.cut or damage.unfinished else "is damaged from start to end"
    return RecordingError(
        f"{name}: {why} ({walk.size:,} bytes), nothing can be saved; "
        f"copy it again if the original is whole{walk.hint}, or record again"
    )


def damage_lines(damage: Damage, count: int, span_ns: int) -> tuple[str, ...]:
    """Return one line for each kind of damage in a file that was read in spite of it.

    Args:
        damage: the damage.
        count: number of readable messages.
        span_ns: nanoseconds from the first to the last of these messages.
    """
    amount = f"{many(count, 'message')}, up to {span_ns / 1e9:.1f} s"
    places = f"damaged in {many(damage.places, 'place')}" if damage.places else ""
    lines = []
    if damage.written:
        lines.append(f"the file is being written: read its content so far, {amount}; open it again for the rest")
    elif damage.cut or places:
        what = " and ".join(filter(None, (f"is {places}" if places else "", "was cut off" if damage.cut else "")))
        lines.append(f"the recording {what}: read {amount}")
    elif damage.log:
        lines.append(
            f"the recorder was stopped before it closed the file: read {amount}; "
            "the end of its -wal file is incomplete or damaged, so that messages are missing"
        )
    elif damage.unfinished:
        lines.append(f"the recorder was stopped before it closed the file: read all of its {amount}")
    elif damage.index:
        lines.append(f"the index of the recording is damaged, so it was read without: {amount}")
    if damage.disk:
        lines.append(f"the disk could not read the file to its end ({damage.disk}): read {amount}")
    if damage.checksums:
        chunks = "1 chunk differs" if damage.checksums == 1 else f"{damage.checksums:,} chunks differ"
        lines.append(f"{chunks} from the checksum in the file: some messages may be wrong")
    if damage.compressions:
        shown = ", ".join(sorted(damage.compressions))
        lines.append(f"chunks compressed with {shown} cannot be read: their messages are left out")
    if damage.unnamed:
        lines.append(f"left out {many(damage.unnamed, 'message')} of topics that the file does not name")
    return tuple(lines)
