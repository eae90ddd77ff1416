"""A table under a heading, as text and as HTML; numbers, sizes, dates and angles as a person reads them."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Sequence
from datetime import datetime, timedelta, timezone
from html import escape
from math import degrees

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


def as_text(
    head: str, heads: Sequence[str], rows: Sequence[Sequence[str]], right: Collection[int], problems: Iterable[str]
) -> str:
    """The table as text, for a terminal; the columns with an index in ``right`` are aligned to the right."""
    all_rows = [heads, *rows]
    widths = [max(len(row[i]) for row in all_rows) for i in range(len(heads))]
    lines = [
        "  ".join(
            cell.rjust(width) if i in right else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in all_rows
    ]
    return "\n".join((head, *(f"  {line.rstrip()}" for line in lines if rows), *(f"! {line}" for line in problems)))


def as_html(
    head: str, heads: Sequence[str], rows: Sequence[Sequence[str]], right: Collection[int], problems: Iterable[str]
) -> str:
    """The table as HTML. All texts are escaped: names of topics come from files and from the network."""
    body = "".join(f"<tr>{_cells('td', row, right)}</tr>" for row in rows)
    table = f"<table><thead><tr>{_cells('th', heads, right)}</tr></thead><tbody>{body}</tbody></table>" if rows else ""
    notes = "".join(f"<div>⚠ {escape(line)}</div>" for line in problems)
    return f"<div><div>{escape(head)}</div>{table}{notes}</div>"


def many(count: int, word: str) -> str:
    """A number of things: ``1 topic``, ``1,200 messages``."""
    return f"{count:,} {word}{'' if count == 1 else 's'}"


def megabytes(size: int) -> str:
    """A number of bytes: ``12.3 MB``, ``1.5 GB``."""
    return f"{size / 1e6:,.1f} MB" if size < 1e9 else f"{size / 1e9:,.1f} GB"


def listed(names: Sequence[str], most: int = 3) -> str:
    """The first names, and the number of the others."""
    return ", ".join(names[:most]) + (f" and {len(names) - most:,} more" if len(names) > most else "")


def _cells(tag: str, cells: Sequence[str], right: Collection[int]) -> str:
    return "".join(
        f'<{tag} style="text-align:{"right" if i in right else "left"}">{escape(cell)}</{tag}>'
        for i, cell in enumerate(cells)
    )


def as_date(time_ns: int) -> str:
    """Nanoseconds since the epoch as date and time of day: ``2024-05-03 14:32:05 UTC``."""
    return f"{_EPOCH + timedelta(seconds=time_ns // 10**9):%Y-%m-%d %H:%M:%S} UTC"


def degrees_of(angle: float) -> str:
    """An angle in radians as degrees: ``−31.2°``."""
    return f"{degrees(angle):.1f}°".replace("-", "\N{MINUS SIGN}")


def often(count: int) -> str:
    """A number of times: ``once``, ``12 times``."""
    return "once" if count == 1 else f"{count:,} times"
