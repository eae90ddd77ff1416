"""A redrawn picture makes the browser compute no layout: the sizes it needs are kept from the last resize."""

from __future__ import annotations

from collections.abc import Callable

import pytest
from playwright.sync_api import expect

from .laser import SETUP, eventually
from .message import IMU
from .plain_page import PlainPage
from .sonar import STUDENT

COUNT = """() => {
    window.reads = [];
    const note = () => {
        const lines = new Error().stack.split("\\n");
        reads.push(lines.slice(2, 6).join("\\n"));
    };
    const getters = [
        [HTMLElement.prototype, ["offsetWidth", "offsetHeight", "offsetLeft", "offsetTop", "innerText"]],
        [Element.prototype, ["clientWidth", "clientHeight", "scrollWidth", "scrollHeight", "scrollLeft", "scrollTop"]],
    ];
    for (const [prototype, names] of getters) {
        for (const name of names) {
            const own = Object.getOwnPropertyDescriptor(prototype, name);
            Object.defineProperty(prototype, name, { ...own, get() { note(); return own.get.call(this); } });
        }
    }
    for (const name of ["getBoundingClientRect", "getClientRects", "checkVisibility"]) {
        const own = Element.prototype[name];
        Element.prototype[name] = function (...given) { note(); return own.apply(this, given); };
    }
    const now = performance.now();
    performance.now = () => now;  // a slow machine is no silent source
    window.drawn = 0;
    const frame = requestAnimationFrame;
    window.requestAnimationFrame = (draw) => frame((time) => { drawn += 1; draw(time); });
}"""
FRAMES = 12
LASER = f"""{SETUP}
def step(i):
    laser.update(**fan({{9: 0.7 + 0.1 * (i % 5)}}))
step(0)
laser.sectors["ahead"] = ("-30deg", "30deg")
laser.selection = "ahead"
laser.pinned = 9
laser.hovered = 3
laser
"""
NOTED = f"""{SETUP}
def step(i):
    laser.update(**fan({{9: 1 + i / 20}}, angle_max=9.0))
step(0)
laser
"""
EMPTY = f"""{SETUP}
def step(i):
    laser.update(**fan() | dict(ranges=np.full(19, inf), angle_increment=0.1 + i / 1000))
step(0)
laser
"""
SPEED = """
from robowidgets import SpeedWidget
speed = SpeedWidget(limits={"linear.x": (-0.2, 0.3), "angular.z": (-1, 1)}, planar=True)
def step(i):
    speed.update(linear=(0.1 * (i % 4), 0, 0), angular=(0, 0, 0.2))
step(0)
speed
"""
TOUCH = """
from robowidgets import TouchWidget
touch = TouchWidget()
def step(i):
    touch.update(left=i % 2 == 0, right=False)
step(0)
touch
"""
TELL = """() => {
    window.told = { same: [], before: [], nodes: [] };
    const note = (records) => {
        for (const { type, target, attributeName, oldValue, addedNodes } of records) {
            told.nodes.push(...[...addedNodes].map((node) => `${node.textContent} in ${target.className}`));
            if (type === "attributes" && target.getAttribute(attributeName) === oldValue)
                told.same.push(`${attributeName} of ${target.className}`);
        }
    };
    const observer = new MutationObserver(note);
    const attributes = { attributeFilter: ["hidden", "class", "style"], attributeOldValue: true };
    observer.observe(document.body, { subtree: true, childList: true, characterData: true, ...attributes });
    for (const name of ["fillText", "strokeText", "measureText"]) {
        const own = CanvasRenderingContext2D.prototype[name];
        CanvasRenderingContext2D.prototype[name] = function (...given) {
            const records = observer.takeRecords();
            note(records);
            told.before.push(...records.map(({ target }) => target.className ?? target.parentElement?.className));
            return own.apply(this, given);
        };
    }
    const now = performance.now();
    performance.now = () => now;  // a slow machine is no silent source
    window.drawn = 0;
    const frame = requestAnimationFrame;
    window.requestAnimationFrame = (draw) => frame((time) => { drawn += 1; draw(time); });
}"""
"""Changes on the page: to the same value, before text is painted in the same frame, and by new nodes."""
MACHINE = """
from robowidgets import MachineWidget, feeds
from robowidgets.behaviors import Drive
robot = feeds.simulator(wander=False, hz=20)
@robot.program(rate=20)
class Walker:
    def forward():
        return Drive(0.05)
    def turn():
        return Drive(0, 0.2)
    moves = "forward -> turn after 60", "turn -> forward after 60"
step = lambda i: None
MachineWidget(robot)
"""
PATH = """
from robowidgets import PathWidget
path = PathWidget(title="/path")
for i in range(3):
    path.update(x=0.1 * i, y=0.0, yaw=0.0, time=0.5 * i)
path
"""
BESIDE = """
def beside(i):
    step(i)
    speed.update(linear=(0.1, 0, 0), angular=(0, 0, 0.2))
    touch.update(left=True, right=False)
    sonars.update(front=0.42, left=0.15, right=None)
    path.update(x=0.2, y=0.0, yaw=0.0, time=1.0)
    imu_widget.update(imu())
"""
CHANGES = """() => {
    window.changes = {};
    const note = (records) => {
        for (const { type, target, attributeName } of records) {
            const element = target instanceof Element ? target : target.parentElement;
            const kind = /rw-card rw-([a-z-]+)/.exec(element.closest(".rw-card")?.className)?.[1];
            (changes[kind] ??= new Set()).add(`${type} ${attributeName ?? ""} of ${element.className}`);
        }
    };
    const all = { childList: true, characterData: true, attributes: true };
    new MutationObserver(note).observe(document.body, { subtree: true, ...all });
    window.painted = {};
    const { clearRect } = CanvasRenderingContext2D.prototype;
    CanvasRenderingContext2D.prototype.clearRect = function (...given) {
        const kind = /rw-card rw-([a-z-]+)/.exec(this.canvas.closest(".rw-card")?.className)?.[1];
        painted[kind] = (painted[kind] ?? 0) + 1;
        return clearRect.apply(this, given);
    };
}"""
"""Changes in cards, by kind, also changes to the same value; and the number of times that they are painted."""


