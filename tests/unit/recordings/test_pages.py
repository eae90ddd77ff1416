"""Pages of raw messages: in the order of arrival, found again, and never believed more than the file bears out."""

from __future__ import annotations

import struct
import tracemalloc
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from robowidgets.recordings.ahead import read_ahead
from robowidgets.recordings.chunk_pages import BagPage
from robowidgets.recordings.pages import pages_of

import robowidgets
from robowidgets import RecordingError
from robowidgets.recordings import chunk_pages, pages, ros_files
from robowidgets.recordings.files import open_timeline
from robowidgets.repair import open_file
from robowidgets.repair.source import Source

from . import clock_back, sweeps
from .written import messages, write_bag, write_db3, write_indexed_mcap

HELD = messages(200)


def source_of(path: Path) -> Source:
    source: Source = open_timeline(path)._source  # type: ignore[attr-defined]
    return source


def unpacked(source: Source) -> list[tuple[str, int, bytes]]:
    found = []
    for page in pages_of(source, source.channels):
        for raws in page()():
            for time_ns, start, end in zip(raws.times.tolist(), raws.starts, raws.ends, strict=True):
                found.append((raws.channel.topic, time_ns, raws.buffer[start:end]))
    return found


FILES = {
    "mcap": lambda folder: write_indexed_mcap(folder / "x", HELD),
    "db3": lambda folder: write_db3(folder / "x", HELD),
    "bag": lambda folder: write_bag(folder / "x.bag", HELD),
    "bz2": lambda folder: write_bag(folder / "x.bag", HELD, "bz2"),
    "lz4": lambda folder: write_bag(folder / "x.bag", HELD, "lz4"),
}


@pytest.mark.parametrize("kind", FILES)
@pytest.mark.parametrize("opener", [source_of, open_file])
def test_pages_hold_every_message_in_its_order(tmp_path: Path, kind: str, opener: Any) -> None:
    source = opener(FILES[kind](tmp_path))
    assert unpacked(source) == HELD
    source.close()


@pytest.mark.parametrize("kind", FILES)
def test_a_page_is_found_again(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "PAGE_BYTES", 5000)
    source = source_of(FILES[kind](tmp_path))
    found = list(pages_of(source, source.channels))
    assert len(found) > 3 or kind == "mcap"
    for page in found:
        first, again = page()(), page()()
        assert [raws.times.tolist() for raws in first] == [raws.times.tolist() for raws in again]
    source.close()


def test_messages_of_one_time_are_not_told_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "PAGE_BYTES", 1000)
    held = [(topic, HELD[0][1], raw) for topic, _, raw in HELD[:40]]
    source = source_of(write_db3(tmp_path / "x", held))
    found = list(pages_of(source, source.channels))
    for page in found:
        page()
    again = [raws.buffer for page in found for raws in page()()]
    assert b"".join(again) == b"".join(raw for _, _, raw in held)
    source.close()


def spoil(path: Path, what: bytes, at: int, by: bytes) -> None:
    """Change bytes some way after the last place where others stand."""
    raw = bytearray(path.read_bytes())
    place = raw.rindex(what) + at
    assert raw[place : place + len(by)] != by
    raw[place : place + len(by)] = by
    path.write_bytes(raw)


