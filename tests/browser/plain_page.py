"""Widgets on a page without Jupyter: the real widget in Python, its real front end, and a connection of our own.

What needs no kernel is tested here in a tenth of the time that JupyterLab takes. Cells run in this process. As with a
kernel, what a page sends is handled in its order, by a thread of its own, but while a cell runs: see `busy`.
"""

from __future__ import annotations

import ast
import asyncio
import contextlib
import io
import itertools
import json
import linecache
import queue
import struct
import threading
import traceback
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any, Literal

import comm
from comm.base_comm import BaseComm
from ipywidgets import Widget
from playwright.sync_api import Locator, Page
from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application, StaticFileHandler
from tornado.websocket import WebSocketHandler

from robowidgets.feeds import Feed
from robowidgets.recordings import RecordingData
from robowidgets.widget.pacer import pacer

from .console import Console
from .notebook import CellError, wait_for_drawing

FOLDER = Path(__file__).parent
MARGIN = 40
"""Margin around the widgets, in pixels."""
_numbers = itertools.count(1)
"""Numbers of cells that run."""


class PageServer:
    """Serves the empty page on 127.0.0.1, and a socket for each open page."""

    def __init__(self) -> None:
        self.pages: dict[str, PlainPage] = {}
        self.loop = asyncio.new_event_loop()
        (socket,) = bind_sockets(0, "127.0.0.1")
        self.url = f"http://127.0.0.1:{socket.getsockname()[1]}"
        self._started = threading.Event()
        self._thread = threading.Thread(target=self._run, args=(socket,), daemon=True)
        self._thread.start()
        self._started.wait()

    def stop(self) -> None:
        """End the thread that serves."""
        self.loop.call_soon_threadsafe(self.loop.stop)
        self._thread.join()

    def _run(self, socket: Any) -> None:
        asyncio.set_event_loop(self.loop)
        handlers: list[Any] = [
            (r"/socket/(.+)", _Socket, {"pages": self.pages}),
            (r"/(plain_page\.(?:html|js))", StaticFileHandler, {"path": FOLDER}),
        ]
        server = HTTPServer(Application(handlers))
        server.add_socket(socket)
        self.loop.call_soon(self._started.set)
        self.loop.run_forever()
        server.stop()


class _Socket(WebSocketHandler):
    def initialize(self, pages: dict[str, PlainPage]) -> None:
        self.pages = pages

    def open(self, name: str) -> None:
        self.page = self.pages[name]
        self.page.socket = self

    def on_message(self, message: str | bytes) -> None:
        assert isinstance(message, bytes)
        self.page.arrived.put(message)


class _Comm(BaseComm):
    """The comm of a widget whose page is a `PlainPage`."""

    page: PlainPage

    def publish_msg(
        self, msg_type: str, data: Any = None, _metadata: Any = None, buffers: Any = None, **_: Any
    ) -> None:
        self.page.post({"kind": msg_type, "comm": self.comm_id, "data": data}, buffers or ())


