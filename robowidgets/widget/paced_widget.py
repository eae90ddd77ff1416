"""The base of the widgets that the pacer sends: their frames, their texts and their traits."""

from __future__ import annotations

import os
import threading
import time
import weakref
from collections.abc import Iterable
from typing import Any

from ..runtime.platform_fixes import message_padding
from .freezing import FreezableWidget
from .heartbeat import BeatingWidget
from .newest_sample import NewestSample
from .pacer import pacer
from .sent_frames import SentFrames
from .timed_frame import TimedFrame
from .traits import HistorySeconds

RESYNC_TRAITS = ("title", "_about", "_source")
"""Traits that only Python writes, which are sent again with a frame at intervals: a server that is flooded with prints
silently drops messages, and a page may overwrite new traits with an older state that it requested before."""

RESYNC_S = 5.0
"""Seconds between two such frames."""


class PacedWidget(BeatingWidget, FreezableWidget):
    """A widget whose newest frame, with the texts on it, and whose traits the pacer sends to the page.

    A loop may set traits at any rate, as it may update the widget, so they wait for their turn too.
    """

    history = HistorySeconds(
        30.0,
        why="; the page keeps 20 samples for each of them",
        help="Seconds for which the page keeps samples to step back through, 0 (none) to 600; 20 a second and 8 MB at "
        "most.",
    ).tag(sync=True)

    _newest: NewestSample[Any]
    """The newest sample, which the subclass makes."""

    def __init__(self, **kwargs: Any) -> None:
        self._process = os.getpid()
        self._sent: tuple[bytes, dict[str, Any]] = (b"", {})
        """The `_frame` and the `_about` that were sent last. Only the pacer sends them."""
        self._sent_frames = SentFrames()
        self._unsent: set[str] = set()
        """Names of the traits that were set since the last send."""
        self._resync_at = time.monotonic() + RESYNC_S
        self.make_locks()
        _made.add(self)
        super().__init__(**kwargs)

    def make_locks(self) -> None:
        """Make free locks; see `NewestSample.make_locks`."""
        self._newest.make_locks()
        self._send_lock = threading.RLock()

    def follow_player(self) -> None:
        """Follow a player in the page, which feeds this widget. It then shows a recorded time, and needs no kernel."""
        with self._send_lock:
            self.driven_by_player, self._beat = True, 0
            self._trait_values["history"] = 0  # without observers, because its player holds a lock
        self.send_state("history")

    def send_newest(self) -> int:
        """Send the newest sample to the page; returns the number of bytes sent. The pacer calls it."""
        if os.getpid() != self._process:
            self._log_once(
                "nothing reaches the page from a forked process; hand messages to the notebook's own, "
                "through a multiprocessing.Queue, and update there"
            )
            return 0
        with self._send_lock:
            # Bypasses the descriptors of the traits, which would take longer than everything else here.
            values = self._trait_values
            comm = values.get("comm")
            if comm is None:
                return 0
            may_send = self._may_send_frame()
            if may_send:
                self._bring_up_to_date()
            frame, about = newest = (values["_frame"], values["_about"]) if may_send else self._sent
            keys = []
            if not self.driven_by_player:
                keys += ["_frame"] if frame != self._sent[0] else []
                keys += ["_about"] if about != self._sent[1] else []
            unsent: tuple[str, ...] = ()
            if self._unsent:
                with self._newest.lock:
                    unsent = tuple(self._unsent)
                    self._unsent.clear()
                keys += unsent
            if not self.driven_by_player:
                keys += self._due_beat()
            if keys and not self.driven_by_player and time.monotonic() >= self._resync_at:
                keys = [*dict.fromkeys((*keys, *RESYNC_TRAITS))]
                self._resync_at = time.monotonic() + RESYNC_S
            if "_frame" in keys:
                self._before_frame(frame)
            try:
                if keys in (["_frame"], ["_frame", "_about"]):
                    # The message that ipywidgets would build, without its cost.
                    state = {"_about": about} if "_about" in keys else {}
                    update = {"method": "update", "state": state, "buffer_paths": [["_frame"]], **message_padding()}
                    comm.send(data=update, buffers=[frame])
                elif keys:
                    super().send_state(keys)
            except BaseException:
                with self._newest.lock:
                    self._unsent.update(unsent)
                raise
            if "_frame" in keys:
                self._sent_frames.add(TimedFrame(self._newest.arrived, about, frame), self.history)
            self._sent = newest
            return len(frame) if "_frame" in keys else 0

    def _may_send_frame(self) -> bool:
        """Return True if the newest frame may go now. Called with the send lock."""
        return True

    def _before_frame(self, frame: bytes) -> None:
        """Note that a frame goes to the page now, which may answer at once. Called with the send lock."""

    def sent_frames(self) -> list[TimedFrame]:
        """Return the frames of its history, oldest first, up to the frame of the newest sample."""
        with self._send_lock:
            self._bring_up_to_date()
            newest = TimedFrame(self._newest.arrived, self._about, self._frame)
            kept = [sent for sent in self._sent_frames if sent.frame != newest.frame]
        return [*kept, newest] if newest.frame else kept

    def send_state(self, key: str | Iterable[str] | None = None) -> None:
        """Send traits to the page with the next sample, or all of them at once if a page requests them (no names)."""
        if key is None or self.comm is None:
            super().send_state(key)
            return
        with self._newest.lock:
            self._unsent.update((key,) if isinstance(key, str) else key)
        pacer.mark(self)

    def close(self) -> None:
        """Remove the widget from the page."""
        with self._send_lock:
            super().close()
            pacer.forget(self)


_made: weakref.WeakSet[PacedWidget] = weakref.WeakSet()


def _after_fork() -> None:
    for widget in _made:
        widget.make_locks()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)
