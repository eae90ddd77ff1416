"""The command, as a person uses it: type it, open the address it prints, run the notebook, see the robot."""

from __future__ import annotations

import os
import re
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, expect

from ..conftest import ROOT
from .console import Console
from .server import FOREIGN, OWN_FOLDERS

SAMPLE = ROOT / "robowidgets" / "data" / "sample.mcap"
WIDGETS = 3
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/lab/tree/\S+\?token=\w+")


@pytest.fixture
def robowidgets(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Types a command that opens JupyterLab; the address it prints."""
    started: list[subprocess.Popen[str]] = []
    environment = {name: value for name, value in os.environ.items() if name not in FOREIGN}
    environment |= {name: str(tmp_path / name.lower()) for name in OWN_FOLDERS}

    def run(*words: str | Path) -> str:
        command = [sys.executable, "-m", "robowidgets", *words, "--no-browser", "--port", "0"]
        process = subprocess.Popen(
            command, cwd=tmp_path, env=environment, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True
        )
        started.append(process)
        said = ""
        for line in process.stdout or ():
            said += line
            if address := ADDRESS.search(line):
                return address[0]
        raise AssertionError(f"no address came; the command said:\n{said}")

    yield run
    for process in started:
        process.send_signal(signal.SIGTERM)
        process.communicate(timeout=30)


@pytest.mark.parametrize("words", [["demo"], ["open", SAMPLE]], ids=["demo", "open"])
def test_the_command_leads_to_a_notebook_that_shows_the_robot(
    robowidgets: Callable[..., str],
    browser: Browser,
    pages: list[tuple[Page, Console]],
    words: list[str | Path],
) -> None:
    page = browser.new_page()
    pages.append((page, Console(page)))
    page.goto(robowidgets(*words))
    expect(page.locator("#jp-main-statusbar").get_by_text("| Idle")).to_be_visible(timeout=60_000)
    page.get_by_role("menuitem", name="Run", exact=True).click()
    page.get_by_role("menuitem", name="Run All Cells", exact=True).click()
    raised = page.locator('[data-mime-type="application/vnd.jupyter.error"], [data-mime-type$=".stderr"]')
    for nth in range(WIDGETS):
        expect(page.locator(".rw-card").nth(nth).or_(raised).first).to_be_visible(timeout=60_000)
        assert raised.all_text_contents() == []
