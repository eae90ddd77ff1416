"""ROS 1 bags, read by rosbags: from any time on, and remote ones by the chunks that are needed."""

from __future__ import annotations

from bisect import bisect_left
from collections import defaultdict
from collections.abc import Callable, Collection, Generator, Iterator, Sequence
from io import BytesIO

import numpy as np
from rosbags.interfaces import Connection
from rosbags.rosbag1 import Reader
from rosbags.rosbag1.reader import Chunk, ChunkInfo, Header, IndexData, ReaderError, RecordType

from ._mcap import Chunks, File, IsNear

MAGIC = b"#ROSBAG V2.0\n"
_END = 2**63 - 1
_Message = tuple[Connection, int, bytes]


class BagReader(Reader):
    """A reader of rosbags that begins at a time at once; `Reader` searches the index from its beginning."""

    def messages(
        self, connections: Collection[Connection] = (), start: int | None = None, stop: int | None = None
    ) -> Generator[_Message, None, None]:
        """Yield messages like `Reader.messages`."""
        asked = connections or self.connections
        part = {one.id: _within(self.indexes[one.id], start, stop) for one in asked}
        yield from self._indexed_by(part, asked)

    def _indexed_by(self, part: dict[int, list[IndexData]], connections: Collection[Connection]) -> Iterator[_Message]:
        """Yield the messages in a part of the index."""
        found, whole = super().messages(connections), self.indexes
        try:
            self.indexes = part
            first = next(found, None)  # takes the index
        finally:
            self.indexes = whole
        if first:
            yield first
            yield from found


