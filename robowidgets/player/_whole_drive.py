"""The whole drive above the widgets of a player: its scanogram, unless that takes long to make."""

from __future__ import annotations

from collections.abc import Collection
from itertools import islice

import ipywidgets

from .._core.text import many
from ..recordings import RecordingData
from ..repair import RecordingError
from ..samples import Scan
from ..scanogram_widget import ScanogramWidget
from .scanogram import scanogram

MOST_READINGS = 100_000_000
"""Of a drive with more a scanogram is made only when it is asked for: it reads them all."""

_LOOKED_AT = 20


def whole_drive(
    recording: RecordingData, topic: str, beside: Collection[str], wanted: bool | None
) -> tuple[ScanogramWidget | None, str]:
    """The scanogram of a topic, if there is one, and words for a person who may miss it.

    Args:
        recording: what is shown.
        topic: the one with the scans; empty: there is none.
        beside: those of which the speed and the touches under them may be.
        wanted: whether to make it; None: if that does not take long.

    Raises:
        RecordingError: it is wanted, and holds no scan with rays.
    """
    if not topic or wanted is False:
        return None, ""
    words = _too_long(recording, topic) if wanted is None else ""
    if words:
        return None, words
    layout = ipywidgets.Layout(margin="0 4px", width="calc(100% - 8px)")
    try:
        return scanogram(recording, topic, beside, layout=layout), ""
    except RecordingError:
        if wanted:
            raise
        return None, ""


def _too_long(recording: RecordingData, topic: str) -> str:
    """Why a scanogram of a topic would take long to make, and how to have it; empty when it would not."""
    count = sum(t.count for t in recording.topics if t.name == topic)
    # Not of the first alone, which may be empty.
    firsts = islice(recording.samples(topic), _LOOKED_AT)
    rays = max((len(moment.sample) for moment in firsts if isinstance(moment.sample, Scan)), default=0)
    if count * rays <= MOST_READINGS:
        return ""
    size = f"{many(count, 'scan')} of {many(rays, 'ray')}"
    return f"no scanogram: {size} take a while; recording.show(scanogram=True) has it made"
