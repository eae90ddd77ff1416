"""A search through a thousand recordings, some damaged, beside a loop over rosbags; and what may go wrong."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from contextlib import closing, contextmanager
from multiprocessing import get_context
from pathlib import Path
from resource import RLIMIT_FSIZE, getrlimit, setrlimit
from statistics import median
from typing import Any, NamedTuple

import numpy as np
import psutil
from rosbags.rosbag2 import StoragePlugin, Writer

import robowidgets
from robowidgets import conditions
from robowidgets.fleet.hits import Hits
from robowidgets.simulator import Robot, Scanner, room, wander

from .recordings import TYPES, open_theirs, timed
from .stage import ROOT

COUNT = 1000
LIMIT = 0.3
SECONDS = 20.0
DIFFERENT = 10
"""Drives of the simulator, each of which is there several times."""
_ROOMS = ("house", "corridor", "office", "maze")
_SCANNER = Scanner(ray_count=360, range_max=12.0, rate=10.0)
_START_NS = 1_700_000_000_000_000_000


class Run(NamedTuple):
    """One way to search all: seconds, the most memory of all its processes in MB, and hits."""

    seconds: float
    megabytes: float
    hits: int


class Trouble(NamedTuple):
    """What went wrong, whether the rows were the same all the same, each once, and what was told."""

    what: str
    is_same: bool
    told: str


def compare(count: int = COUNT) -> None:
    """Print what each recording costs, the ways to search all, what may go wrong, and what an index costs."""
    with tempfile.TemporaryDirectory() as folder:
        os.environ["ROBOWIDGETS_CACHE"] = str(Path(folder) / "cache")
        runs = Path(folder) / "runs"
        files = make(runs, count)
        print(f"{len(files)} recordings, {sum(map(_size, files)) / 1e6:.0f} MB", flush=True)
        alone = Path(folder) / "simulated"
        alone.mkdir()
        for path in sorted(runs.glob("drive_*.mcap"))[:DIFFERENT]:
            shutil.copy(path, alone)
        print(cpu(alone), flush=True)
        print(_index(runs, Path(folder) / "drives.parquet"), flush=True)
        for way in _ways(runs):
            print(way, flush=True)
        for trouble in _troubles(runs):
            print(trouble, flush=True)


def cpu(folder: Path, repeats: int = 3) -> dict[str, float]:
    """Milliseconds of CPU time for each recording in a folder, in this process, and bytes of the index for a row."""

    def cost(work: Callable[[], object]) -> float:
        taken = []
        for _ in range(repeats + 1):  # the first round does not count
            began = time.process_time()
            work()
            taken.append(time.process_time() - began)
        return 1000 * median(taken[1:]) / len(list(folder.iterdir()))

    output = folder.with_name("cpu.parquet")
    here = _Here()
    found = {
        "a plain loop over rosbags": cost(lambda: plain_loop(folder)),
        "`find`": cost(lambda: _find(folder, here)),
        "`index`": cost(lambda: _index_anew(folder, output, here)),
    }
    found["bytes"] = output.stat().st_size / robowidgets.drives(output).dataset.count_rows()
    return found


def _index_anew(folder: Path, output: Path, executor: Any) -> None:
    output.unlink(missing_ok=True)
    robowidgets.index(folder, output=output, executor=executor)


class _Here:
    """An executor that runs all at once, in this process."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(function(*arguments))
        return future


