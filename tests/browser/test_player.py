"""A recording in the notebook: its table, and its widgets with a player that moves all of them."""

from __future__ import annotations

import json
import re
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from shutil import copy
from typing import Any

import pytest
from playwright.sync_api import Locator, Position, expect

import robowidgets
from robowidgets.scanogram import overview as _overview
from robowidgets.screens import _prefetcher

from ..unit.recordings import corridor, robot, sweeps
from ..unit.waiting import wait_for
from .chromium import shoot
from .notebook import CellError, Notebook
from .plain_page import PlainPage

TABLE = "import robowidgets\nrecording = robowidgets.open({path!r})\nrecording"
SHOW = "player = recording.show()\nplayer"
BUSY = "while True:\n    pass"

Open = Callable[..., Any]


SECONDS = """root => {
    const parts = root.querySelector('.rw-play-now').textContent.split(':');
    return parts.reduce((sum, part) => 60 * sum + Number(part), 0);
}"""
"""The times on the bar, in seconds."""


def opened(notebook: Open, path: Path, show: str = SHOW, **more: object) -> Any:
    return notebook([TABLE.format(path=str(path)), show], **more)


def bar(nb: Notebook | PlainPage) -> Locator:
    return nb.output(1).locator(".rw-player")


def now(nb: Notebook | PlainPage) -> float:
    """Return the seconds on the bar of a player once it is drawn; do not call it while it plays."""
    nb.drawn()
    return float(bar(nb).evaluate(f"bar => ({SECONDS})(bar)"))


def to_time(nb: Notebook | PlainPage, seconds: float) -> None:
    """Drag the slider, with all the events that a page receives."""
    slider = bar(nb).locator("input[type=range]")
    slider.evaluate("(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }", seconds)


def passes(nb: Notebook | PlainPage, seconds: float) -> None:
    nb.page.wait_for_function(f"time => ({SECONDS})(document) > time", arg=seconds)


def test_the_slider_and_python_move_every_widget(plain_page: Open, data: Path) -> None:
    nb = opened(plain_page, data / "good" / "neato_fsm")
    expect(nb.output(1).locator(".rw-picture")).to_have_count(6)
    # The page now gets what it lacks.
    nb.python("player.time = next(m.seconds for m in recording.samples('/bump') if any(m.sample.touched.values()))")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("21.96")
    tile = nb.output(1).locator(".rw-tile", has_text="left front")
    expect(tile).to_contain_text("touched")
    for seconds, word in ((20, "free"), (22.5, "touched")):
        to_time(nb, seconds)
        expect(tile).to_contain_text(word)
    expect(bar(nb).locator(".rw-play-now")).to_have_text("22.50")
    told = "print(player.time, player.views[-2].widget.states['left front'].name)"
    wait_for(lambda: nb.python(told).strip() == "22.5 TOUCHED", "Python knew")


HOLD_FRAMES = """() => {
    const frame = requestAnimationFrame;
    const held = [];
    window.requestAnimationFrame = (draw) => held.push(draw);
    window.letGo = () => {
        window.requestAnimationFrame = frame;
        for (const draw of held) frame(draw);
    };
}"""
"""Animation frames come late, as on a page with much to draw."""


def test_a_click_on_the_slider_counts_also_before_the_bar_is_drawn(plain_page: Open) -> None:
    nb = plain_page([TABLE.format(path=str(robowidgets.SAMPLE))])
    nb.page.evaluate(HOLD_FRAMES)
    shown = nb.append("player = recording.show('/scan', scanogram=False)\nplayer")
    nb.run(shown)
    player = nb.output(shown).locator(".rw-player")
    slider = player.locator("input[type=range]")
    slider.wait_for()
    assert player.locator(".rw-play-now").inner_text() == ""
    box = slider.bounding_box() or {}
    nb.page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    nb.page.evaluate("letGo()")
    expect(player.locator(".rw-play-now")).to_have_text(re.compile(r"^29\.0\d$"))


def test_keys_step_from_scan_to_scan_and_go_from_mark_to_mark(plain_page: Open, data: Path) -> None:
    nb = opened(
        plain_page, data / "good" / "tilt_laser.bag", "player = recording.show()\nplayer.marks = [(5, 6, 'x')]\nplayer"
    )
    bar(nb).locator("input").focus()
    first = now(nb)
    scans = [
        float(line) for line in nb.python("for m in list(recording.samples('/scan'))[:4]: print(m.seconds)").split()
    ]
    start = scans.index(next(s for s in scans if abs(s - first) < 0.006))
    nb.page.keyboard.press(".")
    expect(bar(nb).locator(".rw-play-now")).to_have_text(f"{scans[start + 1]:.2f}")
    nb.page.keyboard.press(".")
    expect(bar(nb).locator(".rw-play-now")).to_have_text(f"{scans[start + 2]:.2f}")
    nb.page.keyboard.press(",")
    expect(bar(nb).locator(".rw-play-now")).to_have_text(f"{scans[start + 1]:.2f}")
    nb.page.keyboard.press("n")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("5.00")
    nb.page.keyboard.press("ArrowRight")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("6.00")
    nb.output(1).locator(".rw-scanogram .rw-picture").focus()
    nb.page.keyboard.press("p")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("5.00")


