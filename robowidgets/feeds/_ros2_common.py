"""What rclpy and DDS have in common: domains, topics, queues, and texts for incompatible quality of service (QoS)."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Mapping

from ..messages.twist import TWIST, TWIST_STAMPED
from .middleware import EVENTS, Advert

LAST_DOMAIN = 232

ALONE = 1.4
"""Seconds after which a new participant that has discovered no topic says so."""

_OF_EVERY_NODE = ("/rosout", "/parameter_events")

_DEPTH = 5
"""Length of the queue of a subscription, as ROS 2 has it for sensor data."""

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
    """The domain itself; TypeError or ValueError, with the name of the argument, if it is invalid."""
    if not isinstance(domain, int) or isinstance(domain, bool):
        raise TypeError(f"{name}: expected a whole number, as in ROS_DOMAIN_ID, got {domain!r}")
    if not 0 <= domain <= LAST_DOMAIN:
        raise ValueError(f"{name}: expected 0 to {LAST_DOMAIN}, as in ROS_DOMAIN_ID, got {domain}")
    return domain


def domain_of_environment() -> int:
    """The domain that ``ROS_DOMAIN_ID`` names now; 0 without it. ValueError if it names none."""
    given = os.environ.get("ROS_DOMAIN_ID", "").strip() or "0"
    try:
        return checked_domain("ROS_DOMAIN_ID", int(given, 0))  # the base by its prefix, as rcl has it
    except ValueError:
        raise ValueError(
            f"ROS_DOMAIN_ID: expected a whole number from 0 to {LAST_DOMAIN} in the environment, got {given!r}"
        ) from None


def adverts_of(
    publishers: Mapping[tuple[str, str], Collection[str]], subscribers: Mapping[tuple[str, str], Collection[str]]
) -> list[Advert]:
    """Adverts of topics, by topic and type: the nodes that publish them, and those that subscribe (empty: unnamed)."""
    return [
        Advert(
            *key, key in publishers, key in subscribers, *(_names(nodes, key) for nodes in (publishers, subscribers))
        )
        for key in sorted({*publishers, *subscribers})
    ]


def _names(nodes: Mapping[tuple[str, str], Collection[str]], key: tuple[str, str]) -> tuple[str, ...]:
    return tuple(sorted(filter(None, nodes.get(key, ()))))


def is_alone(adverts: Iterable[Advert]) -> bool:
    """Whether there are no topics but those of every node: of a program of this machine, say, and of no robot."""
    return all(advert.name in _OF_EVERY_NODE for advert in adverts)


def no_robot(domain: int, *questions: str) -> str:
    """Text for a domain in which no robot is, with what to compare."""
    first = 7400 + 250 * domain
    asked = f"Is {domain} the robot's ROS_DOMAIN_ID?", f"Does a firewall block the UDP ports {first} to {first + 249}?"
    return " ".join((f"no robot in domain {domain}.", *asked, *questions))


def speed_types(expected: Iterable[str]) -> set[str]:
    """The types of speeds among those that the subscribers of a topic expect.

    Each needs a publisher before a robot moves by another one: who waits for a match meanwhile cannot send a zero.
    """
    return {TWIST, TWIST_STAMPED}.intersection(expected)


def queue_depth(type_name: str) -> int:
    """The length of the queue of a subscription to messages of a type."""
    from ..kinds import counts_every_message  # Imported lazily: a guard subscribes to nothing.

    return EVENTS if counts_every_message(type_name) else _DEPTH


def not_coming(topic: str, policy: str) -> str:
    """Text for a publisher whose messages do not come."""
    return f"a publisher of {topic} {_DOES.get(policy, f'disagrees on {policy}')}, so its messages do not come"


def not_received(topic: str, policy: str) -> str:
    """Text for a subscriber that does not receive our messages."""
    return f"a subscriber of {topic} {_EXPECTS.get(policy, f'disagrees on {policy}')}, so it receives nothing"


def unconfirmed(topic: str) -> str:
    """Text for a zero that may be under way."""
    return f"a subscriber of {topic} has not confirmed zero: it may not be reached"


def nobody_left(topic: str) -> str:
    """Text for a zero that nobody receives."""
    return f"nobody listens to {topic} any more: who was driven may not be reached, and has got no zero"
