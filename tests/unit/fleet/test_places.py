"""The recordings that paths name."""

from __future__ import annotations

import os
from pathlib import Path
from shutil import copy

import pytest

import robowidgets
from robowidgets.fleet.places import NamedPath, places_of

from ..recordings.written import messages, write_bag

DATA = Path(os.environ.get("ROBOWIDGETS_DATA", Path(__file__).parents[4] / "shared" / "data"))


def test_a_folder_names_all_recordings_in_it_at_any_depth_with_numbers_in_their_order(runs: Path) -> None:
    names = [str(place.path.relative_to(runs)) for place in places_of([runs])]
    assert names == ["broken.bag", "run_2.mcap", "run_10.mcap", "monday/run_1.mcap"]


def test_each_recording_counts_once_however_often_it_is_named(runs: Path) -> None:
    (runs / "link.mcap").symlink_to(runs / "run_2.mcap")
    named = places_of([runs / "run_2.mcap", str(runs / "run_*.mcap"), runs])
    assert [place.path.name for place in named] == ["run_2.mcap", "run_10.mcap", "broken.bag", "run_1.mcap"]


def test_a_pattern_goes_to_any_depth(runs: Path) -> None:
    assert len(places_of([str(runs / "**" / "*.mcap")])) == 3


def test_what_is_not_there_is_named_with_the_reason(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    there = places_of([tmp_path / "no.bag", str(tmp_path / "*.mcap"), tmp_path / "empty"])
    assert there == [
        NamedPath(tmp_path / "no.bag", "no such file or folder"),
        NamedPath(tmp_path / "*.mcap", "nothing matches this pattern"),
        NamedPath(tmp_path / "empty", "no recording in this folder"),
    ]


def test_the_metadata_of_a_folder_names_the_folder(tmp_path: Path) -> None:
    copy(robowidgets.SAMPLE, tmp_path / "drive_0.mcap")
    (tmp_path / "metadata.yaml").write_text("rosbag2_bagfile_information:\n")
    assert places_of([tmp_path / "metadata.yaml", tmp_path]) == [NamedPath(tmp_path)]


def test_logs_of_other_programs_are_not_recordings(tmp_path: Path) -> None:
    (tmp_path / "roslaunch.log").write_text("started core service\n")
    (tmp_path / "carmen.log").write_text("# a comment\nODOM 0 0 0 0 0 0 1.0 host 1.0\n")
    assert places_of([tmp_path]) == [NamedPath(tmp_path / "carmen.log")]


@pytest.mark.skipif(not DATA.is_dir(), reason="needs the recordings of real robots")
def test_the_parts_of_a_recording_are_one(tmp_path: Path) -> None:
    parts = next(folder for folder in (DATA / "odd").iterdir() if folder.name == "mcap_multiple_files_no_metadata")
    (tmp_path / "split").symlink_to(parts)  # the named folder may be a link
    assert places_of([tmp_path / "split"]) == [NamedPath(tmp_path / "split")]


@pytest.mark.parametrize(("given", "error"), [([], ValueError), ([3], TypeError)])
def test_no_path_is_refused(given: list[object], error: type[Exception]) -> None:
    with pytest.raises(error, match="expected"):
        places_of(given)  # type: ignore[arg-type]


def test_a_folder_names_bags_of_killed_recorders_and_those_in_capital_letters(tmp_path: Path) -> None:
    names = ["DRIVE.BAG", "drive_1.bag", "drive_2.bag.active", "drive_3.mcap.zst"]
    for name in [*names, "drive.bag.txt", ".bag", "drive.active"]:
        (tmp_path / name).write_bytes(b"#ROSBAG V2.0\n")
    assert [place.path.name for place in places_of([tmp_path])] == names


def test_the_last_part_of_a_bag_may_be_from_a_killed_recorder(tmp_path: Path) -> None:
    held = messages(60)
    write_bag(tmp_path / "drive_0.bag", held[:30])
    write_bag(tmp_path / "drive_1.bag.active", held[30:])
    assert places_of([tmp_path]) == [NamedPath(tmp_path)]
    with robowidgets.open(tmp_path) as recording:
        assert sum(topic.count for topic in recording.topics) == 60


def test_metadata_of_another_kind_make_no_recording_of_a_folder(tmp_path: Path) -> None:
    later = [(topic, time_ns + 30_000 * 10**9, data) for topic, time_ns, data in messages(30)]
    (tmp_path / "deeper").mkdir()
    for path, held in (("morning.bag", messages(30)), ("evening.bag", later), ("deeper/noon.bag", messages(30))):
        write_bag(tmp_path / path, held)
    (tmp_path / "metadata.yaml").write_text("license: CC-BY-4.0\nauthors: [somebody]\n")
    assert [place.path.name for place in places_of([tmp_path])] == ["evening.bag", "morning.bag", "noon.bag"]
    with pytest.raises(
        robowidgets.RecordingError, match=r"2 recordings in this folder: open one of them: evening\.bag"
    ):
        robowidgets.open(tmp_path)
