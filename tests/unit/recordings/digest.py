"""The content of a recording as a few short texts to compare: every sample, every column, and the problems.

``python -m tests.unit.recordings.digest`` rewrites `DIGESTS`, from the folder of real recordings.
"""

from __future__ import annotations

import json
from hashlib import sha256
from pathlib import Path
from typing import Any

import numpy as np

from robowidgets import Range, Recording, RecordingError, Scan, Speed, Touch, open
from tests.conftest import real_recordings

DIGESTS = Path(__file__).with_name("real_recordings.json")


def recordings(folder: Path) -> list[Path]:
    """Every real recording in a folder, good, odd and damaged."""
    return sorted(path for part in ("good", "odd", "damaged") for path in (folder / part).iterdir())


def digest(path: Path) -> dict[str, Any]:
    """Topics, samples, columns and problems of a recording, or the error if it does not open."""
    try:
        with open(path) as recording:
            return _digest(recording)
    except RecordingError as error:
        return {"error": str(error).replace(str(path.parent), "")}


def _digest(recording: Recording) -> dict[str, Any]:
    shown = [topic for topic in recording.topics if topic.widget]
    told = {
        "start_ns": recording.start_ns,
        "end_ns": recording.end_ns,
        "topics": [[topic.name, topic.count, topic.widget, topic.commanded] for topic in recording.topics],
        "samples": {topic.name: _samples(recording, topic.name) for topic in shown},
        "columns": {topic.name: _columns(recording, topic.name, topic.widget) for topic in shown},
    }
    return {**told, "problems": list(recording.problems)}


def _samples(recording: Recording, topic: str) -> list[Any]:
    hashed = sha256()
    count = 0
    for moment in recording.samples(topic):
        count += 1
        hashed.update(np.int64(moment.time_ns).tobytes())
        hashed.update(np.int64(moment.sample.stamp_ns or 0).tobytes())
        hashed.update(_values(moment.sample))
    return [count, hashed.hexdigest()[:16]]


def _values(sample: Any) -> bytes:
    if isinstance(sample, Scan):
        # Angles as float32, the type in a LaserScan.
        settings = (sample.angle_min, sample.angle_increment, sample.range_min, sample.range_max)
        words = repr((sample.frame_id, sample.header_problems)).encode()
        return np.array(settings, np.float32).tobytes() + sample.ranges.tobytes() + sample.intensities.tobytes() + words
    if isinstance(sample, Speed):
        return np.array(sample.values).tobytes() + sample.frame_id.encode()
    if isinstance(sample, Range):
        return repr(sample).encode()
    assert isinstance(sample, Touch)
    return repr((dict(sample.touched), sample.mode, sample.sensors)).encode()


def _columns(recording: Recording, topic: str, widget: str) -> list[Any]:
    """Sort by time, whatever the order of arrival."""
    hashed = sha256()
    series: Any = recording.series(topic)
    order = np.argsort(series.times_ns, kind="stable")
    hashed.update(series.times_ns[order].tobytes())
    hashed.update(series.stamps_ns[order].tobytes())
    if widget == "laser" and len(series.groups) > 1:
        for group in series.groups:
            order = np.argsort(group.times_ns, kind="stable")
            hashed.update(group.ranges[order].tobytes())
    elif widget == "laser":
        hashed.update(series.ranges[order].tobytes() + series.intensities[order].tobytes())
    elif widget == "speed":
        hashed.update(series.values[order].tobytes())
    elif widget == "sonar":
        hashed.update(series.ranges[order].tobytes())
    else:
        hashed.update(series.states[order].tobytes() + repr(series.labels).encode())
    return [len(series), hashed.hexdigest()[:16]]


def main() -> None:
    """Rewrite the digests."""
    folder = real_recordings()
    told = {f"{path.parent.name}/{path.name}": digest(path) for path in recordings(folder)}
    lines = ",\n".join(f"{json.dumps(name)}: {json.dumps(says)}" for name, says in told.items())
    DIGESTS.write_text(f"{{\n{lines}\n}}\n")


if __name__ == "__main__":
    main()
