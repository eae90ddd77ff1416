"""The poses of the scans behind the one on show, and the spread of each ray."""

from __future__ import annotations

import re
from math import nan, pi
from types import SimpleNamespace

import numpy as np
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import Footprint, LaserWidget, PathWidget, Scan, screen, spread
from robowidgets.poses.recent import RecentPoses
from robowidgets.samples import Pose

from ... import map_scene as scene

S = 1_000_000_000
NAN = float("nan")


def scan(*ranges: float, stamp_ns: int | None = None) -> Scan:
    return Scan(np.array(ranges), -0.2, 0.1, 0.1, 10.0, stamp_ns=stamp_ns)


class TestPoses:
    def test_between_two_poses_the_robot_moves_steadily_and_turns_the_shorter_way(self) -> None:
        poses = RecentPoses()
        poses.add(Pose(0.0, 1.0, 3.0), 10.0, None)
        poses.add(Pose(1.0, 1.0, -3.0), 10.5, None)
        at = poses.at(10.25, None)
        assert at is not None
        assert at == pytest.approx((0.5, 1.0, pi))
        assert poses.at(11.4, None) == pytest.approx((1.0, 1.0, 2 * pi - 3.0)), "the last one holds for a second"
        assert poses.at(11.6, None) is None

    def test_the_place_between_poses_that_are_seconds_apart_is_unknown(self) -> None:
        poses = RecentPoses()
        poses.add(Pose(0.0, 0.0, 0.0), 0.0, None)
        poses.add(Pose(10.0, 0.0, 0.0), 10.0, None)
        assert poses.at(5.0, None) is None
        assert poses.at(9.0, None) == pytest.approx((9.0, 0.0, 0.0))
        assert poses.at(1.1, 5 * S) is None

    def test_stamps_count_where_all_have_some_of_one_clock(self) -> None:
        poses = RecentPoses()
        assert poses.at(0.0, None) is None
        poses.add(Pose(0.0, 0.0, 0.0), 10.0, 100 * S)
        poses.add(Pose(1.0, 0.0, 0.0), 11.0, 101 * S)
        assert poses.at(11.0, 100 * S) == (0, 0, 0)
        assert poses.at(11.0, 900 * S) == (1, 0, 0), "from another clock"
        assert poses.at(10.5, None) == (0.5, 0, 0)
        poses.add(Pose(nan, 0.0, 0.0), 11.5, 102 * S)
        poses.add(Pose(2.0, 0.0, 0.0), 12.0, None)
        assert poses.at(12.0, 100 * S) == (2, 0, 0), "one has no stamp"

    def test_a_clock_that_goes_back_starts_again(self) -> None:
        poses = RecentPoses()
        poses.add(Pose(5.0, 0.0, 0.0), 10.0, 100 * S)
        poses.add(Pose(1.0, 0.0, 0.0), 10.1, 50 * S)
        assert poses.at(10.0, 50 * S) == (1, 0, 0)


