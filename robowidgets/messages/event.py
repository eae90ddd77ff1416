"""Conversion of messages to events."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import atan2, degrees
from typing import Any, NamedTuple

import numpy as np

from ..samples import TouchState
from ..samples.event import Event, Level
from ..samples.touch_tracker import TouchTracker
from .byte_fields import byte, byte_array
from .camera_info import to_camera_info
from .fields import describe, get, has, stamp_ns, unwrap
from .touch import TOUCH_TYPES, to_touch

TEXT_TYPE = "std_msgs/msg/String"

Timed = tuple[int, Event]
"""An event with its time in nanoseconds."""

_ROS2_LINE, _ROS1_LINE = "rcl_interfaces/msg/Log", "rosgraph_msgs/msg/Log"
_ROS2_LEVEL_AT = 12
"""Offset of the level, after the header of CDR and the stamp."""
_ROS1_FRAME_AT = 16
"""Offset of the frame's name in the header, after a number, a stamp, and its length. The level follows the name."""
_ROS1_LEVELS = {1: Level.DEBUG, 2: Level.INFO, 4: Level.WARN, 8: Level.ERROR, 16: Level.FATAL}
_STATUS_LEVELS = {0: Level.INFO, 1: Level.WARN, 2: Level.ERROR, 3: Level.WARN}
_STATUS_WORDS = {0: "OK", 3: "stale"}

_GOAL_STATES = (*("unknown", "accepted", "executing", "canceling", "succeeded", "canceled", "aborted"),)
_ROS1_GOAL_STATES = (
    *("pending", "active", "preempted", "succeeded", "aborted", "rejected", "preempting", "recalling", "recalled"),
    "lost",
)
_GOAL_LEVELS = {"aborted": Level.ERROR, "rejected": Level.ERROR, "lost": Level.ERROR, "canceled": Level.WARN}
_GOAL_LEVELS |= {"preempted": Level.WARN, "recalled": Level.WARN}

_PARAMETER_VALUES = (
    *("", "bool_value", "integer_value", "double_value", "string_value", "byte_array_value"),
    *("bool_array_value", "integer_array_value", "double_array_value", "string_array_value"),
)
"""The fields of a rcl_interfaces/ParameterValue, by its type."""

_RANGE = "sensor_msgs/msg/Range"
"""Only some of these are touch sensors, and a distance is not an event."""


def _with(*names: str, of: type = object) -> Callable[[Any], bool]:
    """Return a function that returns True if a message has fields, the first with a value of a type."""
    return lambda message: has(message, *names) and isinstance(get(message, names[0]), of)


class _EventForm(NamedTuple):
    """Message types, and a function that returns True if a message is one of them, by its fields."""

    types: tuple[str, ...]
    fits: Callable[[Any], bool]


_LINE = _EventForm((_ROS2_LINE, _ROS1_LINE), _with("msg", "level", "name"))
_STATUSES = _EventForm(("diagnostic_msgs/msg/DiagnosticArray",), _with("status", of=Sequence))
_STATUS = _EventForm(("diagnostic_msgs/msg/DiagnosticStatus",), _with("message", "level", "name"))
_JOY = _EventForm(("sensor_msgs/msg/Joy",), _with("buttons", "axes"))
_TEXT = _EventForm((TEXT_TYPE,), _with("data", of=str))
_PARAMETERS = _EventForm(("rcl_interfaces/msg/ParameterEvent",), _with("changed_parameters", "new_parameters", "node"))
_GOALS = _EventForm(("action_msgs/msg/GoalStatusArray", "actionlib_msgs/msg/GoalStatusArray"), _with("status_list"))
_CAMERA = _EventForm(("sensor_msgs/msg/CameraInfo",), _with("distortion_model", "width", "height"))
_FORMS = (_LINE, _STATUSES, _STATUS, _JOY, _TEXT, _PARAMETERS, _GOALS, _CAMERA)

LOG_TYPES = frozenset(_LINE.types)
"""The message types of log lines."""

SEVERE_TYPES = LOG_TYPES | frozenset(_STATUSES.types + _STATUS.types + _GOALS.types)
"""The message types whose events have a level."""

SAID_TYPES: frozenset[str] = frozenset(name for form in _FORMS for name in form.types)
"""The message types that an `EventReader` reads, without touches."""

REPEATED_TYPES = frozenset(_CAMERA.types)
"""Types in `SAID_TYPES` that repeat the same content at the rate of a sensor: they are read only on request."""

EVENT_TYPES: frozenset[str] = SAID_TYPES | (TOUCH_TYPES - {_RANGE})
"""All message types that an `EventReader` reads, as recordings name them."""


