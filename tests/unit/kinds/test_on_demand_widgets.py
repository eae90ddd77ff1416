"""Widgets of topics on request: by name, or because no other widget fits the topic."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace as Message
from typing import Any

import pytest

import robowidgets
from robowidgets import kinds
from robowidgets.feeds import Advert, Feed
from robowidgets.kinds.choice import FEW, choose_widgets
from robowidgets.notebook import cells as _cells
from robowidgets.recording import Recording
from robowidgets.recordings import UnknownTopicError
from robowidgets.screens.player import Player

from ...more_rows.on_demand import ANY, FIELDS, WORDS, AnyWidget, FieldsWidget, WordsWidget, added
from ..feeds.scripted import IMU, ODOM, SCAN, Scripted, set_discovery_timeout
from ..pages import from_page
from ..recordings import recorded
from ..recordings.sweeps import TYPE as LASER_SCAN
from ..waiting import wait_for

STRING = "std_msgs/msg/String"
TYPES = {"/temperature": "std_msgs/msg/Float64", "/says": STRING, "/log": STRING, "/place": "geometry_msgs/msg/Point"}
NUMBERS = ("/temperature.data", "/place.y")


@pytest.fixture(autouse=True)
def _on_demand() -> Iterator[None]:
    with added():
        yield


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds: a number every 0.1 s, a text each second, a later one of another topic, and places."""
    messages: list[tuple[float, str, dict[str, Any]]] = [
        *((i / 10, "/temperature", {"data": float(i)}) for i in range(21)),
        *((float(i), "/says", {"data": f"at {i}"}) for i in range(2)),
        (1.5, "/log", {"data": "late"}),
        *((i / 2, "/place", {"x": 0.0, "y": -float(i), "z": 0.0}) for i in range(4)),
    ]
    ordered = sorted(messages, key=lambda message: message[0])
    return recorded.write(tmp_path_factory.mktemp("asked") / "drive", TYPES, ordered)


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def shown(player: Player) -> list[tuple[str, tuple[str, ...]]]:
    return [(type(view.widget).__name__, view.choice.topics) for view in player.views]


def test_a_recording_of_which_no_topic_has_a_widget_shows_a_few_the_most_useful_first(recording: Recording) -> None:
    player = recording.show()
    try:
        assert shown(player) == [
            ("WordsWidget", ("/says", "/log")),
            ("AnyWidget", ("/temperature",)),
            ("AnyWidget", ("/place",)),
        ]
    finally:
        player.close()


def test_of_many_topics_without_a_widget_few_are_shown(tmp_path: Path) -> None:
    names = [f"/number_{i}" for i in range(9)]
    messages = [(i / 10, name, {"data": float(i)}) for i, name in enumerate(names)]
    with robowidgets.open(
        recorded.write(tmp_path / "x", dict.fromkeys(names, "std_msgs/msg/Float64"), messages)
    ) as recording:
        player = recording.show()
    try:
        assert [topics for _, topics in shown(player)] == [(name,) for name in names[:FEW]]
    finally:
        player.close()


def test_next_to_a_topic_with_a_widget_others_are_shown_only_by_name(tmp_path: Path) -> None:
    messages = [(0.1 * i, topic, {"data": 0.0} if topic == "/n" else {}) for i in range(9) for topic in ("/n", "/odom")]
    types = {"/odom": "nav_msgs/msg/Odometry", "/n": "std_msgs/msg/Float64"}
    with robowidgets.open(recorded.write(tmp_path / "x", types, messages)) as recording:
        by_default, by_name = recording.show(), recording.show("/n", "/odom.pose.pose.position.x")
    try:
        assert shown(by_default) == [("SpeedWidget", ("/odom",)), ("PathWidget", ("/odom",))]
        assert shown(by_name) == [("AnyWidget", ("/n",)), ("FieldsWidget", ("/odom",))]
    finally:
        by_default.close()
        by_name.close()


