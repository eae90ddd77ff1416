"""A state machine on the page: active states, events, transitions, and the same moment in all widgets."""

from __future__ import annotations

import re
from collections.abc import Callable
from typing import Literal

import pytest
from playwright.sync_api import Locator, expect

from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .plain_page import PlainPage

OPEN = """
from robowidgets import LaserWidget, MachineWidget, conditions, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)
laser, other = LaserWidget(), LaserWidget()
robot.connect("/scan", laser)
robot.variables.go = robot.variables.back = False
machine = MachineWidget(robot)
display(laser, other)
machine
"""
WALKER = """
class Walker:
    near = conditions.nearest_below(100.0, "front")
    go = lambda variables: variables.go
    back = lambda variables: variables.back

    def forward():
        return Drive(0.05)

    class avoid:
        def stop():
            return Drive()

        def turn():
            return Drive(0, 0.2)

        spin = None
        moves = "stop -> turn after 1", "turn -> {name} after 60"

    class both:
        class one:
            a = b = None
            moves = "a -> b after 0.1"
        class two:
            c = d = None
            moves = "c -> d after 0.1"

    moves = '''
        forward -> avoid on near
        avoid -> both on go
        * -> forward on back
    '''

program = robot.program(Walker, rate=20)
"""
WIDE = """
class Wide:
    is_left = lambda variables: not variables.go
    is_right = lambda variables: variables.go
    a = b = c = d = hub = None
    moves = *(f"hub -> {name} on is_left" for name in "abcd"), "a -> d on is_right", "d -> a on is_left"

robot.program(Wide)
"""
IS_IN_VIEW = """
state => {
  const [box, view] = [state, state.closest(".rw-picture")].map((element) => element.getBoundingClientRect());
  return box.left >= view.left && box.right <= view.right;
}
"""
TURN, SPIN = WALKER.format(name="stop"), WALKER.format(name="spin")


def state(widget: Locator, name: str) -> Locator:
    return widget.locator(".rw-machine-state").filter(has=widget.page.get_by_text(name, exact=True)).last


def move(widget: Locator, name: str) -> Locator:
    return widget.locator(".rw-move").filter(has=widget.page.get_by_text(name, exact=True))


