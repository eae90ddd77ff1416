"""The chunks of a topic: decoded again on demand, and correct if the index of the file is wrong."""

from __future__ import annotations

import struct
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets.files import open_source
from robowidgets.messages.compression import zstd
from robowidgets.recordings.columns import _store

from . import sweeps
from .written import messages, write_bag, write_db3, write_indexed_mcap

MESSAGES = messages(200)

FILES = {
    "mcap": lambda folder: write_indexed_mcap(folder / "x", MESSAGES),
    "db3": lambda folder: write_db3(folder / "x", MESSAGES),
    "bag": lambda folder: write_bag(folder / "x.bag", MESSAGES),
    "bz2": lambda folder: write_bag(folder / "x.bag", MESSAGES, "bz2"),
    "lz4": lambda folder: write_bag(folder / "x.bag", MESSAGES, "lz4"),
}


@pytest.mark.parametrize("kind", FILES)
def test_batches_are_the_same_when_read_again(tmp_path: Path, kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_store, "BATCH_BYTES", 5000)
    source = open_source(FILES[kind](tmp_path))
    found = list(_store._batches(source.messages(source.channels)))
    assert len(found) > 3
    assert [m for _, read in found for m in read] == list(source.messages(source.channels))
    for batch, read in found:
        again = list(source.messages(source.channels, batch.first_ns, batch.last_ns + 1))
        assert again[batch.skipped : batch.skipped + batch.messages] == read
    source.close()


def test_messages_that_were_compressed_one_by_one_are_read(tmp_path: Path) -> None:
    scans = [(0.1 * i, sweeps.scan(sweeps.START_NS, [i + 1.0])) for i in range(20)]
    packed = [("/scan", sweeps.START_NS + round(at * 1e9), zstd.compress(raw)) for at, raw in scans]
    with robowidgets.open(write_db3(tmp_path / "x", packed)) as recording:
        assert recording.scans().ranges[:, 0].tolist() == [i + 1.0 for i in range(20)]
        assert recording.problems == ()


def test_messages_of_one_time_are_not_read_twice(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_store, "BATCH_BYTES", 1000)
    source = open_source(write_db3(tmp_path / "x", [(topic, MESSAGES[0][1], raw) for topic, _, raw in MESSAGES[:40]]))
    found = list(_store._batches(source.messages(source.channels)))
    assert len(found) > 3
    counts = [batch.messages for batch, _ in found]
    assert [batch.skipped for batch, _ in found] == np.cumsum([0, *counts[:-1]]).tolist()
    source.close()


def test_rows_are_read_batch_by_batch_in_any_order(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(_store, "BATCH_BYTES", 1000)
    decode, decoded = _store.Store._decode, []

    def counted(store: _store.Store, read: list[Any]) -> list[Any]:
        decoded.append(read[0][1])
        return decode(store, read)

    monkeypatch.setattr(_store.Store, "_decode", counted)
    with robowidgets.open(sweeps.write(tmp_path / "x", sweeps.numbered(100))) as recording:
        recording.memory = 1  # so that nothing is kept
        scans = recording.scans()
        batches = len(scans._store._indexed().batches)
        assert batches > 5
        for rows in (np.arange(100) % 3 == 0, slice(None, None, -7), slice(20, 60)):
            part, there = scans[rows], np.arange(100)[rows]
            decoded.clear()
            assert [round(moment.seconds * 10) for moment in part] == there.tolist()
            assert len(decoded) == len(set(decoded)) <= batches
            chunks = list(part.chunks())
            assert [chunk.start for chunk in chunks] == np.cumsum([0, *map(len, chunks)])[:-1].tolist()
            np.testing.assert_array_equal(np.concatenate([chunk.times_ns for chunk in chunks]), part.times_ns)


def spoil(path: Path, what: bytes, at: int, by: bytes) -> None:
    """Change bytes at an offset from the last occurrence of others."""
    raw = bytearray(path.read_bytes())
    place = raw.rindex(what) + at
    assert raw[place : place + len(by)] != by
    raw[place : place + len(by)] = by
    path.write_bytes(raw)


class TestDamage:
    """A wrong index entry costs no message except the missing ones."""

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
            # A message reported on the fast path is not repeated on the other.
            assert next(scans.chunks()).start == 0
            assert sum(len(chunk) for chunk in scans.chunks()) == count

    def test_a_bag_whose_index_lies(self, tmp_path: Path) -> None:
        path = write_bag(tmp_path / "x.bag", MESSAGES, chunk=1 << 20)
        _, time_ns, _ = MESSAGES[100]
        entry = struct.pack("<II", *divmod(time_ns, 10**9))
        spoil(path, entry, 8, struct.pack("<I", 77))
        source = open_source(path)
        assert [(channel.topic, at, raw) for channel, at, raw in source.messages(source.channels)] == MESSAGES
        source.close()
