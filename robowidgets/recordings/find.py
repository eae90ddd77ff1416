"""The search for the moments at which a condition holds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from .conditions import condition
from .progress import Progress, one_bar
from .spans import Span, Spans
from .steps import Steps, spans, steps

if TYPE_CHECKING:
    from .recording import Recording
    from .scan_series import Scans
    from .speed_series import Speeds


class Search:
    """One search through a recording.

    It may be interrupted: then conditions are known up to ``end_ns``, and the search goes no further than that.

    Args:
        recording: where to look.
        topics: see `Recording.find`.
        bar: is told how many samples were looked at.
    """

    def __init__(self, recording: Recording, topics: str | Iterable[str] | None, bar: Any) -> None:
        self.recording = recording
        self.topics = topics
        self.end_ns = recording.end_ns or 0
        self.is_cut = False
        self._bar = bar

    def over(self, series: Scans | Speeds, test: Callable[[Any], NDArray[np.int8]]) -> Steps:
        """Whether something holds from each sample of a series on, found for whole chunks at a time."""
        times: list[NDArray[np.int64]] = [np.empty(0, np.int64)]
        values: list[NDArray[np.int8]] = [np.empty(0, np.int8)]
        try:
            for chunk in series.chunks():
                if self.is_cut and chunk.times_ns[0] > self.end_ns:
                    break
                values.append(test(chunk))
                times.append(chunk.times_ns)
                self.looked_at(len(chunk))
        except KeyboardInterrupt:
            # What was tested last may not have been taken in.
            del values[len(times) :]
            self.cut(int(times[-1][-1]) if len(times) > 1 else self.recording.start_ns or 0)
        return steps(np.concatenate(times), np.concatenate(values))

    def looked_at(self, count: int) -> None:
        """Tell of progress."""
        self._bar.update(count)

    def cut(self, time_ns: int) -> None:
        """Go no further than a time."""
        self.end_ns = min(self.end_ns, time_ns)
        self.is_cut = True


def find(recording: Recording, given: Any, topics: str | Iterable[str] | None) -> Spans:
    """See `Recording.find`."""
    wanted = condition(given)
    total = sum(topic.count for topic in recording.topics if topic.widget)
    start_ns = recording.start_ns or 0
    with Progress(total, "Finding", " samples") as bar, one_bar():
        search = Search(recording, topics, bar)
        try:
            held = wanted.steps(search)
        except KeyboardInterrupt:
            # Where a condition does not look from sample to sample, nothing is known of any time.
            search.cut(start_ns)
            held = steps([], [])
    inside = held.times <= search.end_ns
    found = spans(Steps(held.times[inside], held.values[inside]), search.end_ns)
    return Spans(
        str(wanted),
        [Span((a - start_ns) / 1e9, (b - start_ns) / 1e9, (b - a) / 1e9, a, b) for a, b in found],
        (search.end_ns - start_ns) / 1e9 if search.is_cut else None,
        recording.problems,
    )
