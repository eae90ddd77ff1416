"""A search through a thousand recordings, some damaged, compared with a loop over rosbags; faults; and S3."""

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
from contextlib import closing, contextmanager, suppress
from multiprocessing import get_context
from pathlib import Path
from resource import RLIMIT_FSIZE, getrlimit, setrlimit
from statistics import median
from typing import Any, NamedTuple
from unittest.mock import patch

import numpy as np
import psutil
from rosbags.rosbag2 import StoragePlugin, Writer

import robowidgets
from robowidgets import conditions
from robowidgets.fleet.hits import Hits
from robowidgets.notebook.progress import without_bars
from robowidgets.simulator import Robot, Scanner, room, wander

from .recordings import TYPES, open_theirs, timed
from .stage import ROOT

COUNT = 1000
LIMIT = 0.3
SECONDS = 20.0
DIFFERENT = 10
"""The number of different drives of the simulator. Each is copied several times."""
STORED = 100
"""The number of recordings in object storage."""
_ROOMS = ("house", "corridor", "office", "maze")
_SCANNER = Scanner(ray_count=360, range_max=12.0, rate=10.0)
_THERE = 50_000
"""The initial bytes of a file that grows during the search."""
_START_NS = 1_700_000_000_000_000_000


class Run(NamedTuple):
    """One way to search all: seconds, peak memory in MB of all processes and of a single process, and spans."""

    seconds: float
    megabytes: float
    largest: float
    spans: int


class Trouble(NamedTuple):
    """A fault: its name, True if it happened during the search, True if the rows were the same, each once, and the
    message.
    """

    what: str
    has_come: bool
    is_same: bool
    told: str


def compare(count: int = COUNT) -> None:
    """Print the cost of each recording, the ways to search all, the faults, and the cost of an index."""
    # Without progress bars, which would be written to the full disk.
    with tempfile.TemporaryDirectory() as folder, without_bars():
        os.environ["ROBOWIDGETS_CACHE"] = str(Path(folder) / "cache")
        runs = Path(folder) / "runs"
        files = make(runs, count)
        _say(f"{len(files):,} recordings, {sum(map(_size, files)) / 1e6:.0f} MB")
        alone = Path(folder) / "simulated"
        alone.mkdir()
        for path in sorted(runs.glob("drive_*.mcap"))[:DIFFERENT]:
            shutil.copy(path, alone)
        costs = cpu(alone)
        row = costs.pop("bytes of a row")
        _say("\n| for each drive of the simulator | ms of CPU |\n| --- | --- |")
        for what, cost in costs.items():
            _say(f"| {what} | {cost:.1f} |")
        _say(f"\nA row of the index takes {row:.0f} bytes.")
        _say(_index(runs, Path(folder) / "drives.parquet"))
        _say("\n| way | s | files per s | MB of all processes | of the largest | spans |\n" + "| --- " * 6 + "|")
        for way, run in _ways(runs):
            facts = f"{run.seconds:.1f} | {len(files) / run.seconds:.0f} | {run.megabytes:.0f} | {run.largest:.0f}"
            _say(f"| {way} | {facts} | {run.spans:,} |")
        _say("\n| trouble | same rows, each once | message |\n| --- | --- | --- |")
        for trouble in _troubles(runs):
            same = ("yes" if trouble.is_same else "NO") if trouble.has_come else "it had ended before"
            _say(f"| {trouble.what} | {same} | {trouble.told} |")
        _say(_storage(sorted(runs.glob("drive_*.mcap"))[:STORED]))


def _say(line: str) -> None:
    print(line, flush=True)


def cpu(folder: Path, repeats: int = 3) -> dict[str, float]:
    """Return milliseconds of CPU time per recording of a folder, in this process, and bytes of the index per row."""

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
    found["bytes of a row"] = output.stat().st_size / robowidgets.drives(output).dataset.count_rows()
    return found


def _index_anew(folder: Path, output: Path, executor: Any) -> None:
    output.unlink(missing_ok=True)
    robowidgets.index(folder, output=output, executor=executor)


class _Here:
    """An executor that runs each call at once, in this process."""

    def submit(self, function: Callable[..., Any], *arguments: Any) -> Future[Any]:
        future: Future[Any] = Future()
        future.set_result(function(*arguments))
        return future


