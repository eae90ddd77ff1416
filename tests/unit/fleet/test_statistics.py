"""Statistics of fields over many recordings, by file and by other groups."""

from __future__ import annotations

from collections.abc import Iterator
from math import fsum, inf, nan
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.fleet import Drives, Statistics, _engine, _gather, index, statistics
from robowidgets.fleet._tally import ERROR, EXACT, Tally

from ..recordings import recorded
from .executors import Here

SPEED = "/odom.twist.twist.linear.x"
PARTS = (0.0, 0.05, 0.25, 0.5, 0.95, 1.0)


@pytest.fixture
def drives(runs: Path, tmp_path: Path) -> Drives:
    return index(runs, output=tmp_path / "drives.parquet", executor=Here())


def check(row: dict[str, Any], values: Any) -> None:
    """Compare a row with NumPy's results for all values."""
    finite = values[np.isfinite(values)]
    assert row["count"] == len(finite)
    assert row["unknown"] == np.isnan(values).sum()
    assert (row["inf"], row["minus_inf"]) == ((values == inf).sum(), (values == -inf).sum())
    if not len(finite):
        assert row["mean"] is row["min"] is row["max"] is row["q50"] is None
        return
    assert row["mean"] == pytest.approx(fsum(finite) / len(finite), rel=1e-12, abs=1e-15)
    assert (row["min"], row["max"]) == (finite.min(), finite.max())
    for part in PARTS:
        assert row[f"q{part * 100:02.0f}"] == pytest.approx(np.quantile(finite, part), rel=1e-12), part


def measured(file: str, name: str) -> Any:
    """All values of a recording, from whole columns."""
    with robowidgets.open(file) as recording:
        if name == SPEED:
            return recording.fields("/odom")["twist.twist.linear.x"].astype(float)
        away = recording.scans().distances("front").astype(float)
        return np.where(away == 0, -inf, away)


def test_rows_by_file_and_together_are_those_of_whole_columns(drives: Drives) -> None:
    files = [file for file in drives.files if not file.endswith(".bag")]
    by_file = drives.statistics("front", SPEED, by="file", quantiles=PARTS)
    rows = by_file.to_arrow().to_pylist()
    assert [(row["file"], row["field"]) for row in rows] == [(f, name) for f in files for name in ("front", SPEED)]
    for row in rows:
        check(row, measured(row["file"], row["field"]))
    (together,) = drives.statistics(SPEED, quantiles=PARTS).to_polars().to_dicts()
    check(together, np.concatenate([measured(file, SPEED) for file in files]))
    assert together["drives"] == 3
    assert [Path(one.file).name for one in by_file.unread] == ["broken.bag"]
    assert by_file.to_pandas()["count"].tolist() == [row["count"] for row in rows]
    assert "run_2.mcap" in repr(by_file)
    assert "! not read: broken.bag" in repr(by_file)


@pytest.mark.slow
@pytest.mark.timeout(600)
def test_statistics_of_real_recordings_are_those_of_loops_over_whole_files(data: Path, tmp_path: Path) -> None:
    drives = index(data, output=tmp_path / "drives.parquet")
    for name in ("front", "nearest", "linear.x", "angular.z"):
        found = drives.statistics(name, by="file", quantiles=PARTS)
        every = []
        for row in found.to_arrow().to_pylist():
            with robowidgets.open(row["file"]) as recording:
                recording.preferred = frozenset(_gathered(recording))
                if name in ("front", "nearest"):
                    sector = ("front",) if name == "front" else ()
                    values = recording.scans().distances(*sector).astype(float)
                    values[values == 0] = -inf
                else:
                    values = recording.speeds().values[:, 0 if name == "linear.x" else 5]
            check(row, values)
            every.append(values)
        assert len(every) >= 4
        assert len(every) + len(found.unread) == len(drives)
        (together,) = drives.statistics(name, quantiles=PARTS).to_arrow().to_pylist()
        check(together, np.concatenate(every))


def _gathered(recording: Any) -> list[str]:
    from robowidgets.fleet._topics import chosen_of

    return chosen_of(recording, ())


def levels(folder: Path, name: str, values: list[float], version: str | None) -> None:
    types = {"/level": "std_msgs/msg/Float64", "/version": "std_msgs/msg/String"}
    said = [(0.0, "/version", {"data": version})] if version else []
    recorded.write(folder / name, types, [*said, *((i, "/level", {"data": one}) for i, one in enumerate(values))])


