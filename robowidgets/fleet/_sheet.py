"""The contact sheet of hits, and below it the player of the opened hit."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import ipywidgets

from ..files.remote import is_url
from ..notebook.cells import close_all, take_the_place
from ..recording import open as open_recording
from ..recordings.labels import SHORTEST, Label, LabelFile, LabelledSpan
from ..recordings.search.base import Condition
from ..recordings.times import has_date
from ..runtime.coalesced_call import CoalescedCall
from ..runtime.text import many
from ..screens.player import Player
from ..sheet_widget import SheetFile, SheetWidget
from ..widget.in_words import InWords
from ._fleet_table import Unread, short
from ._hit import Hit
from ._picture_sender import PictureSender

_Named = TypeVar("_Named", Label, LabelledSpan)

_SAME = 1e-6
"""The maximum difference in seconds between two times of one moment."""


class Sheet(InWords, ipywidgets.VBox):  # type: ignore[misc]  # ipywidgets has no types
    """A contact sheet of hits; a click opens the player of a hit below it. `Hits.show` returns it.

    `close` removes everything from the page; running the cell again does the same.

    Args:
        condition: the text of the condition.
        wanted: the condition itself, or None if it is unknown.
        **options: keywords of `SheetWidget`.

    Attributes:
        widget: the sheet itself.
        player: the player of the open hit, or None.
    """

    player: Player | None = None

    def __init__(self, condition: str, wanted: Condition | None, **options: Any) -> None:
        take_the_place(self)
        self._hits: Sequence[Hit] = ()
        self._wanted = 0
        """The number of the hit to open."""
        # Messages of the page may arrive in another thread while a cell runs.
        self._open = CoalescedCall(self._open_wanted)
        self.widget = SheetWidget(
            on_look=self._look,
            on_open=self.open_hit,
            on_new_page=self._start_anew,
            on_label=self.label_hit,
            condition=condition,
            **options,
        )
        self._sender = PictureSender(self.widget.send_pictures, self.widget.keep_pictures, wanted)
        super().__init__([self.widget])

    def set_hits(
        self,
        hits: Sequence[Hit],
        files: Sequence[str],
        unread: Sequence[Unread] = (),
        problems: Mapping[str, Sequence[str]] | None = None,
        done: int | None = None,
    ) -> None:
        """Show hits. Earlier hits keep their places.

        Args:
            hits: the results.
            files: all recordings that were named.
            unread: the recordings that could not be read.
            problems: the problems of each recording.
            done: the number of recordings that were searched so far, or None for all.
        """
        self._hits = hits
        names = short([*files]) if files else {}
        odd = {file: "; ".join(lines) for file, lines in (problems or {}).items()}
        there = [
            SheetFile(file, names.get(file, file), odd.get(file, ""))
            for file in dict.fromkeys([*(hit.file for hit in hits), *odd])
        ]
        numbers = {file.path: i for i, file in enumerate(there)}
        topics = list(dict.fromkeys(hit.topic for hit in hits))
        of_topic = {topic: i for i, topic in enumerate(topics)}
        columns: dict[str, Sequence[Any]] = {
            "file": [numbers[hit.file] for hit in hits],
            "topic": [of_topic[hit.topic] for hit in hits],
            "start": [hit.start for hit in hits],
            "end": [hit.end for hit in hits],
            "time": [hit.moment for hit in hits],
            "date": [hit.start_ns / 1e9 if has_date(hit.start_ns) else None for hit in hits],
            "nearest": [hit.nearest for hit in hits],
            "index": [hit.index for hit in hits],
            "value": [hit.value for hit in hits],
            "silent": [", ".join(hit.silent) for hit in hits],
        }
        unread_files = [SheetFile(one.file, names.get(one.file, one.file), one.problem, False) for one in unread]
        self._read_labels()
        self.widget.show(columns, [*there, *unread_files], topics, total=len(files), done=done)
        self._sender.set_hits(hits)

    @property
    def picked(self) -> Hit | None:
        """The picked hit, or None."""
        number = self.widget.picked
        return None if number is None or number >= len(self._hits) else self._hits[number]

    @property
    def false_finds(self) -> list[Hit]:
        """The hits that the user marked as false finds."""
        return [self._hits[number] for number in self.widget.false_finds if number < len(self._hits)]

    def open_hit(self, number: int) -> None:
        """Open the player of a hit below the sheet, at its moment.

        While another thread opens a hit, that thread opens this one afterwards, and the call returns at once.

        Args:
            number: the number of the hit.

        Raises:
            RecordingError: the recording of the hit cannot be read any more.
        """
        self._hits[number]  # IndexError for a wrong number
        self._wanted = number
        self._open()

    def _open_wanted(self) -> None:
        hit, player = self._hits[self._wanted], self.player
        if player is None or self._file_of_player != hit.file:
            recording = open_recording(hit.file)
            try:
                recording.preferred = frozenset(hit.topic.split(", "))
                new = Player(recording)
            except BaseException:
                recording.close()
                raise
            self.player, self._file_of_player = new, hit.file
            new.bar.observe(self._read_labels, "labels")
            self.children = [self.widget, new]
            if player is not None:
                close_all(player)
        assert self.player is not None
        self.player.marks = [(one.start, one.end, "") for one in self._hits if one.file == hit.file]
        self.player.seek(hit.moment)

    def label_hit(self, number: int, name: str) -> None:
        """Label the span of a hit, next to its recording, instead of its previous label.

        Args:
            number: the number of the hit.
            name: a name such as ``"door"``, or empty to remove the label.

        Raises:
            TypeError, ValueError: ``name`` is not a name. RecordingError: the label cannot be saved. See
                `Recording.label`.
        """
        hit = self._hits[number]
        with open_recording(hit.file) as recording:
            before = _label_of(hit, recording.labels)
            named = recording.label(name, hit.start, max(hit.end, hit.start + SHORTEST)) if name else None
            if before and before != named:
                recording.remove_label(before)
        player = self.player
        if player is not None and self._file_of_player == hit.file:
            player.read_labels()
        self._read_labels()

    def _read_labels(self, _change: Any = None) -> None:
        """Show the current labels of hits, which are stored next to their recordings."""
        of_folder: dict[Path, LabelFile] = {}
        of_file: dict[Path, list[LabelledSpan]] = {}
        labels = {}
        for number, hit in enumerate(self._hits):
            if is_url(hit.file):
                continue
            path = Path(hit.file)
            if path.parent not in of_folder:
                of_folder[path.parent] = LabelFile(path.parent)
            if path not in of_file:
                of_file[path] = of_folder[path.parent].of(path)
            label = _label_of(hit, of_file[path])
            if label:
                labels[str(number)] = label.label
        self.widget.labels = labels

    def close(self) -> None:
        """Remove everything from the page."""
        self._sender.close()
        for widget in (self.player, self.widget):
            if widget is not None and widget.comm is not None:
                close_all(widget)
        if self.comm is not None:
            self.layout.close()
        super().close()

    def __repr__(self) -> str:
        return f"<Sheet {self.widget.condition}: {many(len(self._hits), 'hit')}>"

    _file_of_player = ""

    def _look(self, numbers: Sequence[int]) -> None:
        self._sender.look(numbers)

    def _start_anew(self) -> None:
        self._sender.start_anew()


def _label_of(hit: Hit, labels: Sequence[_Named]) -> _Named | None:
    """Return the last label of the span of a hit, or None if it has no label."""
    end = max(hit.end, hit.start + SHORTEST)
    same = [one for one in labels if abs(one.start - hit.start) < _SAME and abs(one.end - end) < _SAME]
    return same[-1] if same else None