def make(folder: Path, count: int) -> list[Path]:
    """Recordings in a folder: real ones, drives of the simulator, and one in ten of these cut off."""
    folder.mkdir()
    data = Path(os.environ.get("ROBOWIDGETS_DATA") or ROOT.parent / "shared" / "data")
    real = [path for part in ("good", "odd", "damaged", "topics") for path in sorted((data / part).glob("*"))]
    for i, path in enumerate(real):
        target = folder / f"real_{i:03}_{path.name}"
        (shutil.copytree if path.is_dir() else shutil.copyfile)(path, target)
    different = [_simulated(folder / f"drive_{i:04}", i) for i in range(min(DIFFERENT, count))]
    for i in range(len(different), count - len(real)):
        data = different[i % len(different)].read_bytes()
        (folder / f"drive_{i:04}.mcap").write_bytes(data if i % 10 else data[: len(data) * 2 // 3])
    return sorted(folder.iterdir())


def _simulated(path: Path, seed: int) -> Path:
    """An MCAP file of a robot that wanders through a room: its scans and odometry."""
    robot = Robot(room(_ROOMS[seed % len(_ROOMS)]), scanner=_SCANNER, seed=seed)
    scan_type, odometry_type = (
        TYPES.types[f"{name}"] for name in ("sensor_msgs/msg/LaserScan", "nav_msgs/msg/Odometry")
    )
    kind = TYPES.types
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        scans = writer.add_connection("/scan", scan_type.__msgtype__, typestore=TYPES)
        odometry = writer.add_connection("/odom", odometry_type.__msgtype__, typestore=TYPES)
        for _ in wander(robot):
            robot.step(1 / _SCANNER.rate)
            if robot.time >= SECONDS:
                break
            scan, pose, speed = robot.scan(), robot.odometry, robot.speed()
            when = _START_NS + round(robot.time * 1e9)
            stamp = kind["builtin_interfaces/msg/Time"](*divmod(when, 1_000_000_000))
            message = scan_type(
                header=kind["std_msgs/msg/Header"](stamp=stamp, frame_id="laser"),
                angle_min=scan.angle_min,
                angle_max=scan.angle_min + scan.angle_increment * (len(scan) - 1),
                angle_increment=scan.angle_increment,
                time_increment=0.0,
                scan_time=0.1,
                range_min=scan.range_min,
                range_max=scan.range_max,
                ranges=np.asarray(scan.ranges, np.float32),
                intensities=np.empty(0, np.float32),
            )
            writer.write(scans, when, TYPES.serialize_cdr(message, scan_type.__msgtype__))
            point, vector = kind["geometry_msgs/msg/Point"], kind["geometry_msgs/msg/Vector3"]
            turn = kind["geometry_msgs/msg/Quaternion"](0.0, 0.0, np.sin(pose.yaw / 2), np.cos(pose.yaw / 2))
            moved = odometry_type(
                header=kind["std_msgs/msg/Header"](stamp=stamp, frame_id="odom"),
                child_frame_id="base_link",
                pose=kind["geometry_msgs/msg/PoseWithCovariance"](
                    kind["geometry_msgs/msg/Pose"](point(pose.x, pose.y, 0.0), turn), np.zeros(36)
                ),
                twist=kind["geometry_msgs/msg/TwistWithCovariance"](
                    kind["geometry_msgs/msg/Twist"](vector(*speed.linear), vector(*speed.angular)), np.zeros(36)
                ),
            )
            writer.write(odometry, when, TYPES.serialize_cdr(moved, odometry_type.__msgtype__))
    made = path.with_suffix(".mcap")
    next(path.glob("*.mcap")).rename(made)
    shutil.rmtree(path)
    return made


def plain_loop(folder: Path) -> int:
    """How often a scan came nearer than the limit, by rosbags alone, in all that rosbags opens whole."""
    found = 0
    for path in sorted(folder.iterdir()):
        try:
            with closing(open_theirs(path)) as reader:
                wanted = [one for one in reader.connections if one.msgtype.endswith("/LaserScan")][:1]
                was_near = False
                for connection, _, raw in reader.messages(wanted):
                    scan = reader.deserialize(raw, connection.msgtype)
                    ranges = scan.ranges[(scan.ranges >= scan.range_min) & (scan.ranges <= scan.range_max)]
                    is_near = bool(ranges.size and ranges.min() < LIMIT)
                    found += is_near and not was_near
                    was_near = is_near
        except Exception:  # noqa: PERF203  # whatever it says of a damaged file, the loop goes on
            continue
    return found


def _find(folder: Path, executor: Any = None, *, keep: bool = False) -> Hits:
    return robowidgets.find(conditions.nearest_below(LIMIT), folder, executor=executor, keep=keep)


def _ways(folder: Path) -> Iterator[tuple[str, Run]]:
    yield "a plain loop over rosbags", _measured(lambda: plain_loop(folder))
    spawn = get_context("spawn")
    for count in (1, 2):
        with ProcessPoolExecutor(count, spawn) as pool:
            yield f"`find`, {count} process{'es' * (count > 1)}", _measured(lambda: len(_find(folder, pool)))
    with _cluster() as (client, _):
        yield "`find`, Dask with 2 workers", _measured(lambda: len(_find(folder, client)))
    _find(folder, keep=True)
    yield "`find` again, as it was kept", _measured(lambda: len(_find(folder, keep=True)))


def _measured(search: Callable[[], int]) -> Run:
    """A search, with the most memory of this process and all that it started."""
    own, most, is_over = psutil.Process(), [0], threading.Event()

    def watch() -> None:
        while not is_over.wait(0.05):
            sizes = [_memory(process) for process in (own, *own.children(recursive=True))]
            most[0] = max(most[0], sum(sizes))

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        seconds, found = timed(search)
    finally:
        is_over.set()
        thread.join()
    return Run(seconds, most[0] / 1e6, found)


def _memory(process: psutil.Process) -> int:
    try:
        return int(process.memory_info().rss)
    except psutil.Error:
        return 0


@contextmanager
def _cluster() -> Iterator[tuple[Any, list[subprocess.Popen[bytes]]]]:
    """A client of a cluster of two workers of this machine, and its processes, of which the scheduler is the first."""
    from distributed import Client

    dask = [sys.executable, "-m", "distributed.cli.dask_scheduler"]
    with tempfile.TemporaryDirectory() as folder:
        about = Path(folder) / "scheduler.json"
        quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL, "cwd": folder}
        where = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(about)]
        processes = [subprocess.Popen([*dask, *where], **quiet)]  # type: ignore[call-overload]
        worker = [sys.executable, "-m", "distributed.cli.dask_worker", "--scheduler-file", str(about)]
        worker += ["--nthreads", "1", "--no-dashboard"]
        processes += [subprocess.Popen(worker, **quiet) for _ in range(2)]  # type: ignore[call-overload]
        try:
            while not about.exists():
                time.sleep(0.1)
            with Client(scheduler_file=str(about), timeout=60) as client:
                client.wait_for_workers(2)
                yield client, processes
        finally:
            for process in processes:
                process.kill()
                process.wait()


