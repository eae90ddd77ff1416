"""A drive of 23 GB: its topics and one moment from a disk and from a web server, compared with rosbags and mcap."""

from __future__ import annotations

import os
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import fsspec
from mcap.reader import make_reader
from rosbags.rosbag2.storage_mcap import McapReader

import robowidgets
from tests.unit.recordings import long_drive
from tests.unit.recordings.range_server import RangeServer, serving

CHUNKS = 27_000


def compare(chunks: int = CHUNKS) -> None:
    """Print the CPU time, the requests and the bytes of each reader. The file takes 0.2 GB of the disk."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ROBOWIDGETS_CACHE"] = str(Path(folder) / "cache")
        path = long_drive.write(Path(folder) / "long.mcap", chunks, image=900_000, others=15, rare=2)
        middle = chunks / 2
        print(f"{chunks:,} chunks, {path.stat().st_size / 1e9:.1f} GB\n")
        print("| | open, ms of CPU | a moment, ms of CPU |\n| --- | --- | --- |")
        readers = {"robowidgets": _ours, "rosbags": _rosbags, "mcap": _mcap}
        for name, read in readers.items():
            opened, moment = min(read(path, middle) for _ in range(3))
            print(f"| {name} | {opened * 1000:.0f} | {moment * 1000:.1f} |")
        print("\n| from a web server | requests | MB | for a moment: requests | MB |\n| --- | --- | --- | --- | --- |")
        for name, remote in {"robowidgets": _ours_at, "mcap over fsspec": _mcap_at}.items():
            with serving(path) as server:
                counts = remote(server, middle)
            print(f"| {name} | {' | '.join(f'{count:,.0f}' for count in counts)} |")


def _timed(work: Callable[[], Any]) -> tuple[float, Any]:
    began = time.process_time()
    done = work()
    return time.process_time() - began, done


def _ours(path: Path, seconds: float) -> tuple[float, float]:
    opened, recording = _timed(lambda: robowidgets.open(path))
    moment, _ = _timed(lambda: recording.at("/scan", seconds))
    recording.close()
    return opened, moment


def _rosbags(path: Path, seconds: float) -> tuple[float, float]:
    reader = McapReader(path)
    opened, _ = _timed(reader.open)
    scans = [connection for connection in reader.connections if connection.topic == "/scan"]
    moment, _ = _timed(lambda: next(reader.messages(scans, _ns(seconds))))
    reader.close()
    return opened, moment


def _mcap(path: Path, seconds: float) -> tuple[float, float]:
    with path.open("rb") as file:
        reader = make_reader(file)
        opened, _ = _timed(reader.get_summary)
        moment, _ = _timed(lambda: next(iter(reader.iter_messages("/scan", _ns(seconds)))))
    return opened, moment


def _ours_at(server: RangeServer, seconds: float) -> tuple[float, ...]:
    with robowidgets.open(server.url) as recording:
        opened = len(server.requests), server.sent / 1e6
        recording.at("/scan", seconds)
        return (*opened, len(server.requests) - opened[0], server.sent / 1e6 - opened[1])


def _mcap_at(server: RangeServer, seconds: float) -> tuple[float, ...]:
    with fsspec.open(server.url) as file:
        reader = make_reader(file)
        reader.get_summary()
        opened = len(server.requests), server.sent / 1e6
        next(iter(reader.iter_messages("/scan", _ns(seconds))))
        return (*opened, len(server.requests) - opened[0], server.sent / 1e6 - opened[1])


def _ns(seconds: float) -> int:
    return long_drive.START_NS + int(seconds * 1e9)
