"""One search through many recordings."""

from __future__ import annotations

import ast
import json
import os
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from shutil import copy
from signal import SIGINT, SIGKILL
from threading import Event
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions
from robowidgets.command import main
from robowidgets.fleet import find
from robowidgets.fleet._engine import Done, each
from robowidgets.fleet._fleet_table import Unread, not_read
from robowidgets.fleet.hits import Hit, Hits

from ..clocks import ManualClock
from .executors import Here

DATA = Path(os.environ.get("ROBOWIDGETS_DATA", Path(__file__).parents[4] / "shared" / "data"))
NEAR = conditions.nearest_below(0.3)


def rows(hits: Hits) -> list[tuple[Any, ...]]:
    return [tuple(hit) for hit in hits]


def loop(files: list[Path], condition: Any) -> list[tuple[Any, ...]]:
    """The rows of single searches."""
    found = []
    for file in files:
        with robowidgets.open(file) as recording:
            spans = recording.find(condition)
        found += [(str(file), ", ".join(spans.topics), *span) for span in spans]
    return found


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="needs the recordings of real robots")
@pytest.mark.parametrize(
    ("condition", "folder"), [(NEAR, ""), (conditions.touched(), "good"), (conditions.gap(1.0), "good")], ids=str
)
def test_the_rows_of_real_recordings_match_single_searches(condition: Any, folder: str) -> None:
    hits = find(condition, DATA / folder, executor=Here())
    unsure = {*hits.chosen, *(one.file for one in hits.unread)}
    alone = [Path(file) for file in hits.files if file not in unsure]
    assert alone
    assert [row for row in rows(hits) if row[0] not in unsure] == loop(alone, condition)


def test_a_search_for_the_same_reads_no_recording_again_unless_it_changed(runs: Path) -> None:
    first, second, third = Here(), Here(), Here()
    hits = find(NEAR, runs, executor=first)
    again = find(conditions.nearest_below(0.3), runs, executor=second)
    assert (len(first.ran), rows(again)) == (4, rows(hits))
    assert second.ran == [str(runs / "broken.bag")]  # it may be complete the next time
    os.utime(runs / "run_2.mcap", (1, 1))
    find(NEAR, runs, executor=third)
    assert third.ran == [str(runs / "broken.bag"), str(runs / "run_2.mcap")]


@pytest.mark.slow
def test_what_was_kept_holds_for_the_same_condition_alone(runs: Path) -> None:
    def ran(condition: Any, **options: Any) -> int:
        here = Here()
        find(condition, runs / "run_2.mcap", runs / "run_10.mcap", executor=here, **options)
        return len(here.ran)

    assert ran(NEAR) == 2
    assert ran(conditions.nearest_below(0.31)) == 2
    assert ran(NEAR, topics="/sc*") == 2
    assert ran(NEAR, keep=False) == 2
    assert ran(NEAR) == 0


def test_what_cannot_be_kept_is_reported_and_loses_nothing(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "no_folder").write_text("")
    hits = find(NEAR, runs, executor=Here())
    monkeypatch.setenv("ROBOWIDGETS_CACHE", str(tmp_path / "no_folder"))
    same = find(NEAR, runs, executor=Here())
    assert rows(same) == rows(hits)
    assert "results cannot be stored for the next run" in repr(same)


def test_a_line_that_was_cut_as_it_was_kept_is_computed_again(runs: Path, own_cache: Path) -> None:
    hits = find(NEAR, runs / "run_2.mcap", runs / "run_10.mcap", executor=Here())
    (kept,) = (own_cache / "find").iterdir()
    # Results are saved in the order in which recordings are done.
    state, _ = json.loads(kept.read_bytes().splitlines()[-1].partition(b" ")[2])
    kept.write_bytes(kept.read_bytes()[:-20])
    here = Here()
    assert rows(find(NEAR, runs / "run_2.mcap", runs / "run_10.mcap", executor=here)) == rows(hits)
    assert here.ran == [json.loads(state)[0]]


