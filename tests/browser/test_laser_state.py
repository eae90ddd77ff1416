"""The state of a laser widget over two views, a reload, a kernel's restart, a bad message and its own end."""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .laser import FAN, SETUP, eventually, layers, locate
from .notebook import Notebook
from .plain_page import PlainPage
from .test_history import is_at, slider_of
from .test_silence import WIDGETS, cards, is_new, is_old

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
THREAD = "import threading\nthread = threading.Thread(target=laser.update, args=[{}])\nthread.start(); thread.join()"


def views(nb: Notebook) -> list[Locator]:
    """Both views of the laser."""
    return [nb.widget(index).locator(".rw-card") for index in (0, 3)]


def says(card: Locator, nearest: str, freeze: str) -> None:
    expect(card.locator(".rw-nearest")).to_have_text(nearest if "too close" in nearest else f"nearest {nearest}")
    expect(card.locator(".rw-freeze")).to_have_text(freeze)


def test_two_views_a_reloaded_page_and_one_without_its_kernel_show_the_same(notebook: Callable[..., Notebook]) -> None:
    # A view that is made without a scan has another height.
    cell = WIDGETS.replace('LaserWidget(title="/scan")', 'LaserWidget(title="/scan")\nlaser.update(**fan())')
    nb = notebook([cell, "speed", "touch", "laser"], height=1400)
    frozen_in_one_view_it_is_in_both_and_on_a_reloaded_page(nb)
    loaded_in_the_silence_a_page_that_is_late_hears_and_does_not_take_the_picture_for_new(nb)
    after_a_restart_the_cells_run_again_and_a_closed_widget_goes(nb)


def frozen_in_one_view_it_is_in_both_and_on_a_reloaded_page(nb: Notebook) -> None:
    nb.resize(500, height=1400)
    first, second = views(nb)
    place = locate(first)
    assert locate(second) == place
    spot = {"x": place.at(*FAN[4])[0], "y": place.at(*FAN[4])[1]}
    second.locator(".rw-picture").click(position=spot)
    second.locator(".rw-freeze").click()
    second.get_by_role("button", name="Zoom in (+)").click()
    nb.python("laser.update(**fan({9: 0.9}))")
    for card in (first, second):
        says(card, "1.52 m at −80.0° [1]", "Frozen · 1 since")
        expect(card.locator(".rw-popup:visible .rw-popup-expression")).to_have_text("ranges[4]")
        expect(card.locator(".rw-range")).to_have_text("3 m")
    eventually(lambda: layers(first) == layers(second), True)
    eventually(lambda: nb.python("laser.paused"), "True")
    held = layers(first)
    first.locator(".rw-picture").hover(position=spot)
    eventually(lambda: nb.python("laser.hovered"), "4")

    nb.reload()
    first, second = views(nb)
    for card in (first, second):
        says(card, "1.52 m at −80.0° [1]", "Frozen · 1 since")
        expect(card.locator(".rw-popup:visible")).to_have_count(1)
        eventually(lambda card=card: layers(card), held)
    assert nb.python("print(f'{laser.scan.ranges[9]:.2f}')") == "1.68\n"
    eventually(lambda: nb.python("laser.hovered is None"), "True")
    nb.python("laser.pinned = None")
    for card in (first, second):
        expect(card.locator(".rw-popup:visible"), "nobody points").to_have_count(0)

    # There it steps from the frozen scan to the one that was the newest, and to what has come since.
    expect(first.locator(".rw-time")).to_have_text("earlier")
    is_at(first, 1, 2)
    nb.python("laser.update(**fan({9: 0.85}))")
    is_at(first, 1, 3)
    slider_of(first).press("ArrowRight")
    for card in (first, second):
        says(card, "0.90 m at 0.0° [9]", "Frozen · 1 since")
    eventually(lambda: nb.python("print(f'{laser.frozen.nearest().range:.2f}')"), "0.90\n")
    first.locator(".rw-freeze").click()
    for card in (first, second):
        says(card, "0.85 m at 0.0° [9]", "Freeze")
    nb.python("laser.update(**fan({9: 0.8}))")
    for card in (first, second):
        says(card, "0.80 m at 0.0° [9]", "Freeze")


IMPATIENT = """(() => {
    const { timeout } = AbortSignal;
    AbortSignal.timeout = () => timeout.call(AbortSignal, 0);
})()"""
"""anywidget gives up on a widget that is not ready after two seconds, as on a busy page."""


def loaded_in_the_silence_a_page_that_is_late_hears_and_does_not_take_the_picture_for_new(nb: Notebook) -> None:
    nb.python("go_live()")
    for card in cards(nb):
        is_old(card)
    session = nb.page.context.new_cdp_session(nb.page)
    session.send("Page.enable")
    added = session.send("Page.addScriptToEvaluateOnNewDocument", {"source": IMPATIENT})
    nb.reload()
    session.send("Page.removeScriptToEvaluateOnNewDocument", added)
    nb.page.evaluate("window.driver.isSpoilt = true")
    for card in cards(nb):
        is_old(card)
    for card in views(nb):
        says(card, "too close at −40.0° [5]", "Freeze")
    # The page does not know when the touch began: the next beat reports it.
    touched = cards(nb)[2].locator(".rw-tile").first
    expect(touched.locator(".rw-tile-words")).to_have_text(re.compile(r"^touched.*\d s$"))
    nb.python("update()")
    for card in cards(nb):
        is_new(card)


def after_a_restart_the_cells_run_again_and_a_closed_widget_goes(nb: Notebook) -> None:
    nb.restart_kernel()
    first, second = views(nb)
    first.locator(".rw-freeze").click()
    second.locator(".rw-picture").click()
    for card in (first, second):
        says(card, "too close at −40.0° [5]", "Frozen · 0 since")
        expect(card.locator(".rw-popup:visible")).to_have_count(1)
    nb.run_all()
    nb.python("laser.update(**fan({9: 0.9}))")
    first, second = views(nb)
    for card in (first, second):
        says(card, "0.90 m at 0.0° [9]", "Freeze")
    first.locator(".rw-freeze").click()
    says(second, "0.90 m at 0.0° [9]", "Frozen · 0 since")
    nb.python("laser.close()")
    for index in (0, 3):
        expect(nb.output(index).locator(".rw-card")).to_have_count(0)
    nb.python("laser.update(**fan())\nlaser.paused = False")


def test_a_bad_message_in_a_thread_is_reported_and_the_last_good_picture_stays(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([FIRST])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    notice = card.locator(".rw-notice")
    nb.python(THREAD.format("{'linear': 1}"))
    expect(notice).to_contain_text("linear")
    expect(notice).to_contain_text("Showing the last good scan.")
    says(card, "1.52 m at −80.0° [1]", "Freeze")
    locate(card)
    nb.python(THREAD.format("fan(range_max=0.5)"))
    expect(notice).to_contain_text("range_max: expected metres above range_min (0.6), got 0.5; are the two swapped?")
    locate(card)
    box, picture = notice.bounding_box(), card.locator(".rw-picture").bounding_box()
    assert box is not None
    assert picture is not None
    assert box["width"] == picture["width"]
    assert box["height"] < 60
    nb.python("laser.update(**fan({9: 0.9}))")
    expect(notice).to_be_hidden()
    says(card, "0.90 m at 0.0° [9]", "Freeze")
