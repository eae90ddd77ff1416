"""What is said of the clocks of topics, one by one and together."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from robowidgets.recordings.clocks import Clock, about_clock, about_clocks, clock_of

import robowidgets

from .clock_back import drive, mcap, step

S = 1_000_000_000


def times(*silences: tuple[float, float], shift: float = 0.0) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Of a clock at 10 Hz for 1000 s, but for silences from one second to another."""
    seconds = np.arange(10_000) / 10 + shift
    for start, end in silences:
        seconds = seconds[(seconds <= start) | (seconds >= end)]
    return np.round(seconds * S).astype(np.int64)


def clocks(**columns: Sequence[tuple[float, float]]) -> dict[str, Clock]:
    return {f"/{name}": clock_of(times(*silences, shift=0.03 * len(name)), 0) for name, silences in columns.items()}


class TestSilences:
    def test_of_a_topic_are_told_in_a_line(self) -> None:
        assert about_clock(times((100, 200)), 0) == (
            "nothing was recorded for 100.00 s from 100.00 s on, or the clock jumped ahead",
        )
        assert about_clock(times((100, 200), (500, 570)), 0) == (
            "nothing was recorded 2 times, first from 100.00 s on, for up to 100.00 s, or the clock jumped ahead",
        )
        assert about_clock(times((100, 150)), 0) == ()

    def test_that_topics_share_are_told_once(self) -> None:
        assert about_clocks(clocks(a=[(100, 200)], odom=[(100, 200)], tf=[])) == (
            "/a, /odom: nothing was recorded for 100.09 s from 99.93 s on, or the clock jumped ahead",
        )

    def test_of_other_lengths_or_at_other_times_are_told_by_themselves(self) -> None:
        lines = about_clocks(clocks(a=[(100, 200)], b=[(100, 300)], c=[(500, 600)], d=[(100, 200), (500, 600)]))
        assert [line.partition(":")[0] for line in lines] == ["/a", "/b", "/c", "/d"]

    def test_come_after_what_is_wrong_with_each_clock(self) -> None:
        back = clock_of(np.concatenate((times((100, 200)), times()[:1])), 0)
        lines = about_clocks({"/a": back, "/b": back})
        assert [line.split(" ", 4)[:4] for line in lines] == [
            ["/a:", "the", "clock", "goes"],
            ["/b:", "the", "clock", "goes"],
            ["/a,", "/b:", "nothing", "was"],
        ]

    def test_of_nothing_are_none(self) -> None:
        assert about_clock(np.empty(0, np.int64), 0) == about_clock(times()[:1], 0) == ()


def test_a_recording_tells_once_what_its_topics_share(tmp_path: Path) -> None:
    recording = robowidgets.open(mcap(tmp_path, drive(step(-7200.0))))
    _ = recording.scans().seconds, recording.speeds().seconds
    assert recording.problems == (
        "/scan, /vel: nothing was recorded for 7200.10 s from 4.90 s on, or the clock jumped ahead",
    )
