"""The channels and the graph of a foxglove server, and decoders for its messages."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterable, Mapping
from functools import partial
from typing import Any

from ..messages.channel import Channel, full_type
from ._bridge import UnreadableError, other_nodes, strings
from ._websocket import one_line
from .middleware import Advert

ROS = ("cdr", "ros1")
_OURS = "foxglove_bridge"


def channel_of(offer: Any) -> Channel | None:
    """Return the channel in an entry of ``advertise``, or None if the entry is invalid."""
    if not isinstance(offer, Mapping):
        return None
    number, topic, encoding = (offer.get(name) for name in ("id", "topic", "encoding"))
    kind, definition = (offer.get(name) for name in ("schemaName", "schema"))
    if type(number) is not int or not isinstance(topic, str) or not isinstance(encoding, str):
        return None
    kind = kind if isinstance(kind, str) else ""
    return Channel(number, topic, full_type(kind), encoding, definition if isinstance(definition, str) else "", 0)


def decoder(channel: Channel) -> Callable[[bytes], Any]:
    """Return a function that decodes the messages of a channel. Both raise UnreadableError."""
    if channel.encoding == "json":
        return partial(_json, channel.type)
    if not channel.type:
        raise UnreadableError(
            f"{channel.topic} comes without a type: the robot's bridge lacks the package of its messages"
        )
    if channel.encoding not in ROS:
        raise UnreadableError(
            f"{channel.topic} comes as {one_line(channel.type)} in {one_line(channel.encoding)}, "
            "which cannot be read; foxglove_bridge sends cdr, ros1 or json"
        )
    from ..messages.decoding import DecodeError, decoder_of  # Imported lazily: a guard reads no topic.

    try:
        decode = decoder_of(channel)
    except DecodeError:
        raise UnreadableError(
            f"{channel.topic} comes as {one_line(channel.type)}, which is not a known type, "
            "and the server does not define it in a way that can be understood; "
            "add its .msg files with robowidgets.messages.add_definitions(folder)"
        ) from None

    def read(raw: bytes) -> Any:
        try:
            return decode(raw)
        except DecodeError as error:
            raise UnreadableError(f"a message of {channel.topic} cannot be read: {error}") from None

    return read


def _json(kind: str, raw: bytes) -> Any:
    try:
        message = json.loads(raw)
    except (ValueError, RecursionError) as error:
        raise UnreadableError(f"a message cannot be read: {len(raw)} bytes that are not JSON: {error}") from None
    if not isinstance(message, dict):
        raise UnreadableError(f"a message cannot be read: expected a JSON object, got {one_line(str(message)[:100])!r}")
    from ..messages.encoding import as_message  # Imported lazily: a guard reads no topic.

    return as_message("cdr", kind, message)


class Graph:
    """The publishers and subscribers of each topic, if the server reports them."""

    def __init__(self) -> None:
        self.known = False
        self._publishers: dict[str, tuple[str, ...]] = {}
        self._subscribers: dict[str, tuple[str, ...]] = {}

    def update(self, operation: Mapping[str, Any]) -> None:
        """Apply a ``connectionGraphUpdate``."""
        self.known = True
        for name in _list(operation.get("removedTopics")):
            if isinstance(name, str):
                self._publishers.pop(name, None)
                self._subscribers.pop(name, None)
        for nodes, key, ids in (
            (self._publishers, "publishedTopics", "publisherIds"),
            (self._subscribers, "subscribedTopics", "subscriberIds"),
        ):
            for entry in _list(operation.get(key)):
                if isinstance(entry, Mapping) and isinstance(entry.get("name"), str):
                    nodes[entry["name"]] = other_nodes(strings(entry.get(ids)), _OURS)

    def adverts(self, channels: Iterable[Channel]) -> list[Advert]:
        """Return all topics: the channels, and the topics with only subscribers, whose types are not reported."""
        found = {(c.topic, c.type): None for c in channels}
        names = {topic for topic, _ in found}
        if self.known:
            more = dict.fromkeys((*self._publishers, *self._subscribers))
            found.update({(name, ""): None for name in more if name not in names})
        return [self._advert(topic, kind) if self.known else Advert(topic, kind) for topic, kind in found]

    def _advert(self, topic: str, kind: str) -> Advert:
        publishers, subscribers = (nodes.get(topic, ()) for nodes in (self._publishers, self._subscribers))
        return Advert(topic, kind, bool(publishers), bool(subscribers), publishers, subscribers)


def _list(value: Any) -> list[Any]:
    return value if isinstance(value, list) else []
