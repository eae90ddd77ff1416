"""Opening and reading a recording, as a ratio to reading the same topics of the same file through rosbags alone.

`python -m benchmarks.recordings` prints it as a table. Each figure is the best of some rounds, ours and theirs in turn.
"""

from __future__ import annotations

import gc
import os
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from time import perf_counter
from typing import NamedTuple

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets

from .scan import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN, encode

DATA = Path(os.environ.get("ROBOWIDGETS_DATA") or Path(__file__).parents[2] / "shared" / "data")
FILES = {
    "good/turtlebot3_gazebo_mcap": ("/scan", "/odom", "/cmd_vel"),
    "good/hokuyo_people.bag": ("/scan",),
}
SCANS = 20_000


class Timing(NamedTuple):
    """Seconds to open a file, seconds to read some topics of it, and how many messages that were."""

    opened: float
    read: float
    count: int


def main() -> None:
    with long_recording() as long:
        files = {path: topics for name, topics in FILES.items() if (path := DATA / name).exists()}
        print(table({**files, long: ("/scan",)}))


def table(files: dict[Path, tuple[str, ...]], rounds: int = 7) -> str:
    """The ratios in Markdown, a line per file."""
    lines = ["| | messages | open, ms | ratio | read, µs each | ratio |", "|---|---|---|---|---|---|"]
    for path, topics in files.items():
        mine, theirs = zip(
            *((fresh(ours, path, topics), fresh(rosbags, path, topics)) for _ in range(rounds)), strict=True
        )
        opened, read = (min(t[i] for t in mine) for i in (0, 1))
        ratios = opened / min(t.opened for t in theirs), read / min(t.read for t in theirs)
        count = mine[0].count
        figures = f"{1e3 * opened:.1f} | {ratios[0]:.2f} | {1e6 * read / count:.1f} | {ratios[1]:.2f}"
        lines.append(f"| {path.name}: {', '.join(topics)} | {count:,} | {figures} |")
    return "\n".join(lines)


def fresh(read: Callable[[Path, tuple[str, ...]], Timing], path: Path, topics: tuple[str, ...]) -> Timing:
    gc.collect()
    return read(path, topics)


def ours(path: Path, topics: tuple[str, ...]) -> Timing:
    began = perf_counter()
    with robowidgets.open(path) as recording:
        opened = perf_counter()
        count = sum(1 for _ in recording.samples(topics))
        return Timing(opened - began, perf_counter() - opened, count)


def rosbags(path: Path, topics: tuple[str, ...]) -> Timing:
    began = perf_counter()
    with AnyReader([path]) as reader:
        opened = perf_counter()
        connections = [connection for connection in reader.connections if connection.topic in topics]
        count = 0
        for connection, _, raw in reader.messages(connections):
            reader.deserialize(raw, connection.msgtype)
            count += 1
        return Timing(opened - began, perf_counter() - opened, count)


@contextmanager
def long_recording() -> Iterator[Path]:
    """An MCAP folder of scans of 1040 rays, for as long as it is needed."""
    store = get_typestore(Stores.ROS2_HUMBLE)
    types, name = store.types, "sensor_msgs/msg/LaserScan"
    none, last = np.empty(0, np.float32), ANGLE_MIN + 1039 * ANGLE_INCREMENT
    with TemporaryDirectory() as folder:
        path = Path(folder, f"{SCANS} scans")
        with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connection = writer.add_connection("/scan", name, typestore=store)
            for i in range(SCANS):
                time_ns = 1_700_000_000_000_000_000 + i * 25_000_000
                stamp = types["builtin_interfaces/msg/Time"](*divmod(time_ns, 10**9))
                header = types["std_msgs/msg/Header"](stamp, "laser")
                angles = (ANGLE_MIN, last, ANGLE_INCREMENT, 0.0, 0.025, RANGE_MIN, RANGE_MAX)
                message = types[name](header, *angles, encode(i), none)
                writer.write(connection, time_ns, store.serialize_cdr(message, name))
        yield path


if __name__ == "__main__":
    main()
