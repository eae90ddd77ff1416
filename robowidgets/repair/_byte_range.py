"""Sources of bytes for records: a file, or a decompressed chunk."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path
from threading import Lock
from typing import Protocol

from .source import RecordingError

WINDOW = 1 << 16


class ByteRange(Protocol):
    """Bytes that are read by offset."""

    @property
    def size(self) -> int:
        """The number of bytes."""

    def read(self, offset: int, size: int) -> bytes:
        """Return up to ``size`` bytes at an offset, fewer at the end; allocate no more than the rest of the data."""


class MemoryRange:
    """Bytes in memory."""

    def __init__(self, raw: bytes) -> None:
        self._raw = raw
        self.size = len(raw)

    def read(self, offset: int, size: int) -> bytes:
        """Return the bytes at an offset."""
        return self._raw[offset : offset + size]


class FileRange:
    """A file that is open for reading. Several threads may read it.

    Args:
        path: the file.

    Raises:
        RecordingError: the file cannot be opened, or is empty.
    """

    def __init__(self, path: Path) -> None:
        self.name = path.name
        self._lock = Lock()
        try:
            self._file = path.open("rb")
            self.size = self._file.seek(0, 2)
        except OSError as error:
            raise RecordingError(f"{path.name}: cannot be opened: {error.strerror or error}") from None
        if not self.size:
            self.close()
            raise RecordingError(
                f"{path.name}: the file is empty (0 bytes): expected a recording; copy it again or record again"
            )

    def read(self, offset: int, size: int) -> bytes:
        """Return the bytes at an offset; raise OSError if the disk fails, ValueError after `close`."""
        with self._lock:
            self._file.seek(offset)
            return self._file.read(max(0, min(size, self.size - offset)))

    def close(self) -> None:
        """Close the file; further calls do nothing."""
        self._file.close()


def find(data: ByteRange, pattern: re.Pattern[bytes], length: int, start: int) -> Iterator[int]:
    """Yield offsets at which a pattern of at most ``length`` bytes matches, from ``start`` on.

    The pattern is a lookahead, so that matches may overlap, and a match contains a byte other than zero. No match
    starts in the last ``length - 1`` bytes.
    """
    while start + length <= data.size:
        raw = data.read(start, WINDOW)
        if len(raw) < length:
            return
        if raw.count(0) < len(raw):  # files that were allocated and never filled contain gigabytes of zeros
            yield from (start + match.start() for match in pattern.finditer(raw))
        start += len(raw) - length + 1
