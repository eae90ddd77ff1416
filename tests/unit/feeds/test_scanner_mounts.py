"""Scanners that are mounted turned on a running robot: tf is followed, and no note comes before the first scan."""

from __future__ import annotations

from math import inf, pi, radians
from typing import Any

import foxglove
import pytest

from robowidgets import LaserWidget, Scan, feeds
from robowidgets.behaviors import Drive, simulate
from robowidgets.feeds import Advert, Feed
from robowidgets.feeds._scanner_mounts import GRACE
from robowidgets.messages.standard import scan_message
from robowidgets.samples import Mount
from robowidgets.simulator import Robot, Scanner, World

from ..clocks import ManualClock
from ..samples.test_mounts import HANGING, LEFT, own_scan, tf
from ..waiting import wait_for
from .fox import serving
from .scripted import CMD_VEL, SCAN, Scripted

foxglove.set_log_level("CRITICAL")

TF = Advert("/tf", "tf2_msgs/msg/TFMessage")
STATIC = Advert("/tf_static", "tf2_msgs/msg/TFMessage")


def message(mount: Mount = LEFT, wall: float = 0.75) -> dict[str, Any]:
    return scan_message(own_scan(mount, wall), 0, "")[1]


class Heard(list[Any]):
    """The scans that a connected function got."""

    def take(self, scan: Any) -> None:
        self.append(scan)


@pytest.fixture
def clock() -> ManualClock:
    return ManualClock()


def test_a_scan_waits_for_tf_and_has_the_angles_of_the_robot_then(clock: ManualClock) -> None:
    script, laser, heard = Scripted(SCAN, TF, STATIC), LaserWidget(), Heard()
    raw: list[Any] = []
    missed: list[int] = []
    with Feed(script, clock=clock) as feed:
        feed.connect("/scan", laser, heard.take)
        feed.connection.attach("/scan", raw.append, missed.append)
        assert ("subscribe", "/tf_static") not in script.asked, "before the first message"
        for wall in (0.5, 0.75):
            script.listener.on_message("/scan", message(wall=wall))
        assert laser.scan is None
        assert len(raw) == 2, "subscribers that take each message, such as a recorder, do not wait"
        assert {("subscribe", "/tf_static"), ("subscribe", "/tf")} <= {*script.asked}
        script.listener.on_message("/tf_static", tf("laser", pi / 2))
        assert laser.distance("front") == 0.75
        assert laser.scan.mount.words == "turned 90.0° by tf"
        assert ("unsubscribe", "/tf") in script.asked, "static transforms give all mounts"
        wait_for(lambda: heard, "the function is called")
        assert heard[-1].distance("front") == 0.75
        assert feed.mount_of("laser").yaw == pytest.approx(pi / 2)
        script.listener.on_message("/scan", message(wall=1.5))
        assert laser.distance("front") == 1.5
    assert len(raw) == 3


def test_without_tf_nothing_waits_and_nothing_is_followed(clock: ManualClock) -> None:
    script, laser = Scripted(SCAN), LaserWidget()
    with Feed(script, clock=clock) as feed:
        feed.connect("/scan", laser)
        script.listener.on_message("/scan", message())
        assert laser.distance("right") == 0.75
        assert laser.scan.mount is None
        assert script.asked == [("subscribe", "/scan")]


def test_tf_that_does_not_name_the_scanner_delays_its_first_scans_alone(clock: ManualClock) -> None:
    script, laser, heard = Scripted(SCAN, STATIC), LaserWidget(), Heard()
    with Feed(script, clock=clock) as feed:
        feed.connect("/scan", laser)
        feed.connect("/scan", heard.take, each=True)
        script.listener.on_message("/tf_static", tf("camera", 1.0))
        for wall in (0.5, 0.75):
            script.listener.on_message("/scan", message(wall=wall))
        assert laser.scan is None
        clock.advance(GRACE)
        wait_for(lambda: laser.scan is not None, "nothing more is waited for")
        assert laser.distance("right") == 0.75
        wait_for(lambda: len(heard) == 2, "the function gets each")
        script.listener.on_message("/scan", message(wall=1.5))
        assert laser.distance("right") == 1.5
        script.listener.on_message("/tf_static", tf("laser", pi / 2))
        script.listener.on_message("/scan", message(wall=1.5))
        assert laser.distance("front") == 1.5, "tf came late"


