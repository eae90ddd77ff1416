"""Texts for publishers and subscribers with an incompatible quality of service (QoS), by the name of the policy."""

from __future__ import annotations

_OTHER_FIELDS = "defines the fields of its type in another way"
_DOES = {
    "durability": "keeps no earlier messages (durability)",
    "deadline": "promises no rate (deadline)",
    "ownership": "wants to be the only one (exclusive ownership)",
    "liveliness": "promises no sign of life (liveliness)",
    "reliability": "is best-effort",
    "data representation": "encodes its messages in another way (XCDR2)",
    "type consistency": _OTHER_FIELDS,
}
_EXPECTS = {
    "durability": "expects earlier messages (durability)",
    "deadline": "expects messages at a promised rate (deadline)",
    "ownership": "expects one publisher only (exclusive ownership)",
    "liveliness": "expects a sign of life (liveliness)",
    "data representation": "expects messages encoded in another way (XCDR2)",
    "type consistency": _OTHER_FIELDS,
}


def not_coming(topic: str, policy: str) -> str:
    """Text for a publisher whose messages do not come."""
    return f"a publisher of {topic} {_DOES.get(policy, f'disagrees on {policy}')}, so its messages do not come"


def not_received(topic: str, policy: str) -> str:
    """Text for a subscriber that does not receive our messages."""
    return f"a subscriber of {topic} {_EXPECTS.get(policy, f'disagrees on {policy}')}, so it receives nothing"
