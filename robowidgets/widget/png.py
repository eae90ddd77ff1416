"""Saving a widget as a PNG: Python sends a request, a page draws the picture, and Python writes the file."""

from __future__ import annotations

import asyncio
import base64
import itertools
import logging
import os
import threading
from collections.abc import Callable, Generator
from concurrent.futures import Future
from pathlib import Path
from typing import Any, Protocol

from comm import DummyComm

from ..runtime.error_routing import cell_is_running
from ..runtime.output_file import checked_output, whole_file

log = logging.getLogger("robowidgets")

PATIENCE = 10.0
"""Seconds without an answer after which saving fails because no page seems to show the widget. Time in a running cell
does not count."""

_URL = "data:image/png;base64,"


class Saving:
    """A picture that is being saved. A cell that needs the file can ``await`` it.

    Awaiting returns the path, or raises the error that kept the file from being written.
    """

    def __init__(self, path: Path, written: Future[Path]) -> None:
        self.path = path
        self._written = written

    def __await__(self) -> Generator[Any, None, Path]:
        return asyncio.shield(asyncio.wrap_future(self._written)).__await__()

    def __repr__(self) -> str:
        if not self._written.done():
            return f"<{self.path}: asked for, not written yet>"
        error = self._written.exception()
        return f"<{error}>" if error else f"<{self.path}: written>"


class DrawnWidget(Protocol):
    """A widget that a page can draw."""

    comm: Any

    def check_open(self, call: str) -> None:
        """Raise RuntimeError, which begins with the call, if the widget is closed."""

    def send(self, content: dict[str, Any]) -> None:
        """Send a message to the pages that show it."""

    def on_msg(self, callback: Callable[[Any, dict[str, Any], Any], None]) -> None:
        """Call a function with each message of a page."""


class Png:
    """The pictures of a widget, which a page draws and Python writes into files.

    Args:
        widget: the widget.
        show_error: shows an error on the widget, or removes it if the text is empty.
        catch_up: sends the state that the page does not show yet, if there is such a state.
    """

    def __init__(
        self, widget: DrawnWidget, show_error: Callable[[str], None], catch_up: Callable[[], object] | None = None
    ) -> None:
        self._widget, self._show_error, self._catch_up = widget, show_error, catch_up
        self._asked: dict[int, tuple[Path, Future[Path]]] = {}
        self._numbers = itertools.count(1)
        self._patience: threading.Timer | None = None

    def save(self, path: str | os.PathLike[str]) -> Saving:
        """See `RobotWidget.save_png`."""
        target = checked_output("save_png", path, (".png",))
        widget = self._widget
        widget.check_open("save_png()")
        if isinstance(widget.comm, DummyComm):
            raise RuntimeError("save_png() needs a notebook: a page that shows the widget draws the picture")
        number = next(self._numbers)
        if number == 1:
            widget.on_msg(self._on_answer)
        written: Future[Path] = Future()
        self._asked[number] = target, written
        self._show_error("")
        if self._catch_up:
            self._catch_up()
        widget.send({"png": number})
        self._wait()
        return Saving(target, written)

    def _on_answer(self, _widget: Any, content: dict[str, Any], _buffers: Any) -> None:
        # Several pages may answer; the first picture counts.
        number = content.get("png", 0)
        if number not in self._asked:
            return
        path, written = self._asked[number]
        try:
            if "error" in content:
                raise OSError(f"the page could not draw the picture: {content['error']}")
            del self._asked[number]
            _write(path, content.get("url", ""))
        except OSError as error:
            self._fail(path, written, error)
        else:
            self._show_error("")
            if not written.done():  # else it has failed before
                written.set_result(path)

    def _wait(self) -> None:
        """Restart the time-out for all pictures that are outstanding."""
        if self._patience is not None:
            self._patience.cancel()
        self._patience = threading.Timer(PATIENCE, self._on_silence)
        self._patience.daemon = True
        self._patience.start()

    def _on_silence(self) -> None:
        if cell_is_running():
            self._wait()
            return
        for path, written in list(self._asked.values()):
            if written.done():  # a page has reported an error
                continue
            error = (
                f"no page that shows this widget has answered for {PATIENCE:g} s; have it in view and call save_png() "
                "again. If a cell is still awaiting something, the kernel may hear the page only when it ends"
            )
            self._fail(path, written, TimeoutError(error))

    def _fail(self, path: Path, written: Future[Path], error: Exception) -> None:
        text = f"{path} was not written: {error}"
        log.error("%s: %s", type(self._widget).__name__, text)
        self._show_error(text)
        if not written.done():
            written.set_exception(type(error)(text))


def _write(target: Path, url: str) -> None:
    """Write the picture of a data URL into a file, completely or not at all."""
    if not url.startswith(_URL):
        raise OSError(f"the page could not draw the picture; it answered {url[:40]!r}")
    with whole_file(target) as file:
        file.write(base64.b64decode(url[len(_URL) :]))
