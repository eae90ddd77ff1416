"""The check-up of a recording: the content of its topics, their problems, and the remedies."""

from __future__ import annotations

import json
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import RecordingError
from robowidgets.samples.problem import LONGEST

from ..pages import display_html
from . import hazards, recorded, sweeps
from .test_digest import TOLD
from .test_mcap_dialects import SCAN

GOOD = [2.0] * 11
"""The number of rays that the header of `sweeps.scan` implies."""


BEHIND = "/scan: stamps are 40.0 s behind the recorder's clock"
HEADS = ["topic", "samples", "Hz", "jitter", "lost", "rays", "angles", "step", "limits", "frame"]
ROW = ["/scan", "100", "10.0", "0.0 ms", "0", "11", "-28.6° to 28.6°", "5.73°", "0.1 to 30 m", "laser"]


def taken(times: Iterable[float], ranges: Sequence[float] = GOOD, late: float = 0.0, **more: Any) -> list[Any]:
    """Scans with stamps at these times, logged later by some seconds."""
    return [(seconds + late, sweeps.scan(sweeps.START_NS + round(seconds * 1e9), ranges, **more)) for seconds in times]


def steady(start: float, stop: float, hz: float = 10.0) -> list[float]:
    return [start + i / hz for i in range(round((stop - start) * hz))]


@pytest.fixture
def report(tmp_path: Path) -> Callable[..., Any]:
    def examined(scans: Iterable[Any], **more: Any) -> Any:
        with robowidgets.open(sweeps.write(tmp_path / "drive", scans, **more)) as recording:
            return recording.doctor()

    return examined


def lines(report: Any) -> list[str]:
    assert all(len(str(problem)) <= LONGEST for problem in report.problems)
    assert all(problem.remedy for problem in report.problems)
    return [problem.what for problem in report.problems]


class TestTable:
    def test_a_sound_recording_has_its_numbers_in_columns_and_no_problem(self, report: Callable[..., Any]) -> None:
        sound = report(taken(steady(0, 10)))
        head, names, row, end = repr(sound).splitlines()
        assert head.endswith("9.9 s, from 2023-11-14 22:13:20 UTC, 1 topic, 100 messages")
        assert re.split("  +", names.strip()) == HEADS
        assert re.split("  +", row.strip()) == ROW
        assert end == "no problems found"
        assert "no problems found" in display_html(sound)

    def test_a_clockwise_scanner_is_named_and_is_not_a_problem(self, report: Callable[..., Any]) -> None:
        clockwise = report(taken(steady(0, 3), angle_min=1.5, increment=-0.1))
        assert "85.9° to 28.6°, clockwise" in repr(clockwise)
        assert lines(clockwise) == []

    def test_a_program_gets_numbers_and_json(self, report: Callable[..., Any]) -> None:
        sound = report(taken(steady(0, 10)))
        (scan,) = sound.topics
        assert scan.timing.step == pytest.approx(0.1)
        assert (scan.timing.lost, scan.ray_counts, scan.frame_ids) == (0, {11: 100}, ("laser",))
        assert scan.geometry == pytest.approx((-0.5, 0.1, 0.1, 30.0))
        told = json.loads(json.dumps(sound.to_dict()))
        assert told["topics"][0]["geometry"]["range_max"] == 30.0
        assert told["problems"] == []


