"""The HTTP server from which the Rerun viewer in a page fetches its code and data, on this machine only."""

from __future__ import annotations

import logging
import secrets
import threading
from collections.abc import Callable, Iterable, Iterator
from functools import cache, partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

log = logging.getLogger("robowidgets")

HOST = "127.0.0.1"
_TYPES = {".js": "text/javascript", ".wasm": "application/wasm", ".rrd": "application/octet-stream"}
_PIECE = 1 << 20

_HERE = """\
const fetch = (asked, ...more) => {
  const { origin } = new URL(asked.url ?? asked, import.meta.url);
  const here = origin === new URL(import.meta.url).origin;
  return here ? globalThis.fetch(asked, ...more) : Promise.resolve(new Response(null, { status: 403 }));
};
"""

Content = Callable[[], Iterable[bytes]]


class Server:
    """An HTTP server on a free port of 127.0.0.1 that runs until the process ends.

    Any page in the browser can send it requests, because JupyterLab has another port; so each address contains a
    secret.
    """

    def __init__(self) -> None:
        self._contents: dict[str, Content] = {}
        self._secret = secrets.token_urlsafe(16)
        self._server = ThreadingHTTPServer((HOST, 0), partial(_Handler, self._contents))
        self._server.daemon_threads = True
        threading.Thread(target=self._server.serve_forever, name="robowidgets-rerun", daemon=True).start()

    def put(self, name: str, content: Content) -> str:
        """Serve the bytes that a function yields, called for each request, and return their address."""
        path = f"/{self._secret}/{name}"
        self._contents[path] = content
        return f"http://{HOST}:{self._server.server_port}{path}"

    def drop(self, address: str) -> None:
        """Stop serving an address."""
        self._contents.pop(address.removeprefix(f"http://{HOST}:{self._server.server_port}"), None)


@cache
def server() -> Server:
    """Return the server of this process."""
    return Server()


def kept_here(script: str) -> str:
    """Return a JavaScript module changed so that its ``fetch`` reaches only the server of the module.

    The viewer searches the web for its newer releases whenever it starts, and has no option to turn that off.

    Raises:
        RuntimeError: the module can also fetch in another way.
    """
    script = script.replace("arg0.fetch(arg1", "fetch(arg1")
    if ".fetch(" in script:
        raise RuntimeError("the viewer of this rerun-notebook may access the web: use rerun-sdk>=0.41,<0.42")
    return _HERE + script


def read(path: Path) -> Iterator[bytes]:
    """Yield the content of a file in pieces."""
    with path.open("rb") as file:
        while piece := file.read(_PIECE):
            yield piece


class _Handler(BaseHTTPRequestHandler):
    protocol_version = "HTTP/1.1"

    def __init__(self, contents: dict[str, Content], *given: object) -> None:
        self._contents = contents
        super().__init__(*given)  # type: ignore[arg-type]  # passed on unchanged

    def do_GET(self) -> None:  # the name that http.server calls
        content = self._contents.get(self.path)
        if content is None:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Type", _TYPES[Path(self.path).suffix])
        self.send_header("Access-Control-Allow-Origin", "*")
        self.send_header("Transfer-Encoding", "chunked")
        self.end_headers()
        try:
            for piece in content():
                if piece:
                    self.wfile.write(b"%x\r\n%b\r\n" % (len(piece), piece))
            self.wfile.write(b"0\r\n\r\n")
        except ConnectionError:
            self.close_connection = True  # the page was closed
        except Exception:
            log.exception("robowidgets: cannot send the rest of %s to the Rerun viewer", Path(self.path).name)
            self.close_connection = True

    def log_message(self, format: str, *args: object) -> None:  # noqa: A002  # the name of http.server
        """Log nothing, because the notebook would print each request."""
