"""The verdict of a condition on one sample, and the rays that decided it."""

from __future__ import annotations

from collections.abc import Callable
from copy import copy
from math import isnan
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._traced_ranges import traced as traced_ranges
from .checks import frozen
from .distances import inside, ray_distances
from .mount import Mount
from .ray import Ray
from .scan import Scan
from .sector import ALL_ROUND, SectorLike
from .speed import Speed
from .traced_numbers import OPERATORS, UNITS, NumberComparison, fact, plain, traced, traced_fields, traced_values

NO_RAYS: NDArray[np.intp] = frozen(np.empty(0, np.intp))

_MOST_TEXTS = 3


class Verdict(NamedTuple):
    """The verdict of a condition on one sample.

    ``value`` is True, False, or None if unknown. ``text`` is the comparison as a fact, such as ``"1.24 < 1.50 m"``.
    ``rays`` are the indices of the rays that made it true, shape (M,), ascending; empty if it is not true, or if no ray
    decided it. ``nearest`` is the ray to the nearest thing if the condition is true, or None if it read no distance.
    """

    value: bool | None
    text: str = ""
    rays: NDArray[np.intp] = NO_RAYS
    nearest: Ray | None = None


UNKNOWN = Verdict(None)


class _Comparison(NamedTuple):
    """A comparison of a distance of a scan with a limit.

    ``between`` has the id of the distance, and of the limit if that is a distance too.
    """

    scan: Scan
    sector: SectorLike
    distance: float
    relation: str
    limit: float
    holds: bool
    between: frozenset[int]

    @property
    def is_known(self) -> bool:
        """True if the distance is known."""
        return not isnan(self.distance)

    @property
    def text(self) -> str:
        """The outcome of the comparison."""
        return fact(self.distance, self.relation, self.limit)

    def rays(self) -> NDArray[np.bool_]:
        """Return True for each ray of the sector with the same outcome of the comparison, shape (R,)."""
        away = ray_distances(self.scan.ranges, self.scan)
        alike = OPERATORS[self.relation](away, self.limit) == self.holds
        result: NDArray[np.bool_] = alike & ~np.isnan(away) & inside(self.scan, self.sector)
        return result


class _Distance(float):
    """A distance that records its comparisons."""

    _note: Callable[[str, float], bool]

    def __lt__(self, other: Any) -> bool:
        return self._note("<", other)

    def __le__(self, other: Any) -> bool:
        return self._note("≤", other)

    def __gt__(self, other: Any) -> bool:
        return self._note(">", other)

    def __ge__(self, other: Any) -> bool:
        return self._note("≥", other)


_Distance.__name__ = "float"  # for errors in the user's function, such as a comparison with a text


class _TracedScan(Scan):
    """A scan that records the distances and ranges that a function reads, and its comparisons of distances.

    A copy of it, also by `dataclasses.replace`, is a plain scan.
    """

    _trace: Trace
    _scan: Scan

    def __new__(cls, *fields: Any, **named: Any) -> Any:
        return Scan(*fields, **named)

    def __reduce__(self) -> Any:
        return copy, (self._scan,)

    def distance(self, sector: SectorLike = ALL_ROUND, *, percentile: float | None = None) -> float:
        """See `Scan`."""
        return self._trace.read(self._scan, sector, self._scan.distance(sector, percentile=percentile))

    def nearest(self, sector: SectorLike = ALL_ROUND) -> Ray | None:
        """See `Scan`."""
        return self._trace.saw(self._scan, self._scan.nearest(sector))

    def at(self, angle: float | str) -> Ray | None:
        """See `Scan`."""
        return self._trace.saw(self._scan, self._scan.at(angle))

    def turned(self, angle: float | str) -> Scan:
        """See `Scan`."""
        turned: Scan = self._trace.of(self._scan.turned(angle))
        return turned

    def mounted(self, mount: Mount | None) -> Scan:
        """See `Scan`."""
        mounted: Scan = self._trace.of(self._scan.mounted(mount))
        return mounted

    def unmounted(self) -> Scan:
        """See `Scan`."""
        unmounted: Scan = self._trace.of(self._scan.unmounted())
        return unmounted


