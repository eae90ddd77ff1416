"""A check-up of a recording: the contents of its topics, their problems, and the remedies."""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import chain, zip_longest
from math import degrees
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kinds import KINDS
from ...messages.standard import LASER_SCAN, ODOMETRY, RANGE
from ...poses.transforms import Transform
from ...runtime.tables import HasTable, Table
from ...runtime.text import listed, many, often
from ...samples import Problem
from ...samples.scan_problems import of_ranges
from ..columns.scans import Scans
from ..columns.series import Series
from ..columns.speeds import Speeds
from ..odometry import odometry as odometry_of
from ..times import has_date
from ..topics import UPDATES, Topic, updates_in
from ._mount import problem_of
from ._timing import Timing, timing_of
from ._transforms import TransformCheck

_HEADS = ("topic", "samples", "Hz", "jitter", "lost", "rays", "angles", "step", "limits", "frame")
_RIGHT = (1, 2, 3, 4, 5, 7)

_ALWAYS_THERE = ("/rosout", "/rosout_agg", "/parameter_events", "/events/write_split", "/clock", "/tf_static")
"""Topics that every recorder lists, even without messages, as it does topics of services."""
_OF_SERVICES = "/_service_event"

_SELDOM = 0.02
"""The share of the samples below which a range problem, a loss, or a stamp out of order is not reported."""

_SKEW_S = 1.0
"""Seconds between stamps and log times above which transforms of other computers do not fit any more."""
_LEAST_STAMPS = 10

_LATE_NS = 1_000_000_000
"""Nanoseconds by which a late stamp may lie before the previous one. If it is more, the clock was set."""

_NUMBER = re.compile(r"-?\d+(?:,\d{3})*(?:\.\d+)?(?:e[+-]\d+)?")

_NO_SILENCES = np.empty((0, 2))
_DAY = 86400.0
_LONGEST_NAME = 40


class Geometry(NamedTuple):
    """The settings in the headers of most scans of a topic: radians and metres."""

    angle_min: float
    angle_increment: float
    range_min: float
    range_max: float


class TopicReport(NamedTuple):
    """The contents of one topic.

    ``mount`` describes the mount of a scanner, if its angles are not the angles of the robot. ``samples`` is the number
    of samples that came as messages. ``rate`` is their mean number per second, or None if that has no meaning.
    ``timing`` is the timing of scans and measured speeds. ``ray_counts`` has the number of scans for each number of
    rays, ``geometry`` is the geometry of most scans, ``frame_ids`` are the frames of all scans. They are empty or None
    for samples other than scans.
    """

    topic: str
    samples: int
    rate: float | None
    timing: Timing
    ray_counts: dict[int, int]
    geometry: Geometry | None
    frame_ids: tuple[str, ...]
    mount: str = ""


class Report(HasTable):
    """A check-up of a recording. Printed, it is a table with a line for each problem.

    Args:
        head: the recording in one line.
        topics: a report for each topic that a widget shows.
        problems: the problems with their remedies, or empty if all is well.
    """

    def __init__(self, head: str, topics: Sequence[TopicReport], problems: Sequence[Problem]) -> None:
        self.head = head
        self.topics = tuple(topics)
        self.problems = tuple(problems)

    def to_dict(self) -> dict[str, Any]:
        """Return the same data as dictionaries and lists, as in JSON: seconds, radians and metres."""
        return {
            "topics": [_as_dict(topic) for topic in self.topics],
            "problems": [problem._asdict() for problem in self.problems],
        }

    def _table(self) -> Table:
        rows = [_cells(topic) for topic in self.topics]
        notes = () if self.problems else ("no problems found",)
        return Table(self.head, _HEADS, rows, right=_RIGHT, notes=notes, problems=[*map(str, self.problems)])


