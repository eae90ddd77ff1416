"""A page in a file: opened from disk without a network, it plays, and shows and saves what was recorded."""

from __future__ import annotations

import csv
import re
from collections.abc import Callable, Collection, Iterator, Sequence
from math import pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from playwright.sync_api import Browser, Page, expect

import robowidgets
from robowidgets import SAMPLE, LaserWidget, Scan
from robowidgets.messages.any_message import value_at
from robowidgets.messages.channel import Channel
from robowidgets.repair.source import Message
from robowidgets.repair.write import write
from robowidgets.widget.pacer import pacer

from ..unit.recordings import recorded, sweeps
from ..unit.recordings.first_messages import Sent, by_type, first_messages
from . import firefox
from .chromium import PICTURES, SCREENSHOTS, shoot

HOSTILE = "</script><img src=x onerror=alert(1)><script>alert(2)</script>"
NUMBER = re.compile(r"-?[0-9][0-9,]*(\.[0-9]+)?(e[+-]?[0-9]+)?")
READ_TREES = """() => Object.fromEntries([...document.querySelectorAll(".rw-message")].map((card) => [
    card.querySelector(".rw-title").textContent,
    Object.fromEntries([...card.querySelectorAll("[data-rw-row]")].map((row) =>
        [row.dataset.rwRow, row.querySelector(".rw-message-value")?.textContent ?? ""])),
]))"""
ALL_READ = """(names) => {
    const cards = [...document.querySelectorAll(".rw-message")].filter((card) => card.querySelector("[data-rw-row]"));
    const there = cards.map((card) => card.querySelector(".rw-title").textContent);
    return names.every((name) => there.includes(name));
}"""
MANY = 20
"""Topics on a page of the test: each new card makes the browser lay out all others again."""

MARKS = [(12.0, 12.5, HOSTILE), (16.5, 16.5, "turn")]


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    with robowidgets.open(SAMPLE) as recording:
        path = tmp_path_factory.mktemp("pages") / "bump.html"
        return recording.to_html(path, start=10.25, end=20, marks=MARKS, title=HOSTILE, note=f"It turns.\n{HOSTILE}")


@pytest.fixture
def complaints() -> list[str]:
    """The requests, console messages and dialogs of pages."""
    return []


@pytest.fixture
def offline(browser: Browser, complaints: list[str]) -> Iterator[Callable[..., Page]]:
    """Open files without a network; after the test, check that no page has requested anything else, or complained."""
    contexts = []

    def open_file(file: Path, before: str = "", **options: Any) -> Page:
        contexts.append(browser.new_context(offline=True, **options))
        page = contexts[-1].new_page()
        page.add_init_script(before)
        page.on("console", lambda message: complaints.append(message.text))
        page.on("pageerror", lambda error: complaints.append(error.message))
        page.on("dialog", lambda dialog: complaints.append(dialog.message))
        page.on("request", lambda request: complaints.append(request.url) if request.url[:5] != "data:" else None)
        page.goto(file.as_uri())
        assert complaints == [file.as_uri()]
        complaints.clear()
        return page

    yield open_file
    for context in contexts:
        context.close()
    assert complaints == []


WATCH_MARKS = """window.tooWide = [];
new MutationObserver(() => {
    for (const { style } of document.querySelectorAll(".rw-play-marks span"))
        if (parseFloat(style.width) > 100) window.tooWide.push(style.width);
}).observe(document, { childList: true, subtree: true, attributes: true });"""


def test_a_mark_is_never_longer_than_the_bar_while_a_page_opens(file: Path, offline: Callable[..., Page]) -> None:
    page = offline(file, WATCH_MARKS, viewport={"width": 1100, "height": 800})
    expect(page.locator(".rw-play-mark")).to_have_count(len(MARKS))
    assert page.evaluate("() => window.tooWide") == []


