"""A robot in another process."""

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


class RobotProcess:
    """A script of this folder in its own process, which takes lines of JSON and answers with lines.

    Args:
        script: the file name of the script.
        *arguments: its arguments.
    """

    def __init__(self, script: str, *arguments: Any) -> None:
        command = [sys.executable, str(Path(__file__).with_name(script)), *map(str, arguments)]
        self._process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self._told: queue.Queue[str] = queue.Queue()
        threading.Thread(target=self._listen, daemon=True).start()

    def do(self, *what: Any) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps(what) + "\n")
        self._process.stdin.flush()

    def heard(self) -> Any:
        return json.loads(self._told.get(timeout=120))

    @property
    def has_heard(self) -> bool:
        return not self._told.empty()

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
                self._told.put(line)
