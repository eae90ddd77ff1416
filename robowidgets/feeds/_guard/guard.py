"""The process of a guard: starting it, and sharing it among the feeds to one robot."""

from __future__ import annotations

import json
import logging
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import suppress
from pathlib import Path
from typing import NamedTuple

from ...runtime.import_path import import_path
from ..middleware import Outlet
from .link import ENDED, GuardLink
from .mark import SERVER_ENDED

log = logging.getLogger("robowidgets")

OFF = os.environ.get("ROBOWIDGETS_GUARD", "").strip().lower() == "off"
"""True if the environment variable turns the guard off: then the kernel sends all speeds itself."""

NONE_HERE = {"emscripten": "in a browser no process can be started", "win32": "on Windows there is no guard"}.get(
    sys.platform, ""
)
"""The reason why this system has no guard, or empty if it can have one."""

STARTS, OVER = 3, 60.0
"""A guard is started at most this many times within this many seconds."""

READY_TIMEOUT = 25.0
"""Seconds within which the process must be ready. After that the kernel sends speeds."""

END = 14.0
"""Seconds after the request to end at which a guard is killed. Until then it may try to send zero."""

START = """
import sys, types
sys.path += {path!r}
for name, folder in {packages!r}:
    sys.modules[name] = package = types.ModuleType(name)
    package.__path__ = [folder]
from robowidgets.feeds._guard.process import main
main({server})
"""
"""Starts the process without the ``__init__`` modules of packages, which import widgets and many other modules.

The standard library comes first in its path, so a user's file with the name of a standard module is not imported.
"""


class Guard(GuardLink):
    """A process that publishes the speeds of one robot for all feeds of this process to that robot.

    A thread starts the process, and starts another one if it ends.

    Args:
        outlet: the middleware that the process publishes by, with its arguments.
        where: text for the robot.

    Attributes:
        pid: the number of the process, or 0 if it is not running.
    """

    def __init__(self, outlet: Outlet, where: str) -> None:
        super().__init__(where)
        self.unavailable, self._is_starting = NONE_HERE, not NONE_HERE
        self._outlet = outlet
        # The environment when the feed was opened, so that a process that is started later is like the first.
        self._environment = dict(os.environ)
        self._server = _server()
        self._server_has_ended = False
        """True if the process ended because the server of the kernel ended. The kernel ends, too, and sends nothing."""
        self.pid = 0
        self._thread: threading.Thread | None = None

    def start(self) -> None:
        """Start the process unless it is started already."""
        with self._lock:
            if self._thread is None and not self._is_closed and not self.unavailable:
                self._thread = threading.Thread(target=self._run, name="robowidgets-guard", daemon=True)
                self._thread.start()

    def _run(self) -> None:
        starts: list[float] = []
        while not self._is_closed:
            starts = [at for at in starts if at > time.monotonic() - OVER]
            if len(starts) >= STARTS:
                self._is_starting = False
                self.down = f"{self.down}; it has ended {STARTS} times within {OVER:g} s: open the feed again"
                self._call_observers()
                return
            starts.append(time.monotonic())
            self._is_starting = True
            self._has_been_ready, reason = False, ""
            try:
                reason = self._guard_once()
            except OSError as error:
                self.unavailable = f"no process can be started here: {error}"
            else:
                if not (self._has_been_ready or self._is_closed or self.unavailable or self._server_has_ended):
                    self.unavailable = f"its process does not start: {reason.removeprefix(ENDED).strip()}"
            if self.unavailable:
                self._is_starting = False
                self._say(log.warning, f"the kernel sends speeds by itself: {self.unavailable}")
                self._call_observers()
                return
            if reason and not self._is_closed:
                self._say(log.error, f"{reason}; another one is started")

    def _hear_no_more(self, reason: str) -> None:
        self._is_starting = not self._is_closed  # set now, so that a drive waits for the next process
        super()._hear_no_more(reason)

    def _guard_once(self) -> str:
        """Run a process until it ends. Return the reason, or empty if it was asked to end."""
        ours, its = socket.socketpair()
        with ours, its, tempfile.TemporaryFile() as said:
            # -I: no module is imported from the folder of the notebook. -S: neither sitecustomize nor .pth files of a
            # user run. In a new session, an interrupt of the terminal or a signal to the process group of the kernel
            # does not reach it.
            command = [sys.executable, "-I", "-S", "-c", _code(self._server)]
            process = subprocess.Popen(
                command,
                stdin=its.fileno(),
                stdout=said,
                stderr=said,
                env=self._environment,
                start_new_session=True,
            )
            its.close()
            self.pid = process.pid
            self.listen(ours, "open", *self._outlet, ready_timeout=READY_TIMEOUT)
            reason = self.down
            with suppress(subprocess.TimeoutExpired):
                process.wait(0.1 if self._hangs else END)
            process.kill()
            code = process.wait()
            self.pid, self._server_has_ended = 0, code == SERVER_ENDED
            said.seek(max(0, said.seek(0, os.SEEK_END) - 2000))
            last = said.read().decode(errors="replace").strip().splitlines()[-1:]
            self.down = f"{reason} ({'; '.join([f'code {code}', *last])})"
            return self.down


def _code(server: int) -> str:
    """Return the code that the process runs."""
    return START.format(path=_path(), packages=_packages(), server=server)


def _server() -> int:
    """Return the number of the server process that started this kernel, or 0. The kernel ends 1 s after its server."""
    told = os.environ.get("JPY_PARENT_PID", "")
    return os.getppid() if told == str(os.getppid()) else 0


def _path() -> list[str]:
    """Return the import path of the process: the path here without the folder of the notebook and its user files."""
    return [entry for entry in import_path() if entry and Path(entry).absolute() != Path.cwd()]


def _packages() -> list[tuple[str, str]]:
    """Return the packages that import more than a guard needs, with their folders."""
    root = Path(__file__).parents[2]
    return [("robowidgets", str(root)), *((f"robowidgets.{name}", str(root / name)) for name in _LARGE)]


_LARGE = ("feeds", "messages", "samples")


class _Shared(NamedTuple):
    guard: Guard
    feeds: set[int]


_shared: dict[str, _Shared] = {}
"""The guards in use, by their outlets."""
_sharing = threading.Lock()


def guard_for(feed: int, outlet: Outlet, where: str) -> Guard:
    """Return the guard of a robot, shared with one more feed. This does not start it."""
    key = json.dumps(outlet)
    with _sharing:
        there = _shared.get(key)
        if there is None:
            there = _shared[key] = _Shared(Guard(outlet, where), set())
        there.feeds.add(feed)
        return there.guard


def release(feed: int, outlet: Outlet) -> None:
    """Stop using the guard for a feed. After the last feed, the guard ends."""
    with _sharing:
        there = _shared.get(json.dumps(outlet))
        if there is None or feed not in there.feeds:
            return
        there.feeds.discard(feed)
        there.guard.forget(feed)
        if not there.feeds:
            del _shared[json.dumps(outlet)]
            there.guard.close()


def _forget_all() -> None:
    """Forget the guards of the parent of this forked process, whose thread may have held the lock."""
    global _sharing
    _sharing = threading.Lock()
    _shared.clear()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_all)