@pytest.mark.core
def test_its_keys_work_on_every_widget_that_has_no_use_for_them(plain_page: Open, tmp_path: Path) -> None:
    nb = opened(plain_page, robot.write(tmp_path / "drive"))
    shown, press = nb.output(1), nb.page.keyboard.press
    time, play, loop = (bar(nb).locator(one) for one in (".rw-play-now", ".rw-play", ".rw-loop"))
    pictures = [shown.locator(f".rw-{kind} .rw-picture") for kind in ("scanogram", "laser", "speed", "touch")]
    for number, picture in enumerate(pictures):
        picture.click(position={"x": 150, "y": 20})
        to_time(nb, 4.95)
        expect(time).to_have_text("4.95")
        for key, at in ((".", "5.00"), (".", "5.10"), (",", "5.00")):
            press(key)
            expect(time).to_have_text(at)
        press("l")
        expect(loop).to_have_attribute("aria-pressed", "false" if number % 2 else "true")
    for key, at in (("ArrowRight", "6.00"), ("Shift+ArrowRight", "10.00"), ("Home", "0.00"), ("ArrowDown", "0.00")):
        press(key)
        expect(time).to_have_text(at)
    pictures[0].focus()
    for title in ("Stop here (space)", "Play (space)"):
        press(" ")
        expect(play).to_have_attribute("title", title)


def test_a_widget_keeps_the_keys_that_it_uses_itself(plain_page: Open, tmp_path: Path) -> None:
    nb = opened(plain_page, robot.write(tmp_path / "drive"))
    press, time, play = nb.page.keyboard.press, bar(nb).locator(".rw-play-now"), bar(nb).locator(".rw-play")
    nb.python("player.time = 3\nlaser = player.views[0].widget\nlaser.history = 60")
    expect(time).to_have_text("3.00")
    laser = nb.output(1).locator(".rw-laser")
    laser.locator(".rw-picture").focus()
    for key in ("ArrowRight", "Home", "+"):
        press(key)
    expect(laser.locator(".rw-popup-expression >> nth=0")).to_have_text("ranges[0]")
    for key, at in ((".", "3.10"), (".", "3.20")):
        press(key)
        expect(time).to_have_text(at)
    press(" ")
    freeze, kept = laser.locator(".rw-freeze"), laser.locator(".rw-steps b")
    expect(freeze).to_have_attribute("aria-pressed", "true")
    expect(kept).to_have_text("newest")
    press(",")
    expect(kept).not_to_have_text("newest")
    freeze.focus()
    press(" ")
    expect(freeze).to_have_attribute("aria-pressed", "false")
    expect(time).to_have_text("3.20")
    nb.output(1).locator(".rw-scanogram .rw-picture").focus()
    for key, at in (("ArrowRight", "3.30"), ("Home", "0.00"), ("+", "0.00")):
        press(key)
        expect(time).to_have_text(at)
    expect(bar(nb).locator("select")).to_have_value("1")
    bar(nb).locator("select").focus()
    press(".")
    expect(time).to_have_text("0.00")
    expect(play).to_have_attribute("title", "Play (space)")


def test_the_date_and_time_of_day_stand_next_to_the_seconds_if_there_is_room(
    plain_page: Open, data: Path, tmp_path: Path
) -> None:
    nb = opened(plain_page, robot.write(tmp_path / "night", silence=7200))
    clock, moment = (bar(nb).locator(one) for one in (".rw-play-clock", ".rw-play-time"))
    nb.python("player.seek(recording.seconds_at('2023-11-15T00:13:24.900'))")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("2:00:04.90")
    for width, told in ((1000, "2023-11-15 00:13:24 UTC"), (700, "00:13:24 UTC"), (500, "00:13:24 UTC"), (300, "")):
        nb.resize(width)
        expect(clock).to_be_visible(visible=told != "")
        if told:
            expect(clock).to_have_text(told, use_inner_text=True)
        expect(moment).to_have_attribute("title", "7204.90 s\n2023-11-15 00:13:24 UTC")
        assert bar(nb).evaluate("bar => bar.scrollWidth <= bar.clientWidth")
        for theme in ("light", "dark"):
            nb.theme(theme)
            shoot(bar(nb), f"player-clock-{theme}-{width}")
    nb.resize(1000)
    places = []
    for seconds, told in ((0, "0:00:00.00"), (9.99, "0:00:09.99"), (3599.5, "0:59:59.50"), (6399.8, "1:46:39.80")):
        nb.python(f"player.time = {seconds}")
        expect(bar(nb).locator(".rw-play-now")).to_have_text(told)
        places.append(bar(nb).locator(".rw-play-line").bounding_box())
    assert all(place == places[0] for place in places), places
    nb = opened(plain_page, data / "good" / "turtlebot3_gazebo.bag")
    expect(bar(nb).locator(".rw-play-duration")).to_have_text(" / 1:31.34")
    expect(bar(nb).locator(".rw-play-clock")).to_be_hidden()


def test_a_scanogram_that_is_left_out_is_reported_under_the_bar(
    plain_page: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_overview, "FEW", 10)
    monkeypatch.setattr(_overview, "readings_per_second", lambda *_: 5.0)
    nb = opened(plain_page, robot.write(tmp_path / "drive"))
    note = bar(nb).locator(".rw-play-note")
    words = "no scanogram: 100 scans of 1 ray take about 20 s; recording.show(scanogram=True) makes it"
    expect(note).to_have_text(words)
    expect(nb.output(1).locator(".rw-scanogram")).to_have_count(0)
    for width in (1000, 300):
        nb.resize(width)
        shoot(bar(nb), f"player-note-{width}")
        assert note.evaluate("note => note.scrollWidth <= note.clientWidth")


