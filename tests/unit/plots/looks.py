"""The states of a plot whose looks are kept."""

from __future__ import annotations

from robowidgets import PlotWidget

from ...looks import Look


def _lines() -> PlotWidget:
    plot = PlotWidget(title="run", units={"set": "m/s", "measured": "m/s"})
    plot.set_line("set", [0.0, 1.0, 2.0], [0.2, 0.2, 0.0])
    plot.set_line("measured", [0.0, 0.5, 1.0, 1.5, 2.0], [0.0, 0.15, 0.21, 0.19, 0.02])
    return plot


LOOKS = {
    "plot/empty": Look(make=lambda: PlotWidget(title="run")),
    "plot/lines": Look(make=_lines),
}
