"""Stop, on its bar and on a pad, in JupyterLab: beside an idle kernel, beside busy ones, and where there is no way."""

from __future__ import annotations

import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, Literal

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .notebook import CellError, Notebook

FEED = """
import threading, time
from types import SimpleNamespace
from robowidgets._command_watchdog import PROGRAM, CommandWatchdog
from robowidgets._stop_widget import StopWidget

class Feed:
    '''As much of a feed as Stop and pad use.'''
    is_closed, drive_words, driving = False, "", SimpleNamespace(topic="/cmd_vel")
    def __init__(self):
        self.heard, self.refused, self.pages = [], "", []
        self.watchdog = CommandWatchdog(lambda *speed: self.heard.append((time.time(), *speed)))
    def drive(self, linear, angular):
        try:
            self.watchdog.drive((linear, angular))
        except Exception as error:
            self.refused = str(error)
    def drive_by_hand(self, linear, angular, press):
        self.watchdog.drive((linear, angular), driver=press)
    def page_seen(self):
        self.pages.append(time.time())
    def watch(self, tell): pass
    def forget(self, tell): pass

feed = Feed()
runs = True
def program():
    while runs:
        feed.drive(0.2, 0.5)
        time.sleep(0.05)
threading.Thread(target=program, daemon=True).start()
bar = StopWidget(feed)
bar
"""
BUSY = {
    "sleeps": "import time\nwhile True:\n    time.sleep(0.001)",
    "computes": "n = 0\nwhile True:\n    n += 1",
}
BUSY_UNTIL = """
import pathlib, time
while not pathlib.Path({stop!r}).exists():
    {body}
"""
SLEEP = "time.sleep(0.01)"
STUBBORN = "try:\n        time.sleep(0.01)\n    except KeyboardInterrupt:\n        pass"
DEAF = """
from robowidgets import _driving_widget
_driving_widget.answer_beside_cells = lambda comm: None
"""
"""Messages wait until the cell ends, as they do with kernels that do not answer beside a cell."""
NO_INTERRUPT = """(path) => {
    const panel = [...window.jupyterapp.shell.widgets("main")].find((widget) => widget.context?.path === path);
    panel.sessionContext.session.kernel.interrupt = undefined;
}"""
"""The page cannot interrupt the kernel, as in hosts that do not hand it to widgets."""
PROGRAM = "a program drives /cmd_vel: 0.20 m/s, 0.50 rad/s"


def stop_of(nb: Notebook, cell: int = 0) -> Locator:
    return nb.widget(cell).locator(".rw-stop")


def allow_of(nb: Notebook) -> Locator:
    return nb.widget(0).locator(".rw-allow")


def says(nb: Notebook, words: str, hint: str | None = None) -> None:
    expect(nb.widget(0).locator(".rw-stop-text")).to_have_text(words)
    if hint is not None:
        expect(nb.widget(0).locator(".rw-hint")).to_have_text(hint)


def press(nb: Notebook, cell: int = 0) -> float:
    """Press Stop, without letting go, and tell when."""
    box: Any = stop_of(nb, cell).bounding_box()
    nb.page.mouse.move(box["x"] + 20, box["y"] + 20)
    at = time.time()
    nb.page.mouse.down()
    return at


def start_busy(nb: Notebook, body: str) -> tuple[int, Path]:
    """Keep the kernel busy until a file is there."""
    stop = nb.lab.files / f"{nb.path}-stop"
    busy = nb.append(BUSY_UNTIL.format(stop=str(stop), body=body))
    nb.start(busy)
    return busy, stop


@pytest.mark.parametrize("loop", BUSY)
def test_beside_a_busy_cell_stop_reaches_the_robot_at_once(notebook: Callable[..., Notebook], loop: str) -> None:
    nb = notebook([FEED])
    says(nb, PROGRAM)
    nb.page.evaluate(NO_INTERRUPT, nb.path)  # a machine that has much to do may answer late
    busy = nb.append(BUSY[loop])
    nb.start(busy)
    at = press(nb)
    expect(stop_of(nb)).to_have_text("Stopped")
    says(nb, "nobody may drive", "until it is allowed again")
    nb.page.mouse.up()
    allow_of(nb).click()
    says(nb, PROGRAM)
    press(nb)
    says(nb, "nobody may drive", "until it is allowed again")
    nb.lab.interrupt(nb.path)
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    heard = eval(nb.python("feed.heard"))
    zeros = [when for when, *speed in heard if speed == [0, 0]]
    assert zeros[0] - at < 1
    assert len(zeros) == 2
    assert heard[-1][1:] == (0.0, 0.0)
    assert nb.python("feed.refused") == "'stop is latched until somebody releases it'"


def test_stop_acts_on_press_stays_in_its_place_and_is_released_by_hand_or_by_code(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FEED])
    says(nb, PROGRAM, "Escape stops, too")
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
    nb.python("feed.watchdog.stopped = True")
    expect(stop_of(nb)).to_have_text("Stopped")
    nb.python("feed.watchdog.stopped = False")
    says(nb, PROGRAM)
    expect(stop_of(nb)).to_have_text("Stop")
    assert stop_of(nb).bounding_box() == place
    nb.python("runs = False")
    says(nb, "nobody drives")
    nb.python("feed.watchdog.take('p-1'); feed.drive_by_hand(-0.3, 0, 'p-1')")
    says(nb, "nobody drives")
    assert (-0.3, 0) in [tuple(speed) for _, *speed in eval(nb.python("feed.heard"))]
    nb.python("feed.drive_words = 'nobody listens to /cmd_vel'; feed.watchdog.stop()")
    says(nb, "nobody drives", "nobody listens to /cmd_vel")


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
    assert nb._ask("cells", nb.path) == ["code", "code"]
    allow_of(nb).click()
    says(nb, PROGRAM)
    nb.page.keyboard.press("Control+Escape")
    nb.page.locator(".jp-Cell").nth(1).click()
    nb.page.keyboard.press("Escape")
    nb.python("seen = len(feed.pages)")
    nb.page.wait_for_function("() => new Promise((done) => setTimeout(() => done(true), 300))")
    expect(stop_of(nb)).to_have_text("Stop")


