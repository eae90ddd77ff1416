"""The scanogram of a recording: its scans, with speeds and touches under them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterator, Mapping, Sequence
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import kind_of_class
from ..kinds.choice import shared_depth
from ..notebook.cells import take_the_place
from ..recordings import RecordingData
from ..recordings.columns.chunks import ScanChunk
from ..recordings.columns.scans import Scans as ScanSeries
from ..recordings.columns.touches import Touches
from ..recordings.topics import Topic, named, wanted
from ..repair import RecordingError
from ..samples import Scan, Speed, Touch, TouchState
from ..samples.state_span import rows_of
from ..scanogram_widget import ScanogramWidget
from .by_angle import keeps_indices, on_rays, rays_at
from .levels import BUDGET
from .page_parts import most_single
from .scan_times import Thinned
from .scans import ScanRanges, ScansInMemory, Sweep, cut

MEMORY_BYTES = 256 << 20
"""The maximum size of scans that are kept in memory. Larger topics are read from the file again when they are drawn."""

CACHE_BYTES = 32 << 20
"""The maximum size of the cache of scans that are read again."""

_FINER = 2
"""The maximum number of rays of a scan in the picture, relative to the usual number."""

_KNOWN = 1000

_SURELY = 1.1
"""A predicted size above the limit by this factor means that the scans will surely exceed it."""


class RayMapper:
    """A mapping of scans to the rays of one sweep. Scans with more rays are left out: all their ranges are NaN.

    Args:
        sweep: the rays of the picture.
    """

    def __init__(self, sweep: Sweep) -> None:
        self.sweep = sweep
        self._rays = lru_cache(_KNOWN)(lambda of: rays_at(of, sweep))

    def fits(self, like: Scan) -> bool:
        """Return True if the picture includes scans with this geometry."""
        return 0 < len(like) <= self.sweep.ray_count

    def keeps_indices(self, like: Scan) -> bool:
        """Return True if the rays of scans with this geometry keep their indices."""
        return not self.fits(like) or self.is_same(like) or keeps_indices(self._rays(Sweep.of(like)))

    def __call__(self, chunk: ScanChunk) -> Iterator[NDArray[np.float32]]:
        """Yield the ranges of a chunk, as arrays of shape (n, rays of the sweep)."""
        if self.is_same(chunk.like):
            yield chunk.ranges
            return
        rays = self._rays(Sweep.of(chunk.like)) if self.fits(chunk.like) else np.full(self.sweep.ray_count, -1)
        # A few at a time: the sweep may have many more rays than the scans.
        for ranges in cut([chunk.ranges], self.sweep.ray_count):
            yield on_rays(ranges, rays)

    def is_same(self, like: Scan) -> bool:
        """Return True if scans have the rays of the sweep."""
        sweep = self.sweep
        return (len(like), like.angle_min, like.angle_increment) == (
            sweep.ray_count, sweep.angle_min, sweep.angle_increment
        )  # fmt: skip


class ScansInFile:
    """Scans that are read from a file when they are needed.

    Args:
        series: the scans.
        mapper: the mapping of scans to the rays of the picture.
    """

    def __init__(self, series: ScanSeries, mapper: RayMapper) -> None:
        self._series, self._mapper = series, mapper
        self.times_ns = series.times_ns

    def chunks(self) -> Iterator[NDArray[np.float32]]:
        """See `ScanRanges`."""
        return cut(ranges for chunk in self._series.chunks() for ranges in self._mapper(chunk))

    def read(self, start: int, stop: int) -> NDArray[np.float32]:
        """See `ScanRanges`."""
        return np.concatenate([ranges for chunk in self._series[start:stop].chunks() for ranges in self._mapper(chunk)])


OpenSpan = tuple[float | None, float | None]
"""Start and end in seconds from the start of the recording, or None for its start or end."""


def scanogram(
    recording: RecordingData,
    topic: str | None = None,
    beside: Collection[str] | None = None,
    span: OpenSpan = (None, None),
    parts: Sequence[Sequence[ScanChunk]] = (),
    **options: Any,
) -> ScanogramWidget:
    """See `ScanogramWidget.of`; for a span of the recording, or of a few parts of a large one.

    Args:
        recording: the recording.
        topic: as there.
        beside: as there.
        span: the span.
        parts: the scans of the parts, if only these are to be shown; see `RecordingData.thinned_scans`. Speeds and
            touches that take long to read are left out, too.
        **options: as there.
    """
    there = wanted(recording.topics, ())
    lasers = named(there, kind_of_class(Scan).name)
    scans = recording.scans(lasers[0] if topic is None and lasers else topic).between(*span)
    if beside is not None:
        there = [t for t in recording.topics if t.name in beside]

    def of_the_robot(sample: type) -> list[Topic]:
        topics = [t for t in there if t.widget == kind_of_class(sample).name]
        every = (scans.topic, *lasers)
        return [
            t
            for t in topics
            if shared_depth(t.name, scans.topic) == max(shared_depth(t.name, name) for name in every)
            and not (parts and recording.why_long(t.name))
        ]

    widget = ScanogramWidget(**options)
    take_the_place(widget)
    with widget.hold_sync():
        if parts:
            _put_parts(widget, recording, scans.topic, parts)
        else:
            _put_scans(widget, recording, scans, span)
        if not widget.title:
            widget.title = scans.topic
        _put_speeds(widget, recording, of_the_robot(Speed), span)
        _put_touches(widget, recording, [t.name for t in of_the_robot(Touch)], span)
        widget.states = rows_of(recording.states)
    return widget


def _put_scans(widget: ScanogramWidget, recording: RecordingData, scans: ScanSeries, span: OpenSpan) -> None:
    most = min(MEMORY_BYTES, recording.memory)
    loaded = _loaded(scans, most)
    rays = _finest(scans.ray_counts, f"{recording.path.name}: topic {scans.topic!r}")
    if 4 * rays * len(scans) > most:
        loaded = None
    file = None
    if loaded is None:
        # Opened again, so that the given recording may be closed.
        file = recording.reopened()
        file.memory = min(CACHE_BYTES, recording.memory)
        series = file.scans(scans.topic).between(*span)
        likes = [(chunk.like, len(chunk)) for chunk in series.chunks()]
    else:
        likes = [(chunk.like, len(chunk)) for chunk in loaded]
    first = next(like for like, _ in likes if len(like) == rays)
    mapper = RayMapper(Sweep.of(first))
    by_angle = not all(mapper.keeps_indices(like) for like, _ in likes)
    source: ScanRanges = (
        ScansInFile(series, mapper)
        if loaded is None
        else ScansInMemory(scans.times_ns, [ranges for chunk in loaded for ranges in mapper(chunk)])
    )
    widget.show_scans(
        source,
        mapper.sweep._replace(by_angle=by_angle),
        recording.start_ns or 0,
        begin=span[0] or 0.0,
        duration=recording.duration if span[1] is None else span[1],
        notes=[*_about(likes, mapper, by_angle), *map(str, first.header_problems)],
        budget=min(BUDGET, recording.memory // 4),
        file=file,
    )


def _put_parts(
    widget: ScanogramWidget, recording: RecordingData, topic: str, parts: Sequence[Sequence[ScanChunk]]
) -> None:
    """Show the first scans of each part, as many as the picture has cells for; of too many parts, every few."""
    budget = min(BUDGET, recording.memory // 4)
    most = max([1, *(len(chunk.like) for part in parts for chunk in part)])
    room = max(1, min(most_single(most), budget // (4 * most)))
    shown: list[list[ScanChunk]] = []
    for part in parts[:: -(-len(parts) // room)]:
        # Chunks of some writers overlap.
        if not shown or part[0].times_ns[0] > shown[-1][-1].times_ns[-1]:
            shown.append(_firsts(part, max(1, room // len(parts))))
    chunks = [chunk for part in shown for chunk in part]
    likes = [(chunk.like, len(chunk)) for chunk in chunks]
    counts: Counter[int] = Counter()
    for like, scans in likes:
        counts[len(like)] += scans
    rays = _finest(counts, f"{recording.path.name}: topic {topic!r}")
    first = next(like for like, _ in likes if len(like) == rays)
    mapper = RayMapper(Sweep.of(first))
    by_angle = not all(mapper.keeps_indices(like) for like, _ in likes)
    count = sum(one.count for one in recording.topics if one.name == topic)
    lasts = np.cumsum([sum(map(len, part)) for part in shown]) - 1
    widget.show_scans(
        ScansInMemory(
            np.concatenate([chunk.times_ns for chunk in chunks]),
            [ranges for chunk in chunks for ranges in mapper(chunk)],
        ),
        mapper.sweep._replace(by_angle=by_angle),
        recording.start_ns or 0,
        duration=recording.duration,
        notes=[*_about(likes, mapper, by_angle), *map(str, first.header_problems)],
        budget=budget,
        thinned=Thinned(lasts, recording.duration / max(1, count), count),
    )


def _firsts(chunks: Sequence[ScanChunk], count: int) -> list[ScanChunk]:
    """Return the first scans of some chunks."""
    found = []
    for chunk in chunks:
        found.append(chunk.part(slice(count), 0))
        count -= len(found[-1])
        if count == 0:
            break
    return found


def _finest(counts: Mapping[int, int], topic: str) -> int:
    """Return the number of rays of the finest scan, so that no scan is left out: on some scanners the number varies.

    Scans with many more rays than usual do not count.

    Args:
        counts: the number of scans for each number of rays.
        topic: the topic, for messages.

    Raises:
        RecordingError: no scan has a ray.
    """
    with_rays = {rays: count for rays, count in counts.items() if rays}
    if not with_rays:
        raise RecordingError(f"{topic} has no scan with rays; name another topic")
    usual = max(with_rays, key=lambda rays: with_rays[rays])
    return max(rays for rays in with_rays if rays <= _FINER * usual)


def _about(likes: list[tuple[Scan, int]], mapper: RayMapper, by_angle: bool) -> Iterator[str]:
    """Yield notes on scans whose rays differ."""
    left_out = sum(count for like, count in likes if not mapper.fits(like))
    if left_out:
        of = sum(count for _, count in likes)
        yield f"{left_out:,} of {of:,} scans have no rays, or more than {mapper.sweep.ray_count:,}: not in the picture"
    if by_angle:
        counts = sorted({len(like) for like, _ in likes if mapper.fits(like)})
        some = f"{counts[0]:,} to {counts[-1]:,} rays" if len(counts) > 1 else "rays at other angles now and then"
        yield f"the scans have {some}: drawn by angle, without indices"
    limits = {(like.range_min, like.range_max) for like, _ in likes if mapper.fits(like)}
    if len(limits) > 1:
        yield "range_min and range_max change: the values of the first scan are used"


def _loaded(scans: ScanSeries, most: int) -> list[ScanChunk] | None:
    """Return all chunks, read once, or None if their ranges take more than ``most`` bytes."""
    chunks, size, count = [], 0, 0
    for chunk in scans.chunks():
        size += chunk.ranges.nbytes
        count += len(chunk)
        # As soon as that is predictable, so that the rest is not read in vain.
        if size > most or size / count * len(scans) > _SURELY * most:
            return None
        chunks.append(chunk)
    return chunks


def _put_speeds(widget: ScanogramWidget, recording: RecordingData, topics: list[Topic], span: OpenSpan) -> None:
    """Put the first measured speed under the scans, or a commanded one without a measured one."""
    for topic in sorted(topics, key=lambda topic: topic.commanded):
        speeds = recording.speeds(topic.name).between(*span)
        if len(speeds):
            widget.set_speeds(times_ns=speeds.times_ns, values=speeds.values, title=topic.name)
            return


def _put_touches(widget: ScanogramWidget, recording: RecordingData, topics: list[str], span: OpenSpan) -> None:
    begin, end = span[0] or 0.0, recording.duration if span[1] is None else span[1]
    if topics:
        spans = [touch for topic in topics for touch in touched(recording.touches(topic), recording.duration)]
        inside = [(max(begin, start), min(end, stop), label) for start, stop, label in spans]
        widget.set_touches([touch for touch in inside if touch[0] <= touch[1]], title=", ".join(topics))


def touched(touches: Touches, end: float) -> Iterator[tuple[float, float, str]]:
    """Yield the spans in which each sensor was touched: start and end in seconds from the start, and its name."""
    times = np.append(np.maximum.accumulate(touches.seconds), max([end, *touches.seconds[-1:]]))
    for label, states in zip(touches.labels, touches.states.T, strict=True):
        edges = np.diff(np.concatenate(([False], states == TouchState.TOUCHED, [False])).astype(np.int8))
        for first, stop in zip(np.flatnonzero(edges > 0), np.flatnonzero(edges < 0), strict=True):
            yield float(times[first]), float(times[stop]), label
