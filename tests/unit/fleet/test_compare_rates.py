"""Two sets of drives compared: rates with the interval of the difference, by file and by place."""

from __future__ import annotations

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.fleet import Drives, find, index
from robowidgets.fleet._rates import Exposure, rates_of

from ..recordings import recorded
from .executors import Here

BUMP = conditions.field("/bump.data") == True  # noqa: E712


def drive(folder: Path, name: str, bumps: list[float], seconds: int = 100, x: float = 0.2) -> None:
    """Write a drive in which the robot bumps at some seconds, for half a second each, and moves 1 m in each 10 s."""
    types = {"/bump": "std_msgs/msg/Bool", "/odom": "nav_msgs/msg/Odometry"}
    messages: list[tuple[float, str, Any]] = [(0.0, "/bump", {"data": False})]
    for at in bumps:
        messages += [(at, "/bump", {"data": True}), (at + 0.5, "/bump", {"data": False})]
    for second in range(seconds):
        pose = {"position": {"x": x + second / 10}, "orientation": {"w": 1.0}}
        messages.append((float(second), "/odom", {"pose": {"pose": pose}}))
    recorded.write(folder / name, types, sorted(messages, key=lambda one: one[0]))


@pytest.fixture
def sets(tmp_path: Path) -> tuple[Drives, Drives]:
    for part in ("old", "new"):
        (tmp_path / part).mkdir()
    drive(tmp_path / "old", "a", [5.0, 15.5, 16.5, 95.0])
    drive(tmp_path / "old", "b", [15.0])
    drive(tmp_path / "new", "c", [], seconds=200)
    drive(tmp_path / "new", "d", [50.0])
    recorded.write(tmp_path / "new" / "e", {"/other": "std_msgs/msg/Bool"}, [(0.0, "/other", {"data": True})])
    old, new = (
        index(tmp_path / part, output=tmp_path / f"{part}.parquet", fields="/bump.data", executor=Here())
        for part in ("old", "new")
    )
    return old, new


def test_rows_are_counts_of_searches_and_hours_of_searched_drives(sets: tuple[Drives, Drives]) -> None:
    old, new = sets
    found = old.compare(new, BUMP, executor=Here())
    before, after, difference = found.to_arrow().to_pylist()
    assert (before["set"], before["drives"], before["count"]) == ("old", 2, 5)
    assert (after["set"], after["drives"], after["count"]) == ("new", 2, 1)  # without the drive with no such topic
    assert before["hours"] == pytest.approx(200 / 3600)
    assert after["hours"] == pytest.approx(300 / 3600)
    assert before["per_hour"] == pytest.approx(90)
    assert difference["per_hour"] == pytest.approx(12 - 90)
    assert difference["low"] < -78 < difference["high"]
    assert [Path(one.file).name for one in found.unread] == ["e"]
    assert len(found.before) == 5
    assert repr(found) == repr(old.compare(new, BUMP, executor=Here()))
    assert "/bump.data == True: the sets do not differ beyond chance" in repr(found)
    assert "! not read: e: " in repr(found)


def test_spans_are_counted_by_file_and_by_place(sets: tuple[Drives, Drives]) -> None:
    old, new = sets
    found = old.compare(new, BUMP, executor=Here())
    rows = found.by_file().to_arrow().to_pylist()
    assert [(row["set"], Path(row["file"]).name, row["count"]) for row in rows] == [
        ("old", "a", 4),
        ("old", "b", 1),
        ("new", "d", 1),
    ]
    by_place = found.by_place(size=1.0)
    first, *others = by_place.to_arrow().to_pylist()
    # The robot is at 1.7 m at 15 s, and from 8 s to 17 s in that square.
    assert (first["x"], first["y"]) == (1.5, 0.5)
    assert (first["count_before"], first["count_after"]) == (3, 0)
    assert (first["hours_before"], first["hours_after"]) == (20 / 3600, 20 / 3600)
    assert sum(row["count_before"] for row in (first, *others)) == 5
    assert "by squares of 1 m" in repr(by_place)
    assert len(by_place.to_pandas()) == len(by_place) == 4
    for wrong, error in ((0, ValueError), ("a", TypeError)):
        with pytest.raises(error):
            found.by_place(wrong)  # type: ignore[arg-type]


def test_only_an_index_is_compared(sets: tuple[Drives, Drives]) -> None:
    with pytest.raises(TypeError, match="expected drives of another index"):
        sets[0].compare("new.parquet", BUMP)  # type: ignore[arg-type]


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_counts_of_real_recordings_are_those_of_searches_in_whole_files(data: Path, tmp_path: Path) -> None:
    good = index(data / "good", output=tmp_path / "good.parquet")
    odd = index(data / "odd", output=tmp_path / "odd.parquet")
    for condition in (conditions.nearest_below(0.5), conditions.speed_above(0.2)):
        compared = good.compare(odd, condition)
        for folder, row in zip(("good", "odd"), compared.to_arrow().to_pylist(), strict=False):
            hits = find(condition, data / folder, keep=False)
            seconds = 0.0
            left_out = {one.file for one in hits.unread}
            for file in set(hits.files) - left_out:
                with robowidgets.open(file) as recording:
                    seconds += int(recording.duration) + 1
            assert row["count"] == len(hits)
            assert row["drives"] == len(hits.files) - len(left_out)
            assert row["hours"] == pytest.approx(seconds / 3600)
            by_file = {r["file"]: r["count"] for r in compared.by_file().to_arrow().to_pylist() if r["set"] == folder}
            assert by_file == Counter(hit.file for hit in hits)


def exposure(counts: Any, hours: Any) -> Exposure:
    return Exposure(np.array(counts, np.int64), np.array(hours, float))


def test_rates_have_the_limits_of_tables_of_the_poisson_distribution() -> None:
    # Exact limits (Garwood) of 10 events: 4.795 to 18.39; of 0 events: at most 3.689.
    first, second, difference, spread = rates_of(exposure([10], [1]), exposure([0], [1]))
    assert (first.low, first.high) == pytest.approx((4.795, 18.39), rel=0.01)
    assert (second.low, second.high) == pytest.approx((0, 3.689), rel=0.01)
    assert difference.per_hour == -10
    assert difference.low < -10 < difference.high < 0
    assert spread == 1
    nothing, _, unknown, _ = rates_of(exposure([], []), exposure([1], [1]))
    assert np.isnan([*nothing, *unknown]).all()


@pytest.mark.parametrize(("drives", "bursts", "least"), [(10, None, 0.95), (10, 0.3, 0.88), (50, 1.0, 0.9)])
def test_the_interval_contains_the_difference_as_often_as_it_should(
    drives: int, bursts: float | None, least: float
) -> None:
    random, hit, times = np.random.default_rng(5), 0, 300
    for _ in range(times):
        sets = []
        for rate in (2.0, 3.0):
            hours = random.uniform(0.3, 1.5, drives)
            usual = rate * hours * (1 if bursts is None else random.gamma(bursts, 1 / bursts, drives))
            sets.append(Exposure(random.poisson(usual), hours))
        _, _, difference, _ = rates_of(*sets)
        hit += difference.low <= 1.0 <= difference.high
    assert least <= hit / times <= 0.995
