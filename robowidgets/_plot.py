"""`robowidgets.plot`: fields of a recording or of a running robot over time, in one call."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np

from .feeds.feed import Feed
from .kinds import topic_and_field
from .messages.fields import FieldOf
from .plot_widget import MOST_LINES, PlotWidget
from .plotting.line import Floats, slope
from .plotting.units import unit_of
from .recordings.data import RecordingData
from .recordings.time_slice import TimeSlice

_EXAMPLE = 'plot(recording, "/odom.twist.twist.linear.x")'
_NUMBERS = ("int", "uint", "float", "bool")


def plot(
    source: RecordingData | TimeSlice | Feed, *fields: str, derivative: bool = False, **options: Any
) -> PlotWidget:
    """Fields of a recording, or of a running robot, over time: any number of any topic, each under its name.

    Args:
        source: a recording, or a part of it: ``recording[2:5]``; or a feed, of which each message is taken from now on,
            in seconds since the first one came.
        *fields: a topic with a field, such as ``"/odom.twist.twist.linear.x"``; all numbers in it, where the field
            holds several: ``"/imu.angular_velocity"``. Up to eight numbers in all. Of a feed, each is one number, and
            the topic may appear later.
        derivative: of a recording, whether the change per second of each is shown, too, as
            ``"d/dt /odom.twist.twist.linear.x"``.
        **options: keywords of `PlotWidget`. Units that they name hold instead of those of the definition.

    Raises:
        UnknownTopicError: the recording has no such topic, or its messages cannot be read.
        KeyError: the messages have no such field; the text names the nearest ones.
        TypeError: neither a recording nor a feed, no field, or a field that is no number.
        ValueError: more than eight numbers.

    Example:
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
    if isinstance(source, Feed):
        if derivative:
            raise TypeError("plot(): derivative is for recordings; plot.update() takes what a function works out")
        return _live(source, fields, options)
    columns = {name: column for field in fields for name, column in _columns(source, field)}
    if len(columns) * (1 + derivative) > MOST_LINES:
        raise ValueError(f"plot(): expected at most {MOST_LINES} lines, got {', '.join(columns)}")
    units = {name: unit for name, (_, _, unit) in columns.items() if unit}
    lines = {name: (seconds, values) for name, (seconds, values, _) in columns.items()}
    if derivative:
        units |= {f"d/dt {name}": _per_second(unit) for name, unit in units.items()}
        lines |= {f"d/dt {name}": (seconds, slope(seconds, values)) for name, (seconds, values) in lines.items()}
    widget = _widget(fields, units, options)
    for name, (seconds, values) in lines.items():
        widget.set_line(name, seconds, values)
    return widget


def _columns(source: RecordingData | TimeSlice, field: str) -> Iterable[tuple[str, tuple[Floats, Floats, str]]]:
    """Name, times, values and unit of each number in a field of a topic."""
    topic, inner = topic_and_field(field, [one.name for one in source.topics])
    part = source.fields(topic)
    if inner:
        part = part[[inner]]
    types = part.types
    numbers = [
        name
        for name in part.names
        if types[name].startswith(_NUMBERS) and (name.endswith("]") or not types[name].endswith("]"))
    ]
    if not numbers or (not inner and len(numbers) > MOST_LINES):
        has = ", ".join(f"{topic}.{name}" for name in numbers) or ", ".join(f"{n} ({t})" for n, t in types.items())
        raise TypeError(f"plot(): {field!r} is not one number; there are {has}")
    kind = next(one.type for one in source.topics if one.name == topic)
    table = part[numbers].to_numpy()
    seconds = np.asarray(table["seconds"], np.float64)
    for name in numbers:
        values = table.get(name, table.get(f"{name}_"))
        yield f"{topic}.{name}", (seconds, np.ma.filled(np.ma.asarray(values, np.float64), np.nan), unit_of(kind, name))


def _live(feed: Feed, fields: Sequence[str], options: dict[str, Any]) -> PlotWidget:
    """A plot to which each message adds its numbers."""
    known = [topic.name for topic in feed.topics]
    paths: dict[str, dict[str, str]] = {}
    for field in fields:
        topic, inner = topic_and_field(field, known)
        if not inner:
            raise TypeError(f"plot(): expected a field of {topic}, like '/odom.twist.twist.linear.x', got {field!r}")
        paths.setdefault(topic, {})[field] = inner
    if len(set(fields)) > MOST_LINES:
        raise ValueError(f"plot(): expected at most {MOST_LINES} lines, got {', '.join(fields)}")
    units = {name: unit for inner in paths.values() for name, path in inner.items() if (unit := unit_of("", path))}
    widget = _widget(fields, units, options)
    start = _Start()
    for topic, names in paths.items():
        feed.connect(topic, _Adder(feed, widget, topic, names, start), raw=True, each=True)
    return widget


class _Start:
    """The time of the first message of any topic, in nanoseconds since the epoch."""

    time_ns: int | None = None


class _Adder:
    """Adds the numbers in each message of a topic to a plot, until that is closed."""

    def __init__(self, feed: Feed, plot: PlotWidget, topic: str, paths: dict[str, str], start: _Start) -> None:
        self._feed, self._plot, self._topic, self._start = feed, plot, topic, start
        self._fields = {name: FieldOf(path, name) for name, path in paths.items()}

    def __call__(self, message: Any, time_ns: int) -> None:
        if self._plot.comm is None:
            self._feed.disconnect(self._topic, self)
            return
        if self._start.time_ns is None:
            self._start.time_ns = time_ns
        seconds = max(0.0, (time_ns - self._start.time_ns) / 1e9)
        try:
            numbers = {name: read(message) for name, read in self._fields.items()}
        except (TypeError, ValueError) as error:
            self._plot.refuse(error, self._fields)
        else:
            self._plot.update(numbers, time=seconds)


def _widget(fields: Iterable[str], units: dict[str, str], options: dict[str, Any]) -> PlotWidget:
    """A plot with the units of its fields, and the title and units that were given."""
    title = ", ".join(dict.fromkeys(map(_short, fields)))
    return PlotWidget(**{"title": title, **options, "units": units | options.get("units", {})})


def _short(field: str) -> str:
    """The topic of a field."""
    return field.partition(".")[0]


def _per_second(unit: str) -> str:
    return {"m": "m/s", "m/s": "m/s²", "rad": "rad/s", "rad/s": "rad/s²"}.get(unit, f"{unit}/s")
