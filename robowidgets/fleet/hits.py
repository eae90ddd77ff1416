"""What a search through many recordings found, as one table."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from datetime import datetime
from pathlib import Path
from typing import Any, ClassVar, NamedTuple, overload

from .._core.tables import Table
from .._core.text import as_date, listed, many
from ..search.spans import cell
from ._fleet_table import SHOWN, FleetTable, date, date_of, number, short, text, texts, whole


class Hit(NamedTuple):
    """A span in which the condition held: the recording, the topics that were looked at, and the fields of a `Span`."""

    file: str
    topic: str
    start: float
    end: float
    seconds: float
    start_ns: int
    end_ns: int
    silent: tuple[str, ...] = ()
    nearest: float | None = None
    index: int | None = None  # type: ignore[assignment]  # as ROS calls it; it hides tuple.index
    angle: float | None = None

    @property
    def date(self) -> datetime | None:
        """Date and time of its start, in UTC; None if the clock of the recording has no date."""
        return date_of(self.start_ns)


class Hits(FleetTable, Sequence[Hit]):
    """A table of what was found in many recordings; printed, it shows the first of it.

    Args:
        condition: the text of the condition.
        hits: what was found, by recording and time.
        chosen: by recording, the topics that were chosen among several of a kind.
        problems: by recording, what is wrong with it, as in `Recording.problems`: spans may be missing.
        told: a line on how it was searched.
        **rows: as `FleetTable`.
    """

    _types: ClassVar = {
        **dict.fromkeys(("file", "topic"), text),
        **dict.fromkeys(("start", "end", "seconds"), number),
        "date": date,
        **dict.fromkeys(("start_ns", "end_ns"), whole),
        "silent": texts,
        "nearest": number,
        "index": whole,
        "angle": number,
        "problem": text,
    }

    def __init__(
        self,
        condition: str,
        hits: Sequence[Hit],
        *,
        chosen: Mapping[str, Sequence[str]],
        problems: Mapping[str, Sequence[str]],
        told: str = "",
        **rows: Any,
    ) -> None:
        super().__init__(**rows)
        self.condition = condition
        self.chosen = {file: tuple(topics) for file, topics in chosen.items() if topics}
        self.problems = {file: tuple(lines) for file, lines in problems.items() if lines}
        self._hits = tuple(hits)
        self._how = told

    def __len__(self) -> int:
        return len(self._hits)

    @overload
    def __getitem__(self, which: int) -> Hit: ...
    @overload
    def __getitem__(self, which: slice) -> Sequence[Hit]: ...
    def __getitem__(self, which: int | slice) -> Hit | Sequence[Hit]:
        return self._hits[which]

    def __iter__(self) -> Iterator[Hit]:
        return iter(self._hits)

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for hit in self:
            yield {**hit._asdict(), "silent": list(hit.silent), "date": hit.date}

    def _table(self) -> Table:
        """The first rows."""
        met = any(hit.nearest is not None for hit in self)
        silent = any(hit.silent for hit in self)
        heads = ("file", "topic", "start", "end", "date", *("nearest", "index", "angle") * met, *("silent",) * silent)
        names = short([hit.file for hit in self])
        rows = [tuple(_cell(hit, head, names) for head in heads) for hit in self[:SHOWN]]
        more = [f"  ... and {len(self) - SHOWN:,} more"] if len(self) > SHOWN else []
        right = [i for i, head in enumerate(heads) if head in ("start", "end", "nearest", "index", "angle")]
        return Table(self._heading(), heads, rows, right, [*more, *self._told()], list(self._complaints()))

    def _heading(self) -> str:
        there = many(len(self.files), "file")
        if not self:
            return f"{self.condition}: never in {there}"
        return f"{self.condition}: {len(self):,} in {len({hit.file for hit in self}):,} of {there}"

    def _told(self) -> Iterator[str]:
        """How it was searched, and which topics were chosen."""
        if self._how:
            yield f"  {self._how}"
        if self.chosen:
            counts = Counter(topic for topics in self.chosen.values() for topic in topics)
            taken = listed([f"{topic} ({count:,})" for topic, count in counts.most_common()], 5)
            files = many(len(self.chosen), "file")
            yield f"  {files} with several topics that fit: looked at {taken}; topics= names others"

    def _complaints(self) -> Iterator[str]:
        yield from super()._complaints()
        if self.problems:
            names = listed([Path(file).name for file in self.problems])
            yield f"{many(len(self.problems), 'file')} with problems, in .problems: {names}"


def _cell(hit: Hit, head: str, names: Mapping[str, str]) -> str:
    value = getattr(hit, head)
    if head == "file":
        return names[value]
    if head == "topic":
        return str(value)
    if head == "date":
        return "" if value is None else as_date(hit.start_ns)
    return cell(value, head)
