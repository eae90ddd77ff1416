"""Refusals and early ends of ``robowidgets find``."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from shutil import copy

import pytest

import robowidgets
from robowidgets.command import main

FILE = str(robowidgets.SAMPLE)


@pytest.mark.parametrize(
    ("arguments", "text"),
    [
        (["--gap", "0.19", "--scan", "/nonsense"], "--scan needs --nearest-below, which is missing"),
        (["--gap", "1", "--sector", "1", "2"], "--sector needs --nearest-below, which is missing"),
        (["--touched", "--axis", "nonsense"], "--axis needs --speed-above, which is missing"),
        (["--touched", "--speed", "/odom"], "--speed needs --speed-above, which is missing"),
        (["--gap", "1", "--touch", "/bumper"], "--touch needs --touched, which is missing"),
        (["--touched", "--silent", "/bumper"], "--silent needs --gap, which is missing"),
        (["--nearest-below", "0"], "find: --nearest-below: expected metres above 0, got 0.0"),
        (["--speed-above", "-1"], "find: --speed-above: expected a speed, 0 or more, got -1.0"),
        (
            ["--nearest-below", "1", "--sector", "-30", "30"],
            "find: --sector: expected radians within ±2 pi, got -30.0; degrees are written as -30deg",
        ),
    ],
)
def test_what_has_no_use_or_no_sense_is_refused(
    arguments: list[str], text: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", FILE, *arguments]) == 2
    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert text in said.err


@pytest.mark.parametrize(
    ("sector", "where"),
    [
        (["-30deg", "30deg"], "between -30° and 30°"),
        (["-0.5", "7.5deg"], "between -28.65° and 7.5°"),
        (["back"], "in back"),
    ],
)
def test_a_sector_is_given_in_degrees_or_by_name(
    sector: list[str], where: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", "--nearest-below", "0.5", "--sector", *sector, FILE, "--json"]) in (0, 1)
    assert json.loads(capsys.readouterr().out)["condition"].endswith(where)


def test_an_invalid_sector_is_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", FILE, "--nearest-below", "0.5", "--sector", "frnt", "30deg"]) == 2
    assert "find: --sector: expected radians, or degrees as in \"20deg\", got 'frnt'" in capsys.readouterr().err


def test_an_unknown_name_of_a_sector_is_refused_with_the_known_names(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", FILE, "--nearest-below", "0.5", "--sector", "ahead"]) == 2
    assert "find: --sector: expected front, left, back, right or two angles" in capsys.readouterr().err


@pytest.mark.parametrize("options", [["--touched", FILE], ["--touched", FILE, "--json"], ["--touched", "left", FILE]])
def test_the_file_may_stand_after_the_sensor(options: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["find", *options]) == 0
    assert len(capsys.readouterr().out.splitlines()) > 2


def test_all_sensors_that_are_named_must_be_touched(capsys: pytest.CaptureFixture[str]) -> None:
    main(["find", FILE, "--touched", "left", "--touched", "right", "--json"])
    assert json.loads(capsys.readouterr().out)["condition"] == "(left touched & right touched)"
    main(["find", FILE, "--touched", "left", "--touched", "--any", "--json"])
    assert json.loads(capsys.readouterr().out)["condition"] == "(left touched | anything touched)"


def test_spans_are_found_by_the_names_that_people_gave_them(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = str(copy(FILE, tmp_path))
    with robowidgets.open(file) as recording:
        recording.label("door", 12, 14.5)
    for asked in (["--label", file], ["--label", "door", str(tmp_path)]):
        assert main(["find", *asked, "--json"]) == 0
        assert '"start": 12.0' in capsys.readouterr().out
    assert main(["find", file, "--label", "window"]) == 1
    assert main(["find", file, "--label", "x" * 1000]) == 2
    assert "find: --label: expected a name of 1 to" in capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.parametrize(("arguments", "code"), [(["find", FILE, "--touched"], 0), (["info", FILE], 0)])
def test_a_closed_pipe_ends_quietly(arguments: list[str], code: int) -> None:
    command = subprocess.Popen(
        [sys.executable, "-m", "robowidgets", *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert command.stdout is not None
    command.stdout.close()
    _, said = command.communicate(timeout=240)
    assert (said, command.returncode) == (b"", code)
