"""A kernel that sleeps, hangs or was restarted: widgets that live by steps look old and show since when."""

from __future__ import annotations

import os
import re
import signal
from collections.abc import Callable, Iterator

import pytest
from playwright.sync_api import Locator, expect

from .chromium import shoot
from .notebook import Notebook

OPEN = """
from robowidgets import MachineWidget, PathWidget, ProgramWidget, TouchWidget, feeds
from robowidgets.behaviors import Drive
from robowidgets.simulator import View
robot = feeds.simulator(wander=False)
class Walker:
    def forward(): return Drive()
    def turn(): return Drive(0, 0.2)
    moves = "forward -> turn after 0.5", "turn -> forward after 0.5"
program = robot.program(Walker, rate=20)
machine, room, card = MachineWidget(robot), View(robot), ProgramWidget(robot)
touch, path = TouchWidget(title="/bumper"), PathWidget(title="/odom")
touch.update(left=True, right=False)
path.update(x=0.5, y=0.2, yaw=0.1)
display(machine, room, card, touch, path)
"""
SILENT = re.compile(r"^no word from the kernel for \d+\.\d s$")
RATE = re.compile(r"\d+\.\d Hz$")
GRABBED = """
picture => {
  const { x, y, width, height } = picture.getBoundingClientRect();
  for (let i = 4; i < width; i += 4)
    for (let j = 4; j < height; j += 4) {
      const place = { clientX: x + i, clientY: y + j, bubbles: true, pointerType: "mouse" };
      picture.dispatchEvent(new PointerEvent("pointermove", place));
      if (picture.dataset.cursor === "grab") return true;
    }
  return false;
}
"""
"""Return True if anything in the picture can be grabbed."""


@pytest.fixture
def stopped() -> Iterator[list[int]]:
    """Processes that a test has paused, which continue at its end."""
    pids: list[int] = []
    yield pids
    for pid in pids:
        os.kill(pid, signal.SIGCONT)


def is_old(nb: Notebook, words: re.Pattern[str] | str) -> None:
    machine, room, program = cards(nb)
    for card in (machine, room):
        expect(card.locator(".rw-silence")).to_have_text(words)
    for card, shown in zip(events(nb), (".rw-field", ".rw-layer"), strict=True):
        expect(card.locator(".rw-silence")).to_have_text(words)
        expect(card.locator(shown).first).to_have_css("opacity", "0.4")
        expect(card.locator(".rw-footer > *").first).to_have_css("opacity", "0.4")
    expect(machine.locator(".rw-machine-board")).to_have_css("opacity", "0.4")
    expect(machine.locator(".rw-footer")).to_contain_text("last step")
    expect(machine.locator(".rw-footer")).not_to_contain_text("Hz")
    expect(machine.locator(".rw-machine-band-foot")).to_contain_text("last step")
    expect(room.locator(".rw-layer").first).to_have_css("opacity", "0.4")
    expect(program.locator(".rw-program-mode")).to_have_text("not known")
    expect(program.locator(".rw-program-driving")).to_have_css("opacity", "0.4")
    expect(program.locator(".rw-hint")).to_contain_text("what the robot does is not known")
    expect(program.locator(".rw-stop")).to_be_enabled()


def is_live(nb: Notebook) -> None:
    machine, room, program = cards(nb)
    for card in (machine, room, *events(nb)):
        expect(card.locator(".rw-silence")).to_be_hidden()
    expect(machine.locator(".rw-footer")).to_have_text(RATE)
    expect(machine.locator(".rw-machine-band-foot")).to_contain_text("now")
    expect(program.locator(".rw-program-mode")).to_have_text("running")


def cards(nb: Notebook) -> tuple[Locator, Locator, Locator]:
    return nb.widget(0, 0), nb.widget(0, 1), nb.widget(0, 2)


def events(nb: Notebook) -> tuple[Locator, Locator]:
    """Cards of data without a fixed rate."""
    return nb.widget(0, 3), nb.widget(0, 4)


def can_be_dragged(nb: Notebook) -> bool:
    return bool(nb.widget(0, 1).locator(".rw-picture").evaluate(GRABBED))


def test_a_kernel_that_hangs_is_reported_and_nothing_is_moved_until_it_goes_on(
    notebook: Callable[..., Notebook], stopped: list[int]
) -> None:
    nb = notebook([OPEN])
    _, room, program = cards(nb)
    is_live(nb)
    assert can_be_dragged(nb)
    # A paused program sends nothing, and nothing is missing.
    program.get_by_role("button", name="Pause").click()
    expect(program.locator(".rw-program-mode")).to_have_text("paused")
    nb.page.evaluate(
        """() => {
            window.toldSilent = [];
            const look = () => {
                for (const said of document.querySelectorAll(".rw-silence, .rw-program-mode, .rw-hint"))
                    if (/no word|not known/.test(said.textContent)) window.toldSilent.push(said.textContent);
            };
            new MutationObserver(look).observe(document.body, { subtree: true, childList: true, characterData: true });
        }"""
    )
    nb.python("def beats(): return [widget.get_state('_beat')['_beat'] for widget in (machine, room, touch, path)]")
    newest = int(nb.python("print(max(beats()))"))
    nb.python(f"import time\nwhile min(beats()) < {newest + 5}: time.sleep(0.05)")
    assert nb.page.evaluate("window.toldSilent") == []
    program.get_by_role("button", name="Run").click()
    is_live(nb)

    pid = int(nb.python("import os; print(os.getpid())"))
    stopped.append(pid)
    os.kill(pid, signal.SIGSTOP)
    is_old(nb, SILENT)
    expect(program.locator(".rw-hint")).to_contain_text("no word from the kernel")
    assert not can_be_dragged(nb)
    expect(room.get_by_role("button", name="Put an obstacle")).to_be_disabled()
    pose = room.locator(".rw-footer > span").first
    before = pose.inner_text()
    room.locator(".rw-picture").press("ArrowUp")
    expect(pose).to_have_text(before)
    shoot(nb.page.locator(".jp-Cell").first, "silent-kernel")
    os.kill(pid, signal.SIGCONT)
    is_live(nb)
    assert can_be_dragged(nb)


def test_a_kernel_that_was_restarted_is_reported(notebook: Callable[..., Notebook]) -> None:
    nb = notebook([OPEN])
    is_live(nb)
    nb.restart_kernel()
    is_old(nb, "no kernel in this page")
    assert not can_be_dragged(nb)
    shoot(nb.page.locator(".jp-Cell").first, "restarted-kernel")
