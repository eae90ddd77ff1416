"""The path of a robot: its poses, thinned, and the widget that shows them."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Sequence
from math import cos, nan, pi, sin
from typing import Any

import numpy as np
import pytest

from robowidgets import SAMPLE, PathWidget, Speed, open
from robowidgets.poses import path as _path
from robowidgets.poses.path import Path
from robowidgets.samples import Pose

from ..pages import synced
from ..waiting import wait_for


def pose_stamped(x: float, y: float, z: float, w: float) -> dict[str, object]:
    where = {"position": {"x": x, "y": y, "z": 0.0}, "orientation": {"x": 0.0, "y": 0.0, "z": z, "w": w}}
    return {"header": {"frame_id": "map", "stamp": {"sec": 5, "nanosec": 6}}, "pose": where}


def odometry(x: float, seconds: float) -> dict[str, object]:
    told = pose_stamped(x, 0.0, 0.0, 1.0)
    sec, nanosec = divmod(round(seconds * 1e9), 1_000_000_000)
    return {
        "header": {"frame_id": "odom", "stamp": {"sec": sec + 1, "nanosec": nanosec}},
        "pose": {"pose": told["pose"]},
        "twist": {"twist": {"linear": {"x": 0.0, "y": 0.0, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": 0.0}}},
    }


class TestPath:
    def test_its_last_point_moves_until_it_lies_a_step_away_from_the_one_before(self) -> None:
        path = Path()
        for i in range(101):
            path.add(i / 10, Pose(i / 200, 0.0, 0.1))
        at = path.points
        assert at[0].tolist() == [0.0, 0.0, 0.0, 0.1, 0.0]
        assert at[-1].tolist() == [10.0, 0.5, 0.0, 0.1, pytest.approx(0.5)]
        assert np.diff(at[:-1, 1]).min() >= path.step == 0.02
        assert 20 <= len(at) <= 26

    def test_standing_still_adds_no_points(self) -> None:
        path = Path()
        for i in range(1000):
            path.add(i, Pose(1.0, 2.0, i * 0.001))
        assert path.points[:, 0].tolist() == [0.0, 999.0]
        assert path.points[-1, 3] == 0.999

    def test_a_long_way_is_kept_whole_with_fewer_points_to_the_metre(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(_path, "MOST_POINTS", 100)
        path = Path()
        for i in range(5000):
            path.add(i, Pose(i * 0.02, 0.0, 0.0))
        at = path.points
        assert 50 <= len(at) <= 100
        assert (at[0, 0], at[-1, 0]) == (0, 4999)
        assert at[-1, 4] == pytest.approx(4999 * 0.02)
        assert np.diff(at[:, 1]).max() <= 2 * path.step

    def test_the_distance_driven_counts_every_pose_also_on_circles_smaller_than_a_step(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(_path, "MOST_POINTS", 100)
        path = Path()
        angles = np.arange(5000) * 0.05
        for i, angle in enumerate(angles.tolist()):
            path.add(i, Pose(0.3 * cos(angle), 0.3 * sin(angle), 0.0))
        at = path.points
        assert path.step > 0.6
        assert at[-1, 4] == pytest.approx(4999 * 2 * 0.3 * sin(0.025))
        assert np.diff(at[:, 4]).max() <= 2 * path.step
        assert np.diff(at[:, 0]).max() < 200

    def test_a_way_back_within_a_step_counts(self) -> None:
        path = Path()
        for i in range(201):
            path.add(i, Pose(0.005 * (i % 2), 0.0, 0.0))
        assert path.points[-1, 4] == pytest.approx(1.0)

    @pytest.mark.parametrize(("seconds", "metres"), [(0.05, 1.0), (0.5, 8.0), (-60.0, 1.0)])
    def test_a_jump_that_no_robot_drives_begins_a_new_stroke_and_adds_no_distance(
        self, seconds: float, metres: float
    ) -> None:
        path = Path()
        driven = [path.add(i / 20, Pose(i / 80, 0.0, 0.0), clock=i / 20) for i in range(1, 42)]
        assert not any(driven)
        end, clock = 41 / 80, 41 / 20 + seconds
        assert path.add(3.0, Pose(end + metres, 0.0, 0.0), clock=clock)
        for i in range(1, 41):
            assert not path.add(3 + i / 20, Pose(end + metres + i / 80, 0.0, 0.0), clock=clock + i / 20)
        x, way = path.points[:, 1], path.points[:, 4]
        (jump,) = np.flatnonzero(np.diff(x) > 0.1)
        assert (x[jump], x[jump + 1]) == (end, end + metres)
        assert way[jump + 1] == way[jump] == pytest.approx(0.5)
        assert way[-1] == pytest.approx(1.0)

    @pytest.mark.parametrize(
        ("speed", "hz"), [(0.0, 20), (1.0, 1), (2.0, 0.2), (33.0, 10)], ids=["still", "slow", "rare", "car"]
    )
    def test_what_a_robot_or_a_car_drives_is_one_stroke_also_when_poses_are_rare(self, speed: float, hz: float) -> None:
        path, x = Path(), 0.0
        for i in range(200):
            x += min(speed, 3.0 * i / hz) / hz  # it begins with 3 m/s² at most
            assert not path.add(i / hz, Pose(x, 0.0, 0.0), clock=i / hz)
        assert path.points[-1, 4] == pytest.approx(path.points[-1, 1] - path.points[0, 1])

    def test_a_car_that_comes_into_view_at_speed_is_one_stroke_from_its_second_pose_on(self) -> None:
        path = Path()
        assert [path.add(i / 10, Pose(1.5 * i, 0.2 * i, 0.0), clock=i / 10) for i in range(50)] == [
            i == 1 for i in range(50)
        ]

    def test_each_of_several_jumps_on_end_begins_a_stroke(self) -> None:
        path = Path()
        there = [(0, 0), (8, 0), (0, 0), (8, 0), (8, 9), (8, 9)]
        jumps = [path.add(i / 10, Pose(x, y, 0.0), clock=i / 10) for i, (x, y) in enumerate(there)]
        assert jumps == [False, True, True, True, True, False]

    def test_a_jump_is_still_seen_when_points_are_dropped(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(_path, "MOST_POINTS", 100)
        path = Path()
        for i in range(1000):
            path.add(i / 20, Pose(i * 0.02 + (5.0 if i > 500 else 0.0), 0.0, 0.0), clock=i / 20)
        x, way = path.points[:, 1], path.points[:, 4]
        assert np.flatnonzero(np.diff(x) > np.diff(way) + 0.15).size == 1
        assert way[-1] == pytest.approx(998 * 0.02)

    def test_where_only_its_arrival_is_known_a_pose_begins_no_stroke(self) -> None:
        path = Path()
        assert not any(path.add(i / 1e6, Pose(float(i), 0.0, 0.0)) for i in range(10))

    def test_a_pose_without_a_place_is_left_out(self) -> None:
        path = Path()
        path.add(0.0, Pose(nan, 0.0, 0.0))
        assert path.points.shape == (0, 5)


class TestWidget:
    def test_it_takes_poses_one_by_one_as_numbers_messages_and_speeds_with_odometry(self) -> None:
        path = PathWidget(title="/odom")
        path.update(x=1, y=2.0, yaw="90deg", time=0.5)
        assert path.pose is not None
        assert (path.pose.x, path.pose.y, path.pose.yaw, path.pose.time) == (1.0, 2.0, pi / 2, 0.5)
        path.update(pose_stamped(3.0, 4.0, 1.0, 0.0), time=1.0)
        assert (path.pose.x, path.pose.yaw, path.pose.frame_id, path.pose.stamp_ns) == (3.0, pi, "map", 5_000_000_006)
        path.update({"pose": pose_stamped(5.0, 4.0, 0.0, 2.0)}, time=1.5)
        path.update(Speed(pose=Pose(6.0, 4.0, 0.25)), time=2.0)
        assert path.points[:, [0, 1]].tolist() == [[0.5, 1.0], [1.0, 3.0], [1.5, 5.0], [2.0, 6.0]]
        assert repr(path) == "<PathWidget /odom: x 6.00 m, y 4.00 m at 2.00 s>"
        path.clear()
        path.update(x=0, y=0, time=0.0)
        assert path.points.shape == (1, 5)
        assert np.isnan(path.points[0, 3])

    def test_moments_of_a_recording_bring_their_times_and_others_are_timed_by_their_arrival(self) -> None:
        path = PathWidget()
        with open(SAMPLE) as recording:
            for moment in recording.samples("/odom", end=2.0):
                path.update(moment)
        assert path.pose is not None
        assert path.pose.time == moment.seconds
        other = PathWidget()
        other.update(x=0, y=0)
        other.update(x=1, y=0)
        times = other.points[:, 0]
        assert times[0] == 0.0 < times[1] < 10

    @pytest.mark.parametrize(
        ("message", "fields", "error", "text"),
        [
            (Speed(), {}, TypeError, "expected a message like nav_msgs/Odometry, .*; got a speed without odometry"),
            ({"ranges": [1.0]}, {}, TypeError, "with position and orientation; got a dict with the keys ranges"),
            (None, {}, TypeError, r"needs a message, or x and y in metres, as update\(x=1.0, y=0.5"),
            (None, {"x": 1, "y": nan}, ValueError, "y: expected a finite number of metres, got nan"),
            (None, {"x": 1, "y": 1, "theta": 2}, TypeError, "has no field 'theta'; it takes a message, or update"),
            (None, {"X": 1, "Y": 1}, TypeError, "has no field 'X', 'Y'; it takes a message"),
            (Speed(pose=Pose(0, 0, 0)), {"x": 1}, TypeError, "a message or fields, not both; got a message and x"),
            (None, {"x": 1, "y": 1, "time": 2.0}, ValueError, r"time: expected 3 s or later, got 2; clear\(\) starts"),
        ],
    )
    def test_what_is_not_a_pose_is_refused_and_the_path_stays(
        self, message: object, fields: dict[str, object], error: type[Exception], text: str
    ) -> None:
        path = PathWidget()
        path.update(x=0, y=0, time=3.0)
        with pytest.raises(error, match=text):
            path.update(message, **fields)
        assert len(path.points) == 1
        with pytest.raises(TypeError, match="takes one message, or numbers by name"):
            path.update(1.0, 2.0)

    def test_the_path_is_sent_with_the_poses_but_at_most_four_times_a_second(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        path = PathWidget()
        sent: list[int] = []

        def send(data: dict[str, Any], buffers: Sequence[bytes] = (), **_: object) -> None:
            names = [name for (name,) in data["buffer_paths"]]
            sent.extend(len(part) // 40 for name, part in zip(names, buffers, strict=True) if name == "_path")

        monkeypatch.setattr(path.comm, "send", send)
        began = time.monotonic()
        for i in range(50):
            path.update(x=i, y=0.0, time=i)
            path.send_newest()
        assert len(sent) <= 1 + (time.monotonic() - began) / 0.25
        wait_for(lambda: sent[-1:] == [50], "the rest follows")
        path.close()

    def test_the_page_gets_a_jump_by_the_stamps_of_odometry_together_with_the_pose_after_it(self) -> None:
        path = PathWidget(title="/odom")
        for i in range(20):
            path.update(odometry(0.01 * i, i / 20))
        path.send_newest()
        path.update(odometry(2.0, 1.0))
        path.send_newest()
        last = np.frombuffer(synced(path, "_path")).reshape(-1, 5)[-1]
        assert (last[1], last[4]) == (2.0, pytest.approx(0.19))
        path.close()

    def test_a_frozen_pose_is_the_one_on_show(self) -> None:
        path = PathWidget()
        path.update(x=1, y=0, yaw=0.5, time=1.0)
        path.paused = True
        path.update(x=2, y=0, time=2.0)
        assert path.frozen is not None
        assert (path.frozen.x, path.frozen.yaw, path.frozen.time) == (1.0, 0.5, 1.0)

    def test_in_a_callback_it_says_what_was_wrong(self, caplog: pytest.LogCaptureFixture) -> None:
        path = PathWidget(title="/odom")
        with caplog.at_level(logging.ERROR, "robowidgets"):
            thread = threading.Thread(target=path.update, args=({"ranges": []},))
            thread.start()
            thread.join()
        assert "PathWidget /odom: a message could not be shown: expected a message like nav_msgs" in caplog.text


def test_a_player_shows_the_path_of_the_whole_recording_and_the_pose_of_its_moment() -> None:
    with open(SAMPLE) as recording:
        player = recording.show(scanogram=False)
    view = next(view for view in player.views if isinstance(view.widget, PathWidget))
    path = view.widget
    player.seek(10.0)
    assert path.pose is not None
    assert path.pose.time == pytest.approx(10.0, abs=0.06)
    assert path.points[-1, 0] == pytest.approx(recording.duration, abs=0.2)
    frames = list(view.track.frames(5.0, 6.0))
    assert len(frames) == 21
    assert np.frombuffer(frames[-1].frame, "<f8")[4:7].tolist() == pytest.approx([frames[-1].seconds, *path_at(5.95)])
    player.close()


def path_at(seconds: float) -> tuple[float, float]:
    with open(SAMPLE) as recording:
        moment = recording.at("/odom", seconds)
        assert moment is not None
        x, y, _ = moment.sample.pose
        return x, y


def test_a_path_of_very_many_poses_goes_by_evenly_chosen_ones_from_start_to_end(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("robowidgets.path.frames.MOST_POSES", 100)
    monkeypatch.setattr("robowidgets.recordings.columns._store.BATCH_BYTES", 100_000)
    with open(SAMPLE) as recording:
        player = recording.show("/odom")
        times = recording.speeds("/odom").seconds
    points = next(view.widget for view in player.views if isinstance(view.widget, PathWidget)).points
    assert (points[0, 0], points[-1, 0]) == pytest.approx((times[0], times[-1]))
    assert 40 < len(points) < 150 < len(times)
    assert np.diff(points[:, 0]).max() < 10
    player.close()
