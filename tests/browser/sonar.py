"""Cells with rings of sonars, for the tests of their widget."""

from __future__ import annotations

PIONEER = """
from math import inf, nan
from robowidgets import Range, SonarWidget
_angles = (90, 50, 30, 10, -10, -30, -50, -90, -90, -130, -150, -170, 170, 150, 130, 90)
_places = ((0.069, 0.136), (0.114, 0.119), (0.148, 0.078), (0.166, 0.027))
_xy = [*_places, *((x, -y) for x, y in reversed(_places))]
_xy += [(-0.118 - x, y) for x, y in reversed(_xy)]
_poses = {f"sonar_{i}": (*_xy[i], f"{angle}deg") for i, angle in enumerate(_angles)}
_poses = {name: (x, y, float(yaw[:-3]) * 3.14159265 / 180) for name, (x, y, yaw) in _poses.items()}
pioneer = SonarWidget(title="/pioneer/sonar", poses=_poses, near=0.4)
_ranges = (2.1, 3.4, 1.62, 0.81, 0.34, 1.95, inf, 4.4, 1.2, 0.9, 2.2, -inf, nan, 0.0, 3.1, 2.6)
pioneer.update({f"sonar_{i}": Range(r, 0.1, 5.0, 0.5236, "ultrasound") for i, r in enumerate(_ranges)})
pioneer
"""
MANY = """
from robowidgets import SonarWidget, Range
many = SonarWidget(title="24 infrared", near=0.3)
many.update({f"ir_{i}": Range(0.25 + 0.13 * i % 1.4, 0.06, 1.5, 0.2, "infrared") for i in range(24)})
many
"""
STUDENT = """
from robowidgets import SonarWidget
sonars = SonarWidget(title="Arduino", poses={"front": 0, "left": "60deg", "right": "-60deg"}, near=0.2)
sonars.update("front", 0.42)
sonars.update(left=0.15, right=None)
sonars
"""
EMPTY = """
from robowidgets import SonarWidget
empty = SonarWidget(title="/sonar")
empty
"""
ALARMS = """
import threading, time
from robowidgets import SonarWidget
alarms = SonarWidget(title="/sonar", poses={"front": 0, "left": "60deg", "right": "-60deg"})
alive = ["front", "right"]
def run():
    began = time.monotonic()
    while alive:
        names = ["front", "left", "right"] if time.monotonic() - began < 1 else list(alive)
        alarms.update({name: 0.21 if name == "left" else 0.5 for name in names})
        time.sleep(0.05)
threading.Thread(target=run, daemon=True).start()
alarms
"""
