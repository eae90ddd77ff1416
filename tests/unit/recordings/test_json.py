"""Recordings whose messages are in JSON or in protobuf, with schemas of Foxglove or ROS, or without a schema."""

from __future__ import annotations

import base64
import json
from collections.abc import Iterable, Mapping
from math import isnan
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer

import robowidgets
from robowidgets.files import _plain
from robowidgets.messages import protobuf, to_cloud, to_image
from robowidgets.messages.json_shape import JsonShape, field_name

START_NS = 1_700_000_000_000_000_000
STAMP = {"sec": 1_700_000_000, "nsec": 5}


def write(path: Path, topics: Mapping[str, tuple[str, Iterable[Any]]]) -> Path:
    """A file of messages in JSON, ten per second; each topic has the name of its schema, which may be empty."""
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("", "test")
        for topic, (name, messages) in topics.items():
            schema = writer.register_schema(name, "jsonschema", b"{}") if name else 0
            channel = writer.register_channel(topic, "json", schema)
            for i, message in enumerate(messages):
                raw = message if isinstance(message, bytes) else json.dumps(message).encode()
                writer.add_message(channel, START_NS + i * 10**8, raw, START_NS)
        writer.finish()
    return path


def read(path: Path, topic: str) -> list[Any]:
    with robowidgets.open(path) as recording:
        return [one.message for one in recording.messages(topic)]


