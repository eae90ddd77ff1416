"""The drive pad on a page, and the speeds that reach the robot."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import pairwise
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from robowidgets.driving import command_watchdog, press

from ..patience import PATIENT
from .chromium import shoot
from .notebook import Notebook
from .plain_page import PlainPage

PAD = """
import threading, time
from robowidgets import DriveWidget
heard, moves = [], threading.Event()
def send(linear, angular):
    heard.append((time.monotonic(), round(linear, 2), round(angular, 2)))
    if linear or angular:
        moves.set()
pad = DriveWidget(send=send, title="/cmd_vel", linear_limit=0.4)
pad
"""
BUSY = """
import pathlib, time
while not pathlib.Path({stop!r}).exists():
    {body}
"""
SPEEDS = "[speed for _, *speed in heard]"


def pad_of(nb: Notebook | PlainPage, cell: int = 0) -> Locator:
    return nb.widget(cell).locator(".rw-pad")


UNHURRIED = """
import robowidgets.driving.command_watchdog as watchdog, robowidgets.driving.press as press
watchdog.HOLD = press.HOLD = 10
watchdog.CommandWatchdog.drive.__defaults__ = (10, *watchdog.CommandWatchdog.drive.__defaults__[1:])
"""


@pytest.fixture(autouse=True)
def hurried(monkeypatch: pytest.MonkeyPatch) -> None:
    """Restore after each test what `unhurried` changes in this process, on a plain page."""
    monkeypatch.setattr(command_watchdog, "HOLD", command_watchdog.HOLD)
    monkeypatch.setattr(press, "HOLD", press.HOLD)
    drive = command_watchdog.CommandWatchdog.drive
    monkeypatch.setattr(drive, "__defaults__", drive.__defaults__)


def unhurried(nb: Notebook | PlainPage) -> None:
    """Make page and kernel wait ten seconds for each other instead of half a second: the machine may be busy."""
    nb.python(UNHURRIED)
    nb.page.evaluate("window.driver.slowDown(20)")


def says(nb: Notebook | PlainPage, words: str, cell: int = 0) -> None:
    expect(nb.widget(cell).locator(".rw-words")).to_have_text(words)


def numbers(nb: Notebook | PlainPage, *speeds: str) -> None:
    expect(nb.widget(0).locator(".rw-readout:visible .rw-readout-value")).to_have_text(speeds)


def heard(nb: Notebook | PlainPage) -> list[list[float]]:
    """The speeds that the robot received, without repeats."""
    speeds: list[list[float]] = eval(nb.python(SPEEDS))
    return [speed for i, speed in enumerate(speeds) if i == 0 or speed != speeds[i - 1]]


def grab(nb: Notebook | PlainPage, right: float, below: float) -> None:
    """Press the pointer on the middle of the pad and drag it to shares of half its size."""
    drag(nb, 0, 0)
    nb.page.mouse.down()
    drag(nb, right, below)


def drag(nb: Notebook | PlainPage, right: float, below: float) -> None:
    """Move the pointer to a place on the pad: shares of half its size from the middle."""
    box: Any = pad_of(nb).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
    nb.page.mouse.move(x + right * box["width"] / 2, y + below * box["height"] / 2)


LEAVE = {
    "focus": "document.activeElement.blur()",
    "window": "window.dispatchEvent(new Event('blur'))",
    "hidden": """Object.defineProperty(document, 'hidden', { value: true, configurable: true });
        document.dispatchEvent(new Event('visibilitychange')); delete document.hidden""",
}


@pytest.mark.core
def test_the_knob_drives_ahead_and_to_the_left_until_it_is_let_go(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PAD])
    unhurried(nb)
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00")
    grab(nb, 0, -1.5)
    says(nb, "driving")
    numbers(nb, "0.40", "0.00")
    grab(nb, -2, 0)
    numbers(nb, "0.00", "1.00")
    grab(nb, 2, 2)
    numbers(nb, "\u22120.40", "\u22121.00")
    nb.page.mouse.up()
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00")
    assert nb.python("heard[-1][1:]") == "(0.0, 0.0)"
    assert [0.4, 0.0] in heard(nb)


def test_keys_drive_until_one_looks_away(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PAD])
    unhurried(nb)
    pad_of(nb).focus()
    nb.page.keyboard.down("w")
    numbers(nb, "0.40", "0.00")
    nb.page.keyboard.down("ArrowLeft")
    numbers(nb, "0.40", "1.00")
    nb.page.keyboard.up("w")
    numbers(nb, "0.00", "1.00")
    nb.page.keyboard.down("d")
    numbers(nb, "0.00", "0.00")
    says(nb, "driving")
    nb.page.keyboard.up("ArrowLeft")
    nb.page.keyboard.up("d")
    says(nb, "stopped")
    nb.page.keyboard.down("ArrowDown")
    numbers(nb, "\u22120.40", "0.00")
    nb.page.keyboard.press(" ")
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00")
    nb.page.keyboard.up("ArrowDown")

    for way in LEAVE.values():
        pad_of(nb).focus()
        nb.page.keyboard.down("ArrowUp")
        numbers(nb, "0.40", "0.00")
        nb.page.evaluate(f"() => {{ {way} }}")
        says(nb, "stopped")
        numbers(nb, "0.00", "0.00")
        nb.page.keyboard.down("ArrowUp")  # held down, it repeats
        nb.python("heard.clear()")
        says(nb, "stopped")
        assert heard(nb) == [], way
        nb.page.keyboard.up("ArrowUp")


def test_the_notebook_does_not_see_the_keys_of_a_pad(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([PAD, "1"])
    unhurried(nb)
    pad_of(nb).focus()
    for key in ("x", "a", "b", "w", "d", "ArrowDown"):
        nb.page.keyboard.down(key)
        nb.page.keyboard.up(key)
    assert nb.kinds == ["code", "code"]
    nb.page.keyboard.down("ArrowUp")
    numbers(nb, "0.40", "0.00")
    nb.page.keyboard.up("ArrowUp")
    says(nb, "stopped")


def test_a_finger_drives_and_a_cancelled_touch_stops(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PAD], touch=True)
    unhurried(nb)
    box: Any = pad_of(nb).bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + 5
    session = nb.page.context.new_cdp_session(nb.page)
    touch = {"touchPoints": [{"x": x, "y": y}]}
    session.send("Input.dispatchTouchEvent", {"type": "touchStart", **touch})
    numbers(nb, "0.40", "0.00")
    touch["touchPoints"][0]["y"] += box["height"]
    session.send("Input.dispatchTouchEvent", {"type": "touchMove", **touch})
    numbers(nb, "\u22120.40", "0.00")
    session.send("Input.dispatchTouchEvent", {"type": "touchCancel", "touchPoints": []})
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00")


SIDEWAYS = """
from robowidgets import DriveWidget
heard = []
def send(linear, angular, lateral):
    heard.append((0, round(linear, 2), round(angular, 2), round(lateral, 2)))