class TestTiming:
    def test_lost_scans_are_counted_by_their_stamps(self, report: Callable[..., Any]) -> None:
        times = [time for i, time in enumerate(steady(0, 20)) if i % 20 != 7]
        found = report(taken(times))
        assert found.topics[0].timing.lost == 10
        assert lines(found) == ["/scan: 10 of 200 samples were lost"]

    @pytest.mark.parametrize("stamps", [(5.0, 5.0, 5.2), (5.0, 5.2, 5.1), (5.0, 5.2, 5.2)])
    def test_single_stamps_that_are_late_or_repeated_hide_no_loss_and_no_pause(
        self, report: Callable[..., Any], stamps: Sequence[float]
    ) -> None:
        times = [time for i, time in enumerate([*steady(0, 20), *steady(25, 45)]) if i % 10 != 7]
        times[45:48] = stamps
        found = report([(i / 9, raw) for i, (_, raw) in enumerate(taken(times))])
        missing = {5.0, 5.1, 5.2} - set(stamps)
        assert found.topics[0].timing.lost == 40 + len(missing)
        assert [pause for _, pause in found.topics[0].timing.pauses] == [pytest.approx(5.1)]

    @pytest.mark.parametrize(
        "times",
        [
            [time for pair in zip(steady(0, 10), steady(0.04, 10), strict=True) for time in reversed(pair)],
            [*steady(10, 20), *steady(5, 15)],
        ],
        ids=["two sensors", "a clock that was set"],
    )
    def test_stamps_in_no_order_tell_of_no_loss(self, report: Callable[..., Any], times: list[float]) -> None:
        found = report([(i / 10, raw) for i, (_, raw) in enumerate(taken(times))])
        assert found.topics[0].timing.lost is None

    def test_bursts_of_the_recorder_are_not_a_loss(self, report: Callable[..., Any]) -> None:
        times = steady(0, 20)
        scans = [(np.ceil(seconds) + i * 1e-3, raw) for i, (seconds, raw) in enumerate(taken(times))]
        assert lines(report(scans)) == []

    @pytest.mark.parametrize(
        "delays",
        [{5: 0.06}, {5: 0.06, 6: 0.06, 7: 0.06}, {4: 0.32, 5: 0.23, 6: 0.14, 7: 0.05}],
        ids=["one sample", "three in a row", "a queue that was held up"],
    )
    @pytest.mark.parametrize("gone", [set(), {44, 50, 90, 91, 398}], ids=["none gone", "five gone"])
    def test_stamps_of_late_samples_are_not_a_loss(
        self, report: Callable[..., Any], delays: dict[int, float], gone: set[int]
    ) -> None:
        times = [time + delays.get(i % 40, 0.0) for i, time in enumerate(steady(0, 40)) if i not in gone]
        found = report(taken(times))
        assert found.topics[0].timing.lost == len(gone)
        assert lines(found) == []

    def test_a_scanner_without_a_steady_rate_has_no_known_loss(self, report: Callable[..., Any]) -> None:
        steps = np.random.default_rng(1).uniform(0.05, 0.4, 200)
        found = report(taken(np.cumsum(steps).tolist()))
        assert found.topics[0].timing.lost is None
        assert lines(found) == []

    def test_a_pause_and_a_rate_that_falls_are_named_with_their_start(self, report: Callable[..., Any]) -> None:
        times = [*steady(0, 20), *steady(20, 30, hz=4), *steady(30, 40), *steady(45, 50)]
        found = report(taken(times))
        lost, slow, pause = lines(found)
        assert lost.endswith("samples were lost")
        assert slow == "/scan: less than half of its usual 10.0 Hz for 10.0 s, first from 20.00 s on"
        assert pause == "/scan: nothing came once, for up to 5.1 s, first from 39.90 s on"

    def test_a_long_silence_is_named_once_and_a_shorter_pause_with_it(self, report: Callable[..., Any]) -> None:
        times = [*steady(0, 20), *steady(25, 45), *steady(145, 165)]
        assert lines(report(taken(times))) == [
            "/scan: nothing was recorded for 100.10 s from 44.90 s on, or the clock jumped ahead",
            "/scan: nothing came once, for up to 5.1 s, first from 19.90 s on",
        ]

    @pytest.mark.parametrize(
        ("late", "said"), [(0.5, []), (40.0, ["/scan: stamps are 40.0 s behind the recorder's clock"])]
    )
    def test_stamps_by_another_clock_are_named(self, report: Callable[..., Any], late: float, said: list[str]) -> None:
        assert lines(report(taken(steady(0, 5), late=late))) == said

    def test_stamps_of_a_simulation_are_meant_so(self, report: Callable[..., Any]) -> None:
        scans = [(seconds, sweeps.scan(round((seconds + 1) * 1e9), GOOD)) for seconds in steady(0, 5)]
        assert lines(report(scans)) == []


ODOM, TF = "nav_msgs/msg/Odometry", "tf2_msgs/msg/TFMessage"


def odometry(seconds: float) -> dict[str, Any]:
    return {"header": recorded.stamped(recorded.START_NS + round(seconds * 1e9), "odom"), "child_frame_id": "base"}


def tf(seconds: float, x: float, parent: str = "odom") -> dict[str, Any]:
    header = recorded.stamped(recorded.START_NS + round(seconds * 1e9), parent)
    transform = {"translation": {"x": x}, "rotation": {"w": 1.0}}
    return {"transforms": [{"header": header, "child_frame_id": "base_link", "transform": transform}]}


