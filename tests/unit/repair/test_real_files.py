"""Odd or damaged recordings of others, number by number."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from rosbags.rosbag1 import Reader
from rosbags.typesys import Stores, get_typestore

from robowidgets.repair import RecordingError, Source, find_files, open_repaired

from ..recordings.written import read

TILT = {"/gravity_vector": 356, "/magnetic_vector": 356, "/imu_data": 356, "/info_gps": 356, "/position_gps": 356} | {
    "/temperature": 712,
    "/velocity": 712,
    "/tf": 711,
    "/scan": 178,
}
TURTLEBOT = {"/cmd_vel": 2335, "/joint_states": 2741, "/odom": 2741, "/scan": 457, "/imu": 2253}


def counts(source: Source) -> dict[str, int]:
    found: dict[str, int] = {}
    for topic, _, _ in read(source):
        found[topic] = found.get(topic, 0) + 1
    assert found == {channel.topic: channel.count for channel in source.channels if channel.count}
    return found


def seconds(source: Source) -> float:
    assert source.start_ns is not None
    assert source.end_ns is not None
    return (source.end_ns - source.start_ns) / 1e9


def test_a_malformed_index_costs_none_of_360_scans(data: Path) -> None:
    store = get_typestore(Stores.ROS1_NOETIC)
    source = open_repaired([data / "damaged/malformed_index.bag"])
    scans = [store.deserialize_ros1(raw, "sensor_msgs/msg/LaserScan") for _, _, raw in read(source)]
    with Reader(data / "good/urg_681.bag") as reader:
        good = [store.deserialize_ros1(raw, "sensor_msgs/msg/LaserScan") for _, _, raw in reader.messages()]
    assert len(scans) == len(good) == 360
    assert all(np.array_equal(ours.ranges, theirs.ranges) for ours, theirs in zip(scans, good, strict=True))
    assert source.problems == (
        "the index of the recording is damaged, so it was read without: 360 messages, up to 35.8 s",
    )


def test_an_unindexed_bag_holds_what_the_whole_one_does(data: Path) -> None:
    source = open_repaired([data / "damaged/unindexed_killed_recorder.bag"])
    assert counts(source) == TILT
    assert read(source) == read(open_repaired([data / "good/tilt_laser.bag"]))
    assert source.problems == (
        "the recorder was stopped before it closed the file: read all of its 4,093 messages, up to 17.7 s",
    )


def test_a_truncated_bag_holds_the_first_of_the_whole_one(data: Path) -> None:
    source = open_repaired([data / "damaged/truncated.bag"])
    saved = read(source)
    whole = read(open_repaired([data / "good/tilt_laser.bag"]))
    assert counts(source)["/scan"] == 107
    assert len(saved) == 2469
    assert set(saved) <= set(whole)
    assert source.problems == ("the recording was cut off: read 2,469 messages, up to 10.9 s",)


def test_a_truncated_mcap_holds_the_first_of_the_whole_one(data: Path) -> None:
    source = open_repaired([data / "damaged/truncated.mcap"])
    saved = read(source)
    assert len(saved) == 976
    assert set(saved) <= set(read(open_repaired([data / "good/neato_fsm_zstd.mcap"])))
    assert counts(source)["/scan"] == 97
    assert source.problems == ("the recording was cut off: read 976 messages, up to 21.3 s",)


def test_half_a_database_gives_half_its_messages(data: Path) -> None:
    source = open_repaired([data / "damaged/half_the_pages.db3"])
    saved = read(source)
    assert len(saved) == 238
    assert counts(source)["/scan"] == 22
    whole = {(topic, time_ns) for topic, time_ns, _ in read(open_repaired([data / "odd/unchunked_no_index.mcap"]))}
    assert {(topic, time_ns) for topic, time_ns, _ in saved if topic != "/accel"} <= whole
    assert source.problems == ("the recording was cut off: read 238 messages, up to 4.5 s",)


@pytest.mark.parametrize(
    ("name", "why"),
    [
        ("cut_to_3_kb.bag", "was cut off before its first message (3,072 bytes)"),
        ("magic_only.bag", "was cut off before its first message (13 bytes)"),
        ("rosrecord_v1.2.bag", "a bag of format 1.2: only ROS 1 bags of format 2.0 can be read"),
        ("zero_bytes.mcap", "the file is empty (0 bytes)"),
    ],
)
def test_what_holds_nothing_is_named_in_one_line(data: Path, name: str, why: str) -> None:
    with pytest.raises(RecordingError) as error:
        open_repaired([data / "damaged" / name])
    assert str(error.value).startswith(f"{name}: {why}")
    assert "\n" not in str(error.value)


def test_an_unknown_format_is_listed_under_its_name(data: Path) -> None:
    source = open_repaired([data / "damaged/mcap_wrong_format/wrong_rmw_test_0.mcap"])
    assert {channel.encoding for channel in source.channels} == {"wrong_format"}
    assert counts(source) == {"/test_topic": 3, "/array_topic": 4}


@pytest.mark.slow
def test_ros1_messages_in_mcap_match_the_bag(data: Path) -> None:
    source = open_repaired([data / "odd/ros1_messages_in_mcap.mcap"])
    assert counts(source) == TURTLEBOT
    assert {(channel.encoding, channel.type) for channel in source.channels if channel.topic == "/scan"} == {
        ("ros1", "sensor_msgs/msg/LaserScan")
    }
    assert set(read(source)) == set(read(open_repaired([data / "good/turtlebot3_gazebo.bag"])))


def test_no_chunks_and_no_index_are_not_a_problem(data: Path) -> None:
    source = open_repaired([data / "odd/unchunked_no_index.mcap"])
    assert counts(source) == {"/tf": 156, "/tf_static": 2, "/robot_description": 1, "/odom": 52, "/cmd_vel": 46} | {
        "/scan": 47,
        "/bump": 52,
        "/stable_scan": 47,
        "/projected_stable_scan": 47,
    }
    assert seconds(source) == pytest.approx(9.851, abs=0.001)
    assert source.problems == ()


@pytest.mark.parametrize("name", ["service_events.mcap", "service_events.db3"])
def test_service_events_hide_nothing_else(data: Path, name: str) -> None:
    source = open_repaired([data / "odd" / name])
    assert counts(source) == {"/parameter_events": 7, "/add_two_ints/_service_event": 6}
    assert source.problems == ()


def test_an_empty_definition_hides_no_message(data: Path) -> None:
    source = open_repaired([data / "odd/empty_definition.bag"])
    assert counts(source) == {"/led_array_status": 14}
    assert source.channels[0].definition == ""


@pytest.mark.parametrize(
    ("name", "count", "duration"),
    [
        ("sqlite_multiple_files_no_metadata", 3177, 6.352),
        ("mcap_multiple_files_no_metadata", 3177, 6.352),
        ("hist_message_compression", 740, 119.905),
        ("hist_file_compression", 491, 120.0),
        ("metadata_names_missing_file", 6565, 19.801),
        ("sqlite_wbag_split", 6074, 0.000002),
        ("mcap_wbag_split", 6074, 0.000002),
    ],
)
def test_a_folder_is_read_file_by_file(data: Path, name: str, count: int, duration: float) -> None:
    source = open_repaired(find_files(data / "odd" / name))
    assert sum(counts(source).values()) == count
    assert seconds(source) == pytest.approx(duration, abs=0.001)
    assert source.problems == ()
    source.close()


def test_messages_compressed_one_by_one_become_plain(data: Path) -> None:
    source = open_repaired([data / "odd/hist_message_compression/message_compression_0.db3"])
    texts = [raw for topic, _, raw in read(source) if topic == "/topic"]
    assert len(texts) == 120
    assert all(text.startswith(b"\0\1\0\0") and b"Hello" in text for text in texts)


def test_reading_leaves_the_files_as_they_are(data: Path) -> None:
    folder = data / "odd/empty_bag"
    before = {path.name: (path.stat().st_size, path.stat().st_mtime_ns) for path in folder.iterdir()}
    source = open_repaired([folder / "empty_bag_0.db3"])
    assert (source.start_ns, source.problems, len(source.channels)) == (None, (), 2)
    source.close()
    assert {path.name: (path.stat().st_size, path.stat().st_mtime_ns) for path in folder.iterdir()} == before
