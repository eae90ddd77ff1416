"""All scans of a recording as one array, beside rosbags and mcap-ros2-support that deserialise the same messages."""

from __future__ import annotations

import subprocess
import sys
import tempfile
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import robowidgets

from .recordings import open_theirs, real, timed, write
from .stage import ROOT

SLOW_SCANS = 500
"""How many messages the slowest of them reads: the time for all follows from these."""

PEAK = """
import sys, robowidgets

def most():
    return next(int(line.split()[1]) for line in open("/proc/self/status") if line.startswith("VmHWM:"))

with robowidgets.open(sys.argv[1]) as recording:
    recording.memory = 64_000_000
    before = most()
    nearest = min(float(chunk.ranges.min()) for _ in range(2) for chunk in recording.scans().chunks())
    print(most() - before)
"""


@dataclass
class Decoding:
    """One topic: how many scans of how many rays, and how many a second each of them decodes; 0 where it cannot."""

    scans: int
    rays: int
    ours: float
    rosbags: float
    mcap: float


def compare(scans: int, repeats: int) -> tuple[dict[str, Decoding], tuple[float, float]]:
    """Each topic by file and name; and the peak memory in megabytes of a walk through the written file and one ten
    times its size."""
    with tempfile.TemporaryDirectory() as folder:
        made, large = Path(folder) / "scans.mcap", Path(folder) / "large.mcap"
        write(made, scans)
        write(large, 10 * scans)
        found = {}
        for path in (made, *real()):
            with robowidgets.open(path) as recording:
                topics = [topic.name for topic in recording.topics if topic.widget == "laser"]
            name = f"{scans:,} scans of 1040 rays (MCAP)" if path == made else path.name
            found |= {f"{name} {topic}": decode(path, topic, repeats) for topic in topics}
        return found, (peak(made), peak(large))


def decode(path: Path, topic: str, repeats: int) -> Decoding:
    """All of them in turn, each on a file that is open already; the median of each."""
    times: dict[str, list[float]] = {"ours": [], "rosbags": [], "mcap": []}
    for _ in range(repeats):
        with robowidgets.open(path) as recording:
            took, ranges = timed(lambda recording=recording: recording.scans(topic).ranges)
            times["ours"].append(took)
        with closing(open_theirs(path)) as reader:
            took, count = timed(lambda reader=reader: _rosbags(reader, topic))
            times["rosbags"].append(took)
        if count != len(ranges):
            raise RuntimeError(f"{path.name}: {len(ranges)} scans on {topic}, where rosbags has {count} messages")
        if path.suffix == ".mcap":
            took, read = timed(lambda: _mcap(path, topic))
            times["mcap"].append(took * count / read)
    rates = {name: len(ranges) / median(took) if took else 0.0 for name, took in times.items()}
    return Decoding(*ranges.shape, **rates)


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


def peak(path: Path) -> float:
    """Megabytes that a process of its own takes for going through all scans of a file twice, chunk by chunk."""
    run = subprocess.run([sys.executable, "-c", PEAK, path], cwd=ROOT, capture_output=True, text=True, check=True)
    return int(run.stdout) * 1024 / 1e6