@pytest.mark.core
def test_a_machine_is_lit_judged_listed_frozen_and_replaced(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN], width=740)
    laser, other, widget = nb.widget(0), nb.widget(0, 1), nb.widget(0, 2)
    expect(widget.locator(".rw-empty")).to_have_text("waiting for a state machine")
    nb.run(nb.append(TURN))
    expect(widget.locator(".rw-title")).to_have_text("Walker")
    expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")
    expect(state(widget, "avoid")).to_have_attribute("data-active", "frame")
    expect(state(widget, "turn")).to_have_attribute("aria-current", "true")
    expect(state(widget, "stop")).to_have_attribute("data-active", "")
    expect(widget.locator(".rw-facts")).to_have_text("v1 ·\u00a0avoid \u203a turn")
    expect(widget.locator(".rw-live")).to_have_text("active: avoid \u203a turn")
    expect(state(widget, "turn").locator(".rw-machine-state-left")).to_have_text(re.compile(r"5\d\.\d s"))
    expect(move(widget, "go")).to_have_attribute("data-value", "false")
    expect(move(widget, "near")).to_have_attribute("data-value", "")
    expect(move(widget, "near")).to_have_attribute("data-way", "taken")
    rows = widget.locator(".rw-fired-row")
    expect(rows).to_have_count(2)
    expect(rows.nth(1)).to_contain_text("forward \u2192 avoid")
    expect(rows.nth(1).locator(".rw-fired-words")).to_have_text(re.compile(r"near\d+\.\d\d < 100\.00 m\[\d+\]"))

    with nb.busy():
        rows.nth(1).click()
        for card in (laser, widget):
            expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
        expect(rows.nth(1)).to_have_attribute("aria-current", "true")
        expect(state(widget, "stop")).to_have_attribute("data-active", "leaf")
        expect(move(widget, "near")).to_have_attribute("data-value", "true")
        expect(laser.locator(".rw-time b")).to_contain_text("\u2212")
        expect(other.locator(".rw-freeze")).to_have_attribute("aria-pressed", "false")
        shoot(widget, "machine-frozen")
        rows.nth(1).press("ArrowUp")
        expect(rows.nth(0)).to_be_focused()
        rows.nth(0).press("Enter")
        expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")
    moment = (
        "import struct\n(scan, _), (then, about) = (\n"
        "    (struct.unpack_from('<ddqd', state['_frozen_frame'])[3], state['_about'])\n"
        "    for state in (laser.get_state(), machine.get_state())\n)\n"
        "before, at = (one['at'] for one in about['fired'][-2:])\nprint(before < scan <= at <= then)"
    )
    wait_for(lambda: nb.python(moment).strip() == "True", "Python knows that all show what was there as it moved")
    widget.locator(".rw-freeze").click()
    expect(laser.locator(".rw-freeze")).to_have_attribute("aria-pressed", "false")

    # In the band of states, a moment ago: turn has been active since.
    band = widget.locator(".rw-states")
    expect(widget.locator(".rw-machine-band-foot")).to_have_text("\u221230 snow")
    with nb.busy():
        box = band.bounding_box()
        assert box
        place = {"x": box["width"] - 3, "y": box["height"] - 4}
        band.hover(position=place)
        expect(band).to_have_attribute("title", "Walker \u203a avoid \u203a turn")
        band.click(position=place)
        for card in (laser, widget):
            expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "true")
        expect(widget.locator(".rw-machine-band-foot")).to_have_text("\u221230 sfrozen")
    widget.locator(".rw-freeze").click()

    # A moment that is no longer kept freezes nothing, and the page reports it.
    nb.python("machine.history = 0")
    rows.nth(1).click()
    expect(widget.locator(".rw-footer")).to_contain_text("this moment is not kept here")
    shoot(widget, "machine-not-kept")
    for card in (laser, widget):
        expect(card.locator(".rw-freeze")).to_have_attribute("aria-pressed", "false")

    nb.run(nb.append(SPIN))
    expect(widget.locator(".rw-facts")).to_have_text("v2 ·\u00a0avoid \u203a turn")
    expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")
    expect(state(widget, "spin")).to_have_attribute("data-active", "")
    nb.python("robot.variables.go = True")
    expect(state(widget, "b")).to_have_attribute("data-active", "leaf")
    expect(state(widget, "d")).to_have_attribute("data-active", "leaf")
    expect(widget.locator(".rw-machine-lane")).to_have_text(["one", "two"])
    nb.python("robot.close()")
    expect(widget.locator("[data-active=leaf]")).to_have_count(0)


def test_a_machine_fits_a_narrow_page_and_rings_step_by_tenths_where_motion_is_reduced(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN, TURN], width=400, scale=2)
    widget = nb.widget(0, 2)
    nb.page.emulate_media(reduced_motion="reduce")
    expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")
    ring = state(widget, "turn").locator(".rw-ring")
    wait_for(lambda: ring.evaluate("ring => ring.style.getPropertyValue('--rw-left')") == "1", "the ring is full")
    expect(state(widget, "turn").locator(".rw-machine-state-left")).not_to_have_text("60.0 s")
    assert widget.locator(".rw-picture").evaluate("picture => picture.scrollWidth <= picture.clientWidth")
    for theme in ("light", "dark"):
        nb.theme(theme)
        shoot(widget, f"machine-narrow-{theme}")

    nb.python(WIDE)
    for is_right, name in ((False, "a"), (True, "d"), (False, "a")):
        nb.python(f"robot.variables.go = {is_right}")
        expect(state(widget, name)).to_have_attribute("data-active", "leaf")
        wait_for(lambda name=name: state(widget, name).evaluate(IS_IN_VIEW), "the active state is in view")
    nb.run(1)
    expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")

    nb.python("machine.layout.height = '300px'")
    card = widget.locator(".rw-card")
    wait_for(lambda: card.evaluate("card => card.offsetHeight") <= 300, "the card has the height of its layout")
    assert widget.locator(".rw-picture").evaluate("picture => picture.scrollHeight <= picture.clientHeight")
    nb.python("robot.close()")


