"""A span of a recording as an MCAP file that stands alone."""

from __future__ import annotations

import json
import struct
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader
from mcap.writer import Writer as McapFile
from rosbags.interfaces import (
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.rosbag1 import Writer as BagWriter
from rosbags.rosbag2 import StoragePlugin
from rosbags.rosbag2 import Writer as FolderWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import robowidgets
from robowidgets import RecordingError
from robowidgets.command import main
from robowidgets.files import open_source
from robowidgets.messages.channel import full_type
from robowidgets.messages.encoding import encode
from robowidgets.repair import Source
from robowidgets.repair.write import McapWriter

from . import written
from .recorded import START_NS

TYPES = {
    "/scan": "sensor_msgs/msg/LaserScan",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/state": "std_msgs/msg/String",
    "/chatter": "std_msgs/msg/String",
    "/rosout": "rcl_interfaces/msg/Log",
}
TF = "geometry_msgs/TransformStamped[] transforms\n"
LATCHED = ("/tf_static", "/state", "/rosout")

Row = tuple[str, float, bytes]


def rows(encoding: str) -> list[Row]:
    """Scans at 10 Hz for 5 s; two fixed transforms, the first one twice; and states, texts and log lines before 2 s."""

    def text(value: str) -> bytes:
        return encode(encoding, "std_msgs/msg/String", {"data": value})

    def static(child: str) -> bytes:
        transform = {"header": {"frame_id": "base_link"}, "child_frame_id": child}
        return encode(encoding, TYPES["/tf_static"], {"transforms": [transform]}, TF)

    scan = {"angle_increment": 0.1, "range_max": 30.0}
    found = [("/scan", i / 10, encode(encoding, TYPES["/scan"], {**scan, "ranges": [i / 10]})) for i in range(50)]
    found += [
        ("/tf_static", 0.0, static("laser")),
        ("/tf_static", 0.5, static("camera")),
        ("/tf_static", 1.0, static("laser")),
    ]
    found += [("/state", 0.2, text("waiting")), ("/state", 1.0, text("driving")), ("/state", 3.05, text("stopped"))]
    found += [("/chatter", 1.5, text("hello")), ("/chatter", 2.5, text("again"))]
    if encoding == "cdr":
        found.append(("/rosout", 1.0, encode(encoding, TYPES["/rosout"], {"msg": "ready"})))
    return sorted(found, key=lambda row: row[1])


def qos(durability: QosDurability) -> list[Qos]:
    time = QosTime(0, 0)
    automatic = QosLiveliness.AUTOMATIC
    history = QosHistory.KEEP_LAST
    return [Qos(history, 1, QosReliability.RELIABLE, durability, time, time, automatic, time, False)]


def bag(folder: Path) -> Path:
    store = get_typestore(Stores.ROS1_NOETIC)
    store.register(get_types_from_msg(TF, TYPES["/tf_static"]))
    with BagWriter(folder / "drive.bag") as writer:
        connections = {
            topic: writer.add_connection(topic, name, typestore=store, latching=int(topic in LATCHED))
            for topic, name in TYPES.items()
            if topic != "/rosout"
        }
        for topic, seconds, data in rows("ros1"):
            writer.write(connections[topic], START_NS + round(seconds * 1e9), data)
    return folder / "drive.bag"


def rosbag2(plugin: StoragePlugin) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        store = get_typestore(Stores.ROS2_HUMBLE)
        with FolderWriter(folder / "drive", version=9, storage_plugin=plugin) as writer:
            connections = {
                topic: writer.add_connection(
                    topic,
                    name,
                    typestore=store,
                    offered_qos_profiles=qos(
                        QosDurability.TRANSIENT_LOCAL if topic in LATCHED else QosDurability.VOLATILE
                    ),
                )
                for topic, name in TYPES.items()
            }
            for topic, seconds, data in rows("cdr"):
                writer.write(connections[topic], START_NS + round(seconds * 1e9), data)
        return folder / "drive"

    return write


def lone(plugin: StoragePlugin) -> Callable[[Path], Path]:
    def write(folder: Path) -> Path:
        (file,) = (path for path in rosbag2(plugin)(folder).iterdir() if path.suffix != ".yaml")
        return file

    return write


def unindexed(folder: Path) -> Path:
    """An MCAP file whose recorder was killed: `repair` reads it."""
    path = lone(StoragePlugin.MCAP)(folder)
    path.write_bytes(path.read_bytes()[:-200])
    return path


KINDS = {
    "bag": bag,
    "db3": lone(StoragePlugin.SQLITE3),
    "mcap": lone(StoragePlugin.MCAP),
    "folder": rosbag2(StoragePlugin.SQLITE3),
    "unindexed": unindexed,
}


def plain_loop(source: Source, start_ns: int, stop_ns: int) -> list[tuple[str, int, bytes]]:
    """The messages of a span, from a loop over the whole file."""
    return [
        (channel.topic, time_ns, bytes(data))
        for channel, time_ns, data in source.messages(source.channels)
        if start_ns <= time_ns < stop_ns
    ]


def by_mcap(path: Path) -> list[tuple[str, int, bytes, Any]]:
    """The messages in an MCAP file as its own reader has them, each with its schema."""
    with path.open("rb") as file:
        return [
            (channel.topic, message.log_time, message.data, schema)
            for schema, channel, message in make_reader(file).iter_messages()
        ]


def ordered(found: Sequence[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    """Messages of one time by topic: their order across topics is not defined."""
    return sorted((one[:3] for one in found), key=lambda one: (one[1], one[0]))


@pytest.mark.parametrize("kind", KINDS)
def test_a_cut_has_the_messages_of_its_span_unchanged_after_those_that_still_hold(kind: str, tmp_path: Path) -> None:
    path = KINDS[kind](tmp_path)
    encoding = "ros1" if kind == "bag" else "cdr"
    held = {(topic, seconds): data for topic, seconds, data in rows(encoding)}
    with robowidgets.open(path) as recording:
        cut = recording[2:4].to_mcap(tmp_path / "cut.mcap")
        inside = plain_loop(recording.source, START_NS + 2 * 10**9, START_NS + 4 * 10**9)
    found = by_mcap(cut)
    front = [("/tf_static", 0.5), ("/state", 1.0), ("/tf_static", 1.0)]
    assert sorted(one[:3] for one in found[:3]) == sorted(
        (topic, START_NS + 2 * 10**9, held[topic, seconds]) for topic, seconds in front
    )
    assert len(inside) == 22
    assert ordered(found[3:]) == ordered(inside)
    for topic, _, _, schema in found:
        assert full_type(schema.name) == TYPES[topic]
        assert schema.encoding == ("ros1msg" if encoding == "ros1" else "ros2msg")
        assert schema.data
    with robowidgets.open(cut) as again:
        assert again.problems == ()
        assert again.duration == 1.9
        assert len(again.scans()) == 20
        assert {topic.name for topic in again.topics} >= {"/scan", "/state", "/chatter", "/tf_static"}
        nested = by_mcap(again[1.5:].to_mcap(tmp_path / "nested.mcap"))
    assert {one[2] for one in nested if one[1] == START_NS + 3.5e9 and one[0] != "/scan"} == {
        *(held["/tf_static", seconds] for seconds in (0.5, 1.0)),
        held["/state", 3.05],
    }, "a cut of a cut"


def test_a_cut_ends_before_its_end_and_an_open_one_has_the_last_message(tmp_path: Path) -> None:
    with robowidgets.open(bag(tmp_path)) as recording:
        for which, count in ((slice(4.5, None), 5), (slice(None, 0.3), 3), (slice(4.5, 4.9), 4), (slice(-3, 99), 50)):
            cut = recording[which].to_mcap(tmp_path / "cut.mcap", overwrite=True)
            assert [one[0] for one in by_mcap(cut)].count("/scan") == count


def test_other_encodings_stay_as_they_are_with_their_schemas_and_so_do_metadata_and_attachments(tmp_path: Path) -> None:
    schema = json.dumps({"type": "object", "title": "Battery"}).encode()
    with (tmp_path / "drive.mcap").open("wb") as file:
        writer = McapFile(file)
        writer.start("", "test")
        numbers = {
            topic: writer.register_channel(topic, encoding, writer.register_schema(name, language, data))
            for topic, encoding, name, language, data in (
                ("/battery", "json", "Battery", "jsonschema", schema),
                ("/level", "protobuf", "pkg.Level", "protobuf", b"\x0a\xff\x00"),
            )
        }
        for i in range(10):
            time_ns = START_NS + i * 10**9
            writer.add_message(numbers["/battery"], time_ns, b'{"volts": %d}' % i, time_ns)
            writer.add_message(numbers["/level"], time_ns, struct.pack("<I", i), time_ns)
        writer.add_metadata("robot", {"name": "marvin"})
        writer.add_metadata("rosbag2", {"serialized_metadata": "counts of all"})
        writer.add_attachment(START_NS, START_NS, "calibration.yaml", "text/yaml", b"fx: 500")
        writer.finish()
    with robowidgets.open(tmp_path / "drive.mcap") as recording:
        cut = recording[3:5].to_mcap(tmp_path / "cut.mcap")
    found = {(topic, time_ns): (data, s.name, s.encoding, s.data) for topic, time_ns, data, s in by_mcap(cut)}
    assert found[("/battery", START_NS + 3 * 10**9)] == (b'{"volts": 3}', "Battery", "jsonschema", schema)
    assert found[("/level", START_NS + 4 * 10**9)] == (struct.pack("<I", 4), "pkg.Level", "protobuf", b"\x0a\xff\x00")
    assert len(found) == 4
    with cut.open("rb") as file:
        reader = make_reader(file)
        about = {one.name: one.metadata for one in reader.iter_metadata()}
        (attachment,) = reader.iter_attachments()
    assert about["robot"] == {"name": "marvin"}
    assert "rosbag2" not in about
    assert about["robowidgets cut"]["recording"] == "drive.mcap"
    assert float(about["robowidgets cut"]["start"]) == 3
    assert (attachment.name, attachment.data) == ("calibration.yaml", b"fx: 500")


def test_an_existing_file_stays_unless_it_may_be_overwritten_and_never_the_recording(tmp_path: Path) -> None:
    (tmp_path / "kept.mcap").write_bytes(b"kept")
    path = lone(StoragePlugin.MCAP)(tmp_path)
    with robowidgets.open(path) as recording, robowidgets.open(path.parent) as whole:
        with pytest.raises(FileExistsError, match=r"kept\.mcap' exists; name another file, or give overwrite=True"):
            recording[2:4].to_mcap(tmp_path / "kept.mcap")
        assert (tmp_path / "kept.mcap").read_bytes() == b"kept"
        with pytest.raises(FileExistsError, match="part of the recording itself"):
            recording[2:4].to_mcap(path, overwrite=True)
        with pytest.raises(FileExistsError, match="part of the recording itself"):
            whole[2:4].to_mcap(path.parent / "cut.mcap")
        recording[2:4].to_mcap(tmp_path / "kept.mcap", overwrite=True)
    assert len(by_mcap(tmp_path / "kept.mcap")) == 25


def test_a_failure_leaves_no_file_under_the_final_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def fail(self: McapWriter, *_: Any) -> None:
        assert [path.suffix for path in (tmp_path / "out").iterdir()] == [".part"]
        raise OSError(28, "No space left on device")

    (tmp_path / "out").mkdir()
    monkeypatch.setattr(McapWriter, "add", fail)
    with (
        robowidgets.open(bag(tmp_path)) as recording,
        pytest.raises(RecordingError, match=r"cut\.mcap: cannot be written: No space left on device"),
    ):
        recording[2:4].to_mcap(tmp_path / "out/cut.mcap")
    assert list((tmp_path / "out").iterdir()) == []


def test_what_cannot_be_cut_is_refused(tmp_path: Path) -> None:
    with robowidgets.open(bag(tmp_path)) as recording:
        with pytest.raises(ValueError, match=r"^start: expected seconds from 0 to 4\.90, got 7$"):
            recording[7:8].to_mcap(tmp_path / "cut.mcap")
        with pytest.raises(ValueError, match=r"^end: expected seconds from 0 to 4\.90, got -1$"):
            recording[:-1].to_mcap(tmp_path / "cut.mcap")
        with pytest.raises(ValueError, match=r"drive\.bag: no message from 2\.010 s to 2\.020 s; name a longer span"):
            recording[2.01:2.02].to_mcap(tmp_path / "cut.mcap")
        with pytest.raises(ValueError, match=r"name that ends in \.mcap, got 'cut\.bag'"):
            recording[2:4].to_mcap("cut.bag")
        part = recording[2:4]
    with pytest.raises(RecordingError, match="is closed"):
        part.to_mcap(tmp_path / "cut.mcap")
    empty = written.write_bag(tmp_path / "empty.bag", [])
    with robowidgets.open(empty) as recording, pytest.raises(RecordingError, match=r"empty\.bag has no message"):
        recording[:].to_mcap(tmp_path / "cut.mcap")
    assert not (tmp_path / "cut.mcap").exists()


def test_the_command_writes_a_cut(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path, out = str(bag(tmp_path)), str(tmp_path / "cut.mcap")
    assert main(["cut", path, "--start", "2", "--end", "4", "-o", out]) == 0
    assert capsys.readouterr().out.startswith(f"Wrote {out}: drive.bag from 2.00 to 4.00 s, ")
    assert len(by_mcap(Path(out))) == 25
    assert main(["cut", path, "--start", "2", "-o", out]) == 2
    assert "exists; name another file, or replace it with --force" in capsys.readouterr().err
    assert main(["cut", path, "--start", "2", "-o", out, "--force"]) == 0
    whole = by_mcap(Path(out))
    for end in ("4.9", "60"):  # the last scan comes at 4.9 s
        assert main(["cut", path, "--start", "2", "--end", end, "-o", out, "--force"]) == 0
        assert by_mcap(Path(out)) == whole
    for arguments, problem in (
        (["--end", "inf"], "--end: expected seconds from the start of the recording, got inf"),
        (["--start", "4", "--end", "2"], "--end: expected seconds from the start of the recording, 4 or more, got 2"),
        (["--start", "70"], "--start: expected seconds from 0 to 4.90, got 70"),
        (["--start", "nan"], "--start: expected seconds from the start of the recording, got nan"),
        (["-o", out + ".bag"], f"expected a name that ends in .mcap, got '{out}.bag'"),
    ):
        assert main(["cut", path, "-o", out, *arguments, "--force"]) == 2
        assert capsys.readouterr().err == f"robowidgets: cut: {problem}\n"


@pytest.mark.slow
def test_cuts_of_real_recordings_have_the_messages_of_a_loop_over_the_whole_file(data: Path, tmp_path: Path) -> None:
    count = 0
    for path in [one for name in ("good", "odd", "topics", "damaged") for one in sorted((data / name).iterdir())]:
        try:
            recording = robowidgets.open(path)
        except RecordingError:
            continue  # other tests have the reasons
        if recording.start_ns is None:
            continue
        start = recording.duration / 3
        cut = recording[start : start + 1 + recording.duration / 3].to_mcap(tmp_path / f"{count}.mcap")
        start_ns, stop_ns = (
            recording.start_ns + round(seconds * 1e9) for seconds in (start, start + 1 + recording.duration / 3)
        )
        inside = plain_loop(recording.source, start_ns, stop_ns)
        found = by_mcap(cut)
        front = len(found) - len(inside)
        assert all(one[1] == start_ns for one in found[:front]), path
        assert ordered(found[front:]) == ordered(inside), path
        assert len(inside) > 0
        with robowidgets.open(cut) as again:
            assert not [line for line in again.problems if "robowidgets repair" in line], path
        count += 1
    assert count >= 30


def test_the_channels_of_a_cut_keep_their_quality_of_service(tmp_path: Path) -> None:
    for kind in ("db3", "mcap", "unindexed"):
        (folder := tmp_path / kind).mkdir()
        with robowidgets.open(KINDS[kind](folder)) as recording:
            cut = recording[2:4].to_mcap(folder / "cut.mcap")
        for path in (cut, unfinished(cut)):
            source = open_source(path)
            assert {one.topic for one in source.channels if one.is_latched} == set(LATCHED), (kind, path.name)
            source.close()


def unfinished(path: Path) -> Path:
    """A copy of an MCAP file without its end, which `repair` reads."""
    copy = path.with_name("unfinished.mcap")
    copy.write_bytes(path.read_bytes()[:-200])
    return copy
