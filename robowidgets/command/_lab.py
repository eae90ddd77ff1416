"""JupyterLab, on this machine only, open at one notebook."""

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
"""Seconds that tasks of a server have for their end, once it has stopped."""


def is_installed() -> bool:
    """Whether JupyterLab and a Python kernel are installed."""
    return find_spec("jupyterlab") is not None and find_spec("ipykernel") is not None


def arguments(notebook: Path, port: int | None, browser: bool) -> list[str]:
    """The arguments of JupyterLab.

    Args:
        notebook: the file to open; its folder is all that the page can reach.
        port: to listen on, 0 for any that is free; None for JupyterLab's own choice, the first free one from 8888.
        browser: whether to open the browser.
    """
    options = [
        f"--ServerApp.root_dir={notebook.parent}",
        f"--LabApp.default_url=/lab/tree/{quote(notebook.name)}",
        f"--LabApp.workspaces_dir={notebook.parent / '.workspaces'}",  # a workspace of its own, without the user's tabs
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
    """Run the notebook's cells, if asked to, then JupyterLab with the notebook open, until it is stopped.

    JupyterLab makes a new random token, which it prints with its address. `say` takes lines for the person who waits.
    """
    os.environ.pop("JUPYTER_TOKEN", None)
    from jupyterlab.labapp import LabApp

    with warnings.catch_warnings():
        # Options that the server itself reads by their old names; a user can do nothing about them.
        warnings.filterwarnings("ignore", r"ServerApp\.\w+ config is deprecated", DeprecationWarning)
        server = LabApp.initialize_server(arguments(notebook, port, browser))
    server.web_app.settings["page_config_hook"] = _without_announcements

    try:
        _serve(server, notebook, say, runs_cells=runs_cells)
    finally:
        end_tasks(server.io_loop.asyncio_loop)


def end_tasks(loop: asyncio.AbstractEventLoop) -> None:
    """End what a stopped loop has left: threads of anyio wait for the end of a task, and the process waits for them."""

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

    # A server that is stopped interrupts the running cell, so the run ends while its event loop still runs.
    # An interrupt leaves the loop at once where no terminal asks: the run ends in `end_tasks`.
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
    """Without the question about news, and without asking the web for new releases."""
    disabled = [*page_config["disabledExtensions"], "@jupyterlab/apputils-extension:announcements"]
    return page_config | {"disabledExtensions": disabled}
