"""Ready-made conditions for `Recording.find` and for `watch` of a widget, joined by ``&``, ``|`` and ``~``.

`Recording.find` computes a condition for whole columns; `Condition.judge` applies the same test to one sample. The last
scan or speed before a silence is stale one usual step after its time; a silence is a pause of more than 2 s and more
than two usual steps. The state of a touch sensor lasts until its next message.

A new condition is a function here, and a class in a module next to it: in `_samples` if it judges the last sample of
one topic, else in its own module. A comparison of one field of a message needs neither: `field` makes it.

Examples:
    >>> from robowidgets import conditions
    >>> recording.find(conditions.touched() & conditions.nearest_below(0.3))  # doctest: +SKIP
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ...behaviors.version import RATE
from ...samples.sector import ALL_ROUND, SectorLike
from ._events import EventCondition
from ._fields import Field as Field
from ._gaps import GapCondition
from ._labels import LabelCondition
from ._samples import NearestCondition, SpeedCondition, TouchedCondition
from ._stops import StopsCondition
from .base import Condition, FunctionCondition

__all__ = ["Condition", "event", "field", "gap", "label", "nearest_below", "speed_above", "stops", "touched", "when"]


def touched(label: str | None = None, topic: str | None = None) -> Condition:
    """Return the condition that a touch sensor is touched.

    Args:
        label: the name of the sensor, or None for any.
        topic: as in `Recording.touches`.
    """
    return TouchedCondition(label, topic)


def nearest_below(distance: float, sector: SectorLike = ALL_ROUND, topic: str | None = None) -> Condition:
    """Return the condition that `Scan.distance` is below a distance. It is unknown if the distance is NaN.

    Args:
        distance: metres.
        sector: as in `Scan.distance`.
        topic: as in `Recording.scans`.

    Raises:
        TypeError: an argument is not a number.
        ValueError: the distance is not above 0, the sector does not exist, or an angle is beyond a full turn, infinite
            or NaN.
    """
    return NearestCondition(distance, sector, topic)


def speed_above(limit: float, axis: str = "linear.x", topic: str | None = None) -> Condition:
    """Return the condition that a speed is past a limit, in either direction.

    Args:
        limit: m/s or rad/s, 0 or more.
        axis: one of `robowidgets.samples.AXES`: linear.x (forward) to angular.z (yaw).
        topic: as in `Recording.speeds`.

    Raises:
        TypeError: the limit is not a number.
        ValueError: the limit is below 0 or NaN, or the axis does not exist.
    """
    return SpeedCondition(limit, axis, topic)


def gap(seconds: float, topic: str | None = None) -> Condition:
    """Return the condition that no sample came for longer than some time, up to the next sample or the end.

    Each silence is a separate span, even if only one sample lies between two of them.

    Args:
        seconds: the length of the gap, above 0.
        topic: a topic, or None for any topic of scans, measured speeds or sonars. Touch sensors and commands may be
            silent for long.

    Raises:
        TypeError: ``seconds`` is not a number.
        ValueError: the number is not above 0.
        UnknownTopicError: raised by `Recording.find` if no topic is named, and the recording has no topic with such
            samples.
    """
    return GapCondition(seconds, topic)


def event(topic: str | None = None, level: str | int | None = None, text: str | None = None) -> Condition:
    """Return the condition that an event happened, such as a log line or a pressed button; see `Recording.events`.

    It is true only at that moment, so each event is a span of 0 seconds. Joined with ``&``, it selects the events
    during which another condition is true. A watch of an `EventsWidget` judges it on the newest event.

    Args:
        topic: the topic of the event, or None for any topic with events.
        level: the lowest level: ``"DEBUG"``, ``"INFO"``, ``"WARN"``, ``"ERROR"`` or ``"FATAL"``, or None for any.
        text: a text to find in its text or its source, in any case, or None for any.

    Raises:
        TypeError, ValueError: an argument is not a name, a level or a text.

    Examples:
        >>> from robowidgets import conditions
        >>> print(conditions.event("/rosout", level="WARN", text="lost"))
        WARN or more with 'lost' on /rosout
    """
    return EventCondition(topic, level, text)


def field(name: str) -> Field:
    """Return a field of the messages of any topic, to be compared: ``field("/imu.linear_acceleration.x") > 12``.

    `Recording.find` and `Feed.watch` judge it. The condition is unknown for NaN, if an array is too short, and before
    the first message. For a topic that sends steadily, such as a sensor, it is also unknown during a silence. For any
    other topic, a value holds until the next message.

    Args:
        name: the topic with a field of its definition, such as ``"/odom.twist.twist.linear.x"`` or
            ``"/diagnostics.status[0].name"``. It is a number, a flag or a text.

    Raises:
        TypeError: ``name`` is not a text. ValueError: it names no field. Judging the condition raises UnknownTopicError
            and UnknownFieldError, which name the nearest ones, and TypeError if the field is not a number, a flag or a
            text.

    Examples:
        >>> import robowidgets
        >>> from robowidgets import conditions
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> found = recording.find(conditions.field("/odom.twist.twist.linear.x") < 0)
        >>> found.condition
        '/odom.twist.twist.linear.x < 0'
    """
    return Field(name)


def stops(program: Any, rate: float = RATE) -> Condition:
    """Return the condition that a program tells the robot to stop, given recorded samples.

    ``stops(new) & ~stops(old)`` finds the differences of two programs. The program is stepped through the recording
    from its beginning. The recorded drive does not change, whatever the program does: each result is the program's
    decision at that moment of that drive. The condition is unknown, and the program is not called, until all of its
    samples have come, and while one of them is too old to drive by.

    Args:
        program: a function or a state machine, as for `robowidgets.feeds.Feed.program`, or the result of that method.
        rate: steps per second.

    Raises:
        TypeError, ValueError: as `program` of a feed.

    Example:
        >>> import robowidgets
        >>> from robowidgets import conditions
        >>> from robowidgets.behaviors import Drive
        >>> def careful(scan):
        ...     return Drive(0.0 if scan.distance("front") < 0.5 else 0.2)
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> recording.find(conditions.stops(careful)).condition
        'careful stops'
    """
    return StopsCondition(program, rate)


def label(name: str | None = None) -> Condition:
    """Return the condition that a span has a label, set with `Recording.label` or on a contact sheet.

    Args:
        name: the name of the label, or None for any.

    Raises:
        TypeError, ValueError: ``name`` is not a name.
    """
    return LabelCondition(name)


def when(function: Callable[[Any], Any]) -> Condition:
    """Return the condition that a function of one moment is true; see `Recording.find`."""
    return FunctionCondition(function)
