"""The first run of a notebook's cells, before the page opens, so that the page shows live widgets."""

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
"""The tag of cells that are skipped, because they only make sense while the user watches."""


async def run_cells(server: Any, notebook: Path, say: Callable[[str], None]) -> None:
    """Run a notebook in a session of the server, and write the outputs of its cells into its file, as trusted.

    JupyterLab joins the session of the notebook, and takes the live widgets from its kernel. The run ends at the first
    cell that fails or takes more than a minute, or if the kernel fails. `say` then receives a line about this, and the
    file contains the outputs up to that cell.

    Args:
        server: JupyterLab's server, with its loop running.
        notebook: a file in the root folder of the server.
        say: receives a line of text.
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
        # The client checks once a second if the kernel is alive. A kernel restarted by the server would seem busy.
        manager.stop_restarter()
        try:
            # Not async_execute, which would handle the signals that stop the server.
            for index, cell in enumerate(content.cells):
                await client.async_execute_cell(cell, index)
        finally:
            kernel.stop_channels()
            manager.start_restarter()
    except CellExecutionError as error:
        say(f"A cell raised {error.ename}: {error.evalue}. Please run the remaining cells yourself.")
    except CellTimeoutError:
        await manager.interrupt_kernel()
        say(f"A cell took more than {CELL_SECONDS} seconds and was stopped. Please run the remaining cells yourself.")
    except (NoSuchKernel, RuntimeError) as error:
        say(f"The kernel failed: {error}. Please run the remaining cells yourself.")
    client.set_widgets_metadata()
    nbformat.write(content, notebook)
    server.contents_manager.notary.sign(nbformat.read(notebook, as_version=4))
