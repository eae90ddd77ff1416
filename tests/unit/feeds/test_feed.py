"""A feed: topics, connections, status, closing."""

from __future__ import annotations

import gc
import logging
import os
import signal
import subprocess
import sys
import threading
import tracemalloc
import weakref
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import pytest

from robowidgets import DriveWidget, LaserWidget, Scan, SpeedWidget, feeds
from robowidgets.feeds import Advert, Feed, FeedError
from robowidgets.feeds._open_feeds import open_feeds

from ..pages import display_html
from ..waiting import threads_named, wait_for
from .scripted import CMD_VEL, IMU, ODOM, SCAN, Scripted, scan, twist

Opened = Callable[..., tuple[Feed, Scripted]]


@pytest.fixture
def opened() -> Iterator[Opened]:
    """Opens feeds on a script, and closes them."""
    there: list[Feed] = []

    def open_one(*topics: Advert, connected: bool = True) -> tuple[Feed, Scripted]:
        script = Scripted(*topics, connected=connected)
        there.append(Feed(script))
        return there[-1], script

    yield open_one
    for feed in there:
        feed.close()


def source(widget: LaserWidget | SpeedWidget) -> dict[str, str]:
    """The status of a widget, without the random name of its robot."""
    return {name: value for name, value in widget.get_state()["_source"].items() if name != "robot"}


def in_a_thread(call: Callable[[], object]) -> None:
    """Call as a middleware does: errors there do not reach the user."""
    thread = threading.Thread(target=call)
    thread.start()
    thread.join(120)
    assert not thread.is_alive()


# -- topics ------------------------------------------------------------------------------------------------------------


def test_a_feed_prints_as_a_table_of_its_topics(opened: Opened) -> None:
    feed, _ = opened(SCAN, CMD_VEL, IMU)
    assert [topic.name for topic in feed.topics] == ["/scan", "/cmd_vel", "/imu"]
    assert [topic.widget for topic in feed.topics] == ["laser", "speed", None]
    head, heads, first, second, third = repr(feed).splitlines()
    assert head == "the script: 3 topics"
    assert heads.split() == ["topic", "type", "published", "heard", "widget"]
    assert first.split() == ["/scan", "sensor_msgs/msg/LaserScan", "yes", "no", "laser"]
    assert second.split() == ["/cmd_vel", "geometry_msgs/msg/Twist", "no", "yes", "speed", "(commanded)"]
    assert third.split() == ["/imu", "sensor_msgs/msg/Imu", "yes", "no"]


def test_a_table_holds_no_markup_of_others(opened: Opened) -> None:
    feed, _ = opened(Advert("/<b>", "<script>"))
    assert '<td style="text-align:left">/&lt;b&gt;</td>' in display_html(feed)
    assert "<script>" not in display_html(feed)


def test_a_table_says_what_is_wrong_with_the_connection(opened: Opened) -> None:
    feed, script = opened(connected=False)
    assert repr(feed).splitlines() == ["the script: 0 topics", "! connecting to the script"]
    script.listener.on_connected()
    assert repr(feed) == "the script: 0 topics"


# -- connecting --------------------------------------------------------------------------------------------------------


def test_a_topic_goes_to_any_number_of_widgets_and_functions(opened: Opened) -> None:
    feed, script = opened(SCAN)
    one, other = LaserWidget(), LaserWidget(title="mine")
    got: list[Scan] = []
    feed.connect("/scan", one, other)
    feed.connect("/scan", got.append)
    feed.connect("/scan", one)
    script.listener.on_message("/scan", scan(1.5))
    assert one.scan is not None
    assert one.scan.ranges[0] == other.scan.ranges[0] == 1.5  # type: ignore[union-attr]
    wait_for(lambda: [sample.ranges[0] for sample in got] == [1.5], "the function was called")
    assert (one.title, other.title) == ("/scan", "mine")
    assert script.asked == [("subscribe", "/scan")]


