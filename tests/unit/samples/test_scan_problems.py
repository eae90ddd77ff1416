"""`Scan.problems`: the faults of a scan, in plain words, and the remedy."""

from __future__ import annotations

from math import inf, nan, pi
from typing import Any

import numpy as np
import pytest

from robowidgets.messages import to_scan
from robowidgets.samples import Problem, Scan
from robowidgets.samples.problem import LONGEST


def scan(ranges: Any, range_min: float = 0.1, range_max: float = 30.0, **more: Any) -> Scan:
    limits = {"range_min": range_min, "range_max": range_max}
    return Scan(ranges, **({"angle_min": -0.5, "angle_increment": 0.01} | limits | more))


def message(ranges: Any, **changed: Any) -> dict[str, Any]:
    """A LaserScan without fault, except for its ranges and the given changes."""
    count = len(ranges)
    step = 2 * pi / max(1, count)
    fields = {"angle_min": -pi, "angle_increment": step, "range_min": 0.1, "range_max": 12.0}
    ends = {"angle_max": -pi + (count - 1) * step, "time_increment": 0.0, "scan_time": 0.1, "intensities": []}
    header = {"stamp": {"sec": 1, "nanosec": 0}, "frame_id": "laser"}
    return fields | ends | {"ranges": ranges, "header": header} | changed


ROOM = np.full(720, 2.5)

# As seen in practice: the name of the case, the message, and the beginnings of its problems.
CASES: list[tuple[str, dict[str, Any], list[str]]] = [
    ("a sound scan", message(ROOM), []),
    (
        "LDS-01, whose zeros mean nothing seen",
        message(
            np.where(np.arange(360) % 2, 0.0, 1.5), angle_min=0.0, angle_max=6.26573, angle_increment=0.0174533,
            range_min=0.12, range_max=3.5,
        ),
        [],
    ),
    (
        "YDLIDAR X4",
        message(ROOM, angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00872665),
        ["angle_max is one step too far for 720 rays"],
    ),
    (
        "X4, newer driver",
        message(ROOM[:719], angle_min=-3.14159, angle_max=3.14159, angle_increment=0.00869044),
        ["719 rays, but the header implies 724 (angle_max 180.0°)"],
    ),
    (
        "single ray",
        message([10.47], angle_min=0.0, angle_max=0.0, angle_increment=nan),
        ["one ray, angle_increment is not a number: drawn at angle_min"],
    ),
    (
        "upside-down scanner, which turns clockwise and is in order",
        message(ROOM, angle_min=pi, angle_max=-pi + 2 * pi / 720, angle_increment=-2 * pi / 720),
        [],
    ),
    (
        "a step with the wrong sign",
        message(ROOM[:360], angle_min=-1.0, angle_max=1.0, angle_increment=-2 / 359),
        ["angle_max (57.3°) lies against angle_increment"],
    ),
    ("all +inf", message([inf] * 8), ["no readings: all 8 rays say +inf, nothing in range"]),
    ("all -inf", message([-inf] * 8), ["no readings: all 8 rays say -inf, too close"]),
    ("all NaN", message([nan] * 8), ["no readings: all 8 rays say NaN, no measurement"]),
    ("all 0.0", message([0.0] * 8), ["no readings: all 8 rays say 0 m, outside 0.1 m to 12 m"]),
    ("empty", message([]), ["the scan has no rays"]),
    ("RPLIDAR header lie: the numbers agree", message(np.ones(360), angle_min=-pi), []),
    ("wrong intensities", message(ROOM, intensities=[1.0, 2.0]), ["2 intensities for 720 rays: not used"]),
    (
        "absurd times",
        message(ROOM, time_increment=153333.3, scan_time=1.1e8),
        ["time_increment is 153333 s: not used", "scan_time is 1.1e+08 s: not used"],
    ),
    (
        "an empty frame",
        message(ROOM, header={"stamp": {"sec": 1, "nanosec": 0}, "frame_id": ""}),
        ["frame_id is empty"],
    ),
    (
        "degrees in place of radians",
        message(np.ones(360), angle_min=-180.0, angle_max=179.0, angle_increment=1.0),
        ["the rays sweep 57 full circles", "angle_min is -180 rad"],
    ),
]  # fmt: skip


@pytest.mark.parametrize(("sent", "expected"), [case[1:] for case in CASES], ids=[case[0] for case in CASES])
def test_every_odd_scan_has_its_problems_and_each_a_remedy_in_one_line(
    sent: dict[str, Any], expected: list[str]
) -> None:
    problems = to_scan(sent).problems()
    assert sorted(problem.what for problem in problems) == sorted(expected)
    assert all(problem.remedy for problem in problems)
    assert all(len(str(problem)) <= LONGEST and "\n" not in str(problem) for problem in problems)


def test_a_problem_is_a_line_of_words_and_remedy_which_is_cut_in_the_words() -> None:
    assert str(Problem("frame_id is empty", "set it")) == "frame_id is empty; set it"
    assert str(Problem("nothing yet", "")) == "nothing yet"
    line = str(Problem("x" * 500, "rename it"))
    assert len(line) == LONGEST
    assert line.endswith("x…; rename it")


class TestOutside:
    def test_a_third_of_the_rays_beyond_the_limits_is_a_problem_and_fewer_are_not(self) -> None:
        def whats(outside: float, count: int) -> list[str]:
            return [problem.what for problem in scan([outside] * count + [2.0] * (30 - count)).problems()]

        assert whats(40.0, 9) == whats(0.05, 9) == []
        assert whats(40.0, 10) == whats(40.0, 20) == ["a third or more of the rays lie beyond range_max (30 m)"]
        assert whats(0.05, 10) == ["a third or more of the rays lie below range_min (0.1 m)"]

    @pytest.mark.parametrize("code", [0.0, 0.001, inf, nan, -inf])
    def test_values_that_scanners_send_for_rays_without_a_reading_are_none(self, code: float) -> None:
        assert scan([code] * 29 + [2.0]).problems() == ()

    def test_two_scans_with_the_same_problem_have_the_same_words(self) -> None:
        one, other = (scan([40.0] * count + [2.0] * (30 - count)) for count in (11, 17))
        assert one.problems() == other.problems()


class TestNoReading:
    def test_millimetres_are_asked_after(self) -> None:
        (problem,) = scan([1500, 2000, nan, inf]).problems()
        assert problem.what == "no readings: ranges are around 1,750 where range_max is 30 m"
        assert problem.remedy.startswith("are they in millimetres?")

    @pytest.mark.parametrize("ranges", [[65.535, 65.535], [nan, inf], [0.0, inf]])
    def test_millimetres_are_not_asked_after_for_codes(self, ranges: list[float]) -> None:
        (problem,) = scan(ranges).problems()
        assert "millimetres" not in problem.remedy

    def test_one_ray_is_one(self) -> None:
        (problem,) = scan([inf]).problems()
        assert problem.what == "no readings: the one ray says +inf, nothing in range"

    def test_the_reason_comes_before_what_the_header_has(self) -> None:
        whats = [problem.what for problem in to_scan(message([nan] * 4, scan_time=-1.0)).problems()]
        assert whats == ["no readings: all 4 rays say NaN, no measurement", "scan_time is -1 s: not used"]
