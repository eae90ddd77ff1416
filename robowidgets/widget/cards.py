"""The arrangement of cards by hand: rows and columns of names, in the form of JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

_FORM = (
    'arrangement: expected cards as a name or a row or column of them, as in {"cards": {"row": ["/scan", {"column": '
    '["/odom", "/bumper"], "width": 4}]}}'
)
_MAX_DEPTH = 20
_MAX_SIZE = {"width": 12, "height": 10_000}


def checked_cards(arrangement: Any) -> dict[str, Any]:
    """Return the cards of an arrangement in the form of the page; empty without any.

    Raises:
        TypeError, ValueError: not an arrangement; the text gives the part that is wrong.
    """
    if arrangement is None or (isinstance(arrangement, Sequence) and not isinstance(arrangement, str)):
        return {}  # a list of topics
    if not isinstance(arrangement, Mapping) or not {"topics", "cards"}.issuperset(arrangement):
        raise TypeError(
            'arrangement: expected a list of topics, or a dictionary with "topics" and "cards", as view.arrangement '
            f"returns it, got {arrangement!r}"
        )
    cards = arrangement.get("cards")
    if cards is None:
        return {}
    names: list[str] = []
    checked = _part(cards, names, 0)
    if again := [name for i, name in enumerate(names) if name in names[:i]]:
        raise ValueError(f"arrangement: {again[0]!r} has two places; name each card once")
    return {"all": checked}


def as_arrangement(cards: Mapping[str, Any], topics: Sequence[Any]) -> Any:
    """Return an arrangement: a list of topics, or a dictionary with the topics and the cards that are arranged."""
    listed = list(as_entries(topics))
    if "all" not in cards:
        return listed
    return {**({"topics": listed} if listed else {}), "cards": cards["all"]}


def as_entries(topics: Sequence[Any]) -> tuple[Any, ...]:
    """Return topics, and lists of fields, in the form of JSON."""
    return tuple(entry if isinstance(entry, str) else [*entry] for entry in topics)


def topics_of(arrangement: Any) -> Any:
    """Return the topics of an arrangement, which is a list of topics, or a dictionary with topics and cards."""
    return arrangement.get("topics", []) if isinstance(arrangement, Mapping) else arrangement


def _part(value: Any, names: list[str], depth: int) -> Any:
    """Return a checked part, and add the names of its cards."""
    if isinstance(value, str) and value:
        names.append(value)
        return value
    if not isinstance(value, Mapping):
        raise TypeError(f"{_FORM}, got {value!r}")
    if depth > _MAX_DEPTH:
        raise ValueError(f"arrangement: expected at most {_MAX_DEPTH} rows and columns within each other")
    ways = [key for key in value if key in ("card", "row", "column")]
    unknown = [key for key in value if key not in ("card", "row", "column", "width", "height")]
    if len(ways) != 1 or unknown:
        raise ValueError(f"{_FORM}, got {value!r}")
    (way,) = ways
    part: dict[str, Any] = {}
    if way == "card":
        if not isinstance(value["card"], str) or not value["card"]:
            raise TypeError(f"{_FORM}, got {value!r}")
        names.append(value["card"])
        part["card"] = value["card"]
    else:
        inner = value[way]
        if isinstance(inner, str) or not isinstance(inner, Sequence) or not inner:
            raise TypeError(f"{_FORM}, got {value!r}")
        part[way] = [_part(one, names, depth + 1) for one in inner]
    for name, most in _MAX_SIZE.items():
        size = value.get(name)
        if size is None:
            continue
        if isinstance(size, bool) or not isinstance(size, (int, float)) or not 0 < size <= most:
            unit = "twelfths of its row" if name == "width" else "pixels"
            raise ValueError(f"arrangement: expected a {name} above 0 and at most {most} ({unit}), got {size!r}")
        part[name] = size
    return part