class TestStampsThatAreNotDates:
    @pytest.mark.parametrize(
        ("since_ns", "said"),
        [
            (
                35 * 10**9,
                "stamps are 1,699,999,965 s behind the recorder's clock: they are seconds since a start, others",
            ),
            (0, "stamps are 1,700,000,002 s behind the recorder's clock: they are 0, others"),
        ],
        ids=["since boot", "zero"],
    )
    @pytest.mark.parametrize("other", [ODOM, TF])
    def test_are_named_where_others_are_dates(self, tmp_path: Path, since_ns: int, said: str, other: str) -> None:
        fields = odometry if other == ODOM else (lambda seconds: tf(seconds, 0.0))
        messages: list[Any] = []
        for i in range(50):
            stamp = recorded.stamped(since_ns + i * 10**8 if since_ns else 0, "laser")
            messages += [(i / 10, "/scan", {**SCAN, "header": stamp}), (i / 10, "/other", fields(i / 10))]
        path = recorded.write(tmp_path / "x", {"/scan": "sensor_msgs/msg/LaserScan", "/other": other}, messages)
        with robowidgets.open(path) as recording:
            assert lines(recording.doctor()) == [f"/scan: {said} are dates"]

    def test_speeds_without_a_header_have_none(self, tmp_path: Path) -> None:
        types = {"/speed": "geometry_msgs/msg/Twist", "/odom": ODOM}
        messages: list[Any] = []
        for i in range(50):
            messages += [(i / 10, "/speed", {}), (i / 10, "/odom", odometry(i / 10))]
        with robowidgets.open(recorded.write(tmp_path / "x", types, messages)) as recording:
            assert lines(recording.doctor()) == []

    @pytest.mark.parametrize("name", ["microros_stamps", "zero_stamps"])
    def test_of_a_microcontroller_are_named(self, data: Path, name: str) -> None:
        with robowidgets.open(data / f"reports/stamps_since_boot/{name}.mcap") as recording:
            (line,) = lines(recording.doctor())
        assert re.match(r"/scan: stamps are 1,7(59,999,9|60,000,0)\d\d s behind the recorder's clock", line)


class TestTransforms:
    def drive(self, folder: Path, messages: Iterable[Any]) -> list[str]:
        with robowidgets.open(recorded.write(folder / "x", {"/tf": TF}, messages)) as recording:
            return [line for line in lines(recording.doctor()) if "widget" not in line]

    @pytest.mark.parametrize("turns", [(0, 1), (0, 0, 1), (0, 0, 0, 1, 1)], ids=str)
    def test_two_publishers_of_one_are_named(self, tmp_path: Path, turns: tuple[int, ...]) -> None:
        own = [(i / 50, "/tf", tf(i / 50, i / 250 + 0.3 * turns[i % len(turns)])) for i in range(300)]
        (line,) = self.drive(tmp_path, own)
        assert re.fullmatch(
            r"tf: two publishers of odom->base_link, 0\.(29|30|31) m apart: it jumps between them", line
        )

    def test_two_parents_of_one_frame_are_named(self, tmp_path: Path) -> None:
        own = [(i / 50, "/tf", tf(i / 50, i / 250, ("odom", "map")[i % 2])) for i in range(300)]
        assert self.drive(tmp_path, own) == ["base_link has 2 parents in tf: odom, map"]

    @pytest.mark.parametrize("noise", [0.0, 0.005, 0.05])
    def test_one_publisher_that_drives_or_is_unsure_is_not_a_conflict(self, tmp_path: Path, noise: float) -> None:
        shake = np.random.default_rng(1).normal(0, noise, 300)
        own = [(i / 50, "/tf", tf(i / 50, 0.02 * i * (noise == 0) + shake[i])) for i in range(300)]
        assert self.drive(tmp_path, own) == []


def test_releases_without_a_message_are_not_samples(tmp_path: Path) -> None:
    with robowidgets.open(hazards.write(tmp_path / "drive", {0.0: True, 2.0: True, 4.0: False})) as recording:
        assert len(recording.touches()) == 5
        assert [topic.samples for topic in recording.doctor().topics] == [3]