def make(folder: Path, count: int) -> list[Path]:
    """Write recordings to a folder: real ones, and drives of the simulator. One in ten of these is cut off."""
    folder.mkdir()
    data = Path(os.environ.get("ROBOWIDGETS_DATA") or ROOT.parent / "shared" / "data")
    real = [path for part in ("good", "odd", "damaged", "topics") for path in sorted((data / part).glob("*"))]
    for i, path in enumerate(real):
        target = folder / f"real_{i:03}_{path.name}"
        (shutil.copytree if path.is_dir() else shutil.copyfile)(path, target)
    different = [simulated(folder / f"drive_{i:04}", i) for i in range(min(DIFFERENT, count))]
    for i in range(len(different), count - len(real)):
        data = different[i % len(different)].read_bytes()
        (folder / f"drive_{i:04}.mcap").write_bytes(data if i % 10 else data[: len(data) * 2 // 3])
    return sorted(folder.iterdir())


def simulated(path: Path, seed: int) -> Path:
    """Write an MCAP file with scans and odometry of a robot that wanders through a room."""
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
    """Return the number of scans below the limit, by rosbags alone, in all files that rosbags opens completely."""
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
        except Exception:  # noqa: PERF203  # the loop goes on after any error of a damaged file
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
    yield "`find` again, from the cache", _measured(lambda: len(_find(folder, keep=True)))


def _measured(search: Callable[[], int]) -> Run:
    """Run a search, and measure the peak memory of this process and its children."""
    own, is_over = psutil.Process(), threading.Event()
    most = [0, 0]

    def watch() -> None:
        while not is_over.wait(0.25):  # each check of all processes takes some milliseconds
            sizes = [_memory(process) for process in (own, *own.children(recursive=True))]
            most[:] = max(most[0], sum(sizes)), max(most[1], *sizes)

    thread = threading.Thread(target=watch)
    thread.start()
    try:
        seconds, found = timed(search)
    finally:
        is_over.set()
        thread.join()
    return Run(seconds, most[0] / 1e6, most[1] / 1e6, found)


def _memory(process: psutil.Process) -> int:
    try:
        return int(process.memory_info().rss)
    except psutil.Error:
        return 0


@contextmanager
def _cluster() -> Iterator[tuple[Any, list[subprocess.Popen[bytes]]]]:
    """Yield a client of a cluster with two workers on this machine, and its processes, the scheduler first."""
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
                _kill_all(process)
                process.wait()


def _kill_all(process: subprocess.Popen[bytes]) -> None:
    """Kill a process and its children by SIGKILL: the process that restarts a worker of Dask, and the worker."""
    with suppress(psutil.NoSuchProcess):
        own = psutil.Process(process.pid)
        for one in (own, *own.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                one.kill()


def _troubles(folder: Path) -> Iterator[Trouble]:
    seconds, undisturbed = timed(lambda: _find(folder))
    expected, soon = sorted(map(repr, undisturbed)), seconds / 2

    def trouble(what: str, hits: Hits, has_come: threading.Event | None = None) -> Trouble:
        told = [line for line in repr(hits).splitlines() if line.startswith("!")]
        is_same = sorted(map(repr, hits)) == expected
        return Trouble(what, not has_come or has_come.is_set(), is_same, told[-1].removeprefix("! ") if told else "")

    with _after(soon, _kill_a_process) as done:
        hits = _find(folder)
    yield trouble("kill -9 of a process in the middle", hits, done)
    shutil.rmtree(os.environ["ROBOWIDGETS_CACHE"], ignore_errors=True)
    soft, hard = getrlimit(RLIMIT_FSIZE)
    setrlimit(RLIMIT_FSIZE, (20_000, hard))
    try:
        hits = _find(folder, keep=True)
    finally:
        setrlimit(RLIMIT_FSIZE, (soft, hard))
    yield trouble("a full disk where results are kept", hits)
    with _cluster() as (client, processes), _after(soon, lambda: _kill_all(processes[1])) as done:
        hits = _find(folder, client)
    yield trouble("kill -9 of a worker of Dask", hits, done)
    with _cluster() as (client, processes), _after(soon, processes[0].kill) as done:
        hits = _find(folder, client)
    yield trouble("the scheduler lost", hits, done)
    with _cluster() as (client, _):
        hits = _find(folder, client)
    yield trouble("and back: the same call", hits)
    growing = folder / "drive_growing.mcap"
    with _written_meanwhile(folder / "drive_0001.mcap", growing):
        hits = _find(folder)
    rows = sorted(repr(hit) for hit in hits if hit.file != str(growing))
    told = hits.problems.get(str(growing)) or [one.problem for one in hits.unread if one.file == str(growing)]
    yield Trouble("a file that is being written", True, rows == expected, told[0] if told else "")
    growing.unlink()


@contextmanager
def _after(seconds: float, action: Callable[[], object]) -> Iterator[threading.Event]:
    """Do something after some seconds of the block. Yield an event that is set once it is done."""
    has_come = threading.Event()

    def act() -> None:
        action()
        has_come.set()

    timer = threading.Timer(seconds, act)
    timer.start()
    try:
        yield has_come
    finally:
        timer.cancel()


def _kill_a_process() -> None:
    """Kill one of the processes that search."""
    children = psutil.Process().children(recursive=True)
    os.kill([one for one in children if "popen_loky" in " ".join(one.cmdline())][-1].pid, signal.SIGKILL)


@contextmanager
def _written_meanwhile(original: Path, path: Path) -> Iterator[None]:
    """Write a growing file while the block runs, for two minutes at most."""
    data, is_over = original.read_bytes(), threading.Event()

    def write() -> None:
        with path.open("wb", buffering=0) as file:
            file.write(data[:_THERE])
            for at in range(_THERE, len(data), len(data) // 2000):
                if is_over.wait(0.06):
                    return
                file.write(data[at : at + len(data) // 2000])

    thread = threading.Thread(target=write)
    thread.start()
    while not path.exists() or path.stat().st_size < _THERE:
        time.sleep(0.01)
    try:
        yield
    finally:
        is_over.set()
        thread.join()


def _index(folder: Path, output: Path) -> str:
    """Return the cost of an index of all recordings, and of a query to it."""
    seconds, drives = timed(lambda: robowidgets.index(folder, output=output))
    again, _ = timed(lambda: robowidgets.index(folder, output=output))
    rare = conditions.nearest_below(0.05) & conditions.speed_above(0.4)
    asked, candidates = timed(lambda: drives.candidates(rare))
    return (
        f"The index of all took {seconds:.1f} s, and again {again:.1f} s: {drives.dataset.count_rows():,} rows of "
        f"{len(drives.files):,} recordings in {output.stat().st_size / 1e3:.0f} kB. A question to it took "
        f"{asked * 1000:.0f} ms, and left {len(candidates):,} recordings to be read."
    )


def _storage(files: list[Path]) -> str:
    """Return the cost of a search in an S3 server on this machine. It checks that the rows match the local files."""
    import boto3
    from moto.server import ThreadedMotoServer

    server = ThreadedMotoServer(ip_address="127.0.0.1", port=0)
    server.start()
    host, port = server.get_host_and_port()
    keys = {"AWS_ACCESS_KEY_ID": "key", "AWS_SECRET_ACCESS_KEY": "secret", "AWS_DEFAULT_REGION": "us-east-1"}
    try:
        with patch.dict(os.environ, {**keys, "AWS_ENDPOINT_URL": f"http://{host}:{port}"}):
            bucket = boto3.resource("s3").Bucket("drives")
            bucket.create()
            for path in files:
                bucket.upload_file(str(path), path.name)
            near, url = conditions.nearest_below(LIMIT), "s3://drives/*.mcap"
            seconds, there = timed(lambda: robowidgets.find(near, url))
            again, _ = timed(lambda: robowidgets.find(near, url))
    finally:
        server.stop()
    here = robowidgets.find(near, *files, keep=False)
    rows, same = ([hit._replace(file=Path(hit.file).name) for hit in hits] for hits in (there, here))
    return (
        f"\n{len(files)} recordings in S3, by a server of this machine: {seconds:.1f} s, {len(files) / seconds:.0f} a "
        f"second, and {again:.1f} s again, from the cache. Its {len(there):,} rows are "
        f"{'' if rows == same else 'NOT '}the same as for the local files."
    )


def _size(path: Path) -> int:
    return sum(one.stat().st_size for one in path.rglob("*")) if path.is_dir() else path.stat().st_size
