"""Opening and decoding recordings, compared with rosbags alone on the same file."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing, contextmanager
from dataclasses import dataclass
from itertools import count
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
from rosbags.highlevel import AnyReader
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets

from .scan import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN, encode
from .stage import ROOT

TYPES = get_typestore(Stores.ROS2_HUMBLE)
SUFFIXES = (".bag", ".mcap")


@dataclass
class Reading:
    """One file: milliseconds to open it and list its topics, and samples per second, for rosbags and robowidgets."""

    open_theirs: float
    open_ours: float
    rate_theirs: float
    rate_ours: float


def compare(scans: int, repeats: int) -> dict[str, Reading]:
    """Measure each file by its name: the generated file, and the available real files."""
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "scans.mcap"
        write(made, range(scans))
        files = {f"{scans:,} scans of 1040 rays (MCAP)": made, **{path.name: path for path in real()}}
        return {name: read(path, repeats) for name, path in files.items()}


def real() -> Iterator[Path]:
    """Yield the real recordings that rosbags reads: bags, MCAP files, and rosbag2 folders."""
    folder = Path(os.environ.get("ROBOWIDGETS_DATA") or ROOT.parent / "shared" / "data") / "good"
    for path in sorted(folder.iterdir()) if folder.is_dir() else ():
        if path.suffix in SUFFIXES or path.is_dir():
            yield path


@contextmanager
def written(scans: int) -> Iterator[dict[str, Path]]:
    """Yield MCAP files of some scans, of scans with changing times, and of ten times as many, for the block."""
    with tempfile.TemporaryDirectory() as folder:
        made = {name: Path(folder) / f"{name}.mcap" for name in ("scans", "changing", "large")}
        write(made["scans"], range(scans))
        write(made["changing"], range(scans), changing=True)
        write(made["large"], range(10 * scans))
        yield made


def with_scans(made: dict[str, Path]) -> Iterator[tuple[str, Path, str]]:
    """Yield name, file and topic of all topics of scans, in written files and in the available real files."""
    for name, path in {**made, **{path.name: path for path in real()}}.items():
        with robowidgets.open(path) as recording:
            topics = [topic for topic in recording.topics if topic.widget == "laser"]
        for topic in topics:
            yield f"{name} {topic.name}", path, topic.name


def write(path: Path, numbers: Iterable[int], *, changing: bool = False) -> None:
    """Write an MCAP file of scans at 40 Hz with these numbers; see `write_scans`."""
    times = count(1_700_000_000_000_000_000, 25_000_000)
    write_scans(
        path.with_suffix(""), ((number, when, when) for number, when in zip(numbers, times, strict=False)), changing
    )
    next(path.with_suffix("").glob("*.mcap")).rename(path)


def write_scans(folder: Path, scans: Iterable[tuple[int, int, int]], changing: bool = False) -> None:
    """Write a rosbag2 folder with an MCAP file of scans: the number, the log time and the stamp of each, in ns.

    With ``changing``, scan_time and time_increment differ in each scan, as with most drivers of RPLIDAR.
    """
    kind = TYPES.types["sensor_msgs/msg/LaserScan"]
    header, stamp = TYPES.types["std_msgs/msg/Header"], TYPES.types["builtin_interfaces/msg/Time"]
    with Writer(folder, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/scan", kind.__msgtype__, typestore=TYPES)
        for number, when, stamped in scans:
            message = kind(
                header=header(stamp=stamp(*divmod(stamped, 1_000_000_000)), frame_id="laser"),
                angle_min=ANGLE_MIN,
                angle_max=-ANGLE_MIN,
                angle_increment=ANGLE_INCREMENT,
                time_increment=number % 97 * 1e-7 if changing else 0.0,
                scan_time=0.025 + number % 89 * 1e-5 * changing,
                range_min=RANGE_MIN,
                range_max=RANGE_MAX,
                ranges=encode(number),
                intensities=np.empty(0, np.float32),
            )
            writer.write(connection, when, TYPES.serialize_cdr(message, kind.__msgtype__))


def read(path: Path, repeats: int) -> Reading:
    """Measure both in turn on the topics that both understand. Return the medians."""
    with closing(open_theirs(path)) as reader, robowidgets.open(path) as recording:
        shown = {topic.name for topic in recording.topics if topic.widget}
        known = {c.topic for c in reader.connections if c.msgtype in reader.typestore.fielddefs}
    topics = sorted(shown & known)

    def theirs() -> int:
        with closing(open_theirs(path)) as reader:
            wanted = [c for c in reader.connections if c.topic in topics]
            return sum(1 for c, _, raw in reader.messages(wanted) if reader.deserialize(raw, c.msgtype))

    def ours() -> int:
        with robowidgets.open(path) as recording:
            return sum(1 for _ in recording.samples(topics))

    times: dict[str, list[float]] = {"open_theirs": [], "open_ours": [], "all_theirs": [], "all_ours": []}
    for _ in range(repeats):
        times["open_theirs"].append(timed(lambda: open_theirs(path).close())[0])
        times["open_ours"].append(timed(lambda: robowidgets.open(path).close())[0])
        took, count = timed(theirs)
        times["all_theirs"].append(took)
        took, mine = timed(ours)
        times["all_ours"].append(took)
        if mine != count:
            raise RuntimeError(f"{path.name}: {mine} samples of {topics}, where rosbags has {count} messages")
    of = {name: median(values) for name, values in times.items()}
    return Reading(
        open_theirs=1000 * of["open_theirs"],
        open_ours=1000 * of["open_ours"],
        rate_theirs=count / of["all_theirs"],
        rate_ours=count / of["all_ours"],
    )


def open_theirs(path: Path) -> AnyReader:
    """Return an open reader of rosbags with its definitions."""
    reader = AnyReader([path], default_typestore=TYPES)
    reader.open()
    return reader


def timed(work: Callable[[], Any]) -> tuple[float, Any]:
    """Return the seconds of a call, and its result."""
    start = time.perf_counter()
    result = work()
    return time.perf_counter() - start, result
