"""Each hit as a file of its own, in Python and by the command."""

from __future__ import annotations

import json
from pathlib import Path
from shutil import copy

import pytest
from mcap.reader import make_reader

import robowidgets
from robowidgets import RecordingError, conditions, fleet
from robowidgets.command import main

NEAR = conditions.nearest_below(0.2)


def messages(path: Path) -> list[tuple[str, int, bytes]]:
    with path.open("rb") as file:
        found = make_reader(file).iter_messages()
        return sorted((channel.topic, message.log_time, message.data) for _, channel, message in found)


def test_each_hit_is_a_file_with_the_messages_around_it(runs: Path, tmp_path: Path) -> None:
    hits = fleet.find(NEAR, runs)
    assert len(hits) == 18
    paths = hits.to_mcap(tmp_path / "out" / "cuts", around=1)
    assert len(paths) == len(set(paths)) == len(list((tmp_path / "out/cuts").iterdir()))
    assert {path.name.rpartition("_")[0] for path in paths} == {"run_2", "run_10", "monday_run_1"}
    everything = messages(robowidgets.SAMPLE)
    for hit, path in zip(hits, paths, strict=True):
        first, last = hit.start_ns - 10**9, hit.end_ns + 10**9
        assert messages(path) == [one for one in everything if first <= one[1] <= last]
        with robowidgets.open(path) as cut:
            around = [span.start_ns for span in cut.find(NEAR)]
            assert hit.start_ns in around
            assert cut.problems == ()


def test_hits_of_one_start_get_a_name_each(tmp_path: Path) -> None:
    hits = fleet.find(NEAR, robowidgets.SAMPLE)[:1]
    twice = fleet.Hits("near", [*hits, *hits], chosen={}, problems={}, files=hits.files)
    paths = twice.to_mcap(tmp_path, around=0)
    assert [path.name for path in paths] == [f"sample_{hits[0].start:.3f}s.mcap", f"sample_{hits[0].start:.3f}s_2.mcap"]


def test_existing_files_stay_and_nothing_is_written_then(tmp_path: Path) -> None:
    hits = fleet.find(NEAR, robowidgets.SAMPLE)
    (there,) = hits[2:3].to_mcap(tmp_path)
    before = there.read_bytes()
    there.write_bytes(b"kept")
    with pytest.raises(FileExistsError, match=f"1 of {len(hits)} files; name another folder, or give overwrite=True"):
        hits.to_mcap(tmp_path)
    assert [path.read_bytes() for path in tmp_path.iterdir()] == [b"kept"]
    hits.to_mcap(tmp_path, overwrite=True)
    assert there.read_bytes() == before
    assert len(list(tmp_path.iterdir())) == len(hits)


def test_what_cannot_be_written_is_refused(tmp_path: Path) -> None:
    file = copy(robowidgets.SAMPLE, tmp_path / "drive.mcap")
    hits = fleet.find(NEAR, file)
    with pytest.raises(ValueError, match="around: expected seconds"):
        hits.to_mcap(tmp_path / "cuts", around=-1)
    with pytest.raises(TypeError, match="expected the path of a folder, got 3"):
        hits.to_mcap(3)  # type: ignore[arg-type]
    with pytest.raises(NotADirectoryError, match="is a file; name a folder"):
        hits.to_mcap(file)
    with pytest.raises(ValueError, match="nothing was found"):
        hits[:0].to_mcap(tmp_path / "cuts")
    assert not (tmp_path / "cuts").exists()
    Path(file).unlink()
    with pytest.raises(RecordingError, match="no such file"):
        hits.to_mcap(tmp_path / "cuts")


def test_the_command_writes_what_it_finds(runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = str(tmp_path / "cuts")
    file = str(runs / "run_2.mcap")
    assert main(["find", file, "--nearest-below", "0.2", "--cut", out, "--around", "1", "--json"]) == 0
    said = capsys.readouterr()
    hits = [json.loads(line) for line in said.out.splitlines()]
    assert f"Wrote {len(hits)} files into {out}" in said.err
    assert len(list(Path(out).iterdir())) == len(hits) == 6
    assert main(["find", str(runs), "--nearest-below", "0.2", "--cut", out]) == 2
    assert "or replace it with --force" in capsys.readouterr().err
    assert main(["find", str(runs), "--nearest-below", "0.01", "--cut", str(tmp_path / "none")]) == 1
    assert not (tmp_path / "none").exists()
    assert main(["find", file, "--nearest-below", "0.2", "--around", "1"]) == 2
    assert "--around and --force need --cut" in capsys.readouterr().err
    assert main(["find", file, "--nearest-below", "0.2", "--cut", out, "--around", "-1", "--force"]) == 2
    assert "find: --around: expected seconds" in capsys.readouterr().err
