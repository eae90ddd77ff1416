"""Touches as columns: the state of each sensor after each message, and after each release without a message."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import cached_property
from math import inf
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...samples import Touch, TouchMode, TouchState
from ...samples.touch_tracker import TouchTracker
from .chunks import SampleChunk
from .series import Series
from .tables import Column

if TYPE_CHECKING:
    from typing_extensions import Self


class _Table(NamedTuple):
    """All states of a touch topic: the L sensors, N rows for messages and releases, states of shape (N, L)."""

    labels: tuple[str, ...]
    times_ns: NDArray[np.int64]
    stamps_ns: NDArray[np.int64]
    states: NDArray[np.uint8]
    said: NDArray[np.bool_]
    mode: TouchMode
    dialect: str


class _Row(NamedTuple):
    """One row of a table; ``states`` has the states of the sensors that were known at that time."""

    time_ns: int
    stamp_ns: int
    said: bool
    states: bytes


class Touches(Series[Touch]):
    """The states of the touch sensors of a topic as columns; see `Series` for the ways to select from them.

    Each message has a row with the states of all sensors after it, for any `TouchMode`: events, levels or lists of
    touched sensors. If a sensor is released because it is no longer listed, that has a row at the time of the release.
    """

    @property
    def labels(self) -> tuple[str, ...]:
        """The names of the L sensors."""
        return self._table.labels

    @property
    def states(self) -> NDArray[np.uint8]:
        """Shape (N, L), values of `TouchState`: 0 free, 1 touched, 2 unknown."""
        return self._picked(self._table.states)

    @property
    def lists_touches(self) -> bool:
        """True if each message lists the touched sensors, so that an empty message means that no sensor is touched."""
        return self._table.mode is TouchMode.PRESENCE

    @property
    def said(self) -> NDArray[np.bool_]:
        """True for each row that comes from a message, shape (N,); False for a release without a message."""
        return self._picked(self._table.said)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The stamps of the messages in nanoseconds, shape (N,); 0 for rows without one."""
        return self._picked(self._table.stamps_ns)

    def chunks(self) -> Iterator[Self]:
        """Yield the series itself, which is one table."""
        yield self

    def sample(self, number: int) -> Touch:
        """Return the states of all sensors in the row with this index."""
        return self._sample(int(self._row_numbers[number]))

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the times, and True, False or None (unknown) for each sensor by its label."""
        values = np.array([state.as_bool for state in sorted(TouchState)], object)
        return {**super().to_numpy(), **dict(zip(self.labels, values[self.states].T, strict=True))}

    def _columns_of_table(self) -> Mapping[str, Column]:
        """Return flags; unknown ones are masked."""
        flags = (np.ma.masked_array(one == TouchState.TOUCHED, one == TouchState.UNKNOWN) for one in self.states.T)
        return {**super().to_numpy(), **dict(zip(self.labels, flags, strict=True))}

    @cached_property
    def _table(self) -> _Table:
        return _read(self._store.chunks())

    @property
    def _all_times(self) -> NDArray[np.int64]:
        return self._table.times_ns

    def _with(self, rows: NDArray[np.int64]) -> Self:
        part = super()._with(rows)
        vars(part)["_table"] = self._table  # the value of the cached property
        return part

    def _sample(self, row: int) -> Touch:
        table = self._table
        touched = {
            label: TouchState(state).as_bool for label, state in zip(table.labels, table.states[row], strict=True)
        }
        return Touch(touched, stamp_ns=int(table.stamps_ns[row]) or None, dialect=table.dialect)

    def _samples(self) -> Iterator[tuple[int, Touch]]:
        for row in self._row_numbers.tolist():
            yield int(self._table.times_ns[row]), self._sample(row)


def _read(chunks: Iterable[SampleChunk]) -> _Table:
    """Return the states after each message, and after each release without a message."""
    tracker = TouchTracker()
    rows: list[_Row] = []
    touch = Touch({})

    def add(time_ns: int, stamp_ns: int, said: bool) -> None:
        states = tracker.states(time_ns)
        rows.append(_Row(time_ns, stamp_ns, said, bytes(sensor.state for sensor in states.values())))

    def release(until_ns: float) -> None:
        """Add the releases that are due before a time."""
        while rows and (due := tracker.next_change_ns(rows[-1].time_ns)) is not None and due < until_ns:
            add(due, 0, said=False)

    changes = True
    for chunk in chunks:
        columns = chunk.times_ns.tolist(), chunk.stamps_ns.tolist(), chunk.samples
        for time_ns, stamp_ns, latest in zip(*columns, strict=True):
            if latest is touch and not changes:
                rows.append(_Row(time_ns, stamp_ns, True, rows[-1].states))
                continue
            touch = latest
            release(time_ns)
            tracker.apply(touch, time_ns)
            add(time_ns, stamp_ns, said=True)
            # Unless a release is due, a repeated message changes nothing.
            changes = tracker.next_change_ns(time_ns) is not None
    release(inf)
    # A tracker keeps all sensors and their order: sensors that appear later are unknown in earlier rows.
    labels = tuple(tracker.states(0))
    states = b"".join(row.states.ljust(len(labels), bytes([TouchState.UNKNOWN])) for row in rows)
    return _Table(
        labels,
        np.array([row.time_ns for row in rows], np.int64),
        np.array([row.stamp_ns for row in rows], np.int64),
        np.frombuffer(states, np.uint8).reshape(len(rows), len(labels)),
        np.array([row.said for row in rows], bool),
        touch.mode,
        touch.dialect,
    )
