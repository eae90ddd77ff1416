"""The pose of one frame of a robot in another, from the messages of tf and odometry."""

from __future__ import annotations

from math import cos, nan, pi, sin
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets.poses.frame_tree import FrameTree, Poses
from robowidgets.poses.live_frames import held_between, notes_on
from robowidgets.poses.transforms import PoseNumbers, Transform, transforms_of
from robowidgets.recording import open

from . import recorded
from .recorded import stamped

S = 1_000_000_000
STILL = np.zeros(1, np.int64)


def pose(x: float, y: float, yaw: float = 0.0) -> PoseNumbers:
    return x, y, 0.0, 0.0, 0.0, sin(yaw / 2), cos(yaw / 2)


def joint(parent: str, child: str, seconds: float, at: PoseNumbers, stamp: float = 0.0, **kind: bool) -> Transform:
    return Transform(parent, child, round(seconds * S), round(stamp * S), at, **kind)


def at(frames: FrameTree, frame: str, world: str, seconds: float, stamp: float = 0.0) -> tuple[float, float, float]:
    """X, y and yaw."""
    times, stamps = (np.array([round(value * S)], np.int64) for value in (seconds, stamp))
    (place,), (turn,) = frames.poses(frame, world, times, stamps)
    assert np.linalg.norm(turn) == pytest.approx(1)
    yaw = 2 * np.arctan2(turn[2], turn[3])
    return float(place[0]), float(place[1]), float((yaw + pi) % (2 * pi) - pi)


def test_between_two_messages_a_frame_is_between_their_poses_and_beyond_them_it_stays() -> None:
    frames = FrameTree([joint("odom", "base", 1, pose(0, 0)), joint("odom", "base", 3, pose(2, 4, pi / 2))])
    assert at(frames, "base", "odom", 2) == pytest.approx((1, 2, pi / 4))
    assert at(frames, "base", "odom", 0) == pytest.approx((0, 0, 0))
    assert at(frames, "base", "odom", 9) == pytest.approx((2, 4, pi / 2))


def test_between_far_turns_a_frame_turns_at_one_speed() -> None:
    frames = FrameTree([joint("odom", "base", 0, pose(0, 0)), joint("odom", "base", 4, pose(0, 0, 0.9 * pi))])
    assert [at(frames, "base", "odom", t)[2] for t in (1, 2, 3)] == pytest.approx([0.225 * pi, 0.45 * pi, 0.675 * pi])


class TestAGap:
    FRAMES = FrameTree(
        [
            joint("map", "odom", 0, pose(5, 0), static=True),
            *(joint("odom", "base", t, pose(t, 0)) for t in (3, 4, 14, 60)),
        ]
    )

    def held(self, seconds: float) -> str:
        return "; ".join(notes_on([held_between(self.FRAMES, "base", "map", round(seconds * S), None)]))

    def test_of_more_than_ten_seconds_is_not_interpolated(self) -> None:
        assert at(self.FRAMES, "base", "odom", 9)[0] == pytest.approx(9)
        assert at(self.FRAMES, "base", "odom", 40)[0] == 14
        assert at(self.FRAMES, "base", "odom", 60)[0] == 60

    def test_has_a_note_after_ten_seconds_and_a_static_transform_has_none(self) -> None:
        assert [self.held(t) for t in (0, 3, 9, 14, 24, 60, 70)] == [""] * 7
        assert self.held(40) == "tf odom → base is 26 s old"
        assert self.held(102) == "tf odom → base is 42 s old"
        assert held_between(self.FRAMES, "odom", "map", 900 * S, None) is None

    def test_before_the_first_message_has_a_note_too(self) -> None:
        late = FrameTree([joint("odom", "base", 30, pose(1, 0))])
        assert held_between(late, "base", "odom", 25 * S, None) is None
        assert notes_on([held_between(late, "odom", "base", 10 * S, None)]) == ["tf odom → base begins 20 s later"]

    def test_of_several_places_has_one_note_on_the_oldest(self) -> None:
        held = [held_between(self.FRAMES, "base", "map", t * S, None) for t in (80, 90, 85)]
        assert notes_on([None, *held]) == ["tf odom → base is 30 s old"]


