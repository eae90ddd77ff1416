"""The plot on a page."""

from __future__ import annotations

import base64
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from textwrap import dedent

import pytest
from playwright.sync_api import Browser, Locator, Page, expect

from robowidgets import PlotWidget

from .chromium import LOOKS, shoot
from .laser import eventually
from .plain_page import PlainPage
from .plot import ARRAYS, EMPTY, FAST, FULL, GHOST, LIVE, RECORDED

HOSTILE = "<img src=x onerror=alert(1)>"


def x_of(card: Locator, part: float) -> tuple[float, float]:
    """A position at a share of the width of the first graph."""
    box = card.locator(".u-over").first.bounding_box()
    assert box
    return box["x"] + part * box["width"], box["y"] + box["height"] / 2


def value(card: Locator, line: int) -> Locator:
    """The value of a line in the legend, with its unit."""
    return card.locator(".rw-plot-value").nth(line)


def measures(card: Locator, line: int) -> list[str]:
    """Least, mean and most of a line in the legend."""
    return [card.locator(f".rw-plot-{name}").nth(line).inner_text() for name in ("least", "mean", "most")]


def drag(page: Page, card: Locator, start: float, end: float) -> None:
    """Select a span of the first graph, as shares of its width."""
    page.mouse.move(*x_of(card, start))
    page.mouse.down()
    page.mouse.move(*x_of(card, (start + end) / 2))
    page.mouse.move(*x_of(card, end))
    page.mouse.up()


def ink(card: Locator) -> int:
    """The number of painted pixels of the graphs."""
    read = """(card) => [...card.querySelectorAll(".u-wrap canvas")].reduce((sum, canvas) => sum +
        canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height).data.filter((_, i) => i % 4 === 3)
        .reduce((count, alpha) => count + (alpha > 0), 0), 0)"""
    painted: int = card.evaluate(read)
    return painted


def test_least_mean_and_most_of_many_digits_stand_apart_next_to_the_graphs(
    plain_page: Callable[..., PlainPage],
) -> None:
    cell = """
        from robowidgets import PlotWidget
        plot = PlotWidget()
        plot.set_line("vx", [0.0, 1.0, 2.0, 3.0], [-0.003626, -0.0009539, 0.001937, -0.0011733])
        plot
    """
    nb = plain_page([dedent(cell)])
    nb.resize(760)
    numbers = nb.widget(0).locator(".rw-plot-line").locator(".rw-plot-least, .rw-plot-mean, .rw-plot-most")
    expect(numbers).to_have_text(["\u22120.003626", "\u22120.000954", "0.001937"])
    edges = numbers.evaluate_all(
        """(cells) => cells.map((cell) => {
            const text = new Range();
            text.selectNodeContents(cell);
            return [text.getBoundingClientRect().left, text.getBoundingClientRect().right];
        })"""
    )
    assert all(end + 6 <= start for (_, end), (start, _) in pairwise(edges)), edges


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_lines_and_values_are_readable_at_every_width(
    plain_page: Callable[..., PlainPage], theme: str, scale: int
) -> None:
    nb = plain_page([RECORDED, ARRAYS, FAST, LIVE, EMPTY, FULL, GHOST], run=False, scale=scale, theme=theme)
    nb.run_all()
    for width in (320, 560, 1000):
        nb.resize(width)
        for i, name in enumerate(("recorded", "arrays", "fast", "live", "empty", "full", "ghost")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"plot-{name}-{theme}-{width}")
            assert card.evaluate("(card) => card.scrollWidth <= card.clientWidth")
    recorded = nb.widget(0).locator(".rw-card")
    expect(recorded.locator(".rw-plot-graph")).to_have_count(2)
    expect(recorded.locator(".rw-plot-switch b")).to_have_text(["odom", "cmd_vel", "z"])
    expect(recorded.locator(".rw-plot-switch .rw-index")).to_have_text(
        ["twist.twist.linear.x", "twist.linear.x", "twist.twist.angular.z"]
    )
    expect(recorded.locator(".rw-facts")).to_contain_text("3 lines")
    assert measures(nb.widget(2).locator(".rw-card"), 0)[2] == "9"
    expect(nb.widget(4).locator(".rw-empty")).to_have_text("waiting for values")