class TestTrail:
    def test_a_scan_is_placed_by_the_path_in_its_view_and_the_scanner_on_the_footprint(self) -> None:
        laser, path = LaserWidget(trail=5), PathWidget()
        path.update(
            {
                "header": {"stamp": {"sec": 7, "nanosec": 0}},
                "pose": {
                    "position": {"x": 1.0, "y": 2.0, "z": 0.0},
                    "orientation": {"x": 0, "y": 0, "z": 0.5**0.5, "w": 0.5**0.5},
                },
            }
        )
        laser.update(scan(1.0, stamp_ns=7 * S))
        assert "pose" not in laser.get_state()["_about"], "no path is in its view"
        screen(laser, path)
        laser.update(scan(1.0, stamp_ns=7 * S))
        assert laser.get_state()["_about"]["pose"] == pytest.approx([1.0, 2.0, pi / 2], abs=1e-5)
        laser.footprint = Footprint(radius=0.5, scanner=(0.2, 0.1, "180deg"))
        laser.update(scan(1.1, stamp_ns=7 * S))
        assert laser.get_state()["_about"]["pose"] == pytest.approx([0.9, 2.2, pi / 2], abs=1e-5)
        laser.trail = 0
        laser.update(scan(1.2, stamp_ns=7 * S))
        assert "pose" not in laser.get_state()["_about"]

    @pytest.mark.parametrize("wrong", [nan, None])
    def test_a_transform_without_a_pose_does_not_move_another_scanner(self, wrong: float | None) -> None:
        laser = LaserWidget(trail=5)
        laser.take_frames(scene.tf_of_rosbridge(("base_link", "wheel", wrong), ("odom", "laser", 0.5)))
        laser.update(Scan([1.0], 0.0, 0.1, 0.1, 9.0, stamp_ns=S, frame_id="laser"))
        assert laser.get_state()["_about"]["pose"] == [0.5, 0.0, 0.0]
        laser.close()

    def test_tf_of_the_scanner_on_the_robot_alone_does_not_place_scans(self) -> None:
        laser = LaserWidget(trail=5)
        laser.take_static_frames(scene.tf_of_rosbridge(("base_link", "laser", 0.5)))
        laser.update(Scan([1.0], 0.0, 0.1, 0.1, 9.0, frame_id="laser"))
        assert "pose" not in laser.get_state()["_about"]
        laser.take_frames(scene.tf_of_rosbridge(("odom", "base_link", 1.0)))
        laser.update(Scan([1.0], 0.0, 0.1, 0.1, 9.0, frame_id="laser"))
        about = laser.get_state()["_about"]
        assert (about["pose"], about["placed_by"]) == ([1.5, 0.0, 0.0], "tf")
        laser.close()

    def test_a_transform_that_is_old_when_the_scan_comes_has_a_note_unless_it_is_static(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        laser, moving = LaserWidget(trail=5), scene.tf_of_rosbridge(("odom", "base_link", 1.0))
        monkeypatch.setattr("robowidgets.laser.trail.time", SimpleNamespace(monotonic=lambda: -60.0))
        laser.take_static_frames(scene.tf_of_rosbridge(("base_link", "laser", 0.5)))
        laser.take_frames(moving)
        laser.update(Scan([1.0], 0.0, 0.1, 0.1, 9.0, frame_id="laser"))
        about = laser.get_state()["_about"]
        assert about["pose"] == [1.5, 0.0, 0.0]
        assert re.fullmatch(r"tf odom → base_link is \d+ s old", *about["notes"])
        monkeypatch.undo()
        laser.take_frames(moving)
        laser.update(Scan([1.0], 0.0, 0.1, 0.1, 9.0, frame_id="laser"))
        assert "notes" not in laser.get_state()["_about"]
        laser.close()

    def test_in_a_player_odometry_of_the_recording_places_each_scan(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            player = recording.show("/scan", scanogram=False)
            (view,) = player.views
            assert "pose" not in next(view.track.frames(5.0, 6.0)).about
            view.widget.trail = 10
            frames = list(view.track.frames(5.0, 6.0))
            odometry = recording.samples("/odom", frames[-1].seconds - 1e-3)
            near = next(odometry).sample.pose
            assert frames[-1].about["pose"] == pytest.approx(near, abs=0.05)
            assert frames[0].about["pose"] != frames[-1].about["pose"]
            player.close()

    @pytest.mark.parametrize(
        ("fields", "text"),
        [
            ({"trail": -1}, "'trail' trait of a LaserWidget instance should not be less than 0"),
            ({"trail": 101}, "should not be greater than 100"),
            ({"trail": 2.5}, "'trail' trait of a LaserWidget instance expected an int, not the float 2.5"),
            ({"spread": 1}, "spread: expected a number of scans, 2 or more, or 0 for none, got 1"),
        ],
    )
    def test_numbers_that_cannot_be_are_refused(self, fields: dict[str, object], text: str) -> None:
        with pytest.raises(TraitError, match=text):
            LaserWidget(**fields)


class TestSpread:
    def test_is_half_of_the_way_from_the_5th_to_the_95th_percentile_of_the_readings(self) -> None:
        noise = np.random.default_rng(1).normal(3.0, 0.01, (2000, 2))
        found = spread(scan(*row) for row in noise)
        low, high = np.percentile(noise, (5, 95), axis=0)
        assert found.dtype == np.float32
        assert found == pytest.approx((high - low) / 2, abs=1e-6)
        assert found == pytest.approx([0.0165, 0.0165], abs=1e-3), "1.6 standard deviations"

    def test_what_is_not_a_reading_is_left_out_and_one_reading_has_none(self) -> None:
        scans = [scan(1.0, 2.0, NAN, np.inf, 0.0), scan(1.0, NAN, NAN, 1.0, 20.0), scan(1.2, 2.2, -np.inf, NAN, 0.0)]
        assert spread(scans).tolist() == pytest.approx([0.09, 0.09, NAN, NAN, NAN], nan_ok=True)
        assert np.isnan(spread(scans[:1])).all()

    @pytest.mark.parametrize(
        ("scans", "error", "text"),
        [
            ([], ValueError, "spread: expected scans with the same number of rays, got none"),
            ([scan(1.0), scan(1.0, 2.0)], ValueError, "the same number of rays, got scans with 1 and 2"),
            ([[1.0, 2.0]], TypeError, r"expected scans, got list; of a recording, scans\[-50:\]\.spread\(\)"),
        ],
    )
    def test_other_things_are_refused(self, scans: list[Scan], error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            spread(scans)

    def test_scans_of_a_recording_have_it_too(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            last = recording.scans("/scan")[-50:]
            np.testing.assert_array_equal(last.spread(), spread(moment.sample for moment in last))
            assert recording.scans("/scan")[:0].spread().shape == (0,)
