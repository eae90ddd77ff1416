"""A rewritten recording is complete, and has the content of the damaged one."""

from __future__ import annotations

import os
import resource
import signal
import sqlite3
import struct
import subprocess
import sys
from collections.abc import Collection, Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import Any

import pytest
from mcap.reader import make_reader

import robowidgets
from robowidgets.command import main
from robowidgets.files import open_source
from robowidgets.files._fallback import FallbackSource
from robowidgets.messages.channel import Channel
from robowidgets.messages.compression import zstd
from robowidgets.repair import Message, RecordingError, open_repaired
from robowidgets.repair.write import write

from ..recordings.clock_back import KINDS, bag, cut, db3, drive, mcap, step
from ..recordings.digest import digest
from ..recordings.written import MCAP_END, MCAP_MAGIC, mcap_head, mcap_messages, messages, read, record, write_bag
from ..waiting import wait_for
from .test_sqlite import write_old


def repair(path: Path, *options: str) -> Path:
    """The file that the command writes; it ends with 0, and leaves nothing else."""
    output = path.parent / "out" / "clean.mcap"
    output.parent.mkdir(exist_ok=True)
    assert main(["repair", str(path), "--output", str(output), *options]) == 0
    assert os.listdir(output.parent) == ["clean.mcap"]
    return output


def samples(path: Path) -> dict[str, Any]:
    """The content of a recording without its problems."""
    return {name: said for name, said in digest(path).items() if name != "problems"}


def problems(path: Path) -> tuple[str, ...]:
    with robowidgets.open(path) as recording:
        return recording.problems


@pytest.mark.parametrize("kind", KINDS)
def test_a_damaged_recording_says_the_same_and_nothing_is_wrong(tmp_path: Path, kind: str) -> None:
    path = KINDS[kind](tmp_path, drive(step(3.0)))
    cut(next(path.glob("drive_1.*")) if path.is_dir() else path)
    assert len(problems(path)) == 2
    output = repair(path)
    assert samples(output) == samples(path)
    assert problems(output) == ()


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "damaged/half_the_pages.db3",
        "damaged/truncated.bag",
        "damaged/truncated.mcap",
        "good/neato_fsm",
        "odd/belgioioso_two_times.log.gz",
        "odd/hist_file_compression",
        "odd/metadata_names_missing_file",
        "odd/orebro_times_all_zero.log.gz",
        "odd/ros1_messages_in_mcap.mcap",
    ],
)
def test_a_real_recording_says_the_same(data: Path, tmp_path: Path, name: str) -> None:
    output = tmp_path / "clean.mcap"
    assert main(["repair", str(data / name), "--output", str(output)]) == 0
    with closing(open_source(output)) as clean, closing(open_source(data / name)) as source:
        assert clean.problems == ()
        assert [(c.topic, c.type, c.encoding, c.count) for c in clean.channels] == [
            (c.topic, c.type, c.encoding, c.count) for c in source.channels
        ]
        assert sorted(read(clean)) == sorted(read(source))
    assert samples(output) == samples(data / name)


