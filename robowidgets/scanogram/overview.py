"""The parts of a player on the whole recording: the scanogram, unless making it takes long, and the axes of speeds."""

from __future__ import annotations

import time
from collections.abc import Collection, Iterable
from itertools import islice

import numpy as np

from ..notebook.progress import without_bars
from ..recordings import RecordingData
from ..repair import RecordingError
from ..runtime.text import many
from ..samples import Scan
from ..scanogram_widget import ScanogramWidget
from ..speed_widget import OUT_OF_PLANE
from .levels import Levels
from .of_recording import MEMORY_BYTES, OpenSpan, scanogram
from .scans import ScansInMemory, Sweep

LONGEST = 10.0
"""The maximum number of seconds for a scanogram that the user did not request: making it reads all scans."""

FEW = 5_000_000
"""A number of readings that takes no noticeable time."""

_LOOKED_AT = 20

_MEASURED = 0.2
"""Seconds for which scans are read to measure the reading speed."""


def whole_drive(
    recording: RecordingData,
    topic: str,
    beside: Collection[str],
    wanted: bool | None,
    span: OpenSpan = (None, None),
    *,
    may_thin: bool = False,
) -> tuple[ScanogramWidget | None, str]:
    """Return the scanogram of a topic, or None, and a line with the reason if it is not whole.

    Args:
        recording: the recording.
        topic: the topic with the scans, or empty for no scanogram.
        beside: topics whose speed and touches may be shown under the scans.
        wanted: True to make it, or None to make it only if that is quick.
        span: the span of the recording.
        may_thin: True to show parts of the whole drive if reading all scans takes too many bytes.

    Raises:
        RecordingError: ``wanted`` is True, and the topic contains no scan with rays.
    """
    if not topic or wanted is False:
        return None, ""
    reason = _too_long(recording, topic, span) if wanted is None else ""
    if reason:
        thinned = _thinned(recording, topic, beside) if may_thin else None
        return thinned or (None, reason)
    try:
        return scanogram(recording, topic, beside, span), ""
    except RecordingError:
        if wanted:
            raise
        return None, ""


def _thinned(
    recording: RecordingData, topic: str, beside: Collection[str]
) -> tuple[ScanogramWidget | None, str] | None:
    """Return the scanogram of a few parts of a large recording with a line, or None if it has no index of parts."""
    why = recording.why_long(topic)
    if not why:
        return None
    try:
        parts = recording.thinned_scans(topic)
        if not parts:
            return None
        widget = scanogram(recording, topic, beside, parts=parts)
    except RecordingError as error:
        return None, f"no scanogram: {error}"
    return (
        widget,
        f"the scanogram shows {widget.scans_shown}, evenly spread: {why}; recording.show(scanogram=True) reads all",
    )


def is_planar(recording: RecordingData, topics: Iterable[str]) -> bool:
    """Return True if the speeds of topics use only the axes that a planar widget shows. It reads all of them."""
    return not any(np.nan_to_num(recording.speeds(topic).values[:, OUT_OF_PLANE]).any() for topic in topics)


def _too_long(recording: RecordingData, topic: str, span: OpenSpan) -> str:
    """Return a line if a scanogram would take long, with the way to get it, or an empty text."""
    if why := recording.why_long(topic):
        return f"no scanogram: {why}; recording.show(scanogram=True) reads them"
    start, end = span[0] or 0.0, recording.duration if span[1] is None else span[1]
    share = (end - start) / recording.duration if recording.duration else 1.0
    count = round(share * sum(t.count for t in recording.topics if t.name == topic))
    # The maximum number of rays of several scans: the first may be empty.
    firsts = islice(recording.samples(topic), _LOOKED_AT)
    rays = max((len(moment.sample) for moment in firsts if isinstance(moment.sample, Scan)), default=0)
    if count * rays <= FEW:
        return ""
    # Scans that do not fit into memory are read twice.
    times = 2 if 4 * count * rays > MEMORY_BYTES else 1
    seconds = times * count * rays / readings_per_second(recording, topic)
    if seconds <= LONGEST:
        return ""
    size = f"{many(count, 'scan')} of {many(rays, 'ray')}"
    return f"no scanogram: {size} take about {seconds:.0f} s; recording.show(scanogram=True) makes it"


def readings_per_second(recording: RecordingData, topic: str) -> float:
    """Measure for `_MEASURED` seconds how many readings of a topic are read and put into levels in a second."""
    done, passed, began = 0, 0.0, time.perf_counter()
    with without_bars():
        for chunk in recording.scans(topic).chunks():
            if chunk.ranges.size:
                Levels(ScansInMemory(chunk.times_ns, [chunk.ranges]), Sweep.of(chunk.like))
                done += chunk.ranges.size
            passed = time.perf_counter() - began
            if passed >= _MEASURED:
                break
    return done / passed if done else float("inf")
