"""Fields of many recordings in one table, written as they are read."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as arrow
import pyarrow.parquet as parquet
import pytest

import robowidgets
from robowidgets import RecordingError
from robowidgets.fleet import Drives, _engine, _gather, index

from ..recordings import recorded, robot

NAMES = ("/scan.front", "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x", "/bumper.state")


@pytest.fixture
def drives(runs: Path, tmp_path: Path) -> Drives:
    return index(runs, output=tmp_path / "drives.parquet")


def plain(files: list[str], **options: Any) -> dict[str, list[Any]]:
    """The columns by file, from each recording by itself."""
    found: dict[str, list[Any]] = {}
    for file in files:
        with robowidgets.open(file) as recording:
            table = recording.table(*NAMES, **options).to_arrow()
        for name in table.column_names:
            found.setdefault(name, []).extend(table[name].to_pylist())
        found.setdefault("file", []).extend([file] * len(table))
    return found


def same(one: Any, other: Any) -> bool:
    return one == other or (one != one and other != other)


@pytest.mark.parametrize(("at", "how"), [(None, "last"), ("/odom", "linear"), (0.5, "last")])
def test_the_file_has_the_rows_of_each_recording(at: Any, how: str, drives: Drives, tmp_path: Path) -> None:
    table = drives.table(*NAMES, at=at, how=how)
    path = table.to_parquet(tmp_path / "table.parquet")
    rows = parquet.read_table(path)
    order = list(dict.fromkeys(rows["file"].to_pylist()))
    assert sorted(order) == sorted(file for file in drives.files if not file.endswith("broken.bag"))
    expected = plain(order, at=at, how=how)
    assert {*rows.column_names} == {*expected}
    for name, column in expected.items():
        assert all(map(same, rows[name].to_pylist(), column)), name
    assert rows.schema.field("/scan.front").type == arrow.float64()
    assert [Path(one.file).name for one in table.unread] == ["broken.bag"]
    assert "broken.bag" in repr(table)
    assert table.to_arrow().num_rows == len(table.to_pandas()) == len(table.to_polars()) == rows.num_rows


def test_recordings_without_a_field_or_with_other_columns_are_left_out_with_the_reason(
    runs: Path, tmp_path: Path
) -> None:
    robot.write(runs / "other")
    recorded.write(runs / "text", {"/level": "std_msgs/msg/String"}, [(0.0, "/level", {"data": "low"})])
    recorded.write(runs / "real", {"/level": "std_msgs/msg/Float64"}, [(0.0, "/level", {"data": 0.5})])
    drives = index(runs, output=tmp_path / "drives.parquet")
    table = drives.table("/level.data")
    (file,) = {*table.to_arrow()["file"].to_pylist()}
    left_out = {Path(one.file).name: one.problem for one in table.unread}
    other = {"real": "text", "text": "real"}[Path(file).name]
    assert "its columns differ from the columns of the other recordings: /level.data" in left_out[other]
    assert "no topic '/level'" in left_out["other"]
    none = drives.table("/none.x")
    with pytest.raises(RecordingError, match=r"none of 7 recordings has /none\.x: not read: .*no topic '/none'"):
        none.to_parquet(tmp_path / "none.parquet")
    assert not (tmp_path / "none.parquet").exists()


def test_an_interrupt_leaves_no_file_and_an_existing_one_as_it_was(
    drives: Drives, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def each(*arguments: Any, **options: Any) -> Iterator[Any]:
        yield next(_engine.each(*arguments, **options))
        raise KeyboardInterrupt

    monkeypatch.setattr(_gather, "each", each)
    (tmp_path / "there.parquet").write_bytes(b"kept")
    for name in ("new.parquet", "there.parquet"):
        with pytest.raises(KeyboardInterrupt):
            drives.table(*NAMES).to_parquet(tmp_path / name)
    assert (tmp_path / "there.parquet").read_bytes() == b"kept"
    assert sorted(path.suffix for path in tmp_path.iterdir()) == ["", ".parquet", ".parquet"]


def test_a_recording_that_was_read_in_part_is_named(tmp_path: Path) -> None:
    path = tmp_path / "drive.mcap"
    path.write_bytes(robowidgets.SAMPLE.read_bytes()[:400_000])
    table = index(path, output=tmp_path / "drives.parquet").table("/scan.front")
    rows = table.to_arrow()
    with robowidgets.open(path) as recording:
        assert len(rows) == len(recording.scans())
        assert table.problems == {str(path): recording.problems}
    assert "cut off" in table.problems[str(path)][0]
    assert "! 1 file with problems, in .problems: drive.mcap" in repr(table)


def test_wrong_requests_are_refused_before_anything_is_read(drives: Drives, tmp_path: Path) -> None:
    for names, options, error in (
        ((), {}, TypeError),
        (NAMES, {"how": "next"}, ValueError),
        (NAMES, {"at": 0}, ValueError),
    ):
        with pytest.raises(error):
            drives.table(*names, **options)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match=r"ends in \.parquet"):
        drives.table(*NAMES).to_parquet(tmp_path / "table.csv")


@pytest.mark.slow
def test_tables_of_real_recordings_equal_those_of_each_by_itself(data: Path, tmp_path: Path) -> None:
    folder = data / "good"
    drives = index(folder, output=tmp_path / "drives.parquet")
    table = drives.table("/scan.front", "/odom.twist.twist.linear.x", at="/scan", how="linear")
    rows = parquet.read_table(table.to_parquet(tmp_path / "table.parquet"))
    files = {*rows["file"].to_pylist()}
    assert len(files) + len(table.unread) == len(drives.files)
    assert len(files) >= 4
    for file in files:
        own = rows.filter(arrow.compute.equal(rows["file"], file))
        with robowidgets.open(file) as recording:
            alone = recording.table("/scan.front", "/odom.twist.twist.linear.x", at="/scan", how="linear")
        assert own["times_ns"].to_pylist() == alone.times_ns.tolist()
        for name in alone.names:
            np.testing.assert_array_equal(own[name].to_numpy(), alone[name].astype(float))
