"""JupyterLab, on this machine only, open at one notebook."""

from __future__ import annotations

import os
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from urllib.parse import quote


def is_installed() -> bool:
    """Whether JupyterLab and a Python kernel are there."""
    return find_spec("jupyterlab") is not None and find_spec("ipykernel") is not None


def arguments(notebook: Path, port: int | None, browser: bool) -> list[str]:
    """What JupyterLab is told.

    Args:
        notebook: the file to open; its folder is all that the page can reach.
        port: to listen on, 0 for any that is free; None for JupyterLab's own choice, the first free one from 8888.
        browser: whether to open the browser.
    """
    told = [
        f"--ServerApp.root_dir={notebook.parent}",
        f"--LabApp.default_url=/lab/tree/{quote(notebook.name)}",
        "--ServerApp.ip=127.0.0.1",
        "--Application.log_level=WARN",
    ]
    if port is not None:
        told += [f"--ServerApp.port={port}", "--ServerApp.port_retries=0"]
    if not browser:
        told.append("--ServerApp.open_browser=False")
    if hasattr(os, "geteuid") and os.geteuid() == 0:  # in containers people are root; the address and the token guard
        told.append("--ServerApp.allow_root=True")
    return told


def run(notebook: Path, port: int | None, browser: bool) -> None:
    """Run JupyterLab until it is stopped. It makes a new random token, which it prints with its address."""
    os.environ.pop("JUPYTER_TOKEN", None)
    import_module("jupyterlab.labapp").LabApp.launch_instance(arguments(notebook, port, browser))
