"""`robowidgets.compare`: several drives in one plot and on one map, by time or by place."""

from __future__ import annotations

import os
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, suppress
from typing import Any, NamedTuple

import numpy as np

from ._plot import same_places
from .laser.row import LASER
from .notebook.progress import without_bars
from .path_widget import PathWidget
from .plot_widget import PlotWidget
from .plots.line import Floats, held
from .poses.places import to_place
from .recordings.data import RecordingData
from .recordings.odometry import odometry
from .recordings.search import conditions
from .recordings.search.base import Condition
from .recordings.search.search import find
from .recordings.topics import UnknownTopicError, likeliest
from .samples import Pose
from .samples.map_item import MapItem
from .samples.sector import ALL_ROUND, SectorLike
from .samples.state_span import StateSpan, rows_of
from .screen_widget import ScreenWidget
from .screens.layout import in_columns
from .shapes import Points
from .speed.row import SPEED

MOST = 4
"""The maximum number of drives: a graph has room for so many lines."""
_POINTS = 1000
"""The maximum number of points of a path on the map."""
_MARKS = 200
"""Marks of a drive: a plot has room for so many."""
_FRAME = "odom"
_NAME = 40
"""Characters of a name next to a place."""
_LINES = ("nearest", "speed")


class Comparison(ScreenWidget):
    """The plot and the map of `compare`, side by side. The map shows the robots at the time of the plot.

    Attributes:
        plot: the `PlotWidget`.
        map: the `PathWidget`, or None if no drive has odometry.
    """

    def __init__(self, plot: PlotWidget, ways: Mapping[str, _Way], is_by_place: bool) -> None:
        self.plot, self.map = plot, _map(ways)
        # By place, all robots were at the place of the first one.
        self._ways = dict([*ways.items()][:1]) if is_by_place else ways
        self._marked: list[str] = []
        super().__init__(places=in_columns([plot, *([self.map] if self.map else [])]))
        plot.observe(self._mark, "time")

    def _mark(self, change: Any) -> None:
        """Mark on the map the position of each robot at the time of the plot."""
        if self.map is None:
            return
        for mark in self._marked:
            self.map.draw(mark, None)
        self._marked = []
        if change.new is None:
            return
        for name, (seconds, poses) in self._ways.items():
            row = int(np.searchsorted(seconds, change.new, "right")) - 1
            if row >= 0:
                mark = f"{name[:_NAME]} at {change.new:.1f} s"
                self.map.draw(mark, Points([poses[row, :2]]), frame=_FRAME)
                self._marked.append(mark)


class _Way(NamedTuple):
    """The path of a robot by the odometry of the first drive: seconds, and x, y and yaw."""

    seconds: Floats
    poses: Floats


class _Drive(NamedTuple):
    """A recording with its name, and the pose at which its odometry starts in the odometry frame of the first drive."""

    name: str
    recording: RecordingData
    origin: Pose


def compare(
    *drives: str | os.PathLike[str] | RecordingData,
    by: str = "time",
    sector: SectorLike = ALL_ROUND,
    marks: Condition | None = None,
    origins: Sequence[Sequence[Any]] = (),
) -> Comparison:
    """Show several drives in one plot and on one map: nearest distance, speed, states, marks, and paths.

    The lines of the first drive are dark, the lines of the others gray, and the legend shows the differences.

    Args:
        *drives: 2 to 4 recordings, or their paths.
        by: "time" from the start of each drive, or "place": the values of another drive are taken at the times when its
            robot was at the place of the first robot by odometry, as in `Player.follow`.
        sector: the sector of the nearest distance, as in `Scan.distance`.
        marks: a condition whose spans are marked, named by drive, or None for touches and events of level WARN or more.
            By place, only spans of the first drive are marked.
        origins: for each drive but the first, x and y in metres and yaw in radians, or as "20deg", at which its
            odometry starts in the odometry frame of the first; empty if all start at the same place.

    Raises:
        TypeError: an argument is not a recording. ValueError: too few or too many recordings, or, by place, the robots
            were never near each other.
        UnknownTopicError: no recording has scans or measured speeds, or, by place, one has no odometry.
        RecordingError: a recording cannot be read.

    Example:
        >>> import robowidgets
        >>> view = robowidgets.compare(robowidgets.SAMPLE, robowidgets.SAMPLE)
        >>> view.plot.names[:2]
        ('nearest (sample)', 'nearest (sample 2)')
    """
    if not 2 <= len(drives) <= MOST:
        raise ValueError(f"compare(): expected 2 to {MOST} recordings, got {len(drives)}")
    if by not in ("time", "place"):
        raise ValueError(f"by: expected 'time' or 'place', got {by!r}")
    if origins and len(origins) != len(drives) - 1:
        raise ValueError(f"origins: expected one for each drive but the first ({len(drives) - 1}), got {len(origins)}")
    with ExitStack() as opened, without_bars():
        recordings = [
            drive if isinstance(drive, RecordingData) else opened.enter_context(RecordingData(drive))
            for drive in drives
        ]
        starts = [Pose(0.0, 0.0, 0.0), *(to_place("origins", origin) for origin in origins)]
        starts += [starts[0]] * (len(drives) - len(starts))
        all_of = [_Drive(*one) for one in zip(_names(recordings), recordings, starts, strict=True)]
        return Comparison(_plot(all_of, by, sector, marks), dict(_ways(all_of)), by == "place")