def test_a_kernel_that_does_not_answer_is_interrupted(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([DEAF + FEED])
    says(nb, PROGRAM)
    busy, _ = start_busy(nb, SLEEP)
    says(nb, PROGRAM, "kernel busy: Stop interrupts the cell")
    at = press(nb)
    says(nb, "nobody may drive", "the kernel was interrupted")
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    heard = eval(nb.python("feed.heard"))
    assert heard[-1][1:] == (0.0, 0.0)
    assert heard[-1][0] - at < 2
    nb.page.mouse.up()
    allow_of(nb).click()
    says(nb, PROGRAM, "Escape stops, too")


def test_a_cell_that_goes_on_after_an_interrupt_is_named_and_stop_can_be_pressed_again(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([DEAF + FEED])
    says(nb, PROGRAM)
    busy, stop = start_busy(nb, STUBBORN)
    press(nb)
    says(nb, "the kernel was interrupted, but its cell goes on", "press Stop again, or restart the kernel")
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "false")
    nb.page.mouse.up()
    press(nb)
    says(nb, "stopping", "the kernel was interrupted")
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "true")
    stop.touch()
    nb.wait(busy)
    says(nb, "nobody may drive", "the kernel was interrupted")


def test_where_there_is_no_way_to_a_busy_kernel_it_says_so_and_what_would_help(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([DEAF + FEED])
    says(nb, PROGRAM)
    nb.page.evaluate(NO_INTERRUPT, nb.path)
    busy, stop = start_busy(nb, SLEEP)
    says(nb, PROGRAM, "kernel busy: Stop cannot reach it")
    press(nb)
    says(
        nb,
        "Stop cannot reach the busy kernel",
        "Interrupt the cell with the notebook's own button. ipykernel 7 or later hears Stop beside a running cell in "
        "JupyterLab; a robot should also stop by itself.",
    )
    expect(stop_of(nb)).to_have_text("Stop")
    expect(stop_of(nb)).to_have_attribute("aria-pressed", "false")
    for width in (280, 400, 1100):
        nb.resize(width)
        shoot(nb.widget(0), f"stop-unreachable-{width}")
    stop.touch()
    nb.wait(busy)
    says(nb, "nobody may drive", "until it is allowed again")


def test_an_allow_that_waited_for_the_kernel_releases_nothing(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([DEAF + FEED])
    nb.python("feed.watchdog.stopped = True")
    says(nb, "nobody may drive")
    busy = nb.append("import time\ntime.sleep(4)")
    nb.start(busy)
    allow_of(nb).click()
    says(nb, "nobody may drive", "the kernel is busy")
    nb.wait(busy)
    says(nb, "nobody may drive", "that came too late: press again")
    allow_of(nb).click()
    says(nb, PROGRAM)


def test_a_page_is_seen_also_hidden_and_while_a_cell_runs(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([FEED])
    says(nb, PROGRAM)
    nb.page.evaluate("() => Object.defineProperty(document, 'hidden', { value: true, configurable: true })")
    busy = nb.append("import time\nstart, seen = time.time(), len(feed.pages)\nwhile len(feed.pages) < seen + 3: pass")
    nb.run(busy)
    assert 1 < float(nb.python("time.time() - start")) < 10


def test_a_kernel_that_died_while_a_program_drove_is_no_program_that_drives(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FEED])
    says(nb, PROGRAM)
    nb.python("threading.Timer(0.2, lambda: __import__('os').kill(__import__('os').getpid(), 9)).start()")
    says(nb, "no news from the kernel", "what the robot does is not known")
    expect(stop_of(nb)).to_have_text("Stop")


LOOKS = {
    "program": (PROGRAM, ""),
    "words": (PROGRAM, "feed.drive_words = 'nobody listens to /cmd_vel; speeds go to /base/cmd_vel'"),
    "stopped": ("nobody may drive", "feed.watchdog.stopped = True"),
    "free": ("nobody drives", "runs, feed.drive_words, feed.watchdog.stopped = False, '', False"),
    "failed": (
        "nobody drives",
        "def fail(*speed): raise OSError('no route to the robot')\n"
        "feed.watchdog._send = fail\nfeed.drive(0.1, 0); feed.watchdog.stop()",
    ),
}


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("light", 2), ("dark", 2)])
def test_looks(notebook: Callable[..., Notebook], theme: Literal["light", "dark"], scale: int) -> None:
    nb = notebook([FEED], scale=scale, theme=theme)
    for width in (280, 400, 1100):
        nb.resize(width)
        places = []
        for look, (words, code) in LOOKS.items():
            nb.python(code)
            says(nb, words)
            if look == "failed":
                expect(nb.widget(0).locator(".rw-notice")).to_contain_text("no route to the robot")
            places.append(stop_of(nb).bounding_box())
            shoot(nb.widget(0), f"stop-{look}-{theme}-{width}")
            if width == 400 and scale == 2:
                nb.page.emulate_media(forced_colors="active")
                shoot(nb.widget(0), f"stop-{look}-{theme}-forced")
                nb.page.emulate_media(forced_colors="none")
        assert all(place == places[0] for place in places), "Stop moved"
        nb.run_all()
