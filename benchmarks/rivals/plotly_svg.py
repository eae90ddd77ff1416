from plotly.graph_objects import Scatter

from .plotly_gl import make_with

NAME = "plotly (scatter)"
SVG = ".scatterlayer .point"


def make(ranges):
    return make_with(Scatter, ranges)
