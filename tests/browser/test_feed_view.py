"""The view of a feed: one screen with Stop, the room, the laser, the program, its machine, speeds and touches."""

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

ROBOT = """
from robowidgets import feeds
from robowidgets.behaviors import Drive

robot = feeds.simulator({robot!r}, wander=False)
robot.variables.slider("f_vel", 0.2, 0.0, 0.5, "m/s")
robot.variables.slider("near", 0.5, 0.2, 2.0, "m")

class SimpleAvoid:
    obstacle = lambda scan, variables: scan.distance("front") < variables.near
    free = lambda scan, variables: scan.distance("front") > variables.near + 0.2

    def forward(variables):
        return Drive(variables.f_vel)

    class avoid:
        def stop():
            print("near")
            return Drive()

        def turn():
            return Drive(0, 0.5)

        moves = "stop -> turn after 0.4"

    moves = "forward -> avoid on obstacle", "avoid -> forward on free"
"""
SHOW = "view = robot.show()\nview"
RUN = "robot.program(SimpleAvoid, rate=20)"
BOXES = """() => Object.fromEntries([...document.querySelectorAll(
    ".rw-feed, .rw-feed .rw-card:not(.rw-topics)")].map((element) => {
    const { x, y, width, height } = element.getBoundingClientRect();
    return [/rw-(feed|stop-bar|simulator|laser|program|machine|lines|speed|touch|path)\\b/.exec(element.className)[1],
        { x, y, width, height, right: x + width, bottom: y + height }];
}))"""
COVERED = """(cards) => cards.flatMap((card) => {
    const { left, top, width, height } = card.getBoundingClientRect();
    const seen = (x, y) => card.contains(document.elementFromPoint(left + x * width, top + y * height));
    return [[0.04, 0.12], [0.5, 0.5], [0.96, 0.88]].every(([x, y]) => seen(x, y)) ? [] : [card.className];
})"""
"""Return the cards that are partly outside the window or under another card."""
LINES = 46
"""Height in pixels of the lines of the program, folded to one line, below the screen."""
CUT = """(cards) => cards.filter((card) => card.scrollWidth > card.clientWidth + 1).map((card) => card.className)"""

IS_WHOLE = """(element) => {
    const range = document.createRange();
    range.selectNodeContents(element);
    const [text, { left, right }] = [range.getBoundingClientRect(), element.getBoundingClientRect()];
    const card = element.closest(".rw-card").getBoundingClientRect();
    return text.width > 0 && text.left >= left - 0.5 && text.right <= right + 0.5 && right <= card.right;
}"""


def boxes(nb: Notebook | PlainPage) -> dict[str, dict[str, float]]:
    found: dict[str, dict[str, float]] = nb.page.evaluate(BOXES)
    return found


def opened(plain_page: Callable[..., PlainPage], robot: str, **more: object) -> PlainPage:
    nb = plain_page([ROBOT.format(robot=robot), RUN, SHOW], height=720, **more)
    expect(nb.output(2).locator(".rw-machine-state[data-active='leaf']")).to_be_visible()
    expect(nb.output(2).locator(".rw-tile").first).to_be_visible()
    return nb


