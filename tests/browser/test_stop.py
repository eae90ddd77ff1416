"""Stop, on its bar and on a pad: with an idle kernel, with busy ones, and without a way to the kernel."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from itertools import groupby
from typing import Any, Literal

import pytest
from playwright.sync_api import Locator, expect

from robowidgets.driving.driving_widget import ALLOW_LIFETIME

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .notebook import CellError, Notebook
from .plain_page import PlainPage

FEED = """
import threading, time
from robowidgets import feeds
from robowidgets.stop_widget import StopWidget

feed = feeds.simulator(wander=False)
heard, refused = [], ""
publish = feed.connection.middleware.publish
def record(topic, kind, message):
    publish(topic, kind, message)
    heard.append((time.time(), message["linear"]["x"], message["angular"]["z"]))
feed.connection.middleware.publish = record

runs = True
def program():
    global refused
    while runs:
        try:
            feed.drive(0.2, 0.5)
        except feeds.FeedError as error:
            refused = str(error)
        time.sleep(0.05)
threading.Thread(target=program, daemon=True).start()
bar = StopWidget(feed)
bar
"""
BUSY = "import time\nwhile True:\n    time.sleep(0.001)", "n = 0\nwhile True:\n    n += 1"
STUBBORN = """
import pathlib
while not pathlib.Path({stop!r}).exists():
    try:
        time.sleep(0.01)
    except KeyboardInterrupt:
        pass
