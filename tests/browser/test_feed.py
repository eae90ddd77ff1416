"""A feed on the page: a robot drives while a cell is busy."""

from __future__ import annotations

import time
from collections.abc import Callable

from playwright.sync_api import expect

from .chromium import shoot
from .notebook import Notebook

OPEN = """
from robowidgets import LaserWidget, feeds
feed = feeds.simulator()
feed.show()
"""
WRONG = """
lost = LaserWidget()
feed.connect("/scna", lost)
lost
"""
BUSY = """
from pathlib import Path
while not Path({stop!r}).exists():
    feed.drive(0.3, 0.4)
    sum(range(100_000))
"""


def test_a_robot_is_live_while_a_cell_is_busy_for_20_s_and_what_is_wrong_is_told(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([OPEN, WRONG], width=1300)
    cards = nb.output(0).locator(".rw-card")
    expect(cards).to_have_count(5)  # Stop is the first of them
    nb.start(nb.append(BUSY.format(stop="seen")))
    nearest = cards.nth(1).locator(".rw-nearest")
    until = time.monotonic() + 20.0  # longer than any patience of a feed, of the server or of the page
    while time.monotonic() < until:
        before = nearest.inner_text()
        assert before.startswith("nearest ")
        expect(nearest).not_to_have_text(before)
    shoot(nb.output(0), "feed-simulator")
    expect(nb.widget(1)).to_contain_text("no such topic /scna; there are /scan, /odom, /cmd_vel, /bumper")
    shoot(nb.output(1), "feed-no-such-topic")
    (nb.lab.files / "seen").touch()
    nb.wait(2)
    assert nb.python("print(feed.show('/odom').widgets['/odom'].title)") == "/odom\n"
    nb.python("feed.close()")
    expect(cards.nth(1)).to_contain_text("the feed is closed")