def test_a_turn_goes_the_short_way_whatever_sign_its_quaternion_has() -> None:
    x, y, z, *turn = pose(0, 0, 0.2)
    frames = FrameTree([joint("odom", "base", 0, pose(0, 0)), joint("odom", "base", 2, (x, y, z, *(-q for q in turn)))])
    assert at(frames, "base", "odom", 1)[2] == pytest.approx(0.1, abs=1e-4)


def test_the_robots_own_clock_goes_before_the_clock_of_the_recorder() -> None:
    late = [joint("odom", "base", 10 + t, pose(t, 0), stamp=5 + t) for t in (0, 1, 2)]
    assert at(FrameTree(late), "base", "odom", 11.5, stamp=6)[0] == pytest.approx(1)
    assert at(FrameTree(late), "base", "odom", 11.5)[0] == pytest.approx(1.5)
    assert at(FrameTree(late[::-1]), "base", "odom", 11.5, stamp=6)[0] == pytest.approx(1)


def test_stamps_of_another_clock_are_not_taken_for_times() -> None:
    moving = [joint("odom", "base", 10 + t, pose(t, 0), stamp=5 + t) for t in (0, 1, 2)]
    assert at(FrameTree(moving), "base", "odom", 11.5, stamp=900_000)[0] == pytest.approx(1.5)


def test_of_two_parents_the_one_that_was_named_last_holds() -> None:
    said = [joint("odom", "base", 0, pose(9, 9)), *(joint("map", "base", t, pose(t, 0)) for t in (1, 3))]
    assert FrameTree(said).chain("base") == ["base", "map"]
    assert at(FrameTree(said), "base", "map", 2) == pytest.approx((2, 0, 0))


def test_a_scanner_stands_where_the_robot_is_and_turned_as_it_is_mounted() -> None:
    mounted = joint("base", "laser", 0, pose(1, 0, pi), static=True)
    frames = FrameTree([mounted, joint("odom", "base", 0, pose(5, 5, pi / 2), odometry=True)])
    assert frames.chain("laser") == ["laser", "base", "odom"]
    assert frames.odometry == ("odom", "base")
    assert at(frames, "laser", "odom", 7) == pytest.approx((5, 6, -pi / 2))
    assert frames.chain("camera") == ["camera"]


def test_tf_goes_before_odometry_that_says_the_same() -> None:
    said = [joint("odom", "base", 0, pose(9, 9), odometry=True), joint("odom", "base", 0, pose(1, 0))]
    assert at(FrameTree(said), "base", "odom", 0) == pytest.approx((1, 0, 0))


def test_odometry_of_a_frame_below_the_root_of_tf_moves_the_root() -> None:
    above = joint("footprint", "base", 0, pose(1, 0), static=True)
    frames = FrameTree([above, joint("odom", "base", 0, pose(5, 5, pi / 2), odometry=True)])
    assert frames.chain("base") == ["base", "footprint", "odom"]
    assert at(frames, "footprint", "odom", 0) == pytest.approx((5, 4, pi / 2))
    assert at(frames, "base", "odom", 0) == pytest.approx((5, 5, pi / 2))


def test_frames_that_hold_each_other_end_somewhere() -> None:
    frames = FrameTree([joint("a", "b", 0, pose(1, 0)), joint("b", "a", 0, pose(1, 0))])
    assert frames.chain("a") == ["a", "b"]


def test_a_pose_and_its_inverse_undo_each_other() -> None:
    turn = np.array([[0.1, -0.5, 0.3, 0.8]])
    there = Poses(np.array([[1.0, 2.0, 3.0]]), turn / np.linalg.norm(turn))
    places, turns = there.of(there.inverse())
    assert places == pytest.approx(np.zeros((1, 3)))
    assert np.abs(turns) == pytest.approx(np.array([[0, 0, 0, 1]]), abs=1e-12)


def message(turn: tuple[float, ...], x: float = 1.0) -> Any:
    stamp = SimpleNamespace(sec=3, nanosec=5)
    place, rotation = SimpleNamespace(x=x, y=2.0, z=0.0), SimpleNamespace(**dict(zip("xyzw", turn, strict=True)))
    transform = SimpleNamespace(translation=place, rotation=rotation)
    header = SimpleNamespace(stamp=stamp, frame_id="/base_link")
    return SimpleNamespace(transforms=[SimpleNamespace(header=header, child_frame_id="/laser", transform=transform)])


