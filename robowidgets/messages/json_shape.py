"""ROS definitions for messages that come as plain fields, such as JSON, derived from the messages."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from keyword import iskeyword
from math import nan
from typing import Any

from .foxglove import time_of

_MOST_DEPTH = 16
_TIMES = ({"sec", "nsec"}, {"sec", "nanosec"})
_TIME = "builtin_interfaces/Time"
_LINE = "=" * 80


class JsonShape:
    """The fields of some messages, and their types in ROS.

    Numbers are float64, and NaN if a message lacks one or has null. A field that is a number in some messages and a
    text in others is a text.

    Args:
        messages: some messages as dictionaries.
    """

    def __init__(self, messages: Iterable[Any] = ()) -> None:
        self._fields: dict[str, JsonShape] = {}
        self._is_array = False
        self._plain = ""
        """The type of the values, or empty if no value has come or the values are messages."""
        for message in messages:
            self._add_value(message, 0)

    def definition(self, package: str) -> str:
        """Return the text of the definition, with the definitions of its inner messages."""
        parts = list(self._define(package, "Message"))
        return f"\n{_LINE}\n".join([parts[0][1], *(f"MSG: {package}/{name}\n{text}" for name, text in parts[1:])])

    def fields_of(self, message: Any) -> dict[str, Any]:
        """Return the fields of a message in this shape. Raise ValueError if the value is not a message."""
        if not isinstance(message, Mapping):
            raise ValueError(f"expected fields, got {str(message)[:60]!r}")
        given = {field_name(str(name)): value for name, value in message.items()}
        return {name: shape._value(given.get(name)) for name, shape in self._fields.items()}  # noqa: SLF001

    def _add(self, value: Any, depth: int) -> None:
        if isinstance(value, (list, tuple)):
            self._is_array = True
            for item in value:
                self._add_value(item, depth)
        else:
            self._add_value(value, depth)

    def _add_value(self, value: Any, depth: int) -> None:
        if isinstance(value, Mapping):
            if set(value) in _TIMES:
                self._plain = _TIME
            elif depth < _MOST_DEPTH:
                for name, inner in value.items():
                    self._fields.setdefault(field_name(str(name)), JsonShape())._add(inner, depth + 1)  # noqa: SLF001
        elif isinstance(value, str):
            self._plain = "string"
        elif isinstance(value, bytes):
            self._plain, self._is_array = "uint8", True
        elif isinstance(value, bool):
            self._plain = self._plain or "bool"
        elif isinstance(value, (int, float)) and self._plain in ("", "bool"):
            self._plain = "float64"

    def _define(self, package: str, name: str) -> Iterator[tuple[str, str]]:
        """Yield the names and texts of the definitions of this message and its inner messages."""
        lines, inner = [], []
        for field, shape in self._fields.items():
            kind = shape._plain or "float64"  # noqa: SLF001
            if shape._fields and not shape._plain:  # noqa: SLF001
                kind = f"{name}{field.title().replace('_', '')}"
                inner.append((shape, kind))
            lines.append(f"{kind}{'[]' * shape._is_array} {field}\n")  # noqa: SLF001
        yield name, "".join(lines)
        for shape, kind in inner:
            yield from shape._define(package, kind)  # noqa: SLF001

    def _value(self, value: Any) -> Any:
        if self._plain == "uint8":
            return value or b""
        if self._is_array:
            items = value if isinstance(value, (list, tuple)) else [] if value is None else [value]
            return [self._single(item) for item in items]
        return self._single(value[0] if isinstance(value, (list, tuple)) and value else value)

    def _single(self, value: Any) -> Any:
        if self._plain == "string":
            return "" if value is None else str(value)
        if self._plain == _TIME:
            return time_of(value)
        if self._plain == "bool":
            return bool(value)
        if self._fields and not self._plain:
            return self.fields_of(value if isinstance(value, Mapping) else {})
        return float(value) if isinstance(value, (int, float)) else nan


def field_name(name: str) -> str:
    """Return a valid name of a ROS field for a name in JSON."""
    plain = re.sub(r"_+", "_", re.sub(r"[^0-9A-Za-z]", "_", name)).strip("_") or "field"
    plain = plain if plain[0].isalpha() else f"f{plain}"
    return f"{plain}_" if iskeyword(plain) else plain
