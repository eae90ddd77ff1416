"""The message widget on a page."""

from __future__ import annotations

import re
from collections.abc import Callable

import pytest
from playwright.sync_api import Locator, expect

from .chromium import LOOKS, shoot
from .laser import eventually
from .message import BATTERY, DIAGNOSTICS, HOSTILE, IMU, JOINTS, LARGE_NUMBERS
from .plain_page import PlainPage


def value(card: Locator, path: str) -> Locator:
    """The text next to the name of a field."""
    return row(card, path).locator(".rw-message-value")


def row(card: Locator, path: str) -> Locator:
    """The row of a field in the tree."""
    return card.locator(f'.rw-message-row[data-rw-row="{path}"]')


@pytest.mark.parametrize(("theme", "scale"), LOOKS)
def test_every_field_is_readable_at_every_width(plain_page: Callable[..., PlainPage], theme: str, scale: int) -> None:
    nb = plain_page([IMU, BATTERY, JOINTS, DIAGNOSTICS, LARGE_NUMBERS, HOSTILE], run=False, scale=scale, theme=theme)
    nb.run_all()
    for width in (300, 480, 1200):
        nb.resize(width)
        for i, name in enumerate(("imu", "battery", "joints", "diagnostics", "large", "hostile")):
            card = nb.widget(i).locator(".rw-card")
            card.scroll_into_view_if_needed()
            shoot(card, f"message-{name}-{theme}-{width}")
    card = nb.widget(0).locator(".rw-card")
    expect(value(card, "angular_velocity.z")).to_have_text("−0.4702")
    expect(value(card, "orientation")).to_have_text("−114.6° yaw")
    expect(value(card, "angular_velocity_covariance")).to_have_text("all 0: not known")
    expect(value(card, "linear_acceleration_covariance")).to_have_text("−1: not measured")
    battery, large = (nb.widget(i).locator(".rw-card") for i in (1, 4))
    nb.resize(296)
    percentage = battery.locator('[data-rw-row="percentage"] b')
    expect(percentage).to_have_text("86.7")
    cut = "(number) => { const text = new Range(); text.selectNodeContents(number); return "
    cut += "text.getBoundingClientRect().width - number.getBoundingClientRect().width }"
    assert percentage.evaluate(cut) <= 0.02
    expect(battery.locator('[data-rw-row="power_supply_status"] b')).to_have_text("DISCHARGING")
    expect(battery.locator('[data-rw-row="design_capacity"] b')).to_have_text("not measured (NaN)")
    expect(large.locator(".rw-message-value")).to_have_text(["0.867", "16.21", "DISCHARGING", "true"])


def test_hostile_names_and_texts_are_text_and_what_is_large_is_folded(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU, HOSTILE])
    card = nb.widget(1).locator(".rw-card")
    expect(value(card, "<b>name</b>")).to_have_text("<img src=x onerror=alert(1)>")
    assert card.locator("img, b:has-text('name')").count() == 0
    expect(value(card, "nan")).to_have_text("not measured (NaN)")
    expect(value(card, "nothing")).to_have_text("no value")
    expect(value(card, "big")).to_have_text(str(2**60 + 1))
    expect(value(card, "many")).to_have_text("2 000 fields")
    expect(row(card, "text")).to_contain_text("3 000 000 characters")
    assert card.locator(".rw-message-row").count() < 40
    row(card, "many").click()
    row(card, "many[1984:2000]").click()
    expect(value(card, "many.f1999")).to_have_text("1999")
    row(card, "image").click()
    expect(card.get_by_text("image in Python has all")).to_be_visible()


