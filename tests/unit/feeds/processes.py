"""Robots and routers in processes of their own, which answer lines of JSON with lines of JSON."""

from __future__ import annotations

import json
import os
import queue
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

from ...reserved import free_domain

DOMAIN = free_domain()
"""Test runs on one machine must not hear each other."""


class Process:
    """The process of a script in this folder."""

    def __init__(self, script: str, *arguments: Any) -> None:
        command = [sys.executable, str(Path(__file__).with_name(script)), *map(str, arguments)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._told: queue.Queue[str] = queue.Queue()
        self.matched = threading.Event()
        threading.Thread(target=self._listen, daemon=True).start()

    def do(self, *what: Any) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(what) + "\n")
        self._process.stdin.flush()

    def heard(self) -> Any:
        return json.loads(self._told.get(timeout=120))

    @property
    def unread(self) -> int:
        return self._told.qsize()

    def freeze(self) -> None:
        """Stop the process without any notice to others."""
        self._process.send_signal(signal.SIGSTOP)
        # Its threads stop one after the other; the last might confirm messages that come meanwhile.
        os.waitid(os.P_PID, self._process.pid, os.WSTOPPED | os.WNOWAIT)

    def thaw(self) -> None:
        """Resume the process."""
        self._process.send_signal(signal.SIGCONT)

    def kill(self) -> None:
        self._process.kill()
        self._process.wait()
        assert self._process.stdin is not None
        self._process.stdin.close()

    def _listen(self) -> None:
        assert self._process.stdout is not None
        with self._process.stdout as lines:
            for line in lines:
                if line == '"matched"\n':
                    self.matched.set()
                else:
                    self._told.put(line)


class DdsRobot(Process):
    """The process of `dds_robot`."""

    def __init__(self, lease: str = "10s") -> None:
        super().__init__("dds_robot.py", DOMAIN, lease)
        self.may_lose = False

    def hear(self, topic: str, kind: str, reliable: bool = True) -> None:
        """Make it report the messages of a topic from now on, and set `matched` once it has discovered their publisher.

        Unless it is reliable, it loses what is published before that.
        """
        self.may_lose = not reliable
        self.do("hear", topic, kind, reliable)
        assert self.heard() == "ready"