def _names(recordings: Sequence[RecordingData]) -> list[str]:
    """Return short names that differ: with as much of the path as needed, and with numbers for the same file."""
    paths = [recording.path for recording in recordings]
    names = [path.name.partition(".")[0] for path in paths]
    if len(set(names)) < len(set(paths)):
        names = [path.name for path in paths]
    if len(set(names)) < len(set(paths)):
        base = os.path.commonpath([path.parent for path in paths])
        names = [os.path.relpath(path, base) for path in paths]
    return [f"{name} {names[:i].count(name) + 1}" if name in names[:i] else name for i, name in enumerate(names)]


def _plot(drives: Sequence[_Drive], by: str, sector: SectorLike, marks: Condition | None) -> PlotWidget:
    lines = {name: line for drive in drives for name, line in _lines(drive, sector)}
    lacks = [f"{name} of {drive.name}" for drive in drives for name in _LINES if f"{name} ({drive.name})" not in lines]
    if not lines:
        raise UnknownTopicError(f"compare(): none of {', '.join(d.name for d in drives)} has scans or measured speeds")
    if by == "place":
        first, *others = drives
        for drive in others:
            times = same_places(
                first.recording, drive.recording, drive.origin, "compare(): {}; give origins=[(x, y, yaw)]"
            )
            for name in (name for name, _ in _lines(drive, sector)):
                lines[name] = times[0], held(*lines[name], times[1])
    shown = drives[:1] if by == "place" else drives
    widget = PlotWidget(
        title=", ".join(drive.name for drive in drives)
        + (f" where {drives[0].name} was" if by == "place" else "")
        + (f"; not recorded: {', '.join(lacks)}" if lacks else ""),
        units={name: "m" if name.startswith("nearest") else "m/s" for name in lines},
        ghosts=[name for name in lines if not name.endswith(f"({drives[0].name})")],
        marks=sorted(mark for drive in shown for mark in _marks(drive, marks)),
        states=rows_of(span for drive in shown for span in _states(drive, len(shown) > 1)),
    )
    for name in sorted(lines, key=lambda name: name.partition(" ")[0]):
        widget.set_line(name, *lines[name])
    return widget


def _lines(drive: _Drive, sector: SectorLike) -> Iterator[tuple[str, tuple[Floats, Floats]]]:
    """Yield the nearest distance and the speed of a drive by name, if it has them."""
    recording = drive.recording
    with suppress(UnknownTopicError):
        scans = recording.scans(_topic(recording, LASER.name))
        yield f"nearest ({drive.name})", (scans.seconds, scans.distances(sector).astype(np.float64))
    with suppress(UnknownTopicError):
        speeds = recording.speeds(_topic(recording, SPEED.name))
        yield f"speed ({drive.name})", (speeds.seconds, speeds.linear[:, 0])


def _topic(recording: RecordingData, widget: str) -> str | None:
    """Return the preferred topic of a kind, or None if the recording has at most one."""
    fitting = [topic for topic in recording.topics if topic.widget == widget and topic.count]
    return likeliest(fitting).name if len(fitting) > 1 else None


def _marks(drive: _Drive, asked: Condition | None) -> Iterator[tuple[float, float, str]]:
    for condition in (conditions.touched(), conditions.event(level="WARN")) if asked is None else (asked,):
        try:
            spans = find(drive.recording, condition, None)
        except UnknownTopicError:
            if asked is not None:
                raise
            continue
        for span in spans[:_MARKS]:
            yield span.start, span.end, f"{drive.name}: {condition}"


def _states(drive: _Drive, is_named: bool) -> Iterator[StateSpan]:
    """Yield the states of the programs of a drive, in separate rows for each drive."""
    prefix = f"{drive.name.replace('.', '_')} " if is_named else ""
    for span in drive.recording.states:
        yield span._replace(path=f"{prefix}{span.path}")


def _ways(drives: Sequence[_Drive]) -> Iterator[tuple[str, _Way]]:
    """Yield the paths of all drives that have odometry, by name."""
    for drive in drives:
        topic = odometry(drive.recording.topics)
        speeds = drive.recording.speeds(topic) if topic else None
        if not speeds:
            continue
        is_known = np.isfinite(speeds.poses).all(axis=1)
        if is_known.any():
            poses = np.stack(drive.origin.offset(*speeds.poses[is_known].T), axis=1)
            yield drive.name, _Way(speeds.seconds[is_known], poses)


def _map(ways: Mapping[str, _Way]) -> PathWidget | None:
    """Return a map of the paths in the odometry frame of the first drive, or None without paths."""
    if not ways:
        return None
    widget = PathWidget(title="ways by odometry", frame=_FRAME)
    widget.has_rate = False  # recorded data does not become stale
    for name, (seconds, poses) in ways.items():
        few = np.unique(np.linspace(0, len(seconds) - 1, min(_POINTS, len(seconds))).astype(int))
        for second, pose in zip(seconds[few].tolist(), poses[few].tolist(), strict=True):
            widget.put(name, MapItem("pose", _FRAME, pose=Pose(*pose)), time=second)
    return widget
