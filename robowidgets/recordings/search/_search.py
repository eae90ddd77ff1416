"""One search through a recording: the results of conditions, and the nearest readings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import pi
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...samples.checks import ANGLE_ROUNDING, shortest
from ..span import Span
from ._silence import mark_stale
from ._steps import NO, Steps, spans, steps

if TYPE_CHECKING:
    from .. import RecordingData


class Chunked(Protocol):
    """A series of samples that is read in chunks."""

    def chunks(self) -> Iterator[Any]:
        """Yield the chunks, each with ``times_ns``."""


class Search:
    """One search through a recording.

    After an interrupt, the search ends at ``end_ns``.

    Args:
        recording: the recording.
        topics: see `Recording.find`.
        bar: the progress bar; counts the samples that were read.
    """

    def __init__(self, recording: RecordingData, topics: str | Iterable[str] | None, bar: Any) -> None:
        self.recording = recording
        self.topics = topics
        self.end_ns = recording.end_ns or 0
        self.is_cut = False
        self.silences: list[tuple[str, Steps]] = []
        """Topics, and steps that are YES while the topic is silent for too long."""
        self.read: dict[Any, frozenset[str]] = {}
        """For each condition that is a function, the topics that it read."""
        self._met: list[tuple[NDArray[Any], ...]] = []
        """Times, distances, indices and angles of the nearest readings while a condition was true."""
        self._compared: dict[Any, list[tuple[NDArray[Any], ...]]] = {}
        """For each condition, the times, ranks and numbers that it compared while it was true."""
        self._bar = bar

    def over(self, series: Chunked, test: Callable[[Any], NDArray[np.int8]]) -> Steps:
        """Return the steps of a test that takes a chunk and returns a value for each sample; UNKNOWN if stale."""
        found = self._tested(series, test)
        return mark_stale(found, [(found.times, np.ones(len(found.times), bool))], self.end_ns)

    def times(self, series: Chunked) -> NDArray[np.int64]:
        """Return the times of the samples of a series, shape (N,)."""
        return self._tested(series, lambda chunk: np.full(len(chunk), NO, np.int8)).times

    def _tested(self, series: Chunked, test: Callable[[Any], NDArray[np.int8]]) -> Steps:
        # One list, so that after an interrupt all times have values.
        parts: list[tuple[NDArray[np.int64], NDArray[np.int8]]] = [(np.empty(0, np.int64), np.empty(0, np.int8))]
        try:
            for chunk in series.chunks():
                if self.is_cut and chunk.times_ns[0] > self.end_ns:
                    break
                parts.append((chunk.times_ns, test(chunk)))
                self.looked_at(len(chunk))
        except KeyboardInterrupt:
            self.cut(int(parts[-1][0][-1]) if len(parts) > 1 else self.recording.start_ns or 0)
        return steps(np.concatenate([times for times, _ in parts]), np.concatenate([values for _, values in parts]))

    def met(
        self,
        times: NDArray[np.int64],
        distances: NDArray[np.floating[Any]],
        indices: NDArray[np.integer[Any]],
        angles: NDArray[np.floating[Any]],
    ) -> None:
        """Note the nearest readings in some scans, each array of shape (N,): nanoseconds, metres, indices, radians.

        Distances are as in `Scan.distance`, so 0 is too close to measure. Angles are kept within ±pi, as in `Ray`.
        """
        within = np.where(np.abs(angles) > pi + ANGLE_ROUNDING, np.arctan2(np.sin(angles), np.cos(angles)), angles)
        self._met.append((times, distances, indices, within))

    def compared(
        self, by: Any, times: NDArray[np.int64], values: NDArray[np.float64], ranks: NDArray[np.float64]
    ) -> None:
        """Note the numbers for which a condition was true, each array of shape (N,).

        Args:
            by: the condition.
            times: nanoseconds.
            values: the numbers.
            ranks: the number with the lowest rank represents a span; of equal ranks, the first.
        """
        self._compared.setdefault(by, []).append((times, ranks, values))

    def looked_at(self, count: int) -> None:
        """Advance the progress bar."""
        self._bar.update(count)

    def cut(self, time_ns: int) -> None:
        """End the search at a time."""
        self.end_ns = min(self.end_ns, time_ns)
        self.is_cut = True

    def found(self, result: Steps) -> list[Span]:
        """Return the spans in which a condition is true, each with its nearest reading and its silent topics."""
        inside = result.times <= self.end_ns
        # A nanosecond later, because a span that lasts to the end includes the last sample.
        found = spans(Steps(result.times[inside], result.values[inside]), self.end_ns + 1)
        silences = [
            (topic, np.array(spans(when, self.end_ns), np.int64).reshape(-1, 2)) for topic, when in self.silences
        ]
        start_ns = self.recording.start_ns or 0
        nearest = _Least(self._met)
        numbers = [_Least(parts) for parts in self._compared.values()]
        return [
            Span(
                (a - start_ns) / 1e9,
                (b - start_ns) / 1e9,
                (b - a) / 1e9,
                a,
                b,
                tuple(_silent(silences, a, b)),
                *_met(nearest.between(a, stop)),
                *_value(one.between(a, stop) for one in numbers),
            )
            for a, stop in found
            for b in [min(stop, self.end_ns)]
        ]


class _Least:
    """Notes from the times when a condition was true. The note with the lowest rank represents a span.

    Args:
        parts: arrays of equal lengths: times, ranks, and more.
    """

    def __init__(self, parts: list[tuple[NDArray[Any], ...]]) -> None:
        self._columns = [np.concatenate(column) for column in zip(*parts, strict=True)]
        if self._columns:
            order = np.argsort(self._columns[0], kind="stable")
            self._columns = [column[order] for column in self._columns]

    def between(self, start_ns: int, end_ns: int) -> list[Any] | None:
        """Return the first of the lowest ranks in a span as one value of each array, or None without notes."""
        if not self._columns:
            return None
        times, ranks = self._columns[:2]
        first = np.searchsorted(times, start_ns)
        last = np.searchsorted(times, max(end_ns, start_ns + 1))
        if first == last:
            return None
        at = first + int(ranks[first:last].argmin())
        return [column[at] for column in self._columns]


def _met(row: list[Any] | None) -> tuple[float | None, int | None, float | None, int | None]:
    """Return distance, index, angle and time of the nearest reading, or four times None without one."""
    if row is None:
        return None, None, None, None
    time_ns, distance, index, angle = row
    return shortest(distance), int(index), float(angle), int(time_ns)


def _value(rows: Iterable[list[Any] | None]) -> tuple[float | None, int | None]:
    """Return the number of the first condition that compared one, and its time, or twice None."""
    row = next((row for row in rows if row is not None), None)
    return (None, None) if row is None else (float(row[2]), int(row[0]))


def _silent(silences: list[tuple[str, NDArray[np.int64]]], start_ns: int, end_ns: int) -> dict[str, None]:
    """Return the topics with a silence in a span of time, each once, in order."""
    names: dict[str, None] = {}
    for topic, when in silences:
        next_one = np.searchsorted(when[:, 1], start_ns, side="right")
        if next_one < len(when) and when[next_one, 0] < max(end_ns, start_ns + 1):
            names[topic] = None
    return names
