"""What the widgets of a recording show at each of its times, packed as the page takes it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import nan
from struct import Struct
from typing import Any, NamedTuple, Protocol

import numpy as np

from .._core.robot_widget import HEAD
from ..laser_widget import LaserWidget, about_scan
from ..recording import Recording
from ..recordings.timeline import Moment
from ..samples import Scan, Speed, Touch
from ..speed_widget import Reading, SpeedWidget
from ..touch_widget import about_touch, pack_states
from ._touch_history import TouchHistory

NO_SCAN = Scan(np.empty(0, np.float32), 0.0, 0.0, 0.0, 10.0, notes=("no scan up to this time of the recording",))
NO_SPEED = Speed((nan, nan, nan), (nan, nan, nan))

TICK = 0.1
"""Seconds between two stills of touches at most: their durations grow without a message."""

BEFORE = -1.0
"""Seconds, of a still that shows that nothing was measured yet."""

_ROW = Struct("<3d")


class Still(NamedTuple):
    """What a widget shows from a time on, in seconds from the start of the recording, and what is said of it.

    Before anything was measured it is `BEFORE` all.
    """

    seconds: float
    about: dict[str, Any]
    frame: bytes


class Track(Protocol):
    """The stills of one widget."""

    def stills(self, start: float, end: float) -> Iterator[Still]:
        """What it shows at a time, which may be from long before, and all that follows up to another time."""


class LaserTrack:
    """The scans of a topic."""

    def __init__(self, recording: Recording, topic: str, widget: LaserWidget) -> None:
        self._recording, self._topic, self._widget = recording, topic, widget

    def stills(self, start: float, end: float) -> Iterator[Still]:
        """See `Track`."""
        held = self._recording.at(self._topic, start)
        yield self._still(held.seconds, held.sample) if held else self._still(BEFORE, NO_SCAN)
        for moment in self._recording.samples(self._topic, start, end):
            yield self._still(moment.seconds, moment.sample)

    def _still(self, seconds: float, sample: Any) -> Still:
        scan = sample.turned(self._widget.angle_offset)
        return Still(seconds, about_scan(scan), _head(scan) + self._widget._pack(scan))


class SpeedTrack:
    """The measured speeds of a topic, with those of the commanded one, if there is one."""

    def __init__(self, recording: Recording, topic: str, command: str, widget: SpeedWidget) -> None:
        self._recording, self._topic, self._command, self._widget = recording, topic, command, widget

    def stills(self, start: float, end: float) -> Iterator[Still]:
        """See `Track`."""
        names = [name for name in (self._topic, self._command) if name]
        held = {name: self._recording.at(name, start) for name in names}
        now = {name: moment.sample if moment else NO_SPEED for name, moment in held.items()}
        yield self._still(max(moment.seconds if moment else BEFORE for moment in held.values()), now)
        for moment in self._recording.samples(names, start, end):
            now[moment.topic] = moment.sample
            yield self._still(moment.seconds, now)

    def _still(self, seconds: float, now: Mapping[str, Any]) -> Still:
        measured = now[self._topic]
        reading = Reading(commanded=now.get(self._command)).moved(measured)
        return Still(seconds, {"frame_id": measured.frame_id}, _head(measured) + self._widget._pack(reading))


class TouchTrack:
    """The touches of a topic, with what becomes of them when no message comes."""

    def __init__(self, recording: Recording, topic: str) -> None:
        self._recording, self._topic = recording, topic
        self._history = TouchHistory(recording, topic)

    def stills(self, start: float, end: float) -> Iterator[Still]:
        """See `Track`."""
        moments: list[Moment | None] = [*self._recording.samples(self._topic, start, end), None]
        start_ns = self._recording.start_ns or 0
        tracker = self._history.at(start_ns + round(start * 1e9) - 1)
        seconds = start
        for moment in moments:
            until = end if moment is None else moment.seconds
            while seconds < until:
                now_ns = start_ns + round(seconds * 1e9)
                newest = tracker.newest or Touch({})
                frame = _head(newest) + pack_states(tracker, now_ns)
                yield Still(seconds, {**about_touch(newest), "still": True}, frame)
                change_ns = tracker.next_change_ns(now_ns)
                change = until if change_ns is None else (change_ns - start_ns) / 1e9
                seconds = min(seconds + TICK, max(change, seconds + 1e-3), until)
            if moment is not None and isinstance(moment.sample, Touch):
                tracker.apply(moment.sample, moment.time_ns)


def pack(stills: list[Still]) -> tuple[list[dict[str, Any]], bytes]:
    """Stills as the page reads them: what is said of them, each once, and a table of times before the frames."""
    abouts: list[dict[str, Any]] = []
    rows, end = [], 0
    for still in stills:
        if still.about not in abouts:
            abouts.append(still.about)
        end += len(still.frame)
        rows.append(_ROW.pack(still.seconds, abouts.index(still.about), end))
    return abouts, b"".join([np.float64(len(stills)).tobytes(), *rows, *(still.frame for still in stills)])


def _head(sample: Any) -> bytes:
    """Of a frame that the page numbers itself, from a source that has no rate."""
    return HEAD.pack(0.0, nan, sample.stamp_ns or 0, sample._arrived)
