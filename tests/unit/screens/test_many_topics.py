"""A kind whose topics share a widget by namespace follows from its row, like a kind of a single topic."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

import robowidgets
from robowidgets import RecordingError, feeds
from robowidgets.behaviors import Drive
from robowidgets.behaviors.simulation import simulate
from robowidgets.feeds import Advert, Feed
from robowidgets.recording import Recording
from robowidgets.simulator import Robot, World

from ...more_rows.gauges import FLOAT64, GAUGE, GaugesWidget, Numbers, added
from ..feeds.scripted import SCAN, Scripted
from ..pages import synced
from ..recordings import recorded
from ..waiting import wait_for

TOPICS = ("/tank/left", "/tank/right")
LEFT, RIGHT = (Advert(name, FLOAT64) for name in TOPICS)
SPARE = Advert("/spare/left", FLOAT64)


@pytest.fixture(autouse=True)
def _gauges() -> Iterator[None]:
    with added():
        yield


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Two seconds: number i of the left is i, from 0.5 s on at the same times number i of the right is -i."""
    drive = ((i / 10 + late, name, {"data": sign * float(i)}) for i in range(20) for name, sign, late in SENSORS)
    here = ((seconds, name, data) for seconds, name, data in drive if name == TOPICS[0] or seconds > 0.5)
    return recorded.write(tmp_path_factory.mktemp("gauges") / "drive", dict.fromkeys(TOPICS, FLOAT64), here)


SENSORS = ((TOPICS[0], 1, 0.0), (TOPICS[1], -1, 0.004))


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def test_a_player_shows_all_of_a_namespace_in_one_widget_at_any_time(recording: Recording) -> None:
    player = recording.show()
    try:
        (view,) = player.views
        assert isinstance(view.widget, GaugesWidget)
        assert view.widget.title == "/tank"
        assert "/tank" in repr(player)
        assert view.choice.topics == TOPICS
        player.time = 1.15
        shown = view.widget.gauges
        assert {name: number.value for name, number in shown.items()} == {"left": 11.0, "right": -11.0}
        assert shown.seconds == pytest.approx({"left": 1.1, "right": 1.104})
        player.time = 0.25
        assert view.widget.gauges["left"].value == 2.0
        assert view.widget.gauges.seconds["right"] == float("-inf"), "it has no message yet"
    finally:
        player.close()


def test_sensors_that_measure_at_once_share_a_frame(recording: Recording) -> None:
    player = recording.show()
    try:
        (view,) = player.views
        frames = list(view.track.frames(1.0, 1.3))
        assert [frame.seconds for frame in frames] == pytest.approx([1.0, 1.004, 1.104, 1.204])
        assert [frame.frame[-16:] for frame in frames[1:]] == [
            view.widget._pack(Numbers({"left": GAUGE.sample(i), "right": GAUGE.sample(-i)})) for i in (10, 11, 12)
        ]
        assert frames[0].about == {"sensors": ["left", "right"]}
        assert [frame.seconds for frame in view.track.frames(1.002, 1.1)] == pytest.approx([1.0, 1.004])
    finally:
        player.close()


def test_a_function_finds_by_all_of_them_once_each_is_there(recording: Recording) -> None:
    spans = recording.find(lambda gauges: gauges["left"].value - gauges["right"].value < 14)
    assert [(span.start, span.end) for span in spans] == [(pytest.approx(0.504), pytest.approx(0.704))]
    again = recording.find(lambda moment: moment.gauges.seconds["left"] > 1.5)
    assert again[0].start == pytest.approx(1.6)
    one = recording.find(lambda moment: moment.gauge.value > 18, topics=TOPICS[0])
    assert one[0].start == pytest.approx(1.9)
    with pytest.raises(RecordingError, match=r"no 'volumes' here: there are scan, speed, touch, .*gauge, gauges"):
        recording.find(lambda moment: moment.volumes)


def test_a_view_of_a_robot_gives_later_topics_of_the_namespace_to_the_same_widget() -> None:
    script = Scripted(SCAN, LEFT)
    with Feed(script) as feed:
        view = feed.show()
        widget = view.widgets["/tank/left"]
        assert widget.title == "/tank/left"
        script.listener.on_topics([SCAN, LEFT, SPARE, RIGHT])
        assert list(view.widgets) == ["/scan", "/tank/left", "/tank/right", "/spare/left"]
        assert view.widgets["/tank/right"] is widget
        assert view.widgets["/spare/left"] is not widget
        assert repr(view) == "<FeedView: /scan, /tank, /spare/left>"
        for number, advert in enumerate((LEFT, RIGHT), start=1):
            script.listener.on_message(advert.name, {"data": number})
        wait_for(lambda: widget.gauges is not None and len(widget.gauges) == 2, "it shows both")
        assert [number.value for number in widget.gauges.values()] == [1.0, 2.0]
        assert (widget.title, synced(widget, "_source")["topic"]) == ("/tank", "/tank/left")
        view.close()
        assert {topic for what, topic in script.asked if what == "unsubscribe"} == {t for _, t in script.asked}


