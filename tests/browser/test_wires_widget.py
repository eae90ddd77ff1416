"""The wires of a robot on the page: boxes and wires, texts, folding, filtering, freezing, and which pages look."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .laser import eventually
from .notebook import Notebook
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

view = robot.wires()
wires = view.wires
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
view = robot.wires()
wires = view.wires
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


@pytest.mark.core
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


def test_much_is_folded_unfolded_filtered_and_zoomed_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCRIPTED], width=1000)
    widget = nb.widget(0)
    expect(box(widget, "/lidar")).to_be_visible()
    expect(widget.locator(".rw-wires-plumbing")).to_have_text("Infrastructure 2")
    shoot(widget, "wires-robot")
    nb.python(MANY)
    expect(box(widget, "/camera/\u2026")).to_contain_text("60")
    expect(widget.locator(".rw-facts")).to_have_text("91 nodes ·\u00a0157 topics")
    shoot(widget, "wires-many")
    with nb.busy():
        box(widget, "/camera/\u2026").click()
        expect(widget.locator(".rw-wires-foot")).to_contain_text("/camera/0/image, /camera/1/image")
        widget.get_by_role("button", name="Unfold").click()
        expect(box(widget, "/camera/59/image")).to_have_count(1)
        widget.locator(".rw-wires-filter").fill("IMAGE")
        expect(box(widget, "/scan")).to_have_count(0)
        expect(box(widget, "/detector")).to_have_count(1)
        widget.locator(".rw-wires-filter").fill("scan")
        expect(box(widget, "/camera/59/image")).to_have_count(0)
        expect(widget.locator(".rw-wire-box")).to_have_count(5)
        expect(widget.locator(".rw-wires-foot")).to_contain_text("the filter leaves out")
        shoot(widget, "wires-filtered")
        widget.locator(".rw-wires-filter").press("Escape")
        expect(box(widget, "/cmd_vel")).to_have_count(1)
        widget.locator(".rw-wires-plumbing").click()
        expect(box(widget, "/rosout")).to_have_count(1)
        board = widget.locator(".rw-wires-board")
        before = board.evaluate("board => board.style.transform")
        widget.get_by_role("button", name="Zoom in").click()
        eventually(lambda: board.evaluate("board => board.style.transform") != before, True)
        widget.locator(".rw-wires-fit").click()
        expect(box(widget, "/lidar")).to_be_visible()
    wait_for(lambda: nb.python("wires.filter, wires.infrastructure, wires.unfolded") == FOLDED, "Python knows")


FOLDED = "('', True, ['topics /camera'])"


def test_frozen_values_stay_while_others_come_and_the_robots_widgets_freeze_too(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN, "laser"], width=760)
    widget, laser = nb.widget(0), nb.widget(1)
    expect(box(widget, "avoid")).to_contain_text("gave")
    with nb.busy():
        widget.locator(".rw-freeze").click()
        expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
        runs = box(widget, "avoid").locator(".rw-wire-fact").text_content()
        expect(widget.locator(".rw-freeze")).not_to_contain_text("· 0 since")
        assert box(widget, "avoid").locator(".rw-wire-fact").text_content() == runs
        widget.locator(".rw-freeze").click()
        expect(box(widget, "avoid").locator(".rw-wire-fact")).not_to_have_text(runs or "")


def test_keys_walk_from_box_to_box_and_a_screen_reader_reads_the_picked_one(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN], width=1180)
    widget = nb.widget(0)
    expect(box(widget, "avoid")).to_contain_text("gave")
    box(widget, "/simulated_robot").focus()
    box(widget, "/simulated_robot").press("ArrowRight")
    focused = widget.locator(".rw-wire-box:focus")
    expect(focused).to_have_attribute("aria-label", re.compile("^topic /"))
    expect(widget.locator(".rw-wire-box[tabindex='0']")).to_have_count(1)
    box(widget, "/scan").focus()
    box(widget, "/scan").press("Enter")
    expect(box(widget, "/scan")).to_have_attribute("aria-pressed", "true")
    expect(widget.locator(".rw-live")).to_contain_text("topic /scan, sensor_msgs/msg/LaserScan")
    box(widget, "/scan").press("Escape")
    expect(box(widget, "/scan")).to_have_attribute("aria-pressed", "false")
    box(widget, "/scan").press("/")
    expect(widget.locator(".rw-wires-filter")).to_be_focused()


LOOKS_AT = "print(sorted(script.followed), script.asks_for_nodes)"


def test_the_robot_is_asked_nothing_while_the_picture_is_out_of_view(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCRIPTED], width=760)
    widget = nb.widget(0)
    expect(box(widget, "/lidar")).to_be_visible()
    wait_for(lambda: nb.python(LOOKS_AT).strip() == "['/cmd_vel', '/nav/plan', '/odom', '/scan'] True", "it listens")
    nb.page.evaluate("() => { document.body.style.paddingTop = '5000px'; }")
    wait_for(lambda: nb.python(LOOKS_AT).strip() == "[] False", "it does not, below the window")
    nb.page.evaluate("() => { document.body.style.paddingTop = ''; }")
    wait_for(lambda: nb.python(LOOKS_AT).strip().endswith("True"), "it does again")
    box(widget, "/map").click()
    widget.locator(".rw-wires-act", has_text="Message").click()
    wait_for(lambda: nb.python("print(*view.messages)").strip() == "/map", "it is opened")
    nb.python("robot.close()")
    wait_for(lambda: nb.python(LOOKS_AT).strip().endswith("False"), "a closed feed listens to nothing")


def test_names_and_messages_are_text_and_topics_alone_stand_in_rows(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SCRIPTED], width=760)
    widget = nb.widget(0)
    hostile = "/<img src=x onerror=document.title='bad'>"
    nb.python(f"more = [Advert(f'/t/{{i}}', '') for i in range(30)]\nhostile = Advert({hostile!r}, 'a/msg/<b>B</b>')")
    nb.python("script.listener.on_topics([hostile, *more])")
    expect(box(widget, hostile)).to_have_count(1)
    nb.python(f"script.listener.on_message({hostile!r}, {{'data': '<b>hello</b>'}})")
    expect(box(widget, hostile)).to_contain_text('"<b>hello</b>"')
    expect(widget.locator(".rw-wires-foot")).to_contain_text("the robot does not report nodes, only topics")
    expect(widget.locator("img, b b")).to_have_count(0)
    assert nb.page.title() != "bad"
    shoot(widget, "wires-alone")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_button_of_the_list_shows_the_wires_below_the_rest_and_they_open_messages(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    opens = "from robowidgets import feeds; robot = feeds.simulator(wander=False)"
    nb = plain_page([opens, "(view := robot.show('/scan', '/bumper'))"], theme=theme, scale=scale)
    nb.resize(1264, 720)
    shown = nb.output(1)
    expect(shown.locator(".rw-laser .rw-title")).to_have_text("/scan")
    shown.locator(".rw-topics-rail").click()
    button, wires = shown.get_by_role("button", name="Show who publishes"), shown.locator(".rw-wires")
    button.click()
    odom = box(wires, "/odom")
    expect(odom).to_be_visible()
    above, below = shown.locator(".rw-screen").bounding_box(), wires.bounding_box()
    assert above is not None
    assert below is not None
    assert above["y"] + above["height"] <= below["y"]
    shoot(shown, f"topics-wires-{theme}")
    odom.click()
    wires.locator(".rw-wires-act").click()
    expect(shown.locator(".rw-screen .rw-message .rw-title")).to_have_text("/odom")
    shoot(shown, f"topics-wires-message-{theme}")
    shown.get_by_role("button", name="Show the wires no more").click()
    expect(wires).to_have_count(0)
    expect(shown.locator(".rw-screen .rw-message .rw-title")).to_have_text("/odom")


def test_in_jupyterlab_the_messages_of_a_picked_topic_open_below_and_follow(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN.rsplit("wires\n", 1)[0] + "view"], width=1280)
    wires, message = nb.page.locator(".rw-wires"), nb.page.locator(".rw-message")
    expect(box(wires, "avoid")).to_contain_text("gave")
    box(wires, "/odom").click()
    wires.locator(".rw-wires-act").click()
    expect(message.locator(".rw-title")).to_have_text("/odom")
    expect(message).to_contain_text("linear")
    expect(box(wires, "MessageWidget")).to_have_count(1)
    shoot(nb.output(0), "wires-message")
    wires.locator(".rw-wires-act").click()
    expect(message).to_have_count(0)
    expect(box(wires, "MessageWidget")).to_have_count(0)
