"""The judges of the tasks: wrong answers derived from right ones fail, and right answers in many styles pass."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from itertools import pairwise, product
from typing import Any

import numpy as np
import pytest

from robowidgets import Scan, Touch
from robowidgets.behaviors import Drive
from robowidgets.lessons._bounded import BrokenError, WrongError
from robowidgets.lessons._check import TASKS

GIVES_NO_ANSWER = ("returned", "did not move", "finite number")
"""Error messages of answers that are broken, not wrong."""

Answer = Callable[..., Any]
Mutant = tuple[str, Answer]

PICTURES = ("nearest_on_the_left", "wall_ahead", "fits_through", "bumper_reflex")
"""Tasks whose answers get a sample; in the others, the answer drives a robot."""
DRIVES = ("stop_at_wall", "slow_in_doorway", "stop_before_wall", "follow_wall", "back_off")


@pytest.fixture(scope="module")
def wrong_cases() -> Callable[[str, Answer], Iterator[str]]:
    """The faults of an answer, by case, without the threads and limits of a check."""
    cases = {name: task() for name, task in TASKS.items()}

    def found(name: str, answer: Answer) -> Iterator[str]:
        for case in cases[name]:
            try:
                case.judge(answer)
            except WrongError as error:  # noqa: PERF203
                if isinstance(error, BrokenError) and not any(words in str(error) for words in GIVES_NO_ANSWER):
                    raise  # the test is broken, not the answer
                yield f"{case.title}: {error}"

    return found


# -- wrong answers, made from right ones -------------------------------------------------------------------------------


def between(low: float, high: float) -> tuple[str, str]:
    return f"{low}deg", f"{high}deg"


def nearest(low: float, high: float, factor: float = 1.0) -> Answer:
    return lambda scan: factor * scan.distance(between(low, high))


def slices(scan: Scan, share: tuple[float, float]) -> Any:
    """The nearest of some part of the array, by index."""
    return np.nanmin(scan.ranges[int(share[0] * len(scan)) : int(share[1] * len(scan))], initial=math.inf)


def sectors_but(right: tuple[float, float], lows: tuple[float, ...], highs: tuple[float, ...]) -> Iterator[Mutant]:
    """The nearest thing in sectors with a wrong side, sign, limit, order or unit."""
    for low, high in product((*lows, right[0]), (*highs, right[1])):
        if (low, high) != right and high - low < 360:
            yield f"{low} to {high}", nearest(low, high)
    for factor in (100, 0.01, -1, 0.9, 1.1, 1000):
        yield f"times {factor}", nearest(*right, factor)
    for name, share in {"half": (0.5, 1), "other half": (0, 0.5), "all": (0, 1), "third": (2 / 3, 5 / 6)}.items():
        yield name, partial(lambda scan, share: slices(scan, share), share=share)
    yield "swapped", nearest(right[1], right[0])
    if right[0] != -right[1]:
        yield "mirrored", nearest(-right[1], -right[0])
    yield "radians taken for degrees", nearest(*map(math.radians, right))
    yield "middle", lambda scan: (ray := scan.at(between(sum(right) / 2, 0)[0])) and ray.range
    yield "one ray", lambda scan: scan.ranges[len(scan) // 2]
    yield "farthest", lambda scan: np.nanmax(scan.ranges)
    yield "plain min", lambda scan: np.min(scan.ranges[scan.indices(between(*right))], initial=math.inf)
    yield "mean", lambda scan: np.nanmean(scan.ranges[scan.indices(between(*right))])
    yield "index", lambda scan: (ray := scan.nearest(between(*right))) and ray.index
    yield "angle", lambda scan: (ray := scan.nearest(between(*right))) and ray.angle
    yield "None", lambda _scan: None
    yield "no return where it is near", lambda scan: None if scan.distance(between(*right)) < 1 else math.inf


def gaps(limit: float, part: Callable[[Any, Any], Any] = lambda x, _: (x > 0.8) & (x < 1.2)) -> Answer:
    def fits(scan: Scan) -> bool:
        x, y = scan.xy.T
        apart = np.diff(np.sort(y[part(x, y)]))
        return bool(apart.max(initial=0.0) >= limit)

    return fits


def no_gaps() -> Iterator[Mutant]:
    for limit in (0.3, 0.45, 0.51, 0.54, 0.55, 0.65, 0.66, 0.7, 0.76, 0.8, 1.0, 6.0, 60.0, -0.6, 0.006):
        yield f"from {limit} m", gaps(limit)
    parts: dict[str, Callable[[Any, Any], Any]] = {
        "left": lambda x, y: (x > 0.8) & (x < 1.2) & (y > 0),
        "right": lambda x, y: (x > 0.8) & (x < 1.2) & (y < 0),
        "behind": lambda x, _y: x < 0,
        "all": lambda x, _y: x > 0,
        "far": lambda x, _y: x > 1.2,
    }
    for name, part in parts.items():
        yield name, gaps(0.6, part)
    yield "turned round", lambda scan: not gaps(0.6)(scan)
    yield "always", lambda _scan: True
    yield "never", lambda _scan: False
    yield "None", lambda scan: gaps(0.6)(scan) or None
    yield "not sorted", lambda scan: bool(np.diff(scan.xy[:, 1]).max() >= 0.6)
    yield "x for y", lambda scan: bool(np.diff(np.sort(scan.xy[:, 0])).max() >= 0.6)
    yield "ahead is free", lambda scan: scan.distance("front") > 1.1
    yield "a ray ahead is free", lambda scan: scan.at(0).range > 1.2
    yield "smallest", lambda scan: bool(np.diff(np.sort(scan.xy[:, 1])).min() >= 0.6)
    for side in ("left", "right", "front"):
        yield side, partial(lambda scan, side: scan.distance(side) > 1.0, side=side)


STATES = {
    (False, False, False): (0.3, 0.0),
    (True, False, False): (-0.2, -1.0),
    (False, True, False): (-0.2, 1.0),
    (False, False, True): (-0.2, 1.0),
    (True, False, True): (-0.2, -1.0),
}
"""The return values of a right answer, by left, center and right; (0, 0) if one is unknown."""


def table(changed: dict[Any, Any], unknown: Callable[[tuple[Any, ...]], bool] = lambda one: None in one) -> Answer:
    def reflex(touch: Touch) -> Any:
        states = tuple(touch.touched[name] for name in ("left", "center", "right"))
        if unknown(states):
            return 0.0, 0.0
        return {**STATES, **changed}.get(tuple(map(bool, states)), (-0.2, 1.0))

    return reflex


def no_reflexes() -> Iterator[Mutant]:
    others = [(0.0, 0.0), (0.3, 1.0), (0.3, -1.0), (math.nan, 0.0), (30.0, 0.0), (-0.2, 90.0), None, 0.3, (0.2, 0.0)]
    for state, pair in STATES.items():
        turned_over = [(-pair[0], pair[1]), (pair[0] * 100, pair[1]), *([] if pair[1] < 0 else [pair[::-1]])]
        for other in [*others, *turned_over, *([(pair[0], -pair[1])] if sum(state) == 1 and not state[1] else [])]:
            if other != pair and (other != (0.2, 0.0) or any(state)) and not (state[1] and other == (-0.2, -1.0)):
                yield f"{state}: {other}", table({state: other})
    for name in range(3):
        yield f"looks at {name} alone", table({}, partial(lambda one, name: one[name] is None, name=name))
        yield f"overlooks {name}", table({}, partial(lambda one, name: None in one[:name] + one[name + 1 :], name=name))
    yield "all unknown", table({}, lambda one: one == (None,) * 3)
    yield "never unknown", table({}, lambda _one: False)
    yield "always unknown", table({}, lambda _one: True)
    yield "sides swapped", table({(True, False, False): (-0.2, 1.0), (False, False, True): (-0.2, -1.0)})


def wrong_pictures(task: str) -> Iterator[Mutant]:
    if task == "nearest_on_the_left":
        lows = (-180.0, -135.0, -90.0, -45.0, 0.0, 30.0, 40.5, 49.5, 60.0)
        yield from sectors_but((45, 135), lows, (90.0, 100.0, 121.5, 130.0, 140.0, 148.5, 180.0))
    elif task == "wall_ahead":
        yield from sectors_but((-20, 20), (-45.0, -40.0, -22.0, -18.0, -10.0, 0.0), (0.0, 10.0, 18.0, 22.0, 40.0, 45.0))
    else:
        yield from no_gaps() if task == "fits_through" else no_reflexes()


@pytest.mark.parametrize("task", PICTURES)
def test_no_wrong_answer_made_from_a_right_one_passes(
    task: str, wrong_cases: Callable[[str, Answer], Iterator[str]]
) -> None:
    passed = [name for name, answer in wrong_pictures(task) if next(wrong_cases(task, answer), None) is None]
    assert passed == []


def test_there_are_more_than_two_hundred_of_them() -> None:
    assert sum(1 for task in PICTURES for _ in wrong_pictures(task)) > 200


def ahead(scan: Scan, low: float = -20, high: float = 20) -> float:
    return float(scan.distance(between(low, high)))


def stopping(limit: float, low: float = -20, high: float = 20, speed: float = 0.2) -> Callable[[Scan], float]:
    return lambda scan: speed if ahead(scan, low, high) > limit else 0.0


def no_stops(limit: float) -> Iterator[tuple[str, Callable[[Scan], float]]]:
    for other in (limit / 2, limit - 0.15, limit + 0.15, limit * 2, limit * 100, limit / 100, -limit, 0.0):
        yield f"at {other}", stopping(other)
    for low, high in ((0, 20), (-20, 0), (-45, 45), (0, 1), (20, -20), (160, 200), (70, 110), (-110, -70)):
        yield f"{low} to {high}", stopping(limit, low, high)
    for speed in (-0.2, 0.0, 0.01):
        yield f"with {speed} m/s", stopping(limit, speed=speed)
    yield "turned round", lambda scan: 0.0 if ahead(scan) > limit else 0.2
    yield "not below", lambda scan: 0.0 if ahead(scan) < limit else 0.2
    yield "on", lambda _scan: 0.2
    yield "NaN", lambda scan: 0.3 * (scan.ranges[len(scan) // 2] - limit)


def wrong_drives(task: str) -> Iterator[Mutant]:
    if task == "stop_at_wall":
        yield from no_stops(0.4)
        yield "None", lambda scan: 0.2 if ahead(scan) > 0.4 else None
    elif task == "stop_before_wall":
        for name, speed in no_stops(0.5):
            yield name, driving(speed)
    elif task == "slow_in_doorway":
        yield from no_doorways()
    elif task == "follow_wall":
        for name, change in FOLLOWS.items():
            yield name, following(**change)
    else:
        for name, change in BACKS.items():
            yield name, backing(**change)


def driving(speed: Callable[[Scan], float]) -> Answer:
    return lambda scan: Drive(speed(scan))


def doorway(
    left: str = "left", right: str = "right", near: float = 0.8, slow: float = 0.2, fast: float = 0.5
) -> Answer:
    return lambda scan: slow if scan.distance(left) < near and scan.distance(right) < near else fast


def no_doorways() -> Iterator[Mutant]:
    for left, right in (("left", "left"), ("right", "right"), ("front", "back"), ("left", "back"), ("front", "right")):
        yield f"{left} and {right}", doorway(left, right)
    for near in (0.08, -0.8, 0.3, 8.0, 80.0):
        yield f"nearer than {near}", doorway(near=near)
    for slow, fast in (
        (0.5, 0.2),
        (0.22, 0.5),
        (0.18, 0.5),
        (0.2, 0.45),
        (0.2, 0.2),
        (0.5, 0.5),
        (-0.2, 0.5),
        (20, 50),
    ):
        yield f"{slow} and {fast}", doorway(slow=slow, fast=fast)
    yield "either", lambda scan: 0.2 if scan.distance("left") < 0.8 or scan.distance("right") < 0.8 else 0.5
    yield "any", lambda scan: 0.2 if scan.distance() < 0.8 else 0.5
    yield "None", lambda scan: 0.5 if scan.distance("left") > 0.8 else None


def follow(
    scan: Scan,
    near: float = 0.5,
    side: tuple[float, float] = (-60, -40),
    at_wall: float = 1.0,
    turns: tuple[float, float] = (-0.5, 0.5),
    limit: float = 0.6,
    speed: float = 0.2,
    blind: bool = False,
) -> Drive:
    if (blind and ahead(scan) <= near) or (not blind and not ahead(scan) > near):
        return Drive(0, at_wall)
    away = scan.distance(between(*side))
    return Drive(speed, 0.0 if away > 1.0 else turns[0] if away > limit else turns[1])


def following(**change: Any) -> Answer:
    return lambda scan: follow(scan, **change)


FOLLOWS: dict[str, dict[str, Any]] = {
    "mirrored": {"side": (40, 60), "at_wall": -1.0, "turns": (0.5, -0.5)},
    "turns right": {"at_wall": -1.0},
    "never turns": {"at_wall": 0.0},
    "looks left": {"side": (40, 60)},
    "looks back": {"side": (160, 200)},
    "signs swapped": {"turns": (0.5, -0.5)},
    "always left": {"turns": (0.5, 0.5)},
    "always right": {"turns": (-0.5, -0.5)},
    "straight": {"turns": (0.0, 0.0)},
    "too near": {"limit": 0.2},
    "too far": {"limit": 0.95},
    "sees too late": {"near": 0.05},
    "backwards": {"speed": -0.2},
    "creeps": {"speed": 0.01},
    "stands": {"speed": 0.0},
    "blind": {"blind": True},
}


def backing(
    back: float = -0.2,
    until: float = 1.0,
    turn: float = 1.0,
    until_turned: float = 2.0,
    then: float = 0.2,
    name: str = "",
) -> Answer:
    def drive(scan: Scan, touch: Touch, time: float, state: Any) -> Drive | None:
        touched = touch.touched[name] if name else any(touch.touched.values())
        if touched:
            state.bumped = time
        since = time - state.get("bumped", -10)
        if since < until:
            return Drive(back)
        if since < until_turned:
            return Drive(0, turn)
        if "bumped" in state:
            return Drive(then) if ahead(scan) > 0.5 else Drive(0, 1.0)
        return Drive(0.2) if ahead(scan) > 0.5 else Drive(0, 1.0)

    return drive


BACKS: dict[str, dict[str, Any]] = {
    "does not turn, and backs": {"turn": 0.0, "then": -0.2},
    "does not turn, and stands": {"until": 8.0, "turn": 0.0, "then": 0.0},
    "does not turn": {"turn": 0.0},
    "does not drive on": {"then": 0.0},
    "backs for ever": {"until": 60.0},
    "backs on after the turn": {"then": -0.2},
    "turns for ever": {"until_turned": 60.0},
    "turns too little": {"turn": 0.1},
    "pushes": {"back": 0.2},
    "waits": {"back": 0.0},
    "left alone": {"name": "left"},
    "right alone": {"name": "right"},
}


@pytest.mark.slow
@pytest.mark.parametrize("task", DRIVES)
def test_no_wrong_way_to_drive_made_from_a_right_one_passes(
    task: str, wrong_cases: Callable[[str, Answer], Iterator[str]]
) -> None:
    passed = [name for name, answer in wrong_drives(task) if next(wrong_cases(task, answer), None) is None]
    assert passed == []


# -- right answers in many styles --------------------------------------------------------------------------------------


def in_loop(scan: Scan, low: float, high: float) -> float:
    least = math.inf
    for ray in scan:
        if math.radians(low) <= ray.angle <= math.radians(high) and ray.range < least:  # False for NaN
            least = ray.range
    return least


def by_angles(scan: Scan, low: float, high: float) -> float:
    degrees = np.degrees(scan.angles)
    chosen = scan.ranges[(degrees >= low - 1e-6) & (degrees <= high + 1e-6)]
    seen = chosen[np.isfinite(chosen) & (chosen > 0)]
    return float(seen.min()) if seen.size else math.inf


def nearest_styles(low: float, high: float) -> dict[str, Answer]:
    radians = math.radians(low), math.radians(high)
    return {
        "degrees": lambda scan: scan.distance((f"{low}deg", f"{high}deg")),
        "radians": lambda scan: scan.distance(radians),
        "a number of NumPy": lambda scan: np.float64(scan.distance(radians)),
        "the nearest ray": lambda scan: ray.range if (ray := scan.nearest(radians)) else math.inf,
        "the nearest ray, said at length": lambda scan: math.inf if scan.nearest(radians) is None
        else scan.ranges[scan.nearest(radians).index],
        "by indices": lambda scan: np.nanmin(
            (part := scan.ranges[scan.indices(radians)])[~(part <= 0)], initial=math.inf
        ),
        "with a mask": lambda scan: by_angles(scan, low, high),
        "two halves": lambda scan: min(
            scan.distance((radians[0], sum(radians) / 2)), scan.distance((sum(radians) / 2, radians[1]))
        ),
        "sorted": lambda scan: sorted([*filter(lambda r: r > 0, scan.ranges[scan.indices(radians)]), math.inf])[0],
        "rounded to a millimetre": lambda scan: round(scan.distance(radians), 3),
    }  # fmt: skip


def wall(scan: Scan) -> Any:
    x, y = scan.xy.T
    return np.sort(y[(x > 0.8) & (x < 1.2)])


def fits_by_hand(scan: Scan) -> bool:
    points = sorted((y for x, y in scan.xy.tolist() if 0.9 < x < 1.1), reverse=True)
    widest = 0.0
    for first, second in pairwise(points):
        widest = max(widest, first - second)
    return widest >= 0.6


FITS: dict[str, Answer] = {
    "as the lesson": lambda scan: np.diff(wall(scan)).max() >= 0.6,
    "a flag of Python": lambda scan: bool(np.diff(wall(scan)).max() >= 0.6),
    "any": lambda scan: any(gap >= 0.6 for gap in np.diff(wall(scan))),
    "by hand": fits_by_hand,
    "if and else": lambda scan: True if max(np.diff(wall(scan))) > 0.6 else False,  # noqa: SIM210
    "0 and 1": lambda scan: 1 if np.diff(wall(scan)).max() >= 0.6 else 0,
    "shifted": lambda scan: ((y := wall(scan))[1:] - y[:-1]).max() >= 0.6,
    "in centimetres": lambda scan: 100 * np.diff(wall(scan)).max() >= 60,
    "none is too narrow": lambda scan: not np.all(np.diff(wall(scan)) < 0.6),
    "with a margin of a ray": lambda scan: np.diff(wall(scan)).max() >= 0.605,
}


def by_name(touch: Touch) -> Any:
    left, center, right = (touch.touched[name] for name in ("left", "center", "right"))
    if left is None or center is None or right is None:
        return [0, 0]
    if center:
        return [-0.1, 0]
    if left:
        return [-0.1, -0.5]
    return [-0.1, 0.5] if right else [0.5, 0]


def by_sum(touch: Touch) -> Any:
    states = list(touch.touched.values())
    if any(state is None for state in states):
        return (0.0, 0.0)
    return np.array([-0.2, (touch.touched["right"] - touch.touched["left"]) * 1.5]) if sum(states) else (0.2, 0.0)


def with_match(touch: Touch) -> Any:
    speed = turn = 0.0
    if None not in touch.touched.values():
        hit = [name for name, state in touch.touched.items() if state]
        speed = -0.3 if hit else 0.3
        turn = {"left": -1.0, "right": 1.0}.get(hit[0], 0.0) if hit else 0.0
    return speed, turn


REFLEXES: dict[str, Answer] = {
    "a table": table({}),
    "by name": by_name,
    "by sum": by_sum,
    "by a list of names": with_match,
    "slow": lambda touch: tuple(0.1 * value for value in table({})(touch)),
    "whole numbers": lambda touch: tuple(math.trunc(math.copysign(math.ceil(abs(v)), v)) for v in table({})(touch)),
    "a list": lambda touch: list(table({})(touch)),
    "an array": lambda touch: np.array(table({})(touch)),
    "float32": lambda touch: tuple(map(np.float32, table({})(touch))),
    "straight back from the center": table({(False, True, False): (-0.2, 0.0)}),
}


def slower(limit: float, most: float = 0.5, share: float = 0.8) -> Callable[[Scan], float]:
    return lambda scan: min(most, share * (away - limit)) if (away := ahead(scan)) > limit else 0.0


def stop_styles(limit: float) -> dict[str, Callable[[Scan], float]]:
    def halves(scan: Scan) -> float:
        return 0.2 if min(scan.distance((-0.35, 0.0)), scan.distance((0.0, 0.35))) > limit else 0.0

    def negated(scan: Scan) -> float:
        if not scan.distance((-0.35, 0.35)) > limit:
            return 0
        return 0.2

    def known(scan: Scan) -> float:
        away = ahead(scan)
        return 0.0 if math.isnan(away) or away <= limit else 0.15

    def two_steps(scan: Scan) -> float:
        away = ahead(scan)
        return 0.4 if away > limit + 0.5 else 0.1 if away > limit else 0.0

    def by_array(scan: Scan) -> float:
        chosen = scan.ranges[np.abs(scan.angles) < 0.35]
        return 0.2 if not np.isnan(chosen).all() and np.nanmin(chosen) > limit else 0.0

    return {
        "at once": stopping(limit),
        "earlier by a little": stopping(limit + 0.02),
        "slower and slower": slower(limit),
        "slower, with another share": slower(limit, 0.3, 1.0),
        "both halves": halves,
        "negated": negated,
        "known": known,
        "two steps": two_steps,
        "by the array": by_array,
        "wider": stopping(limit, -22, 22, 0.25),
    }


DOORWAYS: dict[str, Answer] = {
    **{f"nearer than {near} m": doorway(near=near) for near in (0.6, 0.7, 0.8, 1.0, 1.2)},
    "the wider of both": lambda scan: 0.2 if max(scan.distance("left"), scan.distance("right")) < 0.8 else 0.5,
    "product": lambda scan: 0.5 - 0.3 * (scan.distance("left") < 0.8) * (scan.distance("right") < 0.8),
    "not": lambda scan: 0.5 if not (scan.distance("left") < 0.9 and scan.distance("right") < 0.9) else 0.2,
    "all of": lambda scan: 0.2 if all(scan.distance(side) < 0.8 for side in ("left", "right")) else 0.5,
    "degrees": lambda scan: 0.2 if scan.distance((0.5, 2.4)) < 0.8 and scan.distance((-2.4, -0.5)) < 0.8 else 0.5,
}


class Follows:
    """The wall as states."""

    near = lambda scan: not ahead(scan) > 0.5  # noqa: E731
    clear = lambda scan: ahead(scan) > 0.8  # noqa: E731

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive(0, 1.0)

    def along(scan) -> Drive:  # type: ignore[no-untyped-def,misc]  # noqa: N805
        return Drive(0.2, -0.5 if scan.distance(("-60deg", "-40deg")) > 0.6 else 0.5)

    moves = "forward -> at_wall on near", "at_wall -> along on clear", "along -> at_wall on near"


class Stops:
    """A stop as states."""

    near = lambda scan: not ahead(scan) > 0.5  # noqa: E731

    def forward() -> Drive:  # type: ignore[misc]
        return Drive(0.2)

    def at_wall() -> Drive:  # type: ignore[misc]
        return Drive()

    moves = "forward -> at_wall on near"


class BacksOff(Follows):
    """Backing off as states."""

    bumped = lambda touch: any(touch.touched.values())  # noqa: E731

    def back() -> Drive:  # type: ignore[misc]
        return Drive(-0.2)

    def turn_away() -> Drive:  # type: ignore[misc]
        return Drive(0, 1.0)

    moves = (
        *Follows.moves,
        "* -> back on bumped",
        "back -> turn_away after 1",
        "turn_away -> forward after 1",
    )


def steered(scan: Scan) -> Drive:
    """Keeps a distance to the wall, with proportional control."""
    if not ahead(scan) > 0.5:
        return Drive(0.0, 0.8)
    away = scan.distance(between(-60, -40))
    return Drive(0.2, max(-0.6, min(0.6, 2.0 * (0.6 - away))) if away < 1.0 else 0.0)


def right_answers(task: str) -> dict[str, Answer]:
    if task == "nearest_on_the_left":
        return nearest_styles(45, 135)
    if task == "wall_ahead":
        return {**nearest_styles(-20, 20), "a loop": lambda scan: in_loop(scan, -20, 20)}
    if task == "stop_before_wall":
        return {"as states": Stops, **{name: driving(speed) for name, speed in stop_styles(0.5).items()}}
    if task == "follow_wall":
        changes: list[dict[str, Any]] = [{}, {"near": 0.55}, {"near": 0.6}, {"limit": 0.55}, {"speed": 0.15}]
        changes += [{"at_wall": 0.8}, {"turns": (-0.4, 0.4)}, {"side": (-65, -40)}]
        found = {f"follows with {change}": following(**change) for change in changes}
        return {**found, "in proportion": steered, "as states": Follows}
    if task == "back_off":
        changes = [{}, {"until": 1.5, "until_turned": 3.0}, {"turn": -1.0}, {"back": -0.1}, {"turn": 0.8}]
        changes += [{"then": 0.1}, {"until_turned": 2.5}, {"back": -0.3}, {"until": 0.8, "until_turned": 2.0}]
        return {**{f"backs off with {change}": backing(**change) for change in changes}, "as states": BacksOff}
    return {
        "fits_through": FITS,
        "bumper_reflex": REFLEXES,
        "stop_at_wall": stop_styles(0.4),
        "slow_in_doorway": DOORWAYS,
    }[task]


@pytest.mark.parametrize("task", [*PICTURES, *(pytest.param(task, marks=pytest.mark.slow) for task in DRIVES)])
def test_right_answers_pass_in_ten_styles(task: str, wrong_cases: Callable[[str, Answer], Iterator[str]]) -> None:
    answers = right_answers(task)
    assert len(answers) >= 10
    assert {name: wrong for name, answer in answers.items() if (wrong := next(wrong_cases(task, answer), ""))} == {}