def test_the_user_connects_its_topics_as_for_any_widget() -> None:
    script = Scripted(LEFT, RIGHT)
    with Feed(script) as feed:
        widget = GaugesWidget()
        feed.connect("/tank/left", widget)
        feed.connect("/tank/right", widget.update)
        script.listener.on_message("/tank/right", {"data": 3})
        wait_for(lambda: widget.gauges == {"right": GAUGE.sample(3.0)}, "it shows the one")
        feed.disconnect("/tank/right", widget)
        for advert in (RIGHT, LEFT):
            script.listener.on_message(advert.name, {"data": 4})
        wait_for(lambda: "left" in widget.gauges, "it shows the other")
        assert widget.gauges["right"].value == 3.0


def test_two_topics_with_one_name_of_a_sensor_do_not_share_a_widget() -> None:
    with Feed(Scripted(LEFT, SPARE)) as feed:
        widget = GaugesWidget()
        feed.connect("/tank/left", widget)
        feed.connect("/tank/left", widget)
        with pytest.raises(
            ValueError, match=r"connect\('/spare/left'\): the widget has a sensor 'left', from /tank/left"
        ):
            feed.connect("/spare/left", widget)
        assert widget.title == "/tank/left"


def test_the_class_of_a_user_that_shows_them_is_called_as_functions_are() -> None:
    class Mine(GaugesWidget):
        def update(self, sensor: object, message: object = None) -> None:
            super().update(f"my {sensor}", message)

    script = Scripted(LEFT)
    with Feed(script) as feed:
        feed.connect("/tank/left", mine := Mine())
        assert [function.topic for function in feed.functions] == ["/tank/left"]
        script.listener.on_message("/tank/left", {"data": 3})
        wait_for(lambda: mine.gauges == {"my left": GAUGE.sample(3.0)}, "it is called with the name")


def test_a_program_gets_all_of_them_and_waits_for_each() -> None:
    script = Scripted(LEFT, RIGHT)
    with Feed(script) as feed:
        got: list[Numbers] = []

        @feed.program(rate=100)
        def look(gauges: Numbers) -> Drive | None:
            got.append(gauges)
            return None

        script.listener.on_message("/tank/left", {"data": 1})
        wait_for(lambda: look.waiting == "waiting for /tank/right", "it says which is missing")
        assert not got
        script.listener.on_message("/tank/right", {"data": 2})
        wait_for(lambda: got, "it steps")
        assert got[0] == {"left": GAUGE.sample(1.0), "right": GAUGE.sample(2.0)}
        assert got[0].seconds["left"] < got[0].seconds["right"]
        wait_for(lambda: "any more" in look.waiting, "they are old")
        assert look.waiting.startswith("no gauge comes on /tank/")


def test_a_program_names_one_of_several_namespaces_or_a_topic() -> None:
    script = Scripted(LEFT, RIGHT, SPARE)
    with Feed(script) as feed:

        def look(gauges: Numbers) -> None:
            got.append(dict(gauges))

        got: list[dict[str, object]] = []
        program = feed.program(look, rate=100)
        several = "2 namespaces have gauges: /tank, /spare; name one: program(gauges='/tank')"
        wait_for(lambda: program.waiting == several, "it says that there are several")
        for advert in (LEFT, RIGHT, SPARE):
            script.listener.on_message(advert.name, {"data": 1})
        feed.program(look, rate=100, gauges="/spare")
        for advert in (LEFT, RIGHT, SPARE):
            script.listener.on_message(advert.name, {"data": 2})
        wait_for(lambda: got, "it steps")
        assert list(got[0]) == ["left"]
        got.clear()
        program = feed.program(look, rate=100, gauges="/nothing")
        wait_for(lambda: program.waiting == "waiting for a topic with gauges in /nothing", "it waits for that")
        feed.program(look, rate=100, gauges="/tank/right")
        script.listener.on_message("/tank/right", {"data": 3})
        wait_for(lambda: got, "it steps")
        assert got[0] == {"right": GAUGE.sample(3.0)}


def test_a_recorder_writes_what_the_row_makes_of_their_samples(path: Path, tmp_path: Path) -> None:
    with feeds.recording(path, loop=True) as feed, feed.record(tmp_path / "again.mcap") as recorder:
        wait_for(lambda: all(recorder.written[name] for name in TOPICS), "both are written")
    assert recorder.problems == ()
    with robowidgets.open(tmp_path / "again.mcap") as again:
        assert {topic.name: topic.widget for topic in again.topics} == dict.fromkeys(TOPICS, "gauge")


@pytest.mark.parametrize("process", [False, pytest.param(True, marks=pytest.mark.slow)])
def test_the_simulated_robot_sends_what_the_row_offers(process: bool) -> None:
    with feeds.simulator(wander=False, process=process) as feed:
        view = feed.show(*TOPICS)
        widget = view.widgets["/tank/right"]
        wait_for(lambda: widget.gauges is not None and len(widget.gauges) == 2, "both have come")
        x, y, _ = feed.robot.pose
        assert [number.value for number in widget.gauges.values()] == [x, y]


def test_a_simulated_program_gets_them_as_one_of_a_robot_does() -> None:
    robot = Robot(World.rooms(), seed=1)
    got: list[Numbers] = []
    steps = list(simulate(lambda gauges: got.append(gauges), robot, 0.2, rate=10))
    assert len(steps) == len(got) == 2
    assert [number.value for number in got[0].values()] == [*robot.pose[:2]]
    assert got[1].seconds["left"] == pytest.approx(0.1)