@pytest.mark.parametrize(
    "cell", [LASER, NOTED, EMPTY, SPEED, TOUCH, MACHINE], ids=["laser", "noted", "empty", "speed", "touch", "machine"]
)
def test_drawing_again_has_the_browser_lay_out_nothing(plain_page: Callable[..., PlainPage], cell: str) -> None:
    nb = plain_page([cell])
    card = nb.widget(0).locator(".rw-card")
    nb.resize(700)
    if cell == SPEED:
        for axis in card.locator(".rw-axis").all():
            axis.hover()
        expect(card.locator(".rw-popup")).to_be_visible()
    nb.page.evaluate(COUNT)
    # Once for each new value: a pop-up is laid out when it becomes wider.
    for i in range(8):
        nb.python(f"step({i})")
    nb.page.evaluate("() => { reads.length = drawn = 0; }")
    for i in range(FRAMES):
        before = nb.page.evaluate("() => drawn")
        nb.python(f"step({i})")
        eventually(lambda before=before: nb.page.evaluate("() => drawn") > before, True)
    assert nb.page.evaluate("() => drawn") >= FRAMES
    assert nb.page.evaluate("() => [...new Set(reads)]") == []


@pytest.mark.parametrize("cell", [LASER, NOTED, EMPTY], ids=["laser", "noted", "empty"])
def test_a_scan_is_painted_before_the_page_is_changed_and_only_texts_that_differ_are(
    plain_page: Callable[..., PlainPage], cell: str
) -> None:
    """Text on a canvas makes the browser lay out earlier changes; a new node makes it look up rules with ``:has()``."""
    nb = plain_page([cell])
    expect(nb.widget(0).locator(".rw-nearest")).to_have_count(1)
    for i in range(8):
        nb.python(f"step({i})")
    nb.page.evaluate(TELL)
    for i in range(FRAMES):
        before = nb.page.evaluate("() => drawn")
        nb.python(f"step({i})")
        eventually(lambda before=before: nb.page.evaluate("() => drawn") > before, True)
    assert nb.page.evaluate("() => told") == {"same": [], "before": [], "nodes": []}


def test_cards_with_unchanged_samples_leave_the_page_alone_next_to_a_live_laser(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([SPEED, TOUCH, STUDENT, PATH, IMU, LASER, BESIDE], height=3000)
    for i in range(8):
        nb.python(f"beside({i})")
    nb.page.evaluate(CHANGES)
    for i in range(FRAMES):
        before = nb.page.evaluate("() => painted.laser ?? 0")
        nb.python(f"beside({i})")
        eventually(lambda before=before: nb.page.evaluate("() => painted.laser ?? 0") > before, True)
    eventually(lambda: nb.page.evaluate("() => painted.path > 3 && painted.sonar > 3"), True)
    told = nb.page.evaluate("() => Object.entries(changes).map(([kind, all]) => [kind, [...all]])")
    changes = {f"{one} in {kind}" for kind, all_of_it in told if kind != "laser" for one in all_of_it}
    changes = {change for change in changes if not change.startswith("characterData")}
    assert changes <= {"attributes title of rw-tile in touch"}, "that tells for how long"


def test_many_cards_that_come_at_once_are_laid_out_together(plain_page: Callable[..., PlainPage]) -> None:
    """Otherwise each makes the browser lay out all others again: the time grows with the square of their number."""
    many = """
from ipywidgets import VBox
cards = [MessageWidget(title=f"/imu{i}") for i in range(24)]
for card in cards:
    card.update(imu())
VBox(cards)
"""
    nb = plain_page([IMU, many], run=False)
    nb.run(0)
    session = nb.page.context.new_cdp_session(nb.page)
    session.send("Performance.enable")

    def layouts() -> float:
        metrics = session.send("Performance.getMetrics")["metrics"]
        return float(next(one["value"] for one in metrics if one["name"] == "LayoutCount"))

    before = layouts()
    nb.run(1)
    rows = nb.output(1).locator(".rw-message-tree:has(.rw-message-row:nth-child(4))")
    expect(rows).to_have_count(24)
    assert layouts() - before < 24
