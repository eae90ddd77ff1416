"""The scans, speeds and touches of a recording, for a scanogram."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..samples import TouchState
from ..scanogram.scans import CHUNK_CELLS, Held, Scans, Sweep
from ..scanogram_widget import ScanogramWidget
from . import scan_series
from .recording import Recording, open
from .source import RecordingError
from .touch_series import Touches

HELD_BYTES = 256 << 20
"""Scans up to so many bytes are held in memory; where there are more, they are read again when they are looked at."""


class Read:
    """Scans that are read from a file whenever they are needed.

    Args:
        series: scans with the same number of rays.
    """

    def __init__(self, series: scan_series.Scans) -> None:
        self._series = series
        self.times_ns = series.times_ns

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """See `Scans`."""
        for chunk in self._series.chunks():
            rows = max(1, CHUNK_CELLS // max(1, chunk.ranges.shape[1]))
            for start in range(0, len(chunk), rows):
                yield chunk.ranges[start : start + rows]

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """See `Scans`."""
        return np.concatenate([chunk.ranges for chunk in self._series[start:stop].chunks()])


def fill(widget: ScanogramWidget, recording: Recording, topic: str | None) -> None:
    """Put the scans of a recording into a scanogram, with its measured speed and all its touches."""
    if topic is None:
        topic = next((t.name for t in recording.topics if t.widget == "laser"), None)
    _put_scans(widget, recording, recording.scans(topic))
    _put_speeds(widget, recording)
    _put_touches(widget, recording)


def _put_scans(widget: ScanogramWidget, recording: Recording, scans: scan_series.Scans) -> None:
    groups = [group for group in scans.groups if len(group) and group.ray_count]
    if not groups:
        raise RecordingError(f"{recording.path.name}: topic {scans.topic!r} holds no scan with rays")
    most = max(groups, key=len)
    first = next(iter(most.chunks())).like
    notes = [*first.notes]
    if len(most) < len(scans):
        notes.append(
            f"{len(scans) - len(most)} of {len(scans)} scans have not {most.ray_count} rays: not in the picture"
        )
    sweep = Sweep.of(first)
    if any(Sweep.of(chunk.like) != sweep for chunk in most.chunks()):
        notes.append("the scanner's geometry changes: the angles and limits are those of the first scan")
    source: Scans
    if 4 * len(most) * most.ray_count <= min(HELD_BYTES, recording.memory):
        source = Held(most.times_ns, most.ranges)
    else:
        # A file of its own, so that the recording given may be closed.
        widget._file = open(recording.path)
        own = widget._file.scans(scans.topic).groups
        source = Read(next(group for group in own if group.ray_count == most.ray_count))
    widget._put(source, sweep, recording.start_ns or 0, duration=recording.duration, notes=notes)
    if not widget.title:
        widget.title = scans.topic


def _put_speeds(widget: ScanogramWidget, recording: Recording) -> None:
    """The first measured speed; a commanded one where none was measured."""
    topics = sorted((t for t in recording.topics if t.widget == "speed"), key=lambda topic: topic.commanded)
    for topic in topics:
        speeds = recording.speeds(topic.name)
        if len(speeds):
            widget.set_speeds(times_ns=speeds.times_ns, values=speeds.values, title=topic.name)
            return


def _put_touches(widget: ScanogramWidget, recording: Recording) -> None:
    topics = [t.name for t in recording.topics if t.widget == "touch"]
    if topics:
        spans = [span for topic in topics for span in touched(recording.touches(topic), recording.duration)]
        widget.set_touches(spans, title=", ".join(topics))


def touched(touches: Touches, end: float) -> Iterator[tuple[float, float, str]]:
    """When each sensor was touched: start and end in seconds from the start, and its name."""
    times = np.append(np.maximum.accumulate(touches.seconds), max([end, *touches.seconds[-1:]]))
    for label, states in zip(touches.labels, touches.states.T, strict=True):
        edges = np.diff(np.concatenate(([False], states == TouchState.TOUCHED, [False])).astype(np.int8))
        for first, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            yield float(times[first]), float(times[stop]), label
