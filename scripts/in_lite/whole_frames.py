"""Decompressors with the interface of Python's and lz4's, for JavaScript functions that need a complete frame."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any


class WholeFrames:
    """A decompressor that collects the bytes of a frame in any pieces, and returns its content once it is complete.

    It returns nothing of a frame that is damaged or cut off. A subclass finds the end of a frame and unpacks it.
    """

    def __init__(self) -> None:
        self.eof, self.needs_input, self.unused_data = False, True, b""
        self._came = bytearray()
        self._left = memoryview(b"")

    def decompress(self, data: bytes, max_length: int = -1) -> bytes:
        """See `compression.zstd.ZstdDecompressor.decompress`."""
        if self.eof:
            raise EOFError("the frame has ended")
        if self.needs_input:
            self._came += data
            end = self._end(self._came)
            if end is None:
                return b""
            self.unused_data = bytes(self._came[end:])
            self._left = memoryview(self._unpack(bytes(self._came[:end])))
            self._came.clear()
            self.needs_input = False
        size = len(self._left) if max_length < 0 else max_length
        piece, self._left = bytes(self._left[:size]), self._left[size:]
        self.eof = not self._left
        return piece

    def _end(self, data: bytearray) -> int | None:
        """Return the end of the frame at the start of these bytes, or None if the frame is not complete."""
        raise NotImplementedError

    def _unpack(self, frame: bytes) -> bytes:
        raise NotImplementedError


def script(name: str) -> Any:
    """Return the exports of a CommonJS script in the folder of this file."""
    from pyodide.code import run_js

    text = Path(__file__).with_name(name).read_text(encoding="utf-8")
    return run_js(f"(() => {{ const exports = {{}}, module = {{ exports }};\n{text}\nreturn module.exports; }})()")


def call(function: Callable[[Any], Any], data: bytes, error: type[Exception]) -> bytes:
    """Return the result of a JavaScript function for some bytes. Its exceptions are raised as the given error."""
    from pyodide.ffi import JsException, to_js

    try:
        return bytes(function(to_js(data)).to_bytes())
    except JsException as why:
        raise error(str(why)) from None