def _troubles(folder: Path) -> Iterator[Trouble]:
    expected = sorted(map(repr, _find(folder)))

    def trouble(what: str, hits: Hits) -> Trouble:
        told = [line for line in repr(hits).splitlines() if line.startswith("!")]
        return Trouble(what, sorted(map(repr, hits)) == expected, told[-1].removeprefix("! ") if told else "")

    with _after(3.0, _kill_a_process):
        yield trouble("kill -9 of a process in the middle", _find(folder))
    soft, hard = getrlimit(RLIMIT_FSIZE)
    setrlimit(RLIMIT_FSIZE, (20_000, hard))
    try:
        shutil.rmtree(os.environ["ROBOWIDGETS_CACHE"], ignore_errors=True)
        yield trouble("a full disk where results are kept", _find(folder, keep=True))
    finally:
        setrlimit(RLIMIT_FSIZE, (soft, hard))
    with _cluster() as (client, processes), _after(3.0, processes[1].kill):
        yield trouble("kill -9 of a worker of Dask", _find(folder, client))
    with _cluster() as (client, processes), _after(3.0, processes[0].kill):
        yield trouble("the scheduler lost", _find(folder, client, keep=True))
    with _cluster() as (client, _):
        yield trouble("and back: the same call", _find(folder, client, keep=True))
    growing = folder / "drive_growing.mcap"
    with _written_meanwhile(next(folder.glob("drive_0001.mcap")), growing):
        hits = _find(folder)
    rows = sorted(repr(hit) for hit in hits if hit.file != str(growing))
    told = hits.problems.get(str(growing)) or [one.problem for one in hits.unread if one.file == str(growing)]
    yield Trouble("a file that is being written", rows == expected, told[0] if told else "")
    growing.unlink()


@contextmanager
def _after(seconds: float, action: Callable[[], object]) -> Iterator[None]:
    timer = threading.Timer(seconds, action)
    timer.start()
    try:
        yield
    finally:
        timer.cancel()


def _kill_a_process() -> None:
    """Kill one of the processes that search."""
    searching = [one for one in psutil.Process().children(recursive=True) if "loky" in " ".join(one.cmdline())]
    os.kill((searching or psutil.Process().children())[-1].pid, signal.SIGKILL)


@contextmanager
def _written_meanwhile(original: Path, path: Path) -> Iterator[None]:
    """A file that grows while the block runs."""
    data, is_over = original.read_bytes(), threading.Event()

    def write() -> None:
        with path.open("wb", buffering=0) as file:
            for at in range(0, len(data) // 2, 1000):
                file.write(data[at : at + 1000])
                if is_over.wait(0.05 if at > 50_000 else 0.0):
                    return

    thread = threading.Thread(target=write)
    thread.start()
    while not path.exists() or path.stat().st_size < 50_000:
        time.sleep(0.01)
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def _index(folder: Path, output: Path) -> dict[str, float]:
    """What an index of all costs, and a question to it."""
    seconds, drives = timed(lambda: robowidgets.index(folder, output=output))
    again, _ = timed(lambda: robowidgets.index(folder, output=output))
    rare = conditions.nearest_below(0.05) & conditions.speed_above(0.4)
    asked, candidates = timed(lambda: drives.candidates(rare))
    return {
        "files": len(drives.files),
        "rows": drives.dataset.count_rows(),
        "bytes": output.stat().st_size,
        "seconds": seconds,
        "again": again,
        "asked": asked,
        "candidates": len(candidates),
    }


def _size(path: Path) -> int:
    return sum(one.stat().st_size for one in path.rglob("*")) if path.is_dir() else path.stat().st_size
