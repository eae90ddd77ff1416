"""MCAP files, read record by record, without their index."""

from __future__ import annotations

import re
import struct
from binascii import crc32
from pathlib import Path

from ..messages.channel import Channel
from . import mcap_records as mcap
from ._byte_range import ByteRange, find
from ._found_messages import Damage, Walk
from ._record_reader import MAX_TEXT, Record, RecordReader
from ._report import HEAD, foreign

# The least number of bytes in a record of each op, 0x01 (header) to 0x0F (end of data).
_LEAST = dict(enumerate((8, 20, 14, 16, 22, 40, 6, 68, 36, 40, 46, 8, 20, 17, 4), start=1))
_PRIVATE = 0x80
_MESSAGE_HEAD = struct.Struct("<HIQQ")
_CHUNK_HEAD = struct.Struct("<QQQII")
_MAX_COMPRESSION = 16
_RECORD = re.compile(rb"(?=[\x01-\x0f].{4}\0{4})", re.DOTALL)
_IN_A_ROW = 3
_READ_AT_ONCE = 1 << 20


def walk_mcap(path: Path) -> Walk:
    """Find all readable messages of an MCAP file, which may lack chunks or an index, or be damaged.

    Encodings and schemas are not interpreted: channels with any of them are listed.

    Args:
        path: the file, with any suffix.

    Raises:
        RecordingError: the file cannot be opened, or is not an MCAP file.
    """
    return _Reader(path).walk()


class _Reader(RecordReader):
    """One walk through an MCAP file."""

    magic = mcap.MAGIC
    last_op = mcap.FOOTER
    index_ops = frozenset((0x07, 0x08, 0x0A, 0x0B, 0x0D, 0x0E))
    inner_ops = frozenset((mcap.SCHEMA, mcap.CHANNEL, mcap.MESSAGE))
    chunk_op = mcap.CHUNK

    def __init__(self, path: Path) -> None:
        super().__init__(path)
        self.schemas: dict[int, mcap.McapSchema] = {}
        self.named: dict[int, mcap.McapChannel] = {}

    def check(self) -> None:
        """See `RecordReader`."""
        head = self.file.read(0, HEAD)
        if not head.startswith(mcap.MAGIC):
            raise foreign(self.file.name, "an MCAP file", head)

    def channels(self) -> list[Channel]:
        """Return the channels with their schemas. A schema may lie anywhere in the file, even after its channel."""
        none = mcap.McapSchema()
        return [one.with_schema(number, self.schemas.get(one.schema, none)) for number, one in self.named.items()]

    def record(self, data: ByteRange, record: Record, chunk: int, damage: Damage) -> None:
        """Index a record of the file (chunk -1) or of a chunk."""
        if record.op == mcap.MESSAGE and record.whole:
            self.message(data, record, chunk, damage)
        elif record.op in (mcap.SCHEMA, mcap.CHANNEL):
            self.name(data, record, damage)
        elif record.op == mcap.CHUNK and chunk < 0:
            self.chunk(record)
        elif record.op == mcap.FOOTER:
            damage.unfinished = False

    def record_at(self, data: ByteRange, pos: int) -> Record | None:
        """See `RecordReader`."""
        head = data.read(pos, mcap.RECORD_HEAD.size)
        if len(head) < mcap.RECORD_HEAD.size:
            return None
        op, size = mcap.RECORD_HEAD.unpack(head)
        if size < _LEAST.get(op, 0) or (op not in _LEAST and op < _PRIVATE):
            return None
        body = pos + mcap.RECORD_HEAD.size
        if op == mcap.CHUNK:
            return _chunk_at(data, pos, body + size)
        return Record(op, pos, body, body + size) if body + size <= data.size else None

    def next_record(self, data: ByteRange, start: int, barred: frozenset[int]) -> int | None:
        """See `RecordReader`: other records follow without a gap, or the record ends the file."""
        for pos in find(data, _RECORD, mcap.RECORD_HEAD.size, start):
            if data.read(pos, 1)[0] not in barred and self.is_chain(data, pos):
                return pos
        return None

    def is_chain(self, data: ByteRange, pos: int) -> bool:
        """Return True if several records follow each other from an offset on, or a record ends the file."""
        for _ in range(_IN_A_ROW):
            record = self.record_at(data, pos)
            if not record:
                return False
            if record.op == mcap.FOOTER or record.end >= data.size:
                return True
            pos = record.end
        return True

    def message(self, data: ByteRange, record: Record, chunk: int, damage: Damage) -> None:
        """Index a message."""
        head = data.read(record.body, _MESSAGE_HEAD.size)
        offset = record.body + len(head)
        if len(head) == _MESSAGE_HEAD.size and offset <= record.end:
            channel, _, time_ns, _ = _MESSAGE_HEAD.unpack(head)
            if self.found.add(channel, time_ns, offset, record.end - offset, chunk):
                return
        damage.places += 1

    def name(self, data: ByteRange, record: Record, damage: Damage) -> None:
        """Add a schema or a channel; a second one with the same id is ignored."""
        raw = data.read(record.body, min(record.end - record.body, MAX_TEXT))
        try:
            if record.op == mcap.SCHEMA:
                self.schemas.setdefault(*mcap.parse_schema(raw))
            else:
                self.named.setdefault(*mcap.parse_channel(raw))
        except struct.error:
            damage.places += 1

    def chunk(self, record: Record) -> None:
        """Check the checksum of a chunk; if it is compressed, index all records that can be decompressed."""
        checksum = int.from_bytes(record.fields["checksum"], "little")
        compression = record.fields["compression"].decode()
        if not compression:
            size = int.from_bytes(record.fields["size"], "little")
            self.damage.checksums += bool(checksum) and self.checksum(record.body, size) not in (checksum, None)
            return
        raw = self.inflated(record, compression)
        if raw is not None and checksum:
            self.damage.checksums += checksum != crc32(raw)

    def checksum(self, offset: int, size: int) -> int | None:
        """Return the CRC-32 of bytes in the file, or None if some are missing."""
        end = offset + size
        if end > self.file.size:
            return None
        value = 0
        for at in range(offset, end, _READ_AT_ONCE):
            value = crc32(self.file.read(at, min(_READ_AT_ONCE, end - at)), value)
        return value


def _chunk_at(data: ByteRange, pos: int, outer_end: int) -> Record | None:
    """Return the chunk at an offset if its lengths agree or all of its data is in the file, else None."""
    body = pos + mcap.RECORD_HEAD.size + _CHUNK_HEAD.size
    head = data.read(pos + mcap.RECORD_HEAD.size, _CHUNK_HEAD.size)
    if len(head) < _CHUNK_HEAD.size:
        return None
    _, _, _, checksum, length = _CHUNK_HEAD.unpack(head)
    if length > _MAX_COMPRESSION:
        return None
    raw = data.read(body, length + 8)
    body += length + 8
    compression, size = raw[:length], raw[length:]
    end = body + int.from_bytes(size, "little")
    if len(size) < 8 or not compression.isascii() or (end != outer_end and end > data.size):
        return None
    fields = {"compression": compression, "checksum": checksum.to_bytes(4, "little"), "size": size}
    return Record(mcap.CHUNK, pos, body, end if compression else body, fields)
