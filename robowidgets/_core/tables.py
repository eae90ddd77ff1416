"""A table under a heading, as text and as HTML."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from html import escape


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
    """

    heading: str
    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    right: Collection[int] = ()
    notes: Sequence[str] = ()
    problems: Sequence[str] = ()

    def to_text(self) -> str:
        """The table as text, for a terminal."""
        rows = [self.heads, *self.rows] if self.rows else []
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
        """The table as HTML. All texts are escaped: names of topics come from files and from the network."""
        body = "".join(f"<tr>{self._cells('td', row)}</tr>" for row in self.rows)
        table = f"<table><thead><tr>{self._cells('th', self.heads)}</tr></thead><tbody>{body}</tbody></table>"
        lines = (*self.notes, *(f"⚠ {line}" for line in self.problems))
        below = "".join(f"<div>{escape(line)}</div>" for line in lines)
        return f"<div><div>{escape(self.heading)}</div>{table if self.rows else ''}{below}</div>"

    def _cells(self, tag: str, cells: Sequence[str]) -> str:
        return "".join(
            f'<{tag} style="text-align:{"right" if i in self.right else "left"}">{escape(cell)}</{tag}>'
            for i, cell in enumerate(cells)
        )
