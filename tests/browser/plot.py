"""Cells with plots, for the tests of their widget."""

from __future__ import annotations

RECORDED = """
import robowidgets
recording = robowidgets.open(robowidgets.SAMPLE)
plot = robowidgets.plot(
    recording, "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x", "/odom.twist.twist.angular.z",
    marks=recording.find(robowidgets.conditions.touched()),
)
plot
"""
ARRAYS = """
from robowidgets import PlotWidget
plot = PlotWidget(title="by hand", units={"a": "m", "b": "m"})
plot.set_line("a", [0, 1, 2, 3, 4], [0.0, 0.25, 0.5, 3.0, 1.0])
plot.set_line("b", [0, 1, 2, 3, 4], [1.0, float("nan"), 1.5, 1.5, -2.0])
plot
"""
FAST = """
import numpy as np
from robowidgets import PlotWidget
plot = PlotWidget(title="1 kHz for an hour", units={"v": "V"})
seconds = np.arange(3_600_000) / 1000
values = np.sin(seconds / 100)
values[1_234_567] = 9.0
plot.set_line("v", seconds, values)
plot
"""
LIVE = """
from robowidgets import PlotWidget
from robowidgets.widget.pacer import pacer
plot = PlotWidget(title="live", units={"v": "m/s", "heading": "rad"})
for i in range(600):
    plot.update({"v": (i % 50) / 100, "heading": 3 - i / 100}, time=i / 10)
plot
"""
EMPTY = """
from robowidgets import PlotWidget
plot = PlotWidget(title="nothing yet")
plot
"""

FULL = """
import numpy as np
import robowidgets
recording = robowidgets.open(robowidgets.SAMPLE)
plot = robowidgets.plot(
    recording, "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x", "/odom.twist.twist.angular.z",
    marks=robowidgets.conditions.nearest_below(0.3), title="run",
    states=[[(0, 12.9, "Walker.forward"), (12.9, 14.6, "Walker.back"), (14.6, 15.9, "Walker.turn"),
        (15.9, 30, "Walker.forward"), (30, 33, "Walker.back"), (33, 58, "Walker.forward")]],
)
plot
"""
GHOST = """
import robowidgets
recording = robowidgets.open(robowidgets.SAMPLE)
plot = robowidgets.plot(recording, "/odom.twist.twist.angular.z", beside=recording, shift=1.5)
plot
"""
