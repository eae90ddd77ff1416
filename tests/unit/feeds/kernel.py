"""A kernel in another process, whose simulated robot logs every command."""

from __future__ import annotations

import ast
from pathlib import Path
from typing import Any

from jupyter_client.blocking.client import BlockingKernelClient
from jupyter_client.manager import KernelManager

OPEN = """
import time
from robowidgets import feeds
from robowidgets.feeds.simulator import Simulated
publish, log = Simulated.publish, open({path!r}, "a", buffering=1)
def note(self, topic, kind, message):
    print((time.monotonic(), message["linear"]["x"], message["angular"]["z"]), file=log)
    publish(self, topic, kind, message)
Simulated.publish = note
feed = feeds.simulator(hz=20, wander=False)
"""
ANEW = "feed.close()\nfeed = feeds.simulator(hz=20, wander=False)"


class Log:
    """The times at which linear and angular speeds reached a robot, by the monotonic clock of the machine.

    Tests poll it while they time the robot: only what is new is read.
    """

    def __init__(self, path: Path) -> None:
        path.touch()
        self.path = path
        self._read = 0
        self._heard: list[tuple[float, float, float]] = []

    def heard(self) -> list[tuple[float, float, float]]:
        with self.path.open("rb") as file:
            file.seek(self._read)
            new = file.read()
        whole = new[: new.rfind(b"\n") + 1]
        self._read += len(whole)
        self._heard += map(ast.literal_eval, whole.decode().splitlines())
        return self._heard

    def forget(self) -> None:
        """Skip the commands up to now."""
        self.heard().clear()


class Kernel:
    """A kernel that runs cells as a notebook does, and the commands of its robot.

    Args:
        path: the log of the robot.
        before: what runs before robowidgets is imported.
    """

    def __init__(self, path: Path, before: str = "") -> None:
        self._log = Log(path)
        # A port that is free when the client chooses it may be taken when the kernel starts, which would then hang.
        self.manager = KernelManager(transport="ipc", connection_file=f"{path}.json")
        self.manager.start_kernel()
        self._client: BlockingKernelClient = self.manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=240)
        assert self.run("open", before + OPEN.format(path=str(path)))["status"] == "ok"

    def open_anew(self) -> None:
        """Open another robot, without commands so far."""
        assert self.run("open", ANEW)["status"] == "ok"
        self._log.forget()

    def start(self, cell: str, code: str) -> str:
        """Run a cell without waiting for it. An error in it does not abort the next one, even if that comes at once."""
        message = self._client.session.msg(
            "execute_request", {"code": code, "silent": False}, metadata={"cellId": cell}
        )
        message["content"].update(store_history=True, user_expressions={}, allow_stdin=False, stop_on_error=False)
        self._client.shell_channel.send(message)
        return str(message["header"]["msg_id"])

    def end_of(self, request: str) -> dict[str, Any]:
        """Wait for the end of a cell, and return the reply."""
        while True:
            reply = self._client.get_shell_msg(timeout=240)
            if reply["parent_header"].get("msg_id") == request:
                content: dict[str, Any] = reply["content"]
                return content

    def run(self, cell: str, code: str) -> dict[str, Any]:
        """Run a cell to its end."""
        return self.end_of(self.start(cell, code))

    def printed(self, cell: str, code: str) -> str:
        """Run a cell to its end; return its printed text."""
        request, printed = self.start(cell, code), ""
        while True:
            message = self._client.get_iopub_msg(timeout=240)
            if message["parent_header"].get("msg_id") != request:
                continue
            if message["msg_type"] == "stream":
                printed += message["content"]["text"]
            elif message["content"].get("execution_state") == "idle":
                self.end_of(request)
                return printed

    def debug(self, command: str, **arguments: Any) -> dict[str, Any]:
        """Send a request to the kernel's debugger, as JupyterLab does; return its reply."""
        request = self._client.session.msg("debug_request", {"type": "request", "command": command, "seq": 1})
        request["content"]["arguments"] = arguments
        self._client.control_channel.send(request)
        reply: dict[str, Any] = self._client.get_control_msg(timeout=240)["content"]
        assert reply["success"], reply
        return dict(reply.get("body", {}))

    @property
    def heard(self) -> list[tuple[float, float, float]]:
        """The speeds that reached the robot, with their times by the monotonic clock of the machine."""
        return self._log.heard()

    def heard_since(self, since: float) -> list[float]:
        """The linear speeds that reached the robot since a time."""
        return [linear for at, linear, _ in self.heard if at >= since]

    def close(self) -> None:
        self._client.stop_channels()
        self.manager.shutdown_kernel(now=True)
