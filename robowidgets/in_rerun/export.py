"""Sending a recording to Rerun: into a file, or onto the page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from .._core.cells import take_the_place
from .._core.output_file import checked_output, whole_file
from ..recordings import RecordingData
from .rerun_log import Log
from .widget import RerunWidget

_TOGETHER = 8
"""Most pieces in the queue to be written."""

_REFUSED = 1 << 20
"""Bytes that a full disk has no room for."""


def to_rerun(
    recording: RecordingData, path: str | os.PathLike[str] | None, topics: Sequence[str]
) -> Path | RerunWidget:
    """See `Recording.to_rerun`."""
    if path is None:
        viewer = RerunWidget(recording, topics)
        take_the_place(viewer)
        return viewer
    where = checked_output("to_rerun", path, (".rrd",))
    log = Log(recording, topics)
    stream = log.stream()
    try:
        with whole_file(where) as file:
            stream.save(file.name)
            try:
                for number, _ in enumerate(log.steps(stream), start=1):
                    if number % _TOGETHER == 0:
                        stream.flush()
                stream.flush()  # raises where not all was written
            except RuntimeError as error:
                # Rerun logs why it could not write, and does not tell. The system tells it to who writes more.
                file.seek(0, os.SEEK_END)
                file.write(bytes(_REFUSED))
                file.flush()
                raise OSError(error) from None
            finally:
                stream.disconnect()
    except OSError as error:
        raise type(error)(f"{where} was not written: {error.strerror or error}") from None
    return where