@pytest.mark.core
def test_the_exact_value_and_time_at_the_pointer_show_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ARRAYS])
    card = nb.widget(0).locator(".rw-card")
    expect(value(card, 0)).to_have_text("1 m")
    with nb.busy():
        nb.page.mouse.move(*x_of(card, 0.7))
        expect(value(card, 0)).to_have_text("0.5 m")
        expect(value(card, 1)).to_have_text("1.5 m")
        expect(card.locator(".rw-plot-at").first).to_have_text("at 2.000 s")
        shoot(card, "plot-pointer")
        nb.page.mouse.move(*x_of(card, 0.3))
        expect(value(card, 1)).to_have_text("none m")
        nb.page.mouse.move(0, 0)
        expect(value(card, 0)).to_have_text("1 m")
        nb.page.mouse.click(*x_of(card, 0.8))
        nb.page.mouse.move(0, 0)
        expect(value(card, 0)).to_have_text("3 m")
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("ArrowLeft")
        nb.page.keyboard.press("ArrowLeft")
        expect(value(card, 0)).to_have_text("0.5 m")
        expect(card.locator(".rw-live")).to_have_text("2.000 s, a 0.5 m, b 1.5 m")
    eventually(lambda: nb.python("print(plot.time)"), "2.0\n")
    nb.python("plot.time = 0.5")
    expect(value(card, 0)).to_have_text("0 m")


PAINTED = """() => {
    window.painted = [];
    const own = CanvasRenderingContext2D.prototype.fillText;
    CanvasRenderingContext2D.prototype.fillText = function (text, x, ...more) {
        const width = this.measureText(text).width;
        painted.push([text, this.textAlign === "center" ? x - width / 2 : x, width]);
        return own.call(this, text, x, ...more);
    };
}"""
"""Records the texts that are painted from now on, with their left end and their width."""


def test_the_time_at_the_pointer_stands_next_to_the_unit_and_only_on_the_lines(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([ARRAYS])
    card = nb.widget(0).locator(".rw-card")
    expect(value(card, 0)).to_have_text("1 m")
    nb.page.evaluate(PAINTED)
    nb.page.mouse.move(*x_of(card, 0.0))
    expect(value(card, 0)).to_have_text("0 m")
    painted = nb.page.evaluate("painted")
    unit = next(one for one in reversed(painted) if one[0] == "m")
    time = next(one for one in reversed(painted) if one[0] == "0.000 s")
    assert unit[1] + unit[2] + 4 <= time[1], (unit, time)
    nb.page.mouse.click(*x_of(card, -0.05))
    expect(value(card, 0)).to_have_text("1 m")
    assert nb.python("print(plot.time)") == "None\n"
    nb.page.mouse.click(*x_of(card, 1.05))
    expect(value(card, 0)).to_have_text("1 m")
    eventually(lambda: nb.python("print(plot.time)"), "4.0\n")


def test_zooming_measures_what_is_seen_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ARRAYS])
    card = nb.widget(0).locator(".rw-card")
    assert measures(card, 0) == ["0", "0.95", "3"]
    with nb.busy():
        drag(nb.page, card, 0.2, 0.6)
        eventually(lambda: measures(card, 0), ["0.25", "0.375", "0.5"])
        expect(card.locator(".rw-footer")).to_contain_text("seen 0.80 s to 2.40 s")
        card.get_by_role("button", name="Zoom out").click()
        expect(card.locator(".rw-footer")).to_contain_text("seen 0.00 s to 3.20 s")
        nb.page.mouse.dblclick(*x_of(card, 0.5))
        eventually(lambda: measures(card, 0), ["0", "0.95", "3"])
    nb.python("plot.view = (3, 4)")
    eventually(lambda: measures(card, 0), ["1", "2", "3"])


