"""A laser widget while scans come: it shows the newest, freezes, and reacts to the user while a cell is busy."""

from __future__ import annotations

import re
from collections.abc import Callable

from playwright.sync_api import Locator, expect

from .laser import FAN, SETUP, eventually, layers, locate
from .notebook import Notebook
from .plain_page import PlainPage

FIRST = f"{SETUP}\nlaser.update(**fan())\nlaser"
# Counts in the distance of ray 9, which is the nearest: 0.6012, 0.6022 and so on, and computes between two scans.
BUSY = """
from pathlib import Path
n = 0
while not Path({stop!r}).exists():
    n = n % 800 + 1
    laser.update(**fan({{9: 0.6002 + n / 1000, 17: nan}}))
    sum(range(100_000))
"""


FLOOD = """
import threading
scans = []
for distance in (0.7, 0.8, 0.9):
    laser.update(**fan({9: distance}))
    scans.append(laser.scan)
laser.update(**fan())

def flood(last):
    for i in range(50_000):
        laser.update(scans[i % 2])
    laser.update(last)
"""


def freeze_of(card: Locator) -> Locator:
    return card.locator(".rw-freeze")


def is_frozen(card: Locator, since: int) -> None:
    expect(freeze_of(card)).to_have_text(f"Frozen · {since} since")
    expect(freeze_of(card)).to_have_attribute("aria-pressed", "true")


def is_live(card: Locator) -> None:
    expect(freeze_of(card)).to_have_text("Freeze")
    expect(freeze_of(card)).to_have_attribute("aria-pressed", "false")


def nearest(card: Locator) -> str:
    return card.locator(".rw-nearest").inner_text()


def test_frozen_by_button_key_or_python_the_picture_holds_still(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FIRST])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup:visible")
    place = locate(card)
    x, y = place.at(*FAN[9])

    def by_space() -> None:
        picture.focus()
        nb.page.keyboard.press("Space")

    rows: list[tuple[Callable[[], object], Callable[[], object]]] = [
        (freeze_of(card).click, by_space),
        (by_space, lambda: nb.python("laser.paused = False")),
        (lambda: nb.python("laser.paused = True"), freeze_of(card).click),
    ]
    for freeze, release in rows:
        nb.python("laser.update(**fan())")
        is_live(card)
        locate(card)
        freeze()
        is_frozen(card, 0)
        still = layers(card)
        nb.python("laser.update(**fan({9: 1.0})); laser.update(**fan({9: 0.9}))")
        is_frozen(card, 2)
        assert layers(card) == still
        picture.hover(position={"x": x, "y": y})
        expect(popup.locator(".rw-popup-distance")).to_have_text("1.68 m")
        nb.python("laser.update(**fan({9: 0.8}))")
        is_frozen(card, 3)
        expect(popup.locator(".rw-popup-distance")).to_have_text("1.68 m")
        eventually(lambda: nb.python("print(laser.paused, f'{laser.scan.ranges[9]:.2f}')"), "True 1.68\n")
        release()
        is_live(card)
        picture.hover(position={"x": x, "y": y})
        expect(popup.locator(".rw-popup-distance")).to_have_text("0.80 m")
        expect(card.locator(".rw-nearest")).to_have_text("nearest 0.80 m at 0.0° [9]")
        eventually(lambda: nb.python("print(laser.paused, f'{laser.scan.ranges[9]:.2f}')"), "False 0.80\n")
        nb.page.mouse.move(5, 5)
        expect(popup).to_have_count(0)

    empty = nb.append("empty = LaserWidget(paused=True)\nempty")
    nb.run(empty)
    words = nb.widget(empty).locator(".rw-empty")
    expect(words).to_have_text("waiting for a scan")
    nb.python("empty.update(**fan())")
    is_frozen(nb.widget(empty), 1)
    expect(words).to_have_text("frozen before the first scan")
    assert nb.python("print(empty.scan)") == "None\n"
    nb.python("empty.paused = False")
    expect(words).to_be_hidden()
    locate(nb.widget(empty))