def test_a_mount_that_moves_is_the_one_at_the_time_of_the_scan(clock: ManualClock) -> None:
    script, laser = Scripted(SCAN, TF, STATIC), LaserWidget()
    with Feed(script, clock=clock) as feed:
        feed.connect("/scan", laser)
        script.listener.on_message("/scan", message())
        script.listener.on_message("/tf", tf("laser", pi / 2))
        assert laser.distance("front") == 0.75
        script.listener.on_message("/tf", tf("laser", 0.0))
        script.listener.on_message("/scan", message())
        assert laser.distance("right") == 0.75
        assert ("unsubscribe", "/tf") not in script.asked


def test_a_mount_by_hand_comes_before_tf_and_waits_for_nothing(clock: ManualClock) -> None:
    script, laser = Scripted(SCAN, STATIC), LaserWidget()
    with Feed(script, clock=clock) as feed:
        feed.mount("laser", 0.0, upside_down=True)
        feed.connect("/scan", laser)
        script.listener.on_message("/scan", scan_message(own_scan(HANGING, at=90.0), 0, "")[1])
        assert laser.distance("left") == 0.75
        feed.mount("laser", None)
        assert feed.mount_of("laser") is None
        with pytest.raises(ValueError, match="yaw: expected radians within"):
            feed.mount("laser", 90)
        with pytest.raises(TypeError, match="frame_id: expected the name of a coordinate frame, got 5"):
            feed.mount(5, 0.0)  # type: ignore[arg-type]


@pytest.mark.slow
def test_over_foxglove_widget_loop_function_and_watch_have_the_angles_of_the_robot() -> None:
    types = {"/scan": SCAN.type, "/tf_static": STATIC.type}
    laser, heard = LaserWidget(), Heard()
    with serving(types) as (address, publish), feeds.foxglove(address) as feed:
        wait_for(lambda: len(feed.topics) == 2, "its topics are listed")
        feed.connect("/scan", laser, heard.take)
        watch = feed.watch(lambda scan: scan.distance("front") < 1, "wall")

        def send() -> bool:
            publish("/tf_static", tf("laser", pi / 2))
            publish("/scan", message())
            return laser.scan is not None and bool(heard) and watch.value is not None

        wait_for(send, "the scan came")
        assert laser.distance("front") == pytest.approx(0.75)
        assert heard[0].distance("front") == pytest.approx(0.75)
        assert watch.value is True
        scans = feed.scans("/scan", timeout=30)
        publish("/scan", message())
        wait_for(lambda: publish("/scan", message()) is None and feed.connection.connected["/scan"], "it is connected")
        assert next(scans).distance("front") == pytest.approx(0.75)


@pytest.mark.parametrize("mount", [LEFT, HANGING, Mount(radians(160), upside_down=True)])
def test_a_program_of_a_robot_with_a_turned_scanner_stops_before_the_wall(mount: Mount) -> None:
    script = Scripted(SCAN, STATIC, CMD_VEL)
    with Feed(script) as feed:
        seen: list[float] = []

        def behave(scan: Scan) -> Drive:
            seen.append(scan.distance("front"))
            return Drive(0.2 if scan.distance("front") > 0.5 else 0.0)

        feed.program(behave)
        roll = pi if mount.upside_down else 0.0
        script.listener.on_message("/scan", message(mount, wall=3.0))
        assert seen == [], "not by a scan of unknown direction"
        script.listener.on_message("/tf_static", tf("laser", mount.yaw, roll))
        wait_for(lambda: (0.2, 0.0) in script.speeds, "it drives")

        def comes_near() -> bool:
            script.listener.on_message("/scan", message(mount, wall=0.4))
            return script.speeds[-1] == (0.0, 0.0)

        wait_for(comes_near, "it stops")
        assert {round(distance, 3) for distance in seen} == {3.0, 0.4}


@pytest.mark.parametrize("scanner", [{"mount": (0.0, 0.0, pi / 2)}, {"mount": (0.0, 0.0, 2.0), "upside_down": True}])
def test_simulate_stops_before_the_wall_too(scanner: dict[str, Any]) -> None:
    robot = Robot(World([(2.0, -3.0, 2.0, 3.0)]), scanner=Scanner(360, 2 * pi, **scanner), seed=1)
    for _ in simulate(lambda scan: Drive(0.3 if scan.distance("front") > 0.5 else 0.0), robot, 20.0):
        pass
    assert 1.3 < robot.pose.x < 1.6
    assert robot.scan().distance("back") == inf
