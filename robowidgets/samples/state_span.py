"""Spans in which the states of a program's machines were active."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable
from itertools import pairwise
from typing import NamedTuple

MOST_ROWS = 3
"""Rows of a band of states."""


def spelled(path: str) -> str:
    """Return a state as pictures and texts write it: ``Walker › avoid › turn`` for ``Walker.avoid.turn``."""
    return path.replace(".", " › ")


class StateSpan(NamedTuple):
    """A span in which a state was active, in seconds from the start of a recording or of a program.

    ``path`` names machines and states from the outermost inwards, such as ``Walker.avoid.turn``.
    """

    start: float
    end: float
    path: str

    @property
    def machine(self) -> str:
        """The machine that the state belongs to."""
        return self.path.rpartition(".")[0]

    @property
    def name(self) -> str:
        """The name of the state without its machines."""
        return self.path.rpartition(".")[2]


def rows_of(spans: Iterable[StateSpan]) -> list[list[StateSpan]]:
    """Return the spans in at most `MOST_ROWS` rows without overlaps: outer machines first, nested ones below."""
    by_machine: defaultdict[str, list[StateSpan]] = defaultdict(list)
    for span in spans:
        by_machine[span.machine].append(span)
    depths = {machine: sum(machine.startswith(f"{outer}.") for outer in by_machine) for machine in by_machine}
    rows: list[list[StateSpan]] = [[] for _ in range(MOST_ROWS)]
    for machine in sorted(depths, key=lambda machine: depths[machine]):
        for number, row in enumerate(rows[depths[machine] :], depths[machine]):
            both = sorted([*row, *by_machine[machine]])
            if all(before.end <= after.start for before, after in pairwise(both)):
                rows[number] = both
                break
    return [row for row in rows if row]