def test_a_command_alone_is_not_shown_as_measured(plain_page: Open, tmp_path: Path) -> None:
    show = "player = recording.show('/scan', '/cmd_vel')\nplayer.time = 7\nplayer"
    nb = opened(plain_page, robot.write(tmp_path / "drive"), show, width=800)
    speed = nb.output(1).locator(".rw-speed")
    expect(speed.locator(".rw-facts")).to_have_text("commanded")
    expect(speed.locator("[data-axis='0'] .rw-value")).to_have_text("0.70")
    expect(speed.locator(".rw-key-item:visible")).to_have_text(["commanded"])
    expect(speed).not_to_contain_text("measured")
    shoot(speed, "player-command-alone")
    nb.theme("dark")
    nb.python("player.views[1].widget.linear_limits = 0.5")
    expect(speed.locator(".rw-summary")).to_have_text("x over the limit of 0.5")
    shoot(speed, "player-command-alone-over")


def test_before_the_first_scan_one_sentence_says_so(plain_page: Open, data: Path) -> None:
    show = "player = recording.show('/test/sensor_msgs/laser_scan', '/test/std_msgs/bool')\nplayer.time = 0\nplayer"
    nb = opened(plain_page, data / "odd" / "every_ros2_type_mcap", show)
    laser = nb.output(1).locator(".rw-laser")
    expect(laser.locator(".rw-empty")).to_have_text("no scan up to this time of the recording")
    expect(laser.locator(".rw-range")).to_have_text("10 m")
    expect(laser.locator(".rw-notice")).to_be_hidden()
    shoot(laser, "player-before-the-first-scan")


def test_a_step_crosses_hours_of_silence_in_which_the_view_is_marked_as_old(plain_page: Open, tmp_path: Path) -> None:
    nb = opened(plain_page, robot.write(tmp_path / "night", silence=7200))
    said = nb.output(1).locator(".rw-laser .rw-silence")
    bar(nb).locator("input").focus()
    nb.python("player.time = 4.9")
    expect(said).to_have_text("")
    for key, time, told in (
        (".", "2:00:05.00", ""),
        (",", "0:00:04.90", ""),
        ("ArrowRight", "0:00:05.90", ""),
        ("Shift+ArrowRight", "0:00:15.90", "no data for 11.0 s"),
        (",", "0:00:04.90", ""),
    ):
        nb.page.keyboard.press(key)
        expect(bar(nb).locator(".rw-play-now")).to_have_text(time)
        expect(said).to_have_text(told)
    to_time(nb, 7204)
    expect(nb.output(1).locator(".rw-speed .rw-silence")).to_have_text("no data for 1 h")
    shoot(nb.output(1), "player-silence")


def test_where_pointer_or_finger_rests_a_click_shows_at_once_also_while_a_cell_runs(
    plain_page: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_prefetcher, "KEPT_BYTES", 100_000)
    path = sweeps.write(tmp_path / "long", sweeps.numbered(3000, rays=100))
    nb = opened(plain_page, path)
    # Not in one cell that waits: the kernel must receive the page's requests for them.
    wait_for(lambda: nb.python("sum(player._prefetcher._sent.values()) >= 90_000") == "True", "segments were sent", 120)
    asked, has = "print(player._prefetcher._pointed)", "print(sorted(player._prefetcher._sent))"

    def fetches(act: Callable[[], object]) -> None:
        before, there = nb.python(asked), json.loads(nb.python(has))
        act()
        wait_for(lambda: nb.python(asked) != before, "Python was asked")
        index = json.loads(nb.python(asked))[0]
        assert index not in there
        wait_for(lambda: index in json.loads(nb.python(has)), "it came")

    picture = nb.output(1).locator(".rw-scanogram .rw-picture")
    picture.scroll_into_view_if_needed()
    box = picture.bounding_box() or {}
    touch = nb.page.context.new_cdp_session(nb.page)
    finger = {"type": "touchStart", "touchPoints": [{"x": box["x"] + 600, "y": box["y"] + 50}]}
    fetches(lambda: touch.send("Input.dispatchTouchEvent", finger))
    touch.send("Input.dispatchTouchEvent", {"type": "touchCancel", "touchPoints": []})
    fetches(lambda: bar(nb).locator("input").hover(position={"x": 400, "y": 10}))
    fetches(lambda: picture.hover(position={"x": 550, "y": 10}))
    with nb.busy():
        picture.click(position={"x": 550, "y": 10})
        passes(nb, 100.0)
        expect(nb.output(1).locator(".rw-laser .rw-footer")).to_contain_text(f"{1 + int(now(nb) * 10) / 100:.2f} m")
        expect(bar(nb).locator(".rw-play-words")).to_be_empty()