def examine(
    head: str,
    topics: Sequence[Topic],
    series: Mapping[str, Series[Any]],
    known: Sequence[Problem],
    silences: Mapping[str, NDArray[np.float64]],
    transforms: Iterable[Transform] = (),
) -> Report:
    """Check a recording. This reads the topics from start to end.

    Args:
        head: the recording in one line.
        topics: all its topics.
        series: the samples of the topics that a widget shows.
        known: the known problems of the file and of its clock.
        silences: start and end in seconds of the silences in these problems, by topic, shape (K, 2).
        transforms: all transforms of the recording.
    """
    tf = TransformCheck(transforms)
    problems = [*known, *_never_came(topics), *_updated(topics), *tf.problems()]
    is_dated = tf.is_dated or any(_has_dated_stamps(one) for one in series.values())
    reports = []
    odometry = series.get(odometry_of(topics) or "")
    for topic in topics:
        if topic.widget and topic.name in series and topic.count:
            report, found = _examine(topic, series[topic.name], silences.get(topic.name, _NO_SILENCES), is_dated)
            reports.append(report)
            of_topic = series[topic.name]
            if isinstance(of_topic, Scans) and isinstance(odometry, Speeds) and (off := problem_of(of_topic, odometry)):
                found.append(off)
            problems += [Problem(f"{topic.name}: {what}", remedy) for what, remedy in found]
    return Report(head, reports, list(dict.fromkeys(problems)))


def _never_came(topics: Sequence[Topic]) -> Iterator[Problem]:
    names = [
        topic.name
        for topic in topics
        if not topic.count and topic.name not in _ALWAYS_THERE and not topic.name.endswith(_OF_SERVICES)
    ]
    if names:
        yield Problem(
            f"{listed(names)}: no message came",
            "does its node run, and does its quality of service fit the recorder's?",
        )


def _updated(topics: Sequence[Topic]) -> Iterator[Problem]:
    for name, count in updates_in(topics).items():
        yield Problem(
            f"{name}: {many(count, 'update')} on {name}{UPDATES} change it, and a map does not draw them",
            "record whole grids: always_send_full_costmap: true in the parameters of its costmap",
        )


def _examine(
    topic: Topic, series: Series[Any], silences: NDArray[np.float64], is_dated: bool
) -> tuple[TopicReport, list[Problem]]:
    is_paced = bool(topic.widget and KINDS[topic.widget].goes_stale and not topic.commanded)
    timing = _timing(series) if is_paced else Timing()
    found = [*_of_timing(timing, series.seconds, silences), *(_of_stamps(topic, series, is_dated) if is_paced else ())]
    rays: dict[int, int] = {}
    geometry: Geometry | None = None
    frames: tuple[str, ...] = ()
    mount = ""
    if isinstance(series, Scans):
        rays = series.ray_counts
        geometry, frames, of_scans = _of_scans(series)
        found += of_scans
        first = next(iter(series.chunks()), None)
        mount = first.like.mount.words if first is not None and first.like.mount else ""
    report = TopicReport(topic.name, int(series.said.sum()), topic.rate, timing, rays, geometry, frames, mount)
    return report, found


def _timing(series: Series[Any]) -> Timing:
    """Return the timing from the stamps, or from the log times if the stamps are not usable.

    Log times come in bursts and contain no sign of lost samples. A few stamps may be late or repeated. If many stamps
    are out of order, they come from several sensors; if one lies far back, a clock was set. Then the log times are
    used, too.
    """
    stamps, seconds = series.stamps_ns, series.seconds
    steps = np.diff(stamps)
    is_in_order = np.count_nonzero(steps <= 0) <= _SELDOM * len(stamps) and (steps > -_LATE_NS).all()
    if (stamps > 0).all() and is_in_order:
        stamps, first = np.unique(stamps, return_index=True)
        return timing_of((stamps - stamps[:1]) / 1e9, seconds[first])
    return Timing(*timing_of(seconds, seconds)[:2])