"""
NO_INTERRUPT = """(path) => {
    const panel = [...window.jupyterapp.shell.widgets("main")].find((widget) => widget.context?.path === path);
    panel.sessionContext.session.kernel.interrupt = undefined;
}"""
"""The page cannot interrupt the kernel, as in hosts that give widgets no access to it."""
ALONE = """(path) => {
    const panel = [...window.jupyterapp.shell.widgets("main")].find((widget) => widget.context?.path === path);
    panel.sessionContext.session.kernel.commsOverSubshells = "disabled";
}"""
"""Messages of widgets wait until a cell ends, as with kernels without subshells."""
PROGRAM = "a program drives /cmd_vel: 0.20 m/s, 0.50 rad/s"


def stop_of(nb: Notebook | PlainPage, cell: int = 0) -> Locator:
    return nb.widget(cell).locator(".rw-stop")


def allow_of(nb: Notebook | PlainPage) -> Locator:
    return nb.widget(0).locator(".rw-allow")


def says(nb: Notebook | PlainPage, words: str, hint: str | None = None) -> None:
    expect(nb.widget(0).locator(".rw-stop-text")).to_have_text(words)
    if hint is not None:
        expect(nb.widget(0).locator(".rw-hint")).to_have_text(hint)


def press(nb: Notebook | PlainPage, cell: int = 0) -> None:
    """Press Stop, and hold it."""
    box: Any = stop_of(nb, cell).bounding_box()
    nb.page.mouse.move(box["x"] + 20, box["y"] + 20)
    nb.page.mouse.down()


def test_during_a_busy_cell_stop_reaches_the_robot_at_once(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([FEED])
    nb.page.evaluate(NO_INTERRUPT, nb.path)  # a busy machine may answer late
    for loop in BUSY:
        says(nb, PROGRAM)
        busy = nb.append(loop)
        nb.start(busy)
        press(nb)
        expect(stop_of(nb)).to_have_text("Stopped")
        says(nb, "nobody may drive", "until it is allowed again")
        nb.page.mouse.up()
        allow_of(nb).click()
        says(nb, PROGRAM)
        press(nb)
        says(nb, "nobody may drive", "until it is allowed again")
        nb.page.mouse.up()
        nb.lab.interrupt(nb.path)
        with pytest.raises(CellError, match="KeyboardInterrupt"):
            nb.wait(busy)
        heard = eval(nb.python("heard"))
        moves = [speed != [0, 0] for _, *speed in heard]
        assert [is_moving for is_moving, _ in groupby(moves)] == [True, False, True, False], loop
        assert moves.count(False) == 2, loop
        assert "cannot drive: Stop is pressed: press Allow driving" in nb.python("refused"), loop
        nb.python("heard.clear(); refused = ''")
        allow_of(nb).click()


@pytest.fixture
def driven_page(plain_page: Callable[..., PlainPage]) -> Iterator[Callable[..., PlainPage]]:
    """A plain page whose cell starts a program that drives; it ends with the test."""
    opened: list[PlainPage] = []

    def open_page(cells: list[str], **more: Any) -> PlainPage:
        opened.append(plain_page(cells, **more))
        return opened[-1]

    yield open_page
    for nb in opened:
        nb.python("runs = False")


@pytest.mark.core
def test_stop_acts_on_press_stays_in_its_place_and_is_released_by_hand_or_by_code(
    driven_page: Callable[..., PlainPage],
) -> None:
    nb = driven_page([FEED])
    says(nb, PROGRAM, "Escape here stops, too")
    expect(allow_of(nb)).not_to_be_visible()
    place = stop_of(nb).bounding_box()
    assert place is not None
    assert place["height"] >= 42
    press(nb)
    says(nb, "nobody may drive", "until it is allowed again")
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "true")
    expect(stop_of(nb)).to_be_enabled()
    assert stop_of(nb).bounding_box() == place
    nb.page.mouse.up()
    allow_of(nb).click()
    says(nb, PROGRAM)
    nb.python("feed.stopped = True")
    expect(stop_of(nb)).to_have_text("Stopped")
    nb.python("feed.stopped = False")
    says(nb, PROGRAM)
    expect(stop_of(nb)).to_have_text("Stop")
    assert stop_of(nb).bounding_box() == place
    nb.python("runs = False")
    says(nb, "nobody drives")
    nb.python(
        "from robowidgets.driving.command_watchdog import Velocity; "
        "feed.watchdog.take('p-1'); feed.driver.drive_by_hand(Velocity(-0.3), 'p-1')"
    )
    says(nb, "nobody drives")
    assert (-0.3, 0) in [tuple(speed) for _, *speed in eval(nb.python("heard"))]
    nb.python("feed.connection.on_unheard('/cmd_vel', 'the robot does not accept data'); feed.watchdog.stop()")
    says(nb, "nobody drives", "the robot does not accept data")


IN_A_BOX = FEED.replace(
    "bar = StopWidget(feed)\nbar", "import ipywidgets, robowidgets\nbar = StopWidget(feed)"
).rstrip()


def test_keys_stop_from_the_bar_and_escape_from_anywhere_in_its_view(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([f"{IN_A_BOX}\nipywidgets.VBox([bar, robowidgets.TouchWidget()])", "1"])
    says(nb, PROGRAM)
    for key in ("Enter", " "):
        stop_of(nb).focus()
        nb.page.keyboard.down(key)
        expect(stop_of(nb)).to_have_text("Stopped")
        nb.page.keyboard.up(key)
        allow_of(nb).focus()
        nb.page.keyboard.press(key)
        says(nb, PROGRAM)
    nb.widget(0).locator(".rw-touch .rw-picture").focus()
    nb.page.keyboard.press("Escape")
    expect(stop_of(nb)).to_have_text("Stopped")
    assert nb.kinds == ["code", "code"]
    allow_of(nb).click()
    says(nb, PROGRAM)
    nb.page.keyboard.press("Control+Escape")
    nb.page.locator(".jp-Cell").nth(1).click()
    nb.page.keyboard.press("Escape")
    nb.python("1")  # the earlier messages of the page have arrived
    expect(stop_of(nb)).to_have_text("Stop")
    assert nb.python("feed.stopped") == "False"


def test_escape_stops_in_a_shadow_root_as_hosts_put_widgets_there(driven_page: Callable[..., PlainPage]) -> None:
    nb = driven_page([FEED])
    says(nb, PROGRAM)
    nb.page.evaluate("""() => {
        const card = document.querySelector(".rw-stop").closest(".rw-card"), host = document.createElement("div");
        card.before(host);
        host.attachShadow({ mode: "open" }).append(card);
    }""")
    nb.page.keyboard.press("Escape")
    stop_of(nb).focus()
    expect(stop_of(nb)).to_have_text("Stop")
    nb.page.keyboard.press("Escape")
    expect(stop_of(nb)).to_have_text("Stopped")


def test_a_kernel_that_does_not_answer_is_interrupted_and_a_cell_that_goes_on_is_named(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FEED], run=False)
    nb.page.evaluate(ALONE, nb.path)
    nb.run_all()
    says(nb, PROGRAM)
    busy = nb.append("while True:\n    time.sleep(0.01)")
    nb.start(busy)
    says(nb, PROGRAM, "kernel busy: Stop interrupts the cell")
    press(nb)
    says(nb, "nobody may drive", "the kernel was interrupted")
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    heard = eval(nb.python("heard"))
    assert heard[-1][1:] == (0.0, 0.0)
    nb.page.mouse.up()
    allow_of(nb).click()
    says(nb, PROGRAM, "Escape here stops, too")

    stop = nb.lab.files / f"{nb.path}-stop"
    busy = nb.append(STUBBORN.format(stop=str(stop)))
    nb.start(busy)
    press(nb)
    hint = "its cell goes on, or the connection is lost: press Stop again, or restart the kernel"
    says(nb, "the kernel was interrupted, but does not answer", hint)
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "false")
    nb.page.mouse.up()
    press(nb)
    says(nb, "stopping", "the kernel was interrupted")
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "true")
    stop.touch()
    nb.wait(busy)
    says(nb, "nobody may drive", "the kernel was interrupted")


def test_without_a_way_to_a_busy_kernel_it_reports_that_and_the_remedy(
    driven_page: Callable[..., PlainPage],
) -> None:
    nb = driven_page([FEED])
    says(nb, PROGRAM)
    with nb.busy():
        says(nb, PROGRAM, "kernel busy: Stop cannot reach it")
        press(nb)
        says(
            nb,
            "Stop cannot reach the busy kernel",
            "Interrupt the cell with the notebook's own button. ipykernel 7 or later hears Stop beside a running cell "
            "in JupyterLab; a robot should also stop by itself.",
        )
        expect(stop_of(nb)).to_have_text("Stop")
        expect(stop_of(nb)).to_have_attribute("aria-pressed", "false")
        for width in (280, 400, 1100):
            nb.resize(width)
            shoot(nb.widget(0), f"stop-unreachable-{width}")
    says(nb, "nobody may drive", "until it is allowed again")


def test_an_allow_that_waited_for_the_kernel_releases_nothing(driven_page: Callable[..., PlainPage]) -> None:
    nb = driven_page([FEED])
    nb.python("feed.stopped = True")
    says(nb, "nobody may drive")
    with nb.busy():
        says(nb, "nobody may drive", "the kernel is busy")
        allow_of(nb).click()
        clicked = time.monotonic()
        wait_for(lambda: time.monotonic() > clicked + ALLOW_LIFETIME, "the page's token is too old")
    says(nb, "nobody may drive", "Allow came too late: press it again")
    allow_of(nb).click()
    says(nb, PROGRAM)


def test_a_page_counts_as_present_with_slow_timers_and_during_a_cell_until_it_is_left(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([f"{FEED.rstrip()[:-3]}feed.driving = feeds.Driving(needs_page=True)\nbar"])
    says(nb, PROGRAM)
    # As on a page that has been hidden for minutes.
    nb.page.evaluate("() => { for (let id = 0; id < 100_000; id++) clearInterval(id); }")
    busy = nb.append(
        "refused = ''\nheard.clear()\nwhile len(heard) < 80: time.sleep(0.001)\nrefused, heard[-1][0] - heard[0][0]"
    )
    refused, seconds = eval(nb.run(busy))
    assert "no page" not in refused
    assert seconds > 3.5
    log = nb.lab.files / "needs-page"
    nb.python(
        "def tell():\n    while 'no page' not in refused or heard[-1][1:] != (0.0, 0.0): time.sleep(0.01)\n"
        f"    open({str(log)!r}, 'w').write(refused)\n"
        "threading.Thread(target=tell).start()"
    )
    nb.page.goto("about:blank")
    wait_for(lambda: log.exists() and "no page" in log.read_text(), "the robot stands")


def test_a_program_of_a_dead_kernel_no_longer_counts_as_driving(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FEED])
    says(nb, PROGRAM)
    nb.python("threading.Timer(0.2, lambda: __import__('os').kill(__import__('os').getpid(), 9)).start()")
    says(nb, "no kernel in this page", "Stop reaches nothing; what the robot does is not known")
    expect(stop_of(nb)).to_have_text("Stop")
    # JupyterLab reports some time later, in a dialog over the notebook then open, that the kernel restarts.
    nb.page.evaluate("window.driver.isSpoilt = true")


STATES = {
    "program": (PROGRAM, ""),
    "status": (
        PROGRAM,
        "feed.connection.on_unheard('/cmd_vel', '/cmd_vel has no subscriber, unlike /base/cmd_vel')",
    ),
    "stopped": ("nobody may drive", "feed.stopped = True"),
    "free": ("nobody drives", "runs = feed.stopped = False; feed.connection.on_unheard('/cmd_vel', '')"),
    "failed": (
        "nobody drives",
        "def fail(*message): raise feeds.FeedError('the socket is not writable: no route to host')\n"
        "feed.connection.middleware.publish = fail\nfeed.watchdog.stop()",
    ),
}


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_looks(driven_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int) -> None:
    nb = driven_page([FEED], scale=scale, theme=theme)
    for width in (280, 400, 1100):
        nb.resize(width)
        places = []
        for state, (words, code) in STATES.items():
            nb.python(code)
            says(nb, words)
            if state == "failed":
                expect(nb.widget(0).locator(".rw-notice")).to_contain_text("no route to host")
            places.append(stop_of(nb).bounding_box())
            shoot(nb.widget(0), f"stop-{state}-{theme}-{width}")
            if width == 400 and scale == 2:
                nb.page.emulate_media(forced_colors="active")
                shoot(nb.widget(0), f"stop-{state}-{theme}-forced")
                nb.page.emulate_media(forced_colors="none")
        assert all(place == places[0] for place in places), "Stop moved"
        nb.python("runs = False; feed.close()")
        nb.run_all()
