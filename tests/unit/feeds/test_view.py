"""A feed on the page."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from math import nan
from typing import Any

import pytest

from robowidgets import LaserWidget, MessageWidget, PathWidget, PlotWidget, Speed, SpeedWidget, TouchWidget, feeds
from robowidgets.behaviors import Drive
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.feeds._feed_view import FeedView
from robowidgets.kinds.choice import choose_widgets
from robowidgets.samples import Pose
from robowidgets.stop_widget import StopWidget
from robowidgets.topics_widget import TopicsWidget
from robowidgets.wires_widget import WiresWidget

from ..pages import display, from_page, synced, widgets_by_place
from ..waiting import wait_for
from .scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan, set_discovery_timeout, twist

BUMPER = Advert("/bumper", "kobuki_msgs/msg/BumperEvent")

Opened = Callable[..., tuple[Feed, Scripted]]


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[Opened]:
    """Opens feeds on a script, with a short wait for subscribers that never come, and closes them."""
    set_discovery_timeout(monkeypatch, 0.02)
    there: list[Feed] = []

    def open_one(*topics: Advert, connected: bool = True) -> tuple[Feed, Scripted]:
        script = Scripted(*topics, connected=connected)
        there.append(Feed(script))
        return there[-1], script

    yield open_one
    for feed in there:
        feed.close()


def words(view: FeedView) -> str:
    return "\n".join(view.notes)


def on_page(view: FeedView) -> list[str]:
    """The titles of the pictures, from top to bottom."""
    return [widget.title for widget in view.children if not isinstance(widget, (StopWidget, TopicsWidget))]


def test_every_topic_that_can_be_shown_gets_its_widget(opened: Opened) -> None:
    feed, script = opened(ODOM, IMU, BUMPER, CMD_VEL, SCAN)
    view = feed.show()
    kinds = {"/scan": LaserWidget, "/odom": SpeedWidget, "/bumper": TouchWidget}
    assert view.widgets.keys() == kinds.keys()
    assert all(isinstance(widget, kinds[name]) for name, widget in view.widgets.items())
    assert on_page(view) == ["/odom", "/odom", "/bumper", "/scan"], "the path, then the bars below it"
    assert repr(view) == "<FeedView: /scan, /odom, /bumper>"
    assert view.widgets["/odom"].command_title == "/cmd_vel"
    assert words(view) == ""
    script.listener.on_message("/scan", scan(1.5))
    script.listener.on_message("/odom", Speed((0.2, 0, 0), (0, 0, 0), pose=Pose(1.5, 0.0, 0.0)))
    script.listener.on_message("/cmd_vel", twist(0.3))
    assert view.widgets["/scan"].scan.ranges[0] == 1.5
    assert view.widgets["/odom"].speed.linear[0] == 0.2
    assert view.widgets["/odom"].commanded.linear[0] == 0.3
    (path,) = [widget for widget in view.children if isinstance(widget, PathWidget)]
    assert path.pose is not None
    assert path.pose.x == 1.5


def test_topics_that_appear_later_get_a_widget_too(opened: Opened) -> None:
    feed, script = opened(connected=False)
    view = feed.show()
    assert words(view) == "connecting to the script"
    script.listener.on_lost("refused", 1.0)
    assert words(view) == "cannot reach the script, trying again in 1 s: refused"
    script.listener.on_connected()
    assert words(view) == ("connected to the script, waiting for its topics; connect() accepts any name")
    script.listener.on_topics([])
    assert words(view) == "connected to the script, which has no topics yet"
    script.listener.on_topics([IMU])
    assert on_page(view) == ["/imu"], "as no topic has a widget for its kind"
    assert words(view) == ""
    script.listener.on_topics([IMU, SCAN])
    assert on_page(view) == ["/scan"]
    assert words(view) == ""
    laser = view.widgets["/scan"]
    script.listener.on_topics([SCAN, BUMPER])
    assert on_page(view) == ["/scan", "/bumper"]
    assert view.widgets["/scan"] is laser
    script.listener.on_topics([])
    assert on_page(view) == ["/scan", "/bumper"]


def test_a_commanded_speed_that_comes_first_joins_the_measured_one(opened: Opened) -> None:
    feed, script = opened(CMD_VEL)
    view = feed.show()
    assert on_page(view) == ["/cmd_vel"]
    script.listener.on_topics([CMD_VEL, ODOM])
    assert on_page(view) == ["/odom", "/odom"]
    script.listener.on_message("/cmd_vel", twist(0.3))
    assert view.widgets["/odom"].commanded.linear[0] == 0.3


def test_named_topics_get_widgets_when_they_appear_and_others_do_not(opened: Opened) -> None:
    feed, script = opened(ODOM, IMU)
    view = feed.show("/odom", "/scna", "/imu")
    assert on_page(view) == ["/odom", "/odom", "/imu"]
    assert words(view) == "no such topic /scna; there are /odom, /imu"
    script.listener.on_topics([ODOM, IMU, SCAN, SCAN._replace(name="/scna")])
    assert sorted(on_page(view)) == ["/imu", "/odom", "/odom", "/scna"]
    assert words(view) == ""


def test_a_number_in_a_message_is_plotted_when_the_page_asks_for_it(opened: Opened) -> None:
    feed, script = opened(ODOM, IMU)
    view = feed.show("/imu as message")
    (message,) = view.widgets.values()
    assert isinstance(message, MessageWidget)
    assert synced(message, "_plots")
    from_page(message, {"plot": "angular_velocity.z"})
    (plot,) = [widget for widget in view.children if isinstance(widget, PlotWidget)]
    script.listener.on_message("/imu", {"angular_velocity": {"z": 0.25}})
    assert plot.names == ("/imu.angular_velocity.z",)
    assert plot["/imu.angular_velocity.z"][1].tolist() == [0.25]
    assert message["angular_velocity.z"] == 0.25
    from_page(message, {"plot": 3})
    from_page(message, "plot")


def test_the_list_of_topics_shows_the_wires_below_the_rest_which_open_messages_on_the_screen(opened: Opened) -> None:
    feed, _ = opened(ODOM, SCAN)
    view = feed.show("/scan")
    from_page(view.topic_list, {"toggle": "the wires", "on": True})
    assert view.children[-1] is view.wires
    assert isinstance(view.wires, WiresWidget)
    assert [wire.name for wire in view.wires.wait().wires] == ["/odom", "/scan"]
    for _ in range(2):  # again, too
        from_page(view.wires, {"open": "/odom"})
        assert isinstance(view.widgets["/odom"], MessageWidget)
        from_page(view.wires, {"open": "/odom"})
        assert list(view.widgets) == ["/scan"]
    wires = view.wires
    view.topic_list.wires = False
    assert (view.wires, wires.comm) == (None, None)
    assert on_page(view) == ["/scan"]
    view.topic_list.wires = True
    wires = view.wires
    view.close()
    assert wires.comm is None


def test_a_program_and_its_machine_are_shown_from_the_first_on_and_the_machine_freezes_with_the_sensors(
    opened: Opened,
) -> None:
    feed, _ = opened(SCAN, CMD_VEL)
    view, named = feed.show(), feed.show("/scan")

    @feed.program
    def still() -> Drive:
        return Drive()

    program = view.program
    assert program is not None
    assert program.program is still
    assert view.machine is None

    class Walker:
        forward = turn = None
        moves = "forward -> turn after 2", "turn -> forward after 1"

    feed.program(Walker)
    machine, laser = view.machine, view.widgets["/scan"]
    assert machine is not None
    assert machine.title == "Walker"
    assert view.program is program
    assert program.program is not still
    laser.paused = True
    assert machine.paused
    assert synced(machine, "_together") == synced(laser, "_source")["robot"], (
        "the page freezes it with widgets elsewhere, too"
    )
    assert (named.program, named.machine) == (None, None)
    later = feed.show()
    assert later.program is not None
    assert later.machine is not None
    view.close()
    assert machine.comm is None
    assert program.comm is None


def places(view: FeedView) -> dict[str, list[str]]:
    """The places of the pictures, with the classes of the widgets in them."""
    others = ("bar", "topics", "foot")
    return {place: names for place, names in widgets_by_place(view).items() if place not in others}


def test_a_simulated_robot_is_shown_in_its_room_which_makes_way_for_a_machine() -> None:
    with feeds.simulator(wander=False) as feed:
        view, named = feed.show(), feed.show("/scan", "/odom")
        low = ["SpeedWidget", "TouchWidget"]
        assert places(view) == {"mains": ["View"], "smalls": low, "wides": ["LaserWidget"]}
        assert places(named) == {"mains": ["PathWidget"], "smalls": low[:1], "wides": ["LaserWidget"]}
        assert named.room is None
        path = {type(widget).__name__ for widget in view.widgets["/scan"]._group}
        assert "PathWidget" in path, "a trail of the laser is placed by it"

        @feed.program
        def still() -> Drive:
            return Drive()

        assert places(view)["mains"] == ["View", "ProgramWidget"]
        assert view.children[-1] is view.lines
        assert view.lines.folded

        class Walker:
            forward = turn = None
            moves = "forward -> turn after 2", "turn -> forward after 1"

        feed.program(Walker)
        assert places(view) == {
            "mains": ["ProgramWidget", "MachineWidget"],
            "smalls": low,
            "wides": ["View", "LaserWidget"],
        }
        room = view.room
        assert room is not None
        view.close()
        assert room.comm is None


def test_a_closed_widget_is_left_out_and_disturbs_nothing(opened: Opened) -> None:
    feed, script = opened(SCAN, ODOM)
    view = feed.show()
    view.widgets["/scan"].close()
    script.listener.on_topics([SCAN, ODOM, BUMPER])
    assert on_page(view) == ["/odom", "/odom", "/bumper"]
    view.widgets["/bumper"].close()
    view.close()
    assert view.comm is None


def test_speeds_are_planar_while_the_other_axes_are_zero_unless_set_otherwise(opened: Opened) -> None:
    feed, script = opened(ODOM, CMD_VEL)
    view, by_hand = feed.show(), feed.show()
    flat, climbing = Speed((0.2, 0.1, 0), (0, 0, 0.5)), Speed((0.2, 0, 0.01), (0, 0, 0))
    script.listener.on_message("/odom", flat)
    by_hand.widgets["/odom"].planar = False
    by_hand.widgets["/odom"].planar = True
    assert view.widgets["/odom"].planar
    script.listener.on_message("/odom", Speed((0.2, 0, nan), (nan, nan, 0.5)))
    assert view.widgets["/odom"].planar, "an axis without a value is not in use"
    script.listener.on_message("/odom", climbing)
    assert not view.widgets["/odom"].planar
    assert by_hand.widgets["/odom"].planar
    view.widgets["/odom"].planar = True
    script.listener.on_message("/odom", climbing)
    assert view.widgets["/odom"].planar, "now the user owns it"
    commanded = feed.show()
    script.listener.on_message("/cmd_vel", climbing)
    assert not commanded.widgets["/odom"].planar


def test_the_bar_freezes_the_group_of_the_view(opened: Opened) -> None:
    feed, script = opened(SCAN)
    view, empty = feed.show(), feed.show("/odom")
    bar, laser = view.children[0], view.widgets["/scan"]
    assert synced(bar, "_together") == synced(laser, "_together") != ""
    assert synced(empty.children[0], "_together") == ""
    script.listener.on_topics([SCAN, BUMPER])
    assert synced(bar, "_together") == synced(laser, "_together") == synced(view.widgets["/bumper"], "_together")


def test_types_of_unknown_names_are_known_from_their_first_message(opened: Opened) -> None:
    ours = [SCAN._replace(name=f"/{name}", type=f"my_msgs/msg/{name}") for name in ("scan", "cmd", "state")]
    sonars = [Advert(name, "sensor_msgs/msg/Range") for name in ("/sonar", "/cliff")]
    feed, script = opened(*ours, *sonars, IMU, Advert("/untyped", ""))
    view = feed.show()
    assert on_page(view) == ["/imu"], "whose type is known"
    assert {topic for _, topic in script.asked} == {"/scan", "/cmd", "/state", "/sonar", "/cliff", "/imu"}
    script.listener.on_message("/state", {"ready": True})
    script.listener.on_message("/scan", scan(1.5))
    script.listener.on_message("/cmd", {"header": {}, "twist": twist(0.5)})
    script.listener.on_message("/sonar", {"range": 1.0, "min_range": 0.1, "max_range": 4.0, "radiation_type": 0})
    script.listener.on_message("/cliff", {"range": float("inf"), "min_range": 0.1, "max_range": 0.1})
    assert on_page(view) == ["/scan", "/sonar", "/cmd", "/cliff"]
    script.listener.on_message("/sonar", {"range": 1.5, "min_range": 0.1, "max_range": 4.0, "radiation_type": 0})
    assert view.widgets["/sonar"].ranges["sonar"].distance == 1.5
    assert ("unsubscribe", "/state") in script.asked
    script.listener.on_message("/scan", scan(2.5))
    assert view.widgets["/scan"].scan.ranges[0] == 2.5
    script.listener.on_topics([*ours, *sonars, Advert("/late", "my_msgs/msg/Late")])
    view.close()
    assert script.asked[-1][0] == "unsubscribe"
    assert {topic for what, topic in script.asked if what == "unsubscribe"} == {t for _, t in script.asked}


def test_texts_of_others_are_not_markup(opened: Opened) -> None:
    feed, script = opened(connected=False)
    view = feed.show()
    script.listener.on_lost("<img src=x onerror=alert(1)>", 1.0)
    assert "<img" in words(view), "the page shows it as plain text"


def test_a_connection_that_is_lost_is_reported_by_the_widgets_themselves(opened: Opened) -> None:
    feed, script = opened(SCAN)
    view = feed.show()
    script.listener.on_lost("refused", 1.0)
    assert words(view) == ""
    assert synced(view.widgets["/scan"], "_source")["status"] == "connection lost, trying again in 1 s: refused"


def test_the_cell_of_a_view_next_to_the_notebook_shows_a_bar_which_is_closed_with_the_view(opened: Opened) -> None:
    feed, _ = opened(SCAN)
    shown = "application/vnd.jupyter.widget-view+json"
    here, view = feed.show(), feed.show(beside=True)
    assert display(here)[shown]["model_id"] == here.model_id
    bar = view._bar
    assert bar is not None
    data = display(bar)
    assert display(view) == data
    assert data[shown]["model_id"] == bar.model_id
    assert synced(bar, "_view") == view.model_id
    view.close()
    assert bar.comm is None
    with pytest.raises(TypeError, match="beside: expected True or False, got 'right'"):
        feed.show("/scan", beside="right")  # type: ignore[arg-type]


def test_showing_waits_for_the_first_topics(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    set_discovery_timeout(monkeypatch, 240.0)
    feed, script = opened()
    threading.Timer(0.05, lambda: script.listener.on_topics([SCAN])).start()
    assert on_page(feed.show()) == ["/scan"]


def test_a_view_that_is_closed_leaves_the_feed_open_and_its_topics_alone(opened: Opened) -> None:
    feed, script = opened(SCAN, ODOM, CMD_VEL)
    view, other = feed.show(), feed.show("/scan")
    view.close()
    view.close()
    assert view.widgets == {}
    assert {*script.asked[-2:]} == {("unsubscribe", "/odom"), ("unsubscribe", "/cmd_vel")}
    script.listener.on_message("/scan", scan(2.5))
    assert other.widgets["/scan"].scan.ranges[0] == 2.5
    script.listener.on_topics([SCAN, ODOM, BUMPER])
    assert view.widgets == {}


def test_a_closed_view_is_not_brought_up_to_date_when_it_is_closed_again(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, _ = opened(SCAN)
    view = feed.show()
    view.close()
    listed: list[object] = []
    monkeypatch.setattr(view.topic_list, "set_rows", listed.append)
    view.close()  # as ipywidgets does when Python exits
    assert not listed


def test_a_feed_that_is_closed_while_its_topics_come_puts_up_nothing(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = opened()
    view = feed.show()
    monkeypatch.setattr(
        "robowidgets.feeds._feed_view.choose_widgets", lambda *asked: (feed.close(), choose_widgets(*asked))[1]
    )
    script.listener.on_topics([SCAN])
    assert script.asked == []
    assert words(view) == "the feed is closed"


def test_a_closed_feed_reports_it_if_there_is_no_widget(opened: Opened) -> None:
    feed, _ = opened()
    view = feed.show()
    feed.close()
    assert words(view) == "the feed is closed"
    with pytest.raises(FeedError, match="the feed of the script is closed: open it again"):
        feed.show()
    with pytest.raises(TypeError, match=r"expected the name of a topic as text, got \['/scan'\]"):
        feed.show(["/scan"])  # type: ignore[arg-type]


def test_a_topic_with_unreadable_messages_that_would_decide_its_widget_is_reported(opened: Opened) -> None:
    feed, script = opened(SCAN, Advert("/range", "sensor_msgs/msg/Range"))
    view = feed.show()
    script.listener.on_trouble("/range", "a message of /range cannot be read: 3 bytes are too few")
    assert words(view) == "a message of /range cannot be read: 3 bytes are too few"
    script.listener.on_trouble("/range", "")
    assert words(view) == ""


def test_no_thread_that_may_carry_speeds_builds_widgets(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    feed, script = opened(ODOM)
    view = feed.show()
    builders: list[str] = []
    goes_on = threading.Event()

    def choose(*asked: Any) -> Any:
        builders.append(threading.current_thread().name)
        assert goes_on.wait(120)
        return choose_widgets(*asked)

    monkeypatch.setattr("robowidgets.feeds._feed_view.choose_widgets", choose)
    for what in (lambda: script.listener.on_topics([ODOM, SCAN]), feed.connection.on_driving):
        thread = threading.Thread(target=what, name="guard", daemon=True)
        thread.start()
        thread.join(60)
        assert not thread.is_alive(), "it waits for widgets"
    goes_on.set()
    wait_for(lambda: on_page(view) == ["/odom", "/odom", "/scan"], "they are there all the same")
    assert {*builders} == {"robowidgets-changes"}
