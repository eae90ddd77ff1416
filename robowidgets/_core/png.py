"""Saving a widget as a PNG: Python sends a request, a page draws the picture, and Python writes the file."""

from __future__ import annotations

import asyncio
import base64
import itertools
import logging
import os
import threading
from collections.abc import Generator
from concurrent.futures import Future
from pathlib import Path
from typing import Any

import anywidget
from comm import DummyComm

from .error_routing import cell_is_running
from .output_file import checked_output, whole_file

log = logging.getLogger("robowidgets")

PATIENCE = 10.0
"""Seconds without an answer after which no page seems to show the widget; not counted while a cell runs."""

_URL = "data:image/png;base64,"


class Saving:
    """A picture that is being saved. A cell that needs the file can ``await`` it.

    Awaiting returns the path, or raises the error that kept the file from being written.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._written: Future[Path] = Future()

    def __await__(self) -> Generator[Any, None, Path]:
        return asyncio.shield(asyncio.wrap_future(self._written)).__await__()

    def __repr__(self) -> str:
        if not self._written.done():
            return f"<{self.path}: asked for, not written yet>"
        error = self._written.exception()
        return f"<{error}>" if error else f"<{self.path}: written>"

    def _end(self, error: Exception | None = None) -> None:
        if self._written.done():
            return
        if error is None:
            self._written.set_result(self.path)
        else:
            self._written.set_exception(error)


class SavesPng(anywidget.AnyWidget):
    """A widget that a page can save as a picture. Subclasses implement `_set_png_error` and `_catch_up`."""

    def __init__(self, **kwargs: Any) -> None:
        self._asked: dict[int, Saving] = {}
        self._numbers = itertools.count(1)
        self._patience: threading.Timer | None = None
        super().__init__(**kwargs)
        self.on_msg(self._on_answer)

    def save_png(self, path: str | os.PathLike[str]) -> Saving:
        """Write what the widget shows now into a PNG file, at least twice as fine as on the screen.

        The page that shows the widget draws the picture. The call returns at once, and the file is written a moment
        later, or after the cell has ended, because many kernels process no message of a page before. To have the file
        within the cell, use ``await laser.save_png("corner.png")``. Later errors appear on the widget and in the log.

        Args:
            path: the file; an existing one is replaced.

        Raises:
            TypeError: no path. ValueError: a name that does not end in .png. OSError: a missing folder, or one that is
                not writable. RuntimeError: no notebook, or the widget is closed.
        """
        target = checked_output("save_png", path, (".png",))
        if self.comm is None:
            raise RuntimeError("save_png(): this widget is closed; show a new one")
        if isinstance(self.comm, DummyComm):
            raise RuntimeError("save_png() needs a notebook: a page that shows the widget draws the picture")
        number, saving = next(self._numbers), Saving(target)
        self._asked[number] = saving
        self._set_png_error("")
        self._catch_up()
        self.send({"png": number})
        self._wait()
        return saving

    def _set_png_error(self, error: str) -> None:
        """Show on the widget what went wrong; empty removes the text."""
        raise NotImplementedError

    def _catch_up(self) -> None:
        """Send the state that the page does not show yet."""

    def _on_answer(self, _widget: Any, content: dict[str, Any], _buffers: Any) -> None:
        # Several pages may answer; the first one counts.
        saving = self._asked.pop(content.get("png", 0), None)
        if saving is None:
            return
        try:
            _write(saving.path, content.get("url", ""))
        except OSError as error:
            self._fail(saving, error)
        else:
            self._set_png_error("")
            saving._end()

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
        for saving in list(self._asked.values()):
            error = (
                f"no page that shows this widget has answered for {PATIENCE:g} s; have it in view and call save_png() "
                "again. If a cell is still awaiting something, the kernel may hear the page only when it ends"
            )
            self._fail(saving, TimeoutError(error))

    def _fail(self, saving: Saving, error: Exception) -> None:
        text = f"{saving.path} was not written: {error}"
        log.error("%s: %s", type(self).__name__, text)
        self._set_png_error(text)
        saving._end(type(error)(text))


def _write(target: Path, url: str) -> None:
    """Write the picture of a data URL into a file, all of it or nothing."""
    if not url.startswith(_URL):
        raise OSError(f"the page could not draw the picture; it answered {url[:40]!r}")
    with whole_file(target) as file:
        file.write(base64.b64decode(url[len(_URL) :]))
