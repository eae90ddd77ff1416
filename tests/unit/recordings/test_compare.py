"""Several drives in one plot and on one map."""

from __future__ import annotations

from pathlib import Path
from shutil import copy

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.recordings import UnknownTopicError

from . import recorded, robot

SAMPLE = Path(robowidgets.SAMPLE)


def test_two_drives_stand_in_one_plot_and_on_one_map(tmp_path: Path) -> None:
    other = robot.write(tmp_path / "other")
    view = robowidgets.compare(SAMPLE, other)
    nearest, speed = ("nearest (sample)", "nearest (other)"), ("speed (sample)", "speed (other)")
    assert view.plot.names == (*nearest, *speed)
    assert view.plot.ghosts == [nearest[1], speed[1]]
    assert view.plot.units == {**dict.fromkeys(nearest, "m"), **dict.fromkeys(speed, "m/s")}
    with robowidgets.open(other) as recording:
        scans, speeds = recording.scans(), recording.speeds()
        for (seconds, values), times, expected in (
            (view.plot[nearest[1]], scans.seconds, scans.distances()),
            (view.plot[speed[1]], speeds.seconds, speeds.linear[:, 0]),
        ):
            assert (seconds.tolist(), values.tolist()) == (times.tolist(), expected.tolist())
    assert (2.0, 3.0, "other: anything touched") in view.plot.marks
    assert any(text == "sample: anything touched" for _, _, text in view.plot.marks)
    assert view.map.names == ("sample", "other")
    assert view.children
    view.plot.time = 7.5
    assert [*view.map.drawn] == ["sample at 7.5 s", "other at 7.5 s"]
    view.plot.time = None
    assert not view.map.drawn


def test_by_place_the_other_one_tells_what_it_met_where_the_first_one_was(tmp_path: Path) -> None:
    view = robowidgets.compare(SAMPLE, SAMPLE, by="place", marks=conditions.nearest_below(0.2))
    names = view.plot.names
    assert names[:2] == ("nearest (sample)", "nearest (sample 2)")
    (_, here), (_, there) = (view.plot[name] for name in names[:2])
    assert len(here) == len(there)
    assert np.median(np.abs(here - there)) == 0
    assert all(text.startswith("sample: nearest below 0.2 m") for _, _, text in view.plot.marks)
    view.plot.time = 7.5
    assert [*view.map.drawn] == ["sample at 7.5 s"]
    with pytest.raises(ValueError, match=r"compare\(\): sample.mcap has no place within 0.5 m .*give origins="):
        robowidgets.compare(SAMPLE, SAMPLE, by="place", origins=[(100, 0, 0)])


def test_names_distinguish_files_and_missing_data_is_reported(tmp_path: Path) -> None:
    for folder in ("monday", "tuesday"):
        (tmp_path / folder).mkdir()
        copy(SAMPLE, tmp_path / folder / "run.mcap")
    view = robowidgets.compare(tmp_path / "monday/run.mcap", tmp_path / "tuesday/run.mcap")
    assert view.plot.names[:2] == ("nearest (monday/run.mcap)", "nearest (tuesday/run.mcap)")
    speeds = recorded.write(
        tmp_path / "wheels", {"/speed": "geometry_msgs/msg/Twist"}, [(0.0, "/speed", {}), (1.0, "/speed", {})]
    )
    with robowidgets.open(SAMPLE) as opened:
        view = robowidgets.compare(opened, speeds)
        assert opened.scans()  # it is still open
    assert view.plot.title == "sample, wheels; not recorded: nearest of wheels"
    assert robowidgets.compare(speeds, speeds).map is None
    log = recorded.write(tmp_path / "log", {"/log": "std_msgs/msg/String"}, [(0.0, "/log", {"data": "done"})])
    with pytest.raises(UnknownTopicError, match="none of log, log 2 has scans or measured speeds"):
        robowidgets.compare(log, log)


def test_what_cannot_be_compared_is_refused() -> None:
    with pytest.raises(ValueError, match="expected 2 to 4 recordings, got 1"):
        robowidgets.compare(SAMPLE)
    with pytest.raises(ValueError, match="expected 'time' or 'place', got 'way'"):
        robowidgets.compare(SAMPLE, SAMPLE, by="way")
    with pytest.raises(ValueError, match=r"origins: expected one for each drive but the first \(1\), got 2"):
        robowidgets.compare(SAMPLE, SAMPLE, origins=[(0, 0, 0), (1, 0, 0)])
