"""The list of topics: its rows, its reactions to click, keys and finger, and its place in the layout."""

from __future__ import annotations

import re
import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from playwright.sync_api import Locator, expect

import robowidgets
from robowidgets import kinds
from robowidgets.files import open_source
from robowidgets.widget.front_end import bundle

from .. import gas_package
from ..more_rows.on_demand import ANY, AnyWidget, added
from ..unit.recordings import recorded
from ..unit.waiting import wait_for
from .chromium import LOOKS, shoot
from .plain_page import PlainPage

Open = Callable[..., PlainPage]

FLOAT = "std_msgs/msg/Float64"


class ShownAny(AnyWidget):
    """Has the front end of a gas sensor."""

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `AnyWidget`."""
        return {}, struct.pack("<d", float("nan") if sample is None else sample.data)

    def _pack(self, sample: Any) -> bytes:
        return struct.pack("<d", sample.messages[""].data)


@pytest.fixture(scope="module", autouse=True)
def _front_end(tmp_path_factory: pytest.TempPathFactory) -> None:
    ShownAny._esm, ShownAny._css = bundle("gas_widget", gas_package.build(tmp_path_factory.mktemp("static")))


@pytest.fixture(autouse=True)
def _asked(_front_end: None) -> Iterator[None]:
    with added():
        kinds.add(replace(ANY, widget=lambda: ShownAny), replace=True)
        yield


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The sample, and 26 topics of numbers, most of them in namespaces, one of an unknown type."""
    names = [f"/{name}" for name in ("voltage", "charge", "<b>bold</b>")]
    names += [f"/camera/{name}" for name in ("exposure", "gain", "white_balance", "temperature", "shutter", "focus")]
    names += [f"/nav/{name}" for name in ("cost", "goal_distance", "local_costmap/raw_updates", "length", "retries")]
    names += [f"/wheel/{side}_{what}" for side in ("left", "right") for what in ("current", "position", "speed")]
    names += [f"/imu/{axis}" for axis in ("x", "y", "z")]
    with closing(open_source(Path(robowidgets.SAMPLE))) as source:
        real = [(message[1], message[0].topic, message[2]) for message in source.messages(source.channels)]
        types = {channel.topic: channel.type for channel in source.channels}
    numbers = [
        (real[0][0] + round(1e9 * i / 2), name, {"data": i / 2 * (1 + len(name))}) for i in range(100) for name in names
    ]
    messages = [((t - recorded.START_NS) / 1e9, topic, what) for t, topic, what in sorted([*real, *numbers], key=first)]
    folder = tmp_path_factory.mktemp("topics") / "drive"
    return recorded.write(folder, {**types, **dict.fromkeys(names, FLOAT)}, messages)


def first(message: tuple[int, Any, Any]) -> int:
    return message[0]


def opened(plain_page: Open, path: Path, show: str = "", **more: Any) -> PlainPage:
    opens = f"recording = robowidgets.open({str(path)!r})"
    nb = plain_page(["import robowidgets", opens, f"(player := recording.show({show}))"], **more)
    expect(nb.output(2).locator(".rw-laser .rw-title")).to_have_text("/scan")
    return nb


def row(nb: PlainPage, name: str) -> Locator:
    return nb.output(2).locator(f'.rw-topic[data-key="{name}"]')


def titles(nb: PlainPage) -> list[str]:
    return nb.output(2).locator(".rw-screen .rw-title").all_inner_texts()


@pytest.mark.core
@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_a_click_puts_a_topic_on_the_screen_and_takes_it_off(
    plain_page: Open, path: Path, theme: str, scale: int
) -> None:
    nb = opened(plain_page, path, theme=theme, scale=scale, height=720)
    nb.resize(1264, 720)
    shown = nb.output(2)
    rail = shown.locator(".rw-topics-rail")
    expect(rail).to_have_text("Topics 4 / 27")
    shoot(shown, f"topics-folded-{theme}")
    rail.click()
    expect(rail).to_be_hidden()
    shoot(shown, f"topics-open-{theme}")
    before = titles(nb)
    row(nb, "/voltage").click()
    expect(row(nb, "/voltage")).to_have_attribute("data-shown", "")
    expect(shown.locator(".rw-screen .rw-title", has_text="/voltage")).to_be_visible()
    shoot(shown, f"topics-added-{theme}")
    row(nb, "/imu/x").click()
    row(nb, "/imu/y").click()
    expect(shown.locator(".rw-screen .rw-title", has_text="/imu/y")).to_be_visible()
    shoot(shown, f"topics-added-three-{theme}")
    assert nb.python("player.arrangement").endswith("'/voltage', '/imu/x', '/imu/y']")
    for name in ("/voltage", "/imu/x", "/imu/y"):
        row(nb, name).click()
    expect(shown.locator(".rw-screen .rw-title", has_text="/imu/y")).to_have_count(0)
    expect(shown.locator(".rw-screen .rw-title")).to_have_text(before)