@pytest.mark.core
def test_a_field_is_pointed_at_copied_and_watched_also_while_a_cell_runs(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU])
    card = nb.widget(0).locator(".rw-card")
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    z = row(card, "linear_acceleration.z")
    expect(value(card, "linear_acceleration.z")).to_have_text("9.824123")
    with nb.busy():
        z.hover()
        expect(card.locator(".rw-message-told")).to_have_text("linear_acceleration.z  9.824123456789012 m/s²")
        z.get_by_role("button", name="Copy path").click()
        expect(z.get_by_role("button", name="Copied")).to_be_visible()
        assert nb.page.evaluate("navigator.clipboard.readText()") == "message.linear_acceleration.z"
        z.get_by_role("button", name="Watch").click()
        expect(card.locator(".rw-over-time")).to_be_visible()
        row(card, "header").click()
        expect(row(card, "header.frame_id")).to_have_count(0)
        expect(row(card, "header")).to_have_attribute("aria-expanded", "false")
    eventually(lambda: nb.python("imu_widget.folds"), "{'header': False}")
    assert nb.python("imu_widget.over_time") == "['linear_acceleration.z']"


def test_what_changed_is_marked_and_nothing_else(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page(
        [IMU, "imu_widget.paused = True\nimu_widget.update(imu(-0.5))", "imu_widget.paused = False"], run=False
    )
    nb.run(0)
    card = nb.widget(0).locator(".rw-card")
    changed = card.locator(".rw-message-changed")
    expect(changed).to_have_count(0)
    nb.run(1)
    nb.run(2)
    nb.page.keyboard.press("Escape")
    expect(value(card, "angular_velocity.z")).to_have_text("−0.5")
    expect(changed).to_have_count(0)  # the silence is over
    card.locator(".rw-picture").focus()
    nb.page.keyboard.press(" ")
    expect(changed).to_have_count(2)
    names = changed.evaluate_all("rows => rows.map(row => row.dataset.rwRow)")
    assert names == ["angular_velocity", "angular_velocity.z"]
    nb.page.keyboard.press(",")
    expect(value(card, "angular_velocity.z")).to_have_text("−0.4702")
    expect(changed).to_have_count(0)


def test_keys_walk_through_the_tree_and_a_screen_reader_hears_each_field(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU])
    card = nb.widget(0).locator(".rw-card")
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    keys = nb.page.keyboard
    expect(card.get_by_role("tree", name="fields")).to_be_visible()
    row(card, "angular_velocity").focus()
    keys.press("ArrowDown")
    expect(row(card, "angular_velocity.x")).to_be_focused()
    expect(row(card, "angular_velocity.x")).to_have_attribute(
        "aria-label", "angular velocity, x, 0.004 radians per second"
    )
    keys.press("c")
    expect(card.get_by_role("button", name="Copied")).to_be_visible()
    assert nb.page.evaluate("navigator.clipboard.readText()") == "message.angular_velocity.x"
    keys.press("w")
    expect(card.locator(".rw-over-time")).to_be_visible()
    keys.press("ArrowLeft")
    expect(row(card, "angular_velocity")).to_be_focused()
    keys.press("ArrowLeft")
    expect(row(card, "angular_velocity.x")).to_have_count(0)
    keys.press("ArrowDown")
    keys.press("ArrowRight")
    expect(row(card, "angular_velocity_covariance[8]")).to_be_visible()
    keys.press("End")
    expect(row(card, "linear_acceleration_covariance")).to_be_focused()
    keys.press("Home")
    expect(row(card, "header")).to_be_focused()


def test_a_finger_reaches_the_buttons_of_a_field(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU], touch=True)
    nb.resize(320)
    card = nb.widget(0).locator(".rw-card")
    x = row(card, "angular_velocity.x")
    x.tap()
    watch = x.get_by_role("button", name="Watch")
    expect(watch).to_be_visible()
    box = watch.bounding_box()
    assert box is not None
    shoot(card, "message-touch")


