"""Names and values of any message: of rosbags, rclpy, rospy or rosbridge, a dataclass or a dict."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields, is_dataclass
from difflib import get_close_matches
from functools import lru_cache
from typing import Any

from .fields import MISSING, FieldOf, ShortArrayError, describe

_NEAREST = 3
_CLASSES = 512
_SHORT = 100
_LISTED = 30
_SCALARS = (str, bytes, bytearray, memoryview, bool, int, float, complex)
_TIMES = (("sec", "nanosec"), ("secs", "nsecs"))


def names_in(value: Any) -> tuple[str, ...]:
    """Return the names of the fields of a message, in order, or an empty tuple if the value is not a message."""
    if isinstance(value, Mapping):
        return tuple(map(str, value))
    if value is None or isinstance(value, _SCALARS) or hasattr(value, "__array__"):
        return ()
    kind: Any = type(value)
    named = _get_names(kind)
    return tuple(name for name in vars(value) if not name.startswith("_")) if named is None else named


@lru_cache(_CLASSES)
def _get_names(kind: Any) -> tuple[str, ...] | None:
    """Return the names of the fields of a class of messages, or None if they differ from object to object."""
    if hasattr(kind, "_fields"):  # a named tuple
        named: Iterable[str] = kind._fields
    elif issubclass(kind, (Sequence, set, frozenset, type)):
        return ()
    elif callable(getattr(kind, "get_fields_and_field_types", None)):  # rclpy
        named = kind.get_fields_and_field_types()
    elif is_dataclass(kind):
        named = [field.name for field in fields(kind)]
    elif hasattr(kind, "__slots__"):
        named = [kind.__slots__] if isinstance(kind.__slots__, str) else kind.__slots__
    else:
        return None if "__dict__" in dir(kind) and kind.__module__ != "builtins" else ()
    return tuple(name for name in named if not name.startswith("_"))


def get_any(value: Any, name: str) -> Any:
    """Return the value of a field, or MISSING. The key of a dict may contain dots."""
    if isinstance(value, Mapping):
        return value.get(name, MISSING)
    return getattr(value, name, MISSING)


def time_in(value: Any) -> tuple[int, int] | None:
    """Return the seconds and nanoseconds of a time or a duration, or None for another value."""
    names = names_in(value)
    if len(names) == 2 and names in _TIMES:
        parts = [get_any(value, name) for name in names]
        if all(isinstance(part, int) and not isinstance(part, bool) for part in parts):
            return parts[0], parts[1]
    return None


def value_at(message: Any, path: str) -> Any:
    """Return the value of a field by its path: ``pose.pose.position.x``, ``transforms[0].header.frame_id``.

    Raises:
        ValueError: the message does not have the field; the text has the nearest names, and all names.
    """
    try:
        return FieldOf(path)(message)
    except ShortArrayError:
        raise
    except ValueError:
        raise ValueError(_no_field(message, path)) from None


def why_no_value(message: Any, path: str) -> str:
    """Return the reason why a message has no field of this path, or an empty text if it has one."""
    try:
        value_at(message, path)
    except ValueError as error:
        return str(error)
    return ""


def _no_field(message: Any, path: str) -> str:
    value, done = _deepest(message, path)
    there = [f"{done}.{name}" if done else name for name in paths_in(value, 3)]
    last = path.rpartition(".")[2]
    same = [one for one in paths_in(message, 5) if one.rpartition(".")[2] == last]
    near = get_close_matches(path[:_SHORT], [*there, *same], _NEAREST) or same[:_NEAREST]
    names = names_in(value)
    more = f" and {len(names) - _LISTED:,} more" if len(names) > _LISTED else ""
    has = f"{done or 'the message'} has {', '.join(names[:_LISTED])}{more}" if names else f"{done} is {describe(value)}"
    hint = f"did you mean {' or '.join(map(repr, near))}? There, {has}" if near else has
    return f"no field {path[:_SHORT]!r}; {hint}"


def _deepest(message: Any, path: str) -> tuple[Any, str]:
    """Return the value at the longest part of a path that a message has, and that part."""
    parts = path.split(".")
    for count in range(len(parts) - 1, 0, -1):
        done = ".".join(parts[:count])
        try:
            return FieldOf(done)(message), done
        except ValueError:
            continue
    return message, ""


def paths_in(value: Any, depth: int) -> Iterable[str]:
    """Yield the paths of the fields in a message and in its inner messages up to a depth, outer fields first."""
    level: list[tuple[str, Any]] = [("", value)]
    for _ in range(depth):
        deeper: list[tuple[str, Any]] = []
        for prefix, one in level:
            for name in names_in(one):
                yield f"{prefix}{name}"
                deeper.append((f"{prefix}{name}.", get_any(one, name)))
        level = deeper[: 10 * _SHORT]