def test_a_click_counts_although_the_list_is_drawn_again_while_the_row_is_pressed(plain_page: Open, path: Path) -> None:
    nb = opened(plain_page, path, height=720)
    nb.resize(1264, 720)
    shown = nb.output(2)
    shown.locator(".rw-topics-rail").click()
    row(nb, "/voltage").hover()
    nb.page.mouse.down()
    nb.python("player.topic_list._error = 'an odd topic'")
    expect(shown.locator(".rw-topics-foot")).to_contain_text("an odd topic")
    nb.page.mouse.up()
    expect(row(nb, "/voltage")).to_have_attribute("data-shown", "")
    expect(shown.locator(".rw-screen .rw-title", has_text="/voltage")).to_be_visible()


def test_keys_walk_fold_filter_and_show(plain_page: Open, path: Path) -> None:
    nb = opened(plain_page, path, height=720)
    nb.resize(1264, 780)  # all groups fit
    shown = nb.output(2)
    shown.locator(".rw-topics-rail").focus()
    nb.page.keyboard.press("Enter")
    keys, at = nb.page.keyboard, shown.locator(".rw-topics-body :focus")
    expect(at).to_have_attribute("data-key", "/scan")
    expect(row(nb, "/scan")).to_have_attribute("aria-label", re.compile(r"^/scan, LaserScan, 581 messages, .*, shown$"))
    for _ in range(4):
        keys.press("ArrowDown")
    expect(at).to_have_attribute("data-key", "/voltage")
    expect(row(nb, "/voltage").locator(".rw-topic-value")).to_have_text("0")
    keys.press(" ")
    expect(shown.locator(".rw-screen .rw-title", has_text="/voltage")).to_be_visible()
    expect(shown.locator(".rw-topics > .rw-unseen")).to_have_text("/voltage shown")
    keys.press("/")
    keys.type("white")
    expect(shown.locator(".rw-topic")).to_have_count(1)
    keys.press("Enter")
    expect(at).to_have_attribute("data-key", "/camera/white_balance")
    keys.press("Escape")
    expect(shown.locator(".rw-topics-filter")).to_be_hidden()
    row(nb, "/camera/white_balance").focus()
    keys.press("ArrowLeft")
    expect(at).to_have_attribute("data-key", "group /camera")
    keys.press("ArrowLeft")
    expect(at).to_have_attribute("aria-expanded", "false")
    expect(row(nb, "/camera/white_balance")).to_have_count(0)
    nb.python("player.time = 20.0")
    expect(row(nb, "/voltage").locator(".rw-topic-value")).to_have_text("180")
    expect(shown.locator(".rw-topics-head")).to_contain_text("at 20.00 s")


def test_a_hostile_name_is_text_and_two_thousand_topics_are_few_rows(plain_page: Open, tmp_path: Path) -> None:
    names = ["/<b>bold</b>", *(f"/t{i}" for i in range(2000))]
    folder = recorded.write(
        tmp_path / "many", dict.fromkeys(names, FLOAT), [(i / 10, names[0], {"data": 1.0}) for i in range(20)]
    )
    nb = plain_page([f"import robowidgets\nrecording = robowidgets.open({str(folder)!r})\nrecording.show()"])
    nb.resize(1264, 720)
    nb.output(0).locator(".rw-topics-rail").click()
    expect(nb.output(0).locator(".rw-topic").first).to_contain_text("/<b>bold</b>")
    expect(nb.output(0).locator(".rw-topic b")).to_have_count(0)
    expect(nb.output(0).locator(".rw-topic")).to_have_count(400)
    expect(nb.output(0).locator(".rw-topics-more")).to_have_text("and 1,601 more: filter them by name")
    nb.page.keyboard.press("/")
    nb.page.keyboard.type("t1999")
    expect(nb.output(0).locator(".rw-topic")).to_have_count(1)


