"""The names that users give to spans of recordings."""

from __future__ import annotations

import json
from math import nan
from pathlib import Path
from shutil import copy

import pytest

import robowidgets
from robowidgets import RecordingError, conditions
from robowidgets.fleet import find
from robowidgets.recordings.labels import FILE

from ..fleet.executors import Here
from . import recorded, robot


@pytest.fixture
def drive(tmp_path: Path) -> Path:
    for name in ("drive.mcap", "other.mcap"):
        copy(robowidgets.SAMPLE, tmp_path / name)
    return tmp_path / "drive.mcap"


def test_a_label_is_kept_next_to_the_recording_read_again_and_searched(drive: Path, tmp_path: Path) -> None:
    with robowidgets.open(drive) as recording:
        assert recording.labels == ()
        recording.label("door", 12.0, 14.5)
        recording.label(" narrow  door ", 3.0, 5.0)
        recording.label("door", 14.0, 15.0)
    with robowidgets.open(drive) as recording, robowidgets.open(tmp_path / "other.mcap") as other:
        assert [one[:3] for one in recording.labels] == [
            ("narrow door", 3.0, 5.0),
            ("door", 12.0, 14.5),
            ("door", 14.0, 15.0),
        ]
        assert other.labels == ()
        assert [span[:2] for span in recording.find(conditions.label("door"))] == [(12.0, 15.0)]
        assert [span[:2] for span in recording.find(conditions.label())] == [(3.0, 5.0), (12.0, 15.0)]
        near = conditions.nearest_below(0.3)
        inside = [span.start for span in recording.find(near) if 12 <= span.start < 15]
        assert [span.start for span in recording.find(conditions.label("door") & near)] == inside


def test_a_search_of_many_recordings_sees_a_label_that_was_given_since(drive: Path) -> None:
    def found() -> list[tuple[str, float]]:
        return [(Path(hit.file).name, hit.start) for hit in find(conditions.label("door"), drive, executor=Here())]

    assert found() == []
    with robowidgets.open(drive) as recording:
        recording.label("door", 12.0, 14.5)
    assert found() == [("drive.mcap", 12.0)]


def test_a_label_that_was_taken_away_is_gone_its_line_stays_and_it_can_be_given_again(drive: Path) -> None:
    with robowidgets.open(drive) as recording, robowidgets.open(drive) as other:
        door = recording.label("door", 1.0, 2.0)
        wall = recording.label("wall", 1.0, 2.0)
        before = (drive.parent / FILE).read_bytes()
        other.remove_label(door)
        assert recording.labels == (wall,)
        assert list(recording.find(conditions.label("door"))) == []
        with pytest.raises(ValueError, match="has no Label"):
            recording.remove_label(door)
        assert (drive.parent / FILE).read_bytes().startswith(before)
        recording.label("door", 1.0, 2.0)
        assert recording.labels == (wall, door)


def test_a_damaged_line_is_reported_and_stays_and_the_others_are_read(drive: Path) -> None:
    file = drive.parent / FILE
    with robowidgets.open(drive) as recording:
        recording.label("door", 1.0, 2.0)
        cut = file.read_bytes() + b'{"file": "drive.mcap", "label": "wi'
        file.write_bytes(cut)
        recording.label("wall", 3.0, 4.0)
        with file.open("a") as lines:
            for start, name in ((-1.0, "early"), (nan, "never"), (1.0, " ")):
                line = {"file": "drive.mcap", "label": name, "start": start, "end": 2.0, "start_ns": 1, "end_ns": 2}
                lines.write(f"{json.dumps(line)}\n[1]\n")
        assert [one.label for one in recording.labels] == ["door", "wall"]
        assert sum("not a label" in line and FILE in line for line in recording.problems) == 7
    assert file.read_bytes().startswith(cut)


