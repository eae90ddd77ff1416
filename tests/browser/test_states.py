"""The states of a recorded program as a band: on the player, under the scanogram, and in a page in a file."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

from playwright.sync_api import Locator, Page, expect

from ..unit.recordings import program_run
from .chromium import shoot
from .plain_page import PlainPage

SHOW = """
import robowidgets
recording = robowidgets.open({path!r})
player = recording.show()
player.seek(5.5)
player
"""


def at(part: Locator, share: float, above: float = 8) -> dict[str, float]:
    """A position in a part: a share of its width across, and some pixels above its foot."""
    box = part.bounding_box()
    assert box
    return {"x": share * box["width"], "y": box["height"] - above}


def test_states_stand_on_player_and_scanogram_are_named_and_lead_to_their_time(
    plain_page: Callable[..., PlainPage],
    static_page: Callable[[Path], Page],
    tmp_path: Path,
) -> None:
    file = program_run.write(tmp_path / "run")
    nb = plain_page([SHOW.format(path=str(file))], scale=2)
    player, scanogram = nb.page.locator(".rw-player"), nb.page.locator(".rw-scanogram")
    band, slider = player.locator(".rw-play-states"), player.locator("input[type=range]")
    expect(slider).to_have_attribute("aria-valuetext", "5.50 of 10.00 seconds, Walker \u203a avoid")
    for theme, width in (("light", 400), ("dark", 900)):
        nb.theme(theme)
        nb.resize(width)
        shoot(player, f"states-player-{theme}-{width}")
        shoot(scanogram, f"states-scanogram-{theme}-{width}")
        nb.python("player.seek(5.5)")
        expect(slider).to_have_attribute("aria-valuetext", "5.50 of 10.00 seconds, Walker \u203a avoid")
        with nb.busy():
            band.hover(position=at(band, 0.2))
            expect(band).to_have_attribute("title", "Walker \u203a forward")
            band.click(position=at(band, 0.8))
            expect(slider).to_have_attribute(
                "aria-valuetext", re.compile(r"^(7.9|8.0)\d of 10.00 seconds, Walker \u203a forward$")
            )
            picture = scanogram.locator(".rw-picture")
            picture.hover(position=at(picture, 0.65, above=24 + 8))
            popup = scanogram.locator(".rw-popup:visible")
            expect(popup).to_contain_text("Walker \u203a avoid \u203a turn_left")
            expect(popup).to_contain_text("5.00 \u2013 7.00 s")

    html = tmp_path / "run.html"
    nb.python(f"recording.to_html({str(html)!r}, start=3, end=9)")
    page = static_page(html)
    band = page.locator(".rw-play-states")
    expect(band).to_be_visible()
    band.hover(position=at(band, 0.5))
    expect(band).to_have_attribute("title", "Walker \u203a avoid")
    shoot(page.locator(".rw-scanogram"), "states-exported")
    nb.python("player.close()\nrecording.close()")