@pytest.mark.core
def test_a_page_plays_and_its_numbers_match_the_recording(offline: Callable[..., Page], file: Path) -> None:
    page = offline(file, viewport={"width": 1280, "height": 800})
    laser, bar = page.locator(".rw-laser"), page.locator(".rw-player")
    expect(laser.locator(".rw-nearest")).to_contain_text("nearest")
    expect(page.locator(".rw-scanogram")).to_contain_text("97 scans")
    expect(page.locator("h1")).to_have_text(HOSTILE)
    expect(page.locator(".rw-page-note")).to_have_text(f"It turns. {HOSTILE}")
    expect(page.locator(".rw-page-text")).to_have_count(0)
    assert page.locator("img").count() == 0
    shoot(page.locator("body"), "to-html")

    bar.locator(".rw-slider").focus()
    page.keyboard.press("n")
    page.keyboard.press("n")
    expect(bar.locator(".rw-play-now")).to_have_text("16.50")
    with robowidgets.open(SAMPLE) as recording:
        scan, speed = recording.at("/scan", 16.5), recording.at("/odom", 16.5)
    assert scan
    assert speed
    near = scan.sample.nearest()
    expect(laser.locator(".rw-nearest")).to_contain_text(f"nearest {near.range:.2f} m")
    expect(laser.locator(".rw-nearest")).to_contain_text(f"[{near.index}]")
    expect(page.locator(".rw-speed .rw-value:not(:empty)").first).to_contain_text(
        f"{speed.sample.linear[0]:.2f}".replace("-", "−")
    )

    page.keyboard.press("Home")
    expect(bar.locator(".rw-play-now")).to_have_text("10.25")
    page.keyboard.press(",")
    expect(bar.locator(".rw-play-now")).to_have_text("10.25")
    page.keyboard.press(".")
    expect(bar.locator(".rw-play-now")).to_have_text("10.30")
    bar.locator(".rw-play-speed").select_option("10")
    bar.locator(".rw-play").click()
    expect(bar.locator(".rw-play-now")).to_have_text("20.00")
    expect(bar.locator(".rw-play")).to_have_attribute("title", "Play (space)")


def test_the_bar_is_as_wide_as_the_page_and_no_card_is_wider(offline: Callable[..., Page], file: Path) -> None:
    page = offline(file, viewport={"width": 1280, "height": 800})
    bar = page.locator(".rw-player")
    for width in (1280, 400):
        page.set_viewport_size({"width": width, "height": 800})
        expect(bar).to_have_js_property("offsetWidth", width - 24)
        assert page.evaluate("document.documentElement.scrollWidth") == width


def test_a_zoomed_scanogram_shows_the_measured_ranges(offline: Callable[..., Page], file: Path) -> None:
    page = offline(file, viewport={"width": 1280, "height": 800})
    picture = page.locator(".rw-scanogram .rw-picture")
    popup = page.locator(".rw-scanogram .rw-popup:visible")
    expect(page.locator(".rw-scanogram")).to_contain_text("97 scans")
    for _ in range(3):
        page.locator(".rw-scanogram").get_by_role("button", name="Zoom in").click()
    picture.hover(position={"x": 500, "y": 90})
    expect(popup).to_contain_text(re.compile(r"scan \d+"))
    text = popup.inner_text()
    index = int(re.search(r"ranges\[(\d+)\]", text)[1])  # type: ignore[index]
    at = float(re.search(r"([\d.]+) s\s+scan", text)[1])  # type: ignore[index]
    with robowidgets.open(SAMPLE) as recording:
        moment = recording.at("/scan", at + 0.006)
    assert moment
    expect(popup).to_contain_text(f"{moment.sample.ranges[index]:.2f} m")