def test_a_span_gets_a_name_by_keys_or_by_a_click_and_loses_it_and_a_busy_kernel_is_reported(
    plain_page: Open, tmp_path: Path
) -> None:
    path = robot.write(tmp_path / "drive")
    nb = opened(plain_page, path, width=1280, height=720)
    player, press = bar(nb), nb.page.keyboard.press
    lane, words, field = (player.locator(one) for one in (".rw-play-label", ".rw-play-words", ".rw-naming > input"))
    # Its begin and its end.
    nb.python("player.time = 3")
    expect(player.locator(".rw-play-now")).to_have_text("3.00")
    player.locator(".rw-play").focus()
    press("a")
    expect(words).to_contain_text("from 3.00 s on")
    press("ArrowRight")
    shoot(player, "player_label_begun")
    press("a")
    expect(player.locator(".rw-naming-about")).to_have_text("3.00 to 4.00 s")
    nb.page.keyboard.type("<b>door</b>")
    shoot(player, "player_label_name")
    press("Enter")
    expect(lane).to_have_text(["<b>door</b>"])
    expect(player.locator(".rw-play")).to_be_focused()
    assert nb.python("[one[:3] for one in recording.labels]").strip() == "[('<b>door</b>', 3.0, 4.0)]"
    # Click the selected span while a cell runs: the page shows it as pending until it is kept.
    nb.python("player.selection = (5, 9)")
    with nb.busy():
        player.get_by_title("Give a name to the selected span").click()
        field.fill("corridor")
        player.get_by_role("button", name="Keep").click()
        expect(words).to_contain_text("\u201ccorridor\u201d is kept when the running cell ends")
        expect(player.locator(".rw-coming")).to_have_text("corridor")
        shoot(player, "player_label_busy")
    expect(player.locator(".rw-coming")).to_have_count(0)
    expect(lane).to_have_text(["corridor", "<b>door</b>"])
    # They are among the marks; a click goes to the mark, renames it, or removes it.
    player.locator(".rw-play-mark-words").click()
    expect(player.locator(".rw-play-row", has_text="\u201ccorridor\u201d")).to_have_count(1)
    player.locator(".rw-play-mark-words").click()
    lane.first.click()
    expect(player.locator(".rw-play-now")).to_have_text("5.00")
    field.fill("long corridor")
    press("Enter")
    expect(lane).to_have_text(["long corridor", "<b>door</b>"])
    expect(player.locator(".rw-coming")).to_have_count(0)
    lane.last.focus()
    press("Delete")
    expect(lane).to_have_text(["long corridor"])
    wait_for(
        lambda: nb.python("len(recording.labels), player.selection") == "(1, (3.0, 4.0))", "the kernel has removed it"
    )
    player.locator(".rw-play").focus()
    press("Control+z")
    expect(lane).to_have_text(["long corridor", "<b>door</b>"])
    press("Control+z")
    expect(lane).to_have_text(["corridor", "<b>door</b>"])
    expect(player.locator(".rw-coming")).to_have_count(0)
    lane.first.click()
    field.fill("long corridor")
    press("Enter")
    expect(player.locator(".rw-coming")).to_have_count(0)
    lane.last.focus()
    press("Delete")
    expect(lane).to_have_text(["long corridor"])
    # Its span is selected: naming it again removes the name.
    player.locator(".rw-play").focus()
    press("a")
    expect(player.locator(".rw-naming-about")).to_have_text("3.00 to 4.00 s")
    press("Escape")
    lane.first.click()
    player.get_by_role("button", name="Remove").click()
    expect(lane).to_have_count(0)
    wait_for(lambda: nb.python("len(recording.labels)") == "0", "the kernel has removed it")
    # A name that cannot be kept appears in the row again, with the reason.
    nb.python(
        "import pathlib; p = recording.path.parent / 'labels.jsonl'; p.unlink(); p.mkdir(); player.selection = (1, 2)"
    )
    player.locator(".rw-play").focus()
    press("a")
    field.fill("door")
    press("Enter")
    expect(player.locator(".rw-naming-about")).to_contain_text("the label cannot be saved")
    expect(field).to_have_value("door")


def test_content_of_another_moment_is_pale_until_its_data_come(
    plain_page: Open, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_prefetcher, "KEPT_BYTES", 100_000)
    nb = opened(plain_page, sweeps.write(tmp_path / "long", sweeps.numbered(3000, rays=100)))
    laser, slider = nb.output(1).locator(".rw-laser"), bar(nb).locator("input[type=range]")
    nearest, picture = laser.locator(".rw-nearest"), nb.output(1).locator(".rw-scanogram .rw-picture")
    waits, ready = re.compile(r"\brw-waits\b"), re.compile(r"^(?!.*\brw-waits\b)")
    expect(nearest).to_contain_text("1.00 m")
    expect(laser).to_have_class(ready)
    with nb.busy():
        to_time(nb, 250.5)
        expect(bar(nb).locator(".rw-play-now")).to_have_text("4:10.50")
        expect(laser).to_have_class(waits)
        expect(nearest).to_contain_text("1.00 m")
        expect(bar(nb).locator(".rw-play-words")).to_have_text("waiting for the kernel")
        for theme in ("light", "dark"):
            nb.theme(theme)
            shoot(nb.output(1), f"player-waits-{theme}")
        # Back to a time that the page has, and by pointer to one that it lacks, which the knob follows.
        to_time(nb, 0)
        expect(laser).to_have_class(ready)
        picture.hover(position={"x": 450, "y": 40})
        expect(laser).to_have_class(waits)
        pointed = now(nb)
        assert pointed > 100
        assert float(slider.input_value()) == pytest.approx(pointed, abs=0.01)
        nb.page.mouse.move(5, 5)
        expect(laser).to_have_class(ready)
        expect(slider).to_have_value("0")
        to_time(nb, 250.5)
        expect(laser).to_have_class(waits)
    expect(nearest).to_contain_text("26.05 m")
    expect(laser).to_have_class(ready)


