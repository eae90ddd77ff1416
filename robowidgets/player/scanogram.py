"""The scans, speeds and touches of a recording, for a scanogram."""

from __future__ import annotations

from collections.abc import Collection, Iterator
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .._core.cells import take_the_place
from .._widget_choice import shared
from ..kinds import LASER, SPEED, TOUCH, Kind
from ..recordings import RecordingData
from ..recordings.columns.chunks import ScanChunk
from ..recordings.columns.scans import Scans as ScanSeries
from ..recordings.columns.touches import Touches
from ..recordings.topics import Topic
from ..repair import RecordingError
from ..samples import Scan, TouchState
from ..scanogram.by_angle import keeps_indices, on_rays, rays_at
from ..scanogram.levels import BUDGET
from ..scanogram.scans import Held, Scans, Sweep, cut
from ..scanogram_widget import ScanogramWidget

HELD_BYTES = 256 << 20
"""Scans up to so many bytes are held in memory; where there are more, they are read again when they are looked at."""

LOOKED_AT_BYTES = 32 << 20
"""Of those that are read again, so many bytes are kept."""

_FINER = 2
"""How many times as many rays as is usual a scan may have."""

_KNOWN = 1000


class Onto:
    """Puts scans on the rays of one sweep. Those with more rays than it has none of there.

    Args:
        sweep: the rays.
    """

    def __init__(self, sweep: Sweep) -> None:
        self.sweep = sweep
        self._rays = lru_cache(_KNOWN)(lambda of: rays_at(of, sweep))

    def fits(self, like: Scan) -> bool:
        """Whether scans like this one are in the picture."""
        return 0 < len(like) <= self.sweep.ray_count

    def keeps_indices(self, like: Scan) -> bool:
        """Whether their rays have the same indices there."""
        return not self.fits(like) or self._is_same(like) or keeps_indices(self._rays(Sweep.of(like)))

    def __call__(self, chunk: ScanChunk) -> Iterator[NDArray[np.float32]]:
        """The ranges of a chunk, in arrays of shape (n, rays of the sweep)."""
        if self._is_same(chunk.like):
            yield chunk.ranges
            return
        rays = self._rays(Sweep.of(chunk.like)) if self.fits(chunk.like) else np.full(self.sweep.ray_count, -1)
        # A few at a time, for there may be many more rays than they had.
        for ranges in cut([chunk.ranges], self.sweep.ray_count):
            yield on_rays(ranges, rays)

    def _is_same(self, like: Scan) -> bool:
        sweep = self.sweep
        return (len(like), like.angle_min, like.angle_increment) == (
            sweep.ray_count, sweep.angle_min, sweep.angle_increment
        )  # fmt: skip


class Read:
    """Scans that are read from a file whenever they are needed.

    Args:
        series: where they are.
        onto: puts those of a chunk on the rays of the picture.
    """

    def __init__(self, series: ScanSeries, onto: Onto) -> None:
        self._series, self._onto = series, onto
        self.times_ns = series.times_ns

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """See `Scans`."""
        return cut(ranges for chunk in self._series.chunks() for ranges in self._onto(chunk))

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """See `Scans`."""
        return np.concatenate([ranges for chunk in self._series[start:stop].chunks() for ranges in self._onto(chunk)])


def scanogram(
    recording: RecordingData, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
) -> ScanogramWidget:
    """See `ScanogramWidget.of`."""
    widget = ScanogramWidget(**options)
    take_the_place(widget)
    with widget.hold_sync():
        widget._is_whole = False
        _fill(widget, recording, topic, beside)
        widget._is_whole = True
        widget._draw(widget._scans_first("of()"))
    return widget


