"""The scanogram above the widgets of a player, unless it takes long to make."""

from __future__ import annotations

from collections.abc import Collection
from itertools import islice

import ipywidgets

from .._core.tables import many
from ..recordings import RecordingData
from ..repair import RecordingError
from ..samples import Scan
from ..scanogram_widget import ScanogramWidget
from .scanogram import scanogram

MOST_READINGS = 100_000_000
"""Most readings of a scanogram that is made without a request: making it reads them all."""

_LOOKED_AT = 20


def whole_drive(
    recording: RecordingData, topic: str, beside: Collection[str], wanted: bool | None
) -> tuple[ScanogramWidget | None, str]:
    """The scanogram of a topic, or None and a line that says why there is none.

    Args:
        recording: the recording.
        topic: the topic with the scans; empty: no scanogram.
        beside: topics whose speed and touches may be shown under the scans.
        wanted: whether to make it; None: only if that does not take long.

    Raises:
        RecordingError: ``wanted`` is True, and the topic contains no scan with rays.
    """
    if not topic or wanted is False:
        return None, ""
    reason = _too_long(recording, topic) if wanted is None else ""
    if reason:
        return None, reason
    layout = ipywidgets.Layout(margin="0 4px", width="calc(100% - 8px)")
    try:
        return scanogram(recording, topic, beside, layout=layout), ""
    except RecordingError:
        if wanted:
            raise
        return None, ""


def _too_long(recording: RecordingData, topic: str) -> str:
    """A line that says why a scanogram would take long and how to get it; empty if it would not."""
    count = sum(t.count for t in recording.topics if t.name == topic)
    # The most rays of several scans: the first may be empty.
    firsts = islice(recording.samples(topic), _LOOKED_AT)
    rays = max((len(moment.sample) for moment in firsts if isinstance(moment.sample, Scan)), default=0)
    if count * rays <= MOST_READINGS:
        return ""
    size = f"{many(count, 'scan')} of {many(rays, 'ray')}"
    return f"no scanogram: {size} take a while; recording.show(scanogram=True) has it made"
