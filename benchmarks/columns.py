"""All scans of a recording as one array, and its scanogram, compared with reading its bytes and with rosbags alone."""

from __future__ import annotations

from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median

import numpy as np

import robowidgets

from .recordings import open_theirs, timed, with_scans


@dataclass
class Whole:
    """One file: megabytes, and milliseconds to read its bytes, and from `open` to all scans and to the scanogram."""

    megabytes: float
    read: float
    array: float
    scanogram: float


@dataclass
class Decoding:
    """One topic: the numbers of scans and rays, and milliseconds from opening the file to all of them."""

    scans: int
    rays: int
    ours: float
    rosbags: float


def whole(path: Path, repeats: int) -> Whole:
    """Measure all three in turn. Return the medians without the first round."""
    times: dict[str, list[float]] = {"read": [], "array": [], "scanogram": []}
    for _ in range(1 + repeats):
        times["read"].append(timed(lambda: len(path.read_bytes()))[0])
        times["array"].append(timed(lambda: _ranges(path, None).nbytes)[0])
        times["scanogram"].append(timed(lambda: _scanogram(path))[0])
    return Whole(path.stat().st_size / 1e6, **{name: 1000 * median(took[1:]) for name, took in times.items()})


def compare(made: dict[str, Path], repeats: int) -> dict[str, Decoding]:
    """Measure each topic of scans, by file and name."""
    return {name: decode(path, topic, repeats) for name, path, topic in with_scans(made)}


def decode(path: Path, topic: str, repeats: int) -> Decoding:
    """Measure both in turn. Return the medians without the first round, in which rosbags makes code for the type."""
    times: dict[str, list[float]] = {"ours": [], "rosbags": []}
    for _ in range(1 + repeats):
        took, ranges = timed(lambda: _ranges(path, topic))
        times["ours"].append(took)
        scans, rays = ranges.shape
        # Free its memory for the next array.
        del ranges
        took, count = timed(lambda: _rosbags(path, topic))
        times["rosbags"].append(took)
        if count != scans:
            raise RuntimeError(f"{path.name}: {scans} scans on {topic}, where rosbags has {count} messages")
    return Decoding(scans, rays, **{name: 1000 * median(took[1:]) for name, took in times.items()})


def _ranges(path: Path, topic: str | None) -> np.ndarray:
    with robowidgets.open(path) as recording:
        return recording.scans(topic).ranges


def _scanogram(path: Path) -> None:
    with robowidgets.open(path) as recording:
        recording.scanogram().close()


def _rosbags(path: Path, topic: str) -> int:
    with closing(open_theirs(path)) as reader:
        wanted = [connection for connection in reader.connections if connection.topic == topic]
        return sum(1 for c, _, raw in reader.messages(wanted) if reader.deserialize(raw, c.msgtype))
