"""What the threads of programs print."""

from __future__ import annotations

from collections import deque

KEPT = 3
"""Lines that are kept."""

LONGEST = 200
"""Characters of a line that are kept."""


class Prints:
    """The last lines that a program printed, with their times.

    Attributes:
        lines: (seconds, text), oldest first.
    """

    def __init__(self) -> None:
        self.lines: deque[tuple[float, str]] = deque(maxlen=KEPT)
        self._rest = ""

    def add(self, text: str, seconds: float) -> None:
        """Add printed text, of which only whole lines are kept."""
        *whole, rest = (self._rest + text).split("\n")
        self._rest = rest[:LONGEST]
        self.lines.extend((seconds, line[:LONGEST]) for line in whole)

    def end_line(self, seconds: float) -> None:
        """Keep what was printed of a line that has no end yet."""
        if self._rest:
            self.add("\n", seconds)
