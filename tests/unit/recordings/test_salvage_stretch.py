"""Bytes that are read by offset, and patterns that are found in them."""

from __future__ import annotations

import re
import tracemalloc
from pathlib import Path

import pytest
from robowidgets.repair._stretch import WINDOW, FileStretch, MemoryStretch, find
from robowidgets.repair._times import Times

PATTERN = re.compile(rb"(?=abc)")


def test_a_file_gives_what_it_has_and_takes_no_memory_for_more(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(b"0123456789")
    file = FileStretch(path)
    tracemalloc.start()
    try:
        assert file.read(4, 1 << 32) == b"456789"
        assert file.read(20, 5) == b""
        assert tracemalloc.get_traced_memory()[1] < 1_000_000
    finally:
        tracemalloc.stop()
    file.close()


@pytest.mark.parametrize("at", [0, WINDOW - 3, WINDOW - 2, WINDOW - 1, WINDOW, 2 * WINDOW - 3])
def test_a_pattern_is_found_once_wherever_it_lies(at: int) -> None:
    data = MemoryStretch(bytes(at) + b"abc" + bytes(3 * WINDOW))
    assert list(find(data, PATTERN, 3, 0)) == [at]
    assert list(find(data, PATTERN, 3, at + 1)) == []


@pytest.mark.slow
@pytest.mark.parametrize("magic", [b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n"])
def test_gigabytes_that_were_never_written_are_passed_over(tmp_path: Path, magic: bytes) -> None:
    class Once:
        """What looks for a pattern, and may look at the start alone."""

        looked_at = 0

        def finditer(self, raw: bytes) -> list[re.Match[bytes]]:
            self.looked_at += len(raw)
            return []

    path, pattern = tmp_path / "x", Once()
    path.write_bytes(magic)
    with path.open("r+b") as file:
        file.truncate(1 << 28)
    file = FileStretch(path)
    assert list(find(file, pattern, 20, 0)) == []  # type: ignore[arg-type]
    assert pattern.looked_at == WINDOW
    file.close()


def test_equal_times_keep_the_order_of_the_file() -> None:
    times = Times([5, 0] * 500, [1, 2] * 500, {1, 2})
    assert [row for row, _, _ in times.rows({1, 2}, None, None)] == [*range(1, 1000, 2), *range(0, 1000, 2)]
    assert times.counts() == {1: 500, 2: 500}


def test_channels_that_are_not_known_do_not_count() -> None:
    times = Times([1, 2, 3], [7, 8, 9], {8})
    assert (len(times), times.start_ns, times.end_ns, times.counts()) == (1, 2, 2, {8: 1})
