"""ROS 2 topics over Zenoh without ROS: a router and a robot in other processes, on loopback."""

from __future__ import annotations

import struct
from collections.abc import Callable, Iterator
from contextlib import closing
from typing import Any

import pytest

pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed: pip install eclipse-zenoh")
pytest.importorskip("zenoh_ros2_sdk", reason="the robot is not installed: pip install zenoh-ros2-sdk")

from robowidgets.feeds import _zenoh_session
from robowidgets.feeds._guard.mark import MARK
from robowidgets.feeds._ros2_types import hash_of
from robowidgets.feeds.middleware import FeedError, NotConnectedYetError
from robowidgets.feeds.zenoh import Zenoh, checked_locator
from robowidgets.messages.encoding import encode

from ...reserved import free_port
from ..waiting import wait_for
from .ears import Ears
from .processes import Process

SCAN, TWIST, STAMPED = "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped"
STRING, RANGE = "std_msgs/msg/String", "sensor_msgs/msg/Range"
VOLATILE, KEPT = "::,10:,:,:,,", ":1:,1:,:,:,,"


def moving(x: float) -> dict[str, Any]:
    vector = {"x": 0.0, "y": 0.0, "z": 0.0}
    return {"linear": vector | {"x": x}, "angular": vector}


Start = Callable[..., Process]


@pytest.fixture
def start() -> Iterator[Start]:
    """Starts processes, which end with the test, also if it fails."""
    there: list[Process] = []

    def start_one(script: str, *arguments: Any) -> Process:
        there.append(Process(script, *arguments))
        return there[-1]

    yield start_one
    for one in there:
        one.kill()


LIMITS = {name: getattr(_zenoh_session, name) for name in ("CONFIRM_TIMEOUT_S", "MATCH_TIMEOUT_S", "ROBOT_SILENCE")}


@pytest.fixture(autouse=True)
def patient(monkeypatch: pytest.MonkeyPatch) -> None:
    """A router on a busy machine may answer late: only tests of these limits have them."""
    for limit in (*LIMITS, "ROBOT_GONE"):
        monkeypatch.setattr(_zenoh_session, limit, 120.0)


@pytest.fixture
def port() -> int:
    return free_port()


def start_router(start: Start, port: int, *others: str) -> Process:
    router = start("zenoh_router.py", port, *others)
    assert router.heard() == "ready"
    return router


@pytest.fixture
def router(start: Start, port: int) -> Process:
    return start_router(start, port)


@pytest.fixture
def robot(start: Start, port: int, router: Process) -> Process:
    return start("zenoh_robot.py", port, 0)


@pytest.fixture
def heard() -> Ears:
    return Ears()


@pytest.fixture
def zenoh(port: int, heard: Ears, router: Process) -> Iterator[Zenoh]:
    zenoh = Zenoh(f"tcp/127.0.0.1:{port}")
    zenoh.open(heard)
    yield zenoh
    zenoh.close()


def until(robot: Process, condition: Callable[[], object], what: str, *do: Any) -> None:
    def done() -> bool:
        if condition():
            return True
        robot.do(*do)
        return False

    wait_for(done, what)


def obey(robot: Process, heard: Ears, kind: str = TWIST) -> None:
    """Make the robot report the speeds that it gets, and wait until it is discovered."""
    robot.do("hear", "/cmd_vel", kind)
    assert robot.heard() == "ready"
    wait_for(is_wanted(heard, "/cmd_vel", kind), "the subscriber is discovered")


def scan(count: int) -> dict[str, Any]:
    return {"header": {"frame_id": "laser"}, "angle_increment": 0.01, "range_max": 10.0, "ranges": [2.0] * count}


def is_wanted(heard: Ears, topic: str, kind: str = TWIST) -> Callable[[], bool]:
    return lambda: any((one.name, one.type, one.wanted) == (topic, kind, True) for one in heard.topics or ())


