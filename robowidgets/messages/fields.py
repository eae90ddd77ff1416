"""Fields of messages, which are objects or dictionaries."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from functools import partial
from types import SimpleNamespace
from typing import Any

from ..samples.age import HasAge

MessageShape = Mapping[str, Any]
"""Field names to ``"float32"``, ``"float32[]"``, or the shape of an inner message."""

FLOATS = ("float32", "float64")
"""The floats of a `MessageShape`."""

MISSING: Any = object()

# The common class first: a check with an abstract class costs more than reading a field.
_KEYED = (dict, Mapping)


def get(message: Any, path: str, default: Any = MISSING) -> Any:
    """Return the value at a dotted path, through attributes or keys, or the default if a part is missing."""
    value = message
    for name in path.split("."):
        value = value.get(name, MISSING) if isinstance(value, _KEYED) else getattr(value, name, MISSING)
        if value is MISSING:
            return default
    return value


class ShortArrayError(ValueError):
    """The message does not have the value, because its array is too short."""


class FieldOf:
    """A reader of one field of messages, which may be a value of an array: ``covariance[7]``, ``status[0].name``.

    Args:
        path: the path of the field.
        name: its full name, for errors.
    """

    def __init__(self, path: str, name: str = "") -> None:
        self._name = name or path
        self._steps: list[str | int] = []
        for part in path.split("."):
            array, index = _INDEXED.fullmatch(part).groups()  # type: ignore[union-attr]
            self._steps += [array] if index is None else [array, int(index)]

    def __call__(self, message: Any) -> Any:
        """Return the value of the field.

        Raises:
            ShortArrayError: an array is too short. ValueError: the message does not have the field.
        """
        value, so_far = message, "the message"
        for step in self._steps:
            if isinstance(step, int):
                if not hasattr(value, "__len__"):
                    raise ValueError(f"{self._name}: {so_far!r} is not an array, but {describe(value)}")
                if step >= len(value):
                    raise ShortArrayError(f"{self._name}: no {so_far}[{step}] in the message; its arrays are shorter")
                value = value[step]
                continue
            inner = get(value, step, MISSING)
            if inner is MISSING:
                raise ValueError(f"{self._name}: no field {step!r}; {so_far} is {describe(value)}")
            value, so_far = inner, step
        return value


_INDEXED = re.compile(r"(.*?)(?:\[(\d+)\])?")


def as_object(message: Any) -> Any:
    """Return an object with the keys of a dictionary as attributes, also for inner dictionaries."""
    if isinstance(message, _KEYED):
        return SimpleNamespace(**{name: as_object(value) for name, value in message.items()})
    return message


def reader(message: Any) -> Callable[[str, Any], Any]:
    """Return a function of a name and a default that reads a field of this message, much faster than `get`."""
    return message.get if isinstance(message, _KEYED) else partial(getattr, message)


def has(message: Any, *names: str) -> bool:
    """Return True if a message has all these fields."""
    return all(get(message, name) is not MISSING for name in names)


def unwrap(message: Any) -> Any:
    """Return the message in a rosbridge envelope (``{"op": "publish", "msg": ...}``), or the sample in a moment."""
    if isinstance(message, _KEYED) and message.get("op") == "publish" and "msg" in message:
        return message["msg"]
    sample = getattr(message, "sample", None)
    return sample if isinstance(sample, HasAge) else message


def stamp_ns(message: Any) -> int | None:
    """Return the stamp of a message in nanoseconds, or None if it is missing, never set (0) or out of range.

    The fields are ``secs`` and ``nsecs`` in rospy, and ``sec`` and ``nanosec`` in ROS 2 and rosbags.
    """
    stamp = get(message, "header.stamp", None)
    if stamp is None:
        return None
    seconds = get(stamp, "sec", get(stamp, "secs", 0))
    nanoseconds = get(stamp, "nanosec", get(stamp, "nsecs", 0))
    try:
        stamp = int(seconds) * 1_000_000_000 + int(nanoseconds)
    except (TypeError, ValueError, OverflowError):
        return None
    return stamp if 0 < stamp < 2**63 else None


def frame_id(message: Any) -> str:
    """Return ``header.frame_id``, or an empty text."""
    return str(get(message, "header.frame_id", ""))


def type_name(message: Any) -> str:
    """Return the short name of the message type (``sensor_msgs/LaserScan``), or the Python type."""
    name = getattr(message, "__msgtype__", None) or getattr(message, "_type", None)
    if isinstance(name, str):
        return name.replace("/msg/", "/")
    module = type(message).__module__.split(".")
    if "msg" in module:
        return f"{module[0]}/{type(message).__name__}"
    return type(message).__name__


def describe(message: Any) -> str:
    """Return a short description of a message for an error: its type and its fields."""
    if isinstance(message, Mapping):
        return f"a dict with the keys {_listed([str(k) for k in message])}"
    fields = getattr(message, "__slots__", None) or getattr(message, "__dict__", {})
    names = [str(f).lstrip("_") for f in fields if not str(f).startswith("__")]
    about = type_name(message)
    return f"a {about} with the fields {_listed(names)}" if names else f"a {about}: {str(message)[:60]!r}"


def _listed(names: list[str]) -> str:
    return ", ".join(names[:8]) + (", …" if len(names) > 8 else "") if names else "(none)"