@pytest.mark.slow
def test_an_interrupt_keeps_what_was_found_and_the_same_search_goes_on(runs: Path) -> None:
    whole = find(NEAR, runs, executor=Here(), keep=False)
    with ThreadPoolExecutor(1) as threads:
        cut = find(_interrupts_once, runs, executor=threads)
        RELEASED.set()
    assert not cut.is_complete
    assert {hit.file for hit in cut} <= {str(runs / "run_2.mcap")}
    assert f"stopped after {cut.until} of 4 files" in repr(cut)
    again = find(_interrupts_once, runs, executor=Here())
    assert [hit[2:] for hit in again] == [hit[2:] for hit in whole]


RELEASED = Event()


def _interrupts_once(moment: Any) -> bool:
    """Interrupt the main thread while it reads one of the recordings."""
    if "run_10.mcap" in _read() and not RELEASED.is_set():
        os.kill(os.getpid(), SIGINT)
        RELEASED.wait()
    return bool(moment.scan.distance() < 0.3)


def test_callers_waiting_for_slow_recordings_are_called_meanwhile() -> None:
    with ThreadPoolExecutor(1) as threads:
        assert [*each(_waits_for_a_call, ["a.mcap"], threads, idle=CALLED.set)] == [Done("a.mcap", True)]


CALLED = Event()


def _waits_for_a_call(_path: str) -> bool:
    return CALLED.wait(60)


@pytest.mark.slow
def test_where_an_executor_breaks_processes_of_this_machine_go_on(runs: Path) -> None:
    here = Here(breaks_after=2)
    assert rows(find(NEAR, runs, executor=here, keep=False)) == rows(find(NEAR, runs, executor=Here(), keep=False))
    assert len(here.ran) == 2


@pytest.mark.slow
def test_a_cluster_that_gives_one_recording_up_goes_on_with_the_others(runs: Path) -> None:
    cluster = Here(gives_up="run_2.mcap")
    assert rows(find(NEAR, runs, executor=cluster, keep=False)) == rows(find(NEAR, runs, executor=Here(), keep=False))
    assert len(cluster.ran) == 3


@pytest.mark.slow
def test_a_process_that_is_killed_loses_its_own_recording_alone(runs: Path) -> None:
    hits = find(_killer, runs / "run_2.mcap", runs / "run_10.mcap", keep=False)
    ((path, problem),) = hits.unread
    assert (Path(path).name, problem) == ("run_2.mcap", "the process that read it ended: killed, or out of memory")
    assert rows(hits) == loop([runs / "run_10.mcap"], lambda moment: moment.scan.distance() < 0.3)


def _killer(moment: Any) -> bool:
    """Kill the process that reads one of the recordings."""
    if "run_2.mcap" in _read():
        os.kill(os.getpid(), SIGKILL)
    return bool(moment.scan.distance() < 0.3)


def _read() -> set[str]:
    """Yield the names of the recordings that are read within the block."""
    found, frame = set(), sys._getframe()
    while frame.f_back is not None:
        frame = frame.f_back
        found.add(os.path.basename(str(frame.f_locals.get("path", ""))))
    return found


HANGS_IN_C = r"""
import re
def stuck(scan):
    return re.match(r"(a+)+$", "a" * 40 + "b") is not None
"""


def made(text: str, name: str) -> Any:
    """A function like one from a cell of a notebook, which is sent to processes by value."""
    names: dict[str, Any] = {"__name__": "__main__"}
    exec(text, names)
    return names[name]


@pytest.mark.slow
def test_a_function_that_holds_the_interpreter_in_c_is_ended_after_its_time(runs: Path) -> None:
    hits = find(made(HANGS_IN_C, "stuck"), runs / "run_2.mcap", longest=0.5)
    assert [one.problem for one in hits.unread] == ["took longer than 0.5 s"]


@pytest.mark.slow
@pytest.mark.parametrize("error", ["SystemExit", "GeneratorExit"])
def test_whatever_a_function_raises_is_named(runs: Path, error: str) -> None:
    raises = made(f"def raises(scan): raise {error}('odd')", "raises")
    (one,) = find(raises, runs / "run_2.mcap").unread
    assert one.problem == f"{error}: odd"


@pytest.mark.slow
def test_a_typo_ends_the_search_after_ten_recordings(tmp_path: Path) -> None:
    for number in range(40):
        copy(robowidgets.SAMPLE, tmp_path / f"run_{number}.mcap")
    hits = find(made("def near(scan): return scna.distance() < 0.3", "near"), tmp_path)
    assert not hits.is_complete
    assert len(hits.unread) == 10
    assert (
        "stopped because it failed in the same way for the first 10 recordings: NameError: name 'scna' is not defined"
        in repr(hits)
    )


