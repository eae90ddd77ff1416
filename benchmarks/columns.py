"""All scans of a recording as one array, beside rosbags and mcap-ros2-support that deserialise the same messages."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import robowidgets

from .recordings import open_theirs, timed, with_scans

SLOW_SCANS = 500
"""How many messages the slowest of them reads: the time for all follows from these."""


@dataclass
class Decoding:
    """One topic: how many scans of how many rays, and how many a second each of them decodes; 0 where it cannot."""

    scans: int
    rays: int
    ours: float
    rosbags: float
    mcap: float
    first: float
    """How many times as fast as rosbags we are the first time."""


def compare(made: Path, repeats: int) -> dict[str, Decoding]:
    """Each topic by file and name."""
    return {name: decode(path, topic, repeats) for name, path, topic in with_scans(made)}


def decode(path: Path, topic: str, repeats: int) -> Decoding:
    """All of them in turn, each on a file that is open already; the median of each, but for the first time."""
    times: dict[str, list[float]] = {"ours": [], "rosbags": [], "mcap": []}
    for _ in range(1 + repeats):
        with robowidgets.open(path) as recording:
            took, ranges = timed(lambda recording=recording: recording.scans(topic).ranges)
            times["ours"].append(took)
        scans, rays = ranges.shape
        # Before the next is made, whose memory this then is.
        del ranges
        with closing(open_theirs(path)) as reader:
            took, count = timed(lambda reader=reader: _rosbags(reader, topic))
            times["rosbags"].append(took)
        if count != scans:
            raise RuntimeError(f"{path.name}: {scans} scans on {topic}, where rosbags has {count} messages")
        if path.suffix == ".mcap":
            took, read = timed(lambda: _mcap(path, topic))
            times["mcap"].append(took * count / read)
    rates = {name: scans / median(took[1:]) if took else 0.0 for name, took in times.items()}
    return Decoding(scans, rays, **rates, first=times["rosbags"][0] / times["ours"][0])


def _rosbags(reader: Any, topic: str) -> int:
    wanted = [connection for connection in reader.connections if connection.topic == topic]
    return sum(1 for c, _, raw in reader.messages(wanted) if reader.deserialize(raw, c.msgtype))


def _mcap(path: Path, topic: str) -> int:
    # Here, because only the benchmarks need it.
    from mcap_ros2.reader import read_ros2_messages

    count = 0
    for count, _ in enumerate(read_ros2_messages(str(path), topics=[topic]), start=1):
        if count == SLOW_SCANS:
            break
    return count
