"""A web server for one file, which counts requests and bytes, and misbehaves on request."""

from __future__ import annotations

import re
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any


class RangeServer(ThreadingHTTPServer):
    """A server that sends parts of a file.

    Attributes:
        requests: the method of each request, with its range.
        urls: the paths of the requests, with their parameters.
        sent: the number of bytes that the answers contain so far.
        refusals: the status of the next requests for parts, in their order.
        cuts: the number of next answers that end after half of their bytes.
        mode: ``"ignore"`` to send the whole file for each range, ``"longer"`` to send other ranges than requested.
    """

    daemon_threads = True

    def __init__(self, path: Path) -> None:
        super().__init__(("127.0.0.1", 0), _Handler)
        self.path = path
        self.tag: str | None = '"1"'
        self.requests: list[str] = []
        self.urls: list[str] = []
        self.sent = 0
        self.refusals: list[int] = []
        self.cuts = 0
        self.mode = ""

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.server_port}/{self.path.name}?signature=secret"


class _Handler(BaseHTTPRequestHandler):
    server: RangeServer
    protocol_version = "HTTP/1.1"

    def do_HEAD(self) -> None:
        self._count()
        self._head(200, self._size, [])

    def do_GET(self) -> None:
        self._count()
        asked = re.fullmatch(r"bytes=(\d+)-(\d+)", self.headers.get("Range", ""))
        if asked and self.server.refusals:
            self._head(self.server.refusals.pop(0), 0, [])
            return
        if asked is None or self.server.mode == "ignore":
            self._head(200, self._size, [])
            self._send(0, self._size)
            return
        first, last = int(asked[1]), min(int(asked[2]), self._size - 1)
        if self.server.mode == "longer":
            last = min(last + 10, self._size - 1)
        length = last + 1 - first
        self._head(206, length, [("Content-Range", f"bytes {first}-{last}/{self._size}")])
        if self.server.cuts:
            self.server.cuts -= 1
            length //= 2
            self.close_connection = True
        self._send(first, length)

    @property
    def _size(self) -> int:
        return self.server.path.stat().st_size

    def _count(self) -> None:
        self.server.urls.append(self.path)
        self.server.requests.append(f"{self.command} {self.headers.get('Range', '')}".strip())

    def _head(self, status: int, length: int, headers: list[tuple[str, str]]) -> None:
        self.send_response(status)
        self.send_header("Content-Length", str(length))
        if self.server.tag:
            self.send_header("ETag", self.server.tag)
        for header in headers:
            self.send_header(*header)
        self.end_headers()

    def _send(self, offset: int, length: int) -> None:
        with self.server.path.open("rb") as file:
            file.seek(offset)
            while length > 0 and (block := file.read(min(length, 1 << 20))):
                self.server.sent += len(block)  # before the client has them, so that a test that has them reads the sum
                length -= len(block)
                try:
                    self.wfile.write(block)
                except ConnectionError:  # the client has read enough
                    self.close_connection = True
                    return

    def log_message(self, *args: Any) -> None:
        pass


@contextmanager
def serving(path: Path) -> Iterator[RangeServer]:
    """Serve a file while the block runs."""
    with RangeServer(path) as server:
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            yield server
        finally:
            server.shutdown()
            thread.join()
