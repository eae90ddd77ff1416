"""A search on a cluster of Dask with two workers, if one of them or the scheduler is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import Any

import pytest

from robowidgets.fleet import find

from .executors import Here

distributed = pytest.importorskip("distributed")
pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]


def near(moment: Any) -> bool:
    return bool(moment.scan.distance() < 0.3)


def near_after(kill: Callable[[], None], marker: Path) -> Callable[[Any], bool]:
    """Return `near` for a search whose first call, in any process, kills something."""

    def condition(moment: Any) -> bool:
        if not marker.exists():
            try:
                marker.touch(exist_ok=False)
            except FileExistsError:
                pass
            else:
                kill()
        return bool(moment.scan.distance() < 0.3)

    return condition


@contextmanager
def cluster(folder: Path) -> Iterator[tuple[Any, int]]:
    """Yield a client of a cluster of processes, and the process of its scheduler."""
    about = folder / "scheduler.json"
    where = ["--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(about)]
    worker = ["--scheduler-file", str(about), "--nthreads", "1", "--no-dashboard"]
    with ExitStack() as ending:
        for name, options in (("dask_scheduler", where), ("dask_worker", worker), ("dask_worker", worker)):
            command = [sys.executable, "-m", f"distributed.cli.{name}", *options]
            # A group of its own, because a worker has a nurse that starts it again.
            process = subprocess.Popen(
                command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, cwd=folder, start_new_session=True
            )
            ending.callback(process.wait)
            ending.callback(end_group, process.pid)
            if name == "dask_scheduler":
                scheduler = process.pid
        with distributed.Client(scheduler_file=str(about), timeout=60) as client:
            client.wait_for_workers(2)
            yield client, scheduler


def end_group(pid: int) -> None:
    with suppress(ProcessLookupError):
        os.killpg(pid, signal.SIGKILL)


def rows(hits: Any) -> list[Any]:
    return sorted(map(repr, hits))


@pytest.mark.parametrize("victim", ["worker", "scheduler"])
def test_each_row_is_found_once_if_a_process_of_the_cluster_is_killed(victim: str, runs: Path, tmp_path: Path) -> None:
    marker = tmp_path / "killed"
    with cluster(tmp_path) as (client, scheduler):
        kill = (
            (lambda: os.kill(os.getpid(), signal.SIGKILL))
            if victim == "worker"
            else (lambda: os.kill(scheduler, signal.SIGKILL))
        )
        hits = find(near_after(kill, marker), runs, executor=client, keep=False)
    assert marker.exists()
    assert rows(hits) == rows(find(near, runs, executor=Here(), keep=False))
    assert [Path(one.file).name for one in hits.unread] == ["broken.bag"]
