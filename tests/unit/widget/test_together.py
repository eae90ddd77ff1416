"""Widgets that freeze and step together; the page's half is in tests/js/stream.test.ts."""

from __future__ import annotations

import gc

import pytest

from robowidgets import LaserWidget, ScanogramWidget, SpeedWidget, TouchWidget, feeds, together
from robowidgets import open as open_recording
from robowidgets.widget.freezing import freeze_together
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..pages import synced


def test_what_a_program_freezes_freezes_all_at_what_they_show() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    view = together(laser, speed, touch)
    speed.update(linear=(0.5, 0, 0))
    touch.update(left=True)
    laser.paused = True
    speed.update(linear=(0.7, 0, 0))
    assert [widget.paused for widget in (laser, speed, touch)] == [True] * 3
    assert speed.frozen is not None
    assert speed.frozen.linear[0] == 0.5
    touch.paused = False
    assert [widget.paused for widget in (laser, speed, touch)] == [False] * 3
    shown = {widget for column in view.children for widget in column.children}
    assert shown == {laser, speed, touch}


def test_a_closed_widget_is_in_no_group() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    speed.close()
    with pytest.raises(RuntimeError, match=r"together\(\): this widget is closed; show a new one"):
        together(laser, speed)


def test_what_a_page_freezes_is_left_to_the_page_which_knows_the_moment() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    together(laser, speed)
    speed.update(linear=(0.5, 0, 0))
    laser.set_state({"paused": True, "_frozen_frame": FRAME_HEADER.pack(1, 10, 0, 1.0)})
    assert not speed.paused


def test_a_widget_is_in_the_group_that_it_joined_last_and_groups_keep_no_widget() -> None:
    laser, speed, other = LaserWidget(), SpeedWidget(), SpeedWidget()
    together(laser, speed)
    together(laser, other)
    laser.paused = True
    assert (speed.paused, other.paused) == (False, True)
    assert synced(laser, "_together") == synced(other, "_together") != synced(speed, "_together")
    freeze_together([laser])
    assert len(laser._group) == 1
    del other
    gc.collect()


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ((), "expected the widgets to freeze together, as in together(laser, speed)"),
        (([LaserWidget()],), "expected laser, speed and touch widgets, got list; give each as an argument of its own"),
        ((ScanogramWidget(),), "expected laser, speed and touch widgets, got ScanogramWidget"),
    ],
)
def test_what_cannot_be_frozen_is_refused(wrong: tuple[object, ...], text: str) -> None:
    with pytest.raises(TypeError) as raised:
        together(*wrong)  # type: ignore[arg-type]
    assert text in str(raised.value)


def test_the_widgets_of_a_feed_and_of_a_recording_are_one_group() -> None:
    from robowidgets import SAMPLE

    player = open_recording(SAMPLE).show(scanogram=False)
    with feeds.simulator() as feed:
        view = feed.show("/scan", "/odom")
        groups = [{synced(widget, "_together") for widget in view.widgets.values()}]
        groups.append({synced(shown.widget, "_together") for shown in player.views})
        assert [len(group) for group in groups] == [1, 1]
        assert "" not in groups[0] | groups[1]
        view.close()
    player.close()
