import matplotlib

matplotlib.use("module://ipympl.backend_nbagg")

import matplotlib.pyplot as plt

from ..scan import RANGE_MAX, points

NAME = "matplotlib + ipympl"


def make(ranges):
    with plt.ioff():
        figure, axes = plt.subplots(figsize=(7.6, 5.6))
    (dots,) = axes.plot(*points(ranges), "s", color="red", markersize=2)
    axes.set(xlim=(-RANGE_MAX, RANGE_MAX), ylim=(-RANGE_MAX, RANGE_MAX), aspect="equal")

    def update(ranges):
        dots.set_data(*points(ranges))
        figure.canvas.draw()

    return figure.canvas, update
