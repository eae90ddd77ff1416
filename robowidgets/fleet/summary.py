"""A summary of many recordings: a row for each."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..laser.row import LASER
from ..notebook.progress import without_bars
from ..poses.path import is_jump
from ..recording import Recording
from ..recording import open as open_recording
from ..recordings.columns.tables import date, number, text, whole
from ..recordings.search import conditions
from ..recordings.times import has_date
from ..runtime.tables import Table
from ..runtime.text import as_date, many
from ..samples.checks import shortest
from ..samples.distances import ray_distances
from ..samples.staleness import RECORDED
from ..speed.row import SPEED
from ..touch.row import TOUCH
from ._engine import LONGEST
from ._fleet_table import SHOWN, FleetTable, date_of, short
from ._gather import gather, kept_of
from ._topics import chosen_of
from .places import PathLike

_FORM = 3
_STANDING = 0.01
"""The speed in m/s below which a robot stands still."""


class Summary(FleetTable):
    """A row for each recording. Printed, it shows the first ones.

    The columns: ``seconds``, ``date`` of its start, ``driven`` in metres by odometry or else by speeds, ``stops``, the
    number of ``touches``, the ``nearest`` distance of the scanner in metres, and its time ``nearest_at`` in seconds.
    Missing values: None.

    Args:
        found: the values of each row, by column.
        **rows: as for `FleetTable`.
    """

    _types: ClassVar = {
        "file": text,
        "seconds": number,
        "date": date,
        "driven": number,
        "stops": whole,
        "touches": whole,
        "nearest": number,
        "nearest_at": number,
        "topics": whole,
        "messages": whole,
        "problem": text,
    }

    def __init__(self, found: list[dict[str, Any]], **rows: Any) -> None:
        super().__init__(**rows)
        self._found = found

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for row in self._found:
            plain = {name: value for name, value in row.items() if name in self._types}
            yield {**plain, "date": date_of(row["start_ns"])}

    def _table(self) -> Table:
        heads = ("file", "seconds", "date", "driven", "stops", "touches", "nearest", "at")
        names = short([row["file"] for row in self._found])
        rows = [
            (
                names[row["file"]],
                f"{row['seconds']:.1f}",
                as_date(row["start_ns"]) if row["start_ns"] is not None and has_date(row["start_ns"]) else "",
                *(_said(row[name], unit) for name, unit in _SHOWN.items()),
            )
            for row in self._found[:SHOWN]
        ]
        more = [f"  ... and {len(self._found) - SHOWN:,} more"] if len(self._found) > SHOWN else []
        seconds = sum(row["seconds"] for row in self._found)
        driven = [row["driven"] for row in self._found if row["driven"] is not None]
        covered = f" in {len(driven):,} of them" if len(driven) < len(self._found) else ""
        way = [f"{sum(driven):,.1f} m driven{covered}"] if driven else []
        head = ", ".join([many(len(self._found), "recording"), f"{seconds:,.1f} s", *way])
        bars = {heads.index(name): _shares([row[name] for row in self._found])[:SHOWN] for name in _BARS}
        return Table(
            head, heads, rows, right=(1, *range(3, 8)), notes=more, problems=list(self._complaints()), bars=bars
        )


_SHOWN = {"driven": ".1f m", "stops": "d", "touches": "d", "nearest": ".2f m", "nearest_at": ".2f"}
_BARS = ("driven", "touches", "nearest")
"""Columns with bars. The length of a bar is the share of the greatest number."""


def _shares(values: list[float | None]) -> list[float]:
    most = max((value for value in values if value is not None and isfinite(value)), default=0)
    return [min(value / most, 1.0) if value and most else 0.0 for value in values]


def _said(value: Any, form: str) -> str:
    how, _, unit = form.partition(" ")
    return "" if value is None else f"{value:{how}} {unit}".rstrip()


def summary(
    *paths: PathLike,
    topics: str | tuple[str, ...] = (),
    executor: Any = None,
    longest: float = LONGEST,
    keep: bool = True,
) -> Summary:
    """Summarize many recordings: lengths, distances driven, numbers of stops and touches, and nearest distances.

    Args:
        *paths: as for `find`.
        topics: as for `find`.
        executor: as for `find`.
        longest: as for `find`.
        keep: as for `find`.

    Raises:
        TypeError: as for `find`. ValueError: as for `find`.

    Examples:
        >>> robowidgets.summary("runs/").to_pandas()  # doctest: +SKIP
    """
    names = (topics,) if isinstance(topics, str) else tuple(topics)
    gathered = gather(
        _Summary(names),
        paths,
        kept_of(("summary", _FORM, names), keep),
        "Reading",
        executor=executor,
        longest=longest,
    )
    return Summary([{"file": path, **result} for path, result in gathered.results.items()], **gathered.rows)


class _Summary:
    """A function that summarizes one recording.

    Args:
        topics: names and patterns of topics.
    """

    def __init__(self, topics: tuple[str, ...]) -> None:
        self._topics = topics

    def __call__(self, path: str) -> dict[str, Any]:
        with open_recording(path) as recording, without_bars():
            recording.preferred = frozenset(chosen_of(recording, self._topics))
            there = {topic.widget for topic in recording.topics if topic.count}
            return {
                "seconds": recording.duration,
                "start_ns": recording.start_ns,
                "topics": len(recording.topics),
                "messages": sum(topic.count for topic in recording.topics),
                **_driven(recording, SPEED.name in there),
                "touches": len(recording.find(conditions.touched())) if TOUCH.name in there else None,
                **_nearest(recording, LASER.name in there),
            }


def _driven(recording: Recording, is_told: bool) -> dict[str, Any]:
    """Return the metres driven, by odometry or else by speeds, and the number of stops; None without measured speeds.

    Impossible steps of the odometry, for example after a reset, do not count.
    """
    speeds = recording.speeds() if is_told else None
    if speeds is None or next(one for one in recording.topics if one.name == speeds.topic).commanded:
        return {"driven": None, "stops": None}
    seconds = np.diff(speeds.seconds)
    steps = np.hypot(*np.diff(speeds.poses[:, :2], axis=0).T)
    fast = np.hypot(speeds.linear[:, 0], speeds.linear[:, 1])
    if not np.isfinite(steps).any():
        is_silent = seconds > RECORDED.after(float(np.median(seconds)) if len(seconds) else 0.0)
        steps = np.where(is_silent, 0.0, fast[:-1] * seconds)
    else:
        usual = np.maximum(seconds, np.median(seconds))  # late messages arrive together
        steps = np.where(is_jump(steps, usual, _speeds(steps, usual, fast)) & (usual > 0), 0.0, steps)
    moves = fast > _STANDING
    return {
        "driven": float(np.nansum(steps)),
        "stops": int(np.count_nonzero(moves[:-1] & ~moves[1:])),
    }


def _speeds(steps: NDArray[Any], seconds: NDArray[Any], told: NDArray[Any]) -> Any:
    """Return the speed of a robot at about each step: as reported, or as in both adjacent steps if that is faster."""
    with np.errstate(divide="ignore", invalid="ignore"):
        beside = np.pad(steps / seconds, 1, constant_values=np.nan)
    went = np.fmin(beside[:-2], beside[2:])
    return np.fmax(np.fmax(told[:-1], told[1:]), np.nan_to_num(went, posinf=0.0))


def _nearest(recording: Recording, is_told: bool) -> dict[str, Any]:
    """Return the nearest distance of the scanner in metres and its time, or None for both without a reading."""
    nearest, at = inf, None
    for chunk in recording.scans().chunks() if is_told else ():
        away = np.nan_to_num(ray_distances(chunk.ranges, chunk.like), nan=inf)
        if away.size and away.min() < nearest:
            row = int(np.unravel_index(away.argmin(), away.shape)[0])
            nearest, at = shortest(away[row].min()), (int(chunk.times_ns[row]) - (recording.start_ns or 0)) / 1e9
    return {"nearest": None, "nearest_at": None} if at is None else {"nearest": nearest, "nearest_at": at}
