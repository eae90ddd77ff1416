"""The walk from record to record through a file that may be damaged."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from .._core.progress import Progress
from ._byte_range import ByteRange, FileRange

MAX_PLACES = 10_000
MAX_TEXT = 1 << 22


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


class Layout(NamedTuple):
    """The functions that recognise the records of one file format.

    ``record_at`` returns the record at an offset, which may reach past the end of the data, or None if there is none.
    ``next_record`` searches from an offset for a record that is unlikely to be an accident; it skips the given ops.
    After ``last_op`` nothing follows. Records in ``index_ops`` contain no messages; those in ``inner_ops`` lie in
    chunks.
    """

    record_at: Callable[[ByteRange, int], Record | None]
    next_record: Callable[[ByteRange, int, frozenset[int]], int | None]
    last_op: int | None
    index_ops: frozenset[int]
    inner_ops: frozenset[int]
    chunk_op: int

    def search(self, data: ByteRange, pending: Record | None, pos: int) -> int | None:
        """The offset of the next record, after a record whose end is in doubt or, with none, after an offset.

        Records of messages within compressed data are skipped: they are accidents, or are read after decompression.
        """
        if pending is None:
            return self.next_record(data, pos + 1, frozenset())
        is_packed = pending.op == self.chunk_op and pending.end > pending.body
        return self.next_record(data, pending.body, self.inner_ops if is_packed else frozenset())


@dataclass
class Damage:
    """The damage of a file.

    ``places`` counts where the walk had to search for the next record or could not use one; ``index``: lengths in the
    index were wrong; ``cut``: data is missing at the end; ``unfinished``: only the index is missing at the end;
    ``checksums`` counts chunks that differ from their checksum; ``compressions`` names those that cannot be read;
    ``unnamed`` counts messages of topics that the file does not name; ``disk`` is the text of the disk's error.
    """

    places: int = 0
    index: bool = False
    cut: bool = False
    unfinished: bool = False
    checksums: int = 0
    compressions: set[str] = field(default_factory=set)
    unnamed: int = 0
    disk: str = ""


def with_bar(records: Iterable[Record], file: FileRange) -> Iterator[Record]:
    """The records of a file, with a progress bar if they take long."""
    done = 0
    with Progress(file.size, f"Reading {file.name}", "B") as bar:
        for record in records:
            yield record
            bar.update(record.end - done)
            done = record.end


def find_records(data: ByteRange, layout: Layout, damage: Damage, start: int = 0) -> Iterator[Record]:
    """Every record that can be recognised, in the order of the file; adds to ``damage``.

    A record is yielded once another one is found where it ends. If there is none, the next one is searched for within
    the pending record, because its length may be wrong.
    """
    pending: Record | None = None
    pos = start
    while pos < data.size:
        record = layout.record_at(data, pos)
        if record:
            if pending:
                yield pending
            pending = record
            if record.op == layout.last_op:
                break
            pos = record.end
            if pos <= data.size:
                continue
        found = layout.search(data, pending, pos) if damage.places < MAX_PLACES else None
        if found is None:
            damage.cut = True
            break
        if pending and pending.op in layout.index_ops:
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
