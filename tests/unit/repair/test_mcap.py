"""MCAP files that are cut, unindexed, from other writers, wrong or hostile."""

from __future__ import annotations

import struct
from base64 import b64encode
from binascii import crc32
from collections.abc import Callable
from pathlib import Path

import lz4.frame
import pytest

from robowidgets.messages.compression import zstd
from robowidgets.repair import RecordingError, open_repaired

from ..recordings.written import (
    MCAP_END,
    MCAP_MAGIC,
    Message,
    mcap_chunk,
    mcap_head,
    mcap_messages,
    messages,
    read,
    record,
    string,
    write_indexed_mcap,
)

PACK: dict[str, Callable[[bytes], bytes]] = {
    "": bytes,
    "lz4": lz4.frame.compress,
    "zstd": zstd.compress,
}


def chunked(held: list[Message], compression: str, each: int = 20, checksum: bool = False) -> list[bytes]:
    """Chunks with this number of messages."""
    raws = [mcap_messages(held[i : i + each]) for i in range(0, len(held), each)]
    return [mcap_chunk(raw, compression, PACK[compression](raw), crc32(raw) if checksum else 0) for raw in raws]


def write(path: Path, *parts: bytes) -> Path:
    path.write_bytes(MCAP_MAGIC + b"".join(parts))
    return path


def test_reads_every_message_that_rosbags_wrote(tmp_path: Path) -> None:
    held = messages()
    source = open_repaired([write_indexed_mcap(tmp_path / "whole", held)])
    assert read(source) == held
    assert source.problems == ()
    assert [(c.topic, c.type, c.encoding, c.count) for c in source.channels] == [
        ("/scan", "sensor_msgs/msg/LaserScan", "cdr", 67),
        ("/cmd_vel", "geometry_msgs/msg/Twist", "cdr", 33),
    ]
    assert "float32 angle_increment" in source.channels[0].definition


@pytest.mark.parametrize("compression", PACK)
def test_reads_chunks_without_an_index(tmp_path: Path, compression: str) -> None:
    held = messages()
    source = open_repaired(
        [write(tmp_path / "x.mcap", mcap_head(), *chunked(held, compression, checksum=True), MCAP_END)]
    )
    assert read(source) == held
    assert source.problems == ()


def test_reads_messages_without_chunks(tmp_path: Path) -> None:
    held = messages()
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held), MCAP_END)])
    assert read(source) == held
    assert source.problems == ()


def test_names_ros1_messages_as_such(tmp_path: Path) -> None:
    head = mcap_head("ros1", "ros1msg", ("sensor_msgs/LaserScan", "geometry_msgs/Twist"))
    source = open_repaired([write(tmp_path / "x.mcap", head, mcap_messages(messages()), MCAP_END)])
    assert [(c.type, c.encoding, c.definition) for c in source.channels] == [
        ("sensor_msgs/msg/LaserScan", "ros1", "# sensor_msgs/LaserScan\n"),
        ("geometry_msgs/msg/Twist", "ros1", "# geometry_msgs/Twist\n"),
    ]


@pytest.mark.parametrize(
    ("schema", "definition"),
    [
        ("ros2msg", "# sensor_msgs/msg/LaserScan\n"),
        ("ros2idl", "=" * 80 + "\nIDL: sensor_msgs/msg/LaserScan\n# sensor_msgs/msg/LaserScan\n"),
        ("protobuf", b64encode(b"# sensor_msgs/msg/LaserScan\n").decode()),
        ("flatbuffer", ""),
    ],
)
def test_gives_definitions_only_in_languages_that_are_read(tmp_path: Path, schema: str, definition: str) -> None:
    source = open_repaired(
        [write(tmp_path / "x.mcap", mcap_head("json", schema), mcap_messages(messages(3)), MCAP_END)]
    )
    assert source.channels[0].definition == definition
    assert source.channels[0].encoding == "json"


def test_a_channel_may_have_no_schema_and_a_schema_may_come_last(tmp_path: Path) -> None:
    head = mcap_head()
    channel = record(0x04, struct.pack("<HH", 7, 0) + string("/bare") + string("cdr") + struct.pack("<I", 0))
    source = open_repaired([write(tmp_path / "x.mcap", channel, mcap_messages(messages(9)), head, MCAP_END)])
    assert [(c.topic, c.type, c.count) for c in source.channels] == [
        ("/bare", "", 0),
        ("/scan", "sensor_msgs/msg/LaserScan", 6),
        ("/cmd_vel", "geometry_msgs/msg/Twist", 3),
    ]


def test_a_killed_recorder_leaves_no_end_and_nothing_is_lost(tmp_path: Path) -> None:
    held = messages()
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), *chunked(held, "zstd"))])
    assert read(source) == held
    assert source.problems == (
        "the recorder was stopped before it closed the file: read all of its 100 messages, up to 5.0 s",
    )


def test_cut_in_an_uncompressed_chunk_keeps_what_came_before(tmp_path: Path) -> None:
    held = messages()
    path = write(tmp_path / "x.mcap", mcap_head(), *chunked(held, "", each=100), MCAP_END)
    raw = path.read_bytes()
    path.write_bytes(raw[: raw.index(held[60][2]) + 100])
    source = open_repaired([path])
    assert read(source) == held[:60]
    assert source.problems == ("the recording was cut off: read 60 messages, up to 3.0 s",)


