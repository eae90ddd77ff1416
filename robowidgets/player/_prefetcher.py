"""Sends a recording to the page ahead of its time, stretch by stretch, so that it plays there without the kernel."""

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

from .._core.progress import one_bar
from ..repair.source import RecordingError
from ._frames import Track, pack

log = logging.getLogger("robowidgets")

STRETCH = 1.0
"""Seconds of a recording that travel together."""

AHEAD = 10.0
"""Seconds, on the clock on the wall, that the page is ahead of what it shows."""

KEPT_BYTES = 64_000_000
"""Most that the page keeps; what lies farthest from the time on show is dropped first."""

KEPT_STRETCHES = 7200
"""Most stretches that the page keeps: where nothing was recorded for weeks, there are millions with nothing in them."""

BYTES_PER_SECOND = 10_000_000
"""Half of what a page takes: the rest is for all else."""

PATIENCE = 3.0
"""Seconds until a page that says nothing is taken to be there: a busy kernel does not hear it."""

LINGER = 600.0
"""Seconds without anything to do after which the thread ends and its file is closed, until there is. Where all was sent
they end at once."""

POINTED = 8
"""Stretches, those pointed at last, that the page keeps however far they are."""

ANSWER = 0.03
"""Seconds at most for which the thread that brings a page's question leaves the processor to the one that answers."""

_AT_EASE = 4
"""How much longer than it works the thread rests while nothing is urgent."""

_BEHIND = 3
"""How many times as far what lies behind counts."""

Send = Callable[[dict[str, Any], list[bytes]], None]


