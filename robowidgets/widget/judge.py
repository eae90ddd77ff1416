"""The thread in which a widget's conditions are judged."""

from __future__ import annotations

import logging
import threading
from collections.abc import Callable
from typing import Any, Protocol

from ..runtime.log_once import LogOnce
from ..runtime.policies import CONDITION
from ..runtime.runner import Call, Runner
from .newest_sample import NewestSample, Shot
from .pacer import Sender, pacer
from .watch import Watch

log = logging.getLogger("robowidgets")

PATIENCE = CONDITION.late
"""Seconds for which a picture waits for the verdicts on its sample. After that it is shown without them."""


class JudgedWidget(Sender, Protocol):
    """A widget with samples to judge."""

    @property
    def title(self) -> str:
        """Its title, for the log."""


class Judge:
    """Judges the newest sample of a widget by all of its watches, in a thread of its own.

    The picture of a sample is sent once its verdicts are known, so that a lamp always belongs to the sample on show. A
    function that takes longer than `PATIENCE` does not hold the picture back: its lamp is unknown then. A function that
    does not return is ended when its watch is removed or replaced, or when the feed of the widget is closed.

    Args:
        widget: the widget, which the pacer sends once the verdicts are known.
        newest: its newest sample.
        to_judge: returns the sample to judge for a shown sample, or None before the first.
        waits: True if a new sample waits for its verdicts while the one before is on show.
    """

    def __init__(
        self, widget: JudgedWidget, newest: NewestSample[Any], to_judge: Callable[[Any], Any], *, waits: bool
    ) -> None:
        self._widget = widget
        self._newest = newest
        self._to_judge, self._waits = to_judge, waits
        self.watches: dict[str, Watch] = {}
        self.make_runner()
        self._newest.on_new = self._on_new
        self._seen = self._done = 0
        """The version that was taken last, and the one that was judged last."""
        self._shot: Shot | None = None
        self._lamps: list[dict[str, Any]] = []
        self._ends_late = False
        """True if a function that is late is ended."""
        self._log = LogOnce(log.error)

    def make_runner(self) -> None:
        """Make the runner; again in a forked process, which has a new lock and no thread of the runner."""
        self._runner = Runner(
            self._judge_newest, self._newest.lock, "robowidgets-judge", CONDITION, on_look=self._mark_late
        )

    def put(self, watch: Watch) -> None:
        """Add a watch; it replaces an earlier one of the same name."""
        with self._newest.lock:
            before = self.watches.get(watch.name)
            self.watches[watch.name] = watch
            self._restart(before)
        if before is not None:  # the truth value of a watch is its verdict
            before.end("another condition has its name now")

    def remove(self, name: str) -> None:
        """Remove a watch."""
        with self._newest.lock:
            gone = self.watches.pop(name)
            self._restart(gone)
        pacer.mark(self._widget)
        gone.end("it is no longer watched")

    def close(self) -> None:
        """End the thread, and the waits for its watches."""
        with self._newest.lock:
            self._newest.on_new = None
            self._detach_worker()
            watches = list(self.watches.values())
        for watch in watches:
            watch.end("its widget is closed")

    def end_late(self) -> None:
        """End a function that is late or becomes late before the next sample, because its source is closed."""
        with self._newest.lock:
            self._ends_late = True
        self._mark_late()

    def _mark_late(self) -> None:
        """Show the picture without its verdicts."""
        if not self.is_late:
            return
        late = self._runner.current
        if self._ends_late and isinstance(late, Watch):
            late.switch_off(f"{self._late_text(late)}, and was ended with its feed")
            with self._newest.lock:
                self._restart(late)
        pacer.mark(self._widget)

    def _on_new(self) -> None:
        self._ends_late = False
        self._wake()

    def _wake(self) -> None:
        if self.watches:
            self._runner.wake()

    def choose(self, packed: int) -> tuple[Shot | None, list[dict[str, Any]]]:
        """Return the shot to send to the page, or None while its verdicts are due in a moment, and its lamps.

        Called with the lock of the samples.

        Args:
            packed: the version that was packed last.
        """
        newest = self._newest.shot()
        if not self.watches:
            return newest, []
        if self._done == newest.version:
            return newest, self._lamps
        if self._shot is not None and self._shot.version > packed and self._waits:
            return self._shot, self._lamps
        if not self.is_late:
            return None, []  # the runner marks the widget when it becomes late
        return newest, [self._unknown(watch) for watch in self.watches.values()]

    def await_verdicts(self) -> None:
        """Wait a moment for the verdicts on the newest sample, at the end of a cell in the main thread.

        So a notebook is saved with the last sample. Called without the lock of the samples.
        """
        if self.watches and threading.current_thread() is threading.main_thread():
            self._newest.waiters.wait_for(lambda: self._done == self._newest.version or None, PATIENCE)

    def will_mark(self) -> bool:
        """Return True if it will mark the widget in a moment, with the verdicts on the newest version."""
        return bool(self.watches) and self._done != self._newest.version and not self.is_late

    @property
    def is_late(self) -> bool:
        """True while the judgement of one sample takes longer than a picture waits for it."""
        return self._runner.is_late

    @property
    def busy_for(self) -> float:
        """Seconds since the judgement of a sample began; 0 while it waits for one."""
        return self._runner.busy_for

    def _restart(self, gone: Watch | None) -> None:
        """Judge the newest sample again, in another thread if this one runs a function that is no longer watched."""
        self._seen = self._done = 0
        self._shot = None
        self._newest.changed = True
        is_in_it = gone is not None and self._runner.current is gone
        if is_in_it or not self.watches:
            self._detach_worker()
        self._wake()

    def _detach_worker(self) -> None:
        """Detach the worker. Called with the lock."""
        self._runner.detach()
        self._newest.waiters.wake()

    def _judge_newest(self, call: Call) -> float | None:
        """Judge the newest version, unless it is judged already."""
        newest = self._newest
        with newest.lock:
            if self._seen == newest.version:
                return None
            self._seen = newest.version
            shot, watches = newest.shot(), list(self.watches.values())
        sample, error, _ = call(self._to_judge, shot.sample, of=self)  # None, so unknown, if it raises
        if error is not None:
            self._log(f"{self._widget.title}: {type(error).__name__}: {error}".strip())
        for watch in watches:
            call(watch.judge, sample, of=watch)
            if watch.error:
                self._log(f"{self._widget.title} {watch.name}: {watch.error}".strip(), watch.error)
        with newest.lock:
            if self._seen == shot.version:  # else another watch was added meanwhile
                self._done, self._shot = shot.version, shot
                self._lamps = [watch.lamp() for watch in watches]
                newest.changed = True  # even if it is already on show with unknown lamps
            newest.waiters.wake()
        pacer.mark(self._widget)
        return 0.0  # there may be a newer one

    def _unknown(self, watch: Watch) -> dict[str, Any]:
        """Return the lamp of a watch without a verdict."""
        lamp = watch.lamp()
        if lamp["state"] == "off":
            return lamp
        text = self._late_text(watch) if watch is self._runner.current else ""
        return {**lamp, "state": "unknown", "text": text, "rays": []}

    def _late_text(self, watch: Watch) -> str:
        """Return a text with the time for which a running condition has not returned, and the line it is at."""
        return f"has not returned for {self.busy_for:.1f} s{self._runner.where(watch.condition)}"
