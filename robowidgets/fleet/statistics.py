"""Statistics of fields over many recordings, by any property of the recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
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
from ._fleet_table import SHOWN, FleetTable, Unread, cell_of, not_read, short
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
        tallies: the numbers by group and field.
        quantiles: the quantiles, from 0 to 1.
        **rows: as for `FleetTable`.
    """

    _types: ClassVar = {"field": text, **dict.fromkeys(_COUNTS, whole), **dict.fromkeys(_LIMITS, number)}

    def __init__(
        self, group: str, tallies: Mapping[tuple[str, str], Tally], quantiles: Sequence[float], **rows: Any
    ) -> None:
        super().__init__(**rows)
        self._group, self._quantiles = group, tuple(quantiles)
        self._tallies = dict(sorted(tallies.items(), key=lambda one: natural(one[0][0])))
        self.is_exact = all(tally.is_exact for tally in tallies.values())
        """True if all quantiles are exact; otherwise they differ by 0.1 % of their size at most."""

    def __len__(self) -> int:
        return len(self._tallies)

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
        for (group, field), tally in self._tallies.items():
            yield {
                **({self._group: group} if self._group else {}),
                "field": field,
                **{name: getattr(tally, name) for name in _COUNTS},
                "mean": _or_none(tally.mean),
                "min": tally.least if tally.count else None,
                **{_name(part): _or_none(tally.quantile(part)) for part in self._quantiles},
                "max": tally.most if tally.count else None,
            }

    def _table(self) -> Table:
        heads = tuple(self._kinds())
        rows = [row for row, _ in zip(self._rows(), range(SHOWN), strict=False)]
        names = short([row["file"] for row in rows]) if self._group == "file" else {}
        cells = [tuple(names.get(row[head]) or cell_of(row[head]) for head in heads) for row in rows]
        more = [f"  ... and {len(self) - SHOWN:,} more"] if len(self) > SHOWN else []
        if not self.is_exact:
            more.append(f"  quantiles of many values differ by {ERROR:.1%} of their size at most")
        fields = ", ".join(dict.fromkeys(field for _, field in self._tallies)) or "no field"
        head = f"{fields} in {many(len(self.files), 'recording')}"
        right = [i for i, name in enumerate(heads) if name not in (self._group, "field")]
        return Table(head, heads, cells, right, more, list(self._complaints()))


def _name(part: float) -> str:
    """Return the name of the column of a quantile: ``q05``, ``q50``, ``q99.9``."""
    percent = f"{part * 100:.6g}"
    return f"q{percent.zfill(2) if percent.isdigit() else percent}"


def _or_none(value: float) -> float | None:
    return None if isnan(value) else value


def statistics(
    files: Sequence[str],
    given: Sequence[Any],
    by: By | None,
    known: Mapping[str, str] | None,
    quantiles: Sequence[float],
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
    for part in quantiles:
        if not 0 <= checked_number("quantiles", part) <= 1:
            raise ValueError(f"quantiles: expected numbers from 0 to 1, got {part!r}")
    groups = known if known is not None else _groups(files, by)
    column = "" if by is None else by if isinstance(by, str) else "group"
    sink = _Sink(groups)
    job = _Job(tuple(zip(names, given, strict=True)), topics, by if groups is None and isinstance(by, str) else "")
    gathered = gather(job, places_in_index(files), sink, "Reading values", executor=executor, longest=longest)
    rows = gathered.rows
    rows["unread"] = [*rows["unread"], *sink.lacking]
    if not sink.tallies and rows["until"] is None:
        why = next(iter(not_read(rows["unread"])), "the index is empty")
        raise RecordingError(f"none of {many(len(files), 'recording')} has {', '.join(names)}: {why}")
    return Statistics(column, sink.tallies, quantiles, **rows)


def _groups(files: Sequence[str], by: By | None) -> Mapping[str, str] | None:
    """Return the group of each recording, or None if a field of it has the group."""
    if by is None:
        return dict.fromkeys(files, "")
    if isinstance(by, Mapping):
        if missing := [file for file in files if file not in by]:
            raise ValueError(f"by: has no group for {missing[0]}, one of {len(missing):,} recordings without one")
        return {file: str(by[file]) for file in files}
    if callable(by):
        return {file: str(by(file)) for file in files}
    if by == "file":
        return {file: file for file in files}
    if by == "folder":
        return {file: str(PurePath(file).parent) for file in files}
    return None


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
        return {"tallies": tallies, "lacking": lacking, "group": group} if tallies else {"problem": lacking[0]}


class _Sink:
    """A `ResultStore` that stores nothing, and adds the numbers of each recording to its group.

    Args:
        groups: the group of each recording, or None if its result has it.
    """

    problem = ""

    def __init__(self, groups: Mapping[str, str] | None) -> None:
        self._groups = groups
        self.tallies: dict[tuple[str, str], Tally] = {}
        self.lacking: list[Unread] = []
        """Recordings without one of the fields, with the reasons."""

    def get(self, state: str) -> Any:  # noqa: ARG002
        return None

    def add(self, path: str, state: str | None, result: Mapping[str, Any]) -> Any:  # noqa: ARG002
        group = str(result["group"]) if self._groups is None else self._groups[path]
        self.lacking += [Unread(path, problem) for problem in result["lacking"]]
        for name, tally in result["tallies"].items():
            self.tallies.setdefault((group, name), Tally()).merge(tally)
        return {}
