"""What the readers of bags and of MCAP files share: the walk through a file of records and of chunks of records."""

from __future__ import annotations

from abc import ABC, abstractmethod
from pathlib import Path

from ..messages.channel import Channel
from ..messages.compression import COMPRESSIONS, MAX_CHUNK, inflate
from ._byte_range import ByteRange, FileRange, MemoryRange
from ._found_messages import FoundMessages, Walk
from ._records import Damage, Layout, Record, find_records, with_bar


class RecordReader(ABC):
    """One walk through a file.

    Args:
        path: the file.
        layout: how its records lie in it.
        start: the offset of its first record.

    Raises:
        RecordingError: it cannot be opened.
    """

    def __init__(self, path: Path, layout: Layout, start: int) -> None:
        self.file = FileRange(path)
        self.layout = layout
        self.start = start
        self.damage = Damage(unfinished=True)
        self.found = FoundMessages(self.file)

    @abstractmethod
    def check(self) -> None:
        """Raise RecordingError for a file in another format."""

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
            try:
                for record in with_bar(find_records(self.file, self.layout, self.damage, self.start), self.file):
                    self.record(self.file, record, -1, self.damage)
            except OSError as error:
                self.damage.disk = error.strerror or str(error)
            return self.found.as_walk(self.channels(), self.damage)
        except BaseException:
            self.file.close()
            raise

    def inflated(self, record: Record, compression: str) -> bytes | None:
        """Index the records of a compressed chunk, as far as it decompresses; returns its data if that is whole."""
        if compression not in COMPRESSIONS:
            self.damage.compressions.add(compression)
            return None
        size = min(record.end - record.body, MAX_CHUNK)
        raw, whole = inflate(compression, self.file.read(record.body, size))
        inside, data = Damage(), MemoryRange(raw)
        chunk = self.found.add_chunk(record.body, size, compression)
        for inner in find_records(data, self.layout, inside, 0):
            self.record(data, inner, chunk, inside)
        self.damage.places += inside.places + (record.whole and (inside.cut or not whole))
        return raw if whole else None
