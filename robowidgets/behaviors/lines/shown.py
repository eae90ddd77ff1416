"""The lines of a step as a view shows them: values with their units and rays, comparisons, counts, passes of loops."""

from __future__ import annotations

from collections.abc import Iterator
from math import isfinite
from typing import Any, NamedTuple

import numpy as np

from ...reasons.places import CHANGE, COMPARE, EFFECT, MARK, OPERAND, OWN, PASS, RAYS, TEST, NotedPlace, Operand
from ...samples import Ray, Scan
from ...samples.sector import ALL_ROUND
from .noting import CallNotes, Noted
from .values import Glimpse, is_result, number_text, text_of
from .watch import WatchedCall

MOST_ROWS = 20
"""Passes of a loop that are listed."""
_MOST_DETAILS = 4
"""Texts of a line in addition to its value."""

NUMBER, FLAG, REACHED = "number", "flag", "reached"
"""The kinds of levels that a line has over time: a number, True or False, or only that it was reached."""


class RaysRead(NamedTuple):
    """Rays that a line read: first and stop of each run, and the index of the deciding ray, or -1 if it is not known.

    ``frame`` is the frame of their scan, since a robot may have several lasers.
    """

    runs: tuple[int, ...]
    nearest: int
    frame: str = ""


class LineValues(NamedTuple):
    """A line that was reached, as it is shown.

    Attributes:
        number: its number in the function, from 0.
        value: the text of its value, empty if it has none.
        details: what else was computed in it.
        times: how often it was reached.
        kind: one of the kinds above.
        level: the number, or 1 and 0 for True and False, or None if it is not finite.
        rays: the rays that it read.
    """

    number: int
    value: str = ""
    details: tuple[str, ...] = ()
    times: int = 1
    kind: str = REACHED
    level: float | None = None
    rays: tuple[RaysRead, ...] = ()


class Passes(NamedTuple):
    """The first passes of a loop: the number of its line, a text for each pass, and how many there were."""

    number: int
    rows: tuple[str, ...]
    times: int


def lines_of(call: WatchedCall) -> list[LineValues]:
    """Return the lines of a call that were reached, from top to bottom."""
    notes = call.notes
    if notes is None:
        return []
    by_line: dict[int, list[Noted]] = {}
    for seen in notes.last.values():
        by_line.setdefault(notes.source.places[seen.place].line, []).append(seen)
    lines = []
    for line, places in notes.source.reach.items():
        if line == call.error_line or any(place in notes.last for place in places):
            lines.append(_line(notes, line, by_line.get(line, [])))
    return lines


def levels_of(call: WatchedCall) -> dict[int, tuple[str, float | None]]:
    """Return for each line that was reached, by its number from 0, what it has over time: faster than `lines_of`."""
    notes = call.notes
    if notes is None:
        return {}
    places, first = notes.source.places, notes.source.first
    own: dict[int, list[Noted]] = {}
    for seen in notes.last.values():
        if places[seen.place].kind in OWN:
            own.setdefault(places[seen.place].line, []).append(seen)
    levels: dict[int, tuple[str, float | None]] = {}
    for line, numbers in notes.source.reach.items():
        if line == call.error_line or any(number in notes.last for number in numbers):
            levels[line - first] = _level_of(notes, own.get(line, []))
    return levels


def _line(notes: CallNotes, line: int, seen: list[Noted]) -> LineValues:
    places, number = notes.source.places, line - notes.source.first
    own = _own(notes, seen)
    inner = [one for one in seen if places[one.place].kind in (COMPARE, OPERAND, RAYS)]
    marks = [one for one in seen if places[one.place].kind in (MARK, PASS)]
    count = max((notes.counts[one.place] for one in (own or marks or inner)), default=1)
    if not own:
        return LineValues(number, details=_details(notes, inner), times=count, rays=_rays(notes, inner))
    shown = [one for one in own if one.value is not None or places[one.place].kind != EFFECT]
    is_named = len(own) > 1
    texts = [_named(notes, one) if is_named and places[one.place].names else value_text(notes, one) for one in shown]
    details = _details(notes, [*(one for one in own if places[one.place].relation), *inner])
    return LineValues(number, ", ".join(texts), details, count, *_level_of(notes, own), _rays(notes, [*own, *inner]))


