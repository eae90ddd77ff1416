"""The cost of the layers of the laser compared with the plain widget, and the frame rate of dragging a sector."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median

from .measure import PATIENCE, painted_within, quantile
from .stage import Stage

HZ = 40
COUNTS = (1040, 20_000)
"""The numbers of rays of the scans on which a sector is dragged."""

_MAKE = """
import numpy as np
from robowidgets import LaserWidget
laser = LaserWidget()
ranges = 3 + np.sin(np.arange({count}) / {count} * 40)
laser.update(ranges=ranges, angle_min=-2.35, angle_increment=4.7 / {count}, range_min=0.1, range_max=6.0)
laser
"""
_DRAG = """
async (picture, seconds) => {
    const { left, top, width, height } = picture.getBoundingClientRect();
    // The chip stands in the picture or below it.
    const chip = () => picture.parentElement.querySelector(".rw-chip-expression")?.value;
    const send = (type, angle) => {
        const [x, y] = [left + width / 2 + 120 * Math.sin(angle), top + 0.58 * height - 120 * Math.cos(angle)];
        const where = { clientX: x, clientY: y, pointerId: 1, isPrimary: true, button: 0, bubbles: true };
        picture.dispatchEvent(new PointerEvent(type, where));
    };
    picture.setPointerCapture = () => {};
    const frame = () => new Promise(requestAnimationFrame);
    send("pointerdown", 0);
    const chips = new Set();
    await frame();
    const start = performance.now();
    let frames = 0;
    while (performance.now() - start < 1000 * seconds) {
        send("pointermove", 0.3 + 0.8 * Math.abs(Math.sin((performance.now() - start) / 700)));
        await frame();
        chips.add(chip());
        frames++;
    }
    const rate = (1000 * frames) / (performance.now() - start);
    send("pointerup", 1);
    return [rate, chips.size];
}
"""


@dataclass(frozen=True)
class Cost:
    """At 40 Hz."""

    painted: float
    """Scans per second."""
    latency: float
    """Milliseconds, the median."""
    cpu: float
    """Milliseconds of the kernel's process per scan."""


def compare(stage: Stage, repeats: int, seconds: float) -> dict[str, Cost]:
    """Measure the plain widget and the widget with all layers in turn."""
    found: dict[str, list[Cost]] = {"laser": [], "layers": []}
    for _ in range(repeats):
        for name, costs in found.items():
            costs.append(_measured(stage, name, seconds))
    return {
        name: Cost(*(median(getattr(cost, field) for cost in costs) for field in ("painted", "latency", "cpu")))
        for name, costs in found.items()
    }


def _measured(stage: Stage, name: str, seconds: float) -> Cost:
    with stage.show(name) as show:
        show.first_paint()
        show.learn()
        run = show.run(f"pace({HZ}, {seconds})", PATIENCE)
    if run.unread:
        print(f"  {run.unread} frames of {name} had no readable number")
    painted = HZ * painted_within(run) / len(run.stamps)
    return Cost(painted=painted, latency=quantile(run, 50), cpu=1000 * run.cpu / len(run.stamps))


def drags(stage: Stage, seconds: float) -> dict[int, float]:
    """Return the frames per second in which a dragged sector follows the pointer, by the number of rays."""
    found = {}
    with stage.show("laser") as show:
        notebook = show.notebook
        for count in COUNTS:
            cell = notebook.append(_MAKE.format(count=count))
            notebook.run(cell)
            picture = notebook.widget(cell).locator(".rw-picture")
            picture.scroll_into_view_if_needed()
            found[count], slices = picture.evaluate(_DRAG, seconds)
            if slices < 5:
                raise RuntimeError(f"the sector did not follow: its chip showed {slices} slices")
    return found