def test_fields_share_a_widget_that_has_the_numbers_of_any_time(recording: Recording) -> None:
    player = recording.show("/says", *NUMBERS)
    try:
        words, lines = (view.widget for view in player.views)
        assert isinstance(words, WordsWidget)
        assert isinstance(lines, FieldsWidget)
        assert lines.fields == NUMBERS
        player.time = 1.25
        assert lines.numbers == {"/temperature.data": 12.0, "/place.y": -2.0}
        assert words.came[-1] == ("/says", "at 1")
        track = player.views[1].track
        assert [frame.seconds for frame in track.frames(0.85, 1.15)] == pytest.approx([0.8, 0.9, 1.0, 1.0, 1.1])
    finally:
        player.close()


def test_a_track_of_messages_of_any_type_begins_with_the_one_before(recording: Recording) -> None:
    player = recording.show("/log")
    try:
        (view,) = player.views
        frames = list(view.track.frames(1.0, 2.0))
        assert [(frame.seconds, frame.about) for frame in frames] == [
            (-1.0, {"texts": {"/log": None}}), (pytest.approx(1.5), {"texts": {"/log": "late"}})
        ]  # fmt: skip
    finally:
        player.close()


def test_a_name_that_is_not_there_raises_with_the_nearest(recording: Recording) -> None:
    with pytest.raises(UnknownTopicError, match=r"no topic '/temperatur'.*did you mean '/temperature'"):
        recording.show("/temperatur")
    with pytest.raises(KeyError, match=r"y"):
        recording.show("/place.yy")
    with pytest.raises(UnknownTopicError, match="did you mean '/place'"):
        recording.show("/plac.y")


def test_a_topic_whose_messages_cannot_be_read_says_why(tmp_path: Path) -> None:
    path = recorded.write(tmp_path / "x", {"/scan": LASER_SCAN}, [])
    with robowidgets.open(path) as recording:
        recording._messages.why_unreadable = lambda _: "no definition of it"  # type: ignore[method-assign]
        recording._messages.topics = (recording.topics[0]._replace(name="/odd", type="a/msg/B", widget=None),)
        with pytest.raises(UnknownTopicError, match="'/odd' cannot be shown: no definition of it"):
            Player(recording, ("/odd",))


def test_a_plot_of_a_topic_without_a_field_is_an_error_that_says_so(recording: Recording) -> None:
    with pytest.raises(ValueError, match=r"'/place as lines' names no field .*, as '/place\.FIELD'"):
        recording.show("/place as lines")


def test_a_page_has_the_frames_of_widgets_that_were_asked_for(recording: Recording, tmp_path: Path) -> None:
    kinds.add(replace(ANY, widget=lambda: PagedWidget), replace=True)
    page = recording.to_html(tmp_path / "page.html", topics=["/temperature"])
    assert "/temperature" in page.read_text()


class PagedWidget(AnyWidget):
    """A widget with the script of a built one."""

    _esm, _css = robowidgets.SonarWidget._esm, robowidgets.SonarWidget._css


NUMBER = Advert("/temperature", "std_msgs/msg/Float64")
SAYS, LOG = Advert("/says", STRING), Advert("/log", STRING)


