"""Real recordings, each with its entry in the list."""

from __future__ import annotations

from collections import Counter
from math import degrees
from pathlib import Path

import numpy as np
import pytest

from robowidgets import Scan, Speed, Touch, Validity
from robowidgets.recording import Recording, open
from robowidgets.recordings import RecordingError

GOOD = {
    "turtlebot3_gazebo.bag": {"/scan": 457, "/odom": 2741, "/cmd_vel": 2335},
    "turtlebot3_gazebo_mcap": {"/scan": 457, "/odom": 2741, "/cmd_vel": 2335},
    "neato_fsm": {"/scan": 147, "/stable_scan": 142, "/odom": 158, "/cmd_vel": 251, "/bump": 157},
    "neato_fsm_zstd.mcap": {"/scan": 147, "/stable_scan": 142, "/odom": 158, "/cmd_vel": 251, "/bump": 157},
    "hokuyo_people.bag": {"/scan": 1265},
    "tilt_laser.bag": {"/scan": 178, "/velocity": 712},
    "urg_681.bag": {"/scan": 360},
    "edmonton.log.gz": {"FLASER": 340, "ODOM": 6011},
}

# rays, sweep in degrees, percent of +inf, NaN, and outside the limits
SCANS = {
    "turtlebot3_gazebo.bag": (360, 360, 9, 0, 0),
    "turtlebot3_gazebo_mcap": (360, 360, 9, 0, 0),
    "neato_fsm": (361, 360, 92, 0, 0),
    "neato_fsm_zstd.mcap": (361, 360, 92, 0, 0),
    "hokuyo_people.bag": (512, 180, 66, 0.7, 0),
    "tilt_laser.bag": (1078, 269, 0, 0, 38),
    "urg_681.bag": (681, 239, 0, 0, 5),
    "edmonton.log.gz": (180, 179, 0, 0, 5),
}

NO_WIDGET = "none of its topics has a widget for its kind of sensor"

# file: samples by topic, and the beginnings of the lines of its problems
ODD = {
    "no_slash_topic_minus_inf.bag": ({"right_scan": 296}, []),
    "stamps_a_year_off.bag": ({"/training_scan": 197}, []),
    "lz4_stage_90_rays.bag": ({"/base_scan": 1727, "/base_pose_ground_truth": 1727}, []),
    "custom_types_start_0.bag": ({}, [NO_WIDGET]),
    "one_message.bag": ({}, [NO_WIDGET]),
    "ros1_messages_in_mcap.mcap": ({"/scan": 457, "/odom": 2741, "/cmd_vel": 2335}, []),
    "unchunked_no_index.mcap": ({"/scan": 47, "/stable_scan": 47, "/odom": 52, "/cmd_vel": 46, "/bump": 52}, []),
    "metadata_names_missing_file": (
        {"/scan": 99, "/odom": 579, "/cmd_vel": 99},
        [
            "metadata.yaml names rosbag2_2024_11_24-17_59_42_0.db3, not in the folder: read the files that are",
        ],
    ),
    "jazzy_mcap_no_laser": ({}, [NO_WIDGET]),
    "every_ros2_type_mcap": (
        {
            "/test/sensor_msgs/laser_scan": 2,
            "/test/sensor_msgs/multi_echo_laser_scan": 2,
            "/test/geometry_msgs/twist": 2,
            "/test/geometry_msgs/twist_stamped": 2,
            "/test/geometry_msgs/twist_with_covariance": 2,
            "/test/geometry_msgs/twist_with_covariance_stamped": 2,
            "/test/nav_msgs/odometry": 2,
            "/test/sensor_msgs/range": 2,
            "/test/std_msgs/bool": 2,
        },
        [],
    ),
    "empty_definition.bag": ({}, ["/led_array_status: no definition of its messages in the file", NO_WIDGET]),
    "service_events.mcap": (
        {},
        ["/add_two_ints/_service_event: the definition of its messages in the file cannot be understood", NO_WIDGET],
    ),
    "service_events.db3": ({}, ["/add_two_ints/_service_event: no definition of its messages in the file", NO_WIDGET]),
    "empty_bag": ({}, ["there is no message in it: nothing was recorded"]),
    "hist_compressed_bag": ({}, ["there is no message in it: nothing was recorded"]),
    "hist_file_compression": ({}, [NO_WIDGET]),
    "hist_message_compression": ({}, [NO_WIDGET]),
    "mcap_wbag_split": ({}, [NO_WIDGET]),
    "sqlite_wbag_split": ({}, [NO_WIDGET]),
    "mcap_multiple_files_no_metadata": ({}, [NO_WIDGET]),
    "sqlite_multiple_files_no_metadata": ({}, [NO_WIDGET]),
    "intel_time_goes_back.log.gz": ({"FLASER": 910, "ODOM": 13631}, ["the clock goes back ", "FLASER: nothing before"]),
    "orebro_times_all_zero.log.gz": ({"FLASER": 237, "ODOM": 18}, ["the clock stood still (1 different time in 255"]),
    "belgioioso_two_times.log.gz": (
        {"FLASER": 395, "ODOM": 4047},
        ["the clock stood still (1 different time in 4,442"],
    ),
}

