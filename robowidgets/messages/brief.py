"""One short line of text for any message."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sized
from dataclasses import fields, is_dataclass
from itertools import islice
from math import isfinite, isnan
from numbers import Integral, Real
from typing import Any

import numpy as np

from ..samples import Range, Scan, Speed, Touch
from .byte_fields import byte

MOST = 60
"""The most characters of a line."""

_FEW = 4
"""The longest array whose numbers are all shown."""

_LEVELS = ("OK", "WARN", "ERROR", "STALE")
"""The levels of a ``diagnostic_msgs/DiagnosticStatus``."""

_DEEPEST = 6
_SKIPPED = frozenset({"header", "stamp", "child_frame_id"})
_TIME = ({"sec", "nanosec"}, {"secs", "nsecs"})
MINUS = "\N{MINUS SIGN}"


def brief(value: Any) -> str:
    """Return a line of at most 60 characters for any sample or message: ``linear.x 0.2, angular.z −0.5``.

    Numbers that are 0 come last, stamps and frames are left out, and long arrays are shown by their length.
    """
    if isinstance(value, Scan):
        near = value.nearest()
        return (
            f"nearest {number(near.range)} m" if near else "no reading"
        ) + f", {len(value):,} ray{'' if len(value) == 1 else 's'}"
    if isinstance(value, Speed):
        x, y, yaw = value.linear[0], value.linear[1], value.angular[2]
        axes = {"m/s": x, **({"m/s left": y} if y else {}), "rad/s": yaw}
        return ", ".join(f"{number(one)} {unit}" for unit, one in axes.items() if not isnan(one)) or "nothing measured"
    if isinstance(value, Range):
        return f"{number(value.distance)} m"
    if isinstance(value, Touch):
        return ", ".join(name for name, touched in value.touched.items() if touched)[:MOST] or "nothing touched"
    if value is None or isinstance(value, (str, Real, np.generic)) or _is_array(value):
        return _cut(_leaf(value))
    if words := _in_words(dict(_items(value))):
        return _cut(words)
    leaves = list(_leaves(value, ""))
    if not leaves:
        return _cut(" ".join(repr(value).split()))
    texts = [(name, _leaf(leaf)) for name, leaf in leaves]
    texts.sort(key=lambda one: one[1] in ("0", "false", '""', "[0]"))
    if len(texts) == 1:
        return _cut(texts[0][1])
    text = ""
    for name, leaf in texts:
        more = f"{text}, {name} {leaf}" if text else f"{name} {leaf}"
        if len(more) > MOST - 3:
            return f"{text}, \N{HORIZONTAL ELLIPSIS}" if text else _cut(more)
        text = more
    return text


def _in_words(fields: Mapping[str, Any]) -> str:
    """Return a text for a message whose first numbers are not informative, or an empty text for any other.

    Values are checked because other types may have fields of the same names.
    """
    names = fields.keys()
    width, height = fields.get("width"), fields.get("height")
    if isinstance(width, Integral) and isinstance(height, Integral):
        if "encoding" in names:
            return f"{_size(fields)} {fields['encoding']}"
        if "distortion_model" in names:
            return _size(fields)
        if "point_step" in names:
            return f"{int(width) * int(height):,} points"
    if {"info", "data"} <= names and {"width", "height", "resolution"} <= (info := dict(_items(fields["info"]))).keys():
        return f"{_size(info)} cells"
    if {"name", "position", "velocity", "effort"} == names - _SKIPPED and _is_array(fields["name"]):
        return _counted(fields["name"], "joint")
    if {"poses"} == names - _SKIPPED and _is_array(fields["poses"]):
        return _counted(fields["poses"], "pose")
    if {"level", "name", "msg"} <= names:
        return _leaf(str(fields["msg"]))
    if {"level", "name", "message", "hardware_id"} <= names and (level := _level(fields)) is not None:
        return f"{fields['name']}: {_level_name(level)} {fields['message']}".strip()
    if "status" in names and _is_array(fields["status"]):
        those = [dict(_items(one)) for one in fields["status"]]
        levels = [level for one in those if (level := _level(one)) is not None]
        if those and len(levels) == len(those):
            worst = those[levels.index(max(levels))]
            return f"{_level_name(max(levels))}: {worst.get('name', '')} {worst.get('message', '')}, of {len(those)}"
    if "transforms" in names and _is_array(fields["transforms"]):
        return _counted(fields["transforms"], "frame")
    return ""


def _size(fields: Mapping[str, Any]) -> str:
    return f"{fields['width']}\N{MULTIPLICATION SIGN}{fields['height']}"


def _counted(values: Sized, noun: str) -> str:
    return f"{len(values):,} {noun}{'' if len(values) == 1 else 's'}"


def _level(status: Mapping[str, Any]) -> int | None:
    """Return the level of a status, a number or a byte in ROS 1 and 2, or None without a valid level."""
    level = status.get("level")
    try:
        return byte("level", level) if isinstance(level, (Integral, bytes, str)) else None
    except ValueError:
        return None


def _level_name(level: int) -> str:
    return _LEVELS[level] if 0 <= level < len(_LEVELS) else f"level {level}"


def number(value: Any) -> str:
    """Return a number with at most three decimals, or in powers of ten if these would hide it."""
    real = float(value)
    if not isfinite(real):
        return "NaN" if real != real else f"{'' if real > 0 else MINUS}inf"
    text = f"{real:.3f}".rstrip("0").rstrip(".") if 0.001 <= abs(real) < 1e6 or real == 0 else f"{real:.3g}"
    return ("0" if text in ("-0", "") else text).replace("-", MINUS)


def _leaf(value: Any) -> str:
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (bytes, bytearray)):
        return f"[{len(value):,}]"
    if isinstance(value, str):
        return '"' + " ".join(value[: MOST + 1].split()) + '"'
    if isinstance(value, Real):
        return number(value)
    if _is_array(value):
        items = list(islice(value, _FEW + 1))
        if items and len(items) <= _FEW and all(isinstance(item, Real) for item in items):
            return f"[{', '.join(map(_leaf, items))}]"
        return f"[{len(value):,}]"
    return _cut(" ".join(repr(value)[:MOST].split()))


def _leaves(message: Any, prefix: str, depth: int = 0) -> Iterator[tuple[str, Any]]:
    """Yield the fields of a message that are not messages, with their paths."""
    for name, value in _items(message):
        path = f"{prefix}{name}"
        if name in _SKIPPED:
            continue
        if depth < _DEEPEST and not _is_array(value) and (inner := dict(_items(value))):
            if inner.keys() not in _TIME:
                yield from _leaves(value, f"{path}.", depth + 1)
        else:
            yield path, value


def _items(message: Any) -> Iterator[tuple[str, Any]]:
    """Yield the names and values of the fields of any message, and nothing for other values."""
    if isinstance(message, Mapping):
        yield from ((str(name), value) for name, value in message.items())
    elif is_dataclass(message) and not isinstance(message, type):
        for field in fields(message):
            if not field.name.startswith("_"):
                yield field.name, getattr(message, field.name)
    elif hasattr(type(message), "__slots__") and not isinstance(message, (str, bytes, Real, tuple, np.ndarray)):
        for slot in type(message).__slots__:
            name = slot.lstrip("_")  # rclpy has properties on slots with an underscore
            if name != "check_fields" and hasattr(message, name):
                yield name, getattr(message, name)


def _is_array(value: Any) -> bool:
    return hasattr(value, "__len__") and hasattr(value, "__getitem__") and not isinstance(value, (str, Mapping))


def _cut(text: str) -> str:
    return text if len(text) <= MOST else text[: MOST - 1] + "\N{HORIZONTAL ELLIPSIS}"
