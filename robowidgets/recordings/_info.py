"""A recording as a table, in text and in HTML."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from .._core import text as _table
from .._core.text import many
from .times import as_date, has_date
from .topics import Topic

_HEADS = ("topic", "type", "messages", "Hz", "widget")
_RIGHT = (2, 3)
_SLOWEST = 0.1


def heading(path: str, topics: Sequence[Topic], duration: float, start_ns: int | None) -> str:
    """One line: which recording, how long, from when, how much is in it."""
    count = sum(topic.count for topic in topics)
    parts = [f"{duration:.1f} s", many(len(topics), "topic"), many(count, "message")]
    if start_ns is not None and has_date(start_ns):
        parts.insert(1, f"from {as_date(start_ns)}")
    return f"{path}: {', '.join(parts)}"


def as_text(head: str, topics: Sequence[Topic], problems: Iterable[str]) -> str:
    """The table in columns, for a terminal."""
    return _table.as_text(head, _HEADS, [_cells(topic) for topic in topics], _RIGHT, problems)


def as_html(head: str, topics: Sequence[Topic], problems: Iterable[str]) -> str:
    """The table in HTML. Every word of it comes from a file, so none of it may be markup."""
    return _table.as_html(head, _HEADS, [_cells(topic) for topic in topics], _RIGHT, problems)


def _cells(topic: Topic) -> tuple[str, ...]:
    shown = (
        f"{topic.widget} (commanded)" if topic.commanded else topic.widget or ("unreadable" if topic.problem else "")
    )
    rate = "" if topic.rate is None else f"{topic.rate:.1f}" if topic.rate >= _SLOWEST else f"<{_SLOWEST}"
    return topic.name, topic.type, f"{topic.count:,}", rate, shown
