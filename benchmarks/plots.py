"""An hour at 1 kHz as a plot: the time to the picture, the cost of zooming and pointing, and of new values."""

from __future__ import annotations

import importlib.util
import json
from dataclasses import dataclass, fields
from math import isinf, nan
from statistics import median
from typing import Any

from .stage import Show, Stage

NAMES = {"ours": "robowidgets", "uplot": "uPlot, every value", "plotly": "plotly (scattergl)"}
PICTURE = {"ours": ".rw-plot .u-over", "uplot": ".uplot .u-over", "plotly": ".nsewdrag"}
DRAWN = {
    "ours": ".rw-plot .u-wrap canvas",
    "uplot": ".uplot canvas",
    "plotly": ".gl-canvas-context, .gl-canvas",
}
STEPS = 12
"""The number of steps of the wheel and of the pointer. Each is followed by the end of the next frame."""

# Milliseconds from a cell's start until the canvas has ink. A WebGL canvas cannot be read: it counts when it exists.
SEEN = """([path, cell, drawn]) => new Promise((done) => {
    const from = performance.now();
    driver.start(path, cell);
    const look = () => {
        const canvas = document.querySelector(drawn);
        const context = canvas?.width ? canvas.getContext("2d") : null;
        const has = context
            ? context.getImageData(0, 0, canvas.width, canvas.height).data.some((part, i) => i % 4 === 3 && part > 0)
            : canvas?.width > 0;
        if (has) done(performance.now() - from);
        else if (performance.now() - from > 30000) done(Infinity);
        else requestAnimationFrame(look);
    };
    look();
})"""
# Milliseconds of each step, from its event to the end of the frame after it.
STEP = """([selector, kind, count]) => (async () => {
    const element = document.querySelector(selector);
    const { left, top, width, height } = element.getBoundingClientRect();
    const took = [];
    for (let i = 0; i < count; i++) {
        const at = { clientX: left + width * (0.3 + (0.4 * i) / count), clientY: top + height / 2, bubbles: true };
        const from = performance.now();
        if (kind === "wheel") {
            const deltaY = i < count / 2 ? -120 : 120;
            element.dispatchEvent(new WheelEvent("wheel", { ...at, deltaY, ctrlKey: false, cancelable: true }));
        } else {
            element.dispatchEvent(new PointerEvent("pointermove", { ...at, pointerType: "mouse" }));
            element.dispatchEvent(new MouseEvent("mousemove", at));
        }
        await new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
        took.push(performance.now() - from);
    }
    return took;
})()"""


@dataclass(frozen=True)
class Plotted:
    """The figures of one library in milliseconds, megabytes, and shares of a core."""

    seen: float
    """From the start of the cell that displays it."""
    megabytes: float
    """The size of the values that the page receives."""
    zoom: float
    """The median of a step of the wheel, to the end of the next frame."""
    zoom_late: float
    """The longest."""
    point: float
    """The same for a move of the pointer."""
    kernel: float
    """Of a core, in the kernel, while values come at 1 kHz; NaN if the library takes no new values."""
    page: float
    """The same for the page's main thread."""


def available() -> list[str]:
    """Return the installed libraries."""
    return [name for name in NAMES if name != "plotly" or importlib.util.find_spec("plotly")]


def compare(stage: Stage, repeats: int, seconds: float) -> dict[str, Plotted]:
    """Return all figures of each library, as medians of some fresh notebooks."""
    found: dict[str, list[Plotted]] = {}
    for _ in range(repeats):
        for name in available():
            found.setdefault(NAMES[name], []).append(_measured(stage, name, seconds))
    return {
        name: Plotted(*(median(getattr(one, field.name) for one in ones) for field in fields(Plotted)))
        for name, ones in found.items()
    }


def _measured(stage: Stage, name: str, seconds: float) -> Plotted:
    with stage.show(name, module="plots_kernel") as show:
        page = show.notebook.page
        cell = show.notebook.append("source.show()")
        seen = page.evaluate(SEEN, [show.notebook.path, cell, DRAWN[name]])
        size = float(show.notebook.python("print(source.megabytes)"))
        if isinf(seen):
            return Plotted(seen, size, nan, nan, nan, nan, nan)
        page.locator(PICTURE[name]).first.scroll_into_view_if_needed()
        zooms = page.evaluate(STEP, [PICTURE[name], "wheel", STEPS])
        moves = page.evaluate(STEP, [PICTURE[name], "move", STEPS])
        kernel, share = _growing(show, seconds)
        return Plotted(seen, size, median(zooms), max(zooms), median(moves), kernel, share)


def _growing(show: Show, seconds: float) -> tuple[float, float]:
    before = show.page_cpu()
    said: Any = json.loads(show.notebook.python(f"print(source.grow({seconds}))"))
    return (nan, nan) if said is None else (said, (show.page_cpu() - before) / 1000 / seconds)
