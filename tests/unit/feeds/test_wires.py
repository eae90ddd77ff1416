"""The wires of a feed: publishers, rates and values, the notebook's part, and the cost for the robot."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any

import pytest

from robowidgets import LaserWidget, WiresWidget, conditions, feeds
from robowidgets.behaviors import Drive
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.feeds._listening import MAX_TOPICS, Listening
from robowidgets.feeds._wires import FeedWires
from robowidgets.messages.infrastructure import is_infrastructure
from robowidgets.runtime.clock import Threads
from robowidgets.samples.staleness import SEEN_FOR
from robowidgets.widget.timed_frame import FRAME_HEADER
from robowidgets.wires_widget import NotebookPart, Wire

from ..clocks import ManualClock
from ..pages import Page, from_page, synced
from ..waiting import wait_for
from .scripted import Scripted, scan

NUMBER, IMAGE = "std_msgs/msg/Float64", "sensor_msgs/msg/Image"
LASER = Advert("/scan", "sensor_msgs/msg/LaserScan", True, True, ("/lidar",), ("/amcl", "/slam"))
SPEED = Advert("/cmd_vel", "geometry_msgs/msg/Twist", False, True, (), ("/base",))
CAMERA = Advert("/image", IMAGE, True, False, ("/camera",), ())
LOG = Advert("/rosout", "rcl_interfaces/msg/Log", True, False, ("/lidar", "/base"), ())


@pytest.fixture
def script() -> Scripted:
    return Scripted(LASER, SPEED, CAMERA, LOG)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


@pytest.fixture
def feed(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


@pytest.fixture
def wires(feed: Feed, clock: ManualClock) -> FeedWires:
    feed.connection.listening = Listening(feed.connection, Threads(clock))
    return FeedWires(feed.connection)


def wire(wires: FeedWires, name: str) -> Wire:
    return next(one for one in wires.wiring.wires if one.name == name)


def parts(wires: FeedWires, kind: str) -> list[NotebookPart]:
    return [part for part in wires.wiring.parts if part.kind == kind]


def ahead(sample: Any) -> float:
    return float(sample.distance())


def take(message: Any) -> None:
    del message


def test_nodes_and_topics_are_as_the_middleware_names_them(wires: FeedWires) -> None:
    wiring = wires.wiring
    assert wiring.nodes == ("/amcl", "/base", "/camera", "/lidar", "/slam")
    assert (wiring.tells_nodes, wiring.note) == (True, "")
    laser = wire(wires, "/scan")
    assert (laser.publishers, laser.subscribers) == (("/lidar",), ("/amcl", "/slam"))
    assert (wire(wires, "/cmd_vel").offered, wire(wires, "/cmd_vel").subscribers) == (False, ("/base",))


def test_a_robot_that_tells_no_nodes_shows_topics_alone_and_says_so(script: Scripted, wires: FeedWires) -> None:
    script.listener.on_topics([Advert("/scan", LASER.type)])
    assert (wires.wiring.nodes, wires.wiring.tells_nodes) == ((), False)
    assert wires.wiring.note == "the robot does not report nodes, only topics"
    script.listener.on_topics([LASER, Advert("/odom", "nav_msgs/msg/Odometry")])
    assert wires.wiring.note == "requesting publishers and subscribers: 1 of 2 topics so far"


def test_rates_and_values_come_while_a_page_looks_and_cost_nothing_after(
    script: Scripted, wires: FeedWires, clock: ManualClock
) -> None:
    assert (script.asked, script.asks_for_nodes) == ([], False)
    wires.look(True)
    clock.advance()
    # A picture is large: one look at it has to be enough. Topics that every node has are not worth a line.
    assert (set(script.asked), script.asks_for_nodes) == ({("subscribe", "/scan"), ("subscribe", "/image")}, True)
    for _ in range(11):
        script.listener.on_message("/scan", scan(0.9, 0.5))
        clock.advance(0.1)
    told = wire(wires, "/scan")
    assert (told.value, told.is_heard) == ("nearest 0.5 m, 2 rays", True)
    assert told.rate == pytest.approx(10, abs=0.1)
    assert told.age == pytest.approx(0.1)
    for _ in range(7):
        script.listener.on_message("/image", {"height": 480, "width": 640})
        clock.advance(0.05)
    image = wire(wires, "/image")
    assert (image.value, image.rate, image.age) == ("height 480, width 640", pytest.approx(20), pytest.approx(0.05))
    assert script.followed == {"/scan"}

    wires.look(False)
    clock.advance(1)
    assert (script.followed, script.asks_for_nodes) == (set(), False)
    seen: list[int] = []
    wires.observe(lambda: seen.append(1))
    clock.advance(60)
    assert seen == []


def test_a_page_that_has_gone_without_a_word_is_forgotten(
    script: Scripted, wires: FeedWires, clock: ManualClock
) -> None:
    wires.look(True)
    clock.advance(SEEN_FOR - 1)
    wires.look(True)
    clock.advance(SEEN_FOR - 1)
    assert ("unsubscribe", "/scan") not in script.asked
    clock.advance(2)
    assert script.followed == set()
    wires.look(True)
    clock.advance()
    assert "/scan" in script.followed


def test_some_of_many_topics_are_listened_to_in_addition_to_connected_ones(
    script: Scripted, feed: Feed, wires: FeedWires, clock: ManualClock
) -> None:
    script.listener.on_topics([CAMERA, *(Advert(f"/number_{i}", NUMBER) for i in range(200))])
    wires.look(True)
    clock.advance()
    assert len(script.asked) == MAX_TOPICS
    feed.connect("/image", take)
    clock.advance(1)
    assert ("subscribe", "/image") in script.asked
    assert len(script.followed) == MAX_TOPICS + 1
    script.listener.on_message("/number_0", {"data": -0.25})
    assert wire(wires, "/number_0").value == "\N{MINUS SIGN}0.25"


def test_a_topic_that_the_notebook_listens_to_anyway_is_counted_whatever_its_size(
    script: Scripted, feed: Feed, wires: FeedWires, clock: ManualClock
) -> None:
    feed.connect("/image", take)
    wires.look(True)
    clock.advance(1)
    script.listener.on_message("/image", {"height": 480, "width": 640, "encoding": "mono8", "data": bytes(1000)})
    assert wire(wires, "/image").value == "640×480 mono8"
    feed.disconnect("/image")
    clock.advance(1)
    assert script.followed == {"/scan"}


def test_the_notebooks_part_says_how_often_it_ran_and_what_it_got_and_gave(
    script: Scripted, feed: Feed, wires: FeedWires
) -> None:
    laser = LaserWidget()
    feed.connect("/scan", laser)
    laser.watch(conditions.nearest_below(0.6), "near")

    feed.connect("/scan", ahead)
    assert parts(wires, "function") == [NotebookPart("function", "ahead", ("/scan",), runs=0)]
    script.listener.on_message("/scan", scan(0.9, 0.5))
    said = NotebookPart("function", "ahead", ("/scan",), runs=1, got="nearest 0.5 m, 2 rays", gave="0.5")
    wait_for(lambda: parts(wires, "function") == [said], "the function ran")
    wait_for(lambda: parts(wires, "condition")[0].runs == 1, "the condition was judged")
    (condition,) = parts(wires, "condition")
    assert condition == NotebookPart(
        "condition", "near", ("/scan",), runs=1, got="nearest 0.5 m, 2 rays", gave="true: 0.50 < 0.60 m"
    )
    assert parts(wires, "widget") == [NotebookPart("widget", "LaserWidget", ("/scan",))]
    laser.close()


def test_a_function_that_raises_is_reported_with_its_line(script: Scripted, feed: Feed, wires: FeedWires) -> None:
    def fails(sample: Any) -> None:
        raise ValueError("no wall")

    feed.connect("/scan", fails)
    script.listener.on_message("/scan", scan(0.9, 0.5))
    wait_for(lambda: parts(wires, "function")[0].problem, "it is reported")
    assert "ValueError: no wall" in parts(wires, "function")[0].problem


def test_the_program_and_the_speeds_that_come_out_are_reported(script: Scripted, feed: Feed, wires: FeedWires) -> None:
    assert parts(wires, "program") == parts(wires, "speeds") == []

    @feed.program(on="/scan")
    def creep(scan: Any) -> Drive:
        return Drive(0.1 if scan.distance() > 0.4 else 0.0, 0.5)

    def runs() -> Any:
        script.listener.on_message("/scan", scan(0.9, 0.5))
        return parts(wires, "speeds")

    wait_for(runs, "it drives")
    wait_for(lambda: parts(wires, "program")[0].gave, "its step is over")
    (program,), (speeds,) = parts(wires, "program"), parts(wires, "speeds")
    assert (program.name, program.reads, program.drives) == ("creep", ("/scan",), True)
    assert (program.got, program.gave) == ("scan nearest 0.5 m, 2 rays", "0.1 m/s, 0.5 rad/s")
    assert (speeds.writes, speeds.gave) == (("/cmd_vel",), "0.1 m/s, 0.5 rad/s")
    assert (speeds.runs or 0) >= 1
    creep.close()
    assert parts(wires, "program") == []


def test_a_topic_that_only_the_notebook_names_is_there_too(feed: Feed, wires: FeedWires) -> None:
    feed.connect("/missing", take)
    assert wire(wires, "/missing").offered is False


@pytest.mark.parametrize(
    ("name", "is_one"),
    [
        ("/rosout", True),
        ("/robot1/rosout", False),
        ("/parameter_events", True),
        ("/arm/move/_action/feedback", True),
        ("/camera/_raw", True),
        ("/planner/transition_event", True),
        ("/rosout_agg", True),
        ("/scan", False),
        ("/tf", False),
        ("/my_action/feedback", False),
    ],
)
def test_infrastructure_is_reported_by_the_name(name: str, is_one: bool) -> None:
    assert is_infrastructure(name) is is_one


def test_the_page_gets_all_of_it_in_a_frame_without_what_is_not_known(script: Scripted, feed: Feed) -> None:
    widget = feed.wires().wires
    page = Page(widget)
    script.listener.on_message("/scan", scan(0.9, 0.5))

    def told() -> dict[str, Any]:
        found: dict[str, Any] = json.loads(page.state["_frame"][FRAME_HEADER.size :])
        return found

    wait_for(
        lambda: "value" in told()["wires"][0] or script.listener.on_message("/scan", scan(0.9, 0.5)), "it is reported"
    )
    first, speeds, *_ = told()["wires"]
    assert told()["nodes"] == ["/amcl", "/base", "/camera", "/lidar", "/slam"]
    assert (first["name"], first["from"], first["to"], first["value"]) == (
        "/scan",
        [3],
        [0, 4],
        "nearest 0.5 m, 2 rays",
    )
    assert speeds.keys() == {"name", "type", "from", "to", "heard", "plumbing", "offered", "wanted"}
    assert page.state["title"] == "the script"
    assert {*page.threads} <= {"robowidgets-pacer"}
    widget.close()
    wait_for(lambda: not script.followed, "nothing is listened to any more")


def test_a_page_says_that_it_looks_and_opens_the_messages_of_a_topic(script: Scripted, feed: Feed) -> None:
    view = feed.wires()
    widget = view.wires
    wait_for(lambda: script.followed == {"/scan"}, "it listens")
    from_page(widget, {"look": False})
    wait_for(lambda: script.followed == frozenset(), "it does not listen")
    from_page(widget, {"look": True})
    from_page(widget, {"open": "/image"})
    wait_for(lambda: script.followed == {"/scan", "/image"}, "it listens to what was opened")
    message = view.messages["/image"]
    script.listener.on_message("/image", {"height": 480, "width": 640})
    assert message["height"] == 480
    assert view.children == (widget, message)

    def is_told() -> bool:
        script.listener.on_message("/image", {"height": 480, "width": 640})
        return view.wires._wired.wiring.wires[2].value == "height 480, width 640"

    wait_for(is_told, "it is reported there, too")
    for nonsense in ("/none", 3, None):
        from_page(widget, {"open": nonsense, "look": nonsense})
    from_page(widget, "nonsense")
    assert list(view.messages) == ["/image"]
    from_page(widget, {"open": "/image"})
    assert (view.messages, view.children) == ({}, (widget,))
    wait_for(lambda: script.followed == {"/scan"}, "it does not listen to that any more")
    view.toggle("/image")
    view.close()
    wait_for(lambda: script.followed == frozenset(), "nothing is listened to")
    assert feed.connection.widgets == ()


def test_a_closed_feed_ends_it_in_words(feed: Feed) -> None:
    widget = feed.wires().wires
    feed.close()
    wait_for(lambda: synced(widget, "_source")["status"] == "the feed is closed", "it is reported")
    with pytest.raises(FeedError, match="is closed: open it again"):
        feed.wires()
    widget.close()


def test_a_feed_reports_that_it_is_closed_while_it_closes(feed: Feed, monkeypatch: pytest.MonkeyPatch) -> None:
    """A view updates for the last time as soon as the feed is closed, which may be before its connection is."""
    seen, close = [], feed.connection.middleware.close
    monkeypatch.setattr(feed.connection.middleware, "close", lambda: (seen.append(feed.status), close()))
    feed.close()
    assert seen == ["the feed is closed"]


def test_an_invalid_source_and_an_unknown_keyword_are_refused(feed: Feed) -> None:
    with pytest.raises(TypeError, match=r"expected the source that feed\.wires\(\) or recording\.wires\(\) uses"):
        WiresWidget(feed)
    with pytest.raises(TypeError, match="did you mean 'infrastructure'"):
        feed.wires(infrastructur=True)


def test_the_simulated_robot_is_a_node() -> None:
    with feeds.simulator(wander=False) as robot:
        widget = robot.wires().wires
        wiring = widget.wait()
        assert wiring.nodes == ("/simulated_robot",)
        assert repr(wiring) == "<1 node, 4 topics, 0 parts of the notebook>"
        widget.close()
