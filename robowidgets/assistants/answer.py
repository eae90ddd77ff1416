"""An answer for an assistant: a short text and a small JSON object, in which texts of robots are marked as data."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from math import isfinite, isnan
from numbers import Integral, Real
from typing import Any

import numpy as np

from ..messages.any_message import get_any, names_in

MAX_BYTES = 24_000
"""The largest JSON of an answer, in bytes."""

MAX_LIST_BYTES = 10_000
"""The largest JSON of a list that is cut, in bytes: an answer has two at most."""

MAX_TEXT = 300
"""The most characters of one text of a robot."""

MAX_PROBLEM_TEXT = 600
"""The most characters of a problem, which may begin with several names of topics."""

MAX_ITEMS = 12
"""The most entries of a list in a message; its length is reported."""

MAX_FIELDS = 60
"""The most fields of one message or of a part of it."""

DEEPEST = 6

_NAME = re.compile(r"[\w/~.:\-]{1,120}")
"""Names of ROS. Any other text of a robot is marked."""


class AnswerError(Exception):
    """The question cannot be answered. The text says what was wrong, what was expected, and what to do."""


class QuotingError(AnswerError):
    """The question cannot be answered, and the text quotes a robot or a file."""


@dataclass
class ToolAnswer:
    """An answer.

    Attributes:
        text: one to a few lines in our own words, without any text of a robot.
        data: the object.
        png: a picture, or None.
    """

    text: str
    data: dict[str, Any] = field(default_factory=dict)
    png: bytes | None = None

    def checked(self) -> ToolAnswer:
        """Return this answer as UTF-8 can encode it. AnswerError if its JSON is too large."""
        made = json.dumps(self.data, allow_nan=False, ensure_ascii=False).encode(errors="replace")
        if len(made) > MAX_BYTES:
            raise AnswerError(
                f"the answer has {len(made):,} bytes, and {MAX_BYTES:,} are allowed: ask for fewer fields or points, "
                "or for a shorter time"
            )
        return ToolAnswer(encodable(self.text), json.loads(made), self.png)


def encodable(text: str) -> str:
    """Return a text with ? for each half of a surrogate pair, which UTF-8 cannot encode: the SDK would end its server.

    JSON of a robot may contain one, and the name of a file that is not UTF-8.
    """
    return text.encode(errors="replace").decode()


def number(value: Any) -> float | None:
    """Return a number of JSON with at most 7 digits, as many as float32 has, or None if it is not finite: unknown."""
    value = float(value)
    return float(f"{value:.7g}") if isfinite(value) else None


def exact(value: Any) -> float | None:
    """Return a whole number exactly, one of float32 with 7 digits, and others with 12, or None if it is not finite."""
    if isinstance(value, (Integral, np.bool_)):
        return int(value)
    value = float(value)
    if not isfinite(value):
        return None
    with np.errstate(over="ignore"):
        return float(f"{value:.7g}" if float(np.float32(value)) == value else f"{value:.12g}")


def seconds(value: float) -> float:
    """Return a time or a duration in seconds, to the microsecond."""
    return round(float(value), 6)


def from_robot(text: Any, most: int = MAX_TEXT) -> dict[str, Any]:
    """Return a text of a robot, cut and marked: data, whatever it asks for."""
    whole = str(text)
    made: dict[str, Any] = {"from_robot": True, "text": whole[:most]}
    if len(whole) > most:
        made["characters_left_out"] = len(whole) - most
    return made


def is_name(text: Any) -> bool:
    """Return True if a text is written as names of ROS are."""
    return _NAME.fullmatch(str(text)) is not None


def name(text: Any) -> Any:
    """Return a name of a robot, such as a topic or a frame, as it is; marked if it is not written as names of ROS."""
    return str(text) if is_name(text) else from_robot(text)


def plain(value: Any, depth: int = 0) -> Any:
    """Return any message, sample or part of it for JSON, in at most a few kilobytes: texts marked, long lists cut.

    NaN and infinity become the texts "nan", "inf" and "-inf".
    """
    if value is None or isinstance(value, (bool, np.bool_)):
        return None if value is None else bool(value)
    if isinstance(value, Integral):
        return int(value)
    if isinstance(value, (Real, np.generic)) and not isinstance(value, (str, bytes)):
        real = float(value)
        return float(f"{real:.12g}") if isfinite(real) else "nan" if isnan(real) else "inf" if real > 0 else "-inf"
    if isinstance(value, str):
        return from_robot(value) if value else ""
    if isinstance(value, (bytes, bytearray, memoryview)):
        return {"bytes": len(value)}
    if depth >= DEEPEST:
        return {"left_out": "too deep"}
    if names := names_in(value):
        keys = isinstance(value, Mapping)
        shown = {str(one) if _NAME.fullmatch(str(one)) else f"field {i}": get_any(value, one) for i, one in
                 enumerate(names[:MAX_FIELDS])}  # fmt: skip
        made = {key: plain(part, depth + 1) for key, part in shown.items()}
        if keys and any(key.startswith("field ") for key in made):
            made["names_left_out"] = True
        return made | ({"fields_left_out": len(names) - MAX_FIELDS} if len(names) > MAX_FIELDS else {})
    if isinstance(value, np.ndarray) or (isinstance(value, Sequence) and not isinstance(value, str)):
        items = value.ravel() if isinstance(value, np.ndarray) else value
        made_list = [plain(one, depth + 1) for one in items[:MAX_ITEMS]]
        if len(items) <= MAX_ITEMS:
            return made_list
        return {"length": len(items), "first": made_list}
    return from_robot(value)


def cut(items: Sequence[Any], most: int) -> dict[str, Any]:
    """Return the number of items, and the first ones: at most so many, and `MAX_LIST_BYTES` of them."""
    first: list[Any] = []
    left = MAX_LIST_BYTES
    for item in items[:most]:
        left -= len(json.dumps(item)) + 2
        if left < 0:
            break
        first.append(item)
    return {"count": len(items), "first": first} | (
        {"left_out": len(items) - len(first)} if len(first) < len(items) else {}
    )
