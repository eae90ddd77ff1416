"""A recording that is played back like a running robot."""

from __future__ import annotations

import heapq
import os
from collections.abc import Mapping
from typing import Any

import numpy as np

from ..recordings import RecordingData
from ..recordings.topics import Topic
from ..runtime.clock import Clock
from ..samples import HasAge
from ..samples.age import note_arrival
from ..samples.checks import finite
from ._threaded import ThreadedMiddleware
from ._topics import YOURS
from .feed import Feed
from .middleware import Advert, FeedError, Listener

_SHORTEST_ROUND = 0.1


class Played(ThreadedMiddleware):
    """A recording as a `Middleware`. A thread plays it from the moment of opening.

    Args:
        recording: the recording. Nothing else may read it at the same time, and closing the feed closes it.
        speed: seconds of the recording per second.
        loop: True to start again at its end.
        clock: as for `ThreadedMiddleware`.
    """

    def __init__(self, recording: RecordingData, speed: float, loop: bool, clock: Clock | None = None) -> None:
        super().__init__(clock)
        self._recording = recording
        self._speed = speed
        self._loop = loop
        self._is_woken = False
        self._listener: Listener
        self._adverts: list[Advert] = []

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return self._recording.path.name

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        listener.on_connected()
        self._listener = listener
        self._adverts = [Advert(topic.name, topic.type, publishers=None) for topic in self._recording.topics]
        listener.on_topics(self._adverts)
        self._start_thread("robowidgets-replay", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`. Nothing moves. The speed is listed next to the recorded one, as a topic of the program."""
        if self._closed.is_set():
            raise FeedError(f"{self.where} is closed: open the feed again")
        if all(known.name != topic for known in self._recording.topics):
            return  # the feed itself shows what it publishes
        own = Advert(f"{topic}{YOURS}", message_type)
        if own not in self._adverts:
            self._adverts = [*self._adverts, own]
            self._listener.on_topics(self._adverts)
        self._listener.on_message(own.name, message)

    def close(self) -> None:
        """See `Middleware`."""
        super().close()
        if self._thread is None:
            self._recording.close()

    def _wake_session(self) -> None:
        self._is_woken = True
        self._changed.notify_all()

    def _run_session(self, listener: Listener) -> str:
        started = self._clock.now()
        with self._recording:
            while True:
                self._is_woken = False
                if self._closed.is_set():
                    return ""
                topics = self._recording.topics
                names = frozenset(topic.name for topic in topics if self._is_wanted(topic, listener))
                ended = self._play(listener, names, started)
                if ended and self._loop:
                    started += max(self._recording.duration / self._speed, _SHORTEST_ROUND)
                elif ended:
                    for name in names:
                        listener.on_trouble(name, f"{self.where} is at its end")
                    self._is_woken_before(None)

    def _is_wanted(self, topic: Topic, listener: Listener) -> bool:
        """Return True if a topic is to be played. Report a wanted topic that cannot be read."""
        if topic.name not in self._wanted:
            return False
        if topic.problem and not topic.widget:
            listener.on_trouble(topic.name, f"{topic.name} cannot be read: {topic.problem}")
            return False
        return True

    def _play(self, listener: Listener, names: frozenset[str], started: float) -> bool:
        """Pass on the samples from now on, each in time, until other topics are wanted. Return True if it ended."""
        now = max((self._clock.now() - started) * self._speed, 0.0)
        shown = names & {topic.name for topic in self._recording.topics if topic.widget}
        samples = [self._recording.samples(shown, start=now)] if shown else []
        messages = [self._recording.messages(name, start=now) for name in sorted(names - shown)]
        for moment in heapq.merge(*samples, *messages, key=lambda moment: moment.time_ns):
            if self._is_woken_before(started + moment.seconds / self._speed):
                return False
            if isinstance(moment.sample, HasAge):
                note_arrival(moment.sample)
            listener.on_message(moment.topic, moment.sample)
        return not self._is_woken_before(started + self._recording.duration / self._speed)

    def _is_woken_before(self, when: float | None) -> bool:
        """Wait until other topics are wanted or a time is reached. Return True if other topics are wanted."""
        with self._lock:
            while not self._is_woken and self._changed.wait_until(when):
                pass
            return self._is_woken


def recording(path: str | os.PathLike[str], *, speed: float = 1.0, loop: bool = False) -> Feed:
    """Open a feed of a recording, played as if it were live.

    Args:
        path: the recording, as for `robowidgets.open`.
        speed: seconds of the recording per second, above 0.
        loop: True to start again at its end.

    Raises:
        RecordingError: the recording cannot be read. The text gives the reason.
        TypeError: the path is not a path, the speed is not a number, or loop is neither True nor False. ValueError:
            the speed is not finite and above 0.

    Examples:
        >>> from robowidgets import SAMPLE, feeds
        >>> with feeds.recording(SAMPLE, speed=10) as feed:
        ...     view = feed.show()
        >>> sorted(view.widgets)
        ['/bumper', '/odom', '/scan']
    """
    if not isinstance(path, (str, bytes, os.PathLike)):
        got = "None" if path is None else f"a {type(path).__name__}"
        hint = (
            "; an open recording has a path: feeds.recording(recording.path)" if isinstance(path, RecordingData) else ""
        )
        raise TypeError(f"recording(): expected the path of a file or folder, such as 'drive.bag', got {got}{hint}")
    if not isinstance(loop, (bool, np.bool_)):
        raise TypeError(f"loop: expected True or False, got {loop!r}")
    if finite("speed", speed, "seconds of the recording in a second") <= 0:
        raise ValueError(f"speed: expected seconds of the recording in a second, above 0, got {speed!r}")
    return Feed(Played(RecordingData(path), speed, loop))
