"""Sending a recording to the page ahead of the shown time, so that it plays without the kernel."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import AbstractContextManager
from heapq import merge
from itertools import chain
from math import floor
from typing import Any

from ..notebook.progress import without_bars
from ..repair import RecordingError
from ..runtime.clock import Clock, ConditionVariable, scheduler
from ..tracks import Track, pack

log = logging.getLogger("robowidgets")

SEGMENT = 1.0
"""Seconds of a recording that are sent in one message."""

AHEAD = 10.0
"""Seconds of wall-clock time for which the page has segments ahead of the shown time."""

KEPT_BYTES = 64_000_000
"""The maximum size of the segments that the page keeps; the segments farthest from the shown time are dropped first."""

KEPT_SEGMENTS = 7200
"""The maximum number of segments that the page keeps: a recording that is silent for weeks has millions of empty ones.
"""

BYTES_PER_SECOND = 10_000_000
"""Half of the bytes per second that a page can process; the other half is left to all other messages."""

PATIENCE = 3.0
"""Seconds to wait for the page's request. A busy kernel does not receive it, so then segments are sent without one."""

LINGER = 600.0
"""Seconds of idleness after which the thread ends and closes its file. A new thread starts when it is needed. Once all
segments are sent, the thread ends at once."""

POINTED = 8
"""The number of segments that the pointer visited last and that the page keeps, however far they are."""

CLOSE_TIMEOUT = 2.0
"""The maximum number of seconds that `Prefetcher.close` waits for the thread, which may read a slow file."""

ANSWER = 0.03
"""The maximum number of seconds that `Prefetcher.point` waits for a segment, which leaves the GIL to the thread."""

_AT_EASE = 4
"""Idle time of the thread per working time, if nothing is urgent."""

_BEHIND = 3
"""The factor on the distance of segments before the shown time: playing moves away from them."""

Send = Callable[[dict[str, Any], list[bytes]], None]


