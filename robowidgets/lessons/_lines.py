"""The lines of an answer in the case in which it was wrong."""

from __future__ import annotations

import re
from collections.abc import Iterator
from html import escape
from typing import Any

from ..behaviors.lines.shown import lines_of, value_text
from ..behaviors.lines.texts import LineText, line_texts
from ..behaviors.lines.watch import WatchedCall, WatchedStep
from ..behaviors.version import RATE
from ..reasons.places import OWN, TEST, VALUE
from ..samples import Scan
from ._texts import say

_MOST_VALUES = 3
_MOST_PASSES = 5
"""Passes of a loop that are shown."""
_WIDEST = 60
"""Characters of code in front of values."""
_CODE = re.compile(r"`([^`]*)`")


class CaseLines:
    """The lines of an answer in one call: each line of code with its values. It prints itself.

    Args:
        title: the title of the case.
        sample: the scan or touch of the case.
        step: the call.
        is_drive: True if the call is one step of a drive.
        is_late: True if the call did not return.
    """

    def __init__(self, title: str, sample: Any, step: WatchedStep, *, is_drive: bool, is_late: bool) -> None:
        self._title, self._is_late = title, is_late
        found = {call.source.key: call for call in step.calls}  # a machine may call a function more than once
        self._calls = [*found.values()]
        if is_drive:
            self._when = say("at {seconds:.1f} s", seconds=(step.number - 1) / RATE)
        else:
            self._when = say("in this scan") if isinstance(sample, Scan) else say("in this case")

    @property
    def summary(self) -> str:
        """The values in plain words: "in this scan `front` was inf, line 3 was not reached"; empty without values."""
        values, missed = list[str](), list[int]()
        for call in self._calls:
            values += _values(call)
            missed += _missed(call)
        texts = values[:_MOST_VALUES] or [text for call in self._calls for text in _returned(call)]
        if len(missed) == 1:
            texts.append(say("line {line} was not reached", line=missed[0]))
        elif missed:
            texts.append(say("lines {lines} were not reached", lines=", ".join(map(str, missed))))
        return f"{self._when} {', '.join(texts)}" if texts else ""

    @staticmethod
    def _heading(title: str, summary: str) -> str:
        if not summary:
            return say("{title}, line by line", title=title)
        return say("{title}, line by line: {summary}", title=title, summary=summary)

    def __repr__(self) -> str:
        heading = self._heading(self._title, self.summary)
        return "\n".join((heading, *(row for call in self._calls for row in self._rows(call))))

    @staticmethod
    def _passes(line: LineText) -> list[str]:
        more = line.times - _MOST_PASSES
        return [*line.passes[:_MOST_PASSES], *([say("... and {more} more passes", more=more)] if more > 0 else [])]

    def _rows(self, call: WatchedCall) -> Iterator[str]:
        if call.why:
            yield f"  {_why(call)}"
        width = min(_WIDEST, max((len(text) for text in call.source.texts), default=0))
        for line in line_texts(call):
            yield f"{line.number:4}  {line.code.ljust(width)}  {self._value(line)}".rstrip()
            yield from (f"{'':{width + 6}}  {row}" for row in self._passes(line))

    def _value(self, line: LineText) -> str:
        if line.error:
            return say("it was still here") if self._is_late else f"! {line.error}"
        return say("not reached") if line.is_reached is False else line.value

    def _repr_html_(self) -> str:
        # Colors of the page, for light and dark notebooks.
        summary = _CODE.sub(r"<code>\1</code>", escape(self.summary))
        heading = self._heading(escape(self._title), summary)
        rows = "".join(row for call in self._calls for row in self._html_rows(call))
        return (
            f"<details open><summary>{heading}</summary>"
            '<div style="overflow:auto;max-height:30em">'
            '<table style="border-collapse:collapse;font-family:monospace;text-align:left;margin:.3em 0">'
            f"{rows}</table></div></details>"
        )

    def _html_rows(self, call: WatchedCall) -> Iterator[str]:
        if call.why:
            yield f'<tr><td></td><td colspan="2" style="text-align:left">{escape(_why(call))}</td></tr>'
        for line in line_texts(call):
            pale = ";opacity:.55" if line.is_reached is False else ""
            ink = ";font-weight:bold" if line.error else ""
            texts = (self._value(line), *self._passes(line))
            value = "<br>".join(map(escape, texts))
            cell = "text-align:left;white-space:pre;vertical-align:top"
            yield (
                f'<tr style="background:none{pale}">'
                f'<td style="text-align:right;vertical-align:top;padding:0 .8em 0 0;opacity:.6">{line.number}</td>'
                f'<td style="{cell};padding:0 2em 0 0">{escape(line.code)}</td>'
                f'<td style="{cell};padding:0{ink}">{value}</td></tr>'
            )


def _why(call: WatchedCall) -> str:
    return say("{name} shows no values: {why}", name=call.source.name, why=call.why)


def _values(call: WatchedCall) -> Iterator[str]:
    """Yield what a call computed in plain words: assigned names, or its conditions if it assigned none."""
    if call.notes is None:
        return
    places = call.source.places
    lines = {line.number + call.source.first: line for line in lines_of(call)}
    texts: dict[str, str] = {}
    for kind in (VALUE, TEST):
        for number, noted in call.notes.last.items():
            place, line = places[number], lines.get(places[number].line)
            if place.kind != kind or line is None or (kind == VALUE and len(place.names) != 1):
                continue
            text = place.names[0] if kind == VALUE else place.text
            why = f" ({line.details[0]})" if kind == TEST and line.details else ""
            texts[text] = say("`{name}` was {value}", name=text, value=value_text(call.notes, noted) + why)
        if texts:
            break
    yield from texts.values()


def _returned(call: WatchedCall) -> Iterator[str]:
    """Yield the value of the last statement of a call in plain words, if it was a return."""
    if call.notes is None or call.error:
        return
    whole = [one for one in call.notes.seen if call.source.places[one.place].kind in OWN]
    place = call.source.places[whole[-1].place] if whole else None
    if place is not None and place.kind == VALUE and not place.names:
        yield say("line {line} returned {value}", line=place.line, value=value_text(call.notes, whole[-1]))


def _missed(call: WatchedCall) -> Iterator[int]:
    yield from (line.number for line in line_texts(call) if line.is_reached is False)
