"""The picture of a laser scan."""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .chromium import shoot
from .laser import DARK, FAN, LIGHT, SETUP, Picture, eventually, layers, listen, locate, words
from .notebook import Notebook
from .plain_page import PlainPage

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
SEEN = (43, 51, 59)
"""Free space in the dark."""
CIRCLE = [(2 + 0.05 * i, 20.0 * i) for i in range(18)]


def card_of(nb: Notebook, index: int = 0) -> Locator:
    return nb.widget(index).locator(".rw-card")


def test_every_reading_stands_at_its_place_in_the_area(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    nb.resize(700)
    card = card_of(nb)
    place, picture = locate(card), Picture(card)
    for metres, degrees in ((0.7, -25), (1.2, 35), (2.5, -35), (3.9, 55)):
        assert picture.around(*place.at(metres, degrees)) == {LIGHT["area"]}, "within limits and sweep"
    for metres, degrees in ((0.5, -25), (0.5, 45), (0.3, 150), (0.3, -150), (0.2, 180)):
        assert picture.around(*place.at(metres, degrees)) == {picture.paper}, "too close, or not swept"
    for metres, degrees in ((2, -35), (3, -35), (1.2, 0), (3.5, 90), (3.5, -90)):
        assert picture.around(*place.at(metres, degrees)) - {LIGHT["area"], picture.paper}, "arcs and rays"
    assert LIGHT["ink"] in picture.around(place.x, place.y - 6), "the robot looks up"
    assert picture.colour(place.x, place.y + 6) == picture.paper
    expect(card.locator(".rw-title")).to_have_text("/scan")
    expect(card.locator(".rw-facts")).to_contain_text("laser · 19 rays")
    expect(card.locator(".rw-nearest")).to_have_text("nearest 1.52 m at −80.0° [1]")

    for forward, nose in (("right", (6, 0)), ("down", (0, 6)), ("left", (-6, 0))):
        nb.python(f"laser.forward = {forward!r}")
        turned = locate(card, forward=forward)
        eventually(lambda t=turned, n=nose: LIGHT["ink"] in Picture(card).around(t.x + n[0], t.y + n[1]), True)
    nb.python("laser.forward = 'up'")

    nb.python("laser.update(**fan(angle_min=np.pi / 2, angle_increment=-np.pi / 18))")
    locate(card, [(metres, -degrees) for metres, degrees in FAN])
    circle = "ranges=2 + 0.05 * np.arange(18), angle_min=0.0, angle_increment=np.pi / 9"
    nb.python(f"laser.update(**fan() | dict({circle}))")
    round_about = locate(card, CIRCLE)
    assert Picture(card).colour(*round_about.at(3.5, 190)) == LIGHT["area"]
    nb.python("laser.angle_offset = np.pi / 2")
    locate(card, [(metres, degrees + 90) for metres, degrees in CIRCLE])
    nb.python("laser.angle_offset = 0; laser.update(**fan() | dict(ranges=[3.0], angle_min=0.0, angle_increment=nan))")
    eventually(lambda: len(Picture(card).dots()), 1)
    expect(card.locator(".rw-facts")).to_contain_text("laser · 1 ray")
    expect(card.locator(".rw-notice")).to_contain_text("one ray, angle_increment is not a number: drawn at angle_min")


def test_arcs_and_rays_are_labelled_and_change_while_it_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST], run=False)
    listen(nb.page)
    nb.run_all()
    nb.resize(700)
    card = card_of(nb)
    every = {f"{a}.0°".replace("-", "−") for a in (-90, -60, -30, 0, 30, 60, 90)}
    eventually(lambda: {word for word in words(card) if word.endswith("°")}, every)
    eventually(lambda: {word for word in words(card) if word.endswith(" m")}, {"1 m", "2 m", "3 m", "4 m"})
    rows = [
        ("laser.arc_count = 2", {"2 m", "4 m"}),
        ("laser.arc_distances = [0.75, 3.5, 50]", {"0.75 m", "3.5 m"}),
        ("laser.arc_count = 0; laser.arc_distances = []", set()),
    ]
    for code, arcs in rows:
        nb.python(code)
        eventually(lambda: {word for word in words(card) if word.endswith(" m")}, arcs)
    nb.python("laser.ray_count = 3")
    eventually(lambda: words(card), {"−90.0°", "[0]", "0.0°", "[9]", "90.0°", "[18]"})
    nb.python("laser.ray_count = 0; laser.arc_count = 4")
    eventually(lambda: words(card), {"1 m", "2 m", "3 m", "4 m"})
    nb.python("laser.update(**fan(range_max=10.0))")
    eventually(lambda: words(card), {"2.5 m", "5 m", "7.5 m", "10 m"})
    nb.python(
        "laser.ray_count = 1; laser.arc_count = 0; laser.update(**fan() | dict(ranges=np.full(1040, 3.0),"
        "angle_min=np.radians(-130), angle_increment=np.radians(0.25)))"
    )
    eventually(lambda: words(card), {"0.0°", "[520]"})
    nb.python("laser.ray_angles = ['-45deg', 0.5, 3.0]")
    eventually(lambda: words(card), {"−45.0°", "[340]", "28.8°", "[635]"})