def test_a_widget_is_titled_after_its_present_topic_unless_the_user_named_it(opened: Opened) -> None:
    feed, _ = opened(SCAN, SCAN._replace(name="/rear"), ODOM, CMD_VEL)
    laser, mine, speed = LaserWidget(), LaserWidget(title="mine"), SpeedWidget()
    feed.connect("/scan", laser, mine)
    feed.connect("/rear", laser, mine)
    assert laser.title == "/scan"
    feed.disconnect("/scan", laser, mine)
    assert (laser.title, mine.title) == ("/rear", "mine")
    laser.title = ""
    feed.connect("/rear", speed.command)
    feed.disconnect("/rear", speed.command)
    feed.connect("/cmd_vel", speed.command)
    assert (laser.title, speed.title, speed.command_title) == ("", "", "/cmd_vel")


def beside(function: Callable[[], object], name: str = "another") -> None:
    thread = threading.Thread(target=function, name=name, daemon=True)
    thread.start()
    thread.join(60)
    assert not thread.is_alive(), "it waits for a lock"


def test_an_observer_of_a_title_is_called_without_a_lock(opened: Opened) -> None:
    feed, _ = opened(SCAN, ODOM, Advert("/tf", "tf2_msgs/msg/TFMessage"))
    laser, seen = LaserWidget(), []

    def on_title(change: Any) -> None:
        seen.append((change["old"], change["new"], laser.title))
        beside(lambda: feed.status and feed.connection.status_of("/scan"))
        beside(lambda: setattr(laser, "trail", 5.0))
        beside(lambda: feed.connect("/odom", lambda _: None))

    laser.observe(on_title, "title")
    feed.connect("/scan", laser)
    assert seen == [("", "/scan", "/scan")]
    assert "/odom" in feed.connection.connected, "for the trail"


