"""The times of pictures and clouds together with a laser at 40 Hz, and of the same bytes on a bare canvas."""

from __future__ import annotations

import json
from dataclasses import dataclass, fields, replace
from statistics import median

from .measure import PATIENCE, quantile
from .stage import Stage

NAMES = {
    "alone": "the laser alone",
    "color-bare": "640 x 480 rgb8 at 30 Hz, bare canvas",
    "color-ours": "640 x 480 rgb8 at 30 Hz, `ImageWidget`",
    "photo-ours": "640 x 480 rgb8 at 30 Hz, smooth but for the noise of a camera, `ImageWidget`",
    "depth-bare": "640 x 480 16UC1 at 10 Hz, bare canvas",
    "depth-ours": "640 x 480 16UC1 at 10 Hz, `ImageWidget`",
    "cloud-bare": "every 4th of 100,000 points at 10 Hz, bare canvas",
    "cloud-ours": "100,000 points at 10 Hz, `CloudWidget`, which draws every 4th",
    "cloud-all": "100,000 points at 10 Hz, `CloudWidget` that draws all",
}
VIEWS = {"bare": "canvas[width='640']", "ours": ".rw-image, .rw-cloud", "all": ".rw-cloud"}
SETTLING = 2.0
"""Seconds at the beginning of a run that do not count."""
IN_VIEW = """(view) => {
  const { top, bottom } = view.getBoundingClientRect();
  return bottom > 0 && top < innerHeight;
}"""


@dataclass(frozen=True)
class Large:
    """A picture together with a laser at 40 Hz, in milliseconds and per cent of a core."""

    late: float
    """From `update` until the page has reported to the kernel that it is drawn."""
    late_p95: float
    per_second: float
    behind: float
    """The median number of newer pictures at that time."""
    behind_most: float
    laser: float
    """From `update` to paint."""
    laser_p95: float
    kernel: float
    page: float
    """Of the page's main thread."""


def compare(stage: Stage, seconds: float, repeats: int) -> dict[str, Large]:
    """Return the medians of some repeats, in turn, each in a fresh notebook."""
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
    """Measure in a fresh notebook."""
    with stage.show(name, module="large_kernel") as show:
        show.first_paint(".rw-laser")
        show.learn()
        page = show.notebook.page
        views = [page.locator(".rw-laser").first]
        if (whose := name.partition("-")[2]) in VIEWS:
            views.append(page.locator(VIEWS[whose]).last)
        show.start(f"pace(40, {SETTLING + seconds}, {SETTLING})")
        page.wait_for_timeout(500 * SETTLING)
        # The cell of the run has scrolled, and views out of sight are drawn only twice a second.
        views[-1].evaluate("view => view.scrollIntoView({ block: 'end' })")
        page.wait_for_timeout(500 * SETTLING)
        before = show.page_cpu()
        run = show.finish(PATIENCE)
        cpu = (show.page_cpu() - before) / 1000
        if not all(view.evaluate(IN_VIEW) for view in views):
            print(f"  {name} was not all in view")
        show.notebook.python("source.told()")
        told = json.loads((stage.lab.files / "large.json").read_text())
    counts = replace(run, painted=run.painted[run.painted[:, 0] >= run.stamps[0] + 1000 * SETTLING])
    return Large(
        **told,
        laser=quantile(counts, 50),
        laser_p95=quantile(counts, 95),
        kernel=100 * run.cpu / run.seconds,
        page=100 * cpu / (run.seconds - SETTLING),
    )
