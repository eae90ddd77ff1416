"""Touches as columns: the state of each sensor after each message, and after each release without a message."""

from __future__ import annotations

from array import array
from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ...samples import Touch, TouchMode, TouchState
from ...samples.touch_tracker import TouchTracker
from ._memory import Memory
from ._store import Store
from .chunks import SampleChunk
from .series import Rows, Series

if TYPE_CHECKING:
    from typing_extensions import Self

_AS_BOOL: dict[int, bool | None] = {TouchState.FREE: False, TouchState.TOUCHED: True, TouchState.UNKNOWN: None}


class Table:
    """All states of a touch topic.

    ``times_ns`` (N,), ``stamps_ns`` (N,), ``labels`` (L of them), ``states`` (N, L) of `TouchState`, ``said`` (N,):
    whether each row comes from a message.

    Raises:
        RecordingError: the table is larger than the limit of the memory, in which it counts.
    """

    def __init__(self, topic: str, chunks: Iterable[SampleChunk], tracker: TouchTracker, memory: Memory) -> None:
        self.dialect = ""
        self.mode = TouchMode.LEVEL
        rows = _Rows()
        latest: int | None = None
        same: Touch | None = None
        for chunk in chunks:
            for time_ns, touch in zip(chunk.times_ns.tolist(), chunk.samples, strict=True):
                stamp_ns = touch.stamp_ns or 0
                if touch is same and latest is not None and time_ns >= latest:
                    rows.repeat(time_ns, stamp_ns)
                else:
                    rows.release(tracker, time_ns if latest is None else max(latest, time_ns))
                    tracker.apply(touch, time_ns)
                    rows.add(tracker, time_ns, stamp_ns, said=True)
                    # Unless a release is due, the same message again changes nothing.
                    same = touch if tracker.next_change_ns(time_ns) is None else None
                latest = time_ns
                self.dialect, self.mode = touch.dialect, touch.mode
            memory.check(rows.nbytes, f"{topic}: the table of touches", "set recording.memory")
        rows.release(tracker, None)
        memory.take(rows.nbytes, f"{topic}: the table of touches", "set recording.memory")
        self.labels = tuple(rows.labels)
        self.times_ns = np.array(rows.times, np.int64)
        self.stamps_ns = np.array(rows.stamps, np.int64)
        self.said = np.array(rows.said, bool)
        self.states = rows.states()


class _Rows:
    """The rows of a table, collected one by one."""

    def __init__(self) -> None:
        self.labels: list[str] = []
        self.times, self.stamps = array("q"), array("q")
        self.said = bytearray()
        self._states: list[bytes] = []
        """For each row the states of the sensors that were known by then."""

    @property
    def nbytes(self) -> int:
        """Bytes of the table with these rows."""
        return len(self.times) * (8 + 8 + 1 + len(self.labels))

    def release(self, tracker: TouchTracker, until_ns: int | None) -> None:
        """Add the releases that were due before a time; None: all releases."""
        now = self.times[-1] if self.times else 0
        while (due := tracker.next_change_ns(now)) is not None and (until_ns is None or due < until_ns):
            self.add(tracker, due, 0, said=False)
            now = due

    def add(self, tracker: TouchTracker, time_ns: int, stamp_ns: int, said: bool) -> None:
        """Add a row with the states of the tracker at a time. The tracker forgets no sensor, and keeps their order."""
        states = tracker.states(time_ns)
        self.labels = list(states)
        self._add(time_ns, stamp_ns, said, bytes(sensor.state for sensor in states.values()))

    def repeat(self, time_ns: int, stamp_ns: int) -> None:
        """Add a row for a message that repeats the states of the last row."""
        self._add(time_ns, stamp_ns, True, self._states[-1])

    def states(self) -> NDArray[np.uint8]:
        """The states, shape (N, L); UNKNOWN before the first message of a sensor."""
        sensors, unknown = len(self.labels), bytes([TouchState.UNKNOWN])
        states = b"".join(row.ljust(sensors, unknown) for row in self._states)
        return np.frombuffer(states, np.uint8).reshape(len(self._states), sensors)

    def _add(self, time_ns: int, stamp_ns: int, said: bool, states: bytes) -> None:
        self.times.append(time_ns)
        self.stamps.append(stamp_ns)
        self.said.append(said)
        self._states.append(states)


class Touches(Series[Touch]):
    """The states of the touch sensors of a topic as columns; see `Series` for the ways to select from them.

    Each message has a row with the states of all sensors after it, for any `TouchMode`: events, levels or lists of
    touched sensors. A sensor that is released because it is no longer listed has a row for that, at the time of the
    release.
    """

    def __init__(self, store: Store, start_ns: int, rows: Rows | None = None) -> None:
        super().__init__(store, start_ns, rows)
        self._table: Table | None = None

    @property
    def labels(self) -> tuple[str, ...]:
        """The names of the L sensors."""
        return self._loaded.labels

    @property
    def states(self) -> NDArray[np.uint8]:
        """Shape (N, L), values of `TouchState`: 0 free, 1 touched, 2 unknown."""
        return self._picked(self._loaded.states)

    @property
    def lists_touches(self) -> bool:
        """Whether each message lists the sensors that are touched, so that an empty message means that none is."""
        return self._loaded.mode is TouchMode.PRESENCE

    @property
    def said(self) -> NDArray[np.bool_]:
        """Whether each row comes from a message, shape (N,); False for a release without a message."""
        return self._picked(self._loaded.said)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The stamps of the messages in nanoseconds, shape (N,); 0 for rows without one."""
        return self._picked(self._loaded.stamps_ns)

    def chunks(self) -> Iterator[Self]:
        """The series itself, which is one table."""
        yield self

    def sample(self, number: int) -> Touch:
        """The states of all sensors in the row with this index."""
        return self._sample(int(self.rows[number]))

    def columns(self) -> dict[str, NDArray[Any]]:
        """Times, and True, False or None (unknown) for each sensor by its label."""
        values = np.array([_AS_BOOL[state] for state in sorted(_AS_BOOL)], object)
        return {**super().columns(), **dict(zip(self.labels, values[self.states].T, strict=True))}

    @property
    def _loaded(self) -> Table:
        if self._table is None:
            self._table = Table(self.topic, self._store.chunks(), TouchTracker(), self._store.memory)
        return self._table

    @property
    def _all_times(self) -> NDArray[np.int64]:
        return self._loaded.times_ns

    def _with(self, rows: Rows) -> Self:
        part = type(self)(self._store, self._start_ns, rows)
        part._table = self._loaded
        return part

    def _sample(self, row: int) -> Touch:
        table = self._loaded
        touched = {label: _AS_BOOL[int(state)] for label, state in zip(table.labels, table.states[row], strict=True)}
        return Touch(touched, stamp_ns=int(table.stamps_ns[row]) or None, dialect=table.dialect)

    def _samples(self) -> Iterator[tuple[int, Touch]]:
        for row in np.asarray(self.rows).tolist():
            yield int(self._loaded.times_ns[row]), self._sample(row)
