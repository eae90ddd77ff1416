"""The threads and the order of locks of a kernel in which every part is at work, against the page that lists them."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

import pytest

from ..feeds.kernel import Kernel
from ..lock_order import problems_of

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "developers" / "threads.md").read_text()
NOTED = f"""
import sys, time
from pathlib import Path
sys.path.insert(0, {str(Path(__file__).parents[1])!r})
import gc, lock_order
lock_order.install()
gc.disable()  # it may close a widget under any lock, which the page says
"""
FULL = """
import robowidgets
from robowidgets import DriveWidget, LaserWidget, MachineWidget, ProgramWidget, SpeedWidget, conditions
from robowidgets.behaviors import Drive

shown = feed.show()
laser, speed, heard = LaserWidget(), SpeedWidget(), []
feed.connect("/scan", laser, heard.append)
feed.connect("/cmd_vel", speed.command)
wall = laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
laser.watch("heard", 1.0)

@feed.program(rate=20)
def avoid(scan):
    return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

of_program, pad = ProgramWidget(feed), DriveWidget(send=feed.drive)
recorder = feed.record({run!r})
player = robowidgets.open(robowidgets.SAMPLE).show(lines=lambda scan: scan.distance("front") < 0.5)
player.seek(5.0)
guarded = feeds.simulator(wander=False, process=True)
guarded.connect("/odom", lambda speed: None)
sheet = robowidgets.find(conditions.nearest_below(0.3), robowidgets.SAMPLE).show()
replayed = feeds.recording(robowidgets.SAMPLE)
of_replayed = replayed.show()
"""
WAIT = """
def threads():
    return {{thread.name for thread in lock_order.threading.enumerate()}}
deadline = time.monotonic() + 240
sheet.widget._on_page(sheet.widget, {{"look": [0], "open": 0}}, [])
while not (len(heard) > 20 and avoid.steps > 20 and wall.sample and {expected!r} <= threads()):
    assert time.monotonic() < deadline, ({expected!r} - threads(), len(heard), avoid)
    player._prefetcher.start()  # as a page does that wants its segments
    player.lines.ask(5.0)
    time.sleep(0.01)
lock_order.write(Path({out!r}))
"""
CHANGE = """
laser.paused = True
laser.paused = False
avoid.pause()
avoid.run()
feed.disconnect("/cmd_vel", speed.command)
laser.unwatch("wall")
feed.stopped = True
feed.stopped = False
laser.wait()
while guarded.status:
    time.sleep(0.01)
guarded.drive(0.1)
guarded.close()
recorder.close()
player.close()
sheet.close()
laser.close()
replayed.close()
feed.close()
lock_order.write(Path({out!r}))
"""


def listed_threads() -> set[str]:
    """The names in the first column of the table; further names of one row are the ends of others."""
    rows = re.findall(r"^\| (`robowidgets-[^|]*) \|", PAGE, re.MULTILINE)
    names = [re.findall(r"`([^`]+)`", row) for row in rows]
    return {name if name.startswith("robowidgets") else f"robowidgets{name}" for row in names for name in row}


@pytest.fixture(scope="module")
def full(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """The notes while all parts were at work, and at the end of all."""
    folder = tmp_path_factory.mktemp("full")
    at_work, at_end = folder / "at_work.json", folder / "at_end.json"
    kernel = Kernel(folder / "heard.txt", before=NOTED)
    expected = listed_threads() - {"robowidgets-dds", "robowidgets-zenoh", "robowidgets-ros2", "robowidgets"}
    try:
        for cell, code in (
            ("full", FULL.format(run=str(folder / "run.mcap"))),
            ("wait", WAIT.format(expected=expected, out=str(at_work))),
            ("change", CHANGE.format(out=str(at_end))),
        ):
            reply = kernel.run(cell, code)
            assert reply["status"] == "ok", "\n".join(reply["traceback"])
    finally:
        kernel.close()
    noted = json.loads(at_work.read_text())
    return {"threads": set(noted["threads"]), "edges": json.loads(at_end.read_text())["edges"]}


@pytest.mark.slow
def test_the_page_lists_every_thread_of_a_full_kernel(full: dict[str, Any]) -> None:
    assert full["threads"] <= listed_threads() | {"robowidgets-log", "robowidgets-changes"}


@pytest.mark.slow
def test_threads_of_a_full_kernel_take_locks_in_the_order_of_the_page(full: dict[str, Any]) -> None:
    assert len(full["edges"]) > 15, "the locks were noted"
    assert problems_of(full["edges"]) == [], "see docs/developers/threads.md"
