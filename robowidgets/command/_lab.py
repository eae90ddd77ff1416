"""JupyterLab on this machine only, opened with one notebook."""

from __future__ import annotations

import asyncio
import os
import warnings
from asyncio import Future
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any
from urllib.parse import quote

_ENDING = 1.0
"""Seconds to wait for the tasks of a stopped server to end."""


def is_installed() -> bool:
    """Return True if JupyterLab and a Python kernel are installed."""
    return find_spec("jupyterlab") is not None and find_spec("ipykernel") is not None


def arguments(notebook: Path, port: int | None, browser: bool) -> list[str]:
    """Return the arguments of JupyterLab.

    Args:
        notebook: the file to open. The page can reach only its folder.
        port: the port to listen on, 0 for any free port, or None for JupyterLab's default, the first free one from
            8888.
        browser: True to open the browser.
    """
    options = [
        f"--ServerApp.root_dir={notebook.parent}",
        f"--LabApp.default_url=/lab/tree/{quote(notebook.name)}",
        f"--LabApp.workspaces_dir={notebook.parent / '.workspaces'}",  # without the user's open tabs
        "--ServerApp.ip=127.0.0.1",
        "--Application.log_level=WARN",
    ]
    if port is not None:
        options += [f"--ServerApp.port={port}", "--ServerApp.port_retries=0"]
    if not browser:
        options.append("--ServerApp.open_browser=False")
    if hasattr(os, "geteuid") and os.geteuid() == 0:  # as in containers; the address and the token protect it
        options.append("--ServerApp.allow_root=True")
    return options


def run(
    notebook: Path, port: int | None, browser: bool, say: Callable[[str], None], *, runs_cells: bool = True
) -> None:
    """Run the notebook's cells if ``runs_cells``, then JupyterLab with the notebook open, until it is stopped.

    JupyterLab makes a new random token, which it prints with its address. `say` receives lines for the user.
    """
    os.environ.pop("JUPYTER_TOKEN", None)
    from jupyterlab.labapp import LabApp

    with warnings.catch_warnings():
        # The server itself uses old names of options; users cannot change this.
        warnings.filterwarnings("ignore", r"ServerApp\.\w+ config is deprecated", DeprecationWarning)
        server = LabApp.initialize_server(arguments(notebook, port, browser))
    server.web_app.settings["page_config_hook"] = _without_announcements

    try:
        _serve(server, notebook, say, runs_cells=runs_cells)
    finally:
        end_tasks(server.io_loop.asyncio_loop)


def end_tasks(loop: asyncio.AbstractEventLoop) -> None:
    """Cancel the tasks of a stopped loop: threads of anyio wait for them, and the process waits for the threads."""

    async def end() -> None:
        if tasks := asyncio.all_tasks() - {asyncio.current_task()}:
            for task in tasks:
                task.cancel()
            await asyncio.wait(tasks, timeout=_ENDING)

    loop.run_until_complete(end())


def _serve(server: Any, notebook: Path, say: Callable[[str], None], *, runs_cells: bool) -> None:
    from ._first_run import run_cells

    if not runs_cells:
        server.start()
        return

    # A stopping server interrupts the running cell, so that the run ends while the event loop still runs.
    # Without a terminal to confirm it, an interrupt leaves the loop at once, and the run ends in `end_tasks`.
    left = False

    def is_open() -> bool:
        return not (left or server._stopping)

    def say_if_open(line: str) -> None:
        if is_open():
            say(line)

    def show(ran: Future[None]) -> None:
        if is_open():
            server.start_app()
        ran.result()  # raises unexpected errors of the run, for the log

    server.io_loop.add_future(server.io_loop.asyncio_loop.create_task(run_cells(server, notebook, say_if_open)), show)
    try:
        server.start_ioloop()
    finally:
        left = True


def _without_announcements(_handler: Any, page_config: dict[str, Any]) -> dict[str, Any]:
    """Return the page's config without the question about news and the search for new releases on the web."""
    disabled = [*page_config["disabledExtensions"], "@jupyterlab/apputils-extension:announcements"]
    return page_config | {"disabledExtensions": disabled}
