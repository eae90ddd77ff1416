from bqplot_gl import ScatterGL

from .bqplot_svg import make_with

NAME = "bqplot (gl)"


def make(ranges):
    return make_with(ScatterGL, ranges)