class Cursor:
    """The shown time, extrapolated between updates, because a busy kernel gets no messages.

    Args:
        clock: returns the seconds of a monotonic clock.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.set_to = 0.0
        self._set_at = clock()
        self.rate = 0.0
        self.span = (0.0, 0.0)
        self.loops = False

    def set_time(self, seconds: float, rate: float, span: tuple[float, float], *, loops: bool = False) -> None:
        """Set the shown time, its rate (0 if it stands still), the span that is played, and True if the span loops."""
        self.set_to, self._set_at = seconds, self._clock()
        self.rate, self.span, self.loops = rate, span, loops

    @property
    def seconds(self) -> float:
        """The shown time now, if the page never had to wait for a segment."""
        seconds = self.set_to + (self._clock() - self._set_at) * self.rate
        start, end = self.span
        if not self.rate or seconds <= end:
            return seconds
        return start + (seconds - start) % (end - start) if self.loops and end > start else max(self.set_to, end)


class Prefetcher:
    """A sender of segments to the page, with a thread that runs while segments are to be sent.

    The segments that are shown soon come first. If the page requested any, all others that it can keep follow, because
    the kernel does not receive requests while a cell runs.

    Args:
        tracks: opens the track of each widget; called once in each thread.
        send: sends a message to the page.
        duration: seconds of the recording.
        complain: called with a line of text if the recording can be read no further.
        clock: the clock by which the page plays.
    """

    def __init__(
        self,
        tracks: Callable[[], AbstractContextManager[Sequence[Track]]],
        send: Send,
        duration: float,
        complain: Callable[[str], None],
        clock: Clock = scheduler.clock,
    ) -> None:
        self._clock = clock
        self.cursor = Cursor(clock.now)
        self._open = tracks
        self._send = send
        self._last = floor(duration / SEGMENT)
        self._complain = complain
        self._sent: dict[int, int] = {}
        self._sending: int | None = None
        """One of these, until it is sent to its end."""
        self._largest = 0
        self._outdated: set[int] = set()
        self._edition = 0
        self._pointed: list[int] = []
        self._lock = threading.RLock()
        self._change = clock.condition(self._lock)
        self._answer = clock.condition(self._lock)
        self._asked = False
        self._closed = False
        self._patience = PATIENCE
        self._thread: threading.Thread | None = None
        """The thread that sends segments, or None while no segment is wanted."""
        self._running: threading.Thread | None = None
        """The same thread, until it has closed its file."""
        self._over = clock.condition(self._lock)
        with self._lock:
            self._wake()

    def set_time(self, seconds: float | None, rate: float, span: tuple[float, float], *, loops: bool = False) -> None:
        """Set the shown time, or keep its current value if None. See `Cursor`."""
        with self._lock:
            self.cursor.set_time(self._here() if seconds is None else seconds, rate, span, loops=loops)
            self._wake()

    def point(self, seconds: float) -> None:
        """Send the segment at a time that the page may show next, or shows now, and keep it there for a while.

        Segments that are played come first. While nothing is played, this returns once the segment is sent, or after
        `ANSWER` seconds.
        """
        with self._lock:
            index = min(max(0, floor(seconds / SEGMENT)), self._last)
            self._pointed = [index, *(other for other in self._pointed if other != index)][:POINTED]
            self._wake()
            if index in self._at_once():
                self._wait(self._answer, lambda: self._has_gone(index) or self._closed, ANSWER)

    def start(self) -> None:
        """Send everything again, because the page has nothing, or its frames are out of date."""
        with self._lock:
            self._edition += 1
            self._outdated.update(self._sent)
            self._sent.clear()
            self._pointed.clear()
            self._asked = True
            self._wake()

    def close(self) -> None:
        """Send nothing more, and end the thread; closing it again does nothing. It waits for a moment at most."""
        with self._lock:
            self._closed = True
            thread = self._running
            self._change.notify_all()
            if thread is None or thread is threading.current_thread():
                return
            self._wait(self._over, lambda: self._running is not thread, CLOSE_TIMEOUT)
            is_over = self._running is not thread
        if is_over:
            thread.join()

    def _wake(self) -> None:
        """Notify the thread of a change, or start it if a segment is wanted. Called with the lock held."""
        if self._thread:
            self._change.notify_all()
        elif not self._closed and self._wanted() is not None:
            thread = threading.Thread(target=self._run, name="robowidgets-prefetcher", daemon=True)
            self._thread = self._running = thread
            self._clock.began(thread)
            thread.start()

    def _wait(self, changed: ConditionVariable, is_over: Callable[[], bool], seconds: float) -> None:
        """Wait for some seconds at most until a condition is true. Called with the lock held."""
        until = self._clock.now() + seconds
        while not is_over() and changed.wait_until(until):
            pass

    def _run(self) -> None:
        try:
            with self._lock:
                self._wait(self._change, lambda: self._asked or self._closed, self._patience)
                self._patience = 0.0
            # Without progress bars: bars of a background thread would appear below any cell.
            with without_bars(), self._open() as tracks:
                while (index := self._await()) is not None:
                    began = time.thread_time()
                    rest = self._send_one(tracks, index) / BYTES_PER_SECOND
                    if index not in self._soon():
                        rest += _AT_EASE * (time.thread_time() - began)
                    with self._lock:
                        self._wait(self._change, lambda: self._closed or self._lacks(), rest)
        except RecordingError as error:
            self._give_up(str(error))
        except Exception as error:
            log.exception("robowidgets: a recording can be played no further")
            self._give_up(f"{type(error).__name__}: {error}")
        finally:
            with self._lock:
                if self._running is threading.current_thread():
                    self._running = None
                self._over.notify_all()

    def _await(self) -> int | None:
        """Wait for the next segment to send; return None if this thread is not needed any more."""
        with self._lock:
            while not self._closed:
                index = self._wanted()
                if index is not None:
                    return index
                if len(self._sent) > self._last:
                    break
                rate = self.cursor.rate
                changed = self._change.wait_until(self._clock.now() + (SEGMENT / 4 / rate if rate else LINGER))
                if not changed and not rate:
                    break
            self._thread = None
            return None

    def _wanted(self) -> int | None:
        """Return the most urgent segment that the page lacks, or None."""
        wanted = chain(self._at_once(), self._soon(), self._pointed_kept(), self._rest())
        return next((index for index in wanted if index not in self._sent), None)

    def _give_up(self, problem: str) -> None:
        with self._lock:
            was_closed, self._closed = self._closed, True
        if not was_closed:
            self._complain(problem)

    def _here(self) -> float:
        """Return the shown time: the page stops at the first segment that it lacks."""
        cursor = self.cursor
        seconds = cursor.seconds
        passed = range(floor(cursor.set_to / SEGMENT), floor(seconds / SEGMENT) + 1)
        missing = next((i for i in passed if i not in self._sent), None)
        return seconds if missing is None else max(cursor.set_to, missing * SEGMENT)

    def _lacks(self) -> bool:
        """Return True if the page lacks a segment that it shows now, or may show at any moment."""
        return any(index not in self._sent for index in self._at_once())

    def _at_once(self) -> list[int]:
        """Return the shown segment, and the next one while it plays, otherwise the segments under the pointer."""
        soon = self._soon()
        return soon[:2] if self.cursor.rate else [*soon[:1], *self._pointed_kept()]

    def _pointed_kept(self) -> list[int]:
        """Return the segments under the pointer that are kept; at most an eighth of the page's memory."""
        each = self._usual_size
        return self._pointed[: floor(KEPT_BYTES / 8 / each)] if each else self._pointed

    @property
    def _usual_size(self) -> float:
        """The mean size of the segments that were sent, in bytes; 0 before the first."""
        return sum(self._sent.values()) / max(1, len(self._sent))

    def _soon(self) -> list[int]:
        """Return the segments that the page shows soon, the most urgent first; at most half of its memory."""
        cursor = self.cursor
        here, (first, last) = floor(self._here() / SEGMENT), (floor(s / SEGMENT) for s in cursor.span)
        each = self._usual_size
        count = floor(AHEAD * max(cursor.rate, 1.0) / SEGMENT) + 1
        if each:
            count = max(2, min(count, floor(KEPT_BYTES / 2 / each)))
        ahead = list(range(here, min(here + count, self._last + 1)))
        # The start of a loop follows its end.
        again = range(first, min(first + max(0, here + count - 1 - last), last + 1)) if cursor.loops else ()
        return list(dict.fromkeys([*ahead[:2], here - 1, *ahead[2:], *again] if here else [*ahead, *again]))

    def _rest(self) -> Iterator[int]:
        """Yield all other segments that the page can keep, the nearest first; farther ones are dropped for them."""
        if not self._asked or not self._sent:
            return
        usual = self._usual_size
        soon = {*self._soon(), *self._pointed_kept()}
        size, count = self._largest + sum(self._sent.get(index, usual) for index in soon), len(soon)
        here = floor(self._here() / SEGMENT)
        for index in merge(range(here + 1, self._last + 1), range(here, -1, -1), key=self._distance()):
            if index in soon:
                continue
            size, count = size + self._sent.get(index, usual), count + 1
            if size > KEPT_BYTES or count > KEPT_SEGMENTS:
                return
            yield index

    def _distance(self) -> Callable[[int], float]:
        """Return a function for the distance of a segment from the shown time, `_BEHIND` times as large before it."""
        here = self._here() / SEGMENT
        return lambda index: index - here if index > here else _BEHIND * (here - index)

    def _send_one(self, tracks: Sequence[Track], index: int) -> int:
        edition = self._edition
        abouts, frames = segment(tracks, index)
        size = sum(map(len, frames))
        with self._lock:
            if edition != self._edition or self._closed:
                return 0
            self._sent[index], self._sending = size, index
            self._largest = max(self._largest, size)
            dropped = self._dropped()
        self._send({"segment": index, "drop": dropped, "abouts": abouts}, frames)
        with self._lock:
            self._sending = None
            self._answer.notify_all()
        return size

    def _has_gone(self, index: int) -> bool:
        """Return True if a segment was sent to its end."""
        return index in self._sent and index != self._sending

    def _dropped(self) -> list[int]:
        """Forget the segments that the page cannot keep, and return them with the out-of-date ones."""
        spare = sorted(self._sent.keys() - {*self._soon(), *self._pointed_kept()}, key=self._distance())
        dropped = sorted(self._outdated - self._sent.keys())
        self._outdated.clear()
        while spare and (sum(self._sent.values()) > KEPT_BYTES or len(self._sent) > KEPT_SEGMENTS):
            dropped.append(spare.pop())
            del self._sent[dropped[-1]]
        return dropped


def segment(tracks: Sequence[Track], index: int) -> tuple[list[list[dict[str, Any]]], list[bytes]]:
    """Pack one segment for the page: the texts on the frames of every track, and the frames."""
    start = index * SEGMENT
    packed = [pack(list(track.frames(start, start + SEGMENT))) for track in tracks]
    return [abouts for abouts, _ in packed], [frames for _, frames in packed]
