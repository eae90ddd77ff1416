"""Notes on the clocks of topics, one by one and together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import robowidgets

from . import topics

Silence = tuple[float, float]


def problems(folder: Path, each: int = 1, **silences: Sequence[Silence]) -> tuple[str, ...]:
    """The notes on topics at 2 Hz for 1000 s, silent for some time, once their columns were read.

    Args:
        folder: the folder to write to.
        each: number of messages at each time.
        silences: of each topic.
    """
    samples = {
        f"/{name}": [(seconds + 0.03 * len(name), 0.0) for seconds in times(silent) for _ in range(each)]
        for name, silent in silences.items()
    }
    with robowidgets.open(topics.write(folder / "drive", samples)) as recording:
        assert recording.problems == ()
        for topic in recording.topics:
            _ = recording.speeds(topic.name).seconds
        return recording.problems


def times(silences: Sequence[Silence]) -> list[float]:
    seconds = [i / 2 for i in range(2000)]
    return [at for at in seconds if all(at <= start or at >= end for start, end in silences)]


class TestSilences:
    def test_of_a_topic_are_reported_in_a_line(self, tmp_path: Path) -> None:
        assert problems(tmp_path, a=[(100, 200)]) == (
            "/a: nothing was recorded for 100.00 s from 100.00 s on, or the clock jumped ahead",
        )

    def test_of_a_topic_that_come_again_are_reported_in_a_line(self, tmp_path: Path) -> None:
        assert problems(tmp_path, a=[(100, 200), (500, 570)]) == (
            "/a: nothing was recorded 2 times, first from 100.00 s on, for up to 100.00 s, or the clock jumped ahead",
        )

    def test_shorter_than_a_minute_are_not_reported(self, tmp_path: Path) -> None:
        assert problems(tmp_path, a=[(100, 150)]) == ()

    def test_that_topics_share_are_reported_once(self, tmp_path: Path) -> None:
        assert problems(tmp_path, a=[(100, 200)], odom=[(100, 200)], tf=[]) == (
            "/a, /odom: nothing was recorded for 99.91 s from 100.09 s on, or the clock jumped ahead",
        )

    def test_of_other_lengths_or_at_other_times_are_reported_separately(self, tmp_path: Path) -> None:
        lines = problems(tmp_path, a=[(100, 200)], b=[(100, 300)], c=[(500, 600)], d=[(100, 200), (500, 600)])
        assert [line.partition(":")[0] for line in lines] == ["/a", "/b", "/c", "/d"]

    def test_come_after_what_is_wrong_with_each_clock(self, tmp_path: Path) -> None:
        assert problems(tmp_path, each=3, a=[(100, 200)], b=[(100, 200)]) == (
            "/a: the clock stands still: 3,602 of 5,403 samples bear the time of the one before",
            "/b: the clock stands still: 3,602 of 5,403 samples bear the time of the one before",
            "/a, /b: nothing was recorded for 100.00 s from 100.00 s on, or the clock jumped ahead",
        )


def test_a_topic_of_one_message_has_nothing_wrong(tmp_path: Path) -> None:
    with robowidgets.open(topics.write(tmp_path / "drive", {"/a": [(0.0, 1.0)]})) as recording:
        assert len(recording.speeds().seconds) == 1
        assert recording.problems == ()
