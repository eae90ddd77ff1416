"""What is measured of feeds: from publishing in another process to paint, beside a bare subscriber's callback."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, fields
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import psutil
from numpy.typing import NDArray

from .measure import PATIENCE, memory, quantile
from .middleware import SYSTEM
from .stage import Run, Show, Stage


@dataclass
class Figures:
    """One feed, at 40 Hz. Milliseconds since publishing, medians, but for the share of a core."""

    bare: float
    """To the callback of a bare subscriber, in a process of its own."""
    handed: float
    """To a function that is connected to the feed."""
    painted: float
    painted_p95: float
    widget: float
    """From `update` to paint, without a feed: the widget's own."""
    added: float
    """What the feed adds to the bare subscriber and the widget."""
    core: float
    """Per cent of a core that the kernel takes with four widgets at once."""


@dataclass
class Endurance:
    """A stretch of a minute at 1000 Hz. Milliseconds and megabytes."""

    latency: float
    latency_p95: float
    page_heap: float
    kernel: float


def available() -> list[str]:
    """The middlewares that can be measured here."""
    return ["dds", "foxglove", *(["ros1"] if Path(SYSTEM, "rospy").is_dir() else [])]


def compare(stage: Stage, name: str, seconds: float, repeats: int) -> Figures:
    """The medians of some repeats, each in a fresh kernel and page."""
    each = [once(stage, name, seconds) for _ in range(repeats)]
    return Figures(**{field.name: median(getattr(one, field.name) for one in each) for field in fields(Figures)})


def once(stage: Stage, name: str, seconds: float) -> Figures:
    """One feed, in one fresh notebook for one widget, and in another for four."""
    with opened(stage, name) as show:
        run = show.run(f"pace(40, {seconds})", PATIENCE)
        bare, handed = (since_published(stage, run, file) for file in ("bare.npy", "heard.npy"))
        painted, painted_p95 = quantile(run, 50), quantile(run, 95)
        widget = quantile(show.run(f"direct(40, {seconds})", PATIENCE), 50)
    with opened(stage, name, count=4) as show:
        four = show.run(f"pace(40, {seconds})", PATIENCE)
    return Figures(
        bare=bare,
        handed=handed,
        painted=painted,
        painted_p95=painted_p95,
        widget=widget,
        added=painted - bare - widget,
        core=100 * four.cpu / four.seconds,
    )


def endure(stage: Stage, name: str, seconds: float, stretch: float) -> tuple[Endurance, Endurance]:
    """The first and the last stretch of a long time at 1000 Hz."""
    with opened(stage, name) as show:
        kernel = psutil.Process(int(show.notebook.python("import os; print(os.getpid())")))
        show.start(f"pace(1000, {seconds})")
        show.notebook.page.wait_for_timeout(1000 * stretch)
        early = memory(show, kernel)
        show.notebook.page.wait_for_timeout(1000 * (seconds - stretch - 1))
        end = memory(show, kernel)
        run = show.finish(PATIENCE)
    times = run.painted[:, 0] - run.stamps[0]
    stretches = (times < 1000 * stretch), (times >= 1000 * (seconds - stretch))
    first, last = (
        Endurance(float(np.median(run.latencies[part])), float(np.percentile(run.latencies[part], 95)), heap, megabytes)
        for part, (heap, megabytes, _) in zip(stretches, (early, end), strict=True)
    )
    return first, last


def since_published(stage: Stage, run: Run, file: str) -> float:
    """The median of the milliseconds from publishing to a callback, which noted number and microseconds."""
    noted: NDArray[Any] = np.load(stage.lab.files / file)
    noted = noted[(noted[:, 0] >= run.first) & (noted[:, 0] < run.first + len(run.stamps))]
    return float(np.median(noted[:, 1] / 1000 - run.stamps[noted[:, 0] - run.first]))


@contextmanager
def opened(stage: Stage, name: str, count: int = 1) -> Iterator[Show]:
    """A notebook with widgets on a feed, whose page can read them."""
    with stage.show(name, count=count, module="feed_kernel") as show:
        show.first_paint()
        show.learn()
        yield show
        show.notebook.python("source.close()")
