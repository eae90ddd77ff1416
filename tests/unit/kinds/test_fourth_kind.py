"""A sensor added by a sample, a reader, a widget and one row is opened, found, played and fed like the others."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import robowidgets
from robowidgets import RecordingError, conditions, feeds
from robowidgets.behaviors.machine import Machine
from robowidgets.feeds import Advert, Feed
from robowidgets.kinds import KINDS, kind_of_type
from robowidgets.recording import Recording
from robowidgets.recordings import UnknownTopicError

from ...fourth_kind import drive
from ...fourth_kind.number import NUMBER, Number, added
from ...fourth_kind.number_widget import NumberWidget
from ..feeds.scripted import SCAN, Scripted
from ..waiting import wait_for

DEPTH = Advert("/depth", "std_msgs/msg/Float64")
LEVEL, NAME = (Advert(name, "std_msgs/msg/String") for name in ("/level", "/name"))


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return drive.write(tmp_path_factory.mktemp("numbers") / "drive")


@pytest.fixture(autouse=True)
def _number() -> Iterator[None]:
    with added():
        yield


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def test_topics_are_listed_with_their_widget_the_undecided_ones_by_their_messages(recording: Recording) -> None:
    assert {topic.name: topic.widget for topic in recording.topics} == {
        "/depth": "number", "/level": "number", "/name": None, "/cliff": "touch"
    }  # fmt: skip
    assert recording.problems == ()
    assert "number" in recording.info()


def test_samples_come_in_the_order_of_time_with_their_unit(recording: Recording) -> None:
    moments = list(recording.samples("/level"))
    assert len(moments) == drive.COUNT
    assert moments[30].sample.value == pytest.approx(1.7)
    assert (moments[30].sample.unit, moments[30].sample.stamp_ns) == ("m", None)
    assert recording.at("/depth", 1.05).sample == Number(1.0)


def test_a_series_has_their_times_and_samples(recording: Recording) -> None:
    series = recording.series("/depth")
    assert len(series) == drive.COUNT
    assert series.seconds.tolist() == pytest.approx([i * drive.STEP for i in range(drive.COUNT)])
    assert [moment.sample.value for moment in series[10:13]] == [1.0, 1.1, 1.2]
    assert sum(len(chunk) for chunk in series.chunks()) == drive.COUNT


def test_a_topic_of_another_kind_is_refused_in_the_words_of_the_row(recording: Recording) -> None:
    with pytest.raises(UnknownTopicError, match="'/depth' is a topic of numbers; topics of laser scans: none"):
        recording.scans("/depth")


def test_a_function_finds_by_the_name_of_the_sample(recording: Recording) -> None:
    spans = recording.find(lambda moment: moment.number.value > 2, topics="/depth")
    assert [(span.start, span.end) for span in spans] == [(pytest.approx(2.1), pytest.approx(4.9))]
    both = recording.find(lambda moment: moment["/depth"].value > 2 and moment["/level"].value > 1.75)
    assert [(span.start, span.end) for span in both] == [(pytest.approx(2.1), pytest.approx(2.5))]


def test_several_topics_of_the_kind_have_to_be_named(recording: Recording) -> None:
    with pytest.raises(UnknownTopicError, match=r"several topics of numbers \(/depth, /level\)"):
        recording.find(lambda moment: moment.number.value > 2)
    with pytest.raises(RecordingError, match=r"no 'volume' here: there are scan, speed, touch, .*number"):
        recording.find(lambda moment: moment.volume > 2)


def test_a_silence_of_them_is_a_gap(recording: Recording) -> None:
    assert not recording.find(conditions.gap(0.15))
    spans = recording.find(conditions.gap(0.05, "/depth"))
    assert spans
    assert {span.silent for span in spans} == {("/depth",)}


def test_a_player_shows_them_at_any_time(recording: Recording) -> None:
    player = recording.show("/depth", "/cliff")
    try:
        assert [type(view.widget).__name__ for view in player.views] == ["TouchWidget", "NumberWidget"]
        view = player.views[1]
        for seconds, value in ((3.05, 3.0), (0.55, 0.5)):
            player.time = seconds
            assert view.widget.number.value == value
        frames = list(view.track.frames(3.05, 3.35))
        assert [frame.seconds for frame in frames] == pytest.approx([3.0, 3.1, 3.2, 3.3])
        assert frames[0].about == {"unit": ""}
        assert frames[0].frame[-8:] == view.widget._pack(Number(3.0))
    finally:
        player.close()


def test_a_recording_feeds_them(path: Path) -> None:
    with feeds.recording(path, speed=20.0, loop=True) as feed:
        view = feed.show("/depth", "/level")
        wait_for(lambda: {"/depth", "/level"} <= view.widgets.keys(), "both widgets")
        # Until its first message shows its kind, a topic of texts is shown as events.
        wait_for(lambda: all(isinstance(one, NumberWidget) for one in view.widgets.values()), "their kinds")
        level = view.widgets["/level"]
        wait_for(lambda: level.number is not None and level.number.unit == "m", "a distance")
        values: list[float] = []
        feed.connect("/depth", lambda sample: values.append(sample.value))
        wait_for(lambda: len(values) > 3, "four samples")


def test_a_robot_feeds_them_the_undecided_ones_once_a_message_has_come() -> None:
    script = Scripted(DEPTH, LEVEL, NAME, SCAN)
    with Feed(script) as feed:
        view = feed.show()
        assert {name: type(widget).__name__ for name, widget in view.widgets.items()} == {
            "/scan": "LaserWidget", "/depth": "NumberWidget"
        }  # fmt: skip
        script.listener.on_message("/depth", {"data": 2.5})
        wait_for(lambda: view.widgets["/depth"].number == Number(2.5), "its widget shows it")
        script.listener.on_message("/level", {"data": "1.5 m"})
        script.listener.on_message("/name", {"data": "tank 2"})
        shown = {name: type(widget).__name__ for name, widget in view.widgets.items()}
        assert (shown["/level"], shown.get("/name")) == ("NumberWidget", None)
        script.listener.on_message("/depth", {"data": "deep"})
        wait_for(lambda: "error" in view.widgets["/depth"].get_state()["_about"], "its widget says so")


def test_without_its_row_the_topics_are_only_listed(path: Path) -> None:
    del KINDS[NUMBER.name]
    assert kind_of_type("std_msgs/msg/Float64") is None
    with robowidgets.open(path) as recording:
        assert {topic.name: topic.widget for topic in recording.topics} == {
            "/depth": None, "/level": None, "/name": None, "/cliff": "touch"
        }  # fmt: skip


def test_rerun_which_the_row_does_not_name_leaves_them_out(recording: Recording, tmp_path: Path) -> None:
    chunk = pytest.importorskip("rerun.chunk", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")
    written = chunk.RrdReader(recording.to_rerun(tmp_path / "numbers.rrd")).stream().collect().stream()
    entities = {piece.entity_path for piece in written}
    assert any("cliff" in entity for entity in entities)
    assert not any("depth" in entity or "level" in entity for entity in entities)


def test_an_action_of_a_machine_gets_them_if_they_have_a_default() -> None:
    class Tank:
        def filling(number=None): ...  # noqa: N805

        emptying = None
        moves = "filling -> emptying after 1"

    assert "number" in Machine(Tank).asks_for
