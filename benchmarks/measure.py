"""The measurements of one library, and of robowidgets alone."""

from __future__ import annotations

import ast
import subprocess
import sys
from dataclasses import dataclass, fields
from pathlib import Path
from statistics import mean, median

import numpy as np
import psutil
from numpy.typing import NDArray

from .stage import ROOT, Run, Show, Stage

RIVALS = Path(__file__).with_name("rivals")
PATIENCE = 5.0
"""Seconds after a flood from which its last scan counts as never shown."""

FLOODS = 3

LOADED = "import ipykernel.kernelapp, ipywidgets, numpy"
"""The modules that every kernel with widgets and scans has loaded before the timed import."""


@dataclass
class Figures:
    """One library in a fresh kernel and page: milliseconds (infinite for never), counts and bytes."""

    first_paint: float
    page_first: float
    latency_10hz: float
    latency_10hz_p95: float
    latency_40hz: float
    latency_40hz_p95: float
    painted_40hz: float
    cpu: float
    page_cpu: float
    bytes: float
    flooded_painted: float
    flooded_latency: float
    flooded_late: float
    flooded_shown: float
    """The share of the floods after which the last scan was shown."""


def facts(rival: str) -> dict[str, str]:
    """Return the constants of a rival's module, without importing it."""
    module = ast.parse((RIVALS / f"{rival}.py").read_text())
    return {
        node.targets[0].id: node.value.value
        for node in module.body
        if isinstance(node, ast.Assign)
        and isinstance(node.targets[0], ast.Name)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    }


def compare(stage: Stage, rival: str, seconds: float) -> Figures:
    """Measure all figures of one library except its import, in a fresh notebook."""
    with stage.show(rival, facts(rival).get("SVG")) as show:
        loaded = show.page_cpu()
        first_paint = show.first_paint()
        painted = show.page_cpu()
        show.learn()
        slow = show.run(f"pace(10, {seconds})", PATIENCE)
        before = show.page_cpu()
        fast = show.run(f"pace(40, {seconds})", PATIENCE)
        after = show.page_cpu()
        # Each flood meets the frames of the display in another phase, and a steady pace keeps this phase.
        floods = [show.run(f"flood({2 * seconds / 3})", PATIENCE) for _ in range(FLOODS)]
    for run in (slow, fast, *floods):
        if run.unread:
            print(f"  {run.unread} frames of {rival} had no readable number")
    return Figures(
        first_paint=first_paint,
        page_first=painted - loaded,
        latency_10hz=quantile(slow, 50),
        latency_10hz_p95=quantile(slow, 95),
        latency_40hz=quantile(fast, 50),
        latency_40hz_p95=quantile(fast, 95),
        painted_40hz=40 * painted_within(fast) / len(fast.stamps),
        cpu=1000 * fast.cpu / len(fast.stamps),
        page_cpu=(after - before) / len(fast.stamps),
        bytes=float(slow.messages[:, 1].sum()) / len(slow.stamps),
        flooded_painted=mean(painted_within(flood) / flood.seconds for flood in floods),
        flooded_latency=mean(quantile(flood, 50) for flood in floods),
        flooded_late=mean(late(flood) for flood in floods),
        flooded_shown=mean(flood.newest_shown for flood in floods),
    )


def quantile(run: Run, percent: float) -> float:
    """Return a percentile of the latencies."""
    return float(np.percentile(run.latencies, percent)) if len(run.painted) else float("inf")


def painted_within(run: Run) -> int:
    """Return the number of scans painted before the run ended, per view."""
    views = len(np.unique(run.painted[:, 1])) or 1
    return int((run.painted[:, 0] <= run.stamps[-1]).sum()) // views


def late(run: Run) -> float:
    """Return milliseconds from the last `update` until all views showed its scan; infinite if one never did."""
    return float(run.painted[-1, 0] - run.stamps[-1]) if run.newest_shown else float("inf")