class PlainPage:
    """Cells whose widgets stand in a page without Jupyter; used as a `Notebook` is."""

    def __init__(self, page: Page, console: Console, server: PageServer, cells: Sequence[str]) -> None:
        self.page = page
        self.console = console
        self._cells = list(cells)
        self._texts: dict[int, str] = {}
        self._server = server
        self._name = f"{id(self)}"
        self.socket: _Socket | None = None
        self.arrived: queue.SimpleQueue[bytes | None] = queue.SimpleQueue()
        self._kernel = threading.RLock()
        self._is_busy = False
        self.namespace: dict[str, Any] = {"__name__": "__main__"}
        self._thread = threading.Thread(target=self._handle, daemon=True)
        self._create_comm = comm.create_comm

    def open(self) -> None:
        """Go to the page, and place every new widget in it."""
        self._server.pages[self._name] = self
        self._thread.start()
        comm.create_comm = type("Comm", (_Comm,), {"page": self})
        self.page.goto(f"{self._server.url}/plain_page.html#{self._name}")
        self._settle()

    def close(self) -> None:
        """Close all its widgets, feeds and recordings."""
        for value in self.namespace.values():
            if isinstance(value, (Feed, RecordingData, Widget)):
                value.close()
        Widget.close_all()
        comm.create_comm = self._create_comm
        del self._server.pages[self._name]
        self.arrived.put(None)
        self._thread.join()

    # Cells

    def run(self, index: int) -> str:
        """Run a cell, show its results, and return its text.

        Raises:
            CellError: it raised.
        """
        self._settle()
        self.page.evaluate("(cell) => host.clear(cell)", index)
        shown: list[Widget] = []
        self.namespace["display"] = lambda *widgets: shown.extend(widgets)
        self._texts[index] = self._execute(self._cells[index], shown)
        self._settle()
        for widget in shown:
            self.page.evaluate("([cell, id]) => host.show(cell, id)", [index, widget.model_id])
        return self._texts[index]

    def run_all(self) -> None:
        """Run the cells from top to bottom. Raises as `run` does."""
        for index in range(len(self._cells)):
            self.run(index)

    def append(self, source: str) -> int:
        """Add a cell at the end, without running it, and return its index."""
        self._cells.append(source)
        return len(self._cells) - 1

    def text(self, index: int) -> str:
        """Return the printed text of a cell, and the text of its result."""
        return self._texts[index]

    def python(self, code: str) -> str:
        """Run code past the cells, after what the page has sent so far; what it prints, or the text of its result.

        Raises:
            CellError: it raised.
        """
        self._settle()
        text = self._execute(code, [])
        # A kernel's answer, too, comes after what the code has sent.
        self._settle()
        return text

    @contextlib.contextmanager
    def busy(self, code: str = "pass") -> Iterator[None]:
        """Run an endless cell within a block; it repeats this code, and messages of the page wait for its end.

        Raises:
            Exception: the code raised it.
        """
        started, ended = threading.Event(), threading.Event()
        compiled = compile(code, "<busy cell>", "exec")

        def run() -> None:
            with self._kernel:
                started.set()
                while not ended.wait(0.001):
                    exec(compiled, self.namespace)

        with ThreadPoolExecutor(1) as cell:
            running = cell.submit(run)
            started.wait()
            self._is_busy = True
            try:
                yield
            finally:
                self._is_busy = False
                ended.set()
            running.result()

    # Elements on show

    def output(self, index: int) -> Locator:
        """The output of a cell."""
        return self.page.locator(f'[data-cell="{index}"]')

    def widget(self, index: int, nth: int = 0) -> Locator:
        """The element of the nth widget that a cell displays."""
        found = self.output(index).locator("> .widget").nth(nth)
        found.wait_for()
        return found

    def drawn(self) -> None:
        """Wait until everything requested is drawn."""
        wait_for_drawing(self.page)

    def theme(self, name: Literal["light", "dark"]) -> None:
        """Switch between light and dark, with the message that JupyterLab sends to widgets."""
        self.page.evaluate("(light) => { document.body.dataset.jpThemeLight = light; }", str(name == "light").lower())

    def resize(self, width: int, height: int = 900) -> None:
        """Size the window such that what a cell displays has `width` CSS pixels."""
        self.page.set_viewport_size({"width": width + MARGIN, "height": height})
        # A busy browser reports its size to the page later. The widgets then draw for it.
        self.page.wait_for_function("(width) => innerWidth === width", arg=width + MARGIN)
        self.drawn()

    # The connection

    def _settle(self) -> None:
        assert not self._is_busy, "the cell that runs would have to end first"
        pacer.flush()
        self.page.evaluate("() => host.settle()")

    def post(self, header: dict[str, Any], buffers: Sequence[Any]) -> None:
        parts = [bytes(buffer) for buffer in buffers]
        text = json.dumps({**header, "sizes": [len(part) for part in parts]}).encode()
        message = struct.pack("<I", len(text)) + text + b"".join(parts)
        with contextlib.suppress(RuntimeError):  # the loop has ended, and with it the page
            self._server.loop.call_soon_threadsafe(self._write, message)

    def _write(self, message: bytes) -> None:
        if self.socket is not None and self.socket.ws_connection is not None:
            self.socket.write_message(message, binary=True)

    def _handle(self) -> None:
        while (message := self.arrived.get()) is not None:
            length = struct.unpack_from("<I", message)[0]
            header = json.loads(message[4 : 4 + length])
            start = 4 + length
            buffers = []
            for size in header["sizes"]:
                buffers.append(memoryview(message)[start : start + size])
                start += size
            with self._kernel:
                if header.get("settle"):
                    self.post({"kind": "settled"}, ())
                elif (found := comm.get_comm_manager().get_comm(header["comm"])) is not None:
                    found.handle_msg({"content": {"data": header["data"]}, "buffers": buffers, "metadata": {}})

    def _execute(self, code: str, shown: list[Widget]) -> str:
        tree = ast.parse(code)
        last = tree.body.pop() if tree.body and isinstance(tree.body[-1], ast.Expr) else None
        # As a notebook does, so that the source of a function is known.
        file = f"<cell {next(_numbers)}>"
        linecache.cache[file] = len(code), None, code.splitlines(keepends=True), file
        printed = io.StringIO()
        with self._kernel, contextlib.redirect_stdout(printed):
            try:
                exec(compile(tree, file, "exec"), self.namespace)
                result = last and eval(compile(ast.Expression(last.value), file, "eval"), self.namespace)
            except Exception:
                raise CellError(traceback.format_exc()) from None
        if isinstance(result, Widget):
            shown.append(result)
            return printed.getvalue()
        return printed.getvalue() + ("" if result is None else repr(result))
