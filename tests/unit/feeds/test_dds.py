"""ROS 2 topics without ROS: a robot in another process, on loopback."""

from __future__ import annotations

import gc
import os
import resource
import socket
import struct
import sys
import threading
import time
import weakref
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing, suppress
from pathlib import Path
from typing import Any
from uuid import UUID

import pytest

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install cyclonedds")

from cyclonedds.core import DDSException
from cyclonedds.domain import Domain

from robowidgets import EventsWidget
from robowidgets.feeds import Driving, Feed, _dds_session, _ros2_common, _threaded, _zeros
from robowidgets.feeds._dds_types import opaque, ros_topic
from robowidgets.feeds._guard.mark import MARK
from robowidgets.feeds._ros2_types import decoder_for, ros_type
from robowidgets.feeds.dds import Dds
from robowidgets.feeds.middleware import Advert, FeedError
from robowidgets.messages import add_definitions, definitions
from robowidgets.messages.decoding import DecodeError
from robowidgets.messages.encoding import encode
from robowidgets.runtime.clock import RealClock
from robowidgets.samples import Level

from ..clocks import ManualClock
from ..waiting import threads_named, wait_for
from . import dds_robot
from .bursts import EVERY, record_bursts
from .ears import Ears
from .processes import DOMAIN
from .processes import DdsRobot as Robot

SCAN = "sensor_msgs/msg/LaserScan"
TWIST, STAMPED = "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
RANGE = "sensor_msgs/msg/Range"
NODES_TYPE = "rmw_dds_common/msg/ParticipantEntitiesInfo"
HASHES = {
    "OldRange": "typehash=RIHS01_9430b1915b94d4268ff903679e8ecd09b6a67d331bd028738ec1eeb592891ebd;",
    "Range": "typehash=RIHS01_b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a;",
}

LIMITS = {name: getattr(_dds_session, name) for name in ("_MATCHING", "_CONFIRMING")}
SETTLING = _dds_session._SETTLING


def get_session(dds: Dds) -> _dds_session.DdsSession:
    """Return the session of a middleware once it takes part."""
    wait_for(lambda: dds._session, "it takes part")
    session = dds._session
    assert isinstance(session, _dds_session.DdsSession)
    return session


def add_reader(session: _dds_session.DdsSession, wish: _dds_session.Wish, samples: list[Any]) -> dict[Any, Any]:
    """Give a session a reader that takes the next of these samples each time, and return all readers."""

    class Reader:
        def take(self, **_: Any) -> list[Any]:
            return samples.pop(0)

    readers = session._readers
    readers[wish] = _dds_session._Reader(Reader(), None, decoder_for(wish.type), deque())
    return readers


def age_zero(dds: Dds, topic: str) -> Any:
    """Make the last zero of a topic 100 s older, and return what the session notes on it."""
    session = get_session(dds)
    with session._writing:
        zeros = session._zeros._topics[topic]
        zeros.since -= 100.0
    return zeros


@pytest.fixture
def start(robots: list[Robot]) -> Iterator[Callable[..., Robot]]:
    """Starts robots, which end with the test, also if it fails."""

    def start_one(lease: str = "10s") -> Robot:
        robots.append(Robot(lease))
        return robots[-1]

    yield start_one
    for robot in robots:
        robot.kill()


@pytest.fixture
def robot(start: Callable[[], Robot]) -> Robot:
    return start()


@pytest.fixture
def other(start: Callable[[], Robot]) -> Robot:
    return start()


@pytest.fixture
def heard() -> Ears:
    return Ears()


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A robot on a busy machine may match and confirm late: only tests of these limits have them."""
    for limit in LIMITS:
        monkeypatch.setattr(_dds_session, limit, 120.0)


@pytest.fixture
def limits(patient: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The limits of the product."""
    for limit, seconds in LIMITS.items():
        monkeypatch.setattr(_dds_session, limit, seconds)


class Settling(RealClock):
    """A clock whose moment for the discovery of a publisher lasts until robots that may lose messages know it."""

    def __init__(self, robots: Sequence[Robot]) -> None:
        self._robots = robots

    def sleep(self, seconds: float) -> None:
        if seconds != SETTLING:
            time.sleep(seconds)
            return
        for robot in self._robots:
            assert not robot.may_lose or robot.matched.wait(120)


@pytest.fixture
def robots() -> list[Robot]:
    return []


@pytest.fixture
def dds(heard: Ears, robots: list[Robot]) -> Iterator[Dds]:
    dds = Dds(DOMAIN, interface="lo", clock=Settling(robots))
    dds.open(heard)
    yield dds
    dds.close()


def publish_until(robot: Robot, condition: Any, what: str, *message: Any) -> None:
    def done() -> bool:
        if condition():
            return True
        robot.do("write", *message)
        return False

    wait_for(done, what)