def test_scans_whose_number_of_rays_changes_stand_by_angle(offline: Callable[..., Page], tmp_path: Path) -> None:
    """All rays of scan i measure 1 + i / 100 m, from 36 to 40 of them all round."""
    scans = [
        (i / 10, sweeps.scan(sweeps.START_NS + i * 10**8, [1 + i / 100] * rays, angle_min=-pi, increment=2 * pi / rays))
        for i in range(50)
        for rays in [36 + i % 5]
    ]
    with robowidgets.open(sweeps.write(tmp_path / "scans", scans)) as recording:
        page = offline(recording.to_html(tmp_path / "a.html"), viewport={"width": 1100, "height": 800})
    scanogram = page.locator(".rw-scanogram")
    expect(scanogram).to_contain_text("50 scans")
    expect(scanogram).to_contain_text("drawn by angle")
    picture, popup = scanogram.locator(".rw-picture"), scanogram.locator(".rw-popup:visible")
    for y in (100, 200, 400):
        picture.hover(position={"x": 100 + y, "y": y})
        expect(popup).to_contain_text(re.compile(r"scan \d+"))
        text = popup.inner_text()
        number = int(re.search(r"scan (\d+)", text)[1])  # type: ignore[index]
        assert f"{1 + number / 100:.2f} m" in text
    shoot(page.locator("body"), "to-html-by-angle")


def test_the_samples_are_saved_exactly(offline: Callable[..., Page], file: Path) -> None:
    page = offline(file)
    with page.expect_download() as saved:
        page.get_by_role("button", name="/scan as CSV").click()
    assert saved.value.suggested_filename == "sample-scan.csv"
    head, *rows = csv.reader(Path(saved.value.path()).read_text(encoding="utf-8").splitlines())
    with robowidgets.open(SAMPLE) as recording:
        scans = recording[10.25:20].scans("/scan")
    first = head.index("ranges[0]")
    ranges = np.array([row[first : first + scans.ranges.shape[1]] for row in rows], np.float32)
    assert np.array_equal(ranges.view(np.uint32), np.asarray(scans.ranges).view(np.uint32))
    assert [float(row[0]) for row in rows] == pytest.approx(scans.seconds)
    for topic in ("/odom", "/cmd_vel", "/bumper"):
        with page.expect_download() as saved:
            page.get_by_role("button", name=f"{topic} as CSV").click()
        assert saved.value.suggested_filename == f"sample-{topic[1:]}.csv"
        _, *rows = csv.reader(Path(saved.value.path()).read_text(encoding="utf-8").splitlines())
        with robowidgets.open(SAMPLE) as recording:
            moments = [(one.seconds, one.sample.stamp_ns or 0) for one in recording[10.25:20].samples(topic)]
        assert [(float(row[0]), int(row[1])) for row in rows] == moments, "a row for each message"
    with page.expect_download() as saved:
        page.locator(".rw-laser").get_by_role("button", name="Save as PNG").click()
    assert Path(saved.value.path()).read_bytes().startswith(b"\x89PNG")


def test_the_policy_of_the_page_forbids_requests_and_scripts(
    offline: Callable[..., Page], file: Path, complaints: list[str]
) -> None:
    page = offline(file)
    expect(page.locator(".rw-laser")).to_be_visible()
    refused = page.evaluate(
        """async () => {
          const refused = [];
          addEventListener("securitypolicyviolation", (event) => refused.push(event.effectiveDirective));
          await fetch("https://example.org/").catch(() => {});
          const script = document.createElement("script");
          script.textContent = "window.ran = true";
          document.head.append(script, Object.assign(new Image(), { src: "https://example.org/a.png" }));
          // In a task of its own: what Playwright evaluates may evaluate text.
          await new Promise((resume) => setTimeout(() => {
            try { Function("window.ran = true")(); } catch {}
            setTimeout(resume, 50);
          }));
          return { refused: refused.sort(), ran: window.ran === true };
        }"""
    )
    assert refused["ran"] is False
    assert {"connect-src", "img-src", "script-src-elem", "script-src"} <= set(refused["refused"])
    assert all("Content Security Policy" in line or "example.org" in line for line in complaints)
    complaints.clear()


