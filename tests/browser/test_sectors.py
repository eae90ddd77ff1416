"""Sectors of a laser's picture: dragged, named, moved and copied as code, by mouse, keys and finger."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import FAN, SETUP, Picture, Place, eventually, listen, locate, placed_words, words
from .notebook import CellError, Notebook
from .plain_page import PlainPage

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
RIM = 4.0
"""Metres: range_max of the fan."""
POINTER = (37, 99, 235)
CLIPBOARD = """() => {
    window.copied = [];
    Object.defineProperty(navigator, "clipboard", {
        value: { writeText: (text) => Promise.resolve(copied.push(text)) }, configurable: true,
    });
}"""
NO_CLIPBOARD = """() => {
    Object.defineProperty(navigator, "clipboard", { value: undefined, configurable: true });
    document.execCommand = () => false;
}"""


def drag(nb: PlainPage | Notebook, card: Locator, *points: tuple[float, float], up: bool = True) -> None:
    """Press at the first of some points of the picture, and move over the others."""
    box = card.locator(".rw-picture").bounding_box()
    assert box
    mouse = nb.page.mouse
    for i, (x, y) in enumerate(points):
        mouse.move(box["x"] + x, box["y"] + y)
        if i == 0:
            mouse.down()
    if up:
        mouse.up()


def arc(place: Place, metres: float, start: float, end: float) -> list[tuple[float, float]]:
    """Points along an arc, from one angle in degrees to another."""
    return [place.at(metres, start + (end - start) * i / 8) for i in range(9)]


def chip(card: Locator) -> Locator:
    return card.locator(".rw-chip")


def says(card: Locator, expression: str, distance: str) -> None:
    expect(chip(card).locator(".rw-chip-expression")).to_have_value(expression)
    expect(chip(card).locator(".rw-chip-distance")).to_have_text(distance)


def opened(plain_page: Callable[..., PlainPage], width: int = 700, **more: Any) -> tuple[PlainPage, Locator, Place]:
    nb = plain_page([FIRST], **more)
    nb.resize(width)
    card = nb.widget(0).locator(".rw-card")
    return nb, card, locate(card)


def test_a_drag_makes_a_sector_with_a_name_and_code_that_gives_its_number(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page)
    assert Picture(card).count(POINTER) == 0
    expect(chip(card)).to_have_count(0)
    drag(nb, card, *arc(place, 3.0, 2, 38))
    says(card, "ranges[9:14]", "1.68 m")
    expect(chip(card).locator(".rw-chip-angles")).to_have_text("0.0° to 40.0°")
    expect(chip(card).locator(".rw-index")).to_have_text("[9]")
    expect(chip(card).locator(".rw-chip-median")).to_have_text("median 1.72 m")
    expect(chip(card).locator(".rw-chip-valid")).to_have_text("5 of 5 valid")
    eventually(lambda: nb.python("laser.selection.slice"), "slice(9, 14, None)")
    expect(card.locator(".rw-popup:visible")).to_have_count(0)  # the end of a drag is not a click

    nb.page.evaluate(CLIPBOARD)
    for form, given in (
        ("scan", "scan=laser.scan"),
        ("message", "msg=laser.scan"),
        ("slice", "ranges=laser.scan.ranges"),
    ):
        chip(card).locator("select").select_option(form)
        chip(card).locator(".rw-copy").click()
        expect(chip(card).locator(".rw-copy")).to_have_text("Copied")
        code = nb.page.evaluate("() => copied.pop()")
        assert nb.python(f"print(laser.code(form={form!r}), end='')") == code
        head, _, last = code.rstrip().rpartition("\n")
        assert nb.python(f"{given}\n{head}\nprint(f'{{np.min({last}):.2f}}')") == "1.68\n", form

    nb.python("laser.update(**fan({10: 0.7}))")
    says(card, "ranges[9:14]", "0.70 m")
    nb.python("laser.update(**fan({10: 0.1}))")
    says(card, "ranges[9:14]", "too close")
    nb.python("laser.update(**fan({9: inf, 10: nan, 11: nan, 12: inf, 13: inf}))")
    says(card, "ranges[9:14]", "nothing")
    nb.python("laser.update(**fan())")

    chip(card).get_by_text("Name").click()
    nb.page.keyboard.type("<b>door</b>")
    nb.page.keyboard.press("Enter")
    eventually(lambda: nb.python("list(laser.sectors)"), "['<b>door</b>']")
    shoot(nb.widget(0), "laser-sector")
    nb.page.keyboard.press("Escape")
    expect(chip(card)).to_have_count(0)
    eventually(lambda: nb.python("laser.selection"), "")
    drag(nb, card, place.at(RIM, 20), up=True)  # a click on its rim picks it again
    says(card, "ranges[9:14]", "1.68 m")
    chip(card).get_by_text("Remove").click()
    eventually(lambda: nb.python("print(dict(laser.sectors))"), "{}\n")
    nb.page.mouse.move(5, 5)
    eventually(lambda: Picture(card).count(POINTER), 0)


def test_edges_move_and_escape_puts_back_what_was_also_while_frozen(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page)
    nb.python("laser.sectors['ahead'] = ('-10deg', '10deg'); laser.paused = True")
    start, end = place.at(RIM, -10), place.at(RIM, 10)
    drag(nb, card, end, *arc(place, 3.5, 10, 52))
    says(card, "ranges[8:15]", "1.66 m")
    eventually(lambda: nb.python("laser.sectors['ahead']"), "Sector('-10deg', '50deg')")
    drag(nb, card, start, *arc(place, 3.5, -10, -48), up=False)
    says(card, "ranges[4:15]", "1.58 m")
    nb.page.keyboard.press("Escape")
    nb.page.mouse.up()
    says(card, "ranges[8:15]", "1.66 m")
    drag(nb, card, start, *arc(place, 3.5, -10, 80))  # past the other edge
    says(card, "ranges[14:18]", "1.78 m")
    nb.page.keyboard.press("Control+z")
    says(card, "ranges[8:15]", "1.66 m")
    nb.page.keyboard.press("Control+z")
    eventually(lambda: nb.python("laser.sectors['ahead']"), "Sector('-10deg', '10deg')")
    nb.python("laser.selection = None")
    expect(chip(card)).to_have_count(0)
    drag(nb, card, *arc(place, 2.6, -80, -50), up=False)
    says(card, "ranges[1:5]", "1.52 m")
    nb.page.keyboard.press("Escape")
    nb.page.mouse.up()
    expect(chip(card)).to_have_count(0)


def test_keys_make_move_keep_walk_and_remove_sectors(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, _ = opened(plain_page)
    picture, keys, live = card.locator(".rw-picture"), nb.page.keyboard, card.locator(".rw-live")
    picture.focus()
    keys.press("[")
    says(card, "ranges[8:11]", "1.66 m")
    keys.press("ArrowLeft")
    keys.press("]")
    for _ in range(2):
        keys.press("ArrowRight")
    says(card, "ranges[7:13]", "1.64 m")
    expect(live).to_have_text("ranges[7:13], nearest [7] 1.64 m, 6 of 6 valid")
    keys.press("Shift+ArrowRight")
    says(card, "ranges[7:19]", "1.64 m")
    nb.page.evaluate(CLIPBOARD)
    keys.press("c")
    eventually(lambda: nb.page.evaluate("() => copied"), ['scan.distance(("-20deg", "90deg"))'])
    keys.press("Enter")
    keys.press("Enter")
    eventually(lambda: nb.python("list(laser.sectors)"), "['sector 1']")
    nb.python("laser.sectors['right'] = ('-90deg', '-60deg'); laser.selection = None")
    expect(chip(card)).to_have_count(0)
    for expected in ("right", "sector 1"):
        keys.press("Shift+Tab")
        expect(live).to_have_text(re.compile(f"^{expected}, "))
    keys.press("]")
    keys.press("ArrowLeft")
    says(card, "ranges[7:18]", "1.64 m")
    keys.press("Escape")  # undoes the edge
    says(card, "ranges[7:19]", "1.64 m")
    name = chip(card).locator(".rw-chip-name")
    chip(card).get_by_text("Rename").click()
    name.fill("right")
    name.press("Enter")  # would replace the other
    expect(chip(card).locator(".rw-chip-error")).to_have_text("there is a sector right already")
    assert nb.python("sorted(laser.sectors)") == "['right', 'sector 1']"
    name.press("Escape")
    expect(chip(card).locator(".rw-chip-error")).to_be_empty()
    keys.press("Delete")
    eventually(lambda: nb.python("list(laser.sectors)"), "['right']")
    keys.press("Control+z")
    expect(live).to_have_text("back: sector \u201csector 1\u201d")
    says(card, "ranges[7:19]", "1.64 m")
    keys.press("Delete")
    eventually(lambda: nb.python("list(laser.sectors)"), "['right']")
    nb.python("laser.pins = {'door': 3, 'same door': 3, 'gone': 99}")
    for expected in ("right", "door", "same door"):
        keys.press("Tab")
        expect(live).to_have_text(re.compile(f"^{expected}, "))
    expect(chip(card)).to_have_count(0)
    eventually(lambda: nb.python("laser.pinned"), "3")
    keys.press("Tab")
    eventually(lambda: nb.python("laser.pinned is None"), "True")
    assert not picture.evaluate("(picture) => document.activeElement === picture"), "focus leaves"


@pytest.mark.parametrize(("degrees", "rays"), [(270, 271), (180, 181), (360, 360), (60, 61)])
def test_the_chip_lies_on_no_reading_and_no_label(
    plain_page: Callable[..., PlainPage], degrees: int, rays: int
) -> None:
    scan = f"ranges=np.full({rays}, 3.9), angle_min=-np.radians({degrees / 2}), angle_increment=np.radians(1)"
    nb = plain_page([f"{SETUP}\nlaser.update({scan}, range_min=0.1, range_max=4.0)\nlaser"], run=False)
    listen(nb.page)
    nb.run_all()
    card = nb.widget(0).locator(".rw-card")
    angles = lambda: {word for word in words(card) if word.endswith("°")}  # noqa: E731
    for width in (760, 560, 420):
        nb.resize(width)
        eventually(lambda: "0.0°" in angles(), True)
        every = angles()
        for start in (-30, -10, 15):
            nb.python(f"laser.selection = ('{start}deg', '{start + 12}deg')")
            expect(chip(card).locator(".rw-chip-angles")).to_contain_text(f"{start}.0° to".replace("-", "−"))
            eventually(lambda every=every: angles() == every, True)
            eventually(lambda: under_chip(card), [])
        shoot(card, f"chip-{degrees}-{width}")
        is_inside = card.locator(".rw-picture .rw-chip").count() == 1
        assert is_inside or (degrees, width) != (60, 760), "it stands in a corner that is free"
        nb.python("laser.selection = None")
        expect(chip(card)).to_have_count(0)


def under_chip(card: Locator) -> list[object]:
    """The words and the dots of the picture that the chip lies on."""
    box, picture = chip(card).bounding_box(), card.locator(".rw-picture").bounding_box()
    assert box
    assert picture
    left, top = box["x"] - picture["x"], box["y"] - picture["y"]
    inside = lambda x, y: left < x < left + box["width"] and top < y < top + box["height"]  # noqa: E731
    dots = Picture(card).dots()
    return [text for text, x, y in placed_words(card) if inside(x, y)] + [dot for dot in dots if inside(*dot)]


def test_typed_rays_are_a_new_selection_and_those_of_the_chip_redefine_its_sector(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb, card, _ = opened(plain_page)
    nb.python("laser.sectors['ahead'] = ('-10deg', '10deg'); laser.selection = 'ahead'")
    ahead = "Sector('-10deg', '10deg')"
    field, keys = chip(card).locator(".rw-chip-expression"), nb.page.keyboard
    says(card, "ranges[8:11]", "1.66 m")
    for leave in ("Escape", "close"):
        card.locator(".rw-type").click()
        expect(field).to_be_focused()
        expect(field).to_have_value("")
        if leave == "Escape":
            keys.press("Escape")
        else:
            chip(card).locator(".rw-chip-close").click()
        says(card, "ranges[8:11]", "1.66 m")
    card.locator(".rw-picture").focus()
    keys.press("t")
    keys.type("ranges[14:30]")
    keys.press("Enter")
    expect(chip(card).locator(".rw-chip-error")).to_have_text("this scan has 19 rays, the last is ranges[18]")
    assert nb.python("print(laser.sectors['ahead'], laser.selection.name)") == f"{ahead} ahead\n"
    field.fill("ranges[14:17]")
    keys.press("Enter")
    says(card, "ranges[14:17]", "1.78 m")
    eventually(lambda: nb.python("laser.selection.slice"), "slice(14, 17, None)")
    assert nb.python("laser.sectors['ahead']") == ahead
    nb.python("laser.selection = 'ahead'")
    says(card, "ranges[8:11]", "1.66 m")
    field.fill("ranges[7:12]")
    keys.press("Enter")
    says(card, "ranges[7:12]", "1.64 m")
    eventually(lambda: nb.python("laser.sectors['ahead']"), "Sector('-20deg', '20deg')")


def test_rays_are_typed_and_an_invalid_entry_is_reported(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page)
    drag(nb, card, *arc(place, 3.0, 2, 38))
    field, error = chip(card).locator(".rw-chip-expression"), chip(card).locator(".rw-chip-error")
    for text in ("ranges[12", "alert(1)", "ranges[40:50]", "ranges[1:3] + ranges[8:9]"):
        field.fill(text)
        field.press("Enter")
        expect(error).not_to_be_empty()
    assert nb.python("laser.selection.slice") == "slice(9, 14, None)"
    field.press("Escape")
    says(card, "ranges[9:14]", "1.68 m")
    expect(error).to_be_empty()
    field.fill("ranges[-3:]")
    field.press("Enter")
    says(card, "ranges[16:19]", "1.82 m")
    eventually(lambda: nb.python("laser.selection.slice"), "slice(16, 19, None)")
    nb.python("laser.selection = None; laser.highlight('ranges[2:6]'); laser.pins = {'door': 3}")
    eventually(lambda: Picture(card).colour(*place.at(RIM, -50)), POINTER)
    eventually(lambda: POINTER in Picture(card).around(*ring(place.at(*FAN[3]))), True)
    nb.python("laser.highlight(None); laser.pins = {}")
    eventually(lambda: Picture(card).count(POINTER), 0)


def test_rays_are_typed_where_nothing_is_picked_also_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST, "LaserWidget()"])
    expect(nb.widget(1).locator(".rw-type")).to_be_disabled()  # no rays yet
    card, keys = nb.widget(0).locator(".rw-card"), nb.page.keyboard
    field, error, button = (card.locator(name) for name in (".rw-chip-expression", ".rw-chip-error", ".rw-type"))
    for width in (700, 400):
        nb.resize(width)
        place = locate(card)
        tops = card.locator(".rw-header .rw-button:visible").evaluate_all("(all) => all.map((one) => one.offsetTop)")
        assert len(set(tops)) == 1, "the controls are in one row"
        with nb.busy():
            button.click()
            expect(field).to_be_focused()
            expect(chip(card).get_by_role("button")).to_have_count(1)  # the key that closes it
            keys.type("ranges[9:14")
            keys.press("Enter")
            expect(error).to_have_text("expected a slice, as ranges[240:300]")
            assert Picture(card).count(POINTER) == 0
            chip(card).get_by_role("button").click()
            expect(chip(card)).to_have_count(0)
            keys.press("t")
            expect(field).to_be_focused()
            keys.type("ranges[9:14]")
            keys.press("Enter")
            says(card, "ranges[9:14]", "1.68 m")
            eventually(lambda place=place: Picture(card).colour(*place.at(RIM, 20)), POINTER)
            keys.press("t")
            keys.type("ranges[40:50]")
            keys.press("Enter")
            expect(error).to_have_text("this scan has 19 rays, the last is ranges[18]")
            assert Picture(card).colour(*place.at(RIM, 20)) == POINTER, "what was lit stays"
        assert nb.python("laser.pinned, laser.selection.slice") == "(None, slice(9, 14, None))"
        for _ in range(2):  # leaves the field, then deselects
            keys.press("Escape")
        expect(chip(card)).to_have_count(0)
        keys.press("t")
        keys.press("Escape")
        expect(chip(card)).to_have_count(0)
        expect(card.locator(".rw-picture")).to_be_focused()


def ring(middle: tuple[float, float]) -> tuple[float, float]:
    """A point of the ring round a pinned reading."""
    return middle[0] - 6, middle[1]


def test_an_edge_where_the_scanner_has_no_rays_is_in_the_picture_too(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, _ = opened(plain_page)
    nb.python("laser.sectors['left'] = 'left'; laser.pins = {'door': 0}; laser.update(**fan({0: inf}))")
    place = locate(card, FAN[1:])
    drag(nb, card, place.at(RIM, 135), *arc(place, 3.5, 135, 80))
    eventually(lambda: nb.python("laser.sectors['left']"), "Sector('45deg', '80deg')")
    shoot(nb.widget(0), "laser-sector-beyond")


def test_an_empty_scan_leaves_the_scanner_in_the_middle(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page)
    listen(card)
    nb.python("laser.sectors['ahead'] = ('-10deg', '10deg'); laser.update(**fan(ranges=[]))")
    expect(card.locator(".rw-empty")).to_contain_text("the scan has no rays")
    eventually(lambda: [abs(x - place.x) < 30 for word, x, _ in placed_words(card) if word == "ahead"], [True])


def test_code_is_copied_by_hand_if_there_is_no_clipboard(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page, width=400)
    nb.page.evaluate(NO_CLIPBOARD)
    drag(nb, card, *arc(place, 3.0, 2, 38))
    expect(card.locator(".rw-picture .rw-chip")).to_have_count(0)  # below a narrow picture
    chip(card).locator(".rw-copy").click()
    field = chip(card).locator(".rw-code")
    expect(field).to_have_value('scan.distance(("0deg", "40deg"))')
    selected = field.evaluate("(field) => field.value.slice(field.selectionStart, field.selectionEnd)")
    assert selected == 'scan.distance(("0deg", "40deg"))'
    expect(field).to_be_focused()
    chip(card).locator(".rw-chip-close").click()
    card.locator(".rw-picture").click(position=dict(zip("xy", place.at(*FAN[4]), strict=True)))  # type: ignore[arg-type]
    nb.page.evaluate(CLIPBOARD)
    card.locator(".rw-popup .rw-copy").first.click()
    eventually(lambda: nb.page.evaluate("() => copied"), ['scan.distance(("-50.1deg", "-49.9deg"))'])
    assert nb.python("laser.code(4)") == repr('scan.distance(("-50.1deg", "-49.9deg"))')
    for form in ("message", "slice"):
        card.locator(".rw-popup select").first.select_option(form)
        card.locator(".rw-popup .rw-copy").first.click()
        eventually(lambda: len(nb.page.evaluate("() => copied")), 2)
        assert nb.python(f"print(laser.code(4, form={form!r}), end='')") == nb.page.evaluate("() => copied.pop()")
    card.locator(".rw-popup select").first.select_option("scan")
    card.locator(".rw-popup select").first.press("ArrowDown")
    expect(card.locator(".rw-popup select").first).to_have_value("message")
    assert nb.python("laser.pinned") == "4", "keys in the list do not walk the rays"
    nb.python("laser.pinned = 400")
    expect(card.locator(".rw-popup").first).to_contain_text("this scan has 19 rays")
    expect(card.locator(".rw-popup .rw-copy").first).to_be_hidden()


def test_a_finger_drags_from_the_rim_and_scrolls_the_page_elsewhere(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, place = opened(plain_page, touch=True)
    box = card.locator(".rw-picture").bounding_box()
    assert box
    session = nb.page.context.new_cdp_session(nb.page)

    def swipe(points: list[tuple[float, float]]) -> None:
        for kind, at in [("touchStart", points[0]), *(("touchMove", point) for point in points), ("touchEnd", None)]:
            touches = [{"x": box["x"] + at[0], "y": box["y"] + at[1]}] if at else []
            session.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": touches})

    swipe(arc(place, 2.6, 2, 38))
    eventually(lambda: nb.python("laser.selection"), "")
    swipe(arc(place, RIM, 2, 38))
    says(card, "ranges[9:14]", "1.68 m")
    eventually(lambda: nb.python("laser.selection.slice"), "slice(9, 14, None)")


def test_a_sector_runs_across_the_seam_of_any_scanner(plain_page: Callable[..., PlainPage]) -> None:
    nb, card, _ = opened(plain_page)
    for step in (1, -1):
        nb.python("laser.selection = None")
        angles = f"angle_min=0.0, angle_increment=np.radians({step})"
        nb.python(f"laser.update(ranges=np.full(360, 2.0), {angles}, range_min=0.6, range_max=4.0)")
        nb.python("laser.selection = ('-10deg', '10deg')")
        says(card, "ranges[350:] + ranges[:11]", "2.00 m")
        place = Picture(card).circle(2.0)
        drag(nb, card, place.at(RIM, 10), *arc(place, RIM, 10, 20))
        says(card, "ranges[350:] + ranges[:21]" if step > 0 else "ranges[340:] + ranges[:11]", "2.00 m")
        drag(nb, card, *arc(place, 3.0, 170, 200))
        says(card, "ranges[170:201]" if step > 0 else "ranges[160:191]", "2.00 m")


@pytest.mark.core
def test_in_a_busy_notebook_a_drag_becomes_code_that_runs_in_the_next_cell(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([FIRST, "import time\nwhile True:\n    time.sleep(0.1)"], run=False)
    nb.run(0)
    card = nb.widget(0).locator(".rw-card")
    place = locate(card)
    nb.start(1)
    nb.page.evaluate(CLIPBOARD)
    drag(nb, card, *arc(place, 3.0, 2, 38))
    says(card, "ranges[9:14]", "1.68 m")
    keys = nb.page.keyboard
    keys.press("Enter")
    keys.type("door")
    keys.press("Enter")
    expect(chip(card)).to_have_attribute("aria-label", "sector door")
    keys.press("c")
    eventually(lambda: nb.page.evaluate("() => copied.length"), 1)
    # The keys reached the field and the picture, not the notebook.
    expect(nb.page.locator(".jp-Notebook .jp-Cell")).to_have_count(2)
    expect(nb.page.locator(".jp-Notebook.jp-mod-editMode")).to_have_count(0)
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(1)
    code = nb.page.evaluate("() => copied[0]")
    assert run_new(nb, f"scan = laser.scan\nprint({code})") == "1.68\n"
    assert run_new(nb, "print(laser.distance('door'), laser.selection.slice)") == "1.68 slice(9, 14, None)\n"


def run_new(nb: Notebook, source: str) -> str:
    """Run a new cell and return its printed text."""
    index = nb.append(source)
    nb.run(index)
    return nb.text(index)
