"""Conditions that a widget judges on each sample."""

from __future__ import annotations

import asyncio
import gc
import itertools
import re
import threading
import time
import weakref
from collections.abc import Iterator
from contextvars import ContextVar, copy_context
from typing import Any

import pytest

import robowidgets
from robowidgets import LaserWidget, SpeedWidget, TouchWidget, conditions
from robowidgets.widget import judge
from robowidgets.widget.robot_widget import RobotWidget
from robowidgets.widget.timed_frame import FRAME_HEADER
from robowidgets.widget.watch import MOST_RUNS, _runs

from ..pages import Page, get_edition
from ..waiting import wait_for


@pytest.fixture
def laser() -> Iterator[LaserWidget]:
    made = LaserWidget(title="/scan")
    yield made
    made.close()


def show(laser: LaserWidget, nearest: float) -> None:
    """Five rays from right to left; the middle one sees the nearest thing."""
    laser.update(
        ranges=[2.0, 2.0, nearest, 2.0, 2.0], angle_min=-0.4, angle_increment=0.2, range_min=0.1, range_max=4.0
    )


def lamp(page: Page, name: str = "wall") -> dict[str, Any]:
    """The lamp on the page, or empty if it is not shown."""
    return next((lamp for lamp in page.state["_about"].get("lamps", ()) if lamp["name"] == name), {})


def sequence(state: dict[str, Any]) -> float:
    return float(FRAME_HEADER.unpack_from(state["_frame"])[0]) if state["_frame"] else 0.0


def get_late_judge(widget: RobotWidget[Any]) -> judge.Judge:
    """Return the judge of the conditions of a widget once it has been at work for long."""
    at_work = widget._watches.judge
    assert at_work is not None
    wait_for(lambda: at_work.is_late, "it is at work")
    return at_work


