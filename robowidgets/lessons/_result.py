"""The result of the check of an answer."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from typing import Any

from ._lines import CaseLines
from ._texts import say


class Result:
    """The result of the check of an answer. It is true if the answer is right, and its text explains what is wrong.

    Args:
        name: the name of the task.
        wrong: a line for each wrong case; after a case without an answer, no other cases are tried.
        right: the number of right cases.
        cases: the number of all cases.
        sample: the scan or touch of the first wrong case, or None if all are right.
        prints: the last lines that the function printed.
        fault: the fault of the first wrong case, the same text in all languages.
        lines: the lines of the answer in the first wrong case, with their values; None if they are not known.
    """

    def __init__(
        self,
        name: str,
        wrong: Sequence[str],
        right: int,
        cases: int,
        sample: Any = None,
        prints: Sequence[str] = (),
        fault: str = "",
        lines: CaseLines | None = None,
    ) -> None:
        self.name = name
        self.prints = tuple(prints)
        self.wrong = tuple(wrong)
        self.right = right
        self.cases = cases
        self.sample = sample
        self.fault = fault
        self.lines = lines

    def __bool__(self) -> bool:
        return not self.wrong

    def __repr__(self) -> str:
        printed = [say("It printed last:"), *(f"  {line}" for line in self.prints)] if self.prints else []
        lines = [repr(self.lines)] if self.lines else []
        return "\n".join((self._head(), *(f"  - {line}" for line in self.wrong), *lines, *printed))

    def _repr_html_(self) -> str:
        # HTML, because a notebook wraps lines of plain text in the middle of words.
        lines = "".join(f"<li>{escape(line)}</li>" for line in self.wrong)
        opened = self.lines._repr_html_() if self.lines else ""
        printed = "\n".join(map(escape, self.prints))
        printed = printed and f"<div>{escape(say('It printed last:'))}</div><pre>{printed}</pre>"
        return f"<div>{escape(self._head())}</div><ul>{lines}</ul>{opened}{printed}"

    def _head(self) -> str:
        if not self.wrong:
            return say("{name}: right in all {cases} cases. Well done!", name=self.name, cases=self.cases)
        return say(
            "{name}: right in {right} of {cases} cases. Still wrong:",
            name=self.name,
            right=self.right,
            cases=self.cases,
        )