def test_an_edited_line_means_the_same_to_labels_and_to_a_search(drive: Path) -> None:
    file = drive.parent / FILE
    with robowidgets.open(drive) as recording:
        recording.label("door", 1.0, 2.0)
        file.write_text(file.read_text().replace("1.0", "3.0").replace("2.0", "4.0"))
        (door,) = recording.labels
        assert door[:3] == ("door", 3.0, 4.0)
        assert recording.start_ns is not None
        assert (door.start_ns - recording.start_ns, door.end_ns - recording.start_ns) == (3 * 10**9, 4 * 10**9)
        assert [span[:2] for span in recording.find(conditions.label("door"))] == [(3.0, 4.0)]
        recording.remove_label(door)
        assert recording.labels == ()


@pytest.mark.parametrize("end", ["1e999", "1e300", "1" + 400 * "0"])
def test_a_time_without_nanoseconds_is_not_the_time_of_a_label(drive: Path, end: str) -> None:
    (drive.parent / FILE).write_text(f'{{"file": "drive.mcap", "label": "door", "start": 1, "end": {end}}}\n')
    with robowidgets.open(drive) as recording:
        assert recording.labels == ()
        assert any("line 1" in line and "not a label" in line for line in recording.problems)
        with pytest.raises(ValueError, match="at most 1e"):
            recording.label("door", 1.0, 1e300)


def test_labels_match_the_recording_however_its_path_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    speeds = [(float(second), "/speed", {"linear": {"x": 1.0}}) for second in (0, 9)]
    run = recorded.write(tmp_path / "run", {"/speed": "geometry_msgs/msg/Twist"}, speeds)
    (run / "inside").mkdir()
    monkeypatch.chdir(run)
    for number, path in enumerate((run / "metadata.yaml", Path("inside/.."), Path(".")), start=1):
        with robowidgets.open(path) as recording:
            assert recording.path == run
            recording.label(f"door {number}", number, number + 0.5)
            assert len(recording.labels) == number
        for named in (path, run, tmp_path):
            assert [hit.start for hit in find(conditions.label(f"door {number}"), named, executor=Here())] == [number]
    assert (tmp_path / FILE).exists()


def test_a_folder_above_a_link_is_the_one_of_its_target(tmp_path: Path) -> None:
    (tmp_path / "disk" / "day").mkdir(parents=True)
    copy(robowidgets.SAMPLE, tmp_path / "disk" / "drive.mcap")
    (tmp_path / "today").symlink_to(tmp_path / "disk" / "day", target_is_directory=True)
    with robowidgets.open(tmp_path / "today" / ".." / "drive.mcap") as recording:
        assert recording.path == tmp_path / "disk" / "drive.mcap"


def test_what_is_not_a_label_is_refused(drive: Path) -> None:
    with robowidgets.open(drive) as recording:
        with pytest.raises(TypeError, match="expected a name"):
            recording.label(3, 1.0, 2.0)  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="expected a name"):
            recording.label(" ", 1.0, 2.0)
        with pytest.raises(ValueError, match=r"label: expected \(start, end\) in seconds, 0 <= start < end"):
            recording.label("door", 3.0, 2.0)
        with pytest.raises(ValueError, match=r"label: expected a start within the 58\.00 s of .*, got 12000"):
            recording.label("door", 12_000, 14_500)  # milliseconds
        (drive.parent / FILE).mkdir()
        with pytest.raises(RecordingError, match="the label cannot be saved"):
            recording.label("door", 1.0, 2.0)


def labels_of(path: Path) -> list[tuple[str, float, float]]:
    with robowidgets.open(path) as recording:
        return [one[:3] for one in recording.labels]


def complaints(path: Path) -> list[str]:
    with robowidgets.open(path) as recording:
        recording.labels  # noqa: B018  # they are read then
        return [line for line in recording.problems if line.startswith("labels: ")]


DOOR = ("door", 12.0, 14.5)