class EventReader:
    """A reader of the events in the messages of one topic, in their order.

    For a status, a goal, a calibration, a button or a touch sensor only a change is an event, so the reader keeps the
    previous value.

    Args:
        topic: the name of the topic, for its events.
    """

    def __init__(self, topic: str = "") -> None:
        self._topic = topic
        self._reads: dict[_EventForm, Callable[[Any], list[Event]]] = {
            _LINE: self._line,
            _STATUSES: self._diagnostics,
            _STATUS: self._status,
            _JOY: self._joy,
            _TEXT: self._text,
            _PARAMETERS: self._parameters,
            _GOALS: self._goals,
            _CAMERA: self._camera,
        }
        self._goal_states: dict[str, str] = {}
        self._calibration = ""
        self._statuses: dict[str, tuple[Level, str]] = {}
        self._buttons: dict[int, bool] = {}
        self._tracker = TouchTracker()
        self._seen_ns = 0
        """The time up to which changes of touches were reported."""
        self._touched: dict[str, TouchState] = {}

    def read(self, message: Any, time_ns: int = 0) -> list[Timed]:
        """Return the events in a message with their times, or an empty list if nothing changed.

        A touch that a message no longer lists ended before the message.

        Args:
            message: an object or dictionary like std_msgs/String, rcl_interfaces/Log or rosgraph_msgs/Log,
                diagnostic_msgs/DiagnosticArray or DiagnosticStatus, sensor_msgs/Joy or CameraInfo,
                rcl_interfaces/ParameterEvent, action_msgs/GoalStatusArray, or a message for `to_touch`; text; or an
                `Event`.
            time_ns: the time of the message, in nanoseconds of any clock that does not go back.

        Raises:
            TypeError: the message has another type; the text says what came and what was expected.
            ValueError: a field is not a number.
        """
        message = unwrap(message)
        if isinstance(message, Event):
            return [(time_ns, message)]
        if isinstance(message, str):
            return [(time_ns, Event(message, topic=self._topic))]
        form = next((one for one in _FORMS if one.fits(message)), None)
        if form is not None:
            return [(time_ns, event) for event in self._reads[form](message)]
        try:
            touch = to_touch(message)
        except TypeError:
            known = ", ".join(one.types[0].replace("/msg/", "/") for one in _FORMS)
            raise TypeError(
                f"expected text, a message like one of {known}, or one of touch sensors; got {describe(message)}"
            ) from None
        found = self.due(time_ns)
        self._tracker.apply(touch, time_ns)
        return [*found, *self._touch_changes(time_ns, touch.stamp_ns)]

    def due(self, until_ns: float) -> list[Timed]:
        """Return the ends of touches before a time, which no message reports."""
        found: list[Timed] = []
        while (at := self.next_due_ns) is not None and at < until_ns:
            found += self._touch_changes(at, None)
        return found

    @property
    def next_due_ns(self) -> int | None:
        """The time of the next end of a touch without further messages, or None if no touch ends."""
        return self._tracker.next_change_ns(self._seen_ns)

    def _text(self, message: Any) -> list[Event]:
        return [Event(get(message, "data"), topic=self._topic)]

    def _line(self, message: Any) -> list[Event]:
        level, stamp = get(message, "level"), stamp_ns(message)
        # Messages of ROS 1 have the topics of the node, and a header; their levels are bits.
        if has(message, "topics"):
            found = _ROS1_LEVELS.get(byte("level", level), Level.INFO)
        else:
            found = Level.at_most(byte("level", level))
            stamp = stamp_ns({"header": {"stamp": get(message, "stamp", None)}})
        return [Event(str(get(message, "msg")), found, str(get(message, "name")), self._topic, stamp)]

    def _diagnostics(self, message: Any) -> list[Event]:
        stamp = stamp_ns(message)
        found: list[Event] = []
        for status in get(message, "status"):
            found += self._status(status, stamp)
        return found

    def _status(self, status: Any, stamp: int | None = None) -> list[Event]:
        name, code = str(get(status, "name")), byte("level", get(status, "level"))
        inner = str(get(status, "message"))
        level = _STATUS_LEVELS.get(code, Level.ERROR)
        word = _STATUS_WORDS.get(code, "")
        prefix = word if word.lower() != inner.lower() else ""
        text = ": ".join(filter(None, (prefix, inner))) or word or f"level {code}"
        if self._statuses.get(name) == (level, text):
            return []
        self._statuses[name] = level, text
        return [Event(text, level, name, self._topic, stamp)]

    def _joy(self, message: Any) -> list[Event]:
        stamp, found = stamp_ns(message), []
        for index, value in enumerate(get(message, "buttons")):
            pressed = bool(value)
            if self._buttons.get(index, False) != pressed:
                found.append(
                    Event(f"button {index} {'pressed' if pressed else 'released'}", topic=self._topic, stamp_ns=stamp)
                )
            self._buttons[index] = pressed
        return found

    def _parameters(self, message: Any) -> list[Event]:
        node, stamp = str(get(message, "node")), stamp_ns({"header": {"stamp": get(message, "stamp", None)}})
        texts = []
        # A node declares all its parameters when it starts.
        if declared := [_parameter(one) for one in get(message, "new_parameters")]:
            texts.append(f"declared {', '.join(declared)}")
        texts += [_parameter(one) for one in get(message, "changed_parameters")]
        if deleted := [str(get(one, "name")) for one in get(message, "deleted_parameters", ())]:
            texts.append(f"deleted {', '.join(deleted)}")
        return [Event(text, source=node, topic=self._topic, stamp_ns=stamp) for text in texts]

    def _goals(self, message: Any) -> list[Event]:
        found, now = [], {}
        for one in get(message, "status_list"):
            is_ros1 = has(one, "goal_id")
            states = _ROS1_GOAL_STATES if is_ros1 else _GOAL_STATES
            number = byte("status", get(one, "status"))
            state = states[number] if 0 <= number < len(states) else f"status {number}"
            goal = str(get(one, "goal_id.id")) if is_ros1 else _short_uuid(get(one, "goal_info.goal_id.uuid"))
            now[goal] = state
            if self._goal_states.get(goal) != state:
                more = str(get(one, "text", "") or "")
                text = ": ".join(filter(None, (f"goal {goal} {state}", more)))
                found.append(Event(text, _GOAL_LEVELS.get(state, Level.INFO), topic=self._topic))
        self._goal_states = now
        return found

    def _camera(self, message: Any) -> list[Event]:
        info = to_camera_info(message)
        parts = [f"{info.width} × {info.height} pixels"]
        if info.is_calibrated:
            # Drivers that only rectify set only the second matrix.
            across, down = (info.k[0], info.k[4]) if info.k[0] > 0 else (info.p[0], info.p[5])
            angles = (round(degrees(2 * atan2(n, 2 * f))) for n, f in ((info.width, across), (info.height, down)))
            parts.append("sees {}° × {}°".format(*angles))
            parts.append(info.distortion_model or "no distortion model")
        else:
            parts.append("not calibrated")
        numbers = [*info.k.tolist(), *info.d.tolist(), *info.p.tolist()]
        text, whole = ", ".join(parts), f"{parts} {numbers}"
        if whole == self._calibration:
            return []
        self._calibration = whole
        return [Event(text, source=info.frame_id, topic=self._topic, stamp_ns=info.stamp_ns)]

    def _touch_changes(self, time_ns: int, stamp: int | None) -> list[Timed]:
        self._seen_ns = time_ns
        found = []
        for sensor, one in self._tracker.states(time_ns).items():
            before = self._touched.get(sensor, TouchState.UNKNOWN)
            self._touched[sensor] = one.state
            # A sensor that was never touched is not an event.
            is_news = one.state is TouchState.TOUCHED or (one.state is TouchState.FREE and before)
            if is_news and one.state is not before:
                found.append((time_ns, Event(touch_text(sensor, one.state), topic=self._topic, stamp_ns=stamp)))
        return found


