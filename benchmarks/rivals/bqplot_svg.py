import bqplot

from ..scan import RANGE_MAX, points

NAME = "bqplot"
SVG = ".object_grp"


def make_with(mark, ranges):
    x, y = points(ranges)
    scales = {name: bqplot.LinearScale(min=-RANGE_MAX, max=RANGE_MAX) for name in "xy"}
    dots = mark(x=x, y=y, scales=scales, colors=["red"], marker="square", default_size=9)
    axes = [bqplot.Axis(scale=scales["x"]), bqplot.Axis(scale=scales["y"], orientation="vertical")]
    layout = {"width": "760px", "height": "560px"}
    figure = bqplot.Figure(marks=[dots], axes=axes, layout=layout)

    def update(ranges):
        with dots.hold_sync():
            dots.x, dots.y = points(ranges)

    return figure, update


def make(ranges):
    return make_with(bqplot.Scatter, ranges)