class TestLamp:
    def test_is_lit_with_the_rays_that_made_it_true(self, laser: LaserWidget) -> None:
        page = Page(laser)
        laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
        show(laser, 1.0)
        wait_for(lambda: lamp(page).get("state") == "false", "the lamp is off")
        show(laser, 0.4)
        wait_for(lambda: lamp(page)["state"] == "true", "the lamp is lit")
        assert lamp(page)["text"] == "0.40 < 0.50 m"
        assert lamp(page)["rays"] == [2, 3]
        assert lamp(page)["changes"] == 1
        assert page.state["_about"]["judged"] == sequence(page.state) == 2

    def test_is_unknown_before_the_first_scan_and_gone_when_it_is_watched_no_more(self, laser: LaserWidget) -> None:
        page = Page(laser)
        laser.watch(conditions.nearest_below(0.5), name="wall")
        wait_for(lambda: lamp(page).get("state") == "unknown", "there is a lamp")
        laser.unwatch("wall")
        wait_for(lambda: not lamp(page), "the lamp is gone")
        assert dict(laser.watched) == {}
        show(laser, 0.4)
        wait_for(lambda: sequence(page.state) == 1, "scans come as before")
        with pytest.raises(KeyError, match="no watch 'wall': there are none"):
            laser.unwatch("wall")

    def test_is_never_of_another_scan_than_the_one_on_show(self, laser: LaserWidget) -> None:
        page = Page(laser)
        wall = laser.watch(lambda scan: time.sleep(0.003) or scan.distance() < 0.5, name="wall")
        count = itertools.count()

        def judged() -> list[dict[str, Any]]:
            return [state for state in page.history if state["_frame"] and "judged" in state["_about"]]

        def several_are_judged() -> bool:
            show(laser, 0.4 if next(count) % 2 else 1.0)
            return sum(state["_about"]["lamps"][0]["state"] != "unknown" for state in judged()) > 5

        wait_for(several_are_judged, "several scans are shown with their verdicts")
        for state in judged():
            about = state["_about"]
            assert about["judged"] == sequence(state)
            right = "false" if sequence(state) % 2 else "true"
            assert about["lamps"][0]["state"] in (right, "unknown"), "unknown while the machine was held up"
        show(laser, 0.4)
        wait_for(lambda: wall.value is True, "the last scan is judged")

    def test_of_a_slow_function_is_unknown_and_holds_no_picture_back(self, laser: LaserWidget) -> None:
        page = Page(laser)
        gate = threading.Event()
        laser.watch(lambda _: gate.wait(120), name="wall")
        show(laser, 0.4)
        wait_for(lambda: sequence(page.state) == 1, "the scan is shown")
        assert lamp(page)["state"] == "unknown"
        words = r"has not returned for \d+\.\d s, line \d+$"
        wait_for(lambda: re.match(words, lamp(page)["text"]), "the lamp shows where it hangs")
        show(laser, 0.3)
        wait_for(lambda: sequence(page.state) == 2, "the next scan is shown, too")
        laser.watch(lambda scan: scan.distance() < 0.5, name="wall")
        wait_for(lambda: lamp(page)["state"] == "true", "another condition takes its place")
        gate.set()

    def test_of_a_slow_function_tells_its_verdict_when_it_is_there(self, laser: LaserWidget) -> None:
        page = Page(laser)
        gate = threading.Event()
        laser.watch(lambda scan: gate.wait(120) and scan.distance() < 0.5, name="wall")
        show(laser, 0.4)
        wait_for(lambda: lamp(page).get("text", "").startswith("has not returned"), "the lamp is unknown")
        gate.set()
        wait_for(lambda: lamp(page)["state"] == "true", "the lamp is lit without another scan")
        assert sequence(page.state) == 1

    def test_of_a_function_that_raises_says_so_and_is_off(
        self, laser: LaserWidget, caplog: pytest.LogCaptureFixture
    ) -> None:
        page = Page(laser)
        calls: list[int] = []

        def broken(scan: robowidgets.Scan) -> bool:
            calls.append(1)
            return scan.distance() < 1 / 0

        watch = laser.watch(broken)
        laser.watch(conditions.nearest_below(0.5), name="wall")
        line = broken.__code__.co_firstlineno + 2
        for _ in range(3):
            show(laser, 0.4)
            wait_for(lambda: lamp(page).get("state") == "true", "the other one is judged")
        assert lamp(page, "broken")["state"] == "off"
        assert lamp(page, "broken")["text"] == f"line {line}: ZeroDivisionError: division by zero"
        assert len(calls) == 1
        assert watch.error == lamp(page, "broken")["text"]
        assert (watch.value, bool(watch)) == (None, False)
        assert [record.message for record in caplog.records] == [f"/scan broken: {watch.error}"]
        with pytest.raises(RuntimeError, match="broken: switched off, line"):
            watch.wait()

    def test_of_a_distance_that_is_not_compared_is_off(self, laser: LaserWidget) -> None:
        page = Page(laser)
        laser.watch(lambda scan: scan.distance(), name="wall")
        show(laser, 0.4)
        wait_for(lambda: lamp(page).get("state") == "off", "it is switched off")
        assert "expected True, False or None, got 0.4: compare it, as in ... < 0.3" in lamp(page)["text"]

    @pytest.mark.filterwarnings("ignore::pytest.PytestUnhandledThreadExceptionWarning")
    def test_that_can_be_judged_no_more_holds_no_picture_back(self) -> None:
        class Failing(LaserWidget):
            def _to_judge(self, shown: Any) -> Any:  # noqa: ARG002
                raise MemoryError

        laser = Failing()
        page = Page(laser)
        laser.watch(conditions.nearest_below(0.5), name="wall")
        for number in (1, 2):
            show(laser, 0.4)
            wait_for(lambda number=number: sequence(page.state) == number, "the scan is shown")
            assert lamp(page)["state"] == "unknown"
        laser.close()

    def test_is_in_a_notebook_that_is_saved_after_the_cell(
        self, laser: LaserWidget, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr(judge, "PATIENCE", 120)
        laser.watch(conditions.nearest_below(0.5), name="wall")
        show(laser, 0.4)
        state = laser.get_state()
        assert [lamp["state"] for lamp in state["_about"]["lamps"]] == ["true"]
        assert sequence(state) == 1

    def test_many_runs_of_rays_are_joined(self) -> None:
        assert _runs([3, 4, 9]) == [3, 5, 9, 10]
        runs = _runs(list(range(0, 10_000, 2)))
        assert len(runs) <= 2 * MOST_RUNS
        assert (runs[0], runs[-1]) == (0, 9999)


class TestOtherWidgets:
    def test_speed(self) -> None:
        speed = SpeedWidget()
        page = Page(speed)
        speed.watch(conditions.speed_above(0.3), name="fast")
        speed.update(linear=(0.5, 0, 0))
        wait_for(lambda: lamp(page, "fast").get("state") == "true", "it is fast")
        speed.command(linear=(0.1, 0, 0))
        wait_for(lambda: page.state["_about"]["judged"] == 1 and len(page.sent("_frame")) > 1, "the command is shown")
        assert lamp(page, "fast")["state"] == "true"
        speed.close()

    def test_touch_that_is_released_without_a_message(self) -> None:
        touch = TouchWidget(sensors=["left"], hold=0.1)
        page = Page(touch)
        bump = touch.watch(conditions.touched("left"), name="bump")
        contact = robowidgets.Touch({"left": True}, mode=robowidgets.TouchMode.PRESENCE)
        wait_for(lambda: touch.update(contact) or bump.value, "it is judged before it is over")
        bump.wait(240, value=False)
        wait_for(lambda: lamp(page, "bump")["state"] == "false", "the lamp is off")
        for state in page.history:
            if state["_frame"] and "lamps" in state["_about"]:
                is_touched = b'"touched"' in state["_frame"]
                assert (state["_about"]["lamps"][0]["state"] == "true") == is_touched
        touch.close()

    def test_touch_is_shown_while_a_function_hangs(self) -> None:
        touch = TouchWidget()
        page = Page(touch)
        gate = threading.Event()
        touch.watch(lambda one: not one.touched["left"] or gate.wait(120), name="bump")
        touch.update(left=False)
        wait_for(lambda: lamp(page, "bump").get("state") == "true", "the first is judged")
        touch.update(left=True)
        wait_for(lambda: b'"touched"' in page.state["_frame"], "the second is shown without its verdict")
        assert lamp(page, "bump")["state"] == "unknown"
        touch.close()
        gate.set()


class TestWaiting:
    def test_gives_the_sample_for_which_it_is_true(self, laser: LaserWidget) -> None:
        wall = laser.watch(lambda scan: scan.distance() < 0.5, name="wall")
        show(laser, 1.0)
        timer = threading.Timer(0.1, show, (laser, 0.4))
        timer.start()
        scan = wall.wait(240)
        assert scan.distance() == pytest.approx(0.4)
        assert wall.wait(0) is scan, "it still is"
        assert wall.verdict.rays.tolist() == [2]

    def test_ends_in_time_and_says_what_it_was(self, laser: LaserWidget) -> None:
        wall = laser.watch(lambda scan: scan.distance() < 0.5, name="wall")
        with pytest.raises(TimeoutError, match=r"wall was not true within 0.05 s: it is unknown: no scan came$"):
            wall.wait(0.05)
        show(laser, 1.0)
        wall.wait(240, value=False)
        told = r"wall was not true within 0.05 s: it is false for \d+\.\d s \(1.00 ≥ 0.50 m\)$"
        with pytest.raises(TimeoutError, match=told):
            wall.wait(0.05)
        with pytest.raises(TypeError, match="timeout: expected a number"):
            wall.wait("long")  # type: ignore[arg-type]
        with pytest.raises(ValueError, match="timeout: expected seconds, 0 or more, got -1"):
            wall.wait(-1)

    def test_a_stale_scan_is_unknown(self, laser: LaserWidget, monkeypatch: pytest.MonkeyPatch) -> None:
        wall = laser.watch(conditions.nearest_below(0.5), name="wall")
        show(laser, 0.4)
        wall.wait(240)
        now = time.monotonic()
        monkeypatch.setattr(time, "monotonic", lambda: now + 60)
        assert wall.value is None
        assert wall.verdict.value is True
        with pytest.raises(TimeoutError, match=r"unknown: no new scan for \d+\.\d s"):
            wall.wait(0)

    def test_the_verdict_on_an_old_scan_is_not_that_on_the_newest(
        self, laser: LaserWidget, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        gate = threading.Event()
        clear = laser.watch(lambda scan: scan.distance() > 0.5 or gate.wait(120), name="clear")
        other = laser.watch(conditions.nearest_below(3.0), name="other")
        show(laser, 2.0)
        clear.wait(240)
        other.wait(240)
        show(laser, 0.11)
        late = get_late_judge(laser)
        assert (clear.value, other.value) == (True, True)
        now = time.monotonic()
        monkeypatch.setattr(time, "monotonic", lambda: now + 60)
        monkeypatch.setattr(late._runner, "_now", lambda: now + 60)
        show(laser, 0.11)
        assert (clear.value, other.value) == (None, None)
        words = r"<clear: unknown: conditions at work for \d+\.\d s, 2.00 > 0.50 m, 0 changes>"
        assert re.fullmatch(words, repr(clear))
        with pytest.raises(TimeoutError, match=r"unknown: conditions at work for \d+\.\d s"):
            clear.wait(0)
        gate.set()

    def test_ends_when_it_is_watched_no_more(self, laser: LaserWidget) -> None:
        wall = laser.watch(conditions.nearest_below(0.5), name="wall")
        threading.Timer(0.1, laser.unwatch, ("wall",)).start()
        with pytest.raises(RuntimeError, match="wall: it is no longer watched"):
            wall.wait(240)

    def test_with_await(self, laser: LaserWidget) -> None:
        wall = laser.watch(lambda scan: scan.distance() < 0.5, name="wall")

        async def show_meanwhile() -> None:
            while not wall._wakers:
                await asyncio.sleep(0)
            show(laser, 0.4)

        async def program() -> Any:
            with pytest.raises(TimeoutError, match=r"wall was not true within 0\.01 s"):
                await wall.wait_async(0.01)
            showing = asyncio.ensure_future(show_meanwhile())  # in the same loop, which goes on meanwhile
            scan = await wall.wait_async(240)
            await showing
            return scan

        assert asyncio.run(program()).distance() == pytest.approx(0.4)
        assert wall._wakers == []


class TestChanges:
    def test_are_kept_with_their_times(self, laser: LaserWidget) -> None:
        wall = laser.watch(lambda scan: scan.distance() < 0.5, name="wall")
        before = time.time()
        for nearest, value in ((1.0, False), (0.4, True), (0.3, True), (2.0, False)):
            show(laser, nearest)
            wait_for(lambda nearest=nearest: wall.sample and wall.sample.distance() == nearest, "judged")
            assert wall.value is value
        assert [(change.value, change.text) for change in wall.changes] == [
            (True, "0.40 < 0.50 m"),
            (False, "2.00 ≥ 0.50 m"),
        ]
        assert before <= wall.changes[0].time <= wall.changes[1].time <= time.time()
        assert re.fullmatch(r"<wall: false for \d+\.\d s, 2.00 ≥ 0.50 m, 2 changes>", repr(wall))


class TestArguments:
    def test_what_cannot_be_watched(self, laser: LaserWidget) -> None:
        async def later(_scan: Any) -> bool:
            return True

        for given, error, text in (
            (3, TypeError, "expected a function of one scan, or one of robowidgets.conditions, got 3"),
            (conditions.touched(), ValueError, "anything touched reads a touch; this is a LaserWidget, which has a"),
            (conditions.gap(1), TypeError, "a gap lies between samples"),
            (lambda: True, TypeError, r"expected a function of one scan; .*<lambda> takes \(\)"),
            (lambda _: True, TypeError, 'a lambda has no name; give one, as in name="wall"'),
            (later, TypeError, "expected a plain function, got the coroutine function"),
        ):
            with pytest.raises(error, match=text):
                laser.watch(given)
        with pytest.raises(ValueError, match="name: expected 1 to 40 characters, got ' '"):
            laser.watch(conditions.nearest_below(1), name=" ")
        assert dict(laser.watched) == {}

    def test_names_of_functions_and_conditions(self, laser: LaserWidget) -> None:
        def close(scan: robowidgets.Scan) -> bool:
            return scan.distance() < 0.2

        assert laser.watch(close).name == "close"
        assert laser.watch(conditions.nearest_below(0.5, "front")).name == "nearest below 0.5 m in front"
        assert [*laser.watched] == ["close", "nearest below 0.5 m in front"]

    def test_the_same_watch_goes_to_find(self, laser: LaserWidget) -> None:
        of_function = laser.watch(lambda s: s.distance("front") < 0.2, name="wall")
        ready_made = laser.watch(conditions.nearest_below(0.2, "front"), name="ready-made")
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            assert list(recording.find(of_function)) == list(recording.find(ready_made)) != []
            assert recording.find(of_function).condition == "wall"

    def test_in_a_player_only_the_laser_takes_one(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            player = recording.show("/odom")
        with pytest.raises(ValueError, match=r"a player moves this widget; give the condition to recording\.find"):
            player.views[0].widget.watch(conditions.speed_above(0.5))
        player.close()

    def test_in_a_player_each_scan_has_its_verdict_which_matches_find(self) -> None:
        near = conditions.nearest_below(0.3)
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            found = recording.find(near)
            player = recording.show("/scan", scanogram=False)
        view = player.views[0]
        edition = get_edition(view.widget)
        wall = view.widget.watch(near, name="wall")
        assert get_edition(view.widget) == edition + 1, "the page gets the frames again"
        lit = {timed.seconds: timed.about["lamps"][0] for timed in view.track.frames(0.0, 30.0)}
        for seconds, lamp in lit.items():
            is_found = any(span.start <= seconds < span.end for span in found)
            assert lamp["state"] == ("true" if is_found else "false"), seconds
            assert (lamp["since"], lamp["changes"], bool(lamp["rays"])) == (None, 0, is_found)
        assert {lamp["state"] for lamp in lit.values()} == {"true", "false"}
        player.seek(found[0].start + 0.05)
        assert wall.wait(240) is view.widget.scan
        view.widget.unwatch("wall")
        assert "lamps" not in next(view.track.frames(0.0, 0.1)).about
        player.close()

    def test_in_a_player_too_what_raises_is_switched_off_and_before_the_first_scan_all_is_unknown(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            player = recording.show("/scan", scanogram=False)
        view = player.views[0]
        view.widget.watch(lambda scan: scan.ranges[9999] < 1, name="far")
        frames = [timed.about["lamps"][0] for timed in view.track.frames(5.0, 5.3)]
        assert frames[-1]["state"] == "off"
        assert "IndexError" in frames[-1]["text"]
        view.widget.watch(lambda scan: scan.ranges[0] > 0, name="far")
        lamps = view.widget.frame_of(view.choice.kind.nothing)[0]["lamps"]
        assert [lamp["state"] for lamp in lamps] == ["unknown"]
        player.close()


def test_no_user_function_runs_in_a_thread_that_carries_data(laser: LaserWidget) -> None:
    Page(laser)
    threads: set[str] = set()
    wall = laser.watch(lambda scan: threads.add(threading.current_thread().name) or scan.distance() < 0.5, name="wall")
    threading.Thread(target=show, args=(laser, 0.4), name="data").start()
    wall.wait(240)
    assert threads == {"robowidgets-judge"}


def test_a_condition_runs_in_the_context_of_the_cell_that_watches_so_that_what_it_prints_is_below_that_cell(
    laser: LaserWidget,
) -> None:
    cell: ContextVar[str] = ContextVar("cell", default="another one")
    below: list[str] = []

    def watch() -> None:
        cell.set("that cell")
        laser.watch(lambda _scan: below.append(cell.get()) or True, name="wall")

    copy_context().run(watch)
    show(laser, 0.4)
    wait_for(lambda: below, "it is judged")
    assert set(below) == {"that cell"}


def test_a_function_that_never_ends_is_ended_when_it_is_not_wanted_any_more(laser: LaserWidget) -> None:
    ended: list[bool] = []

    def endless(_scan: Any) -> None:
        try:
            while True:
                time.sleep(0.001)
        finally:
            ended.append(True)

    show(laser, 0.4)
    for end, why in (
        (lambda: laser.watch(conditions.nearest_below(0.5), name="wall"), "another condition has its name now"),
        (lambda: laser.unwatch("wall"), "it is no longer watched"),
        (laser.close, "its widget is closed"),
    ):
        ended.clear()
        wall = laser.watch(endless, name="wall")
        get_late_judge(laser)
        end()
        wait_for(lambda: ended, "it has ended")
        assert wall.error == "", "that is not an error of the function"
        with pytest.raises(RuntimeError, match=f"wall: {why}"):
            wall.wait(0)


def test_a_function_may_end_its_own_watch(laser: LaserWidget) -> None:
    done = threading.Event()
    laser.watch(lambda _: (laser.unwatch("once"), time.sleep(0.01), done.set()) and True, name="once")
    show(laser, 0.4)
    assert done.wait(240)


def test_the_thread_ends_with_the_last_watch_and_with_the_widget() -> None:
    def judging() -> int:
        return sum(thread.name == "robowidgets-judge" for thread in threading.enumerate())

    before = judging()
    laser = LaserWidget()
    laser.watch(conditions.nearest_below(0.5), name="wall")
    wait_for(lambda: judging() == before + 1, "it judges")
    laser.unwatch("wall")
    wait_for(lambda: judging() == before, "it has ended")
    wall = laser.watch(conditions.nearest_below(0.5), name="wall")
    laser.close()
    wait_for(lambda: judging() == before, "it has ended with the widget")
    with pytest.raises(RuntimeError, match="its widget is closed"):
        wall.wait()


def test_a_judge_is_deleted_with_its_widget_though_a_condition_hung() -> None:
    gate = threading.Event()

    def judge_and_close() -> weakref.ref[Any]:
        touch = TouchWidget()
        touch.watch(lambda _: gate.wait(120), name="bump")
        touch.update(left=True)
        late = get_late_judge(touch)
        touch.close()
        return weakref.ref(late)

    judge = judge_and_close()
    gate.set()

    def is_gone() -> bool:
        gc.collect()
        return judge() is None

    wait_for(is_gone, "nothing refers to it")