BOXES = """() => [...document.querySelectorAll(
    ".rw-recording, .rw-recording .rw-card:not(.rw-topics)")].map(element => {
    const { x, y, width, height } = element.getBoundingClientRect();
    const [, kind] = element.className.match(/rw-(recording|player|scanogram|laser|speed|touch|path)(?!-)/);
    return [kind, [x, y, width, height]];
})"""
ENDS = """elements => elements.map(element => {
    const range = document.createRange();
    range.selectNodeContents(element);
    const { left, right } = range.getBoundingClientRect();
    return [left, right];
})"""
"""Left and right of the texts of elements."""


def boxes(nb: Notebook | PlainPage) -> dict[str, list[float]]:
    """Left, top, width and height of the recording and of its cards."""
    nb.drawn()
    found: dict[str, list[float]] = dict(nb.page.evaluate(BOXES))
    return found


MARKED = (
    "player = recording.show()\nplayer.selection = (20, 25)\n"
    "player.marks = [(21.96, 22.4, 'bump'), (28, 29, 'late')]\nplayer.time = 22\nplayer"
)


def test_all_of_a_recording_stands_on_one_screen(plain_page: Open) -> None:
    nb = opened(plain_page, Path(robowidgets.SAMPLE), MARKED, height=720)
    touch = nb.output(1).locator(".rw-touch")
    for width, small in ((1112, 172), (1300, 172), (900, 240)):
        nb.resize(width, 720)
        at = boxes(nb)
        assert at["recording"][2] == width
        assert at["recording"][3] == 562
        assert at["player"][3] == 62
        left, right = at["scanogram"], at["laser"]
        assert left[2] / right[2] == pytest.approx(62 / 38, abs=0.01)
        assert left[1] == right[1]
        assert right[1] + right[3] == at["recording"][1] + 562
        assert right[2] > 330
        for name in ("speed", "touch", "path"):
            assert at[name][3] == small, "the small ones stand in one row"
            assert at[name][1] + at[name][3] == right[1] + right[3]
        expect(touch.locator(".rw-tile")).to_have_count(3)
        assert touch.locator(".rw-picture").evaluate("picture => picture.scrollHeight <= picture.clientHeight")
        numbers = nb.output(1).locator(".rw-speed [data-axis] .rw-value").evaluate_all(ENDS)
        assert len(numbers) == 3
        assert all(end + 4 < start for (_, end), (start, _) in pairwise(numbers)), "the numbers do not run together"
        for card in nb.output(1).locator(".rw-card").all():
            assert card.evaluate("card => card.scrollWidth <= card.clientWidth + 1")
        shoot(nb.output(1), f"recording-show-light-{width}")
    nb.resize(1500, 900)
    at = boxes(nb)
    assert at["recording"][3] == 742, "on a high window all of it is higher"
    assert at["path"][3] == 240
    assert at["path"][1] + at["path"][3] == at["laser"][1] + at["laser"][3] == at["recording"][1] + 742
    shoot(nb.output(1), "recording-show-light-high")
    for width in (848, 1200):
        nb.resize(width, 900)
        at = boxes(nb)
        assert at["recording"][3] == 742
        row = at["laser"][1] + at["laser"][3]
        assert row == at["scanogram"][1] + at["scanogram"][3], "the rays are as high as the scanogram"
        for name in ("speed", "touch", "path"):
            assert at[name][1] == row + 4
            assert at[name][1] + at[name][3] == at["recording"][1] + 742
        assert at["path"][0] + at["path"][2] == at["laser"][0] + at["laser"][2], "the small ones stand below both"
        shoot(nb.output(1), f"recording-show-light-high-{width}")
    nb.resize(400, 720)
    at = boxes(nb)
    tops = [at[name][1] for name in ("player", "laser", "scanogram", "speed", "touch")]
    assert tops == sorted(tops), "below 800 px the rays stand under the bar"
    assert all(width <= 400 for _, _, width, _ in at.values())
    shoot(nb.output(1), "recording-show-light-400")
    nb.theme("dark")
    for width in (400, 1143):
        nb.resize(width, 720)
        shoot(nb.output(1), f"recording-show-dark-{width}")
    words, walk = nb.output(1).locator(".rw-play-mark-words"), nb.output(1).locator(".rw-play-walk button")
    expect(words).to_contain_text("mark 1 of 2: bump")
    walk.last.click()
    expect(words).to_contain_text("mark 2 of 2: late")
    for mark in nb.output(1).locator(".rw-play-mark").all():
        assert (mark.bounding_box() or {"width": 0})["width"] >= 3
    nb.page.emulate_media(forced_colors="active")
    nb.resize(1143, 720)
    shoot(nb.output(1), "recording-show-forced-1143")