def _own(notes: CallNotes, seen: list[Noted]) -> list[Noted]:
    """Return the values of a line in the order of its code, up to a test that was False: its branch ran before."""
    places = notes.source.places
    own = sorted((one for one in seen if places[one.place].kind in OWN), key=lambda one: one.place)
    end = next((i for i, one in enumerate(own, 1) if places[one.place].kind == TEST and one.value is False), len(own))
    return own[:end]


def value_text(notes: CallNotes, seen: Noted) -> str:
    """Return the text of a noted value, with its unit."""
    place, value = notes.source.places[seen.place], seen.value
    if place.kind == CHANGE:
        return f"{place.operands[0].text} {text_of(value)}"
    is_unpacked = len(place.names) > 1 and type(value) is Glimpse and value.brackets != "::"
    if is_unpacked and len(value.parts) == len(place.names) == value.count:
        return ", ".join(f"{name} {text_of(one)}" for name, one in zip(place.names, value.parts, strict=True))
    if place.relation == "distance" and type(value) in (float, int):
        of = _side(notes, place.operands[0], seen)
        # A distance of an object of the user's has another unit, perhaps; of a depth image only the name is kept.
        return text_of(value, "m" if type(of) is Scan or of == Glimpse("Image") else "")
    # A forgotten `return`.
    return text_of(value) + ", not returned" * (place.kind == EFFECT and is_result(value))


def _level_of(notes: CallNotes, own: list[Noted]) -> tuple[str, float | None]:
    """Return the level of a line: of its test, after which its branch may stand, or of its only value.

    In a loop, it is true if it was true in any pass.
    """
    deciding = [one for one in own if notes.source.places[one.place].kind == TEST] or own
    if len(deciding) != 1 or notes.source.places[deciding[0].place].kind == CHANGE:
        return REACHED, 1.0
    return _level(deciding[0].place in notes.true or deciding[0].value)


def _level(value: Any) -> tuple[str, float | None]:
    if type(value) is bool:
        return FLAG, float(value)
    if type(value) is float or (type(value) is int and value.bit_length() < 100):
        return NUMBER, float(value) if isfinite(value) else None
    return REACHED, 1.0


def _details(notes: CallNotes, seen: list[Noted]) -> tuple[str, ...]:
    places = notes.source.places
    sides = {side.place for one in places for side in one.operands if side.place is not None}
    found = []
    for one in sorted(seen, key=lambda one: one.place):
        place = places[one.place]
        if place.kind == OPERAND and one.place not in sides and type(one.value) is not Scan:
            found.append(f"{', '.join(place.names) or place.text} is {text_of(one.value)}")
        elif place.relation in ("distance", "nearest", "at"):
            if place.kind == RAYS and one.place not in sides:
                found.append(f"{_sector_text(place)} {value_text(notes, one)}".strip())
        elif len(place.chain) == 1:
            found.append(_comparison(notes, one))
    return tuple(dict.fromkeys(found))[:_MOST_DETAILS]


def _sector_text(place: NotedPlace) -> str:
    return place.operands[1].text if len(place.operands) > 1 else "all around"


def _comparison(notes: CallNotes, seen: Noted) -> str:
    place = notes.source.places[seen.place]
    left, right = (_side(notes, side, seen) for side in place.operands)
    text = " ".join(_sides(left, "==" if place.relation == "=" else place.relation, right))
    # The value of a whole test stands before it.
    return text if place.kind != COMPARE or type(seen.value) is not bool else f"{text} is {seen.value}"


def _side(notes: CallNotes, side: Operand, seen: Noted) -> Any:
    if side.extra is not None:
        return seen.extras[side.extra] if side.extra < len(seen.extras) else Glimpse("?")
    if side.place is not None:
        noted = notes.last.get(side.place)
        return noted.value if noted else Glimpse("?")
    return side.constant


