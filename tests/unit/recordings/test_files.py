"""The meaning of a path, and the errors for one without a recording."""

from __future__ import annotations

import gc
import gzip
import heapq
import io
import os
import re
import shutil
import sqlite3
import sys
import tarfile
from collections.abc import Callable, Iterator
from contextlib import closing
from itertools import zip_longest
from pathlib import Path
from types import SimpleNamespace

import pytest
import rosbags.rosbag1.reader

from robowidgets import SAMPLE
from robowidgets.files import open_source
from robowidgets.files._fallback import FallbackSource
from robowidgets.messages.compression import zstd
from robowidgets.recording import open
from robowidgets.recordings import RecordingError

from . import topics
from .written import START_NS, STEP_NS, Message, messages, write_bag, write_db3, write_indexed_mcap

LOG = b"\n".join(f"ODOM 1 2 0.5 0.{i} 0.1 0 {i}.0 host {i}.0".encode() for i in range(9)) + b"\n"


def read_count(path: Path) -> dict[str, int]:
    with open(path) as recording:
        return {topic.name: topic.count for topic in recording.topics}


@pytest.mark.parametrize("part", [1.0, 0.5], ids=["whole", "cut"])
@pytest.mark.parametrize("write", [write_bag, write_indexed_mcap, write_db3])
@pytest.mark.filterwarnings("error::ResourceWarning")
def test_an_unreferenced_recording_closes_its_file(
    tmp_path: Path, write: Callable[..., Path], part: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    complaints: list[object] = []
    monkeypatch.setattr(sys, "unraisablehook", lambda told: complaints.append(told.exc_value))
    path = write(tmp_path / "drive", messages(300))
    os.truncate(path, int(part * path.stat().st_size))
    recording = open(path)
    assert recording.topics
    del recording
    gc.collect()
    assert complaints == []


@pytest.mark.parametrize("name", ["drive.bag", "drive.recorded", "a folder/drive #1%.bag"])
def test_a_bag_is_known_by_its_content(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    assert read_count(write_bag(path, messages(30))) == {"/scan": 20, "/cmd_vel": 10}


def test_topics_of_a_bag_are_looked_up_in_its_index(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    held = messages(300)
    looked_at: list[int] = []

    def merge(*indexes: list[tuple[int, ...]]) -> Iterator[tuple[int, ...]]:
        looked_at.append(sum(map(len, indexes)))
        return heapq.merge(*indexes)

    monkeypatch.setattr(rosbags.rosbag1.reader, "heapq", SimpleNamespace(merge=merge))
    with closing(open_source(write_bag(tmp_path / "drive.bag", held))) as source:
        asked = [(0, 300), (290, 295), (0, 5), (100, 100), (299, 301), (150, 160)]
        parts = [source.messages(source.channels, START_NS + a * STEP_NS, START_NS + b * STEP_NS) for a, b in asked]
        parts += [source.messages(source.channels, None, START_NS), source.messages(source.channels, held[-1][1])]
        read: list[list[Message]] = [[] for _ in parts]
        for turn in zip_longest(*parts):  # in turns, as when several topics are read
            for one, message in zip(read, turn, strict=True):
                if message:
                    one.append((message[0].topic, message[1], message[2]))
    assert read == [*(held[a:b] for a, b in asked), [], held[-1:]]
    assert looked_at == [*(max(0, min(b, 300) - a) for a, b in asked), 0, 1]


@pytest.mark.parametrize("write", [write_db3, write_indexed_mcap])
@pytest.mark.parametrize("name", ["drive", "drive #1", "drive%20a", "drive?"])
def test_files_of_ros_2_are_read_alone_and_as_folders(
    tmp_path: Path, write: Callable[[Path, list[Message]], Path], name: str
) -> None:
    written = write(tmp_path / "written", messages(30))
    path = written.parent.rename(tmp_path / name) / written.name
    expected = {"/scan": 20, "/cmd_vel": 10}
    assert read_count(path) == read_count(path.parent) == read_count(path.parent / "metadata.yaml") == expected
    (path.parent / "metadata.yaml").unlink()
    assert read_count(path.parent) == expected
    lone = path.rename(tmp_path / "renamed.data")
    assert read_count(lone) == expected


def test_split_files_are_one_recording(tmp_path: Path) -> None:
    held = messages(60)
    folder = tmp_path / "split"
    folder.mkdir()
    for number, part in enumerate((held[:30], held[30:])):
        shutil.copy(write_db3(tmp_path / f"part{number}", part), folder / f"split_{number}.db3")
    with open(folder) as recording:
        assert {topic.name: topic.count for topic in recording.topics} == {"/scan": 40, "/cmd_vel": 20}
        assert (recording.start_ns, recording.end_ns) == (held[0][1], held[-1][1])


@pytest.mark.parametrize("name", ["drive.log", "drive.clf", "drive.log.gz", "drive.clf.gz", "drive"])
def test_a_carmen_log_is_read_gzipped_or_not(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(gzip.compress(LOG) if name.endswith(".gz") else LOG)
    assert read_count(path) == {"ODOM": 9}


@pytest.mark.slow
@pytest.mark.parametrize("in_folder", [False, True])
def test_damage_that_is_met_on_the_way_is_reported_and_the_rest_is_read(
    data: Path, tmp_path: Path, in_folder: bool
) -> None:
    raw = bytearray((data / "good" / "turtlebot3_gazebo.bag").read_bytes())
    half = len(raw) // 2
    raw[half : half + 64] = bytes(byte ^ 0xA5 for byte in raw[half : half + 64])
    (tmp_path / "drive.bag").write_bytes(raw)
    with open(tmp_path if in_folder else tmp_path / "drive.bag") as recording:
        assert recording.problems == ()
        times = [moment.time_ns for moment in recording.samples()]
        assert 4000 < len(times) < 5533
        assert times == sorted(times)
        assert times[-1] - times[0] > 90e9
        assert len(recording.problems) == 1
        assert recording.problems[0].startswith("the recording is damaged in 1 place: read ")
        at = recording.at("/scan", 91.0)
        assert at is not None
        assert len(list(recording.samples())) == len(times)


def test_a_path_may_be_text(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    write_bag(tmp_path / "drive.bag", messages(3))
    monkeypatch.setenv("HOME", str(tmp_path))
    with open("~/drive.bag") as recording:
        assert recording.path == tmp_path / "drive.bag"
    with open(os.fsencode(tmp_path / "drive.bag")) as recording:  # type: ignore[arg-type]
        assert recording.path == tmp_path / "drive.bag"
    words = "path: expected the path of a recording, as text or as a pathlib.Path, got 7"
    with pytest.raises(TypeError, match=f"^{re.escape(words)}$"):
        open(7)  # type: ignore[arg-type]


def tar(name: str = "drive.bag") -> bytes:
    """A tar archive with one file."""
    held = io.BytesIO()
    with tarfile.open(fileobj=held, mode="w") as archive:
        archive.addfile(tarfile.TarInfo(name))
    return held.getvalue()


LFS_POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n"


@pytest.mark.parametrize(
    ("name", "content", "text"),
    [
        ("empty.log", b"", "empty.log: the file is empty: expected a ROS bag (.bag)"),
        ("notes.log", b"It rained.\n", "notes.log: expected a ROS bag (.bag)"),
        ("notes.txt", b"It rained.\n", "got text that starts with 'It rained.'"),
        ("photo.jpg", b"\xff\xd8\xff\xe0\0\x10JFIF", "got bytes that start with ff d8 ff e0"),
        ("drive.zip", b"PK\x03\x04\0\0", "got a zip archive; unpack it first"),
        ("drive.tar", tar(), "got a tar archive; unpack it first, with tar -xf"),
        ("drive.bag", tar(), "drive.bag: expected a ROS 1 bag of format 2.0, got a tar archive; unpack it first"),
        ("drive.db3", tar(), "got a tar archive"),
        ("drive.mcap", tar("FLASER 1"), "got a tar archive"),
        ("drive.tar.gz", gzip.compress(tar(), mtime=0), "got a tar archive; unpack it first, with tar -xf"),
        ("drive.tar.zst", zstd.compress(tar()), "got a tar archive; unpack it first, with tar -xf"),
        ("drive.gz", gzip.compress(b"It rained.", mtime=0), "drive.gz: expected a ROS bag"),
        ("drive.gz", b"\x1f\x8b\x08nonsense", "got gzip data"),
        ("drives.parquet", b"PAR1\x15\x04", "got a Parquet file; robowidgets.drives() opens an index of drives"),
        ("drive.bag.gz", gzip.compress(b"#ROSBAG V2.0\n", mtime=0), "got a ROS 1 bag in gzip: unpack it with gunzip"),
        (
            "drive.bag",
            b"It rained.\n",
            "drive.bag: expected a ROS 1 bag of format 2.0, got text that starts with 'It rained.'",
        ),
        ("drive.mcap", b"It rained.\n", "drive.mcap: expected an MCAP file, got text that starts with 'It rained.'"),
        ("drive.db3", b"It rained.\n", "drive.db3: expected a rosbag2 database (.db3), got text"),
        ("drive.bag", b"", "drive.bag: the file is empty (0 bytes)"),
        *((f"drive{suffix}", LFS_POINTER, "got a pointer of Git LFS") for suffix in (".bag", ".mcap", ".db3", ".log")),
    ],
)
def test_a_file_that_is_not_a_recording_is_named_for_what_it_is(
    tmp_path: Path, name: str, content: bytes, text: str
) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(RecordingError) as caught:
        open(tmp_path / name)
    assert text in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_large_file_that_is_not_a_log_is_not_read_to_its_end(tmp_path: Path) -> None:
    path = tmp_path / "notes.log"
    path.write_bytes(b"It rained.\n")
    with path.open("r+b") as file:
        file.truncate(1 << 40)
    with pytest.raises(RecordingError, match=r"got text that starts with 'It rained\.'"):
        open(path)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes with a name")
def test_a_pipe_is_not_waited_for(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "drive.bag")
    with pytest.raises(RecordingError, match="expected a file or a folder, got a pipe or a device"):
        open(tmp_path / "drive.bag")


def test_a_path_that_no_disk_takes_says_so() -> None:
    with pytest.raises(RecordingError, match="cannot be read: File name too long"):
        open("drive" * 1000)


def test_a_path_to_nothing_says_so(tmp_path: Path) -> None:
    with pytest.raises(RecordingError) as raised:
        open(tmp_path / "missing.bag")
    assert str(raised.value) == f"{tmp_path / 'missing.bag'}: no such file or folder"


def test_a_link_that_leads_nowhere_is_called_that(tmp_path: Path) -> None:
    (tmp_path / "loop.bag").symlink_to(tmp_path / "loop.bag")
    (tmp_path / "lost.bag").symlink_to(tmp_path / "gone" / "lost.bag")
    for name in ("loop.bag", "lost.bag"):
        with pytest.raises(RecordingError, match=rf"{name}: a link that leads nowhere$"):
            open(tmp_path / name)
    with pytest.raises(RecordingError, match=r"got loop\.bag \(a link that leads nowhere\), lost\.bag \(a link"):
        open(tmp_path)


def test_a_folder_that_links_to_itself_is_read_once(tmp_path: Path) -> None:
    write_bag(tmp_path / "drive.bag", messages(30))
    (tmp_path / "again").symlink_to(tmp_path, target_is_directory=True)
    (tmp_path / "loop.bag").symlink_to(tmp_path / "loop.bag")
    assert read_count(tmp_path / "again" / "again") == {"/scan": 20, "/cmd_vel": 10}


@pytest.mark.skipif(sys.platform != "linux", reason="only Linux tells who writes to a file")
class TestAFileThatIsBeingWritten:
    BEING_WRITTEN = (
        "the file is being written: read its content so far, 30 messages, up to 1.4 s; open it again for the rest"
    )

    @pytest.mark.parametrize("write", [write_bag, write_db3, write_indexed_mcap])
    @pytest.mark.parametrize("cut", [0, 40])
    def test_is_called_that_and_read_so_far(
        self, tmp_path: Path, write: Callable[[Path, list[Message]], Path], cut: int
    ) -> None:
        path = write(tmp_path / "drive", messages(30))
        if cut and write is not write_db3:  # the end that a recorder has not written yet
            os.truncate(path, path.stat().st_size - cut)
        with path.open("ab"), open(path) as recording:
            assert recording.problems == (self.BEING_WRITTEN,)
            assert sum(topic.count for topic in recording.topics) == 30
        with open(path) as recording:
            assert self.BEING_WRITTEN not in recording.problems

    def test_without_a_message_says_so(self, tmp_path: Path) -> None:
        path = write_indexed_mcap(tmp_path / "drive", messages(30))
        os.truncate(path, 20)
        with path.open("ab"), pytest.raises(RecordingError) as caught:
            open(path)
        assert str(caught.value) == "drive.mcap: is being written, and has no message so far: open it again later"

    def test_may_be_one_that_another_program_reads(self, tmp_path: Path) -> None:
        path = write_bag(tmp_path / "drive.bag", messages(30))
        with path.open("rb"), open(path) as recording:
            assert recording.problems == ()


def test_a_folder_without_a_recording_names_what_it_holds(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match=r"expected \.db3, \.mcap or \.bag files, got nothing"):
        open(tmp_path)
    (tmp_path / "notes.txt").write_text("It rained.")
    with pytest.raises(RecordingError, match=r"got notes\.txt"):
        open(tmp_path)


def test_a_folder_is_named_however_it_was_given(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(RecordingError, match=rf"^{tmp_path}: no recording in this folder"):
        open(".")


def test_a_folder_of_many_things_names_some(tmp_path: Path) -> None:
    for number in range(8):
        (tmp_path / f"{number}.txt").touch()
    with pytest.raises(RecordingError, match=r"got 0\.txt, 1\.txt, 2\.txt, 3\.txt, 4\.txt and 3 more$"):
        open(tmp_path)


@pytest.mark.parametrize("other", ["kitchen.bag", "drive_2.bag", "driven_1.bag"])
def test_recordings_of_different_names_are_not_taken_for_one(tmp_path: Path, other: str) -> None:
    write_bag(tmp_path / "drive_0.bag", messages(3))
    (tmp_path / other).touch()
    named = ", ".join(sorted(["drive_0.bag", other]))
    with pytest.raises(RecordingError, match=f"2 recordings in this folder: open one of them: {named}$"):
        open(tmp_path)


class TestFilesWithoutMetadata:
    """Files are joined only if they are the parts of one recording."""

    def folder(self, tmp_path: Path, *parts: list[Message]) -> Path:
        folder = tmp_path / "runs"
        folder.mkdir()
        for number, held in enumerate(parts):
            shutil.copy(write_indexed_mcap(tmp_path / f"part_{number}", held), folder / f"run_{number}.mcap")
        return folder

    def test_that_follow_on_are_one(self, tmp_path: Path) -> None:
        held = messages(60)
        assert read_count(self.folder(tmp_path, held[:30], held[30:])) == {"/scan": 40, "/cmd_vel": 20}

    @pytest.mark.parametrize("pause", [50, 70, 86_400])
    def test_that_start_minutes_later_are_not(self, tmp_path: Path, pause: int) -> None:
        held = messages(60)
        later = [(topic, time_ns + pause * 10**9, raw) for topic, time_ns, raw in held[30:]]
        folder = self.folder(tmp_path, held[:30], later)
        if pause < 60:
            assert read_count(folder) == {"/scan": 40, "/cmd_vel": 20}
            return
        with pytest.raises(RecordingError, match="2 recordings in this folder"):
            open(folder)

    @pytest.mark.parametrize("count", [30, 300])
    @pytest.mark.parametrize("cut", [0, 100])
    def test_that_are_copies_of_one_run_are_not(self, tmp_path: Path, count: int, cut: int) -> None:
        held = messages(count)
        folder = self.folder(tmp_path, held, held)
        for file in folder.iterdir():
            file.write_bytes(file.read_bytes()[: file.stat().st_size - cut])
        with pytest.raises(RecordingError, match=r"2 recordings in this folder: open one of them: run_0\.mcap, run_1"):
            open(folder)

    def test_that_each_lack_another_slow_topic_are_one(self, tmp_path: Path) -> None:
        """A part of an MCAP recording lists only the topics with a message in it."""
        folder = tmp_path / "runs"
        folder.mkdir()
        for number in range(3):
            (part,) = topics.write(
                tmp_path / f"part_{number}",
                {name: [(10.0 * number + i, 1.0) for i in range(9)] for name in ("/scan", "/back", f"/slow_{number}")},
            ).glob("*.mcap")
            shutil.copy(part, folder / f"run_{number}.mcap")
        assert read_count(folder) == {"/scan": 27, "/back": 27, "/slow_0": 9, "/slow_1": 9, "/slow_2": 9}

    def test_that_hold_other_topics_are_not(self, tmp_path: Path) -> None:
        folder = self.folder(tmp_path, messages(60))
        (other,) = topics.write(tmp_path / "other", {"/other_scan": [(1000, 1.0)]}).glob("*.mcap")
        shutil.copy(other, folder / "run_1.mcap")
        with pytest.raises(RecordingError, match="2 recordings in this folder"):
            open(folder)


@pytest.mark.parametrize("write", [write_indexed_mcap, write_bag])
def test_a_file_whose_line_ends_git_changed_is_called_that(tmp_path: Path, write: Callable[..., Path]) -> None:
    path = write(tmp_path / "drive", messages(30))
    raw, kind = path.read_bytes(), "mcap" if write is write_indexed_mcap else "bag"
    changed = tmp_path / f"changed.{kind}"
    changed.write_bytes(raw.replace(b"\r\n", b"\n") if kind == "mcap" else raw.replace(b"\n", b"\r\n"))
    with pytest.raises(RecordingError, match=rf"whose line ends git has changed for good: .*`\*\.{kind} binary`"):
        open(changed)


def test_a_file_from_a_checkout_that_changes_line_ends(data: Path) -> None:
    with pytest.raises(RecordingError, match="whose line ends git has changed"):
        open(data / "reports/git_line_ends/drive.mcap")


class TestDatabases:
    def test_that_were_cut_within_their_last_page_give_no_zeros(self, tmp_path: Path) -> None:
        held = messages(60)
        path = write_db3(tmp_path / "x", held)
        size = path.stat().st_size
        for missing in (1, 100, 2000, 4000):
            cut = tmp_path / f"cut_{missing}.db3"
            cut.write_bytes(path.read_bytes()[: size - missing])
            source = open_source(cut)
            for channel, time_ns, raw in source.messages(source.channels):
                assert (channel.topic, time_ns, raw) in held
            assert source.problems[0].startswith("the recording was cut off: read ")
            source.close()

    def test_count_messages_of_topics_that_they_do_not_name(self, tmp_path: Path) -> None:
        path = write_db3(tmp_path / "x", messages(60))
        with closing(sqlite3.connect(path)) as database:
            database.execute("DELETE FROM topics WHERE name = '/cmd_vel'")
            database.commit()
        with closing(open_source(path)) as source:
            assert [channel.count for channel in source.channels] == [40]
            assert source.problems == ("left out 20 messages of topics that the file does not name",)


class TestMetadata:
    def test_of_other_files_are_not_believed(self, tmp_path: Path) -> None:
        short, long = write_db3(tmp_path / "short", messages(30)), write_db3(tmp_path / "long", messages(60))
        shutil.copy(long.parent / "metadata.yaml", short.parent)
        text = (short.parent / "metadata.yaml").read_text().replace("long.db3", "short.db3")
        (short.parent / "metadata.yaml").write_text(text)
        with open(short.parent) as recording:
            assert sum(topic.count for topic in recording.topics) == 30
            assert recording.duration == pytest.approx(29 * STEP_NS / 1e9)
            assert recording.problems[0] == ("metadata.yaml states 60 messages, the files hold 30: read the files")

    def test_of_another_day_are_not_believed(self, tmp_path: Path) -> None:
        path = write_db3(tmp_path / "x", messages(30))
        metadata = path.parent / "metadata.yaml"
        metadata.write_text(metadata.read_text().replace(str(START_NS), str(START_NS + 86_400 * 10**9)))
        with open(path.parent) as recording:
            assert recording.start_ns == START_NS
            assert recording.problems[0] == ("metadata.yaml states another start than the files have: read the files")

    @pytest.mark.parametrize(
        ("spoil", "problem"),
        [
            (Path.mkdir, "metadata.yaml cannot be read (Is a directory): read the files without it"),
            (Path.touch, "metadata.yaml is not rosbag2 metadata, or is damaged: read the files without it"),
            (
                lambda path: path.write_bytes(bytes(600)),
                "metadata.yaml is not rosbag2 metadata, or is damaged: read the files without it",
            ),
            (
                lambda path: path.symlink_to(path),
                "metadata.yaml cannot be read (Too many levels of symbolic links): read the files without it",
            ),
        ],
    )
    def test_that_cannot_be_read_are_named(self, tmp_path: Path, spoil: Callable[[Path], object], problem: str) -> None:
        path = write_db3(tmp_path / "x", messages(30))
        (path.parent / "metadata.yaml").unlink()
        spoil(path.parent / "metadata.yaml")
        with open(path.parent) as recording:
            assert sum(topic.count for topic in recording.topics) == 30
            assert recording.problems == (problem,)

    def test_of_another_duration_are_not_believed(self, tmp_path: Path) -> None:
        path = write_db3(tmp_path / "x", messages(30))
        metadata = path.parent / "metadata.yaml"
        stated = re.sub(r"(duration:\s+nanoseconds: )\d+", r"\g<1>90000000000", metadata.read_text())
        metadata.write_text(stated)
        with open(path.parent) as recording:
            assert recording.duration == pytest.approx(29 * STEP_NS / 1e9)
            assert recording.problems[0] == "metadata.yaml states 90.0 s, the files hold 1.4 s: read the files"


def test_a_split_whose_last_file_was_not_yet_compressed_is_one_recording(tmp_path: Path) -> None:
    held = messages(60)
    folder = tmp_path / "split"
    folder.mkdir()
    (folder / "split_9.db3.zstd").write_bytes(zstd.compress(write_db3(tmp_path / "first", held[:30]).read_bytes()))
    shutil.copy(write_db3(tmp_path / "second", held[30:]), folder / "split_10.db3")
    assert read_count(folder) == {"/scan": 40, "/cmd_vel": 20}


def test_a_folder_whose_files_are_all_lost_says_why(tmp_path: Path) -> None:
    (tmp_path / "metadata.yaml").write_text("no: metadata")
    (tmp_path / "drive_0.db3").write_bytes(b"It rained.")
    with pytest.raises(RecordingError, match=r"drive_0\.db3: expected a rosbag2 database"):
        open(tmp_path)


@pytest.mark.parametrize("spoil", [Path.touch, Path.mkdir])
def test_files_of_any_names_are_one_recording_where_the_metadata_are_of_no_use(
    tmp_path: Path, spoil: Callable[[Path], None]
) -> None:
    held = messages(60)
    spoil(tmp_path / "metadata.yaml")
    write_bag(tmp_path / "drive.bag", held[:30])
    write_bag(tmp_path / "kitchen.bag", held[30:])
    assert read_count(tmp_path) == {"/scan": 40, "/cmd_vel": 20}


def test_an_intact_file_without_messages_is_not_called_damaged_for_the_files_next_to_it(tmp_path: Path) -> None:
    for lost in (b"", b"It rained."):
        (tmp_path / "metadata.yaml").write_text("relative_file_paths:\n  - drive_0.db3\n  - drive_1.db3\n")
        (tmp_path / "drive_1.db3").write_bytes(write_db3(tmp_path / f"part{len(lost)}", []).read_bytes())
        if lost:
            (tmp_path / "drive_0.db3").write_bytes(lost)
        with open(tmp_path) as recording:
            assert "drive_0.db3" in recording.problems[0]
            assert recording.problems[1:] == ("there is no message in it: nothing was recorded",)


@pytest.mark.skipif(os.geteuid() == 0, reason="root may read everything")
def test_a_file_that_may_not_be_read_says_so(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "drive.bag", messages(3))
    path.chmod(0)
    with pytest.raises(RecordingError, match="Permission denied"):
        open(path)


def test_a_recording_is_read_from_wherever_the_program_went(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    shutil.copy(SAMPLE, tmp_path / "drive.mcap")
    monkeypatch.chdir(tmp_path)
    with open("drive.mcap") as recording:
        monkeypatch.chdir(tmp_path.parent)
        assert len(recording.scans()) == next(topic.count for topic in recording.topics if topic.widget == "laser")
        with open(recording.path) as again:
            assert again.topics == recording.topics


def test_real_files_that_are_whole_are_not_walked_through(data: Path) -> None:
    for path in sorted((data / "good").iterdir()):
        if path.suffix != ".gz":
            source = open_source(path)
            assert isinstance(source, FallbackSource), path.name
            assert source.problems == ()
            source.close()
