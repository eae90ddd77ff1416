"""Something odd about data, and what to do about it."""

from __future__ import annotations

from typing import NamedTuple

LONGEST = 200
"""Characters of a problem as text."""


class Problem(NamedTuple):
    """Something odd about data, in plain words, and the remedy, which may be empty.

    As text it is one line of at most 200 characters: names from a file may be of any length, and are cut.

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
