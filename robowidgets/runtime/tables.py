"""A table under a heading, as text and as HTML."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from html import escape

_BLOCKS = " ▏▎▍▌▋▊▉█"
_BAR = 5
"""Characters of the longest bar."""


@dataclass(frozen=True)
class Table:
    """A table under a heading, with lines below it.

    Args:
        heading: the line above the table.
        heads: the names of the columns.
        rows: the cells of each row; without rows the heads are not shown either.
        right: the indices of the columns that are aligned to the right.
        notes: lines below the table.
        problems: lines below the notes, each with a sign that warns.
        bars: the lengths of the bars of each row, from 0 (no bar) to 1, by the index of the column.
    """

    heading: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    right: Collection[int] = ()
    notes: Sequence[str] = ()
    problems: Sequence[str] = ()
    bars: Mapping[int, Sequence[float]] = field(default_factory=dict)

    def to_text(self) -> str:
        """Return the table as text, for a terminal."""
        bars = [{i: _blocks(lengths[row]) for i, lengths in self.bars.items()} for row in range(len(self.rows))]
        with_bars = (
            [f"{cell} {bar[i]}" if i in bar else cell for i, cell in enumerate(row)]
            for row, bar in zip(self.rows, bars, strict=True)
        )
        heads = [f"{head}{' ' * (_BAR + 1)}" if i in self.bars else head for i, head in enumerate(self.heads)]
        rows = [heads, *with_bars] if self.rows else []
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = [
            "  ".join(
                cell.rjust(width) if i in self.right else cell.ljust(width)
                for i, (cell, width) in enumerate(zip(row, widths, strict=True))
            )
            for row in rows
        ]
        shown = (f"  {line.rstrip()}" for line in lines)
        return "\n".join((self.heading, *shown, *self.notes, *(f"! {line}" for line in self.problems)))

    def to_html(self) -> str:
        """Return the table as HTML. All texts are escaped: names of topics come from files and from the network."""
        body = "".join(f"<tr>{self._cells('td', row, number)}</tr>" for number, row in enumerate(self.rows))
        table = f"<table><thead><tr>{self._cells('th', self.heads)}</tr></thead><tbody>{body}</tbody></table>"
        lines = (*self.notes, *(f"⚠ {line}" for line in self.problems))
        below = "".join(f"<div>{escape(line)}</div>" for line in lines)
        return f"<div><div>{escape(self.heading)}</div>{table if self.rows else ''}{below}</div>"

    def _cells(self, tag: str, cells: Sequence[str], row: int | None = None) -> str:
        styles = [f"text-align:{'right' if i in self.right else 'left'}" for i in range(len(cells))]
        for i, lengths in self.bars.items():
            if row is not None and lengths[row]:
                styles[i] += f";{_BEHIND.format(100 * lengths[row])}"
        both = zip(styles, cells, strict=True)
        return "".join(f'<{tag} style="{style}">{escape(cell)}</{tag}>' for style, cell in both)


class HasTable(ABC):
    """An object that is shown as a table, in a terminal and in a notebook."""

    def __repr__(self) -> str:
        return self._table().to_text()

    def _repr_html_(self) -> str:
        return self._table().to_html()

    @abstractmethod
    def _table(self) -> Table:
        """Return the table."""


_BEHIND = "background:linear-gradient(to right,rgba(128,128,128,.3) {0:.0f}%,transparent {0:.0f}%)"
"""The bar behind a cell, for light pages and dark ones."""


def _blocks(length: float) -> str:
    """Return a bar of block characters."""
    eighths = round(length * _BAR * 8)
    whole, part = divmod(eighths, 8)
    return f"{_BLOCKS[8] * whole}{_BLOCKS[part]}"[:_BAR].ljust(_BAR)
