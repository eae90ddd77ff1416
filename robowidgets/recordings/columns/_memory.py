"""A cache of decoded messages, with a limit in bytes."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Callable, Hashable, Iterator, Sequence
from contextlib import contextmanager
from operator import index
from threading import Lock
from typing import Any

from ...repair import RecordingError
from ...runtime.text import megabytes

DEFAULT = 1 << 30

_INSTEAD = (
    "take a part of it (series[a:b], series.between(start, end)), go through .chunks(), "
    "or set recording.memory higher, in bytes"
)


class Memory:
    """A cache of the sequences used last, up to a limit in bytes.

    Args:
        limit: the limit in bytes.

    Raises:
        TypeError: the limit is not a whole number.
        ValueError: the limit is 0 or less.
    """

    def __init__(self, limit: int = DEFAULT) -> None:
        self._cached: OrderedDict[Hashable, Sequence[Any]] = OrderedDict()
        self._bytes = self._reserved = 0
        self._lock = Lock()
        self.limit = limit

    @property
    def limit(self) -> int:
        """The limit in bytes; a new one applies at once."""
        return self._limit

    @limit.setter
    def limit(self, limit: int) -> None:
        try:
            limit = index(limit)
        except TypeError:
            raise TypeError(f"memory: expected a whole number of bytes, got {limit!r}") from None
        if limit <= 0:
            raise ValueError(f"memory: expected a number of bytes above 0, got {limit!r}")
        self._limit = limit
        self._drop(0)

    def get(self, key: Hashable, make: Callable[[], Sequence[Any]]) -> Sequence[Any]:
        """Return the sequence cached under a key, or make it and cache it if there is room. Items have ``nbytes``."""
        with self._lock:
            if key in self._cached:
                self._cached.move_to_end(key)
                return self._cached[key]
        made = make()
        self.put(key, made)
        return made

    def put(self, key: Hashable, made: Sequence[Any]) -> None:
        """Cache a sequence instead of the least recently used ones."""
        size = _size(made)
        self._drop(size)
        with self._lock:
            if key not in self._cached and self._bytes + self._reserved + size <= self._limit:
                self._cached[key] = made
                self._bytes += size

    def check(self, size: int, what: str) -> None:
        """Check that an array is not larger than the limit.

        Raises:
            RecordingError: the array is larger.
        """
        if size > self._limit:
            raise RecordingError(
                f"{what} would take {megabytes(size)} of memory, and the limit is {megabytes(self._limit)}: {_INSTEAD}"
            )

    @contextmanager
    def reserved(self, size: int, what: str) -> Iterator[None]:
        """Make room for an array while it is filled, and give the room back.

        Raises:
            RecordingError: the array is larger than the limit.
        """
        self.check(size, what)
        self._reserved += size
        self._drop(0)
        try:
            yield
        finally:
            self._reserved -= size

    def _drop(self, size: int) -> None:
        """Drop the least recently used sequences until so many bytes have room."""
        with self._lock:
            while self._cached and self._bytes + self._reserved + size > self._limit:
                self._bytes -= _size(self._cached.popitem(last=False)[1])


def _size(made: Sequence[Any]) -> int:
    return sum(part.nbytes for part in made)
