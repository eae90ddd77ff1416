"""The common part of rclpy and DDS: domains, topics, queues, and texts for incompatible quality of service (QoS)."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping

from ..messages.twist import TWIST, TWIST_STAMPED
from ..runtime.clock import Clock
from .middleware import EVENTS, Advert, Listener

LAST_DOMAIN = 232

ALONE = 1.4
"""Seconds after which a new participant reports that it has discovered no topic."""

_OF_EVERY_NODE = ("/rosout", "/parameter_events")

_DEPTH = 5
"""Length of the queue of a subscription, as in the sensor data profile of ROS 2."""

_OTHER_FIELDS = "defines the fields of its type in another way"
_DOES = {
    "durability": "keeps no earlier messages (durability)",
    "reliability": "is best-effort",
    "data representation": "encodes its messages in another way (XCDR2)",
    "type consistency": _OTHER_FIELDS,
}
_EXPECTS = {
    "durability": "expects earlier messages (durability)",
    "data representation": "expects messages encoded in another way (XCDR2)",
    "type consistency": _OTHER_FIELDS,
}


def checked_domain(name: str, domain: object) -> int:
    """Return the domain. Raise TypeError or ValueError with the name of the argument if it is invalid."""
    if not isinstance(domain, int) or isinstance(domain, bool):
        raise TypeError(f"{name}: expected a whole number, as in ROS_DOMAIN_ID, got {domain!r}")
    if not 0 <= domain <= LAST_DOMAIN:
        raise ValueError(f"{name}: expected 0 to {LAST_DOMAIN}, as in ROS_DOMAIN_ID, got {domain}")
    return domain


def domain_of_environment() -> int:
    """Return the domain in ``ROS_DOMAIN_ID``, or 0 if it is not set. Raise ValueError if it is invalid."""
    given = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    try:
        return checked_domain("ROS_DOMAIN_ID", int(given, 0))  # the prefix gives the base, as in rcl
    except ValueError:
        raise ValueError(
            f"ROS_DOMAIN_ID: expected a whole number from 0 to {LAST_DOMAIN} in the environment, got {given!r}"
        ) from None


def adverts_of(
    publishers: Mapping[tuple[str, str], Collection[str]], subscribers: Mapping[tuple[str, str], Collection[str]]
) -> list[Advert]:
    """Return the adverts of topics, from the nodes by topic and type. An empty name is an unnamed node."""
    return [
        Advert(
            *key, key in publishers, key in subscribers, *(_names(nodes, key) for nodes in (publishers, subscribers))
        )
        for key in sorted({*publishers, *subscribers})
    ]


def _names(nodes: Mapping[tuple[str, str], Collection[str]], key: tuple[str, str]) -> tuple[str, ...]:
    return tuple(sorted(filter(None, nodes.get(key, ()))))


def is_alone(adverts: Iterable[Advert]) -> bool:
    """Return True if there are only topics that every node has, so that other nodes are programs but not a robot."""
    return all(advert.name in _OF_EVERY_NODE for advert in adverts)


class TopicReports:
    """Reports the topics of a session once for each change, and an empty list only after time to discover some.

    Args:
        listener: gets the reports.
        no_robot: the hint to report after that time, until a robot is discovered.
        clock: the clock.
    """

    def __init__(self, listener: Listener, no_robot: str, clock: Clock) -> None:
        self._listener, self._no_robot, self._clock = listener, no_robot, clock
        self._alone_until: float | None = clock.now() + ALONE
        """The time from which a missing robot is reported, or None once a robot was discovered."""
        self._topics: list[Advert] = []
        self._is_told = False

    def change(self, topics: list[Advert]) -> None:
        """Take the topics to report at the next look."""
        self._topics, self._is_told = topics, False

    def look(self) -> None:
        """Report what is due."""
        if not is_alone(self._topics):
            if self._alone_until is not None:
                self._listener.on_nobody("")
            self._alone_until = None
        elif self._alone_until is not None:
            if self._clock.now() < self._alone_until:
                return
            self._listener.on_nobody(self._no_robot)
        if not self._is_told:
            self._is_told = True
            self._listener.on_topics(self._topics)


def no_robot(domain: int, *questions: str) -> str:
    """Return the text for a domain without a robot, with what to check."""
    first = 7400 + 250 * domain
    asked = f"Is {domain} the robot's ROS_DOMAIN_ID?", f"Does a firewall block the UDP ports {first} to {first + 249}?"
    return " ".join((f"no robot in domain {domain}.", *asked, *questions))


def speed_types(expected: Iterable[str]) -> set[str]:
    """Return the velocity types among the types that the subscribers of a topic expect.

    Each type needs a publisher before the robot moves by another type, because a zero cannot wait for a match.
    """
    return {TWIST, TWIST_STAMPED}.intersection(expected)


def queue_depth(type_name: str) -> int:
    """Return the length of the queue of a subscription to messages of a type."""
    from ..kinds import counts_every_message  # Imported lazily: a guard subscribes to nothing.

    return EVENTS if counts_every_message(type_name) else _DEPTH


def not_coming(topic: str, policy: str) -> str:
    """Return the text for a publisher whose messages do not arrive."""
    return f"a publisher of {topic} {_DOES.get(policy, f'disagrees on {policy}')}, so its messages do not come"


def not_received(topic: str, policy: str) -> str:
    """Return the text for a subscriber that does not receive our messages."""
    return f"a subscriber of {topic} {_EXPECTS.get(policy, f'disagrees on {policy}')}, so it receives nothing"


def unknown_type(topic: str, type_name: str) -> str:
    """Return the text for a topic whose type has no known definition, with the remedy."""
    return (
        f"{topic} comes as {type_name}, a type that is not known here: "
        "add its .msg files with robowidgets.messages.add_definitions(folder), or use feeds.ros2 or "
        "feeds.foxglove, which do not need them"
    )


def unconfirmed(topic: str) -> str:
    """Return the text for a zero that may still be in transit."""
    return f"a subscriber of {topic} has not confirmed zero: it may not be reached"


def nobody_left(topic: str) -> str:
    """Return the text for a zero without a subscriber."""
    return f"{topic} has no subscriber any more: the robot that was driven may be unreachable, and got no zero"
