"""Problems of the clock of a topic, and lines on them."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...runtime.text import listed, often
from ...samples.staleness import CLOCK_JUMP, usual_step

_STILL_SHARE = 0.5
_STILL_LEAST = 10
_SAME_SHARE = 0.9


class TopicClock(NamedTuple):
    """The problems of a topic's clock: lines, and start and end of its silences in seconds, shape (K, 2)."""

    lines: tuple[str, ...]
    silences: NDArray[np.float64]


def clock_of(times_ns: NDArray[np.int64], start_ns: int) -> TopicClock:
    """Return the problems of a clock: it stands still, or it has silences.

    A clock stands still if half of the messages, and ten at least, have the time of the previous one. A silence is a
    pause of more than a minute and more than a hundred usual pauses. A recording cannot distinguish it from a clock
    that jumped ahead.

    Args:
        times_ns: nanoseconds, shape (N,), ascending.
        start_ns: start of the recording.
    """
    steps = np.diff(times_ns)
    lines = []
    still = int(np.count_nonzero(steps == 0))
    if still >= max(_STILL_SHARE * steps.size, _STILL_LEAST):
        lines.append(f"the clock stands still: {still:,} of {len(times_ns):,} samples bear the time of the one before")
    silent = np.flatnonzero(steps > CLOCK_JUMP.after(usual_step(times_ns), 1e9))
    return TopicClock(tuple(lines), (np.stack((times_ns[silent], times_ns[silent + 1]), 1) - start_ns) / 1e9)


def about_clock(times_ns: NDArray[np.int64], start_ns: int) -> tuple[str, ...]:
    """Return lines on the problems of a clock; takes the arguments of `clock_of`."""
    clock = clock_of(times_ns, start_ns)
    return (*clock.lines, *_about(clock.silences))


def about_clocks(clocks: Mapping[str, TopicClock]) -> tuple[str, ...]:
    """Return lines on the clocks of topics by name; a silence that several topics share gets one line."""
    shared: list[tuple[list[str], NDArray[np.float64]]] = []
    for name, clock in clocks.items():
        for i, (names, silences) in enumerate(shared):
            if _is_same(silences, clock.silences):
                shared[i] = ([*names, name], _common(silences, clock.silences))
                break
        else:
            shared.append(([name], clock.silences))
    lines = (f"{name}: {line}" for name, clock in clocks.items() for line in clock.lines)
    return (*lines, *(f"{listed(names)}: {line}" for names, silences in shared for line in _about(silences)))


def _about(silences: NDArray[np.float64]) -> tuple[str, ...]:
    if not len(silences):
        return ()
    longest = (silences[:, 1] - silences[:, 0]).max()
    start = silences[0, 0]
    if len(silences) == 1:
        return (f"nothing was recorded for {longest:.2f} s from {start:.2f} s on, or the clock jumped ahead",)
    return (
        f"nothing was recorded {often(len(silences))}, first from {start:.2f} s on, for up to {longest:.2f} s, "
        "or the clock jumped ahead",
    )


def _common(some: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return the silences that both have in common."""
    return np.stack((np.maximum(some[:, 0], others[:, 0]), np.minimum(some[:, 1], others[:, 1])), 1)


def _is_same(some: NDArray[np.float64], others: NDArray[np.float64]) -> bool:
    if len(some) != len(others):
        return False
    both, *each = (silences[:, 1] - silences[:, 0] for silences in (_common(some, others), some, others))
    return all((both >= _SAME_SHARE * length).all() for length in each)
