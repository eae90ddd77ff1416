"""The scans, speeds and touches of a recording, for a scanogram."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from ..samples import TouchState
from ..scanogram.levels import BUDGET
from ..scanogram.scans import Held, Scans, Sweep, cut
from ..scanogram_widget import ScanogramWidget
from . import scan_series
from .chunks import ScanChunk
from .recording import Recording, open
from .source import RecordingError
from .touch_series import Touches

HELD_BYTES = 256 << 20
"""Scans up to so many bytes are held in memory; where there are more, they are read again when they are looked at."""

LOOKED_AT_BYTES = 32 << 20
"""Of those that are read again, so many bytes are kept."""


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
        return cut(chunk.ranges for chunk in self._series.chunks())

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
    held = _held(scans, min(HELD_BYTES, recording.memory))
    counts = {rays: count for rays, count in scans.ray_counts.items() if rays}
    if not counts:
        raise RecordingError(f"{recording.path.name}: topic {scans.topic!r} holds no scan with rays")
    rays = max(counts, key=lambda rays: counts[rays])
    notes = []
    if counts[rays] < len(scans):
        notes.append(f"{len(scans) - counts[rays]} of {len(scans)} scans have not {rays} rays: not in the picture")
    source: Scans
    if held is None:
        # A file of its own, so that the recording given may be closed.
        widget._file = open(recording.path)
        widget._file.memory = min(LOOKED_AT_BYTES, recording.memory)
        own = _group(widget._file.scans(scans.topic), rays)
        likes = [chunk.like for chunk in own.chunks()]
        source = Read(own)
    else:
        same = [chunk for chunk in held if chunk.ranges.shape[1] == rays]
        likes = [chunk.like for chunk in same]
        source = Held(_group(scans, rays).times_ns, [chunk.ranges for chunk in same])
    sweep = Sweep.of(likes[0])
    if any(Sweep.of(like) != sweep for like in likes):
        notes.append("the scanner's geometry changes: the angles and limits are those of the first scan")
    notes += likes[0].notes
    widget._put(
        source,
        sweep,
        recording.start_ns or 0,
        duration=recording.duration,
        notes=notes,
        budget=min(BUDGET, recording.memory // 4),
    )
    if not widget.title:
        widget.title = scans.topic


def _held(scans: scan_series.Scans, most: int) -> list[ScanChunk] | None:
    """All chunks, on the first way through the file; None where their ranges take more than so many bytes."""
    chunks, size = [], 0
    for chunk in scans.chunks():
        size += chunk.ranges.nbytes
        if size > most:
            return None
        chunks.append(chunk)
    return chunks


def _group(scans: scan_series.Scans, rays: int) -> scan_series.Scans:
    return next(group for group in scans.groups if group.ray_count == rays)


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
