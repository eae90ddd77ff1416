"""The laser's latency on a robot with thirty topics, and the CPU of kernel and page."""

from __future__ import annotations

import os
from dataclasses import dataclass, fields
from statistics import mean, median

import numpy as np

from .feeds import since_published
from .measure import PATIENCE, quantile
from .stage import VIEW, Stage

NAMES = {
    "bare": "a bare canvas on the feed, of a robot of one topic",
    "alone": "the laser, of a robot of one topic",
    "beside": "the laser, of a robot of 30; the list of topics folded",
    "cards": "8 cards: laser, speed, a plot and a message at 1 kHz, a plot, events, a map, a sonar; the list folded",
    "listed": "`feed.show()`: all that it finds a widget for, and the list open",
}
MIDDLEWARES = ("dds", "foxglove")
SETTLING = 3000
"""Milliseconds of running before anything counts."""


@dataclass(frozen=True)
class Beside:
    """The laser at 40 Hz with other widgets, in milliseconds since publishing and per cent of a core."""

    bare: float
    """To the callback of a bare subscriber in a separate process."""
    handed: float
    """To a function that is connected to the feed."""
    painted: float
    painted_p95: float
    per_second: float
    """The painted scans of 40."""
    kernel: float
    page: float
    """The load of the page's main thread."""
    rate: float
    """The messages per second of the robot without its scans."""


@dataclass(frozen=True)
class Compared:
    """The medians of some repeats of each, and the number of processes that ran or waited for a core."""

    figures: dict[str, Beside]
    load: float


def compare(stage: Stage, middleware: str, seconds: float, repeats: int) -> Compared:
    """Measure all views in turn, each in fresh notebooks."""
    found: dict[str, list[Beside]] = {name: [] for name in NAMES}
    loads = []
    for _ in range(repeats):
        for name, ones in found.items():
            ones.append(once(stage, f"{middleware}-{name}", seconds))
            loads.append(os.getloadavg()[0])
            print(f"{middleware}, {NAMES[name]}: {ones[-1]}; load {loads[-1]:.1f}", flush=True)
    middle = {
        name: Beside(*(median(getattr(one, field.name) for one in ones) for field in fields(Beside)))
        for name, ones in found.items()
    }
    return Compared(middle, mean(loads))


def once(stage: Stage, name: str, seconds: float) -> Beside:
    """Measure in a fresh notebook."""
    with stage.show(name, module="topics_kernel") as show:
        view = VIEW if name.endswith("-bare") else ".rw-laser"
        show.first_paint(view)
        show.notebook.python("source.beside('once')")
        show.notebook.page.wait_for_timeout(SETTLING)
        # The places of dots are learned from still pictures, before the other topics are published.
        show.learn()
        show.notebook.python("source.beside('go')")
        show.notebook.page.wait_for_timeout(SETTLING)
        before = show.page_cpu()
        show.start(f"pace(40, {seconds})")
        # The cell of the run has scrolled the laser of a tall view out of sight. There it is drawn only twice a second.
        show.notebook.page.locator(view).first.evaluate("view => view.scrollIntoView({ block: 'center' })")
        run = show.finish(PATIENCE)
        page = (show.page_cpu() - before) / 1000
        rate = float(show.notebook.python("print(source.rate())"))
        bare, handed = (since_published(stage, run, file) for file in ("bare.npy", "heard.npy"))
        show.notebook.python("source.close()")
    if run.unread:
        print(f"  {run.unread} frames of {name} had no readable number")
    return Beside(
        bare=float(np.nanmedian(bare)),
        handed=float(np.nanmedian(handed)),
        painted=quantile(run, 50),
        painted_p95=quantile(run, 95),
        per_second=len(run.painted) / run.seconds,
        kernel=100 * run.cpu / run.seconds,
        page=100 * page / run.seconds,
        rate=rate,
    )
