import plotly.graph_objects as go

from .plotly_gl import make_with

NAME = "plotly (scatter)"
SVG = ".scatterlayer .point"


def make(ranges):
    return make_with(go.Scatter, ranges)
