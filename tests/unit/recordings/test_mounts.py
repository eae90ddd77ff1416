"""Scanners that are mounted turned on the robot of a recording: by tf or by hand, all angles are the robot's."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, inf, nan, pi, radians, sin
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import LaserWidget, Mount, Recording, conditions
from robowidgets.feeds import recording as play
from robowidgets.messages.standard import scan_message

from ... import camera_drive
from ..pages import parse_sample
from ..samples.test_mounts import HANGING, LEFT, own_scan, tf
from .recorded import START_NS, write

SCAN, TF, ODOM = "sensor_msgs/msg/LaserScan", "tf2_msgs/msg/TFMessage", "nav_msgs/msg/Odometry"
TYPES = {"/scan": SCAN, "/tf": TF, "/tf_static": TF}


@pytest.fixture
def turned(data: Path) -> Iterator[Recording]:
    with robowidgets.open(data / "reports/scanner_turned_on_the_robot/turned.mcap") as recording:
        yield recording


def fields(mount: Mount, seconds: float, wall: float = 0.75) -> dict[str, Any]:
    return scan_message(own_scan(mount, wall), START_NS + round(seconds * 1e9), "")[1]


def stamped(message: dict[str, Any], seconds: float) -> dict[str, Any]:
    whole = round(seconds * 1e9) + START_NS
    for one in message["transforms"]:
        one["header"]["stamp"] = {"sec": whole // 10**9, "nanosec": whole % 10**9}
    return message


def written(folder: Path, mount: Mount, *of_tf: tuple[float, str, dict[str, Any]]) -> Recording:
    """A recording of ten scans a second for ten seconds, of a scanner with a mount."""
    scans = [(0.1 * i, "/scan", fields(mount, 0.1 * i)) for i in range(100)]
    rows = sorted([*scans, *of_tf], key=lambda row: row[0])
    return robowidgets.open(write(folder / "drive", TYPES, rows))


def test_a_scanner_turned_by_static_tf_has_the_angles_of_the_robot_everywhere(turned: Recording) -> None:
    scan = turned.at("/scan", 5.0).sample
    assert (scan.distance("front"), scan.distance("right")) == (0.75, inf)
    assert (scan.mount.yaw, scan.mount.upside_down, scan.mount.by) == (pytest.approx(pi / 2), False, "tf")
    assert turned.scans().at(5.0).sample.at(0).index == 90, "the index of the array"
    assert turned.scans().angles[90] == pytest.approx(0, abs=1e-6)
    assert turned.scans().distances("front")[50] == 0.75
    (span,) = turned.find(conditions.nearest_below(1, "front"))
    assert (span.start, span.end) == (pytest.approx(4.1, abs=0.06), pytest.approx(5.9, abs=0.06))
    assert not turned.find(conditions.nearest_below(1, "right"))
    (by_function,) = turned.find(lambda scan: scan.distance("front") < 1)
    assert by_function.start == span.start
    assert turned.mount_of("rplidar_link").words == "turned 90.0° by tf"
    assert turned.mount_of("nowhere") is None


def test_many_recordings_are_searched_by_the_angles_of_each_robot(turned: Recording) -> None:
    found = robowidgets.find(conditions.nearest_below(1, "front"), turned.path, keep=False)
    assert [round(hit.start, 1) for hit in found] == [4.1]


def test_the_player_shows_the_robots_angles_and_says_so(turned: Recording) -> None:
    player = turned.show("/scan")
    laser = player.views[0].widget
    player.seek(5.0)
    assert laser.distance("front") == 0.75
    about, _ = laser.frame_of(turned.at("/scan", 5.0).sample)
    assert about["mount"]["words"] == "turned 90.0° by tf"
    player.close()


def test_a_mount_by_hand_holds_in_what_a_player_sends_ahead_and_on_pages(turned: Recording, tmp_path: Path) -> None:
    turned.mount("rplidar_link", "0deg")
    player = turned.show("/scan")
    with player._open_tracks() as (track,):
        timed = next(track.frames(5.0, 5.0))
    scan = parse_sample(player.views[0].widget, timed.frame, timed.about)
    assert scan.distance("right") == 0.75
    assert "words" not in timed.about.get("mount", {})
    assert "turned 90.0" not in player.to_html(tmp_path / "page.html").read_text()
    player.close()


def test_a_scan_made_of_a_depth_image_needs_no_recording_of_another_thread(tmp_path: Path) -> None:
    """A file that a thread opened to send frames ahead is closed again: the widget does not read from it."""
    recording = robowidgets.open(camera_drive.write(tmp_path / "drive"))
    player = recording.show("/camera/depth/image_rect_raw as scan")
    with player._open_tracks():
        pass
    (view,) = player.views
    now = next(view.track.frames(0.5, 0.5))
    player.seek(1.0)
    assert "error" not in now.about
    assert len(view.widget.scan) == 320
    player.close()


def test_a_played_recording_is_a_robot_with_the_same_angles(turned: Recording) -> None:
    laser = LaserWidget()
    with play(turned.path, speed=100, loop=True) as feed:
        feed.connect("/scan", laser)
        assert laser.wait(60).mount.words == "turned 90.0° by tf"
    laser.close()


def test_the_doctor_says_nothing_of_a_turn_that_tf_explains_and_shows_the_header(turned: Recording) -> None:
    report = turned.doctor()
    assert report.problems == ()
    assert report.topics[0].geometry.angle_min == pytest.approx(-pi)
    assert "-180.0° to 179.0°, turned 90.0° by tf" in str(report)


@pytest.mark.parametrize(
    ("yaw", "what"),
    [
        (0.0, "/scan: walls move as if the scanner were turned by about 90°, which tf does not contain"),
        (
            -pi / 2,
            "/scan: the scanner is turned -90.0° by hand, but walls move as if it were also turned by about 180°",
        ),
    ],
)
def test_the_doctor_says_that_walls_move_the_wrong_way(turned: Recording, yaw: float, what: str) -> None:
    turned.mount("rplidar_link", yaw)
    (problem,) = turned.doctor().problems
    assert problem.what == what


def test_a_mount_by_hand_comes_before_tf_and_is_taken_back(turned: Recording) -> None:
    turned.mount("/rplidar_link", "0deg")
    assert turned.at("/scan", 5.0).sample.distance("right") == 0.75
    assert turned.scans().at(5.0).sample.mount is None
    turned.mount("rplidar_link", None)
    assert turned.at("/scan", 5.0).sample.distance("front") == 0.75
    with pytest.raises(ValueError, match="yaw: expected radians within"):
        turned.mount("rplidar_link", 90)


def test_a_scanner_on_its_head_and_one_in_tf_that_is_not_static(tmp_path: Path) -> None:
    for name, mount, of_tf in (
        ("head", HANGING, [(0.0, "/tf_static", tf("laser", 0.0, pi))]),
        ("moving", LEFT, [(0.1 * i, "/tf", stamped(tf("laser", pi / 2), 0.1 * i)) for i in range(5, 100)]),
        ("late", LEFT, [(9.0, "/tf_static", tf("laser", pi / 2))]),
    ):
        with written(tmp_path / name, mount, *of_tf) as recording:
            assert set(recording.scans().distances("front").tolist()) == {0.75}, name


def test_a_scanner_that_moves_on_its_robot_has_the_angles_of_each_time(tmp_path: Path) -> None:
    """It looks ahead for five seconds, then to the left; the wall stays in the scanner's direction."""
    of_tf = [(0.05 * i, "/tf", stamped(tf("laser", 0.0 if i < 100 else pi / 2), 0.05 * i)) for i in range(200)]
    with written(tmp_path, Mount(), *of_tf) as recording:
        scans = recording.scans()
        assert (scans.distances("front") == 0.75).tolist() == [True] * 50 + [False] * 50
        assert scans.at(9.0).sample.distance("left") == 0.75
        assert recording.at("/scan", 9.0).sample.distance("left") == 0.75
        assert recording.mount_of("laser", 9.0).yaw == pytest.approx(pi / 2)