def test_two_scanners_and_four_sensors_stand_whole_on_one_screen(plain_page: Open, data: Path) -> None:
    nb = opened(plain_page, data / "good" / "neato_fsm", "(player := recording.show())", height=720)
    card, scans = nb.output(1).locator(".rw-touch"), nb.output(1).locator(".rw-laser")
    for width in (1112, 900):
        nb.resize(width, 720)
        at = boxes(nb)
        assert at["recording"][3] == 562
        assert at["touch"][3] == at["path"][3] == 240
        assert card.locator(".rw-picture").evaluate("picture => picture.scrollHeight <= picture.clientHeight")
        assert card.locator(".rw-tile").evaluate_all(
            "tiles => tiles.every((tile) => tile.scrollWidth <= tile.clientWidth)"
        )
        footer = card.locator(".rw-footer")
        assert footer.evaluate("footer => footer.scrollWidth <= footer.clientWidth")
        expect(footer.locator(".rw-state:not([hidden])")).to_have_text(["0touched", "4free"])
        for scan in scans.all():
            assert (scan.locator(".rw-picture").bounding_box() or {"height": 0})["height"] > 200
        shoot(nb.output(1), f"recording-four-sensors-{width}")
    nb.python("for view in player.views:\n    if view.widget.sample_name == 'scan': laser = view.widget")
    nb.python("laser.index_view = True; laser.selection = 'front'")
    expect(scans.locator(".rw-strip")).to_have_count(1)
    expect(scans.locator(".rw-chip")).to_be_visible()
    expect(scans.locator(".rw-picture .rw-chip")).to_have_count(0)  # below a picture of small height
    for picture in scans.locator(".rw-picture").all():
        assert (picture.bounding_box() or {"height": 0})["height"] >= 200
    nb.resize(400, 720)
    expect(scans.locator(".rw-footer:visible")).to_have_count(2)


@pytest.mark.core
def test_a_first_look_is_there_though_the_kernel_is_busy_at_once(notebook: Open) -> None:
    show = f"player = recording.show()\ndisplay(player)\n{BUSY}"
    nb = opened(notebook, Path(robowidgets.SAMPLE), show, run=False)
    nb.run(0)
    nb.start(1)
    # A kernel's first recording takes seconds to open.
    expect(nb.output(1).locator(".rw-laser .rw-nearest")).to_contain_text("nearest")
    bar(nb).get_by_title("Play (space)").click()
    passes(nb, 6.0)
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(1)


NOTE_TIMES = """() => {
    const now = document.querySelector('.rw-play-now');
    window.noted = [];
    const note = () => window.noted.push(Number(now.textContent));
    new MutationObserver(note).observe(now, {childList: true, characterData: true, subtree: true});
}"""


def test_a_second_page_takes_no_step_back_and_after_a_lost_connection_all_shows_what_is_pointed_at(
    notebook: Open, tmp_path: Path
) -> None:
    nb = opened(notebook, Path(copy(robowidgets.SAMPLE, tmp_path)), "(player := recording.show('/scan', '/odom'))")
    nb.save()
    page = nb.page.context.new_page()
    second = Notebook(page, nb.lab, nb.path, nb.console)
    second.open()
    expect(bar(second).locator(".rw-play-now")).to_have_text("0.00")
    nb.page.bring_to_front()
    picture = nb.output(1).locator(".rw-scanogram .rw-picture")
    picture.focus()
    nb.page.evaluate(NOTE_TIMES)
    for _ in range(40):
        picture.press("ArrowRight")
    expect(bar(second).locator(".rw-play-now")).to_have_text("4.00")
    expect(bar(nb).locator(".rw-play-now")).to_have_text("4.00")
    wait_for(lambda: nb.python("print(player.time)").strip() == "4.0", "Python knew")
    noted = nb.page.evaluate("noted")
    assert noted == sorted(noted)
    page.close()
    facts, laser = nb.output(1).locator(".rw-path .rw-footer"), nb.output(1).locator(".rw-laser")
    expect(facts).to_contain_text("4.0 s")
    picture.hover(position=Position(x=90, y=60))
    expect(facts).not_to_contain_text("4.0 s")
    expect(laser).to_contain_text("ranges[")
    pointed, ray = facts.inner_text(), laser.inner_text()
    nb.reconnect()
    expect(facts).to_have_text(pointed, use_inner_text=True)
    expect(laser).to_have_text(ray, use_inner_text=True)


def test_a_follower_stays_where_it_was_moved_when_the_page_is_reloaded(notebook: Open, tmp_path: Path) -> None:
    one, other = (Path(copy(robowidgets.SAMPLE, tmp_path / name)) for name in ("one.mcap", "other.mcap"))
    follow = f"other = robowidgets.open({str(other)!r}).show('/scan', scanogram=False)\nother.follow(player)\nother"
    show = "(player := recording.show('/scan', scanogram=False))"
    nb = notebook([TABLE.format(path=str(one)), show, follow])
    to_time(nb, 20.0)
    expect(nb.output(2).locator(".rw-play-now")).to_have_text("20.00")
    wait_for(lambda: nb.python("print(player.time, other.time)").strip() == "20.0 20.0", "Python knew")
    nb.output(2).locator(".rw-player").press(".")
    expect(nb.output(2).locator(".rw-play-now")).to_have_text("20.10")
    wait_for(lambda: nb.python("print(player.time, other.time)").strip() == "20.0 20.1", "Python knew")
    nb.reload()
    expect(nb.output(1).locator(".rw-play-now")).to_have_text("20.00")
    expect(nb.output(2).locator(".rw-play-now")).to_have_text("20.10")
    to_time(nb, 30.0)
    expect(nb.output(2).locator(".rw-play-now")).to_have_text("30.00")