def test_a_page_of_a_widget_plays_its_history(offline: Callable[..., Page], tmp_path: Path) -> None:
    laser = LaserWidget(title="/scan", pinned=1)
    for metres in (1.0, 2.0, 3.0):
        laser.update(Scan([9.0, metres, 9.0], -0.5, 0.5, 0, 10))
        pacer.flush()
    page = offline(laser.to_html(tmp_path / "laser.html", note="the wall"), viewport={"width": 900, "height": 900})
    laser.close()
    expect(page.locator(".rw-laser .rw-nearest")).to_contain_text("nearest 3.00 m")
    expect(page.locator(".rw-laser .rw-popup:visible .rw-popup-expression")).to_have_text("ranges[1]")
    page.locator(".rw-player .rw-slider").focus()
    page.keyboard.press(",")
    expect(page.locator(".rw-laser .rw-nearest")).to_contain_text("nearest 2.00 m")
    page.keyboard.press(",")
    expect(page.locator(".rw-laser .rw-nearest")).to_contain_text("nearest 1.00 m")
    shoot(page.locator("body"), "to-html-widget")


def test_a_browser_that_cannot_unpack_says_so_over_the_first_samples(offline: Callable[..., Page], file: Path) -> None:
    page = offline(file, before="delete window.DecompressionStream")
    text = page.locator(".rw-page-text")
    expect(text).to_be_visible()
    expect(text).to_contain_text("This browser cannot unpack this page: it has no DecompressionStream")
    expect(text).to_contain_text("10.300 s  /scan")
    page = offline(file, java_script_enabled=False)
    expect(page.locator(".rw-page-text")).to_contain_text("This page has not started")


@pytest.mark.skipif(firefox.found() is None, reason="Firefox is not installed: apt-get install firefox-esr")
def test_a_page_plays_in_firefox(file: Path, tmp_path: Path) -> None:
    with firefox.running(tmp_path) as browser:
        browser.open(file)
        nearest = 'document.querySelector(".rw-laser .rw-nearest")?.textContent'
        browser.wait(f"return {nearest}")
        browser.wait('return document.querySelector(".rw-scanogram")?.textContent.includes("97 scans")')
        assert browser.run('return document.querySelector("h1").textContent') == HOSTILE
        assert browser.run("return document.images.length") == 0
        browser.run('document.querySelector(".rw-play-speed").value = "10"')
        browser.run('document.querySelector(".rw-play-speed").dispatchEvent(new Event("change"))')
        browser.run('document.querySelector(".rw-play").click()')
        browser.wait('return document.querySelector(".rw-play-now").textContent === "20.00"')
        with robowidgets.open(SAMPLE) as recording:
            moment = recording.at("/scan", 20.0 - 1e-6)
        assert moment
        near = moment.sample.nearest()
        # The laser draws its last scan in the frame after the clock's.
        text = browser.wait(f'return {nearest}.includes("[{near.index}]") && {nearest}')
        assert f"nearest {near.range:.2f} m" in text
        # Files that the page has loaded in addition to itself.
        assert browser.run("return performance.getEntriesByType('resource').map((entry) => entry.name)") == []
        if PICTURES:
            browser.shoot(SCREENSHOTS / "to-html-firefox.png")


def test_a_page_plays_messages_of_any_type_which_unfold_there(offline: Callable[..., Page], tmp_path: Path) -> None:
    said = [(0.5 * i, "/wrench", {"force": {"x": 0.5 * i}}) for i in range(8)]
    folder = recorded.write(tmp_path / "drive", {"/wrench": "geometry_msgs/msg/Wrench"}, said)
    with robowidgets.open(folder) as recording:
        page = offline(recording.to_html(tmp_path / "wrench.html", topics=["/wrench as message"]))
    card = page.locator(".rw-message")
    force = card.locator('[data-rw-row="force.x"] .rw-message-value')
    expect(force).to_have_text("0")
    page.get_by_role("button", name="One scan on (.)").first.click()
    expect(force).to_have_text("0.5")
    card.locator('[data-rw-row="force"]').click()
    expect(force).to_have_count(0)


class OfEachType:
    """A recording with the first messages of a topic of each type that the real recordings have."""

    problems: tuple[str, ...] = ()
    start_ns, end_ns = recorded.START_NS, recorded.START_NS + 10**9

    def __init__(self, sent: Sequence[Sent]) -> None:
        self._raw = {number: one.raw for number, one in enumerate(sent)}
        self.channels = tuple(
            one.channel._replace(id=number, topic=one.topic, count=len(one.raw)) for number, one in enumerate(sent)
        )

    def messages(self, channels: Collection[Channel], *_: Any) -> Iterator[Message]:
        for number, time_ns in enumerate((self.start_ns, self.end_ns)):
            for channel in channels:
                if number < channel.count:
                    yield channel, time_ns, self._raw[channel.id][number]

    def span_ns(self, _channel: Channel) -> None:
        return None

    def close(self) -> None:
        pass


