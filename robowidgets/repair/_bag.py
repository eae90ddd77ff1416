"""ROS 1 bags (format 2.0), read record by record, without their index."""

from __future__ import annotations

import re
import struct
from pathlib import Path
from shlex import quote

from ..messages.channel import Channel
from ._byte_range import ByteRange, find
from ._found_messages import Damage, Walk
from ._record_reader import MAX_TEXT, Record, RecordReader
from ._report import HEAD, foreign
from .source import RecordingError

MAGIC = b"#ROSBAG V2.0\n"
_MESSAGE, _FILE, _INDEX, _CHUNK, _CHUNK_INFO, _CONNECTION = range(2, 8)
_NEEDED: dict[int, dict[str, int | None]] = {
    _MESSAGE: {"conn": 4, "time": 8},
    _FILE: {"index_pos": 8},
    _INDEX: {"conn": 4, "count": 4},
    _CHUNK: {"compression": None, "size": 4},
    _CHUNK_INFO: {"chunk_pos": 8, "count": 4},
    _CONNECTION: {"conn": 4, "topic": None},
}
_PLAIN = b"none"
_MAX_HEADER = 1 << 12
_MAX_FIELDS = 16
_HEADER = re.compile(
    rb"(?=..\0\0..\0\0(?:op|conn|time|topic|compression|size|ver|count|chunk_pos|start_time|end_time|latching|callerid)=)",
    re.DOTALL,
)
_HEADER_LENGTH = 20
_VERSION = re.compile(rb"#ROS(?:BAG|RECORD|LOG) V(\d+\.\d+)")


def walk_bag(path: Path) -> Walk:
    """Find all readable messages of a ROS 1 bag, which may lack an index or be damaged.

    Args:
        path: the file, with any suffix.

    Raises:
        RecordingError: the file cannot be opened, is not a ROS 1 bag of format 2.0, or is encrypted.

    Source: http://wiki.ros.org/Bags/Format/2.0
    """
    return _Reader(path).walk()


def index_in(head: bytes) -> int:
    """Return the place of the index by the first bytes of a bag, or 0 if its recorder has not written it yet."""
    _, found, after = head[:HEAD].partition(b"index_pos=")
    return _uint(after[:8]) if found and len(after) >= 8 else 0


class _Reader(RecordReader):
    """One walk through a bag."""

    magic = MAGIC
    index_ops = frozenset((_INDEX, _CHUNK_INFO))
    inner_ops = frozenset((_MESSAGE, _CONNECTION))
    chunk_op = _CHUNK

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.by_id: dict[int, Channel] = {}

    def check(self) -> None:
        """See `RecordReader`."""
        name, head = self.file.name, self.file.read(0, HEAD)
        if head.startswith(MAGIC):
            return
        version = _VERSION.match(head)
        if version and version[1] != b"2.0":
            raise RecordingError(
                f"{name}: a bag of format {version[1].decode()}: only ROS 1 bags of format 2.0 can be read; "
                f"with ROS 1 installed, `rosbag filter {quote(name)} new.bag True` writes it as 2.0"
            )
        raise foreign(name, "a ROS 1 bag of format 2.0", head)

    def channels(self) -> list[Channel]:
        """Return the connections."""
        return list(self.by_id.values())

    def record(self, data: ByteRange, record: Record, chunk: int, damage: Damage) -> None:
        """Index a record of the file (chunk -1) or of a chunk."""
        if record.op == _MESSAGE and record.whole:
            seconds, nanoseconds = struct.unpack("<II", record.fields["time"])
            time_ns = seconds * 10**9 + nanoseconds
            self.found.add(_uint(record.fields["conn"]), time_ns, record.body, record.end - record.body, chunk)
        elif record.op == _CONNECTION:
            self.connection(data, record, damage)
        elif record.op == _CHUNK and record.fields["compression"] != _PLAIN and chunk < 0:
            self.inflated(record, _text(record.fields["compression"]))
        elif record.op == _FILE and chunk < 0:
            self.header(record)

    def record_at(self, data: ByteRange, pos: int) -> Record | None:
        """See `RecordReader`."""
        raw = data.read(pos, 4)
        if len(raw) < 4:
            return None
        size = _uint(raw)
        if size > _MAX_HEADER:
            return None
        raw = data.read(pos + 4, size + 4)
        if len(raw) < size + 4:
            return None
        fields = _fields(raw[:size])
        if fields is None or len(fields.get("op", b"")) != 1:
            return None
        op = fields["op"][0]
        needed = _NEEDED.get(op)
        if needed is None or any(
            name not in fields or length not in (None, len(fields[name])) for name, length in needed.items()
        ):
            return None
        body = pos + 4 + size + 4
        plain_chunk = op == _CHUNK and fields["compression"] == _PLAIN
        end = body if plain_chunk else body + _uint(raw[size:])
        return Record(op, pos, body, end, fields)

    def next_record(self, data: ByteRange, start: int, barred: frozenset[int]) -> int | None:
        """See `RecordReader`: the record has the fields that its op requires."""
        for pos in find(data, _HEADER, _HEADER_LENGTH, start):
            record = self.record_at(data, pos)
            if record and record.op not in barred:
                return pos
        return None

    def header(self, record: Record) -> None:
        """Read the bag header, which shows if the file was finished, and if its end is missing."""
        if encryptor := record.fields.get("encryptor"):
            raise RecordingError(
                f"{self.file.name}: the bag is encrypted ({_text(encryptor)}): expected a plain one; "
                f"decrypt it with `rosbag decrypt {quote(self.file.name)}`"
            )
        index_pos = _uint(record.fields["index_pos"])
        self.damage.unfinished = index_pos == 0
        self.damage.cut |= index_pos >= self.file.size

    def connection(self, data: ByteRange, record: Record, damage: Damage) -> None:
        """Add a connection; a second connection with the same id is ignored."""
        fields = _fields(data.read(record.body, min(record.end - record.body, MAX_TEXT)))
        if fields is None or "type" not in fields:
            damage.places += 1
            return
        package, slash, message = _text(fields["type"]).partition("/")
        channel = Channel(
            id=_uint(record.fields["conn"]),
            topic=_text(record.fields["topic"]),
            type=f"{package}/msg/{message}" if slash else package,
            encoding="ros1",
            definition=_text(fields.get("message_definition", b"")),
            count=0,
            callers=(_text(caller),) if (caller := fields.get("callerid")) else (),
            metadata=(("latching", "1"),) if fields.get("latching") == b"1" else (),
        )
        self.by_id.setdefault(channel.id, channel)


def _fields(raw: bytes) -> dict[str, bytes] | None:
    """Return the ``name=value`` fields of a header, or None if it does not consist of a few such fields."""
    fields: dict[str, bytes] = {}
    pos = 0
    for _ in range(_MAX_FIELDS):
        if pos >= len(raw):
            break
        size = _uint(raw[pos : pos + 4])
        name, equals, value = raw[pos + 4 : pos + 4 + size].partition(b"=")
        if not equals:
            return None
        fields[_text(name)] = value
        pos += 4 + size
    return fields if pos == len(raw) else None


def _uint(raw: bytes) -> int:
    return int.from_bytes(raw, "little")


def _text(raw: bytes) -> str:
    return raw.decode("utf-8", errors="replace")