def test_damaged_recordings_do_not_end_a_search_however_many_there_are(tmp_path: Path) -> None:
    for number in range(20):
        (tmp_path / f"{number:02}").mkdir()
        (tmp_path / f"{number:02}" / "cut.bag").write_bytes(b"#ROSBAG V2.0\n")
    copy(robowidgets.SAMPLE, tmp_path / "whole.mcap")
    hits = find(NEAR, tmp_path)
    assert hits.is_complete
    assert len(hits.unread) == 20
    assert {Path(hit.file).name for hit in hits} == {"whole.mcap"}


@pytest.mark.slow
def test_a_recording_is_late_by_the_clock_of_the_search_once_its_process_has_started() -> None:
    clock = ManualClock()
    asleep = made("import time\ndef asleep(path):\n    while True: time.sleep(0.01)", "asleep")
    looks = []

    def idle() -> None:
        looks.append(clock.now())
        if len(looks) > 40:  # ten seconds, in which no time of the clock has passed
            clock.set(clock.now() + 700)

    ((_, _, problem, failure),) = each(asleep, ["a.mcap"], longest=600, idle=idle, clock=clock)
    assert (problem, failure) == ("took longer than 600 s", "took longer than 600 s")


@pytest.mark.parametrize(
    "line", [b"5", b"[1]", b'"x"', b'["state", 5]', b"\xff\xfe", b"00000000 [1, 2]", b"[" * 100_000], ids=repr
)
def test_an_odd_line_among_kept_results_is_left_out(runs: Path, own_cache: Path, line: bytes) -> None:
    expected = rows(find(NEAR, runs, executor=Here()))
    (kept,) = (own_cache / "find").iterdir()
    kept.write_bytes(kept.read_bytes() + line + b"\n")
    again = Here()
    assert rows(find(NEAR, runs, executor=again)) == expected
    assert again.ran == [str(runs / "broken.bag")]


STALE = {
    "attribute": "def near(scan): return scan.distance() < near.limit\nnear.limit = {}",
    "environment": "import os\nos.environ['LIMIT'] = '{}'\n"
    "def near(scan): return scan.distance() < float(os.environ['LIMIT'])",
    "default": "def near(scan, limit={}): return scan.distance() < limit",
}


@pytest.mark.parametrize("text", STALE.values(), ids=STALE)
def test_a_function_is_computed_again_whatever_changed(runs: Path, text: str) -> None:
    never, often = (
        find(made(text.format(limit), "near"), runs / "run_2.mcap", executor=Here()) for limit in (0.001, 0.6)
    )
    assert not never
    assert often


def test_a_file_that_took_the_place_of_one_with_its_size_and_time_is_read(runs: Path) -> None:
    path = runs / "run_2.mcap"
    first = find(NEAR, path, executor=Here())
    whole, before = path.read_bytes(), path.stat()
    path.write_bytes(bytes(len(whole)))
    os.utime(path, ns=(before.st_atime_ns, before.st_mtime_ns))
    hits = find(NEAR, path, executor=Here())
    assert first
    assert hits.unread


@pytest.mark.slow
def test_a_recording_that_takes_too_long_becomes_a_row(runs: Path) -> None:
    def hangs(moment: Any) -> bool:
        while True:
            time.sleep(0.01)

    hits = find(hangs, runs / "run_2.mcap", longest=0.2)
    assert [one.problem for one in hits.unread] == ["took longer than 0.2 s"]


def test_a_function_that_fails_names_the_recording_and_the_time(runs: Path) -> None:
    hits = find(lambda moment: moment.scan.ranges[100_000], runs / "run_2.mcap", executor=Here())
    assert "<lambda> failed at 0.00 s: IndexError" in hits.unread[0].problem


