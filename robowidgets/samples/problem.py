"""A problem of some data, and its remedy."""

from __future__ import annotations

from typing import NamedTuple

LONGEST = 200
"""The most characters of a problem as text."""


class Problem(NamedTuple):
    """A problem of some data in plain words, and its remedy, which may be empty.

    The text is one line of at most 200 characters: long names from a file are cut.

    Examples:
        >>> print(Problem("frame_id is empty", "set it in the driver"))
        frame_id is empty; set it in the driver
    """

    what: str
    remedy: str

    def __str__(self) -> str:
        remedy = f"; {self.remedy}" if self.remedy else ""
        room = LONGEST - len(remedy)
        what = self.what if len(self.what) <= room else f"{self.what[: room - 1]}…"
        return what + remedy
