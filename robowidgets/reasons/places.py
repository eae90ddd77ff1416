"""The places in a function's source that are noted, and the lines that belong to them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any
from zlib import crc32

VALUE, TEST, EFFECT, COMPARE, OPERAND, RAYS = "value", "test", "effect", "compare", "operand", "rays"
MARK, PASS, CHANGE = "mark", "pass", "change"
"""Kinds of places: the value of a statement, a test, the value of an expression that is a statement, such as print(), a
comparison, a part of a condition, a call that reads rays, the beginning of a statement without a value, the beginning
of a pass of a loop, and the 1 of ``state.n += 1``, whose target is not read again, as this might call a user's code."""
OWN = (VALUE, TEST, EFFECT, CHANGE)
"""The kinds that are the value of a whole line."""


@dataclass(frozen=True)
class Operand:
    """One side of a comparison, or an argument.

    ``text`` is its source. It is a constant if ``place`` and ``extra`` are None. Else it is the value that was noted at
    a place, or the value that the note of the comparison has as its ``extra``-th one.
    """

    text: str
    constant: Any = None
    place: int | None = None
    extra: int | None = None


@dataclass(frozen=True)
class NotedPlace:
    """A place in the source whose value is noted.

    Attributes:
        kind: one of the kinds above.
        line: the line in the file on which its value is shown.
        text: its source.
        extras: the number of values that its note has in addition to its own.
        names: the names that the value is assigned to.
        relation: of a comparison with two sides, such as ``<``.
        operands: for a comparison its sides. For a call that reads rays the scan, then the sector. For a change its
            operator.
        loop: the number of the innermost loop around it, or None.
        chain: of a comparison its relations, one between each two sides.
        is_inner: True in a comprehension or an inner function, whose notes are not shown on lines.
    """

    kind: str
    line: int
    text: str = ""
    extras: int = 0
    names: tuple[str, ...] = ()
    relation: str = ""
    operands: tuple[Operand, ...] = ()
    loop: int | None = None
    chain: tuple[str, ...] = ()
    is_inner: bool = False


@dataclass(frozen=True)
class Loop:
    """A loop: its line, and the loop around it, or None."""

    line: int
    around: int | None


@dataclass(frozen=True)
class FunctionSource:
    """The source of a function, with the places that are noted.

    Attributes:
        name: the name of the function.
        file: the name of its file, as in tracebacks.
        first: the number of its first line in the file.
        texts: its lines, without their common indentation.
        places: by number.
        loops: by number.
        reach: for each line of code, the numbers of the places that show that it was reached.
        column: of its beginning, in bytes.
    """

    name: str
    file: str
    first: int
    texts: tuple[str, ...]
    places: tuple[NotedPlace, ...] = ()
    loops: tuple[Loop, ...] = ()
    reach: Mapping[int, tuple[int, ...]] = field(default_factory=dict)
    column: int = 0

    @cached_property
    def key(self) -> str:
        """A unique name: functions in two cells may have the same name and the same line."""
        own = self.file, self.column, self.texts
        return f"{self.name} {self.first} {crc32(repr(own).encode(errors='replace')):08x}"
