"""A feed on the page when the kernel or the page is taken from under it."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .notebook import CellError, Notebook

OPEN = """
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


def test_a_feed_lives_through_an_interrupt_and_starts_anew_after_a_restart(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN])
    busy = nb.append(BUSY.format(stop="never"))
    nb.start(busy)
    expect_moving(nb.widget(0))
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    expect_moving(nb.widget(0))
    assert nb.python("print(repr(feed.status))") == "''\n"
    shoot(nb.output(0), "feed-interrupted")
    nb.restart_kernel()
    nb.run(0)
    expect_moving(nb.widget(0))
    assert nb.python("print(repr(feed.status))") == "''\n"


def test_a_feed_is_live_on_two_pages_and_on_one_that_was_reloaded_while_a_cell_was_busy(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([OPEN])
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
    (nb.lab.files / "reloaded").touch()  # before that JupyterLab does not ask a busy kernel for its widgets
    nb.open()
    expect_moving(nb.widget(0))
    shoot(nb.output(0), "feed-reloaded")
    assert nb.python("print(repr(feed.status))") == "''\n"
