"""The content of a file for Rerun, read by Rerun's own reader."""

from __future__ import annotations

import os
import resource
import sys
from collections.abc import Iterator
from itertools import islice, pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets.in_rerun.rerun_log import Log
from robowidgets.in_rerun.widget import _pieces
from robowidgets.poses.frame_tree import Poses, _rotated
from robowidgets.recording import Recording
from robowidgets.recordings import RecordingError, UnknownTopicError
from robowidgets.simulator import World

from ..cloud.test_cloud import cloud_message, points_of
from ..recordings.recorded import START_NS, stamped, write

chunk = pytest.importorskip("rerun.chunk", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")

SCAN = "/world/scans/scan"


class Read:
    """The columns of a ``.rrd`` file by entity."""

    def __init__(self, path: Path) -> None:
        self._chunks = list(chunk.RrdReader(path).stream().collect().stream())
        self.entities = {held.entity_path for held in self._chunks}

    def rows(self, entity: str, *names: str, static: bool = False) -> list[tuple[Any, ...]]:
        """The values of some columns, row by row, in the order of time."""
        rows: list[tuple[Any, ...]] = []
        for held in self._chunks:
            batch = held.to_record_batch()
            if held.entity_path == entity and held.is_static == static and set(names) <= set(batch.schema.names):
                rows += zip(*(batch.column(name).to_pylist() for name in names), strict=True)
        return rows if static else sorted(rows, key=lambda row: row[0])


@pytest.fixture(scope="module")
def recording() -> Iterator[Recording]:
    with robowidgets.open(robowidgets.SAMPLE) as opened:
        yield opened


@pytest.fixture(scope="module")
def drive(recording: Recording, tmp_path_factory: pytest.TempPathFactory) -> Read:
    path = tmp_path_factory.mktemp("rerun") / "drive.rrd"
    assert recording.to_rerun(path) == path
    return Read(path)


@pytest.mark.slow
@pytest.mark.versions
def test_a_point_for_each_ray_bears_its_index_and_stands_where_the_scan_has_it(
    drive: Read, recording: Recording
) -> None:
    rows = drive.rows(SCAN, "recording_time", "Points3D:positions")
    ((labels, shown),) = drive.rows(SCAN, "Points3D:labels", "Points3D:show_labels", static=True)
    scans = recording.scans("/scan")
    assert len(rows) == len(scans) == 581
    assert labels == [f"ranges[{i}]" for i in range(scans.ray_count)]
    assert shown == [False]
    seen = 0
    for (_, points), moment in zip(rows, scans, strict=True):
        assert len(points) == len(labels)
        for index in range(0, len(points), 50):
            point, ray = points[index], moment.sample[index]
            seen += ray.x is not None
            x, y = (np.nan if part is None else part for part in (ray.x, ray.y))
            assert point == pytest.approx([x, y, 0], abs=1e-5, nan_ok=True)
    assert seen > 1000


def test_times_match_the_recording_to_the_nanosecond(drive: Read, recording: Recording) -> None:
    rows = drive.rows(SCAN, "recording_time", "message_log_time")
    scans = recording.scans("/scan")
    assert [row[1].value for row in rows] == scans.times_ns.tolist()
    assert [row[0].value for row in rows] == (scans.times_ns - recording.start_ns).tolist()


@pytest.mark.slow
def test_scans_land_on_the_walls_of_the_house(drive: Read) -> None:
    world = World.rooms()
    names = ("recording_time", "Points3D:positions", "Transform3D:translation", "Transform3D:quaternion")
    for _, points, places, turns in drive.rows(SCAN, *names)[::20]:
        known = np.array([point for point in points if np.isfinite(point[0])])
        poses = Poses(np.repeat(places, len(known), axis=0), np.repeat(turns, len(known), axis=0))
        landed = poses.positions + _rotated(poses.orientations, known)
        away = [abs(world.clearance(x, y)) for x, y, _ in landed[::20]]
        assert np.median(away) < 0.03, away


def test_speeds_are_numbers_by_axis_and_a_command_holds_until_the_next(drive: Read, recording: Recording) -> None:
    for topic, holds in (("/odom", None), ("/cmd_vel", [2])):
        entity = f"/speeds{topic}/angular.z"
        rows = drive.rows(entity, "recording_time", "Scalars:scalars")
        speeds = recording.speeds(topic)
        assert [row[1][0] for row in rows] == speeds.angular[:, 2].tolist()
        assert [row[0].value / 1e9 for row in rows] == pytest.approx(speeds.seconds.tolist())
        ((name,),) = drive.rows(entity, "SeriesLines:names", static=True)
        assert name == [f"{topic} angular.z"]
        modes = drive.rows(entity, "SeriesLines:interpolation_mode", static=True)
        assert (modes[0][0] if modes else None) == holds


def test_each_touch_sensor_has_a_state_from_each_change_on(drive: Read, recording: Recording) -> None:
    touches = recording.touches("/bumper")
    for number, label in enumerate(touches.labels):
        rows = drive.rows(f"/touches/bumper/{label}", "message_log_time", "StateChange:state")
        told = {"free": 0, "touched": 1, "": 2}
        states = [told[row[1][0]] for row in rows]
        assert len(states) > 3
        assert all(one != other for one, other in pairwise(states))
        last = np.searchsorted([row[0].value for row in rows], touches.times_ns, side="right") - 1
        settled = np.append(np.diff(touches.times_ns) > 0, True)
        assert np.array(states)[last][settled].tolist() == touches.states[settled, number].tolist()


def test_the_path_goes_through_every_pose_of_the_odometry(drive: Read, recording: Recording) -> None:
    ((strips,),) = drive.rows("/world/path", "LineStrips3D:strips", static=True)
    told = [joint.pose[:3] for joint in recording.transforms()]
    assert len(told) == 1161
    assert np.array(strips[0]) == pytest.approx(np.array(told), abs=1e-5)
    robot = drive.rows("/world/robot", "recording_time", "Transform3D:translation")
    assert np.array([row[1][0] for row in robot]) == pytest.approx(np.array(told), abs=1e-5)


def test_what_is_not_known_is_reported(drive: Read, tmp_path: Path, data: Path) -> None:
    ((text,),) = drive.rows("/notes", "TextDocument:text", static=True)
    assert text == ["The pose of laser on the robot is unknown: its scans are drawn at base_link."]
    with robowidgets.open(data / "good" / "urg_681.bag") as still:
        still.to_rerun(tmp_path / "still.rrd")
    ((text,),) = Read(tmp_path / "still.rrd").rows("/notes", "TextDocument:text", static=True)
    assert text == ["Neither odometry nor tf has the pose of the robot: all scans are drawn at one place."]


def test_a_mounted_scanner_has_its_own_pose_and_no_note(tmp_path: Path, data: Path) -> None:
    with robowidgets.open(data / "good" / "neato_fsm") as real:
        real.to_rerun(tmp_path / "neato.rrd", "/scan", "/bump")
    read = Read(tmp_path / "neato.rrd")
    assert "/notes" not in read.entities
    assert {"/touches/bump/left_front", SCAN} <= read.entities
    assert not [entity for entity in read.entities if "stable" in entity or "odom" in entity]
    (first, *_) = read.rows(SCAN, "recording_time", "Transform3D:translation")
    assert first[1][0] == pytest.approx([2.42687, 4.09899, 0.166], abs=1e-4)


def test_what_a_page_gets_piece_by_piece_is_the_same(drive: Read, recording: Recording, tmp_path: Path) -> None:
    entities, rows = set(), []
    names = ("recording_time", "Transform3D:translation")
    for piece in _pieces(recording, ()):
        (tmp_path / "piece.rrd").write_bytes(piece)
        read = Read(tmp_path / "piece.rrd")
        entities |= read.entities
        rows += read.rows(SCAN, *names)
    assert entities == drive.entities
    assert rows == drive.rows(SCAN, *names)


def test_scans_of_several_ray_counts_keep_their_indices(tmp_path: Path, data: Path) -> None:
    changing = next(path for path in (data / "odd").iterdir() if path.name.startswith("every_ros2_type"))
    with robowidgets.open(changing) as odd:
        (topic,) = (topic.name for topic in odd.topics if topic.type == "sensor_msgs/msg/LaserScan")
        counts = sorted(len(moment.sample) for moment in odd.scans(topic))
        odd.to_rerun(tmp_path / "odd.rrd", topic)
    read = Read(tmp_path / "odd.rrd")
    (entity,) = (entity for entity in read.entities if entity.startswith("/world/scans/"))
    assert sorted(len(row[1] or ()) for row in read.rows(entity, "recording_time", "Points3D:positions")) == counts


@pytest.mark.skipif(sys.platform != "linux", reason="names of files are texts there")
def test_a_recording_whose_name_is_not_utf_8_is_written(tmp_path: Path) -> None:
    odd = tmp_path / os.fsdecode(b"Fahrt_\xfcber.mcap")
    odd.write_bytes(robowidgets.SAMPLE.read_bytes())
    with robowidgets.open(odd) as recording:
        assert recording.to_rerun(tmp_path / "a.rrd", "/odom").stat().st_size > 0


def test_only_a_file_for_rerun_is_replaced(recording: Recording, tmp_path: Path) -> None:
    own = tmp_path / "drive.mcap"
    own.write_bytes(robowidgets.SAMPLE.read_bytes())
    with (
        robowidgets.open(own) as copy,
        pytest.raises(ValueError, match=r"expected a name that ends in \.rrd, got .*mcap"),
    ):
        copy.to_rerun(copy.path)
    assert own.read_bytes() == robowidgets.SAMPLE.read_bytes()
    with pytest.raises(ValueError, match=r"to_rerun\(\): expected a name that ends in \.rrd, got '/scan'"):
        recording.to_rerun("/scan")


def test_a_file_is_replaced_when_the_new_one_is_whole(
    recording: Recording, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "drive.rrd"
    path.write_text("before")
    steps = Log.steps

    def interrupted(log: Log, stream: Any) -> Iterator[None]:
        yield from islice(steps(log, stream), 3)
        raise KeyboardInterrupt

    with monkeypatch.context() as context:
        context.setattr(Log, "steps", interrupted)
        with pytest.raises(KeyboardInterrupt):
            recording.to_rerun(path)
    assert [(file.name, file.read_text()) for file in tmp_path.iterdir()] == [("drive.rrd", "before")]

    recording.to_rerun(path)
    assert Read(path).entities > {SCAN}
    assert list(tmp_path.iterdir()) == [path]


@pytest.fixture
def small_disk() -> Iterator[None]:
    """Limit files to 100 kB, as on a full disk."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (100_000, before[1]))
    yield
    resource.setrlimit(resource.RLIMIT_FSIZE, before)


def test_a_disk_without_room_is_named_as_the_system_names_it(
    recording: Recording, tmp_path: Path, small_disk: None
) -> None:
    with pytest.raises(OSError, match=r"drive\.rrd was not written: File too large$"):
        recording.to_rerun(tmp_path / "drive.rrd")
    assert list(tmp_path.iterdir()) == []


def test_errors_match_show(recording: Recording, tmp_path: Path) -> None:
    with pytest.raises(UnknownTopicError, match=r"sample\.mcap has no topic '/scam'"):
        recording.to_rerun(tmp_path / "x.rrd", "/scam")
    assert not (tmp_path / "x.rrd").exists()
    with pytest.raises(FileNotFoundError, match="nowhere"):
        recording.to_rerun(tmp_path / "nowhere" / "x.rrd")
    closed = robowidgets.open(robowidgets.SAMPLE)
    closed.close()
    with pytest.raises(RecordingError, match="is closed: open it again"):
        closed.to_rerun(tmp_path / "x.rrd")


def test_all_points_of_a_cloud_keep_their_index_and_an_invalid_message_is_left_out(tmp_path: Path) -> None:
    points = points_of(4, [(axis, "f4") for axis in "xyz"])
    points["x"][1] = np.nan
    good, bad = cloud_message(points), cloud_message(points, data=np.zeros(1, np.uint8))
    kind = "sensor_msgs/msg/PointCloud2"
    messages = [(0, "/points", good), (1, "/points", bad), (2, "/points", good)]
    folder = write(tmp_path / "drive", {"/points": kind}, messages)
    with robowidgets.open(folder) as recording:
        for name, topics in (("all", ()), ("named", ("/points",))):
            read = Read(recording.to_rerun(tmp_path / f"{name}.rrd", *topics))
            rows = read.rows("/world/clouds/points", "recording_time", "Points3D:positions")
            assert [row[0].value for row in rows] == [0, 2_000_000_000]
            expected = np.column_stack([points[axis] for axis in "xyz"])
            assert all(np.array_equal(np.array(row[1]), expected, equal_nan=True) for row in rows)


def test_pictures_stand_in_space_where_their_camera_is_calibrated_and_its_place_known(tmp_path: Path) -> None:
    depth = np.array([[0, 1500, 2000], [1000, 65535, 7]], np.uint16)
    header = stamped(START_NS, "eye")
    image = {"header": header, "height": 2, "width": 3, "encoding": "16UC1", "step": 6, "data": depth.view(np.uint8)}
    image["data"] = image["data"].reshape(-1)
    k = np.array([500.0, 0, 1, 0, 600, 0.5, 0, 0, 1])
    info = {"header": header, "height": 2, "width": 3, "k": k, "p": np.zeros(12), "d": np.zeros(0)}
    place = {"translation": {"x": 0.5, "y": 0.0, "z": 1.0}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
    tf = {"transforms": [{"header": stamped(START_NS, "base_link"), "child_frame_id": "eye", "transform": place}]}
    jpeg = np.frombuffer(b"\xff\xd8\xff\xc0\x00\x11\x08\x00\x02\x00\x03" + bytes(9), np.uint8)
    topics = {
        "/eye/image": "sensor_msgs/msg/Image",
        "/eye/camera_info": "sensor_msgs/msg/CameraInfo",
        "/tf_static": "tf2_msgs/msg/TFMessage",
        "/rear/compressed": "sensor_msgs/msg/CompressedImage",
    }
    messages = [
        (0, "/tf_static", tf),
        (0, "/eye/camera_info", info),
        (1, "/eye/image", image),
        (2, "/eye/image", {**image, "data": jpeg[:1]}),
        (3, "/rear/compressed", {"header": header, "format": "jpeg", "data": jpeg}),
    ]
    with robowidgets.open(write(tmp_path / "drive", topics, messages)) as recording:
        read = Read(recording.to_rerun(tmp_path / "seen.rrd"))
    entity = "/world/cameras/eye\\/image"
    names = ("recording_time", "DepthImage:buffer", "DepthImage:meter", "Transform3D:translation")
    ((_, (pixels,), (meter,), (translation,)),) = read.rows(entity, *names)
    assert np.array_equal(np.frombuffer(bytes(pixels), np.uint16).reshape(2, 3), depth)
    assert (meter, translation) == (1000.0, [0.5, 0.0, 1.0])
    ((matrix,),) = read.rows(entity, "Pinhole:image_from_camera", static=True)
    assert np.reshape(matrix, (3, 3), "F").tolist() == [[500, 0, 1], [0, 600, 0.5], [0, 0, 1]]
    ((_, (blob,)),) = read.rows("/cameras/rear\\/compressed", "recording_time", "EncodedImage:blob")
    assert bytes(blob) == jpeg.tobytes()
