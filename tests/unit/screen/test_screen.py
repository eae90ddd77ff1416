"""Widgets on one screen, which freeze and step together; the page's half is in tests/js/stream.test.ts."""

from __future__ import annotations

import gc
import json

import ipywidgets
import pytest
from ipywidgets.embed import dependency_state

from robowidgets import SAMPLE, LaserWidget, ScanogramWidget, SpeedWidget, TouchWidget, feeds, screen
from robowidgets import open as open_recording
from robowidgets.screen_widget import ScreenWidget
from robowidgets.widget.freezing import freeze_together
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..pages import Page, synced


def test_what_a_program_freezes_freezes_all_at_what_they_show() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    view = screen(laser, speed, touch)
    speed.update(linear=(0.5, 0, 0))
    touch.update(left=True)
    laser.paused = True
    speed.update(linear=(0.7, 0, 0))
    assert [widget.paused for widget in (laser, speed, touch)] == [True] * 3
    assert speed.frozen is not None
    assert speed.frozen.linear[0] == 0.5
    touch.paused = False
    assert [widget.paused for widget in (laser, speed, touch)] == [False] * 3
    assert view.children == (laser, speed, touch)


def test_a_closed_widget_is_in_no_group() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    speed.close()
    with pytest.raises(RuntimeError, match=r"screen\(\): this widget is closed; show a new one"):
        screen(laser, speed)


def test_what_a_page_freezes_is_left_to_the_page_which_knows_the_moment() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    screen(laser, speed)
    speed.update(linear=(0.5, 0, 0))
    laser.set_state({"paused": True, "_frozen_frame": FRAME_HEADER.pack(1, 10, 0, 1.0)})
    assert not speed.paused


def test_a_widget_is_in_the_group_that_it_joined_last_and_groups_keep_no_widget() -> None:
    laser, speed, other = LaserWidget(), SpeedWidget(), SpeedWidget()
    screen(laser, speed)
    screen(laser, other)
    laser.paused = True
    assert (speed.paused, other.paused) == (False, True)
    assert synced(laser, "_together") == synced(other, "_together") != synced(speed, "_together")
    freeze_together([laser])
    assert len(laser._group) == 1
    del other
    gc.collect()


def test_a_screen_within_a_screen_is_frozen_with_the_widgets_around_it() -> None:
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    view = screen(screen(screen(laser), touch), speed)
    laser.paused = True
    assert (speed.paused, touch.paused) == (True, True)
    player = open_recording(SAMPLE).show("/scan", "/odom", scanogram=False)
    other = screen(player, speed)
    groups = {synced(shown.widget, "_together") for shown in player.views}
    player.close()
    assert len(groups) == 1
    assert synced(speed, "_together") not in groups, "a recording has moments of its own"
    assert len(view.children) == len(other.children) == 2


def test_a_widget_that_is_given_twice_has_one_card() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    assert [room["card"] for room in screen(laser, speed, laser).rooms] == ["laser", "speed"]


@pytest.mark.parametrize(
    ("wrong", "text"),
    [
        ((open_recording(SAMPLE),), "got Recording; give the widget that its show() returns"),
        ((), "expected the widgets to show side by side, as in screen(laser, speed)"),
        (([LaserWidget()],), "expected widgets of robowidgets, got list; give each as an argument of its own"),
        ((ipywidgets.HTML(),), "expected widgets of robowidgets, got HTML"),
    ],
)
def test_what_is_no_widget_of_robowidgets_is_refused(wrong: tuple[object, ...], text: str) -> None:
    with pytest.raises(TypeError) as raised:
        screen(*wrong)  # type: ignore[arg-type]
    assert text in str(raised.value)


def test_the_widgets_of_a_feed_and_of_a_recording_are_one_group() -> None:
    player = open_recording(SAMPLE).show(scanogram=False)
    with feeds.simulator() as feed:
        view = feed.show("/scan", "/odom")
        groups = [{synced(widget, "_together") for widget in view.widgets.values()}]
        groups.append({synced(shown.widget, "_together") for shown in player.views})
        assert [len(group) for group in groups] == [1, 1]
        assert "" not in groups[0] | groups[1]
        view.close()
    player.close()


