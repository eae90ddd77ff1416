"""`robowidgets.plot`: fields of a recording over time, in one call."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np

from .plot_widget import MOST_LINES, PlotWidget
from .plotting.line import Floats, slope
from .plotting.units import unit_of
from .recordings.data import RecordingData
from .recordings.time_slice import TimeSlice

_EXAMPLE = 'plot(recording, "/odom.twist.twist.linear.x")'
_NUMBERS = ("int", "uint", "float", "bool")


def plot(source: RecordingData | TimeSlice, *fields: str, derivative: bool = False, **options: Any) -> PlotWidget:
    """Fields of a recording over its time: any number of any topic, each under its name.

    Args:
        source: a recording, or a part of it: ``recording[2:5]``.
        *fields: a topic with a field, such as ``"/odom.twist.twist.linear.x"``; all numbers in it, where the field
            holds several: ``"/imu.angular_velocity"``. Up to eight numbers in all.
        derivative: whether the change per second of each is shown, too, as ``"d/dt /odom.twist.twist.linear.x"``.
        **options: keywords of `PlotWidget`. Units that they name hold instead of those of the definition.

    Raises:
        UnknownTopicError: the recording has no such topic, or its messages cannot be read.
        KeyError: the messages have no such field; the text names the nearest ones.
        TypeError: no recording, no field, or a field that is no number.
        ValueError: more than eight numbers.

    Example:
        >>> import robowidgets
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> robowidgets.plot(recording, "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x").names
        ('/odom.twist.twist.linear.x', '/cmd_vel.twist.linear.x')
    """
    if not isinstance(source, (RecordingData, TimeSlice)):
        raise TypeError(f"plot() takes a recording and fields, as {_EXAMPLE}; got {source!r}")
    if not fields:
        raise TypeError(f"plot() needs a field, as {_EXAMPLE}")
    columns = {name: column for field in fields for name, column in _columns(source, field)}
    if len(columns) * (1 + derivative) > MOST_LINES:
        raise ValueError(f"plot(): expected at most {MOST_LINES} lines, got {', '.join(columns)}")
    units = {name: unit for name, (_, _, unit) in columns.items() if unit}
    lines = {name: (seconds, values) for name, (seconds, values, _) in columns.items()}
    if derivative:
        units |= {f"d/dt {name}": _per_second(unit) for name, unit in units.items()}
        lines |= {f"d/dt {name}": (seconds, slope(seconds, values)) for name, (seconds, values) in lines.items()}
    given = options.pop("units", {})
    widget = PlotWidget(**{"title": ", ".join(dict.fromkeys(map(_short, fields))), **options, "units": units | given})
    for name, (seconds, values) in lines.items():
        widget.set_line(name, seconds, values)
    return widget


def _columns(source: RecordingData | TimeSlice, field: str) -> Iterable[tuple[str, tuple[Floats, Floats, str]]]:
    """Name, times, values and unit of each number in a field of a topic."""
    if not isinstance(field, str):
        raise TypeError(f"plot(): expected a topic with a field, like '/odom.twist.twist.linear.x', got {field!r}")
    names = sorted((topic.name for topic in source.topics), key=len, reverse=True)
    topic = next((name for name in names if field == name or field.startswith(f"{name}.")), field.partition(".")[0])
    part = source.fields(topic)
    inner = field[len(topic) + 1 :]
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


def _short(field: str) -> str:
    """The topic of a field."""
    return field.partition(".")[0]


def _per_second(unit: str) -> str:
    return {"m": "m/s", "m/s": "m/s²", "rad": "rad/s", "rad/s": "rad/s²"}.get(unit, f"{unit}/s")
