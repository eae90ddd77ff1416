"""The command as users run it: type it, open the address it prints, see the robot, and move through time."""

from __future__ import annotations

import os
import re
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from playwright.sync_api import Browser, Page, Request, expect

from ..conftest import ROOT
from .chromium import shoot
from .console import Console
from .server import FOREIGN, OWN_FOLDERS

SAMPLE = ROOT / "robowidgets" / "data" / "sample.mcap"
# The texts on the canvases of an element, as one text.
PICTURE = "card => [...card.querySelectorAll('canvas')].map((canvas) => canvas.toDataURL()).join()"
ADDRESS = re.compile(r"http://127\.0\.0\.1:\d+/lab/tree/\S+\?token=\w+")

PATIENCE_MS = 300_000
"""A kernel and all of JupyterLab start: no page of the other tests is used again here."""


def saves_tabs(request: Request) -> bool:
    return request.method == "PUT" and "/lab/api/workspaces" in request.url


@pytest.fixture
def robowidgets(tmp_path: Path) -> Iterator[Callable[..., str]]:
    """Run a command that opens JupyterLab, and return the address it prints."""
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
        process.communicate(timeout=600)


@pytest.mark.parametrize("command", ["demo", "open"])
def test_the_command_leads_to_a_page_that_shows_the_robot_live_with_no_cell_run_by_hand_and_nothing_before_it(
    robowidgets: Callable[..., str],
    browser: Browser,
    pages: list[tuple[Page, Console]],
    command: str,
    tmp_path: Path,
) -> None:
    words: list[str | Path] = [command]
    if command == "open":
        words.append(tmp_path / 'it\'s a "drive".mcap')
        shutil.copyfile(SAMPLE, words[1])
    page = browser.new_page(viewport={"width": 1280, "height": 900})
    pages.append((page, Console(page)))
    address = robowidgets(*words)
    with page.expect_request(saves_tabs, timeout=PATIENCE_MS) as saved:
        page.goto(address)
        expect(page.locator(".rw-card").first).to_be_visible(timeout=PATIENCE_MS)
    assert saved.value.response()
    assert not (tmp_path / "jupyter_config_dir" / "lab" / "workspaces").exists(), "the tabs of the person stay"
    assert page.locator(".jp-Dialog, .Toastify__toast").all_text_contents() == []
    expect(page.locator(".jp-Notification-Status-Text")).to_have_text("0")

    laser, speed, touch = (page.locator(f".rw-{kind}").first for kind in ("laser", "speed", "touch"))
    expect(laser).to_contain_text(re.compile(r"/scan.*nearest \d\.\d\d m", re.DOTALL), timeout=PATIENCE_MS)
    expect(speed).to_contain_text(re.compile(r"/odom.*0\.00", re.DOTALL))
    expect(touch).to_contain_text(re.compile(r"/bumper.*3\s*unknown", re.DOTALL))
    shoot(page.locator("#main"), f"command-{command}")

    before = laser.evaluate(PICTURE)
    assert before.startswith("data:image/png")
    page.locator(".rw-player input[type=range]").first.click()
    expect(page.locator(".rw-play-now").first).to_have_text(re.compile(r"^(28|29|30)\.\d\d$"))
    expect(touch).to_contain_text(re.compile(r"[1-9] touches"))
    page.wait_for_function(f"before => ({PICTURE})(document.querySelector('.rw-laser')) !== before", arg=before)
