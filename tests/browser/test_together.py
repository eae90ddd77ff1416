"""Widgets of one view freeze and step to one moment, in the page, while a cell runs."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .laser import eventually
from .notebook import CellError, Notebook

SHOW = """
from robowidgets import feeds
feed = feeds.simulator()
feed.drive(0.2, 0.3)
view = feed.show()
view
"""
BUSY = "import time\nend = time.time() + 60\nwhile time.time() < end:\n    pass"
ARRIVED = """
import bisect
from robowidgets._core.robot_widget import FRAME_HEADER
print(*(FRAME_HEADER.unpack_from(widget._frozen_frame)[3] for widget in view.widgets.values()))
"""


def test_freeze_and_step_hold_all_widgets_at_one_moment_while_a_cell_runs(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([SHOW])
    buttons = nb.output(0).locator(".rw-freeze")
    expect(buttons).to_have_count(4)
    expect(nb.output(0).locator(".rw-laser .rw-nearest")).to_contain_text("nearest")
    # Some samples to step back through.
    nb.python("import time\ntime.sleep(2)")
    busy = nb.append(BUSY)
    nb.start(busy)
    laser = nb.output(0).locator(".rw-laser")
    laser.locator(".rw-freeze").click()
    for button in buttons.all():
        expect(button).to_have_attribute("aria-pressed", "true")
    for _ in range(5):
        nb.page.keyboard.press(",")
    expect(laser.locator(".rw-time b")).to_contain_text("−")
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)

    def same_moment() -> bool:
        scan, speed, _ = (float(one) for one in nb.python(ARRIVED).split())
        return scan - 0.3 < speed <= scan

    # The page tells Python what each widget holds at its own pace.
    eventually(same_moment, True)
    nb.output(0).locator(".rw-speed .rw-freeze").click()
    for button in buttons.all():
        expect(button).to_have_attribute("aria-pressed", "false")
