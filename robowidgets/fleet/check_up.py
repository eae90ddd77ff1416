"""A check-up of many recordings: the kinds of problems, the number of recordings with them, and their first dates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, ClassVar, NamedTuple

from ..notebook.progress import without_bars
from ..recording import open as open_recording
from ..recordings.columns.tables import date, text
from ..runtime.tables import Table
from ..runtime.text import listed, many
from ..samples import Problem
from ._engine import LONGEST
from ._fleet_table import FleetTable, date_of, without_name
from ._gather import gather, kept_of
from .places import PathLike

_FORM = 2
_NUMBERS = re.compile(r"\d[\d,.:]*")


class KindOfProblem(NamedTuple):
    """Problems that differ only in their numbers: the number of recordings, the date of the first, and a remedy."""

    text: str
    recordings: int
    since: str
    remedy: str


class CheckUp(FleetTable):
    """The problems of many recordings. Printed, it has a line for each kind of problem. As a table it has all.

    Args:
        found: the start of each recording, and its problems with their remedies.
        **rows: as for `FleetTable`.
    """

    _types: ClassVar = {"file": text, "date": date, "problem": text, "remedy": text}

    def __init__(self, found: dict[str, dict[str, Any]], **rows: Any) -> None:
        super().__init__(**rows)
        self._found = found

    @property
    def kinds(self) -> tuple[KindOfProblem, ...]:
        """The kinds of problems, the most frequent first."""
        groups: dict[str, dict[str, tuple[str, str]]] = {}
        for file, one in self._found.items():
            for problem, remedy in one["problems"]:
                alike = _NUMBERS.sub("…", without_name(problem, file))
                groups.setdefault(alike, {}).setdefault(file, (problem, remedy))
        kinds = []
        for alike, files in groups.items():
            dates = sorted(when for file in files if (when := date_of(self._found[file]["start_ns"])))
            shown, remedy = next(iter(files.values()))
            since = f"{dates[0]:%Y-%m-%d}" if dates else ""
            kinds.append(KindOfProblem(shown if len(files) == 1 else alike, len(files), since, remedy))
        return tuple(sorted(kinds, key=lambda kind: -kind.recordings))

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for file, one in self._found.items():
            for problem, remedy in one["problems"]:
                yield {"file": file, "date": date_of(one["start_ns"]), "problem": problem, "remedy": remedy}

    def _table(self) -> Table:
        kinds = self.kinds
        bad = [Path(file).name for file, one in self._found.items() if one["problems"]]
        head = f"{many(len(self._found), 'recording')}, {len(bad):,} with problems"
        rows = [(f"{kind.recordings:,}", kind.since, str(Problem(kind.text, kind.remedy))) for kind in kinds]
        notes = [f"  {listed(bad, 10)}"] if bad else ["no problems found"] * bool(self._found)
        heads = ("recordings", "since", "problem")
        return Table(head, heads, rows, right=(0,), notes=notes, problems=list(self._complaints()))


def doctor(*paths: PathLike, executor: Any = None, longest: float = LONGEST, keep: bool = True) -> CheckUp:
    """Check many recordings with `Recording.doctor`: the problems, the number of recordings, and the first dates.

    Args:
        *paths: as for `find`.
        executor: as for `find`.
        longest: as for `find`.
        keep: as for `find`.

    Raises:
        TypeError: as for `find`. ValueError: as for `find`.
    """
    kept = kept_of(("doctor", _FORM), keep)
    gathered = gather(_check, paths, kept, "Checking", executor=executor, longest=longest)
    return CheckUp(gathered.results, **gathered.rows)


def _check(path: str) -> dict[str, Any]:
    with open_recording(path) as recording, without_bars():
        problems = recording.doctor().problems
        return {"start_ns": recording.start_ns, "problems": [[problem.what, problem.remedy] for problem in problems]}
