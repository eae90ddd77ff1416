"""Touches as columns: what is known of each sensor after each message, and after each release that no message tells."""

from __future__ import annotations

from collections.abc import Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..samples import Touch, TouchState
from ..touch_tracker import TouchTracker
from .chunks import TouchChunk
from .series import Rows, Series
from .store import Store

if TYPE_CHECKING:
    from typing_extensions import Self

_TOLD: dict[int, bool | None] = {TouchState.FREE: False, TouchState.TOUCHED: True, TouchState.UNKNOWN: None}


class Table:
    """All states of a touch topic.

    ``times_ns`` (N,), ``stamps_ns`` (N,), ``labels`` (L of them), ``states`` (N, L) of `TouchState`, ``said`` (N,):
    False in rows that are a release without a message.
    """

    def __init__(self, chunks: Iterator[TouchChunk], tracker: TouchTracker) -> None:
        self.labels: dict[str, int] = {}
        self.dialect = ""
        self._times: list[int] = []
        self._stamps: list[int] = []
        self._said: list[bool] = []
        self._rows: list[dict[int, int]] = []
        latest: int | None = None
        for chunk in chunks:
            for time_ns, touch in zip(chunk.times_ns.tolist(), chunk.touches, strict=True):
                self._release(tracker, time_ns if latest is None else max(latest, time_ns))
                tracker.apply(touch, time_ns)
                self._add(tracker, time_ns, touch.stamp_ns or 0, said=True)
                latest = time_ns
                self.dialect = touch.dialect
        self._release(tracker, None)
        self.times_ns = np.array(self._times, np.int64)
        self.stamps_ns = np.array(self._stamps, np.int64)
        self.said = np.array(self._said, bool)
        self.states = np.full((len(self._rows), len(self.labels)), TouchState.UNKNOWN, np.uint8)
        for row, states in zip(self.states, self._rows, strict=True):
            row[list(states)] = list(states.values())

    def _release(self, tracker: TouchTracker, until_ns: int | None) -> None:
        """Take in the releases that were due before a time; None: all that are."""
        now = self._times[-1] if self._times else 0
        while (due := tracker.next_change_ns(now)) is not None and (until_ns is None or due < until_ns):
            self._add(tracker, due, 0, said=False)
            now = due

    def _add(self, tracker: TouchTracker, time_ns: int, stamp_ns: int, said: bool) -> None:
        states = tracker.states(time_ns)
        for label in states:
            self.labels.setdefault(label, len(self.labels))
        self._times.append(time_ns)
        self._stamps.append(stamp_ns)
        self._said.append(said)
        self._rows.append({self.labels[label]: int(sensor.state) for label, sensor in states.items()})


class Touches(Series[Touch]):
    """The states of the touch sensors of a topic as columns; see `Series` for how to pick some of them.

    There is a row for each message: what is known of every sensor once it came, whether the topic speaks in events,
    levels or lists of what is touched (`TouchMode`). Where sensors are released because nothing lists them any more,
    there is a row for that too, at its time.
    """

    def __init__(self, store: Store[TouchChunk], start_ns: int, rows: Rows | None = None) -> None:
        self._store = store
        self._start_ns = start_ns
        self._rows = rows
        self._table: Table | None = None

    @property
    def topic(self) -> str:
        """The name of the topic."""
        name: str = self._store.feed.name
        return name

    @property
    def labels(self) -> tuple[str, ...]:
        """The names of its L sensors."""
        return tuple(self._known.labels)

    @property
    def states(self) -> NDArray[np.uint8]:
        """Shape (N, L), values of `TouchState`: 0 free, 1 touched, 2 unknown."""
        return self._picked(self._known.states)

    @property
    def said(self) -> NDArray[np.bool_]:
        """Shape (N,): True for a message, False for a release that none told."""
        return self._picked(self._known.said)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The times that the messages bear, in nanoseconds, shape (N,); 0 where they bear none."""
        return self._picked(self._known.stamps_ns)

    def sample(self, number: int) -> Touch:
        """What is known of every sensor in a row, by its number."""
        return self._sample(int(self.rows[number]))

    def columns(self) -> dict[str, NDArray[Any]]:
        """Times, and True, False or None (unknown) for each sensor by its label."""
        told = np.array([_TOLD[state] for state in sorted(_TOLD)], object)
        times = {"times_ns": self.times_ns, "seconds": self.seconds, "stamps_ns": self.stamps_ns}
        return {**times, **dict(zip(self.labels, told[self.states].T, strict=True))}

    @property
    def _known(self) -> Table:
        if self._table is None:
            self._table = Table(self._store.chunks(), TouchTracker())
        return self._table

    @property
    def _all_times(self) -> NDArray[np.int64]:
        return self._known.times_ns

    def _with(self, rows: Rows) -> Self:
        part = type(self)(self._store, self._start_ns, rows)
        part._table = self._known
        return part

    def _sample(self, row: int) -> Touch:
        table = self._known
        said = {label: _TOLD[int(state)] for label, state in zip(table.labels, table.states[row], strict=True)}
        return Touch(said, stamp_ns=int(table.stamps_ns[row]) or None, dialect=table.dialect)

    def _samples(self) -> Iterator[tuple[int, Touch]]:
        for row in np.asarray(self.rows).tolist():
            yield int(self._known.times_ns[row]), self._sample(row)
