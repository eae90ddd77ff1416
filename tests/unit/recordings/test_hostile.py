"""Recordings made to use up memory or time end with an error, soon, and within the memory budget, in every reader."""

from __future__ import annotations

import gzip
import json
import struct
import subprocess
import sys
import time
from pathlib import Path
from typing import Any

import pytest

import robowidgets

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

from ..repair.test_hostile import CLAIMS
from . import sweeps, topics
from .written import MCAP_END, MCAP_MAGIC, mcap_chunk, mcap_head, record, string

SECONDS = 5
LEVELS = 60
HUGE = 1 << 30
LINE = "=" * 80

# Opens each file, reads all of its topics, and prints the result, the time and the memory that it took.
PROBE = """
import json, sys, time
import robowidgets
told = {}
for path in sys.argv[1:]:
    start = time.process_time()
    try:
        with robowidgets.open(path) as recording:
            for topic in recording.topics:
                if topic.widget == "laser":
                    len(recording.scans(topic.name))
            sum(1 for _ in recording.samples()) if any(topic.widget for topic in recording.topics) else None
            said = list(recording.problems)
    except robowidgets.RecordingError as error:
        said = [str(error)]
    told[path] = said, time.process_time() - start
most = next(line for line in open("/proc/self/status") if line.startswith("VmHWM:"))
print(json.dumps([told, int(most.split()[1]) * 1024]))
"""


def probe(paths: list[Path]) -> tuple[dict[str, tuple[list[str], float]], int]:
    ended = subprocess.run([sys.executable, "-c", PROBE, *map(str, paths)], capture_output=True, text=True, check=False)
    assert ended.returncode == 0, ended.stderr
    told, memory = json.loads(ended.stdout)
    return told, memory


def zeros(size: int) -> bytes:
    """Zeros, compressed."""
    packer = zstd.ZstdCompressor()
    piece = bytes(1 << 24)
    return b"".join(packer.compress(piece) for _ in range(size >> 24)) + packer.flush()


@pytest.mark.slow
@pytest.mark.skipif(not Path("/proc/self/status").exists(), reason="only Linux tells the peak of a process's memory")
def test_no_claim_and_no_bomb_takes_memory_or_time(tmp_path: Path) -> None:
    paths = []
    for name, raw in CLAIMS.items():
        paths.append(tmp_path / name)
        paths[-1].write_bytes(raw)
    bomb = zeros(HUGE)
    assert len(bomb) < 1_000_000
    chunk = mcap_chunk(bytes(1000), "zstd", bomb)
    # A chunk that is huge and declares it, and one that declares to be small, in files that are indexed like any other.
    for claim in (HUGE, 1000):
        folder = sweeps.write(tmp_path / str(claim), sweeps.numbered(20))
        path = folder / f"{claim}.mcap"
        path.write_bytes(indexed(path.read_bytes(), bomb, claim))
        paths.append(path)
    paths.append(tmp_path / "unindexed.mcap")
    paths[-1].write_bytes(MCAP_MAGIC + mcap_head() + chunk + MCAP_END)
    paths.append(tmp_path / "drive.log.gz")
    with gzip.open(paths[-1], "wb", compresslevel=1) as log:
        log.write(b"FLASER 1 1.0 0 0 0 0 0 0 1 robot 1\n")
        for _ in range(16):
            log.write(bytes(1 << 24))

    told, memory = probe(paths)
    for path in paths:
        said, seconds = told[str(path)]
        assert said, path
        assert seconds < SECONDS, path
    assert memory < 800_000_000


