"""Pictures of the widgets, at scale 1 and 2, light and dark, narrow and wide: to be opened and judged."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest

from .chromium import LOOKS, shoot
from .plain_page import PlainPage

TILT = """
import robowidgets
from rosbags.highlevel import AnyReader
from pathlib import Path
with AnyReader([Path({path!r})]) as reader:
    c = [c for c in reader.connections if c.msgtype.endswith("LaserScan")][:1]
    scans = [reader.deserialize(raw, con.msgtype) for con, _, raw in reader.messages(c)]
    topic = c[0].topic
scan = scans[{index}]
laser = robowidgets.LaserWidget(title=topic)
laser.update(scan)
laser
"""


@pytest.mark.parametrize("file", ["tilt_laser.bag", "turtlebot3_gazebo.bag", "hokuyo_people.bag"])
@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_laser(plain_page: Callable[..., PlainPage], data: Path, file: str, theme: str, scale: int) -> None:
    nb = plain_page([TILT.format(path=str(data / "good" / file), index=3)], scale=scale, theme=theme)
    card = nb.widget(0).locator(".rw-card")
    stem = file.split(".")[0]
    for width in (320, 700, 1200):
        nb.resize(width)
        shoot(card, f"laser-{stem}-{theme}-{width}")
    nb.resize(700)
    nb.python("laser.view_range = 'data'; laser.pinned = 600 if len(laser.scan) > 600 else 30")
    card.locator(".rw-freeze").click()
    nb.python("laser.update(scan)")
    card.locator(".rw-number", has_text="1").wait_for()
    shoot(card, f"laser-{stem}-{theme}-pinned")


STATES = """
import numpy as np, robowidgets
def widget(title, ranges, **more):
    laser = robowidgets.LaserWidget(title=title, **more)
    laser.update(ranges=ranges, angle_min=-np.pi / 2, angle_increment=np.pi / 180, range_min=0.12, range_max=3.5,
                 header={"frame_id": "laser"}, angle_max=np.pi / 2 + np.pi / 180,
                 intensities=np.linspace(0, 900, len(ranges)))
    return laser
mixed = np.full(181, 2.0)
mixed[20:50], mixed[60:75], mixed[80:90], mixed[100:110] = np.inf, -np.inf, np.nan, 0.05
waiting = robowidgets.LaserWidget(title="/scan")
nothing = widget("/scan", np.full(181, np.inf))
zeros = widget("/scan", np.zeros(181))
classes = widget("<b>/scan</b>", mixed)
classes.pinned = 25
colored = widget("/scan", mixed, color_by_intensity=True, view_range=1.5)
refused = widget("/scan", mixed, forward="right")
try:
    refused.update({"linear": 1})
except TypeError:
    pass
"""


def test_laser_states(plain_page: Callable[..., PlainPage]) -> None:
    names = ["waiting", "nothing", "zeros", "classes", "colored", "refused"]
    nb = plain_page([STATES, *names], scale=2)
    nb.resize(600)
    for i, name in enumerate(names, 1):
        shoot(nb.widget(i).locator(".rw-card"), f"laser-state-{name}")
