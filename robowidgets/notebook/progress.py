"""Progress bars for steps that take longer than a second, in a notebook and in a terminal."""

from __future__ import annotations

import time
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from .cells import close_all

SHOWN_AFTER = 1.0
"""Seconds of work before a bar is shown."""


_BETWEEN = 0.5
"""The shortest time in seconds between two updates of a bar. In a log, each update is a line."""

_SCALED_FROM = 10_000
"""The smallest count that is shown by its first digits only."""

_hidden: ContextVar[bool] = ContextVar("hidden", default=False)


@contextmanager
def without_bars() -> Iterator[None]:
    """Show no bars that are made within the block: the caller has its own, or is a background thread."""
    before = _hidden.set(True)
    try:
        yield
    finally:
        _hidden.reset(before)


class Progress:
    """A context manager that makes a tqdm bar once its block has run for a second, and removes the bar at the end.

    A bar in a notebook consists of ten widgets, which ipywidgets keeps until they are closed. Most steps are short:
    they need neither these widgets nor the time to import tqdm.
    """

    def __init__(self, total: int | None, what: str, unit: str = " messages") -> None:
        self._options = {"total": total, "desc": what, "unit": unit}
        self._is_scaled = total is None or total >= _SCALED_FROM
        self._is_hidden = _hidden.get()
        self._began = time.monotonic()
        self._done = 0
        self._bar: Any = None

    def update(self, count: int, note: str = "") -> None:
        """Add to the number of finished items, with a note next to it."""
        self._done += count
        taken = time.monotonic() - self._began
        if self._bar is not None:
            if note:
                self._bar.set_postfix_str(note, refresh=False)
            self._bar.update(count)
        elif taken >= SHOWN_AFTER and not self._is_hidden:
            from tqdm.auto import tqdm

            self._bar = tqdm(**self._options, unit_scale=self._is_scaled, leave=False, mininterval=_BETWEEN)
            if not self._bar.disable:
                # The bar's rate counts from the beginning.
                self._bar.start_t -= taken
                self._bar.last_print_t -= taken
            self._bar.update(self._done)

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, _kind: object, error: BaseException | None, _trace: object) -> None:
        bar = self._bar
        if bar is None:
            return
        if not isinstance(error, Exception):
            # In a notebook, a bar closed before its end would stay, in red.
            bar.total = bar.n
        bar.close()
        box = getattr(bar, "container", None)
        if box is not None and box.comm is None:
            close_all(box)