def indexed(raw: bytes, packed: bytes, size: int) -> bytes:
    """An MCAP file with its one chunk replaced by another, to which its index still points."""
    start = raw.index(struct.pack("<B", 0x06), len(MCAP_MAGIC) + 30)
    (length,) = struct.unpack_from("<Q", raw, start + 1)
    times = raw[start + 9 : start + 25]
    body = times + struct.pack("<QI", size, 0) + string("zstd") + struct.pack("<Q", len(packed)) + packed
    chunk = struct.pack("<BQ", 0x06, len(body)) + body
    grown = len(chunk) - (9 + length)
    rest = bytearray(raw[start + 9 + length :])

    def move(at: int) -> None:
        (offset,) = struct.unpack_from("<Q", rest, at)
        struct.pack_into("<Q", rest, at, offset + grown)

    # The chunk's index: the position of the records after it, its length, and its compression.
    entry = next(at for at in range(len(rest)) if rest[at] == 0x08 and rest[at + 9 : at + 25] == times)
    (count,) = struct.unpack_from("<I", rest, entry + 41)
    struct.pack_into("<Q", rest, entry + 33, len(chunk))
    for at in range(entry + 45 + 2, entry + 45 + count, 10):
        move(at)
    tail = entry + 45 + count + 8
    (old,) = struct.unpack_from("<I", rest, tail)
    named = string("zstd") + struct.pack("<QQ", len(packed), size)
    (entry_size,) = struct.unpack_from("<Q", rest, entry + 1)
    struct.pack_into("<Q", rest, entry + 1, entry_size + 4 - old)
    rest[tail : tail + 4 + old + 16] = named
    summary = len(rest) - len(MCAP_MAGIC) - 20
    move(summary)
    struct.pack_into("<Q", rest, summary + 8, 0)
    return raw[:start] + chunk + bytes(rest)


def types(lines: str, *more: str) -> str:
    return f"\n{LINE}\n".join((lines, *more))


NESTED = {
    "two in each": types(
        "a/T1 x\na/T1 y",
        *(f"MSG: a/T{i}\na/T{i + 1} x\na/T{i + 1} y" for i in range(1, LEVELS)),
        f"MSG: a/T{LEVELS}\nint8 x",
    ),
    "one in the other": types(
        "a/T1 x", *(f"MSG: a/T{i}\na/T{i + 1} x" for i in range(1, 3000)), "MSG: a/T3000\nint8 x"
    ),
    "itself": types("a/T1 x", "MSG: a/T1\na/T1 x"),
    "each other": types("a/T1 x", "MSG: a/T1\na/T2 x", "MSG: a/T2\na/T1 x"),
}


def write_defined(path: Path, definition: str) -> Path:
    """A file with one message, of a type that the file defines."""
    schema = record(0x03, struct.pack("<H", 1) + string("a/msg/T0") + string("ros2msg") + string(definition))
    channel = record(0x04, struct.pack("<HH", 1, 1) + string("/topic") + string("cdr") + struct.pack("<I", 0))
    message = record(0x05, struct.pack("<HIQQ", 1, 0, 1, 1) + bytes(8))
    path.write_bytes(MCAP_MAGIC + schema + channel + message + MCAP_END)
    return path


@pytest.mark.parametrize("name", NESTED)
def test_a_definition_that_nests_without_end_is_not_followed(tmp_path: Path, name: str) -> None:
    path = write_defined(tmp_path / "x.mcap", NESTED[name])
    start = time.process_time()
    recording = robowidgets.open(path)
    assert time.process_time() - start < SECONDS
    assert recording.problems[0].startswith("/topic: the definition of its messages in the file cannot be understood")


def test_a_definition_of_many_fields_is_read_all_the_same(tmp_path: Path) -> None:
    definition = "\n".join(f"int8 x{i}" for i in range(2000))
    recording = robowidgets.open(write_defined(tmp_path / "x.mcap", definition))
    assert recording.problems == ("none of its topics has a widget for its kind of sensor",)


@pytest.mark.parametrize("rays", [1 << 20, (1 << 30) - 1])
def test_a_scan_that_claims_more_rays_than_it_has_is_left_out(tmp_path: Path, rays: int) -> None:
    scans: list[Any] = sweeps.numbered(30)
    raw = scans[20][1]
    (place,) = (at for at in range(len(raw)) if raw[at : at + 4] == struct.pack("<I", 4) and at > 40)
    scans[20] = scans[20][0], raw[:place] + struct.pack("<I", rays) + raw[place + 4 :]
    recording = robowidgets.open(sweeps.write(tmp_path / "x", scans))
    assert recording.scans().ranges.shape == (29, 4)
    assert "messages that cannot be shown are left out, the first at 2.00 s" in recording.problems[0]


def test_a_problem_of_a_topic_whose_name_has_no_end_is_a_short_line(tmp_path: Path) -> None:
    late = {f"/{1000 * 'scan'}": topics.every(0.1, 20, 30, 2.0), "/odom": topics.every(0.1, 0, 30, 0.3)}
    with robowidgets.open(topics.write(tmp_path / "x", late)) as recording:
        assert [len(line) for line in recording.problems] == [200]
