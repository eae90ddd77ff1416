"""The search through many recordings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from ..notebook.progress import without_bars
from ..recording import open as open_recording
from ..recordings.search.base import Condition, condition
from ..recordings.topics import UnknownTopicError
from ._engine import LONGEST
from ._fleet_table import Unread
from ._gather import FromAll, gather, identity_or_none, kept_of
from ._live import LiveTable
from ._topics import chosen_of, looked_at
from .hits import Hit, Hits
from .places import NamedPath, PathLike

_FORM = 7
"""The version of the form of the stored results."""


def find(
    given: Condition | Callable[..., Any],
    *paths: PathLike,
    topics: str | Iterable[str] = (),
    executor: Any = None,
    longest: float = LONGEST,
    keep: bool = True,
) -> Hits:
    """Find the spans of a condition in many recordings: a table with a row for each span and each file not read.

    It calls `Recording.find` for each recording. Recordings that were searched for the same condition before are not
    read again, unless they changed. In a notebook, a table of the results grows while the search runs; a click in it
    opens the recording at that time. An interrupt (stop the cell, Ctrl-C) ends the search and keeps the results; the
    same search continues.

    Args:
        given: as for `Recording.find`: one of `robowidgets.conditions`, several of them joined, or a function of a
            moment.
        *paths: recordings, folders with recordings at any depth, or patterns such as ``"runs/*.mcap"``. A rosbag2
            folder is one recording.
        topics: names or patterns of topics, such as ``"/front*"``, that are preferred in recordings with several topics
            of a kind. If no preferred topic fits, measured topics precede derived ones (``/scan_merged``), then the one
            with most messages is chosen, then the one with the shortest name; see `Hits.chosen`. Topics without a
            widget, such as ``"/imu"``, must be named here if a function reads them.
        executor: an object with ``submit``, or a Dask client, or None for a process on each core.
        longest: the maximum number of seconds for one recording. After that, it counts as not read.
        keep: True to store results in the folder that the environment variable ``ROBOWIDGETS_CACHE`` names, by default
            the user's cache folder. Results of a function are never stored, because they may change.

    Raises:
        TypeError: ``given`` is not a condition, a path is not a path, or ``executor`` has no ``submit``. ValueError: no
            path is given.

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
    paths: Iterable[PathLike | NamedPath],
    topics: tuple[str, ...],
    executor: Any,
    longest: float,
    keep: bool,
    grow: Callable[[Mapping[str, Any], Sequence[Unread], Sequence[str]], None] | None = None,
) -> FromAll:
    """Return the results of a search for each recording; `gather` takes ``grow``."""
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
    """Return the table of the results of a search."""
    results = gathered.results
    return Hits(
        wanted,
        [Hit(path, result["topic"], *_span(span)) for path, result in results.items() for span in result["spans"]],
        chosen={path: result["chosen"] for path, result in results.items()},
        problems={path: result["problems"] for path, result in results.items()},
        **gathered.rows,
    )


def _span(span: list[Any]) -> list[Any]:
    """Return the fields of a span from the plain data in which it is sent and stored."""
    return [tuple(value) if isinstance(value, list) else value for value in span]


class _Search:
    """A function that searches one recording.

    Args:
        wanted: the condition.
        topics: names and patterns of topics.
    """

    def __init__(self, wanted: Condition, topics: tuple[str, ...]) -> None:
        self._wanted, self._topics = wanted, topics

    def __call__(self, path: str) -> dict[str, Any]:
        """Return the results, or the reason why it cannot be searched, as plain data."""
        with open_recording(path) as recording, without_bars():
            try:
                chosen = chosen_of(recording, self._topics)
                recording.preferred = frozenset(chosen)
                spans = recording.find(self._wanted, looked_at(recording, self._topics) or None)
            except UnknownTopicError as error:
                return {"problem": str(error)}
            problems = recording.losses
        return {
            "spans": [list(span) for span in spans],
            "topic": ", ".join(spans.topics),
            "chosen": [name for name in chosen if name in spans.topics],
            "problems": list(problems),
            "known": spans.known,
        }
