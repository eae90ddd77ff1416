"""Scanograms of a few parts of recordings that are too large to read without a request."""

from __future__ import annotations

import json
import re
import zlib
from base64 import b85decode
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import ScanogramWidget
from robowidgets.scanogram.levels import COARSEST
from robowidgets.scanogram.page_parts import detail, most_single, overview

from ..pages import synced
from ..recordings import long_drive
from .pictures import get_picture

CHUNKS = 60
CHUNK_BYTES = 6_000
"""A little more than the bytes of a chunk of the drive."""
PARTS = 12


@pytest.fixture(autouse=True)
def limits(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robowidgets.recordings.data.MOST_READ", 10_000)
    monkeypatch.setattr("robowidgets.recordings.data.THINNED_READ", (PARTS * CHUNK_BYTES, PARTS))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return long_drive.write(tmp_path / "drive.mcap", CHUNKS, image=1000)


def thinned(path: Path) -> tuple[ScanogramWidget, str]:
    """Return the scanogram of a player, and the line of the player."""
    with robowidgets.open(path) as recording, closing(recording.show("/scan", "/speed")) as player:
        assert player.scanogram is not None
        return player.scanogram, synced(player.bar, "_note")


def facts(frame: bytes) -> dict[str, Any]:
    length = int.from_bytes(frame[:4], "little")
    return dict(json.loads(frame[4 : 4 + length]))


def test_a_player_shows_parts_of_the_drive_at_once_and_says_how_many_scans_are_missing(path: Path) -> None:
    widget, note = thinned(path)
    assert widget.is_thinned
    assert note == (
        "the scanogram shows 120 of 600 scans, evenly spread: its messages lie in 140 kB; "
        "recording.show(scanogram=True) reads all"
    )
    assert widget.scans_shown == "120 of 600 scans"
    told = facts(synced(widget, "_frame"))
    assert (told["scan_count"], told["drive_scans"]) == (120, 600)
    assert "speed" not in told, "the speeds lie in as many bytes"
    assert (told["begin"], told["duration"]) == (0.0, pytest.approx(59.9))


def test_its_columns_are_those_of_the_whole_and_between_the_parts_there_are_none(path: Path) -> None:
    widget, _ = thinned(path)
    with robowidgets.open(path) as recording:
        whole = recording.scanogram("/scan")
    assert not whole.is_thinned
    few, all_of_it = (overview(one.levels, one.clock) for one in map(get_picture, (widget, whole)))
    same = np.searchsorted(all_of_it.starts, few.starts)
    assert (all_of_it.starts[same] == few.starts).all()
    assert (all_of_it.cells[same] == few.cells).all()
    assert few.ends == pytest.approx(all_of_it.ends[same])
    first, last = few.starts[::10], few.ends[9::10]
    assert last - first == pytest.approx(np.ones(PARTS))
    assert (first[1:] - last[:-1] > 2).all(), "evenly spread: four chunks are missing between two parts"
    assert np.ptp(np.diff(first)) <= 2


@pytest.mark.parametrize("columns", [1, 7, 100])
def test_no_cell_reaches_from_one_part_to_the_next_however_few_columns_the_page_has(
    path: Path, monkeypatch: pytest.MonkeyPatch, columns: int
) -> None:
    monkeypatch.setattr("robowidgets.recordings.data.THINNED_READ", (CHUNKS * CHUNK_BYTES, 40))
    picture = get_picture(thinned(path)[0])
    part = detail(picture.levels, picture.clock, 0, 60, columns)
    assert len(part.starts) > COARSEST, "a whole drive would have coarser levels"
    assert part.level == 0
    assert (part.ends - part.starts).max() < 0.11
    gap = np.flatnonzero(picture.clock.starts[1:] > picture.clock.ends[:-1] + 0.5)[0]
    middle = picture.clock.ends[gap] + 0.2
    assert len(detail(picture.levels, picture.clock, middle, middle + 0.1, columns).starts) == 0


def test_many_rays_leave_room_for_few_scans_of_each_part_and_then_for_fewer_parts(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for room, expected in ((1000, 10 * PARTS), (PARTS * 3 + 1, 3 * PARTS), (5, 4)):
        monkeypatch.setattr("robowidgets.scanogram.of_recording.most_single", lambda _, room=room: room)
        picture = get_picture(thinned(path)[0])
        assert len(picture.clock) == expected
        assert (picture.clock.ends - picture.clock.starts).max() < 0.11
    assert most_single(100_000) >= 1


def test_on_request_all_of_it_is_read_and_a_saved_page_does_not_read_it_unasked(path: Path, tmp_path: Path) -> None:
    with robowidgets.open(path) as recording:
        with closing(recording.show("/scan", "/speed", scanogram=True)) as player:
            assert player.scanogram is not None
            assert not player.scanogram.is_thinned
            assert synced(player.bar, "_note") == ""
        with closing(recording.show("/scan", "/speed", scanogram=False)) as player:
            assert (player.scanogram, synced(player.bar, "_note")) == (None, "")
        with closing(recording.show("/scan", "/speed")) as player:
            for name, wanted in (("without", None), ("whole", True)):
                player.to_html(tmp_path / f"{name}.html", start=0, end=5, scanogram=wanted)
    pages = [(tmp_path / f"{name}.html").read_text(encoding="utf-8") for name in ("without", "whole")]
    packed = [re.findall(r'data-part="page">([^<]*)<', page)[0] for page in pages]
    unpacked = [zlib.decompress(b85decode(part.replace(",", "<"))) for part in packed]
    assert [b'"track": 0' in page or b'"track":0' in page for page in unpacked] == [False, True]


def test_files_of_a_split_drive_have_their_share(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "drive"
    folder.mkdir()
    long_drive.write(folder / "drive_0.mcap", 40, image=1000)
    monkeypatch.setattr(long_drive, "START_NS", long_drive.START_NS + 40_000_000_000)
    long_drive.write(folder / "drive_1.mcap", 20, image=1000)
    with robowidgets.open(folder) as recording:
        parts = recording.thinned_scans("/scan")
        starts = np.array([chunks[0].times_ns[0] - recording.start_ns for chunks in parts]) / 1e9
    assert len(starts) == PARTS
    assert ((starts < 40).sum(), (starts >= 40).sum()) == (8, 4)
    assert (np.diff(starts) > 0).all()


def test_a_file_with_json_has_parts_too(tmp_path: Path) -> None:
    path = long_drive.write(tmp_path / "drive.mcap", CHUNKS, image=1000, others=1, encoding="json")
    with robowidgets.open(path) as recording:
        assert len(recording.thinned_scans("/scan")) == PARTS


def test_a_damaged_part_is_reported_and_the_file_is_not_read_whole_to_repair_it(path: Path) -> None:
    with robowidgets.open(path) as recording:
        source = recording._source
        reader = source._first._reader  # type: ignore[attr-defined]
        offsets = reader.index.offsets.tolist()
    raw = bytearray(path.read_bytes())
    for offset in offsets[20:40]:
        raw[offset + 49 : offset + 58] = b"\x05" + b"\xff" * 8
    path.write_bytes(raw)
    with robowidgets.open(path) as recording, closing(recording.show("/scan", "/speed")) as player:
        assert player.scanogram is None
        assert synced(player.bar, "_note").startswith("no scanogram: a part of the file cannot be read")


def test_chunks_larger_than_the_limit_leave_the_line_without_a_picture(
    path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.recordings.data.THINNED_READ", (100, PARTS))
    with robowidgets.open(path) as recording, closing(recording.show("/scan")) as player:
        assert recording.thinned_scans("/scan") == []
        assert player.scanogram is None
        assert synced(player.bar, "_note").startswith("no scanogram: its messages lie in ")


def test_parts_of_one_scan_each_last_as_long_as_a_scan(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robowidgets.scanogram.of_recording.most_single", lambda _: PARTS)
    picture = get_picture(thinned(path)[0])
    assert picture.clock.ends - picture.clock.starts == pytest.approx(np.full(PARTS, 0.1), abs=0.001)
    assert picture.clock.notes == ()


def test_a_file_without_an_index_of_parts_has_none(data: Path) -> None:
    with robowidgets.open(data / "good" / "tilt_laser.bag") as recording:
        assert recording.thinned_scans(recording.only("laser")) == []


def test_of_parts_that_overlap_only_one_is_shown(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = long_drive.write(tmp_path / "drive.mcap", CHUNKS, image=1000, overlap_ns=950_000_000)
    monkeypatch.setattr("robowidgets.recordings.data.THINNED_READ", (10 * CHUNKS * CHUNK_BYTES, CHUNKS))
    picture = get_picture(thinned(path)[0])
    assert len(picture.clock) == 10 * CHUNKS // 2
    assert picture.clock.notes == ()