def _fill(widget: ScanogramWidget, recording: RecordingData, topic: str | None, beside: Collection[str] | None) -> None:
    """Put the scans of a recording into a scanogram, with the measured speed and all touches of the same robot."""
    lasers = [t.name for t in recording.topics if t.widget == LASER.name]
    scans = recording.scans(lasers[0] if topic is None and lasers else topic)
    _put_scans(widget, recording, scans)

    def of_the_robot(kind: Kind) -> list[Topic]:
        topics = [t for t in recording.topics if t.widget == kind.name and (beside is None or t.name in beside)]
        return [t for t in topics if shared(t.name, scans.topic) == max(shared(t.name, name) for name in lasers)]

    _put_speeds(widget, recording, of_the_robot(SPEED))
    _put_touches(widget, recording, [t.name for t in of_the_robot(TOUCH)])


def _put_scans(widget: ScanogramWidget, recording: RecordingData, scans: ScanSeries) -> None:
    most = min(HELD_BYTES, recording.memory)
    held = _held(scans, most)
    counts = {rays: count for rays, count in scans.ray_counts.items() if rays}
    if not counts:
        raise RecordingError(f"{recording.path.name}: topic {scans.topic!r} holds no scan with rays")
    usual = max(counts, key=lambda rays: counts[rays])
    # As fine as the finest of one scanner, so that no ray is left out; some count differently in each turn.
    rays = max(count for count in counts if count <= _FINER * usual)
    if 4 * rays * len(scans) > most:
        held = None
    if held is None:
        # A file of its own, so that the recording given may be closed.
        widget._file = RecordingData(recording.path)
        widget._file.memory = min(LOOKED_AT_BYTES, recording.memory)
        series = widget._file.scans(scans.topic)
        likes = [(chunk.like, len(chunk)) for chunk in series.chunks()]
    else:
        likes = [(chunk.like, len(chunk)) for chunk in held]
    first = next(like for like, _ in likes if len(like) == rays)
    onto = Onto(Sweep.of(first))
    by_angle = not all(onto.keeps_indices(like) for like, _ in likes)
    source: Scans = (
        Read(series, onto)
        if held is None
        else Held(scans.times_ns, [ranges for chunk in held for ranges in onto(chunk)])
    )
    widget._put(
        source,
        onto.sweep._replace(by_angle=by_angle),
        recording.start_ns or 0,
        duration=recording.duration,
        notes=[*_about(likes, onto, by_angle), *first.notes],
        budget=min(BUDGET, recording.memory // 4),
    )
    if not widget.title:
        widget.title = scans.topic


def _about(likes: list[tuple[Scan, int]], onto: Onto, by_angle: bool) -> Iterator[str]:
    """What is to be said of scans that have not all the same rays."""
    left_out = sum(count for like, count in likes if not onto.fits(like))
    if left_out:
        of = sum(count for _, count in likes)
        yield f"{left_out:,} of {of:,} scans have no rays, or more than {onto.sweep.ray_count:,}: not in the picture"
    if by_angle:
        counts = sorted({len(like) for like, _ in likes if onto.fits(like)})
        some = f"{counts[0]:,} to {counts[-1]:,} rays" if len(counts) > 1 else "rays at other angles now and then"
        yield f"the scans have {some}: drawn by angle, without indices"
    limits = {(like.range_min, like.range_max) for like, _ in likes if onto.fits(like)}
    if len(limits) > 1:
        yield "range_min and range_max change: those of the first scan count"


def _held(scans: ScanSeries, most: int) -> list[ScanChunk] | None:
    """All chunks, on the first way through the file; None where their ranges take more than so many bytes."""
    chunks, size = [], 0
    for chunk in scans.chunks():
        size += chunk.ranges.nbytes
        if size > most:
            return None
        chunks.append(chunk)
    return chunks


def _put_speeds(widget: ScanogramWidget, recording: RecordingData, topics: list[Topic]) -> None:
    """The first measured speed; a commanded one where none was measured."""
    for topic in sorted(topics, key=lambda topic: topic.commanded):
        speeds = recording.speeds(topic.name)
        if len(speeds):
            widget.set_speeds(times_ns=speeds.times_ns, values=speeds.values, title=topic.name)
            return


def _put_touches(widget: ScanogramWidget, recording: RecordingData, topics: list[str]) -> None:
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
