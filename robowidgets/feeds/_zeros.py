"""Zeros that a network may have lost, although it took them: when they are written again."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from .._core.clock import Clock
from ..driving.command_watchdog import RECENT

AGAIN = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Seconds after a zero at which it is written again where a subscriber does not confirm what it receives."""

LOOK = 0.1
"""Seconds between two looks whether one is due, at least."""


@dataclass
class _Topic:
    moved_at: float = 0.0
    """The time of the last speed."""
    was_heard: bool = False
    """Whether a subscriber was there for a speed."""
    driven: int = 0
    """Number of subscribers at the last speed."""
    zeros: dict[str, Any] = field(default_factory=dict)
    """By their types, the zeros after it; none while the robot moves."""
    since: float = 0.0
    """The time of the first of them, or at which a subscriber came."""
    repeats: int = 0
    subscribers: int = 0
    """Number of subscribers at the last look."""


class Zeros:
    """The last zero of each topic on which speeds were published, until a speed follows.

    A network takes a zero for a subscriber that it does not reach for a while, and forgets it. So zero is due again
    when a subscriber comes, and some times for one that does not confirm what it receives; no more when for a while
    none of them was missing, because others may drive then. The caller serializes the calls.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._topics: dict[str, _Topic] = {}
        self._look_at = 0.0

    def note_speed(self, topic: str, subscribers: int) -> None:
        """Note that a speed was published on a topic that has so many subscribers."""
        there = self._topics.setdefault(topic, _Topic())
        there.moved_at, there.was_heard = self._clock.now(), there.was_heard or subscribers > 0
        there.driven = subscribers
        there.zeros.clear()

    def note_zero(self, topic: str, kind: str, zero: Any, subscribers: int) -> None:
        """Note that zero was published on a topic: its type, and what was published."""
        there = self._topics.get(topic)
        if there is None:
            return
        if not there.zeros:
            there.since, there.repeats, there.subscribers = self._clock.now(), 0, subscribers
        there.zeros[kind] = zero

    def is_unheard(self, topic: str, subscribers: int) -> bool:
        """Whether a zero does not arrive, as no subscriber is left: one of those that a speed reached just now."""
        there = self._topics.get(topic)
        is_recent = there is not None and there.was_heard and self._clock.now() - there.moved_at < RECENT
        return is_recent and not subscribers

    def topics(self) -> list[str]:
        """The topics whose zeros may be due again; none where it was asked just now."""
        now = self._clock.now()
        if now < self._look_at:
            return []
        self._look_at = now + LOOK
        return [topic for topic, there in self._topics.items() if there.zeros]

    def due(self, topic: str, subscribers: int, *, all_confirm: bool) -> dict[str, Any]:
        """The zeros that are to be published on a topic again now, by their types.

        Args:
            topic: one of `topics`.
            subscribers: how many it has.
            all_confirm: whether each of them confirms what it receives.
        """
        there, now = self._topics[topic], self._clock.now()
        is_due = subscribers > there.subscribers
        if is_due:
            there.since, there.repeats = now, 0
        there.subscribers = subscribers
        while there.repeats < len(AGAIN) and now >= there.since + AGAIN[there.repeats]:
            there.repeats += 1
            is_due = is_due or not all_confirm
        zeros = dict(there.zeros) if is_due else {}
        if now - there.since > RECENT and subscribers >= there.driven:
            there.zeros.clear()
        return zeros
