"""One version of a program."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..notebook.cells import CellRun
from ..samples.checks import finite

RATE = 10.0
"""The steps per second of a program that names neither a rate nor a topic."""

FASTEST = 200.0
"""The highest number of steps per second."""


def to_rate(value: Any) -> float:
    """Return a valid rate in steps per second; TypeError or ValueError for anything else."""
    rate = finite("rate", value, "steps a second")
    if not 0 < rate <= FASTEST:
        raise ValueError(f"rate: expected steps a second, above 0 and at most {FASTEST:g}, got {value!r}")
    return rate


@dataclass(frozen=True)
class Version:
    """One version of a program.

    ``asks_for`` are the parameters of the function, and ``topics`` the topics that the user named for some of them. The
    program steps ``rate`` times a second, or on each message of the topic ``on``. ``text`` is the text of the cell or
    file of the function, and ``cell`` the run of the cell that made the version. If a number was changed on the page,
    ``written`` is the text as it still stands in the cell, and ``change`` is the change as text; else both are empty.
    """

    function: Callable[..., Any]
    asks_for: tuple[str, ...] = ()
    topics: Mapping[str, str] = field(default_factory=dict)
    rate: float = RATE
    on: str | None = None
    number: int = 1
    text: str = ""
    cell: CellRun = ("", "")
    written: str = ""
    change: str = ""