def middle(repeats: list[Figures]) -> Figures:
    """Return the median of each figure."""
    of = {field.name: [getattr(r, field.name) for r in repeats] for field in fields(Figures)}
    figures = Figures(**{name: median(values) for name, values in of.items()})
    figures.flooded_shown = mean(of["flooded_shown"])
    return figures


def import_time(rival: str, repeats: int) -> float:
    """Return milliseconds of the imports of a rival's cell, in fresh processes with the modules of every kernel."""
    code = f"{LOADED}, time\ns = time.perf_counter()\nimport benchmarks.rivals.{rival}\nprint(time.perf_counter() - s)"
    command = [sys.executable, "-c", code]
    times = [subprocess.run(command, cwd=ROOT, capture_output=True, check=True).stdout for _ in range(repeats)]
    return 1000 * median(map(float, times))


@dataclass
class Four:
    """Four widgets at once."""

    messages: int
    """The highest number of messages to the page within a second."""
    painted: float
    latency: float
    latency_p95: float
    newest_shown: bool
    dropped: bool
    """True if the server reported dropped messages."""


def four(stage: Stage, seconds: float) -> tuple[Four, Four]:
    """Measure four laser widgets in one notebook, at 40 Hz each, and flooded."""
    with stage.show("laser", count=4) as show:
        show.first_paint()
        show.learn()
        runs = show.run(f"pace(40, {seconds})", PATIENCE), show.run(f"flood({seconds})", PATIENCE)
    paced, flooded = (
        Four(
            messages=most_per_second(run.messages[:, 0]),
            painted=painted_within(run) / run.seconds,
            latency=quantile(run, 50),
            latency_p95=quantile(run, 95),
            newest_shown=run.newest_shown,
            dropped=run.complaint,
        )
        for run in runs
    )
    return paced, flooded


def most_per_second(times: np.ndarray) -> int:
    """Return the largest number of events within any second, from ascending times in milliseconds."""
    return int((np.searchsorted(times, times + 1000) - np.arange(len(times))).max())


@dataclass
class Endurance:
    """A part of a long flood, in milliseconds and megabytes."""

    painted: float
    latency: float
    latency_p95: float
    page_heap: float
    kernel: float
    server: float


def flood_long(stage: Stage, seconds: float, stretch: float) -> tuple[Endurance, Endurance, float]:
    """Measure the first and the last part of a flood, and the delay of its last scan."""
    with stage.show("laser") as show:
        show.first_paint()
        show.learn()
        kernel = psutil.Process(int(show.notebook.python("import os; print(os.getpid())")))
        show.start(f"flood({seconds})")
        show.notebook.page.wait_for_timeout(1000 * stretch)
        early = memory(show, kernel)
        show.notebook.page.wait_for_timeout(1000 * (seconds - stretch - 1))
        end = memory(show, kernel)
        run = show.finish(PATIENCE)
    first, last = (
        Endurance(len(part) / stretch, float(np.median(part)), float(np.percentile(part, 95)), *megabytes)
        for part, megabytes in zip(ends(run, seconds, stretch), (early, end), strict=True)
    )
    return first, last, late(run)


def ends(run: Run, seconds: float, stretch: float) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the latencies of the paints in the first and in the last part of a run."""
    times = run.painted[:, 0] - run.stamps[0]
    return run.latencies[times < 1000 * stretch], run.latencies[times >= 1000 * (seconds - stretch)]


def memory(show: Show, kernel: psutil.Process) -> tuple[float, float, float]:
    """Return megabytes of the page's JavaScript after garbage collection, and of the processes of kernel and server."""
    session = show.notebook.page.context.new_cdp_session(show.notebook.page)
    session.send("HeapProfiler.collectGarbage")
    heap = session.send("Runtime.getHeapUsage")["usedSize"]
    session.detach()
    server = kernel.parent()
    assert server is not None
    return heap / 1e6, kernel.memory_info().rss / 1e6, server.memory_info().rss / 1e6