@pytest.mark.parametrize("robot", ["turtlebot3", "kobuki"])
def test_a_robot_with_a_program_and_its_machine_stands_on_one_screen(
    plain_page: Callable[..., PlainPage], robot: str
) -> None:
    nb = opened(plain_page, robot)
    nb.python(
        "robot.variables.f_vel = 0.0"
    )  # at the wall, the machine unfolds a state, and becomes smaller to make room
    cards = nb.output(2).locator(".rw-card")
    for width in (1112, 900):
        nb.resize(width, 720)
        eventually(lambda: cards.evaluate_all(CUT), [])
        at = boxes(nb)
        assert at["feed"]["height"] == 562 + LINES
        assert at["feed"]["width"] == width
        bar, room, laser = (at[name] for name in ("stop-bar", "simulator", "laser"))
        assert bar["y"] == room["y"] == at["feed"]["y"]
        assert bar["right"] < room["x"]
        assert room["bottom"] < laser["y"]
        assert laser["height"] > 320
        for name in ("program", "machine"):
            assert bar["bottom"] < at[name]["y"]
            assert at[name]["height"] > 290
            assert at[name]["bottom"] < at["speed"]["y"], "what it has no room for scrolls"
        for name in ("speed", "touch"):
            assert at[name]["height"] in (150, 188)
            assert at[name]["bottom"] == laser["bottom"] < at["lines"]["y"]
        tiles = nb.output(2).locator(".rw-touch > .rw-picture")
        assert tiles.evaluate("tiles => tiles.scrollHeight <= tiles.clientHeight"), "all sensors are in view"
        expect(nb.output(2).locator(".rw-speed [data-axis] .rw-value")).to_have_count(3)
        expect(nb.output(2).locator(".rw-screen .rw-freeze:visible")).to_have_count(0)
        names = nb.output(2).locator(".rw-machine-state-name")
        assert names.evaluate_all("names => names.every((name) => name.getBoundingClientRect().height > 13)")
        hint = nb.output(2).locator(".rw-stop-bar .rw-hint")
        expect(hint).to_have_css("display", "block")  # no rule of another widget applies to it
        shoot(nb.output(2), f"feed-{robot}-{width}-light")
    nb.resize(1500, 900)
    assert boxes(nb)["feed"]["height"] == 742
    shoot(nb.output(2), f"feed-{robot}-1500-light")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_in_narrow_cells_nothing_is_cut_and_stop_comes_first(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = opened(plain_page, "turtlebot3", theme=theme, scale=scale)
    for width in (799, 600, 400, 320):
        nb.resize(width, 720)
        at = boxes(nb)
        assert at["feed"]["width"] == width
        # Cards out of sight are drawn a little later.
        eventually(lambda: nb.output(2).locator(".rw-card").evaluate_all(CUT), [])
        assert all(box["right"] <= at["feed"]["right"] for box in at.values())
        tops = [at[name]["y"] for name in ("feed", "simulator", "laser", "program", "machine", "speed", "touch")]
        assert tops == sorted(tops)
        if width >= 600:
            assert at["simulator"]["y"] == at["laser"]["y"], "two stand side by side"
            assert at["program"]["y"] == at["machine"]["y"]
        shoot(nb.output(2), f"feed-{width}-{theme}")
    nb.page.mouse.move(200, 400)
    nb.page.mouse.wheel(0, 900)
    nb.page.wait_for_function("() => scrollY >= 800")
    assert nb.output(2).locator(".rw-stop-bar .rw-stop").evaluate_all(COVERED) == [], "Stop stays in view"


def test_the_state_of_a_program_is_whole_at_any_width(plain_page: Callable[..., PlainPage]) -> None:
    nb = opened(plain_page, "turtlebot3")
    mode = nb.output(2).locator(".rw-program-mode")
    codes = {"running": "pass", "stopped": "robot.stopped = True"}
    for state, code in codes.items():
        nb.python(code)
        expect(mode).to_have_text(state)
        for width in (1112, 808, 360, 280):
            nb.resize(width, 720)
            assert mode.evaluate(IS_WHOLE), f"{state} at {width} px"


@pytest.mark.core
def test_one_freeze_freezes_all_pictures_of_the_view_during_a_busy_cell(plain_page: Callable[..., PlainPage]) -> None:
    nb = opened(plain_page, "turtlebot3")
    nb.resize(1112, 720)
    freeze, cards = nb.output(2).locator(".rw-freeze-all"), nb.output(2).locator(".rw-frozen")
    expect(freeze).to_have_text("Freeze")
    with nb.busy():
        freeze.click()
        expect(cards).to_have_count(6)
        expect(freeze).to_have_text("Frozen")
        expect(freeze).to_have_attribute("aria-pressed", "true")
        shoot(nb.output(2), "feed-frozen")
        freeze.click()
        expect(cards).to_have_count(0)
        expect(freeze).to_have_attribute("aria-pressed", "false")
        nb.output(2).locator(".rw-laser > .rw-picture").press(" ")
        expect(freeze).to_have_text("Frozen")
        freeze.click()
        expect(cards).to_have_count(0)
    nb.python("view.widgets['/odom'].paused = True")
    expect(cards).to_have_count(6)
    expect(freeze).to_have_text("Frozen")
    nb.python("view.widgets['/odom'].paused = False")
    expect(freeze).to_have_text("Freeze")


def test_the_room_is_frozen_with_the_view_and_goes_on_by_a_press_on_it_before_it_is_dragged(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = opened(plain_page, "turtlebot3")
    nb.resize(1112, 720)
    freeze, room = nb.output(2).locator(".rw-freeze-all"), nb.output(2).locator(".rw-simulator")
    expect(room.locator(".rw-footer")).to_contain_text("drag the robot")
    time = room.locator(".rw-facts")
    seconds = "robot.robot.time"
    freeze.click()
    expect(room).to_have_class(re.compile("rw-frozen"))
    expect(room.locator(".rw-silence")).to_have_text("frozen · press to go on")
    expect(room.locator(".rw-silence")).to_be_visible()
    expect(room.get_by_role("button", name="Put an obstacle")).to_be_disabled()
    assert nb.python("view.room.paused") == "True"
    shown = drawn(room), time.inner_text()
    began = float(nb.python(seconds))
    wait_for(lambda: float(nb.python(seconds)) > began + 1, "the robot goes on")
    assert (drawn(room), time.inner_text()) == shown
    shoot(room, "room-frozen")
    room.locator(".rw-picture").click()
    expect(room).not_to_have_class(re.compile("rw-frozen"))
    expect(time).not_to_have_text(shown[1])
    expect(freeze).to_have_text("Frozen")
    room.locator(".rw-picture").press(" ")
    expect(room).to_have_class(re.compile("rw-frozen"))
    freeze.click()
    expect(nb.output(2).locator(".rw-frozen")).to_have_count(0)
    nb.python("view.widgets['/odom'].paused = True")
    expect(room).to_have_class(re.compile("rw-frozen"))


def drawn(room: Locator) -> str:
    """The picture of a room."""
    return str(room.locator("canvas").first.evaluate("canvas => canvas.toDataURL()"))


def test_in_jupyterlab_all_of_it_is_in_view_at_1280_by_720_and_in_a_narrow_window_stop_stays_in_view(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([ROBOT.format(robot="turtlebot3"), SHOW, RUN], width=1280, height=720)
    feed = nb.output(1).locator(".rw-feed")
    expect(feed.locator(".rw-machine-state[data-active='leaf']")).to_be_visible()
    feed.evaluate("feed => feed.scrollIntoView()")
    assert boxes(nb)["feed"]["height"] == 562 + LINES
    cards = feed.locator(".rw-card:not(.rw-lines)")  # the lines of the program stand below
    expect(cards).to_have_count(8)
    assert cards.evaluate_all(COVERED) == []
    shoot(nb.page.locator(".jp-NotebookPanel"), "feed-lab")
    feed.locator(".rw-freeze-all").click()
    expect(feed.locator(".rw-frozen")).to_have_count(6)
    nb.reload()
    feed = nb.output(1).locator(".rw-feed")
    expect(feed.locator(".rw-freeze-all")).to_have_text("Frozen")
    feed.locator(".rw-freeze-all").click()
    expect(feed.locator(".rw-frozen")).to_have_count(0)
    nb.resize(500, 720)
    feed.locator(".rw-touch").scroll_into_view_if_needed()
    notebook_at, stop_at = (
        shown.bounding_box() for shown in (nb.page.locator(".jp-WindowedPanel-outer"), feed.locator(".rw-stop").first)
    )
    assert notebook_at is not None
    assert stop_at is not None
    assert 0 <= stop_at["y"] - notebook_at["y"] < 20, "Stop stays at the top of the notebook"


@pytest.mark.parametrize("width", [376, 848, 1280])
def test_the_list_of_topics_neither_moves_nor_covers_stop(plain_page: Callable[..., PlainPage], width: int) -> None:
    nb = plain_page([ROBOT.format(robot="turtlebot3"), RUN, SHOW], height=720)
    nb.resize(width, 720)
    shown = nb.output(2)
    stop, bar, listed = (shown.locator(one) for one in (".rw-stop-bar .rw-stop", ".rw-stop-bar", ".rw-topics"))
    expect(shown.locator(".rw-topics-rail")).to_be_visible()
    before = stop.bounding_box()
    shown.locator(".rw-topics-rail").click()
    expect(shown.locator(".rw-topics-fold")).to_be_visible()
    assert stop.bounding_box() == before
    over, below = bar.bounding_box(), listed.bounding_box()
    assert over
    assert below
    assert below["y"] >= over["y"] + over["height"], "it stands below all of the bar"
    assert stop.evaluate_all(COVERED) == []
    shown.locator(".rw-topics-fold").click()
    expect(shown.locator(".rw-topics-rail")).to_be_visible()
    assert stop.bounding_box() == before
