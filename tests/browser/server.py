"""A real JupyterLab with its own settings: it neither reads nor changes the settings of the current user."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.error import URLError
from urllib.request import Request, urlopen

# Nothing pops up, and the tests set the theme.
SETTINGS = {
    "@jupyterlab/apputils-extension:notification": {
        "checkForUpdates": False,
        "doNotDisturbMode": True,
        "fetchNews": "false",
    },
    "@jupyterlab/apputils-extension:themes": {"adaptive-theme": False, "theme": "JupyterLab Light"},
    "@jupyterlab/docmanager-extension:plugin": {"autosave": False},
    "@jupyter-widgets/jupyterlab-manager:plugin": {"saveState": True},
}
OWN_FOLDERS = ("JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "JUPYTER_RUNTIME_DIR", "IPYTHONDIR", "MPLCONFIGDIR")
FOREIGN = ("JUPYTER_PATH", "JUPYTER_CONFIG_PATH", "JUPYTERLAB_DIR", "JUPYTERLAB_SETTINGS_DIR", "JUPYTER_TOKEN")
STARTUP_SECONDS = 240
"""A busy machine takes its time; a test has 300 seconds with its fixtures."""


class LabServer:
    """JupyterLab on a free port of 127.0.0.1, with a token, serving `files`."""

    def __init__(self, home: Path) -> None:
        self.files = home / "files"
        self.log = home / "lab.log"
        self.files.mkdir()
        environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
        environment |= {name: str(home / name.lower()) for name in OWN_FOLDERS}
        overrides = home / "jupyter_config_dir" / "labconfig" / "default_setting_overrides.json"
        overrides.parent.mkdir(parents=True)
        overrides.write_text(json.dumps(SETTINGS))
        command = [sys.executable, "-m", "jupyterlab", "--no-browser", "--allow-root", "--expose-app-in-browser"]
        # Port 0 is any free one: two servers that start at once would find the same first free port.
        command += ["--ip=127.0.0.1", "--port=0", f"--ServerApp.root_dir={self.files}"]
        with self.log.open("w") as log:
            self._process = subprocess.Popen(
                command, cwd=home, env=environment, stdin=subprocess.DEVNULL, stdout=log, stderr=subprocess.STDOUT
            )
        try:
            # The server writes its port here.
            said = home / "jupyter_runtime_dir" / f"jpserver-{self._process.pid}.json"
            self._wait(lambda: said.exists() and said.read_text().endswith("}"), "wrote down its port")
            facts = json.loads(said.read_text())
            self.url, self.token = facts["url"].rstrip("/"), facts["token"]
            self._wait(self._answers, "answered")
        except BaseException:
            self.stop()
            raise

    def request(self, path: str, method: str = "GET") -> Any:
        """Return the JSON of the server's interface, or None if it does not answer."""
        request = Request(f"{self.url}/{path}", method=method, headers={"Authorization": f"token {self.token}"})
        with urlopen(request, timeout=240) as answer:
            body = answer.read()
        return json.loads(body) if body else None

    def interrupt(self, path: str) -> None:
        """Interrupt the kernel of a notebook, past the page."""
        for session in self.request("api/sessions"):
            if session["path"] == path:
                self.request(f"api/kernels/{session['kernel']['id']}/interrupt", "POST")

    def end_sessions(self) -> None:
        """Shut down every kernel that a notebook left running, and forget which notebooks were open."""
        for session in self.request("api/sessions"):
            self.request(f"api/sessions/{session['id']}", "DELETE")
        for name in self.request("lab/api/workspaces")["workspaces"]["ids"]:
            self.request(f"lab/api/workspaces/{name}", "DELETE")

    def stop(self) -> None:
        """End the server and its kernels."""
        self._process.terminate()
        try:
            self._process.wait(15)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _answers(self) -> bool:
        try:
            self.request("api/status")
        except (URLError, TimeoutError):
            return False
        return True

    def _wait(self, condition: Callable[[], bool], what: str) -> None:
        deadline = time.monotonic() + STARTUP_SECONDS
        while not condition():
            if self._process.poll() is not None or time.monotonic() > deadline:
                raise RuntimeError(f"JupyterLab never {what}. Its log ends:\n{self.log.read_text()[-3000:]}")
            time.sleep(0.05)
