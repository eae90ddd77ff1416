"""Statistics of fields over many recordings, by any property of the recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from math import isnan
from pathlib import PurePath
from typing import Any, ClassVar

from ..notebook.progress import without_bars
from ..recording import open as open_recording
from ..recordings.columns.tables import RowType, number, text, whole
from ..recordings.field_values import check_value_name, first_value, values_of
from ..repair import RecordingError, natural
from ..runtime.tables import Table
from ..runtime.text import many
from ..samples.checks import number as checked_number
from ._fleet_table import SHOWN, FleetTable, Unread, cell_of, date_of, not_read, short, with_problems
from ._gather import gather
from ._tally import ERROR, Tally
from ._topics import chosen_of
from .places import places_in_index

By = str | Mapping[str, Any] | Callable[[str], Any]
_COUNTS = ("drives", "count", "unknown", "inf", "minus_inf")
_LIMITS = ("mean", "min", "max")


class Statistics(FleetTable):
    """A row for each group of recordings and each field: see `Drives.statistics`. Printed, it shows the first ones.

    The columns: the group under the name of ``by``, ``field``, ``drives`` with a value of it, ``count`` of the finite
    values, ``mean``, ``min``, quantiles such as ``q50``, and ``max``; ``unknown``, the number of values that are NaN or
    missing, ``inf`` and ``minus_inf``, for distances nothing in range and too close (REP 117). None of these three is
    in the others. A recording that lacks a field is in `unread` with the reason.

    Args:
        group: the name of the column of the group, or empty for all recordings together.
        numbers: the values of the columns, by group and field.
        quantiles: the quantiles, from 0 to 1.
        is_exact: True if all quantiles are exact.
        problems: the problems of each recording, as in `Recording.losses`: values may be missing.
        **rows: as for `FleetTable`.
    """

    _types: ClassVar = {"field": text, **dict.fromkeys(_COUNTS, whole), **dict.fromkeys(_LIMITS, number)}

    def __init__(
        self,
        group: str,
        numbers: Mapping[tuple[str | None, str], Mapping[str, Any]],
        quantiles: Sequence[float],
        *,
        is_exact: bool,
        problems: Mapping[str, Sequence[str]],
        **rows: Any,
    ) -> None:
        super().__init__(**rows)
        self._group, self._quantiles = group, tuple(quantiles)
        self._numbers = dict(sorted(numbers.items(), key=lambda one: (one[0][0] is None, natural(one[0][0] or ""))))
        self.problems = {file: tuple(lines) for file, lines in problems.items()}
        self.is_exact = is_exact
        """True if all quantiles are exact; otherwise they differ by 0.1 % of the size of the next values at most."""

    def __len__(self) -> int:
        return len(self._numbers)

    def _kinds(self) -> Mapping[str, RowType]:
        group = {self._group: text} if self._group else {}
        least, most = {"mean": number, "min": number}, {"max": number}
        quantiles = {_name(part): number for part in self._quantiles}
        return {
            **group,
            "field": text,
            **dict.fromkeys(_COUNTS[:2], whole),
            **least,
            **quantiles,
            **most,
            **dict.fromkeys(_COUNTS[2:], whole),
        }

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for (group, field), numbers in self._numbers.items():
            yield {**({self._group: group} if self._group else {}), "field": field, **numbers}

    def _complaints(self) -> Iterator[str]:
        yield from super()._complaints()
        yield from with_problems(self.problems)

    def _table(self) -> Table:
        heads = tuple(self._kinds())
        rows = [row for row, _ in zip(self._rows(), range(SHOWN), strict=False)]
        names = short([row["file"] for row in rows]) if self._group == "file" else {}
        cells = [tuple(names.get(row[head]) or cell_of(row[head]) for head in heads) for row in rows]
        more = [f"  ... and {len(self) - SHOWN:,} more"] if len(self) > SHOWN else []
        if not self.is_exact:
            more.append(f"  quantiles of many values differ by {ERROR:.1%} of the size of the next values at most")
        fields = ", ".join(dict.fromkeys(field for _, field in self._numbers)) or "no field"
        head = f"{fields} in {many(len(self.files), 'recording')}"
        right = [i for i, name in enumerate(heads) if name not in (self._group, "field")]
        return Table(head, heads, cells, right, more, list(self._complaints()))


def _name(part: float) -> str:
    """Return the name of the column of a quantile: ``q05``, ``q50``, ``q99.9``."""
    percent = f"{part * 100:.6g}"
    return f"q{percent.zfill(2) if percent.isdigit() else percent}"


def _numbers_of(tally: Tally, quantiles: Sequence[float]) -> dict[str, Any]:
    """Return the values of the columns."""
    return {
        **{name: getattr(tally, name) for name in _COUNTS},
        "mean": _or_none(tally.mean),
        "min": tally.least if tally.count else None,
        **{_name(part): _or_none(tally.quantile(part)) for part in quantiles},
        "max": tally.most if tally.count else None,
    }


def _or_none(value: float) -> float | None:
    return None if isnan(value) else value


def statistics(
    files: Sequence[str],
    given: Sequence[Any],
    by: By | None,
    known: Mapping[str, str | None] | None,
    quantiles: Iterable[float],
    topics: tuple[str, ...],
    executor: Any,
    longest: float,
) -> Statistics:
    """See `Drives.statistics`.

    Args:
        files: the recordings.
        given: the fields.
        by: as there.
        known: the group of each recording, if the index has it, or None.
        quantiles: as there.
        topics: names and patterns of preferred topics.
        executor: as there.
        longest: as there.
    """
    if not given:
        raise TypeError('statistics(): expected fields, such as "/odom.twist.twist.linear.x" or "front", got none')
    names = [check_value_name(one) for one in given]
    if not isinstance(quantiles, Iterable) or isinstance(quantiles, str):
        raise TypeError(f"quantiles: expected numbers from 0 to 1, such as (0.05, 0.5, 0.95), got {quantiles!r}")
    quantiles = tuple(quantiles)
    for part in quantiles:
        if not 0 <= checked_number("quantiles", part) <= 1:
            raise ValueError(f"quantiles: expected numbers from 0 to 1, got {part!r}")
    groups = known if known is not None else _groups(files, by)
    column = "" if by is None else by if isinstance(by, str) else "group"
    sink = _Sink(groups, quantiles, is_by_day=by == "day")
    job = _Job(tuple(zip(names, given, strict=True)), topics, by if groups is None and isinstance(by, str) else "")
    gathered = gather(job, places_in_index(files), sink, "Reading values", executor=executor, longest=longest)
    rows = gathered.rows
    rows["unread"] = [*rows["unread"], *sink.lacking]
    numbers = sink.numbers()
    if not numbers and rows["until"] is None:
        why = next(iter(not_read(rows["unread"])), "the index is empty")
        raise RecordingError(f"none of {many(len(files), 'recording')} has {', '.join(names)}: {why}")
    return Statistics(column, numbers, quantiles, is_exact=sink.is_exact, problems=sink.problems, **rows)


def _groups(files: Sequence[str], by: By | None) -> Mapping[str, str | None] | None:
    """Return the group of each recording, or None if a field of it has the group."""
    if by is None:
        return dict.fromkeys(files, "")
    if not (isinstance(by, (str, Mapping)) or callable(by)):
        raise TypeError(f"by: expected a text, a mapping, a function or None, got {by!r}")
    if isinstance(by, Mapping):
        if missing := [file for file in files if file not in by]:
            raise ValueError(
                f"by: expected a group for each recording, got none for {missing[0]}, one of {len(missing):,} without"
            )
        return {file: _text(by[file]) for file in files}
    if callable(by):
        return {file: _text(by(file)) for file in files}
    if by == "file":
        return {file: file for file in files}
    if by == "folder":
        return {file: str(PurePath(file).parent) for file in files}
    return None


def _text(group: Any) -> str | None:
    return None if group is None else str(group)


class _Job:
    """A function that returns the numbers of one recording.

    Args:
        fields: the fields by their names.
        topics: names and patterns of topics.
        by: the field whose first value is the group, or empty.
    """

    def __init__(self, fields: tuple[tuple[str, Any], ...], topics: tuple[str, ...], by: str) -> None:
        self._fields, self._topics, self._by = fields, topics, by

    def __call__(self, path: str) -> dict[str, Any]:
        with open_recording(path) as recording, without_bars():
            recording.preferred = frozenset(chosen_of(recording, self._topics))
            group = first_value(recording, self._by) if self._by else None
            if self._by and group is None:
                return {"problem": f"no message of {self._by}"}
            tallies: dict[str, Tally] = {}
            lacking = []
            start = date_of(recording.start_ns)
            for name, given in self._fields:
                tally = Tally()
                try:
                    for values in values_of(recording, given):
                        tally.add(values)
                except (RecordingError, TypeError) as error:
                    lacking.append(str(error))
                    continue
                tally.drives = int(tally.count > 0)
                tallies[name] = tally
            problems = recording.losses
        if not tallies:
            return {"problem": lacking[0]}
        day = start and f"{start:%Y-%m-%d}"
        return {"tallies": tallies, "lacking": lacking, "group": group, "day": day, "problems": list(problems)}


class _Sink:
    """A `ResultStore` that stores nothing, and adds the numbers of each recording to its group.

    Args:
        groups: the group of each recording, or None if its result has it.
        quantiles: the quantiles of the rows.
        is_by_day: True to take the day of a recording from its result if the index lacks it.
    """

    problem = ""

    def __init__(self, groups: Mapping[str, str | None] | None, quantiles: Sequence[float], *, is_by_day: bool) -> None:
        self._groups, self._quantiles, self._is_by_day = groups, quantiles, is_by_day
        self._is_alone = groups is not None and not is_by_day and len({*groups.values()}) == len(groups)
        self._tallies: dict[tuple[str | None, str], Tally] = {}
        self._numbers: dict[tuple[str | None, str], dict[str, Any]] = {}
        self.is_exact = True
        self.problems: dict[str, Sequence[str]] = {}
        """The problems of recordings that were read in part."""
        self.lacking: list[Unread] = []
        """Recordings without one of the fields, with the reasons."""

    def get(self, state: str) -> Any:  # noqa: ARG002
        return None

    def add(self, path: str, state: str | None, result: Mapping[str, Any]) -> Any:  # noqa: ARG002
        group = str(result["group"]) if self._groups is None else self._groups[path]
        if group is None and self._is_by_day:
            group = result["day"]
        if result["problems"]:
            self.problems[path] = result["problems"]
        self.lacking += [Unread(path, problem) for problem in result["lacking"]]
        for name, tally in result["tallies"].items():
            if self._is_alone:  # no other recording has the group, so its values need not stay
                self._close(group, name, tally)
            else:
                self._tallies.setdefault((group, name), Tally()).merge(tally)
        return {}

    def numbers(self) -> Mapping[tuple[str | None, str], Mapping[str, Any]]:
        """Return the values of the columns, by group and field."""
        for (group, name), tally in self._tallies.items():
            self._close(group, name, tally)
        return self._numbers

    def _close(self, group: str | None, name: str, tally: Tally) -> None:
        self._numbers[group, name] = _numbers_of(tally, self._quantiles)
        self.is_exact &= tally.is_exact
