"""The result of a walk through one file: an index of its messages, and a function that reads them."""

from __future__ import annotations

from array import array
from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from threading import Lock
from typing import NamedTuple

from ..messages.channel import Channel
from ..messages.compression import inflate
from ._byte_range import FileRange
from .source import RecordingError

MAX_PLACES = 10_000
"""The number of damaged places after which the rest of a file is not read."""
_KEPT = 1 << 26
_MAX_TIME = 2**63


@dataclass
class Damage:
    """The damage of a file.

    ``places`` counts the places at which the walk had to search for the next record or could not use one. ``index``:
    lengths in the index were wrong. ``cut``: data is missing at the end. ``unfinished``: only the index is missing at
    the end. ``written``: another program is writing to the file. ``log``: the end of the -wal file of a database is
    missing. ``checksums`` counts chunks that differ from their checksum. ``compressions`` names unsupported
    compressions. ``unnamed`` counts messages of topics that the file does not name. ``disk`` is the text of the disk's
    error.
    """

    places: int = 0
    index: bool = False
    cut: bool = False
    unfinished: bool = False
    written: bool = False
    log: bool = False
    checksums: int = 0
    compressions: set[str] = field(default_factory=set)
    unnamed: int = 0
    disk: str = ""


@dataclass
class Walk:
    """The messages of one file.

    Args:
        name: name of the file.
        size: size of the file in bytes.
        channels: all channels that the file names; messages of other channels are left out.
        times: log times in nanoseconds, in the order of arrival.
        ids: the channel ids of these messages.
        read: returns the bytes of a message by its number.
        close: closes the file.
        damage: the damage of the file.
        problems: lines on other problems.
        hint: another way to save the file, for an error if no message can be read.
    """

    name: str
    size: int
    channels: Sequence[Channel]
    times: Sequence[int]
    ids: Sequence[int]
    read: Callable[[int], bytes]
    close: Callable[[], object]
    damage: Damage
    problems: tuple[str, ...] = ()
    hint: str = ""


class _Chunk(NamedTuple):
    """The place of the data of a compressed chunk in the file."""

    offset: int
    size: int
    compression: str


class FoundMessages:
    """The places of all messages of a file of records, with 40 bytes each, so that a file of any size can be indexed.

    Args:
        file: the file.
    """

    def __init__(self, file: FileRange) -> None:
        self.channels = array("q")
        self.times = array("q")
        self._file = file
        self._chunks: list[_Chunk] = []
        self._where = array("q")
        self._offsets = array("q")
        self._sizes = array("q")
        self._lock = Lock()
        self._raw: OrderedDict[int, bytes] = OrderedDict()

    def add_chunk(self, offset: int, size: int, compression: str) -> int:
        """Add a compressed chunk, and return its number."""
        self._chunks.append(_Chunk(offset, size, compression))
        return len(self._chunks) - 1

    def add(self, channel: int, time_ns: int, offset: int, size: int, chunk: int) -> bool:
        """Add a message in a chunk, or outside chunks (-1); return False if its time is beyond 2262."""
        if time_ns >= _MAX_TIME:
            return False
        self.channels.append(channel)
        self.times.append(time_ns)
        self._where.append(chunk)
        self._offsets.append(offset)
        self._sizes.append(size)
        return True

    def read(self, number: int) -> bytes:
        """Return the bytes of a message; raise RecordingError if the file cannot be read any more."""
        chunk, offset, size = self._where[number], self._offsets[number], self._sizes[number]
        try:
            data = self._file.read(offset, size) if chunk < 0 else self._chunk(chunk)[offset : offset + size]
        except ValueError:
            raise RecordingError(f"{self._file.name}: is closed; open it again") from None
        except OSError as error:
            raise RecordingError(f"{self._file.name}: the disk could not read it: {error.strerror or error}") from None
        if len(data) != size:
            raise RecordingError(f"{self._file.name}: has changed since it was opened; open it again")
        return data

    def as_walk(self, channels: Sequence[Channel], damage: Damage) -> Walk:
        """Return the result of the walk."""
        file = self._file
        return Walk(file.name, file.size, channels, self.times, self.channels, self.read, self._close, damage)

    def _close(self) -> None:
        self._file.close()
        self._raw.clear()

    def _chunk(self, number: int) -> bytes:
        """Return the data of a chunk. The last chunks are cached, because consecutive messages mostly share one."""
        with self._lock:
            raw = self._raw.pop(number, None)
            if raw is None:
                chunk = self._chunks[number]
                raw, _ = inflate(chunk.compression, self._file.read(chunk.offset, chunk.size))
            self._raw[number] = raw
            while len(self._raw) > 1 and sum(map(len, self._raw.values())) > _KEPT:
                self._raw.popitem(last=False)
            return raw
