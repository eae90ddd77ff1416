"""Calls of a condition, and what it read and compared in each: its verdict with its reasons."""

from __future__ import annotations

import marshal
import os
from collections import deque
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from math import isnan
from types import CodeType, FunctionType, MethodType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..samples.distances import inside, ray_distances
from ..samples.ray import Ray, Validity
from ..samples.scan import Scan
from ..samples.sector import ALL_ROUND, SectorLike
from ..samples.verdict import NO_RAYS, OPERATORS, Verdict, fact
from .looker import ALL, EACH, PART, Looker
from .names import MIRRORED, name_and_unit
from .places import FunctionSource, NotedPlace, Operand
from .rewriting import NotRewrittenError, Rewritten, function_in, is_bound, rewritten

MOST_NOTES = 20_000
"""The number of notes of one call that are kept, the last ones."""
_MOST_CALLED = 200
"""Called functions that are kept in their rewritten form."""
_MOST_TEXTS = 3
_FLOATS = {float, np.float32, np.float64}
_LIBRARIES = os.path.dirname(os.__file__)

Note = Sequence[Any]
"""The places of a function, the number of the place, its value, and extra values."""


class _Comparison(NamedTuple):
    """A comparison of a number with a limit.

    Attributes:
        value: the number.
        relation: one of `OPERATORS`.
        limit: the limit.
        holds: its outcome.
        expression: the source of the number, if it is not a distance.
        is_length: True for a number of metres.
        read: the scan and the sector of a distance, else None.
        between: the id of the distance, and of the limit if that is a distance, too.
    """

    value: Any
    relation: str
    limit: Any
    holds: bool
    expression: str = ""
    is_length: bool = False
    read: tuple[Scan, SectorLike] | None = None
    between: frozenset[int] = frozenset()

    @property
    def is_known(self) -> bool:
        """True if neither side is NaN. To be equal to NaN is how some functions test for it."""
        return self.relation in "=≠" or not (isnan(self.value) or isnan(self.limit))

    @property
    def text(self) -> str:
        """The outcome: ``"way 0.04 ≤ 0.10"``."""
        name, unit = ("", "m") if self.is_length else name_and_unit(self.expression)
        return f"{name} {fact(self.value, self.relation, self.limit, unit)}".strip()

    def rays(self) -> NDArray[np.bool_]:
        """Return True for each ray of the sector of a distance with the same outcome, shape (R,)."""
        assert self.read is not None
        scan, sector = self.read
        away = ray_distances(scan.ranges, scan)
        alike = OPERATORS[self.relation](away, self.limit) == self.holds
        result: NDArray[np.bool_] = alike & ~np.isnan(away) & inside(scan, sector)
        return result


class Look:
    """A function of samples, rewritten so that each call returns what it read and compared, too.

    A function whose source is not known is called as it is; its verdicts contain the reason.

    Args:
        function: the function.
        known: functions that another process has rewritten, which knows their sources.

    Attributes:
        function: the function as it is.

    Examples:
        >>> scan = Scan([1.0, 0.4], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=4.0)
        >>> Look(lambda scan: scan.distance() < 0.5).judge(scan).value
        True
    """

    def __init__(self, function: Callable[..., Any], known: Sequence[Rewritten] = ()) -> None:
        self.function, self._known = function, known
        self._code: CodeType | None = None
        self._forms: list[_Form] = []
        self._why = ""

    def __reduce__(self) -> Any:
        found = [(one.function, one.source, marshal.dumps(one.code)) for one in _all_rewritten(self.function)]
        return _received, (self.function, found)

    def __call__(self, *samples: Any, **values: Any) -> tuple[Any, Reasons]:
        """Return the result of the function, and what it read and compared. Its exceptions pass through."""
        function = self.function
        # Written out, as a search calls it often.
        is_same = type(function) is FunctionType and function.__code__ is self._code
        try:
            form = self._forms.pop() if is_same else self._form()
        except IndexError:  # all are in use
            form = self._form()
        if form is None:
            return function(*samples, **values), Reasons((), (), self._why)
        log = form.log
        try:
            result = form.function(*samples, **values)
            reasons = Reasons((*samples, *values.values()) if values else samples, [*log], form.why)
        finally:
            log.clear()
        self._forms.append(form)
        return result, reasons

    def prepare(self) -> None:
        """Rewrite the function now, which takes some milliseconds, and not in its first call."""
        if form := self._form():
            self._forms.append(form)

    def judge(self, *samples: Any) -> Verdict:
        """Return the verdict of the function on some samples.

        The function may return True or False, None for unknown, a `Ray`, or True or False for each ray, shape (R,), or
        for each ray of a part of the ranges; the latter is true if any ray is. Its exceptions pass through.
        """
        result, reasons = self(*samples)
        return reasons.verdict(result)

    def _form(self) -> _Form | None:
        """Return an idle rewritten form, or None for a function that cannot be rewritten."""
        code = _code_of(self.function)
        if code is not self._code:  # at first, and if autoreload has changed it in place
            self._code, self._forms, self._why = code, [], ""
        if self._why:
            return None
        try:
            return self._forms.pop()
        except IndexError:
            pass
        try:
            return _Form(self.function, self._known)
        except NotRewrittenError as error:
            self._why = str(error)
        except Exception as error:  # the condition is judged without reasons, which say why
            self._why = f"its source could not be read ({type(error).__name__}: {error})"
        return None


