"""A condition in two sets of drives: how often, the difference with its interval, and the files and places of it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from math import inf, isfinite, nan, sqrt
from typing import Any, ClassVar, NamedTuple

import numpy as np

from ..recordings.columns.tables import RowType, library, number, text, whole
from ..runtime.tables import Table
from ..runtime.text import many
from ..samples.checks import number as checked_number
from ._fleet_table import SHOWN, FleetTable, cell_of, short, with_problems
from ._index_file import IndexFile
from ._rates import Exposure, Rate, rates_of
from .hits import Hits

_HOUR = 3600.0


class SearchedSet(NamedTuple):
    """The results of a condition in a set of drives, under its name.

    ``seconds``: the time in which the condition was known to be true or false, for each drive that was searched or
    ruled out by the index.
    """

    name: str
    hits: Hits
    file: IndexFile
    seconds: Mapping[str, float]

    def exposure(self) -> Exposure:
        """Return the number of hits and the hours of each drive in ``seconds``."""
        counts = Counter(hit.file for hit in self.hits)
        found = np.array([counts.get(file, 0) for file in self.seconds], np.int64)
        return Exposure(found, np.array(list(self.seconds.values()), float) / _HOUR)


class RateTable(FleetTable):
    """A table of `RateComparison`, the rows with the largest differences first. Printed, it shows these.

    Args:
        heading: the line above it.
        kinds: the columns with their types.
        found: the values of each row, by column.
        **rows: as for `FleetTable`.
    """

    _types: ClassVar = {}

    def __init__(
        self, heading: str, kinds: Mapping[str, RowType], found: Sequence[Mapping[str, Any]], **rows: Any
    ) -> None:
        super().__init__(**rows)
        self._heading, self._columns_of, self._found = heading, kinds, tuple(found)

    def __len__(self) -> int:
        return len(self._found)

    def _kinds(self) -> Mapping[str, RowType]:
        return self._columns_of

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        yield from self._found

    def _table(self) -> Table:
        heads = tuple(self._columns_of)
        names = short([row["file"] for row in self._found[:SHOWN]]) if "file" in heads else {}
        rows = [tuple(cell_of(names.get(row[head], row[head])) for head in heads) for row in self._found[:SHOWN]]
        more = [f"  ... and {len(self) - SHOWN:,} more"] if len(self) > SHOWN else []
        right = [i for i, kind in enumerate(self._columns_of.values()) if kind is not text]
        return Table(self._heading, heads, rows, right, more)


class RateComparison(FleetTable):
    """A condition in two sets of drives: see `Drives.compare`.

    A row for each set, and one for the ``difference``, the second minus the first. The columns: ``set``, ``drives``
    that could be searched, the ``hours`` in which the condition was true or false, not unknown, ``count`` of the spans,
    ``per_hour``, and the ends ``low`` and ``high`` of its interval of 95 %. The hours of a drive that was ruled out are
    by the index, a row until the next one, so a silence of all topics counts. If not all drives were reached, the
    difference is unknown, and with one drive in a set its interval.

    Args:
        condition: the text of the condition.
        before: the results in the first set.
        after: the results in the second set.
    """

    _types: ClassVar = {
        "set": text,
        "drives": whole,
        "hours": number,
        "count": whole,
        "per_hour": number,
        "low": number,
        "high": number,
    }

    def __init__(self, condition: str, before: SearchedSet, after: SearchedSet) -> None:
        both = before.hits, after.hits
        until = [len(hits.files) if hits.until is None else hits.until for hits in both]
        super().__init__(
            [*both[0].files, *both[1].files],
            list(dict.fromkeys([*both[0].unread, *both[1].unread])),
            None if all(hits.is_complete for hits in both) else sum(until),
            "; ".join(dict.fromkeys(hits.note for hits in both if hits.note)),
        )
        self.condition = condition
        self.problems = {**both[0].problems, **both[1].problems}
        """The problems of recordings that were searched, as in `Recording.losses`: spans may be missing."""
        self._in_both = len({*both[0].files} & {*both[1].files})
        self._sets = before, after
        self.before, self.after = both
        """The spans in each set, as `Hits`."""
        self._exposures = before.exposure(), after.exposure()
        *self._rates, self.difference, self.spreads = rates_of(*self._exposures)
        """The difference per hour with its interval; and by set the variance between drives, 1 for Poisson rates."""
        if not self.is_complete:
            self.difference = Rate(nan, nan, nan)

    @property
    def is_different(self) -> bool:
        """True if the interval of the difference does not contain 0."""
        return self.difference.low > 0 or self.difference.high < 0

    def by_file(self) -> RateTable:
        """Return a row for each recording with a span, the ones furthest above the common rate first."""
        exposures = self._exposures
        hours = sum(float(one.hours.sum()) for one in exposures)
        usual = sum(int(one.counts.sum()) for one in exposures) / hours if hours else 0.0
        found: list[dict[str, Any]] = []
        for part in self._sets:
            counts = Counter(hit.file for hit in part.hits)
            for file, count in counts.items():
                own = part.seconds[file] / _HOUR
                found.append(
                    {
                        "set": part.name,
                        "file": file,
                        "hours": own,
                        "count": count,
                        "per_hour": count / own if own else None,
                    }
                )
        found.sort(key=lambda row: (usual * row["hours"] - row["count"]) / sqrt(max(usual * row["hours"], 1e-9)))
        kinds = {"set": text, "file": text, "hours": number, "count": whole, "per_hour": number}
        return RateTable(f"{self.condition}, by file", kinds, found, files=self.files)

    def by_place(self, size: float = 1.0) -> RateTable:
        """Return a row for each square of the floor with a span in it, the largest differences first.

        Places are by odometry, so they agree between drives that start at the same place in the same direction. The
        place of a span is the place at its start; hours count the seconds with a message in the square. Both are by the
        index, so spans in a part of a drive that it does not have are left out.

        Args:
            size: the side of a square in metres.

        Raises:
            TypeError, ValueError: the size is not a number above 0.
        """
        if not 0 < checked_number("size", size) < inf:
            raise ValueError(f"size: expected metres above 0, got {size!r}")
        names = ("before", "after")
        seconds, counts = (
            [_seconds_by_place(one, size) for one in self._sets],
            [_hits_by_place(one, size) for one in self._sets],
        )
        found = []
        for place in dict.fromkeys([*counts[0], *counts[1]]):
            row: dict[str, Any] = {"x": (place[0] + 0.5) * size, "y": (place[1] + 0.5) * size}
            for name, times, spans in zip(names, seconds, counts, strict=True):
                hours, count = times.get(place, 0) / _HOUR, spans.get(place, 0)
                row |= {f"hours_{name}": hours, f"count_{name}": count}
                row[f"per_hour_{name}"] = count / hours if hours else None
            found.append(row)
        found.sort(key=_difference, reverse=True)
        kinds = {"x": number, "y": number}
        for name in names:
            kinds |= {f"hours_{name}": number, f"count_{name}": whole, f"per_hour_{name}": number}
        return RateTable(f"{self.condition}, by squares of {size:g} m", kinds, found, files=self.files)

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for part, exposure, rate in zip(self._sets, self._exposures, self._rates, strict=True):
            yield {
                "set": part.name,
                "drives": len(exposure.counts),
                "hours": float(exposure.hours.sum()),
                "count": int(exposure.counts.sum()),
                **_plain(rate),
            }
        yield {"set": "difference", **_plain(self.difference)}

    def _complaints(self) -> Iterator[str]:
        if self._in_both:
            are = "is" if self._in_both == 1 else "are"
            yield f"{many(self._in_both, 'recording')} {are} in both sets"
        yield from super()._complaints()
        yield from with_problems(self.problems)

    def _table(self) -> Table:
        heads = tuple(self._types)
        rows = [tuple(cell_of(row.get(head)) for head in heads) for row in self._rows()]
        if not self.is_complete:
            verdict = "not all drives were searched"
        elif not isfinite(self.difference.per_hour):
            verdict = "one of the sets has no drive that could be searched"
        elif not isfinite(self.difference.low):
            verdict = "unknown with one drive in a set"
        elif self.is_different:
            verdict = f"{self._sets[1].name} has {'more' if self.difference.per_hour > 0 else 'fewer'} per hour"
        else:
            verdict = "the sets do not differ beyond chance"
        spreads = ", ".join(f"{spread:.3g}" if isfinite(spread) else "unknown" for spread in self.spreads)
        notes = [f"  low and high: 95 % (Poisson, MOVER; variance between drives: {spreads})"]
        return Table(f"{self.condition}: {verdict}", heads, rows, range(1, len(heads)), notes, list(self._complaints()))


def _plain(rate: Rate) -> dict[str, float | None]:
    return {name: value if isfinite(value) else None for name, value in rate._asdict().items()}


def _difference(row: Mapping[str, Any]) -> float:
    """Return the difference of the counts at a place in standard deviations of equal rates."""
    hours, count = row["hours_before"] + row["hours_after"], row["count_before"] + row["count_after"]
    share = row["hours_after"] / hours if hours else 0.5
    share = min(max(share, 0.01), 0.99)
    return float(abs(row["count_after"] - count * share) / sqrt(count * share * (1 - share)))


def _places(x: Any, y: Any, size: float) -> Any:
    """Return the numbers of the squares of some places, shape (N, 2)."""
    return np.floor(np.stack((x, y), axis=1) / size).astype(np.int64)


def _seconds_by_place(one: SearchedSet, size: float) -> dict[tuple[int, int], int]:
    """Return the number of seconds with a message in each square, in recordings that could be searched."""
    found: Counter[tuple[int, int]] = Counter()
    for batch in one.file.batches(("file", "x", "y")):
        file = batch.column("file")
        names = file.dictionary.to_pylist()
        is_searched = np.array([name in one.seconds for name in names], bool)[file.indices.to_numpy(False)]
        x, y = batch.column("x").to_numpy(False), batch.column("y").to_numpy(False)
        is_known = is_searched & np.isfinite(x) & np.isfinite(y)
        squares, counts = np.unique(_places(x[is_known], y[is_known], size), axis=0, return_counts=True)
        found.update(dict(zip(map(tuple, squares.tolist()), counts.tolist(), strict=True)))
    return found


def _hits_by_place(one: SearchedSet, size: float) -> Counter[tuple[int, int]]:
    """Return the number of hits that start in each square; hits at a place that is not in the index do not count."""
    starts: dict[str, list[float]] = {}
    for hit in one.hits:
        starts.setdefault(hit.file, []).append(hit.start)
    found: Counter[tuple[int, int]] = Counter()
    if not starts:
        return found
    among = library("pyarrow.dataset", "compare").field("file").isin(list(starts))
    table = one.file.dataset.to_table(["file", "second", "x", "y"], filter=among).unify_dictionaries()
    files = table["file"].combine_chunks()
    files = files.chunk(0) if hasattr(files, "num_chunks") else files
    columns = [files.indices.to_numpy(False), *(table[name].to_numpy() for name in ("second", "x", "y"))]
    order = np.lexsort((columns[1], columns[0]))
    codes, second, x, y = (column[order] for column in columns)
    number_of = {name: i for i, name in enumerate(files.dictionary.to_pylist())}
    for file, seconds in starts.items():
        first, last = np.searchsorted(codes, (number_of[file], number_of[file] + 1))
        inside = [at for at in seconds if second[first] <= at <= second[last - 1] + 1]  # not with null, as NaN
        row = first + np.searchsorted(second[first:last], inside, side="right") - 1
        row = row[np.isfinite(x[row]) & np.isfinite(y[row])]
        found.update(map(tuple, _places(x[row], y[row], size).tolist()))
    return found