def test_a_widget_stands_in_the_column_of_its_kind_and_one_without_a_kind_in_the_wide_one() -> None:
    laser, speed, whole = LaserWidget(layout={"height": "300px"}), SpeedWidget(), ScanogramWidget()
    inner = screen(laser)
    view = screen(speed, whole, inner)
    rooms = view.get_state()["_children"]
    assert [(room["place"], room["widget"].removeprefix("anywidget:")) for room in rooms] == [
        ("wide", whole.model_id), ("wide", inner.model_id), ("narrow", speed.model_id),
    ]  # fmt: skip
    (room,) = inner.get_state()["_children"]
    assert room["style"] == {"height": "300px"}


def test_a_page_gets_new_places_in_one_message_also_if_the_order_is_the_same() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    view = ScreenWidget(places={"wides": [laser], "smalls": [speed]})
    page = Page(view)
    view.place({"mains": [speed], "wides": [laser]})
    view.place({"mains": [speed, laser]})
    view.place({"wides": [laser]})
    places = [[room["place"] for room in rooms] for rooms in page.sent("_children")]
    assert places == [["mains", "wides"], ["mains", "mains"], ["wides"]]
    view.close()
    assert None not in (laser.comm, speed.comm), "they are not closed with it"


def test_a_page_that_embeds_a_screen_has_the_widgets_on_it() -> None:
    laser, other = LaserWidget(), SpeedWidget()
    view = screen(laser)
    assert {view.model_id, laser.model_id} <= dependency_state([view]).keys()
    assert other.model_id not in dependency_state([view])


def test_the_text_of_a_screen_names_its_cards_and_a_closed_one_says_so() -> None:
    laser, speed = LaserWidget(title="/scan"), SpeedWidget()
    view = screen(laser, speed)
    assert repr(view) == "<ScreenWidget: /scan, speed>"
    assert view._repr_mimebundle_()[0]["text/plain"].splitlines()[:2] == [repr(view), repr(laser)]
    player = open_recording(SAMPLE).show("/scan", scanogram=False)
    with feeds.simulator() as feed:
        shown = feed.show("/scan")
        for one in (view, player, shown):
            one.close()
            assert repr(one) == "this widget is closed: make a new one"


CARDS = {"row": [{"card": "/scan", "width": 8}, {"column": ["/odom", "touch"], "height": 240}]}


def test_an_arrangement_by_hand_is_a_value_that_the_page_changes() -> None:
    laser, speed, touch = LaserWidget(title="/scan"), SpeedWidget(title="/odom"), TouchWidget()
    view = screen(laser, speed, touch)
    assert view.arrangement == []
    assert [(room["card"], room["kind"]) for room in view.rooms] == [
        ("/scan", "laser"),
        ("/odom", "speed"),
        ("touch", "touch"),
    ]
    view.set_state({"_cards": {"all": CARDS}})  # as the page sends it
    assert view.arrangement == {"cards": CARDS}
    again = screen(laser, speed, touch, arrangement=json.loads(json.dumps(view.arrangement)))
    assert again.arrangement == view.arrangement
    again.arrangement = []
    assert again.arrangement == []


def test_cards_with_the_same_title_have_names_of_their_own() -> None:
    one, other, third = (SpeedWidget(title="/odom") for _ in range(3))
    assert [room["card"] for room in screen(one, other, third).rooms] == ["/odom", "/odom 2", "/odom 3"]


@pytest.mark.parametrize(
    ("cards", "error", "words"),
    [
        (3, TypeError, "expected cards as a name or a row or column of them"),
        ({"row": "/scan"}, TypeError, "a row or column"),
        ({"row": []}, TypeError, "a row or column"),
        ({"row": ["/scan"], "column": ["/odom"]}, ValueError, "a row or column"),
        ({"card": "/scan", "size": 3}, ValueError, "a row or column"),
        ({"row": ["/scan", {"card": "/scan"}]}, ValueError, "'/scan' has two places"),
        ({"card": "/scan", "width": 13}, ValueError, "expected a width above 0 and at most 12"),
        ({"card": "/scan", "height": True}, ValueError, "expected a height above 0"),
    ],
)
def test_a_wrong_arrangement_is_refused_with_the_part_that_is_wrong(
    cards: object, error: type[Exception], words: str
) -> None:
    laser = LaserWidget(title="/scan")
    with pytest.raises(error, match=words):
        screen(laser, arrangement={"cards": cards})
    with pytest.raises(TypeError, match="expected a list of topics, or a dictionary"):
        screen(laser, arrangement={"card": "/scan"})