pad = DriveWidget(send=send, title="pr2 /cmd_vel", linear_limit=0.4, lateral_limit=0.3)
pad
"""


def test_of_a_robot_that_moves_sideways_a_second_knob_and_two_keys_do_so(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SIDEWAYS])
    unhurried(nb)
    numbers(nb, "0.00", "0.00", "0.00")
    box: Any = nb.widget(0).locator(".rw-slide").bounding_box()
    nb.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    nb.page.mouse.down()
    nb.page.mouse.move(box["x"], box["y"] + 3 * box["height"])
    says(nb, "driving")
    numbers(nb, "0.00", "0.00", "0.30")
    shoot(nb.widget(0), "drive-sideways")
    nb.page.mouse.up()
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00", "0.00")
    pad_of(nb).focus()
    nb.page.keyboard.down("e")
    numbers(nb, "0.00", "0.00", "\u22120.30")
    nb.page.keyboard.down("w")
    numbers(nb, "0.40", "0.00", "\u22120.30")
    nb.page.keyboard.up("e")
    numbers(nb, "0.40", "0.00", "0.00")
    nb.page.keyboard.up("w")
    says(nb, "stopped")
    assert heard(nb)[-1] == [0.0, 0.0, 0.0]


def test_two_fingers_drive_by_two_knobs_and_each_lets_go_of_its_own(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SIDEWAYS], touch=True)
    unhurried(nb)
    pad, slide = pad_of(nb).bounding_box(), nb.widget(0).locator(".rw-slide").bounding_box()
    assert pad
    assert slide
    ahead = {"x": pad["x"] + pad["width"] / 2, "y": pad["y"] + 5, "id": 1}
    left = {"x": slide["x"] + 5, "y": slide["y"] + slide["height"] / 2, "id": 2}
    again = {"x": pad["x"] + pad["width"] / 2, "y": pad["y"] + pad["height"] - 5, "id": 3}
    session = nb.page.context.new_cdp_session(nb.page)

    def touch(act: str, *points: dict[str, float]) -> None:
        session.send("Input.dispatchTouchEvent", {"type": f"touch{act}", "touchPoints": list(points)})

    touch("Start", ahead)
    numbers(nb, "0.40", "0.00", "0.00")
    touch("Start", ahead, left)
    numbers(nb, "0.40", "0.00", "0.30")
    touch("Start", ahead, left, again)  # a second finger on the pad has no effect
    touch("Move", {**ahead, "y": pad["y"] + pad["height"]}, left, again)
    numbers(nb, "\u22120.40", "0.00", "0.30")
    touch("End", ahead)
    numbers(nb, "0.00", "0.00", "0.30")
    says(nb, "driving")
    touch("Cancel")
    says(nb, "stopped")
    numbers(nb, "0.00", "0.00", "0.00")


def test_a_feed_gives_the_pad_a_knob_for_sideways_where_its_robot_moves_so(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([FEED])
    unhurried(nb)
    slide = nb.widget(0).locator(".rw-slide")
    expect(slide).not_to_be_visible()
    pad_of(nb).focus()
    nb.page.keyboard.down("q")
    says(nb, "stopped")
    nb.page.keyboard.up("q")
    nb.python("pad.connect(feeds.simulator('pr2', wander=False))")
    expect(slide).to_be_visible()
    pad_of(nb).focus()
    nb.page.keyboard.down("q")
    numbers(nb, "0.00", "0.00", "0.50")
    nb.page.keyboard.up("q")


HANG = "() => setTimeout(() => { const end = Date.now() + 1500; while (Date.now() < end) continue; })"


def test_a_page_or_a_process_that_hangs_stops_the_robot_and_does_not_drive_on(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([PAD])
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    numbers(nb, "0.40", "0.00")
    nb.page.evaluate(HANG)
    says(nb, "no answer in time: stopped")
    numbers(nb, "0.00", "0.00")
    times = eval(nb.python("[(when, linear) for when, linear, _ in heard]"))
    stopped, last = next((at, before) for (before, _), (at, linear) in pairwise(times) if linear == 0)
    assert stopped - last > 0.2, "a speed holds from when it came"
    assert heard(nb) == [[0.4, 0.0], [0.0, 0.0]]
    nb.page.keyboard.up("ArrowUp")
    says(nb, "stopped")

    nb.page.keyboard.down("ArrowUp")
    numbers(nb, "0.40", "0.00")
    nb.python("import ctypes; ctypes.PyDLL(None).usleep(1_500_000)")
    says(nb, "no answer in time: stopped")
    numbers(nb, "0.00", "0.00")
    assert heard(nb) == 2 * [[0.4, 0.0], [0.0, 0.0]]


def test_a_busy_kernel_stops_it_and_what_waited_moves_nothing(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PAD])
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    numbers(nb, "0.40", "0.00")
    with nb.busy():
        numbers(nb, "0.00", "0.00")
        nb.page.keyboard.up("ArrowUp")
        pad_of(nb).focus()
        for _ in range(3):
            nb.page.keyboard.down("ArrowUp")
            says(nb, "asking the kernel")
            says(nb, "kernel busy: stopped")
            nb.page.keyboard.up("ArrowUp")
        nb.page.keyboard.down("ArrowUp")
        says(nb, "asking the kernel")
        says(nb, "kernel busy: stopped")
    says(nb, "no answer in time: stopped")
    assert heard(nb) == [[0.4, 0.0], [0.0, 0.0]]
    nb.page.keyboard.up("ArrowUp")
    says(nb, "stopped")
    nb.page.keyboard.down("ArrowUp")
    says(nb, "driving")
    numbers(nb, "0.40", "0.00")


def test_a_pad_whose_kernel_is_gone_says_so_and_a_new_one_drives(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([PAD])
    unhurried(nb)
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    says(nb, "driving")
    nb.restart_kernel()
    says(nb, "no kernel in this page")
    nb.page.keyboard.up("ArrowUp")
    nb.run_all()
    unhurried(nb)
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    says(nb, "driving")


PROGRAM = """
import threading, time
from robowidgets import DriveWidget, feeds
feed = feeds.simulator(wander=False)
heard, refused, runs = [], "", True
publish = feed.connection.middleware.publish
def record(topic, kind, message):
    publish(topic, kind, message)
    heard.append((time.monotonic(), message["linear"]["x"], message["angular"]["z"]))