def test_a_busy_cell_is_seen_frozen_pointed_at_and_zoomed_and_a_flood_ends_with_the_newest(
    notebook: Callable[..., Notebook],
) -> None:
    nb = notebook([FIRST])
    nb.resize(700)
    card = nb.widget(0).locator(".rw-card")
    picture, popup = card.locator(".rw-picture"), card.locator(".rw-popup:visible")
    place = locate(card)
    nb.start(nb.append(BUSY.format(stop="busy-laser-seen")))
    for _ in range(3):
        shown = nearest(card)
        expect(card.locator(".rw-nearest")).not_to_have_text(shown)
    picture.hover(position={"x": place.at(2, 0)[0], "y": place.at(2, 0)[1]})
    expect(popup.locator(".rw-popup-expression")).to_have_text("ranges[9]")
    distance = popup.locator(".rw-popup-distance").inner_text()
    expect(popup.locator(".rw-popup-distance")).not_to_have_text(distance)
    expect(card.locator(".rw-facts")).to_have_text(re.compile(r"^laser\s·\s19 rays\s·\s\d+\.\d Hz$"))

    picture.focus()
    nb.page.keyboard.press("Space")
    since = re.compile(r"^Frozen · ([\d\u202f]{2,}) since$")
    expect(freeze_of(card)).to_have_text(since)
    still, counted = layers(card), freeze_of(card).inner_text()
    expect(freeze_of(card)).not_to_have_text(counted)
    assert layers(card) == still
    held = nearest(card)
    picture.click(position={"x": place.at(*FAN[4])[0], "y": place.at(*FAN[4])[1]})
    nb.page.mouse.move(5, 5)
    expect(popup.locator(".rw-popup-expression")).to_have_text("ranges[4]")
    nb.page.keyboard.press("ArrowRight")
    expect(popup.locator(".rw-popup-expression")).to_have_text("ranges[5]")
    card.get_by_role("button", name="Zoom in (+)").click()
    expect(card.locator(".rw-range")).to_have_text("3 m")
    card.locator(".rw-class-no_measurement").click()
    expect(card.locator(".rw-class-no_measurement")).to_have_attribute("aria-pressed", "false")
    assert nearest(card) == held
    (nb.lab.files / "busy-laser-seen").touch()
    nb.wait(1)
    eventually(lambda: nb.python("print(laser.paused, laser.pinned, laser.view_range)"), "True 5 3.0\n")
    eventually(lambda: nb.python("'no_measurement' in laser.marks"), "False")
    assert f"nearest {float(nb.python('laser.scan.nearest().range')):.2f} m at 0.0° [9]" == held
    freeze_of(card).click()
    is_live(card)
    newest = float(nb.python("0.6002 + n / 1000"))
    expect(card.locator(".rw-nearest")).to_have_text(re.compile(rf"^nearest {newest:.2f} m at 0.0° \[9\]$"))

    nb.run(nb.append(FLOOD))
    nb.run(nb.append("flood(scans[2])"))
    expect(card.locator(".rw-nearest")).to_have_text("nearest 0.90 m at 0.0° [9]")
    nb.python("laser.paused = True")
    nb.run(nb.append("thread = threading.Thread(target=flood, args=[scans[1]])\nthread.start()"))
    expect(freeze_of(card)).to_have_text("Frozen · 50\u202f001 since")
    freeze_of(card).click()
    expect(card.locator(".rw-nearest")).to_have_text("nearest 0.80 m at 0.0° [9]")
    nb.run(nb.append("for step in range(50_000):\n    laser.title, laser.pinned = f'step {step}', step % 19"))
    expect(card.locator(".rw-title")).to_have_text("step 49999")
    expect(popup.locator(".rw-popup-expression")).to_have_text(f"ranges[{49_999 % 19}]")
