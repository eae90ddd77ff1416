"""Watching folders for new recordings, in Python and by the command."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from shutil import copy
from typing import Any

import pytest

import robowidgets
from robowidgets import conditions, fleet
from robowidgets.command import main
from robowidgets.fleet import Hits, _engine, _gather, follow, following
from robowidgets.runtime.clock import RealClock

from ..recordings import recorded, written

NEAR = conditions.nearest_below(0.2)
Step = Callable[[], object]


class Script(RealClock):
    """A clock whose sleeps do the next step of a test, and then an interrupt.

    Args:
        steps: a function for each sleep, or None to do nothing.
    """

    def __init__(self, *steps: Step | None) -> None:
        self._steps = iter(steps)
        self.time = 100.0

    def now(self) -> float:  # type: ignore[override]
        return self.time

    def sleep(self, seconds: float) -> None:  # type: ignore[override]
        self.time += seconds
        try:
            step = next(self._steps)
        except StopIteration:
            raise KeyboardInterrupt from None
        if step:
            step()


def interrupted(watched: Iterator[Hits]) -> list[Hits]:
    """The results up to the interrupt."""
    found: list[Hits] = []
    try:
        for hits in watched:
            found.append(hits)  # noqa: PERF402  # extend() would lose them with the interrupt
    except KeyboardInterrupt:
        return found
    pytest.fail("it ended by itself")


def names(found: list[Hits]) -> list[list[str]]:
    return [[Path(file).name for file in hits.files] for hits in found]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "runs").mkdir()
    return tmp_path / "runs"


@pytest.fixture
def output(tmp_path: Path) -> Path:
    return tmp_path / "drives.parquet"


def test_each_new_recording_is_indexed_and_searched_once_and_not_again_after_a_new_start(
    folder: Path, output: Path
) -> None:
    def add(name: str) -> Step:
        return lambda: (folder / name).parent.mkdir(exist_ok=True) or copy(robowidgets.SAMPLE, folder / name)

    copy(robowidgets.SAMPLE, folder / "run_1.mcap")
    clock = Script(None, add("run_2.mcap"), None, None, add("deeper/run_3.mcap"), None, None)
    found = interrupted(follow(NEAR, folder, output=output, clock=clock))
    assert names(found) == [["run_1.mcap"], ["run_2.mcap"], ["run_3.mcap"]]
    plain = fleet.find(NEAR, *(folder / name for name in ("run_1.mcap", "run_2.mcap", "deeper/run_3.mcap")))
    assert [hit for hits in found for hit in hits] == list(plain)
    assert {*fleet.drives(output).files} == {*plain.files}
    assert interrupted(follow(NEAR, folder, output=output, clock=Script(None, None, None))) == []
    again = interrupted(follow(NEAR, folder, output=output, clock=Script(add("run_4.mcap"), None, None)))
    assert names(again) == [["run_4.mcap"]]
    assert len(fleet.drives(output).files) == 4


def parts_of(path: Path) -> tuple[bytes, bytes]:
    raw = path.read_bytes()
    return raw[: len(raw) // 2], raw[len(raw) // 2 :]


@pytest.mark.parametrize("kind", ["mcap", "bag", "db3"])
def test_a_file_that_still_grows_is_taken_once_it_is_whole(
    kind: str, folder: Path, output: Path, tmp_path: Path
) -> None:
    anything = ~conditions.gap(1e6, "/scan")
    (source := tmp_path / "source").mkdir()
    if kind == "bag":
        path = written.write_bag(source / "drive.bag", written.messages())
    else:
        write = written.write_db3 if kind == "db3" else written.write_indexed_mcap
        path = write(source / "drive", written.messages())
    first, rest = parts_of(path)
    target = folder / path.name

    def write_first() -> None:
        target.write_bytes(first)

    def write_rest() -> None:
        with target.open("ab") as file:
            file.write(rest)

    clock = Script(write_first, None, None, None, write_rest)
    watched = follow(anything, folder, output=output, clock=clock)
    assert interrupted(watched) == [], "whole, but seen for the first time"
    assert not output.exists()
    found = interrupted(follow(anything, folder, output=output, clock=Script(None, None)))
    assert names(found) == [[path.name]]
    assert fleet.drives(output).unread == ()


@pytest.mark.skipif(not sys.platform.startswith("linux"), reason="only Linux shows that a file is open for writing")
def test_a_file_that_a_program_has_open_for_writing_is_not_taken(folder: Path, output: Path) -> None:
    copy(robowidgets.SAMPLE, folder / "drive.mcap")
    with (folder / "drive.mcap").open("ab"):
        assert interrupted(follow(NEAR, folder, output=output, clock=Script(None, None, None))) == []
    assert names(interrupted(follow(NEAR, folder, output=output, clock=Script(None, None)))) == [["drive.mcap"]]


def test_a_recording_whose_recorder_was_killed_is_read_as_it_is_after_a_minute_and_whole_again_if_it_comes(
    folder: Path, output: Path
) -> None:
    target = folder / "drive.mcap"
    whole = robowidgets.SAMPLE.read_bytes()
    target.write_bytes(whole[: len(whole) * 3 // 4])

    def check() -> None:
        assert not output.exists()

    clock = Script(*[check] * 11, None, None, lambda: target.write_bytes(whole), None, None)
    found = interrupted(follow(NEAR, folder, output=output, clock=clock))
    assert names(found) == [["drive.mcap"], ["drive.mcap"]]
    assert found[0].problems
    assert not found[1].problems
    hits = [hit for hits in found for hit in hits]
    assert len({hit.start_ns for hit in hits[len(found[0]) :]} - {hit.start_ns for hit in found[0]}) > 0
    assert len({(hit.start_ns, hit.end_ns) for hit in hits}) == len(hits), "no hit comes twice"


def test_a_folder_of_rosbag2_is_one_recording_once_its_metadata_is_there(folder: Path, output: Path) -> None:
    drive = recorded.write(folder / "drive", {"/log": "std_msgs/msg/String"}, [(0.0, "/log", {"data": "hit"})])
    metadata = (drive / "metadata.yaml").read_text()
    (drive / "drive.mcap").rename(drive / "drive_0.mcap")
    (drive / "metadata.yaml").unlink()
    event = conditions.event("/log")

    def finish() -> None:
        (drive / "metadata.yaml").write_text(metadata.replace("drive.mcap", "drive_0.mcap"))

    found = interrupted(follow(event, folder, output=output, clock=Script(None, None, None)))
    assert found == []
    found = interrupted(follow(event, folder, output=output, clock=Script(finish, None, None)))
    assert names(found) == [["drive"]]
    assert len(found[0]) == 1


def test_a_recording_that_cannot_be_read_is_named_with_the_reason(folder: Path, output: Path) -> None:
    (folder / "broken.mcap").write_bytes(b"\x89MCAP0\r\n" * 2)
    (hits,) = interrupted(follow(NEAR, folder, output=output, clock=Script(None, None)))
    assert [Path(one.file).name for one in hits.unread] == ["broken.mcap"]


def test_a_recording_that_is_removed_leaves_the_index_with_the_next_one(folder: Path, output: Path) -> None:
    copy(robowidgets.SAMPLE, folder / "run_1.mcap")

    def change() -> None:
        (folder / "run_1.mcap").unlink()
        copy(robowidgets.SAMPLE, folder / "run_2.mcap")

    interrupted(follow(NEAR, folder, output=output, clock=Script(None, change, None, None)))
    assert [Path(file).name for file in fleet.drives(output).files] == ["run_2.mcap"]


@pytest.mark.parametrize("during", ["search", "index"])
def test_an_interrupt_keeps_the_earlier_index_and_no_hit_is_lost(
    during: str, folder: Path, output: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    copy(robowidgets.SAMPLE, folder / "run_1.mcap")
    interrupted(follow(NEAR, folder, output=output, clock=Script(None, None)))
    copy(robowidgets.SAMPLE, folder / "run_2.mcap")
    calls: list[str] = []

    def each(job: Any, *arguments: Any, **options: Any) -> Iterator[Any]:
        calls.append(type(job).__name__.strip("_").lower())
        if calls[-1] == during:
            raise KeyboardInterrupt
        yield from _engine.each(job, *arguments, **options)

    with monkeypatch.context() as patch:
        patch.setattr(_gather, "each", each)
        found = interrupted(follow(NEAR, folder, output=output, clock=Script(None, None, None)))
    assert calls == ["search", "index"][: 1 + (during == "index")], "it ended at once"
    assert sum(map(len, found)) == (6 if during == "index" else 0)
    assert [path.name for path in output.parent.iterdir() if path.suffix == ".part"] == []
    assert str(folder / "run_1.mcap") in fleet.drives(output).files
    found = interrupted(follow(NEAR, folder, output=output, clock=Script(None, None)))
    assert names(found) == [["run_2.mcap"]]
    assert len(found[0]) == 6


def test_wrong_arguments_are_refused_at_once(folder: Path, output: Path) -> None:
    for arguments, options, error, text in (
        ((NEAR,), {}, ValueError, "got none"),
        ((NEAR, 3), {}, TypeError, "got 3"),
        ((NEAR, folder / "none"), {}, FileNotFoundError, "no such file or folder; make the folder"),
        ((NEAR, folder), {"every": 0}, ValueError, "every: expected seconds above 0"),
        (("near", folder), {}, TypeError, "condition"),
        ((NEAR, folder), {"output": "drives.csv"}, ValueError, r"ends in \.parquet"),
    ):
        with pytest.raises(error, match=text):
            follow(*arguments, **{"output": output, **options})  # type: ignore[arg-type]


def test_the_command_prints_a_line_for_each_hit_and_its_code_is_that_of_an_alarm(
    folder: Path, output: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    copy(robowidgets.SAMPLE, folder / "run_1.mcap")
    (folder / "broken.mcap").write_bytes(b"\x89MCAP0\r\n" * 2)
    hits = fleet.find(NEAR, folder / "run_1.mcap")
    near = ["index", str(folder), "-o", str(output), "--follow", "--nearest-below"]

    def run(*arguments: str, steps: tuple[Step | None, ...] = (None, None)) -> tuple[int, list[str], str]:
        monkeypatch.setattr(following, "RealClock", lambda: Script(*steps))
        code = main([*near, *arguments])
        said = capsys.readouterr()
        return code, said.out.splitlines(), said.err

    code, out, err = run("0.01")
    assert (code, len(out)) == (1, 1), "nothing was found"
    assert "Ended: 0 spans found" in err
    os.remove(output)
    code, out, err = run("0.2")
    assert (code, len(out)) == (0, 1 + len(hits))
    assert "broken.mcap: " in err
    assert f"Ended: {len(hits)} spans found; {output} has the recordings so far" in err
    add = lambda: copy(robowidgets.SAMPLE, folder / "run_2.mcap")  # noqa: E731
    (folder / "broken.mcap").write_bytes(b"\x89MCAP0\r\n" * 3)
    code, out, err = run("0.2", "--first", "--json", "--every", "1", steps=(add, None, None, None))
    assert code == 0
    (problem,) = [line for line in map(json.loads, out) if "problem" in line]
    out = [line for line in out if "problem" not in line]
    assert Path(problem["file"]).name == "broken.mcap"
    assert [json.loads(line)["start"] for line in out] == [hit.start for hit in hits]
    assert "Ended" not in err
    for arguments, text in (
        (["--nearest-below", "0.2"], "index: --nearest-below needs --follow"),
        (["--every", "3"], "index: --every needs --follow"),
        (["--follow"], "index: expected a condition"),
        (["--follow", "--gap", "1", "--every", "-1"], "index: every: expected seconds above 0"),
    ):
        assert main(["index", str(folder), "-o", str(output), *arguments]) == 2
        assert text in capsys.readouterr().err
