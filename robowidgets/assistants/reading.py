"""Answers from recordings."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from functools import reduce
from math import hypot, inf
from operator import and_, or_
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..image.row import IMAGE
from ..kinds import KINDS, on_demand_for_type
from ..laser.row import LASER
from ..messages.image import to_image
from ..notebook.progress import without_bars
from ..recording import Recording
from ..recordings.columns.scans import Scans
from ..recordings.columns.speeds import Speeds
from ..recordings.odometry import odometry
from ..recordings.search import conditions
from ..recordings.search.base import Condition
from ..recordings.search.comparison import compared
from ..recordings.topics import Topic, UnknownTopicError, UnnamedTopicError, check_known, likeliest
from ..runtime.text import many
from ..samples import Scan
from ..samples.distances import ray_distances
from ..samples.sector import ALL_ROUND, to_sector
from ..samples.staleness import RECORDED
from ..speed.row import SPEED
from .answer import (
    MAX_PROBLEM_TEXT,
    AnswerError,
    QuotingError,
    ToolAnswer,
    cut,
    exact,
    from_robot,
    name,
    number,
    seconds,
)
from .describe import describe, distance, frame, ray, said
from .library import Library
from .picture import picture_of

MAX_TOPICS, MAX_SPANS, MAX_PROBLEMS, MAX_POINTS, MAX_NAMES = 60, 30, 20, 200, 100

COMPARED_TIMES = 20
"""The number of times at which recordings are compared."""


class RecordingTools:
    """Answers from the recordings of a library. Each method is one question; any thread may ask.

    Args:
        library: the recordings.
    """

    def __init__(self, library: Library) -> None:
        self._library = library

    def recordings(self) -> ToolAnswer:
        """List the recordings."""
        names = self._library.names()
        return ToolAnswer(
            f"{many(len(names), 'recording')} that this server may read.", {"recordings": cut(names, MAX_NAMES)}
        )

    def info(self, recording: str) -> ToolAnswer:
        """Return the length, the topics and the problems of a recording."""
        with self._library.open(recording) as opened:
            opened.check_topics()
            topics = [_topic(topic) for topic in sorted(opened.topics, key=lambda one: one.widget is None)]
            data = {
                "seconds": seconds(opened.duration),
                "start_ns": opened.start_ns,
                "topics": cut(topics, MAX_TOPICS),
                "problems": _problems(opened.problems),
            }
            return ToolAnswer(
                f"{opened.duration:.1f} s, {many(len(topics), 'topic')}, {many(len(opened.problems), 'problem')}.", data
            )

    def doctor(self, recording: str) -> ToolAnswer:
        """Check a recording, and return its problems with their remedies."""
        with self._library.open(recording) as opened, without_bars():
            report = opened.doctor()
            problems = [
                {"problem": from_robot(one.what, MAX_PROBLEM_TEXT), "remedy": from_robot(one.remedy, MAX_PROBLEM_TEXT)}
                for one in report.problems
            ]
            topics = [
                {"topic": name(one.topic), "samples": one.samples, "rate_hz": one.rate and number(one.rate)}
                for one in report.topics
            ]
            data = {"problems": cut(problems, MAX_PROBLEMS), "topics": cut(topics, MAX_TOPICS)}
            return ToolAnswer(f"{many(len(problems), 'problem')}; the texts may quote names from the recording.", data)

    def find(self, recording: str, **asked: Any) -> ToolAnswer:
        """Return the spans in which conditions held."""
        with self._library.open(recording) as opened, without_bars():
            try:
                spans = opened.find(_condition(**asked))
            except UnnamedTopicError as error:
                by = KINDS[error.widget].sample_name if error.widget else "silent"
                raise QuotingError(f"{error.there}: name the topic, as in {by}={error.topics[0]!r}") from None
            found = [
                {
                    "start_s": seconds(span.start),
                    "end_s": seconds(span.end),
                    **({} if span.nearest is None else {"nearest_m": number(span.nearest), "index": span.index}),
                    **({} if span.value is None else {"value": exact(span.value)}),
                    **({"silent": [name(topic) for topic in span.silent]} if span.silent else {}),
                }
                for span in spans
            ]
            data = {
                "spans": cut(found, MAX_SPANS),
                "seconds_in_all": seconds(spans.seconds),
                "searched_all": spans.is_complete,
                "problems": _problems(spans.problems),
            }
            return ToolAnswer(f"{many(len(found), 'span')}, {spans.seconds:.2f} s in all.", data)

    def at(self, recording: str, topic: str, at: float) -> ToolAnswer:
        """Return the last sample or message of a topic up to a time."""
        with self._library.open(recording) as opened:
            sample, about = _sample_at(opened, topic, at)
            return ToolAnswer(when(about), {**about, **describe(sample)})

    def distance(
        self, recording: str, at: float, topic: str | None, sector: Any, percentile: float | None
    ) -> ToolAnswer:
        """Return the distance to the nearest thing in a sector at a time."""
        with self._library.open(recording) as opened:
            scan, about = _scan_at(opened, topic, at)
            return of_distance(scan, about, sector, percentile)

    def nearest(self, recording: str, at: float, topic: str | None, sector: Any, count: int) -> ToolAnswer:
        """Return the rays to the nearest things in a sector at a time, the nearest first."""
        with self._library.open(recording) as opened:
            scan, about = _scan_at(opened, topic, at)
            return of_nearest(scan, about, sector, count)

    def series(
        self, recording: str, topic: str, fields: Sequence[str], start: float | None, end: float | None, points: int
    ) -> ToolAnswer:
        """Return fields of a topic over time: at most some points, and the extremes of all."""
        if not 1 <= points <= MAX_POINTS:
            raise AnswerError(f"points: expected 1 to {MAX_POINTS}, got {points}")
        with self._library.open(recording) as opened, without_bars():
            times, columns = _columns(opened, topic, list(fields), start, end)
            rows = np.unique(np.linspace(0, max(0, len(times) - 1), min(points, len(times))).astype(np.intp))
            data: dict[str, Any] = {
                "count": len(times),
                "points": len(rows),
                "seconds": [seconds(times[i]) for i in rows],
                "fields": {field: _line(values, rows) for field, values in columns.items()},
            }
            thinned = "" if len(rows) == len(times) else ", thinned evenly; min, max and mean are of all"
            return ToolAnswer(f"{len(rows)} of {len(times)} points{thinned}. null: unknown or not finite.", data)

    def picture(self, recording: str, topic: str, at: float) -> ToolAnswer:
        """Return a PNG of a scan or of a camera picture at a time."""
        with self._library.open(recording) as opened:
            sample, about = _sample_at(opened, topic, at)
            return of_picture(sample, about, check_known(topic, opened.topics, opened.path.name).type)

    def compare(self, recordings: Sequence[str]) -> ToolAnswer:
        """Return facts of 2 to 4 recordings side by side, and nearest distances and speeds at the same times."""
        if not 2 <= len(recordings) <= 4:
            raise AnswerError(f"recordings: expected 2 to 4 names, got {len(recordings)}")
        made: list[dict[str, Any]] = []
        with without_bars():
            for which in recordings:
                with self._library.open(which) as opened:
                    made.append({"recording": which, **_facts(opened)})
        shortest = min(one["seconds"] for one in made)
        at = [seconds(shortest * i / COMPARED_TIMES) for i in range(COMPARED_TIMES + 1)]
        for one in made:
            for line in ("nearest_m", "speed_m_s"):
                held = one.pop(f"_{line}", None)
                one[f"{line}_at"] = None if held is None else [_held(held, second) for second in at]
        text = f"{len(made)} recordings, by the time since the start of each; null: unknown."
        return ToolAnswer(text, {"at_s": at, "recordings": made})


def _line(values: NDArray[Any], rows: NDArray[np.intp]) -> dict[str, Any]:
    """Return the values of some rows, and the extremes of all."""
    known = values[np.isfinite(values)]
    made: dict[str, Any] = {"values": [exact(values[i]) for i in rows], "unknown": len(values) - len(known)}
    if len(known):
        made |= {"min": exact(known.min()), "max": exact(known.max()), "mean": exact(known.mean())}
    return made


def of_distance(scan: Scan, about: dict[str, Any], sector: Any, percentile: float | None) -> ToolAnswer:
    """Return the distance to the nearest thing in a sector of a scan."""
    rays = to_sector(sector) if sector is not None else ALL_ROUND
    data = {**about, **distance(scan, rays), **frame(scan)}
    if percentile is not None:
        data |= {"percentile": percentile, "distance_m": number(scan.distance(rays, percentile=percentile))}
    return ToolAnswer(f"{said(scan.distance(rays, percentile=percentile))}. {when(about)}", data)


def of_nearest(scan: Scan, about: dict[str, Any], sector: Any, count: int) -> ToolAnswer:
    """Return the nearest rays in a sector of a scan."""
    if not 1 <= count <= 20:
        raise AnswerError(f"count: expected 1 to 20 rays, got {count}")
    indices = scan.indices(to_sector(sector) if sector is not None else ALL_ROUND)
    away = ray_distances(scan.ranges, scan)
    order = indices[np.argsort(away[indices], kind="stable")]
    found = [ray(scan[int(i)]) for i in order[:count] if away[i] < inf]
    data = {
        **about,
        "rays": found,
        "rays_in_sector": len(indices),
        **frame(scan),
    }
    return ToolAnswer(f"{many(len(found), 'ray')}, the nearest first. {when(about)}", data)


def of_picture(sample: Any, about: dict[str, Any], type_name: str) -> ToolAnswer:
    """Return a picture of a sample."""
    if on_demand_for_type(type_name) is IMAGE:
        sample = to_image(sample)
    made, how = picture_of(sample)
    return ToolAnswer(f"{how} {when(about)}", about, made)


def when(about: dict[str, Any]) -> str:
    """Return a text for the age of a sample."""
    if "at_s" not in about:
        return f"The sample came {about['age_s']:.3f} s ago{', and is stale: unknown now' if about['stale'] else ''}."
    stale = ", stale: it may say nothing about that time any more" if about.get("stale") else ""
    return f"The sample is {about['age_s']:.3f} s older than the time that was asked for{stale}."


def _sample_at(recording: Recording, topic: str, at: float) -> tuple[Any, dict[str, Any]]:
    known = check_known(topic, recording.topics, recording.path.name)
    if not 0 <= at <= recording.duration:
        raise AnswerError(f"seconds: expected seconds from the start, 0 to {recording.duration:.3f}, got {at:g}")
    moment = recording.at(topic, at) if known.widget else recording.message_at(topic, at)
    if moment is None:
        raise AnswerError(f"{topic}: unknown at {at:g} s, as the topic has no sample up to then")
    age = at - moment.seconds
    # The state of a touch sensor stays until the next message.
    holds = known.widget is not None and not KINDS[known.widget].goes_stale
    fresh_for = RECORDED.after(inf) if holds else _fresh_for(known)
    return moment.sample, {
        "topic": name(topic),
        "at_s": seconds(at),
        "sample_s": seconds(moment.seconds),
        "time_ns": moment.time_ns,
        "age_s": seconds(age),
        "stale": bool(age > fresh_for),
    }


def _scan_at(recording: Recording, topic: str | None, at: float) -> tuple[Scan, dict[str, Any]]:
    chosen = recording.only(LASER.name) if topic is None else topic
    sample, about = _sample_at(recording, chosen, at)
    if not isinstance(sample, Scan):
        raise AnswerError(f"topic: expected a topic of scans, got {chosen}")
    return sample, about


def _topic(topic: Topic) -> dict[str, Any]:
    return {
        "topic": name(topic.name),
        "type": name(topic.type),
        "count": topic.count,
        "rate_hz": None if topic.rate is None else number(topic.rate),
        "shown_by": topic.widget,
        **({"commanded": True} if topic.commanded else {}),
        **({"problem": from_robot(topic.problem)} if topic.problem else {}),
    }


def _problems(problems: Sequence[str]) -> dict[str, Any]:
    return cut([from_robot(one, MAX_PROBLEM_TEXT) for one in problems], MAX_PROBLEMS)


def _condition(
    *,
    touched: Sequence[str] = (),
    nearest_below: float | None = None,
    sector: Any = None,
    speed_above: float | None = None,
    axis: str = "linear.x",
    gap: float | None = None,
    fields: Sequence[str] = (),
    event: str | None = None,
    level: str | None = None,
    text: str | None = None,
    label: str | None = None,
    scan: str | None = None,
    speed: str | None = None,
    touch: str | None = None,
    silent: str | None = None,
    any_of: bool = False,
) -> Condition:
    """Return the condition of the arguments: the ones of the command ``find``, and no code."""
    asked: list[Condition] = [conditions.touched(one or None, touch) for one in touched]
    if nearest_below is not None:
        asked.append(conditions.nearest_below(nearest_below, ALL_ROUND if sector is None else to_sector(sector), scan))
    if speed_above is not None:
        asked.append(conditions.speed_above(speed_above, axis, speed))
    if gap is not None:
        asked.append(conditions.gap(gap, silent))
    asked += map(compared, fields)
    if event is not None or level is not None or text is not None:
        asked.append(conditions.event(event or None, level, text))
    if label is not None:
        asked.append(conditions.label(label or None))
    if not asked:
        raise AnswerError(
            "find: expected a condition: touched, nearest_below, speed_above, gap, fields, event, level, text or label"
        )
    for option, given, user, used in (
        ("sector", sector, "nearest_below", nearest_below),
        ("scan", scan, "nearest_below", nearest_below),
        ("speed", speed, "speed_above", speed_above),
        ("touch", touch, "touched", touched or None),
        ("silent", silent, "gap", gap),
    ):
        if given is not None and used is None:
            raise AnswerError(f"find: {option} needs {user}, which is missing")
    return reduce(or_ if any_of else and_, asked)


def _columns(
    recording: Recording, topic: str, names: list[str], start: float | None, end: float | None
) -> tuple[Any, dict[str, Any]]:
    """Return the times and the fields of a topic; without names, the nearest distance of scans, or the speed."""
    known = check_known(topic, recording.topics, recording.path.name)
    if not names and known.widget:
        series = recording.series(topic).between(start, end)
        if isinstance(series, Scans):
            return series.seconds, {"nearest_m": series.distances().astype(float)}
        if isinstance(series, Speeds):
            columns = {"linear.x_m_s": series.linear[:, 0], "angular.z_rad_s": series.angular[:, 2]}
            return series.seconds, columns
    fields = recording.fields(topic)
    if not names:
        raise QuotingError(f"fields: name some of {', '.join(fields.names[:40])}")
    if len(names) > 6:
        raise AnswerError(f"fields: expected at most 6, got {len(names)}")
    part = fields.between(start, end)
    made = {}
    for one in names:
        column = np.asarray(part[one])
        if column.ndim != 1 or column.dtype.kind not in "fiub":
            raise AnswerError(f"fields: {one!r} is not a number per message; ask `at` for it")
        made[one] = column
    return part.seconds, made


def _facts(recording: Recording) -> dict[str, Any]:
    """Return what is compared of a recording; None for what it did not record."""
    made: dict[str, Any] = {"seconds": seconds(recording.duration), "problems": len(recording.problems)}
    scans = _likeliest(recording, LASER.name)
    if scans:
        columns = recording.scans(scans.name)
        away = columns.distances().astype(float)
        known = np.isfinite(away)
        if known.any():
            least = int(np.where(known, away, inf).argmin())
            made["nearest"] = {"distance_m": number(away[least]), "at_s": seconds(columns.seconds[least])}
        made["_nearest_m"] = columns.seconds, away, _fresh_for(scans)
    speeds = _likeliest(recording, SPEED.name)
    if speeds:
        moved = recording.speeds(speeds.name)
        made["fastest_m_s"] = number(np.nanmax(np.abs(moved.linear[:, 0]))) if len(moved) else None
        made["_speed_m_s"] = moved.seconds, moved.linear[:, 0], _fresh_for(speeds)
    topic = odometry(recording.topics)
    if topic:
        poses = recording.speeds(topic).poses
        poses = poses[np.isfinite(poses).all(axis=1)]
        made["driven_m"] = number(sum(hypot(*step) for step in np.diff(poses[:, :2], axis=0)))
    for line, condition in (("touches", conditions.touched()), ("warnings", conditions.event(level="WARN"))):
        made[line] = None
        with suppress(UnknownTopicError):
            made[line] = len(recording.find(condition))
    return made


def _likeliest(recording: Recording, widget: str) -> Topic | None:
    fitting = [topic for topic in recording.topics if topic.widget == widget and topic.count]
    return likeliest(fitting) if fitting else None


def _fresh_for(topic: Topic) -> float:
    """Return the seconds for which a sample of a topic says something about the present."""
    return RECORDED.after(1 / topic.rate if topic.rate else inf)


def _held(line: tuple[Any, Any, float], second: float) -> float | None:
    """Return the value at a time, or None before the first sample and while the last one is stale."""
    times, values, fresh_for = line
    row = int(np.searchsorted(times, second, "right")) - 1
    return None if row < 0 or second - times[row] > fresh_for else number(values[row])
