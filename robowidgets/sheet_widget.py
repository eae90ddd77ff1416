"""The contact sheet: moments found in many recordings, side by side as small pictures or as rows of a table."""

from __future__ import annotations

import logging
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import traitlets

from .repair import RecordingError
from .runtime.platform_fixes import route_by_message
from .runtime.text import many
from .widget.base_widget import NamedWidget
from .widget.front_end import bundle
from .widget.traits import Flag, bytes_trait

MOST_LOOKED_AT = 500
"""The most moments for which a page requests pictures at once."""

log = logging.getLogger("robowidgets")


class SheetFile(NamedTuple):
    """A recording that was searched: its path or URL, its name, and its problem, if any.

    ``is_read`` is True if a part of it could be read.
    """

    path: str
    name: str
    problem: str = ""
    is_read: bool = True


class SheetWidget(NamedWidget):
    """Moments side by side: the picture of each, its value, its file and its time.

    Only visible moments are drawn, so that thousands stay smooth. They can be sorted and filtered by column. A click
    opens one. Arrow keys walk, Enter opens, `c` copies the code that opens it, `x` marks a false find, `l` gives it a
    name, `/` filters. Sorting, filtering and walking work without the kernel.

    Args:
        title: title in the header.
        condition: the text of the condition, next to the title.
        header, footer: False to hide them.
        sort: the column by which it is sorted, such as ``"nearest"``, or ``"-nearest"`` for the reverse order. The view
            writes it.
        rows: True for a table instead of pictures. The view writes it.
        one_per_file: True to show only the first moment of each file. The view writes it.
        every: True to show only an even choice that fills one screen. The view writes it.
        filters: filters by column: a part of a text, or numbers as in ``"< 0.2"`` and ``"0.1 to 0.2"``. The view writes
            it.
        picked: the number of the selected moment, or None. The view writes it.
        false_finds: the numbers of moments that are marked as false finds. The view writes it.
        labels: the names that users gave the spans of moments, by the number of the moment as text.
    """

    _esm, _css = bundle("sheet_widget")

    condition = traitlets.Unicode(help="The condition as in the program.").tag(sync=True)
    footer = Flag(True, help="True to show facts below the moments.").tag(sync=True)
    sort = traitlets.Unicode("nearest", help="The column by which it is sorted; with a minus in reverse order.").tag(
        sync=True
    )
    rows = Flag(False, help="True for a table instead of pictures.").tag(sync=True)
    one_per_file = Flag(False, help="True to show only the first moment of each file.").tag(sync=True)
    every = Flag(False, help="True to show only an even choice.").tag(sync=True)
    filters = traitlets.Dict(help="Filters by column.").tag(sync=True)
    picked = traitlets.Int(None, allow_none=True, help="The number of the selected moment, or None.").tag(sync=True)
    false_finds = traitlets.List(traitlets.Int(), help="The numbers of false finds.").tag(sync=True)
    labels = traitlets.Dict(help="The name of the span of a moment, by the number of the moment.").tag(sync=True)

    _columns = traitlets.Dict(help="The moments by column.").tag(sync=True, echo_update=False)
    _files = traitlets.List(traitlets.List(), help="Path and name of each file with moments.").tag(
        sync=True, echo_update=False
    )
    _topics = traitlets.List(traitlets.Unicode(), help="Names of topics.").tag(sync=True, echo_update=False)
    _unread = traitlets.List(traitlets.Dict(), help="Files that were not read whole, with the reason.").tag(
        sync=True, echo_update=False
    )
    _total = traitlets.Int(0, help="Number of files to search.").tag(sync=True)
    _done = traitlets.Int(None, allow_none=True, help="Number of files searched so far, or None for all.").tag(
        sync=True
    )
    _pictures = bytes_trait(echo_update=False)
    _opened = traitlets.Int(None, allow_none=True, help="The number of the open moment, or None.").tag(sync=True)
    _status = traitlets.Unicode(help="Why a moment could not be opened.").tag(sync=True, echo_update=False)

    def __init__(
        self,
        on_look: Callable[[Sequence[int]], None] | None = None,
        on_open: Callable[[int], None] | None = None,
        on_new_page: Callable[[], None] | None = None,
        on_label: Callable[[int, str], None] | None = None,
        **kwargs: Any,
    ) -> None:
        self._on_look, self._on_open, self._on_new_page, self._on_label = on_look, on_open, on_new_page, on_label
        super().__init__(**{"title": "Moments", **kwargs})
        self.on_msg(self._on_page)

    _keywords = ("on_look", "on_open", "on_new_page", "on_label")

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm)

    def show(
        self,
        columns: Mapping[str, Sequence[Any]],
        files: Sequence[SheetFile],
        topics: Sequence[str],
        *,
        total: int,
        done: int | None = None,
    ) -> None:
        """Show moments.

        Args:
            columns: ``file`` and ``topic`` as indices, ``start``, ``end``, ``date``, ``nearest``, ``index``, ``value``
                and ``silent``, each with one value for each moment. Moments are numbered from 0.
            files: the files with moments. Files with problems are listed below them.
            topics: the names of the topics.
            total: the number of files to search.
            done: the number of files searched so far; by default all.
        """
        with self.hold_sync():
            self._files = [[file.path, file.name] for file in files]
            self._unread = [file._asdict() for file in files if file.problem]
            self._topics = [*topics]
            self._columns = {name: [*values] for name, values in columns.items()}
            self._total, self._done = total, done

    def send_pictures(self, packed: bytes) -> None:
        """Send some pictures."""
        self.send({"pictures": len(packed)}, [packed])

    def keep_pictures(self, packed: bytes) -> None:
        """Put pictures into the state, which is saved with a notebook."""
        self._pictures = packed

    def complain(self, problem: str) -> None:
        """Show why a moment could not be opened, or clear this text if it is empty."""
        self._status = problem

    def close(self) -> None:
        """Remove the widget from the page."""
        self._on_look = self._on_open = self._on_new_page = self._on_label = None
        super().close()

    def _summary(self) -> str:
        return many(len(self._columns.get("file", ())), "moment")

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Make pictures of visible moments, or open a moment. Called in the main thread or in a subshell's."""
        if not isinstance(content, dict):
            return
        count = len(self._columns.get("file", ()))
        looked_at, opened = content.get("look"), content.get("open")
        if content.get("new") and self._on_new_page:
            self._on_new_page()
        if isinstance(looked_at, list) and self._on_look:
            self._on_look([one for one in looked_at[:MOST_LOOKED_AT] if isinstance(one, int) and 0 <= one < count])
        named = content.get("label")
        if self._on_label and isinstance(named, list) and isinstance(named[0], int) and 0 <= named[0] < count:
            try:
                self._on_label(named[0], named[1])
            except (RecordingError, TypeError, ValueError) as error:
                self.complain(str(error))
            else:
                self.complain("")
            self.send({"labelled": named[0]})
        if isinstance(opened, int) and 0 <= opened < count and self._on_open:
            try:
                self._on_open(opened)
            except RecordingError as error:
                self.complain(str(error))
            except Exception as error:
                log.exception("robowidgets: a moment could not be opened")
                self.complain(f"{type(error).__name__}: {error}")
            else:
                self.complain("")
                self._opened = opened
            self.send({"opened": opened})