def test_while_a_cell_runs_it_plays_steps_points_seeks_and_keeps_a_name(notebook: Open, tmp_path: Path) -> None:
    nb = opened(notebook, Path(copy(robowidgets.SAMPLE, tmp_path)), width=1280, height=720)
    wait_for(lambda: nb.python("len(player._prefetcher._sent) == 59") == "True", "all segments were sent", 120)
    to_time(nb, 29.0)
    # JupyterLab sends nothing more for a model that was waiting for a message when the connection was lost.
    wait_for(lambda: nb.python("print(player.time)").strip() == "29.0", "Python knew")
    nb.reconnect()
    assert now(nb) == 29.0, "it stays where it is when the connection was lost"
    to_time(nb, 0.0)
    busy = nb.append(BUSY)
    nb.start(busy)
    shown = nb.output(1)
    nearest, value = shown.locator(".rw-laser .rw-nearest"), shown.locator(".rw-speed [data-axis='0'] .rw-value")
    tile, time = shown.locator(".rw-tile", has_text="right"), bar(nb).locator(".rw-play-now")
    first = nearest.inner_text()
    bar(nb).get_by_title("Play (space)").click()
    bar(nb).locator("select").select_option("10")
    passes(nb, 6.0)
    bar(nb).get_by_title("Stop here (space)").click()
    expect(bar(nb).get_by_title("Play (space)")).to_be_visible()
    expect(nearest).not_to_have_text(first)
    there = now(nb)
    for _ in range(2):  # the first may lead to the scan on show, hundredths of a second ago
        bar(nb).get_by_title("One scan back (,)").click()
    nb.page.wait_for_function(f"time => ({SECONDS})(document) < time", arg=there)
    assert now(nb) == pytest.approx(there, abs=0.25)

    # All widgets show the moment under the pointer on the scanogram; a click stays there.
    nb.drawn()
    there = now(nb)
    scans = [m for m in robowidgets.open(robowidgets.SAMPLE).samples("/scan") if m.seconds < there + 0.005]
    expect(nearest).to_contain_text(f"[{scans[-1].sample.nearest().index}]")
    first = nearest.inner_text()
    at = boxes(nb)
    assert at["recording"][3] == 562
    picture = shown.locator(".rw-scanogram .rw-picture")
    box = picture.bounding_box() or {"width": 0}

    def at_second(seconds: float) -> Position:
        return {"x": 64 + (seconds + 0.05) / 58.1 * (box["width"] - 80), "y": 100}

    picture.hover(position=at_second(3))
    expect(time).to_have_text("3.00")
    expect(nearest).not_to_have_text(first)
    ring = shown.locator(".rw-laser .rw-popup:visible .rw-popup-expression")
    expect(ring).to_have_text(shown.locator(".rw-scanogram .rw-popup-expression").inner_text())
    nb.drawn()
    pointed = (nearest.inner_text(), value.inner_text(), tile.inner_text())
    nb.page.mouse.move(5, 5)
    expect(time).to_have_text(f"{there:.2f}")
    expect(nearest).to_have_text(first)
    expect(ring).to_have_count(0)
    picture.click(position=at_second(3))
    nb.page.mouse.move(5, 5)
    expect(time).to_have_text("3.00")
    wait_for(lambda: (nearest.inner_text(), value.inner_text(), tile.inner_text()) == pointed, "all show it")

    # To a moment that it has not played yet, and one step from it.
    picture.click(position=at_second(9))
    passes(nb, 8.9)
    nb.drawn()
    clicked = now(nb)
    expect(shown.locator(".rw-scanogram .rw-scanogram-cursor")).to_contain_text(f"{clicked:.2f} s")
    nb.page.keyboard.press(".")
    passes(nb, clicked)
    nb.drawn()
    stepped = now(nb)
    for focused in (".rw-play", ".rw-step >> nth=0", ".rw-play-speed", ".rw-loop", "input"):
        bar(nb).locator(focused).focus()
        nb.page.keyboard.press("x")
    expect(nb.page.locator(".jp-Cell"), "no key reached the notebook").to_have_count(3)
    # Meanwhile a name is saved next to the recording.
    bar(nb).locator(".rw-play").focus()
    for key in ("a", "ArrowRight", "a"):
        nb.page.keyboard.press(key)
    bar(nb).locator(".rw-naming > input").fill("door")
    nb.page.keyboard.press("Enter")
    expect(bar(nb).locator(".rw-play-label:not(.rw-coming)")).to_have_text("door")
    with robowidgets.open(tmp_path / Path(robowidgets.SAMPLE).name) as recording:
        assert [one.label for one in recording.labels] == ["door"]
    stepped = now(nb)
    nb.interrupt()
    with pytest.raises(CellError, match="KeyboardInterrupt"):
        nb.wait(busy)
    wait_for(lambda: abs(float(nb.python("print(player.time)")) - stepped) < 0.01, "Python knew")
    assert now(nb) == stepped, "it did not go back to the click that Python heard of last"


BELOW_TOP = """() => {
    const panel = document.querySelector('.jp-WindowedPanel-outer');
    panel.scrollTop = 600;
    return document.querySelector('.rw-player').getBoundingClientRect().top - panel.getBoundingClientRect().top;
}"""
"""Distance in pixels from the top of the visible notebook, scrolled down a bit, to the player."""