SAVED = {
    "malformed_index.bag": ({"/scan": 360}, ["the index of the recording is damaged"]),
    "truncated.bag": ({"/scan": 107, "/velocity": 430}, ["the recording was cut off"]),
    "unindexed_killed_recorder.bag": ({"/scan": 178, "/velocity": 712}, ["the recorder was stopped before"]),
    "truncated.mcap": (
        {"/scan": 97, "/stable_scan": 92, "/odom": 102, "/cmd_vel": 183, "/bump": 101},
        ["the recording was cut off"],
    ),
    "half_the_pages.db3": (
        {"/scan": 22, "/stable_scan": 22, "/odom": 26, "/cmd_vel": 14, "/bump": 26},
        ["the recording was cut off"],
    ),
    "mcap_wrong_format": ({}, ["/test_topic, /array_topic: its messages are encoded as 'wrong_format'", NO_WIDGET]),
    "sqlite_wrong_format": ({}, ["/array_topic, /test_topic: no definition of its messages in the file", NO_WIDGET]),
}

LOST = {
    "rosrecord_v1.2.bag": "rosrecord_v1.2.bag: a bag of format 1.2: only ROS 1 bags of format 2.0 can be read",
    "cut_to_3_kb.bag": "cut_to_3_kb.bag: was cut off before its first message",
    "magic_only.bag": "magic_only.bag: was cut off before its first message",
    "zero_bytes.mcap": "zero_bytes.mcap: the file is empty",
}


def counted(recording: Recording) -> Counter[str]:
    return Counter(moment.topic for moment in recording.samples())


def scans(recording: Recording, topic: str) -> list[Scan]:
    return [m.sample for m in recording.samples(topic) if isinstance(m.sample, Scan)]


@pytest.mark.parametrize("name", GOOD)
def test_a_good_recording_shows_without_a_word(data: Path, name: str) -> None:
    with open(data / "good" / name) as recording:
        assert {topic.name: topic.count for topic in recording.topics if topic.widget} == GOOD[name]
        assert counted(recording) == GOOD[name]
        assert recording.problems == ()


@pytest.mark.parametrize("name", SCANS)
def test_scans_are_as_the_scanner_sent_them(data: Path, name: str) -> None:
    rays, sweep, nothing, none, outside = SCANS[name]
    with open(data / "good" / name) as recording:
        topic = next(topic.name for topic in recording.topics if topic.widget == "laser" and "stable" not in topic.name)
        all_of_them = scans(recording, topic)
    assert {len(scan) for scan in all_of_them} == {rays}
    assert {round(degrees(scan.angles[-1] - scan.angles[0])) for scan in all_of_them} <= {sweep - 1, sweep}
    kinds = np.concatenate([scan.validity for scan in all_of_them])
    percent = {kind: 100 * np.count_nonzero(kinds == kind) / kinds.size for kind in Validity}
    assert percent[Validity.NOTHING_IN_RANGE] == pytest.approx(nothing, abs=0.5)
    assert percent[Validity.NO_MEASUREMENT] == pytest.approx(none, abs=0.05)
    assert percent[Validity.OUTSIDE_LIMITS] == pytest.approx(outside, abs=0.5)


@pytest.mark.parametrize("name", ["turtlebot3_gazebo.bag", "turtlebot3_gazebo_mcap"])
def test_readings_equal_to_range_max_are_readings(data: Path, name: str) -> None:
    with open(data / "good" / name) as recording:
        at_the_limit = [scan.valid[scan.ranges == np.float32(scan.range_max)] for scan in scans(recording, "/scan")]
    assert sum(map(len, at_the_limit)) == 71
    assert np.concatenate(at_the_limit).all()


