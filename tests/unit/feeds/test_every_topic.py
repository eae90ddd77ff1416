"""Every readable topic of the real recordings, live: from two middlewares into a feed and its widgets."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any

import foxglove
import numpy as np
import pytest

from robowidgets import MessageWidget, PlotWidget, feeds
from robowidgets.feeds import Feed
from robowidgets.feeds._topics import decided
from robowidgets.kinds.choice import choose_widgets
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import decoder_of, definition_of
from robowidgets.messages.encoding import encode
from robowidgets.widget.sample_widget import SampleWidget

from ...reserved import free_domain, free_port
from ..pages import get_newest
from ..recordings.first_messages import Sent, by_type, first_messages
from ..recordings.test_fields import bits
from ..waiting import wait_for

FEW = 2


@pytest.fixture(scope="module")
def sent(data: Path) -> list[Sent]:
    return [*first_messages(data, FEW), several_echoes(), picture()]


def several_echoes() -> Sent:
    """A scan of a type that no recording has."""
    channel = Channel(0, "/glass", "sensor_msgs/msg/MultiEchoLaserScan", "cdr", "", 0)
    rays = [{"echoes": np.float32([1.0, 4.5])}, {"echoes": np.float32([2.0])}]
    raw = encode("cdr", channel.type, {"ranges": rays, "angle_increment": 0.1, "range_max": 30.0})
    return Sent("/glass", channel._replace(definition=definition_of(channel)), [raw], [decoder_of(channel)(raw)])


def picture() -> Sent:
    """The messages of a camera, which no recording has."""
    channel = Channel(0, "/camera/image_raw", "sensor_msgs/msg/Image", "cdr", "", 0)
    data = np.arange(18, dtype=np.uint8)
    raw = encode("cdr", channel.type, {"height": 2, "width": 3, "encoding": "rgb8", "step": 9, "data": data})
    return Sent(
        "/camera/image_raw", channel._replace(definition=definition_of(channel)), [raw], [decoder_of(channel)(raw)]
    )


def assert_same(got: Any, expected: Any, name: str) -> None:
    """Fail unless a message has all fields of another, with the same types, to the last bit."""
    if is_dataclass(expected):
        for field in fields(expected):
            if not field.name.startswith("_") and not field.name.isupper():  # constants
                assert_same(getattr(got, field.name), getattr(expected, field.name), f"{name}.{field.name}")
    elif isinstance(expected, np.ndarray):
        assert (got.dtype, got.shape, got.tobytes()) == (expected.dtype, expected.shape, expected.tobytes()), name
    elif isinstance(expected, list):
        assert len(got) == len(expected), name
        for one, other in zip(got, expected, strict=True):
            assert_same(one, other, name)
    else:
        assert (type(got), bits([got])) == (type(expected), bits([expected])), name


def is_same(got: Any, expected: Any) -> bool:
    """Return True if the messages are equal."""
    try:
        assert_same(got, expected, "")
    except (AssertionError, AttributeError):
        return False
    return True


def fitting(feed: Feed, one: Sent) -> SampleWidget:
    """The widget that `Feed.show` makes for a topic, connected to it."""
    topic = next(topic for topic in feed.topics if topic.name == one.topic)
    assert topic.type == one.channel.type
    (choice, *_) = choose_widgets([topic], [topic.name]) or [None]
    if choice is None:  # a message decides
        found = decided(topic, one.messages[0])
        choice = choose_widgets([found], [topic.name])[0]
    widget = choice.make()
    feed.connect(one.topic, getattr(widget, choice.method(choice.role)))
    return widget


def is_empty(widget: Any) -> bool:
    """Return True if a widget shows nothing. The images of two recordings are invalid, and the widget reports that."""
    if isinstance(widget, PlotWidget):
        return not any(len(widget[name][1]) for name in widget.names)
    newest = get_newest(widget)
    return newest.sample is None and not newest.about.get("error", "").startswith("the picture is")


def assert_shown(feed: Feed, sent: Sequence[Sent], send: Callable[[int], object]) -> None:
    """Fail unless a fitting widget shows what is sent, and its message equals the one of rosbags."""
    wait_for(lambda: {topic.name for topic in feed.topics} >= {one.topic for one in sent}, "the topics are listed")
    as_messages = {one.topic: MessageWidget() for one in sent}
    for topic, widget in as_messages.items():
        feed.connect(topic, widget)
    widgets = [fitting(feed, one) for one in by_type(sent)]

    for number in range(FEW):
        left = {one.topic: one.messages[min(number, len(one.messages) - 1)] for one in sent}

        def came(number: int = number, left: dict[str, Any] = left) -> bool:
            send(number)
            for topic in [topic for topic, message in left.items() if is_same(as_messages[topic].message, message)]:
                del left[topic]
            return not left

        try:
            wait_for(came, "each has come")
        except AssertionError:
            topic, message = next(iter(left.items()))
            assert_same(as_messages[topic].message, message, topic)
            raise
    empty = [(type(widget).__name__, widget.title, repr(widget)) for widget in widgets if is_empty(widget)]
    assert empty == []
    for widget in (*as_messages.values(), *widgets):
        widget.close()


@pytest.mark.slow
def test_over_foxglove_every_topic_of_the_recordings_is_shown_to_the_last_bit(sent: list[Sent]) -> None:
    context = foxglove.Context()
    server = foxglove.start_server(host="127.0.0.1", port=0, context=context)

    def channel_of(one: Sent) -> foxglove.Channel:
        version = "ros1msg" if one.channel.encoding == "ros1" else "ros2msg"
        schema = foxglove.Schema(name=one.channel.type, encoding=version, data=definition_of(one.channel).encode())
        return foxglove.Channel(one.topic, schema=schema, message_encoding=one.channel.encoding, context=context)

    channels = [channel_of(one) for one in sent]

    def send(number: int) -> None:
        """Send repeatedly: the server does not report when it has registered a subscription."""
        for channel, one in zip(channels, sent, strict=True):
            channel.log(one.raw[min(number, len(one.raw) - 1)])

    assert (len(sent) > 250, len(by_type(sent)) > 80) == (True, True)
    with feeds.foxglove(f"ws://127.0.0.1:{server.port}") as feed:
        assert_shown(feed, sent, send)
    server.stop()


@pytest.mark.slow
def test_over_dds_every_topic_of_a_known_type_is_shown_to_the_last_bit(sent: list[Sent]) -> None:
    pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install cyclonedds")
    from cyclonedds.domain import DomainParticipant
    from cyclonedds.pub import DataWriter
    from cyclonedds.qos import Policy, Qos
    from cyclonedds.topic import Topic

    from robowidgets.feeds._dds_types import dds_topic, struct, type_hash
    from robowidgets.feeds._ros2_types import definitions_of

    def known(one: Sent) -> Any:
        """The type as a robot describes it to DDS, or None unless we have the definition in the file."""
        if one.channel.encoding != "cdr":
            return None
        own = type_hash(one.channel.type, one.channel.definition)
        return next(
            (
                struct(one.channel.type, text)
                for text in definitions_of(one.channel.type)
                if type_hash(one.channel.type, text) == own
            ),
            None,
        )

    there = [(one, kind) for one in sent if (kind := known(one))]
    assert (len(there) > 120, len(by_type([one for one, _ in there])) > 50) == (True, True)
    robot = DomainParticipant(free_domain())
    kept = Policy.Reliability.Reliable(10**9), Policy.Durability.TransientLocal, Policy.History.KeepLast(1)
    writers = []
    for one, kind in there:
        says = Policy.Userdata(type_hash(one.channel.type, one.channel.definition))
        writers.append(DataWriter(robot, Topic(robot, dds_topic(one.topic), kind), Qos(*kept, says)))
    with feeds.dds(free_domain()) as feed:

        def send(number: int) -> None:
            """Send each once: they are kept for late subscribers."""
            for writer, (one, kind) in zip(writers, there, strict=True):
                if number not in done[one.topic]:
                    done[one.topic].add(number)
                    writer.write(kind(one.raw[min(number, len(one.raw) - 1)]))

        done = {one.topic: set[int]() for one, _ in there}
        assert_shown(feed, [one for one, _ in there], send)


@pytest.mark.slow
def test_over_zenoh_every_topic_of_a_known_type_is_shown_to_the_last_bit(sent: list[Sent]) -> None:
    zenoh = pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed: pip install eclipse-zenoh")
    from zenoh import ext

    from robowidgets.feeds._ros2_types import dds_type, definitions_of, hash_of

    from .zenoh_router import open_router

    def known(one: Sent) -> str:
        """The hash of the type, or empty unless we have the definition in the file."""
        if one.channel.encoding != "cdr":
            return ""
        own = hash_of(one.channel.type, one.channel.definition)
        return own if own in {hash_of(one.channel.type, text) for text in definitions_of(one.channel.type)} else ""

    there = [(one, own) for one in sent if (own := known(one))]
    assert (len(there) > 120, len(by_type([one for one, _ in there])) > 50) == (True, True)
    where = f"tcp/127.0.0.1:{free_port()}"
    publishers = []
    with open_router(where) as robot:
        for number, (one, own) in enumerate(there):
            topic, kind = one.topic.strip("/"), dds_type(one.channel.type)
            cache = ext.CacheConfig(1)
            key = f"0/{topic}/{kind}/{own}"
            # By default, zenoh drops what does not fit into its queue: here, messages of all topics at once.
            block = zenoh.CongestionControl.BLOCK
            writer = ext.declare_advanced_publisher(
                robot, key, congestion_control=block, cache=cache, publisher_detection=True
            )
            node = f"@ros2_lv/0/{robot.info.zid()}/0/{number}/MP/%/%/robot"
            name = f"{node}/%{topic.replace('/', '%')}/{kind}/{own}/:1:,1:,:,:,,"
            publishers.append((writer, robot.liveliness().declare_token(name)))
        with feeds.zenoh(where) as feed:

            def send(number: int) -> None:
                """Send each once: they are kept for late subscribers."""
                for (writer, _), (one, _) in zip(publishers, there, strict=True):
                    if number not in done[one.topic]:
                        done[one.topic].add(number)
                        writer.put(one.raw[min(number, len(one.raw) - 1)])

            done = {one.topic: set[int]() for one, _ in there}
            assert_shown(feed, [one for one, _ in there], send)
