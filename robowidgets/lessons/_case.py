"""One case of a task."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

Answer = Callable[..., Any]


class Case(NamedTuple):
    """One case of a task: its title, a sample to look at, and what raises `WrongError` for a wrong answer."""

    title: str
    sample: Any
    judge: Callable[[Answer], None]