def test_an_observer_of_a_title_that_hangs_holds_up_no_thread_of_the_feed(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser, threads, goes_on = LaserWidget(), [], threading.Event()

    def on_title(change: Any) -> None:
        threads.append((change["new"], threading.current_thread().name))
        assert goes_on.wait(120)

    feed.connect("/scna", laser)
    feed.connect("/scan", laser)
    laser.observe(on_title, "title")
    beside(lambda: script.listener.on_message("/scan", scan(1.0)), "robot")
    beside(lambda: script.listener.on_message("/scan", scan(2.0)), "robot")
    assert (laser.title, laser.scan.ranges[0]) == ("/scan", 2.0)
    wait_for(lambda: threads == [("/scan", "robowidgets-changes")], "it is called in a thread of its own")
    goes_on.set()
    wait_for(lambda: threads_named("robowidgets-changes") == 0, "that thread ends")


def test_where_the_robot_is_may_be_asked_for_by_several_threads_at_once(opened: Opened) -> None:
    feed, script = opened(SCAN, ODOM)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    follow = script.follow

    def follow_once(topics: frozenset[str], each: frozenset[str] = frozenset()) -> None:
        script.follow = follow  # type: ignore[method-assign]
        beside(lambda: setattr(laser, "trail", 0.0))  # while the other one attaches
        follow(topics, each)

    script.follow = follow_once  # type: ignore[method-assign]
    laser.trail = 5.0
    assert list(feed.connection.connected) == ["/scan"], "the newest wins"


def test_once_a_topic_that_was_mended_delivers_the_widget_is_titled_after_it_and_complains_no_more(
    opened: Opened,
) -> None:
    feed, script = opened(SCAN, ODOM, CMD_VEL)
    laser, speed = LaserWidget(), SpeedWidget()
    feed.connect("/scna", laser)
    feed.connect("/scan", laser)
    complaint = "no such topic /scna; there are /scan, /odom, /cmd_vel; did you mean /scan?"
    assert (laser.title, source(laser)["status"]) == ("/scna", complaint)
    script.listener.on_message("/scan", scan())
    assert laser.title == "/scan"
    assert source(laser) == {"topic": "/scan", "type": SCAN.type, "status": "", "error": "", "lost": False}
    assert feed.connection.status_of("/scna") == complaint
    script.listener.on_lost("no route to host", 1.0)
    script.listener.on_connected()
    assert (laser.title, source(laser)["status"]) == ("/scan", "waiting for /scan")
    feed.connect("/odm", speed)
    feed.connect("/cmd_vle", speed.command)
    feed.connect("/odom", speed)
    script.listener.on_message("/odom", twist(0.1))
    assert (speed.title, speed.command_title) == ("/odom", "/cmd_vle")
    assert source(speed)["status"].startswith("no such topic /cmd_vle; ")
    feed.connect("/cmd_vel", speed.command)
    script.listener.on_message("/cmd_vel", twist(0.1))
    assert (speed.command_title, source(speed)["status"]) == ("/cmd_vel", "")


def test_a_topic_that_is_misspelt_after_another_delivered_is_reported(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_message("/scan", scan())
    feed.connect("/raer", laser)
    assert laser.title == "/scan"
    assert source(laser)["status"] == "no such topic /raer; there are /scan"


def test_a_method_of_a_speed_widget_takes_the_commanded_speed(opened: Opened) -> None:
    feed, script = opened(ODOM, CMD_VEL)
    speed = SpeedWidget()
    feed.connect("/cmd_vel", speed.command)
    feed.connect("/odom", speed)
    script.listener.on_message("/cmd_vel", twist(0.5))
    script.listener.on_message("/odom", twist(0.25))
    assert (speed.commanded.linear[0], speed.speed.linear[0]) == (0.5, 0.25)  # type: ignore[union-attr]
    assert (speed.title, speed.command_title) == ("/odom", "/cmd_vel")
    expected = {"topic": "/odom", "type": "nav_msgs/msg/Odometry", "status": "", "error": "", "lost": False}
    assert source(speed) == expected


def test_what_is_disconnected_gets_nothing_more(opened: Opened) -> None:
    feed, script = opened(SCAN)
    one, other = LaserWidget(), LaserWidget()
    feed.connect("/scan", one, other)
    feed.disconnect("/scan", one)
    script.listener.on_message("/scan", scan(3.0))
    assert one.scan is None
    assert other.scan is not None
    assert source(one) == {}
    feed.disconnect("/scan")
    feed.disconnect("/scan")
    assert script.asked == [("subscribe", "/scan"), ("unsubscribe", "/scan")]
    feed.connect("/scan", one)
    assert script.asked[-1] == ("subscribe", "/scan")


def test_a_callback_may_connect_and_close(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", lambda _: feed.connect("/other", laser))
    script.listener.on_message("/scan", scan())
    wait_for(lambda: script.asked == [("subscribe", "/scan"), ("subscribe", "/other")], "it is connected")
    feed.connect("/other", lambda _: feed.close())
    script.listener.on_message("/other", scan())
    wait_for(lambda: script.closed == 1, "the feed is closed")


def test_where_the_log_hangs_the_thread_that_brings_messages_does_not(
    opened: Opened, monkeypatch: pytest.MonkeyPatch
) -> None:
    feed, script = opened(SCAN)
    gate, laser = threading.Event(), LaserWidget()
    monkeypatch.setattr(logging.getLogger("robowidgets"), "error", lambda *_, **__: gate.wait(120))
    feed.connection.attach("/scan", lambda _: 1 / 0)
    feed.connect("/scan", laser)
    sender = threading.Thread(target=lambda: script.listener.on_message("/scan", scan(3.0)))
    sender.start()
    wait_for(lambda: laser.scan, "the message goes on to the others")
    wait_for(lambda: "ZeroDivisionError" in source(laser)["status"], "its widget says what went wrong")
    gate.set()
    sender.join()


def test_words_for_what_cannot_be_connected(opened: Opened) -> None:
    feed, _ = opened(SCAN)
    with pytest.raises(TypeError, match=r"expected a widget, a method of one .* got <class .*LaserWidget'>; make one"):
        feed.connect("/scan", LaserWidget)
    with pytest.raises(TypeError, match=r"expected a widget, .* got 'laser'$"):
        feed.connect("/scan", "laser")
    with pytest.raises(
        TypeError, match=r"got <.*DriveWidget.*>; a pad that drives is connected to a feed: pad.connect"
    ):
        feed.connect("/cmd_vel", DriveWidget())
    for wrong in (lambda: None, lambda a, b, c: (a, b, c)):
        with pytest.raises(TypeError, match=r"a message and the time at which it came; got <lambda>\("):
            feed.connect("/scan", wrong)
    with pytest.raises(
        TypeError, match=r"connect\('/scan'\): expected a widget, or a function of a sample, after the topic; got none"
    ):
        feed.connect("/scan")
    with pytest.raises(TypeError, match=r"expected the name of a topic as text, got \['/scan'\]"):
        feed.connect(["/scan"], LaserWidget())  # type: ignore[arg-type]
    feed.close()
    with pytest.raises(FeedError, match="the feed of the script is closed: open it again"):
        feed.connect("/scan", LaserWidget())


def test_a_subscription_that_fails_does_not_block_the_next(opened: Opened, monkeypatch: pytest.MonkeyPatch) -> None:
    feed, script = opened(SCAN)

    def refuse(topics: frozenset[str], _each: frozenset[str]) -> None:
        raise FeedError(f"{', '.join(topics)} is no name of a topic")

    with monkeypatch.context() as patch:
        patch.setattr(script, "follow", refuse)
        with pytest.raises(FeedError, match="a b is no name"):
            feed.connect("a b", print)
    feed.connect("/scan", print)
    assert ("subscribe", "/scan") in script.asked


# -- messages on the widget --------------------------------------------------------------------------------------------


def test_a_widget_says_what_it_waits_for_and_then_nothing(opened: Opened) -> None:
    feed, script = opened(connected=False)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    assert source(laser) == {
        "topic": "/scan",
        "type": "",
        "status": "connecting to the script",
        "error": "",
        "lost": True,
    }
    script.listener.on_connected()
    assert source(laser)["status"] == "waiting for /scan"
    script.listener.on_topics([SCAN])
    assert source(laser) == {
        "topic": "/scan",
        "type": SCAN.type,
        "status": "waiting for /scan",
        "error": "",
        "lost": False,
    }
    script.listener.on_message("/scan", scan())
    assert source(laser)["status"] == ""


@pytest.mark.parametrize(
    ("asked", "there", "words"),
    [
        ("/scna", [SCAN, ODOM], "no such topic /scna; there are /scan, /odom; did you mean /scan?"),
        ("/scan", [IMU], "no such topic /scan; there are /imu"),
        ("/scan", [], "no topic /scan yet; no topics are known"),
        ("/scan", [SCAN._replace(offered=False)], "/scan has no publisher yet"),
    ],
)
def test_a_widget_names_what_is_there_instead(opened: Opened, asked: str, there: list[Advert], words: str) -> None:
    feed, _ = opened(*there)
    laser = LaserWidget()
    feed.connect(asked, laser)
    assert source(laser)["status"] == words


def test_a_publisher_that_ends_and_comes_back_is_reported(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_message("/scan", scan())
    script.listener.on_topics([SCAN._replace(offered=False)])
    assert source(laser)["status"] == "/scan has no publisher any more"
    script.listener.on_topics([SCAN])
    assert source(laser)["status"] == "waiting for /scan"
    script.listener.on_message("/scan", scan())
    assert source(laser)["status"] == ""


def test_a_topic_that_vanishes_with_its_publisher_is_reported_as_unpublished(opened: Opened) -> None:
    feed, script = opened(SCAN, ODOM)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_message("/scan", scan())
    script.listener.on_topics([ODOM])
    assert source(laser)["status"] == "/scan has no publisher any more"


def test_a_connection_that_is_lost_and_found_is_reported(opened: Opened) -> None:
    feed, script = opened(SCAN, connected=False)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_lost("connection refused", 0.5)
    assert source(laser)["status"] == "cannot reach the script, trying again in 0.5 s: connection refused"
    script.listener.on_connected()
    script.listener.on_topics([SCAN])
    script.listener.on_message("/scan", scan())
    script.listener.on_lost("the other side hung up", 2.0)
    assert source(laser)["status"] == "connection lost, trying again in 2 s: the other side hung up"
    script.listener.on_connected()
    assert source(laser)["status"] == "waiting for /scan"
    assert laser.scan is not None


def test_trouble_of_the_middleware_is_reported_until_it_is_over(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_trouble("/scan", "the publisher is best-effort, so nothing comes")
    assert source(laser)["status"] == "the publisher is best-effort, so nothing comes"
    script.listener.on_topics([ODOM])
    gone = "no such topic /scan; there are /odom"
    assert source(laser)["status"] == f"{gone}; the publisher is best-effort, so nothing comes"
    script.listener.on_topics([SCAN])
    script.listener.on_trouble("/scan", "")
    assert source(laser)["status"] == "waiting for /scan"
    script.listener.on_trouble("/other", "nobody is connected to it")


def test_a_topic_that_changes_its_type_is_reported_and_goes_on(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_topics([SCAN._replace(type="my_msgs/msg/Scan")])
    script.listener.on_message("/scan", scan(4.0))
    assert source(laser)["status"] == "/scan was sensor_msgs/msg/LaserScan and is now my_msgs/msg/Scan"
    assert source(laser)["type"] == "my_msgs/msg/Scan"
    assert laser.scan is not None
    script.listener.on_topics([SCAN, SCAN._replace(type="my_msgs/msg/Scan")])
    assert source(laser)["status"] == "/scan is published as sensor_msgs/msg/LaserScan and as my_msgs/msg/Scan"


def test_two_scanners_on_one_topic_are_reported(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    for ranges in ([1.0] * 3, [1.0] * 5) * 2:
        script.listener.on_message("/scan", scan(*ranges))
    few, many = (f"{count} rays from 0.0° in steps of 5.73°" for count in (3, 5))
    words = "two scanners take turns on this topic, or one changes its rays: "
    assert source(laser)["status"] == f"{words}{few}, and {many}"


def test_a_message_of_the_wrong_type_keeps_the_last_picture_and_says_so(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)

    def come() -> None:
        script.listener.on_message("/scan", scan(2.5))
        script.listener.on_message("/scan", twist(1.0))

    in_a_thread(come)
    assert laser.scan is not None
    assert laser.scan.ranges[0] == 2.5
    assert "expected a message like sensor_msgs/LaserScan" in laser.get_state()["_about"]["error"]
    script.listener.on_message("/scan", scan(3.5))
    assert laser.scan.ranges[0] == 3.5
    assert "error" not in laser.get_state()["_about"]


def test_a_scan_of_100_mb_is_refused_in_words_and_not_kept(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    script.listener.on_message("/scan", scan(2.5))
    kept: list[weakref.ref[object]] = []

    def come() -> None:
        huge = scan() | {"ranges": np.ones(25_000_000, np.float32)}
        kept.append(weakref.ref(huge["ranges"]))
        script.listener.on_message("/scan", huge)

    in_a_thread(come)
    assert laser.scan is not None
    assert laser.scan.ranges[0] == 2.5
    assert "expected at most 1,000,000 rays, got 25,000,000" in laser.get_state()["_about"]["error"]
    script.listener.on_message("/scan", scan(3.5))
    assert laser.scan.ranges[0] == 3.5
    assert kept[0]() is None
    assert "error" not in laser.get_state()["_about"]


def test_a_commanded_speed_need_not_be_waited_for(opened: Opened) -> None:
    feed, script = opened(ODOM, CMD_VEL)
    speed = SpeedWidget()
    feed.connect("/odom", speed)
    feed.connect("/cmd_vel", speed.command)
    script.listener.on_message("/odom", twist(0.1))
    assert source(speed)["status"] == ""
    feed.connect("/cmd_vle", speed.command)
    assert source(speed)["status"] == "no such topic /cmd_vle; there are /odom, /cmd_vel; did you mean /cmd_vel?"


# -- closing -----------------------------------------------------------------------------------------------------------


def test_a_closed_feed_says_so_and_hears_nothing_more(opened: Opened) -> None:
    feed, script = opened(SCAN)
    laser = LaserWidget()
    feed.connect("/scan", laser)
    feed.close()
    feed.close()
    assert script.closed == 1
    assert source(laser)["status"] == "the feed is closed"
    script.listener.on_connected()
    script.listener.on_lost("late", 1.0)
    script.listener.on_topics([])
    script.listener.on_trouble("/scan", "late")
    script.listener.on_message("/scan", scan())
    assert source(laser)["status"] == "the feed is closed"
    assert laser.scan is None
    feed.disconnect("/scan")
    assert script.asked == [("subscribe", "/scan")]


def test_a_middleware_that_cannot_be_opened_leaves_nothing_behind(monkeypatch: pytest.MonkeyPatch) -> None:
    script = Scripted()

    def refuse(_listener: object) -> None:
        raise FeedError("rclpy is not installed")

    monkeypatch.setattr(script, "open", refuse)
    with pytest.raises(FeedError, match="rclpy is not installed"):
        Feed(script)
    assert open_feeds == set()


def test_twenty_opens_and_closes_leave_no_thread_and_no_memory() -> None:
    got: list[object] = []
    there: list[weakref.ref[Feed]] = []

    def once(until: Callable[[], object] = lambda: True) -> None:
        with feeds.simulator(hz=100.0) as feed:
            feed.connect("/scan", got.append)
            feed.drive(0.1, 0.0)
            wait_for(until, "a scan has come")
            there.append(weakref.ref(feed))
        got.clear()

    once(until=lambda: got)
    before = set(threading.enumerate())
    tracemalloc.start()
    once(until=lambda: got)
    gc.collect()
    settled, _ = tracemalloc.get_traced_memory()
    for _ in range(20):
        once()
    wait_for(lambda: set(threading.enumerate()) <= before, "every thread has ended")
    gc.collect()
    after, _ = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    assert [ref for ref in there if ref() is not None] == []
    assert after - settled < 40_000


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
def test_a_forked_process_reports_that_the_feed_stayed_behind_whatever_locks_were_held(opened: Opened) -> None:
    feed, script = opened(SCAN, CMD_VEL)
    feed.driving = feeds.Driving(hold=60.0)
    feed.drive(0.1)
    reading, writing = os.pipe()
    with in_other_hands(feed.connection._lock), in_other_hands(feed.watchdog._lock):
        child = os.fork()
        if child == 0:
            try:
                signal.alarm(20)
                for use in (feed.drive, feed.stop, feed.show, lambda: feed.connect("/scan", print)):
                    with pytest.raises(FeedError) as error:
                        use()
                    os.write(writing, f"{error.value}\n".encode())
                feed.close()
                os.write(writing, f"{script.speeds} {script.closed}".encode())
            finally:
                os._exit(0)
    os.close(writing)
    with open(reading) as answer:
        said = answer.read().splitlines()
    os.waitpid(child, 0)
    words = "the feed of the script belongs to the parent of this forked process: open it again"
    assert said == [words] * 4 + ["[(0.1, 0.0)] 0"]
    feed.stop()
    assert script.speeds == [(0.1, 0.0), (0.0, 0.0)]


@contextmanager
def in_other_hands(lock: Any) -> Iterator[None]:
    """Hold a lock in another thread meanwhile."""
    taken, done = threading.Event(), threading.Event()

    def hold() -> None:
        with lock:
            taken.set()
            done.wait(120)

    holder = threading.Thread(target=hold)
    holder.start()
    assert taken.wait(120)
    yield
    done.set()
    holder.join()


@pytest.mark.slow
def test_a_feed_that_is_not_closed_stops_the_robot_and_lets_the_process_end() -> None:
    program = (
        "from robowidgets import feeds\n"
        "from robowidgets.feeds.simulator import Simulated\n"
        "publish = Simulated.publish\n"
        "Simulated.publish = lambda *a: (print(a[3]['linear']['x'], flush=True), publish(*a))\n"
        "feed = feeds.simulator()\n"
        "view = feed.show()\n"
        "feed.drive(0.25, 0.0)\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")
    first, *later = ended.stdout.split()
    assert (first, {*later}) == ("0.25", {"0.0"}), "the speed may end before the process"


@pytest.mark.slow
def test_at_the_end_feeds_are_closed_before_what_a_middleware_brings_along_and_one_that_fails_spares_the_others() -> (
    None
):
    program = (
        "import atexit\n"
        "from robowidgets import feeds\n"
        "from robowidgets.feeds.simulator import Simulated\n"
        "publish, start = Simulated.publish, Simulated.open\n"
        "import sys\n"
        "tell = lambda speed: (sys.stdout.write(f'{speed}\\n'), sys.stdout.flush())\n"
        "Simulated.publish = lambda *a: (tell(a[3]['linear']['x']), publish(*a))\n"
        "def open_late(*a):\n"
        "    atexit.register(print, 'the end of the middleware')\n"
        "    start(*a)\n"
        "Simulated.open = open_late\n"
        "def fail(): raise RuntimeError('cannot close')\n"
        "both = [feeds.simulator(), feeds.simulator()]\n"
        "for feed in both:\n"
        "    feed.drive(0.25, 0.0)\n"
        "    feed.connection.middleware.close = fail\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    end = ["the end of the middleware"] * 2
    assert (ended.returncode, ended.stdout.splitlines()) == (0, ["0.25", "0.25", "0.0", "0.0", *end])
    assert ended.stderr.count("RuntimeError: cannot close") == 2


def test_feeds_are_reached_from_the_package_without_being_imported_by_it() -> None:
    program = (
        "import sys, robowidgets\n"
        "assert 'robowidgets.feeds' not in sys.modules\n"
        "assert callable(robowidgets.feeds.simulator) and callable(robowidgets.feeds.recording)\n"
        "import robowidgets.feeds.simulator, robowidgets.feeds.replay\n"
        "assert callable(robowidgets.feeds.simulator) and callable(robowidgets.feeds.recording)\n"
        "print([name for name in ('tornado', 'cyclonedds', 'rclpy', 'rospy') if name in sys.modules])\n"
    )
    ended = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=False)
    assert (ended.stdout, ended.stderr) == ("[]\n", "")


def test_messages_of_many_threads_and_connections_that_change_meanwhile_end_well(opened: Opened) -> None:
    feed, script = opened(SCAN)
    lasers = [LaserWidget() for _ in range(4)]
    done = threading.Event()

    def flood() -> None:
        while not done.is_set():
            script.listener.on_message("/scan", scan())
            script.listener.on_topics([SCAN])

    def change(laser: LaserWidget) -> None:
        for _ in range(50):
            feed.connect("/scan", laser)
            feed.disconnect("/scan", laser)

    flooding = threading.Thread(target=flood, daemon=True)
    flooding.start()
    changing = [threading.Thread(target=change, args=(laser,), daemon=True) for laser in lasers]
    for thread in changing:
        thread.start()
    wait_for(lambda: not any(thread.is_alive() for thread in changing), "all have connected and disconnected")
    done.set()
    flooding.join(120)
    assert script.asked[-1] == ("unsubscribe", "/scan")
    assert script.asked == [("subscribe", "/scan"), ("unsubscribe", "/scan")] * (len(script.asked) // 2)
