"""Each widget brings its own stylesheet, and the stylesheets of other widgets in the page do not change it."""

from __future__ import annotations

from collections.abc import Callable

from playwright.sync_api import expect

from .laser import SETUP
from .plain_page import PlainPage

WIDGETS = f"""{SETUP}
from robowidgets import DriveWidget, ScanogramWidget, SpeedWidget, TouchWidget
from robowidgets.driving.command_watchdog import CommandWatchdog
from robowidgets.player_widget import PlayerWidget
from robowidgets.stop_widget import StopWidget

def fill(height):
    laser = LaserWidget(title="/scan", color_by_intensity=True, layout=dict(height=height))
    laser.update(**fan({{3: 0.1, 5: inf, 7: nan, 9: -inf}}, intensities=np.arange(19)))
    laser.pinned = 12
    speed = SpeedWidget(title="/odom", hold_peaks=True, limits={{"linear.x": (-0.2, 0.5)}}, layout=dict(height=height))
    speed.update(linear=(0.62, -3, nan), angular=(0, 0, -0.24))
    speed.command(linear=(0.4, 0, 0), angular=(0, 0, 0))
    touch = TouchWidget(title="/bumper", angles={{"left": 0.9, "right": -0.9}}, layout=dict(height=height))
    touch.update(left=True, right=None, front=False)
    scanogram = ScanogramWidget(title="/scan", layout=dict(height=height))
    scanogram.update(times_ns=np.arange(9) * 10**8, ranges=np.where(np.arange(61) < 9, inf, np.full((9, 61), 2.0)),
                     angle_min=-1.5, angle_increment=0.05, range_min=0.1, range_max=10.0)
    scanogram.selection = (0.2, 0.4)
    stop = StopWidget(CommandWatchdog(print), layout=dict(height=height))
    player = PlayerWidget(duration=10.0, selection=(1, 2), marks=[(3, 4, "bump")], layout=dict(height=height))
    return laser, speed, touch, scanogram, DriveWidget(title="/cmd_vel", layout=dict(height=height)), stop, player

first = fill(None)
for shown in first[:3]:
    shown.paused = True
display(*first, *fill("500px"))
"""
KINDS = ["laser", "speed", "touch", "scanogram", "drive", "stop-bar", "player"]
DIFFERENCES = """(card) => {
    const sheets = [...document.head.querySelectorAll("style[id]")];
    const own = sheets.find(({ id }) => id === card.dataset.sheet);
    const others = sheets.filter((sheet) => sheet !== own);
    const names = [...getComputedStyle(card)];
    const elements = [card.parentElement, card, ...card.querySelectorAll("*")];
    const look = (beside, ordered) => {
        for (const sheet of others) sheet.disabled = !beside;
        document.head.append(...ordered);
        return elements.flatMap((element) => [undefined, "::before", "::after"].map((pseudo) => {
            const style = getComputedStyle(element, pseudo);
            const isThere = element.checkVisibility() && !(pseudo && style.content === "none");
            return names.map((name) => isThere || name === "display" ? style.getPropertyValue(name) : "");
        }));
    };
    const alone = look(false, sheets);
    return [[own, ...others], [...others, own]].flatMap((ordered) => look(true, ordered).flatMap((looks, i) =>
        looks.flatMap((value, j) => value === alone[i][j] ? [] : [
            `${elements[Math.floor(i / 3)].className}: ${names[j]} ${alone[i][j]} becomes ${value}`])));
}"""
"""The properties that change with the stylesheets of other widgets in the page, before or after a widget's own."""


def test_a_widget_looks_the_same_with_any_other_widgets_on_the_page(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([WIDGETS])
    for nth, kind in enumerate(2 * KINDS):
        expect(nb.widget(0, nth).locator(f".rw-{kind}")).to_be_visible()
    for width in (250, 380, 700):
        nb.resize(width)
        for nth, kind in enumerate(2 * KINDS):
            card = nb.widget(0, nth).locator(f".rw-{kind}")
            assert card.evaluate(DIFFERENCES) == [], f"{kind} at {width} px"
