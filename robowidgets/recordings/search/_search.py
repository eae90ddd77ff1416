"""One search through a recording: the results of conditions, and the nearest readings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from math import pi
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

from ...samples.checks import ANGLE_ROUNDING, shortest
from ..span import Span
from ._silence import mark_stale
from ._steps import NO, Steps, inverted, spans, steps

if TYPE_CHECKING:
    from .. import RecordingData

_NEAREST = "nearest"
"""Stands for all conditions on distances, because a span has one nearest reading."""

_LAST = np.iinfo(np.int64).max


class Chunked(Protocol):
    """A series of samples that is read in chunks."""

    def chunks(self) -> Iterator[Any]:
        """Yield the chunks, each with ``times_ns``."""


class HasSteps(Protocol):
    """A condition, or a part of one."""

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""


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
        self._is_negated = False
        """True while the condition that is computed makes the whole one true by being false."""
        self._new_notes: list[tuple[Any, list[NDArray[Any]]]] = []
        """A condition, and times of samples, True for each sample with a note, and the columns of the notes."""
        self._notes: list[_Notes] = []
        self._bar = bar

    def steps_of(self, condition: HasSteps, *, is_negated: bool = False) -> Steps:
        """Return the steps of a condition, and limit its notes to the times at which it makes the whole one true.

        Args:
            condition: the condition, or a part of it.
            is_negated: True for the part of a condition that is true if this part is false.
        """
        before = len(self._notes)
        self._is_negated ^= is_negated
        result = condition.steps(self)
        if self._new_notes:
            who, parts = zip(*self._new_notes, strict=True)
            times, has_note, *columns = (np.concatenate(column) for column in zip(*parts, strict=True))
            ends = np.append(times[1:], _LAST)[has_note]  # a sample is in force until the next one
            self._notes.append(_Notes(who[0], [times[has_note], ends, times[has_note], *columns]))
            self._new_notes.clear()
        if len(self._notes) > before:
            when = np.array(spans(inverted(result) if self._is_negated else result, self.end_ns + 1), np.int64)
            self._notes[before:] = [one.within(when.reshape(-1, 2)) for one in self._notes[before:]]
        self._is_negated ^= is_negated
        return result

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
        has_note: NDArray[np.bool_],
        distances: NDArray[np.floating[Any]],
        indices: NDArray[np.integer[Any]],
        angles: NDArray[np.floating[Any]],
    ) -> None:
        """Note the nearest readings of the scans for which a condition was true.

        Distances are as in `Scan.distance`, so 0 is too close to measure. Angles are kept within ±pi, as in `Ray`.

        Args:
            times: nanoseconds, of all scans.
            has_note: True for the N scans with a note.
            distances: metres, shape (N,).
            indices: of the rays, shape (N,).
            angles: radians, shape (N,).
        """
        within = np.where(np.abs(angles) > pi + ANGLE_ROUNDING, np.arctan2(np.sin(angles), np.cos(angles)), angles)
        self._note(_NEAREST, times, has_note, distances, indices, within)

    def compared(
        self,
        by: Any,
        times: NDArray[np.int64],
        has_note: NDArray[np.bool_],
        values: NDArray[np.floating[Any]],
        ranks: NDArray[np.floating[Any]],
    ) -> None:
        """Note the numbers for which a condition was true.

        Args:
            by: the condition.
            times: nanoseconds, of all samples.
            has_note: True for the N samples with a note.
            values: the numbers, shape (N,).
            ranks: the number with the lowest rank represents a span; of equal ranks, the first. Shape (N,).
        """
        self._note(by, times, has_note, ranks, values)

    def _note(self, by: Any, *columns: NDArray[Any]) -> None:
        if not self._is_negated:
            self._new_notes.append((by, [*columns]))

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
        when = np.array(found, np.int64).reshape(-1, 2)
        noted: dict[Any, list[_Notes]] = {}
        for one in self._notes:
            noted.setdefault(one.by, []).append(one)
        nearest = _least(noted.pop(_NEAREST, []), when)
        numbers = [_least(notes, when) for notes in noted.values()]
        return [
            Span(
                (a - start_ns) / 1e9,
                (b - start_ns) / 1e9,
                (b - a) / 1e9,
                a,
                b,
                tuple(_silent(silences, a, b)),
                *_met(nearest.get(i)),
                *_value(one.get(i) for one in numbers),
            )
            for i, (a, stop) in enumerate(found)
            for b in [min(stop, self.end_ns)]
        ]


class _Notes(NamedTuple):
    """Notes of samples in force while a condition was true.

    ``by``: the condition. ``columns``: start and end of each note, the time of its sample, its rank, and more.
    """

    by: Any
    columns: list[NDArray[Any]]

    def within(self, when: NDArray[np.int64]) -> _Notes:
        """Return the notes in some spans, shape (M, 2), each cut to its span."""
        rows, place = _overlaps(self.columns[0], self.columns[1], when)
        starts, ends, *more = (column[rows] for column in self.columns)
        return _Notes(self.by, [np.maximum(starts, when[place, 0]), np.minimum(ends, when[place, 1]), *more])


def _overlaps(
    starts: NDArray[np.int64], ends: NDArray[np.int64], when: NDArray[np.int64]
) -> tuple[NDArray[np.intp], NDArray[np.intp]]:
    """Return each pair of a note and a span that overlap, as indices. If start and end are equal, it lasts 1 ns."""
    first = np.searchsorted(np.maximum(when[:, 1], when[:, 0] + 1), starts, side="right")
    counts = np.searchsorted(when[:, 0], np.maximum(ends, starts + 1)) - first
    rows = np.repeat(np.arange(len(starts)), counts)
    return rows, np.arange(len(rows)) + np.repeat(first - np.cumsum(counts) + counts, counts)


def _least(parts: list[_Notes], when: NDArray[np.int64]) -> dict[int, list[Any]]:
    """Return the note with the lowest rank for each span that has notes, the first of equal ones: its columns."""
    if not parts:
        return {}
    columns = [np.concatenate(column) for column in zip(*(one.columns for one in parts), strict=True)]
    starts, ends, _, ranks, *_ = columns
    rows, place = _overlaps(starts, ends, when)
    order = np.lexsort((starts[rows], ranks[rows], place))
    spans_with, first = np.unique(place[order], return_index=True)
    best = rows[order[first]]
    return {int(i): [column[row] for column in columns] for i, row in zip(spans_with, best, strict=True)}


def _met(row: list[Any] | None) -> tuple[float | None, int | None, float | None, int | None]:
    """Return distance, index, angle and time of the nearest reading, or four times None without one."""
    if row is None:
        return None, None, None, None
    _, _, time_ns, distance, index, angle = row
    return shortest(distance), int(index), float(angle), int(time_ns)


def _value(rows: Iterable[list[Any] | None]) -> tuple[float | None, int | None]:
    """Return the number of the first condition that compared one, and its time, or twice None."""
    row = next((row for row in rows if row is not None), None)
    return (None, None) if row is None else (float(row[4]), int(row[2]))


def _silent(silences: list[tuple[str, NDArray[np.int64]]], start_ns: int, end_ns: int) -> dict[str, None]:
    """Return the topics with a silence in a span of time, each once, in order."""
    names: dict[str, None] = {}
    for topic, when in silences:
        next_one = np.searchsorted(when[:, 1], start_ns, side="right")
        if next_one < len(when) and when[next_one, 0] < max(end_ns, start_ns + 1):
            names[topic] = None
    return names
