"""The messages that were found in a file, read from it when they are asked for."""

from __future__ import annotations

from array import array
from collections import OrderedDict
from collections.abc import Collection, Iterator, Sequence
from functools import partial
from threading import Lock
from typing import NamedTuple

from ..recordings.pages import PAGE_BYTES, Held, Page, pack
from ._inflate import inflate
from ._known import Known
from ._records import Damage
from ._report import nothing
from ._stretch import FileStretch
from .source import Channel, RecordingError

_KEPT = 1 << 26
_MAX_TIME = 2**63


class Chunk(NamedTuple):
    """Where the data of a compressed chunk lies in the file."""

    offset: int
    size: int
    compression: str


class Findings:
    """Where every message of a file lies: 40 bytes each, so that the messages themselves need not be held."""

    def __init__(self) -> None:
        self.chunks: list[Chunk] = []
        self.channels = array("q")
        self.times = array("q")
        self.where = array("q")
        self.offsets = array("q")
        self.sizes = array("q")

    def add(self, channel: int, time_ns: int, offset: int, size: int, chunk: int) -> bool:
        """Note a message in a chunk of ``chunks``, or in the file itself (-1); False when no clock has its time."""
        if time_ns >= _MAX_TIME:
            return False
        self.channels.append(channel)
        self.times.append(time_ns)
        self.where.append(chunk)
        self.offsets.append(offset)
        self.sizes.append(size)
        return True


class SavedFile(Known):
    """A `SavedSource` over the messages found in one file.

    Args:
        file: the file, which is closed with the source.
        channels: every channel named in it, counts not yet known.
        found: where the messages lie.
        damage: what was wrong.

    Raises:
        RecordingError: the file is damaged and holds no message.
    """

    def __init__(self, file: FileStretch, channels: Collection[Channel], found: Findings, damage: Damage) -> None:
        super().__init__(found.times, found.channels, channels, damage)
        self._file = file
        self._found = found
        self._lock = Lock()
        self._raw: OrderedDict[int, bytes] = OrderedDict()
        if self.problems and not len(self._times):
            raise nothing(file.name, file.size, damage)

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[tuple[Channel, int, bytes]]:
        """Channel, log time and bytes of the messages of these channels, by log time."""
        wanted = {channel.id: channel for channel in channels}
        for row, channel, time_ns in self._times.rows(wanted, start_ns, stop_ns):
            data = self._read(self._found.where[row], self._found.offsets[row], self._found.sizes[row])
            yield wanted[channel], time_ns, data

    def pages(self, channels: Collection[Channel]) -> Iterator[Page]:
        """See `pages.Paged`."""
        wanted = {channel.id: channel for channel in channels}
        for rows in self._times.stretches(wanted, self._found.sizes, PAGE_BYTES):
            yield partial(self._page, rows, wanted)

    def close(self) -> None:
        """Close the file; doing it again does nothing."""
        self._file.close()
        self._raw.clear()

    def _page(self, rows: Sequence[int], wanted: dict[int, Channel]) -> Held:
        found = self._found
        places = ((row, found.where[row], found.offsets[row], found.sizes[row]) for row in rows)
        messages = [(wanted[found.channels[row]], self._times.of(row), self._read(*place)) for row, *place in places]
        return partial(pack, messages)

    def _read(self, chunk: int, offset: int, size: int) -> bytes:
        try:
            data = self._file.read(offset, size) if chunk < 0 else self._chunk(chunk)[offset : offset + size]
        except ValueError:
            raise RecordingError(f"{self._file.name}: is closed; open it again") from None
        except OSError as error:
            raise RecordingError(f"{self._file.name}: the disk could not read it: {error.strerror or error}") from None
        if len(data) != size:
            raise RecordingError(f"{self._file.name}: has changed since it was opened; open it again")
        return data

    def _chunk(self, number: int) -> bytes:
        """A chunk's data; those read last are kept, as messages next to each other in time mostly share one."""
        with self._lock:
            raw = self._raw.pop(number, None)
            if raw is None:
                chunk = self._found.chunks[number]
                raw = inflate(chunk.compression, self._file.read(chunk.offset, chunk.size)).raw
            self._raw[number] = raw
            while len(self._raw) > 1 and sum(map(len, self._raw.values())) > _KEPT:
                self._raw.popitem(last=False)
            return raw