def memory() -> int:
    """The memory of this process, in bytes."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * resource.getpagesize()


def udp_addresses() -> set[tuple[str, int]]:
    """Addresses and ports of the UDP sockets of this process."""
    links = [os.path.realpath(f"/proc/self/fd/{number}") for number in os.listdir("/proc/self/fd")]
    own = {link.partition("socket:[")[2].rstrip("]") for link in links if "socket:[" in link}
    rows = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    places = [row[1].split(":") for row in rows if row[9] in own]
    return {(".".join(map(str, bytes.fromhex(address)[::-1])), int(port, 16)) for address, port in places}


def counts(heard: Ears) -> set[int]:
    return {len(message.ranges) for _, message in heard.messages}


def test_a_scan_comes_with_its_topic_and_type(dds: Dds, heard: Ears, robot: Robot) -> None:
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0, 2.5], 0.5)
    topic, message = heard.messages[0]
    assert (topic, list(message.ranges), message.header.frame_id) == ("/scan", [1.0, 2.5], "laser")
    assert heard.topics == [Advert("/scan", SCAN, offered=True, wanted=False, subscribers=())]
    assert (heard.connected, heard.lost, heard.troubles) == (1, [], {})


@pytest.mark.slow
def test_two_publishers_with_different_geometry_are_both_heard(
    dds: Dds, heard: Ears, robot: Robot, other: Robot
) -> None:
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, lambda: 1 in counts(heard), "the one came", "/scan", "LaserScan", [1.0], 0.5)
    publish_until(other, lambda: 3 in counts(heard), "the other came", "/scan", "LaserScan", [1.0, 2.0, 3.0], 0.1)
    publish_until(robot, lambda: len(heard.messages[-1][1].ranges) == 1, "the one again", "/scan", "LaserScan", [1], 1)


def test_events_that_come_at_once_all_come(dds: Dds, heard: Ears, robot: Robot) -> None:
    dds.follow(frozenset({"/scan", "/bump"}))
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    publish_until(robot, lambda: heard.messages[-1][0] == "/bump", "a bump came", "/bump", "Twist", 0.0)
    held, go_on = threading.Event(), threading.Event()

    def hold(*_: object) -> None:
        held.set()
        assert go_on.wait(120)

    heard.then = hold
    publish_until(robot, held.is_set, "it is busy", "/scan", "LaserScan", [1.0], 0.5)
    heard.messages.clear()
    for x in (1.0, 2.0, 3.0):
        robot.do("write", "/bump", "Twist", x)
    robot.hear("/done", "Twist")
    go_on.set()

    def bumps() -> list[float]:
        # One published before may come late.
        return [message.linear.x for topic, message in heard.messages if topic == "/bump" and message.linear.x]

    wait_for(lambda: len(bumps()) == 3, "all three came")
    assert bumps() == [1.0, 2.0, 3.0]


def test_a_latched_message_reaches_late_subscribers(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.do("latch", "/map_scan", "LaserScan", [4.0], 0.5)
    wait_for(lambda: heard.topics, "the topic is known")
    dds.follow(frozenset({"/map_scan"}))
    wait_for(lambda: heard.messages, "the kept scan came")
    assert list(heard.messages[0][1].ranges) == [4.0]


def test_an_undefined_type_is_named(dds: Dds, heard: Ears, robot: Robot) -> None:
    dds.follow(frozenset({"/riddle"}))
    publish_until(robot, lambda: heard.troubles, "it is said", "/riddle", "Mystery", "?")
    assert heard.words("/riddle") == (
        "/riddle comes as nobody_msgs/msg/Mystery, a type that is not known here: "
        "add its .msg files with robowidgets.messages.add_definitions(folder), or use feeds.ros2 or feeds.foxglove, "
        "which do not need them"
    )


def test_a_type_that_a_user_defines_is_heard(
    dds: Dds, heard: Ears, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(definitions, "_added", {})
    add_definitions("MSG: nobody_msgs/Mystery\nstring text\n")
    dds.follow(frozenset({"/riddle"}))
    publish_until(robot, lambda: heard.messages, "it came", "/riddle", "Mystery", "!")
    assert [message.text for _, message in heard.messages][-1] == "!"


def test_a_type_with_other_fields_under_the_same_name_is_reported(dds: Dds, heard: Ears, robot: Robot) -> None:
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, lambda: heard.troubles, "it is said", "/scan", "OtherScan", "no scan")
    assert heard.words("/scan") == (
        "a publisher of /scan defines the fields of its type in another way, so its messages do not come"
    )
    assert not heard.messages


def test_a_truncated_message_is_reported_until_a_whole_one_comes(heard: Ears) -> None:
    # Cyclone DDS writes no such bytes: they come from publishers that do not describe their types, as ROS 2 to Jazzy.
    session = _dds_session.DdsSession(DOMAIN, heard)
    whole = encode("cdr", TWIST, {"linear": {"x": 0.5}})
    samples = [[opaque(TWIST)(whole[:-9])], [opaque(TWIST)(whole)]]

    wish = _dds_session.Wish("/speed", TWIST, False, False)
    add_reader(session, wish, samples)
    session.pass_on(wish)
    assert heard.words("/speed").startswith(f"a message of /speed cannot be read: 43 bytes are not a valid {TWIST}: ")
    session.pass_on(wish)
    assert heard.words("/speed") == ""
    assert heard.messages[0][1].linear.x == 0.5


@pytest.mark.slow
def test_messages_of_100_mb_come_hold_up_no_other_topic_and_leave_no_memory_behind(
    dds: Dds, heard: Ears, robot: Robot, other: Robot
) -> None:
    scan = "/scan", "LaserScan", [1.0], 0.5
    dds.follow(frozenset({"/scan"}))
    publish_until(other, lambda: heard.messages, "a scan came", *scan)
    before = memory()
    for _ in range(2):
        heard.messages.clear()
        robot.do("latch", "/image", "Image", 100_000_000)
        dds.follow(frozenset({"/scan", "/image"}))
        publish_until(other, lambda: "/image" in [topic for topic, _ in heard.messages], "the image came", *scan)
        publish_until(other, lambda: heard.messages[-1][0] == "/scan", "scans go on", *scan)
        dds.follow(frozenset({"/scan"}))
    came = [(topic, len(message.data) if topic == "/image" else 0) for topic, message in heard.messages]
    assert came.index(("/image", 100_000_000)) > 10, "scans came while it was under way"
    heard.messages.clear()
    # Small freed pieces may stay with the process: as much as one message, but not two.
    wait_for(lambda: memory() < before + 150e6, "the memory is given back")


@pytest.mark.parametrize(("kind", "name"), [("Twist", TWIST), ("TwistStamped", STAMPED)])
def test_the_robot_hears_the_speed_that_it_listens_to(
    dds: Dds, heard: Ears, robot: Robot, kind: str, name: str
) -> None:
    robot.hear("/cmd_vel", kind)
    wait_for(lambda: heard.topics, "the topic is known")
    assert heard.topics == [Advert("/cmd_vel", name, offered=False, wanted=True, subscribers=())]
    twist = {"linear": {"x": 0.25}, "angular": {"z": -0.5}}
    dds.publish("/cmd_vel", name, twist if kind == "Twist" else {"header": {"frame_id": "base"}, "twist": twist})
    got = robot.heard()
    if kind == "TwistStamped":
        assert got["header"]["frame_id"] == "base"
        got = got["twist"]
    assert (got["linear"]["x"], got["angular"]["z"]) == (0.25, -0.5)


def test_publishing_without_a_connection_raises(limits: None, dds: Dds, heard: Ears) -> None:
    never = Dds(DOMAIN, interface="lo")
    wait_for(lambda: heard.connected, "it takes part")
    dds.publish("/cmd_vel", TWIST, {})
    dds.close()
    for unconnected in (never, dds):
        with pytest.raises(FeedError, match=f"DDS domain {DOMAIN} on lo is not connected"):
            unconnected.publish("/cmd_vel", TWIST, {})


def test_a_message_that_dds_does_not_take_is_reported(limits: None, heard: Ears) -> None:
    session = _dds_session.DdsSession(DOMAIN, heard)
    raw = encode("cdr", TWIST, {})
    session.publish("/cmd_vel", TWIST, raw, is_zero=True)
    writer = session._writers["/cmd_vel", TWIST]
    writer._delete(writer._ref)
    with pytest.raises(FeedError, match=r"cannot publish on /cmd_vel: \[DDS_RETCODE_"):
        session.publish("/cmd_vel", TWIST, raw, is_zero=True)


def test_a_subscriber_that_does_not_keep_up_delays_nothing(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.hear("/cmd_vel", "TwistStamped")
    wait_for(lambda: heard.topics, "the topic is known")
    robot.freeze()
    for _ in range(5):  # a call that waited for it would be an error
        twist = {"linear": {"x": 0.25}}
        dds.publish("/cmd_vel", STAMPED, {"header": {"frame_id": "x" * 1_000_000}, "twist": twist})


def test_a_speed_is_sent_while_a_message_is_handed_on(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.hear("/cmd_vel", "Twist")
    held, go_on = threading.Event(), threading.Event()

    def hold(*_: object) -> None:
        held.set()
        assert go_on.wait(120)

    heard.then = hold
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, held.is_set, "it is busy", "/scan", "LaserScan", [1.0], 0.5)
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
    assert robot.heard()["linear"]["x"] == 0.25
    go_on.set()


@pytest.mark.slow
def test_speeds_are_sent_at_once_while_scans_come_at_a_high_rate(
    dds: Dds, heard: Ears, robot: Robot, other: Robot
) -> None:
    robot.do("flood", "/scan", "LaserScan", 0.002, [1.0] * 1040, 0.006)
    other.hear("/cmd_vel", "Twist")
    dds.follow(frozenset({"/scan"}))
    wait_for(lambda: heard.messages and "/cmd_vel" in {topic.name for topic in heard.topics or ()}, "both are known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    assert other.heard()["linear"]["x"] == 0.0
    before = len(heard.messages)
    for number in range(1, 51):
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": number}})
        assert other.heard()["linear"]["x"] == number
    wait_for(lambda: len(heard.messages) > before, "scans come all the time")


@pytest.mark.parametrize("reliable", [True, False])
def test_the_first_message_is_heard(dds: Dds, heard: Ears, robot: Robot, reliable: bool) -> None:
    robot.hear("/cmd_vel", "Twist", reliable)
    wait_for(lambda: heard.topics, "the topic is known")
    for x in (0.0, 1.0):  # the next one may replace the one before until that has come
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": x}})
        assert robot.heard()["linear"]["x"] == x


def test_the_first_message_waits_for_a_subscriber_that_is_known_a_moment_later(dds: Dds, robot: Robot) -> None:
    session = get_session(dds)
    publishing = threading.Thread(target=dds.publish, args=("/cmd_vel", TWIST, {"linear": {"x": 0.5}}))
    publishing.start()
    wait_for(lambda: session._writers, "it waits")
    robot.hear("/cmd_vel", "Twist", False)
    assert robot.heard()["linear"]["x"] == 0.5
    publishing.join()


def test_the_first_message_waits_a_moment_if_no_subscriber_comes(limits: None, heard: Ears) -> None:
    clock, reads = ManualClock(), ("robowidgets-dds",)
    with closing(Dds(DOMAIN, interface="lo", clock=clock)) as dds:
        dds.open(heard)
        wait_for(lambda: heard.connected, "it takes part")
        publishing = clock.beside(lambda: dds.publish("/cmd_vel", TWIST, {}))
        clock.advance(0.299, reads)
        assert publishing.is_alive()
        clock.advance(0.006, reads)  # it looks every 5 ms
        publishing.join()


def test_subscribers_of_two_types_match_before_the_first_message(
    dds: Dds, heard: Ears, robot: Robot, other: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.hear("/of_two_types", "Twist")
    other.hear("/of_two_types", "TwistStamped", False)
    wait_for(lambda: [one.name for one in heard.topics or ()].count("/of_two_types") == 2, "both are known")
    dds.publish("/of_two_types", TWIST, {"linear": {"x": 0.25}})
    monkeypatch.setattr(_dds_session, "_SETTLING", 1000.0)  # messages that wait from now on wait too long
    dds.publish("/of_two_types", STAMPED, {"twist": {"linear": {"x": 0.25}}})
    assert other.heard()["twist"]["linear"]["x"] == 0.25


def test_stop_does_not_wait_until_a_subscriber_of_another_type_matches(
    kernel_sends: None, robot: Robot, other: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.hear("/retyped", "Twist")
    with Feed(Dds(DOMAIN, interface="lo")) as feed:
        feed.driving = Driving("/retyped", hold=60.0)
        feed.drive(0.25)
        assert robot.heard()["linear"]["x"] == 0.25
        other.hear("/retyped", "TwistStamped")
        wait_for(
            lambda: Advert("/retyped", STAMPED, False, True, (), ()) in feed.connection.adverts, "the other is known"
        )
        for wait in ("_MATCHING", "_SETTLING"):  # messages that wait from now on wait too long
            monkeypatch.setattr(_dds_session, wait, 1000.0)
        feed.drive(0.25)
        with suppress(FeedError):  # a busy robot confirms late, which is reported
            feed.stop()
        while robot.heard()["linear"]["x"]:
            pass

        def moves() -> bool:
            feed.drive(0.25)
            return other.unread

        wait_for(moves, "the other moves, too")


def test_a_zero_right_before_closing_arrives(heard: Ears, robot: Robot) -> None:
    robot.hear("/cmd_vel", "Twist")
    for number in range(1, 6):
        heard.topics = []
        dds = Dds(DOMAIN, interface="lo")
        dds.open(heard)
        wait_for(lambda: heard.topics, "the topic is known")
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": number}})
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
        dds.close()
        while robot.heard()["linear"]["x"]:  # zero may replace the speed before it
            pass


def test_a_zero_that_a_subscriber_has_confirmed_is_not_sent_again(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.hear("/cmd_vel", "Twist")
    wait_for(lambda: heard.topics, "the topic is known")
    for x in (0.5, 0.0):  # zero may replace the speed until that has come
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": x}})
        assert robot.heard()["linear"]["x"] == x
    zeros = age_zero(dds, "/cmd_vel")
    wait_for(lambda: zeros.repeats == len(_zeros.AGAIN), "it was looked at")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
    assert robot.heard()["linear"]["x"] == 0.25


def test_a_best_effort_subscriber_gets_zero_some_more_times(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.hear("/cmd_vel", "Twist", False)
    wait_for(lambda: heard.topics, "the topic is known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}})
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    assert [robot.heard()["linear"]["x"] for _ in range(2)] == [0.5, 0.0]
    age_zero(dds, "/cmd_vel")
    assert robot.heard()["linear"]["x"] == 0.0


def test_a_best_effort_subscriber_gets_zero_some_more_times_before_the_connection_ends(
    dds: Dds, heard: Ears, robot: Robot
) -> None:
    robot.hear("/cmd_vel", "Twist", False)
    wait_for(lambda: heard.topics, "the topic is known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}})
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    dds.close()
    assert [robot.heard()["linear"]["x"] for _ in range(2 + _zeros.LAST)] == [0.5, *[0.0] * (1 + _zeros.LAST)]


@pytest.mark.parametrize("reliable", [True, False])
def test_a_robot_that_comes_back_gets_the_zero_that_was_sent_meanwhile(
    dds: Dds, heard: Ears, robot: Robot, start: Callable[[], Robot], reliable: bool
) -> None:
    robot.hear("/cmd_vel", "Twist", reliable)
    wait_for(lambda: heard.topics, "the topic is known")
    # A subscriber without reliability misses what is sent before it knows the publisher.
    wait_for(lambda: dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}}) or robot.unread, "the speed comes")
    assert robot.heard()["linear"]["x"] == 0.5
    robot.do("end")
    wait_for(lambda: heard.topics == [], "it is gone")
    with pytest.raises(
        TimeoutError, match="/cmd_vel has no subscriber any more: the robot that was driven may be unreachable"
    ):
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    again = start()
    again.do("hear", "/cmd_vel", "Twist", reliable)
    told = [again.heard(), again.heard()]  # zero may come before it reports that it is ready
    told.remove("ready")
    assert told[0]["linear"]["x"] == 0.0


def test_closing_does_not_wait_for_a_robot_that_does_nothing_any_more(
    limits: None, dds: Dds, heard: Ears, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    robot.hear("/cmd_vel", "Twist")
    wait_for(lambda: heard.topics, "the topic is known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}})
    robot.heard()
    robot.freeze()
    with pytest.raises(TimeoutError, match="a subscriber of /cmd_vel has not confirmed zero: it may not be reached"):
        dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.0}})
    monkeypatch.setattr(_threaded, "CLOSE_TIMEOUT", 1000.0)
    dds.close()
    assert not threads_named("robowidgets-dds")


def test_closing_does_not_wait_for_long_for_a_message_that_is_handed_on(
    dds: Dds, heard: Ears, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_threaded, "CLOSE_TIMEOUT", 0.1)
    held, go_on = threading.Event(), threading.Event()

    def hold(*_: object) -> None:
        held.set()
        assert go_on.wait(120)

    heard.then = hold
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, held.is_set, "it is busy", "/scan", "LaserScan", [1.0], 0.5)
    dds.close()
    assert not go_on.is_set(), "closed before the message was delivered"
    go_on.set()


def test_a_subscriber_that_does_not_hear_what_is_published_is_reported_until_it_is_gone(
    dds: Dds, heard: Ears, robot: Robot
) -> None:
    robot.do("want_kept", "/cmd_vel", "Twist")
    wait_for(lambda: heard.topics, "the topic is known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}})
    wait_for(lambda: heard.words("/cmd_vel"), "it is reported")
    assert heard.words("/cmd_vel") == (
        "a subscriber of /cmd_vel expects earlier messages (durability), so it receives nothing"
    )
    robot.do("stop", "/cmd_vel", "Twist")
    wait_for(lambda: not heard.words("/cmd_vel"), "it is over")


@pytest.mark.slow
def test_another_subscriber_hears_what_one_does_not(dds: Dds, heard: Ears, robot: Robot, other: Robot) -> None:
    robot.do("want_kept", "/cmd_vel", "Twist")
    wait_for(lambda: heard.topics, "the topic is known")
    dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.5}})
    wait_for(lambda: heard.words("/cmd_vel"), "it is reported")
    other.hear("/cmd_vel", "Twist")
    publishing = threading.Event()

    def publish() -> None:
        while not publishing.is_set():
            dds.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
            time.sleep(0.01)

    thread = threading.Thread(target=publish)
    thread.start()
    assert other.heard()["linear"]["x"] == 0.25
    publishing.set()
    thread.join()
    assert heard.words("/cmd_vel").startswith("a subscriber of /cmd_vel expects")


@pytest.mark.parametrize("do", ["write", "hashed"])
@pytest.mark.parametrize(
    ("kind", "values"), [("Range", [0.5, 0.1, 4.0, 1.5, 0.25]), ("OldRange", [0.5, 0.1, 4.0, 1.5])]
)
def test_a_range_of_any_distribution_is_read(
    dds: Dds, heard: Ears, robot: Robot, do: str, kind: str, values: list[float]
) -> None:
    dds.follow(frozenset({"/sonar"}))

    def came() -> bool:
        robot.do(do, "/sonar", kind, *values)
        return bool(heard.messages)

    wait_for(came, "a range came")
    message = heard.messages[0][1]
    assert (message.range, getattr(message, "variance", None)) == (1.5, 0.25 if kind == "Range" else None)
    assert heard.said == []
    robot.do("subscribers", "/sonar", kind)
    assert robot.heard() == [f"{HASHES[kind]}reader=robowidgets;"]


def test_a_range_of_a_publisher_that_does_not_describe_it_is_read_by_the_definition_that_fits() -> None:
    old = encode("cdr", RANGE, {"range": 1.5})
    new = old + b"\0\0\x80\x3e"  # 0.25 as float32
    decode = decoder_for(RANGE, "")
    assert (decode(old).range, hasattr(decode(old), "variance")) == (1.5, False)
    assert (decode(new).range, decode(new).variance) == (1.5, 0.25)
    with pytest.raises(DecodeError, match=f"{len(old) - 4} bytes are not a valid {RANGE}"):
        decode(old[:-4])


def test_our_readers_say_the_hash_of_their_type_as_ros_expects(dds: Dds, heard: Ears, robot: Robot) -> None:
    dds.follow(frozenset({"/scan"}))
    publish_until(robot, lambda: heard.messages, "a scan came", "/scan", "LaserScan", [1.0], 0.5)
    robot.do("subscribers", "/scan", "LaserScan")
    scan = "typehash=RIHS01_64c191398013af96509d518dac71d5164f9382553fce5c1f8cca5be7924bd828;"
    assert robot.heard() == [f"{scan}reader=robowidgets;"]


def test_a_publisher_is_reported_by_the_name_of_its_node(dds: Dds, heard: Ears, robot: Robot) -> None:
    robot.do("write", "/cmd_vel", "Twist", 0.0)
    robot.do("name", "/cmd_vel", "Twist", "/arena", "planner")
    named = Advert("/cmd_vel", TWIST, offered=True, wanted=False, publishers=("/arena/planner",), subscribers=())
    wait_for(lambda: heard.topics == [named], "its name is known")
    robot.do("stop", "/cmd_vel", "Twist")
    wait_for(lambda: heard.topics == [], "it is gone")


def test_a_node_is_reported_with_what_it_publishes_and_what_it_subscribes_to(
    dds: Dds, heard: Ears, robot: Robot
) -> None:
    robot.do("want_kept", "/cmd_vel", "Twist")
    robot.do("write", "/odom", "String", "here")
    robot.do("name", "/odom", "String", "/", "base")
    told = [
        Advert("/cmd_vel", TWIST, offered=False, wanted=True, subscribers=("/base",)),
        Advert("/odom", "std_msgs/msg/String", offered=True, wanted=False, publishers=("/base",), subscribers=()),
    ]
    wait_for(lambda: heard.topics == told, "its name is known on both")


@pytest.mark.parametrize("length", [16, 24])
def test_node_names_are_understood_from_any_distribution_and_other_messages_ignored(heard: Ears, length: int) -> None:
    session = _dds_session.DdsSession(DOMAIN, heard)
    key = bytes(range(16))
    gid = struct.pack(f"{length}s", key)
    name = struct.pack("<I2s2xI4s", 2, b"/", 4, b"nav")
    info = b"\0\1\0\0" + gid + struct.pack("<I", 1) + name + struct.pack("<II", 0, 1) + gid
    session._offers[UUID(bytes=key)] = _dds_session.Endpoint("/cmd_vel", TWIST, False, False, b"", None)
    samples = [[opaque(NODES_TYPE)(info)], [opaque(TWIST)(encode("cdr", TWIST, {}))]]

    for kind in (NODES_TYPE, TWIST):
        wish = _dds_session.Wish("ros_discovery_info", kind, True, False)
        readers = add_reader(session, wish, samples)
        session.pass_on(wish)
    readers.clear()
    session.look()
    assert heard.topics == [Advert("/cmd_vel", TWIST, offered=True, wanted=False, publishers=("/nav",), subscribers=())]
    assert heard.messages == []


def test_on_loopback_it_sends_from_there_and_listens_everywhere(heard: Ears) -> None:
    before = udp_addresses()
    dds = Dds(DOMAIN, interface="lo")
    dds.open(heard)
    wait_for(lambda: heard.connected, "it takes part")
    ours = udp_addresses() - before
    dds.close()
    assert {address for address, _ in ours} == {"0.0.0.0", "127.0.0.1"}
    first = 7400 + 250 * DOMAIN  # as in the documentation of the feed
    assert all(first <= port < first + 250 for address, port in ours if address == "0.0.0.0")


def test_twenty_opens_and_closes_leave_no_thread_no_socket_and_no_memory() -> None:
    there: list[weakref.ref[Dds]] = []

    def open_and_close() -> None:
        heard = Ears()
        dds = Dds(DOMAIN, interface="lo")
        dds.open(heard)
        dds.follow(frozenset({"/scan"}))
        wait_for(lambda: heard.connected, "it takes part")
        dds.close()
        there.append(weakref.ref(dds))

    open_and_close()
    held = memory()
    files, threads = len(os.listdir("/proc/self/fd")), len(os.listdir("/proc/self/task"))
    for _ in range(20):
        open_and_close()
    assert len(os.listdir("/proc/self/fd")) <= files
    # A joined thread has done its work, but the system may not have ended it yet.
    wait_for(lambda: len(os.listdir("/proc/self/task")) <= threads, "every thread has ended")
    gc.collect()
    assert [ref for ref in there if ref() is not None] == []
    assert memory() < held + 5e6


def test_closing_ends_the_participant_though_something_refers_to_it(heard: Ears) -> None:
    dds = Dds(DOMAIN, interface="lo")
    dds.open(heard)
    session = get_session(dds)
    participant = session._participant
    assert participant.guid
    dds.close()
    with pytest.raises(DDSException):
        _ = participant.guid
    again = Domain(DOMAIN, dds_robot.LOOPBACK)  # which raises while a domain remembers the robots that it had
    del again, session


def test_a_network_that_is_not_there_is_tried_again(heard: Ears) -> None:
    dds = Dds(DOMAIN, interface="nowhere0")
    dds.open(heard)
    wait_for(lambda: len(heard.lost) > 1, "it was tried again")
    dds.close()
    assert heard.connected == 0
    there = ", ".join(name for _, name in socket.if_nameindex())
    assert heard.lost[0] == f"this machine has no network interface 'nowhere0'; there are {there}"
    assert heard.pauses[1] > heard.pauses[0]


def test_an_address_of_no_interface_is_reported_with_the_existing_interfaces(heard: Ears) -> None:
    dds = Dds(DOMAIN, interface="192.0.2.1")
    dds.open(heard)
    wait_for(lambda: heard.lost, "it is reported")
    dds.close()
    assert heard.lost[0].startswith("this machine has no network interface '192.0.2.1'; there are ")


def test_a_domain_without_a_robot_says_what_to_compare_until_there_is_one(
    heard: Ears, start: Callable[..., Robot], monkeypatch: pytest.MonkeyPatch
) -> None:
    assert _ros2_common.ALONE + 0.5 < 2.0, "plus the longest wait for a change"
    monkeypatch.setattr(_ros2_common, "ALONE", 0.5)
    dds = Dds(DOMAIN, interface="lo")
    dds.open(heard)
    wait_for(lambda: heard.nobody or heard.topics is not None, "it is reported")
    first = 7400 + 250 * DOMAIN
    assert heard.nobody == (
        f"no robot in domain {DOMAIN}. Is {DOMAIN} the robot's ROS_DOMAIN_ID? Does a firewall block the UDP ports "
        f"{first} to {first + 249}? 'lo' reaches only this machine."
    )
    wait_for(lambda: heard.topics == [], "then the topics count as known")
    robot = start(lease="1s")  # after which others drop it, not after Cyclone's ten seconds
    publish_until(robot, lambda: heard.topics, "the robot is found", "/scan", "LaserScan", [1.0], 0.5)
    assert heard.nobody == ""
    robot.kill()
    wait_for(lambda: heard.topics == [], "it is gone")
    assert heard.nobody == "", "a known subscriber has the right settings"
    dds.close()


def test_on_other_interfaces_what_to_compare_names_them(monkeypatch: pytest.MonkeyPatch) -> None:
    names = [(1, "lo"), (2, "docker0"), (3, "wlan0"), (4, "eth0")]
    monkeypatch.setattr(socket, "if_nameindex", lambda: names)

    def advice(**chosen: str) -> str:
        return Dds(7, **chosen)._no_robot()

    network = "Is it in another network? Then use dds(7, interface='wlan0'). The interfaces are docker0, wlan0"
    assert advice().endswith(f" {network}, eth0.")
    assert advice(interface="eth0").endswith(f" {network}.")
    names[:] = names[:1]
    assert advice().endswith(" Does a firewall block the UDP ports 9150 to 9399?")


def test_wrong_arguments_are_refused_by_name() -> None:
    with pytest.raises(ValueError, match="domain: expected 0 to 232, as in ROS_DOMAIN_ID, got 233"):
        Dds(233)
    with pytest.raises(TypeError, match="domain: expected a whole number, as in ROS_DOMAIN_ID, got '0'"):
        Dds("0")  # type: ignore[arg-type]
    with pytest.raises(TypeError, match="interface: expected the name of a network interface, such as 'eth0', got 1"):
        Dds(interface=1)  # type: ignore[arg-type]


def test_names_of_dds_match_ros() -> None:
    assert (ros_topic("rt/a/scan"), ros_topic("rq/a/getRequest")) == ("/a/scan", "")
    assert ros_type("sensor_msgs::msg::dds_::LaserScan_") == SCAN
    assert ros_type("std_srvs::srv::dds_::Empty_Request_") == ""


def test_each_line_of_rosout_is_an_event(robot: Robot) -> None:
    events = EventsWidget()
    with Feed(Dds(DOMAIN, interface="lo")) as feed:
        feed.connect("/rosout", events)
        publish_until(robot, lambda: events.rows, "a line came", "/rosout", "Log", 20, "planner", "started")
        for i in range(50):
            robot.do("write", "/rosout", "Log", 30, "planner", f"no way {i}")
        wait_for(lambda: events.rows[-1].text == "no way 49", "the last line came")
    assert [row.text for row in events.rows if row.level == Level.WARN] == [f"no way {i}" for i in range(50)]
    assert {row.source for row in events.rows} == {"planner"}
    events.close()


def test_the_guard_of_another_kernel_is_another_publisher_and_ours_is_not(robot: Robot) -> None:
    told = "another node publishes /cmd_vel, too"
    with Feed(Dds(DOMAIN, interface="lo")) as feed:
        robot.hear("/cmd_vel", "Twist")
        wait_for(lambda: any(topic.name == "/cmd_vel" for topic in feed.topics), "the robot is found")
        for mark, is_other in ((MARK, False), ("robowidgets_guard_of_another_kernel", True)):
            with closing(Dds(DOMAIN, interface="lo", mark=mark)) as guard:
                ears = Ears()
                guard.open(ears)
                wait_for(lambda ears=ears: ears.topics, "the guard sees the robot")  # type: ignore[misc]
                guard.publish("/cmd_vel", TWIST, {"linear": {"x": 0.25}})
                assert robot.heard()["linear"]["x"] == 0.25
                if is_other:
                    wait_for(lambda: told in feed.drive_status, "it is reported")
                else:  # a writer that is created later is discovered later
                    robot.do("write", "/after", "Twist", 0.5)
                    wait_for(lambda: any(topic.name == "/after" for topic in feed.topics), "a later one is known")
                    assert told not in feed.drive_status


# -- recording ---------------------------------------------------------------------------------------------------------


def test_each_message_of_a_burst_is_recorded_or_counted(robot: Robot, tmp_path: Path) -> None:
    def send(readings: list[float]) -> None:
        robot.do("burst", "/scan", "LaserScan", readings)

    recorded = record_bursts(Dds(DOMAIN, interface="lo"), tmp_path / "run.mcap", send)
    assert len(recorded.there) + recorded.missing >= len(EVERY)
    assert recorded.there == sorted(set(recorded.there))
    assert len(recorded.there) > len(EVERY) / 2


@pytest.mark.parametrize(
    ("publishers", "subscriptions"), [(["write"], [False, True]), (["best_effort", "write"], [False, False])]
)
def test_recording_requests_lost_packets_again_if_each_publisher_can_repeat_them(
    publishers: list[str],
    subscriptions: list[bool],
    dds: Dds,
    heard: Ears,
    start: Callable[[], Robot],
) -> None:
    robots = [start() for _ in publishers]
    for do, robot in zip(publishers, robots, strict=True):
        message = [[1.0], 0.5] if do == "write" else []
        robot.do(do, "/scan", "LaserScan", *message)
    session = get_session(dds)
    wait_for(lambda: len(session._offers) == len(robots), "all are found")
    dds.follow(frozenset({"/scan"}), frozenset({"/scan"}))

    def asked() -> Any:
        robots[-1].do("reliable_subscribers", "/scan")
        return robots[-1].heard()

    wait_for(lambda: asked() == subscriptions, "both subscriptions are there: of the newest, and of each")
    publish_until(robots[-1], lambda: heard.replaced, "each comes", "/scan", "LaserScan", [1.0], 0.5)


def buffers() -> list[int]:
    """The sizes of the receive buffers of this process's UDP sockets."""
    sizes = []
    for number in os.listdir("/proc/self/fd"):
        try:
            one = socket.socket(fileno=os.dup(int(number)))
        except OSError:  # not a socket, or closed meanwhile
            continue
        with one:
            if one.type == socket.SOCK_DGRAM:
                sizes.append(one.getsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF))
    return sizes


