"""The simulated robot in its own process."""

from __future__ import annotations

import ctypes
import os
import signal
import subprocess
import sys
import time
from contextlib import suppress
from pathlib import Path

import pytest

from robowidgets import feeds
from robowidgets.feeds.simulator import Simulated
from robowidgets.simulator import Robot, World, robot_process
from robowidgets.simulator.robot_process import MISSED, RobotProcess, _Outbox

from ..waiting import wait_for

pytestmark = pytest.mark.slow
ROOM = World([(3.0, -2.0, 3.0, 2.0)])


def hold_the_interpreter() -> None:
    """Block all other threads of this process for two seconds."""
    ctypes.PyDLL(None).usleep(2_000_000)


def test_it_starts_whatever_lies_in_the_folder_of_the_notebook(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("types", "pickle"):
        (tmp_path / f"{name}.py").write_text("raise RuntimeError('of the user')")
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(tmp_path)
    with feeds.simulator(room=ROOM, process=True, wander=False) as feed:
        feed.drive(0.3)
        wait_for(lambda: feed.robot.pose.x > 0.01, "it drives")


def test_it_is_driven_measured_moved_and_goes_on_while_a_call_holds_the_interpreter() -> None:
    with feeds.simulator(room=ROOM, process=True, wander=False, hz=20) as feed:
        view = feed.show()
        assert sorted(view.widgets) == ["/bumper", "/odom", "/scan"], "before the process has begun, too"
        robot, scans = feed.robot, feed.scans("/scan", timeout=120)
        assert next(scans).distance("front") == pytest.approx(3.0, abs=0.1)
        for widget in view.widgets.values():
            assert widget.wait()
        feed.drive(0.3)
        wait_for(lambda: robot.pose.x > 0.1, "it drives")
        feed.stop()
        wait_for(lambda: robot.command().linear[0] == 0.0, "it stops")
        robot.move_to(1.0, 0.0, 0.0)
        wait_for(lambda: next(scans).distance("front") == pytest.approx(2.0, abs=0.1), "it is seen from there")
        robot.world = ROOM.with_obstacles([(2.0, 0.0, 0.3)])
        wait_for(lambda: next(scans).distance("front") == pytest.approx(0.7, abs=0.1), "the obstacle is seen")
        assert robot.pose.x == pytest.approx(1.0, abs=0.05)
        assert not next(scans).ranges.flags.writeable

        def goes_on() -> bool:
            before = robot.time
            hold_the_interpreter()
            returned = time.monotonic()
            wait_for(lambda: robot.time > before, "it is heard again")
            # A robot in this process would have stood still, and catches up with one second at most.
            return robot.time - before - (time.monotonic() - returned) > 1.2

        wait_for(goes_on, "its time goes on meanwhile")


def test_a_reset_sets_its_odometry_back_too() -> None:
    with feeds.simulator(room=ROOM, process=True, wander=False, hz=20) as feed:
        robot = feed.robot
        start = robot.odometry
        feed.drive(0.3)
        wait_for(lambda: robot.pose.x > 0.1, "it drives")
        feed.stop()
        wait_for(lambda: robot.command().linear[0] == 0.0, "it stops")
        before = robot.time
        wait_for(lambda: robot.time > before + 2.0, "it stands")
        assert robot.odometry.x > start.x + 0.05
        feed.reset()
        before = robot.time
        wait_for(lambda: robot.time > before + 0.5, "the state of the other one was reported")
        assert robot.odometry == start


def test_a_guard_in_its_process_stops_it_while_a_call_holds_the_interpreter() -> None:
    with feeds.simulator(room=World([(90.0, -2.0, 90.0, 2.0)]), process=True, wander=False, hz=50) as feed:
        robot = feed.robot
        feed.driving = feeds.Driving(hold=60.0)
        feed.drive(0.3)
        wait_for(lambda: robot.pose.x > 0.1, "it drives")
        feed.drive(0.3)
        before, place = robot.time, robot.pose.x
        hold_the_interpreter()
        wait_for(lambda: robot.time > before + 1.5, "its time has gone on meanwhile")
        # On a busy computer the guard may stand still, too.
        reports = "the guard stopped the robot meanwhile", "the guard stood still"
        wait_for(lambda: any(one in feed.drive_status for one in reports), "it is reported")
        wait_for(lambda: robot.command().linear[0] == 0.0, "it stands")
        assert robot.pose.x - place < 0.3 * (robot.time - before) / 2

        def drives() -> bool:
            with suppress(feeds.FeedError):  # at first: the speed may be based on data from before that
                feed.drive(0.2)
            return bool(robot.command().linear[0] == 0.2)

        wait_for(drives, "it drives again")


def test_each_sample_is_recorded_while_a_call_holds_the_interpreter(tmp_path: Path) -> None:
    with feeds.simulator(room=ROOM, process=True, wander=False, hz=100) as feed:
        with feed.record(tmp_path / "run.mcap", "/odom") as recorder:
            wait_for(lambda: recorder.written["/odom"] > 10, "it records")
            recorded, before = recorder.written["/odom"], feed.robot.time
            hold_the_interpreter()
            wait_for(lambda: recorder.written["/odom"] >= recorded + 100, "what came meanwhile is recorded")
            steps = round((feed.robot.time - before) * 100)
            wait_for(lambda: recorder.written["/odom"] >= recorded + steps - 2, "all of it is")
        assert recorder.problems == ()


WRITES = """
import pickle, sys
first = [("/odom", 1), ("/scan", 2), ("/odom", 3), ("missed", ("/odom", 4))]
for messages in (first, [("/odom", 5)]): pickle.dump(messages, sys.stdout.buffer)
"""


def test_of_samples_that_come_together_callers_of_the_newest_get_only_the_last(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(robot_process, "SERVE", WRITES)
    got: list[tuple[object, ...]] = []
    process = RobotProcess(Robot(ROOM), 20, False, ())
    told = process.run(
        lambda *sample, newest: got.append((*sample, newest)),
        lambda: got.append(("started",)),
        lambda *missed: got.append(("missed", *missed)),
    )
    of_first = [("/odom", 1, False), ("/scan", 2, True), ("/odom", 3, True), ("missed", "/odom", 4)]
    assert got == [("started",), *of_first, ("/odom", 5, True)]
    assert told == "its process has ended, with code 0"


def test_of_samples_that_wait_too_long_the_oldest_are_dropped_and_counted(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robot_process, "MOST_WAITING", 3)
    outbox = _Outbox()
    outbox.each = ("/odom",)
    for number in range(5):
        outbox.put("/odom", number)
        outbox.put("/scan", number)
    assert outbox.take() == [("/odom", 2), ("/odom", 3), ("/odom", 4), ("/scan", 4), (MISSED, ("/odom", 2))]
    outbox.put("/odom", 5)
    assert outbox.take() == [("/odom", 5)]


def test_a_robot_whose_process_is_killed_goes_on_where_it_was() -> None:
    with feeds.simulator(room=ROOM, process=True, wander=False, hz=20) as feed:
        wait_for(lambda: feed.robot.time > 0.1, "it runs")
        feed.robot.move_to(1.0, 0.5, 0.0)
        middleware = feed.connection.middleware
        assert isinstance(middleware, Simulated)
        process = middleware._live
        assert isinstance(process, RobotProcess)
        os.kill(process.pid, signal.SIGKILL)
        wait_for(lambda: "its process has ended, with code -9" in feed.status, "the feed says so")
        wait_for(lambda: not feed.status, "another process runs")
        before = feed.robot.time
        wait_for(lambda: feed.robot.time > before, "time goes on")
        assert feed.robot.pose[:2] == pytest.approx((1.0, 0.5))


OPEN = """
import os, time
from robowidgets import feeds
feed = feeds.simulator(process=True)
while not feed.robot.time: time.sleep(0.01)
if {forks}: pid = os.fork()
if not {forks} or pid: print(feed.connection.middleware._live.pid, flush=True)
time.sleep(60 if not {forks} or pid else 5)
"""


@pytest.mark.parametrize("forks", [False, True])
def test_it_ends_with_the_process_that_opened_it_though_that_is_killed_and_a_fork_has_its_pipes(forks: bool) -> None:
    opener = subprocess.Popen([sys.executable, "-c", OPEN.format(forks=forks)], stdout=subprocess.PIPE, text=True)
    assert opener.stdout
    pid = int(opener.stdout.readline())
    assert Path(f"/proc/{pid}").exists()
    opener.kill()
    opener.wait()
    wait_for(lambda: not Path(f"/proc/{pid}").exists() or _is_zombie(pid), "it has ended")
    opener.stdout.close()


def _is_zombie(pid: int) -> bool:
    return " Z " in Path(f"/proc/{pid}/stat").read_text()
