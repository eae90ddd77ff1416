"""A recording as a table, in text and in HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime, timezone
from html import escape

from .timeline import Topic

_HEADS = ("topic", "type", "messages", "Hz", "widget")
_RIGHT = (2, 3)
_MADE_UP_BEFORE = 86_400 * 365
_SLOWEST = 0.1


def heading(path: str, topics: Sequence[Topic], duration: float, start_ns: int | None) -> str:
    """One line: which recording, how long, from when, how much is in it."""
    count = sum(topic.count for topic in topics)
    parts = [f"{duration:.1f} s", _many(len(topics), "topic"), _many(count, "message")]
    if start_ns is not None and start_ns // 10**9 > _MADE_UP_BEFORE:
        started = datetime.fromtimestamp(start_ns // 10**9, timezone.utc)
        parts.insert(1, f"from {started:%Y-%m-%d %H:%M:%S} UTC")
    return f"{path}: {', '.join(parts)}"


def as_text(head: str, topics: Sequence[Topic], problems: Iterable[str]) -> str:
    """The table in columns, for a terminal."""
    rows = [_HEADS, *(_cells(topic) for topic in topics)]
    widths = [max(len(row[i]) for row in rows) for i in range(len(_HEADS))]
    lines = [
        "  ".join(
            cell.rjust(width) if i in _RIGHT else cell.ljust(width)
            for i, (cell, width) in enumerate(zip(row, widths, strict=True))
        )
        for row in rows
    ]
    return "\n".join((head, *(f"  {line.rstrip()}" for line in lines if topics), *(f"! {line}" for line in problems)))


def as_html(head: str, topics: Sequence[Topic], problems: Iterable[str]) -> str:
    """The table in HTML. Every word of it comes from a file, so none of it may be markup."""
    rows = "".join(f"<tr>{_html_cells('td', _cells(topic))}</tr>" for topic in topics)
    table = f"<table><thead><tr>{_html_cells('th', _HEADS)}</tr></thead><tbody>{rows}</tbody></table>" if topics else ""
    notes = "".join(f"<div>⚠ {escape(line)}</div>" for line in problems)
    return f"<div><div>{escape(head)}</div>{table}{notes}</div>"


def _cells(topic: Topic) -> tuple[str, ...]:
    shown = (
        f"{topic.widget} (commanded)" if topic.commanded else topic.widget or ("unreadable" if topic.problem else "")
    )
    rate = "" if topic.rate is None else f"{topic.rate:.1f}" if topic.rate >= _SLOWEST else f"<{_SLOWEST}"
    return topic.name, topic.type, f"{topic.count:,}", rate, shown


def _html_cells(tag: str, cells: Sequence[str]) -> str:
    return "".join(
        f'<{tag} style="text-align:{"right" if i in _RIGHT else "left"}">{escape(cell)}</{tag}>'
        for i, cell in enumerate(cells)
    )


def _many(count: int, word: str) -> str:
    return f"{count:,} {word}{'' if count == 1 else 's'}"
