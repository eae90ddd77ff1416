"""Two sets of drives compared: rates with the interval of the difference, by file and by place."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from shutil import copy, rmtree
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.fleet import Drives, _engine, _gather, _index_file, find, index
from robowidgets.fleet._rates import Exposure, rates_of
from robowidgets.fleet._topics import chosen_of

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
    # The times of searches are exact; the 199 s of the drive that was ruled out are 200 s in the index.
    assert before["hours"] == pytest.approx(198 / 3600)
    assert after["hours"] == pytest.approx((200 + 99) / 3600)
    assert before["per_hour"] == pytest.approx(5 / 198 * 3600)
    assert difference["per_hour"] == pytest.approx(3600 / 299 - 5 / 198 * 3600)
    assert difference["low"] < difference["per_hour"] < difference["high"]
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


def test_drives_that_an_interrupt_left_out_do_not_count(
    sets: tuple[Drives, Drives], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def each(*arguments: Any, **options: Any) -> Iterator[Any]:
        asked.append(arguments)
        yield next(_engine.each(*arguments, **options))
        raise KeyboardInterrupt

    monkeypatch.setattr(_gather, "each", each)
    found = sets[0].compare(sets[1], BUMP, executor=Here(), keep=False)
    assert len(asked) == 1  # one interrupt ends both searches
    assert not found.is_complete
    assert not found.is_different
    before, after, difference = found.to_arrow().to_pylist()
    assert (before["drives"], before["count"], before["hours"]) == (1, 4, pytest.approx(99 / 3600))
    assert (after["drives"], after["hours"]) == (0, 0)
    assert difference["per_hour"] is difference["low"] is None
    assert "not all drives were searched" in repr(found)
    assert "stopped after 1 of 5 files" in repr(found)


def test_a_search_that_stopped_early_gives_no_difference(
    sets: tuple[Drives, Drives], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(_gather, "_ALIKE", 1)
    found = sets[0].compare(sets[1], lambda moment: moment["/bump"].wrong, executor=Here())
    assert not found.is_complete
    assert "not all drives were searched" in repr(found)
    assert "! stopped because it failed in the same way for the first 1 recordings" in repr(found)


def test_hours_and_hits_are_of_the_same_recording_if_it_changed_since_the_index(sets: tuple[Drives, Drives]) -> None:
    old, new = sets
    changed = Path(new.files[1])
    rmtree(changed)
    drive(changed.parent, changed.name, [50.0, 150.0, 900.0], seconds=1000)
    found = old.compare(new, BUMP, executor=Here())
    after = found.to_arrow().to_pylist()[1]
    assert (after["count"], after["hours"]) == (3, pytest.approx((200 + 999) / 3600))
    (row,) = (one for one in found.by_file().to_arrow().to_pylist() if one["set"] == "new")
    assert row["per_hour"] == pytest.approx(3 / 999 * 3600)
    # The index has the places of the first 100 s only.
    assert sum(one["count_after"] for one in found.by_place().to_arrow().to_pylist()) == 1


def test_a_recording_that_could_not_be_indexed_counts_once_it_can_be_searched(tmp_path: Path) -> None:
    for part in ("old", "new"):
        (tmp_path / part).mkdir()
        drive(tmp_path / part, "a", [5.0])
    drive(tmp_path / "new", "b", [15.0])
    file = tmp_path / "new" / "b" / "b.mcap"
    whole = file.read_bytes()
    file.write_bytes(b"nothing")
    old, new = (index(tmp_path / name, output=tmp_path / f"{name}.parquet", executor=Here()) for name in ("old", "new"))
    file.write_bytes(whole)
    found = old.compare(new, BUMP, executor=Here())
    after = found.to_arrow().to_pylist()[1]
    assert (after["drives"], after["count"], after["hours"]) == (2, 2, pytest.approx(198 / 3600))
    assert all(row["per_hour"] == pytest.approx(3600 / 99) for row in found.by_file().to_arrow().to_pylist())
    assert sum(row["count_after"] for row in found.by_place().to_arrow().to_pylist()) == 1


def scan_drive(folder: Path, name: str, scans: range, near: bool = False, level: bool = True) -> None:
    """Write a drive of 100 s with a scan at some seconds, near something in each fifth one or never, and a level."""
    types = {"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry", "/level": "std_msgs/msg/Float64"}
    messages: list[tuple[float, str, Any]] = [(float(second), "/odom", {}) for second in range(101)]
    if level:
        messages += [(float(second), "/level", {"data": 5.0}) for second in range(101)]
    for second in scans:
        ranges = [0.1 if near and second % 5 == 0 else 1.0] * 5
        limits = {"angle_min": -1.0, "angle_max": 1.0, "angle_increment": 0.5, "range_min": 0.05, "range_max": 10.0}
        messages.append((float(second), "/scan", {**limits, "ranges": ranges}))
    used = {topic for _, topic, _ in messages}
    types = {topic: kind for topic, kind in types.items() if topic in used}
    recorded.write(folder / name, types, sorted(messages, key=lambda one: one[0]))


def test_time_in_which_the_condition_is_unknown_does_not_count(tmp_path: Path) -> None:
    for part, scans in (("old", range(101)), ("new", range(20))):
        (tmp_path / part).mkdir()
        for i in range(2):
            scan_drive(tmp_path / part, f"near{i}", scans, near=True)
            scan_drive(tmp_path / part, f"far{i}", scans)
    old, new = (
        index(tmp_path / part, output=tmp_path / f"{part}.parquet", fields="/level.data", executor=Here())
        for part in ("old", "new")
    )
    near = conditions.nearest_below(0.3)
    for condition in (near, near & (conditions.field("/level.data") > 1), near & (conditions.field("/level.data") > 9)):
        found = old.compare(new, condition, executor=Here())
        hours = [row["hours"] for row in found.to_arrow().to_pylist()[:2]]
        if "9" in str(condition):  # false by the level alone
            assert hours == pytest.approx([4 * 101 / 3600] * 2)
            continue
        # The last scan counts for a usual step, and in the index for each second in which it may have counted.
        assert hours == pytest.approx([(2 * 100 + 2 * 101) / 3600, (2 * 20 + 2 * 22) / 3600])
        assert len(found.before) == 2 * 21
        assert len(found.after) == 2 * 4
        assert not found.is_different


def test_a_drive_without_a_topic_of_the_condition_is_left_out_of_hours_too(tmp_path: Path) -> None:
    (tmp_path / "old").mkdir()
    for level in (True, False):
        for near in (True, False):
            scan_drive(tmp_path / "old", f"{level}_{near}", range(101), near=near, level=level)
    old = index(tmp_path / "old", output=tmp_path / "old.parquet", fields="/level.data", executor=Here())
    drive(tmp_path, "new", [])
    new = index(tmp_path / "new", output=tmp_path / "new.parquet", executor=Here())
    condition = conditions.nearest_below(0.3) & (conditions.field("/level.data") > 1)
    found = old.compare(new, condition, executor=Here())
    assert found.to_arrow().to_pylist()[0]["drives"] == 2
    whole = find(condition, tmp_path / "old", executor=Here(), keep=False)
    assert set(found.before.unread) == set(whole.unread)
    assert len(whole.unread) == 2


def test_a_condition_without_a_scan_reads_no_drive_for_lack_of_a_scan(sets: tuple[Drives, Drives]) -> None:
    here = Here()
    sets[0].compare(sets[1], BUMP.for_longer(1000), executor=here)
    assert [Path(path).name for path in here.ran] == ["a", "b", "d", "e"]


def test_seconds_of_a_drive_that_was_ruled_out_are_the_same_in_any_batches(
    sets: tuple[Drives, Drives], monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = sets[1].index_file.ruled_out(BUMP)
    monkeypatch.setitem(_index_file._AHEAD, "batch_size", 7)
    parts = sets[1].index_file.ruled_out(BUMP)
    assert whole.seconds.tolist() == parts.seconds.tolist()
    assert sorted(whole.seconds) == [0, 99, 200]
    assert whole.lacks.tolist() == parts.lacks.tolist()


def test_a_recording_in_several_files_of_an_index_is_refused(sets: tuple[Drives, Drives], tmp_path: Path) -> None:
    (tmp_path / "days").mkdir()
    for name in ("monday", "tuesday"):
        copy(sets[0].path, tmp_path / "days" / f"{name}.parquet")
    with pytest.raises(RecordingError, match="days has a recording in several of its files"):
        sets[1].compare(Drives(tmp_path / "days"), BUMP)


def test_recordings_in_both_sets_or_with_problems_are_reported_once(
    sets: tuple[Drives, Drives], tmp_path: Path
) -> None:
    file = tmp_path / "old" / "b" / "b.mcap"
    file.write_bytes(file.read_bytes()[:-3000])
    parts = (tmp_path / "old", tmp_path / "new")
    old, new = (
        index(*some, output=tmp_path / f"{i}.parquet", fields="/bump.data", executor=Here())
        for i, some in enumerate((parts, parts[1:]))
    )
    found = old.compare(new, BUMP, executor=Here())
    assert [Path(one.file).name for one in found.unread] == ["e"]
    lines = [line for line in repr(found).splitlines() if line.startswith("!")]
    assert lines[0] == "! 3 recordings are in both sets"
    assert lines[2:] == ["! 1 file with problems, in .problems: b"]
    assert [Path(name).name for name in found.problems] == ["b"]
    with pytest.raises(ValueError, match=r"expected another index, got 0.parquet twice"):
        old.compare(Drives(old.path), BUMP)


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
                    recording.preferred = frozenset(chosen_of(recording, ()))
                    seconds += recording.find(condition).known
            assert row["count"] == len(hits)
            assert row["drives"] == len(hits.files) - len(left_out)
            # Drives without a hit have the rows of the index, which count until the next one, also in a silence.
            assert row["hours"] * 3600 == pytest.approx(seconds, rel=0.06, abs=2 * row["drives"])
            by_file = {r["file"]: r["count"] for r in compared.by_file().to_arrow().to_pylist() if r["set"] == folder}
            assert by_file == Counter(hit.file for hit in hits)


def exposure(counts: Any, hours: Any) -> Exposure:
    return Exposure(np.array(counts, np.int64), np.array(hours, float))


def test_rates_have_the_limits_of_tables_of_the_poisson_distribution() -> None:
    # Exact limits (Garwood) of 10 events: 4.795 to 18.39; of 0 events: at most 3.689.
    first, second, difference, spreads = rates_of(exposure([5, 5], [0.5, 0.5]), exposure([0, 0], [0.5, 0.5]))
    assert (first.low, first.high) == pytest.approx((4.795, 18.39), rel=0.01)
    assert (second.low, second.high) == pytest.approx((0, 3.689), rel=0.01)
    assert difference.per_hour == -10
    assert difference.low < -10 < difference.high < 0
    assert spreads == (1, 1)
    nothing, _, unknown, _ = rates_of(exposure([], []), exposure([1], [1]))
    assert np.isnan([*nothing, *unknown]).all()


def test_one_drive_has_no_spread_and_drives_without_hours_do_not_count() -> None:
    first, second, difference, spreads = rates_of(exposure([10, 0, 0], [1, 0, 0]), exposure([9, 0], [1, 1]))
    assert first.per_hour == 10
    assert np.isnan([first.low, first.high, difference.low, difference.high, spreads[0]]).all()
    assert difference.per_hour == -5.5
    assert np.isfinite([*second, spreads[1]]).all()
    counts, hours = [9, 0, 0], [1, 1, 1]
    found = rates_of(exposure(counts, hours), exposure(counts, hours))
    assert found == rates_of(exposure([*counts, 0], [*hours, 0]), exposure([*counts, 0, 0], [*hours, 0, 0]))


def test_bursts_in_a_small_set_are_not_hidden_by_a_large_quiet_one() -> None:
    bursts, quiet = exposure([50, *[0] * 9], [1] * 10), exposure([0] * 1000, [1] * 1000)
    _, _, difference, spreads = rates_of(bursts, quiet)
    assert spreads == pytest.approx((50, 1))
    assert difference.low < -20
    assert difference.high > -0.1


def test_one_drive_in_a_set_gives_no_verdict(sets: tuple[Drives, Drives], tmp_path: Path) -> None:
    drive(tmp_path, "one", [])
    one = index(tmp_path / "one", output=tmp_path / "one.parquet", fields="/bump.data", executor=Here())
    found = sets[0].compare(one, BUMP, executor=Here())
    assert not found.is_different
    assert found.difference.per_hour < 0
    assert "unknown with one drive in a set" in repr(found)
    assert "variance between drives: 1.8, unknown" in repr(found)
    nothing = index(sets[1].files[2], output=tmp_path / "nothing.parquet", executor=Here())
    none = sets[0].compare(nothing, BUMP, executor=Here())
    assert not none.is_different
    assert "one of the sets has no drive that could be searched" in repr(none)


@pytest.mark.parametrize(
    ("drives", "rates", "bursts", "least"),
    [
        ((10, 10), (2.0, 3.0), (None, None), 0.95),
        ((10, 10), (2.0, 3.0), (0.3, 0.3), 0.88),
        ((50, 50), (2.0, 3.0), (1.0, 1.0), 0.9),
        ((10, 300), (2.0, 2.0), (0.3, None), 0.82),
        ((10, 1000), (2.0, 0.2), (0.3, 0.3), 0.82),
    ],
)
def test_the_interval_contains_the_difference_as_often_as_it_should(
    drives: tuple[int, int], rates: tuple[float, float], bursts: tuple[float | None, float | None], least: float
) -> None:
    random, hit, times = np.random.default_rng(5), 0, 300
    for _ in range(times):
        sets = []
        for count, rate, burst in zip(drives, rates, bursts, strict=True):
            hours = random.uniform(0.3, 1.5, count)
            usual = rate * hours * (1 if burst is None else random.gamma(burst, 1 / burst, count))
            sets.append(Exposure(random.poisson(usual), hours))
        _, _, difference, _ = rates_of(*sets)
        hit += difference.low <= rates[1] - rates[0] <= difference.high
    assert least <= hit / times <= 0.995