def test_groups_come_from_a_field_the_folder_the_day_a_mapping_or_a_function(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for name, values, version in (
        ("a", [1.0, nan, 3.0], "1.0"),
        ("b", [inf, -inf, 5.0], "1.0"),
        ("c", [-7.0], "1.1"),
        ("d", [1.0], None),
    ):
        levels(tmp_path / "runs", name, values, version)
    drives = index(tmp_path / "runs", output=tmp_path / "drives.parquet", executor=Here())

    def rows(by: Any, *fields: Any) -> list[tuple[Any, ...]]:
        table = drives.statistics(*(fields or ("/level.data",)), by=by).to_arrow().to_pylist()
        return [(row[next(iter(row))], row["count"], row["mean"]) for row in table]

    by_version = drives.statistics("/level.data", by="/version.data").to_arrow().to_pylist()
    counted = ("/version.data", "drives", "count", "unknown", "inf", "minus_inf", "mean")
    assert [tuple(row[name] for name in counted) for row in by_version] == [
        ("1.0", 2, 3, 1, 1, 1, 3.0),
        ("1.1", 1, 1, 0, 0, 0, -7.0),
    ]
    assert rows("folder") == [(str(tmp_path / "runs"), 5, 0.6)]
    assert rows("day") == [("2023-11-14", 5, 0.6)]
    assert rows(lambda file: Path(file).name < "c") == [("False", 2, -3.0), ("True", 3, 3.0)]
    assert rows({file: Path(file).name in "ad" for file in drives.files})[1] == ("True", 3, 5 / 3)
    assert rows("file", abs(conditions.field("/level.data")))[2][2] == 7.0
    (together,) = drives.statistics("/level.data").to_arrow().to_pylist()
    assert list(together)[:3] == ["field", "drives", "count"]


@pytest.mark.parametrize(
    ("fields", "options", "error", "text"),
    [
        ((), {}, TypeError, "expected fields"),
        ((3,), {}, TypeError, "expected a topic with a field"),
        (("frnt",), {}, ValueError, "one of 'nearest', 'front'.*got 'frnt'"),
        (("front",), {"quantiles": [2]}, ValueError, "quantiles: expected numbers from 0 to 1"),
        (("front",), {"quantiles": 0.5}, TypeError, r"quantiles: expected numbers from 0 to 1, such as .*, got 0.5"),
        (
            ("front",),
            {"quantiles": "0.5"},
            TypeError,
            r"quantiles: expected numbers from 0 to 1, such as .*, got '0.5'",
        ),
        (("front",), {"by": "robot"}, ValueError, "by: expected one of 'file', 'folder', 'day', 'sensors'"),
        (("front",), {"by": Path("runs")}, TypeError, "by: expected a text, a mapping, a function or None"),
        (
            ("front",),
            {"by": {}},
            ValueError,
            "by: expected a group for each recording, got none for .*, one of 4 without",
        ),
        (("/none.x",), {}, RecordingError, "none of 4 recordings has /none.x: .*no topic '/none'"),
        (("/odom.header.stamp",), {}, RecordingError, "is a time, not a number"),
        (("/odom.header.frame_id",), {}, RecordingError, "is a string, not a number"),
        (("/scan.ranges",), {}, RecordingError, r"several values in a message: name one, such as 'ranges\[0\]'"),
    ],
)
def test_wrong_requests_are_refused(
    fields: Any, options: Any, error: type[Exception], text: str, drives: Drives
) -> None:
    with pytest.raises(error, match=text):
        drives.statistics(*fields, executor=Here(), **options)


def test_a_recording_without_one_of_the_fields_has_the_others(runs: Path, tmp_path: Path) -> None:
    levels(runs, "other", [2.0], None)
    drives = index(runs / "other", runs / "run_2.mcap", output=tmp_path / "drives.parquet", executor=Here())
    found = drives.statistics("/level.data", "front", executor=Here())
    assert [row["drives"] for row in found.to_arrow().to_pylist()] == [1, 1]
    assert sorted(Path(one.file).name for one in found.unread) == ["other", "run_2.mcap"]


def test_an_interrupt_keeps_what_was_read(drives: Drives, monkeypatch: pytest.MonkeyPatch) -> None:
    def each(*arguments: Any, **options: Any) -> Iterator[Any]:
        yield next(_engine.each(*arguments, **options))
        raise KeyboardInterrupt

    monkeypatch.setattr(_gather, "each", each)
    found: Statistics = drives.statistics(SPEED)
    assert not found.is_complete
    assert "stopped after" in repr(found)


@pytest.mark.parametrize("seed", [1, 2])
def test_quantiles_of_many_values_differ_by_a_thousandth_at_most_in_any_order(seed: int) -> None:
    random = np.random.default_rng(seed)
    values = random.normal(size=2 * EXACT) * 10 ** random.uniform(-6, 6, 2 * EXACT)
    values[:1000] = 0.0
    tallies = []
    for parts in (np.array_split(values, 7), np.array_split(values[::-1], 3)):
        whole = Tally()
        for part in parts:
            one = Tally()
            one.add(part)
            whole.merge(one)
        tallies.append(whole)
    one, other = tallies
    assert not one.is_exact
    for part in np.linspace(0, 1, 101):
        exact = np.quantile(values, part, method="lower"), np.quantile(values, part, method="higher")
        found = one.quantile(part)
        assert found == other.quantile(part)
        assert min(exact) - ERROR * abs(min(exact)) * 1.001 <= found <= max(exact) + ERROR * abs(max(exact)) * 1.001
    assert one.mean == pytest.approx(fsum(values) / len(values), rel=1e-9)
    assert (one.least, one.most) == (values.min(), values.max())


def test_a_group_without_a_name_stays_null_apart_from_the_text_none(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for name, value, version in (("a", 1.0, "None"), ("b", 2.0, "2"), ("c", 3.0, "1")):
        levels(tmp_path / "runs", name, [value], version)
    drives = index(tmp_path / "runs", output=tmp_path / "drives.parquet", executor=Here())

    def groups(by: Any) -> list[Any]:
        table = drives.statistics("/level.data", by=by, executor=Here()).to_arrow()
        return list(zip(table[0].to_pylist(), table["mean"].to_pylist(), strict=True))

    assert groups({file: None if file.endswith("a") else "None" for file in drives.files}) == [("None", 2.5), (None, 1)]
    assert groups(lambda file: None if file.endswith("a") else "None") == [("None", 2.5), (None, 1)]
    assert groups(dict.fromkeys(drives.files)) == [(None, 2)]
    assert groups("scan") == [(None, 2)]
    assert sorted(groups("/version.data")) == [("1", 3), ("2", 2), ("None", 1)]


def test_the_day_comes_from_a_recording_that_the_index_could_not_read(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for name in "ab":
        levels(tmp_path / "runs", name, [1.0, 2.0], None)
    file = tmp_path / "runs" / "b" / "b.mcap"
    whole = file.read_bytes()
    file.write_bytes(b"nothing")
    drives = index(tmp_path / "runs", output=tmp_path / "drives.parquet", executor=Here())
    file.write_bytes(whole)
    (row,) = drives.statistics("/level.data", by="day", executor=Here()).to_arrow().to_pylist()
    assert (row["day"], row["drives"], row["count"]) == ("2023-11-14", 2, 4)


def test_a_recording_that_was_read_in_part_is_named(tmp_path: Path) -> None:
    levels(tmp_path, "a", [1.0] * 200, None)
    file = tmp_path / "a" / "a.mcap"
    file.write_bytes(file.read_bytes()[:-3000])
    drives = index(tmp_path / "a", output=tmp_path / "drives.parquet", executor=Here())
    found = drives.statistics("/level.data", executor=Here())
    assert [*found.problems] == [str(tmp_path / "a")]
    assert "! 1 file with problems, in .problems: a" in repr(found)


def test_values_of_one_drive_do_not_stay_in_memory_if_files_are_the_groups(drives: Drives) -> None:
    sinks: list[Any] = []

    class Sink(statistics._Sink):
        def __init__(self, *arguments: Any, **options: Any) -> None:
            super().__init__(*arguments, **options)
            sinks.append(self)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(statistics, "_Sink", Sink)
        drives.statistics(SPEED, by="file", executor=Here())
        drives.statistics(SPEED, by="folder", executor=Here())
    assert [len(sink._tallies) for sink in sinks] == [0, 2]
    assert [len(sink.numbers()) for sink in sinks] == [3, 2]


def test_quantiles_may_come_from_a_generator(drives: Drives) -> None:
    found = drives.statistics(SPEED, quantiles=(part for part in (0.1, 0.9)), executor=Here())
    assert {"q10", "q90"} <= {*found.to_arrow().column_names}


def test_the_largest_numbers_have_a_mean_and_quantiles() -> None:
    most = np.finfo(float).max
    one, other = Tally(), Tally()
    one.add(np.array([1.0, most, most, -3.0]))
    other.add(np.array([most, most, most, most]))
    one.merge(other)
    assert one.mean == pytest.approx(most / 8 * 6)
    assert one.quantile(0.5) == most
    other.add(np.full(1000, most))
    assert other.mean == other.quantile(0.5) == most
    ends = Tally()
    ends.add(np.array([-most, most]))
    assert ends.mean == ends.quantile(0.5) == 0
    small = Tally()
    small.add(np.array([5e-324, 1e-310, 3e-310]))
    assert small.mean == fsum([5e-324, 1e-310, 3e-310]) / 3
    many = Tally()
    many.add(np.append(np.linspace(0, 1, EXACT), [most, most]))
    assert not many.is_exact
    assert many.quantile(1 - 1e-9) == pytest.approx(most, rel=1e-3)


def test_the_error_of_a_quantile_is_by_the_size_of_the_values_next_to_it() -> None:
    values = np.concatenate([-np.linspace(1000, 2000, EXACT), np.linspace(1003, 2000, EXACT)])
    tally = Tally()
    tally.add(values)
    assert abs(tally.quantile(0.5) - np.quantile(values, 0.5)) <= ERROR * 1003
