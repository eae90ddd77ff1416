"""Several files as one source."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterator
from pathlib import Path

import pytest

from robowidgets.files import open_source
from robowidgets.repair import RecordingError, Source

from .written import START_NS, STEP_NS, Message, messages, read, write_bag


def split(folder: Path) -> list[Path]:
    """One recording in three files, whose times overlap: speeds are written before the scans of the same time."""
    edges = {"/scan": (0, 40, 60, 90), "/cmd_vel": (0, 46, 66, 90)}
    parts: list[list[Message]] = [[], [], []]
    for i, message in enumerate(messages(90)):
        parts[bisect_right(edges[message[0]], i) - 1].append(message)
    return [write_bag(folder / f"drive_{number}.bag", part) for number, part in enumerate(parts)]


class TestWholeFiles:
    @pytest.fixture
    def source(self, tmp_path: Path) -> Iterator[Source]:
        split(tmp_path)
        source = open_source(tmp_path)
        yield source
        source.close()

    def test_become_one_recording_in_the_order_of_time(self, source: Source) -> None:
        assert read(source) == messages(90)
        assert [(channel.topic, channel.count) for channel in source.channels] == [("/scan", 60), ("/cmd_vel", 30)]
        assert len({channel.id for channel in source.channels}) == 2
        assert (source.start_ns, source.end_ns, source.problems) == (START_NS, START_NS + 89 * STEP_NS, ())
        assert [source.span_ns(channel) for channel in source.channels] == [
            (START_NS, START_NS + 88 * STEP_NS),
            (START_NS + 2 * STEP_NS, START_NS + 89 * STEP_NS),
        ]

    def test_give_some_channels_within_some_time(self, source: Source) -> None:
        speeds = [channel for channel in source.channels if channel.topic == "/cmd_vel"]
        window = source.messages(speeds, START_NS + 38 * STEP_NS, START_NS + 44 * STEP_NS)
        assert [(time_ns - START_NS) // STEP_NS for _, time_ns, _ in window] == [38, 41]
        assert list(source.messages(())) == []

    def test_are_all_closed_with_it(self, source: Source) -> None:
        source.close()
        source.close()
        with pytest.raises(RecordingError, match="is closed"):
            read(source)


def test_an_unreadable_file_is_reported_and_the_rest_is_read(tmp_path: Path) -> None:
    paths = split(tmp_path)
    paths[0].write_bytes(b"")
    paths[1].write_bytes(paths[1].read_bytes()[:-60])
    source = open_source(tmp_path)
    held = messages(90)
    assert read(source) == [message for i, message in enumerate(held) if i >= 40 and i not in (41, 44)]
    assert source.problems == (
        "drive_0.bag: the file is empty (0 bytes): expected a recording; copy it again or record again",
        "drive_1.bag: the recording was cut off: read 20 messages, up to 1.2 s",
    )
    source.close()


def test_when_no_file_can_be_read_the_first_says_why(tmp_path: Path) -> None:
    (tmp_path / "drive_0.bag").write_bytes(b"#ROSRECORD V1.2\n")
    (tmp_path / "drive_1.bag").touch()
    with pytest.raises(RecordingError, match=r"^drive_0\.bag: a bag of format 1\.2"):
        open_source(tmp_path)


def test_files_without_a_message_have_no_time(tmp_path: Path) -> None:
    for number in range(2):
        write_bag(tmp_path / f"drive_{number}.bag", [])
    source = open_source(tmp_path)
    assert (source.start_ns, source.end_ns, read(source)) == (None, None, [])
    source.close()