def _of_timing(timing: Timing, seconds: NDArray[np.float64], silences: NDArray[np.float64]) -> Iterator[Problem]:
    """Yield the problems of a timing, without the pauses that another problem reports as silences.

    ``seconds``: the times of recording of the samples, from the start of the recording.
    """
    if not timing.step:
        return
    count = len(seconds)
    if timing.lost and timing.lost > _SELDOM * count:
        yield Problem(
            f"{timing.lost:,} of {count + timing.lost:,} samples were lost",
            "give the recorder a larger cache and a faster disk; record on the robot, not over Wi-Fi",
        )
    if timing.slow:
        slow = sum(length for _, length in timing.slow)
        yield Problem(
            f"less than half of its usual {1 / timing.step:.1f} Hz for {slow:.1f} s, "
            f"first from {timing.slow[0][0]:.2f} s on",
            "was the network slow, or the robot's computer busy?",
        )
    pauses = [pause for pause in timing.pauses if not np.isclose(silences[:, 0], pause[0]).any()]
    if pauses:
        longest = max(length for _, length in pauses)
        # A recorder that received all samples at once has a shorter time.
        clock = " by its stamps" if longest > seconds[-1] - seconds[0] else ""
        yield Problem(
            f"nothing came {often(len(pauses))}, for up to {longest:.1f} s{clock}, first from {pauses[0][0]:.2f} s on",
            "did the sensor, its cable or the network fail?",
        )


def _has_dated_stamps(series: Series[Any]) -> bool:
    stamps = series.stamps_ns
    return len(stamps) > 0 and has_date(int(np.median(stamps)))


def _of_stamps(topic: Topic, series: Series[Any], is_dated: bool) -> Iterator[Problem]:
    """Yield the problem of stamps by another clock than the recorder's. A simulated clock differs on purpose.

    Args:
        topic: the topic.
        series: its samples.
        is_dated: True if other stamps of the recording are dates, so that they are not simulated.
    """
    times, stamps = series.times_ns, series.stamps_ns
    if len(stamps) < _LEAST_STAMPS or not has_date(int(times.min())):
        return
    if is_dated and not has_date(int(stamps.max())) and (stamps.any() or _is_stamped(topic.type)):
        behind = float(np.median(times - stamps)) / 1e9
        kind = "seconds since a start" if stamps.any() else "0"
        yield Problem(
            f"stamps are {behind:,.0f} s behind the recorder's clock: they are {kind}, others are dates",
            "give its driver the time (micro-ROS: rmw_uros_sync_session), or tf finds no transforms",
        )
    if not has_date(int(stamps.min())):
        return
    skew = float(np.median(stamps - times)) / 1e9
    if abs(skew) > _SKEW_S:
        size = f"{abs(skew):.1f} s" if abs(skew) < _DAY else f"{abs(skew) / _DAY:,.1f} days"
        yield Problem(
            f"stamps are {size} {'ahead of' if skew > 0 else 'behind'} the recorder's clock",
            "set the clocks of the robot and the recorder (chrony, NTP), or tf finds no transforms",
        )


def _is_stamped(type_name: str) -> bool:
    """Return True for types whose messages have a stamp that is a date, so that 0 is an error. A Twist has no stamp."""
    return type_name.endswith("Stamped") or type_name in (LASER_SCAN, ODOMETRY, RANGE)


