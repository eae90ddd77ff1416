"""The first messages of every readable topic of the real recordings."""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice
from pathlib import Path
from typing import Any, NamedTuple

from robowidgets.files import open_source
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import DecodeError, decoder_of
from robowidgets.repair import RecordingError

from .test_fields import recordings_in


class Sent(NamedTuple):
    """A topic under a name of no other recording, with its first messages as bytes and as rosbags reads them."""

    topic: str
    channel: Channel
    raw: list[bytes]
    messages: list[Any]


def first_messages(data: Path, count: int) -> list[Sent]:
    """The first messages of every readable topic with messages."""
    found = []
    for number, path in enumerate(recordings_in(data)):
        try:
            source = open_source(path)
        except RecordingError:
            continue  # nothing in it can be read
        for channel in source.channels:
            if channel.encoding not in ("cdr", "ros1"):
                continue  # a feed sends messages of ROS
            raw = [raw for _, _, raw in islice(source.messages([channel]), count)]
            try:
                decode = decoder_of(channel)
                messages = [decode(one) for one in raw]
            except DecodeError:
                continue
            if messages:
                found.append(Sent(f"/r{number}/{channel.topic.lstrip('/')}", channel, raw, messages))
        source.close()
    return found


def by_type(sent: Iterable[Sent]) -> list[Sent]:
    """One topic of each type."""
    return list({one.channel.type: one for one in sent}.values())
