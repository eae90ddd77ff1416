"""What is measured of large frames: pictures beside a laser at 40 Hz, and the same bytes on a bare canvas."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields
from statistics import median

from .measure import PATIENCE, quantile
from .stage import Stage

NAMES = {
    "alone": "the laser alone",
    "color-bare": "640 x 480 rgb8 at 30 Hz, bare canvas",
    "color-ours": "640 x 480 rgb8 at 30 Hz, `ImageWidget`",
    "depth-bare": "640 x 480 16UC1 at 10 Hz, bare canvas",
    "depth-ours": "640 x 480 16UC1 at 10 Hz, `ImageWidget`",
}


@dataclass(frozen=True)
class Large:
    """A picture beside a laser at 40 Hz. Milliseconds, and per cent of a core."""

    late: float
    """From `update` until the kernel has heard that it is drawn."""
    late_p95: float
    per_second: float
    behind: float
    """The most that came meanwhile."""
    laser: float
    """From `update` to paint."""
    laser_p95: float
    kernel: float
    page: float
    """Of the page's main thread."""


def compare(stage: Stage, seconds: float, repeats: int) -> dict[str, Large]:
    """The medians of some repeats, in turn, each in a fresh notebook."""
    found: dict[str, list[Large]] = {name: [] for name in NAMES}
    for _ in range(repeats):
        for name, ones in found.items():
            ones.append(once(stage, name, seconds))
            print(f"{NAMES[name]}: {ones[-1]}", flush=True)
    return {
        name: Large(*(median(getattr(one, field.name) for one in ones) for field in fields(Large)))
        for name, ones in found.items()
    }


def once(stage: Stage, name: str, seconds: float) -> Large:
    """One fresh notebook."""
    with stage.show(name, module="large_kernel") as show:
        show.first_paint(".rw-laser")
        show.learn()
        show.notebook.python("source.beside()")
        show.notebook.page.wait_for_timeout(1000)
        before = show.page_cpu()
        show.start(f"pace(40, {seconds})")
        # Both in view: what is out of sight is drawn twice a second.
        below = {"bare": "canvas", "ours": ".rw-image"}.get(name.partition("-")[2], ".rw-laser")
        show.notebook.page.locator(below).last.evaluate("view => view.scrollIntoView({ block: 'center' })")
        run = show.finish(PATIENCE)
        page = (show.page_cpu() - before) / 1000
        show.notebook.python("source.told()")
        told = json.loads((stage.lab.files / "large.json").read_text())
    return Large(
        late=told["late"] or 0.0,
        late_p95=told["late_p95"] or 0.0,
        per_second=told["per_second"],
        behind=told["behind"],
        laser=quantile(run, 50),
        laser_p95=quantile(run, 95),
        kernel=100 * run.cpu / run.seconds,
        page=100 * page / run.seconds,
    )
