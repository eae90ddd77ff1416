"""The times of feeds from publishing in another process to paint, compared with a bare subscriber's callback."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import psutil
from numpy.typing import NDArray

from .inside import MADE
from .measure import PATIENCE, ends, memory
from .middleware import SYSTEM
from .stage import Run, Show, Stage

BLOCK = 20
"""The length of a block of consecutive scans in the bootstrap, because a scan may delay the next."""
TURNS = 4
"""The number of turns of the feed and of the widget alone in a notebook."""


@dataclass
class Figures:
    """One feed at 40 Hz: medians of milliseconds since publishing, and the share of a core."""

    bare: float
    """To the callback of a bare subscriber in a separate process."""
    handed: float
    """To a function that is connected to the feed."""
    painted: float
    painted_p95: float
    widget: float
    """From `update` to paint, without a feed."""
    added: tuple[float, float, float]
    """The mean time that the feed adds to the bare subscriber and the widget, and its 95 % confidence interval."""
    core: float
    """The load of the kernel with four widgets, in per cent of a core."""


@dataclass
class Endurance:
    """A part of a minute at 1000 Hz, in milliseconds and megabytes."""

    latency: float
    latency_p95: float
    page_heap: float
    kernel: float


def available() -> list[str]:
    """Return the feeds that can be measured on this machine."""
    ros1, ros2 = Path(SYSTEM, "rospy").is_dir(), find_spec("rclpy") is not None
    return ["dds", "foxglove", "rosbridge", "zenoh", *["ros1"] * ros1, *["ros2"] * ros2, *MADE]


def compare(stage: Stage, name: str, seconds: float, repeats: int) -> Figures:
    """Measure some repeats, each in a fresh kernel and page."""
    found = [once(stage, name, seconds) for _ in range(repeats)]
    with_feed, alone = ([run for one in found for run in one[part]] for part in ("with_feed", "alone"))
    painted = np.concatenate([run.latencies for run, _, _ in with_feed])
    bare, handed = (np.concatenate([run[part] for run in with_feed]) for part in (1, 2))
    # For each painted scan, from the bare subscriber's callback.
    since_bare = [run.latencies - since[run.painted[:, 2].astype(int) - run.first] for run, since, _ in with_feed]
    return Figures(
        bare=float(np.nanmedian(bare)),
        handed=float(np.nanmedian(handed)),
        painted=float(np.median(painted)),
        painted_p95=float(np.percentile(painted, 95)),
        widget=float(np.median(np.concatenate(alone))),
        added=difference([since[~np.isnan(since)] for since in since_bare], alone),
        core=median(one["core"] for one in found),
    )


def once(stage: Stage, name: str, seconds: float) -> dict[str, Any]:
    """Measure a feed and the widget alone in turn, in a fresh notebook, and four widgets in another notebook."""
    with_feed, alone = [], []
    with opened(stage, name) as show:
        for _ in range(TURNS):
            run = show.run(f"pace(40, {seconds / TURNS})", PATIENCE)
            with_feed.append((run, *(since_published(stage, run, file) for file in ("bare.npy", "heard.npy"))))
            alone.append(show.run(f"direct(40, {seconds / TURNS})", PATIENCE).latencies)
    with opened(stage, name, count=4) as show:
        four = show.run(f"pace(40, {seconds})", PATIENCE)
    return {"with_feed": with_feed, "alone": alone, "core": 100 * four.cpu / four.seconds}


def difference(ours: list[NDArray[Any]], theirs: list[NDArray[Any]]) -> tuple[float, float, float]:
    """Return the difference of two means and its 95 % confidence interval, by a bootstrap of blocks."""
    draw = np.random.default_rng(1)

    def means(runs: list[NDArray[Any]]) -> NDArray[Any]:
        blocks = [block for run in runs for block in np.array_split(run, max(1, len(run) // BLOCK))]
        sums, sizes = np.array([block.sum() for block in blocks]), np.array([len(block) for block in blocks])
        drawn = draw.integers(len(blocks), size=(5000, len(blocks)))
        return np.asarray(sums[drawn].sum(axis=1) / sizes[drawn].sum(axis=1))

    low, high = np.percentile(means(ours) - means(theirs), [2.5, 97.5])
    return float(np.concatenate(ours).mean() - np.concatenate(theirs).mean()), float(low), float(high)


def endure(stage: Stage, name: str, seconds: float, stretch: float) -> tuple[Endurance, Endurance]:
    """Measure the first and the last part of a long time at 1000 Hz."""
    with opened(stage, name) as show:
        kernel = psutil.Process(int(show.notebook.python("import os; print(os.getpid())")))
        show.start(f"pace(1000, {seconds})")
        show.notebook.page.wait_for_timeout(1000 * stretch)
        early = memory(show, kernel)
        show.notebook.page.wait_for_timeout(1000 * (seconds - stretch - 1))
        end = memory(show, kernel)
        run = show.finish(PATIENCE)
    first, last = (
        Endurance(float(np.median(part)), float(np.percentile(part, 95)), heap, megabytes)
        for part, (heap, megabytes, _) in zip(ends(run, seconds, stretch), (early, end), strict=True)
    )
    return first, last


def since_published(stage: Stage, run: Run, file: str) -> NDArray[np.float64]:
    """Return milliseconds from publishing to a callback for each scan, from the callback's file; NaN if it missed."""
    noted: NDArray[Any] = np.load(stage.lab.files / file)
    noted = noted[(noted[:, 0] >= run.first) & (noted[:, 0] < run.first + len(run.stamps))]
    since = np.full(len(run.stamps), np.nan)
    since[noted[:, 0] - run.first] = noted[:, 1] / 1000 - run.stamps[noted[:, 0] - run.first]
    return since


@contextmanager
def opened(stage: Stage, name: str, count: int = 1) -> Iterator[Show]:
    """Open a notebook with widgets on a feed that the page can read."""
    with stage.show(name, count=count, module="feed_kernel") as show:
        show.first_paint()
        show.learn()
        yield show
        show.notebook.python("source.close()")