def _received(function: Callable[..., Any], found: list[tuple[Any, FunctionSource, bytes]]) -> Look:
    """Return the look of another process."""
    return Look(function, [Rewritten(source, marshal.loads(code), each) for each, source, code in found])


def _all_rewritten(function: Callable[..., Any]) -> list[Rewritten]:
    """Return a function and the functions that it calls by name, rewritten if they can be."""
    found: list[Rewritten] = []
    left, seen = [function], {id(function)}
    while left:
        with suppress(Exception):  # its verdicts contain the reason
            found.append(rewritten(each := left.pop(), Looker))
            inner = function_in(each)
            cells = [cell.cell_contents for cell in inner.__closure__ or ()]
            called = [one for one in (*cells, *map(inner.__globals__.get, _names(inner.__code__))) if _is_users(one)]
            left += [one for one in called if id(one) not in seen]
            seen.update(map(id, called))
    return found


def _names(code: CodeType) -> list[str]:
    """Return the global names in a code and in the functions in it."""
    return [*code.co_names, *(name for one in code.co_consts if isinstance(one, CodeType) for name in _names(one))]


def _code_of(function: Any) -> CodeType | None:
    try:
        return function_in(function).__code__
    except NotRewrittenError:
        return None


class LookHooks:
    """Functions for `HOOKS`: they note the rays that methods read, and what called functions read and compare.

    Attributes:
        log: the notes.
        why: the reason why a function that it calls is not rewritten; empty if all are.
    """

    def __init__(self, known: Sequence[Rewritten] = ()) -> None:
        self._known = known
        self.log: deque[Note] = deque(maxlen=MOST_NOTES)
        self.why = ""
        self._codes: dict[int, tuple[CodeType, Rewritten | None]] = {}
        """The rewritten functions that it called, by the ids of their codes; None if a code stays as it is."""
        self._called: dict[int, tuple[FunctionType, CodeType, Any]] = {}
        """The functions that it called, by their ids: the function, its code, and its rewritten form."""

    def method(self, _place: int, value: Any) -> Any:
        """Return a method that notes its rays if it is of a scan, or the value as it is."""
        of = value.__self__ if type(value) is MethodType else None
        if not isinstance(of, Scan):
            return value

        def noted(*given: Any, **named: Any) -> Any:
            result = value(*given, **named)
            asked = given or (*named.values(),)
            self.log.append((_METHODS[value.__name__], bool(asked), result, of, *asked[:1]))
            return result

        return noted

    def called(self, _place: int, value: Any) -> Any:
        """Return the rewritten form of a function or method of the user, or the value as it is."""
        kind = type(value)
        if kind is FunctionType:
            return self._called_form(value)
        if kind is MethodType and type(value.__func__) is FunctionType:
            inner = self._called_form(value.__func__)
            return value if inner is value.__func__ else MethodType(inner, value.__self__)
        return value

    def _found(self, function: Callable[..., Any]) -> Rewritten:
        sent = next((one for one in self._known if one.function is function), None)
        return sent or rewritten(function, Looker)

    def _bound(self, found: Rewritten) -> Any:
        places, add = found.source.places, self.log.append

        def note(place: int, value: Any) -> Any:
            add((places, place, value))
            return value

        def note_1(place: int, value: Any, one: Any) -> Any:
            add((places, place, value, one))
            return value

        def note_2(place: int, value: Any, one: Any, other: Any) -> Any:
            add((places, place, value, one, other))
            return value

        notes = (note, note_1, note_2)
        return found.bind((*notes, *notes, self.method, self.called))

    def _called_form(self, function: FunctionType) -> Any:
        """Return the rewritten form of a function that the condition calls, or the function as it is."""
        known = self._called.get(id(function))
        if known is None or known[1] is not function.__code__:
            if len(self._called) >= _MOST_CALLED:  # functions that are made in each call
                self._called.clear()
            found = self._found_called(function)
            made = function if found is None else self._bound(replace(found, function=function))
            known = self._called[id(function)] = function, function.__code__, made
        return known[2]

    def _found_called(self, function: FunctionType) -> Rewritten | None:
        code = function.__code__
        if id(code) not in self._codes:
            found = None
            if _is_users(function) and not is_bound(code):
                try:
                    found = self._found(function)
                except Exception as error:  # its reasons stay unknown
                    self.why = f"of {function.__name__}, as {error}"
            self._codes[id(code)] = code, found
        return self._codes[id(code)][1]