def _of_scans(scans: Scans) -> tuple[Geometry | None, tuple[str, ...], list[Problem]]:
    """Return geometry and frames of scans, and the problems of headers and ranges."""
    geometries: Counter[Geometry] = Counter()
    frames: dict[str, None] = {}
    counts: Counter[Problem] = Counter()
    first: dict[Problem, float] = {}
    headers: set[Problem] = set()
    seconds = scans.seconds
    for chunk in scans.chunks():
        like = chunk.like.unmounted()
        geometries[Geometry(like.angle_min, like.angle_increment, like.range_min, like.range_max)] += len(chunk)
        frames[like.frame_id] = None
        headers.update(like.header_problems)
        for i, ranges in enumerate(chunk.ranges):
            for problem in (*like.header_problems, *of_ranges(ranges, like.range_min, like.range_max)):
                counts[problem] += 1
                first.setdefault(problem, float(seconds[chunk.start + i]))
    problems = []
    for alike in _groups(counts):
        count = sum(counts[problem] for problem in alike)
        if count <= _SELDOM * len(scans) and not headers.intersection(alike):
            continue
        joined = Problem(_joined([problem.what for problem in alike]), alike[0].remedy)
        if count < len(scans) or len(alike) > 1:
            where = f"in {count:,} of {len(scans):,} scans"
            if count < len(scans):
                where += f", first at {min(first[problem] for problem in alike):.2f} s"
            joined = joined._replace(what=f"{joined.what} ({where})")
        problems.append(joined)
    usual = geometries.most_common(1)
    return usual[0][0] if usual else None, tuple(frames), problems


def _groups(problems: Iterable[Problem]) -> list[list[Problem]]:
    """Group problems that differ only in their numbers, in the order of the first of each group."""
    groups: defaultdict[tuple[str, str], list[Problem]] = defaultdict(list)
    for problem in problems:
        groups[_NUMBER.sub("", problem.what), _NUMBER.sub("", problem.remedy)].append(problem)
    return list(groups.values())


def _joined(texts: Sequence[str]) -> str:
    """Join texts that differ only in their numbers into one: ``for 926 to 937 rays``."""
    columns = zip(*(_NUMBER.findall(text) for text in texts), strict=True)
    numbers = (sorted(set(column), key=lambda number: float(number.replace(",", ""))) for column in columns)
    ranges = [one[0] if len(one) == 1 else f"{one[0]} to {one[-1]}" for one in numbers]
    return "".join(chain(*zip_longest(_NUMBER.split(texts[0]), ranges, fillvalue="")))


def _as_dict(report: TopicReport) -> dict[str, Any]:
    facts = report._asdict() | {"timing": report.timing._asdict()}
    return facts | {"geometry": report.geometry._asdict() if report.geometry else None}


def _cells(report: TopicReport) -> tuple[str, ...]:
    timing, geometry = report.timing, report.geometry
    rate = "" if report.rate is None else f"{report.rate:.1f}"
    jitter = "" if timing.jitter is None else f"{1000 * timing.jitter:.1f} ms"
    lost = "" if timing.lost is None else f"{timing.lost:,}"
    cells = (report.topic, f"{report.samples:,}", rate, jitter, lost)
    if geometry is None:
        return (*cells, *[""] * 5)
    counts = sorted(report.ray_counts)
    rays = f"{counts[0]:,}" + (f" to {counts[-1]:,}" if len(counts) > 1 else "")
    usual = max(report.ray_counts, key=lambda count: report.ray_counts[count])
    first, step = degrees(geometry.angle_min), degrees(geometry.angle_increment)
    angles = f"{first:.1f}° to {first + (usual - 1) * step:.1f}°" if usual else ""
    limit = "" if geometry.range_max >= np.finfo(np.float32).max else f"{geometry.range_max:.4g} m"
    limits = f"{geometry.range_min:.4g} to {limit}" if limit else f"from {geometry.range_min:.4g} m"
    frames = listed(list(map(_name_of, report.frame_ids)), 2)
    angles += ", clockwise" * (step < 0) + f", {report.mount}" * bool(report.mount)
    return (*cells, rays, angles, f"{step:.4g}°", limits, frames)


def _name_of(frame_id: str) -> str:
    """Return the name of a frame for display: a name from a file may be of any length."""
    return (frame_id if len(frame_id) <= _LONGEST_NAME else f"{frame_id[: _LONGEST_NAME - 1]}…") or "(empty)"
