"""Shapes that programs draw on a scan."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator
from math import inf, nan, pi
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import Arc, Arrow, LaserWidget, Line, Points, Polygon, Text
from robowidgets.widget import judge
from robowidgets.widget.pacer import INTERVAL, pacer

from ..pages import Page, get_edition
from ..waiting import wait_for

SCAN: dict[str, Any] = {
    "ranges": [2.0, nan, 4.0],
    "angle_min": -pi / 2,
    "angle_increment": pi / 2,
    "range_min": 0.1,
    "range_max": 10.0,
}
WALL = Line((1, -1), (1, 1))


@pytest.fixture
def laser() -> Iterator[LaserWidget]:
    widget = LaserWidget(title="/scan")
    widget.update(SCAN)
    yield widget
    widget.close()


@pytest.fixture
def page(laser: LaserWidget) -> Page:
    return Page(laser)


def on_page(page: Page) -> list[dict[str, Any]]:
    """The shapes that the page has."""
    pacer.flush()
    shapes: list[dict[str, Any]] = page.state["_about"].get("shapes", [])
    return shapes


class TestShapes:
    def test_places_are_metres_rays_or_indices(self, laser: LaserWidget) -> None:
        scan = laser.scan
        assert scan
        assert Line((1, -1), (1, 1)).form == {"kind": "line", "at": [[1.0, -1.0], [1.0, 1.0]]}
        assert Line(scan[0], 2).form["at"] == [[pytest.approx(0, abs=1e-9), -2.0], 2]
        assert Line(np.array([[1, 2], [3, 4]])) == Line([(1, 2), (3, 4)]) == Line((1, 2), (3, 4))
        assert Points(range(3)).form["at"] == [0, 1, 2]
        assert Points(np.float32([[1.5, 2]])).form["at"] == Points((1.5, 2)).form["at"] == [[1.5, 2.0]]
        assert len(Polygon([(0, 0), (1, 0), (1, 1)]).form["at"]) == 3

    def test_angles_may_be_in_degrees(self) -> None:
        assert Arc(0.5, "-90deg", "90deg") == Arc(0.5, -pi / 2, pi / 2)
        assert Arrow((1, 2), "90deg").form == {"kind": "arrow", "at": [[1.0, 2.0]], "yaw": pi / 2}
        assert Arc(0.5).form == {"kind": "arc", "at": [[0.0, 0.0]], "radius": 0.5, "start": 0.0, "end": 2 * pi}

    def test_shapes_are_values(self) -> None:
        assert WALL == Line((1.0, -1.0), (1.0, 1.0)) != Points([(1, -1), (1, 1)])
        assert len({WALL, Line((1, -1), (1, 1)), Text((0, 0), "a")}) == 2
        assert repr(WALL) == "Line(at=[[1.0, -1.0], [1.0, 1.0]])"
        with pytest.raises(AttributeError, match="a Line does not change; draw another one under the same name"):
            WALL.kind = "arc"  # type: ignore[misc]

    @pytest.mark.parametrize(
        ("make", "error", "text"),
        [
            (lambda: Line((1, 1)), ValueError, "Line: expected 2 to 2,000 places, got 1"),
            (
                lambda: Line((1, 1), "b"),
                TypeError,
                r"Line: expected \(x, y\) in metres, a ray or the index of one; got",
            ),
            (lambda: Line(3), ValueError, "Line: expected 2 to 2,000 places, got 1"),
            (lambda: Line("ab"), TypeError, r"Line: expected places, like \(1.0, -0.5\) in metres .* got 'ab'"),
            (lambda: Line((1, nan), (1, 1)), ValueError, r"Line: expected finite metres, .* got \(1, nan\)"),
            (lambda: Line((1, 1e9), (1, 1)), ValueError, "Line: expected finite metres, at most 100,000 away"),
            (lambda: Line(-1, 3), ValueError, "Line: expected the index of a ray, 0 or more, got -1"),
            (lambda: Points(np.zeros((3, 3))), TypeError, "Points: expected"),
            (lambda: Points(np.zeros((2001, 2))), ValueError, "Points: expected 1 to 2,000 places, got 2,001"),
            (lambda: Polygon([(0, 0), (1, 0)]), ValueError, "Polygon: expected 3 to 2,000 places, got 2"),
            (lambda: Arc(0), ValueError, "Arc.radius: expected metres above 0"),
            (lambda: Arc(1, 90), ValueError, "Arc.start: expected radians within ±2 pi, got 90.0; math.radians"),
            (lambda: Arrow((1, 1), inf), ValueError, "Arrow.yaw: expected a finite number of radians"),
            (lambda: Text((1, 1), ""), ValueError, "Text.text: expected 1 to 60 characters, got ''"),
            (lambda: Text((1, 1), 5), TypeError, "Text.text: expected text, got 5"),
        ],
    )
    def test_a_shape_that_cannot_be_is_refused(self, make: Any, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            make()

    def test_a_ray_without_a_reading_is_not_a_place(self, laser: LaserWidget) -> None:
        assert laser.scan
        with pytest.raises(ValueError, match="Line: ray 1 has no reading; leave it out, or draw it as an index"):
            Line(laser.scan[0], laser.scan[1])

    def test_all_are_names_of_the_package(self) -> None:
        assert {"Line", "Points", "Polygon", "Text", "Arc", "Arrow"} <= set(robowidgets.__all__)


class TestDraw:
    def test_a_shape_is_replaced_by_its_name_and_removed_by_none(self, laser: LaserWidget, page: Page) -> None:
        laser.draw("wall", WALL)
        laser.draw("zone", [Arc(0.5), Text((1, 0), "stop")], color="#12854a")
        assert [(one["name"], one["kind"], one.get("color")) for one in on_page(page)] == [
            ("wall", "line", None),
            ("zone", "arc", "#12854a"),
            ("zone", "text", "#12854a"),
        ]
        laser.draw("wall", Line(0, 2))
        assert on_page(page)[0]["at"] == [0, 2]
        laser.draw("zone", None)
        assert [one["name"] for one in on_page(page)] == ["wall"]
        assert dict(laser.drawn) == {"wall": (Line(0, 2),)}
        laser.draw("wall", None)
        laser.draw("never there", None)
        assert on_page(page) == []
        assert dict(laser.drawn) == {}

    def test_shapes_stay_when_scans_come(self, laser: LaserWidget, page: Page) -> None:
        laser.draw("wall", WALL)
        laser.update(SCAN)
        assert on_page(page) == [{"name": "wall", **WALL.form}]

    def test_a_loop_without_a_pause_sends_few_messages_and_the_last_shape(self, laser: LaserWidget, page: Page) -> None:
        on_page(page)
        before, began = len(page.messages), time.monotonic()
        for i in range(2000):
            laser.draw("wall", Line((1, -1), (1, i)))
        assert on_page(page)[0]["at"][1] == [1.0, 1999.0]
        assert len(page.messages) - before <= 2 + (time.monotonic() - began) / INTERVAL

    def test_a_shape_on_a_scan_is_sent_with_the_verdicts_on_it(
        self, laser: LaserWidget, page: Page, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        judging, may_end = threading.Event(), threading.Event()

        def close(scan: Any) -> bool:
            judging.set()
            return may_end.wait(120)

        monkeypatch.setattr(judge, "CONDITION", judge.CONDITION._replace(late=600.0))
        laser.watch(close, name="close")
        assert judging.wait(120)
        marked: list[object] = []
        mark = pacer.mark
        monkeypatch.setattr(pacer, "mark", lambda sender: (marked.append(sender), mark(sender)))
        laser.update(SCAN)
        laser.draw("wall", WALL)
        assert marked == []
        may_end.set()
        wait_for(lambda: page.state["_about"].get("shapes"), "the shape came")
        assert [one["state"] for one in page.state["_about"]["lamps"]] == ["true"]
        laser.draw("other", WALL)
        wait_for(lambda: len(page.state["_about"]["shapes"]) == 2, "a shape without a new scan came")

    def test_a_shape_goes_when_its_time_is_over(self, laser: LaserWidget, page: Page) -> None:
        laser.draw("brief", WALL, lifetime=0.15)
        laser.draw("later", WALL, lifetime=0.3)
        laser.draw("stays", WALL)
        sent = {one["name"]: one.get("left") for one in on_page(page)}
        assert 0 < sent["brief"] <= 0.15 < sent["later"] <= 0.3
        assert sent["stays"] is None
        wait_for(lambda: "brief" not in laser.drawn, "its time was over")
        wait_for(lambda: len(page.state["_about"]["shapes"]) == 2, "Python updated the page, without another call")
        wait_for(lambda: len(page.state["_about"]["shapes"]) == 1, "the second went as well")

    def test_a_shape_that_is_drawn_again_lives_on(self, laser: LaserWidget) -> None:
        laser.draw("wall", WALL, lifetime=0.05)
        laser.draw("wall", WALL, lifetime=60)
        laser.draw("clock", WALL, lifetime=0.1)
        wait_for(lambda: "clock" not in laser.drawn, "more than the first lifetime was over")
        assert "wall" in laser.drawn

    @pytest.mark.parametrize(
        ("name", "shape", "more", "error", "text"),
        [
            ("", WALL, {}, ValueError, "^name: expected 1 to 60 characters, got ''$"),
            (5, WALL, {}, TypeError, "^name: expected text, got 5$"),
            ("a", (1, 2), {}, TypeError, r"^draw\('a'\): expected a Line, Points, Polygon, .* got \(1, 2\)$"),
            ("a", Line, {}, TypeError, r"^draw\('a'\): a function of a scan is for widgets in the player of a rec"),
            ("a", WALL, {"color": "reddish"}, ValueError, '^color: expected one like "#12854a", or one of black, blue'),
            ("a", WALL, {"lifetime": 0}, ValueError, "^lifetime: expected seconds above 0, or None to stay, got 0$"),
            (
                "a",
                WALL,
                {"lifetime": nan},
                ValueError,
                "^lifetime: expected seconds above 0, or None to stay, got nan$",
            ),
            ("a", [Points(np.zeros((2000, 2))), WALL], {}, ValueError, "expected at most 2,000 places in all shapes"),
        ],
    )
    def test_what_cannot_be_drawn_is_refused_and_the_picture_kept(
        self, laser: LaserWidget, page: Page, name: Any, shape: Any, more: Any, error: type[Exception], text: str
    ) -> None:
        laser.draw("wall", WALL)
        for _ in range(2):
            with pytest.raises(error, match=text):
                laser.draw(name, shape, **more)
        assert [one["name"] for one in on_page(page)] == ["wall"]

    def test_there_is_an_end_to_names(self, laser: LaserWidget) -> None:
        for i in range(100):
            laser.draw(f"{i}", WALL)
        with pytest.raises(ValueError, match=r"expected at most 100 names; draw\(name, None\) removes one"):
            laser.draw("one more", WALL)
        laser.draw("99", Arc(1))

    def test_in_a_callback_nothing_is_raised_and_the_widget_says_it(
        self, laser: LaserWidget, page: Page, caplog: pytest.LogCaptureFixture
    ) -> None:
        laser.draw("wall", WALL)
        with caplog.at_level(logging.ERROR, "robowidgets"):
            thread = threading.Thread(target=laser.draw, args=("wall", "no shape"))
            thread.start()
            thread.join()
        assert [one["name"] for one in on_page(page)] == ["wall"]
        assert page.state["_about"]["error"].startswith("draw('wall'): expected a Line")
        assert "expected a Line" in caplog.text


class TestInAPlayer:
    @pytest.fixture
    def player(self) -> Iterator[Any]:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            player = recording.show(scanogram=False)
            yield player
            player.close()

    def shapes(self, player: Any, start: float) -> tuple[list[dict[str, Any]], list[str]]:
        """The shapes on the scan at a time, and the notes on it."""
        frame = next(iter(player.views[0].track.frames(start, start)))
        return frame.about.get("shapes", []), frame.about.get("notes", [])

    def test_a_function_draws_on_each_scan(self, player: Any) -> None:
        laser = player.views[0].widget
        laser.draw("nearest", lambda scan: Points([scan.nearest()]))
        laser.draw("zone", Arc(0.5))
        at = []
        for seconds in (5.0, 20.0):
            (nearest, zone), notes = self.shapes(player, seconds)
            ray = player.recording.at("/scan", seconds).sample.nearest()
            assert nearest["at"] == [[ray.x, ray.y]]
            assert (zone["name"], notes) == ("zone", [])
            at.append(nearest["at"])
        assert at[0] != at[1]
        laser.draw("nearest", None)
        assert [one["name"] for one in self.shapes(player, 5.0)[0]] == ["zone"]

    def test_a_function_may_draw_nothing_and_what_raises_is_noted(self, player: Any) -> None:
        laser = player.views[0].widget
        laser.draw("never", lambda _scan: None)
        laser.draw("broken", lambda _scan: Line(1 / 0, 2))
        laser.draw("wrong", lambda _scan: (1, 2))
        shapes, notes = self.shapes(player, 5.0)
        assert shapes == []
        assert notes[0].startswith("broken: line ")
        assert notes[0].endswith("ZeroDivisionError: division by zero")
        assert "wrong" in notes[1]
        assert "expected a Line, Points" in notes[1]

    def test_the_page_gets_its_segments_again(self, player: Any) -> None:
        laser = player.views[0].widget
        before = get_edition(laser)
        laser.draw("zone", Arc(0.5))
        assert get_edition(laser) == before + 1
        assert "_edition" in laser.frame_traits
