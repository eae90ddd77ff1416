"""One version of a program."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

RATE = 10.0
"""Steps a second, where a program names neither a rate nor a topic."""


@dataclass(frozen=True)
class Version:
    """One version of a program.

    ``asks_for`` are the parameters of the function, ``topics`` the topics that were named for some of them. It steps
    ``rate`` times a second, or on each message of the topic ``on``. ``text`` is that of the cell or file it stands in.
    """

    function: Callable[..., Any]
    asks_for: tuple[str, ...] = ()
    topics: Mapping[str, str] = field(default_factory=dict)
    rate: float = RATE
    on: str | None = None
    number: int = 1
    text: str = ""
