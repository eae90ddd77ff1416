"""The wires of a robot on the page: boxes and wires, what they say, folding, filtering, freezing, and who looks."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .plain_page import PlainPage

OPEN = """
from robowidgets import LaserWidget, conditions, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)
laser = LaserWidget()
robot.connect("/scan", laser)
laser.watch(conditions.nearest_below(0.5), "near")

def ahead(scan):
    return scan.distance("front")

robot.connect("/scan", ahead)

@robot.program(rate=20)
def avoid(scan):
    return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

wires = robot.wires()
wires
"""
SCRIPTED = """
from robowidgets.feeds import Advert, Feed
from tests.unit.feeds.scripted import Scripted

def advert(name, publishers, subscribers=(), kind="std_msgs/msg/Float64"):
    return Advert(name, kind, bool(publishers), bool(subscribers), tuple(publishers), tuple(subscribers))

topics = [
    advert("/scan", ["/lidar"], ["/amcl", "/nav/costmap", "/slam"], "sensor_msgs/msg/LaserScan"),
    advert("/odom", ["/base"], ["/amcl", "/nav/planner"], "nav_msgs/msg/Odometry"),
    advert("/cmd_vel", ["/nav/controller"], ["/base"], "geometry_msgs/msg/Twist"),
    advert("/rosout", ["/lidar", "/base", "/amcl"], [], "rcl_interfaces/msg/Log"),
    advert("/parameter_events", ["/lidar"], ["/lidar"], "rcl_interfaces/msg/ParameterEvent"),
    advert("/nav/plan", ["/nav/planner"], ["/nav/controller"], "nav_msgs/msg/Path"),
    advert("/map", ["/slam"], ["/nav/costmap"], "nav_msgs/msg/OccupancyGrid"),
    advert("/goal", [], ["/nav/planner"], "geometry_msgs/msg/PoseStamped"),
]
script = Scripted(*topics)
robot = Feed(script)
wires = robot.wires()
wires
"""
MANY = """
script.listener.on_topics([
    *topics,
    *(advert(f"/camera/{i}/image", ["/camera/driver"], ["/detector"]) for i in range(60)),
    *(advert(f"/arm/joint_{i}/state", [f"/arm/motor_{i}"], ["/arm/controller"]) for i in range(80)),
    *(advert(f"/extra_{i}", ["/base"], ["/nav/monitor"]) for i in range(9)),
])
"""


def box(widget: Locator, name: str) -> Locator:
    return widget.locator(".rw-wire-box").filter(has=widget.page.get_by_text(name, exact=True))


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_it_shows_nodes_topics_and_the_notebooks_own_part(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([OPEN], width=760, scale=scale)
    nb.theme(theme)  # type: ignore[arg-type]
    widget = nb.widget(0)
    expect(box(widget, "/simulated_robot")).to_be_visible()
    expect(box(widget, "/scan")).to_contain_text(re.compile(r"\d+\.\d Hz"))
    expect(box(widget, "/scan")).to_contain_text("nearest 0.")
    expect(box(widget, "avoid")).to_contain_text("gave 0.2 m/s, 0 rad/s")
    expect(box(widget, "ahead")).to_contain_text("got nearest")
    expect(box(widget, "near")).to_contain_text("gave false")
    expect(box(widget, "speeds")).to_contain_text("0.2 m/s, 0 rad/s")
    expect(widget.locator("svg g")).to_have_count(10)
    shoot(widget, f"wires-{theme}")
    box(widget, "/scan").hover()
    expect(box(widget, "avoid")).to_have_attribute("data-near", "true")
    expect(box(widget, "/odom")).to_have_attribute("data-near", "false")
    expect(widget.locator(".rw-wires-foot")).to_contain_text("here to ahead")
    shoot(widget, f"wires-pointed-{theme}")
    nb.resize(400)
    shoot(widget, f"wires-narrow-{theme}")
    nb.resize(1280)
    shoot(widget, f"wires-wide-{theme}")


def test_scripted(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCRIPTED], width=760)
    widget = nb.widget(0)
    expect(box(widget, "/lidar")).to_be_visible()
    shoot(widget, "wires-robot")
    nb.python(MANY)
    expect(box(widget, "/camera/…")).to_be_visible()
    shoot(widget, "wires-many")
    nb.python("script.listener.on_topics([advert(f'/t/{i}', []) for i in range(30)])")
    expect(widget.locator(".rw-facts")).to_have_text("30 topics")
    shoot(widget, "wires-alone")
    assert wait_for
