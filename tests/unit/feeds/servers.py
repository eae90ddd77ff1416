"""Websocket servers that send what a test wants."""

from __future__ import annotations

import asyncio
import json
import threading
from collections.abc import Callable
from typing import Any

from tornado.httpserver import HTTPServer
from tornado.netutil import bind_sockets
from tornado.web import Application
from tornado.websocket import WebSocketClosedError, WebSocketHandler


class Server:
    """A websocket server in a thread of its own; subclasses answer. A context manager."""

    subprotocols: tuple[str, ...] = ()

    def __init__(self, port: int = 0) -> None:
        self.heard: list[Any] = []
        self.clients: list[WebSocketHandler] = []
        self.opened = 0
        self.offered: list[str] = []
        self._sockets = bind_sockets(port, "127.0.0.1")
        self.port = self._sockets[0].getsockname()[1]
        self._ready = threading.Event()
        self._read: asyncio.Future[None] | None = None
        self._thread = threading.Thread(target=lambda: asyncio.run(self._serve()), daemon=True)

    @property
    def address(self) -> str:
        return f"ws://127.0.0.1:{self.port}"

    def __enter__(self) -> Any:
        self._thread.start()
        self._ready.wait()
        return self

    def __exit__(self, *_: object) -> None:
        self.loop.call_soon_threadsafe(self._end.set)
        self._thread.join()

    def on_open(self, client: WebSocketHandler) -> None:
        """Greet a client, in the server's thread, like the next methods."""

    def on_said(self, client: WebSocketHandler, said: Any) -> None:
        """Answer a client."""

    def on_close(self, client: WebSocketHandler) -> None:
        """Note that the connection to a client ended."""

    def stall(self) -> Callable[[], None]:
        """Read and answer nothing until the returned function is called; the network still accepts data."""
        stalled, go_on = threading.Event(), threading.Event()
        self.loop.call_soon_threadsafe(lambda: (stalled.set(), go_on.wait(120)))
        assert stalled.wait(120)
        return go_on.set

    def hang(self) -> None:
        """Read the next message and nothing after it, not even a ping, but go on sending."""
        ready = threading.Event()

        def stop_reading() -> None:
            self._read = self.loop.create_future()
            ready.set()

        self.loop.call_soon_threadsafe(stop_reading)
        assert ready.wait(120)

    def send(self, said: Any) -> None:
        """Send something to every client, from any thread: bytes and text as they are, everything else as JSON."""
        self.loop.call_soon_threadsafe(lambda: [self.tell(client, said) for client in list(self.clients)])

    def tell(self, client: WebSocketHandler, said: Any) -> None:
        frame = said if isinstance(said, (bytes, str)) else json.dumps(said)
        try:
            client.write_message(frame, binary=isinstance(frame, bytes)).add_done_callback(lambda f: f.exception())
        except WebSocketClosedError:
            self.clients.remove(client)

    def drop(self) -> None:
        """Drop every connection without a closing handshake, from any thread."""
        self.loop.call_soon_threadsafe(lambda: [client.ws_connection.stream.close() for client in self.clients])

    def heard_op(self, op: str) -> list[Any]:
        return [said for said in self.heard if isinstance(said, dict) and said.get("op") == op]

    async def _serve(self) -> None:
        self.loop, self._end = asyncio.get_running_loop(), asyncio.Event()
        server = self

        class Handler(WebSocketHandler):
            def select_subprotocol(self, subprotocols: list[str]) -> str | None:
                server.offered = subprotocols
                return next((name for name in server.subprotocols if name in subprotocols), None)

            def check_origin(self, _origin: str) -> bool:
                return True

            def open(self, *_: str, **__: str) -> None:
                self.set_nodelay(True)
                server.opened += 1
                server.clients.append(self)
                server.on_open(self)

            def on_message(self, message: str | bytes) -> asyncio.Future[None] | None:
                said = json.loads(message) if isinstance(message, str) else message
                server.heard.append(said)
                server.on_said(self, said)
                return server._read

            def on_close(self) -> None:
                if self in server.clients:
                    server.clients.remove(self)
                server.on_close(self)

        web = HTTPServer(Application([("/.*", Handler)]))
        web.add_sockets(self._sockets)
        self._ready.set()
        await self._end.wait()
        web.stop()
        for client in list(self.clients):
            client.ws_connection.stream.close()
        await web.close_all_connections()