class TestDamage:
    """What the index says and the file does not bear out costs no message but those that are gone."""

    @pytest.fixture
    def path(self, tmp_path: Path) -> Path:
        folder = sweeps.write(tmp_path / "x", sweeps.numbered(900, rays=1000))
        return folder / "x.mcap"

    def test_a_whole_file_needs_no_other_reader(self, path: Path) -> None:
        with robowidgets.open(path) as recording:
            assert recording.scans().ranges.shape == (900, 1000)
            assert recording.problems == ()

    def test_a_wrong_offset_in_the_index(self, path: Path) -> None:
        time_ns = struct.pack("<Q", sweeps.START_NS + 500 * 10**8)
        spoil(path, time_ns, 8, struct.pack("<Q", 12345))
        self.check(path, 900)

    def test_a_wrong_time_in_the_index(self, path: Path) -> None:
        time_ns = struct.pack("<Q", sweeps.START_NS + 500 * 10**8)
        spoil(path, time_ns, 0, struct.pack("<Q", sweeps.START_NS))
        self.check(path, 900)

    def test_a_length_that_reaches_beyond_the_chunk(self, path: Path) -> None:
        raw = path.read_bytes()
        message = struct.pack("<HIQQ", 1, 0, *[sweeps.START_NS + 500 * 10**8] * 2)
        place = raw.index(message)
        path.write_bytes(raw[: place - 8] + struct.pack("<Q", 1 << 50) + raw[place:])
        with robowidgets.open(path) as recording:
            scans = recording.scans()
            assert len(scans) >= 898
            assert all(a < b for a, b in pairwise(scans.times_ns.tolist()))

    def check(self, path: Path, count: int) -> None:
        with robowidgets.open(path) as recording:
            scans = recording.scans()
            np.testing.assert_allclose(scans.ranges[:, 0], 1 + np.arange(count) / 100, rtol=1e-5)
            np.testing.assert_array_equal(scans.seconds, np.arange(count) / 10)
            # What was begun on the quick way is not told twice on the other.
            assert next(scans.chunks()).start == 0
            assert sum(len(chunk) for chunk in scans.chunks()) == count

    def test_a_bag_whose_index_lies(self, tmp_path: Path) -> None:
        path = write_bag(tmp_path / "x.bag", HELD, chunk=1 << 20)
        _, time_ns, _ = HELD[100]
        entry = struct.pack("<II", *divmod(time_ns, 10**9))
        spoil(path, entry, 8, struct.pack("<I", 77))
        source = ros_files.open_bag(path)
        with pytest.raises(RecordingError, match=r"x\.bag: the chunk at byte .* is damaged, or not as the index says"):
            unpacked(source)
        source.close()
        source = source_of(path)
        assert unpacked(source) == HELD
        source.close()

    @pytest.mark.parametrize("size", [50_000, 2**32 - 1])
    def test_a_bag_whose_messages_all_claim_the_same_large_header(self, tmp_path: Path, size: int) -> None:
        raw = struct.pack("<I", size) + bytes(60_000)
        (tmp_path / "x.bag").write_bytes(raw)
        page = BagPage(tmp_path / "x.bag", 0, len(raw), "", {0: [(0, 0)] * 500}, {})
        tracemalloc.start()
        with pytest.raises(RecordingError, match=r"x\.bag: the chunk at byte .* is damaged, or not as the index says"):
            page()()
        _, most = tracemalloc.get_traced_memory()
        tracemalloc.stop()
        assert most < 1_000_000


def test_threads_read_ahead_only_where_there_is_much_to_decompress(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, most, expected in (
        ("neato_fsm_zstd.mcap", 1 << 22, False),
        ("neato_fsm_zstd.mcap", 1 << 20, True),
        ("turtlebot3_gazebo_mcap/fuse_turtlebot3_mcap.mcap", 1, False),
    ):
        monkeypatch.setattr(ros_files, "_SLOW", most)
        source = ros_files.open_mcap(data / "good" / name)
        found: Any = source.pages(source.channels)
        assert found
        assert {page.slow for page in found} == {expected}
        source.close()


@pytest.mark.parametrize("slow", [True, False])
def test_reading_ahead_keeps_the_order_and_passes_on_errors(slow: bool) -> None:
    def page(number: int) -> Any:
        def read() -> int:
            if number == 3:
                raise OSError("the disk is gone")
            return number

        read.slow = slow  # type: ignore[attr-defined]
        return read

    read = read_ahead(page(number) for number in range(5))
    assert [next(read) for _ in range(3)] == [0, 1, 2]
    with pytest.raises(OSError, match="the disk is gone"):
        next(read)


class TestChunksThatArePacked:
    @pytest.fixture
    def inflated(self, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
        calls: list[Any] = []
        real = chunk_pages.inflate

        def inflate(*given: Any) -> Any:
            calls.append(given)
            return real(*given)

        monkeypatch.setattr(chunk_pages, "inflate", inflate)
        return calls

    def test_are_decompressed_once_for_all_topics(self, tmp_path: Path, inflated: list[Any]) -> None:
        with robowidgets.open(clock_back.bz2(tmp_path, clock_back.drive(clock_back.step(0)))) as recording:
            assert len(recording.scans()) == 100
            chunks = len(inflated)
            assert chunks > 3
            assert len(recording.speeds()) == 100
            assert len(inflated) == chunks

    def test_are_let_go_of_where_there_is_little_room(self, tmp_path: Path, inflated: list[Any]) -> None:
        with robowidgets.open(clock_back.bz2(tmp_path, clock_back.drive(clock_back.step(0)))) as recording:
            recording.memory = 3000
            assert len(recording.scans()) == 100
            chunks = len(inflated)
            assert len(recording.speeds()) == 100
            assert len(inflated) == 2 * chunks
            assert recording._series.memory.held <= 3000