class TestScans:
    def test_a_header_that_lies_is_named_once_for_all(self, report: Callable[..., Any]) -> None:
        found = report(taken(steady(0, 5), [2.0] * 7))
        assert lines(found) == ["/scan: 7 rays, but the header implies 11 (angle_max 28.6°)"]

    def test_what_is_odd_in_some_scans_is_named_with_their_number(self, report: Callable[..., Any]) -> None:
        times = steady(0, 10)
        some = [*taken(times[:40]), *taken(times[40:50], [40.0] * 6 + [2.0] * 5), *taken(times[50:])]
        said = "/scan: a third or more of the rays lie beyond range_max (30 m) (in 10 of 100 scans, first at 4.00 s)"
        assert lines(report(some)) == [said]

    def test_what_differs_in_numbers_alone_is_one_line(self, report: Callable[..., Any]) -> None:
        rays = [12 + i % 5 for i in range(100)]
        increments = [1.0 / count for count in rays]  # the header implies one ray more
        scans = [
            scan
            for seconds, count, increment in zip(steady(0, 10), rays, increments, strict=True)
            for scan in taken([seconds], [2.0] * count, increment=increment)
        ]
        said = "/scan: angle_max is one step too far for 12 to 16 rays (in 100 of 100 scans)"
        found = report(scans)
        assert lines(found) == [said]
        assert found.problems[0].remedy == "angles are counted from angle_min; programs should do so too"

    def test_what_differs_in_numbers_alone_counts_together(self, report: Callable[..., Any]) -> None:
        times = steady(0, 10)
        odd = [*taken(times[50:51], [float("nan")] * 11), *taken(times[51:53], [float("nan")] * 12, increment=1 / 11)]
        said = ("/scan: no readings: all 11 to 12 rays say NaN, no measurement (in 3 of 100 scans, first at 5.00 s)",)
        assert tuple(lines(report([*taken(times[:50]), *odd, *taken(times[53:])]))) == said

    def test_single_scans_without_a_reading_are_not_a_problem_of_the_recording(
        self, report: Callable[..., Any]
    ) -> None:
        times = steady(0, 10)
        assert lines(report([*taken(times[:1], [float("nan")] * 11), *taken(times[1:])])) == []

    def test_frames_are_named_where_they_are_several_or_empty(self, report: Callable[..., Any]) -> None:
        times = steady(0, 4)
        mixed = [*taken(times[:20], frame_id="front"), *taken(times[20:], frame_id="")]
        found = report(mixed)
        assert found.topics[0].frame_ids == ("front", "")
        assert lines(found) == [
            "/scan: laser scans of 2 frames: front, (empty)",
            "/scan: frame_id is empty (in 20 of 40 scans, first at 2.00 s)",
        ]

    def test_a_frame_with_a_name_without_end_leaves_the_table_readable(self, report: Callable[..., Any]) -> None:
        found = report(taken(steady(0, 4), frame_id=300 * "front"))
        assert max(map(len, str(found).splitlines())) < 300


def test_topics_that_never_came_are_named_but_for_those_that_are_always_there(report: Callable[..., Any]) -> None:
    silent = ["/scan_rear", "/bump", "/rosout", "/parameter_events", "/add/_service_event"]
    assert lines(report(taken(steady(0, 3)), silent=silent)) == ["/scan_rear, /bump: no message came"]


def test_problems_of_the_file_come_first_with_a_remedy(tmp_path: Path) -> None:
    whole = sweeps.write(tmp_path / "drive", taken(steady(0, 30)))
    data = next(whole.glob("*.mcap")).read_bytes()
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(data[: len(data) * 2 // 3])
    with robowidgets.open(cut) as recording:
        first, *_ = recording.doctor().problems
        assert first.what == recording.problems[0]
        assert first.remedy.startswith("robowidgets repair")


def test_a_closed_recording_is_refused() -> None:
    recording = robowidgets.open(robowidgets.SAMPLE)
    recording.close()
    with pytest.raises(RecordingError, match="is closed"):
        recording.doctor()


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for name in TOLD if name.startswith(("good/", "odd/"))])
def test_there_is_no_false_alarm_on_real_recordings(data: Path, name: str) -> None:
    with robowidgets.open(data / name) as recording:
        found = recording.doctor()
        own = [problem.what for problem in found.problems if problem.what not in recording.problems]
    expected = {
        "odd/stamps_a_year_off.bag": [
            "/training_scan: nothing came 3 times, for up to 9.9 s by its stamps, first from 0.04 s on",
            "/training_scan: stamps are 380.3 days behind the recorder's clock",
        ],
        "odd/every_ros2_type_mcap": [
            "/test/sensor_msgs/laser_scan: 5 rays, but the header implies 315 (angle_max 90.0°)",
            "/test/sensor_msgs/multi_echo_laser_scan: 3 rays, but the header implies 32 (angle_max 90.0°)",
        ],
    }
    assert own == expected.get(name, [])
