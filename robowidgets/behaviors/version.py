"""One version of a program."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from .._core.cells import CellRun
from ..samples.checks import finite

RATE = 10.0
"""Steps a second, where a program names neither a rate nor a topic."""

FASTEST = 200.0
"""Steps a second."""


def to_rate(value: Any) -> float:
    """Steps a second; TypeError or ValueError for anything else."""
    rate = finite("rate", value, "steps a second")
    if not 0 < rate <= FASTEST:
        raise ValueError(f"rate: expected steps a second, above 0 and at most {FASTEST:g}, got {value!r}")
    return rate


@dataclass(frozen=True)
class Version:
    """One version of a program.

    ``asks_for`` are the parameters of the function, ``topics`` the topics that were named for some of them. It steps
    ``rate`` times a second, or on each message of the topic ``on``. ``text`` is that of the cell or file it stands in,
    and ``cell`` the run of a cell that made it.
    """

    function: Callable[..., Any]
    asks_for: tuple[str, ...] = ()
    topics: Mapping[str, str] = field(default_factory=dict)
    rate: float = RATE
    on: str | None = None
    number: int = 1
    text: str = ""
    cell: CellRun = ("", "")
