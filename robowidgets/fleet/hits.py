"""The results of a search through many recordings, as one table."""

from __future__ import annotations

import os
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, overload

from ..export.html import MAX_SIZE, SUFFIXES
from ..notebook.cells import CellRun, running_cell
from ..recordings.columns.tables import date, number, text, texts, whole
from ..recordings.search.base import Condition
from ..recordings.search.spans import cell, more_heads
from ..runtime.output_file import checked_output
from ..runtime.tables import Table
from ..runtime.text import as_date, listed, many
from ._fleet_table import SHOWN, FleetTable, short, with_problems
from ._hit import Hit as Hit

if TYPE_CHECKING:
    from ._sheet import Sheet


class Hits(FleetTable, Sequence[Hit]):
    """A table of the results in many recordings. Printed, it shows the first ones.

    Args:
        condition: the condition, or only its text: then pictures light only the nearest ray.
        hits: the results, by recording and time.
        chosen: the topics of each recording that were chosen among several of a kind.
        problems: the problems of each recording, as in `Recording.losses`: spans may be missing.
        told: a line on the way of the search.
        **rows: as for `FleetTable`.
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
        "nearest_ns": whole,
        "value": number,
        "value_ns": whole,
        "problem": text,
    }

    def __init__(
        self,
        condition: Condition | str,
        hits: Sequence[Hit],
        *,
        chosen: Mapping[str, Sequence[str]],
        problems: Mapping[str, Sequence[str]],
        told: str = "",
        **rows: Any,
    ) -> None:
        super().__init__(**rows)
        self.condition = str(condition)
        self._wanted = condition if isinstance(condition, Condition) else None
        self.chosen = {file: tuple(topics) for file, topics in chosen.items() if topics}
        self.problems = {file: tuple(lines) for file, lines in problems.items() if lines}
        self._hits = tuple(hits)
        self._how = told
        self.shown_in: CellRun | None = None
        """The run of a cell below which the hits are shown already."""
        self.live: Sheet | None = None
        """The table that grew below that cell."""

    def __len__(self) -> int:
        return len(self._hits)

    def _repr_html_(self) -> str:
        table = self._table()
        return (replace(table, rows=(), notes=()) if self.shown_in == running_cell() else table).to_html()

    @overload
    def __getitem__(self, which: int) -> Hit: ...
    @overload
    def __getitem__(self, which: slice) -> Hits: ...
    def __getitem__(self, which: int | slice) -> Hit | Hits:
        return self.only(self._hits[which]) if isinstance(which, slice) else self._hits[which]

    def only(self, hits: Sequence[Hit]) -> Hits:
        """Return the same results with only some of the hits."""
        rows: dict[str, Any] = {"files": self.files, "unread": self.unread, "until": self.until, "note": self.note}
        return Hits(
            self.condition if self._wanted is None else self._wanted,
            hits,
            chosen=self.chosen,
            problems=self.problems,
            told=self._how,
            **rows,
        )

    def __iter__(self) -> Iterator[Hit]:
        return iter(self._hits)

    def show(self, **options: Any) -> Sheet:
        """Show a contact sheet: each hit as a small picture of the laser, with the rays of the condition lit.

        A click opens the player of the recording at that moment, below the sheet. Hits of conditions on other samples
        show a value, or its line.

        Args:
            **options: keywords of `SheetWidget`, such as ``sort="file"``, or ``rows=True`` for a table.

        Raises:
            TypeError: an unknown keyword.
        """
        sheet = self._sheet(**options)
        if self.live is not None and self.shown_in == running_cell() and self.live.player is None:
            self.live.close()  # otherwise the same table would be shown twice
        return sheet

    def to_html(
        self,
        path: str | os.PathLike[str],
        *,
        around: float = 2.0,
        title: str = "",
        note: str = "",
        max_size: int | None = MAX_SIZE,
    ) -> Path:
        """Write the contact sheet as one page that plays each hit, which any browser shows with nothing installed.

        Args:
            path: the file, such as ``"near_misses.html"``; an existing file is replaced when the new one is complete.
            around: the number of seconds that are played before and after each hit.
            title: the title of the page, or empty for the condition.
            note: a text under the title.
            max_size: the maximum size of the file in bytes, or None for no limit.

        Returns:
            The path of the file.

        Raises:
            ValueError: nothing was found, or the page would be too large; the text says how to make it smaller.
            TypeError: ``around`` is not a number. OSError: the file cannot be written. RecordingError: a recording
                cannot be read any more.

        Example:
            >>> hits[:50].to_html("near_misses.html", around=1.0)  # doctest: +SKIP
        """
        from ._to_html import write  # Imported lazily: a search needs no widget.

        target = checked_output("to_html", path, SUFFIXES)
        sheet = self._sheet()
        try:
            return write(self, sheet.widget, self._wanted, target, around, title, note, max_size)
        finally:
            sheet.close()

    def to_mcap(self, folder: str | os.PathLike[str], *, around: float = 2.0, overwrite: bool = False) -> list[Path]:
        """Write each hit as an MCAP file, as `TimeSlice.to_mcap` does, named by its recording and its start.

        Args:
            folder: the folder, which is made if it is missing.
            around: the number of seconds before and after each hit.
            overwrite: True to replace existing files.

        Returns:
            The paths of the files, in the order of the hits.

        Raises:
            FileExistsError: a file exists; nothing is written then. ValueError: nothing was found. TypeError:
                ``around`` is not a number. OSError, RecordingError: a file cannot be written, or a recording cannot be
                read any more.

        Example:
            >>> hits.to_mcap("cuts/", around=5)  # doctest: +SKIP
        """
        from ._to_mcap import write  # Imported lazily: a search needs no mcap.

        return write(self, folder, around, overwrite)

    def _sheet(self, **options: Any) -> Sheet:
        from ._sheet import Sheet  # Imported lazily: a search needs no widget.

        sheet = Sheet(self.condition, self._wanted, **options)
        sheet.set_hits(self._hits, self.files, self.unread, self.problems)
        return sheet

    def _rows(self) -> Iterator[Mapping[str, Any]]:
        for hit in self:
            yield {**hit._asdict(), "silent": list(hit.silent), "date": hit.date}

    def _table(self) -> Table:
        """Return the table of the first hits."""
        met = any(hit.nearest is not None for hit in self)
        heads = ("file", "topic", "start", "end", "date", *("nearest", "index", "angle") * met, *more_heads(self))
        names = short([hit.file for hit in self])
        rows = [tuple(_cell(hit, head, names) for head in heads) for hit in self._hits[:SHOWN]]
        more = [f"  ... and {len(self) - SHOWN:,} more"] if len(self) > SHOWN else []
        right = [i for i, head in enumerate(heads) if head in ("start", "end", "nearest", "index", "angle", "value")]
        return Table(self._heading(), heads, rows, right, [*more, *self._told()], list(self._complaints()))

    def _heading(self) -> str:
        searched = (len(self.files) if self.until is None else self.until) - len(self.unread)
        left = len(self.files) - searched
        if left and not searched:
            return f"{self.condition}: none of {many(left, 'file')} searched"
        there = many(searched, "file") + (f", {left:,} not searched" if left else "")
        if not self:
            return f"{self.condition}: never in {there}"
        return f"{self.condition}: {len(self):,} in {len({hit.file for hit in self}):,} of {there}"

    def _told(self) -> Iterator[str]:
        """Yield lines on the way of the search, and on the chosen topics."""
        if self._how:
            yield f"  {self._how}"
        if self.chosen:
            counts = Counter(topic for topics in self.chosen.values() for topic in topics)
            taken = listed([f"{topic} ({count:,})" for topic, count in counts.most_common()], 5)
            files = many(len(self.chosen), "file")
            yield f"  {files} with several topics that fit: read {taken}; choose others with topics="

    def _complaints(self) -> Iterator[str]:
        yield from super()._complaints()
        yield from with_problems(self.problems)


def _cell(hit: Hit, head: str, names: Mapping[str, str]) -> str:
    value = getattr(hit, head)
    if head == "file":
        return names[value]
    if head == "topic":
        return str(value)
    if head == "date":
        return "" if value is None else as_date(hit.start_ns)
    return cell(value, head)