def test_each_value_of_an_hour_at_1_khz_shows_when_the_kernel_is_free(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FAST])
    card = nb.widget(0).locator(".rw-card")
    assert measures(card, 0)[2] == "9"
    with nb.busy():
        drag(nb.page, card, 0.3, 0.4)
        expect(card.locator(".rw-footer")).to_contain_text("finer detail when the kernel is free")
        assert measures(card, 0)[2] == "9"
    expect(card.locator(".rw-footer")).not_to_contain_text("finer detail")
    nb.python("plot.view = (1234.5, 1234.6)")
    expect(card.locator(".rw-footer")).not_to_contain_text("finer detail")
    eventually(lambda: nb.python("print(len(plot.get_state('_detail')['_detail']) // 32)"), "105\n")
    nb.python("plot.time = 1234.567")
    expect(value(card, 0)).to_have_text("9 V")
    expect(card.locator(".rw-plot-at")).to_have_text("at 1234.567 s")


def test_live_lines_on_a_phone_have_a_whole_title_and_one_at_zero_lies_in_the_middle(
    plain_page: Callable[..., PlainPage],
) -> None:
    cell = """
        from robowidgets import PlotWidget
        plot = PlotWidget(title="wheel speeds", units={"v": "m/s", "w": "rad/s"})
        for i in range(100):
            plot.update({"v": 0.0, "w": i / 100}, time=i / 10)
        plot
    """
    nb = plain_page([dedent(cell)])
    nb.resize(376)
    card = nb.widget(0).locator(".rw-card")
    expect(value(card, 1)).to_have_text("0.99 rad/s")
    assert card.locator(".rw-title").evaluate("(title) => title.scrollWidth <= title.clientWidth")
    assert card.locator(".rw-header").evaluate("(header) => header.offsetHeight") == 40
    expect(card.get_by_role("button", name="Freeze the picture (space)")).to_be_visible()
    dark = """(wrap) => {
        const [canvas, over] = ["canvas", ".u-over"].map((name) => wrap.querySelector(name));
        const [x, top, height] = [over.offsetLeft + over.offsetWidth / 2 + 7, over.offsetTop, over.offsetHeight];
        const { data } = canvas.getContext("2d").getImageData(x * devicePixelRatio, top * devicePixelRatio, 1,
            height * devicePixelRatio);
        const rows = [...data].flatMap((red, i) => (i % 4 === 0 && data[i + 3] > 200 && red < 100 ? [i / 4] : []));
        return rows.map((row) => row / devicePixelRatio / height);
    }"""
    rows = card.locator(".u-wrap").first.evaluate(dark)
    assert rows
    assert all(0.45 < row < 0.55 for row in rows)


