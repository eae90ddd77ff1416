"""The Rerun viewer on a page, with a time that Python can set and observe."""

from __future__ import annotations

import json
import threading
import time
from collections import deque
from collections.abc import Iterator, Sequence
from functools import cache, partial
from itertools import count
from typing import Any

import ipywidgets

from ..notebook.progress import without_bars
from ..recordings import RecordingData
from ..runtime.coalesced_call import CoalescedCall
from ..widget.pacer import pacer
from ..widget.time_traits import Seconds
from ._server import kept_here, read, server
from .rerun_log import CLOCK, SECONDS, Log
from .sdk import library

HEIGHT = 720
"""Height of the viewer in pixels."""

PACE = 0.05
"""Seconds between two updates of the time from the viewer while it plays."""

PATIENCE = 0.5
"""Seconds to wait for the viewer to confirm a time before the next time is sent. The viewer draws a picture for each
time, and a slow viewer would fall behind. The wait is limited, because no answer arrives while a cell runs."""

_numbers = count(1)


class RerunWidget(ipywidgets.Box):  # type: ignore[misc]  # ipywidgets has no types
    """A recording in the Rerun viewer.

    The page fetches the viewer and the data from this process, which reads the file piece by piece. The browser must
    run on the same machine.

    Args:
        recording: the recording, open or closed.
        topics: names of topics in it, or nothing for all topics with a widget and a message.

    Raises:
        ImportError: rerun-sdk or its part for notebooks is not installed.
        UnknownTopicError: the recording has no such topic, or no widget shows it.
    """

    time = Seconds(help="The time on show, in seconds from the start of the recording. Python and the viewer write it.")

    _viewer: Any = None

    def __init__(self, recording: RecordingData, topics: Sequence[str] = (), **kwargs: Any) -> None:
        Log(recording, topics)
        viewer = _viewer()
        self.duration = recording.duration
        self._start_ns = recording.start_ns or 0
        self._lock = threading.RLock()
        self._take_time = CoalescedCall(self._take_shown, thread="robowidgets-changes")
        # Answers arrive only between cells, so all times sent until then must be recognised.
        self._sent: deque[int] = deque(maxlen=100_000)
        self._heard: int | None = None
        self._shown: int | None = None
        self._is_open = self._agrees = False
        self._clock = False
        self._next = self._sent_at = 0.0
        self._url = server().put(f"{next(_numbers)}.rrd", partial(_pieces, recording, topics))
        self._viewer = viewer(width="auto", height=HEIGHT, url=self._url)
        self._viewer._on_raw_event(self._on_event)
        super().__init__([self._viewer], **kwargs)
        self.observe(self._on_time, "time")

    def close(self) -> None:
        """Remove the viewer from the page."""
        if self._viewer:
            pacer.forget(self)
            server().drop(self._url)
            self._viewer.close()
        super().close()

    def send_newest(self) -> int:
        """Synchronise the time with the viewer. The pacer calls it."""
        with self._lock:
            self._next = time.monotonic() + PACE
            heard, self._heard = self._heard, None
            if heard is not None:
                self._shown = heard
            elif not self._agrees:
                self._shown = None
        if heard is not None:
            self._take_time.later()  # in another thread, because observers of the time may delay the pacer
        else:
            self._send_time()
        return 0

    def _take_shown(self) -> None:
        """Take the time that the viewer shows."""
        shown = self._shown
        if shown is not None:
            self.time = shown / 1e9

    def _on_time(self, change: Any) -> None:
        with self._lock:
            if round(change["new"] * 1e9) == self._shown:
                return
            self._heard = None
        pacer.mark(self)

    def _send_time(self) -> None:
        """Send the time to the viewer, unless the viewer shows it already."""
        with self._lock:
            now = round(self.time * 1e9)
            if not self._is_open or now == self._shown:
                return
            if self._sent and time.monotonic() < self._sent_at + PATIENCE:
                pacer.mark_at(self, self._sent_at + PATIENCE)
                return
            self._shown, self._sent_at = now, time.monotonic()
            if now != next(reversed(self._sent), None):  # the viewer answers once to repeated times
                self._sent.append(now)
        self._viewer.set_time_ctrl(SECONDS, duration_nanos=now, play=False)

    def _on_event(self, text: str) -> None:
        """Handle an event of the viewer, which also echoes the times that it receives."""
        event = json.loads(text)
        kind = event["type"]
        if kind == "recording_open":
            # The page has just loaded the recording and has no time yet.
            with self._lock:
                self._sent.clear()
                self._is_open = True
                self._shown, self._agrees, self._clock = None, False, False
            self._send_time()
        elif kind == "timeline_change":
            self._clock = event["timeline"] == CLOCK
            self._on_event_time(event["time"])
        elif kind == "time_update":
            self._on_event_time(event["time"])

    def _on_event_time(self, nanoseconds: float) -> None:
        now = round(nanoseconds) - (self._start_ns if self._clock else 0)
        with self._lock:
            if now in self._sent:
                while self._sent.popleft() != now:
                    pass
                self._agrees = True
                pacer.mark(self)
            elif self._agrees and now != self._shown:
                self._heard = now
                pacer.mark_at(self, self._next)
            elif not self._agrees:  # a viewer without a timeline drops the times that it receives: send the time again
                pacer.mark_at(self, self._sent_at + PATIENCE)


def _pieces(shown: RecordingData, topics: Sequence[str]) -> Iterator[bytes]:
    # Without progress bars, because the page already shows the viewer.
    with without_bars(), shown.reopened() as recording:
        log = Log(recording, topics)
        stream = log.stream()
        drain = stream.binary_stream()
        for _ in log.steps(stream):
            yield drain.read() or b""


@cache
def _viewer() -> Any:
    """Return Rerun's widget class, changed to fetch the viewer from this process instead of the web."""
    notebook = library("rerun_notebook")
    server().put(notebook.WASM_PATH.name, partial(read, notebook.WASM_PATH))
    script = kept_here(notebook.WIDGET_PATH.read_text(encoding="utf-8")).encode()
    return type("LocalViewer", (notebook.Viewer,), {"_esm": server().put(notebook.WIDGET_PATH.name, lambda: [script])})