def test_a_page_of_every_type_there_is_shows_the_values(
    offline: Callable[..., Page], tmp_path: Path, data: Path
) -> None:
    sent = by_type(first_messages(data, 2))
    path = tmp_path / "all.mcap"
    write(OfEachType(sent), path)
    fitting, compared = set(), 0
    for part in range(0, len(sent), MANY):
        those = sent[part : part + MANY]
        names = [one.topic for one in those]
        with robowidgets.open(path) as recording:
            player = recording.show(*names, *(f"{name} as message" for name in names))
            page = offline(player.to_html(tmp_path / f"{part}.html", scanogram=False))
            fitting |= {view.choice.shown.name for view in player.views}
            player.close()
        page.wait_for_function(ALL_READ, arg=names, timeout=150_000)
        trees = page.evaluate(READ_TREES)
        compared += sum(shows_the_number(one, row, text) for one in those for row, text in trees[one.topic].items())
        page.close()
    assert fitting >= {"laser", "speed", "path", "events", "sonar", "touch", "message"}
    assert compared > 300


def shows_the_number(one: Sent, row: str, text: str) -> bool:
    """Return True if a row of a tree has a number; fail unless it is the number in the first message."""
    if " " in row:  # roll, pitch and yaw, which are computed
        return False
    value = value_at(one.messages[0], row)
    number = NUMBER.match(text.replace("\N{MINUS SIGN}", "-"))
    if not number or isinstance(value, bool) or not isinstance(value, (int, float)) or not np.isfinite(value):
        return False
    assert float(number[0].replace(",", "")) == pytest.approx(value, rel=0.01, abs=0.006), (one.topic, row, text)
    return True


def test_a_print_has_all_pictures_on_white_without_buttons_and_leaves_the_screen_as_it_was(
    offline: Callable[..., Page], file: Path
) -> None:
    page = offline(file, viewport={"width": 1280, "height": 800})
    expect(page.locator(".rw-tile").first).to_be_visible()
    page.evaluate("""() => {
        window.printed = [];
        addEventListener("beforeprint", () => printed.push(
            [...document.querySelectorAll("canvas.rw-layer")].map((canvas) => canvas.width / canvas.clientWidth)));
    }""")
    document = page.pdf(format="A4")
    assert min(page.evaluate("() => printed[0]")) >= 2.9, "sharp enough for paper"
    # A canvas printed call by call clears those below: each is a picture of pixels.
    pixels = [int(width) for width in re.findall(rb"/Subtype /Image\s+/Width (\d+)", document)]
    assert sum(width > 1000 for width in pixels) >= 5, pixels
    assert not page.locator("html.rw-printing").count()
    page.emulate_media(media="print", color_scheme="dark")
    expect(page.locator("html.rw-printing")).to_be_attached()
    expect(page.locator(".rw-laser")).to_have_attribute("data-rw-theme", "light")
    for button in page.locator(".rw-card button:not(.rw-tile, .rw-class), .rw-page-data").all():
        expect(button).to_be_hidden()
    assert page.locator(".rw-card").evaluate_all(
        "(cards) => cards.every((card) => getComputedStyle(card).breakInside === 'avoid')"
    )
    shoot(page.locator("body"), "page-printed")
    page.emulate_media(media="screen", color_scheme="light")
    expect(page.locator("html.rw-printing")).to_have_count(0)
    expect(page.locator(".rw-freeze").first).to_be_visible()
    page.set_viewport_size({"width": 700, "height": 800})
    expect(page.locator(".rw-drag-hint")).to_be_visible()
    page.emulate_media(media="print")
    expect(page.locator(".rw-drag-hint")).to_be_hidden()
