"""The use of locks in the package: an interrupt may come between any two steps of Python, and must leave none held."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

import robowidgets

ROOT = Path(robowidgets.__file__).parent
INTERRUPTED = """
import os, random, signal, threading, time
from robowidgets.runtime.coalesced_call import CoalescedCall
from robowidgets.widget.pacer import Pacer
from robowidgets.runtime.waiters import Waiters
from robowidgets.behaviors.program import Program
from robowidgets.behaviors.robot import DrivenRobot
from robowidgets.behaviors.variables import Variables
from robowidgets.behaviors.version import Version
from robowidgets.driving.command_watchdog import CommandWatchdog, Velocity

class Sender:
    def __init__(self):
        self.was_sent = threading.Event()
    def send_newest(self):
        self.was_sent.set()
        return 0

watchdog = CommandWatchdog(lambda *_: None, settle=0.0)  # a busy machine may let it stand still
pacer, sender = Pacer(), Sender()
class Inputs:
    choose = close = lambda *_: None
    take = dict

no = lambda: False
robot = DrivenRobot("robot", no, no, lambda _wake: Inputs(), lambda *_: "", lambda: None)
program = Program("go", robot, Variables())
again = Version(lambda: None, rate=200)

def steps():
    program.pause()
    program.replace(again)
    before, deadline = program.steps, time.monotonic() + 120
    while program.steps <= before + 1:
        assert time.monotonic() < deadline, program
        time.sleep(0.001)
    return True

def rests():
    if program._runner.is_at_work:
        program.pause()
    deadline = time.monotonic() + 120
    while any(one.name == "robowidgets-program" for one in threading.enumerate()):
        assert time.monotonic() < deadline, "a step goes on of which nobody knows"
        time.sleep(0.001)
    return True

lock = threading.RLock()
waiters = Waiters(lock)
calls = []
call = CoalescedCall(lambda: calls.append(1))
began = threading.Event()

def interrupt():
    while True:
        began.wait()
        began.clear()
        time.sleep(random.random() * 0.002)
        os.kill(os.getpid(), signal.SIGINT)

threading.Thread(target=interrupt, daemon=True).start()
for _ in range(400):
    try:
        began.set()
        while True:
            {step}
    except KeyboardInterrupt:
        {works}
"""
LOOPS = {
    "drive": ("watchdog.drive(Velocity(0.3), hold=60.0)", "watchdog.sent_in_time(watchdog.stop(), 120.0)"),
    "flush": ("pacer.flush()", "sender.was_sent.clear(); pacer.mark(sender); assert sender.was_sent.wait(60.0)"),
    "wait": ("waiters.wait_for(lambda: None, 0.0001)", "assert not waiters and not lock._is_owned()"),
    "call": ("call()", "calls.clear(); call(); assert calls"),
    "program": ("program.replace(again); program.pause()", "assert rests(); assert steps()"),
}
"""A step of a loop, and the checks after an interrupt anywhere in it."""
MODULES = {str(path.relative_to(ROOT)): path for path in sorted(ROOT.rglob("*.py"))}


def is_condition(node: ast.AST) -> bool:
    """Return True if this makes a condition: a `threading.Condition`, or a condition of a clock."""
    return isinstance(node, ast.Call) and (
        ast.unparse(node.func) == "threading.Condition" or ast.unparse(node.func).endswith("clock.condition")
    )


def test_a_condition_has_a_lock_of_its_own_name_and_only_that_is_held() -> None:
    texts = {module: path.read_text() for module, path in MODULES.items()}
    trees = {module: ast.parse(text) for module, text in texts.items() if "ondition(" in text}
    assert trees
    for module, tree in trees.items():
        made = [node for node in ast.walk(tree) if is_condition(node)]
        assert all(call.args for call in made if isinstance(call, ast.Call)), f"{module}: threading.Condition(lock)"
        names = {
            ast.unparse(target)
            for node in ast.walk(tree)
            if isinstance(node, ast.Assign) and is_condition(node.value)
            for target in node.targets
        }
        withs = [node for node in ast.walk(tree) if isinstance(node, ast.With)]
        held = {ast.unparse(item.context_expr) for node in withs for item in node.items}
        why = "hold its lock: `with` on a condition runs Python, where an interrupt leaves it held"
        assert not names & held, f"{module}: {why}"


@pytest.mark.slow
@pytest.mark.parametrize("loop", LOOPS)
def test_an_interrupt_anywhere_in_a_loop_leaves_all_at_work(loop: str) -> None:
    step, works = LOOPS[loop]
    command = [sys.executable, "-c", INTERRUPTED.format(step=step, works=works)]
    ended = subprocess.run(command, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stderr) == (0, "")
