"""Cards that the user arranges on a screen, by pointer and keys, in full screen and undone; and links to a moment."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, Page, expect

import robowidgets

from ..unit.waiting import wait_for
from .chromium import shoot
from .notebook import Notebook
from .plain_page import PlainPage
from .test_feed_view import opened as robot_opened

OPEN = f"import robowidgets\nrecording = robowidgets.open({str(robowidgets.SAMPLE)!r})"
SHOW = "player = recording.show()\nplayer"
IS_FREE = """stop => {
    const { x, y, width, height } = stop.getBoundingClientRect();
    const points = [[0.1, 0.2], [0.5, 0.5], [0.9, 0.8]].map(([i, j]) => [x + i * width, y + j * height]);
    return points.every(([x, y]) => stop.contains(stop.getRootNode().elementFromPoint(x, y)));
}"""


APART = """cards => {
    const boxes = cards.map((card) => card.getBoundingClientRect());
    const apart = (a, b) => a.right <= b.left || b.right <= a.left || a.bottom <= b.top || b.bottom <= a.top;
    return boxes.every((a, i) => boxes.every((b, j) => i === j || apart(a, b)));
}"""


def box(locator: Locator) -> dict[str, float]:
    found = locator.bounding_box()
    assert found is not None
    return dict(found)


def header(out: Locator, card: str) -> Locator:
    return out.locator(f".rw-{card} > .rw-header")


def drag(page: Page, start: tuple[float, float], end: tuple[float, float], *, drops: bool = True) -> None:
    """Press, move as a hand does, and release."""
    page.mouse.move(*start)
    page.mouse.down()
    page.mouse.move(start[0] + 6, start[1] + 2)
    page.mouse.move(*end, steps=5)
    if drops:
        page.mouse.up()


def on_header(out: Locator, card: str) -> tuple[float, float]:
    at = box(header(out, card))
    return at["x"] + 40, at["y"] + 8


def lower_part(out: Locator, card: str) -> tuple[float, float]:
    at = box(out.locator(f".rw-{card}"))
    return at["x"] + at["width"] / 2, at["y"] + at["height"] * 0.8


def cards(nb: PlainPage | Notebook, name: str = "player") -> Any:
    """The arrangement by hand that Python has."""
    return json.loads(nb.python(f"import json; print(json.dumps({name}._cards.get('all')))"))


def settled(out: Locator) -> None:
    """Wait until the cards stand still."""
    stand = "document.getAnimations().every(one => one.playState === 'finished')"
    wait_for(lambda: out.page.evaluate(stand), "the cards stand still")


def test_cards_and_edges_are_dragged_while_the_kernel_is_busy_and_undone(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN, SHOW], width=1100, height=760)
    out = nb.output(1)
    page = nb.page
    nb.drawn()
    expect(out.locator(".rw-grip")).to_have_count(0)  # at rest nothing shows that cards can be moved
    before = box(out.locator(".rw-speed"))
    header(out, "speed").hover(position={"x": 40, "y": 8})
    expect(out.locator(".rw-speed .rw-grip")).to_have_css("opacity", "1")
    assert box(out.locator(".rw-speed")) == before, "the grip moves nothing"
    with nb.busy():
        drag(page, on_header(out, "speed"), lower_part(out, "laser"), drops=False)
        expect(out.locator(".rw-drop-place")).to_be_visible()
        expect(out.locator(".rw-dragged .rw-speed")).to_be_visible()
        shoot(out, "arrange-drag-light")
        page.keyboard.press("Escape")
        expect(out.locator(".rw-by-hand, .rw-drop-place")).to_have_count(0)
        page.mouse.up()
        drag(page, on_header(out, "speed"), lower_part(out, "laser"))
        settled(out)
        speed, laser = box(out.locator(".rw-speed")), box(out.locator(".rw-laser"))
        assert speed["x"] == laser["x"]
        assert speed["y"] > laser["y"] + laser["height"]
        expect(out.locator(".rw-speed .rw-grip")).to_be_focused()
    moved = cards(nb)
    assert moved["row"][1] == {"column": ["/scan", "/odom"], "width": 5}
    # The edge between the columns.
    left = box(out.locator(".rw-scanogram"))
    at = left["x"] + left["width"] + 2, left["y"] + 80
    page.mouse.move(*at)
    expect(out.locator(".rw-edge-line")).to_be_visible()
    drag(page, at, (at[0] - 180, at[1]))
    wait_for(lambda: [part["width"] for part in cards(nb)["row"]] == [5, 7], "the edge has moved by two twelfths")
    # Undone, with words, until the places of the widgets decide.
    words = out.locator(".rw-arranged-words")
    page.keyboard.press("Control+z")
    expect(words).to_have_text("back: edge moved")
    assert cards(nb) == moved
    page.keyboard.press("Control+z")
    expect(words).to_have_text("back: speed /odom moved")
    settled(out)
    wait_for(lambda: cards(nb) is None, "Python has the places of the widgets")
    assert box(out.locator(".rw-speed")) == before
    # A preset, which is lit, and the code of the arrangement.
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    large = out.get_by_role("button", name="Large laser")
    large.click()
    expect(large).to_have_attribute("aria-pressed", "true")
    settled(out)
    assert box(out.locator(".rw-laser"))["width"] > 0.6 * box(out.locator(".rw-one-screen"))["width"]
    assert out.locator(".rw-screen .rw-card").evaluate_all(APART), "no card covers another one"
    for width in (400, 640, 848, 1600):
        nb.resize(width, 760)
        assert out.locator(".rw-screen .rw-card").evaluate_all(APART), width
        for card in out.locator(".rw-card").all():
            assert card.evaluate("card => card.scrollWidth <= card.clientWidth + 1"), width
        shoot(out, f"arrange-large-laser-light-{width}")
    out.get_by_role("button", name="Copy arrangement").click()
    code = page.evaluate("navigator.clipboard.readText()")
    nb.python(f"{code}again = recording.show(arrangement=arrangement)\nassert again.arrangement == player.arrangement")
    large.click()
    wait_for(lambda: cards(nb) is None, "the preset is off")


def test_a_dragged_edge_leaves_the_columns_of_a_narrow_screen_next_to_each_other(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([OPEN, SHOW], width=900, height=900)
    nb.resize(848, 900)  # of a cell in a window of 1280 px
    out, page = nb.output(1), nb.page
    before = {name: box(out.locator(f".rw-{name}")) for name in ("scanogram", "speed", "touch", "laser")}
    at = before["laser"]["x"] - 2, before["laser"]["y"] + 80
    drag(page, at, (at[0] - 12, at[1]), drops=False)
    for name, old in before.items():
        now = box(out.locator(f".rw-{name}"))
        # Columns have whole twelfths: three next to each other are rounded further.
        assert now["x"] == pytest.approx(old["x"], abs=848 / 12 if name == "touch" else 40), name
        assert now["y"] == pytest.approx(old["y"], abs=40), name
    page.mouse.up()


def test_keys_move_a_card_and_show_it_alone(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([OPEN, SHOW], width=1100, height=760, theme="dark")
    out, page = nb.output(1), nb.page
    nb.drawn()
    header(out, "touch").hover(position={"x": 60, "y": 8})
    grip = out.locator(".rw-touch .rw-grip")
    grip.focus()
    page.keyboard.press("ArrowRight")
    expect(out.locator(".rw-arranged-live")).to_have_text(re.compile("^touch /bumper, first column.*third column$"))
    expect(grip).to_be_focused()
    page.keyboard.press("Escape")
    expect(out.locator(".rw-by-hand")).to_have_count(0)
    page.keyboard.press("ArrowRight")
    page.keyboard.press("Shift+ArrowLeft")
    page.keyboard.press("Enter")
    wait_for(lambda: cards(nb) is not None, "Python has the arrangement")
    row = cards(nb)["row"][0]["column"][1]["row"]
    assert [part["card"] for part in row] == ["/odom", "/odom as path", "/bumper"]
    # One card in full screen: its own keys work, others are a strip of names.
    out.locator(".rw-touch > .rw-picture").focus()
    page.keyboard.press("f")
    strip = out.locator(".rw-card-strip")
    expect(strip.get_by_role("button", pressed=True)).to_have_text("touch /bumper")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(1)
    expect(out.locator(".rw-player")).to_be_visible()
    page.wait_for_function("document.fullscreenElement !== null")
    strip.get_by_role("button", pressed=True).focus()
    page.keyboard.press("ArrowRight")
    expect(out.locator(".rw-screen .rw-card.rw-path")).to_be_visible()
    page.keyboard.press("ArrowRight")
    expect(out.locator(".rw-screen .rw-card.rw-laser")).to_be_visible()
    shoot(out.locator(".rw-one-screen"), "arrange-full-dark")
    page.keyboard.press("Escape")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(5)
    page.wait_for_function("document.fullscreenElement === null")
    header(out, "laser").dblclick(position={"x": 40, "y": 8})
    expect(out.locator(".rw-screen .rw-card")).to_have_count(1)
    page.keyboard.press("f")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(5)
    out.locator(".rw-laser > .rw-picture").focus()
    page.keyboard.press("f")  # the formula of its angle
    expect(out.locator(".rw-screen .rw-card")).to_have_count(5)
    page.keyboard.press("Shift+F")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(1)
    expect(out.locator(".rw-laser > .rw-picture")).to_be_focused()
    page.keyboard.press("Escape")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(5)
    assert [part["card"] for part in cards(nb)["row"][0]["column"][1]["row"]] == ["/odom", "/odom as path", "/bumper"]


def test_stop_stays_at_its_place_and_is_never_covered(plain_page: Callable[..., PlainPage]) -> None:
    nb = robot_opened(plain_page, "turtlebot3", width=1160)
    out, page = nb.output(2), nb.page
    stop = out.locator(".rw-stop-bar .rw-stop")
    place = box(stop)

    def stays() -> None:
        settled(out)
        assert box(stop) == place
        assert stop.evaluate(IS_FREE)

    drag(page, on_header(out, "laser"), (place["x"] + 30, place["y"] + 20), drops=False)
    stays()
    page.mouse.up()
    stays()
    out.get_by_role("button", name="Large laser").click()
    stays()
    shoot(out, "arrange-feed-light")
    header(out, "simulator").dblclick(position={"x": 40, "y": 8})
    expect(out.locator(".rw-screen .rw-card")).to_have_count(1)
    stays()
    assert page.evaluate("document.fullscreenElement") is None, "there Escape would not reach Stop"
    shoot(out, "arrange-feed-full-light")
    page.keyboard.press("Escape")
    expect(stop).to_have_text("Stopped")
    expect(out.locator(".rw-screen .rw-card")).to_have_count(7)
    assert box(stop)["x"] == place["x"]
    assert box(stop)["y"] == place["y"]
    page.keyboard.press("Control+z")
    expect(out.locator(".rw-arranged-words")).to_have_text("back: large laser")
    assert stop.evaluate(IS_FREE)


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    arrangement = {"cards": {"column": [{"row": ["/odom", "/scan"]}, "scanogram"]}}
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        player = recording.show("/scan", "/odom", arrangement=arrangement)
        try:
            return player.to_html(tmp_path_factory.mktemp("pages") / "turn.html", start=20, end=30)
        finally:
            player.close()


def test_a_page_keeps_the_arrangement_and_opens_at_a_moment(static_page: Callable[..., Page], file: Path) -> None:
    page = static_page(file)
    page.goto(f"{file.as_uri()}#t=24.1&ray=105")
    page.reload()
    bar = page.locator(".rw-player")
    expect(bar.locator(".rw-play-now")).to_have_text("24.10")
    expect(bar.locator(".rw-play-words")).to_have_text("24.10 s, from the link")
    popup = page.locator(".rw-laser .rw-popup", has_text="ranges[105]")
    expect(popup).to_be_visible()
    screen = page.locator(".rw-one-screen")
    speed, laser = box(page.locator(".rw-speed")), box(page.locator(".rw-laser"))
    assert speed["x"] < laser["x"]
    assert speed["y"] == laser["y"]
    expect(page.locator(".rw-speed .rw-empty")).to_be_hidden()
    shoot(page.locator("main"), "arrange-page-light")
    # The link of another moment.
    page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    bar.locator("input[type=range]").evaluate("(bar) => { bar.value = 26; bar.dispatchEvent(new Event('input')); }")
    expect(bar.locator(".rw-play-words")).to_have_text("")
    popup.get_by_role("button", name="Copy link").click()
    expect(popup.get_by_role("button", name="Copied")).to_be_visible()
    link = page.evaluate("navigator.clipboard.readText()")
    assert re.fullmatch(re.escape(file.as_uri()) + r"#t=26&ray=105", link)
    page.evaluate("location.hash = '#t=21.5&ray=7'")
    expect(bar.locator(".rw-play-now")).to_have_text("21.50")
    expect(page.locator(".rw-laser .rw-popup", has_text="ranges[7]")).to_be_visible()
    page.locator(".rw-page-data").get_by_role("button", name="Copy link").click()
    assert page.evaluate("location.hash") == "#t=21.5&ray=7"
    # Arranged further, without any kernel.
    drag(page, on_header(screen, "speed"), lower_part(screen, "scanogram"))
    settled(screen)
    assert box(page.locator(".rw-speed"))["y"] > box(page.locator(".rw-scanogram"))["y"]


def test_a_saved_notebook_keeps_the_arrangement(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN, SHOW], width=1280, height=900)
    out = nb.output(1)
    nb.drawn()
    drag(nb.page, on_header(out, "speed"), lower_part(out, "laser"))
    settled(out)
    speed, laser = box(out.locator(".rw-speed")), box(out.locator(".rw-laser"))
    assert (speed["x"], speed["width"]) == (laser["x"], laser["width"])
    assert speed["y"] > laser["y"]
    shoot(out, "arrange-lab-light")
    nb.page.keyboard.press("Control+z")  # in the screen, not in the notebook
    expect(out.locator(".rw-arranged-words")).to_have_text("back: speed /odom moved")
    settled(out)
    wait_for(lambda: cards(nb) is None, "the kernel has it")
    drag(nb.page, on_header(out, "speed"), lower_part(out, "laser"))
    settled(out)
    wait_for(lambda: cards(nb) is not None, "the kernel has it")
    arranged = cards(nb)
    assert arranged["column"][0]["row"][1]["column"] == ["/scan", "/odom"]
    nb.run(1)  # the same request
    settled(out)
    assert cards(nb) == arranged
    states = json.loads(nb.save().read_text())["metadata"]["widgets"]["application/vnd.jupyter.widget-state+json"]
    kept = [model["state"]["_cards"] for model in states["state"].values() if "_cards" in model["state"]]
    assert {"all": arranged} in kept