class BagInParts(BagReader):
    """A reader of a remote bag by its table of chunks, which has their times and their numbers of messages.

    The index lies between the chunks, and `Reader` reads all of it: of 20 GB, more than 20,000 small pieces. Here the
    index of a chunk is read together with the chunk.

    Args:
        file: the bag.
        is_near: returns True if some bytes at an offset may be read to make the times of a topic exact.
    """

    def __init__(self, file: File, is_near: IsNear) -> None:
        super().__init__(file)  # type: ignore[arg-type]
        self.is_near = is_near
        self.index: Chunks
        self._infos: list[ChunkInfo] = []

    def open(self) -> None:
        """Read the connections and the table of chunks at the end of the file."""
        super().open()
        assert self.bio
        self.bio.seek(len(MAGIC))
        end = Header.read(self.bio, RecordType.BAGHEADER).get_uint64("index_pos")
        infos = sorted((info for info in self.chunk_infos if info.connection_counts), key=lambda info: info.pos)
        self._infos = infos
        table = np.array([(info.start_time, info.end_time - 1, info.pos) for info in infos], np.int64).reshape(-1, 3)
        starts, ends, offsets = table.T
        lengths = np.diff(offsets, append=end)
        places = [
            (number, channel, info.pos, count)
            for number, info in enumerate(infos)
            for channel, count in info.connection_counts.items()
        ]
        columns = np.array(places, np.int64).reshape(-1, 4).T
        rows = {one.id: np.flatnonzero((columns[1] == one.id) & (columns[3] > 0)) for one in self.connections}
        by_channel = {number: found for number, found in rows.items() if len(found)}
        order = np.lexsort((offsets, starts))
        nothing = np.zeros_like(lengths)
        unknown = [""] * len(lengths)
        self.index = Chunks(
            starts, ends, offsets, lengths, nothing, unknown, lengths, lengths, columns, order, by_channel
        )
        counts = self.index.counts()
        self.connections = [one._replace(msgcount=counts.get(one.id, 0)) for one in self.connections]

    def read_chunk(self) -> Chunk:
        """Return no chunk: `Reader.open` calls this for each of them."""
        return Chunk(0, 0, bytes)

    def read_index_data(self, pos: int, indexes: dict[int, list[IndexData]]) -> None:
        """Read no index: `Reader.open` calls this for each chunk."""

    def messages(
        self, connections: Collection[Connection] = (), start: int | None = None, stop: int | None = None
    ) -> Generator[_Message, None, None]:
        """Yield messages like `Reader.messages`, but open each chunk only when its start time comes."""
        asked = connections or self.connections
        left: dict[int, list[IndexData]] = {one.id: [] for one in asked}
        numbers: list[int] = self.index.of(list(left), start, stop).tolist()
        following = [*self.index.starts[numbers[1:]].tolist(), _END]
        for number, until in zip(numbers, following, strict=False):
            opened = self._open(number, self._read(number))
            for channel, entries in left.items():
                entries += _within(opened.get(channel, []), start, stop)
                entries.sort(key=_by_time)
            ready = {channel: _within(entries, None, until) for channel, entries in left.items()}
            left = {channel: entries[len(ready[channel]) :] for channel, entries in left.items()}
            yield from self._indexed_by(ready, asked)

    def thinned(self, connections: Sequence[Connection], most_bytes: int, most_chunks: int) -> Iterator[list[_Message]]:
        """Yield the messages in each of a few chunks; see `Chunks.spread`. Each is one request."""
        channels = [one.id for one in connections]
        for number in self.index.spread(channels, most_bytes, most_chunks).tolist():
            opened = self._open(number, self._read(number, alone=True))
            yield [*self._indexed_by({channel: opened.get(channel, []) for channel in channels}, connections)]

    def span_ns(self, channel: int) -> tuple[int, int] | None:
        """Return the times of a connection's first and last message, or of their chunks if these are far from others.

        Return None if the connection has no messages.
        """
        rows = self.index.by_channel.get(channel)
        if rows is None:
            return None
        numbers = self.index.places[0, rows]
        first = int(numbers[self.index.starts[numbers].argmin()])
        last = int(numbers[self.index.ends[numbers].argmax()])
        places = [(int(self.index.offsets[i]), int(self.index.lengths[i])) for i in (first, last)]
        if not all(self.is_near(*place) for place in places):
            return int(self.index.starts[first]), int(self.index.ends[last])
        times = [entry.time for i in {first, last} for entry in self._open(i, self._read(i)).get(channel, [])]
        return min(times), max(times)

    def _read(self, number: int, *, alone: bool = False) -> bytes:
        """Return a chunk and its index, as they lie in the file.

        Args:
            number: the number of the chunk.
            alone: True to fetch these bytes only, instead of whole blocks.
        """
        assert self.bio
        start, length = int(self.index.offsets[number]), int(self.index.lengths[number])
        fetch: Callable[[int, int], bytes] | None = getattr(self.bio, "fetch", None)
        if alone and fetch:
            return fetch(start, start + length)
        self.bio.seek(start)
        return self.bio.read(length)

    def _open(self, number: int, raw: bytes) -> dict[int, list[IndexData]]:
        """Return the index of a chunk by connections, and keep the chunk until the next one.

        Raises:
            ReaderError: the chunk or its index is damaged.
        """
        place, _, _, counts = self._infos[number]
        indexes: dict[int, list[IndexData]] = defaultdict(list)
        bio, self.bio = self.bio, BytesIO(raw)
        try:
            chunk = super().read_chunk()
            for _ in counts:
                super().read_index_data(place, indexes)
        finally:
            self.bio = bio
        if {one: len(entries) for one, entries in indexes.items()} != counts:
            raise ReaderError(f"The index of the chunk at byte {place:,} disagrees with the table of chunks.")
        self.chunks[place] = chunk._replace(datapos=place + chunk.datapos)
        self.current_chunk[1].close()
        packed = raw[chunk.datapos : chunk.datapos + chunk.datasize]
        self.current_chunk = place, BytesIO(chunk.decompressor(packed))
        return indexes


def _within(entries: list[IndexData], start: int | None, stop: int | None) -> list[IndexData]:
    """Return the entries of a sorted index from a time on, and before another."""
    first = 0 if start is None else bisect_left(entries, (start,))
    return entries[first : len(entries) if stop is None else bisect_left(entries, (stop,))]


def _by_time(entry: IndexData) -> tuple[int, int]:
    return entry.time, entry.chunk_pos