class TestTheFile:
    def summary(self, path: Path) -> Any:
        with path.open("rb") as file:
            return make_reader(file).get_summary()

    def profile(self, path: Path) -> str:
        with path.open("rb") as file:
            return make_reader(file).get_header().profile

    def test_is_indexed_and_compressed_in_chunks(self, tmp_path: Path) -> None:
        held = messages(9000)
        output = repair(write_bag(tmp_path / "drive.bag", held))
        summary = self.summary(output)
        assert len(summary.chunk_indexes) > 1
        assert {chunk.compression for chunk in summary.chunk_indexes} == {"zstd"}
        assert summary.statistics.message_count == 9000
        with output.open("rb") as file:
            found = [message for _, _, message in make_reader(file, validate_crcs=True).iter_messages()]
        assert [(message.log_time, message.data) for message in found] == [(time, data) for _, time, data in held]

    def test_is_one_that_rosbags_reads(self, tmp_path: Path) -> None:
        source = open_source(repair(cut(db3(tmp_path, drive(step(0.0))))))
        assert isinstance(source, FallbackSource)
        source.close()

    def test_tells_which_ros_it_comes_from(self, tmp_path: Path) -> None:
        assert self.profile(repair(bag(tmp_path, drive(step(0.0))))) == "ros1"
        assert self.profile(repair(mcap(tmp_path, drive(step(0.0))), "--force")) == "ros2"

    @pytest.mark.parametrize("write_one", [write_bag, write_old])
    def test_defines_its_messages_also_where_the_recording_does_not(self, tmp_path: Path, write_one: Any) -> None:
        schemas = self.summary(repair(write_one(tmp_path / "drive", messages()))).schemas.values()
        name = "sensor_msgs/LaserScan" if write_one is write_bag else "sensor_msgs/msg/LaserScan"
        (text,) = (schema.data.decode() for schema in schemas if schema.name == name)
        assert "float32 angle_increment" in text
        assert "MSG: std_msgs/Header" in text
        assert ("uint32 seq" in text) == (write_one is write_bag)

    def test_keeps_definitions_in_idl(self, tmp_path: Path) -> None:
        path = tmp_path / "drive.mcap"
        path.write_bytes(MCAP_MAGIC + mcap_head(schema="ros2idl") + mcap_messages(messages()) + MCAP_END)
        schemas = self.summary(repair(path)).schemas.values()
        assert {schema.encoding for schema in schemas} == {"ros2idl"}
        assert all(schema.data.startswith(b"=" * 80 + b"\nIDL: " + schema.name.encode()) for schema in schemas)

    def test_keeps_messages_that_are_not_of_ros_and_says_what_they_lack(
        self, tmp_path: Path, capsys: pytest.CaptureFixture[str]
    ) -> None:
        path = tmp_path / "drive.mcap"
        path.write_bytes(MCAP_MAGIC + mcap_head("flatbuffer", "flatbuffer") + mcap_messages(messages()) + MCAP_END)
        output = repair(path)
        assert "! /scan: its messages, encoded as 'flatbuffer', have no definition now" in capsys.readouterr().out
        assert read(open_repaired([output])) == messages()
        assert self.profile(output) == ""

    def test_holds_messages_that_were_compressed_one_by_one_as_they_were_sent(self, tmp_path: Path) -> None:
        held = [(topic, time_ns, b"\0\1\0\0" + data) for topic, time_ns, data in messages()]
        packed = [(topic, time_ns, zstd.compress(data)) for topic, time_ns, data in held]
        assert read(open_repaired([repair(write_old(tmp_path / "drive.db3", packed))])) == held

    def test_of_a_recording_without_a_message_is_without_one(self, tmp_path: Path) -> None:
        output = repair(write_bag(tmp_path / "drive.bag", []))
        assert problems(output) == ("there is no message in it: nothing was recorded",)


