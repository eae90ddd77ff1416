"""The states of touch sensors at any time of a recording."""

from __future__ import annotations

from bisect import bisect_right
from copy import copy
from dataclasses import replace

from ..recordings import RecordingData
from ..samples import Touch, TouchMode
from ..samples.touch_tracker import TouchTracker

_KEPT_EVERY = 200


class TouchHistory:
    """A tracker of the touches of a topic, with checkpoints, so that going back is quick.

    Args:
        recording: the recording.
        topic: a topic of touches in the recording.
        hold, timeout: seconds, as of `TouchTracker`.
    """

    def __init__(self, recording: RecordingData, topic: str, hold: float, timeout: float | None) -> None:
        self._recording = recording
        self._topic = topic
        self._start_ns = recording.start_ns or 0
        # The tracker's state just before each of these times. `_here` caches the end of the last query.
        self._times = [self._start_ns]
        self._trackers = [TouchTracker(hold, timeout)]
        first = next(recording.samples(topic), None)
        if first and isinstance(first.sample, Touch) and first.sample.mode is not TouchMode.PRESENCE:
            # Lists all sensors of the topic before their first messages.
            self._trackers[0].apply(replace(first.sample, touched={}), self._start_ns)
        self._here = (self._start_ns, self._trackers[0])

    def at(self, time_ns: int) -> TouchTracker:
        """Return a tracker that has applied all touches up to and including a time of the recording."""
        kept = max(bisect_right(self._times, time_ns) - 1, 0)
        since_ns, tracker = self._times[kept], self._trackers[kept]
        if since_ns < self._here[0] <= time_ns:
            since_ns, tracker = self._here
        tracker = copy(tracker)
        latest = since_ns
        moments = self._recording.samples(self._topic, self._seconds(since_ns), self._seconds(time_ns + 1))
        for number, moment in enumerate(moments, start=1):
            if number >= _KEPT_EVERY and number % _KEPT_EVERY == 0 and moment.time_ns > max(latest, self._times[-1]):
                self._times.append(moment.time_ns)
                self._trackers.append(copy(tracker))
            latest = moment.time_ns
            if isinstance(moment.sample, Touch):
                tracker.apply(moment.sample, moment.time_ns)
        self._here = (time_ns + 1, copy(tracker))
        return tracker

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - self._start_ns) / 1e9
