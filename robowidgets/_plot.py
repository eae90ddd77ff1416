"""`robowidgets.plot`: fields of a recording or of a running robot over time, in one call."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from .feeds.feed import Feed
from .kinds import is_command, topic_and_field
from .plot_widget import MOST_LINES, PlotWidget
from .plots.line import Floats, held, slope
from .poses.places import WITHIN, to_place
from .recordings.data import RecordingData
from .recordings.field_lines import FieldLine, choices, field_lines
from .recordings.odometry import places_of
from .recordings.search.base import Condition
from .recordings.search.search import find
from .recordings.time_slice import TimeSlice
from .samples import Pose
from .samples.state_span import rows_of

_EXAMPLE = 'plot(recording, "/odom.twist.twist.linear.x")'
_BY = ("time", "place")


def plot(
    source: RecordingData | TimeSlice | Feed,
    *fields: str,
    derivative: bool = False,
    beside: RecordingData | None = None,
    by: str = "time",
    origin: Sequence[Any] = (0, 0, 0),
    **options: Any,
) -> PlotWidget:
    """Plot fields of a recording, or of a running robot, over time: any numbers of any topics, each with its name.

    Args:
        source: a recording, or a part of it, such as ``recording[2:5]``; or a feed, whose messages are added from now
            on, in seconds since the first one.
        *fields: a topic with a field, such as ``"/odom.twist.twist.linear.x"``. A field with several numbers adds all
            of them: ``"/imu.angular_velocity"``. Eight numbers in total at most. With a feed, each field is one number,
            and the topic may appear later.
        derivative: True to add the change per second of each line of a recording, such as ``"d/dt
            /odom.twist.twist.linear.x"``.
        beside: another recording, whose same fields are drawn in gray; ``shift=`` moves them by seconds.
        by: "time"; or "place" to compare with the times at which the robot of the other recording was at the same
            place, by odometry, as in `Player.follow`.
        origin: for "place", the start of the other recording's odometry in the odometry of this recording: x and y in
            metres and yaw in radians, or as "20deg".
        **options: keywords of `PlotWidget`. Units in them replace the units of the definition. ``marks`` may be a
            condition, whose spans in the recording are marked.

    Raises:
        UnknownTopicError: the recording has no such topic, or its messages cannot be read, or it has no odometry for
            "place".
        KeyError: the messages have no such field. The text names similar ones.
        TypeError: neither a recording nor a feed, no field, or a field that is not a number.
        ValueError: more than eight numbers, or the two recordings have no places in common.

    Examples:
        >>> import robowidgets
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> robowidgets.plot(recording, "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x").names
        ('/odom.twist.twist.linear.x', '/cmd_vel.twist.linear.x')
    """
    if not isinstance(source, (RecordingData, TimeSlice, Feed)):
        raise TypeError(f"plot() takes a recording or a feed, and fields, as {_EXAMPLE}; got {source!r}")
    if not fields:
        raise TypeError(f"plot() needs a field, as {_EXAMPLE}")
    for field in fields:
        if not isinstance(field, str):
            raise TypeError(f"plot(): expected a topic with a field, like '/odom.twist.twist.linear.x', got {field!r}")
    if beside is not None and not isinstance(beside, RecordingData):
        raise TypeError(f"beside: expected another recording, got {beside!r}")
    if by not in _BY:
        raise ValueError(f"by: expected {' or '.join(map(repr, _BY))}, got {by!r}")
    if isinstance(source, Feed):
        if derivative or beside is not None:
            raise TypeError("plot(): derivative and beside are for recordings; plot.update() takes any number")
        return _live(source, fields, options)
    lines = [line for field in fields for line in _lines(source, field)]
    if derivative:
        lines += [
            FieldLine(f"d/dt {name}", seconds, slope(seconds, values), _per_second(unit) if unit else "")
            for name, seconds, values, unit in lines
        ]
    ghosts = list(_ghosts(source, beside, fields, by, origin)) if beside is not None else []
    if len(lines) + len(ghosts) > MOST_LINES:
        raise ValueError(f"plot(): expected at most {MOST_LINES} lines, got {', '.join(n for n, *_ in lines + ghosts)}")
    return _of_recording(source, fields, lines, ghosts, options)


def _of_recording(
    source: RecordingData | TimeSlice,
    fields: Sequence[str],
    lines: Sequence[FieldLine],
    ghosts: Sequence[FieldLine],
    options: dict[str, Any],
) -> PlotWidget:
    whole = _whole(source)
    if isinstance(options.get("marks"), Condition):
        options = {**options, "marks": find(whole, options["marks"], None)}
    given = {
        "title": ", ".join(dict.fromkeys(field.partition(".")[0] for field in fields)),
        "states": rows_of(whole.states),
        "steps": [line.name for line in (*lines, *ghosts) if is_command(line.name)],
        "ghosts": [line.name for line in ghosts],
        **options,
        "units": {line.name: line.unit for line in (*lines, *ghosts) if line.unit} | options.get("units", {}),
    }
    widget = PlotWidget(**given)
    for name, seconds, values, _ in (*lines, *ghosts):
        widget.set_line(name, seconds, values)

    def add(field: str) -> None:
        for name, seconds, values, unit in _lines(source, field):
            widget.units = {**widget.units, **({name: unit} if unit else {})}
            widget.set_line(name, seconds, values)

    widget.offer(choices(source), add)
    return widget


def _whole(source: RecordingData | TimeSlice) -> Any:
    return source.recording if isinstance(source, TimeSlice) else source


def _lines(source: RecordingData | TimeSlice, field: str) -> list[FieldLine]:
    try:
        return field_lines(source, field, MOST_LINES)
    except TypeError as error:
        raise TypeError(f"plot(): {error}") from None


def _ghosts(
    source: RecordingData | TimeSlice, other: RecordingData, fields: Sequence[str], by: str, origin: Sequence[Any]
) -> Iterator[FieldLine]:
    """Yield the lines of another recording at its times, or at the times when this robot was at the same places."""
    name = other.path.name
    times: tuple[Floats, Floats] | None = None
    if by == "place":
        times = same_places(_whole(source), other, to_place("origin", origin), "plot(): {}; give origin=(x, y, yaw)")
    for field in fields:
        for line in _lines(other, field):
            at, values = line.seconds, line.values
            if times is not None:
                at, values = times[0], held(line.seconds, line.values, times[1])
            yield FieldLine(f"{line.name} ({name})", at, values, line.unit)


def same_places(one: RecordingData, other: RecordingData, origin: Pose, error: str) -> tuple[Floats, Floats]:
    """Return times of a recording, and the times at which the robot of another one was at the same place, or NaN.

    Raises:
        ValueError: the recordings have no places in common. ``error`` has a placeholder for the details.
        UnknownTopicError: a recording has no odometry.
    """
    here, there = places_of(one), places_of(other).seen_from(origin)
    seconds, apart = there.nearest(here)
    if not (apart <= WITHIN).any():
        wrong = f"{other.path.name} has no place within {WITHIN:g} m of one of {one.path.name}"
        where = ", the place in this one's odometry where the other starts: where the robot was switched on"
        raise ValueError(error.format(wrong) + where)
    return here.seconds, np.where(apart <= WITHIN, seconds, np.nan)


def _live(feed: Feed, fields: Sequence[str], options: dict[str, Any]) -> PlotWidget:
    """Return a plot to which each message adds its numbers."""
    known = [topic.name for topic in feed.topics]
    split = {field: topic_and_field(field, known) for field in dict.fromkeys(fields)}
    for field, (topic, inner) in split.items():
        if not inner:
            raise TypeError(f"plot(): expected a field of {topic}, like '/odom.twist.twist.linear.x', got {field!r}")
    if len(split) > MOST_LINES:
        raise ValueError(f"plot(): expected at most {MOST_LINES} lines, got {', '.join(fields)}")
    topics = list(dict.fromkeys(topic for topic, _ in split.values()))
    widget = PlotWidget(*split, **{"title": ", ".join(topics), **options})
    for topic in topics:
        feed.connect(topic, widget)
    return widget


def _per_second(unit: str) -> str:
    return {"m": "m/s", "m/s": "m/s²", "rad": "rad/s", "rad/s": "rad/s²"}.get(unit, f"{unit}/s")