feed.connection.middleware.publish = record
def program():
    global refused
    while runs:
        try:
            feed.drive(0.2, 0.5)
        except feeds.FeedError as error:
            refused = str(error)
        time.sleep(0.02)
threading.Thread(target=program, daemon=True).start()
pad = DriveWidget(linear_limit=0.4)
pad.connect(feed)
pad
"""


def test_during_a_busy_cell_a_hand_takes_over_from_a_program_and_lets_go_at_once(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([PATIENT + PROGRAM])
    unhurried(nb)
    says(nb, "a program drives")
    numbers(nb, "0.20", "0.50")
    for body in ("time.sleep(0.001)", "pass"):
        stop = nb.lab.files / f"drive-beside-{len(body)}"
        busy = nb.append(BUSY.format(stop=str(stop), body=body))
        nb.start(busy)
        pad_of(nb).focus()
        nb.page.keyboard.down("ArrowUp")
        says(nb, "driving")
        numbers(nb, "0.40", "0.00")
        nb.page.keyboard.up("ArrowUp")
        says(nb, "a program drives")
        numbers(nb, "0.20", "0.50")
        stop.touch()
        nb.wait(busy)
        assert nb.python("refused") == "'cannot drive: a hand drives from a pad, until it is released'", body
        commands = heard(nb)
        first = commands.index([0.4, 0.0])
        after = next(i for i, command in enumerate(commands) if i > first and command != [0.4, 0.0])
        # The program's next speed replaces zero if it comes before zero is sent.
        assert {tuple(speed) for speed in commands[after:]} - {(0.0, 0.0)} == {(0.2, 0.5)}, body
        nb.python("heard.clear(); refused = ''")


@pytest.fixture
def driven_page(plain_page: Callable[..., PlainPage], monkeypatch: pytest.MonkeyPatch) -> Iterator[PlainPage]:
    """A plain page with a pad of a robot that a program drives until the end of the test."""
    monkeypatch.setattr(command_watchdog, "STANDSTILL", 3600.0)
    nb = plain_page([PROGRAM])
    yield nb
    nb.namespace["runs"] = False


def test_a_kernel_that_does_not_answer_is_not_reported_to_have_stopped_a_program(driven_page: PlainPage) -> None:
    nb = driven_page
    says(nb, "a program drives")
    with nb.busy():
        pad_of(nb).focus()
        nb.page.keyboard.down("ArrowUp")
        says(nb, "kernel busy; a program drives")
        numbers(nb, "0.20", "0.50")
        nb.page.keyboard.up("ArrowUp")
        says(nb, "kernel busy; a program drives")
    says(nb, "a program drives")
    assert nb.python("refused") == "''"


def test_stop_on_the_pad_latches_until_driving_is_allowed(driven_page: PlainPage) -> None:
    nb = driven_page
    unhurried(nb)
    says(nb, "a program drives")
    stop, allow = nb.widget(0).locator(".rw-stop"), nb.widget(0).locator(".rw-allow")
    place = pad_of(nb).bounding_box()
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    says(nb, "driving")
    nb.page.keyboard.press("Escape")
    says(nb, "nobody may drive")
    numbers(nb, "0.00", "0.00")
    expect(stop).to_have_text("Stopped")
    nb.page.keyboard.up("ArrowUp")
    grab(nb, 0, -1)
    says(nb, "nobody may drive")
    nb.page.mouse.up()
    assert nb.python("feed.stopped, heard[-1][1:]") == "(True, (0.0, 0.0))"
    assert pad_of(nb).bounding_box() == place
    allow.click()
    says(nb, "a program drives")
    stop.dispatch_event("pointerdown", {"button": 0})
    says(nb, "nobody may drive")


def test_two_views_of_one_pad_give_way_to_the_newest_press(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PAD, "pad"])
    unhurried(nb)
    for cell in (0, 1):
        pad_of(nb, cell).dispatch_event("pointerdown", {"pointerId": 1, "button": 0})
    says(nb, "driving", 1)
    says(nb, "driven from another pad", 0)


def test_two_pads_of_one_robot_give_way_to_the_newest_press(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FEED, "two = DriveWidget()\ntwo.connect(feed)\ntwo"])
    unhurried(nb)
    for cell in (0, 1):
        pad_of(nb, cell).dispatch_event("pointerdown", {"pointerId": 1, "button": 0})
    says(nb, "driving", 1)
    says(nb, "driven from another pad", 0)


def test_what_is_wrong_is_reported(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(["from robowidgets import DriveWidget\npad = DriveWidget()\npad"])
    says(nb, "no feed")
    nb.python(
        "class Robot:\n    def drive(self, linear, angular):\n        raise OSError('no route to the <b>robot</b>')"
    )
    nb.python("pad.connect(Robot())")
    says(nb, "stopped")
    pad_of(nb).focus()
    nb.page.keyboard.down("ArrowUp")
    expect(nb.widget(0).locator(".rw-notice")).to_have_text(
        "The robot could not be driven: OSError: no route to the <b>robot</b>. Sending zero failed, too"
    )
    says(nb, "no route to the <b>robot</b>")
    shoot(nb.widget(0), "drive-failed")
    nb.page.keyboard.up("ArrowUp")
    says(nb, "stopped")
    nb.python("pad.enabled = False")
    says(nb, "switched off")


FEED = """
from robowidgets import DriveWidget, feeds
feed = feeds.simulator(wander=False)
feed.driving = feeds.Driving(max_linear=0.2)
pad = DriveWidget()
pad.connect(feed)
pad
"""


def test_of_a_feed_it_says_how_speeds_are_cut_without_moving_and_that_it_is_closed(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([FEED])
    unhurried(nb)
    notice = nb.widget(0).locator(".rw-notice")
    grab(nb, 0, -1)
    expect(notice).to_have_text("0.5 m/s is cut to 0.2")
    numbers(nb, "0.20", "0.00")
    place = pad_of(nb).bounding_box()
    drag(nb, 0, -0.2)
    expect(notice).not_to_be_visible()
    nb.page.mouse.up()
    says(nb, "stopped")
    assert pad_of(nb).bounding_box() == place
    nb.python("feed.close()")
    says(nb, "the feed is closed")
    expect(nb.widget(0).locator(".rw-hint")).to_have_text("open it and connect again")
    for _ in range(2):
        grab(nb, 0, -1)
        says(nb, "the feed is closed")
        nb.page.mouse.up()
    shoot(nb.widget(0), "drive-closed")
