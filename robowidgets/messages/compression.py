"""Decompression within a limit of memory, up to the first error."""

from __future__ import annotations

import sys
from bz2 import BZ2Decompressor
from collections.abc import Callable, Iterator
from io import BytesIO
from typing import Any

from lz4.frame import LZ4FrameDecompressor  # type: ignore[import-untyped]

if sys.version_info >= (3, 14):
    from compression import zstd
else:
    from backports import zstd

MAX_CHUNK = 1 << 28
ZSTD_MAGIC = b"\x28\xb5\x2f\xfd"
_STEP = 1 << 20

_DECOMPRESSORS: dict[str, Callable[[], Any]] = {
    "bz2": BZ2Decompressor,
    "lz4": LZ4FrameDecompressor,
    "zstd": zstd.ZstdDecompressor,
}
COMPRESSIONS = frozenset(_DECOMPRESSORS)


def inflate(compression: str, data: bytes, limit: int = MAX_CHUNK) -> tuple[bytes, bool]:
    """Decompress as much as possible; return the bytes, and True if these are all.

    Args:
        compression: "bz2", "lz4" or "zstd".
        data: compressed bytes, complete or cut off.
        limit: the most bytes to return.
    """
    out = BytesIO()
    whole = inflate_to(out.write, compression, iter((data,)), limit)
    return out.getvalue(), whole


def inflate_to(write: Callable[[bytes], object], compression: str, blocks: Iterator[bytes], limit: int) -> bool:
    """Decompress block by block into ``write``; return True if all of it was valid and at most ``limit`` bytes."""
    size, data = 0, next(blocks, b"")
    while data:
        stream = _DECOMPRESSORS[compression]()
        while not stream.eof:
            data = data or (next(blocks, b"") if stream.needs_input else b"")
            if stream.needs_input and not data:
                return False
            try:
                piece = stream.decompress(data, _STEP)
            except (OSError, EOFError, RuntimeError, ValueError, zstd.ZstdError):
                return False
            write(piece[: limit - size])
            size += len(piece)
            if size > limit:
                return False
            data = b""
        data = stream.unused_data or next(blocks, b"")
    return True


def plain(data: bytes) -> bytes:
    """Return a message as sent: decompressed if a recorder compressed it with zstd, else as it is.

    CDR messages never start with the magic bytes of zstd. Data that does not decompress is returned as it is.
    """
    if not data.startswith(ZSTD_MAGIC):
        return data
    raw, whole = inflate("zstd", data)
    return raw if whole else data
