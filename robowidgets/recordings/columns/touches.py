"""Touches as columns: the state of each sensor after each message, and after each release that no message tells."""

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

_TOLD: dict[int, bool | None] = {TouchState.FREE: False, TouchState.TOUCHED: True, TouchState.UNKNOWN: None}


class Table:
    """All states of a touch topic.

    ``times_ns`` (N,), ``stamps_ns`` (N,), ``labels`` (L of them), ``states`` (N, L) of `TouchState`, ``said`` (N,):
    False in rows that are a release without a message.

    Raises:
        RecordingError: it is larger than the limit of the memory, in which it counts from then on.
    """

    def __init__(self, topic: str, chunks: Iterable[SampleChunk], tracker: TouchTracker, memory: Memory) -> None:
        self.dialect = ""
        self.mode = TouchMode.LEVEL
        rows = _Growing()
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
                    # Where nothing is going to be released, the same message again changes nothing.
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


class _Growing:
    """The rows of a table as they come."""

    def __init__(self) -> None:
        self.labels: list[str] = []
        self.times, self.stamps = array("q"), array("q")
        self.said = bytearray()
        self._blocks: list[tuple[int, int, bytearray]] = []
        """First row, number of sensors, their states: a new block when another sensor is first heard of."""

    @property
    def nbytes(self) -> int:
        """Bytes of the table that they make."""
        return len(self.times) * (8 + 8 + 1 + len(self.labels))

    def release(self, tracker: TouchTracker, until_ns: int | None) -> None:
        """Take in the releases that were due before a time; None: all that are."""
        now = self.times[-1] if self.times else 0
        while (due := tracker.next_change_ns(now)) is not None and (until_ns is None or due < until_ns):
            self.add(tracker, due, 0, said=False)
            now = due

    def add(self, tracker: TouchTracker, time_ns: int, stamp_ns: int, said: bool) -> None:
        """A row: what the tracker knows at a time. It forgets no sensor, and keeps their order."""
        states = tracker.states(time_ns)
        if not self._blocks or len(states) > len(self.labels):
            self.labels = list(states)
            self._blocks.append((len(self.times), len(states), bytearray()))
        self.times.append(time_ns)
        self.stamps.append(stamp_ns)
        self.said.append(said)
        self._blocks[-1][-1].extend(sensor.state for sensor in states.values())

    def repeat(self, time_ns: int, stamp_ns: int) -> None:
        """A row with the states of the last one, which a message says again."""
        self.times.append(time_ns)
        self.stamps.append(stamp_ns)
        self.said.append(True)
        _, sensors, block = self._blocks[-1]
        block.extend(block[len(block) - sensors :])

    def states(self) -> NDArray[np.uint8]:
        """Shape (N, L); what was not heard of yet is unknown."""
        states = np.full((len(self.times), len(self.labels)), TouchState.UNKNOWN, np.uint8)
        for first, sensors, block in self._blocks:
            if sensors:
                part = np.frombuffer(block, np.uint8).reshape(-1, sensors)
                states[first : first + len(part), :sensors] = part
        return states


class Touches(Series[Touch]):
    """The states of the touch sensors of a topic as columns; see `Series` for how to pick some of them.

    There is a row for each message: what is known of every sensor once it came, whether the topic speaks in events,
    levels or lists of what is touched (`TouchMode`). Where sensors are released because nothing lists them any more,
    there is a row for that too, at its time.
    """

    def __init__(self, store: Store, start_ns: int, rows: Rows | None = None) -> None:
        super().__init__(store, start_ns, rows)
        self._table: Table | None = None

    @property
    def labels(self) -> tuple[str, ...]:
        """The names of its L sensors."""
        return self._known.labels

    @property
    def states(self) -> NDArray[np.uint8]:
        """Shape (N, L), values of `TouchState`: 0 free, 1 touched, 2 unknown."""
        return self._picked(self._known.states)

    @property
    def lists_touches(self) -> bool:
        """Whether each message lists the sensors that are touched, so that an empty one says that none is."""
        return self._known.mode is TouchMode.PRESENCE

    @property
    def said(self) -> NDArray[np.bool_]:
        """Shape (N,): True for a message, False for a release that none told."""
        return self._picked(self._known.said)

    @property
    def stamps_ns(self) -> NDArray[np.int64]:
        """The times that the messages bear, in nanoseconds, shape (N,); 0 where they bear none."""
        return self._picked(self._known.stamps_ns)

    def chunks(self) -> Iterator[Self]:
        """Itself: all of it is one table."""
        yield self

    def sample(self, number: int) -> Touch:
        """What is known of every sensor in a row, by its number."""
        return self._sample(int(self.rows[number]))

    def columns(self) -> dict[str, NDArray[Any]]:
        """Times, and True, False or None (unknown) for each sensor by its label."""
        told = np.array([_TOLD[state] for state in sorted(_TOLD)], object)
        return {**super().columns(), **dict(zip(self.labels, told[self.states].T, strict=True))}

    @property
    def _known(self) -> Table:
        if self._table is None:
            self._table = Table(self.topic, self._store.chunks(), TouchTracker(), self._store.memory)
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
