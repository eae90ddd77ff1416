"""The walk through a file of records and chunks of records, shared by the readers of bags and MCAP files."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import ClassVar, NamedTuple

from ..messages.channel import Channel
from ..messages.compression import COMPRESSIONS, MAX_CHUNK, inflate
from ..notebook.progress import Progress
from ._byte_range import ByteRange, FileRange, MemoryRange
from ._found_messages import MAX_PLACES, Damage, FoundMessages, Walk

MAX_TEXT = 1 << 22
"""The most bytes of a record with names and definitions."""


class Record(NamedTuple):
    """The offsets of a record: ``start``, the first byte of its data (``body``), the byte after its data (``end``).

    An uncompressed chunk ends at the start of its data: its records are read as if they were outside the chunk, so a
    wrong length or a missing end loses nothing. ``whole`` is False if the data ends early.
    """

    op: int
    start: int
    body: int
    end: int
    fields: Mapping[str, bytes] = {}
    whole: bool = True


class RecordReader(ABC):
    """One walk through a file that may be damaged. Subclasses define the records of a format.

    Args:
        path: the file.

    Raises:
        RecordingError: the file cannot be opened.
    """

    magic: ClassVar[bytes]
    """The bytes before the first record."""
    last_op: ClassVar[int | None] = None
    """The op of the last record."""
    index_ops: ClassVar[frozenset[int]]
    """The ops of records without messages."""
    inner_ops: ClassVar[frozenset[int]]
    """The ops of records that lie in chunks."""
    chunk_op: ClassVar[int]

    def __init__(self, path: Path) -> None:
        self.file = FileRange(path)
        self.damage = Damage(unfinished=True)
        self.found = FoundMessages(self.file)

    @abstractmethod
    def check(self) -> None:
        """Raise RecordingError for a file in another format."""

    @abstractmethod
    def record_at(self, data: ByteRange, pos: int) -> Record | None:
        """Return the record at an offset, which may reach past the end of the data, or None."""

    @abstractmethod
    def next_record(self, data: ByteRange, start: int, barred: frozenset[int]) -> int | None:
        """Return the next offset from ``start`` on of a likely record without a barred op, or None."""

    @abstractmethod
    def record(self, data: ByteRange, record: Record, chunk: int, damage: Damage) -> None:
        """Index a record of the file (chunk -1) or of a chunk."""

    @abstractmethod
    def channels(self) -> list[Channel]:
        """Return the channels that were found."""

    def walk(self) -> Walk:
        """Read the whole file; close it on errors."""
        try:
            self.check()
            done = 0
            try:
                with Progress(self.file.size, f"Reading {self.file.name}", "B") as bar:
                    for record in self.records(self.file, self.damage, len(self.magic)):
                        self.record(self.file, record, -1, self.damage)
                        bar.update(record.end - done)
                        done = record.end
            except OSError as error:
                self.damage.disk = error.strerror or str(error)
            return self.found.as_walk(self.channels(), self.damage)
        except BaseException:
            self.file.close()
            raise

    def records(self, data: ByteRange, damage: Damage, start: int = 0) -> Iterator[Record]:
        """Yield every record that can be recognised, in the order of the data; add to ``damage``.

        A record is yielded once another record is found at its end. Otherwise the next record is searched for within
        the pending record, because its length may be wrong.
        """
        pending: Record | None = None
        pos = start
        while pos < data.size:
            record = self.record_at(data, pos)
            if record:
                if pending:
                    yield pending
                pending = record
                if record.op == self.last_op:
                    break
                pos = record.end
                if pos <= data.size:
                    continue
            found = self._search(data, pending, pos) if damage.places < MAX_PLACES else None
            if found is None:
                damage.cut = True
                break
            if pending and pending.op in self.index_ops:
                damage.index = True
            else:
                damage.places += 1
            if pending and found < pending.end:
                pending = pending._replace(end=found)
            pos = found
        if pending and pending.end > data.size:
            pending = pending._replace(end=data.size, whole=False)
        if pending:
            yield pending

    def inflated(self, record: Record, compression: str) -> bytes | None:
        """Index all records of a compressed chunk that can be decompressed; return its data if that is complete."""
        if compression not in COMPRESSIONS:
            self.damage.compressions.add(compression)
            return None
        size = min(record.end - record.body, MAX_CHUNK)
        raw, whole = inflate(compression, self.file.read(record.body, size))
        inside, data = Damage(), MemoryRange(raw)
        chunk = self.found.add_chunk(record.body, size, compression)
        for inner in self.records(data, inside):
            self.record(data, inner, chunk, inside)
        self.damage.places += inside.places + (record.whole and (inside.cut or not whole))
        return raw if whole else None

    def _search(self, data: ByteRange, pending: Record | None, pos: int) -> int | None:
        """Return the offset of the next record after a pending record, whose end is in doubt, or else after an offset.

        Within compressed data, records that belong into chunks are skipped: they are accidental matches.
        """
        if pending is None:
            return self.next_record(data, pos + 1, frozenset())
        is_packed = pending.op == self.chunk_op and pending.end > pending.body
        return self.next_record(data, pending.body, self.inner_ops if is_packed else frozenset())
