"""Overlays on the pictures of a camera, and the reasons for a missing one."""

from __future__ import annotations

import json
from contextlib import closing
from math import nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import (
    CameraInfo,
    CameraModel,
    ImageWidget,
    LaserWidget,
    Line,
    PlotWidget,
    Range,
    Scan,
    SonarWidget,
    SpeedWidget,
    screen,
)
from robowidgets.camera import BesidePictures, PictureView, about_overlay, cones
from robowidgets.feeds._frame_topics import _wanted
from robowidgets.feeds._topics import FeedTopic
from robowidgets.image.frames import ImageFrames
from robowidgets.kinds.choice import choose_widgets
from robowidgets.poses.frame_tree import Poses
from robowidgets.samples import Image, Pose
from robowidgets.screens.layout import on_one_screen
from robowidgets.widget.freezing import freeze_together

from ... import camera_drive, map_scene
from ..pages import get_edition, synced
from ..recordings import recorded

SECOND = 1_000_000_000
INFO = {
    "header": {"frame_id": "camera_optical_frame", "stamp": {"sec": 1, "nanosec": 0}},
    "width": 640,
    "height": 480,
    "k": [525.0, 0, 319.5, 0, 525, 239.5, 0, 0, 1],
}
TF = {
    "transforms": [
        {
            "header": {"frame_id": parent, "stamp": {"sec": 1, "nanosec": 0}},
            "child_frame_id": child,
            "transform": {
                "translation": dict(zip("xyz", place, strict=True)),
                "rotation": dict(zip("xyzw", turn, strict=True)),
            },
        }
        for parent, child, place, turn in (
            ("base_footprint", "laser", (0.1, 0.0, 0.2), (0.0, 0.0, 0.0, 1.0)),
            ("base_footprint", "camera_optical_frame", (0.2, 0.0, 0.5), (-0.5, 0.5, -0.5, 0.5)),
            ("base_footprint", "sonar_front", (0.2, 0.0, 0.1), (0.0, 0.0, 0.0, 1.0)),
        )
    ]
}


def scan_at(stamp_ns: int, distance: float = 2.0) -> Scan:
    ranges = np.full(61, distance, np.float32)
    return Scan(ranges, -0.6, 0.02, 0.1, 10.0, stamp_ns=stamp_ns, frame_id="laser")


def picture_at(stamp_ns: int) -> Image:
    return Image(np.zeros((480, 640), np.uint8), "mono8", stamp_ns, "camera_optical_frame")


