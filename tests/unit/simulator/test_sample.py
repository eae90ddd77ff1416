"""The recording that the package ships, and the script that makes it."""

from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

import robowidgets
from robowidgets.messages import to_scan, to_speed

SHIPPED = Path(robowidgets.__file__).parent / "data" / "sample.mcap"
SCRIPT = Path(__file__).parents[3] / "scripts" / "make_sample.py"


def read(path):
    """Topic to (log time, message), in the order of the file."""
    said = {}
    with AnyReader([path]) as reader:
        for connection, time_ns, raw in reader.messages():
            said.setdefault(connection.topic, []).append((time_ns, reader.deserialize(raw, connection.msgtype)))
        types = {connection.topic: connection.msgtype for connection in reader.connections}
    return said, types


@pytest.fixture(scope="module")
def shipped():
    return read(SHIPPED)[0]


@pytest.fixture(scope="module")
def script():
    spec = spec_from_file_location("make_sample", SCRIPT)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def presses(said, bumper):
    return [
        time_ns for time_ns, message in said["/bumper"] if (message.bumper, message.state) == (bumper, message.PRESSED)
    ]


def test_it_is_at_most_one_megabyte():
    assert SHIPPED.stat().st_size <= 1_000_000


def test_it_holds_the_laser_the_speeds_and_the_bumpers():
    said, types = read(SHIPPED)
    assert types == {
        "/scan": "sensor_msgs/msg/LaserScan",
        "/odom": "nav_msgs/msg/Odometry",
        "/cmd_vel": "geometry_msgs/msg/TwistStamped",
        "/bumper": "kobuki_ros_interfaces/msg/BumperEvent",
    }
    assert {topic: len(messages) for topic, messages in said.items()} == {
        "/scan": 581,
        "/odom": 1161,
        "/cmd_vel": 1161,
        "/bumper": 16,
    }


def test_it_lasts_a_minute_at_the_rates_of_a_robot(shipped):
    for topic, period in (("/scan", 0.1), ("/odom", 0.05), ("/cmd_vel", 0.05)):
        times = np.array([time_ns for time_ns, _ in shipped[topic]])
        assert (np.diff(times) == round(period * 1e9)).all()
        assert (times[-1] - times[0]) / 1e9 == 58.0
        stamps = [m.header.stamp.sec * 10**9 + m.header.stamp.nanosec for _, m in shipped[topic]]
        assert stamps == times.tolist()


def test_it_bumps_left_right_and_in_the_middle(shipped):
    assert [len(presses(shipped, bumper)) for bumper in range(3)] == [2, 3, 3]
    open_presses = set()
    for _, message in shipped["/bumper"]:
        (open_presses.add if message.state else open_presses.remove)(message.bumper)
    assert open_presses == set()


def test_the_robot_stands_when_it_has_bumped_head_on(shipped):
    for hit in presses(shipped, 1):
        speeds = [
            to_speed(message).linear[0] for time_ns, message in shipped["/odom"] if 0 <= time_ns - hit <= 300_000_000
        ]
        assert len(speeds) == 7
        assert max(map(abs, speeds)) < 0.3
        assert min(map(abs, speeds)) < 1e-9


def test_it_turns_faster_than_the_limits_that_widgets_draw(shipped):
    measured = np.array([to_speed(message).values for _, message in shipped["/odom"]])
    assert measured[:, 5].max() > 1
    assert measured[:, 5].min() < -1
    assert measured[:, 0].min() < -0.2


def test_its_scans_have_readings_nothing_in_range_and_no_measurement(shipped):
    scans = [to_scan(message) for _, message in shipped["/scan"]]
    assert {len(scan) for scan in scans} == {451}
    assert all(scan.problems() == () and scan.intensities.size == 451 for scan in scans)
    nothing = np.array([np.isposinf(scan.ranges).mean() for scan in scans])
    assert (nothing > 0.15).sum() > 50
    assert (nothing == 0).sum() > 20
    assert 0.001 < np.mean([np.isnan(scan.ranges).mean() for scan in scans]) < 0.003


def test_it_drives_through_three_rooms(shipped):
    places = np.array([(m.pose.pose.position.x, m.pose.pose.position.y) for _, m in shipped["/odom"]])
    east, south = places[:, 0] > 2.6, places[:, 1] < -0.8
    assert [bool(seen.any()) for seen in (~east, east & ~south, east & south)] == [True, True, True]


@pytest.mark.slow
def test_the_script_writes_the_same_file_every_time(script, tmp_path, capsys):
    first, second = tmp_path / "first.mcap", tmp_path / "second.mcap"
    script.main(first)
    second.write_bytes(b"an older one")
    script.main(second)
    assert first.read_bytes() == second.read_bytes()
    assert "first.mcap: " in capsys.readouterr().out


@pytest.mark.slow
def test_the_shipped_file_is_what_the_script_writes(script, shipped):
    """Message by message, not byte by byte: another processor may round the last bit of a sine in another way."""
    made = {}
    for topic, time_ns, message in script.drive():
        made.setdefault(topic, []).append((time_ns, message))
    assert list(made) == list(shipped)
    for topic, messages in made.items():
        assert [time_ns for time_ns, _ in messages] == [time_ns for time_ns, _ in shipped[topic]]
    bumps = [[(m.bumper, m.state) for _, m in said["/bumper"]] for said in (made, shipped)]
    assert bumps[0] == bumps[1]
    for topic in ("/odom", "/cmd_vel"):
        speeds = [np.array([to_speed(m).values for _, m in said[topic]]) for said in (made, shipped)]
        assert np.abs(speeds[0] - speeds[1]).max() < 1e-6
    ranges = [np.concatenate([m.ranges for _, m in said["/scan"]]) for said in (made, shipped)]
    assert np.isclose(*ranges, atol=0.0015, equal_nan=True).mean() > 0.999
