"""Zeros that the network accepted but may have lost, and when to write them again."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any

from ..driving.command_watchdog import RECENT
from ..runtime.clock import Clock

AGAIN = (1.0, 2.0, 4.0, 8.0, 16.0)
"""Seconds after a zero at which it is written again for a subscriber that does not confirm messages."""

LAST, LAST_PAUSE = 3, 0.1
"""Before the connection ends, such a subscriber gets zero this many times more, and these seconds apart."""

LOOK = 0.1
"""The least seconds between two checks for overdue zeros."""


@dataclass
class _Topic:
    moved_at: float = 0.0
    """The time of the last speed."""
    was_heard: bool = False
    """True if there was a subscriber for a speed."""
    driven: int = 0
    """Number of subscribers at the last speed."""
    zeros: dict[str, Any] = field(default_factory=dict)
    """The zeros after it by type, or empty while the robot moves."""
    since: float = 0.0
    """The time of the first zero, or the time at which a subscriber appeared."""
    repeats: int = 0
    subscribers: int = 0
    """Number of subscribers at the last look."""


class Zeros:
    """The last zero of each topic on which speeds were published, until a speed follows.

    A network accepts a zero for a subscriber that it cannot reach for a while, and loses it. So zero is due again when
    a subscriber appears, and several times for a subscriber that does not confirm messages. After a while without a
    missing subscriber it is not due any more, because another node may drive. The caller serializes the calls.
    """

    def __init__(self, clock: Clock) -> None:
        self._clock = clock
        self._topics: dict[str, _Topic] = {}
        self._look_at = 0.0

    def note_speed(self, topic: str, subscribers: int) -> None:
        """Note that a speed was published on a topic with this number of subscribers."""
        there = self._topics.setdefault(topic, _Topic())
        there.moved_at, there.was_heard = self._clock.now(), there.was_heard or subscribers > 0
        there.driven = subscribers
        there.zeros.clear()

    def note_zero(self, topic: str, kind: str, zero: Any, subscribers: int) -> None:
        """Note that zero was published on a topic, with its type and the message."""
        there = self._topics.get(topic)
        if there is None:
            return
        if not there.zeros:
            there.since, there.repeats, there.subscribers = self._clock.now(), 0, subscribers
        there.zeros[kind] = zero

    def is_unheard(self, topic: str, subscribers: int) -> bool:
        """Return True if a zero cannot arrive because the topic has lost the subscribers of a recent speed."""
        there = self._topics.get(topic)
        is_recent = there is not None and there.was_heard and self._clock.now() - there.moved_at < RECENT
        return is_recent and not subscribers

    def topics(self) -> list[str]:
        """Return the topics whose zeros may be due again, or an empty list if it was called just now."""
        now = self._clock.now()
        if now < self._look_at:
            return []
        self._look_at = now + LOOK
        return [topic for topic, there in self._topics.items() if there.zeros]

    def due(self, topic: str, subscribers: int, *, all_confirm: bool) -> dict[str, Any]:
        """Return the zeros to publish again now on a topic, by their types.

        Args:
            topic: one of `topics`.
            subscribers: the number of its subscribers.
            all_confirm: True if each of them confirms messages.
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

    def last(self, all_confirm: Callable[[str], bool]) -> Iterator[tuple[str, str, Any]]:
        """Yield the topics, types and messages of the zeros to publish before the connection ends, `LAST` times each.

        Nothing repeats a lost zero after that. So it waits for a moment, but only if a subscriber may miss a zero.

        Args:
            all_confirm: returns True if each subscriber of a topic confirms messages.
        """
        for _ in range(LAST):
            repeated = [topic for topic, there in self._topics.items() if there.repeats < len(AGAIN) and there.zeros]
            zeros = [
                (topic, kind, zero)
                for topic in repeated
                if not all_confirm(topic)
                for kind, zero in self._topics[topic].zeros.items()
            ]
            yield from zeros
            if zeros:
                self._clock.sleep(LAST_PAUSE)
