"""Two scans compared ray by ray."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets import Footprint, LaserWidget, Scan
from robowidgets.samples.distances import indices_at

from ..pages import synced

INF, NAN = float("inf"), float("nan")


def scan(*ranges: float, angle_min: float = -0.2, increment: float = 0.1, frame_id: str = "") -> Scan:
    return Scan(
        np.array(ranges),
        angle_min=angle_min,
        angle_increment=increment,
        range_min=0.1,
        range_max=10.0,
        frame_id=frame_id,
    )


class TestDifference:
    def test_each_ray_counts_as_in_distance(self) -> None:
        now = scan(2.0, 1.0, INF, 3.0, INF, NAN, -INF, 0.0)
        then = scan(1.5, 1.0, 4.0, INF, 20.0, 1.0, 1.0, 1.0)
        assert (now - then).tolist() == pytest.approx([0.5, 0, INF, -INF, 0, NAN, -1, NAN], nan_ok=True)
        assert (now - then).dtype == np.float32
        assert (now - now).tolist() == pytest.approx([0, 0, 0, 0, 0, NAN, 0, NAN], nan_ok=True)

    @pytest.mark.parametrize(
        ("other", "expected"),
        [
            (scan(1, 2, 3, angle_min=-0.1), [NAN, 9, 8, 7, NAN]),
            (scan(5, 4, 3, 2, 1, angle_min=0.2, increment=-0.1), [9, 8, 7, 6, 5]),
            (scan(1, 2, 3, 4, 5, angle_min=-0.2 + 2 * pi), [9, 8, 7, 6, 5]),
            (scan(1, 3, 5, increment=0.2), [9, 9, 7, 5, 5]),
            (scan(2, angle_min=0.0, increment=0.0), [8, 8, 8, 8, 8]),
            (scan(), [NAN] * 5),
        ],
    )
    def test_other_angles_are_compared_by_angle(self, other: Scan, expected: list[float]) -> None:
        found = scan(10, 10, 10, 10, 10) - other
        if len(other) == 3 and other.angle_increment == pytest.approx(0.2):
            found = found[::2]  # rays in the middle between two are as close to either
            expected = expected[::2]
        assert found.tolist() == pytest.approx(expected, nan_ok=True)

    def test_the_closest_ray_matches_at(self) -> None:
        for other in (
            scan(*range(1, 8), angle_min=-1.0, increment=0.3),
            scan(*range(1, 8), angle_min=3.0, increment=-0.3),
            scan(*np.ones(360), angle_min=0.0, increment=pi / 180),
            scan(*np.ones(361), angle_min=-pi, increment=pi / 180),
        ):
            angles = np.linspace(-3.1, 3.1, 517)
            rays = [other.at(float(angle)) for angle in angles]
            found = indices_at(other, angles)
            for ray, index, angle in zip(rays, found, angles, strict=True):
                assert (ray is None) == (index < 0), angle
                if ray:
                    off = abs(other[int(index)].angle - ray.angle)
                    assert min(off, 2 * pi - off) < 1e-6, angle

    def test_of_something_else_is_refused(self) -> None:
        with pytest.raises(TypeError, match="unsupported operand"):
            scan(1.0) - 1  # type: ignore[operator]


class TestGhost:
    def test_a_scan_stays(self) -> None:
        laser = LaserWidget()
        assert laser.ghost is None
        laser.update(scan(1.0, 2.0))
        laser.ghost = laser.scan
        laser.update(scan(3.0, 3.0))
        assert laser.ghost.ranges.tolist() == [1, 2]
        assert laser.ghost.age == pytest.approx(laser.scan.age, abs=1)
        assert (laser.scan - laser.ghost).tolist() == [2, 1]
        assert laser.get_state()["_ghost"] != b"", "a saved notebook has it"
        laser.ghost = None
        assert laser.ghost is None
        laser.close()

    def test_a_scan_gets_the_mount_of_the_scanner_in_the_widget(self) -> None:
        laser = LaserWidget()
        laser.footprint = Footprint(radius=0.2, scanner=(0, 0, "90deg"), upside_down=True)
        message = scan(1.0, 2.0, 3.0)
        laser.update(scan(1.0, 2.0, 2.0))
        laser.ghost = message
        assert laser.ghost.angles.tolist() == pytest.approx(laser.scan.angles.tolist())
        assert (laser.scan - laser.ghost).tolist() == [0, 0, -1]
        laser.ghost = laser.scan
        assert laser.ghost.angles.tolist() == pytest.approx(laser.scan.angles.tolist())
        laser.close()

    def test_a_scan_keeps_its_frame_when_it_is_pinned(self) -> None:
        laser = LaserWidget()
        laser.update(scan(1.0, 2.0, frame_id="first"))
        laser.get_state()
        by_page = synced(laser, "_frame")
        laser.update(scan(3.0, 3.0, frame_id="second"))
        laser.get_state()
        laser.ghost = laser.scan
        assert laser.ghost.frame_id == "second"
        laser._ghost = by_page
        assert (laser.ghost.frame_id, laser.ghost.ranges.tolist()) == ("first", [1, 2])
        laser.close()

    def test_some_scans_ago_and_another_widget(self) -> None:
        laser, other = LaserWidget(), LaserWidget()
        laser.ghost = 10
        assert laser.ghost == 10
        laser.ghost = other
        assert laser.ghost is other
        state = laser.get_state()
        assert (state["_ghost_of"], state["_ghost_ago"], state["_ghost"]) == (other.model_id, 0, b"")
        laser.ghost = scan(1.0)
        assert laser.get_state()["_ghost_of"] == ""
        laser.close()
        other.close()

    @pytest.mark.parametrize(
        ("value", "error", "text"),
        [
            (0, ValueError, "ghost: expected how many scans ago, 1 or more, got 0"),
            (True, TypeError, "got True"),
            ([1.0], TypeError, r"expected a Scan, how many scans ago, another laser widget or None, got \[1.0\]"),
        ],
    )
    def test_nothing_else_is_taken_and_the_ghost_stays(self, value: Any, error: type[Exception], text: str) -> None:
        laser = LaserWidget()
        laser.ghost = 5
        with pytest.raises(error, match=text):
            laser.ghost = value
        assert laser.ghost == 5
        with pytest.raises(ValueError, match="another laser widget, got this one"):
            laser.ghost = laser
        other = LaserWidget()
        other.close()
        with pytest.raises(RuntimeError, match="ghost: this widget is closed; show a new one"):
            laser.ghost = other
        laser.close()

    def test_the_player_of_a_recording_keeps_no_earlier_scans(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            scan_before = recording.scans()[0].sample
            player = recording.show("/scan")
            widget = player.views[0].widget
            with pytest.raises(ValueError, match="a player keeps no earlier scans; set a scan"):
                widget.ghost = 10
            widget.ghost = scan_before
            assert widget.ghost.ranges.tolist() == pytest.approx(scan_before.ranges.tolist(), nan_ok=True)
            player.close()