class TestTheCommand:
    def test_says_what_was_wrong_and_what_was_written(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = cut(bag(tmp_path, drive(step(3.0))))
        assert main(["repair", str(path)]) == 0
        output = tmp_path / "drive_repaired.mcap"
        assert capsys.readouterr().out.splitlines() == [
            "! the recording was cut off: read 200 messages, up to 6.9 s",
            "! the clock goes back once, by up to 2.90 s: order is kept, time stands still meanwhile",
            f"Wrote {output}: 200 messages, 6.9 s, {output.stat().st_size / 1e3:.0f} kB",
        ]

    def test_says_that_nothing_was_wrong(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = bag(tmp_path, drive(step(0.0)))
        assert main(["repair", str(path)]) == 0
        assert capsys.readouterr().out.splitlines()[0] == f"Nothing is wrong with {path}"

    def test_says_what_was_met_on_the_way(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = KINDS["bz2"](tmp_path, drive(step(0.0)))
        raw = bytearray(path.read_bytes())
        second = [at for at in range(len(raw)) if raw.startswith(b"compression=bz2", at)][1]
        raw[second + 80 : second + 200] = bytes(120)
        path.write_bytes(raw)
        assert main(["repair", str(path)]) == 0
        assert capsys.readouterr().out.startswith("! the recording is damaged in 1 place: read ")
        assert problems(tmp_path / "drive_repaired.mcap") == ()

    @pytest.mark.parametrize(
        ("name", "written"),
        [
            ("drive.bag", "drive_repaired.mcap"),
            ("drive.bag.active", "drive_repaired.mcap"),
            ("drive.db3.zstd", "drive_repaired.mcap"),
            ("drive 1.5", "drive 1.5_repaired.mcap"),
        ],
    )
    def test_names_the_file_after_the_recording(self, tmp_path: Path, name: str, written: str) -> None:
        raw = write_bag(tmp_path / "whole", messages()).read_bytes()
        (tmp_path / name).write_bytes(zstd.compress(raw) if name.endswith("zstd") else raw)
        assert main(["repair", str(tmp_path / name)]) == 0
        assert sorted(os.listdir(tmp_path)) == sorted([name, written, "whole"])

    def test_puts_the_file_next_to_a_folder(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        folder = db3(tmp_path, drive(step(0.0))).parent
        assert main(["repair", str(folder / "metadata.yaml")]) == 0
        (tmp_path / "drive_repaired.mcap").unlink()
        monkeypatch.chdir(folder)
        assert main(["repair", "."]) == 0
        assert (tmp_path / "drive_repaired.mcap").exists()

    def test_replaces_a_file_only_on_request(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path, output = bag(tmp_path, drive(step(0.0))), tmp_path / "drive_repaired.mcap"
        output.write_bytes(b"precious")
        self.refuses([str(path)], f"{output}: already exists; replace it with --force", capsys)
        assert output.read_bytes() == b"precious"
        assert main(["repair", str(path), "--force"]) == 0
        assert problems(output) == ()

    def test_never_writes_into_the_recording_itself(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = db3(tmp_path, drive(step(0.0)))
        before = path.read_bytes()
        for file, output in ((path, path), (path.parent, path), (path.parent, path.parent / "new.mcap")):
            arguments = [str(file), "--output", str(output), "--force"]
            self.refuses(arguments, f"{output}: is part of the recording itself", capsys)
        assert path.read_bytes() == before

    @pytest.mark.parametrize(
        ("arguments", "line"),
        [
            (["missing.bag"], "missing.bag: no such file or folder"),
            (["notes.bag"], "notes.bag: expected a ROS 1 bag of format 2.0, got text that starts with 'It rained.'"),
            (["drive.bag", "--output", "."], ".: is a folder; name a file with --output"),
            (["drive.bag", "-o", "x.bag"], "--output: expected a name that ends in .mcap, got 'x.bag'"),
            (["drive.bag", "--output", "no/x.mcap"], "no/x.mcap: cannot be written: No such file or directory"),
            (["drive.bag", "--output", "drive.bag/x.mcap"], "drive.bag/x.mcap: cannot be written: Not a directory"),
            (["drive.bag", "--output", f"{'x' * 300}.mcap"], "File name too long"),
        ],
    )
    def test_that_cannot_be_done_is_one_line_and_2(
        self,
        tmp_path: Path,
        monkeypatch: pytest.MonkeyPatch,
        capsys: pytest.CaptureFixture[str],
        arguments: list[str],
        line: str,
    ) -> None:
        monkeypatch.chdir(tmp_path)
        bag(tmp_path, drive(step(0.0)))
        (tmp_path / "notes.bag").write_bytes(b"It rained.\n")
        before = sorted(os.listdir(tmp_path))
        self.refuses(arguments, line, capsys)
        assert sorted(os.listdir(tmp_path)) == before

    @pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
    def test_says_that_a_folder_cannot_be_written(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path, locked = bag(tmp_path, drive(step(0.0))), tmp_path / "locked"
        locked.mkdir(0o500)
        self.refuses([str(path), "--output", str(locked / "x.mcap")], "cannot be written: Permission denied", capsys)

    def test_leaves_nothing_when_there_is_no_room(self, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
        path = write_bag(tmp_path / "drive.bag", messages(9000))
        with room_for(1 << 20):
            self.refuses([str(path)], "drive_repaired.mcap: cannot be written: File too large", capsys)
        assert os.listdir(tmp_path) == ["drive.bag"]

    def refuses(self, arguments: list[str], line: str, capsys: pytest.CaptureFixture[str]) -> None:
        assert main(["repair", *arguments]) == 2
        said = capsys.readouterr()
        assert said.out in ("", f"Nothing is wrong with {arguments[0]}\n")
        # On a slow machine a progress bar comes before it.
        last = said.err.splitlines()[-1]
        assert last.startswith("robowidgets: ")
        assert line in last
        assert said.err.count("\n") == 1

    @pytest.mark.slow
    def test_leaves_nothing_when_it_is_interrupted(self, tmp_path: Path) -> None:
        path = write_bag(tmp_path / "drive.bag", messages(60_000, size=320), chunk=1 << 20)
        command = [sys.executable, "-m", "robowidgets", "repair", str(path)]
        with subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE) as running:
            wait_for(lambda: running.poll() is not None or len(os.listdir(tmp_path)) > 1, "it begins to write")
            assert [name.endswith(".part") for name in sorted(os.listdir(tmp_path))] == [False, True]
            running.send_signal(signal.SIGINT)
            assert running.wait(120) == 130
        assert os.listdir(tmp_path) == ["drive.bag"]


@contextmanager
def room_for(size: int) -> Iterator[None]:
    """Limit files to this number of bytes."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


class TestASourceThatCanBeReadNoFurther:
    class Breaking:
        """A source of two messages, after which it breaks."""

        channels = (Channel(5, "/scan", "sensor_msgs/msg/LaserScan", "cdr", "", 9),)
        problems = ()
        start_ns, end_ns = 1, 9

        def __init__(self, error: BaseException, after: int) -> None:
            self.error, self.after = error, after

        def messages(self, channels: Collection[Channel], *_: int | None) -> Iterator[Message]:
            (channel,) = channels
            for i in range(self.after):
                yield channel, i, b"\0\1\0\0"
            raise self.error

        def span_ns(self, _: Channel) -> None:
            return None

        def close(self) -> None:
            pass

    def test_is_written_up_to_the_damage(self, tmp_path: Path) -> None:
        path = tmp_path / "x.mcap"
        written = write(self.Breaking(RecordingError("the disk could not read it"), after=2), path)
        assert written.messages == 2
        assert written.problems == ("the file can be read no further: the disk could not read it",)
        assert [time_ns for _, time_ns, _ in read(open_repaired([path]))] == [0, 1]

    @pytest.mark.parametrize("error", [RecordingError("the disk could not read it"), KeyboardInterrupt()])
    def test_is_not_written_when_it_gives_nothing(self, tmp_path: Path, error: BaseException) -> None:
        with pytest.raises(type(error)):
            write(self.Breaking(error, after=0), tmp_path / "x.mcap")
        assert os.listdir(tmp_path) == []


def test_a_clock_that_begins_before_1970_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_old(tmp_path / "drive.db3", messages(10))
    with closing(sqlite3.connect(path)) as connection, connection:
        connection.execute("UPDATE messages SET timestamp = id - 2000000000")
    assert main(["repair", str(path)]) == 2
    assert "cannot be written: the clock begins before 1970" in capsys.readouterr().err
    assert os.listdir(tmp_path) == ["drive.db3"]


def test_a_channel_without_a_type_is_kept(tmp_path: Path) -> None:
    channel = record(0x04, struct.pack("<HHI", 1, 0, 5) + b"/bare" + struct.pack("<I", 3) + b"cdr" + bytes(4))
    message = record(0x05, struct.pack("<HIQQ", 1, 0, 7, 7) + b"data")
    path = tmp_path / "drive.mcap"
    path.write_bytes(MCAP_MAGIC + channel + message + MCAP_END)
    assert read(open_repaired([repair(path)])) == [("/bare", 7, b"data")]
