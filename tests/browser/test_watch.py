"""Conditions on the picture: lamps, marked rays, and steps through their changes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .laser import LIGHT, SETUP, Picture, eventually, locate
from .plain_page import PlainPage

DRIVE = """
from robowidgets import LaserWidget, conditions
from robowidgets.simulator import Robot, World, wander
robot = Robot(World.rooms(), seed=1)
laser = LaserWidget(title="/scan")
wall = laser.watch(lambda scan: scan.distance("front") < 0.9, name="wall")
laser.watch(conditions.nearest_below(0.35, ("50deg", "130deg")), name="left side")
laser.watch(lambda scan: 1 / 0, name="broken")
laser.watch(lambda scan: None, name="never known")
laser.watch(conditions.nearest_below(3), name="anything")
for _ in wander(robot):
    robot.step(0.1)
    laser.update(robot.scan())
    if robot.time > 9:
        break
laser
"""
STATES = {"wall": "true", "left side": "false", "broken": "off", "never known": "unknown", "anything": "true"}


def lamp_is(lamp: Locator, state: str, nb: PlainPage, send: str) -> None:
    """Wait for a state of a lamp while scans come, because it is unknown once a source is silent for a second."""

    def sends_and_is() -> bool:
        nb.python(send)
        return lamp.get_attribute("data-rw-state") == state

    wait_for(sends_and_is, f"the lamp is {state}")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_lamps_of_all_states_fit_every_width(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    nb = plain_page([DRIVE], scale=scale, theme=theme)
    card, said = nb.widget(0).locator(".rw-card"), nb.widget(0).locator(".rw-lamps")
    expect(card.locator(".rw-lamp")).to_have_text(list(STATES))
    for name, state in STATES.items():
        lamp_is(card.locator(".rw-lamp", has_text=name), state, nb, "laser.update(robot.scan())")
    for width in (320, 400, 700):
        nb.resize(width)
        assert said.evaluate("lamps => lamps.scrollWidth <= lamps.clientWidth")
        shoot(card, f"watch-{theme}-{width}")


NEAR = """
import time
from robowidgets.widget.pacer import pacer
def show(nearest):
    laser.update(**fan({9: nearest}))
    def shown():
        lamps = laser.get_state("_about")["_about"].get("lamps", ())
        return any(lamp["text"].startswith(f"{nearest:.2f} ") for lamp in lamps)
    while not shown():
        time.sleep(0.001)
        pacer.flush()
