"""A recording as a table of its topics."""

from __future__ import annotations

from collections.abc import Sequence

from ..kinds import widgets_of
from ..runtime.tables import Table
from ..runtime.text import as_date, many
from .program_log import PROGRAM
from .times import has_date
from .topics import Topic

_HEADS = ("topic", "type", "messages", "Hz", "widget")
_RIGHT = (2, 3)
_SLOWEST = 0.1


def heading(path: str, topics: Sequence[Topic], duration: float, start_ns: int | None) -> str:
    """Return one line: the path of the recording, its length, its start and its contents."""
    count = sum(topic.count for topic in topics)
    parts = [f"{duration:.1f} s", many(len(topics), "topic"), many(count, "message")]
    versions = sum(topic.count for topic in topics if topic.name == PROGRAM)
    if versions:
        parts.append(many(versions, "program version"))
    if start_ns is not None and has_date(start_ns):
        parts.insert(1, f"from {as_date(start_ns)}")
    return f"{path}: {', '.join(parts)}"


def table_of(head: str, topics: Sequence[Topic], problems: Sequence[str]) -> Table:
    """Return a table with a row for each topic, and the problems of the recording."""
    return Table(head, _HEADS, [_cells(topic) for topic in topics], right=_RIGHT, problems=problems)


def _cells(topic: Topic) -> tuple[str, ...]:
    shown = widgets_of(topic.widget, topic.type, topic.commanded) or ("unreadable" if topic.problem else "")
    rate = "" if topic.rate is None else f"{topic.rate:.1f}" if topic.rate >= _SLOWEST else f"<{_SLOWEST}"
    return topic.name, topic.type, f"{topic.count:,}", rate, shown
