"""Frozen, a widget steps back through its history; live, it shows the texts of a feed and the age of its data."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .laser import SETUP, eventually, layers
from .plain_page import PlainPage
from .test_laser_live import FIRST, freeze_of, nearest

LOOP = "n = n % 800 + 1\nlaser.update(**fan({9: 0.6002 + n / 1000, 17: nan}))\nsum(range(10_000))"
BACK = re.compile(r"^−\d\.\d\d s from newest$")
# The position of the picture in its card, and the height of the card.
BOXES = """(card) => {
    const [outer, inner] = [card, card.querySelector(".rw-picture")].map((e) => e.getBoundingClientRect());
    return [[inner.x - outer.x, inner.y - outer.y, inner.width, inner.height], outer.height];
}"""
# Sample n has its nearest reading at n centimetres more than 0.6 m.
TWENTY = f"{SETUP}\nfrom robowidgets.widget.pacer import pacer\n" + (
    "def feed(*numbers):\n"
    "    for n in numbers:\n"
    "        laser.update(**fan({9: 0.6 + n / 100}))\n"
    "        pacer.flush()\n"
    "laser"
)


def time_of(card: Locator) -> Locator:
    return card.locator(".rw-time")


def slider_of(card: Locator) -> Locator:
    return card.get_by_role("slider", name="Sample on show")


def is_at(card: Locator, place: int, count: int) -> None:
    expect(slider_of(card)).to_have_attribute("aria-valuetext", re.compile(rf", {place} of {count}$"))


def test_in_the_middle_of_an_endless_loop_it_steps_and_drags(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([f"n = 0\n{FIRST}"])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    bar, slider = card.locator(".rw-steps"), slider_of(card)
    expect(bar).to_be_hidden()
    with nb.busy(LOOP):
        for _ in range(8):
            shown = nearest(card)
            expect(card.locator(".rw-nearest")).not_to_have_text(shown)
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("Space")
        expect(bar).to_be_visible()
        since = freeze_of(card).inner_text()
        held = layers(card)
        for _ in range(12):
            nb.page.keyboard.press(",")
        expect(time_of(card)).to_have_text(BACK)
        assert layers(card) != held
        for _ in range(12):
            nb.page.keyboard.press(".")
        eventually(lambda: layers(card) == held, True)
        card.get_by_role("button", name="One sample back (,)").click()
        card.get_by_role("button", name="One sample on (.)").click()
        eventually(lambda: layers(card) == held, True)

        box = slider.bounding_box()
        assert box is not None
        nb.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        nb.page.mouse.down()
        nb.page.mouse.move(box["x"] + 2, box["y"] + box["height"] / 2, steps=10)
        nb.page.mouse.up()
        first = re.compile(r"^(earlier|[\d.]+ seconds before the newest), 1 of \d+$")
        expect(slider).to_have_attribute("aria-valuetext", first)
        assert layers(card) != held
        expect(freeze_of(card)).not_to_have_text(since)  # it keeps coming, and counting
        nb.page.keyboard.press("ArrowRight")
        expect(slider).to_have_attribute("aria-valuetext", re.compile(r" seconds before the newest, 2 of \d+$"))
        expect(card.locator(".rw-popup:visible")).to_have_count(0)
        nb.page.keyboard.press("End")
        for words in ("Freeze", re.compile("^Frozen"), "Freeze"):
            nb.page.keyboard.press("Space")
            expect(freeze_of(card)).to_have_text(words)
        expect(bar).to_be_hidden()
    newest = float(nb.python("0.6002 + n / 1000"))
    expect(card.locator(".rw-nearest")).to_have_text(re.compile(rf"^nearest {newest:.2f} m "))


def test_python_and_a_second_view_have_the_sample_stepped_to(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([TWENTY, "feed(*range(1, 20))\nlaser"])
    card, second = (nb.widget(i).locator(".rw-card") for i in (0, 1))
    expect(card.locator(".rw-nearest")).to_have_text(re.compile("^nearest 0.79 m"))
    freeze_of(card).click()
    is_at(card, 19, 19)
    expect(time_of(card)).to_have_text("newest")
    for _ in range(4):
        nb.page.keyboard.press(",")
    for view in (card, second):
        is_at(view, 15, 19)
        expect(view.locator(".rw-nearest")).to_have_text(re.compile("^nearest 0.75 m"))
        expect(freeze_of(view)).to_have_text("Frozen · 4 since")
    look = "print(f'{laser.frozen.nearest().range:.2f}' if laser.frozen else None)"
    eventually(lambda: nb.python(look), "0.75\n")
    nb.python("feed(20, 21)")
    is_at(card, 15, 21)
    expect(freeze_of(card)).to_have_text("Frozen · 6 since")

    slider_of(card).press("ArrowRight")
    expect(card.locator(".rw-nearest")).to_have_text(re.compile("^nearest 0.76 m"))
    eventually(lambda: nb.python(look), "0.76\n")
    freeze_of(card).click()
    expect(card.locator(".rw-nearest")).to_have_text(re.compile("^nearest 0.81 m"))
    eventually(lambda: nb.python(look), "None\n")

    # Python freezes: the page finds the sample in its history. Without a history it cannot step.
    nb.python("feed(22); laser.paused = True")
    is_at(card, 22, 22)
    nb.page.keyboard.press(",")
    eventually(lambda: nb.python(look), "0.81\n")
    nb.python("laser.paused = False; laser.history = 0; feed(23, 24); laser.paused = True")
    expect(freeze_of(card)).to_have_text("Frozen · 0 since")
    expect(card.locator(".rw-steps")).to_be_hidden()


def test_speeds_and_touches_of_an_earlier_sample_are_right(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        [
            "from robowidgets import SpeedWidget, TouchWidget\nfrom robowidgets.widget.pacer import pacer\n"
            "speed, touch = SpeedWidget(hold_peaks=True), TouchWidget()\nspeed",
            "touch",
            "for n in range(1, 5):\n"
            "    speed.update(linear=(n / 10, 0, 0), angular=(0, 0, 0))\n"
            # Nothing is touched at the end: messages about the duration of a touch would be further samples.
            "    touch.update(left=n % 2 == 1, right=n == 2)\n"
            "    pacer.flush()",
        ]
    )
    bars, tiles = nb.widget(0).locator(".rw-card"), nb.widget(1).locator(".rw-card")
    for card in (bars, tiles):
        freeze_of(card).click()
        is_at(card, 4, 4)
        nb.page.keyboard.press(",")
        is_at(card, 3, 4)
    eventually(lambda: nb.python("print(speed.frozen.linear[0], speed.peaks['linear.x'])"), "0.3 (0.1, 0.3)\n")
    expect(tiles.locator(".rw-tile")).to_have_text(["lefttouched0.0 s", "rightfree1 touch"])
    eventually(
        lambda: nb.python("print({n: s.name for n, s in touch.frozen.items()}, touch.touches)"),
        "{'left': 'TOUCHED', 'right': 'FREE'} {'left': 2, 'right': 1}\n",
    )


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_the_bar_moves_nothing(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    feed = (
        "from robowidgets import SpeedWidget, TouchWidget\n"
        "speed, touch = SpeedWidget(title='/odom'), TouchWidget(title='/bumper')\n"
        "feed(*range(1, 9))\n"
        "for n in range(3):\n"
        "    speed.update(linear=(n / 3, 0, 0), angular=(0, 0, n / 5))\n"
        "    touch.update(left=n == 1, center=False, right=n == 2)\n"
        "    pacer.flush()\n"
        "speed"
    )
    nb = plain_page([TWENTY, feed, "touch"], scale=scale, theme=theme)
    for width in (320, 1200):
        nb.resize(width)
        for index, name in enumerate(("laser", "speed", "touch")):
            card = nb.widget(index).locator(".rw-card")
            expect(card.locator(".rw-empty")).to_be_hidden()
            picture, height = card.evaluate(BOXES)
            freeze_of(card).click()
            nb.page.keyboard.press(",")
            expect(card.locator(".rw-steps")).to_be_visible()
            frozen_picture, frozen_height = card.evaluate(BOXES)
            assert frozen_picture == picture
            assert frozen_height == pytest.approx(height, abs=0 if width > 459 else 16)
            shoot(card, f"history-{name}-{theme}-{width}")
            freeze_of(card).click()


def test_a_finger_drags(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([TWENTY, "feed(*range(1, 20))"], touch=True)
    nb.resize(320)
    card = nb.widget(0).locator(".rw-card")
    freeze_of(card).tap()
    is_at(card, 19, 19)
    box = slider_of(card).bounding_box()
    assert box is not None
    y, right, left = box["y"] + box["height"] / 2, box["x"] + box["width"] - 6, box["x"] + 2
    screen = nb.page.context.new_cdp_session(nb.page)
    for kind, points in (
        ("touchStart", [{"x": right, "y": y}]),
        ("touchMove", [{"x": (right + left) / 2, "y": y}]),
        ("touchMove", [{"x": left, "y": y}]),
        ("touchEnd", []),
    ):
        screen.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})
    is_at(card, 1, 19)
    expect(card.locator(".rw-nearest")).to_have_text(re.compile("0.61 m"))


def test_silence_and_the_messages_of_a_feed_are_shown(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([TWENTY])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    facts, notice, empty, silence = (
        card.locator(f".rw-{name}") for name in ("facts", "notice-text", "empty", "silence")
    )
    nb.python(
        "laser._source = {'topic': '/scan', 'type': 'sensor_msgs/msg/LaserScan', 'status': 'waiting for <b>/scan'}"
    )
    expect(empty).to_have_text("waiting for <b>/scan")
    expect(notice).to_be_hidden()
    nb.python(
        "import threading, time\n"
        "def flow():\n"
        "    while flows: feed(3); time.sleep(0.05)\n"
        "flows = True\n"
        "threading.Thread(target=flow).start()"
    )
    expect(empty).to_be_hidden()
    expect(notice).to_have_text("waiting for <b>/scan")
    expect(notice).to_have_css("color", "rgb(95, 107, 122)")
    expect(facts).to_have_text(re.compile(r"^laser\s·\s19 rays\s·\s\d+\.\d Hz$"))
    nb.python("laser._source = {**laser._source, 'status': ''}")
    expect(notice).to_be_hidden()
    card.locator(".rw-title").hover()
    expect(card.locator(".rw-header")).to_have_attribute(
        "title",
        re.compile(r"^/scan\nsensor_msgs/msg/LaserScan\nlaser\s·\s19 rays\s·\s\d+\.\d Hz\nnewest \d\.\d s ago$"),
    )
    nb.python("flows = False")
    expect(silence).to_have_text(re.compile(r"^no data for 2\.\d s$"))
    expect(facts).to_have_text(re.compile(r"^laser\s·\s19 rays$"))
    expect(silence).to_have_text(re.compile(r"^no data for 3\.\d s$"))
    nb.resize(320)
    expect(silence).to_be_visible()
    nb.python(
        "laser._source = {**laser._source, 'status': 'connection lost, trying again in 2 s'}\n"
        "try: laser.update(ranges='x')\n"
        "except (TypeError, ValueError): pass"
    )
    expect(notice).to_have_class(re.compile("rw-error"))
    expect(notice).to_have_text(re.compile(r"^connection lost, trying again in 2 s · .* Showing the last good scan\.$"))
    shoot(card, "silence-error-light-320")
    nb.python("feed(9)")
    expect(silence).to_be_hidden()