HELD = """
import gc, os, threading
from comm import get_comm_manager
gc.collect()
files = [os.path.realpath(f"/proc/self/fd/{name}") for name in os.listdir("/proc/self/fd")]
senders = [thread for thread in threading.enumerate() if thread.name == "robowidgets-prefetcher"]
print(len(get_comm_manager().comms), len(senders), sum("fsm_0" in file for file in files))
"""


def test_a_cell_that_runs_again_replaces_its_player_which_goes_on_where_it_was_on_a_reloaded_page(
    notebook: Open, data: Path
) -> None:
    nb = opened(notebook, data / "good" / "neato_fsm")
    expect(nb.output(0).locator("table tbody tr")).to_have_count(10)
    wait_for(
        lambda: nb.python(HELD).split()[1:] == ["0", "2"], "all was sent: the table and the player have the file open"
    )
    held = nb.python(HELD)
    for _ in range(3):
        nb.run(1)
    expect(nb.output(1).locator(".rw-player")).to_have_count(1)
    wait_for(lambda: nb.python(HELD) == held, "what the earlier runs held is gone")
    nb.resize(600, 500)
    wait_for(lambda: 0 <= nb.page.evaluate(BELOW_TOP) < 5, "the bar stays at the top of a narrow page")

    to_time(nb, 22.25)
    tile = nb.output(1).locator(".rw-tile", has_text="left front")
    expect(tile).to_contain_text("touched")
    nb.reload()
    expect(bar(nb).locator(".rw-play-now")).to_have_text("22.25")
    expect(tile).to_contain_text("touched")
    bar(nb).get_by_title("Play (space)").click()
    passes(nb, 22.5)


def test_two_players_stay_at_one_place_while_the_kernel_is_busy(plain_page: Open, tmp_path: Path) -> None:
    corridor.write(tmp_path / "fast")
    corridor.write(tmp_path / "slow", speed=0.4)
    setup = f"""
import robowidgets
fast, slow = (robowidgets.open({str(tmp_path)!r} + name).show(scanogram=False) for name in ("/fast", "/slow"))
fast.views[0].widget.ghost = slow.views[0].widget
slow.follow(fast)"""
    nb = plain_page([setup, "fast", "slow"], width=900)
    nb.resize(900)
    other = nb.output(2).locator(".rw-player")
    now_there, words = other.locator(".rw-play-now"), other.locator(".rw-play-words")
    strip = nb.output(1).locator(".rw-laser .rw-strip")
    expect(strip).to_be_visible()
    for time in (1.0, 9.0):
        to_time(nb, time)  # the page fetches what lies around
        wait_for(lambda: nb.python("print(fast.time)").strip() == str(time), "Python knows")  # noqa: B023
    expect(words).to_have_text("no place within 0.5 m of fast")
    with nb.busy():
        for time, there in ((2.0, "4.00"), (3.0, "6.00")):
            to_time(nb, time)
            expect(now_there).to_have_text(there)
            expect(words).to_be_empty()
        to_time(nb, 8.0)
        expect(words).to_have_text("no place within 0.5 m of fast")
        expect(now_there).to_have_text("6.00")
        shoot(other, "same-place-lost")
        to_time(nb, 3.0)
        bar(nb).get_by_title("Play (space)").click()
        nb.page.wait_for_function("() => document.querySelectorAll('.rw-play-now')[1].textContent > '7.00'")
    bar(nb).get_by_title("Stop here (space)").click()
    told = "print(f'{slow.time:.2f}', fast.playing, slow.playing)"
    # On a busy machine the first may have played on to its turning point, and the second stays.
    wait_for(lambda: nb.python(told).split() == [now_there.text_content(), "False", "False"], "Python knows")
    shoot(nb.output(1), "same-place")


def test_the_slider_has_a_row_of_its_own_and_many_marks_are_a_density(plain_page: Callable[..., PlainPage]) -> None:
    open_it = "import robowidgets\nrecording = robowidgets.open(robowidgets.SAMPLE)"
    nb = plain_page([open_it, "player = recording.show()\nplayer"])
    slider, bar = nb.output(1).locator(".rw-player .rw-slider"), nb.output(1).locator(".rw-player")
    for width in (256, 376, 990, 1280):
        nb.resize(width)
        inside, outside = slider.bounding_box(), bar.bounding_box()
        assert inside
        assert outside
        assert inside["width"] >= outside["width"] - 24
    nb.python("player.marks = [(i * 58 / 5000, i * 58 / 5000, 'mark') for i in range(5000)]")
    expect(nb.output(1).locator(".rw-play-dense").first).to_be_attached()
    assert nb.output(1).locator(".rw-play-marks > *").count() < 500
    nb.python("player.marks = [(10, 11, 'first'), (40, 41, 'second')]")
    expect(nb.output(1).locator(".rw-play-dense")).to_have_count(0)
    expect(nb.output(1).locator(".rw-play-mark")).to_have_count(2)


def test_a_finger_finds_44_pixels_of_slider_and_buttons(plain_page: Callable[..., PlainPage]) -> None:
    open_it = "import robowidgets\nrecording = robowidgets.open(robowidgets.SAMPLE)"
    nb = plain_page([open_it, "recording.show()"], touch=True)
    nb.resize(376)
    for part in nb.output(1).locator(".rw-player :is(.rw-slider, .rw-play)").all():
        box = part.bounding_box()
        assert box
        assert box["height"] >= 44
        assert box["width"] >= 44
