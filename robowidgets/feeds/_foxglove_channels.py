"""What a foxglove server says of its topics, and how their messages are read."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from typing import Any, NamedTuple

from ..messages.channel import Channel as RosChannel
from ..messages.decoding import DecodeError
from ._bridge import UnreadableError, full_type, other_nodes, strings
from ._websocket import one_line
from .middleware import Advert

ROS = ("cdr", "ros1")
_OURS = "foxglove_bridge"


class Channel(NamedTuple):
    """A topic of one type, as a server offers it."""

    id: int
    topic: str
    type: str
    encoding: str
    definition: str


def channel_of(offer: Any) -> Channel | None:
    """The channel in an entry of ``advertise``; None when it is none."""
    if not isinstance(offer, Mapping):
        return None
    number, topic, encoding = (offer.get(name) for name in ("id", "topic", "encoding"))
    kind, definition = (offer.get(name) for name in ("schemaName", "schema"))
    if type(number) is not int or not isinstance(topic, str) or not isinstance(encoding, str):
        return None
    kind = kind if isinstance(kind, str) else ""
    return Channel(number, topic, full_type(kind), encoding, definition if isinstance(definition, str) else "")


def decoder(channel: Channel) -> Callable[[bytes], Any]:
    """What reads the messages of a channel; it and this raise UnreadableError."""
    if channel.encoding == "json":
        return _json
    if not channel.type:
        raise UnreadableError(
            f"{channel.topic} comes without a type: the robot's bridge lacks the package of its messages"
        )
    if channel.encoding not in ROS:
        raise UnreadableError(
            f"{channel.topic} comes as {one_line(channel.type)} in {one_line(channel.encoding)}, "
            "which is not read; what foxglove_bridge sends is (cdr, ros1, json)"
        )
    # Here, so that who hears JSON alone waits for none of it.
    from ..messages.decoding import decoder_of

    asked = RosChannel(channel.id, channel.topic, channel.type, channel.encoding, channel.definition, 0)
    try:
        decode = decoder_of(asked)
    except DecodeError:
        raise UnreadableError(
            f"{channel.topic} comes as {one_line(channel.type)}, which is not a known type, "
            "and the server does not define it in a way that can be understood"
        ) from None

    def read(raw: bytes) -> Any:
        try:
            return decode(raw)
        except DecodeError as error:
            raise UnreadableError(f"a message of {channel.topic} cannot be read: {error}") from None

    return read


def _json(raw: bytes) -> Any:
    try:
        message = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(f"a message cannot be read: {len(raw)} bytes that are no JSON: {error}") from None
    if not isinstance(message, dict):
        raise UnreadableError(f"a message cannot be read: it is no JSON object but {one_line(str(message)[:100])!r}")
    return message


class Graph:
    """Who publishes and who listens, where the server tells."""

    def __init__(self) -> None:
        self.known = False
        self._publishers: dict[str, tuple[str, ...]] = {}
        self._listeners: dict[str, tuple[str, ...]] = {}

    def update(self, said: Mapping[str, Any]) -> None:
        """Learn from a ``connectionGraphUpdate``."""
        self.known = True
        for name in _list(said.get("removedTopics")):
            if isinstance(name, str):
                self._publishers.pop(name, None)
                self._listeners.pop(name, None)
        for nodes, what, ids in (
            (self._publishers, "publishedTopics", "publisherIds"),
            (self._listeners, "subscribedTopics", "subscriberIds"),
        ):
            for entry in _list(said.get(what)):
                if isinstance(entry, Mapping) and isinstance(entry.get("name"), str):
                    nodes[entry["name"]] = other_nodes(strings(entry.get(ids)), _OURS)

    def adverts(self, channels: Iterable[Channel]) -> list[Advert]:
        """All topics: the channels, and those that somebody only listens to, whose types nobody tells."""
        found = {(c.topic, c.type): None for c in channels}
        names = {topic for topic, _ in found}
        if self.known:
            more = dict.fromkeys((*self._publishers, *self._listeners))
            found.update({(name, ""): None for name in more if name not in names})
        return [
            Advert(topic, kind, bool(nodes := self._publishers.get(topic, ())), bool(self._listeners.get(topic)), nodes)
            if self.known
            else Advert(topic, kind)
            for topic, kind in found
        ]


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
