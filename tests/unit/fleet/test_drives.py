"""The index of many recordings, and the recordings that a search reads with it."""

from __future__ import annotations

import json
import os
import resource
import sys
from concurrent.futures import ThreadPoolExecutor
from itertools import count
from math import nan
from pathlib import Path
from shutil import copy, rmtree
from signal import SIGINT
from threading import Event, current_thread, main_thread
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main
from robowidgets.fleet import drives, find, index
from robowidgets.fleet.hits import Hits
from robowidgets.notebook.progress import Progress
from robowidgets.recordings.search.base import Condition

from ..recordings import recorded
from .executors import Here

DATA = Path(os.environ.get("ROBOWIDGETS_DATA", Path(__file__).parents[4] / "shared" / "data"))
NEAR, NEVER = conditions.nearest_below(0.3), conditions.nearest_below(0.01)


def rows(hits: Hits) -> list[tuple[Any, ...]]:
    return sorted((tuple(hit) for hit in hits), key=repr)


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "drives.parquet"


@pytest.mark.slow
@pytest.mark.timeout(600)
@pytest.mark.skipif(not DATA.is_dir(), reason="needs the recordings of real robots")
def test_no_hit_of_real_recordings_is_lost_and_fewer_are_read(output: Path) -> None:
    # Slow: it reads each of these recordings for the index, and again for each condition.
    folders = DATA / "good", DATA / "odd"
    there = index(*folders, output=output, executor=Here())
    field = conditions.field("/odom.twist.twist.linear.x")
    for condition in (
        NEAR,
        conditions.nearest_below(0.15, ("100deg", "-100deg")) | conditions.gap(5.0),
        ~conditions.speed_above(0.01) & conditions.nearest_below(0.5, "front"),
        conditions.touched() & conditions.speed_above(0.1, "angular.z") & (field < 0.2),
    ):
        here = Here()
        assert rows(there.find(condition, executor=here)) == rows(find(condition, *folders, executor=Here())), condition
        assert len(here.ran) < len(there.files)


def test_a_row_tells_of_its_second_and_of_the_last_sample_before(runs: Path, output: Path) -> None:
    there = index(runs / "run_2.mcap", output=output).to_arrow().to_pandas()
    with robowidgets.open(runs / "run_2.mcap") as recording:
        scans, speeds, touches = recording.scans(), recording.speeds(), recording.touches()
        assert there["second"].tolist() == list(range(int(recording.duration) + 1))
        for second in (0, 5, 12):
            row = there.iloc[second]
            part = np.flatnonzero((scans.seconds >= second) & (scans.seconds < second + 1))
            held = scans[slice(max(part[0] - 1, 0), part[-1] + 1)]
            assert row["front"] == held.distances("front").min()
            assert row["nearest"] == held.distances().min()
            part = np.flatnonzero((speeds.seconds >= second) & (speeds.seconds < second + 1))
            assert row["linear_x_max"] == speeds.linear[max(part[0] - 1, 0) : part[-1] + 1, 0].max()
            assert row["x"] == speeds.poses[max(part[0] - 1, 0), 0]
        touched = {int(second) for second in touches.seconds[(touches.states == 1).any(axis=1)]}
        assert touched <= set(there["second"][there["touched"] != ""])


def test_only_recordings_in_which_it_may_have_been_are_read(runs: Path, output: Path) -> None:
    there = index(runs, output=output, executor=Here())
    here = Here()
    assert rows(there.find(NEAR, executor=here)) == rows(find(NEAR, runs, executor=Here()))
    assert len(here.ran) == 4
    here = Here()
    hits = there.find(NEVER & (lambda scan: scan.ranges[0] > 0), executor=here)  # type: ignore[operator]
    assert here.ran == [str(runs / "broken.bag")]  # it may be complete now
    assert "by the index 3 files had no such moment" in repr(hits)
    os.utime(runs / "run_10.mcap", (1, 1))
    assert there.candidates(NEVER) == [str(runs / "broken.bag"), str(runs / "run_10.mcap")]
    assert len(there.candidates(conditions.touched("nose"))) == 4  # the search reports the available sensors


@pytest.mark.parametrize(
    ("condition", "is_possible"),
    [
        (conditions.nearest_below(0.05, "back"), False),
        (~conditions.nearest_below(0.05, "back"), True),
        (conditions.speed_above(0.2), True),
        (conditions.speed_above(9.0), False),
        (~conditions.speed_above(9.0), True),
        (~conditions.speed_above(0.0, "linear.y"), True),
        (conditions.touched("left"), True),
        (conditions.gap(60.0), False),
        (conditions.gap(60.0, "/elsewhere"), True),
        (conditions.gap(60.0) | conditions.touched(), True),
        (conditions.event(level="WARN"), True),
        (conditions.when(lambda moment: moment.seconds < 0), True),
    ],
    ids=str,
)
def test_a_condition_that_the_index_cannot_tell_of_may_have_been_true(
    condition: Condition, is_possible: bool, sample_index: Path
) -> None:
    assert bool(drives(sample_index).candidates(condition)) is is_possible