class _Form(LookHooks):
    """A rewritten function with its own notes, for one call at a time.

    Attributes:
        function: the rewritten function.
    """

    def __init__(self, function: Callable[..., Any], known: Sequence[Rewritten]) -> None:
        super().__init__(known)
        self.function = self._bound(self._found(function))


def _is_users(function: Any) -> bool:
    """Return True for a function that is of no library."""
    if type(function) is not FunctionType:
        return False
    file = function.__code__.co_filename
    is_ours = str(function.__module__).startswith("robowidgets.")
    return not (is_ours or file.startswith(_LIBRARIES) or "site-packages" in file)


_METHODS = {
    name: tuple(
        NotedPlace("rays", 0, extras=count, relation=name, operands=tuple(Operand("", extra=i) for i in range(count)))
        for count in (1, 2)
    )
    for name in ("distance", "nearest", "at")
}
"""The places of methods that a condition passes on: without an argument, and with one."""


class Reasons:
    """The values that one call of a function read and compared.

    Args:
        samples: the arguments of the call.
        notes: the notes of the call, in their order.
        why: the reason why the function has no notes; empty if it has.
    """

    def __init__(self, samples: Iterable[Any], notes: Sequence[Note], why: str = "") -> None:
        self._samples, self._notes, self._why = samples, notes, why

    def value(self, result: Any) -> bool | None:
        """Return True, False or None (unknown) for the result of the function.

        None and NaN mean unknown. A result is unknown too if all compared distances are, or all numbers if it compared
        no distance: a comparison with NaN is False, but that means neither False nor True.

        Raises:
            TypeError: the result is a number with a fraction, such as a distance, or text. It was not compared.
        """
        if isinstance(result, (float, np.floating)):
            if isnan(result):
                return None
            raise TypeError(f"expected True, False or None, got {result:g}: compare it, as in ... < 0.3")
        if result is None:
            return None
        if isinstance(result, str):
            raise TypeError(f"expected True, False or None, got {result!r:.80}")
        if _has_nan(self._notes):  # else all that it compared is known
            compared = self._read.distances or self._read.comparisons
            if compared and not any(comparison.is_known for comparison in compared):
                return None
        return bool(np.any(result)) if _is_mask(result) else bool(result)

    def nearest(self) -> Ray | None:
        """Return the ray to the nearest thing among the rays that were read."""
        met = self.met()
        return met[1] if met else None

    def met(self) -> tuple[float, Ray] | None:
        """Return the nearest thing among the rays that were read: its distance as in `Scan.distance`, and its ray."""
        found = self._read.seen
        for scan, sector in [c.read for c in self._decisive if c.read] or self._read.sectors:
            if ray := scan.nearest(sector):
                found.append((scan, ray))
        away = [(_distance_of(ray, scan), ray) for scan, ray in found]
        return min((one for one in away if not isnan(one[0])), key=lambda one: one[0], default=None)

    def verdict(self, result: Any) -> Verdict:
        """Return the verdict for the result of the function."""
        value = self.value(result)
        return Verdict(value, self.text, self._marked(result), self.nearest()) if value else Verdict(value, self.text)

    @property
    def text(self) -> str:
        """The comparisons, as `Verdict.text`, or the reason why they are not known."""
        choices = self._choices
        conditions = [comparison for comparison in self._read.comparisons if id(comparison) not in choices]
        decisive = [comparison for comparison in conditions if comparison.holds] or conditions
        texts = [comparison.text for comparison in decisive if comparison.is_known]
        shown = " · ".join([*dict.fromkeys(texts)][:_MOST_TEXTS])
        return shown or (f"shows no reasons: {self._why}" if self._why else "")

    @cached_property
    def _read(self) -> _Read:
        return _Read(self._samples, self._notes)

    @property
    def _decisive(self) -> list[_Comparison]:
        """The comparisons of distances that held, or all if no comparison held, as in ``not distance > limit``."""
        choices = self._choices
        conditions = [comparison for comparison in self._read.distances if id(comparison) not in choices]
        return [comparison for comparison in conditions if comparison.holds] or conditions

    @cached_property
    def _choices(self) -> set[int]:
        """The ids of comparisons that only chose the distance to compare: ``near = a if a < b else b``."""
        choices: set[int] = set()
        distances = self._read.distances
        limited: frozenset[int] = frozenset().union(*(c.between for c in distances if len(c.between) == 1))
        left = [c for c in distances if len(c.between) == 2]
        while found := [c for c in left if c.between & limited]:
            choices.update(map(id, found))
            limited = limited.union(*(c.between for c in found))
            left = [c for c in left if id(c) not in choices]
        return choices

    def _marked(self, result: Any) -> NDArray[np.intp]:
        read = self._read
        if _is_mask(result):
            indices = (np.arange(len(scan))[key] for scan, key in read.parts)
            return next((part[result] for part in indices if part.shape == result.shape), NO_RAYS)
        if isinstance(result, Ray):
            return np.array([result.index], np.intp)
        if read.distances:
            return np.flatnonzero(np.logical_or.reduce([comparison.rays() for comparison in self._decisive]))
        nearest = [scan.nearest(sector) for scan, sector in read.sectors]
        return np.unique(np.array([ray.index for ray in (*(ray for _, ray in read.seen), *nearest) if ray], np.intp))