def _sides(left: Any, relation: str, right: Any) -> Iterator[str]:
    """Yield both sides of a comparison, with enough decimals to show the difference."""
    numbers = [type(one) is float and isfinite(one) for one in (left, right)]
    plain = [type(one) in (float, int) and (type(one) is int or isfinite(one)) for one in (left, right)]
    if all(plain) and any(numbers) and all(abs(one) < 1e6 for one in (left, right)):
        decimals = next((n for n in range(2, 7) if left == right or f"{left:.{n}f}" != f"{right:.{n}f}"), 6)
        yield from (number_text(float(left), decimals=decimals), relation, number_text(float(right), decimals=decimals))
        return
    yield from (text_of(left), relation, text_of(right))


def _rays(notes: CallNotes, seen: list[Noted]) -> tuple[RaysRead, ...]:
    found = []
    for one in sorted(seen, key=lambda one: one.place):
        place = notes.source.places[one.place]
        if place.relation in ("distance", "nearest", "at") and place.operands:
            scan = _side(notes, place.operands[0], one)
            rays = rays_read(scan, place, one, notes) if type(scan) is Scan else None
            if rays is not None:
                found.append(rays)
    return tuple(found)


def rays_read(scan: Scan, place: NotedPlace, seen: Noted, notes: CallNotes) -> RaysRead | None:
    """Return the rays of a scan that a call read, or None if they are not known."""
    value = seen.value
    if place.relation == "at":
        return RaysRead((value.index, value.index + 1), value.index, scan.frame_id) if type(value) is Ray else None
    sector: Any = ALL_ROUND
    if len(place.operands) > 1:
        sector = _side(notes, place.operands[1], seen)
        if type(sector) is Glimpse:
            if sector.count != len(sector.parts) or sector.brackets != "()":
                return None
            sector = sector.parts
    try:
        indices, nearest = np.sort(scan.indices(sector)), scan.nearest(sector)
    except (TypeError, ValueError):  # the call raised it, too
        return None
    breaks = np.flatnonzero(np.diff(indices) > 1)
    firsts, stops = indices[np.r_[0, breaks + 1]], indices[np.r_[breaks, -1]] + 1
    runs = np.stack((firsts, stops), axis=1).ravel().tolist() if len(indices) else []
    # A percentile is the distance of no ray.
    is_its = nearest is not None and (type(value) is Ray or value == scan.distance(sector))
    return RaysRead(tuple(runs), nearest.index if nearest is not None and is_its else -1, scan.frame_id)


def passes_of(call: WatchedCall) -> list[Passes]:
    """Return the passes of each loop of a call, from top to bottom."""
    notes = call.notes
    if notes is None or not notes.source.loops:
        return []
    source = notes.source
    heads = {loop.line for loop in source.loops}
    open_: dict[int, int] = {}
    """The number of the current pass of each loop."""
    rows: dict[int, list[list[str]]] = {}
    labels: dict[int, str] = {}
    for seen in notes.seen:
        place = source.places[seen.place]
        if place.loop is None:
            continue
        if place.kind == PASS:
            around = source.loops[place.loop].around
            open_[place.loop] = open_.get(place.loop, 0) + 1
            for inner, loop in enumerate(source.loops):
                if loop.around == place.loop:
                    open_[inner] = 0
            prefix = f"{labels.get(around, '')}." if around is not None and around in labels else ""
            labels[place.loop] = f"{prefix}{open_[place.loop]}"
            text = f"{labels[place.loop]}:"
            rows.setdefault(place.loop, []).append([text, *([_named(notes, seen)] if place.names else [])])
        elif place.kind in OWN and place.line not in heads and rows.get(place.loop):
            rows[place.loop][-1] += [_named(notes, seen)] if place.kind != EFFECT or seen.value is not None else []
    passes = {place.loop: notes.counts.get(i, 0) for i, place in enumerate(source.places) if place.kind == PASS}
    return [
        Passes(
            loop.line - source.first,
            tuple(" \N{MIDDLE DOT} ".join(row).replace(": \N{MIDDLE DOT} ", ": ", 1) for row in rows[i][:MOST_ROWS]),
            passes.get(i, len(rows[i])),
        )
        for i, loop in enumerate(source.loops)
        if i in rows
    ]


def _named(notes: CallNotes, seen: Noted) -> str:
    place, value = notes.source.places[seen.place], value_text(notes, seen)
    if len(place.names) == 1:
        return f"{place.names[0]} {value}"
    return value if place.names else f"line {place.line} {value}" if place.kind == TEST else value