wall = laser.watch(lambda scan: scan.distance(("-5deg", "5deg")) < 1, name="wall")
laser
"""


def test_lit_marked_frozen_and_stepped_through(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP + NEAR, "show(1.68)", "show(0.9)"], run=False)
    nb.run(0)
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    name, said = card.locator(".rw-lamp"), card.locator(".rw-lamps")
    expect(name).to_have_attribute("data-rw-state", "unknown")
    nb.run(1)
    expect(name).to_have_attribute("data-rw-state", "false")
    place = locate(card)
    behind = place.at(0.9 + 5 / place.scale, 0)
    assert LIGHT["ink"] not in Picture(card).around(*behind)

    nb.run(2)
    expect(name).to_have_attribute("data-rw-state", "true")
    expect(said).to_contain_text("0.90 < 1.00 m")
    expect(said).to_contain_text("1 change")
    assert LIGHT["ink"] in Picture(card).around(*behind), "the ray that made it true is underlined"
    assert Picture(card).colour(*place.at(0.9, 0)) == LIGHT["reading"], "and no reading changes its colour"

    card.locator(".rw-freeze").click()
    nb.python("show(1.68); show(0.8); show(1.68)")
    expect(name).to_have_attribute("data-rw-state", "true")
    expect(said).to_contain_text("0.90 < 1.00 m")
    card.locator(".rw-freeze").click()
    lamp_is(name, "false", nb, "show(1.68)")

    # However fast scans and steps follow each other, the last number is of the last one.
    nb.python("show(1.75); show(1.74)")
    expect(said).to_contain_text("1.74 ≥ 1.00 m")
    card.locator(".rw-picture").press("Space")
    for key, text in ((",", "1.75"), (",", "1.68"), (".", "1.75")):
        nb.page.keyboard.press(key)
        expect(said).to_contain_text(f"{text} ≥ 1.00 m")
    nb.page.keyboard.press("Space")

    # Each step leads to the scan of a change, and freezes it.
    back, forth = (card.get_by_role("button", name=f"wall: the {which}") for which in ("change before", "next change"))
    for state, text in (("false", "1.68 ≥ 1.00 m"), ("true", "0.80 < 1.00 m"), ("false", "1.68 ≥ 1.00 m")):
        back.click()
        expect(name).to_have_attribute("data-rw-state", state)
        expect(said).to_contain_text(text)
    assert nb.python("print(laser.paused, laser.frozen.nearest().range)").startswith("True")
    forth.click()
    expect(said).to_contain_text("0.80 < 1.00 m")
    card.locator(".rw-picture").press("Space")

    # A condition that raises is off, with its line; removing a name removes its lamp.
    nb.python("def broken(scan):\n    return 1 / 0\nlaser.watch(broken)\nlaser.unwatch('wall')\nlaser.update(**fan())")
    expect(card.locator(".rw-lamp")).to_have_count(1)
    expect(card.locator(".rw-lamp")).to_have_attribute("data-rw-state", "off")
    expect(said).to_contain_text("line 2: ZeroDivisionError: division by zero")
    nb.python("laser.unwatch('broken')")
    expect(said).to_be_hidden()


FOUND = """
import robowidgets
from robowidgets import conditions
recording = robowidgets.open(robowidgets.SAMPLE)
player = recording.show("/scan", scanogram=False)
player.marks = recording.find(conditions.nearest_below(0.25, "front"))
player
"""


def test_what_was_found_stands_in_rows_that_lead_there(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FOUND], scale=2)
    card = nb.output(0).locator(".rw-player")
    rows = card.locator(".rw-play-row")
    expect(rows.first).to_be_hidden()
    card.locator(".rw-play-mark-words").press("Space")
    assert nb.python("print(player.playing)").strip() == "False", "the key opens the list, and plays nothing"
    spans = nb.python(
        "print(*(f'{s.start:.2f} {s.index}' for s in recording.find(conditions.nearest_below(0.25, 'front'))))"
    )
    starts, indices = spans.split()[::2], spans.split()[1::2]
    expect(rows).to_have_count(len(starts))
    rows.nth(2).click()
    expect(card.locator(".rw-play-now")).to_have_text(starts[2])
    expect(rows.nth(2)).to_have_attribute("aria-current", "true")
    expect(rows.nth(2)).to_contain_text(f"[{indices[2]}]")
    shoot(nb.output(0), "found-rows")


def test_in_the_middle_of_an_endless_loop(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([SETUP + "import time\nn = 0\nlaser.update(**fan())\nlaser"])
    card = nb.widget(0).locator(".rw-card")
    nb.python('laser.watch(lambda scan: scan.distance(("-5deg", "5deg")) < 1, name="wall")')
    name, said = card.locator(".rw-lamp"), card.locator(".rw-lamps")
    expect(name).to_have_attribute("data-rw-state", "false")
    with nb.busy("n = n % 800 + 2\nlaser.update(**fan({9: 0.6002 + n / 1000}))\ntime.sleep(0.002)"):
        for state in ("true", "false", "true"):
            expect(name).to_have_attribute("data-rw-state", state)
        # The changes are stepped through, and scans compared, without the kernel.
        card.get_by_role("button", name="wall: the change before").click()
        expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
        frozen = said.inner_text()
        card.locator(".rw-picture").press("g")
        strip = card.locator(".rw-strip")
        expect(strip).to_be_visible()
        strip.hover(position={"x": 46 + 9.5 / 19 * (width_of(card) - 68), "y": 60})
        expect(card.locator(".rw-popup:visible")).to_contain_text("ranges[9]")
        assert said.inner_text() == frozen
        card.locator(".rw-picture").press("Space")
        expect(name).to_have_attribute("data-rw-state", "true")
    # A lamp is not older than its scan: its state is unknown when scans stop, also after it is folded and unfolded.
    card.locator(".rw-title").hover()
    nb.python("laser.update(**fan())")
    place = locate(card)
    behind = place.at(0.8 + 5 / place.scale, 0)
    nb.python("laser.update(**fan({9: 0.8}))")
    expect(card.locator(".rw-footer")).to_contain_text("0.80 m")
    card.locator(".rw-picture").press("Space")
    expect(name).to_have_attribute("data-rw-state", "true")
    eventually(lambda: LIGHT["ink"] in Picture(card).around(*behind), True)
    card.locator(".rw-picture").press("Space")
    expect(name).to_have_attribute("data-rw-state", "unknown")
    expect(said).to_contain_text("unknown")
    eventually(lambda: LIGHT["ink"] in Picture(card).around(*behind), False)
    for _ in range(2):
        assert name.evaluate("name => (name.click(), name.dataset.rwState)") == "unknown"


def width_of(card: Locator) -> float:
    """Pixels of the index view."""
    return float(card.locator(".rw-strip").evaluate("(strip) => strip.clientWidth"))


PLAYED = """
import robowidgets
from robowidgets import conditions
recording = robowidgets.open(robowidgets.SAMPLE)
bump = recording.find(conditions.nearest_below(0.3))[0]
player = recording.show("/scan", scanogram=False)
player.seek(bump.start - 1)
player
"""


def test_in_a_player_the_lamp_shows_the_verdict_on_the_scan_of_its_time(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([PLAYED])
    laser = nb.output(0).locator(".rw-laser")
    expect(laser.locator(".rw-footer")).to_contain_text("readings")
    nb.python("player.views[0].widget.watch(conditions.nearest_below(0.3), name='wall')")
    lamp = laser.locator(".rw-lamp")
    expect(lamp).to_have_attribute("data-rw-state", "false")
    nb.python("player.seek(bump.start + 0.05)")
    expect(lamp).to_have_attribute("data-rw-state", "true")
    expect(laser.locator(".rw-lamp-text")).to_contain_text("0.30 m")
    shoot(nb.output(0), "watch-player")

    # Frozen, and after steps, it keeps the verdict on its own scan, whatever the time of the player.
    freeze, now = laser.locator(".rw-freeze"), nb.output(0).locator(".rw-play-now")
    for button in (freeze, nb.output(0).get_by_role("button", name="One scan on (.)")):
        button.click()
        for seconds in (-1, -0.5):
            nb.python(f"player.seek(bump.start + {seconds})")
            expect(now).to_have_text(nb.python(f"print(f'{{bump.start + {seconds}:.2f}}')").strip())
        expect(laser.locator(".rw-lamp-text")).to_contain_text("< 0.30 m")
        expect(lamp).to_have_attribute("data-rw-state", "true")
    freeze.click()
    nb.python("player.seek(bump.start - 1)")
    expect(lamp).to_have_attribute("data-rw-state", "false")
    nb.python("player.views[0].widget.unwatch('wall')")
    expect(lamp).to_have_count(0)
