"""Several files as one source."""

from __future__ import annotations

from pathlib import Path

import pytest
from robowidgets.recordings.chain import Chain, open_chain

from robowidgets.repair import open_file
from robowidgets.repair.source import RecordingError

from .written import START_NS, STEP_NS, messages, read, write_bag


def split(folder: Path) -> list[Path]:
    """One recording in three files, whose times overlap."""
    held = messages(90)
    parts = [held[:40], held[40:60:2] + held[70:], held[41:60:2] + held[60:70]]
    return [write_bag(folder / f"drive_{number}.bag", part) for number, part in enumerate(parts)]


def test_files_become_one_recording_in_the_order_of_time(tmp_path: Path) -> None:
    source = open_chain(split(tmp_path), open_file)
    assert read(source) == messages(90)
    assert [(channel.topic, channel.count) for channel in source.channels] == [("/scan", 60), ("/cmd_vel", 30)]
    assert len({channel.id for channel in source.channels}) == 2
    assert (source.start_ns, source.end_ns, source.problems) == (START_NS, START_NS + 89 * STEP_NS, ())


def test_some_channels_within_some_time(tmp_path: Path) -> None:
    source = open_chain(split(tmp_path), open_file)
    speeds = [channel for channel in source.channels if channel.topic == "/cmd_vel"]
    window = source.messages(speeds, START_NS + 38 * STEP_NS, START_NS + 44 * STEP_NS)
    assert [(time_ns - START_NS) // STEP_NS for _, time_ns, _ in window] == [38, 41]
    assert list(source.messages(())) == []


def test_a_file_that_cannot_be_read_is_told_beside_the_rest(tmp_path: Path) -> None:
    paths = split(tmp_path)
    paths[0].write_bytes(b"")
    paths[1].write_bytes(paths[1].read_bytes()[:-60])
    source = open_chain(paths, open_file)
    assert read(source) == messages(90)[40:]
    assert source.problems == (
        "drive_0.bag: the file is empty (0 bytes): expected a recording; copy it again or record again",
        "drive_1.bag: the recording was cut off: read 30 messages, up to 2.5 s",
    )


def test_when_no_file_can_be_read_the_first_says_why(tmp_path: Path) -> None:
    paths = [tmp_path / "drive_0.bag", tmp_path / "drive_1.bag"]
    paths[0].write_bytes(b"#ROSRECORD V1.2\n")
    paths[1].touch()
    with pytest.raises(RecordingError, match=r"^drive_0\.bag: a bag of format 1\.2"):
        open_chain(paths, open_file)


def test_closing_closes_every_file_and_does_what_was_asked_once(tmp_path: Path) -> None:
    calls: list[str] = []
    sources = [(path.name, open_file(path)) for path in split(tmp_path)]
    chain = Chain(sources, on_close=lambda: calls.append("closed"))
    chain.close()
    chain.close()
    assert calls == ["closed"]
    for _, source in sources:
        with pytest.raises(RecordingError, match="is closed"):
            read(source)


def test_no_source_and_no_message_have_no_time() -> None:
    chain = Chain([])
    assert (chain.start_ns, chain.end_ns, chain.channels, read(chain)) == (None, None, (), [])