class TestAFeed:
    @pytest.fixture(autouse=True)
    def _impatient(self, monkeypatch: pytest.MonkeyPatch) -> None:
        set_discovery_timeout(monkeypatch, 0.02)

    def test_shows_all_topics_if_no_topic_has_a_widget(self) -> None:
        script = Scripted(NUMBER, SAYS, LOG)
        with Feed(script) as feed:
            view = feed.show()
            assert {topic: type(widget).__name__ for topic, widget in view.widgets.items()} == {
                "/says": "WordsWidget", "/log": "WordsWidget", "/temperature": "AnyWidget"
            }  # fmt: skip
            assert view.widgets["/says"] is view.widgets["/log"]
            script.listener.on_message("/temperature", Message(data=2.5))
            wait_for(lambda: view.widgets["/temperature"].message == Message(data=2.5), "the number is shown")

    def test_gives_each_message_with_its_topic_to_a_shared_widget(self) -> None:
        script = Scripted(SAYS, LOG, ODOM)
        with Feed(script) as feed:
            view = feed.show("/says", "/log")
            (widget,) = set(view.widgets.values())
            for i in range(3):
                script.listener.on_message("/says", Message(data=f"{i}"))
            script.listener.on_message("/log", Message(data="x"))
            wait_for(lambda: len(widget.came) == 4, "every text is there")
            assert [text for topic, text in widget.came if topic == "/says"] == ["0", "1", "2"]
            assert ("/log", "x") in widget.came

    def test_shows_fields_of_topics_that_come_later_in_the_same_widget(self) -> None:
        script = Scripted(NUMBER)
        with Feed(script) as feed:
            view = feed.show("/temperature.data", "/imu.orientation.w")
            widget = view.widgets["/temperature"]
            assert widget.fields == ("/temperature.data", "/imu.orientation.w")
            script.listener.on_topics((NUMBER, IMU, SCAN))
            assert view.widgets == {"/temperature": widget, "/imu": widget}
            script.listener.on_message("/imu", Message(orientation=Message(w=1.0)))
            wait_for(lambda: widget.numbers == {"/imu.orientation.w": 1.0}, "the field is shown")


def test_topics_of_several_namespaces_share_a_shared_widget() -> None:
    topics = [Message(name=name, type=STRING, widget=None, commanded=False) for name in ("/a/x", "/b/x")]
    (choice,) = choose_widgets(topics, ["/b/x", "/a/x"])
    assert (choice.kind, choice.topics, choice.titles) == (WORDS, ("/b/x", "/a/x"), ("/b/x, /a/x",))


def test_a_row_that_cannot_work_is_refused() -> None:
    with pytest.raises(ValueError, match="replace=True"):
        kinds.add(replace(WORDS))
    with pytest.raises(ValueError, match="other than laser"):
        kinds.add(replace(WORDS, name="laser"), replace=True)
    with pytest.raises(ValueError, match="shared"):
        kinds.add(replace(FIELDS, name="more", shared=False))
    with pytest.raises(TypeError, match="widget: expected a function that imports and returns the class, got"):
        kinds.add(replace(ANY, name="more", widget=PagedWidget))


