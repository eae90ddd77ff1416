"""A lesson on the threads of a browser, in CPython: prints its result. Run it in a process of its own."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
import time
import traceback
from pathlib import Path
from types import ModuleType

ROOT = Path(__file__).parents[1]
sys.path.insert(0, str(ROOT))
# The threads come first, as in a browser.
sys.modules["robowidgets"] = ModuleType("robowidgets")
sys.modules["robowidgets"].__path__ = [str(ROOT / "robowidgets")]
from robowidgets.notebook.in_browser import clamp_timers, is_users  # noqa: E402
from robowidgets.runtime.stack_threads import StackThreads  # noqa: E402
from tests.unit import baton_host  # noqa: E402

host = baton_host.BatonHost()
clamp_timers(type(host.loop))
threads = StackThreads(host)
threads.install()
threads.slice_time(lambda code: is_users(code) and code.co_filename != baton_host.__file__)
del sys.modules["robowidgets"]
signal.signal = lambda *_: None  # type: ignore[assignment]  # a browser takes handlers; other threads of CPython may not


def say(name: str, value: object) -> None:
    sys.stdout.write(f"{name}: {value}\n")


def lesson() -> None:
    from robowidgets import LaserWidget, feeds, lessons
    from robowidgets.behaviors import Drive

    laser = LaserWidget(title="/scan")
    feed = feeds.simulator(wander=False)
    feed.connect("/scan", laser)

    @feed.program(rate=20)
    def avoid(scan):  # type: ignore[no-untyped-def]
        return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)

    before = feed.robot.pose
    while avoid.steps < 3:
        time.sleep(0.01)
    say("waited", type(laser.wait(timeout=240)).__name__)
    say("moved", feed.robot.pose != before)
    steps, sequence = avoid.steps, laser.scan
    while avoid.steps < steps + 3 or laser.scan is sequence:
        pass  # a cell that never waits
    say("gave way", True)

    # An edit takes over; a version that does not return is left behind and named.
    @feed.program(rate=20)
    def avoid(scan):  # type: ignore[no-untyped-def]
        while True:
            pass

    while not avoid.error:
        time.sleep(0.01)
    say("error", avoid.error)
    say("lamp", laser.watch(lambda scan: scan.distance() >= 0, name="there").wait(timeout=240) is not None)

    def nearest_on_the_left(scan):  # type: ignore[no-untyped-def]
        while True:
            pass

    say("check", lessons.check(nearest_on_the_left).wrong[0])

    def nearest_on_the_left(scan):  # type: ignore[no-untyped-def]
        return scan.distance("right")

    say("lines", " ".join(str(lessons.check(nearest_on_the_left).lines).split()[-3:]))
    say("right", bool(lessons.check(lambda scan: scan.distance("left"), "nearest_on_the_left")))
    feed.close()
    say("closed", True)
    study_by_its_button()


def study_by_its_button() -> None:
    sys.path.insert(0, str(ROOT / "studies"))
    import study

    with tempfile.TemporaryDirectory() as folder:
        someone = study.Study(1, folder)
        someone.agree()
        while not someone.step[4].is_code:
            someone.give_up()
        box = someone.show()
        _, _, field, buttons, said = box.children
        check, step, given = buttons.children[0], someone.step, someone.step[4].given.partition("\n")[0]
        for body, is_judged in (
            ("while True: pass", lambda: said.value and not check.disabled),
            ("return scan.distance(('-20deg', '20deg'))", lambda: said not in box.children),
        ):
            field.value = f"{given}\n    {body}"
            host.loop.call_from_page(check.click)
            while not is_judged():
                time.sleep(0.01)
        say("a loop in the study", "line 2: a step has not returned for half a second" in said.value)
        say("the study", someone.step is not step)


if __name__ == "__main__":
    try:
        host.run(lesson)
    except BaseException:
        traceback.print_exc()
    sys.stdout.flush()
    os._exit(0)  # a browser's process does not end
