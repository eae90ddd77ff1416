"""The speed widget on a page."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .plain_page import PlainPage

SPEED = """
from math import inf, nan
from robowidgets import SpeedWidget
speed = SpeedWidget(title="/odom", command_title="/cmd_vel")
speed
"""
STATES = """
from math import inf, nan
from robowidgets import SpeedWidget
def widget(linear, angular, **more):
    speed = SpeedWidget(title="/odom", command_title="/cmd_vel", **more)
    speed.update({"child_frame_id": "base_footprint", "twist": {"twist": {
        "linear": dict(zip("xyz", linear)), "angular": dict(zip("xyz", angular))}}})
    return speed
waiting = SpeedWidget(title="/odom")
usual = widget((0.62, 0, 0), (0, 0, -1.24))
usual.command(linear=(0.6, 0, 0), angular=(0, 0, -1.1))
measured = widget((0.62, 0.08, -0.99), (-0.01, -0.02, -0.30))
planar = widget((0.18, 0, 0), (0, 0, 1.2), planar=True, linear_limits=0.22, angular_limits=2.84, hold_peaks=True)
planar.update(linear=(0.1, 0, 0), angular=(0, 0, -0.4))
planar.command(linear=(0.15, 0, 0), angular=(0, 0, -0.5))
odd = widget((nan, inf, -12.5), (0.5, 2.345, 1.0), hold_peaks=True,
             limits={"linear.x": (-0.2, 0.5), "angular.y": (-0.5, 2), "angular.z": (-0.25, 1.25)})
odd.command(linear=(0.6, 3, 0), angular=(nan, 0, -1.1))
slow = widget((0.012, -0.0034, 0), (0.02, 0, -0.05), linear_limits=(0, 0.02), angular_limits=0.05)
fast = widget((123.456, 12345.678, -0.1), (0, -1e9, 3.14159), linear_limits=(-10, 130), angular_limits=3.2)
frozen = widget((0.3, 0.1, 0.25), (0, 0, 1.5), planar=True, hold_peaks=True)
frozen.get_state()
frozen.paused = True
for _ in range(37):
    frozen.update(linear=(0, 0, 0), angular=(0, 0, 0))
commands = SpeedWidget(title="/cmd_vel")
commands.command(linear=(0.4, 0, 0), angular=(0, 0, -1.3))
car = SpeedWidget(title="/drive", bars="commanded", linear_limits=None, angular_limits=None)
car.update({"drive": {"speed": 1.5, "steering_angle": -0.31}})
steered = widget((1.38, 0, 0), (0, 0, -0.9), planar=True, linear_limits=None, angular_limits=None)
steered.command({"drive": {"speed": 1.5, "steering_angle": -0.31}})
refused = widget((0.62, 0, 0), (0, 0, -1.24))
try:
    refused.update({"ranges": [1]})
except TypeError:
    pass
