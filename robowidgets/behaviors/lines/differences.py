"""The first line with another value in the same step of two versions."""

from __future__ import annotations

from difflib import SequenceMatcher

from .shown import LineValues, lines_of
from .watch import WatchedStep


def first_difference(old: WatchedStep, new: WatchedStep) -> tuple[int | None, str, str]:
    """Return the first line of the new version with a different value, and both values."""
    for before, after in zip(old.calls, new.calls, strict=False):
        values = [{line.number: line for line in lines_of(call)} for call in (before, after)]
        one, other = ([text.strip() for text in call.source.texts] for call in (before, after))
        same: dict[int, int] = {}
        for tag, a, b, c, d in SequenceMatcher(None, one, other, autojunk=False).get_opcodes():
            if tag in ("equal", "replace") and b - a == d - c:
                same.update(zip(range(c, d), range(a, b), strict=True))
        for number in range(len(after.source.texts)):
            if number in same and number + after.source.first in after.source.reach:
                old_text, new_text = (_value_text(values[i].get(n)) for i, n in enumerate((same[number], number)))
                if old_text != new_text:
                    return number + after.source.first, old_text, new_text
    return None, "", ""


def _value_text(line: LineValues | None) -> str:
    return (
        "not reached" if line is None else " ".join(filter(None, (line.value, " \N{MIDDLE DOT} ".join(line.details))))
    )
