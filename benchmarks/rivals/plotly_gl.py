from plotly.graph_objects import FigureWidget, Scattergl

from ..scan import RANGE_MAX, points

NAME = "plotly (scattergl)"
LAYOUT = {
    "width": 760,
    "height": 560,
    "xaxis": {"range": [-RANGE_MAX, RANGE_MAX]},
    "yaxis": {"range": [-RANGE_MAX, RANGE_MAX], "scaleanchor": "x"},
}
MARKER = {"color": "red", "size": 3, "symbol": "square"}


def make_with(trace, ranges):
    x, y = points(ranges)
    figure = FigureWidget(data=[trace(x=x, y=y, mode="markers", marker=MARKER)], layout=LAYOUT)

    def update(ranges):
        with figure.batch_update():
            figure.data[0].x, figure.data[0].y = points(ranges)

    return figure, update


def make(ranges):
    return make_with(Scattergl, ranges)