GO = """
robot.variables.bad = False
class Goer:
    def wait(state):
        state.way = 0.04
        return Drive()

    def fail(variables):
        return Drive(0.1 / (not variables.bad))

    moves = "wait -> fail on done_by", "fail -> wait after 600"
    done_by = lambda state: state.get("way", 0) >= 0.1

program = robot.program(Goer, rate=20)
"""


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_click_goes_to_a_state_numbers_stand_next_to_events_and_a_failed_state_is_marked(
    plain_page: Callable[..., PlainPage], theme: Literal["light", "dark"], scale: int
) -> None:
    nb = plain_page([OPEN, GO], width=740, theme=theme, scale=scale)
    widget = nb.widget(0, 2)
    expect(move(widget, "done_by").locator(".rw-move-numbers")).to_have_text("way 0.04 < 0.10")
    go = state(widget, "fail").get_by_role("button", name="Go to the state fail")
    expect(go).to_have_css("opacity", "0")
    state(widget, "fail").hover()
    expect(go).to_have_css("opacity", "1")
    shoot(widget, f"machine-go-{theme}")
    go.click()
    expect(state(widget, "fail")).to_have_attribute("data-active", "leaf")
    expect(widget.locator(".rw-fired-row").first).to_contain_text("by hand")
    state(widget, "wait").get_by_role("button", name="Go to the state wait").press("Enter")
    expect(state(widget, "wait")).to_have_attribute("data-active", "leaf")
    go.press("Enter")
    expect(state(widget, "fail")).to_have_attribute("data-active", "leaf")
    expect(state(widget, "fail")).to_have_attribute("data-failed", "false")
    nb.python("robot.variables.bad = True")
    expect(state(widget, "fail")).to_have_attribute("data-failed", "true")
    expect(widget.locator(".rw-notice-text")).to_have_text("line 9: ZeroDivisionError: float division by zero")
    shoot(widget, f"machine-failed-{theme}")
    widget.locator(".rw-freeze").click()
    expect(state(widget, "wait").get_by_role("button")).to_be_hidden()
    nb.python("robot.close()")


EDITED = """
class Edited:
    go = lambda variables: variables.go
    back = lambda variables: variables.back

    def forward():
        return Drive(0.05)

    class avoid:
        stop = turn = None
        moves = "stop -> turn after 0.2"

    {more}
    moves = "forward -> avoid on go", "avoid -> forward on back", {moves}

robot.program(Edited, rate=20)
"""
FIRST = EDITED.format(more="", moves="")
SECOND = EDITED.format(more="rest = None", moves="'forward -> rest on back', 'rest -> forward on go'")
BROKEN = EDITED.format(more="def rest(): return Drive(1 / 0)", moves="'forward -> rest on back'")


@pytest.mark.parametrize("width", [740, 400, 300])
def test_a_card_keeps_its_height_while_one_edits_and_shows_the_whole_machine(
    plain_page: Callable[..., PlainPage], width: int
) -> None:
    nb = plain_page([OPEN, FIRST], width=width)
    widget = nb.widget(0, 2)
    card, picture = widget.locator(".rw-card"), widget.locator(".rw-picture")

    def height() -> float:
        return float(card.evaluate("card => card.getBoundingClientRect().height"))

    expect(state(widget, "forward")).to_have_attribute("data-active", "leaf")
    expect(widget.locator(".rw-fired-row")).to_have_count(0)
    nb.drawn()
    first = height()
    nb.python("robot.variables.go = True")
    expect(state(widget, "turn")).to_have_attribute("data-active", "leaf")
    expect(widget.locator(".rw-fired-row")).not_to_have_count(0)
    assert height() == pytest.approx(first, abs=1)
    nb.python("robot.variables.go = False")
    nb.run(nb.append(SECOND))
    expect(widget.locator(".rw-facts")).to_contain_text("v2")
    expect(state(widget, "rest")).to_be_visible()
    assert height() == pytest.approx(first, abs=1)
    shoot(widget, f"machine-edited-{width}")
    inside = "picture => picture.scrollWidth <= picture.clientWidth && picture.scrollHeight <= picture.clientHeight"
    assert picture.evaluate(inside)
    nb.run(nb.append(BROKEN))
    nb.python("robot.variables.back = True")
    expect(state(widget, "rest")).to_have_attribute("data-failed", "true")
    shoot(widget, f"machine-broken-{width}")
    assert height() == pytest.approx(first, abs=1)
    assert picture.evaluate(inside)
    nb.python("robot.close()")
