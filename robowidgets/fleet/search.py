"""The search through many recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from .._core.progress import without_bars
from ..recording import open as open_recording
from ..recordings.topics import UnknownTopicError
from ..search.base import Condition, condition
from ._engine import LONGEST
from ._fleet_table import Unread
from ._gather import FromAll, gather, identity_or_none, kept_of
from ._live import LiveTable
from ._topics import chosen_of, looked_at
from .hits import Hit, Hits
from .places import PathLike

_FORM = 5
"""Of the results that are kept: another number for another form."""


def find(
    given: Condition | Callable[..., Any],
    *paths: PathLike,
    topics: str | Iterable[str] = (),
    executor: Any = None,
    longest: float = LONGEST,
    keep: bool = True,
) -> Hits:
    """When something held in many recordings: one table, with a row for each span and for each file not read.

    It is `Recording.find` for each recording. Those that were searched for the same before are not read again, unless
    they changed. In a notebook, a table of what was found grows while it runs, in which a click opens the recording
    there. An interrupt (stop the cell, Ctrl-C) ends the search and keeps what was found; the same search
    goes on.

    Args:
        given: as `Recording.find`: one of `robowidgets.conditions`, several of them joined, or a function of a moment.
        *paths: recordings, folders with recordings at any depth, or patterns such as ``"runs/*.mcap"``. The parts of a
            rosbag2 folder are one recording.
        topics: names or patterns of topics, such as ``"/front*"``, that are meant where a recording has several of a
            kind. Where none of these fits, it is one that was measured rather than made of others (``/scan_merged``),
            then the one with most messages, then the one with the shortest name; `Hits.chosen` tells. A function may
            read the topics that no widget shows, such as ``"/imu"``, where they are named here.
        executor: what runs it: anything with ``submit``, or a client of Dask; None: a process for each core.
        longest: seconds that one recording may take. It is then named as one that was not read.
        keep: keep results in the folder that the environment variable ``ROBOWIDGETS_CACHE`` names, by default one of
            the user's for such files. The results of a function are never kept: what it reads may change.

    Raises:
        TypeError: no condition, no path, or ``executor`` has no ``submit``. ValueError: no path.

    Examples:
        >>> from robowidgets import conditions
        >>> robowidgets.find(conditions.nearest_below(0.3), "runs/", "more/*.mcap")  # doctest: +SKIP
    """
    wanted = condition(given)
    names = (topics,) if isinstance(topics, str) else tuple(topics)

    def so_far(results: Mapping[str, Any], unread: Sequence[Unread], files: Sequence[str]) -> Hits:
        read = {path: result for path, result in results.items() if "problem" not in result}
        return hits_of(wanted, FromAll(read, {"files": files, "unread": unread}))

    live = LiveTable(so_far)
    gathered = search(wanted, paths, names, executor, longest, keep, live.grow)
    hits = hits_of(wanted, gathered)
    live.end(hits, gathered.results)
    return hits


def search(
    wanted: Condition,
    paths: Iterable[PathLike],
    topics: tuple[str, ...],
    executor: Any,
    longest: float,
    keep: bool,
    grow: Callable[[Mapping[str, Any], Sequence[Unread], Sequence[str]], None] | None = None,
) -> FromAll:
    """What a search for a condition gives for each recording; `gather` takes ``grow``."""
    question = ("find", _FORM, wanted, topics)
    return gather(
        _Search(wanted, topics),
        paths,
        kept_of(question, keep),
        "Finding",
        executor=executor,
        longest=longest,
        is_ours=identity_or_none(question) is not None,
        found=lambda result: len(result.get("spans", ())),
        grow=grow,
    )


def hits_of(wanted: Condition, gathered: FromAll) -> Hits:
    """The table of what came of a search."""
    results = gathered.results
    return Hits(
        wanted,
        [Hit(path, result["topic"], *_span(span)) for path, result in results.items() for span in result["spans"]],
        chosen={path: result["chosen"] for path, result in results.items()},
        problems={path: result["problems"] for path, result in results.items()},
        **gathered.rows,
    )


def _span(span: list[Any]) -> list[Any]:
    """The fields of a span, of the plain data that it is sent and kept as."""
    return [tuple(value) if isinstance(value, list) else value for value in span]


class _Search:
    """The search in one recording.

    Args:
        wanted: the condition.
        topics: names and patterns of topics.
    """

    def __init__(self, wanted: Condition, topics: tuple[str, ...]) -> None:
        self._wanted, self._topics = wanted, topics

    def __call__(self, path: str) -> dict[str, Any]:
        """What was found in it, or why it has nothing to be searched, as plain data."""
        with open_recording(path) as recording, without_bars():
            try:
                chosen = chosen_of(recording, self._topics)
                recording.preferred = frozenset(chosen)
                spans = recording.find(self._wanted, looked_at(recording, self._topics) or None)
            except UnknownTopicError as error:
                return {"problem": str(error)}
            problems = recording.problems
        return {
            "spans": [list(span) for span in spans],
            "topic": ", ".join(spans.topics),
            "chosen": [name for name in chosen if name in spans.topics],
            "problems": list(problems),
        }