_TracedScan.__name__ = "Scan"  # for errors in the user's function, such as an attribute that scans do not have


class Trace:
    """A record of one call of a function of samples: the values that it reads and compares.

    Examples:
        >>> trace = Trace()
        >>> scan = Scan([1.0, 0.4], angle_min=0.0, angle_increment=0.1, range_min=0.1, range_max=4.0)
        >>> trace.verdict(trace.of(scan).distance() < 0.5).rays.tolist()
        [1]
    """

    def __init__(self) -> None:
        self._comparisons: list[_Comparison] = []
        self._all: list[_Comparison | NumberComparison] = []
        """All comparisons, of distances and of other numbers, in order of time."""
        self._rays: list[tuple[Scan, Ray]] = []
        self._sectors: list[tuple[Scan, SectorLike]] = []
        self._distances: list[_Distance] = []
        """The distances that were read, kept alive so that their ids stay unique."""
        self._parts: list[tuple[Scan, Any]] = []
        """The scans, with the keys that read all of their ranges or a part of them."""
        self._of_parts: dict[tuple[int, int], Scan] = {}
        """The scans that were read in parts, by the id of the scan and the index of the nearest ray of a part."""
        self._single: tuple[float, Scan, Any] | None = None
        """The nearest of the ranges that were read one by one: its range, scan and index."""

    def of(self, sample: Any) -> Any:
        """Return a scan that records what is read from it, or another sample as it is."""
        if not isinstance(sample, Scan):
            return sample
        self._parts.append((sample, slice(None)))
        _ = sample.angles  # cached once for the scan and for all its traced copies
        traced = object.__new__(_TracedScan)
        ranges = traced_ranges(sample.ranges, lambda key, part: self.looked(sample, key, part))
        traced.__dict__.update(sample.__dict__, ranges=ranges, _scan=sample, _trace=self)
        return traced

    def named(self, name: str, value: Any) -> Any:
        """Return an argument of a program's step by its name: a scan as from `of`; numbers record their comparisons."""
        note = self._all.append
        if name in ("state", "variables"):
            return traced_values(value, note)
        if isinstance(value, Speed):
            return traced_fields(value, ("linear", "angular", "pose"), note)
        return self.of(value) if isinstance(value, Scan) else traced(value, name, note, UNITS.get(name, ""))

    def read(self, scan: Scan, sector: SectorLike, distance: float) -> float:
        """Record that the distance in a sector was read."""
        self._sectors.append((scan, sector))
        noted = _Distance(distance)

        def compare(relation: str, limit: Any) -> bool:
            # A plain number: Python would call the method of the other distance first, which would swap the sides.
            outcome: Any
            between = frozenset(id(one) for one in (noted, limit) if isinstance(one, _Distance))
            limit = float(limit) if isinstance(limit, _Distance) else plain(limit)
            try:
                outcome = OPERATORS[relation](distance, limit)
            except TypeError:
                outcome = NotImplemented  # Python then raises the error on the line that compares.
            if isinstance(outcome, (bool, np.bool_)):
                comparison = _Comparison(scan, sector, distance, relation, float(limit), bool(outcome), between)
                self._comparisons.append(comparison)
                self._all.append(comparison)
            result: bool = outcome
            return result

        vars(noted)["_note"] = compare
        self._distances.append(noted)
        return noted

    def saw(self, scan: Scan, ray: Ray | None) -> Ray | None:
        """Record that a ray was read."""
        if ray:
            self._rays.append((scan, ray))
        return ray

    def looked(self, scan: Scan, key: Any, part: Any) -> None:
        """Record that an index of the ranges was read, which returned a part of them or a single one."""
        if not part.ndim:
            before = self._single
            if before is None or part < before[0] or isnan(before[0]):
                self._single = part, scan, key
            return
        self._parts.append((scan, key))
        away = np.where(np.isnan(part), np.inf, part)
        if part.size and away.min() < np.inf:
            self._of_parts[id(scan), int(np.arange(len(scan))[key].flat[away.argmin()])] = scan

    def value(self, result: Any) -> bool | None:
        """Return True, False or None (unknown) for the result of the function.

        None and NaN mean unknown. A result is unknown too if all compared distances are: a comparison with NaN is
        False, but that means neither False nor True.
        """
        compared = self._comparisons or self._all
        if result is None or (isinstance(result, (float, np.floating)) and isnan(result)):
            return None
        if compared and not any(comparison.is_known for comparison in compared):
            return None
        return bool(np.any(result)) if _is_mask(result) else bool(result)

    def nearest(self) -> Ray | None:
        """Return the ray to the nearest thing among the rays that were read."""
        met = self.met()
        return met[1] if met else None

    def met(self) -> tuple[float, Ray] | None:
        """Return the nearest thing among the rays that were read: its distance as in `Scan.distance`, and its ray."""
        found = self._seen
        for scan, sector in [(c.scan, c.sector) for c in self._decisive] or self._sectors:
            if ray := Scan.nearest(scan, sector):
                found.append((scan, ray))
        away = [(float(ray_distances(scan.ranges[[ray.index]], scan)[0]), ray) for scan, ray in found]
        return min((one for one in away if not isnan(one[0])), key=lambda one: one[0], default=None)

    def verdict(self, result: Any) -> Verdict:
        """Return the verdict for the result of the function."""
        value = self.value(result)
        return Verdict(value, self.text, self._marked(result), self.nearest()) if value else Verdict(value, self.text)

    @property
    def text(self) -> str:
        """The comparisons, as `Verdict.text`."""
        choices = self._choices
        conditions = [comparison for comparison in self._all if id(comparison) not in choices]
        decisive = [comparison for comparison in conditions if comparison.holds] or conditions
        texts = [comparison.text for comparison in decisive if comparison.is_known]
        return " · ".join([*dict.fromkeys(texts)][:_MOST_TEXTS])

    @property
    def _decisive(self) -> list[_Comparison]:
        """The comparisons that held, or all if no comparison held, as in ``not distance > limit``."""
        choices = self._choices
        conditions = [comparison for comparison in self._comparisons if id(comparison) not in choices]
        return [comparison for comparison in conditions if comparison.holds] or conditions

    @property
    def _choices(self) -> set[int]:
        """The ids of comparisons by min, max or sorted, which chose the distance to compare: not conditions."""
        choices: set[int] = set()
        limited: frozenset[int] = frozenset().union(*(c.between for c in self._comparisons if len(c.between) == 1))
        left = [c for c in self._comparisons if len(c.between) == 2]
        while found := [c for c in left if c.between & limited]:
            choices.update(map(id, found))
            limited = limited.union(*(c.between for c in found))
            left = [c for c in left if id(c) not in choices]
        return choices

    def _marked(self, result: Any) -> NDArray[np.intp]:
        if _is_mask(result):
            indices = (np.arange(len(scan))[key] for scan, key in self._parts)
            return next((part[result] for part in indices if part.shape == result.shape), np.array([], np.intp))
        if isinstance(result, Ray):
            return np.array([result.index], np.intp)
        if self._comparisons:
            return np.flatnonzero(np.logical_or.reduce([comparison.rays() for comparison in self._decisive]))
        nearest = [Scan.nearest(scan, sector) for scan, sector in self._sectors]
        seen = [ray for _, ray in self._seen]
        return np.unique(np.array([ray.index for ray in (*seen, *nearest) if ray], np.intp))

    @property
    def _seen(self) -> list[tuple[Scan, Ray]]:
        """The rays that were read, each with its scan."""
        seen = [*self._rays, *((scan, scan[index]) for (_, index), scan in self._of_parts.items())]
        if self._single:
            _, scan, key = self._single
            seen.append((scan, scan[int(np.arange(len(scan))[key])]))
        return seen


def _is_mask(result: Any) -> bool:
    """Return True if the result is True or False for each ray, or for each ray of a part of them."""
    return isinstance(result, np.ndarray) and result.dtype == bool and result.ndim == 1


def judged(function: Callable[..., Any], *samples: Any) -> Verdict:
    """Return the verdict of a function on some samples.

    The function may return True or False, None for unknown, a `Ray`, or True or False for each ray, shape (R,), or for
    each ray of a part of the ranges; the latter is true if any ray is. Its exceptions pass through.
    """
    trace = Trace()
    return trace.verdict(function(*map(trace.of, samples)))
