"""Any file by its first bytes, files in zstd, and the files of a folder."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import pytest

from robowidgets.messages.compression import plain, zstd
from robowidgets.repair import RecordingError, find_files, open_repaired

from ..recordings.written import messages, read, write_bag, write_db3, write_indexed_mcap


@pytest.fixture
def temporary(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The folder for temporary files, which has to be empty in the end."""
    folder = tmp_path / "temporary"
    folder.mkdir()
    monkeypatch.setattr(tempfile, "tempdir", str(folder))
    yield folder
    assert list(folder.iterdir()) == []


def files(folder: Path) -> list[Path]:
    held = messages(30)
    return [write_bag(folder / "a.bag", held), write_indexed_mcap(folder / "b", held), write_db3(folder / "c", held)]


def test_how_a_file_starts_decides_not_its_name(tmp_path: Path) -> None:
    for path in files(tmp_path):
        renamed = path.rename(tmp_path / "recording.data")
        assert read(open_repaired([renamed])) == messages(30)


def test_a_file_in_zstd_is_read_and_its_copy_removed(tmp_path: Path, temporary: Path) -> None:
    for path in files(tmp_path):
        packed = path.with_name(f"{path.name}.zstd")
        packed.write_bytes(zstd.compress(path.read_bytes()))
        source = open_repaired([packed])
        assert source.problems == ()
        assert read(source) == messages(30)
        source.close()
        source.close()


def test_zstd_that_is_cut_off_gives_what_comes_before(tmp_path: Path, temporary: Path) -> None:
    held = messages(2000)
    path = tmp_path / "cut.bag.zstd"
    packed = zstd.compress(write_bag(tmp_path / "cut.bag", held).read_bytes())
    path.write_bytes(packed[: len(packed) // 2])
    source = open_repaired([path])
    saved = read(source)
    assert 700 <= len(saved) <= 1000
    assert saved == held[: len(saved)]
    assert source.problems[0].startswith(f"the recording was cut off: read {len(saved)} messages")
    source.close()


def test_zstd_that_is_cut_off_after_the_recording_is_reported(tmp_path: Path, temporary: Path) -> None:
    path = tmp_path / "tail.bag.zstd"
    whole = zstd.compress(write_bag(tmp_path / "tail.bag", messages(30)).read_bytes())
    path.write_bytes(whole + zstd.compress(bytes(1000))[:-3])
    source = open_repaired([path])
    assert read(source) == messages(30)
    assert len(source.problems) == 1
    source.close()


@pytest.mark.parametrize(
    ("raw", "why"),
    [
        (zstd.compress(b"hello robot")[:9], r"x\.db3\.zstd: its zstd data is damaged or cut off at its start"),
        (zstd.compress(zstd.compress(b"hello")), r"x\.db3\.zstd: expected a recording in zstd, got zstd within zstd"),
        (
            zstd.compress(b"hello robot"),
            r"x\.db3: expected a rosbag2 database \(\.db3\), got text that starts with 'hello",
        ),
        (b"\x7fELF\x02\x01", r"x\.db3\.zstd: expected a ROS 1 bag, an MCAP file or a rosbag2 database, got bytes that"),
    ],
)
def test_zstd_of_anything_else_is_named_and_leaves_nothing_behind(
    tmp_path: Path, temporary: Path, raw: bytes, why: str
) -> None:
    path = tmp_path / "x.db3.zstd"
    path.write_bytes(raw)
    with pytest.raises(RecordingError, match=why):
        open_repaired([path])


def test_zstd_that_unpacks_to_more_than_a_disk_is_stopped(
    tmp_path: Path, temporary: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("robowidgets.repair._open._MOST_UNPACKED", 1 << 21)
    path = tmp_path / "bomb.bag.zstd"
    held = messages(30)
    path.write_bytes(zstd.compress(write_bag(tmp_path / "bomb.bag", held).read_bytes() + bytes(1 << 28)))
    source = open_repaired([path])
    assert sum(file.stat().st_size for file in temporary.rglob("*.bag")) <= 256 * path.stat().st_size + (1 << 21)
    assert read(source) == held
    source.close()


def test_a_message_in_zstd_becomes_plain_and_any_other_stays() -> None:
    assert plain(zstd.compress(b"\0\1\0\0data")) == b"\0\1\0\0data"
    assert plain(b"\0\1\0\0data") == b"\0\1\0\0data"
    cut = zstd.compress(b"\0\1\0\0data")[:-2]
    assert plain(cut) == cut


def test_files_of_a_folder_come_in_natural_order(tmp_path: Path) -> None:
    names = [
        "drive_0.db3",
        "drive_2.db3",
        "drive_10.db3",
        "drive_10.mcap",
        "other.bag",
        "other.db3.zstd",
        "other.mcap.zst",
    ]
    for name in [*names, "metadata.yaml", "drive_0.db3-wal", "notes.zst", "photo.png"]:
        (tmp_path / name).touch()
    (tmp_path / "folder.mcap").mkdir()
    assert [path.name for path in find_files(tmp_path)] == names


def test_a_missing_file_is_reported_and_the_rest_is_read(tmp_path: Path) -> None:
    held = messages(30)
    source = open_repaired([tmp_path / "drive_0.bag", write_bag(tmp_path / "drive_1.bag", held)])
    assert read(source) == held
    assert source.problems == ("drive_0.bag: cannot be opened: No such file or directory",)