def test_without_a_transform_of_the_scanner_nothing_changes(tmp_path: Path) -> None:
    with written(tmp_path, LEFT, (0.0, "/tf_static", tf("camera", 1.0)), (0.0, "/tf", tf("wheel", 1.0))) as recording:
        scan = recording.scans()[0].sample
        assert (scan.distance("right"), scan.mount, scan.problems()) == (0.75, None, ())


def test_a_transform_without_a_pose_is_left_out_and_named(tmp_path: Path) -> None:
    with written(
        tmp_path, LEFT, (0.0, "/tf_static", tf("laser", nan)), (1.0, "/tf_static", tf("laser", pi / 2))
    ) as one:
        assert one.scans()[0].sample.distance("front") == 0.75
        assert any("/tf_static: messages that cannot be shown are left out" in problem for problem in one.problems)


def test_a_real_robot_whose_scanner_looks_backwards(data: Path) -> None:
    """The tf of a Neato turns its scanner by 180 degrees; then walls move as its odometry predicts."""
    with robowidgets.open(data / "good/neato_fsm") as recording:
        assert recording.scans("/scan")[0].sample.mount.words in ("turned 180.0° by tf", "turned -180.0° by tf")
        assert not [one for one in recording.doctor().problems if "walls" in one.what]


class TestDoctorWithoutTf:
    """A room of four walls, in which a robot drives straight and then turns on the spot."""

    @pytest.mark.parametrize(
        ("mount", "words"),
        [
            (Mount(), None),
            (Mount(pi / 2), "turned by about 90°"),
            (Mount(pi), "turned by about 180°"),
            (Mount(0.0, upside_down=True), "upside down"),
            (Mount(-pi / 2, upside_down=True), "upside down and turned by about -90°"),
        ],
    )
    def test_walls_tell_how_the_scanner_stands(self, tmp_path: Path, mount: Mount, words: str | None) -> None:
        rows: list[tuple[float, str, dict[str, Any]]] = []
        for i in range(120):
            x, yaw = (0.04 * min(i, 50), 0.05 * max(0, i - 50))
            rows.append((0.1 * i, "/odom", odometry(x, yaw, 0.1 * i)))
            rows.append((0.1 * i, "/scan", room(x, yaw, mount, 0.1 * i)))
        with robowidgets.open(write(tmp_path / "drive", {"/scan": SCAN, "/odom": ODOM}, rows)) as recording:
            told = [problem.what for problem in recording.doctor().problems if "walls" in problem.what]
            expected = f"/scan: walls move as if the scanner were {words}, which tf does not contain"
            assert told == ([expected] if words else [])
            if words:
                recording.mount("laser", mount.yaw, upside_down=mount.upside_down)
                assert not [problem for problem in recording.doctor().problems if "walls" in problem.what]


def odometry(x: float, yaw: float, seconds: float) -> dict[str, Any]:
    whole = START_NS + round(seconds * 1e9)
    pose = {"position": {"x": x, "y": 0.0}, "orientation": {"z": sin(yaw / 2), "w": cos(yaw / 2)}}
    stamp = {"sec": whole // 10**9, "nanosec": whole % 10**9}
    return {"header": {"frame_id": "odom", "stamp": stamp}, "child_frame_id": "base_link", "pose": {"pose": pose}}


def room(x: float, yaw: float, mount: Mount, seconds: float) -> dict[str, Any]:
    """The measurements of a scanner in a room from (-2, -1) to (4, 3)."""
    own = -pi + np.arange(360) * radians(1)
    world = np.array([mount.to_robot(angle) for angle in own]) + yaw
    with np.errstate(divide="ignore"):
        along = np.where(np.cos(world) > 0, (4 - x) / np.cos(world), (-2 - x) / np.cos(world))
        across = np.where(np.sin(world) > 0, 3 / np.sin(world), -1 / np.sin(world))
    scan = robowidgets.Scan(np.minimum(along, across), -pi, radians(1), 0.1, 12.0, frame_id="laser")
    return scan_message(scan, START_NS + round(seconds * 1e9), "")[1]