@pytest.mark.slow
def test_the_rows_match_single_searches_in_the_processes_of_a_script_without_a_main_guard(
    runs: Path, tmp_path: Path
) -> None:
    script = tmp_path / "search.py"
    script.write_text(
        "from robowidgets.fleet import find\n"
        "limit = 0.3\n"
        f"hits = find(lambda moment: moment.scan.distance() < limit, {str(runs)!r})\n"
        "print([tuple(hit) for hit in hits])\n"
        "print([tuple(one) for one in hits.unread])\n"
    )
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=True)
    found, ((unread, problem),) = map(ast.literal_eval, done.stdout.splitlines())
    files = [runs / "run_2.mcap", runs / "run_10.mcap", runs / "monday/run_1.mcap"]
    assert found == loop(files, lambda moment: moment.scan.distance() < 0.3)
    assert {row[1] for row in found} == {"/scan"}
    assert unread == str(runs / "broken.bag")
    assert "cut off" in problem


@pytest.mark.slow
def test_a_client_of_dask_runs_it(runs: Path) -> None:
    distributed = pytest.importorskip("distributed")
    with (
        distributed.LocalCluster(n_workers=1, threads_per_worker=2, processes=False, dashboard_address=None) as cluster,
        distributed.Client(cluster) as client,
    ):
        hits = find(lambda moment: moment.scan.distance() < 0.3, runs, executor=client, keep=False)
        assert rows(hits) == rows(find(lambda moment: moment.scan.distance() < 0.3, runs, executor=Here(), keep=False))


def test_the_table_has_the_same_rows_for_every_library(runs: Path, tmp_path: Path) -> None:
    import pyarrow.parquet

    hits = find(NEAR, runs, executor=Here())
    arrow = hits.to_arrow().to_pylist()
    assert [row["nearest"] for row in arrow] == [*(hit.nearest for hit in hits), None]
    assert arrow[-1]["file"] == str(runs / "broken.bag")
    assert arrow[-1]["problem"] == hits.unread[0].problem
    assert hits.to_polars().to_dicts() == arrow
    assert pyarrow.parquet.read_table(hits.to_parquet(tmp_path / "hits.parquet")).to_pylist() == arrow
    frame = hits.to_pandas()
    assert frame["index"].dropna().tolist() == [hit.index for hit in hits]
    assert frame["date"].dropna().tolist() == [hit.date for hit in hits if hit.date]
    lines = [json.loads(line) for line in hits.to_json().splitlines()]
    assert [line["start"] for line in lines[:-1]] == [hit.start for hit in hits]
    assert lines[-1] == {"file": str(runs / "broken.bag"), "problem": hits.unread[0].problem}


def test_pandas_has_the_same_types_whatever_was_found(runs: Path) -> None:
    every = find(NEAR, runs / "run_2.mcap", executor=Here()).to_pandas()
    some = find(NEAR, runs, executor=Here()).to_pandas()
    none = find(conditions.nearest_below(0.001), runs / "run_2.mcap", executor=Here()).to_pandas()
    unread = find(NEAR, runs / "broken.bag", executor=Here()).to_pandas()
    assert every.dtypes.to_dict() == some.dtypes.to_dict() == none.dtypes.to_dict() == unread.dtypes.to_dict()
    assert len(none) == 0 < len(unread) < len(some)
    assert none["date"].dt.year.tolist() == []
    assert str(some["date"].dt.tz) == "UTC"


def test_a_reason_loses_the_name_of_its_recording_and_no_other_word() -> None:
    problem = "{}: no /scan in {}. A scanner was lost"
    unread = [Unread(f"/runs/{name}", problem.format(f"/runs/{name}", name)) for name in ("scan", "a", "b.bag")]
    assert list(not_read(unread)) == ["not read: scan, a, b.bag: no /scan in . A scanner was lost"]


def test_a_command_in_a_reason_keeps_its_file_or_names_a_stand_in_for_several() -> None:
    problem = "{0}: a bag of format 1.2; `rosbag filter {0} new.bag True` writes it as 2.0, {0} stays"
    unread = [Unread(f"/runs/{name}", problem.format(name)) for name in ("a.bag", "b.bag")]
    assert list(not_read(unread[:1])) == [
        "not read: a.bag: a bag of format 1.2; `rosbag filter a.bag new.bag True` writes it as 2.0,  stays"
    ]
    assert list(not_read(unread)) == [
        "not read: a.bag, b.bag: a bag of format 1.2; `rosbag filter FILE new.bag True` writes it as 2.0,  stays"
    ]


