"""The notes of a step: the values that its places had, in the order in which they were computed."""

from __future__ import annotations

from collections import Counter
from functools import cached_property
from typing import Any, NamedTuple

from ...reasons.places import PASS, FunctionSource
from ...reasons.rewriting import Notes
from ...samples import Scan
from .values import glimpse

MOST_PASSES = 20
"""The number of passes of a loop whose notes are kept of one call; later ones are counted, and the last is kept."""


class Noted(NamedTuple):
    """A note: the number of its place, the value, and the extra values."""

    place: int
    value: Any
    extras: tuple[Any, ...] = ()


class CallNotes:
    """The notes of one call of a function, as they were written; they are read when they are asked for.

    Args:
        source: of the function.
        log: for each note the place, the value, and the extra values.
        counts: how often each place was noted; 0 outside of loops.
        last: the last values of places that were noted too often to be in the log.
        true: the places in loops that were True in any pass.
    """

    def __init__(
        self,
        source: FunctionSource,
        log: list[Any],
        counts: list[int],
        last: dict[int, tuple[Any, ...]],
        true: frozenset[int] = frozenset(),
    ) -> None:
        self.source, self.true = source, true
        self._log, self._counts, self._last = log, counts, last

    @cached_property
    def seen(self) -> tuple[Noted, ...]:
        """The notes, in the order in which they were written."""
        log, places, found = self._log, self.source.places, []
        i = 0
        # A step that was ended from outside may have left a note without all of its values.
        while i + 1 < len(log):
            extras = places[log[i]].extras
            found.append(Noted(log[i], log[i + 1], tuple(log[i + 2 : i + 2 + extras])))
            i += 2 + extras
        return tuple(found)

    @cached_property
    def last(self) -> dict[int, Noted]:
        """The last note of each place that has one."""
        found = {one.place: one for one in self.seen}
        found.update({place: Noted(place, value, tuple(more)) for place, (value, *more) in self._last.items()})
        return found

    @cached_property
    def counts(self) -> dict[int, int]:
        """The number of notes of each place."""
        in_log = Counter(one.place for one in self.seen)
        return {place: max(in_log[place], self._counts[place]) for place in self.last}


class Notebook:
    """Takes the notes of one function, one call after the other.

    Its functions are called in the thread of the step. They append to a list, and call nothing of a user's.

    Attributes:
        source: of the function.
        notes: the functions that note a value.
    """

    def __init__(self, source: FunctionSource) -> None:
        self.source = source
        self._log: list[Any] = []
        self._counts = [0] * len(source.places)
        self._zeros = self._counts[:]
        self._last: dict[int, tuple[Any, ...]] = {}
        self._none: dict[int, tuple[Any, ...]] = {}
        self._true: set[int] = set()
        in_loops = _in_loops(source, self._log, self._counts, self._last, self._true)
        self.notes = (*_outside_of_loops(self._log), *in_loops)

    def take(self) -> CallNotes:
        """Return the notes since the last time, and begin again."""
        log, counts, last, true = self._log[:], self._zeros, self._none, frozenset[int]()
        self._log.clear()
        if self.source.loops:
            counts, last, true = self._counts[:], self._last.copy(), frozenset(self._true)
            self._counts[:] = self._zeros
            self._last.clear()
            self._true.clear()
        return CallNotes(self.source, log, counts, last, true)


def _kept(value: Any) -> Any:
    kind = type(value)
    return value if kind is float or kind is bool or kind is int or value is None else glimpse(value)


def _outside_of_loops(log: list[Any]) -> Notes:
    add = log.append

    # Written out: a call of another function would take as long as all the rest.
    def note(place: int, value: Any) -> Any:
        kind = type(value)
        add(place)
        add(value if kind is float or kind is bool or kind is int or value is None else glimpse(value))
        return value

    def note_1(place: int, value: Any, one: Any) -> Any:
        kind = type(value)
        add(place)
        add(value if kind is float or kind is bool or kind is int or value is None else glimpse(value))
        kind = type(one)
        add(one if kind is float or kind is Scan or kind is int or one is None else glimpse(one))
        return value

    def note_2(place: int, value: Any, one: Any, other: Any) -> Any:
        kind = type(value)
        add(place)
        add(value if kind is float or kind is bool or kind is int or value is None else glimpse(value))
        kind = type(one)
        add(one if kind is float or kind is Scan or kind is int or one is None else glimpse(one))
        kind = type(other)
        add(other if kind is float or kind is bool or kind is int or other is None else glimpse(other))
        return value

    return note, note_1, note_2


def _in_loops(
    source: FunctionSource, log: list[Any], counts: list[int], last: dict[int, tuple[Any, ...]], true: set[int]
) -> Notes:
    begins = {one.loop: (number,) for number, one in enumerate(source.places) if one.kind == PASS}
    passes: dict[int | None, tuple[int, ...]] = {None: ()}
    """For each loop, the places at which a pass of it or of a loop around it begins."""
    for number, loop in enumerate(source.loops):
        passes[number] = *passes[loop.around], *begins.get(number, ())  # of an inner function's, no pass is noted
    passes_of = [passes[one.loop] for one in source.places]

    def put(place: int, value: Any, *more: Any) -> Any:
        count = counts[place] = counts[place] + 1
        kept = _kept(value)
        if kept is True:
            true.add(place)
        if count > MOST_PASSES or any(counts[begin] > MOST_PASSES for begin in passes_of[place]):
            last[place] = kept, *map(_kept, more)
        else:
            log.extend((place, kept, *map(_kept, more)))
        return value

    return put, put, put
