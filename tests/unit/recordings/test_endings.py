"""Topics that end long before their recording does are told, and no others."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

import robowidgets
from robowidgets.recordings._sample_reader import truncation_note
from robowidgets.recordings.files._index import _INDEX_HEAD
from robowidgets.recordings.files._rosbags import open_mcap

from .clock_back import KINDS, SCAN, SPEED, Message, cut, drive, long_mcap, mcap, step

S = 1_000_000_000


def ends(topic: str, after: int) -> list[Message]:
    """A drive of 40 s in which one topic has so many messages."""
    return [message for message in drive(step(0.0, count=400)) if message[0] != topic or message[2] < after]


@pytest.mark.parametrize("kind", KINDS)
class TestATopicThatEndsHalfWay:
    @pytest.mark.parametrize("topic", [SCAN, SPEED])
    def test_is_told_when_the_recording_is_opened(self, tmp_path: Path, kind: str, topic: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, ends(topic, 200)))
        assert recording.problems == (f"{topic}: nothing after 19.90 s of 39.90 s",)

    def test_is_not_told_of_one_that_ends_with_it(self, tmp_path: Path, kind: str) -> None:
        assert robowidgets.open(KINDS[kind](tmp_path, ends(SCAN, 351))).problems == ()


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_a_damaged_file_tells_it_too(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(cut(KINDS[kind](tmp_path, ends(SCAN, 200))))
    assert recording.problems[1].startswith("/scan: nothing after 19.90 s of 39.")


def test_a_log_tells_it_too(tmp_path: Path) -> None:
    lines = [f"ODOM 0 0 0 0.1 0 0 {i / 10} host {i / 10}" for i in range(400)]
    lines[0:200:10] = [f"FLASER 1 2.0 0 0 0 0 0 0 {i} host {i}" for i in range(20)]
    (tmp_path / "x.log").write_text("\n".join(lines))
    assert robowidgets.open(tmp_path / "x.log").problems == ()
    lines[0:200:5] = [f"FLASER 1 2.0 0 0 0 0 0 0 {i / 2} host {i / 2}" for i in range(40)]
    (tmp_path / "x.log").write_text("\n".join(lines))
    assert robowidgets.open(tmp_path / "x.log").problems == ("FLASER: nothing after 19.50 s of 39.90 s",)


class TestTheEndOfATopic:
    def test_is_early_more_than_five_seconds_before_the_end(self) -> None:
        assert truncation_note("/scan", 1000, 94 * S, 0, 100 * S) == "/scan: nothing after 94.00 s of 100.00 s"
        assert truncation_note("/scan", 1000, 95 * S, 0, 100 * S) == ""

    def test_is_early_by_more_than_ten_steps(self) -> None:
        assert truncation_note("/scan", 21, 50 * S, 0, 100 * S) == ""
        assert truncation_note("/scan", 21, 49 * S, 0, 100 * S) != ""

    def test_counts_from_the_start(self) -> None:
        assert truncation_note("/scan", 100, 1020 * S, 1000 * S, 1100 * S) == "/scan: nothing after 20.00 s of 100.00 s"


def test_real_recordings_end_as_they_should(data: Path) -> None:
    for path in sorted((data / "good").iterdir()):
        with robowidgets.open(path) as recording:
            assert recording.problems == (), path.name


@pytest.mark.parametrize("write", [mcap, long_mcap])
def test_an_index_that_lies_about_itself_is_met_when_messages_are_read(
    tmp_path: Path, write: Callable[[Path, list[Message]], Path]
) -> None:
    path = write(tmp_path, ends(SCAN, 200))
    with closing(open_mcap(path)) as source:
        offsets = source._reader.chunks[-1].message_index_offsets
    raw = bytearray(path.read_bytes())
    for at in offsets.values():
        raw[at : at + _INDEX_HEAD.size] = b"\xff" * _INDEX_HEAD.size
    path.write_bytes(raw)
    with robowidgets.open(path) as recording:
        assert len(list(recording.samples(SPEED))) == 400
        assert len(list(recording.samples(SCAN))) == 200
