"""What the readers of bags and of MCAP files share: the walk through a file of records and of chunks of records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import ClassVar, NamedTuple

from .._core.progress import Progress
from ..messages.channel import Channel
from ..messages.compression import COMPRESSIONS, MAX_CHUNK, inflate
from ._byte_range import ByteRange, FileRange, MemoryRange
from ._found_messages import MAX_PLACES, Damage, FoundMessages, Walk

MAX_TEXT = 1 << 22
"""Most bytes of a record with names and definitions."""


class Record(NamedTuple):
    """The offsets of a record: ``start``, the first byte of its data (``body``), the byte after its data (``end``).

    A chunk that is not compressed ends where its data starts: its records are walked as if they lay outside it, so a
    wrong length or a missing end costs nothing. ``whole`` is False when the data ends early.
    """

    op: int
    start: int
    body: int
    end: int
    fields: Mapping[str, bytes] = {}
    whole: bool = True


class RecordReader(ABC):
    """One walk through a file that may be damaged. Subclasses know the records of a format.

    Args:
        path: the file.

    Raises:
        RecordingError: it cannot be opened.
    """

    magic: ClassVar[bytes]
    """The bytes before the first record."""
    last_op: ClassVar[int | None] = None
    """The op after which nothing follows."""
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
        """The record at an offset, which may reach past the end of the data; None if there is none."""

    @abstractmethod
    def next_record(self, data: ByteRange, start: int, barred: frozenset[int]) -> int | None:
        """The offset, from ``start`` on, of a record that is unlikely to be an accident and has no barred op.

        None if there is none.
        """

    @abstractmethod
    def record(self, data: ByteRange, record: Record, chunk: int, damage: Damage) -> None:
        """Index a record of the file (chunk -1) or of a chunk."""

    @abstractmethod
    def channels(self) -> list[Channel]:
        """The channels that were found."""

    def walk(self) -> Walk:
        """Read the whole file, which an error closes."""
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
        """Every record that can be recognised, in the order of the data; adds to ``damage``.

        A record is yielded once another one is found where it ends. If there is none, the next one is searched for
        within the pending record, because its length may be wrong.
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
        """Index the records of a compressed chunk, as far as it decompresses; returns its data if that is whole."""
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
        """The offset of the next record, after a record whose end is in doubt or, with none, after an offset.

        Records of messages within compressed data are skipped: they are accidents, or are read after decompression.
        """
        if pending is None:
            return self.next_record(data, pos + 1, frozenset())
        is_packed = pending.op == self.chunk_op and pending.end > pending.body
        return self.next_record(data, pending.body, self.inner_ops if is_packed else frozenset())
