"""Recordings whose clock was set while they were written: found, and put in the order of arrival."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ._held_clock import LEAP, about_set, hold
from .source import Arrivals, SavedSource, Source

JITTER_NS = 10_000_000
"""How far times in a row may go back: threads of a recorder overtake each other by less, clocks are set by more."""

_SECOND = 1_000_000_000
LEAP_NS = int(LEAP) * _SECOND
_LATEST = 2**63 - 1
_HABIT, _RARELY = 10, 100
"""A topic that goes back more often than the one, and than at every so many messages, has several senders: its times
are theirs."""
_SILENT = 10
_MOST = 10_000_000
"""Of votes: no clock has so many, and they would take long."""


def was_set(source: Source) -> bool:
    """Whether the clock behind a source was set back, or far ahead, as its index tells without reading the messages."""
    arrivals = source.arrivals()
    return leaps(arrivals.times) or bool(steps_back(arrivals))


def in_order(source: SavedSource) -> SavedSource:
    """The source, in the order of arrival where its clock was set, with times that are held as `hold` says."""
    arrivals = source.arrivals()
    steps = steps_back(arrivals)
    if steps or leaps(arrivals.times):
        stretches = np.zeros(len(arrivals.times), np.int64)
        stretches[steps] = 1
        # Within each stretch the clock ran, and topics overtake each other as they do in any recording.
        order = np.lexsort((arrivals.times, np.cumsum(stretches)))
        held, odd = hold(arrivals.times[order].tolist(), _SECOND)
        times = np.empty_like(arrivals.times)
        times[order] = [max(-_LATEST, min(time, _LATEST)) for time in held]
        source.retime(times, about_set(len(steps), odd))
    return source


def leaps(times: NDArray[np.int64]) -> bool:
    """Whether nothing came for longer than a robot is silent: its clock was set ahead meanwhile."""
    if not times.size or float(times.max()) - float(times.min()) <= LEAP_NS:
        return False
    return bool((np.diff(np.sort(times).astype(np.float64)) > LEAP_NS).any())


def steps_back(arrivals: Arrivals) -> list[int]:
    """The first message after each time that the clock was set back.

    It was set back where the messages of a topic go back in the order of arrival, and most topics that can tell agree:
    else they are messages that came late, were written twice, or bear times of their own.
    """
    # As floats, for differences of any two: a quarter of a microsecond does not matter.
    times = arrivals.times.astype(np.float64)
    if not times.size or (times >= np.maximum.accumulate(times) - JITTER_NS).all():
        return []
    by_topic = np.argsort(arrivals.channels, kind="stable")
    topics = np.split(by_topic, np.flatnonzero(np.diff(arrivals.channels[by_topic])) + 1)
    ahead = np.append(-1, np.flatnonzero(np.diff(times) > LEAP_NS) + 1)
    found = [falls for places in topics if (falls := _falls(times, places, ahead)).places.size]
    if not 0 < sum(falls.places.size for falls in found) * len(topics) < _MOST:
        return []
    falls = _Falls(*(np.concatenate(column) for column in zip(*found, strict=True)))
    votes = sum((_votes(times, places, falls) for places in topics), np.zeros(len(falls.places), np.int64))
    steps: list[int] = []
    start = 0
    for i in np.argsort(falls.places, kind="stable"):
        # Every topic that goes on falls; those that fall after the first of them tell of the same step.
        if votes[i] > 0 and falls.before[i] >= start:
            start = int(falls.places[i])
            steps.append(start)
    return steps


class _Falls(NamedTuple):
    """Where one message of a topic has an earlier time than the one before.

    Places of both, by how much, time until the end, and the place of the last leap ahead before it.
    """

    places: NDArray[np.int64]
    before: NDArray[np.int64]
    depths: NDArray[np.float64]
    rests: NDArray[np.float64]
    leaps: NDArray[np.int64]


def _falls(times: NDArray[np.float64], places: NDArray[np.int64], ahead: NDArray[np.int64]) -> _Falls:
    own = times[places]
    at = np.flatnonzero(np.diff(own) < -JITTER_NS)
    if at.size > max(_HABIT, own.size / _RARELY):
        at = at[:0]
    last = ahead[np.searchsorted(ahead, places[at + 1]) - 1]
    return _Falls(places[at + 1], places[at], own[at] - own[at + 1], own[-1] - own[at + 1], last)


def _votes(times: NDArray[np.float64], places: NDArray[np.int64], falls: _Falls) -> NDArray[np.int64]:
    """What one topic says to each fall: 1 if it falls there too, -1 if it goes on or has ended, 0 if it cannot tell.

    That it goes on tells something only if it usually speaks in less than half the time of the fall; and where a leap
    ahead came before the fall, if it spoke since.
    """
    own = times[places]
    steps = np.diff(own)
    usual = float(np.median(steps[steps > 0])) if (steps > 0).any() else np.inf
    number = np.searchsorted(places, falls.places)
    both = (number > 0) & (number < own.size)
    before, after = own[np.maximum(number - 1, 0)], own[np.minimum(number, own.size - 1)]
    ended = (number == own.size) & (_SILENT * usual < falls.rests)
    goes_on = both & (after >= before) & (usual < falls.depths / 2)
    goes_on &= (falls.depths <= LEAP_NS) | (places[np.maximum(number - 1, 0)] >= falls.leaps)
    against = goes_on | ended
    votes: NDArray[np.int64] = (both & (after < before)).astype(np.int64) - against
    return votes