@pytest.fixture(scope="module")
def sample_index(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return index(robowidgets.SAMPLE, output=tmp_path_factory.mktemp("index") / "sample.parquet").path


FIELD = conditions.field
BATTERY, MODE = "/battery.percentage", "/mode.data"


def write_states(folder: Path) -> Path:
    """Write recordings with a battery and a mode, one of them without the battery."""
    types = {"/battery": "sensor_msgs/msg/BatteryState", "/mode": "std_msgs/msg/String"}
    for name, levels, modes in (
        ("full", (0.9, 0.8, nan, 0.7), ("drive", "drive, slowly")),
        ("low", (0.4, -0.1), ("drive", "dock")),
        ("silent", (), ("dock",)),
    ):
        messages = [(10.0 * i, "/battery", {"percentage": level}) for i, level in enumerate(levels)]
        messages += [(4.0 + i, "/mode", {"data": mode}) for i, mode in enumerate(modes)]
        recorded.write(folder / name, types, [*messages, (40.0, "/mode", {"data": modes[-1]})])
    types = {"/mode": "std_msgs/msg/String", "/battery": "std_msgs/msg/String"}
    recorded.write(folder / "other", types, [(0.0, "/mode", {"data": "drive"}), (1.0, "/battery", {"data": "low"})])
    return folder


@pytest.mark.parametrize(
    ("condition", "names"),
    [
        (FIELD(BATTERY) < 0.5, "low"),
        (FIELD(BATTERY) <= 0.7, "full low"),
        (FIELD(BATTERY) > 0.9, ""),
        (FIELD(BATTERY) >= 0.85, "full"),
        (FIELD(BATTERY) == 0.1, "low"),
        (FIELD(BATTERY) != 0.5, "full low"),
        (~(FIELD(BATTERY) < 0.5), "full"),
        (~(FIELD(BATTERY) > -1), ""),
        (abs(FIELD(BATTERY)) < 0.05, "low"),
        (FIELD(BATTERY).between(-1, -0.05), "low"),
        (FIELD(MODE) == "dock", "low silent"),
        (FIELD(MODE) != "dock", "full low other"),
        (~(FIELD(MODE) == "drive"), "full low silent"),
        (FIELD(MODE) == "slowly", ""),
        (FIELD(MODE) > 3, "full low other silent"),
        (FIELD("/mode.other") == "dock", "full low other silent"),
        ((FIELD(BATTERY) < 0.5) & (FIELD(MODE) == "none"), ""),
        (FIELD(BATTERY) < 2**53 + 1, "full low other silent"),
    ],
    ids=str,
)
def test_a_condition_on_a_field_of_the_index_needs_no_other_recordings(
    condition: Condition, names: str, states_index: Path
) -> None:
    there = drives(states_index)
    assert there.fields == (BATTERY, MODE)
    found = [Path(file).name for file in there.candidates(condition)]
    # The others have a battery of another type, or no message of it.
    asked = names.split()
    if BATTERY in str(condition) and MODE not in str(condition):
        asked = sorted({*asked, "other"})
    assert sorted(found) == asked


@pytest.fixture(scope="module")
def states_index(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = write_states(tmp_path_factory.mktemp("states"))
    output = tmp_path_factory.mktemp("index") / "states.parquet"
    return index(folder, output=output, fields=[BATTERY, MODE], executor=Here()).path


def test_a_field_of_an_index_holds_its_last_value_and_can_be_asked_by_columns(states_index: Path) -> None:
    rows_of = drives(states_index).to_arrow().to_pandas()
    full = rows_of[rows_of["file"].str.endswith("full")].set_index("second")
    assert full.loc[[0, 4, 10, 20, 30], f"{BATTERY}_min"].round(1).tolist() == [0.9, 0.9, 0.8, 0.8, 0.7]
    assert full.loc[[0, 4, 10, 20, 30], f"{BATTERY}_max"].round(1).tolist() == [0.9, 0.9, 0.9, 0.8, 0.7]
    assert full.loc[[4, 5, 40], MODE].tolist() == ['["drive"]', '["drive", "drive, slowly"]', '["drive, slowly"]']
    assert full.loc[0, BATTERY] == "float32"


def test_an_index_without_fields_is_one_of_before_and_is_read(runs: Path, output: Path) -> None:
    import pyarrow.parquet

    index(runs, output=output, executor=Here())
    table = pyarrow.parquet.read_table(output)
    about = json.loads(table.schema.metadata[b"robowidgets"])
    del about["fields"]  # as it was before there were fields
    pyarrow.parquet.write_table(table.replace_schema_metadata({"robowidgets": json.dumps(about)}), output)
    assert drives(output).fields == ()
    assert len(drives(output).candidates(NEVER)) == 1
    here = Here()
    index(runs / "*.mcap", output=output, executor=here)
    assert here.ran == []
    index(runs / "*.mcap", output=output, executor=here, fields="/odom.twist.twist.linear.x")
    assert len(here.ran) == 2
    assert len(drives(output).candidates(conditions.field("/odom.twist.twist.linear.x") > 5)) == 0
    for wrong, error in (("/odom", ValueError), (3, TypeError)):
        with pytest.raises(error, match="expected a topic with a field"):
            index(runs, output=output, fields=[wrong])  # type: ignore[list-item]


def test_a_recording_in_two_files_of_a_folder_counts_once(runs: Path, tmp_path: Path) -> None:
    for name, recording in (("monday", "run_2.mcap"), ("tuesday", "run_10.mcap"), ("again", "run_2.mcap")):
        (tmp_path / "index").mkdir(exist_ok=True)
        index(runs / recording, output=tmp_path / "index" / f"{name}.parquet", executor=Here())
    there = drives(tmp_path / "index")
    assert there.files == (str(runs / "run_2.mcap"), str(runs / "run_10.mcap"))
    assert len(there) == 2
    assert there.candidates(NEVER) == []
    os.utime(runs / "run_10.mcap", (1, 1))
    assert there.candidates(NEVER) == [str(runs / "run_10.mcap")]


def test_an_index_that_is_trusted_looks_at_no_recording(
    runs: Path, output: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = index(runs / "*.mcap", output=output, executor=Here())
    os.utime(runs / "run_10.mcap", (1, 1))
    looked, stat = [], os.stat
    monkeypatch.setattr(os, "stat", lambda path, **options: looked.append(str(path)) or stat(path, **options))
    assert there.candidates(NEVER, check=False) == []
    hits = there.find(NEVER, check=False)
    assert (len(hits), len(hits.files)) == (0, 2)
    assert {*looked} <= {str(output)}  # pathlib of Python 3.10 looks past this


def test_a_new_index_reads_what_is_new_and_leaves_out_what_is_not_named(runs: Path, output: Path) -> None:
    first = index(runs, output=output, executor=Here()).to_arrow().to_pylist()
    copy(runs / "run_2.mcap", runs / "run_3.mcap")
    here = Here()
    there = index(runs / "*.mcap", output=output, executor=here)
    assert here.ran == [str(runs / "run_3.mcap")]
    assert there.files == tuple(str(runs / f"run_{number}.mcap") for number in (2, 3, 10))
    kept = [row for row in there.to_arrow().to_pylist() if row["file"] != here.ran[0]]
    assert sorted(kept, key=repr) == sorted((row for row in first if row["file"] in there.files), key=repr)
    here = Here()
    index(runs / "*.mcap", output=output, topics="/sc*", executor=here)
    assert len(here.ran) == 3  # of other topics


def test_an_interrupt_leaves_an_index_that_misses_nothing(
    runs: Path, output: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    released, both_before = Event(), Event()
    own = sys.modules["robowidgets.fleet.drives"]  # the package has the function under this name
    seconds_of, update, updates = own.seconds_of, Progress.update, count(1)

    def counts(bar: Progress, done: int, *given: Any) -> None:
        update(bar, done, *given)
        # Each recording has a bar of its own, in the thread that reads it; a search that waits updates by 0.
        if current_thread() is main_thread() and done and next(updates) == 2:
            both_before.set()

    def interrupts(recording: Any, fields: Any) -> Any:
        if recording.path.name == "run_10.mcap" and not released.is_set():
            both_before.wait()
            os.kill(os.getpid(), SIGINT)
            released.wait()
        return seconds_of(recording, fields)

    monkeypatch.setattr(Progress, "update", counts)
    monkeypatch.setattr(own, "seconds_of", interrupts)
    with ThreadPoolExecutor(1) as threads:
        there = index(runs, output=output, executor=threads)
        released.set()
    assert str(runs / "run_10.mcap") in {one.file for one in there.unread}
    assert "not read before an interrupt" in repr(there)
    assert str(runs / "run_10.mcap") in there.candidates(NEVER)
    again = Here()
    assert rows(index(runs, output=output, executor=again).find(NEAR, executor=Here())) == rows(
        find(NEAR, runs, executor=Here())
    )
    assert str(runs / "run_2.mcap") not in again.ran


def test_a_full_disk_leaves_the_earlier_index(runs: Path, output: Path) -> None:
    index(runs / "run_2.mcap", output=output, executor=Here())
    before = output.read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (2_000, hard))
    try:
        with pytest.raises(OSError, match="too large"):
            index(runs, output=output, executor=Here())
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert output.read_bytes() == before
    assert [path.name for path in output.parent.iterdir() if "part" in path.suffix] == []


def test_what_is_not_an_index_is_refused_with_what_writes_one(tmp_path: Path) -> None:
    import pyarrow
    import pyarrow.parquet

    (tmp_path / "text.parquet").write_text("no")
    pyarrow.parquet.write_table(pyarrow.table({"a": [1]}), tmp_path / "other.parquet")
    for name in ("text.parquet", "other.parquet", "missing.parquet"):
        with pytest.raises(
            robowidgets.RecordingError, match=rf"{name} is not an index .*robowidgets.index\(\) writes one"
        ):
            drives(tmp_path / name)
    with pytest.raises(ValueError, match=r"expected a name that ends in \.parquet"):
        index(robowidgets.SAMPLE, output=tmp_path / "drives.csv")
    with pytest.raises(TypeError, match=r"fields: expected topics with fields, .* got 3"):
        index(robowidgets.SAMPLE, output=tmp_path / "drives.parquet", fields=3)  # type: ignore[arg-type]
    with pytest.raises(TypeError, match=r"drives\(\): expected the path of an index, got None"):
        drives(None)  # type: ignore[arg-type]


def test_a_field_that_no_recording_has_is_reported(output: Path) -> None:
    names = ["/odom.twst.linear.x", "/odom.twist.twist.linear.x"]
    made = index(robowidgets.SAMPLE, output=output, fields=names, executor=Here())
    assert [line for line in repr(made).splitlines() if "no recording has" in line] == [
        "! no recording has /odom.twst.linear.x; robowidgets.open(...).fields(topic) shows the fields of a topic"
    ]


def test_the_command_writes_an_index_and_searches_by_it(
    runs: Path, output: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    files = [str(runs / "run_2.mcap")]
    assert main(["index", *files, "-o", str(output)]) == 0
    assert capsys.readouterr().out.startswith("drives.parquet: 1 recording, ")
    assert main(["find", str(output), "--nearest-below", "0.3"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split("\t")[0] for line in lines[1:]] == [hit.file for hit in find(NEAR, *files)]
    assert main(["find", str(output), "--nearest-below", "0.01"]) == 1
    assert main(["index", *files, "-o", str(output), "--field", "/odom.twist.twist.linear.x"]) == 0
    assert drives(output).fields == ("/odom.twist.twist.linear.x",)
    assert main(["index", *files, "-o", str(output), "--field", "/odom.twist.twist.linear.x > 0.1"]) == 2
    assert "--field needs --follow" in capsys.readouterr().err
    assert main(["index", *files, "-o", "drives.csv"]) == 2
    assert "expected a name that ends in .parquet" in capsys.readouterr().err


def test_a_folder_of_the_index_stays_one_recording_without_its_metadata(tmp_path: Path) -> None:
    (tmp_path / "runs").mkdir()
    for name in ("lost", "whole", "gone"):
        messages = [(float(second), "/level", {"data": 1.0}) for second in range(5)]
        recorded.write(tmp_path / "runs" / name, {"/level": "std_msgs/msg/Float64"}, messages)
    found = index(tmp_path / "runs", output=tmp_path / "drives.parquet", executor=Here())
    sample = index(robowidgets.SAMPLE, output=tmp_path / "sample.parquet", executor=Here())
    lost, whole = (str(tmp_path / "runs" / name) for name in ("lost", "whole"))
    (Path(lost) / "metadata.yaml").unlink()
    rmtree(tmp_path / "runs" / "gone")
    hits = found.find(conditions.field("/level.data") > 0, executor=Here())
    assert [hit.file for hit in hits] == [lost, whole]
    assert [(Path(one.file).name, one.problem) for one in hits.unread] == [("gone", "no such file or folder")]
    table = found.statistics("/level.data", by="file", executor=Here())
    assert table.to_arrow()["file"].to_pylist() == [lost, whole]
    assert set(found.table("/level.data", executor=Here()).to_arrow()["file"].to_pylist()) == {lost, whole}
    both = found.compare(sample, conditions.field("/level.data") > 0, executor=Here())
    assert {row["file"] for row in both.by_file().to_arrow().to_pylist()} == {lost, whole}


def test_drives_of_an_index_that_was_written_again_say_so(runs: Path, output: Path) -> None:
    old = index(runs / "run_2.mcap", output=output, executor=Here())
    new = index(runs, output=output, executor=Here())
    for ask in (lambda: old.find(NEAR, executor=Here()), old.to_arrow, lambda: len(old)):
        with pytest.raises(
            robowidgets.RecordingError, match=r"drives.parquet was written again.*robowidgets.drives\(\)"
        ):
            ask()
    assert len(new) == 4
    output.unlink()
    with pytest.raises(robowidgets.RecordingError, match="or removed"):
        new.to_arrow()
