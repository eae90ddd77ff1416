"""The result of `Recording.find`: the spans in which a condition is true."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import Any, overload

from ...runtime.tables import HasTable, Table
from ...runtime.text import degrees_of, often
from ..columns.tables import frame_of, number, texts, whole
from ..span import Span

_SHOWN = 20
_TYPES = {
    **dict.fromkeys(("start", "end", "seconds", "nearest", "angle", "value"), number),
    **dict.fromkeys(("start_ns", "end_ns", "index", "nearest_ns", "value_ns"), whole),
    "silent": texts,
}
"""The columns of a DataFrame with their types."""


class Spans(HasTable, Sequence[Span]):
    """A table of spans. Printed, it shows the first ones.

    Args:
        condition: the text of the condition.
        spans: the spans in the order of time.
        until: seconds up to which the recording was searched, if the search was interrupted, or None for all of it.
        problems: the problems of the recording, as in `Recording.losses`: spans may be missing.
        topics: the topics that were read.

    Attributes:
        function: the function that was searched with, or None.
        known: the seconds in which the condition was true or false; in the others, it was unknown.
        shown_by: shows the recording of the spans; None if it is not known.
    """

    function: Any = None
    known: float = 0.0
    shown_by: Callable[..., Any] | None = None

    def __init__(
        self,
        condition: str,
        spans: Sequence[Span],
        until: float | None = None,
        problems: Sequence[str] = (),
        topics: Iterable[str] = (),
    ) -> None:
        self.condition = condition
        self.until = until
        self.problems = tuple(problems)
        self.topics = tuple(topics)
        self._spans = tuple(spans)

    @property
    def is_complete(self) -> bool:
        """True if all readable parts of the recording were searched; `problems` names the other parts."""
        return self.until is None

    @property
    def heads(self) -> tuple[str, ...]:
        """The columns with content: start, end and seconds, the nearest reading, a number, and silent topics."""
        met = any(span.nearest is not None for span in self)
        return ("start", "end", "seconds", *("nearest", "index", "angle") * met, *more_heads(self))

    @property
    def seconds(self) -> float:
        """The sum of the lengths of all spans, in seconds."""
        return sum(span.seconds for span in self)

    def show(self, *topics: str, **options: Any) -> Any:
        """Show the recording at the first span, with the spans as marks, and the lines of the function if it has one.

        Args:
            *topics: as for `Recording.show`.
            **options: keywords of `Recording.show`.

        Raises:
            RuntimeError: `Recording.find` did not return these spans.
        """
        if self.shown_by is None:
            raise RuntimeError(f"{self.condition}: only what Recording.find has returned can be shown")
        return self.shown_by(*topics, **{"lines": self, **options})

    def to_pandas(self) -> Any:
        """Return a pandas DataFrame: a row for each span.

        Raises:
            ImportError: pandas is not installed.
        """
        return frame_of({name: [getattr(span, name) for span in self] for name in Span._fields}, _TYPES)

    def __len__(self) -> int:
        return len(self._spans)

    @overload
    def __getitem__(self, which: int) -> Span: ...
    @overload
    def __getitem__(self, which: slice) -> Spans: ...
    def __getitem__(self, which: int | slice) -> Span | Spans:
        if isinstance(which, slice):
            return Spans(self.condition, self._spans[which], self.until, self.problems, self.topics)
        return self._spans[which]

    def __iter__(self) -> Iterator[Span]:
        return iter(self._spans)

    def _table(self) -> Table:
        """Return the table of the first spans, a row for each."""
        heads = self.heads
        rows = [tuple(cell(getattr(span, head), head) for head in heads) for span in self._spans[:_SHOWN]]
        more = [f"  ... and {len(self) - _SHOWN:,} more"] if len(self) > _SHOWN else []
        stopped = [] if self.is_complete else [f"stopped at {self.until:.2f} s: the rest was not searched"]
        problems = [*stopped, *self.problems]
        return Table(self._heading(), heads, rows, right=range(len(heads)), notes=more, problems=problems)

    def _heading(self) -> str:
        if not self._spans:
            return f"{self.condition}: never"
        return f"{self.condition}: {often(len(self))}, {self.seconds:.2f} s together"


def more_heads(spans: Collection[Any]) -> list[str]:
    """Return the further columns with content: a number that was compared, and silent topics."""
    heads = {"value": any(span.value is not None for span in spans), "silent": any(span.silent for span in spans)}
    return [head for head, is_there in heads.items() if is_there]


def cell(value: Any, head: str) -> str:
    """Return a value of a span as text: seconds, metres, an index, degrees, or names of topics."""
    if head == "silent":
        return ", ".join(value)
    if value is None:
        return ""
    if head == "angle":
        return degrees_of(value)
    if head == "value":
        return rounded_text(value, 7)
    return f"[{value}]" if head == "index" else f"{value:.2f}" + " m" * (head == "nearest")


def rounded_text(value: float, digits: int) -> str:
    """Return a number as text: a whole number with all its digits, another one rounded to so many."""
    is_whole = value.is_integer() and abs(value) <= 2**53
    return f"{value:.0f}" if is_whole else f"{value:.{digits}g}"
