"""The scanogram of a recording, beside rosbags that goes through the raw messages of the same topics."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import robowidgets

from .recordings import open_theirs, timed, with_scans


@dataclass
class Drawing:
    """One topic of scans: milliseconds until its scanogram is ready, and of rosbags, over so many messages."""

    messages: int
    ours: float
    rosbags: float


def compare(made: Path, repeats: int) -> dict[str, Drawing]:
    """Each topic with scans by file and name."""
    return {name: draw(path, topic, repeats) for name, path, topic in with_scans(made)}


def draw(path: Path, topic: str, repeats: int) -> Drawing:
    """Both in turn, each on a file that is open already; the median of each, but for the first time."""
    ours, theirs = [], []
    for _ in range(1 + repeats):
        with robowidgets.open(path) as recording:
            topics = _looked_at(recording, topic)
            took, widget = timed(lambda recording=recording: recording.scanogram(topic))
            ours.append(took)
            widget.close()
        # Before the next is made, whose memory this then is.
        del widget
        with closing(open_theirs(path)) as reader:
            took, count = timed(lambda reader=reader, topics=topics: _rosbags(reader, topics))
            theirs.append(took)
    return Drawing(count, 1000 * median(ours[1:]), 1000 * median(theirs[1:]))


def _looked_at(recording: robowidgets.recording.Recording, topic: str) -> set[str]:
    """The topics in its picture: the scans, one speed, and all touches."""
    speeds = sorted((t for t in recording.topics if t.widget == "speed" and t.count), key=lambda t: t.commanded)
    return {topic, *(t.name for t in speeds[:1]), *(t.name for t in recording.topics if t.widget == "touch")}


def _rosbags(reader: Any, topics: set[str]) -> int:
    wanted = [connection for connection in reader.connections if connection.topic in topics]
    return sum(1 for _ in reader.messages(wanted))
