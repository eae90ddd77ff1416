"""One function of each of some recordings, with what was kept of it, behind one bar."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable
from typing import Any, NamedTuple

from .._core.progress import Progress, without_bars
from ..kinds import KINDS
from ..recordings.remote import is_url, without_secrets
from ..repair import RecordingError
from ._engine import LONGEST, each
from ._fleet_table import Unread
from ._identity import NotIdentifiedError, identity_of
from ._kept import Kept, state_of
from .places import PathLike, places_of


class FromAll(NamedTuple):
    """What came of many recordings: the results by path, and what `FleetTable` takes."""

    results: dict[str, Any]
    rows: dict[str, Any]


def gather(
    job: Callable[[str], dict[str, Any]],
    paths: Iterable[PathLike],
    question: Any,
    what: str,
    *,
    executor: Any = None,
    longest: float = LONGEST,
    keep: bool = True,
    found: Callable[[Any], int] = lambda result: 0,  # noqa: ARG005
) -> FromAll:
    """What a job returns for each recording that some paths name.

    Args:
        job: takes a path, and returns plain data: a mapping. One with ``problem`` says why there is nothing to tell.
        paths: as for `places_of`.
        question: what the job asks: equal for what is computed equally. What `identity_of` cannot tell is not kept.
        what: for the bar: "Finding".
        executor: as for `each`.
        longest: as for `each`.
        keep: whether results are kept for the next time, and those that were are taken.
        found: how much a result is, for the bar.

    Raises:
        TypeError, ValueError: as `places_of` and `each`.
    """
    places = places_of(paths)
    kept = _kept(question) if keep else None
    unread = [Unread(str(place.path), place.problem) for place in places if place.problem]
    states: dict[str, str | None] = {}
    for place in places:
        if not place.problem:
            try:
                states[str(place.path)] = state_of(place.path)
            except OSError as error:
                unread.append(Unread(str(place.path), f"cannot be read: {error.strerror or error}"))
            except RecordingError as error:
                unread.append(Unread(str(place.path), str(error)))
    before = {path: kept.get(state) for path, state in states.items() if state} if kept else {}
    results = {path: result for path, result in before.items() if result is not None}
    missing = [path for path in states if path not in results]
    count = sum(map(found, results.values()))
    is_cut = False
    with Progress(len(missing), what, " files") as bar, without_bars():
        work = each(job, missing, executor, longest)
        try:
            for path, result, problem in work:
                if problem:
                    unread.append(Unread(path, problem))
                else:
                    results[path] = result
                    count += found(result)
                    if kept and (state := states[path]):
                        kept.add(state, result)
                bar.update(1, f"{count:,} found" if count else "")
        except KeyboardInterrupt:
            is_cut = True
        finally:
            work.close()
    order = {str(place.path): i for i, place in enumerate(places)}
    for i, (path, problem) in enumerate(unread):
        name = without_secrets(path) if is_url(path) else os.path.basename(path)
        unread[i] = Unread(path, problem.removeprefix(f"{name}: "))
    unread += [Unread(path, result["problem"]) for path, result in results.items() if "problem" in result]
    read = {path: results[path] for path in states if path in results and "problem" not in results[path]}
    rows = {
        "files": list(order),
        "unread": sorted(unread, key=lambda one: order[one.file]),
        "until": len(read) + len(unread) if is_cut else None,
        "note": kept.problem if kept else "",
    }
    return FromAll(read, rows)


def _kept(question: Any) -> Kept | None:
    """Where the results are kept; None where nothing tells whether the question is the same next time."""
    try:
        # What is read of a topic is part of it: somebody may have added a kind.
        return Kept(identity_of((question, {kind.name: kind.read for kind in KINDS.values()})))
    except NotIdentifiedError:
        return None
