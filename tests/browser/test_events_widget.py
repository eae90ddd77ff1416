"""The list of events on a page."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Locator, Page, expect

from .chromium import LOOKS, shoot
from .events import EMPTY, HOSTILE, MANY, RECORDING, ROBOT
from .laser import eventually
from .plain_page import PlainPage


def rows(card: Locator) -> Locator:
    """The rows of the list that are on the page."""
    return card.locator(".rw-event:visible")


def row(card: Locator, text: str) -> Locator:
    """The row with a text."""
    return rows(card).filter(has_text=text)


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_each_row_says_when_how_bad_who_and_what_at_every_width(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([ROBOT, MANY, EMPTY], scale=scale, theme=theme)
    for width in (300, 480, 1000):
        nb.resize(width)
        for i, name in enumerate(("robot", "many", "empty")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"events-{name}-{theme}-{width}")
    card = nb.widget(0).locator(".rw-card")
    nb.python("events.layout.height = '500px'")
    failed = row(card, "over current")
    expect(failed.locator(".rw-event-time")).to_have_text("11.00 s")
    expect(failed.locator(".rw-event-level")).to_have_text("✕error")
    expect(failed.locator(".rw-event-source")).to_have_text("base: left motor")
    expect(failed.locator(".rw-event-text")).to_have_text(
        "over current: 4.2 A, limit 3.0 A the driver is off until it is reset"
    )
    expect(row(card, "12 rays were lost").locator(".rw-event-count")).to_have_text("× 14")
    expect(card.locator(".rw-footer")).to_contain_text("✕ 2 errors▲ 15 warnings6 more")
    expect(nb.widget(2).locator(".rw-empty")).to_have_text("waiting for an event")
    expect(nb.widget(1).locator(".rw-footer")).to_contain_text("1\u202f000 older left out")


@pytest.mark.core
def test_a_row_unfolds_by_a_click_and_keys_walk_rows_also_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([ROBOT])
    card = nb.widget(0).locator(".rw-card")
    with nb.busy():
        row(card, "over current").click()
        expect(card.locator(".rw-event-whole:visible")).to_have_text(
            "over current: 4.2 A, limit 3.0 A\nthe driver is off until it is reset", use_inner_text=True
        )
        expect(card.locator(".rw-event-facts:visible")).to_have_text("11.000 s · error · base: left motor")
        expect(card.locator('[aria-current="true"]')).to_contain_text("over current")
        shoot(card, "events-unfolded")
        row(card, "over current").locator(".rw-event-line").click()
        expect(card.locator(".rw-event-whole:visible")).to_have_count(0)
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("ArrowDown")
        expect(card.locator('[aria-current="true"]')).to_contain_text("wall at 0.42 m")
        expect(card.locator(".rw-live")).to_have_text(
            "info, 12.50 s, follower, wall at 0.42 m, and the robot turns away from it by 20 degrees"
        )
        nb.page.keyboard.press("Home")
        expect(card.locator('[aria-current="true"]')).to_contain_text("robot_state_publisher started")
        nb.page.keyboard.press("Enter")
        expect(card.locator(".rw-event-whole:visible")).to_have_text("robot_state_publisher started")
        nb.page.keyboard.press("Escape")
        nb.page.keyboard.press("Escape")
        expect(card.locator('[aria-current="true"]')).to_have_count(0)


def test_it_is_filtered_by_level_and_words_in_the_page_and_from_python(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ROBOT])
    card = nb.widget(0).locator(".rw-card")
    with nb.busy():
        card.get_by_label("The least level that is listed").select_option("WARN")
        expect(rows(card)).to_have_count(4)
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("/")
        nb.page.keyboard.type("base contact")
        expect(rows(card)).to_have_count(1)
        expect(card.locator(".rw-events-extent")).to_have_text("1 of 10 rows")
        nb.page.keyboard.press("Escape")
        expect(rows(card)).to_have_count(4)
        nb.page.keyboard.press("Escape")
        expect(card.locator(".rw-picture")).to_be_focused()
    eventually(lambda: nb.python("print(events.level, repr(events.words))"), "WARN ''\n")
    nb.python("events.words, events.level = 'nowhere', 'DEBUG'")
    expect(card.locator(".rw-empty")).to_have_text("nothing of this level with these words")
    expect(card.get_by_label("Only rows with these words (/)")).to_have_value("nowhere")


def test_live_the_newest_stays_in_view_unless_the_user_points_at_the_list_or_freezes_it(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([MANY])
    card = nb.widget(0).locator(".rw-card")
    expect(row(card, "line 2999")).to_be_visible()
    nb.python("many.add('the newest', level='ERROR', time=31.0)")
    expect(row(card, "the newest")).to_be_visible()
    expect(card.locator(".rw-live")).to_have_text("error, 31.00 s, the newest")
    row(card, "line 2999").hover()
    nb.python("many.add('later', time=32.0)")
    expect(card.locator(".rw-footer")).to_contain_text("1\u202f002 older left out")
    box, last = card.locator(".rw-events-list").bounding_box(), row(card, "the newest").bounding_box()
    assert box
    assert last
    assert last["y"] + last["height"] <= box["y"] + box["height"] + 1  # nothing moved under the pointer
    nb.page.mouse.move(0, 0)
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("Space")
    expect(card.locator(".rw-freeze")).to_contain_text("Frozen")
    nb.python("many.add('while frozen', time=33.0)")
    expect(card.locator(".rw-freeze")).to_contain_text("1 since")
    expect(row(card, "while frozen")).to_have_count(0)
    eventually(lambda: nb.python("print(many.rows[-1].text)"), "later\n")
    nb.page.keyboard.press("Space")
    expect(row(card, "while frozen")).to_be_visible()


def test_a_drawing_that_changes_no_row_leaves_the_list_as_it_is(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ROBOT])
    card = nb.widget(0).locator(".rw-card")
    expect(row(card, "over current")).to_be_visible()
    card.locator(".rw-events-list").evaluate(
        """(list) => {
            window.scrolled = 0;
            const { get, set } = Object.getOwnPropertyDescriptor(Element.prototype, "scrollTop");
            const count = function (top) { window.scrolled++; set.call(this, top); };
            Object.defineProperty(list, "scrollTop", { get, set: count });
        }"""
    )
    nb.python("events.title = 'drawn anew'")
    expect(card.locator(".rw-title")).to_have_text("drawn anew")
    assert nb.page.evaluate("window.scrolled") == 0


def test_hostile_texts_stay_texts_and_long_ones_are_cut_and_marked(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([HOSTILE])
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-event-text").first).to_have_text("<img src=x onerror=alert(1)>")
    expect(card.locator(".rw-event-source").first).to_have_text("<b>node</b>")
    assert card.locator("img, i, .rw-event b").count() == 0
    rows(card).nth(1).click()
    expect(card.locator(".rw-event-facts:visible")).to_contain_text(
        "the first 2\u202f000 of 3\u202f000\u202f013 characters"
    )
    shoot(card, "events-hostile")
    assert nb.python("print(len(hostile.get_state()['_new']) < 20_000)") == "True\n"


def test_in_a_player_a_click_goes_there_pointing_shows_that_moment_and_the_row_of_the_cursor_is_ink(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([RECORDING])
    nb.resize(1240, 720)
    output = nb.output(0)
    card = output.locator(".rw-events")
    now = output.locator(".rw-play-now")
    expect(row(card, "over current")).to_be_visible()
    shoot(output.locator(".rw-recording"), "events-player")
    row(card, "over current").click()
    expect(now).to_have_text("5.00")
    expect(card.locator('[aria-current="true"]')).to_contain_text("over current")
    eventually(lambda: nb.python("print(player.time)").strip(), "5.0")
    row(card, "lost the map").hover()
    expect(now).to_have_text("7.00")
    nb.page.mouse.move(0, 0)
    expect(now).to_have_text("5.00")
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("ArrowUp")
    expect(now).to_have_text("3.00")
    expect(card.locator(".rw-event:visible .rw-event-count").filter(has_text="× 5")).to_have_count(1)
    card.get_by_label("Only rows with these words (/)").fill("lost the")
    expect(row(card, "over current")).to_have_count(0)
    nb.page.keyboard.press("Enter")
    nb.page.keyboard.press("ArrowDown")
    expect(now).to_have_text("7.00")
    assert nb.python("print([mark[0] for mark in player.marks])").strip() == "[2.0, 5.0, 7.0]"
    nb.python("player.time = 9.5")
    expect(card.locator('[aria-current="true"]')).to_contain_text("lost the map")


def test_an_exported_page_has_the_list_which_leads_it(
    plain_page: Callable[..., PlainPage], static_page: Callable[[Path], Page], tmp_path: Path
) -> None:
    nb = plain_page([RECORDING])
    file = tmp_path / "page.html"
    nb.python(f"player.to_html({str(file)!r}, start=1, end=8)")
    page = static_page(file)
    card = page.locator(".rw-events")
    expect(rows(card)).to_have_count(4)
    row(card, "lost the map").click()
    expect(page.locator(".rw-play-now")).to_have_text("7.00")
    expect(card.locator('[aria-current="true"]')).to_contain_text("lost the map")
    shoot(page.locator("main"), "events-page")
