"""What `Recording.find` gives: from when to when a condition held."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from html import escape
from typing import Any, NamedTuple, overload

from .columns._tables import library

_SHOWN = 20


class Span(NamedTuple):
    """A span: start, end and length in seconds, from the start of the recording; and by its clock.

    ``end`` is when the next sample said that it is over, when nothing more was known because the topic fell silent, or
    the end of the recording. It is ``start`` where one of several samples of a time held, and the last of them did not.
    ``silent`` names the topics with a gap in it, where a gap was looked for.
    """

    start: float
    end: float
    seconds: float
    start_ns: int
    end_ns: int
    silent: tuple[str, ...] = ()


class Spans(Sequence[Span]):
    """A table of spans; printed, it shows the first of them.

    Args:
        condition: what held, in words.
        spans: in the order of time.
        until: seconds up to which the recording was looked at, when that was cut short; None: all of it.
        problems: what was wrong with the recording, as `Recording.problems` tells it: something may be missed.
    """

    def __init__(
        self, condition: str, spans: Sequence[Span], until: float | None = None, problems: Sequence[str] = ()
    ) -> None:
        self.condition = condition
        self.until = until
        self.problems = tuple(problems)
        self._spans = tuple(spans)

    @property
    def is_complete(self) -> bool:
        """Whether all of the recording was looked at that can be read; `problems` says what cannot."""
        return self.until is None

    @property
    def seconds(self) -> float:
        """How long it held, taken together."""
        return sum(span.seconds for span in self)

    def to_pandas(self) -> Any:
        """A pandas DataFrame: a row for each span.

        Raises:
            ImportError: pandas is not installed.
        """
        return library("pandas", "to_pandas").DataFrame(list(self), columns=list(Span._fields))

    def __len__(self) -> int:
        return len(self._spans)

    @overload
    def __getitem__(self, which: int) -> Span: ...
    @overload
    def __getitem__(self, which: slice) -> Spans: ...
    def __getitem__(self, which: int | slice) -> Span | Spans:
        if isinstance(which, slice):
            return Spans(self.condition, self._spans[which], self.until, self.problems)
        return self._spans[which]

    def __iter__(self) -> Iterator[Span]:
        return iter(self._spans)

    def __repr__(self) -> str:
        head, rows = self._table()
        table = ["  " + "  ".join(cell.rjust(10) for cell in row) for row in (head, *rows)] if rows else []
        return "\n".join((self._heading(), *table, *self._notes()))

    def _repr_html_(self) -> str:
        head, rows = self._table()
        body = "".join(_row("td", row) for row in rows)
        table = f"<table><thead>{_row('th', head)}</thead><tbody>{body}</tbody></table>" if rows else ""
        notes = "".join(f"<div>{escape(line.strip())}</div>" for line in self._notes())
        return f"<div><div>{escape(self._heading())}</div>{table}{notes}</div>"

    def _table(self) -> tuple[tuple[str, ...], list[tuple[str, ...]]]:
        """Head and rows; what was silent only where something was."""
        width = 4 if any(span.silent for span in self) else 3
        return ("start", "end", "seconds", "silent")[:width], [_cells(span)[:width] for span in self._spans[:_SHOWN]]

    def _heading(self) -> str:
        if not self._spans:
            return f"{self.condition}: never"
        times = "once" if len(self) == 1 else f"{len(self):,} times"
        return f"{self.condition}: {times}, {self.seconds:.2f} s together"

    def _notes(self) -> list[str]:
        more = [f"  ... and {len(self) - _SHOWN:,} more"] if len(self) > _SHOWN else []
        stopped = [] if self.is_complete else [f"! stopped at {self.until:.2f} s: nothing after that was looked at"]
        return [*more, *stopped, *(f"! {line}" for line in self.problems)]


def _cells(span: Span) -> tuple[str, ...]:
    return f"{span.start:.2f}", f"{span.end:.2f}", f"{span.seconds:.2f}", ", ".join(span.silent)


def _row(tag: str, cells: Sequence[str]) -> str:
    return "<tr>" + "".join(f'<{tag} style="text-align:right">{escape(cell)}</{tag}>' for cell in cells) + "</tr>"
