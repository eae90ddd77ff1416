"""The lines of a call as texts, for what is printed."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

from .shown import lines_of, passes_of
from .watch import WatchedCall


class LineText(NamedTuple):
    """A line of code with its texts.

    Attributes:
        number: its number in the file or cell.
        code: the line.
        value: its value, the nearest ray, and what else was computed in it.
        is_reached: True or False, or None if the line has no code.
        error: the error that ended the call in this line, or empty.
        passes: a text for each of the first passes of the loop that begins in this line.
        times: the number of its passes in all.
    """

    number: int
    code: str
    value: str = ""
    is_reached: bool | None = None
    error: str = ""
    passes: tuple[str, ...] = ()
    times: int = 0


def line_texts(call: WatchedCall) -> Iterator[LineText]:
    """Yield the lines of a call from top to bottom."""
    source = call.source
    values = {line.number: line for line in lines_of(call)}
    passes = {one.number: (one.rows, one.times) for one in passes_of(call)}
    for number, code in enumerate(source.texts):
        line, there, value = values.get(number), number + source.first, ""
        if line is not None:
            indices = " ".join(f"[{rays.nearest}]" for rays in line.rays if rays.nearest >= 0)
            times = f"×{line.times}" if line.times > 1 else ""
            value = "  ".join(filter(None, (line.value, indices, " \N{MIDDLE DOT} ".join(line.details), times)))
        is_reached = True if line is not None else False if there in source.reach else None
        error = call.error if call.error_line == there else ""
        yield LineText(there, code, value, is_reached, error, *passes.get(number, ((), 0)))