def test_an_empty_picture_says_why_and_words_stay_words(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"{SETUP}\nlaser.title = '<b>/scan</b> &amp;'\nlaser"])
    card = card_of(nb)
    empty = card.locator(".rw-empty")
    expect(empty).to_have_text("waiting for a scan")
    eventually(lambda: Picture(card).count(LIGHT["area"]) > 10_000, True)
    nowhere = "no readings: none of the 19 rays lies within 0.6 m to 4 m"
    rows = [
        ("np.full(19, inf)", "no readings: all 19 rays say +inf, nothing in range"),
        ("np.full(19, -inf)", "no readings: all 19 rays say -inf, too close"),
        ("np.full(19, nan)", "no readings: all 19 rays say NaN, no measurement"),
        ("np.zeros(19)", "no readings: all 19 rays say 0 m, outside 0.6 m to 4 m"),
        ("np.linspace(5, 6, 19)", nowhere),
        ("[inf] * 9 + [nan] * 10", nowhere),
        ("[]", "the scan has no rays"),
    ]
    for ranges, what in rows:
        nb.python(f"laser.update(**fan() | dict(ranges={ranges}))")
        remedy = nb.python("print(laser.scan.problems()[0].remedy)").strip()
        expect(empty).to_have_text(f"{what} {remedy}")
        expect(card.locator(".rw-nearest")).to_have_text("too close at −90.0° [0]" if "-inf" in ranges else "")
        assert Picture(card).dots() == []
    nb.python("laser.update(**fan(header={'frame_id': '<img src=x onerror=alert(1)>'}, angle_max=np.pi))")
    expect(empty).to_be_hidden()
    expect(card.locator(".rw-facts")).to_contain_text("<img src=x onerror=alert(1)> · 19 rays")
    expect(card.locator(".rw-title")).to_have_text("<b>/scan</b> &amp;")
    expect(card.locator("img, .rw-title b")).to_have_count(0)
    expect(card.locator(".rw-notice-text")).to_have_text(re.compile("^19 rays, but the header implies 28"))
    locate(card)
    nb.python("laser.update(**fan(intensities=[1.0, 2.0]))")
    expect(card.locator(".rw-notice-text")).to_have_text("2 intensities for 19 rays: not used")
    nb.python("laser.update(**fan())")
    expect(card.locator(".rw-notice")).to_be_hidden()


def test_marks_header_and_footer_are_switched(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        [f"{SETUP}\nlaser.update(**fan({{3: inf, 4: inf, 7: -inf, 11: nan, 12: nan, 13: nan, 15: 0.3}}))\nlaser"]
    )
    nb.resize(740)
    card = card_of(nb)
    counts = {"nothing_in_range": "2", "too_close": "1", "no_measurement": "3", "outside_limits": "1"}
    expect(card.locator(".rw-class-reading")).to_have_text(re.compile("12.*readings"))
    expect(card.locator(".rw-nearest")).to_have_text("too close at −20.0° [7]")
    for name, count in counts.items():
        button = card.locator(f".rw-class-{name}")
        expect(button.locator("b")).to_have_text(count)
        shown = layers(card)
        button.click()
        expect(button).to_have_attribute("aria-pressed", "false")
        eventually(lambda s=shown: layers(card) != s, True)
        assert len(Picture(card).dots()) == 12
    eventually(lambda: nb.python("laser.marks"), "[]")
    card.locator(".rw-class-no_measurement").click()
    eventually(lambda: nb.python("laser.marks"), "['no_measurement']")
    nb.python("laser.header = False; laser.footer = False")
    expect(card.locator(".rw-header")).to_be_hidden()
    expect(card.locator(".rw-footer")).to_be_hidden()
    expect(card.locator(".rw-layer").first).to_be_visible()
    nb.python("laser.header = True; laser.footer = True")
    expect(card.locator(".rw-header")).to_be_visible()
    expect(card.locator(".rw-class-too_close")).to_have_attribute("aria-pressed", "false")


def test_colours_follow_theme_and_intensities_and_every_size_is_sharp(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"{SETUP}\nlaser.update(**fan(intensities=100.0 * np.arange(19)))\nlaser"], scale=2, run=False)
    listen(nb.page)
    nb.run_all()
    card = card_of(nb)
    sharp = """(card) => [...card.querySelectorAll(".rw-layer")].every((layer) => {
        const { width, height } = layer.getBoundingClientRect();
        return layer.width === Math.round(2 * width) && layer.height === Math.round(2 * height);
    })"""
    for width in (320, 700, 500):
        nb.resize(width)
        eventually(lambda: card.evaluate(sharp), True)
        place = locate(card)
        assert Picture(card).colour(*place.at(2.5, -35)) == LIGHT["area"]
    nb.theme("dark")
    dark = locate(card, colour=DARK["reading"])
    assert Picture(card).colour(*dark.at(2.5, -35)) == DARK["area"]
    nb.theme("light")
    locate(card)

    nb.python("laser.color_by_intensity = True")
    eventually(lambda: Picture(card).dots(), [])
    assert {"intensity 0", "1800"} <= words(card)
    for colour, is_left in (((0x44, 0x01, 0x54), False), ((0x95, 0xD8, 0x40), True)):
        picture = Picture(card)
        [(x, _)] = [dot for dot in picture.dots(colour) if dot[1] < picture.height - 30]  # the scale is below
        assert (x < picture.width / 2) is is_left, "the least is dark, the most is bright"


def test_free_space_is_cut_out_of_the_area_when_asked_for(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST], theme="dark")
    nb.resize(700)
    card = card_of(nb)
    place = locate(card, colour=DARK["reading"])
    free, taken = place.at(1.2, 35), place.at(2.5, -35)
    assert {Picture(card).colour(*free), Picture(card).colour(*taken)} == {DARK["area"]}
    nb.python("laser.free_space = True")
    eventually(lambda: Picture(card).colour(*free), SEEN)
    assert Picture(card).colour(*taken) == DARK["area"], "behind a reading it is unknown"
    shoot(card, "free-space-dark")
    nb.python("laser.update(**fan({i: nan for i in range(10, 15)} | {5: inf}))")
    eventually(lambda: Picture(card).colour(*free), DARK["area"])
    eventually(lambda: Picture(card).colour(*place.at(2.5, -40)), SEEN)
