"""Read the files of a study and compare the two forms by paired times, solved tasks, TLX and SUS."""

from __future__ import annotations

import math
import sys
from collections.abc import Callable, Iterable, Sequence
from html import escape
from pathlib import Path
from typing import NamedTuple

import numpy as np

sys.path.insert(0, str(Path(__file__).parent))
from study import SUS, TASKS, TLX, WITH, WITHOUT, Row, read_rows

_T_975 = (
    *(12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131),
    *(2.120, 2.110, 2.101, 2.093, 2.086, 2.080, 2.074, 2.069, 2.064, 2.060, 2.056, 2.052, 2.048, 2.045, 2.042),
)
"""The 97.5 % quantile of Student's t, from one degree of freedom on."""
_Z_975 = 1.959964


class Measure(NamedTuple):
    """One measure of all participants, paired, and its effect with a 95 % confidence interval.

    ``values`` has a row for each participant: with, without. The effect is the ratio of times (below 1 means faster
    with widgets), otherwise the difference, with minus without. The interval is NaN if the differences do not vary.
    """

    name: str
    values: np.ndarray
    effect: float
    low: float
    high: float
    is_ratio: bool

    def __str__(self) -> str:
        kind = "ratio" if self.is_ratio else "difference"
        means = ", ".join(f"{mean:.1f}" for mean in self.values.mean(axis=0))
        return f"{self.name:22} {means:>16}   {kind} {self.effect:.2f}, {self.interval}"

    @property
    def interval(self) -> str:
        """The interval as text."""
        if math.isnan(self.low):
            return "no interval: the difference is the same for all participants"
        return f"95 % CI {self.low:.2f} to {self.high:.2f}"


class Comparison:
    """The results of a study: `measures`, and a line in `problems` for each skipped file."""

    def __init__(self, participants: Sequence[int], measures: Iterable[Measure], problems: Sequence[str]) -> None:
        self.participants = tuple(participants)
        self.measures = tuple(measures)
        self.problems = tuple(problems)

    def __repr__(self) -> str:
        head = f"{len(self.participants)} participants           with, without"
        return "\n".join([head, *map(str, self.measures), *(f"left out: {problem}" for problem in self.problems)])

    def _repr_html_(self) -> str:
        parts = "".join(
            f'<figure style="display:inline-block;margin:0 1em 1em 0"><figcaption>{escape(measure.name)}<br>'
            f"<small>{'ratio' if measure.is_ratio else 'difference'} <b>{measure.effect:.2f}</b>, "
            f"{measure.interval}</small></figcaption>{_pairs(measure)}</figure>"
            for measure in self.measures
        )
        problems = "".join(f"<li>{escape(problem)}</li>" for problem in self.problems)
        left_out = f"<p>Left out:<ul>{problems}</ul>" if problems else ""
        head = f"{len(self.participants)} participants, each a line from with to without"
        return f"<div><p>{head}</p>{parts}{left_out}</div>"


def compare(folder: str | Path) -> Comparison:
    """Compare all participants with complete files (``P07.csv``) in a folder.

    The 95 % confidence intervals use Student's t for the mean of the paired differences (for times, of their
    logarithms). An unsolved task counts with its time limit.

    Raises:
        ValueError: the folder has fewer than two complete files.
    """
    people: list[list[Row]] = []
    file_of: dict[int, str] = {}
    problems = []
    for file in sorted(Path(folder).glob("P*.csv")):
        try:
            rows = read_rows(file)
        except (ValueError, OSError) as error:
            problems.append(str(error))
            continue
        problem = _incomplete(rows)
        if problem:
            problems.append(f"{file.name} is not complete: {problem}")
            continue
        number = rows[0].participant
        if file_of.setdefault(number, file.name) != file.name:
            problems.append(f"{file.name} and {file_of[number]} are both of participant {number}: keep one of them")
        else:
            people.append(rows)
    if len(people) < 2:
        raise ValueError(f"compare: expected two complete files or more in {folder}, got {len(people)} {problems}")
    measures = [
        _measure("seconds per task", people, lambda rows: float(np.exp(np.mean(np.log(_times(rows))))), is_ratio=True),
        _measure("tasks solved", people, lambda rows: float(sum(row.right for row in rows if row.kind == "task"))),
        _measure("TLX, 0 to 100", people, lambda rows: float(np.mean(_values(rows, "tlx")))),
        _measure("SUS, 0 to 100", people, _sus),
    ]
    return Comparison([rows[0].participant for rows in people], measures, problems)