def test_live_values_stand_still_while_frozen_and_are_followed_again(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([LIVE])
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("seen 29.90 s to 59.90 s")
    with nb.busy():
        card.locator(".rw-plot-freeze").click()
        expect(card.locator(".rw-plot-freeze")).to_have_text("Frozen")
    eventually(lambda: nb.python("print(plot.paused, plot.get_state('_frozen_at')['_frozen_at'])"), "True 59.9\n")
    nb.python("plot.update(v=5.0, heading=0.0, time=70.0); pacer.flush()")
    expect(card.locator(".rw-facts")).to_contain_text("1\u202f202 values")
    expect(value(card, 0)).to_have_text("0.49 m/s")
    expect(card.locator(".rw-footer")).to_contain_text("seen 29.90 s to 59.90 s")
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press("Space")
    expect(value(card, 0)).to_have_text("5 m/s")
    drag(nb.page, card, 0.2, 0.3)
    nb.python("plot.update(v=6.0, heading=0.0, time=71.0); pacer.flush()")
    card.get_by_role("button", name="Follow the newest values").click()
    expect(value(card, 0)).to_have_text("6 m/s")
    expect(card.locator(".rw-footer")).to_contain_text("to 1:11.00")


def test_new_lines_units_and_errors_show_and_names_are_text(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([EMPTY])
    card = nb.widget(0).locator(".rw-card")
    nb.python(f"plot.update({{{HOSTILE!r}: 1.0}}, time=0.0)\nplot.units = {{{HOSTILE!r}: {HOSTILE!r}}}")
    expect(card.locator(".rw-plot-name")).to_have_text(HOSTILE)
    expect(value(card, 0)).to_have_text(f"1 {HOSTILE}")
    assert card.locator("img").count() == 0
    nb.python("try: plot.update(v='fast')\nexcept TypeError: pass")
    expect(card.locator(".rw-notice")).to_contain_text("v: expected a number, got 'fast'.")
    nb.python("plot.update(v=1, time=1.0)")
    expect(card.locator(".rw-plot-name")).to_have_text([HOSTILE, "v"])
    expect(card.locator(".rw-plot-graph")).to_have_count(2)


def test_keys_go_from_mark_to_mark(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ARRAYS.replace('title="by hand"', 'marks=[(1, 1.5, "near"), (3, 3, "bump")]')])
    card = nb.widget(0).locator(".rw-card")
    card.locator(".rw-picture").focus()
    for key, seconds, text in (("n", "1.0", "near"), ("n", "3.0", "bump"), ("p", "1.0", "near")):
        nb.page.keyboard.press(key)
        expect(card.locator(".rw-live")).to_contain_text(text)
        eventually(lambda: nb.python("print(plot.time)"), f"{seconds}\n")


def test_a_page_without_a_kernel_reads_and_zooms(browser: Browser, tmp_path: Path) -> None:
    plot = PlotWidget(title="page", units={"v": "m"})
    plot.set_line("v", [0, 1, 2, 3, 4], [0.0, 1.0, 2.0, 4.0, 0.0])
    file = plot.to_html(tmp_path / "plot.html", note="A plot.")
    plot.close()
    context = browser.new_context(offline=True)
    page = context.new_page()
    complaints: list[str] = []
    page.on("console", lambda message: complaints.append(message.text))
    page.on("pageerror", lambda error: complaints.append(error.message))
    page.goto(file.as_uri())
    card = page.locator(".rw-plot")
    expect(value(card, 0)).to_have_text("0 m")
    assert ink(card) > 1000
    page.mouse.move(*x_of(card, 0.8))
    expect(value(card, 0)).to_have_text("4 m")
    drag(page, card, 0.1, 0.6)
    eventually(lambda: measures(card, 0), ["1", "1.5", "2"])
    shoot(page.locator("body"), "plot-page")
    context.close()
    assert complaints == []


def test_a_png_has_the_lines(plain_page: Callable[..., PlainPage], tmp_path: Path) -> None:
    nb = plain_page([ARRAYS])
    path = tmp_path / "plot.png"
    nb.python(f"saving = plot.save_png({str(path)!r})")
    eventually(path.exists, True)
    shoot(nb.widget(0).locator(".rw-card"), "plot-beside-png")
    dark = """(url) => new Promise((done) => { const image = new Image(); image.onload = () => {
        const canvas = document.createElement("canvas"); canvas.width = image.width; canvas.height = image.height;
        const context = canvas.getContext("2d"); context.drawImage(image, 0, 0);
        const { width, height } = image;
        const part = context.getImageData(0.2 * width, 0.25 * height, 0.4 * width, 0.4 * height);
        done(part.data.filter((_, i) => i % 4 === 0).reduce((count, red) => count + (red < 60), 0)); };
        image.src = url; })"""
    eventually(lambda: nb.python("print(saving)"), f"<{path}: written>\n")
    url = "data:image/png;base64," + base64.b64encode(path.read_bytes()).decode()
    assert nb.page.evaluate(dark, url) > 200


def test_what_two_lines_differ_by_and_what_holds_at_the_pointer_stand_next_to_them(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([FULL])
    card = nb.widget(0).locator(".rw-card")
    nb.page.mouse.move(*x_of(card, 13.0 / 58.0))
    expect(card.locator(".rw-plot-difference .rw-plot-name")).to_have_text("odom \u2212 cmd_vel")
    shown = [card.locator(".rw-plot-value b").nth(i).inner_text().replace("\u2212", "-") for i in range(3)]
    assert float(shown[2]) == pytest.approx(float(shown[0]) - float(shown[1]), abs=1e-3)
    expect(card.locator(".rw-plot-state .rw-plot-name")).to_have_text("back")
    expect(card.locator(".rw-plot-mark")).to_have_class("rw-plot-mark rw-on")
    expect(card.locator(".rw-plot-mark .rw-plot-at")).to_have_text("8 times, 12.40 s")
    nb.page.mouse.move(*x_of(card, 5.0 / 58.0))
    expect(card.locator(".rw-plot-state .rw-plot-name")).to_have_text("forward")
    expect(card.locator(".rw-plot-mark")).to_have_class("rw-plot-mark")
    band = card.locator(".rw-plot-states").bounding_box()
    assert band
    nb.page.mouse.click(band["x"] + 60 + (band["width"] - 60) * 0.5, band["y"] + 7)
    eventually(lambda: round(float(nb.python("print(plot.time)")), 0), 29.0)


def test_a_click_leaves_a_line_out_while_a_cell_runs_and_keys_pick_one(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ARRAYS])
    card = nb.widget(0).locator(".rw-card")
    with nb.busy():
        card.get_by_role("button", name="a", exact=True).click()
        expect(card.locator(".rw-plot-off .rw-plot-left")).to_have_text("not drawn")
        expect(card.locator(".rw-plot-difference")).to_have_count(0)
        card.get_by_role("button", name="a", exact=True).click()
        expect(card.locator(".rw-plot-off")).to_have_count(0)
        card.locator(".rw-picture").focus()
        nb.page.keyboard.press("]")
        expect(card.locator(".rw-live")).to_have_text("a")
        nb.page.keyboard.press("]")
        expect(card.locator(".rw-live")).to_have_text("b")
        nb.page.keyboard.press("Delete")
    eventually(lambda: nb.python("print(plot.names, plot.off)"), "('a',) []\n")


def test_one_line_is_drawn_over_the_other(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([ARRAYS])
    card = nb.widget(0).locator(".rw-card")
    with nb.busy():
        card.get_by_role("button", name="Draw the second line over the first").click()
        expect(card.locator(".rw-plot-graphs")).to_be_hidden()
        picture = card.locator(".rw-picture").bounding_box()
        assert picture
        nb.page.mouse.click(picture["x"] + picture["width"] / 2, picture["y"] + picture["height"] / 2)
        shoot(card, "plot-over")
    eventually(lambda: nb.python("print(plot.x_over_y)"), "('a', 'b')\n")
    nb.python("plot.x_over_y = None")
    expect(card.locator(".rw-plot-graphs")).to_be_visible()


def test_a_line_is_added_from_a_list_by_words_and_keys(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([FULL])
    card = nb.widget(0).locator(".rw-card")
    card.get_by_role("button", name="Add a line").click()
    card.get_by_role("searchbox").fill("pose position y")
    expect(card.locator(".rw-plot-choice")).to_have_text(["/odom.pose.pose.position.y"])
    shoot(card, "plot-adder")
    nb.page.keyboard.press("Enter")
    expect(card.locator(".rw-plot-switch b")).to_have_text(["odom", "cmd_vel", "z", "y"])
    expect(card.locator(".rw-plot-adder")).to_be_hidden()
    assert nb.python("print(plot.units[plot.names[-1]])") == "m\n"


def test_ghosts_are_moved_by_seconds_that_are_typed(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([GHOST])
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-footer")).to_contain_text("seen 0.00 s to 59.50 s")
    card.get_by_label("shift").fill("4")
    nb.page.keyboard.press("Enter")
    expect(card.locator(".rw-footer")).to_contain_text("seen 0:00.00 to 1:02.00")
    assert nb.python("print(plot.shift)") == "4.0\n"


PLAYED = """
import robowidgets
player = robowidgets.open(robowidgets.SAMPLE).show("/scan", "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x")
player
"""


def test_a_plot_in_a_player_shows_and_sets_the_time_of_all_widgets_while_a_cell_runs(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([PLAYED])
    card = nb.page.locator(".rw-plot")
    expect(card.locator(".rw-plot-switch b")).to_have_text(["odom", "cmd_vel"])
    card.locator(".u-over").first.scroll_into_view_if_needed()
    laser = nb.page.locator(".rw-laser .rw-footer")
    before = laser.inner_text()
    with nb.busy():
        nb.page.mouse.move(*x_of(card, 0.01))
        nb.page.mouse.click(*x_of(card, 0.02))
        nb.page.mouse.move(0, 0)
    eventually(lambda: 0.5 < float(nb.python("print(player.time)")) < 2.0, True)
    eventually(lambda: laser.inner_text() != before, True)
    nb.python("player.time = 14.0")
    expect(card.locator(".rw-plot-at").first).to_contain_text("at 14.000 s")
    shoot(nb.page.locator("body"), "plot-player")
