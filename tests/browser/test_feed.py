"""A feed on the page: a robot drives while a cell is busy, and while the kernel or the page is lost."""

from __future__ import annotations

import time
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .notebook import CellError, Notebook

SHOW = """
from robowidgets import LaserWidget, feeds
feed = feeds.simulator()
feed.show()
"""
WRONG = """
lost = LaserWidget()
feed.connect("/scna", lost)
lost
"""
ENDLESS = """
from contextlib import suppress
while True:
    with suppress(feeds.FeedError):  # after a standstill of a busy machine
        feed.drive(0.3, 0.4)
    sum(range(100_000))
"""
CONNECT = """
from robowidgets import LaserWidget, feeds
laser = LaserWidget()
feed = feeds.simulator()
feed.connect("/scan", laser)
laser
"""
BUSY = """
from pathlib import Path
while not Path({stop!r}).exists():
    sum(range(100_000))
"""


def expect_moving(laser: Locator) -> None:
    """Wait until the widget has shown three more scans."""
    nearest = laser.locator(".rw-nearest")
    expect(nearest).to_contain_text("nearest ")
    for _ in range(3):
        expect(nearest).not_to_have_text(nearest.inner_text())


def test_a_robot_is_live_while_a_cell_is_busy_and_after_an_interrupt_and_a_restart(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([SHOW, WRONG, ENDLESS], run=False, width=1300)
    nb.run(0)
    nb.run(1)
    laser = nb.output(0).locator(".rw-laser")
    nb.start(2)
    until = time.monotonic() + 12.0  # longer than any time limit of a feed or of the page
    while time.monotonic() < until:
        expect_moving(laser)
    shoot(nb.output(0), "feed-simulator")
    expect(nb.widget(1)).to_contain_text("no such topic /scna; there are /scan, /odom, /cmd_vel, /bumper")
    shoot(nb.output(1), "feed-no-such-topic")
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(2)
    expect_moving(laser)
    assert nb.python("print(repr(feed.status))") == "''\n"
    assert nb.python("print(feed.show('/odom').widgets['/odom'].title)") == "/odom\n"

    nb.restart_kernel()
    expect(laser.locator(".rw-silence")).to_have_text("no kernel in this page")
    nb.run(0)
    expect_moving(laser)
    assert nb.python("print(repr(feed.status))") == "''\n"
    nb.python("feed.close()")
    expect(laser).to_contain_text("the feed is closed")


def test_a_feed_is_live_on_two_pages_and_on_one_that_was_reloaded_while_a_cell_was_busy(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([CONNECT])
    busy = nb.append(BUSY.format(stop="reloaded"))
    nb.save()
    page = nb.page.context.new_page()
    second = Notebook(page, nb.lab, nb.path, nb.console)
    second.open()
    expect_moving(second.widget(0))
    expect_moving(nb.widget(0))
    shoot(second.output(0), "feed-second-page")
    page.close()
    nb.start(busy)
    expect_moving(nb.widget(0))
    nb.save()
    nb.page.reload()
    (nb.lab.files / "reloaded").touch()  # until then JupyterLab does not request widgets from a busy kernel
    nb.open()
    expect_moving(nb.widget(0))
    shoot(nb.output(0), "feed-reloaded")
    assert nb.python("print(repr(feed.status))") == "''\n"