class Cursor:
    """Where a player is: told now and then, and reckoned in between, because a busy kernel hears nothing.

    Args:
        clock: seconds that pass.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self._clock = clock
        self.told = 0.0
        self._told_at = clock()
        self.rate = 0.0
        self.span = (0.0, 0.0)
        self.loops = False

    def tell(self, seconds: float, rate: float, span: tuple[float, float], *, loops: bool = False) -> None:
        """Tell the time on show, how fast it passes (0: it stands), from where to where, and if again and again."""
        self.told, self._told_at = seconds, self._clock()
        self.rate, self.span, self.loops = rate, span, loops

    @property
    def seconds(self) -> float:
        """The time on show now, if nothing had to be waited for."""
        seconds = self.told + (self._clock() - self._told_at) * self.rate
        start, end = self.span
        if not self.rate or seconds <= end:
            return seconds
        return start + (seconds - start) % (end - start) if self.loops and end > start else max(self.told, end)


class Sender:
    """Keeps the page supplied, from a thread that is there while there is something to do.

    First comes what is shown soon; then, to a page that asked, all the rest as far as it is kept, because a page that
    plays while a cell runs is not heard.

    Args:
        tracks: opens what each widget shows; called in each thread, once.
        send: hands a message to the page.
        duration: seconds of the recording.
        complain: is told in a line why it can go on no further.
    """

    def __init__(
        self,
        tracks: Callable[[], AbstractContextManager[Sequence[Track]]],
        send: Send,
        duration: float,
        complain: Callable[[str], None],
    ) -> None:
        self.cursor = Cursor()
        self._open = tracks
        self._send = send
        self._last = floor(duration / STRETCH)
        self._complain = complain
        self._sent: dict[int, int] = {}
        self._largest = 0
        self._stale: set[int] = set()
        self._edition = 0
        self._pointed: list[int] = []
        lock = threading.RLock()
        self._change = threading.Condition(lock)
        self._answer = threading.Condition(lock)
        self._asked = False
        self._closed = False
        self._patience = PATIENCE
        self._thread: threading.Thread | None = None
        with self._change:
            self._wake()

    def tell(self, seconds: float | None, rate: float, span: tuple[float, float], *, loops: bool = False) -> None:
        """Tell where the player is; None: where it is reckoned to be. See `Cursor`."""
        with self._change:
            self.cursor.tell(self._here() if seconds is None else seconds, rate, span, loops=loops)
            self._wake()

    def point(self, seconds: float) -> None:
        """Send what lies at a time, to which the page may go next or has gone, and keep it there for a while.

        What plays comes first. Where nothing does it was sent when this returns, unless that takes long.
        """
        with self._change:
            index = min(max(0, floor(seconds / STRETCH)), self._last)
            self._pointed = [index, *(other for other in self._pointed if other != index)][:POINTED]
            self._wake()
            if index in self._at_once():
                self._answer.wait_for(lambda: index in self._sent or self._closed, ANSWER)

    def start(self) -> None:
        """Send all anew: to a page that has nothing, or whose stills are not right any more."""
        with self._change:
            self._edition += 1
            self._stale.update(self._sent)
            self._sent.clear()
            self._pointed.clear()
            self._asked = True
            self._wake()

    def close(self) -> None:
        """End the thread; doing it again does nothing."""
        with self._change:
            self._closed = True
            thread = self._thread
            self._change.notify()
        if thread and thread is not threading.current_thread():
            thread.join()

    def _wake(self) -> None:
        """Tell the thread of a change; have one, if there is something to do. With the lock held."""
        if self._thread:
            self._change.notify()
        elif not self._closed and self._wanted() is not None:
            self._thread = threading.Thread(target=self._run, name="robowidgets-player", daemon=True)
            self._thread.start()

    def _run(self) -> None:
        try:
            with self._change:
                self._change.wait_for(lambda: self._asked or self._closed, self._patience)
                self._patience = 0.0
            # Nobody asked for what a thread does; its bars would stand in any cell.
            with one_bar(), self._open() as tracks:
                while (index := self._await()) is not None:
                    began = time.thread_time()
                    rest = self._send_one(tracks, index) / BYTES_PER_SECOND
                    if index not in self._soon():
                        rest += _AT_EASE * (time.thread_time() - began)
                    with self._change:
                        self._change.wait_for(lambda: self._closed or self._lacks(), rest)
        except RecordingError as error:
            self._give_up(str(error))
        except Exception as error:
            log.exception("robowidgets: a recording can be played no further")
            self._give_up(f"{type(error).__name__}: {error}")

    def _await(self) -> int | None:
        """The stretch that is wanted next, when there is one; None when this thread is not needed any more."""
        with self._change:
            while not self._closed:
                index = self._wanted()
                if index is not None:
                    return index
                if len(self._sent) > self._last:
                    break
                rate = self.cursor.rate
                told = self._change.wait(STRETCH / 4 / rate if rate else LINGER)
                if not told and not rate:
                    break
            self._thread = None
            return None

    def _wanted(self) -> int | None:
        """The stretch that the page lacks most, if there is one."""
        wanted = chain(self._at_once(), self._soon(), self._lent(), self._rest())
        return next((index for index in wanted if index not in self._sent), None)

    def _give_up(self, words: str) -> None:
        with self._change:
            self._closed = True
        self._complain(words)

    def _here(self) -> float:
        """The time on show now: the page goes no further than what it has."""
        cursor = self.cursor
        seconds = cursor.seconds
        passed = range(floor(cursor.told / STRETCH), floor(seconds / STRETCH) + 1)
        missing = next((i for i in passed if i not in self._sent), None)
        return seconds if missing is None else max(cursor.told, missing * STRETCH)

    def _lacks(self) -> bool:
        """Whether the page shows, or may show at any moment, what it does not have."""
        return any(index not in self._sent for index in self._at_once())

    def _at_once(self) -> list[int]:
        """What the page shows, and shows next: where it plays what follows, else what a person points at."""
        soon = self._soon()
        return soon[:2] if self.cursor.rate else [*soon[:1], *self._lent()]

    def _lent(self) -> list[int]:
        """What a person points at; an eighth of what the page keeps, at most."""
        each = sum(self._sent.values()) / max(1, len(self._sent))
        return self._pointed[: floor(KEPT_BYTES / 8 / each)] if each else self._pointed

    def _soon(self) -> list[int]:
        """The stretches that the page is about to show, the most urgent first; half of what it keeps, at most."""
        cursor = self.cursor
        here, (first, last) = floor(self._here() / STRETCH), (floor(s / STRETCH) for s in cursor.span)
        each = sum(self._sent.values()) / max(1, len(self._sent))
        count = floor(AHEAD * max(cursor.rate, 1.0) / STRETCH) + 1
        if each:
            count = max(2, min(count, floor(KEPT_BYTES / 2 / each)))
        ahead = list(range(here, min(here + count, self._last + 1)))
        # At the end of what is looped the start comes next.
        again = range(first, min(first + max(0, here + count - 1 - last), last + 1)) if cursor.loops else ()
        return list(dict.fromkeys([*ahead[:2], here - 1, *ahead[2:], *again] if here else [*ahead, *again]))

    def _rest(self) -> Iterator[int]:
        """All others, the nearest first, as far as the page keeps them; what lies farther is dropped for them."""
        if not self._asked or not self._sent:
            return
        usual = sum(self._sent.values()) / len(self._sent)
        soon = {*self._soon(), *self._lent()}
        size, count = self._largest + sum(self._sent.get(index, usual) for index in soon), len(soon)
        here = floor(self._here() / STRETCH)
        for index in merge(range(here + 1, self._last + 1), range(here, -1, -1), key=self._distance()):
            if index in soon:
                continue
            size, count = size + self._sent.get(index, usual), count + 1
            if size > KEPT_BYTES or count > KEPT_STRETCHES:
                return
            yield index

    def _distance(self) -> Callable[[int], float]:
        """How far a stretch is from the time on show; more so when it lies behind, for time goes on."""
        here = self._here() / STRETCH
        return lambda index: index - here if index > here else _BEHIND * (here - index)

    def _send_one(self, tracks: Sequence[Track], index: int) -> int:
        edition = self._edition
        packed = stretch(tracks, index)
        size = sum(len(track) for _, track in packed)
        with self._change:
            if edition != self._edition:
                return 0
            self._sent[index] = size
            self._largest = max(self._largest, size)
            dropped = self._dropped()
        self._send(
            {"stretch": index, "drop": dropped, "abouts": [abouts for abouts, _ in packed]}, [raw for _, raw in packed]
        )
        with self._change:
            self._answer.notify_all()
        return size

    def _dropped(self) -> list[int]:
        """Take out what is more than the page keeps, and what is stale."""
        spare = sorted(self._sent.keys() - {*self._soon(), *self._lent()}, key=self._distance())
        dropped = sorted(self._stale - self._sent.keys())
        self._stale.clear()
        while spare and (sum(self._sent.values()) > KEPT_BYTES or len(self._sent) > KEPT_STRETCHES):
            dropped.append(spare.pop())
            del self._sent[dropped[-1]]
        return dropped


def stretch(tracks: Sequence[Track], index: int) -> list[tuple[list[dict[str, Any]], bytes]]:
    """One stretch of every track, packed for the page."""
    start = index * STRETCH
    return [pack(list(track.stills(start, start + STRETCH))) for track in tracks]
