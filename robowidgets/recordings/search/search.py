"""The search for the spans in which a condition is true."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ...notebook.progress import Progress, without_bars
from ._search import Search
from ._steps import known_ns, steps
from .base import FunctionCondition, condition
from .spans import Spans

if TYPE_CHECKING:
    from .. import RecordingData


def find(recording: RecordingData, given: Any, topics: str | Iterable[str] | None) -> Spans:
    """See `Recording.find`."""
    wanted = condition(given)
    start_ns = recording.start_ns or 0
    count_of = {topic.name: topic.count for topic in recording.topics}
    total = sum(count_of.get(topic, 0) for topic in wanted.topics(recording, topics))
    with Progress(total, "Finding", " samples") as bar, without_bars():
        search = Search(recording, topics, bar)
        try:
            result = search.steps_of(wanted)
        except KeyboardInterrupt:
            # An interrupt within a condition on whole columns: it is unknown at all times.
            search.cut(start_ns)
            result = steps([], [])
    found = Spans(
        str(wanted),
        search.found(result),
        (search.end_ns - start_ns) / 1e9 if search.is_cut else None,
        recording.losses,
        dict.fromkeys(wanted.looked_at(search)),
    )
    found.known = known_ns(result, search.end_ns) / 1e9
    found.function = wanted.function if isinstance(wanted, FunctionCondition) else None
    return found
