"""Series: the samples of one topic as columns. The base of the series of all kinds."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from operator import index as as_index
from typing import TYPE_CHECKING, Any, Generic, TypeVar, overload

import numpy as np
from numpy.typing import NDArray

from ...kinds import Kind
from ...messages.channel import Channel
from ...repair import RecordingError
from ...samples.checks import frozen
from ..times import span_ns, to_ns
from ..topics import Moment
from ._clock_problems import about_clock
from ._decoders import Decoder, SampleDecoder
from ._store import Store
from .tables import Columns

if TYPE_CHECKING:
    from typing_extensions import Self

Taken = TypeVar("Taken")


class Series(Columns, Generic[Taken]):
    """The samples of one topic, each with its time, in the order of time.

    By index: ``series[3]`` is a `Moment` (with ``sample``, ``time_ns`` and ``seconds``), ``series[10:20]`` a shorter
    series. By time, in seconds from the start of the recording: ``series.at(21.96)`` is the nearest sample,
    ``series.between(2.0, 5.0)`` a shorter series.

    Nothing is read until it is needed. Then the topic is read once from start to end, with a progress bar if reading
    takes longer than a second, and the samples decoded last are cached, within `Recording.memory`.
    """

    def __init__(self, store: Store, start_ns: int, rows: NDArray[np.int64] | None = None) -> None:
        self._store = store
        self._start_ns = start_ns
        self._rows = rows

    @staticmethod
    def decoder(channel: Channel, kind: Kind) -> Decoder:
        """Return the decoder of the messages of a channel."""
        return SampleDecoder(channel, kind.read)

    @property
    def topic(self) -> str:
        """The name of the topic."""
        return self._store.topic

    @property
    def is_read(self) -> bool:
        """True if all its samples were read."""
        return self._store.is_indexed

    def chunks(self) -> Iterator[Any]:
        """Yield the columns chunk by chunk; ``start`` of a chunk counts within this series.

        Only one chunk at a time is in memory, so a recording of any size fits.
        """
        return self._store.chunks(self._rows)

    def thinned(self, most_bytes: int, most_parts: int) -> Iterator[list[Any]]:
        """Yield the columns of a few parts of the file, evenly spread over its time, part by part.

        Nothing is yielded if the file has no index of its parts.

        Args:
            most_bytes: the maximum number of bytes to read in all.
            most_parts: the maximum number of parts. A part of a remote file takes one request.

        Raises:
            RecordingError: a part cannot be read.
        """
        return self._store.thinned(most_bytes, most_parts)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The stamps of the messages in nanoseconds, shape (N,); 0 for messages without one."""
        return self._picked(self._store.stamps_ns)

    @property
    def times_ns(self) -> NDArray[np.int64]:
        """Log times in nanoseconds since the epoch, shape (N,)."""
        return frozen(self._picked(self._all_times))

    @property
    def said(self) -> NDArray[np.bool_]:
        """True for each row that comes from a message, shape (N,)."""
        return np.ones(len(self), bool)

    @property
    def seconds(self) -> NDArray[np.float64]:
        """Log times in seconds from the start of the recording, shape (N,)."""
        return frozen((self.times_ns - self._start_ns) / 1e9)

    @property
    def problems(self) -> tuple[str, ...]:
        """The problems of the clock of the topic, one line each: standing still, or silent for long."""
        return about_clock(self.times_ns, self._start_ns)

    def __len__(self) -> int:
        return len(self._all_times if self._rows is None else self._rows)

    @overload
    def __getitem__(self, which: slice | NDArray[np.bool_]) -> Self: ...
    @overload
    def __getitem__(self, which: int) -> Moment: ...
    def __getitem__(self, which: int | slice | NDArray[np.bool_]) -> Self | Moment:
        if isinstance(which, slice):
            return self._with(self._row_numbers[which])
        if isinstance(which, np.ndarray) and which.dtype == bool:
            if which.shape != (len(self),):
                raise IndexError(f"{self.topic}: expected a mask of {len(self):,} values, got shape {which.shape}")
            return self._with(self._row_numbers[np.ma.filled(which, False)])
        try:
            number = as_index(which)
        except TypeError:
            raise TypeError(
                f"{self.topic}: expected a number, a slice of numbers or a mask, got {repr(which)[:60]}; "
                "by time there are at(seconds) and between(start, end)"
            ) from None
        if not -len(self) <= number < len(self):
            raise IndexError(
                f"{self.topic}: expected a number from 0 to {len(self) - 1:,}, got {number}"
                if len(self)
                else f"{self.topic}: the topic has no samples"
            )
        row = int(self._row_numbers[number])
        return self._moment(int(self._all_times[row]), self._sample(row))

    def __iter__(self) -> Iterator[Moment]:
        return (self._moment(time_ns, sample) for time_ns, sample in self._samples())

    def at(self, seconds: float) -> Moment:
        """Return the sample nearest to a time; if two are equally near, the first.

        Args:
            seconds: seconds from the start of the recording.

        Raises:
            TypeError: ``seconds`` is not a number.
            ValueError: ``seconds`` is infinite or NaN.
            RecordingError: the topic has no samples.
        """
        time_ns = to_ns(self._start_ns, "seconds", seconds)
        times = self.times_ns
        if not times.size:
            raise RecordingError(f"{self.topic}: the topic has no samples")
        return self[int(np.abs(times - time_ns).argmin())]

    def between(self, start: float | None = None, end: float | None = None) -> Self:
        """Return the samples from ``start`` up to, not including, ``end``, in seconds from the start of the recording.

        Args:
            start: the first time, or None for the start of the recording.
            end: the time after the last, or None for the end of the recording, included.

        Raises:
            TypeError: a time is not a number.
            ValueError: a time is infinite or NaN.
        """
        if start is None and end is None:
            return self
        first_ns, stop_ns = span_ns(self._start_ns, start, end)
        is_after = first_ns is None or self.times_ns >= first_ns
        is_before = stop_ns is None or self.times_ns < stop_ns
        return self._with(self._row_numbers[is_after & is_before])

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the columns by name; times as ``times_ns``, ``seconds`` and ``stamps_ns``."""
        return {"times_ns": self.times_ns, "seconds": self.seconds, "stamps_ns": self.stamps_ns}

    def __repr__(self) -> str:
        times = self.seconds
        span = f", {times.min():.2f} to {times.max():.2f} s" if times.size else ""
        return "\n".join((f"{self._title()}{span}", *(f"! {line}" for line in self.problems)))

    def _title(self) -> str:
        return f"{type(self).__name__} of {self.topic}: {len(self):,}"

    @property
    def _row_numbers(self) -> NDArray[np.int64]:
        """The rows of this series among all rows of the store, shape (N,)."""
        return np.arange(len(self._all_times)) if self._rows is None else self._rows

    @property
    def _all_times(self) -> NDArray[np.int64]:
        """Log times of all rows of the topic."""
        return self._store.times_ns

    def _with(self, rows: NDArray[np.int64]) -> Self:
        """Return a series with other rows of the topic."""
        return type(self)(self._store, self._start_ns, rows)

    def _sample(self, row: int) -> Taken:
        """Return the sample in one row of the topic."""
        sample: Taken = self._store.sample(row)
        return sample

    def _samples(self) -> Iterator[tuple[int, Taken]]:
        """Yield log time and sample of every row of this series."""
        for chunk in self.chunks():
            for i, time_ns in enumerate(chunk.times_ns.tolist()):
                yield time_ns, chunk.sample(i)

    def _array(self, name: str, width: int, kind: type[np.generic], column: Callable[[Any], Any]) -> NDArray[Any]:
        """Return a column of all chunks as one array, shape (N, width)."""
        dtype = np.dtype(kind)
        size = len(self) * width * dtype.itemsize
        with self._store.memory.reserved(size, f"{self.topic}: the array of all {name}"):
            array = np.empty((len(self), width), dtype)
            for chunk in self.chunks():
                array[chunk.start : chunk.start + len(chunk)] = column(chunk)
        return array

    def _picked(self, column: NDArray[Any]) -> NDArray[Any]:
        return column if self._rows is None else column[self._rows]

    def _moment(self, time_ns: int, sample: Any) -> Moment:
        return Moment(self.topic, time_ns, sample, (time_ns - self._start_ns) / 1e9)


def series_of(kind: Kind) -> type[Series[Any]]:
    """Return the class of the columns of a kind."""
    return Samples if kind.columns is None else kind.columns()


class Samples(Series[Any]):
    """The samples of a topic of any kind, with their times; see `Series` for the ways to select from them."""
