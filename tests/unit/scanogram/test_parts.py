from __future__ import annotations

import json

import numpy as np
import pytest

from robowidgets.samples import Scan
from robowidgets.scanogram.levels import Levels
from robowidgets.scanogram.page_parts import DETAIL_BYTES, OVERVIEW_BYTES, detail, overview, pack
from robowidgets.scanogram.scan_times import ScanTimes
from robowidgets.scanogram.scans import ScansInMemory, Sweep


def made(count: int, rays: int) -> tuple[Levels, ScanTimes]:
    ranges = np.random.default_rng(4).uniform(0.2, 29.0, (count, rays)).astype(np.float32)
    times = np.arange(count) * 100_000_000
    return Levels(
        ScansInMemory(times, [ranges[:7], ranges[7:]]), Sweep.of(Scan(ranges[0], -1.0, 0.001, 0.1, 30.0))
    ), ScanTimes(times, 0)


def test_a_short_recording_is_sent_whole_to_the_very_float() -> None:
    levels, clock = made(100, 360)
    part = overview(levels, clock)
    assert (part.level, part.cells.dtype) == (0, np.float32)
    assert (part.cells == levels.scans.read(0, 100)).all()


@pytest.mark.parametrize(("count", "rays"), [(20_000, 360), (1_000, 5_000), (3, 100_000)])
def test_the_overview_holds_all_scans_and_stays_small(count: int, rays: int) -> None:
    levels, clock = made(count, rays)
    part = overview(levels, clock)
    assert part.cells.nbytes <= OVERVIEW_BYTES
    assert len(part.starts) << part.level >= count
    assert part.cells.shape == (len(part.starts), -(-rays // part.ray_step))
    assert part.starts[0] == 0
    assert part.ends[-1] == pytest.approx(count * 0.1)


def test_a_closer_look_is_as_fine_as_the_screen_and_single_scans_come_as_floats() -> None:
    levels, clock = made(20_000, 360)
    far, near = detail(levels, clock, 500, 1500, 1000), detail(levels, clock, 500, 530, 1000)
    assert far.level == 3
    assert far.starts[0] <= 500
    assert far.ends[-1] >= 1500
    assert far.cells.nbytes <= DETAIL_BYTES
    assert (near.level, near.cells.dtype) == (0, np.float32)
    assert (near.cells == levels.scans.read(near.first, near.first + len(near.cells))).all()
    assert near.starts[0] <= 500 <= 530 <= near.ends[-1]


def test_a_look_at_where_nothing_is_gives_no_cells() -> None:
    levels, clock = made(100, 10)
    assert len(detail(levels, clock, 50, 60, 1000).starts) == 0


def test_facts_and_arrays_are_packed_one_after_the_other() -> None:
    packed = pack({"a": 1}, numbers=np.array([1.5, 2.5]), codes=np.array([[7, 8]], np.uint16))
    length = int.from_bytes(packed[:4], "little")
    facts = json.loads(packed[4 : 4 + length])
    assert facts == {"a": 1, "arrays": [["numbers", "f8", 2], ["codes", "u2", 2]]}
    assert np.frombuffer(packed, "<f8", 2, 4 + length).tolist() == [1.5, 2.5]
    assert np.frombuffer(packed, "<u2", 2, 20 + length).tolist() == [7, 8]
