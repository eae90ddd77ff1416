"""The results of a search so far, as a table in the notebook that grows while it runs."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from ..notebook.cells import running_cell
from ..notebook.progress import SHOWN_AFTER
from ..runtime.error_routing import called_from_cell
from ._fleet_table import Unread
from .hits import Hits

_LEAST = 0.5
_SHARE = 20
"""The minimum number of seconds between two updates, and a factor on the CPU time of an update, so that a long table
does not slow down the search. The first update does not count, because it loads the widget."""


class LiveTable:
    """A table of the results so far, shown once a search has run for a second in a notebook cell, and nowhere else.

    Args:
        to_hits: makes a table of the results so far, the recordings that could not be read, and all files.
        clock: returns seconds.
        cpu: returns seconds of CPU time of this thread, because other processes search on all cores meanwhile.
    """

    def __init__(
        self,
        to_hits: Callable[[Mapping[str, Any], Sequence[Unread], Sequence[str]], Hits],
        clock: Callable[[], float] = time.monotonic,
        cpu: Callable[[], float] = time.thread_time,
    ) -> None:
        self._to_hits, self._clock, self._cpu = to_hits, clock, cpu
        self._due = clock() + SHOWN_AFTER
        self._sheet: Any = None
        self._done = 0
        self._is_in_cell = bool(running_cell()[0]) and called_from_cell()
        self._order: list[str] = []

    def grow(self, results: Mapping[str, Any], unread: Sequence[Unread], files: Sequence[str]) -> None:
        """Show the results so far, if there are more and an update is due. Earlier ones keep their places."""
        done = len(results) + len(unread)
        if not self._is_in_cell or done == self._done or self._clock() < self._due:
            return
        is_first, began = self._sheet is None, self._cpu()
        self._show(results, unread, files, done)
        self._done = done
        self._due = self._clock() + (_LEAST if is_first else max(_LEAST, _SHARE * (self._cpu() - began)))

    def end(self, hits: Hits, results: Mapping[str, Any]) -> None:
        """Show all results, and let this table replace the table of the result below this cell."""
        if self._sheet is not None:
            self._show(results, hits.unread, hits.files, None if hits.is_complete else hits.until)
            hits.shown_in, hits.live = running_cell(), self._sheet

    def _show(
        self, results: Mapping[str, Any], unread: Sequence[Unread], files: Sequence[str], done: int | None
    ) -> None:
        known = {*self._order}
        self._order += [path for path in results if path not in known]
        hits = self._to_hits({path: results[path] for path in self._order if path in results}, unread, files)
        if self._sheet is None:
            # Imported lazily: a search in a terminal needs no widget.
            from IPython.display import display

            self._sheet = hits.show(rows=True, sort="file")
            self._sheet.set_hits(hits, files, unread, hits.problems, done)
            display(self._sheet)  # type: ignore[no-untyped-call]
        else:
            self._sheet.set_hits(hits, files, unread, hits.problems, done)
