"""Clocks that were set while a recording was written: detection of the steps, and monotonic times.

A robot sets its clock when it reaches a time server: the clock goes back, or leaps years ahead. Repaired times continue
from the last time before the step, in the order of arrival of the messages.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..runtime.text import many, often
from ..samples.staleness import ENDED, usual_step

Times = NDArray[np.int64]

SECOND = 1_000_000_000
JITTER_NS = 10_000_000
"""Largest step back that is jitter: the threads of a recorder overtake each other by less, clocks are set by more."""

RESET_NS = 10 * SECOND
"""Largest step back after which the clock may catch up; a larger step is permanent."""

LEAP_NS = 30 * 86_400 * SECOND
"""Longest time between two messages of any topics; a longer one means that the clock was set ahead."""

REAL_FROM_NS = 631_152_000 * SECOND
"""The year 1990. A clock before that was never set, or has another epoch, as in a simulation."""

_STILL_STEP_NS = SECOND // 10
_STILL_SHARE = 10
_LATEST = 2**63 - 1
_HABIT, _RARELY = 10, 100
"""A topic has several publishers, whose times differ, if it goes back more than 10 times and in more than 1 message
of 100."""
_MOST_VOTES = 10_000_000
"""The most votes to count: no clock is set so often, and counting more would take long."""


class Arrivals(NamedTuple):
    """Log times of messages in nanoseconds and the ids of their channels, shape (N,) each, in the order of the file."""

    times: Times
    channels: Times

    def span_ns(self, channel: int) -> tuple[int, int] | None:
        """Return the earliest and the latest log time of a channel, or None if it has no messages."""
        own = self.times[self.channels == channel]
        return (int(own.min()), int(own.max())) if own.size else None

    def renumbered(self, ids: Mapping[int, int]) -> Arrivals:
        """Return the same arrivals with other ids of channels, or -1 for channels that are not in ``ids``."""
        known, places = np.unique(self.channels, return_inverse=True)
        return Arrivals(self.times, np.array([ids.get(number, -1) for number in known.tolist()], np.int64)[places])


def joined(parts: Iterable[Arrivals]) -> Arrivals:
    """Return the arrivals of several files, one after the other."""
    times, channels = zip(*parts, strict=True)
    return Arrivals(np.concatenate(times), np.concatenate(channels))


def has_clock_step(arrivals: Arrivals) -> bool:
    """Return True if the clock was set back, was set far ahead, or began later than the recorder."""
    return bool(_before_clock(arrivals.times).any()) or _leaps(arrivals.times) or bool(_steps_back(arrivals))


def may_precede_clock(first_ns: int, last_ns: int) -> bool:
    """Return True if a recording between two times may have messages from before its clock began."""
    return first_ns == 0 and last_ns > RESET_NS


def repaired(arrivals: Arrivals) -> tuple[Times, str]:
    """Return monotonic times of the same messages, and a line on the problems of the clock, which may be empty."""
    early = _before_clock(arrivals.times)
    if early.any():
        count = int(early.sum())
        clock_starts = int(arrivals.times[~early].min())
        times, line = repaired(arrivals._replace(times=np.where(early, clock_starts, arrivals.times)))
        about = f"the clock began only after {many(count, 'message')} at time 0, which are put at its start"
        return times, "; ".join(filter(None, (about, line)))
    steps = _steps_back(arrivals)
    if not steps and not _leaps(arrivals.times):
        return arrivals.times, ""
    runs = np.zeros(len(arrivals.times), np.int64)
    runs[steps] = 1
    # Between two steps the clock is right, but messages overtake each other as in any recording: sort them by time.
    order = np.lexsort((arrivals.times, np.cumsum(runs)))
    monotonic, problems = make_monotonic(arrivals.times[order].tolist())
    times = np.empty_like(arrivals.times)
    times[order] = [max(-_LATEST, min(time, _LATEST)) for time in monotonic]
    return times, _described(len(steps), problems)


def repaired_log(times: Sequence[int | None]) -> tuple[list[int], str]:
    """Return monotonic times for the lines of a log, and a line on the problems of the clock.

    The order of the lines is kept. If the clock stands still (fewer than one different time in ten lines), the lines
    are set 0.1 s apart.

    Args:
        times: nanoseconds, in the order of the lines, or None for a line without a time.
    """
    if len(times) > 1 and _STILL_SHARE * len(set(times)) < len(times):
        different = len(set(times))
        line = (
            f"the clock stood still ({different} different time{'s' * (different > 1)} in {len(times):,} lines): "
            f"the lines are set {_STILL_STEP_NS / SECOND:g} s apart, in their order"
        )
        return [i * _STILL_STEP_NS for i in range(len(times))], line
    filled: list[int] = []
    latest = next((time for time in times if time is not None), 0)
    for time in times:
        latest = latest if time is None else time
        filled.append(latest)
    monotonic, problems = make_monotonic(filled)
    back = sum(after < before for before, after in pairwise(filled))
    return monotonic, _described(back, problems)


class ClockProblems(NamedTuple):
    """The problems of a clock; times in nanoseconds.

    ``behind`` is the largest step back, ``leaps`` the number of leaps ahead, ``ahead`` the largest leap, and ``start``
    the first monotonic time.
    """

    behind: int
    leaps: int
    ahead: int
    start: int


def make_monotonic(times: Sequence[int]) -> tuple[list[int], ClockProblems]:
    """Return times that never go back and never leap, in the same order, and the problems of the clock.

    After a small step back (up to `RESET_NS`) the last time is repeated until the clock has caught up. Other steps
    shift all later times, so that they continue from the last time: a larger step back, if the clock stays there; a
    leap ahead by more than `LEAP_NS`; and a step back by more than a second to the start of a clock without a date, as
    when a simulator is reset. After a leap the result is dated by the first time from 1990 on; without a leap, or
    without such a time, by the first time.
    """
    result: list[int] = []
    latest = times[0] if times else 0
    shift = furthest = widest = leaps = 0
    for i, time in enumerate(times):
        now = time + shift
        if now < latest:
            behind = latest - now
            furthest = max(furthest, behind)
            is_reset = behind > RESET_NS or (behind > SECOND and time < REAL_FROM_NS and time <= times[0] + SECOND)
            if is_reset and _goes_on(times[i : i + 2]):
                shift += behind
            now = latest
        elif now - latest > LEAP_NS:
            leaps += 1
            widest = max(widest, now - latest)
            shift -= now - latest
            now = latest
        latest = now
        result.append(now)
    if leaps:
        moved = next((time - result[i] for i, time in enumerate(times) if time >= REAL_FROM_NS), 0)
        result = [time + moved for time in result]
    return result, ClockProblems(furthest, leaps, widest, result[0] if result else 0)


def _goes_on(pair: Sequence[int]) -> bool:
    return len(pair) == 2 and 0 <= pair[1] - pair[0] < RESET_NS


def _described(back: int, problems: ClockProblems) -> str:
    lines = []
    if back:
        depth = f"by up to {problems.behind / SECOND:.2f} s"
        lines.append(f"goes back {often(back)}, {depth}: order is kept, time stands still meanwhile")
    if problems.leaps:
        by = f"{'up to ' * (problems.leaps > 1)}{problems.ahead / SECOND / 86_400:,.1f} days"
        date = np.datetime64(problems.start // SECOND, "s").astype("datetime64[D]")
        lines.append(f"jumps ahead {often(problems.leaps)}, by {by}: time goes on without a gap, dated {date}")
    return f"the clock {'; it '.join(lines)}" if lines else ""


def _before_clock(times: Times) -> NDArray[np.bool_]:
    """Return, for each message, True if it came before the clock began.

    A recorder that waits for the clock of a simulation writes the time 0 until it begins.
    """
    early: NDArray[np.bool_] = times == 0
    count = int(early.sum())
    is_before = 0 < count < len(times) and bool(early[:count].all())
    if not is_before or not may_precede_clock(int(times.min()), int(times[count:].min())):
        return np.zeros(len(times), bool)
    return early


def _leaps(times: Times) -> bool:
    """Return True if a gap is too long for a silence, so that the clock was set ahead within it."""
    if not times.size or float(times.max()) - float(times.min()) <= LEAP_NS:
        return False
    return bool((np.diff(np.sort(times).astype(np.float64)) > LEAP_NS).any())


def _steps_back(arrivals: Arrivals) -> list[int]:
    """Return the indices of the first messages after each time that the clock was set back.

    The clock was set back if a topic goes back in the order of arrival and most other topics agree. Otherwise messages
    of the topic were late, were written twice, or have times by another clock.
    """
    # Floats, so that no difference overflows; rounding by a quarter of a microsecond does not matter.
    times = arrivals.times.astype(np.float64)
    if not times.size or (times >= np.maximum.accumulate(times) - JITTER_NS).all():
        return []
    by_topic = np.argsort(arrivals.channels, kind="stable")
    topics = np.split(by_topic, np.flatnonzero(np.diff(arrivals.channels[by_topic])) + 1)
    ahead = np.append(-1, np.flatnonzero(np.diff(times) > LEAP_NS) + 1)
    found = [falls for places in topics if (falls := _falls(times, places, ahead)).places.size]
    if not 0 < sum(falls.places.size for falls in found) * len(topics) < _MOST_VOTES:
        return []
    falls = _Falls(*(np.concatenate(column) for column in zip(*found, strict=True)))
    votes = sum((_votes(times, places, falls) for places in topics), np.zeros(len(falls.places), np.int64))
    steps: list[int] = []
    start = 0
    for i in np.argsort(falls.places, kind="stable"):
        # At a step all topics that continue go back, so later falls across the same place belong to the same step.
        if votes[i] > 0 and falls.before[i] >= start:
            start = int(falls.places[i])
            steps.append(start)
    return steps


class _Falls(NamedTuple):
    """Falls: messages with an earlier time than the previous message of their topic.

    The fields are the indices of both messages, the depth of each fall, the time from it to the end of the topic, and
    the index of the last leap ahead before it.
    """

    places: Times
    before: Times
    depths: NDArray[np.float64]
    rests: NDArray[np.float64]
    leaps: Times


def _falls(times: NDArray[np.float64], places: Times, ahead: Times) -> _Falls:
    own = times[places]
    at = np.flatnonzero(np.diff(own) < -JITTER_NS)
    if at.size > max(_HABIT, own.size / _RARELY):
        at = at[:0]
    last = ahead[np.searchsorted(ahead, places[at + 1]) - 1]
    return _Falls(places[at + 1], places[at], own[at] - own[at + 1], own[-1] - own[at + 1], last)


def _votes(times: NDArray[np.float64], places: Times, falls: _Falls) -> Times:
    """Return the vote of a topic on each fall: 1 if it falls too, -1 if it continues or has ended, 0 if it is unsure.

    A topic continues only if its usual step is less than half the depth of the fall. If the clock leapt ahead before
    the fall, the topic must also have had a message since the leap.
    """
    own = times[places]
    usual = usual_step(own) or np.inf
    number = np.searchsorted(places, falls.places)
    both = (number > 0) & (number < own.size)
    before, after = own[np.maximum(number - 1, 0)], own[np.minimum(number, own.size - 1)]
    ended = (number == own.size) & (ENDED.after(usual) < falls.rests)
    goes_on = both & (after >= before) & (usual < falls.depths / 2)
    goes_on &= (falls.depths <= LEAP_NS) | (places[np.maximum(number - 1, 0)] >= falls.leaps)
    against = goes_on | ended
    votes: Times = (both & (after < before)).astype(np.int64) - against
    return votes