def line_level(type_name: str, encoding: str, raw: bytes) -> Level:
    """Return the level of a log line from its bytes without decoding it, or FATAL if the level is unknown.

    Args:
        type_name: one of `LOG_TYPES`.
        encoding: ``cdr`` or ``ros1``.
        raw: the message.
    """
    if (type_name, encoding) == (_ROS2_LINE, "cdr") and len(raw) > _ROS2_LEVEL_AT:
        return Level.at_most(raw[_ROS2_LEVEL_AT])
    if (type_name, encoding) == (_ROS1_LINE, "ros1"):
        at = _ROS1_FRAME_AT + int.from_bytes(raw[_ROS1_FRAME_AT - 4 : _ROS1_FRAME_AT], "little")
        if len(raw) > at:
            return _ROS1_LEVELS.get(raw[at], Level.INFO)
    return Level.FATAL


def touch_text(sensor: str, state: TouchState) -> str:
    """Return the text of an event of a sensor that was touched or released."""
    words = "touched" if state is TouchState.TOUCHED else "released"
    return words if sensor == "touch" else f"{sensor} {words}"


def _parameter(one: Any) -> str:
    """Return the name and the value of a rcl_interfaces/Parameter: ``max_speed = 0.3``."""
    kind = byte("type", get(one, "value.type"))
    if not 0 < kind < len(_PARAMETER_VALUES):
        return f"{get(one, 'name')} is not set"
    value = get(one, f"value.{_PARAMETER_VALUES[kind]}")
    value = value if isinstance(value, (str, bool, int, float)) else np.asarray(value).tolist()
    return f"{get(one, 'name')} = {value}"


def _short_uuid(value: Any) -> str:
    """Return the first digits of the UUID of a goal, as the tools of ROS 2 print it."""
    return byte_array("uuid", value).tobytes().hex()[:8]
