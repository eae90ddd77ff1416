"""Sending a recording to Rerun: into a file, or onto the page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from .._core.cells import take_the_place
from ..recordings import RecordingData
from .rerun_log import Log
from .widget import RerunWidget

_TOGETHER = 8
"""Most pieces in the queue to be written."""


def to_rerun(
    recording: RecordingData, path: str | os.PathLike[str] | None, topics: Sequence[str]
) -> Path | RerunWidget:
    """See `Recording.to_rerun`."""
    if path is None:
        viewer = RerunWidget(recording, topics)
        take_the_place(viewer)
        return viewer
    where = Path(os.fsdecode(path)).expanduser()
    log = Log(recording, topics)
    with where.open("wb"):  # raises if the file cannot be written
        pass
    stream = log.stream()
    stream.save(where)
    for number, _ in enumerate(log.steps(stream), start=1):
        if number % _TOGETHER == 0:
            stream.flush()
    stream.disconnect()
    return where
