"""Sending a recording to Rerun: to a file or to the page."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from ..notebook.cells import take_the_place
from ..recordings import RecordingData
from ..runtime.output_file import checked_output, whole_file
from .rerun_log import Log
from .widget import RerunWidget

_TOGETHER = 8
"""The highest number of pieces in the queue of the writer."""

_REFUSED = 1 << 20
"""Bytes that do not fit on a full disk."""


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
                stream.flush()  # raises if not everything was written
            except RuntimeError as error:
                # Rerun only logs the cause. Writing more bytes raises the system's error.
                file.seek(0, os.SEEK_END)
                file.write(bytes(_REFUSED))
                file.flush()
                raise OSError(error) from None
            finally:
                stream.disconnect()
    except OSError as error:
        raise type(error)(f"{where} was not written: {error.strerror or error}") from None
    return where
