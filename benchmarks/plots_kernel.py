"""In the kernel: an hour at 1 kHz as a plot, by name."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

HZ, HOUR = 1000, 3600
PEAK = 1_234_567
"""The index of the outlier, which must be visible."""

BARE = """
export default {
  render({ model, el }) {
    const start = async () => {
      if (!globalThis.uPlot) (0, eval)(model.get("script"));
      const values = new Float64Array(model.get("values").buffer.slice(0));
      const times = Float64Array.from(values, (_, i) => i / 1000);
      const scales = { x: { time: false } };
      const size = { width: 760, height: 260 };
      const series = [{}, { stroke: "black", width: 1 }];
      const plot = new uPlot({ ...size, scales, series, legend: { show: false } }, [times, values], el);
      plot.over.addEventListener("wheel", (event) => {
        event.preventDefault();
        const { min, max } = plot.scales.x;
        const factor = event.deltaY < 0 ? 0.8 : 1.25;
        const around = plot.posToVal(event.offsetX, "x");
        plot.setScale("x", { min: around - (around - min) * factor, max: around + (max - around) * factor });
      });
      model.on("change:more", () => plot.setData([times, values], false));
    };
    start();
  },
};
"""


def hour() -> tuple[Any, Any]:
    """Return times and values."""
    times = np.arange(HZ * HOUR) / HZ
    values = np.sin(times / 100) + np.random.default_rng(1).normal(0, 0.05, len(times))
    values[PEAK] = 9.0
    return times, values


def _ours() -> tuple[Any, Callable[[float, float], None]]:
    from robowidgets import PlotWidget

    plot = PlotWidget(title="1 kHz for an hour", units={"v": "V"}, window=None)
    plot.set_line("v", *hour())
    return plot, lambda value, at: plot.update(v=value, time=HOUR + at)


def _bare() -> tuple[Any, None]:
    import anywidget
    import traitlets

    folder = Path(__file__).parents[1] / "robowidgets" / "js" / "node_modules" / "uplot" / "dist"

    library = (folder / "uPlot.iife.min.js").read_text().replace("var uPlot", "globalThis.uPlot")

    class Bare(anywidget.AnyWidget):  # type: ignore[misc]  # ipywidgets has no types
        _esm = BARE
        _css = (folder / "uPlot.min.css").read_text()
        script = traitlets.Unicode(library).tag(sync=True)
        values = traitlets.Bytes().tag(sync=True)

    return Bare(values=hour()[1].tobytes()), None


def _plotly() -> tuple[Any, None]:
    from plotly.graph_objects import FigureWidget, Scattergl

    times, values = hour()
    layout = {"width": 760, "height": 300, "dragmode": "pan"}
    figure = FigureWidget(data=[Scattergl(x=times, y=values, mode="lines")], layout=layout)
    figure._config = {**figure._config, "scrollZoom": True}
    return figure, None


MAKE: dict[str, Callable[[], tuple[Any, Callable[[float, float], None] | None]]] = {
    "ours": _ours,
    "uplot": _bare,
    "plotly": _plotly,
}


def _size(value: Any) -> int:
    """Return the bytes of arrays in a state."""
    if isinstance(value, dict):
        return sum(map(_size, value.values()))
    if isinstance(value, (list, tuple)):
        return sum(_size(one) for one in value if not isinstance(one, (int, float, str)))
    return memoryview(value).nbytes if isinstance(value, (bytes, memoryview, np.ndarray)) else 0


class Source:
    """A plot that receives values."""

    def __init__(self, name: str, _count: int) -> None:
        began = time.process_time()
        self._widget, self._add = MAKE[name]()
        self.cpu = time.process_time() - began
        state = self._widget.get_state()
        self.megabytes = _size(state) / 1e6

    def show(self) -> Any:
        """Return the object that the cell displays."""
        return self._widget

    def grow(self, seconds: float) -> str:
        """Add values at 1 kHz for some seconds. Return the CPU of the process in that time, as a share."""
        if self._add is None:
            return json.dumps(None)
        add, stop = self._add, threading.Event()
        began, worked = time.perf_counter(), time.process_time()
        for i in range(round(seconds * HZ)):
            add(np.sin(i / 100), i / HZ)
            stop.wait(max(0.0, began + (i + 1) / HZ - time.perf_counter()))
        return json.dumps((time.process_time() - worked) / (time.perf_counter() - began))
