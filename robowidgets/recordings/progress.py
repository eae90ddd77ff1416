"""A bar for what takes longer than a second, in a notebook and in a terminal."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

SHOWN_AFTER = 1.0
"""Seconds."""


_hidden: ContextVar[bool] = ContextVar("hidden", default=False)


@contextmanager
def one_bar() -> Iterator[None]:
    """Within it no more bars are shown: one tells of the whole."""
    before = _hidden.set(True)
    try:
        yield
    finally:
        _hidden.reset(before)


def progress(total: int, what: str, unit: str = " messages") -> Any:
    """A tqdm bar that stays hidden for the first second and goes away at the end; to be used in a ``with``."""
    # Here, because it costs more than all the rest, and most of what is asked of a recording needs no bar.
    from tqdm.auto import tqdm

    return tqdm(
        total=total, desc=what, unit=unit, unit_scale=True, delay=SHOWN_AFTER, leave=False, disable=_hidden.get()
    )