def test_printed_it_names_files_without_their_common_folder_and_what_was_not_read(runs: Path) -> None:
    text = repr(find(NEAR, runs, executor=Here()))
    assert text.startswith("nearest below 0.3 m: ")
    assert "\n  monday/run_1.mcap  /scan" in text
    assert "\n! not read: broken.bag: " in text
    never = repr(find(conditions.nearest_below(0.001), runs, executor=Here()))
    assert never.startswith("nearest below 0.001 m: never in 3 files, 1 not searched\n")


def test_only_files_that_were_searched_are_counted_as_searched(runs: Path) -> None:
    some = repr(find(NEAR, runs, executor=Here())).splitlines()[0]
    assert some.endswith(" in 3 of 3 files, 1 not searched")
    none = repr(find(NEAR, runs / "broken.bag", runs / "missing.mcap", executor=Here())).splitlines()[0]
    assert none == "nearest below 0.3 m: none of 2 files searched"
    other = repr(find(conditions.nearest_below(0.3, topic="/rear"), runs, executor=Here())).splitlines()[0]
    assert other == "nearest below 0.3 m: none of 4 files searched"
    whole = repr(find(NEAR, runs / "run_2.mcap", executor=Here())).splitlines()[0]
    assert whole.endswith(" in 1 of 1 file")


def test_a_function_that_cannot_be_sent_is_refused_with_the_reason(runs: Path) -> None:
    lock = Event()
    with pytest.raises(TypeError, match="cannot be sent to another process: cannot pickle"):
        find(lambda moment: lock.is_set() and moment.scan, runs)


def test_files_and_urls_which_have_no_folder_in_common_are_named_whole() -> None:
    files = ["/runs/a.mcap", "s3://bucket/b.mcap"]
    hits = Hits(
        "near", [Hit(file, "/scan", 0.0, 1.0, 1.0, 0, 1) for file in files], chosen={}, problems={}, files=files
    )
    assert all(f"\n  {file}" in repr(hits) for file in files)


@pytest.mark.parametrize("executor", [3, object()])
def test_an_object_without_submit_is_not_an_executor(runs: Path, executor: Any) -> None:
    with pytest.raises(TypeError, match=r"executor: expected an object with submit\(\)"):
        find(NEAR, runs, executor=executor)


def test_a_list_and_an_empty_text_are_no_paths(monkeypatch: pytest.MonkeyPatch, runs: Path) -> None:
    monkeypatch.chdir(runs)
    with pytest.raises(ValueError, match=r'got an empty text; "\." is this folder'):
        find(NEAR, "")
    with pytest.raises(robowidgets.RecordingError, match=r'got an empty text; "\." is this folder'):
        robowidgets.open("")
    with pytest.raises(TypeError, match=r"got \['a.mcap'\]; give each path as an argument of its own: \*paths"):
        find(NEAR, ["a.mcap"])  # type: ignore[arg-type]


def test_no_condition_is_refused_before_anything_is_read(runs: Path) -> None:
    with pytest.raises(TypeError, match="condition: expected"):
        find("scan < 3", runs)  # type: ignore[arg-type]


@pytest.mark.slow
def test_the_command_prints_a_line_for_each_span_of_several_recordings(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    code = main(["find", str(runs), "--nearest-below", "0.3"])
    out, err = capsys.readouterr()
    hits = find(NEAR, runs, executor=Here())
    lines = out.splitlines()
    assert (code, lines[0]) == (0, "# file\ttopic\tstart\tend\tseconds\tnearest\tindex\tangle")
    assert [line.split("\t")[0] for line in lines[1:]] == [hit.file for hit in hits]
    assert f"! {runs / 'broken.bag'}: was cut off" in err
    assert main(["find", str(runs), "--nearest-below", "0.3", "--json"]) == 0
    assert capsys.readouterr().out == f"{hits.to_json()}\n"
    assert main(["find", str(runs / "run_2.mcap"), "--nearest-below", "0.001"]) == 1


def test_the_command_exits_with_2_if_no_recording_could_be_searched(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["find", str(tmp_path / "a.bag"), str(tmp_path / "b.bag"), "--touched"]) == 2
    assert "none of these recordings could be searched" in capsys.readouterr().err