def test_rows_and_tree_change_over(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU, DIAGNOSTICS, JOINTS])
    card = nb.widget(1).locator(".rw-card")
    expect(card.locator(".rw-message-tr")).to_have_count(4)
    card.locator('.rw-message-tr[data-rw-row="status[0]"]').click()
    expect(card.locator(".rw-message-inner:visible")).to_have_text("temperature: 41.2\ncurrent: 0.8")
    card.get_by_role("button", name="Tree").click()
    expect(value(card, "status")).to_have_text("[4]")
    eventually(lambda: nb.python("diagnostics.rows"), "False")
    card.get_by_role("button", name="Rows").click()
    expect(card.locator(".rw-message-tr")).to_have_count(4)
    joints = nb.widget(2).locator(".rw-card")
    gripper = joints.locator(".rw-message-tr").last.locator("b")
    expect(gripper).to_have_text(["0.031", "—", "—"])


def test_joints_show_their_numbers_and_names_whole(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([WHEELS])
    card = nb.widget(0).locator(".rw-card")
    expect(card.locator(".rw-message-tr th")).to_have_text(["wheel_right_back_joint[0]", "wheel_right_front_joint[1]"])
    for width in (474, 350):
        nb.resize(width)
        texts = card.locator(".rw-message-line b, .rw-message-tr th")
        assert texts.evaluate_all("(texts) => texts.every((one) => one.scrollWidth <= one.clientWidth)"), width


WHEELS = """
import robowidgets
wheels = robowidgets.MessageWidget(title="/joint_states")
wheels.update({"name": ["wheel_right_back_joint", "wheel_right_front_joint"], "position": [-10.61234, -8.4831234e-10],
               "velocity": [-8.4831234e-10, -4.6141234e-17], "effort": [-277.31234, -0.0000016412345]})
wheels
"""

RECORDED = """
import tempfile
from pathlib import Path
import robowidgets
from tests.unit.recordings import recorded
_said = [(0.5 * i, "/state", {"data": 0.1 * i}) for i in range(8)]
_folder = Path(tempfile.mkdtemp()) / "drive"
recording = robowidgets.open(recorded.write(_folder, {"/state": "std_msgs/msg/Float64"}, _said))
player = recording.show("/state as message")
player
"""


def test_a_player_shows_the_message_of_each_time_and_copies_the_code_that_reads_it(
    plain_page: Callable[..., PlainPage],
) -> None:
    nb = plain_page([RECORDED])
    nb.page.context.grant_permissions(["clipboard-read", "clipboard-write"])
    card = nb.output(0).locator(".rw-message")
    expect(value(card, "data")).to_have_text("0")
    with nb.busy():
        nb.output(0).get_by_role("button", name="One scan on (.)").first.click()
        expect(value(card, "data")).to_have_text("0.1")
        expect(card.locator(".rw-message-place")).to_have_text("at 0.500 s")
        expect(row(card, "data")).to_have_class(re.compile("rw-message-changed"))
        row(card, "data").hover()
        row(card, "data").get_by_role("button", name="Copy path").click()
        expect(row(card, "data").get_by_role("button", name="Copied")).to_be_visible()
    code = nb.page.evaluate("navigator.clipboard.readText()")
    assert code == 'recording.message_at("/state", 0.5).message.data'
    assert nb.python(code) == "0.1"
    assert nb.python("player.views[0].widget.message.data") == "0.1"
    shoot(card, "message-player")


def test_a_click_plots_a_number_of_a_recording_next_to_it(plain_page: Callable[..., PlainPage]) -> None:
    nb = plain_page([IMU, RECORDED])
    alone = row(nb.widget(0).locator(".rw-card"), "angular_velocity.z")
    alone.hover()
    expect(alone.get_by_role("button", name="Watch")).to_be_visible()
    expect(alone.get_by_role("button", name="Plot")).to_be_hidden()
    card = nb.output(1).locator(".rw-message")
    row(card, "data").hover()
    row(card, "data").get_by_role("button", name="Plot").click()
    expect(nb.output(1).locator(".rw-plot").locator(".rw-plot-most")).to_have_text("0.7")
    assert nb.python("[type(view.widget).__name__ for view in player.views]") == "['PlotWidget', 'MessageWidget']"
