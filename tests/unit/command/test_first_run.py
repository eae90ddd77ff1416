"""Notebooks that ran in a real JupyterLab server before a user opens them."""

import json
import os
import signal
import subprocess
import sys
import time

import nbformat
import pytest

pytestmark = pytest.mark.slow

KERNEL = {"name": "python3", "display_name": "Python 3", "language": "python"}
LIVE = {"tags": ["live"]}
NOTEBOOKS = {
    "whole": ["import ipywidgets; ipywidgets.IntSlider(7)", "print('only when you look')", "print('end')"],
    "long": ["print('begin')", "import time; time.sleep(1000)", "print('never')"],
    "dying": ["print('begin')", "import os; os._exit(1)", "print('never')"],
    "asking": ["print('begin')", "input()", "print('never')"],
    "foreign": ["print('never')"],
}
# For an unknown format, jsonschema builds a grammar at its import, which takes half of a server's start time.
QUICK = """
import sys
sys.modules["rfc3987_syntax"] = None
"""
# Runs every notebook of a folder in one server, and prints the results.
RUN_ALL = (
    QUICK
    + """
import asyncio, json
from pathlib import Path
import nbformat
from nbclient import NotebookClient
from jupyterlab.labapp import LabApp
from robowidgets.command import _first_run, _lab

folder = Path(sys.argv[1])

class Patient(NotebookClient):
    # On a busy machine, too, a kernel comes and a cell ends in time, but for the one that is never to end.
    def __init__(self, content, timeout, **options):
        super().__init__(content, startup_timeout=3600, iopub_timeout=3600, **options)
        self.may_take = timeout

    async def async_execute_cell(self, cell, index):
        self.timeout = self.may_take if "sleep" in cell.source else 3600
        await super().async_execute_cell(cell, index)

_first_run.NotebookClient, _first_run.CELL_SECONDS = Patient, 2
# It restarts a kernel that has died at once, where it may.
hasty = ["--KernelRestarter.time_to_dead=0.1"]
server = LabApp.initialize_server(_lab.arguments(folder / "whole.ipynb", 0, False) + hasty)

async def answer(session):
    client = server.kernel_manager.get_kernel(session["kernel"]["id"]).client()
    client.start_channels()
    await client.wait_for_ready()
    reply = await client.execute_interactive("done = True")
    client.stop_channels()
    return reply["content"]["status"]

async def run(notebook):
    said = []
    await _first_run.run_cells(server, notebook, said.append)
    trusted = server.contents_manager.notary.check_signature(nbformat.read(notebook, as_version=4))
    sessions = [s for s in await server.session_manager.list_sessions() if s["path"] == notebook.name]
    answers = [await answer(session) for session in sessions if notebook.stem != "dying"]
    print(json.dumps([notebook.stem, said, trusted, answers]))
    for session in sessions:
        await server.session_manager.delete_session(session["id"])

async def run_all():
    await asyncio.gather(*map(run, folder.glob("*.ipynb")))

server.io_loop.run_sync(run_all)
"""
)
OPEN = (
    QUICK
    + """
from pathlib import Path
from robowidgets.command import _lab
_lab.run(Path(sys.argv[1]), 0, False, print)
"""
)


def write(file, sources, kernel=KERNEL):
    cells = [nbformat.v4.new_code_cell(source) for source in sources]
    if file.stem == "whole":
        cells[1].metadata.update(LIVE)
    nbformat.write(nbformat.v4.new_notebook(cells=cells, metadata={"kernelspec": kernel}), file)


def environment(folder):
    own = ("JUPYTER_RUNTIME_DIR", "JUPYTER_CONFIG_DIR", "JUPYTER_DATA_DIR", "IPYTHONDIR")
    return os.environ | {name: str(folder / name) for name in own}


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    """The results of each notebook: its cells, its messages, its trust, and the answers of its kernels."""
    folder = tmp_path_factory.mktemp("notebooks")
    for name, sources in NOTEBOOKS.items():
        write(folder / f"{name}.ipynb", sources, KERNEL | ({"name": "cobol"} if name == "foreign" else {}))
    done = subprocess.run(
        [sys.executable, "-c", RUN_ALL, str(folder)],
        env=environment(folder),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stderr
    return {
        name: (nbformat.read(folder / f"{name}.ipynb", as_version=4), said, trusted, answers)
        for name, said, trusted, answers in map(json.loads, done.stdout.splitlines())
    }


def texts(notebook):
    return [[output.get("text", output.output_type) for output in cell.outputs] for cell in notebook.cells]


@pytest.mark.versions
def test_a_notebook_holds_what_its_cells_show_and_the_state_of_its_widgets(run):
    notebook, said, trusted, answers = run["whole"]
    nbformat.validate(notebook)
    view = notebook.cells[0].outputs[0].data["application/vnd.jupyter.widget-view+json"]
    states = notebook.metadata.widgets["application/vnd.jupyter.widget-state+json"].state
    assert states[view.model_id].state.value == 7
    assert texts(notebook)[2] == ["end\n"]
    assert said == []
    assert trusted
    assert answers == ["ok"]


@pytest.mark.versions
def test_a_cell_without_value_in_an_unattended_run_is_left_alone(run):
    cell = run["whole"][0].cells[1]
    assert (cell.execution_count, cell.outputs) == (None, [])


@pytest.mark.versions
@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("asking", "A cell raised StdinNotImplementedError: "),
        ("long", "A cell took more than 2 seconds and was stopped."),
        ("dying", "The kernel failed: Kernel died."),
    ],
)
def test_what_goes_wrong_is_reported_and_what_was_shown_before_is_kept(run, name, reason):
    notebook, (said,), trusted, answers = run[name]
    assert said.startswith(reason)
    assert said.endswith(". Please run the remaining cells yourself.")
    assert texts(notebook) == [["begin\n"], ["error"] if name == "asking" else [], []]
    assert trusted
    assert answers == ([] if name == "dying" else ["ok"])


@pytest.mark.versions
def test_a_missing_kernel_is_reported(run):
    notebook, said, _, answers = run["foreign"]
    assert said == ["The kernel failed: No such kernel named cobol. Please run the remaining cells yourself."]
    assert texts(notebook) == [[]]
    assert answers == []


def test_it_can_be_stopped_while_a_cell_runs(tmp_path, start):
    started = []
    for sent in (signal.SIGTERM, signal.SIGINT):
        folder = tmp_path / sent.name
        folder.mkdir()
        write(folder / "n.ipynb", [f"open({str(folder / 'begun')!r}, 'w').close(); import time; time.sleep(1000)"])
        with (folder / "log").open("w") as log:
            command = [sys.executable, "-c", OPEN, str(folder / "n.ipynb")]
            process = start(command, env=environment(folder), stdin=subprocess.DEVNULL, stdout=log, stderr=log)
        started.append((sent, folder, process))
    for sent, folder, process in started:
        while not (folder / "begun").exists():
            assert process.poll() is None, (folder / "log").read_text()
            time.sleep(0.05)
        process.send_signal(sent)
    for _, folder, process in started:
        assert process.wait() == 0
        said = (folder / "log").read_text()
        assert "http://127.0.0.1" not in said
        assert "Please run the remaining cells yourself" not in said
        assert list(folder.glob("JUPYTER_RUNTIME_DIR/jpserver-*")) == []
