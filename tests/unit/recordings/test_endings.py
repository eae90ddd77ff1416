"""Topics that begin long after their recording, or end long before it, are reported, and no others."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest

import robowidgets
from robowidgets.files._rosbags import open_mcap
from robowidgets.recordings._sample_reader import silences
from robowidgets.repair.mcap_records import INDEX_HEAD

from .clock_back import KINDS, SCAN, SPEED, Message, cut, drive, long_mcap, mcap, step


def part(topic: str, start: int, stop: int) -> list[Message]:
    """A drive of 40 s in which one topic has these messages only."""
    return [message for message in drive(step(0.0, count=400)) if message[0] != topic or start <= message[2] < stop]


def ends(topic: str, after: int) -> list[Message]:
    return part(topic, 0, after)


@pytest.mark.parametrize("kind", KINDS)
class TestATopicThatEndsHalfWay:
    @pytest.mark.parametrize("topic", [SCAN, SPEED])
    def test_is_reported_when_the_recording_is_opened(self, tmp_path: Path, kind: str, topic: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, ends(topic, 200)))
        assert recording.problems == (f"{topic}: nothing after 19.90 s of 39.90 s",)

    def test_is_not_reported_for_one_that_ends_with_it(self, tmp_path: Path, kind: str) -> None:
        assert robowidgets.open(KINDS[kind](tmp_path, ends(SCAN, 351))).problems == ()


@pytest.mark.parametrize("kind", KINDS)
class TestATopicThatBeginsLate:
    @pytest.mark.parametrize("topic", [SCAN, SPEED])
    def test_is_reported_with_the_rate_of_its_own_time(self, tmp_path: Path, kind: str, topic: str) -> None:
        recording = robowidgets.open(KINDS[kind](tmp_path, part(topic, 60, 200)))
        assert recording.problems == (
            f"{topic}: nothing before 6.00 s of 39.90 s",
            f"{topic}: nothing after 19.90 s of 39.90 s",
        )
        assert [there.rate for there in recording.topics] == pytest.approx([10.0, 10.0])
        assert str(recording).splitlines()[2].split()[2:4] == [("140" if topic == SCAN else "400"), "10.0"]

    def test_is_not_reported_for_one_that_begins_with_it(self, tmp_path: Path, kind: str) -> None:
        assert robowidgets.open(KINDS[kind](tmp_path, part(SCAN, 49, 400))).problems == ()


@pytest.mark.parametrize("kind", ["bag", "mcap"])
def test_a_damaged_file_tells_it_too(tmp_path: Path, kind: str) -> None:
    recording = robowidgets.open(cut(KINDS[kind](tmp_path, ends(SCAN, 200))))
    assert recording.problems[1].startswith("/scan: nothing after 19.90 s of 39.")


def test_a_log_tells_it_too(tmp_path: Path) -> None:
    lines = [f"ODOM 0 0 0 0.1 0 0 {i / 10} host {i / 10}" for i in range(400)]
    lines[0:190:10] = [f"FLASER 1 2.0 0 0 0 0 0 0 {i} host {i}" for i in range(19)]
    (tmp_path / "x.log").write_text("\n".join([*lines, ""]))
    assert robowidgets.open(tmp_path / "x.log").problems == ()
    lines[0:200:5] = [f"FLASER 1 2.0 0 0 0 0 0 0 {i / 2} host {i / 2}" for i in range(40)]
    (tmp_path / "x.log").write_text("\n".join([*lines, ""]))
    assert robowidgets.open(tmp_path / "x.log").problems == ("FLASER: nothing after 19.50 s of 39.90 s",)


class TestASilence:
    def test_is_longer_than_five_seconds(self) -> None:
        assert silences("/scan", 1000, 0, 94, 100) == ["/scan: nothing after 94.00 s of 100.00 s"]
        assert silences("/scan", 1000, 6, 100, 100) == ["/scan: nothing before 6.00 s of 100.00 s"]
        assert silences("/scan", 1000, 5, 95, 100) == []

    def test_is_longer_than_ten_steps_of_the_topic_itself(self) -> None:
        assert silences("/scan", 21, 20, 80, 110) == []
        assert silences("/scan", 21, 20, 80, 111) == ["/scan: nothing after 80.00 s of 111.00 s"]


def test_a_few_messages_within_a_second_have_no_rate(tmp_path: Path) -> None:
    with robowidgets.open(mcap(tmp_path, part(SPEED, 3, 9))) as recording:
        assert [topic.rate for topic in recording.topics] == [pytest.approx(10.0), None]


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
        index = source._reader.index
        offsets = index.places[2, index.places[0] == len(index.starts) - 1].tolist()
    raw = bytearray(path.read_bytes())
    for at in offsets:
        raw[at : at + INDEX_HEAD.size] = b"\xff" * INDEX_HEAD.size
    path.write_bytes(raw)
    with robowidgets.open(path) as recording:
        assert len(list(recording.samples(SPEED))) == 400
        assert len(list(recording.samples(SCAN))) == 200
