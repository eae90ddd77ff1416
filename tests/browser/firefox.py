"""The system's Firefox, headless, by its own protocol (Marionette): enough to open, click, and ask what it shows."""

from __future__ import annotations

import base64
import json
import shutil
import socket
import subprocess
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ..reserved import free_port

NAMES = ("firefox-esr", "firefox")
SECONDS = 240
"""Seconds that it may stay silent: a page may start JupyterLite on a busy machine."""
_PREFERENCES: dict[str, Any] = {
    # Without a network: all but what this machine serves goes to a proxy that is not there.
    "network.proxy.type": 1,
    "network.proxy.http": "127.0.0.1",
    "network.proxy.http_port": 9,
    "network.proxy.ssl": "127.0.0.1",
    "network.proxy.ssl_port": 9,
    "browser.shell.checkDefaultBrowser": False,
    "datareporting.policy.dataSubmissionEnabled": False,
}


def found() -> str | None:
    """Return the path of Firefox, or None on a machine without it."""
    return next((path for name in NAMES if (path := shutil.which(name))), None)


class Firefox:
    """A Firefox without a network."""

    def __init__(self, stream: socket.socket) -> None:
        self._stream = stream
        self._number = 0
        self._read()
        self._ask("WebDriver:NewSession")

    def open(self, address: Path | str) -> None:
        """Go to a file or to a page that this machine serves, and wait until it is loaded."""
        self._ask("WebDriver:Navigate", url=address.as_uri() if isinstance(address, Path) else address)

    def click(self, selector: str) -> None:
        """Click the first element of a selector."""
        found = self._ask("WebDriver:FindElement", using="css selector", value=selector)["value"]
        self._ask("WebDriver:ElementClick", id=next(iter(found.values())))

    def run(self, script: str) -> Any:
        """Run a script in the page and return its result."""
        return self._ask("WebDriver:ExecuteScript", script=script, args=[])["value"]

    def wait(self, script: str) -> Any:
        """Wait until a script returns something true, and return it."""
        until = time.monotonic() + SECONDS
        while not (value := self.run(script)):
            if time.monotonic() > until:
                shown = self.run("return document.body.innerText")
                raise AssertionError(f"Firefox: still {value!r}: {script}\nThe page shows:\n{shown}")
            time.sleep(0.05)
        return value

    def shoot(self, path: Path) -> None:
        """Photograph the page."""
        path.write_bytes(base64.b64decode(self._ask("WebDriver:TakeScreenshot", full=True)["value"]))

    def _ask(self, command: str, **given: Any) -> Any:
        self._number += 1
        text = json.dumps([0, self._number, command, given])
        self._stream.sendall(f"{len(text.encode())}:{text}".encode())
        _, _, error, result = self._read()
        assert error is None, f"{command}: {error}"
        return result

    def _read(self) -> Any:
        head = b""
        while not head.endswith(b":"):
            head += self._take(1)
        return json.loads(self._take(int(head[:-1])))

    def _take(self, count: int) -> bytes:
        taken = b""
        while len(taken) < count:
            part = self._stream.recv(count - len(taken))
            assert part, "Firefox has ended"
            taken += part
        return taken


@contextmanager
def running(folder: Path, preferences: Mapping[str, Any] | None = None) -> Iterator[Firefox]:
    """Start a Firefox with a new profile in a folder, and with preferences as about:config lists them."""
    path = found()
    assert path
    port = free_port()
    all_of_them = {**_PREFERENCES, **(preferences or {}), "marionette.port": port}
    lines = [f"user_pref({json.dumps(name)}, {json.dumps(value)});" for name, value in all_of_them.items()]
    folder.mkdir(exist_ok=True)
    (folder / "user.js").write_text("\n".join(lines), encoding="utf-8")
    command = [
        path,
        "--headless",
        "--marionette",
        "--no-remote",
        "--width",
        "1280",
        "--height",
        "800",
        "--profile",
        folder,
    ]
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        with _connected(port, process) as stream:
            yield Firefox(stream)
    finally:
        process.terminate()
        process.wait(SECONDS)


def _connected(port: int, process: subprocess.Popen[bytes]) -> socket.socket:
    until = time.monotonic() + SECONDS
    with socket.socket() as asked:
        while asked.connect_ex(("127.0.0.1", port)):
            assert process.poll() is None, "Firefox did not start"
            assert time.monotonic() < until, "Firefox does not answer"
            time.sleep(0.1)
    return socket.create_connection(("127.0.0.1", port), SECONDS)