def test_a_transform_is_read_without_slashes_and_its_turn_made_one() -> None:
    (told,) = transforms_of(message((0.0, 0.0, 2.0, 0.0)), "/robot/tf_static", 7)
    assert told == Transform("base_link", "laser", 7, 3 * S + 5, (1, 2, 0, 0, 0, 1, 0), static=True)
    (told,) = transforms_of(message((0.0, 0.0, 0.0, 1.0)), "/tf", 7)
    assert not told.static


@pytest.mark.parametrize(("turn", "x"), [((0.0,) * 4, 1.0), ((0.0, 0.0, nan, 1.0), 1.0), ((0.0, 0.0, 0.0, 1.0), nan)])
def test_a_transform_that_says_no_pose_is_an_error_that_names_the_frames(turn: tuple[float, ...], x: float) -> None:
    with pytest.raises(ValueError, match="'/laser' in '/base_link' has no valid pose"):
        list(transforms_of(message(turn, x), "/tf", 7))


def test_the_other_transforms_of_a_message_come_before_the_error_of_one() -> None:
    right, wrong = (message((0.0, 0.0, 0.0, 1.0), x).transforms for x in (1.0, nan))
    found = []
    with pytest.raises(ValueError, match=r"has no valid pose: nan, 2.0, 0.0, with the quaternion 0.0, 0.0, 0.0, 1.0"):
        found.extend(transforms_of(SimpleNamespace(transforms=[*wrong, *right, *wrong, *right]), "/tf", 7))
    assert [told.pose[0] for told in found] == [1.0, 1.0]
    with pytest.raises(ValueError, match="expected a message like geometry_msgs/TransformStamped, got a dict with the"):
        list(transforms_of({"transforms": [{"child_frame_id": "laser"}]}, "/tf", 7))


def test_odometry_without_a_pose_is_left_out_and_reported(tmp_path: Path) -> None:
    def odometry(x: float) -> dict[str, Any]:
        pose = {"position": {"x": x}, "orientation": {"w": 1.0}}
        return {"header": stamped(S, "odom"), "child_frame_id": "base_link", "pose": {"pose": pose}}

    messages = [(second, "/odom", odometry(x)) for second, x in enumerate((1.0, nan, 3.0))]
    recorded.write(tmp_path / "bag", {"/odom": "nav_msgs/msg/Odometry"}, messages)
    with open(tmp_path / "bag") as recording:
        assert [told.pose[0] for told in recording.transforms()] == [1, 3]
        assert "the first at 1.00 s: 'base_link' in 'odom' has no valid pose" in " ".join(recording.problems)


def test_a_real_robot_has_its_scanner_behind_its_middle_and_turned_round(data: Path) -> None:
    with open(data / "good" / "neato_fsm") as recording:
        frames = FrameTree(recording.transforms())
        scans = recording.scans("/scan")
        assert frames.chain("base_laser_link") == ["base_laser_link", "base_link", "base_footprint", "odom"]
        robot = frames.poses("base_footprint", "odom", scans.times_ns, scans.stamps_ns)
        laser = frames.poses("base_laser_link", "odom", scans.times_ns, scans.stamps_ns)
    yaw = 2 * np.arctan2(robot.orientations[:, 2], robot.orientations[:, 3])
    # It is published twice, first with 0.1016 m: as in tf, the last message counts.
    behind = robot.positions[:, :2] - 0.084 * np.stack([np.cos(yaw), np.sin(yaw)], axis=1)
    assert laser.positions[:, :2] == pytest.approx(behind, abs=1e-5)
    turned = 2 * np.arctan2(laser.orientations[:, 2], laser.orientations[:, 3]) - yaw
    assert np.cos(turned) == pytest.approx(-np.ones(len(yaw)), abs=1e-6)


def test_a_carmen_log_has_its_path_in_its_odometry(data: Path) -> None:
    with open(data / "good" / "edmonton.log.gz") as recording:
        told = list(recording.transforms())
        assert len(told) == len(recording.speeds("ODOM")) == 6011
        assert {(each.parent, each.child, each.odometry) for each in told} == {("odom", "base_link", True)}
        steps = np.diff([each.pose[:2] for each in told], axis=0)
    assert 0 < np.hypot(*steps.T).max() < 1