class TestAnArrangement:
    def test_is_the_present_view_and_may_be_set_and_reused(self, recording: Recording) -> None:
        player = recording.show("/says", "/temperature")
        try:
            assert player.arrangement == ["/says", "/temperature"]
            from_page(player.topic_list, {"toggle": "/place", "on": True})
            from_page(player.topic_list, {"toggle": "/temperature", "on": False})
            assert player.arrangement == ["/says", "/place"]
            assert shown(player) == [("WordsWidget", ("/says",)), ("AnyWidget", ("/place",))]
            kept = player.views[0].widget
            player.arrangement = ["/says", ["/temperature.data", "/place.y"], ["/place.x"]]
            assert player.views[0].widget is kept, "what stays is the same widget"
            assert [view.choice.fields for view in player.views[1:]] == [NUMBERS, ("/place.x",)]
            again = recording.show(arrangement=json.loads(json.dumps(player.arrangement)))
            assert shown(again) == shown(player)
            again.close()
        finally:
            player.close()

    def test_is_refused_if_it_is_invalid_or_names_something_missing(self, recording: Recording) -> None:
        for wrong in ("/says", [1], [[]], {"/says": 1}):
            with pytest.raises(TypeError, match=r"arrangement: expected a list of topics"):
                recording.show(arrangement=wrong)
        with pytest.raises(UnknownTopicError, match="did you mean '/says'"):
            recording.show(arrangement=["/say"])

    def test_keeps_the_places_of_cards_that_the_user_has_moved(self, recording: Recording) -> None:
        player = recording.show("/says", "/temperature", "/place.x")
        cards = {"row": ["/says as words", {"column": ["/place.x", "/temperature as anything"]}]}
        try:
            assert {room["card"] for room in player.rooms if room["place"] not in ("bar", "topics")} == {
                *("/says as words", "/place.x", "/temperature as anything")
            }
            player.set_state({"_cards": {"all": cards}})  # as the page sends it
            topics = ["/says", "/temperature", "/place.x"]
            assert player.arrangement == {"topics": topics, "cards": cards}
            from_page(player.topic_list, {"toggle": "/temperature", "on": False})
            assert player.arrangement == {"topics": ["/says", "/place.x"], "cards": cards}, "it may come back"
            again = recording.show(arrangement=json.loads(json.dumps(player.arrangement)))
            assert shown(again) == shown(player)
            assert again.arrangement == player.arrangement
            again.arrangement = ["/says"]
            assert again.arrangement == ["/says"]
            again.close()
            every = recording.show(arrangement={"cards": cards})
            assert [len(view.choice.topics) for view in every.views] == [2, 1, 1], "without topics the usual ones"
            every.close()
        finally:
            player.close()

    def test_all_may_be_taken_off(self, recording: Recording) -> None:
        player = recording.show("/says")
        try:
            from_page(player.topic_list, {"toggle": "/says", "on": False})
            assert (player.arrangement, player.views) == ([], ())
            from_page(player.topic_list, {"toggle": "/says", "on": True})
            assert player.arrangement == ["/says"]
        finally:
            player.close()

    def test_names_the_widget_that_is_to_show_a_topic(self, tmp_path: Path) -> None:
        path = recorded.write(tmp_path / "x", {"/odom": "nav_msgs/msg/Odometry"}, [(0, "/odom", {}), (1, "/odom", {})])
        with robowidgets.open(path) as recording:
            player = recording.show("/odom as path", "/odom as anything")
        try:
            assert shown(player) == [("PathWidget", ("/odom",)), ("AnyWidget", ("/odom",))]
        finally:
            player.close()

    def test_of_a_feed_keeps_deselected_topics_off_while_others_come(self) -> None:
        script = Scripted(ODOM, SCAN)
        with Feed(script) as feed:
            view = feed.show()
            from_page(view.topic_list, {"toggle": "/scan", "on": False})
            assert view.arrangement == ["/odom"]
            script.listener.on_topics((ODOM, SCAN, NUMBER))
            from_page(view.topic_list, {"toggle": "/temperature", "on": True})
            assert view.arrangement == ["/odom", "/temperature"]
            assert view.widgets.keys() == {"/odom", "/temperature"}

    def test_is_kept_by_a_cell_that_is_run_again_and_asks_for_the_same(
        self, recording: Recording, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        runs = iter("1234")
        monkeypatch.setattr(_cells, "_made", {})

        def run(cell: str, *topics: str) -> Player:
            monkeypatch.setattr(_cells, "running_cell", lambda: (cell, number))
            number = next(runs)
            with robowidgets.open(recording.path) as opened:
                return opened.show(*topics)

        first = run("a cell", "/says", "/temperature")
        first.arrangement = ["/temperature", ["/temperature.data"]]
        assert first.topic_list is not None
        from_page(first.topic_list, {"toggle": "/place", "on": True})
        chosen = first.arrangement
        assert "/place" in chosen
        assert run("a cell", "/says", "/temperature").arrangement == chosen
        last = run("a cell", "/says")
        assert last.arrangement == ["/says"]
        last.close()

        script = Scripted(ODOM, SCAN, NUMBER)
        with Feed(script) as feed:
            monkeypatch.setattr(_cells, "running_cell", lambda: ("another", "1"))
            view = feed.show()
            view.arrangement = ["/odom", "/temperature"]
            monkeypatch.setattr(_cells, "running_cell", lambda: ("another", "2"))
            assert feed.show().arrangement == ["/odom", "/temperature"]
