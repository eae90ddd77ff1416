"""The server that sends everything that the viewer in a page shows."""

from __future__ import annotations

import logging
from collections.abc import Iterator
from http.client import HTTPException
from pathlib import Path
from urllib.error import HTTPError
from urllib.parse import urlsplit
from urllib.request import Request, urlopen

import pytest

from robowidgets.in_rerun._server import Server, kept_here, read

from ..waiting import wait_for


@pytest.fixture(scope="module")
def server() -> Server:
    return Server()


def fetch(address: str) -> bytes:
    with urlopen(address, timeout=240) as answer:
        return bytes(answer.read())


def test_it_listens_on_this_machine_alone(server: Server) -> None:
    assert server._server.server_address[0] == "127.0.0.1"
    assert urlsplit(server.put("a.rrd", list)).hostname == "127.0.0.1"


def test_each_request_gets_the_content_again_piece_by_piece(server: Server, tmp_path: Path) -> None:
    (tmp_path / "file").write_bytes(bytes(range(256)) * 10_000)
    address = server.put("b.wasm", lambda: read(tmp_path / "file"))
    with urlopen(address, timeout=240) as answer:
        assert answer.headers["Content-Type"] == "application/wasm"
        assert answer.headers["Access-Control-Allow-Origin"] == "*"
        assert answer.read() == bytes(range(256)) * 10_000
    (tmp_path / "file").write_bytes(b"new")
    assert fetch(address) == b"new"


def test_nothing_is_found_without_the_secret_or_once_it_is_dropped(server: Server) -> None:
    address = server.put("c.rrd", lambda: [b"", b"1", b"", b"2"])
    assert fetch(address) == b"12"
    parts = urlsplit(address)
    with pytest.raises(HTTPError, match="404"):
        fetch(f"http://{parts.netloc}/c.rrd")
    server.drop(address)
    with pytest.raises(HTTPError, match="404"):
        fetch(address)


def test_content_that_breaks_off_does_not_look_whole_and_is_logged(
    server: Server, caplog: pytest.LogCaptureFixture
) -> None:
    def broken() -> Iterator[bytes]:
        yield b"begun"
        raise OSError("the disk is gone")

    with caplog.at_level(logging.ERROR, "robowidgets"), pytest.raises(HTTPException):
        fetch(server.put("d.rrd", broken))
    wait_for(lambda: "cannot send the rest of d.rrd" in caplog.text, "it was logged")
    assert "the disk is gone" in caplog.text


def test_a_page_that_goes_away_is_not_an_error(server: Server, caplog: pytest.LogCaptureFixture) -> None:
    ended = []

    def endless() -> Iterator[bytes]:
        try:
            while True:
                yield bytes(1 << 20)
        finally:
            ended.append(True)

    with caplog.at_level(logging.ERROR, "robowidgets"):
        with urlopen(Request(server.put("e.rrd", endless)), timeout=240) as answer:
            answer.read(10)
        wait_for(lambda: bool(ended), "it stopped")
    assert not caplog.text


def test_the_viewer_is_kept_from_the_web() -> None:
    kept = kept_here("const ret = arg0.fetch(arg1, arg2); const other = fetch(arg0);")
    assert "arg0.fetch" not in kept
    assert kept.index("const fetch =") < kept.index("fetch(arg1, arg2)")
    with pytest.raises(RuntimeError, match=r"may access the web: use rerun-sdk>=0\.41,<0\.42"):
        kept_here("window.fetch(where)")