def _incomplete(rows: Sequence[Row]) -> str:
    """Return the missing or repeated steps of a participant, or an empty text if each step occurs once."""
    for kind, items in (("task", TASKS), ("tlx", TLX), ("sus", [str(number) for number in range(1, len(SUS) + 1)])):
        for form in (WITH, WITHOUT):
            found = [row.item for row in rows if (row.kind, row.condition) == (kind, form)]
            if sorted(found) != sorted(items):
                rows_there = ", ".join(found) or "none"
                return f"expected a row for each {kind} {form} widgets: {', '.join(items)}; got {rows_there}"
    numbers = {row.participant for row in rows}
    return f"it has rows of the participants {sorted(numbers)}" if len(numbers) > 1 else ""


def _times(rows: Sequence[Row]) -> list[float]:
    return [max(row.seconds, 0.1) for row in rows if row.kind == "task"]


def _values(rows: Sequence[Row], kind: str) -> list[float]:
    return [float(row.value) for row in rows if row.kind == kind]


def _sus(rows: Sequence[Row]) -> float:
    return 2.5 * sum(value - 1 if number % 2 == 0 else 5 - value for number, value in enumerate(_values(rows, "sus")))


def _measure(
    name: str, people: Sequence[Sequence[Row]], of: Callable[[Sequence[Row]], float], *, is_ratio: bool = False
) -> Measure:
    values = np.array([[of([r for r in rows if r.condition == form]) for form in (WITH, WITHOUT)] for rows in people])
    scale = np.log(values) if is_ratio else values
    differences = scale[:, 0] - scale[:, 1]
    found = float(differences.mean()), *interval_of(differences)
    return Measure(name, values, *(map(float, np.exp(list(found))) if is_ratio else found), is_ratio)


def interval_of(differences: np.ndarray) -> tuple[float, float]:
    """Return the 95 % confidence interval of the mean of paired differences; NaN if none varies."""
    mean, spread = float(differences.mean()), float(differences.std(ddof=1))
    if spread < 1e-9 * max(1.0, abs(mean)):
        return math.nan, math.nan
    away = _t_975(len(differences) - 1) * spread / math.sqrt(len(differences))
    return mean - away, mean + away


def _t_975(freedom: int) -> float:
    """Return the 97.5 % quantile of Student's t (beyond the table by the expansion of Cornish and Fisher)."""
    if freedom <= len(_T_975):
        return _T_975[freedom - 1]
    z = _Z_975
    return z + (z**3 + z) / (4 * freedom) + (5 * z**5 + 16 * z**3 + 3 * z) / (96 * freedom**2)


def _pairs(measure: Measure) -> str:
    """Return a picture with a line for each participant from with to without, and the means."""
    low, high = float(measure.values.min()), float(measure.values.max())
    span = (high - low) or 1.0

    def y(value: float) -> float:
        return 130 - 110 * (value - low) / span

    lines = "".join(f'<path d="M60 {y(a):.1f}L180 {y(b):.1f}"/>' for a, b in measure.values.tolist())
    first, second = measure.values.mean(axis=0).tolist()
    return (
        f'<svg width="240" height="155" style="font:11px sans-serif" fill="currentColor">'
        f'<g stroke="currentColor" opacity=".35" fill="none">{lines}</g>'
        f'<path d="M60 {y(first):.1f}L180 {y(second):.1f}" stroke="#1f7a46" stroke-width="3" fill="none"/>'
        f'<text x="52" y="{y(first) + 4:.1f}" text-anchor="end">{first:.1f}</text>'
        f'<text x="188" y="{y(second) + 4:.1f}">{second:.1f}</text>'
        '<text x="60" y="150" text-anchor="middle">with</text>'
        '<text x="180" y="150" text-anchor="middle">without</text></svg>'
    )
