"""The server over HTTP on this computer, for those who know its token."""

from __future__ import annotations

import hmac
import secrets
import socket
import threading
from collections.abc import Awaitable, Callable, MutableMapping
from typing import Any

import uvicorn
from starlette.responses import PlainTextResponse

from ..runtime.platform_fixes import run_beside_debugger
from .server import AssistantServer

HOST = "127.0.0.1"
PATH = "/mcp"

_Scope = MutableMapping[str, Any]
_Receive = Callable[[], Awaitable[_Scope]]
_Send = Callable[[_Scope], Awaitable[None]]


class TokenGate:
    """Refuses each request without the token, before anything else reads it.

    Args:
        app: the application behind it.
        token: the token, which a client sends as ``Authorization: Bearer TOKEN``.
    """

    def __init__(self, app: Callable[[_Scope, _Receive, _Send], Awaitable[None]], token: str) -> None:
        self._app, self._expected = app, f"Bearer {token}".encode()

    async def __call__(self, scope: _Scope, receive: _Receive, send: _Send) -> None:
        """Pass a request on, or answer it with 401."""
        if scope["type"] == "http":
            given = [value for key, value in scope["headers"] if key == b"authorization"]
            if len(given) != 1 or not hmac.compare_digest(given[0], self._expected):
                refuse = PlainTextResponse(
                    "expected the token of this server: Authorization: Bearer TOKEN\n",
                    status_code=401,
                    headers={"WWW-Authenticate": "Bearer"},
                )
                await refuse(scope, receive, send)
                return
        await self._app(scope, receive, send)


class HttpServer:
    """A server on a port of this computer.

    The SDK checks that a request names this computer as its host, and comes from no page of another site.

    Args:
        server: the server.
        port: the port, or 0 for any free one.
        token: the token, or empty for a new one.

    Attributes:
        url: the address for clients.
        token: the token.

    Raises:
        ValueError: the port does not exist. OSError: it is taken.
    """

    def __init__(self, server: AssistantServer, port: int = 0, token: str = "") -> None:
        if not 0 <= port <= 65535:
            raise ValueError(f"port: expected 0 to 65535, where 0 is any free one, got {port}")
        self.token = token or secrets.token_urlsafe(32)
        self._socket = socket.create_server((HOST, port))
        self.url = f"http://{HOST}:{self._socket.getsockname()[1]}{PATH}"
        app = TokenGate(server.streamable_http_app(streamable_http_path=PATH, host=HOST), self.token)
        config = uvicorn.Config(app, log_config=None, log_level="warning", timeout_graceful_shutdown=1)
        self._uvicorn = uvicorn.Server(config)
        self._thread: threading.Thread | None = None

    def run(self) -> None:
        """Serve until an interrupt."""
        self._uvicorn.run(sockets=[self._socket])

    def start(self) -> None:
        """Serve in a thread until `close`."""
        self._thread = threading.Thread(target=self.run, name="robowidgets-assistants", daemon=True)
        run_beside_debugger(self._thread)
        self._thread.start()

    def close(self) -> None:
        """Serve no more."""
        self._uvicorn.should_exit = True
        if self._thread is not None:
            self._thread.join(5)
        self._socket.close()
