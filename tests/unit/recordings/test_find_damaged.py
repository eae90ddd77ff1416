"""Finding in a recording that was cut off: the result notes that something may be missing."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main

from ..pages import display_html
from . import sweeps


@pytest.fixture
def damaged(tmp_path: Path) -> Path:
    """The first part of a recording of ten seconds."""
    (whole,) = sweeps.write(tmp_path / "x", sweeps.numbered(100, rays=500)).glob("*.mcap")
    cut = tmp_path / "<cut>.mcap"
    cut.write_bytes(whole.read_bytes()[: whole.stat().st_size // 2])
    return cut


def test_the_result_of_a_search_reports_problems(damaged: Path) -> None:
    with robowidgets.open(damaged) as recording:
        spans = recording.find(conditions.nearest_below(0.5))
        (problem,) = spans.problems
    assert problem.startswith("the recording was cut off: read ")
    assert repr(spans).splitlines() == ["nearest below 0.5 m: never", f"! {problem}"]
    assert f"<div>⚠ {problem}</div>" in display_html(spans)
    assert spans[:0].problems == spans.problems


def test_a_whole_recording_has_no_problem() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        assert recording.find(conditions.touched()).problems == ()


@pytest.mark.parametrize(("asked", "code"), [("0.5", 1), ("1.5", 0)])
def test_the_shell_prints_it_with_the_results(
    damaged: Path, asked: str, code: int, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["info", str(damaged)]) == 0
    told = capsys.readouterr().out.splitlines()[-1]
    assert main(["find", str(damaged), "--nearest-below", asked]) == code
    said = capsys.readouterr()
    assert said.out.startswith("# start\tend\tseconds\tnearest\tindex\tangle\n")
    assert said.err == f"{told}\n"
    assert main(["find", str(damaged), "--nearest-below", asked, "--json"]) == code
    said = capsys.readouterr()
    assert json.loads(said.out)["problems"] == [told.removeprefix("! ")]
    assert said.err == f"{told}\n"


def test_the_shell_also_prints_it_without_a_search(damaged: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", str(damaged), "--touched"]) == 2
    first, second = capsys.readouterr().err.splitlines()
    assert first.startswith("! the recording was cut off: ")
    assert "has no touch sensors" in second