@pytest.fixture
def labelled(tmp_path: Path) -> Path:
    """A recording with a label, and another one next to it."""
    copy(robowidgets.SAMPLE, tmp_path / "drive.mcap")
    robot.write(tmp_path / "other")
    with robowidgets.open(tmp_path / "drive.mcap") as recording:
        recording.label(*DOOR)
    return tmp_path / "drive.mcap"


def test_labels_follow_a_recording_that_is_renamed(labelled: Path) -> None:
    renamed = labelled.rename(labelled.with_name("monday.mcap"))
    assert labels_of(renamed) == [DOOR]
    assert labels_of(labelled.parent / "other") == []
    assert complaints(renamed) == complaints(labelled.parent / "other") == []
    assert [Path(hit.file).name for hit in find(conditions.label("door"), labelled.parent, executor=Here())] == [
        "monday.mcap"
    ]
    hits = find(conditions.label("door"), renamed, executor=Here())
    with robowidgets.open(renamed) as recording:
        wall = recording.label("wall", 20.0, 21.0)
        recording.remove_label(recording.labels[0])
        assert recording.labels == (wall,)
    again = renamed.rename(labelled.with_name("tuesday.mcap"))
    assert labels_of(again) == [wall[:3]]
    again.unlink()
    assert ["1 label of monday.mcap" in line for line in complaints(labelled.parent / "other")] == [True]
    assert len(hits) == 1


def test_labels_follow_a_folder_that_is_renamed(tmp_path: Path) -> None:
    with robowidgets.open(robot.write(tmp_path / "drive")) as recording:
        recording.label("door", 1.0, 2.0)
    (tmp_path / "drive").rename(tmp_path / "monday")
    assert labels_of(tmp_path / "monday") == [("door", 1.0, 2.0)]


def test_a_copy_has_no_labels_of_its_original_until_that_is_gone(labelled: Path) -> None:
    twin = Path(copy(labelled, labelled.with_name("twin.mcap")))
    assert (labels_of(labelled), labels_of(twin)) == ([DOOR], [])
    labelled.unlink()
    assert labels_of(twin) == [DOOR]


def test_another_recording_under_the_old_name_does_not_get_the_labels(labelled: Path, tmp_path: Path) -> None:
    renamed = labelled.rename(labelled.with_name("monday.mcap"))
    (other,) = (tmp_path / "other").glob("*.mcap")
    copy(other, labelled)
    assert (labels_of(labelled), labels_of(renamed)) == ([], [DOOR])
    assert complaints(labelled) == complaints(renamed) == []
    renamed.unlink()
    (line,) = complaints(labelled)
    assert line.startswith("labels: labels.jsonl has 1 label of an earlier drive.mcap, which is gone")


def test_a_recording_that_was_still_growing_keeps_its_labels(tmp_path: Path) -> None:
    whole = robowidgets.SAMPLE.read_bytes()
    path = tmp_path / "drive.mcap"
    path.write_bytes(whole[: len(whole) * 3 // 4])
    with robowidgets.open(path) as recording:
        recording.label("door", 1.0, 2.0)
    path.write_bytes(whole)
    assert labels_of(path) == [("door", 1.0, 2.0)]


def test_labels_of_a_recording_that_is_gone_are_reported_and_stay_in_the_file(labelled: Path) -> None:
    file, other = labelled.with_name(FILE), labelled.parent / "other"
    old = {"file": "older.bag", "label": "wall", "start": 1.0, "end": 2.0}
    file.write_text(file.read_text() + json.dumps(old) + "\n")
    assert complaints(other) == [
        "labels: labels.jsonl has 1 label of older.bag, which is gone: give it its name back, or remove the lines"
    ]
    before = file.read_bytes()
    labelled.unlink()
    assert ["drive.mcap" in line for line in complaints(other)] == [True, False]
    assert file.read_bytes() == before
    file.write_text(
        file.read_text()
        + "".join(json.dumps({**json.loads(line), "removed": True}) + "\n" for line in before.splitlines() if line)
    )
    assert complaints(other) == []