class _Read:
    """The notes of a call, read once.

    Attributes:
        comparisons: all comparisons of numbers, in their order.
        distances: the comparisons of distances among them.
        sectors: the scans and sectors whose distance was read.
        parts: the scans, with the keys that read all of their ranges or a part of them.
    """

    def __init__(self, samples: Iterable[Any], notes: Sequence[Note]) -> None:
        self.comparisons: list[_Comparison] = []
        self.distances: list[_Comparison] = []
        self.sectors: list[tuple[Scan, SectorLike]] = []
        self.parts: list[tuple[Scan, Any]] = []
        self._rays: list[tuple[Scan, Ray]] = []
        self._scans: dict[int, Scan] = {}
        """The scans, by the ids of their ranges."""
        self._reads: dict[int, tuple[Scan, SectorLike]] = {}
        """The distances that were read, by their ids: all values are alive in the notes."""
        self._lengths: set[float] = set()
        """The ranges that were read."""
        self._of_parts: dict[tuple[int, int], Scan] = {}
        """The scans that were read in parts, by the id of the scan and the index of the nearest ray of a part."""
        self._single: tuple[float, Scan, Any] | None = None
        """The nearest of the ranges that were read one by one: its range, scan and index."""
        self._last: dict[tuple[int, int], Any] = {}
        for sample in samples:
            if isinstance(sample, Scan):
                self._add_scan(sample)
        for note in notes:
            self._take(*note)

    @property
    def seen(self) -> list[tuple[Scan, Ray]]:
        """The rays that were read, each with its scan."""
        seen = [*self._rays, *((scan, scan[index]) for (_, index), scan in self._of_parts.items())]
        if self._single:
            _, scan, key = self._single
            seen.append((scan, scan[int(np.arange(len(scan))[key])]))
        return seen

    def _add_scan(self, scan: Scan) -> None:
        if id(scan.ranges) not in self._scans:
            self._scans[id(scan.ranges)] = scan
            self.parts.append((scan, slice(None)))

    def _take(self, places: Sequence[NotedPlace], number: int, value: Any, *extras: Any) -> None:
        place = places[number]
        if place.chain:
            self._compare(places, place, extras)
        elif place.relation:
            self._take_read(place, value, [self._side(places, side, extras) for side in place.operands])
        if isinstance(value, Scan):
            self._add_scan(value)
        self._last[id(places), number] = value

    def _side(self, places: Sequence[NotedPlace], side: Operand, extras: Sequence[Any]) -> Any:
        if side.extra is not None:
            return extras[side.extra] if side.extra < len(extras) else None
        return side.constant if side.place is None else self._last.get((id(places), side.place))

    def _take_read(self, place: NotedPlace, value: Any, sides: list[Any]) -> None:
        of = sides[0] if sides else None
        if isinstance(value, Ray):
            self._rays += [(of, value)] if isinstance(of, Scan) else []
            self._lengths.add(value.range)
        elif place.relation == "distance" and isinstance(of, Scan):
            sector = sides[1] if len(sides) > 1 else ALL_ROUND
            sector = getattr(sector, "parts", sector)  # a tuple whose first parts were kept
            self.sectors.append((of, sector))
            self._reads[id(value)] = of, sector
        elif scan := self._scan_of(of if sides else value):
            if place.relation == PART and isinstance(value, (np.ndarray, np.generic)):
                self._look(scan, slice(*sides[1:]) if len(sides) > 2 else sides[1], value)
            elif place.relation == EACH or (place.relation == ALL and np.isscalar(value)):
                self._look(scan, slice(None), scan.ranges)

    def _scan_of(self, value: Any) -> Scan | None:
        """Return a scan, or the scan of an array of ranges."""
        if isinstance(value, Scan):
            self._add_scan(value)
            return value
        return self._scans.get(id(value))

    def _look(self, scan: Scan, key: Any, part: Any) -> None:
        """Take a read of an index of the ranges, which returned a part of them or a single one."""
        if not part.ndim:
            before = self._single
            self._lengths.add(float(part))
            if before is None or part < before[0] or isnan(before[0]):
                self._single = part, scan, key
            return
        self.parts.append((scan, key))
        away = np.where(np.isnan(part), np.inf, part)
        if part.size and away.min() < np.inf:
            self._lengths.add(float(away.min()))
            self._of_parts[id(scan), int(np.arange(len(scan))[key].flat[away.argmin()])] = scan

    def _compare(self, places: Sequence[NotedPlace], place: NotedPlace, extras: Sequence[Any]) -> None:
        sides = [self._side(places, side, extras) for side in place.operands]
        for i, relation in enumerate(place.chain):
            left, right = sides[i : i + 2]
            if relation not in OPERATORS or not (_is_number(left) and _is_number(right)):
                return
            holds = bool(OPERATORS[relation](left, right))
            self._add(place.operands[i : i + 2], left, relation, right, holds)
            if not holds:
                return  # the rest was not computed

    def _add(self, operands: Sequence[Operand], left: Any, relation: str, right: Any, holds: bool) -> None:
        reads = self._reads
        between = frozenset(id(one) for one in (left, right) if id(one) in reads)
        is_right = id(left) not in reads and (id(right) in reads or _is_constant(operands[0]))
        if is_right:
            left, right, relation, operands = right, left, MIRRORED[relation], operands[::-1]
        read = reads.get(id(left))
        is_length = read is not None or (isinstance(left, (float, np.floating)) and float(left) in self._lengths)
        expression = "" if is_length else operands[0].text
        made = _Comparison(left, relation, right, holds, expression, is_length, read, between)
        self.comparisons.append(made)
        if read is not None:
            self.distances.append(made)


def _distance_of(ray: Ray, scan: Scan) -> float:
    """Return the distance of a ray as `Scan.distance` has it; NaN if the ray has no measurement."""
    if ray.validity is Validity.READING:
        return float(scan.ranges[ray.index])
    return float(ray_distances(scan.ranges[[ray.index]], scan)[0])


def _has_nan(notes: Sequence[Note]) -> bool:
    floats = _FLOATS
    return any(value != value for note in notes for value in note[2:] if type(value) in floats)


def _is_constant(side: Operand) -> bool:
    return side.place is None and side.extra is None


def _is_number(value: Any) -> bool:
    return isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)


def _is_mask(result: Any) -> bool:
    """Return True if the result is True or False for each ray, or for each ray of a part of them."""
    return isinstance(result, np.ndarray) and result.dtype == bool and result.ndim == 1
