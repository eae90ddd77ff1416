"""The content and the problems of many recordings."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import robowidgets
from robowidgets.command import main
from robowidgets.fleet import Summary, doctor, summary

from ..pages import display_html
from ..recordings import recorded
from .executors import Here


def test_a_summary_has_what_the_recording_says(runs: Path) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        scans, poses = recording.scans(), recording.speeds().poses
        touches = recording.find(robowidgets.conditions.touched())
        away = np.where(scans.ranges < scans[0].sample.range_min, np.inf, scans.ranges)
        nearest = np.nanmin(away)
    frame = summary(runs, executor=Here()).to_pandas()
    row = frame.iloc[0]
    assert len(frame) == 4
    assert row["driven"] == pytest.approx(np.hypot(*np.diff(poses[:, :2], axis=0).T).sum())
    assert row["touches"] == len(touches)
    assert np.float32(row["nearest"]) == nearest
    assert scans.seconds[np.nanargmin(np.nanmin(away, axis=1))] == pytest.approx(row["nearest_at"])
    assert (row["seconds"], row["messages"]) == (recording.duration, sum(topic.count for topic in recording.topics))
    assert frame["problem"].iloc[3].startswith("was cut off")


def test_it_prints_a_line_for_each_recording_and_their_sum(runs: Path) -> None:
    text = repr(summary(runs, executor=Here()))
    assert text.startswith("3 recordings, ")
    assert "\n  monday/run_1.mcap  " in text
    assert "\n! not read: broken.bag: " in text


def test_bars_show_which_drive_went_far_and_came_near() -> None:
    row = {"file": "", "seconds": 1.0, "start_ns": None, "stops": 0, "nearest_at": 0.0}
    found = [
        {**row, "file": "/runs/a.bag", "driven": 20.0, "touches": 0, "nearest": 0.5},
        {**row, "file": "/runs/b.bag", "driven": 13.0, "touches": 4, "nearest": None},
    ]
    made = Summary(found, files=["/runs/a.bag", "/runs/b.bag"])
    lines = [line.split() for line in repr(made).splitlines()[2:]]
    assert lines[0] == ["a.bag", "1.0", "20.0", "m", "█████", "0", "0", "0.50", "m", "█████", "0.00"]
    assert lines[1] == ["b.bag", "1.0", "13.0", "m", "███▎", "0", "4", "█████", "0.00"]
    assert 'rgba(128,128,128,.3) 65%,transparent 65%)">13.0 m</td>' in display_html(made)


def test_the_sum_of_the_ways_covers_only_drives_with_a_way() -> None:
    row = {"file": "/runs/a.bag", "seconds": 1.0, "start_ns": None, "stops": 0, "touches": 0, "nearest": None}
    row["nearest_at"] = None

    def heading(*ways: float | None) -> str:
        found = [{**row, "driven": way} for way in ways]
        return repr(Summary(found, files=["/runs/a.bag"])).splitlines()[0]

    assert heading(2.0, 0.5) == "2 recordings, 2.0 s, 2.5 m driven"
    assert heading(2.0, None, 0.5) == "3 recordings, 3.0 s, 2.5 m driven in 2 of them"
    assert heading(0.0) == "1 recording, 1.0 s, 0.0 m driven"
    assert heading(None, None) == "2 recordings, 2.0 s"


def test_problems_that_differ_by_their_numbers_are_one_kind(runs: Path) -> None:
    whole = robowidgets.SAMPLE.read_bytes()
    (runs / "run_2.mcap").write_bytes(whole[: len(whole) // 2])
    (runs / "run_10.mcap").write_bytes(whole[: len(whole) // 3])
    found = doctor(runs, executor=Here())
    kind = found.kinds[0]
    assert (kind.recordings, kind.text) == (2, "the recording was cut off: read … messages, up to … s")
    assert "robowidgets repair" in kind.remedy
    rows = found.to_arrow().to_pylist()
    assert sum("was cut off: read" in row["problem"] for row in rows) == 2
    assert "2 with problems" in repr(found)


@pytest.mark.parametrize(("command", "code"), [("info", 1), ("doctor", 2)])
def test_a_command_that_could_read_none_of_several_files_reports_each_reason_and_fails(
    command: str, code: int, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(tmp_path / name) for name in ("a.mcap", "b.mcap")]
    assert main([command, *files]) == code
    said = capsys.readouterr()
    assert said.out == ""
    assert said.err.splitlines() == [
        *(f"! {file}: no such file or folder" for file in files),
        "robowidgets: none of these recordings could be read",
    ]
    assert "no problems found" not in repr(doctor(*files))


@pytest.mark.slow
def test_the_commands_take_several_recordings(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["info", str(runs), "--json"]) == 0
    assert len([json.loads(line) for line in capsys.readouterr().out.splitlines()]) == 4
    assert main(["doctor", str(runs)]) == 1
    assert capsys.readouterr().out.startswith("3 recordings")
    assert main(["info", str(runs / "run_2.mcap"), str(runs / "run_2.mcap")]) == 0
    assert "/scan" in capsys.readouterr().out


def drive(folder: Path, ways: Iterable[float], speed: float, hz: float = 10.0) -> Path:
    """A recording of odometry with these positions, all with the same speed."""
    messages = [
        (
            i / hz,
            "/odom",
            {
                "pose": {"pose": {"position": {"x": x}, "orientation": {"w": 1.0}}},
                "twist": {"twist": {"linear": {"x": speed}}},
            },
        )
        for i, x in enumerate(ways)
    ]
    return recorded.write(folder, {"/odom": "nav_msgs/msg/Odometry"}, messages)


SLOW = np.arange(100) * 0.01
FAST = np.arange(100) * 1.5


@pytest.mark.parametrize(
    ("ways", "speed", "driven"),
    [
        (np.where(np.arange(100) < 50, SLOW, 30 + SLOW), 0.1, 0.98),
        (np.where(np.arange(100) == 50, 30, SLOW), 0.1, 0.97),
        (np.where(np.arange(100) < 1, -30, SLOW), 0.1, 0.98),
        (FAST, 15.0, 148.5),
        (FAST, 0.0, 148.5),  # many drivers leave the speed out
        (np.where(np.arange(100) < 50, FAST, FAST - 70), 15.0, 147.0),
    ],
)
def test_a_jump_of_the_odometry_is_not_driven(
    tmp_path: Path, ways: NDArray[np.float64], speed: float, driven: float
) -> None:
    (row,) = summary(drive(tmp_path / "run", ways.tolist(), speed)).to_arrow().to_pylist()
    assert row["driven"] == pytest.approx(driven)