def test_a_scan_comes_with_its_topic_type_and_node(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/robot1/scan"}))
    write = ("write", "/robot1/scan", SCAN, scan(90), "front_laser", "/robot1")
    until(robot, lambda: heard.of("/robot1/scan"), "a scan comes", *write)
    assert len(heard.of("/robot1/scan")[0].ranges) == 90
    advert = next(one for one in heard.topics or () if one.name == "/robot1/scan")
    assert (advert.type, advert.offered, advert.publishers) == (SCAN, True, ("/robot1/front_laser",))
    robot.do("stop", "/robot1/scan", SCAN)
    wait_for(lambda: not heard.topics, "the topic is gone")


def test_only_the_domain_that_was_asked_for_is_listed(start: Start, router: Process, port: int, heard: Ears) -> None:
    robot = start("zenoh_robot.py", port, 3)
    robot.do("write", "/scan", SCAN, scan(3))
    other = Ears()
    with closing(Zenoh(f"127.0.0.1:{port}", 3)) as third, closing(Zenoh(f"127.0.0.1:{port}")) as first:
        third.open(other)
        first.open(heard)
        wait_for(lambda: other.topics, "the robot is discovered in its domain")
        wait_for(lambda: "no node of ROS 2 is in domain 0" in heard.nobody, "the hint comes")
        assert not heard.topics


def test_the_speed_and_the_zero_arrive_and_the_zero_is_confirmed_by_the_router(
    zenoh: Zenoh, heard: Ears, robot: Process
) -> None:
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    zenoh.publish("/cmd_vel", TWIST, moving(0.0))
    assert (robot.heard(), robot.heard()) == ([0.2, 0.0], [0.0, 0.0])


def test_a_stamped_speed_reaches_the_subscriber_of_its_type(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    obey(robot, heard, STAMPED)
    header = {"stamp": {"sec": 0, "nanosec": 0}, "frame_id": "base_link"}
    zenoh.publish("/cmd_vel", STAMPED, {"header": header, "twist": moving(0.3)})
    assert robot.heard() == [0.3, 0.0]
    with pytest.raises(NotConnectedYetError, match="/cmd_vel has no subscriber for geometry_msgs/msg/Twist yet"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.2))


def test_zero_is_repeated_because_nothing_confirms_it(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    zenoh.publish("/cmd_vel", TWIST, moving(0.0))
    assert [robot.heard() for _ in range(3)] == [[0.2, 0.0], [0.0, 0.0], [0.0, 0.0]]


def test_without_a_subscriber_speeds_are_refused_and_a_lost_zero_is_reported(
    zenoh: Zenoh, heard: Ears, robot: Process
) -> None:
    wait_for(lambda: heard.connected, "the router answers")
    with pytest.raises(NotConnectedYetError, match="no subscriber"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    assert robot.heard() == [0.2, 0.0]
    robot.kill()
    wait_for(lambda: not is_wanted(heard, "/cmd_vel")(), "the subscriber is gone")
    with pytest.raises(FeedError, match="has no subscriber any more"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    with pytest.raises(TimeoutError, match="got no zero"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.0))


def test_a_robot_that_comes_back_gets_the_zero_that_was_sent_meanwhile(
    zenoh: Zenoh, heard: Ears, robot: Process, start: Start, port: int
) -> None:
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    robot.kill()
    wait_for(lambda: not is_wanted(heard, "/cmd_vel")(), "the subscriber is gone")
    with pytest.raises(TimeoutError):
        zenoh.publish("/cmd_vel", TWIST, moving(0.0))
    again = start("zenoh_robot.py", port, 0)
    again.do("hear", "/cmd_vel", TWIST)
    assert (again.heard(), again.heard()) == ("ready", [0.0, 0.0])


def test_a_zero_right_before_closing_arrives(heard: Ears, robot: Process, port: int) -> None:
    robot.do("hear", "/cmd_vel", TWIST)
    assert robot.heard() == "ready"
    zenoh = Zenoh(f"tcp/127.0.0.1:{port}")
    zenoh.open(heard)
    wait_for(is_wanted(heard, "/cmd_vel"), "the subscriber is discovered")
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    zenoh.publish("/cmd_vel", TWIST, moving(0.0))
    zenoh.close()
    assert (robot.heard(), robot.heard()) == ([0.2, 0.0], [0.0, 0.0])


def test_a_router_that_is_killed_and_started_again_is_found_again(
    zenoh: Zenoh, heard: Ears, robot: Process, router: Process, start: Start, port: int
) -> None:
    zenoh.follow(frozenset({"/scan"}))
    robot.do("flood", "/scan", SCAN, 0.02, scan(9))
    robot.do("hear", "/cmd_vel", TWIST)
    assert robot.heard() == "ready"
    wait_for(lambda: heard.of("/scan") and is_wanted(heard, "/cmd_vel")(), "the robot is there")
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    assert robot.heard() == [0.2, 0.0]
    router.kill()
    wait_for(lambda: heard.lost, "the loss is reported")
    assert heard.lost[0] == "the Zenoh router has ended the connection"
    with pytest.raises(FeedError):
        zenoh.publish("/cmd_vel", TWIST, moving(0.3))
    wait_for(lambda: any("no Zenoh router answers at tcp/127" in one for one in heard.lost), "the next try fails")
    start_router(start, port)
    count = len(heard.messages)
    wait_for(lambda: len(heard.messages) > count and heard.connected > 1, "scans come again")
    wait_for(is_wanted(heard, "/cmd_vel"), "the subscriber is discovered again")
    zenoh.publish("/cmd_vel", TWIST, moving(0.4))
    wait_for(lambda: robot.heard() == [0.4, 0.0], "the robot obeys again")


def test_a_router_that_hangs_is_reported_and_does_not_confirm_zero(
    zenoh: Zenoh, heard: Ears, robot: Process, router: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    assert robot.heard() == [0.2, 0.0]
    router.freeze()
    for limit, seconds in {**LIMITS, "ROBOT_GONE": 2.0}.items():
        monkeypatch.setattr(_zenoh_session, limit, seconds)
    with pytest.raises(TimeoutError, match="has not confirmed zero"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.0))
    wait_for(lambda: heard.lost, "the loss is reported")
    assert heard.lost[0] == "the Zenoh router has not answered for 2 s"
    router.thaw()
    assert robot.heard() == [0.0, 0.0]
    wait_for(lambda: heard.connected > 1, "the router is found again")


def test_speeds_are_refused_while_the_router_does_not_answer(
    zenoh: Zenoh, heard: Ears, robot: Process, router: Process, monkeypatch: pytest.MonkeyPatch
) -> None:
    obey(robot, heard)
    zenoh.publish("/cmd_vel", TWIST, moving(0.2))
    assert robot.heard() == [0.2, 0.0]
    router.freeze()
    monkeypatch.setattr(_zenoh_session, "ROBOT_SILENCE", LIMITS["ROBOT_SILENCE"])
    wait_for(lambda: heard.unheard.get("/cmd_vel"), "the silence is reported")
    assert heard.unheard["/cmd_vel"] == "the Zenoh router does not answer: until it does, only zero is sent"
    with pytest.raises(FeedError, match=r"has not answered for .* s: until it does, only zero is sent"):
        zenoh.publish("/cmd_vel", TWIST, moving(0.3))
    router.thaw()
    monkeypatch.setattr(_zenoh_session, "ROBOT_SILENCE", 120.0)
    wait_for(lambda: not heard.unheard["/cmd_vel"], "the report ends")
    zenoh.publish("/cmd_vel", TWIST, moving(0.4))
    assert robot.heard() == [0.4, 0.0]
    assert not heard.lost


def test_a_topic_behind_a_second_router_is_reached(start: Start, router: Process, port: int, heard: Ears) -> None:
    far = free_port()
    start_router(start, far, f"tcp/127.0.0.1:{port}")
    robot = start("zenoh_robot.py", far, 0)
    with closing(Zenoh(f"tcp/127.0.0.1:{port}")) as zenoh:
        zenoh.open(heard)
        zenoh.follow(frozenset({"/scan"}))
        until(robot, lambda: heard.of("/scan"), "a scan comes", "write", "/scan", SCAN, scan(5))


def test_a_message_that_its_publisher_keeps_reaches_late_subscribers(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    raw = encode("cdr", STRING, {"data": "a map"})
    robot.do("put", "/map_name", STRING, hash_of(STRING), KEPT, raw.hex())
    wait_for(lambda: any(one.name == "/map_name" for one in heard.topics or ()), "the topic is listed")
    zenoh.follow(frozenset({"/map_name"}))
    wait_for(lambda: heard.of("/map_name"), "the kept message comes")
    assert heard.of("/map_name")[0].data == "a map"


def test_a_type_with_other_fields_under_the_same_name_is_reported_and_not_decoded(
    zenoh: Zenoh, heard: Ears, robot: Process
) -> None:
    zenoh.follow(frozenset({"/scan"}))
    until(robot, lambda: heard.troubles.get("/scan"), "it is reported", "put", "/scan", SCAN, "RIHS01_00", VOLATILE, "")
    assert "/scan comes as sensor_msgs/msg/LaserScan with other fields than known here" in heard.troubles["/scan"]
    assert "add_definitions(folder)" in heard.troubles["/scan"]
    assert not heard.of("/scan")


def test_the_report_of_other_fields_ends_with_their_publisher(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/name"}))
    put = ("put", "/name", STRING, "RIHS01_00", VOLATILE, "")
    until(robot, lambda: heard.troubles.get("/name"), "it is reported", *put)
    until(robot, lambda: heard.of("/name"), "a message comes", "write", "/name", STRING, {"data": "ok"})
    assert heard.troubles["/name"], "the other publisher is still there"
    robot.do("withdraw", "/name", STRING)
    wait_for(lambda: not heard.troubles["/name"], "the report ends")


def test_an_unknown_type_is_named(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/riddle"}))
    put = ("put", "/riddle", "nobody_msgs/msg/Riddle", "RIHS01_00", VOLATILE, "")
    until(robot, lambda: heard.troubles.get("/riddle"), "it is reported", *put)
    assert "/riddle comes as nobody_msgs/msg/Riddle, a type that is not known here" in heard.troubles["/riddle"]


def test_a_range_with_the_hash_of_its_fields_is_read(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/sonar"}))
    values = {"min_range": 0.1, "max_range": 4.0, "range": 1.5, "variance": 0.5}
    until(robot, lambda: heard.of("/sonar"), "it comes", "write", "/sonar", RANGE, values)
    assert heard.of("/sonar")[0].variance == 0.5


def test_a_range_of_humble_which_has_no_hashes_is_read(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/sonar"}))
    raw = b"\0\1\0\0" + struct.pack("<iII1sB2xffff", 0, 0, 1, b"\0", 0, 0.0, 0.1, 4.0, 1.5)
    put = ("put", "/sonar", RANGE, "TypeHashNotSupported", VOLATILE, raw.hex())
    until(robot, lambda: heard.of("/sonar"), "it comes", *put)
    assert heard.of("/sonar")[0].range == pytest.approx(1.5)


def test_a_truncated_message_is_reported_until_a_whole_one_comes(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/name"}))
    put = ("put", "/name", STRING, hash_of(STRING), VOLATILE)
    until(robot, lambda: heard.troubles.get("/name"), "it is reported", *put, "0001000009000000")
    assert "a message of /name cannot be read: 8 bytes are not a valid std_msgs/msg/String" in heard.troubles["/name"]
    until(robot, lambda: heard.of("/name"), "a whole one comes", *put, encode("cdr", STRING, {"data": "ok"}).hex())
    assert heard.troubles["/name"] == ""


def test_lost_messages_are_counted_if_each_is_wanted(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/name"}), frozenset({"/name"}))
    put = ("put", "/name", STRING, hash_of(STRING), VOLATILE, encode("cdr", STRING, {"data": "ok"}).hex())
    robot.do(*put)  # before a subscriber is there
    robot.do("wait_for_subscriber", "/name", STRING)
    robot.do(*put)
    wait_for(lambda: heard.of("/name"), "one comes")
    robot.do("skip", "/name", STRING, 7)
    robot.do(*put)
    wait_for(lambda: heard.missed["/name"] == 7, "the seven are counted")


@pytest.mark.slow
def test_messages_of_100_mb_come(zenoh: Zenoh, heard: Ears, robot: Process) -> None:
    zenoh.follow(frozenset({"/image"}))
    size = 100_000_000
    kind = "sensor_msgs/msg/Image"
    head = b"\0\1\0\0" + struct.pack("<iII2s2xIII6sBxII", 1, 2, 2, b"x", 1, size, 6, b"mono8", 0, size, size)
    put = ("put", "/image", kind, hash_of(kind), VOLATILE, head.hex(), size)
    robot.do(*put)  # before a subscriber is there
    robot.do("wait_for_subscriber", "/image", kind)
    robot.do(*put)
    wait_for(lambda: heard.of("/image"), "an image comes")
    assert len(heard.of("/image")[0].data) == size
    assert not heard.lost


def test_the_guard_of_another_kernel_is_another_publisher_and_ours_is_not(
    zenoh: Zenoh, heard: Ears, robot: Process, port: int
) -> None:
    obey(robot, heard)
    for mark in (MARK, "robowidgets_guard_of_another"):
        with closing(Zenoh(f"tcp/127.0.0.1:{port}", mark=mark)) as guard:
            ears = Ears()
            guard.open(ears)
            wait_for(is_wanted(ears, "/cmd_vel"), "the guard discovers the subscriber")
            guard.publish("/cmd_vel", TWIST, moving(0.1))
            assert robot.heard() == [0.1, 0.0]
            if mark == MARK:
                assert not next(one for one in heard.topics or () if one.name == "/cmd_vel").publishers
            else:
                wait_for(
                    lambda: any(one.publishers == ("/robowidgets_guard_of_another",) for one in heard.topics or ()),
                    "the other one is listed",
                )


def test_an_address_without_a_router_says_what_to_check(heard: Ears, port: int) -> None:
    with closing(Zenoh(f"127.0.0.1:{port}")) as zenoh:
        zenoh.open(heard)
        wait_for(lambda: heard.lost, "the failure is reported")
        assert heard.lost[0].startswith(f"no Zenoh router answers at tcp/127.0.0.1:{port}. Is the robot on")
        with pytest.raises(FeedError, match="is not connected"):
            zenoh.publish("/cmd_vel", TWIST, moving(0.0))


def test_a_name_that_cannot_be_resolved_is_reported(heard: Ears) -> None:
    with closing(Zenoh("tls/no-such-robot.invalid:7447")) as zenoh:
        zenoh.open(heard)
        wait_for(lambda: heard.lost, "the failure is reported")
        assert heard.lost[0] == "the name no-such-robot.invalid cannot be resolved; try the robot's IP address"


@pytest.mark.parametrize(
    ("given", "expected"),
    [
        ("robot", "tcp/robot:7447"),
        ("10.0.0.7:7448", "tcp/10.0.0.7:7448"),
        ("[::1]", "tcp/[::1]:7447"),
        ("tls/robot.local:7447", "tls/robot.local:7447"),
    ],
)
def test_the_address_may_be_short(given: str, expected: str) -> None:
    assert checked_locator(given) == expected


@pytest.mark.parametrize(
    "wrong",
    ["", "tcp/robot", "http://robot:7447", 'tcp/robot:7447"]', "tcp/a b:1", "robot:74477", "tcp/robot:0", 7447, None],
)
def test_wrong_arguments_are_refused_by_name(wrong: Any) -> None:
    with pytest.raises((TypeError, ValueError), match="locator: expected the address of the robot's Zenoh router"):
        Zenoh(wrong)
    with pytest.raises(ValueError, match="domain: expected 0 to 232"):
        Zenoh("robot", 233)


@pytest.mark.parametrize(
    "key",
    [
        "@ros2_lv/0/a/0/1/SS/%/%/node/%add/pkg::srv::dds_::Add_/RIHS01_1/::,1:,:,:,,",
        "@ros2_lv/0/a/0/0/NN/%/%/node",
        "@ros2_lv/0/a/0/1/MP/%/%/node/%x/no_type/RIHS01_1/::,1:,:,:,,",
        "@ros2_lv/0/a/0/1/MP/%/%/node/%x/pkg::msg::dds_::X_/RIHS01_1/",
        "@ros2_lv/0",
    ],
)
def test_tokens_of_services_nodes_and_other_texts_are_ignored(key: str) -> None:
    assert _zenoh_session._parse_token(key) is None