@pytest.mark.parametrize("name", ["neato_fsm", "neato_fsm_zstd.mcap"])
def test_the_neato_bumps_at_21_96_seconds(data: Path, name: str) -> None:
    with open(data / "good" / name) as recording:
        bumps = [
            m for m in recording.samples("/bump") if isinstance(m.sample, Touch) and any(m.sample.touched.values())
        ]
        assert len(bumps) == 13
        seconds = (bumps[0].time_ns - (recording.start_ns or 0)) / 1e9
        assert seconds == pytest.approx(21.96, abs=0.01)
        before, at = recording.at("/bump", seconds - 1e-9), recording.at("/bump", seconds)
    assert at is not None
    assert at.time_ns == bumps[0].time_ns
    assert before is not None
    assert isinstance(before.sample, Touch)
    assert not any(before.sample.touched.values())
    assert isinstance(bumps[0].sample, Touch)
    assert {s for s, touched in bumps[0].sample.touched.items() if touched} == {"left front", "right front"}


@pytest.mark.slow
def test_the_same_messages_in_another_container_are_the_same_samples(data: Path) -> None:
    def all_of(name: str) -> list[object]:
        with open(data / name) as recording:
            return [
                (m.topic, m.sample.ranges.tobytes() if isinstance(m.sample, Scan) else m.sample)
                for m in recording.samples(["/scan", "/odom", "/cmd_vel"])
            ]

    bag = all_of("good/turtlebot3_gazebo.bag")
    assert sorted(map(repr, bag)) == sorted(map(repr, all_of("good/turtlebot3_gazebo_mcap")))
    assert sorted(map(repr, bag)) == sorted(map(repr, all_of("odd/ros1_messages_in_mcap.mcap")))


def test_odometry_moves_sideways_and_backwards(data: Path) -> None:
    with open(data / "odd" / "lz4_stage_90_rays.bag") as recording:
        speeds = [m.sample for m in recording.samples("/base_pose_ground_truth") if isinstance(m.sample, Speed)]
    assert any(speed.linear[0] < 0 for speed in speeds)
    assert any(speed.linear[1] != 0 for speed in speeds)


def test_scans_whose_header_and_array_disagree_say_so(data: Path) -> None:
    with open(data / "odd" / "every_ros2_type_mcap") as recording:
        scan = scans(recording, "/test/sensor_msgs/laser_scan")[0]
    assert len(scan) == 5
    assert any("the header implies 315" in problem.what for problem in scan.problems())


@pytest.mark.parametrize(("name", "expected"), [(n, e) for table in (ODD, SAVED) for n, e in table.items()])
def test_an_odd_or_damaged_recording_shows_what_it_holds_and_says_what_it_does_not(
    data: Path, name: str, expected: tuple[dict[str, int], list[str]]
) -> None:
    samples, lines = expected
    with open(data / ("odd" if name in ODD else "damaged") / name) as recording:
        assert counted(recording) == samples
        assert len(recording.problems) == len(lines), recording.problems
        for problem, line in zip(recording.problems, lines, strict=True):
            assert problem.startswith(line)
            assert "\n" not in problem
        for topic in samples:
            last = recording.at(topic, recording.duration)
            assert last is not None
            assert last.topic == topic
        assert recording.duration >= 0


@pytest.mark.parametrize("name", LOST)
def test_a_recording_that_is_lost_says_why_in_one_line(data: Path, name: str) -> None:
    with pytest.raises(RecordingError) as caught:
        open(data / "damaged" / name)
    assert str(caught.value).startswith(LOST[name])
    assert "\n" not in str(caught.value)


def test_every_file_of_the_collection_is_in_these_lists(data: Path) -> None:
    there = {path.name for folder in ("good", "odd", "damaged") for path in (data / folder).iterdir()}
    assert there <= {*GOOD, *ODD, *SAVED, *LOST}


def test_what_was_saved_is_what_was_there(data: Path) -> None:
    with open(data / "good" / "urg_681.bag") as whole, open(data / "damaged" / "malformed_index.bag") as damaged:
        ranges = [[scan.ranges.tobytes() for scan in scans(recording, "/scan")] for recording in (whole, damaged)]
    assert ranges[0] == ranges[1]
