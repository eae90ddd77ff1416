"""Any cut or change in a recording gives a source or a RecordingError, soon, and no invented message."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path
from time import process_time

import lz4.frame
import pytest

from robowidgets.messages.compression import zstd
from robowidgets.repair import RecordingError, open_repaired

from ..recordings.written import (
    MCAP_END,
    MCAP_MAGIC,
    mcap_chunk,
    mcap_head,
    mcap_messages,
    messages,
    read,
    write_bag,
    write_db3,
)

COUNT = 120
CUTS = 30
SECONDS = 5


def write_mcap(path: Path, compression: str, pack: Callable[[bytes], bytes] = bytes) -> Path:
    held = messages(COUNT)
    raws = [mcap_messages(held[i : i + 10]) for i in range(0, COUNT, 10)]
    chunks = (mcap_chunk(raw, compression, pack(raw)) for raw in raws)
    path.write_bytes(MCAP_MAGIC + mcap_head() + b"".join(chunks) + MCAP_END)
    return path


WRITERS: dict[str, Callable[[Path], Path]] = {
    "plain.bag": lambda folder: write_bag(folder / "x.bag", messages(COUNT)),
    "bz2.bag": lambda folder: write_bag(folder / "x.bag", messages(COUNT), "bz2"),
    "lz4.bag": lambda folder: write_bag(folder / "x.bag", messages(COUNT), "lz4"),
    "plain.mcap": lambda folder: write_mcap(folder / "x.mcap", ""),
    "lz4.mcap": lambda folder: write_mcap(folder / "x.mcap", "lz4", lz4.frame.compress),
    "zstd.mcap": lambda folder: write_mcap(folder / "x.mcap", "zstd", zstd.compress),
    "x.db3": lambda folder: write_db3(folder / "x", messages(COUNT)),
}


def try_open(path: Path, raw: bytes) -> list[tuple[str, int, bytes]]:
    """Save what these bytes hold; fail unless counts and times agree with the messages."""
    path.write_bytes(raw)
    start = process_time()
    try:
        source = open_repaired([path])
    except RecordingError as error:
        said = str(error)
    else:
        said = ""
    if said:
        assert "\n" not in said
        assert said.startswith(path.name)
        return []
    saved = read(source)
    assert process_time() - start < SECONDS
    assert len(saved) == sum(channel.count for channel in source.channels)
    times = [time_ns for _, time_ns, _ in saved]
    assert times == sorted(times)
    assert (source.start_ns, source.end_ns) == ((times[0], times[-1]) if times else (None, None))
    assert all("\n" not in line for line in source.problems)
    source.close()
    return saved


@pytest.mark.parametrize("name", WRITERS)
def test_cut_anywhere_it_gives_the_first_messages(tmp_path: Path, name: str) -> None:
    path = WRITERS[name](tmp_path)
    raw, held = path.read_bytes(), messages(COUNT)
    counts = []
    for part in range(CUTS):
        saved = try_open(path, raw[: len(raw) * part // CUTS])
        # A database keeps no order of time on disk.
        assert saved == ([message for message in held if message in saved] if name == "x.db3" else held[: len(saved)])
        counts.append(len(saved))
    assert counts == sorted(counts)
    assert counts[-1] >= COUNT * 3 // 4


@pytest.mark.parametrize("flips", [1, 20, 1000])
@pytest.mark.parametrize("name", WRITERS)
def test_flipped_bits_cost_little_and_never_a_traceback(tmp_path: Path, name: str, flips: int) -> None:
    path = WRITERS[name](tmp_path)
    raw, held = path.read_bytes(), set(messages(COUNT))
    chance = random.Random(f"{name} {flips}")
    best = 0
    for _ in range(20):
        changed = bytearray(raw)
        for _ in range(flips):
            changed[chance.randrange(len(raw))] ^= 1 << chance.randrange(8)
        best = max(best, len(held.intersection(try_open(path, changed))))
    if flips == 1:
        assert best >= COUNT - 1


@pytest.mark.parametrize("name", WRITERS)
def test_holes_cost_no_more_than_they_are_wide(tmp_path: Path, name: str) -> None:
    path = WRITERS[name](tmp_path)
    raw, held = path.read_bytes(), set(messages(COUNT))
    chance = random.Random(name)
    counts = []
    # Without the page that names the pages of a table, its rows are not found.
    start = raw.index(messages(1)[0][2]) if name == "x.db3" else 5000
    for _ in range(20):
        at, size = chance.randrange(start, len(raw)), chance.randrange(1, 2000)
        counts.append(len(held.intersection(try_open(path, raw[:at] + bytes(size) + raw[at + size :]))))
    assert min(counts) >= COUNT // 2
