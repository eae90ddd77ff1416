"""Watching folders for new recordings: each is indexed and searched once it is whole."""

from __future__ import annotations

import glob
import os
import re
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

from ..files import METADATA, NO_SUCH_PATH
from ..files.remote import is_url
from ..recordings.search.base import Condition, condition
from ..repair import RecordingError, find_files, is_finished
from ..runtime.clock import Clock, RealClock
from ..runtime.output_file import checked_output
from ..samples.checks import number
from ._engine import LONGEST
from ._kept import RecordingState, states_of
from .drives import LATER, Drives, index
from .hits import Hits
from .places import PathLike, named_places
from .search import hits_of, search

EVERY = 5.0
"""Seconds between two looks."""

PATIENCE = 60.0
"""Seconds after which a recording without an end is read as it is, if nothing writes to it any more."""


def follow(
    given: Condition | Callable[..., Any],
    *paths: PathLike,
    output: PathLike,
    topics: str | Iterable[str] = (),
    fields: str | Iterable[str] = (),
    every: float = EVERY,
    executor: Any = None,
    longest: float = LONGEST,
    clock: Clock | None = None,
) -> Iterator[Hits]:
    """Watch folders for new recordings, and yield the results of a condition in them, for ever.

    A recording is read once it is whole: its end is there, no program writes to it, and it stayed the same between two
    looks. If its recorder was killed, it is read as it is after a minute without a change. Recordings that the index
    has already are not searched again, so that a new start repeats nothing. Parts of a recording count as one if they
    lie in a folder with rosbag2 metadata. An interrupt (Ctrl-C) ends it, and the index keeps what was read.

    Args:
        given: as for `find`.
        *paths: as for `find`.
        output: the index, as for `index`; it is written again after each look that found a new recording.
        topics: as for `find`.
        fields: as for `index`.
        every: seconds between two looks.
        executor: as for `find`.
        longest: as for `find`.
        clock: the clock for the looks.

    Yields:
        The results in the recordings that are new since the last look, also if nothing was found in them.

    Raises:
        TypeError, ValueError: as `find` and `index`, or ``every`` is not above 0. ImportError, OSError: as `index`.

    Examples:
        >>> for hits in robowidgets.fleet.follow(near, "runs/", output="drives.parquet"):  # doctest: +SKIP
        ...     print(hits)
    """
    wanted = condition(given)
    if not 0 < number("every", every) < float("inf"):
        raise ValueError(f"every: expected seconds above 0, got {every!r}")
    if not paths:
        raise ValueError("expected files, folders or patterns of recordings, got none")
    for path in paths:
        if not isinstance(path, (str, os.PathLike)):
            raise TypeError(f"expected the path of a recording, a folder or a pattern, got {path!r}")
        text = os.fspath(path)
        if not is_url(text) and not glob.has_magic(text) and not Path(text).expanduser().exists():
            raise FileNotFoundError(f"{text}: {NO_SUCH_PATH}; make the folder before its recordings come")
    names = (topics,) if isinstance(topics, str) else tuple(topics)
    looks = _Looks(paths, _known(checked_output("follow", output, (".parquet",))), clock or RealClock())

    def write() -> Drives:
        return index(*looks.ready, output=output, topics=names, fields=fields, executor=executor, longest=longest)

    return _follow(wanted, looks, write, names, every, executor, longest)


def _follow(
    wanted: Condition,
    looks: _Looks,
    write: Callable[[], Drives],
    topics: tuple[str, ...],
    every: float,
    executor: Any,
    longest: float,
) -> Iterator[Hits]:
    reported: dict[str, set[tuple[str, int, int]]] = {}
    while True:
        fresh, to_search = looks.look()
        if fresh:
            hits, is_cut = None, False
            if to_search:
                found = search(wanted, to_search, topics, executor, longest, keep=True)
                hits, is_cut = hits_of(wanted, found), found.rows["until"] is not None
            # After the search: a recording in the index counts as searched at the next start.
            try:
                if not is_cut:
                    is_cut = any(one.problem == LATER for one in write().unread)
            except KeyboardInterrupt:
                is_cut = True
            if hits is not None:
                yield _new(hits, reported)
            if is_cut:
                raise KeyboardInterrupt
            looks.done()
        looks.clock.sleep(every)


def _new(hits: Hits, reported: dict[str, set[tuple[str, int, int]]]) -> Hits:
    """Return the results that no earlier look found, when a recording was shorter, and note them."""
    found = []
    for hit in hits:
        before = reported.setdefault(hit.file, set())
        key = hit.topic, hit.start_ns, hit.end_ns
        if key not in before:
            before.add(key)
            found.append(hit)
    return hits.only(found)


class _Looks:
    """The recordings in some places, and since when each of them is the same.

    Args:
        paths: the places.
        known: the states of recordings that were searched before.
        clock: the clock.
    """

    def __init__(self, paths: Iterable[PathLike], known: set[str | None], clock: Clock) -> None:
        self._paths, self._known, self.clock = tuple(os.fspath(path) for path in paths), known, clock
        self._seen: dict[str, tuple[RecordingState, float]] = {}
        self._taken: dict[str, RecordingState] = {}
        self.ready: list[str] = []
        """The recordings that are whole."""

    def look(self) -> tuple[list[str], list[str]]:
        """Return the recordings that have become ready since `done`, and the part of them that was never searched."""
        now = self.clock.now()
        named = (place for text in self._paths for place in named_places(text, _is_one))
        places = dict.fromkeys(place.path for place in named if not place.problem)
        states = states_of(places)
        self._seen = {path: self._seen.get(path, (state, now)) for path, state in states.items()}
        self.ready = []
        for place in places:
            path = str(place)
            before, since = self._seen[path]
            if before != states[path]:
                self._seen[path] = states[path], now
            elif self._taken.get(path) == before or (
                now > since and (_is_whole(place, before) or now - since >= PATIENCE)
            ):
                self.ready.append(path)
        fresh = [path for path in self.ready if self._taken.get(path) != states[path]]
        return fresh, [path for path in fresh if states[path].text not in self._known or states[path].text is None]

    def done(self) -> None:
        """Note that the ready recordings are in the index, and were searched."""
        self._taken = {path: self._seen[path][0] for path in self.ready}


def _is_whole(place: Path | str, state: RecordingState) -> bool:
    if isinstance(place, str):  # an object appears once it is whole
        return not state.problem
    if state.problem:
        return False
    try:
        files = find_files(place) if place.is_dir() else [place]
        return all(map(is_finished, files)) and (not place.is_dir() or (place / METADATA).exists())
    except OSError:  # it is gone meanwhile
        return False


def _is_one(folder: Path) -> bool:
    """Return True if a folder is one recording. No file is opened, as it may be under way."""
    files = find_files(folder)
    part = re.compile(rf"{re.escape(folder.name)}_\d+\.")
    # rosbag2 writes the metadata of a folder last.
    return bool(files) and ((folder / METADATA).exists() or all(part.match(file.name) for file in files))


def _known(path: Path) -> set[str | None]:
    """Return the states of the recordings in an existing index."""
    try:
        return {*Drives(path).states.values()} if path.exists() else set()
    except RecordingError:  # not an index, or of another version: it is written again
        return set()