def test_the_scan_nearest_to_the_picture_by_its_stamp_lies_over_it() -> None:
    beside = BesidePictures()
    view = PictureView((640, 480), "camera_optical_frame", 2 * SECOND, 0, rectified=True)
    assert beside.over(view) is None
    for tenths in (17, 19, 23):
        beside.scans.append((scan_at(tenths * SECOND // 10), tenths))
    nothing = beside.over(view)
    assert nothing is not None
    assert nothing.missing == ("no camera_info: the place of readings in the picture is unknown",)
    beside.info = CameraInfo(640, 480, np.array(INFO["k"]), frame_id="camera_optical_frame")
    assert beside.over(view).missing == ("no tf from laser to camera_optical_frame",)  # type: ignore[union-attr]
    widget = ImageWidget()
    widget.take_frames(TF)
    beside.frames = widget.beside.frames
    found = beside.over(view)
    assert found is not None
    assert found.scan is beside.scans[1][0]
    assert (found.missing, found.apart) == ((), -0.1)
    late = beside.over(view._replace(stamp_ns=5 * SECOND))
    assert late is not None
    assert late.scan is None
    assert late.missing == ("no scan within 1 s of the picture: the nearest is 2.7 s older",)
    widget.close()


@pytest.mark.parametrize("wrong", [nan, None])
def test_a_transform_without_a_pose_hides_no_other_sensor(wrong: float | None) -> None:
    with closing(ImageWidget()) as image:
        image.take_frames(map_scene.tf_of_rosbridge(("base_link", "wheel", wrong), ("base_link", "laser", 0.1)))
        assert image.beside.frames.chain("laser") == ["laser", "base_link"]


def test_odometry_joins_frames_as_an_object_and_as_a_dictionary_of_rosbridge() -> None:
    message = map_scene.odometry(Pose(1.0, 2.0, 0.0), 1.0)
    as_dictionary = json.loads(json.dumps(message, default=vars))
    for one in (message, as_dictionary, {"op": "publish", "msg": as_dictionary}):
        with closing(ImageWidget()) as image:
            image.take_frames(one)
            assert image.beside.frames.chain("base_link") == ["base_link", "odom"]


def test_a_message_that_joins_no_frames_is_left_out() -> None:
    with closing(ImageWidget()) as image:
        for one in ({"data": 1}, {"transforms": [{"child_frame_id": "laser"}]}, {"transforms": 5}, {"pose": None}, 3):
            image.take_frames(one)
        assert image.beside.frames.chain("laser") == ["laser"]


def test_the_page_gets_each_reading_in_the_picture_by_its_index() -> None:
    image, laser = ImageWidget(title="/camera/image_rect"), LaserWidget(title="/scan")
    screen(laser, image)
    laser.sectors["front"] = ("-5deg", "5deg")
    laser.draw("wall", Line((1.5, -0.2), (1.5, 0.2)))
    image.calibrate(INFO)
    image.take_frames(TF)
    image.take_scan(scan_at(SECOND))
    image.take_range("front", Range(1.0, 0.1, 4.0, frame_id="sonar_front"))
    image.update(picture_at(SECOND + SECOND // 20))
    image.send_newest()
    over: dict[str, Any] = image.get_state()["_about"]["over"]
    dots = np.array(over["dots"]).reshape(-1, 4)
    assert set(dots[:, 3]) == {2000}
    # Ray 30 points ahead: 1.9 m from the camera, 0.3 m below it.
    assert dots[dots[:, 0] == 30][0, 1:3] / 4 == pytest.approx([319.5, 239.5 + 525 * 0.3 / 1.9], abs=0.25)
    assert (over["apart"], over["laser"], "missing" in over) == (-0.05, laser.model_id, False)
    assert [one["kind"] for one in over["drawn"]] == ["area", "sector", "line", "cone", "arc"]
    image.overlay = False
    image.update(picture_at(2 * SECOND))
    image.send_newest()
    assert "over" not in image.get_state()["_about"]
    image.close()
    laser.close()


def test_a_feed_gives_an_image_what_lies_over_it() -> None:
    image = ImageWidget(title="/camera/image_raw")
    topics = [
        FeedTopic(name, kind, None, False, True, None)
        for name, kind in (
            ("/camera/camera_info", "sensor_msgs/msg/CameraInfo"),
            ("/other/camera_info", "sensor_msgs/msg/CameraInfo"),
            ("/scan", "sensor_msgs/msg/LaserScan"),
            ("/tf", "tf2_msgs/msg/TFMessage"),
            ("/tf_static", "tf2_msgs/msg/TFMessage"),
        )
    ]
    wanted = _wanted(topics, image)
    assert [(name, take.__name__) for name, take in wanted] == [
        ("/tf", "take_frames"),
        ("/tf_static", "take_static_frames"),
        ("/camera/camera_info", "calibrate"),
        ("/scan", "take_scan"),
    ]
    image.overlay = False
    assert _wanted(topics, image) == []
    image.close()


def test_the_pose_of_the_camera_may_be_given_by_hand_and_is_checked() -> None:
    with pytest.raises(TypeError, match="camera_pose: expected x, y, z, roll, pitch and yaw, got 3"):
        ImageWidget(camera_pose=3)
    image = ImageWidget(camera_pose=(0.1, 0, 0.3, 0, "10deg", 0))
    image.take_scan(scan_at(SECOND))
    image.calibrate(INFO)
    found = image.over_of(picture_at(SECOND), 0)["over"]
    assert len(found["dots"]) > 4 * 40
    assert about_overlay(image.beside.over(PictureView((640, 480), "", SECOND, 0, rectified=True)))["drawn"]  # type: ignore[arg-type]
    image.close()


def test_a_player_lays_the_nearest_scan_over_each_picture(tmp_path: Path) -> None:
    types = {
        "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
        "/camera/image_rect": "sensor_msgs/msg/Image",
        "/scan": "sensor_msgs/msg/LaserScan",
        "/tf_static": "tf2_msgs/msg/TFMessage",
    }

    def header(frame: str, tenths: int) -> dict[str, Any]:
        return {"frame_id": frame, "stamp": {"sec": 1, "nanosec": tenths * SECOND // 10}}

    def scan(tenths: int) -> dict[str, Any]:
        limits = {"angle_min": -0.6, "angle_increment": 0.02, "range_min": 0.1, "range_max": 10.0}
        return {"header": header("laser", tenths), **limits, "ranges": np.full(61, 2.0 + tenths, np.float32)}

    said: list[tuple[float, str, dict[str, Any]]] = [
        (0.0, "/tf_static", TF),
        (0.0, "/camera/camera_info", {**INFO, "k": np.array(INFO["k"])}),
        (0.1, "/scan", scan(1)),
        (0.4, "/scan", scan(4)),
    ]
    pixels = np.zeros(640 * 480, np.uint8)
    fields = {"height": 480, "width": 640, "encoding": "mono8", "step": 640, "data": pixels}
    said.append((0.5, "/camera/image_rect", {"header": header("camera_optical_frame", 5), **fields}))
    path = recorded.write(tmp_path / "seen", types, said)
    with robowidgets.open(path) as recording:
        (choice,) = choose_widgets(recording.topics, ["/camera/image_rect"])
        widget = choice.make()
        track = ImageFrames(recording, choice, widget)  # type: ignore[arg-type]
        *_, last = track.frames(0.0, 0.6)
    over = last.about["over"]
    assert {*over["dots"][3::4]} == {6000}
    assert (over["apart"], "missing" in over) == (-0.1, False)
    widget.close()


def test_sonars_without_tf_are_placed_by_readings_or_the_user_and_one_line_names_the_others() -> None:
    image, ring = ImageWidget(title="/camera/image_rect"), SonarWidget(poses={"front": (0.2, 0.0, 0.0)})
    screen(image, ring)
    image.calibrate(INFO)
    image.take_frames(TF)
    image.take_range("front", Range(1.0, 0.1, 4.0))
    image.take_range("told", Range(1.5, 0.1, 4.0, pose=Pose(0.2, 0.3, 0.0)))
    for name in ("lost", "lost too", "lost as well"):
        image.take_range(name, Range(1.0, 0.1, 4.0, frame_id=name))
    image.update(picture_at(SECOND))
    seen = image.seen
    assert seen is not None
    assert [one.name for one in seen.drawn if one.kind == "cone"] == ["front", "told"]
    assert seen.missing == ("no tf from lost to camera_optical_frame and 2 more",)
    for widget in (image, ring):
        widget.close()


def test_infrared_is_a_thin_cone() -> None:
    model = CameraModel(CameraInfo(640, 480, np.array(INFO["k"])))
    ahead = Poses(np.zeros((1, 3)), np.array([[-0.5, 0.5, -0.5, 0.5]])).inverse()
    found = {
        radiation: cones(model, {"": (Range(1.0, 0.1, 4.0, radiation=radiation), ahead)}, 0.26)[0].pieces[0]
        for radiation in ("ultrasound", "infrared")
    }
    widths = {radiation: np.ptp(cone[:, 0]) for radiation, cone in found.items()}
    assert 0 < widths["infrared"] < 0.3 * widths["ultrasound"]


def test_of_two_scanners_the_one_shown_next_to_it_lies_over_the_picture() -> None:
    image, laser = ImageWidget(title="/camera/image_raw"), LaserWidget(title="/tilt_scan")
    topics = dict.fromkeys(("/base_scan", "/tilt_scan"), "sensor_msgs/msg/LaserScan")
    ((base, _),) = image.topics_beside(topics)
    image.take_scan(scan_at(SECOND))
    screen(laser, image)
    ((tilt, _),) = image.topics_beside(topics)
    assert (base, tilt) == ("/base_scan", "/tilt_scan")
    assert not image.beside.scans  # its scans were of the other scanner
    image.calibrate(INFO)
    image.take_frames(TF)
    image.take_scan(scan_at(SECOND))
    assert image.over_of(picture_at(SECOND), 0)["over"]["laser"] == laser.model_id
    laser.title = "/points"
    assert "laser" not in image.over_of(picture_at(SECOND), 0)["over"]
    for widget in (image, laser):
        widget.close()


def test_a_recording_shows_its_camera_with_what_is_kept_on_the_laser_and_its_depth_as_a_laser(tmp_path: Path) -> None:
    path = camera_drive.write(tmp_path / "drive", 0.6)
    topics = ("/camera/image_raw", "/scan", "/sonar/front_3", "/camera/depth/image_rect_raw as laser")
    with robowidgets.open(path) as recording, closing(recording.show(*topics)) as player:
        image, laser, of_depth, ring = (
            next(view.widget for view in player.views if view.choice.topic == name)
            for name in ("/camera/image_raw", "/scan", "/camera/depth/image_rect_raw", "/sonar/front_3")
        )

        def told(topic: str) -> dict[str, Any]:
            view = next(view for view in player.views if view.choice.topic == topic)
            *_, last = view.track.frames(0.0, 0.6)
            return last.about

        over = told("/camera/image_raw")["over"]
        assert {one["kind"] for one in over["drawn"]} >= {"area", "cone"}
        assert (over["laser"], "missing" in over) == (laser.model_id, False)
        edition = get_edition(image)
        laser.sectors["near"] = ("-10deg", "10deg")
        assert get_edition(image) > edition  # the player sends its pictures again
        assert "near" in [one["name"] for one in told("/camera/image_raw")["over"]["drawn"]]
        # The page may turn it off and on again without Python.
        image.overlay = False
        assert "over" in told("/camera/image_raw")
        about = told("/camera/depth/image_rect_raw")
        assert about["made_of"] == ["row 119", "image.depth.flat[{number}]"]
        of_depth.rows = 20
        assert told("/camera/depth/image_rect_raw")["made_of"][0] == "rows 109 to 128"
        assert of_depth.scan.distance("front") > 0.45
        assert ring.ranges


def test_a_laser_says_what_it_needs_of_a_depth_image() -> None:
    laser = LaserWidget(rows=(0, 3))
    depth = Image(np.full((4, 8), 2000, np.uint16), "16UC1", depth_scale=0.001)
    with pytest.raises(ValueError, match="no camera_info: the angles of a depth image are unknown"):
        laser.update(depth)
    laser.calibrate({**INFO, "width": 8, "height": 4, "k": [8, 0, 3.5, 0, 8, 1.5, 0, 0, 1]})
    laser.update(depth)
    assert laser.scan is not None
    assert laser.scan.distance() == pytest.approx(2.0, abs=0.01)
    with pytest.raises(ValueError, match="a picture in mono8 has no distances"):
        laser.update(Image(np.zeros((4, 8), np.uint8), "mono8"))
    for rows in (0, (3, 3), (-1, 2), "3", (1, 2, 3), True):
        with pytest.raises(TraitError, match="rows"):
            laser.rows = rows
    laser.close()


def test_the_first_picture_stands_next_to_a_laser_that_stands_alone_and_others_below() -> None:
    laser, speed = LaserWidget(), SpeedWidget()
    images = [ImageWidget(), ImageWidget()]
    alone = on_one_screen([], [laser], [], images)
    assert alone == {"wides": [laser], "smalls": images[:1], "below": images[1:]}
    assert on_one_screen([], [laser], [speed], images) == {"wides": [laser], "smalls": [speed], "below": images}
    for widget in (laser, speed, *images):
        widget.close()


def test_a_picture_stands_in_a_group_with_a_plot_which_has_no_samples() -> None:
    image, laser, plot = ImageWidget(), LaserWidget(title="/scan"), PlotWidget("/imu.angular_velocity.z")
    freeze_together([image, laser, plot])  # as a player does
    assert synced(image, "_lasers") == ["/scan"]
    for widget in (image, laser, plot):
        widget.close()
