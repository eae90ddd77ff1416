"""Files made to use up memory or time get little of either."""

from __future__ import annotations

import bz2
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path
from time import process_time

import pytest

from robowidgets.messages.compression import inflate
from robowidgets.repair import RecordingError, open_repaired

from ..recordings.written import MCAP_END, MCAP_MAGIC, mcap_head, mcap_messages, messages, record, write_bag

HUGE = 1 << 40
SECONDS = 5


def bag_record(body_size: int, **fields: bytes) -> bytes:
    parts = [name.encode() + b"=" + value for name, value in fields.items()]
    header = b"".join(struct.pack("<I", len(part)) + part for part in parts)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", body_size)


CLAIMS: dict[str, bytes] = {
    "message.mcap": MCAP_MAGIC + mcap_head() + struct.pack("<BQ", 0x05, HUGE) + bytes(40),
    "schema.mcap": MCAP_MAGIC + record(0x03, struct.pack("<HI", 1, 0xFFFFFFFF) + bytes(20)),
    "chunk.mcap": MCAP_MAGIC
    + struct.pack("<BQQQQI", 0x06, HUGE, 0, 0, HUGE, 0)
    + struct.pack("<I4sQ", 4, b"zstd", HUGE - 44)
    + bytes(40),
    "header.bag": b"#ROSBAG V2.0\n" + struct.pack("<I", 0xFFFFFFFF) + bytes(40),
    "field.bag": b"#ROSBAG V2.0\n" + struct.pack("<II", 40, 0xFFFFFFFF) + bytes(40),
    "message.bag": b"#ROSBAG V2.0\n" + bag_record(0xFFFFFFFF, op=b"\x02", conn=bytes(4), time=bytes(8)),
    "chunk.bag": b"#ROSBAG V2.0\n" + bag_record(0xFFFFFFFF, op=b"\x05", compression=b"lz4", size=b"\xff" * 4),
    "topic.bag": b"#ROSBAG V2.0\n" + bag_record(0xFFFFFFFF, op=b"\x07", conn=bytes(4), topic=b"/scan"),
}


@pytest.mark.parametrize("name", CLAIMS)
def test_a_length_in_the_file_does_not_reserve_memory(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_bytes(CLAIMS[name])
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError):
            open_repaired([path])
        assert tracemalloc.get_traced_memory()[1] < 4_000_000
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("name", ["schema.mcap", "topic.bag"])
def test_a_text_that_fills_the_file_is_not_held(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    with path.open("wb") as file:
        if path.suffix == ".bag":
            file.write(b"#ROSBAG V2.0\n" + bag_record(1 << 26, op=b"\x07", conn=bytes(4), topic=b"/scan"))
        else:
            file.write(MCAP_MAGIC + struct.pack("<BQ", 0x03, 1 << 26))
        file.truncate(file.tell() + (1 << 26))
    tracemalloc.start()
    try:
        with pytest.raises(RecordingError):
            open_repaired([path])
        assert tracemalloc.get_traced_memory()[1] < 1 << 24
    finally:
        tracemalloc.stop()


def test_what_grows_a_thousandfold_is_decompressed_up_to_a_limit() -> None:
    raw, whole = inflate("bz2", bz2.compress(bytes(8_000_000)), limit=1_000_000)
    assert (len(raw), whole) == (1_000_000, False)
    assert inflate("bz2", bz2.compress(bytes(1_000_000)), limit=1_000_000) == (bytes(1_000_000), True)


def flood(piece: bytes) -> bytes:
    return piece * (1_000_000 // len(piece))


FLOODS: dict[str, Callable[[], bytes]] = {
    "decoys.mcap": lambda: flood(record(0x05, b"")),
    "lengths.mcap": lambda: flood(struct.pack("<BQ", 0x05, 0x10000)),
    "small.mcap": lambda: flood(record(0x0F, bytes(4)) * 4 + b"\xff" * 9),
    "zeros.mcap": lambda: bytes(1_000_000),
    "ones.mcap": lambda: b"\xff" * 1_000_000,
    "decoys.bag": lambda: flood(struct.pack("<II", 4000, 9) + b"op=\x02"),
    "fields.bag": lambda: flood(struct.pack("<I", 8) + b"ver=" + struct.pack("<I", 12 * 300)),
    "small.bag": lambda: flood(bag_record(0, op=b"\x02", conn=bytes(4), time=bytes(8)) + b"\xff" * 9),
    "zeros.bag": lambda: bytes(1_000_000),
    "ones.bag": lambda: b"\xff" * 1_000_000,
}


@pytest.mark.slow
@pytest.mark.parametrize("name", FLOODS)
def test_a_megabyte_of_decoys_ends_soon_and_costs_no_message_before_it(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    if path.suffix == ".bag":
        write_bag(path, messages(9), chunk=1 << 20)
    else:
        path.write_bytes(MCAP_MAGIC + mcap_head() + mcap_messages(messages(9)))
    raw = path.read_bytes()
    end = raw.index(messages(9)[-1][2]) + len(messages(9)[-1][2])
    path.write_bytes(raw[:end] + FLOODS[name]())
    start = process_time()
    source = open_repaired([path])
    assert process_time() - start < SECONDS
    assert sum(channel.count for channel in source.channels if channel.topic in ("/scan", "/cmd_vel")) >= 9


def test_many_damaged_places_are_given_up_at_some_point(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("robowidgets.repair._record_reader.MAX_PLACES", 5)
    held = messages(60)
    parts = [mcap_messages(held[i : i + 4]) for i in range(0, 60, 4)]
    path = tmp_path / "x.mcap"
    path.write_bytes(MCAP_MAGIC + mcap_head() + b"\xff\xff".join(parts) + MCAP_END)
    source = open_repaired([path])
    assert sum(channel.count for channel in source.channels) == 24
    assert source.problems == ("the recording is damaged in 5 places and was cut off: read 24 messages, up to 1.1 s",)