POSE = {"position": {"x": 1.0, "y": 2.0, "z": 3.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
SENSED = {"timestamp": STAMP, "frame_id": "sensor"}


class TestFoxglovesSchemas:
    def test_a_scan_is_one_of_a_laser(self, tmp_path: Path) -> None:
        scan = {**SENSED, "start_angle": -1.0, "end_angle": 1.0, "ranges": [1.0, 2.0, 3.0], "intensities": []}
        with robowidgets.open(write(tmp_path / "x.mcap", {"/scan": ("foxglove.LaserScan", [scan] * 4)})) as recording:
            (topic,) = recording.topics
            assert (topic.type, topic.widget, topic.count) == ("sensor_msgs/msg/LaserScan", "laser", 4)
            scans = recording.scans()
            assert scans.ranges.tolist() == [[1.0, 2.0, 3.0]] * 4
            first = next(iter(recording.samples("/scan"))).sample
            assert (first.angle_min, first.angle_increment, first.range_max) == (-1.0, 1.0, np.finfo(np.float32).max)
            assert (first.frame_id, first.stamp_ns) == ("sensor", START_NS + 5)
            assert "!" not in recording.info()

    def test_a_pose_a_fix_and_a_transform_have_their_places(self, tmp_path: Path) -> None:
        fix = {**SENSED, "latitude": 52.0, "longitude": 4.0, "altitude": 1.0, "position_covariance_type": "KNOWN"}
        turn = {"translation": {"x": 1.0, "y": 0.0, "z": 0.0}, "rotation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}}
        frame = {"timestamp": STAMP, "parent_frame_id": "map", "child_frame_id": "base", **turn}
        path = write(
            tmp_path / "x.mcap",
            {
                "/pose": ("foxglove.PoseInFrame", [{**SENSED, "pose": POSE}]),
                "/fix": ("foxglove.LocationFix", [fix]),
                "/tf": ("foxglove.FrameTransform", [frame]),
                "/more": ("foxglove.FrameTransforms", [{"transforms": [frame, frame]}]),
            },
        )
        with robowidgets.open(path) as recording:
            pose, place = (recording.message_at(topic, 1.0).message for topic in ("/pose", "/fix"))  # type: ignore[union-attr]
            assert (pose.pose.position.y, pose.header.frame_id) == (2.0, "sensor")
            assert (place.latitude, place.longitude, place.position_covariance_type) == (52.0, 4.0, 3)
            found = [(one.parent, one.child, one.pose[0]) for one in recording.transforms()]
            assert found == [("map", "base", 1.0)] * 3

    def test_lines_of_a_log_have_their_levels(self, tmp_path: Path) -> None:
        lines = [
            {"timestamp": STAMP, "level": level, "message": f"line {level}", "name": "node", "file": "", "line": 0}
            for level in (2, 4, "WARNING")
        ]
        with robowidgets.open(write(tmp_path / "x.mcap", {"/log": ("foxglove.Log", lines)})) as recording:
            assert [(one.level.name, one.text) for one in recording.events()] == [
                ("INFO", "line 2"),
                ("ERROR", "line 4"),
                ("WARN", "line WARNING"),
            ]

    def test_pictures_and_clouds_have_their_bytes(self, tmp_path: Path) -> None:
        pixels = np.arange(6, dtype=np.uint8)
        raw = {**SENSED, "height": 2, "width": 3, "step": 3, "encoding": "mono8"}
        points = np.array([[1, 2, 3], [4, 5, 6]], np.float32)
        fields = [{"name": axis, "offset": 4 * i, "type": 7 if i else "FLOAT32"} for i, axis in enumerate("xyz")]
        cloud = {**SENSED, "point_stride": 12, "fields": fields, "data": base64.b64encode(points.tobytes()).decode()}
        path = write(
            tmp_path / "x.mcap",
            {
                "/image": ("foxglove.RawImage", [{**raw, "data": base64.b64encode(pixels.tobytes()).decode()}]),
                "/cloud": ("foxglove.PointCloud", [cloud]),
            },
        )
        assert to_image(read(path, "/image")[0]).pixels.tolist() == [[0, 1, 2], [3, 4, 5]]
        found = to_cloud(read(path, "/cloud")[0])
        assert (found.x.tolist(), found.z.tolist()) == ([1.0, 4.0], [3.0, 6.0])


class TestOtherJson:
    def test_of_a_type_of_ros_is_that_type(self, tmp_path: Path) -> None:
        scan = {"angle_min": -1.0, "angle_increment": 0.1, "range_max": 9.0, "ranges": [1.0, None, 2.0]}
        path = write(tmp_path / "x.mcap", {"/scan": ("sensor_msgs/LaserScan", [scan] * 3)})
        with robowidgets.open(path) as recording:
            ranges = recording.scans().ranges
        assert ranges[0, ::2].tolist() == [1.0, 2.0]
        assert isnan(ranges[0, 1])

    def test_of_no_type_has_the_fields_of_its_messages(self, tmp_path: Path) -> None:
        messages = [
            {"battery": 12, "mode": "drive", "pose": {"x": i / 2, "on": True}, "class": 1, "list": [1, 2], "parts": []}
            for i in range(5)
        ]
        messages += [{"battery": None, "mode": None, "late": 5, "parts": [{"name": "arm", "t": {"sec": 1, "nsec": 2}}]}]
        with robowidgets.open(write(tmp_path / "x.mcap", {"/state": ("", messages)})) as recording:
            fields = recording.fields("/state")
            assert fields["pose.x"].tolist()[:5] == [0.0, 0.5, 1.0, 1.5, 2.0]
            assert isnan(fields["battery"][5])
            assert isnan(fields["late"][0])
            assert fields["late"][5] == 5
            *_, last = recording.messages("/state")
            assert (last.message.mode, last.message.parts[0].t.nanosec) == ("", 2)
            assert isnan(last.message.class_)
            assert recording.topics[0].type == "json/msg/Message"

    @pytest.mark.parametrize("wrong", [b"{", b"[1]", b"7", b"\xff", b"[" * 100_000], ids=lambda raw: repr(raw[:3]))
    def test_that_is_not_a_message_is_left_out_and_named(self, tmp_path: Path, wrong: bytes) -> None:
        path = write(tmp_path / "x.mcap", {"/state": ("", [{"x": 1}, wrong, {"x": 3}])})
        with robowidgets.open(path) as recording:
            assert [one.message.x for one in recording.messages("/state")] == [1.0, 3.0]
            (line, _) = recording.problems
        assert line.startswith("/state: messages that cannot be shown are left out, the first at 0.10 s")

    def test_of_public_recorders_is_read(self, data: Path) -> None:
        with robowidgets.open(data / "reports/mcap_json/json.mcap") as recording:
            assert "!" not in recording.info()
            assert [len(recording.scans(topic)) for topic in ("/fox_scan", "/scan_json")] == [30, 30]
            assert recording.fields("/state")["battery"].tolist()[0] == 12.5
            assert [one.text for one in recording.events("/log")] == ["line 0", "line 10", "line 20"]


def test_names_become_names_of_fields() -> None:
    names = ("a b", "1st", "class", "_x_", "ä", "ok")
    assert [field_name(name) for name in names] == ["a_b", "f1st", "class_", "x", "field", "ok"]


def test_a_shape_is_what_messages_have_in_common() -> None:
    shape = JsonShape([{"a": True, "b": 1, "c": [[1, 2]]}, {"a": 2, "b": "two"}])
    assert shape.definition("x") == "float64 a\nstring b\nfloat64[] c\n"
    assert shape.fields_of({"a": False, "b": 3}) == {"a": 0.0, "b": "3", "c": []}


def write_protobuf(path: Path) -> Path:
    """Scans as the SDK of Foxglove encodes them."""
    messages = pytest.importorskip("foxglove.messages")
    schema = messages.LaserScan.get_schema()
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start("", "test")
        number = writer.register_schema(schema.name, schema.encoding, schema.data)
        channel = writer.register_channel("/scan", "protobuf", number)
        for i in range(10):
            scan = messages.LaserScan(
                timestamp=messages.Timestamp(i, 7),
                frame_id="laser",
                start_angle=-1.0,
                end_angle=1.0,
                ranges=[1.0, 2.0, float(i)],
                intensities=[],
            )
            writer.add_message(channel, START_NS + i * 10**8, scan.encode(), START_NS)
        writer.finish()
    return path


class TestProtobuf:
    def test_is_read_by_the_definition_in_the_file(self, tmp_path: Path) -> None:
        pytest.importorskip("google.protobuf", reason="protobuf is not installed: pip install protobuf")
        with robowidgets.open(write_protobuf(tmp_path / "x.mcap")) as recording:
            scans = recording.scans("/scan")
            assert scans.ranges[:, 2].tolist() == list(range(10))
            assert scans.stamps_ns.tolist() == [i * 10**9 + 7 for i in range(10)]
            assert "!" not in recording.info()

    def test_without_its_package_says_how_to_get_it(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        for module in (_plain, protobuf):
            monkeypatch.setattr(module, "has_protobuf", lambda: False)
        monkeypatch.setattr("robowidgets.recordings._sample_reader.has_protobuf", lambda: False)
        with robowidgets.open(write_protobuf(tmp_path / "x.mcap")) as recording:
            assert "/scan: its messages are encoded as 'protobuf': pip install protobuf to read them" in str(recording)