def test_cut_in_a_compressed_chunk_keeps_what_decompresses(tmp_path: Path) -> None:
    held = messages(2000)
    path = write(tmp_path / "x.mcap", mcap_head(), *chunked(held, "zstd", each=2000), MCAP_END)
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 6 // 10])
    source = open_repaired([path])
    saved = read(source)
    assert 900 <= len(saved) <= 1200
    assert saved == held[: len(saved)]
    assert source.problems == (
        f"the recording was cut off: read {len(saved):,} messages, up to {(saved[-1][1] - saved[0][1]) / 1e9:.1f} s",
    )


@pytest.mark.parametrize("compression", ["lz4", "zstd"])
def test_a_broken_chunk_costs_no_other(tmp_path: Path, compression: str) -> None:
    held = messages()
    chunks = chunked(held, compression)
    chunks[2] = chunks[2][:60] + bytes(len(chunks[2]) - 60)
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), *chunks, MCAP_END)])
    assert read(source) == held[:40] + held[60:]
    assert source.problems == ("the recording is damaged in 1 place: read 80 messages, up to 5.0 s",)


@pytest.mark.parametrize("compression", PACK)
def test_a_chunk_that_differs_from_its_checksum_is_read_and_reported(tmp_path: Path, compression: str) -> None:
    held = messages(40)
    raw = mcap_messages(held)
    chunk = mcap_chunk(raw, compression, PACK[compression](raw), crc32(raw) ^ 1)
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), chunk, MCAP_END)])
    assert read(source) == held
    assert source.problems == ("1 chunk differs from the checksum in the file: some messages may be wrong",)


def test_a_wrong_length_costs_one_message(tmp_path: Path) -> None:
    held = messages()
    path = write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held), MCAP_END)
    raw = bytearray(path.read_bytes())
    at = raw.index(held[50][2]) - 30
    raw[at : at + 9] = struct.pack("<Q", 1 << 40).join((b"\x05", b""))
    path.write_bytes(raw)
    source = open_repaired([path])
    assert read(source) == held[:50] + held[51:]
    assert source.problems == ("the recording is damaged in 1 place: read 99 messages, up to 5.0 s",)


def test_what_looks_like_a_record_within_a_damaged_one_is_not_taken_for_one(tmp_path: Path) -> None:
    held = messages(20)
    held[7] = ("/scan", held[7][1], b"before" + mcap_messages(messages(1, size=32)) + b"behind" * 9)
    path = write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held), MCAP_END)
    raw = bytearray(path.read_bytes())
    raw[raw.index(held[7][2]) - 31] = 0
    path.write_bytes(raw)
    assert read(open_repaired([path])) == held[:7] + held[8:]


def test_a_hole_costs_the_messages_in_it_and_no_others(tmp_path: Path) -> None:
    held = messages()
    path = write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held), MCAP_END)
    raw = path.read_bytes()
    first, last = raw.index(held[40][2]) - 31, raw.index(held[43][2]) + 7
    path.write_bytes(raw[:first] + b"\xff" * (last - first) + raw[last:])
    source = open_repaired([path])
    assert read(source) == held[:40] + held[44:]
    assert len(source.problems) == 1


def test_a_time_that_no_clock_has_is_left_out_and_reported(tmp_path: Path) -> None:
    held = messages(9)
    late = [("/scan", 2**63, b"late")]
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held + late), MCAP_END)])
    assert read(source) == held
    assert source.problems == ("the recording is damaged in 1 place: read 9 messages, up to 0.4 s",)


def test_an_unknown_compression_is_reported(tmp_path: Path) -> None:
    held = messages()
    raw = mcap_messages(held)
    source = open_repaired(
        [write(tmp_path / "x.mcap", mcap_head(), mcap_messages(held[:3]), mcap_chunk(raw, "snappy", raw), MCAP_END)]
    )
    assert read(source) == held[:3]
    assert source.problems == ("chunks compressed with snappy cannot be read: their messages are left out",)


def test_an_empty_recording_is_not_an_error(tmp_path: Path) -> None:
    source = open_repaired([write(tmp_path / "x.mcap", mcap_head(), MCAP_END)])
    assert (source.start_ns, source.end_ns, source.problems, len(source.channels)) == (None, None, (), 2)


@pytest.mark.parametrize("size", [8, 60, 400])
def test_nothing_but_a_start_is_named_so(tmp_path: Path, size: int) -> None:
    path = write(tmp_path / "x.mcap", mcap_head(), mcap_messages(messages()))
    path.write_bytes(path.read_bytes()[:size])
    with pytest.raises(RecordingError, match=rf"x\.mcap: was cut off before its first message \({size} bytes\)"):
        open_repaired([path])


def test_a_foreign_file_is_named(tmp_path: Path) -> None:
    path = tmp_path / "x.mcap"
    path.write_bytes(b"PK\x03\x04" + bytes(40))
    with pytest.raises(RecordingError, match=r"^x\.mcap: expected an MCAP file, got a zip archive; unpack it first$"):
        open_repaired([path])