def test_a_busy_kernel_is_named_and_the_topic_follows(plain_page: Open, path: Path) -> None:
    nb = opened(plain_page, path, height=720)
    nb.resize(1264, 720)
    nb.output(2).locator(".rw-topics-rail").click()
    with nb.busy():
        row(nb, "/charge").click()
        expect(nb.output(2).locator(".rw-topics-foot-facts")).to_have_text(
            "the kernel is busy: it follows when the cell ends"
        )
    expect(nb.output(2).locator(".rw-screen .rw-title", has_text="/charge")).to_be_visible()
    expect(nb.output(2).locator(".rw-topics-foot-facts")).not_to_contain_text("busy")


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_pictures_of_the_list_at_each_width(plain_page: Open, path: Path, theme: str, scale: int) -> None:
    nb = opened(plain_page, path, theme=theme, scale=scale, height=720)
    nb.output(2).locator(".rw-topics-rail").click()
    for width in (1500, 1112, 900, 400):
        nb.resize(width, 720)
        listed = nb.output(2).locator(".rw-topics")
        expect(listed).to_be_visible()
        assert listed.evaluate("list => list.scrollWidth <= list.clientWidth + 1")
        box = listed.bounding_box()
        assert box is not None
        assert box["width"] == (width if width < 900 else 284)
        shoot(nb.output(2), f"topics-{width}-{theme}")


@pytest.mark.parametrize("width", [920, 1300, 1500])
def test_the_list_of_a_robot_leaves_the_bar_and_the_pictures_their_place(plain_page: Open, width: int) -> None:
    opens = "from robowidgets import feeds; robot = feeds.simulator(wander=False)"
    nb = plain_page([opens, "(view := robot.show('/scan', '/odom', '/cmd_vel', '/bumper'))"])
    nb.resize(width, 720)
    laser = nb.output(1).locator(".rw-laser")
    expect(laser.locator(".rw-title")).to_have_text("/scan")
    nb.output(1).locator(".rw-topics-rail").click()
    listed = nb.output(1).locator(".rw-topics")
    expect(listed).to_be_visible()
    bar, there, picture = (
        nb.output(1).locator(one).bounding_box() for one in (".rw-stop-bar", ".rw-topics", ".rw-laser")
    )
    shoot(nb.output(1), f"topics-robot-{width}")
    assert bar is not None
    assert there is not None
    assert picture is not None
    assert there["y"] == pytest.approx(bar["y"] + bar["height"], abs=12)
    assert there["x"] == pytest.approx(bar["x"], abs=4)
    assert picture["y"] < bar["y"] + 100


def test_the_list_of_a_robot_says_what_comes_now_and_how_often_until_it_is_folded(plain_page: Open) -> None:
    opens = "from robowidgets import feeds; robot = feeds.simulator(wander=False)"
    nb = plain_page(["import time", opens, "(view := robot.show('/scan'))"])
    nb.output(2).locator(".rw-topics-rail").click()
    expect(row(nb, "/scan").locator(".rw-topic-rate")).to_have_text(re.compile(r"^(\d+|\d\.\d)$"))
    expect(row(nb, "/odom").locator(".rw-topic-rate")).to_have_text(re.compile(r"^(\d+|\d\.\d)$"))
    expect(row(nb, "/odom").locator(".rw-topic-value")).to_have_text("0 m/s")
    row(nb, "/odom").hover()
    expect(nb.output(2).locator(".rw-topics-foot-facts")).to_contain_text("Hz")
    shoot(nb.output(2), "topics-robot-now")
    nb.output(2).locator(".rw-topics-fold").click()
    heard = "print(*robot.connection.connected)"
    wait_for(lambda: nb.python(heard).strip() == "/scan", "it listens to nothing more")


def test_two_views_of_the_list_of_a_robot_each_have_what_they_show(plain_page: Open) -> None:
    opens = "from robowidgets import feeds; robot = feeds.simulator(wander=False)"
    nb = plain_page([opens, "(view := robot.show('/scan'))", "view"])
    first, second = (nb.output(cell).locator(".rw-topics") for cell in (1, 2))
    odom = first.locator(".rw-topic[data-key='/odom']")
    first.locator(".rw-topics-rail").click()
    for listed in (first, second):
        listed.scroll_into_view_if_needed()
        expect(listed.locator(".rw-topic[data-key='/odom'] .rw-topic-value")).to_have_text("0 m/s")
    second.locator(".rw-topics-search").click()
    second.locator(".rw-topics-filter").fill("scan")
    expect(second.locator(".rw-topic")).to_have_count(1)
    looks = "print(sorted(len(names) for _, names in view.topic_list._looks.values()))"
    wait_for(lambda: nb.python(looks).strip() == "[1, 4]", "one looks at one topic, the other at all")
    odom.scroll_into_view_if_needed()

    def it_says_so() -> bool:  # it drives for half a second
        nb.python("robot.drive(0.2, 0)")
        return odom.locator(".rw-topic-value").inner_text() == "0.2 m/s"

    wait_for(it_says_so, "the first list has what comes now")
    expect(odom.locator(".rw-topic-rate")).to_have_text(re.compile(r"^(\d+|\d\.\d)$"))
