"""The first run of a notebook's cells, before anybody looks: the page then meets their widgets live."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.kernelspec import NoSuchKernel
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError, CellTimeoutError

CELL_SECONDS = 60
LEFT_TO_THE_READER = "live"
"""The tag of cells that are worth nothing when nobody looks at them run."""


async def run_cells(server: Any, notebook: Path, say: Callable[[str], None]) -> None:
    """Run a notebook in a session of the server, and write what its cells show into its file, as trusted.

    JupyterLab joins the session that a notebook has, and takes the live widgets from its kernel. The first cell that
    fails or takes more than a minute ends the run, and so does a kernel that fails: `say` gets a line that says so, and
    the file holds what was shown up to there.

    Args:
        server: JupyterLab's server, with its loop running.
        notebook: a file in the root folder of the server.
        say: takes a line of text.
    """
    content = nbformat.read(notebook, as_version=4)
    client = NotebookClient(content, timeout=CELL_SECONDS, skip_cells_with_tag=LEFT_TO_THE_READER, record_timing=False)
    manager: Any = None
    try:
        session = await server.session_manager.create_session(
            path=notebook.name, name=notebook.name, type="notebook", kernel_name=content.metadata.kernelspec.name
        )
        client.km = manager = server.kernel_manager.get_kernel(session["kernel"]["id"])
        kernel = await client.async_start_new_kernel_client()
        # The client looks once a second whether the kernel lives: one that the server restarted meanwhile seems busy.
        manager.stop_restarter()
        try:
            # Not async_execute: it takes the signals that stop the server for itself.
            for index, cell in enumerate(content.cells):
                await client.async_execute_cell(cell, index)
        finally:
            kernel.stop_channels()
            manager.start_restarter()
    except CellExecutionError as error:
        say(f"A cell raised {error.ename}: {error.evalue}. The rest is left for you to run.")
    except CellTimeoutError:
        await manager.interrupt_kernel()
        say(f"A cell took more than {CELL_SECONDS} seconds and was stopped. The rest is left for you to run.")
    except (NoSuchKernel, RuntimeError) as error:
        say(f"The kernel failed: {error}. The rest is left for you to run.")
    client.set_widgets_metadata()
    nbformat.write(content, notebook)
    server.contents_manager.notary.sign(nbformat.read(notebook, as_version=4))