"""
NAMES = [
    *(
        "waiting",
        "usual",
        "measured",
        "planar",
        "odd",
        "slow",
        "fast",
        "frozen",
        "commands",
        "car",
        "steered",
        "refused",
    ),
]

OVERLAPS = """(card) => {
    const box = (element) => element.getBoundingClientRect();
    const isShown = (element) => element.offsetWidth > 0 && element.textContent;
    const words = [...card.querySelectorAll(
        ".rw-value, .rw-command, .rw-axis-state, .rw-axis-name, .rw-scale-label, .rw-limit-label, .rw-heading")]
        .filter(isShown).map((element) => {
            const range = document.createRange();
            range.selectNodeContents(element);
            return { text: element.textContent, box: range.getBoundingClientRect() };
        });
    const picture = box(card.querySelector(".rw-picture"));
    const outside = (a) => a.left < picture.left || a.right > picture.right + 0.5;
    const over = (a, b) => a.left < b.right - 0.5 && b.left < a.right - 0.5
        && a.top < b.bottom - 2 && b.top < a.bottom - 2;
    return words.flatMap((a, i) => [
        ...(outside(a.box) ? [a.text + " leaves the picture"] : []),
        ...words.slice(i + 1).filter((b) => over(a.box, b.box)).map((b) => a.text + " touches " + b.text),
    ]);
}"""

PLACES = """(card) => [...card.querySelectorAll(".rw-track, .rw-footer")]
    .map((element) => JSON.stringify(element.getBoundingClientRect()))"""


def of_each(cards: Locator, faults: str) -> list[str]:
    """The faults that a script finds in any of some cards."""
    found: list[str] = cards.evaluate_all(f"(cards) => cards.flatMap({faults})")
    return found


def axis(widget: Locator, name: str) -> Locator:
    """The column of an axis, like "angular.z"."""
    group, letter = name.split(".")
    return widget.locator(f"[data-axis='{(3 if group == 'angular' else 0) + 'xyz'.index(letter)}']")


def value(widget: Locator, name: str) -> Locator:
    """The number of an axis."""
    return axis(widget, name).locator(".rw-value")


def drawn(widget: Locator, name: str, part: str) -> float:
    """The speed at which a part of an axis is drawn, from the positions of zero and the limits of -1 and 1."""
    speed: float = axis(widget, name).evaluate(
        """(column, part) => {
            const box = (element) => element.getBoundingClientRect();
            const middle = ({ top, bottom }) => (top + bottom) / 2;
            const [low, high] = [...column.querySelectorAll(".rw-limit")].map((line) => box(line).bottom);
            const zero = (low + high) / 2;
            const mark = box(column.querySelector(part));
            const end = part !== ".rw-bar" ? middle(mark) : middle(mark) < zero ? mark.top : mark.bottom;
            return (zero - end) / (zero - high);
        }""",
        part,
    )
    return speed


def colour(shown: Locator) -> str:
    """The paint of an element."""
    painted: str = shown.evaluate("(element) => getComputedStyle(element).backgroundColor")
    return painted


@pytest.mark.parametrize(("theme", "scale"), [("light", 1), ("dark", 2)])
def test_no_words_touch_at_any_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([STATES, *NAMES], scale=scale, theme=theme)
    cards = nb.page.locator(".rw-card")
    expect(cards).to_have_count(len(NAMES))
    for width in (320, 520, 1200):
        nb.resize(width)
        assert of_each(cards, OVERLAPS) == [], f"at {width} px"
        for i, name in enumerate(NAMES):
            shoot(cards.nth(i), f"speed-{name}-{theme}-{width}")
        usual = nb.widget(2).locator(".rw-card")
        axis(usual, "angular.z").hover()
        shoot(usual, f"speed-hover-{theme}-{width}")


def test_the_first_data_move_nothing(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0).locator(".rw-card")
    for width in (320, 700):
        nb.resize(width)
        nb.run(0)
        expect(card.get_by_text("waiting for a speed")).to_be_visible()
        before = card.evaluate(PLACES)
        nb.python("speed.update(linear=(0.5, 0, 0), angular=(0, 0, -2))")
        expect(value(card, "linear.x")).to_have_text("0.50")
        expect(card.get_by_text("waiting for a speed")).to_be_hidden()
        assert card.evaluate(PLACES) == before


def test_frozen_before_the_first_speed_it_says_so(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0).locator(".rw-card")
    card.locator(".rw-freeze").click()
    nb.python("speed.update(linear=(0.5, 0, 0))")
    expect(card.locator(".rw-empty")).to_have_text("frozen before the first speed")
    card.locator(".rw-freeze").click()
    expect(card.locator(".rw-empty")).to_be_hidden()


def test_bars_go_up_and_down_to_scale_with_the_exact_number(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(0.5, -0.25, 0), angular=(1, -1, 0.1))")
    expect(value(card, "linear.x")).to_have_text("0.50")
    for axis_name, number in zip("xyz", ("0.50", "−0.25", "0.00"), strict=True):
        expect(value(card, f"linear.{axis_name}")).to_have_text(number)
    for axis_name, number in zip("xyz", ("1.00", "−1.00", "0.10"), strict=True):
        expect(value(card, f"angular.{axis_name}")).to_have_text(number)
    for name, speed in {"linear.x": 0.5, "linear.y": -0.25, "angular.x": 1, "angular.y": -1, "angular.z": 0.1}.items():
        assert drawn(card, name, ".rw-bar") == pytest.approx(speed, abs=0.02), name


def test_a_car_has_a_bar_for_its_steering_angle(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update({'speed': 0.5, 'steering_angle': -0.25})")
    expect(card.locator(".rw-heading")).to_have_text(["linear m/s", "steering rad"])
    expect(card.locator("[data-axis] .rw-value")).to_have_text(["0.50", "−0.25"])
    expect(card.get_by_role("button", name="Planar")).to_be_hidden()
    nb.python("speed.update(linear=(0.4, 0, 0), angular=(0, 0, 0.1))")
    expect(card.locator(".rw-heading")).to_have_text(["linear m/s", "angular rad/s"])
    nb.python("speed.command({'speed': 0.5, 'steering_angle': -0.25})")
    expect(card.locator(".rw-heading")).to_have_text(["linear m/s", "angular rad/s", "steering rad"])
    expect(card.locator(".rw-command:visible")).to_have_text(["cmd 0.50", *["cmd –"] * 5, "cmd −0.25"])


def test_a_bar_past_its_limit_turns_red_with_a_mark_and_words(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(1.1, -1.1, 0.9), angular=(0, 0, 0))")
    expect(axis(card, "linear.x").locator(".rw-axis-state")).to_have_text("▲ over limit")
    expect(axis(card, "linear.y").locator(".rw-axis-state")).to_have_text("▼ over limit")
    expect(axis(card, "linear.z").locator(".rw-axis-state")).to_have_text("")
    red = colour(axis(card, "linear.x").locator(".rw-bar"))
    assert red == colour(axis(card, "linear.y").locator(".rw-bar"))
    assert red != colour(axis(card, "linear.z").locator(".rw-bar"))
    expect(card.locator(".rw-summary")).to_have_text("x over the limit of 1, y over the limit of 1")
    nb.python("speed.linear_limits = 2; speed.limits = {'linear.z': (-1, 0.5)}")
    expect(axis(card, "linear.z").locator(".rw-axis-state")).to_have_text("▲ over limit")
    expect(axis(card, "linear.x").locator(".rw-axis-state")).to_have_text("")
    expect(axis(card, "linear.z").locator(".rw-limit-label:visible")).to_have_text(["−1", "0.5"])


def test_a_bar_longer_than_the_scale_is_cut_and_its_number_exact(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(12.34, -inf, 1.2), angular=(0, 0, 0))")
    expect(value(card, "linear.x")).to_have_text("12.34")
    expect(value(card, "linear.y")).to_have_text("−inf")
    for name, cut in {"linear.x": "up", "linear.y": "down", "linear.z": ""}.items():
        bar = axis(card, name).locator(".rw-bar")
        expect(bar).to_have_attribute("data-cut", cut)
        drawn_break = bar.evaluate("(e) => getComputedStyle(e, '::after').content")
        assert (drawn_break != "none") == bool(cut), name
    assert drawn(card, "linear.x", ".rw-bar") == pytest.approx(1.25, abs=0.02)


def test_a_missing_value_is_shown_as_such_and_not_drawn_as_zero(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(nan, 0, 0), angular=(0, 0, nan))")
    expect(value(card, "linear.x")).to_have_text("no value")
    expect(axis(card, "linear.x").locator(".rw-bar")).to_be_hidden()
    expect(axis(card, "linear.y").locator(".rw-bar")).to_be_visible()
    nb.python("speed.update(linear=(0, 0, 0), angular=(0, 0, 0))")
    expect(value(card, "linear.x")).to_have_text("0.00")
    expect(axis(card, "linear.x").locator(".rw-bar")).to_be_visible()


def test_a_planar_robot_shows_three_axes_and_tells_of_the_others(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(0.5, 0, 1.5), angular=(0, 0, 0.1))")
    expect(card.locator("[data-axis]")).to_have_count(6)
    card.get_by_role("button", name="Planar: show linear x, linear y and yaw only").click()
    expect(card.locator("[data-axis]")).to_have_count(3)
    for name in ("linear.x", "linear.y", "angular.z"):
        expect(axis(card, name)).to_be_visible()
    expect(card.locator(".rw-summary")).to_have_text("z over the limit of 1 · not shown: z 1.50")
    assert nb.python("speed.planar") == "True"
    nb.python("speed.planar = False")
    expect(card.locator("[data-axis]")).to_have_count(6)
    expect(value(card, "linear.z")).to_have_text("1.50")


def test_a_command_is_a_tick_on_the_measured_bar(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    tick = axis(card, "linear.x").locator(".rw-tick")
    nb.python("speed.command(linear=(0.8, 0, -3), angular=(0, 0, nan))")
    expect(axis(card, "linear.x").locator(".rw-command")).to_have_text("cmd 0.80")
    expect(value(card, "linear.x")).to_have_text("–")
    expect(card.locator(".rw-facts")).to_contain_text("with /cmd_vel")
    expect(axis(card, "angular.z").locator(".rw-tick")).to_be_hidden()
    expect(axis(card, "linear.z").locator(".rw-tick")).to_have_attribute("data-off", "down")
    nb.python("speed.update(linear=(0.5, 0, 0), angular=(0, 0, 0))")
    expect(value(card, "linear.x")).to_have_text("0.50")
    expect(tick).to_be_visible()
    assert drawn(card, "linear.x", ".rw-tick") == pytest.approx(0.8, abs=0.02)
    assert drawn(card, "linear.x", ".rw-bar") == pytest.approx(0.5, abs=0.02)


def test_peaks_hold_what_was_never_painted_until_they_are_reset(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    peaks = axis(card, "linear.x").locator(".rw-peak")
    reset = card.get_by_role("button", name="Reset the peaks")
    nb.python("for x in [0, 0.9, -0.7] + 500 * [0.2]:\n    speed.update(linear=(x, 0, 0), angular=(0, 0, 0))")
    expect(value(card, "linear.x")).to_have_text("0.20")
    expect(peaks.first).to_be_hidden()
    expect(reset).to_be_hidden()
    nb.python("speed.hold_peaks = True")
    expect(peaks.first).to_be_visible()
    least, greatest = (
        axis(card, "linear.x")
        .locator(".rw-peak")
        .evaluate_all("(all) => all.map((e) => e.getBoundingClientRect().top)")
    )
    assert least > greatest
    assert drawn(card, "linear.x", ".rw-peak:nth-of-type(2)") == pytest.approx(-0.7, abs=0.03)
    assert drawn(card, "linear.x", ".rw-peak:nth-of-type(3)") == pytest.approx(0.9, abs=0.03)
    reset.click()
    nb.page.wait_for_function(
        "([least, was]) => least.getBoundingClientRect().top < was - 20", arg=[peaks.first.element_handle(), least]
    )
    assert nb.python("speed.peaks['linear.x']") == "(0.2, 0.2)"


def test_the_picture_freezes_by_button_by_space_and_from_python(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    freeze = card.locator(".rw-freeze")
    move = "speed.update(linear=({}, 0, 0), angular=(0, 0, 0))"
    for x, hold in enumerate(["click", "space", "python"], 1):
        nb.python(move.format(x / 10))
        expect(value(card, "linear.x")).to_have_text(f"{x / 10:.2f}")
        if hold == "click":
            freeze.click()
        elif hold == "space":
            card.locator(".rw-picture").press(" ")
        else:
            nb.python("speed.paused = True")
        expect(freeze).to_have_attribute("aria-pressed", "true")
        nb.python(";".join([move.format(0.9)] * 3))
        expect(freeze).to_contain_text("3 since")
        expect(value(card, "linear.x")).to_have_text(f"{x / 10:.2f}")
        assert nb.python("speed.speed.linear[0]") == str(x / 10)
        freeze.click()
        expect(value(card, "linear.x")).to_have_text("0.90")


@pytest.mark.core
def test_pointing_at_an_axis_tells_it_exactly_and_stays_in_the_box(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    popup = card.locator(".rw-popup")
    nb.python("speed.hold_peaks = True; speed.command(linear=(0.6, 0, 0), angular=(0, 0, 0))")
    nb.python("speed.update(linear=(0.62346, 0, 0), angular=(0, 0, -1.5))")
    for width in (320, 700):
        nb.resize(width)
        for name in [f"{group}.{letter}" for group in ("linear", "angular") for letter in "xyz"]:
            axis(card, name).hover()
            expect(popup.locator(".rw-popup-expression")).to_contain_text(name)
            inside: Any = popup.evaluate(
                """(popup) => {
                    const [a, b] = [popup, popup.parentElement].map((e) => e.getBoundingClientRect());
                    return a.left >= b.left && a.right <= b.right && a.top >= b.top && a.bottom <= b.bottom;
                }"""
            )
            assert inside, f"{name} at {width} px"
        expect(popup).to_contain_text("−1.5000 rad/s")
        expect(popup).to_contain_text("over the limit of 1, off the scale")
    axis(card, "linear.x").hover()
    for text in ("0.6235 m/s", "forward", "limits−1 to 1", "commanded0.6000", "least0.6235"):
        expect(popup).to_contain_text(text)
    nb.python("speed.update(linear=(0.7, 0, 0), angular=(0, 0, 0))")
    expect(popup).to_contain_text("0.7000 m/s")
    card.locator(".rw-header").hover()
    expect(popup).to_be_hidden()


def test_arrow_keys_walk_the_axes(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    picture, named = card.locator(".rw-picture"), card.locator(".rw-popup-expression")
    for key, name in [("ArrowRight", "linear.x"), ("ArrowRight", "linear.y"), ("End", "angular.z"),
                      ("ArrowRight", "angular.z"), ("ArrowLeft", "angular.y"), ("Home", "linear.x")]:  # fmt: skip
        picture.press(key)
        expect(named).to_contain_text(name)
    picture.press("Escape")
    expect(named).to_be_hidden()


def test_a_finger_taps_an_axis(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED], touch=True)
    card = nb.widget(0)
    axis(card, "linear.y").tap()
    expect(card.locator(".rw-popup-expression")).to_have_text("linear.y")
    axis(card, "linear.y").tap()
    expect(card.locator(".rw-popup")).to_be_hidden()


def test_bars_move_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED, "import itertools, time\nsteps = itertools.count()"])
    card = nb.widget(0)
    with nb.busy("speed.update(linear=(0.25 * (next(steps) % 2), 0, 0))\ntime.sleep(0.1)"):
        for text in ("0.25", "0.00", "0.25"):
            expect(value(card, "linear.x")).to_have_text(text)


def test_an_error_is_reported_and_the_last_good_speed_stays(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED])
    card = nb.widget(0)
    nb.python("speed.update(linear=(0.5, 0, 0), angular=(0, 0, 0))")
    nb.python("import threading; threading.Thread(target=speed.command, args=('<b>stop</b>',)).start()")
    expect(card.locator(".rw-notice")).to_contain_text("command(): expected a message like geometry_msgs/Twist")
    expect(card.locator(".rw-notice")).to_contain_text("<b>stop</b>")
    expect(value(card, "linear.x")).to_have_text("0.50")
    nb.python("speed.command(linear=(0.5, 0, 0))")
    expect(card.locator(".rw-notice")).to_be_hidden()


def test_a_second_view_and_one_that_is_made_later_show_the_last_speed(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SPEED, "speed"])
    nb.python("speed.planar = True; speed.update(linear=(0.5, 0, 0), angular=(0, 0, -1.5))")
    expect(value(nb.widget(1), "angular.z")).to_have_text("−1.50")
    nb.run(1)
    expect(value(nb.widget(1), "angular.z")).to_have_text("−1.50")
    expect(nb.widget(1).locator("[data-axis]")).to_have_count(3)
