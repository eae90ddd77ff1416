"""ROS 1 bags that are cut, unindexed, wrong or hostile."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest

from robowidgets.repair import RecordingError, open_repaired
from robowidgets.repair._byte_range import FileRange

from ..recordings.written import START_NS, STEP_NS, messages, read, write_bag

COMPRESSIONS = ("none", "bz2", "lz4")
HEADER_END = 4096 + 13


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_reads_every_message_of_a_whole_bag_without_a_word(tmp_path: Path, compression: str) -> None:
    held = messages()
    source = open_repaired([write_bag(tmp_path / "whole.bag", held, compression)])
    assert read(source) == held
    assert source.problems == ()
    assert {c.topic: (c.type, c.encoding, c.count) for c in source.channels} == {
        "/scan": ("sensor_msgs/msg/LaserScan", "ros1", 67),
        "/cmd_vel": ("geometry_msgs/msg/Twist", "ros1", 33),
    }
    assert (source.start_ns, source.end_ns) == (START_NS, START_NS + 99 * STEP_NS)
    assert "float32 angle_increment" in source.channels[0].definition


@pytest.mark.parametrize("compression", COMPRESSIONS)
def test_a_killed_recorder_leaves_no_index_and_nothing_is_lost(tmp_path: Path, compression: str) -> None:
    held = messages()
    path = write_bag(tmp_path / "killed.bag", held, compression)
    raw = path.read_bytes()
    index = struct.unpack_from("<Q", raw, raw.index(b"index_pos=") + 10)[0]
    path.write_bytes(raw[:index].replace(b"index_pos=" + struct.pack("<Q", index), b"index_pos=" + bytes(8)))
    source = open_repaired([path])
    assert read(source) == held
    assert source.problems == (
        "the recorder was stopped before it closed the file: read all of its 100 messages, up to 5.0 s",
    )


def test_cut_in_a_chunk_that_is_not_compressed_keeps_all_that_came_before(tmp_path: Path) -> None:
    held = messages()
    path = write_bag(tmp_path / "cut.bag", held, chunk=1 << 20)
    raw = path.read_bytes()
    path.write_bytes(raw[: raw.index(held[60][2]) + 100])
    source = open_repaired([path])
    assert read(source) == held[:60]
    assert source.problems == ("the recording was cut off: read 60 messages, up to 3.0 s",)


@pytest.mark.parametrize("compression", ["bz2", "lz4"])
def test_cut_in_a_compressed_chunk_keeps_the_chunks_before(tmp_path: Path, compression: str) -> None:
    held = messages()
    path = write_bag(tmp_path / "cut.bag", held, compression)
    raw = path.read_bytes()
    third = [at for at in range(len(raw)) if raw.startswith(b"compression=", at)][2]
    path.write_bytes(raw[: third + 2000])
    source = open_repaired([path])
    saved = read(source)
    assert len(saved) >= 30
    assert saved == held[: len(saved)]
    assert source.problems == (
        f"the recording was cut off: read {len(saved)} messages, up to {(saved[-1][1] - saved[0][1]) / 1e9:.1f} s",
    )


def test_wrong_lengths_in_the_index_cost_no_message(tmp_path: Path) -> None:
    held = messages()
    path = write_bag(tmp_path / "index.bag", held)
    raw = bytearray(path.read_bytes())
    index = raw.index(b"\x04\0\0\0op=\x04")
    header = raw.rindex(struct.pack("<I", 47), 0, index)
    raw[header + 51 : header + 55] = struct.pack("<I", 3000)
    path.write_bytes(raw)
    source = open_repaired([path])
    assert read(source) == held
    assert source.problems == (
        "the index of the recording is damaged, so it was read without: 100 messages, up to 5.0 s",
    )


def test_a_hole_costs_the_messages_in_it_and_no_others(tmp_path: Path) -> None:
    held = messages()
    path = write_bag(tmp_path / "hole.bag", held)
    raw = path.read_bytes()
    first, last = raw.index(held[40][2]), raw.index(held[43][2])
    path.write_bytes(raw[:first] + bytes(last - first) + raw[last:])
    source = open_repaired([path])
    saved = read(source)
    assert saved[:40] == held[:40]
    assert saved[-56:] == held[-56:]
    assert len(source.problems) == 1
    assert source.problems[0].startswith("the recording is damaged in 1 place: read 97 messages, up to 5.0 s")


@pytest.mark.parametrize("compression", ["bz2", "lz4"])
def test_a_broken_compressed_chunk_costs_no_other(tmp_path: Path, compression: str) -> None:
    held = messages()
    path = write_bag(tmp_path / "broken.bag", held, compression)
    raw = bytearray(path.read_bytes())
    second = [at for at in range(len(raw)) if raw.startswith(b"compression=", at)][1]
    raw[second + 80 : second + 4000] = bytes(3920)
    path.write_bytes(raw)
    source = open_repaired([path])
    saved = read(source)
    assert 70 <= len(saved) < 100
    assert set(saved) <= set(held)
    assert source.problems == (f"the recording is damaged in 1 place: read {len(saved)} messages, up to 5.0 s",)


def test_an_empty_definition_is_given_as_it_is(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "empty.bag", messages(3))
    raw = path.read_bytes()
    start = raw.index(b"message_definition=") - 4
    (size,) = struct.unpack_from("<I", raw, start)
    empty = b"message_definition=".ljust(size, b"\n")
    path.write_bytes(raw.replace(raw[start + 4 : start + 4 + size], empty))
    source = open_repaired([path])
    assert source.channels[0].definition.strip() == ""
    assert read(source) == messages(3)


def test_a_window_of_time_holds_its_start_and_not_its_stop(tmp_path: Path) -> None:
    source = open_repaired([write_bag(tmp_path / "window.bag", messages(), "lz4")])
    scans = [channel for channel in source.channels if channel.topic == "/scan"]
    window = source.messages(scans, START_NS + 30 * STEP_NS, START_NS + 33 * STEP_NS)
    assert [(time_ns - START_NS) // STEP_NS for _, time_ns, _ in window] == [30, 31]
    assert list(source.messages((), None, None)) == []
    assert list(source.messages(scans, 2**70, None)) == []
    assert len(list(source.messages(scans, -(2**70), 2**70))) == 67


def test_two_readers_at_once_do_not_disturb_each_other(tmp_path: Path) -> None:
    source = open_repaired([write_bag(tmp_path / "two.bag", messages(), "bz2")])
    first, second = source.messages(source.channels), source.messages(source.channels)
    assert [next(first)[1] for _ in range(50)] == [next(second)[1] for _ in range(50)]
    assert list(first) == list(second)


def test_a_closed_bag_says_so(tmp_path: Path) -> None:
    source = open_repaired([write_bag(tmp_path / "closed.bag", messages())])
    source.close()
    source.close()
    with pytest.raises(RecordingError, match=r"closed\.bag: is closed; open it again"):
        read(source)


def test_a_file_that_shrinks_after_it_was_opened_says_so(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "shrunk.bag", messages())
    source = open_repaired([path])
    path.write_bytes(path.read_bytes()[:6000])
    with pytest.raises(RecordingError, match=r"shrunk\.bag: has changed since it was opened"):
        read(source)


@pytest.mark.parametrize("size", [13, 3072, HEADER_END])
def test_nothing_but_a_start_is_named_so(tmp_path: Path, size: int) -> None:
    path = write_bag(tmp_path / "start.bag", messages(5))
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(RecordingError) as error:
        open_repaired([path])
    assert str(error.value) == (
        f"start.bag: was cut off before its first message ({size:,} bytes), nothing can be saved; "
        "copy it again if the original is whole, or record again"
    )


def test_an_older_format_is_named_with_a_way_out(tmp_path: Path) -> None:
    path = tmp_path / "old.bag"
    path.write_bytes(b"#ROSRECORD V1.2\n" + bytes(100))
    with pytest.raises(RecordingError) as error:
        open_repaired([path])
    assert str(error.value) == (
        "old.bag: a bag of format 1.2: only ROS 1 bags of format 2.0 can be read; "
        "with ROS 1 installed, `rosbag filter old.bag new.bag True` writes it as 2.0"
    )


def test_an_encrypted_bag_is_named_with_a_way_out(tmp_path: Path) -> None:
    fields = [b"op=\x03", b"index_pos=" + bytes(8), b"encryptor=rosbag/AesCbcEncryptor"]
    header = b"".join(struct.pack("<I", len(field)) + field for field in fields)
    path = tmp_path / "my secret.bag"
    path.write_bytes(b"#ROSBAG V2.0\n" + struct.pack("<I", len(header)) + header + bytes(4))
    with pytest.raises(RecordingError, match=r"encrypted \(rosbag/AesCbcEncryptor\).*`rosbag decrypt 'my secret.bag'`"):
        open_repaired([path])


def test_an_unknown_compression_is_named(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "odd.bag", messages(), "bz2")
    path.write_bytes(path.read_bytes().replace(b"compression=bz2", b"compression=xyz"))
    with pytest.raises(
        RecordingError, match=r"odd\.bag: compressed with xyz, which cannot be read: expected none, bz2"
    ):
        open_repaired([path])


@pytest.mark.parametrize(
    ("raw", "what"),
    [
        (b"PK\x03\x04" + bytes(40), "a zip archive; unpack it first"),
        (b"hello robot\n", "text that starts with 'hello robot'"),
        (b"\x01\x02\x03", "bytes that start with 01 02 03"),
    ],
)
def test_a_foreign_file_is_named(tmp_path: Path, raw: bytes, what: str) -> None:
    path = tmp_path / "foreign.bag"
    path.write_bytes(raw)
    with pytest.raises(RecordingError) as error:
        open_repaired([path])
    assert str(error.value) == f"foreign.bag: expected a ROS 1 bag of format 2.0, got {what}"


def test_an_empty_or_missing_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "zero.bag"
    with pytest.raises(RecordingError, match=r"zero\.bag: cannot be opened: No such file"):
        open_repaired([path])
    path.touch()
    with pytest.raises(RecordingError, match=r"zero\.bag: the file is empty \(0 bytes\): expected a recording"):
        open_repaired([path])


def test_messages_of_a_topic_that_is_not_named_are_reported(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "nameless.bag", messages(99), chunk=1 << 20)
    raw = path.read_bytes()
    nameless = bytearray(raw)
    at = -1
    while (at := raw.find(b"topic=/cmd_vel", at + 1)) >= 0:
        nameless[at : at + 6] = b"tropic"
    path.write_bytes(nameless)
    source = open_repaired([path])
    assert [channel.topic for channel in source.channels] == ["/scan"]
    assert "left out 33 messages of topics that the file does not name" in source.problems
    assert (source.start_ns, source.end_ns) == (START_NS, START_NS + 97 * STEP_NS)


def test_a_disk_that_fails_is_reported_and_what_was_read_before_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = messages()
    path = write_bag(tmp_path / "card.bag", held, chunk=1 << 20)
    broken = path.read_bytes().index(held[50][2])
    whole = FileRange.read

    def read_until(self: FileRange, offset: int, size: int) -> bytes:
        if offset >= broken:
            raise OSError(5, "Input/output error")
        return whole(self, offset, size)

    monkeypatch.setattr(FileRange, "read", read_until)
    source = open_repaired([path])
    assert read(source) == held[:50]
    assert source.problems == (
        "the disk could not read the file to its end (Input/output error): read 50 messages, up to 2.5 s",
    )
    broken = 0
    with pytest.raises(RecordingError, match=r"^card\.bag: the disk could not read it: Input/output error$"):
        read(source)
