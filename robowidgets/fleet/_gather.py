"""Running one function on some recordings, with stored results and one progress bar."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from ..files.remote import is_url, with_secrets
from ..kinds import KINDS
from ..messages.definitions import all_added, installed
from ..notebook.progress import Progress, without_bars
from ..repair import find_files
from ._engine import LONGEST, each
from ._fleet_table import Unread
from ._identity import NotIdentifiedError, identity_of
from ._kept import Kept, states_of
from .places import NamedPath, PathLike, places_of

_HERE_BYTES = 100 << 20
"""Recordings with less data in total are read faster than processes start, if no code of the user can hang."""

_ALIKE = 10
"""If a job failed for so many recordings in the same way, and succeeded for none, the job itself is wrong."""


class FromAll(NamedTuple):
    """The results of many recordings by path, and the arguments of `FleetTable`."""

    results: dict[str, Any]
    rows: dict[str, Any]


class ResultStore(Protocol):
    """A store of results for the next run."""

    @property
    def problem(self) -> str:
        """The reason why results cannot be stored, or empty while they can."""

    def get(self, state: str) -> Any:
        """Return the result for a recording in this state, or None without one."""

    def add(self, path: str, state: str | None, result: Any) -> Any:
        """Store the result for a recording, whose state may be unknown. Return the part that stays in memory."""


def gather(
    job: Callable[[str], dict[str, Any]],
    paths: Iterable[PathLike | NamedPath],
    kept: ResultStore | None,
    what: str,
    *,
    executor: Any = None,
    longest: float = LONGEST,
    is_ours: bool = True,
    found: Callable[[Any], int] = lambda result: 0,  # noqa: ARG005
    grow: Callable[[Mapping[str, Any], Sequence[Unread], Sequence[str]], None] | None = None,
) -> FromAll:
    """Return the result of a job for each recording that some paths name.

    Args:
        job: takes a path, and returns plain data: a mapping. A mapping with ``problem`` contains the reason for the
            missing result.
        paths: as for `places_of`.
        kept: the store of results of earlier runs, or None for no store. See `kept_of`. A result with ``problem`` is
            not stored: the reason may lie outside of the recording.
        what: the text of the bar, such as "Finding".
        executor: as for `each`.
        longest: as for `each`.
        is_ours: True if the job runs no code of the user, so that it needs no process that can be killed.
        found: returns the count of a result, for the bar.
        grow: called now and then with the results so far, the recordings that were not read, and all recordings.

    Raises:
        TypeError, ValueError: as for `places_of` and `each`.
    """
    places = places_of(paths)
    unread = [Unread(str(place.path), place.problem) for place in places if place.problem]
    looked_at = states_of(place.path for place in places if not place.problem)
    unread += [Unread(path, state.problem) for path, state in looked_at.items() if state.problem]
    states = {path: state.text for path, state in looked_at.items() if not state.problem}
    before = {path: kept.get(state) for path, state in states.items() if state} if kept else {}
    results = {path: result for path, result in before.items() if result is not None}
    missing = [path for path in states if path not in results]
    count = sum(map(found, results.values()))
    is_cut = False
    failures: list[str] = []
    note = ""

    def tell(done: int) -> None:
        bar.update(done, f"{count:,} found" if count else "")
        if grow:
            grow(results, unread, [str(place.path) for place in places])

    # Other processes know only the secrets in the URLs that they get.
    name_of = {with_secrets(path) if is_url(path) else path: path for path in missing}
    with Progress(len(missing), what, " files") as bar, without_bars():
        work = each(job, list(name_of), executor, longest, lambda: tell(0), here=is_ours and _are_few(missing))
        try:
            for given, result, problem, failure in work:
                path = name_of[given]
                failures.append(failure)
                if problem:
                    unread.append(Unread(path, problem))
                else:
                    count += found(result)
                    results[path] = result
                    if kept and "problem" not in result:
                        results[path] = kept.add(path, states[path], result)
                tell(1)
                if failure and len(failures) == _ALIKE < len(missing) and len({*failures}) == 1:
                    note = f"stopped because it failed in the same way for the first {_ALIKE} recordings: {failure}"
                    is_cut = True
                    break
        except KeyboardInterrupt:
            is_cut = True
        finally:
            work.close()
    order = {str(place.path): i for i, place in enumerate(places)}
    for i, (path, problem) in enumerate(unread):
        name = path if is_url(path) else os.path.basename(path)
        unread[i] = Unread(path, problem.removeprefix(f"{name}: "))
    unread += [Unread(path, result["problem"]) for path, result in results.items() if "problem" in result]
    read = {path: results[path] for path in states if path in results and "problem" not in results[path]}
    rows = {
        "files": list(order),
        "unread": sorted(unread, key=lambda one: order[one.file]),
        "until": len(read) + len(unread) if is_cut else None,
        "note": note or (kept.problem if kept else ""),
    }
    return FromAll(read, rows)


def _are_few(paths: Sequence[str]) -> bool:
    """Return True if the recordings are read faster than processes start: one, or some small local ones."""
    if len(paths) <= 1:
        return True
    size = 0
    for path in paths:
        if is_url(path) or size > _HERE_BYTES:
            return False
        files = find_files(Path(path)) if os.path.isdir(path) else [path]
        size += sum(os.path.getsize(file) for file in files if os.path.exists(file))
    return size <= _HERE_BYTES


def kept_of(question: Any, keep: bool) -> Kept | None:
    """Return the store of the results for a question, or None if it contains code of the user.

    Args:
        question: plain values and conditions.
        keep: False to store nothing.
    """
    identity = identity_or_none(question) if keep else None
    return None if identity is None else Kept(identity)


def identity_or_none(question: Any) -> str | None:
    """Return the text of a question, from `identity_of`, or None if it contains code of the user."""
    try:
        # A kind of sensor, or message definitions, may have been added: then other samples are read.
        readers = {kind.name: kind.read for kind in KINDS.values()}
        return identity_of((version("robowidgets"), question, readers, all_added(), installed()))
    except NotIdentifiedError:
        return None
