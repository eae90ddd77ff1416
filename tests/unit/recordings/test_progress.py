"""Long work shows a bar, and only one."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from comm import get_comm_manager
from tqdm.notebook import tqdm_notebook

import robowidgets
from robowidgets import conditions
from robowidgets.notebook import progress

from . import robot, sweeps


@pytest.fixture
def recording(tmp_path: Path) -> robowidgets.Recording:
    return robowidgets.open(sweeps.write(tmp_path / "x", sweeps.numbered(1200, rays=1000)))


def test_quick_work_shows_no_bar(recording: robowidgets.Recording, capsys: pytest.CaptureFixture[str]) -> None:
    len(recording.scans())
    recording.find(conditions.nearest_below(1))
    assert capsys.readouterr().err == ""


def test_the_bar_of_a_notebook_leaves_nothing_behind_unless_it_failed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tqdm.auto.tqdm", tqdm_notebook)
    comms = get_comm_manager().comms
    before = len(comms)
    with progress.Progress(10, "Reading") as bar:
        bar.update(5)
        assert len(comms) == before, "quick work makes no bar"
        monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
        bar.update(1)
        assert len(comms) > before
    assert len(comms) == before

    def fail() -> None:
        with progress.Progress(10, "Reading") as bar:
            bar.update(5)
            raise ValueError("the file")

    with pytest.raises(ValueError, match="the file"):
        fail()
    assert len(comms) > before


def test_what_takes_long_says_what_it_does(
    recording: robowidgets.Recording, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
    len(recording.scans())
    assert "Reading /scan:   0%" in capsys.readouterr().err


@pytest.mark.parametrize("name", ["truncated.bag", "truncated.mcap", "half_the_pages.db3"])
def test_a_file_without_an_index_is_gone_through_with_a_bar(
    name: str, data: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
    robowidgets.open(data / "damaged" / name).close()
    assert f"Reading {name}: " in capsys.readouterr().err


def test_a_search_shows_one_bar_for_all_it_does(
    recording: robowidgets.Recording, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
    recording.find(conditions.nearest_below(1))
    said = capsys.readouterr().err
    assert "Finding:   0%" in said
    assert "Reading" not in said


@pytest.mark.parametrize(
    "condition",
    [
        conditions.nearest_below(1),
        conditions.touched() & ~conditions.speed_above(1),
        conditions.gap(1, "/odom"),
        lambda moment: moment.scan.distance() < 1,
    ],
)
def test_the_bar_of_a_search_comes_to_its_end(condition: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    bars: list[progress.Progress] = []

    class Bar(progress.Progress):
        def __enter__(self) -> progress.Progress:
            bars.append(self)
            return self

    monkeypatch.setattr("robowidgets.recordings.search.search.Progress", Bar)
    with robowidgets.open(robot.write(tmp_path / "drive")) as recording:
        recording.find(condition)
    (bar,) = bars
    assert bar._done == bar._options["total"] > 0


def test_a_page_is_measured_and_written_with_a_bar(
    recording: robowidgets.Recording,
    tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
    recording.html_size(start=0, end=5)
    assert "Measuring the page:   0%" in capsys.readouterr().err
    recording.to_html(tmp_path / "a.html", start=0, end=5)
    assert "Writing the page:   0%" in capsys.readouterr().err
