"""Bytes that are read by offset, and patterns that are found in them."""

from __future__ import annotations

import re
import tracemalloc
from pathlib import Path

import pytest

from robowidgets.repair._byte_range import WINDOW, FileRange, MemoryRange, find

PATTERN = re.compile(rb"(?=abc)")


def test_a_file_gives_what_it_has_and_takes_no_memory_for_more(tmp_path: Path) -> None:
    path = tmp_path / "x"
    path.write_bytes(b"0123456789")
    file = FileRange(path)
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
    data = MemoryRange(bytes(at) + b"abc" + bytes(3 * WINDOW))
    assert list(find(data, PATTERN, 3, 0)) == [at]
    assert list(find(data, PATTERN, 3, at + 1)) == []


@pytest.mark.slow
@pytest.mark.parametrize("magic", [b"#ROSBAG V2.0\n", b"\x89MCAP0\r\n"])
def test_gigabytes_that_were_never_written_are_passed_over(tmp_path: Path, magic: bytes) -> None:
    class Once:
        """Finds a pattern; it may look at the start only."""

        looked_at = 0

        def finditer(self, raw: bytes) -> list[re.Match[bytes]]:
            self.looked_at += len(raw)
            return []

    path, pattern = tmp_path / "x", Once()
    path.write_bytes(magic)
    with path.open("r+b") as file:
        file.truncate(1 << 28)
    file = FileRange(path)
    assert list(find(file, pattern, 20, 0)) == []  # type: ignore[arg-type]
    assert pattern.looked_at == WINDOW
    file.close()