@pytest.mark.skipif(sys.platform != "linux", reason="the limit of the system is read from Linux's /proc")
@pytest.mark.parametrize("interface", ["lo", None])
def test_the_system_is_asked_for_room_for_what_comes_while_python_is_busy(
    interface: str | None, heard: Ears, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("CYCLONEDDS_URI", raising=False)
    most = int(Path("/proc/sys/net/core/rmem_max").read_text())
    with closing(Dds(DOMAIN + 1, interface=interface)) as dds:
        dds.open(heard)
        wait_for(lambda: heard.connected, "it is connected")
        assert max(buffers()) == 2 * min(most, 16 * 2**20), "Linux counts twice the requested size"
    if interface is None:
        monkeypatch.setenv("CYCLONEDDS_URI", '<Internal><SocketReceiveBufferSize max="100kB"/></Internal>')
        gc.collect()
        with closing(Dds(DOMAIN + 1)) as dds:
            dds.open(heard)
            wait_for(lambda: heard.connected == 2, "it is connected")
            assert max(buffers()) == 2 * 100 * 1024, "the user's own setting counts"


def test_a_domain_that_the_program_uses_already_is_used_as_it_is(heard: Ears) -> None:
    program = Domain(DOMAIN + 1, dds_robot.LOOPBACK)
    with closing(Dds(DOMAIN + 1)) as dds:
        dds.open(heard)
        wait_for(lambda: heard.connected, "it is connected")
    del program


@pytest.mark.parametrize("full", ["MOST_UNREAD", "_DEEPEST"])
def test_what_does_not_fit_into_the_queue_is_counted(
    full: str, heard: Ears, robot: Robot, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_dds_session, full, 10)
    with closing(Dds(DOMAIN, interface="lo")) as dds:
        dds.open(heard)
        dds.follow(frozenset({"/scan"}), frozenset({"/scan"}))
        publish_until(robot, lambda: heard.messages and heard.replaced, "scans come", "/scan", "LaserScan", [1.0], 0.5)
        go_on = threading.Event()
        heard.then = lambda *_: go_on.wait(120)
        before = len(heard.replaced)
        robot.do("burst", "/scan", "LaserScan", [2.0] * 50)
        assert robot.heard() == "written"
        go_on.set()
        if full == "_DEEPEST":  # the number that DDS itself replaced is unknown
            wait_for(lambda: heard.missed["/scan"] >= 1, "it is reported")
            return
        wait_for(lambda: heard.missed["/scan"] >= 30, "the rest is counted")
        wait_for(lambda: len(heard.replaced) - before + heard.missed["/scan"] >= 50, "all are accounted for")
