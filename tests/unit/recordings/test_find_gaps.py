"""Finding gaps: the topics that fell silent, and the topic of the search."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main
from robowidgets.recordings import UnknownTopicError

from ..pages import display_html
from . import topics
from .topics import every


class TestSilent:
    WRITTEN: Mapping[str, Sequence[tuple[float, float]]] = {
        "/odom": [*every(0.5, 0, 10, 0.5), *every(0.5, 20, 40.5, 0.5)],
        "/scan": [*every(0.5, 0, 15, 0.5), *every(0.5, 25, 30, 0.5), *every(0.5, 36, 40.5, 0.5)],
    }

    @pytest.fixture
    def recording(self, tmp_path: Path) -> robowidgets.Recording:
        return robowidgets.open(topics.write(tmp_path / "x", self.WRITTEN))

    def test_names_the_topics_that_fell_silent(self, recording: robowidgets.Recording) -> None:
        spans = recording.find(conditions.gap(3))
        assert [(*span[:2], span.silent) for span in spans] == [
            (9.5, 25, ("/odom", "/scan")),
            (29.5, 36, ("/scan",)),
        ]
        assert repr(spans).splitlines()[1:] == [
            "  start    end  seconds        silent",
            "   9.50  25.00    15.50  /odom, /scan",
            "  29.50  36.00     6.50         /scan",
        ]
        assert ">/odom, /scan</td>" in display_html(spans)
        assert spans.to_pandas()["silent"].tolist() == [("/odom", "/scan"), ("/scan",)]

    def test_are_not_joined_across_a_single_sample(self, tmp_path: Path) -> None:
        recording = robowidgets.open(topics.write(tmp_path / "y", {"/scan": [(3.0 * i, 1.0) for i in range(11)]}))
        spans = recording.find(conditions.gap(2))
        assert [(round(span.start, 3), round(span.end, 3)) for span in spans] == [(3 * i, 3 * i + 3) for i in range(10)]
        assert spans.seconds == pytest.approx(30)

    def test_names_those_that_are_silent_in_what_was_found(self, recording: robowidgets.Recording) -> None:
        def late(moment: Any) -> bool:
            return bool(moment.seconds >= 30)

        def silent(condition: conditions.Condition) -> list[tuple[str, ...]]:
            return [span.silent for span in recording.find(condition)]

        assert silent(conditions.gap(3) & late) == [("/scan",)]
        assert silent(conditions.gap(3, "/odom") | late) == [("/odom",), ()]
        assert silent(~conditions.gap(3)) == [(), (), ()]
        assert silent(conditions.gap(3) & conditions.gap(4)) == [("/odom", "/scan"), ("/scan",)]


class TestTopics:
    def test_in_the_shell_are_of_any_topic_or_of_one(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        file = str(topics.write(tmp_path / "x", {"/scan": [(0, 1), (5, 1)], "/odom": [(0, 1), (2, 1), (5, 1)]}))
        assert main(["find", file, "--gap", "2.5"]) == 0
        assert capsys.readouterr().out == "# start\tend\tseconds\tsilent\n0.000\t5.000\t5.000\t/scan, /odom\n"
        assert main(["find", file, "--gap", "2.5", "--silent", "/odom"]) == 0
        assert capsys.readouterr().out == "# start\tend\tseconds\tsilent\n2.000\t5.000\t3.000\t/odom\n"
        assert main(["find", file, "--gap", "2.5", "--json"]) == 0
        (span,) = json.loads(capsys.readouterr().out)["spans"]
        assert span["silent"] == ["/scan", "/odom"]

    def test_of_nothing_steady_have_to_be_named(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        file = str(topics.write(tmp_path / "x", {"/left_bump": [(0, 1), (5, 1)], "/cmd_vel": [(0, 1)]}))
        text = "x has no laser scans, measured speeds or sonars: name the topic, as in "
        with robowidgets.open(file) as recording, pytest.raises(UnknownTopicError, match=f"{text}topic='/left_bump'"):
            recording.find(conditions.gap(1))
        assert main(["find", file, "--gap", "1"]) == 2
        assert capsys.readouterr().err == f"robowidgets: {text}--silent /left_bump\n"

    def test_of_nothing_at_all_are_refused(self, tmp_path: Path) -> None:
        recording = robowidgets.open(topics.write(tmp_path / "x", {}))
        with pytest.raises(UnknownTopicError, match="x has no laser scans, measured speeds or sonars"):
            recording.find(conditions.gap(1))
