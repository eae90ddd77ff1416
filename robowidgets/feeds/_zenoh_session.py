"""A session of Zenoh that speaks the protocol of rmw_zenoh. One thread reads while another may publish."""

from __future__ import annotations

import os
import secrets
import struct
import threading
import time
from collections.abc import Iterable, Sequence
from itertools import count
from typing import Any, NamedTuple

import zenoh
from zenoh import ext
from zenoh.handlers import Callback, RingChannel

from ..messages.decoding import Decode, DecodeError
from ..runtime.clock import Clock
from ._guard.mark import MARK
from ._ros2_common import ALONE, adverts_of, is_alone, nobody_left, queue_depth, unconfirmed
from ._ros2_types import decoder_for, definitions_of, hash_of, ros_type
from ._zeros import Zeros
from .middleware import MOST_UNREAD, Advert, FeedError, Listener, NotConnectedYetError

CONNECT_TIMEOUT_S = 1.0
"""Seconds within which a router must accept a connection."""

CONFIRM_TIMEOUT_S = 0.3
"""Seconds within which the router must answer after a zero."""

POLL_PERIOD_S = 0.004
"""Seconds between two looks for messages."""

MATCH_TIMEOUT_S = 0.3
"""Seconds for which the first message of a publisher waits until the router knows the subscriber."""

PING_PERIOD_S = 0.5
"""Seconds between two questions to the router, if it has answered."""

SILENCE_TIMEOUT_S = 2.0
"""Seconds without an answer after which the router is considered lost. Zenoh itself waits for ten seconds."""

_AREA = "@ros2_lv"
_NO_HASH = "TypeHashNotSupported"
"""The hash of every type on a robot with Humble, which has no hashes."""

_BEST_EFFORT, _TRANSIENT_LOCAL = "2", "1"
"""Numbers in the quality of service of a token. An empty text is the default: reliable and volatile."""

_SENSOR_QOS, _LATCHED_QOS, _SPEED_QOS = "2::,5:,:,:,,", ":1:,1:,:,:,,", "::,1:,:,:,,"
"""Reliability, durability, history and depth, deadline, lifespan and liveliness of our subscribers and publishers."""

_GID_SIZE = 16
_HEAD = struct.Struct("<qqB")
"""The start of an attachment: sequence number, nanoseconds since 1970, and the size of the identifier that follows."""


class Entity(NamedTuple):
    """A publisher or subscriber of another node, as its token reports it."""

    topic: str
    type: str
    wire_type: str
    """The name of the type in Zenoh's keys."""
    hash: str
    latched: bool
    reliable: bool
    node: str

    @property
    def key(self) -> str:
        """The end of the key of its data: topic, type and hash."""
        return "/".join((self.topic.strip("/"), self.wire_type, self.hash))


class TopicWish(NamedTuple):
    """A subscription to make. ``each`` requests every message."""

    topic: str
    type: str
    wire_type: str
    hash: str
    latched: bool
    each: bool


class _Token(NamedTuple):
    """The parts of the key of a token."""

    number: tuple[str, str]
    kind: str
    node: str
    endpoint: Entity | None


class _Subscription:
    """A subscription of Zenoh, which keeps the newest messages until they are taken.

    Zenoh keeps them without Python: a callback would need the interpreter for each message, of which it gets 200 a
    second while a cell computes.
    """

    def __init__(self, subscriber: Any, token: Any, decode: Decode) -> None:
        self.decode = decode
        self._subscriber, self._token = subscriber, token
        self._last: dict[bytes, int] = {}
        """The last sequence number of each publisher."""

    def take(self) -> tuple[bytes, int] | None:
        """Return the next message with the number of messages that were lost before it, or None."""
        sample = self._subscriber.try_recv()
        if sample is None:
            return None
        lost, head = 0, bytes(sample.attachment or b"")
        if len(head) == _HEAD.size + _GID_SIZE:
            number, publisher = _HEAD.unpack_from(head)[0], head[_HEAD.size :]
            lost = max(0, number - self._last.get(publisher, number) - 1)
            self._last[publisher] = number
        return sample.payload.to_bytes(), lost

    def end(self) -> None:
        self._token.undeclare()
        self._subscriber.undeclare()


class _Publisher:
    """A publisher of speeds on a topic, in one type and one version of it."""

    def __init__(self, session: Any, key: str, token: Any) -> None:
        self._publisher = session.declare_publisher(
            key,
            # To wait for a slow network would hold up the next speed, and zero.
            congestion_control=zenoh.CongestionControl.DROP,
            priority=zenoh.Priority.REAL_TIME,
            express=True,
        )
        self._token = token
        self._gid, self._numbers = os.urandom(_GID_SIZE), count(1)

    @property
    def is_matched(self) -> bool:
        """True if the router knows a subscriber. Otherwise a message would be dropped without an error."""
        return bool(self._publisher.matching_status.matching)

    def write(self, raw: bytes) -> None:
        head = _HEAD.pack(next(self._numbers), time.time_ns(), _GID_SIZE)
        self._publisher.put(raw, attachment=head + self._gid)


class ZenohSession:
    """A client of the router of a robot. Only the thread that made it may use it, except for `wake` and `publish`.

    As a client it opens no port. Other nodes see it as a node, because it declares the tokens of one.

    Args:
        locator: the address of the router, ``tcp/robot:7447``.
        domain: the robot's ``ROS_DOMAIN_ID``.
        listener: gets messages and reports.
        no_robot: the text to report after a moment without a robot, until one is discovered.
        clock: the clock of its waits, except for waits in Zenoh.
        mark: for a guard, the name of its node. Publishers with the mark of our guards are not other programs.

    Raises:
        zenoh.ZError: no router accepts the connection.
    """

    def __init__(
        self, locator: str, domain: int, listener: Listener, no_robot: str, clock: Clock, mark: str = ""
    ) -> None:
        self._domain, self._listener, self._no_robot, self._clock = domain, listener, no_robot, clock
        self._alone_until: float | None = clock.now() + ALONE
        self._lock = threading.RLock()
        self._news = clock.condition(self._lock)
        self._is_woken = False
        self._tokens: dict[tuple[str, str], _Token] = {}
        """The tokens of other nodes. Zenoh's thread changes it with the lock."""
        self._changed = True
        self._wishes: dict[TopicWish, _Subscription] = {}
        self._followed: tuple[frozenset[str], frozenset[str]] | None = None
        self._unreadable: set[str] = set()
        self._writing = threading.Lock()
        self._publishers: dict[tuple[str, str, str], _Publisher] = {}
        """By topic, type and hash."""
        self._zeros = Zeros(clock)
        self._answered_at = clock.now()
        self._is_asking = False
        self._numbers = count(1)
        self._session = zenoh.open(_config(locator))
        self._zid = str(self._session.info.zid())
        self._node = mark or f"robowidgets_{secrets.token_hex(3)}"
        liveliness = self._session.liveliness()
        self._handles = [
            liveliness.declare_token(self._token("NN", 0)),
            liveliness.declare_subscriber(f"{_AREA}/{domain}/**", self._on_token, history=True),
        ]

    def close(self) -> None:
        """End the session. Before that, zero is repeated, because no subscriber confirms it."""
        with self._writing:
            for topic, key, raw in self._zeros.last(lambda _: False):
                self._write_zero(topic, key, raw)
            self._is_answered(CONFIRM_TIMEOUT_S)  # what was written is on its way before the connection ends
            self._session.close()  # type: ignore[no-untyped-call]

    def wake(self) -> None:
        """Make `wait` return."""
        with self._lock:
            self._is_woken = True
            self._news.notify_all()

    def wait(self) -> None:
        """Wait for a change of the topics, `wake`, or the time to take messages or to ask the router."""
        until = self._clock.now() + (POLL_PERIOD_S if self._wishes else PING_PERIOD_S)
        with self._lock:
            while not (self._is_woken or self._changed) and self._news.wait_until(until):
                pass
            self._is_woken = False

    def look(self) -> str:
        """Report the topics, if they changed, and repeat zeros. Return the reason why the router is lost, or empty."""
        if reason := self._why_lost():
            return reason
        with self._lock:
            changed, self._changed = self._changed, False
        if changed:
            self._followed = None
        topics = self._adverts()
        if is_alone(topics) and self._alone_until is not None:
            if self._clock.now() >= self._alone_until:
                self._alone_until = None
                self._listener.on_nobody(self._no_robot)
                self._listener.on_topics(topics)
        else:
            if not is_alone(topics):
                self._alone_until = None
                self._listener.on_nobody("")
            if changed:
                self._listener.on_topics(topics)
        self._repeat_zeros()
        return ""

    def follow(self, topics: frozenset[str], each: frozenset[str]) -> None:
        """Subscribe to the publishers of these topics, to every message if wanted, and to nothing else."""
        if (topics, each) == self._followed:
            return
        self._followed = topics, each
        offers = [one for one in self._endpoints("MP") if one.topic in topics]
        latched: dict[tuple[str, str], bool] = {}
        for one in offers:
            latched[one.key, one.topic] = latched.get((one.key, one.topic), False) or one.latched
        wishes = {
            TopicWish(one.topic, one.type, one.wire_type, one.hash, latched[one.key, one.topic], one.topic in each)
            for one in offers
        }
        for wish in self._wishes.keys() - wishes:
            self._wishes.pop(wish).end()
        for wish in sorted(wishes - self._wishes.keys()):
            self._subscribe(wish)
        for topic in self._unreadable - {one.topic for one in offers}:
            self._unreadable.discard(topic)
            self._listener.on_trouble(topic, "")

    @property
    def wishes(self) -> list[TopicWish]:
        """The subscriptions."""
        return list(self._wishes)

    def pass_on(self, wish: TopicWish) -> bool:
        """Pass on the next message of a subscription. Return False if it has none."""
        there = self._wishes[wish]
        taken = there.take()
        if taken is None:
            return False
        raw, lost = taken
        if wish.each and lost:
            self._listener.on_missed(wish.topic, lost)
        try:
            message = there.decode(raw)
        except DecodeError as error:
            self._listener.on_trouble(wish.topic, f"a message of {wish.topic} cannot be read: {error}")
            return True
        if wish.topic not in self._unreadable:
            self._listener.on_trouble(wish.topic, "")
        self._listener.on_message(wish.topic, message, replaced=0 if wish.each else lost)
        return True

    def publish(self, topic: str, type_name: str, raw: bytes, *, is_zero: bool) -> None:
        """Write a message from any thread, in each version of the type that a subscriber expects.

        Zenoh confirms nothing. So after a zero the router is asked, and answers after one round trip: the zero has
        reached the router, which usually runs on the robot.

        Raises:
            NotConnectedYetError: no subscriber was ever there.
            FeedError: no subscriber is there any more, or Zenoh refuses the message.
            TimeoutError: the message is a zero, and the router has not answered, or the subscriber is gone.
        """
        with self._writing:
            there = [one for one in self._subscribers(topic) if one.type == type_name]
            known = [key for key in self._publishers if key[:2] == (topic, type_name)]
            if not there and not known:
                raise NotConnectedYetError(f"{topic} has no subscriber for {type_name} yet")
            if not there and not is_zero:
                raise FeedError(f"{topic} has no subscriber any more")
            try:
                for key in {*known, *((topic, type_name, one.hash) for one in there)}:
                    self._publisher(key, there).write(raw)
                    if is_zero:
                        self._zeros.note_zero(topic, "/".join(key[1:]), raw, len(there))
            except zenoh.ZError as error:
                raise FeedError(f"cannot publish on {topic}: {error}") from None
            if not is_zero:
                self._zeros.note_speed(topic, len(there))
                return
            if not self._is_answered(CONFIRM_TIMEOUT_S):
                raise TimeoutError(unconfirmed(topic))
            if self._zeros.is_unheard(topic, len(there)):
                raise TimeoutError(nobody_left(topic))

    def _publisher(self, key: tuple[str, str, str], there: Sequence[Entity]) -> _Publisher:
        """Return the publisher of a topic, a type and its hash. A new one declares its token first."""
        if key not in self._publishers:
            topic, _, type_hash = key
            wire_type = next(one.wire_type for one in there if one.hash == type_hash)
            end = "/".join((topic.replace("/", "%"), wire_type, type_hash, _SPEED_QOS))
            token = self._session.liveliness().declare_token(self._token("MP", next(self._numbers), end))
            data = f"{self._domain}/{topic.strip('/')}/{wire_type}/{type_hash}"
            publisher = self._publishers[key] = _Publisher(self._session, data, token)
            # A node may declare its token before its subscriber.
            until = self._clock.now() + MATCH_TIMEOUT_S
            while not publisher.is_matched and self._clock.now() < until:
                self._clock.sleep(0.005)
        return self._publishers[key]

    def _repeat_zeros(self) -> None:
        """Repeat the zeros that subscribers may have missed. If another thread is writing, do it at the next look."""
        if not self._writing.acquire(blocking=False):
            return
        try:
            for topic in self._zeros.topics():
                due = self._zeros.due(topic, len(self._subscribers(topic)), all_confirm=False)
                for key, raw in due.items():
                    self._write_zero(topic, key, raw)
        finally:
            self._writing.release()

    def _write_zero(self, topic: str, key: str, raw: bytes) -> None:
        type_name, _, type_hash = key.rpartition("/")
        try:
            self._publishers[topic, type_name, type_hash].write(raw)
        except zenoh.ZError:  # the next requested zero reports it
            return

    def _why_lost(self) -> str:
        """Return the reason why the router is lost, or empty. Ask it from time to time, without a wait."""
        now = self._clock.now()
        if not self._session.info.routers_zid():
            return "the Zenoh router has ended the connection"
        if self._is_asking and now - self._answered_at > SILENCE_TIMEOUT_S:
            return f"the Zenoh router has not answered for {SILENCE_TIMEOUT_S:g} s"
        if not self._is_asking and now - self._answered_at >= PING_PERIOD_S:
            self._is_asking, self._answered_at = True, now
            self._ask(self._on_answer, 4 * SILENCE_TIMEOUT_S)
        return ""

    def _on_answer(self) -> None:
        """Note an answer of the router. Zenoh's thread calls it."""
        self._is_asking, self._answered_at = False, self._clock.now()

    def _is_answered(self, seconds: float) -> bool:
        """Return True if the router answers within some seconds."""
        answered = threading.Event()
        try:
            self._ask(answered.set, 4 * seconds)
        except zenoh.ZError:
            return False
        return answered.wait(seconds) and bool(self._session.info.routers_zid())

    def _ask(self, then: Any, timeout: float) -> None:
        """Ask the router for a token that does not exist. Zenoh calls a function when all answers have come."""
        nothing = f"{_AREA}/{self._domain}/{self._zid}/0/0/nothing"
        handler: Callback[Any] = Callback(lambda _reply: None, drop=then, indirect=False)
        self._session.liveliness().get(nothing, handler, timeout=timeout)

    def _on_token(self, sample: Any) -> None:
        """Note a token that appears or disappears. Zenoh's thread calls it."""
        token = _parse_token(str(sample.key_expr))
        if token is None or token.number[0] == self._zid or token.node.rpartition("/")[2].startswith(MARK):
            return
        with self._lock:
            if sample.kind == zenoh.SampleKind.PUT:
                self._tokens[token.number] = token
            else:
                self._tokens.pop(token.number, None)
            self._changed = True
            self._news.notify_all()

    def _endpoints(self, kind: str) -> list[Entity]:
        """Return the publishers (``MP``) or the subscribers (``MS``)."""
        with self._lock:
            return [one.endpoint for one in self._tokens.values() if one.kind == kind and one.endpoint is not None]

    def _subscribers(self, topic: str) -> list[Entity]:
        """Return the subscribers of a topic that may be a robot."""
        return [one for one in self._endpoints("MS") if one.topic == topic and "/robowidgets_" not in one.node]

    def _adverts(self) -> list[Advert]:
        publishers, subscribers = (_by_topic(self._endpoints(kind)) for kind in ("MP", "MS"))
        return adverts_of(publishers, subscribers)

    def _subscribe(self, wish: TopicWish) -> None:
        try:
            decode = _decoder(wish)
        except DecodeError as error:
            self._unreadable.add(wish.topic)
            self._listener.on_trouble(wish.topic, str(error))
            return
        key = f"{self._domain}/{wish.topic.strip('/')}/{wish.wire_type}/{wish.hash}"
        ring: RingChannel[Any] = RingChannel(MOST_UNREAD if wish.each else queue_depth(wish.type))
        subscriber: Any
        if wish.latched:
            history = ext.HistoryConfig(detect_late_publishers=True)
            subscriber = ext.declare_advanced_subscriber(self._session, key, ring, history=history)
        else:
            subscriber = self._session.declare_subscriber(key, ring)
        qos = _LATCHED_QOS if wish.latched else _SENSOR_QOS
        end = "/".join((wish.topic.replace("/", "%"), wish.wire_type, wish.hash, qos))
        token = self._session.liveliness().declare_token(self._token("MS", next(self._numbers), end))
        self._wishes[wish] = _Subscription(subscriber, token, decode)

    def _token(self, kind: str, number: int, endpoint: str = "") -> str:
        """Return the key of a token of ours: of the node, a publisher or a subscriber."""
        parts = [_AREA, str(self._domain), self._zid, "0", str(number), kind, "%", "%", self._node]
        return "/".join([*parts, *filter(None, [endpoint])])


def _config(locator: str) -> zenoh.Config:
    config = zenoh.Config()
    settings = {
        "mode": '"client"',
        "connect/endpoints": f'["{locator}"]',
        "connect/timeout_ms": str(round(1000 * CONNECT_TIMEOUT_S)),
        "scouting/multicast/enabled": "false",
        "transport/shared_memory/enabled": "false",
    }
    for name, value in settings.items():
        config.insert_json5(name, value)
    return config


def _parse_token(key: str) -> _Token | None:
    """Return the parts of a token, or None for tokens of services and for other texts.

    A key is ``@ros2_lv/domain/session/node number/number/kind/enclave/namespace/node/topic/type/hash/qos``.
    """
    parts = key.split("/")
    if len(parts) < 9 or parts[0] != _AREA:
        return None
    session, number, kind = parts[2], parts[4], parts[5]
    node = f"{parts[7].replace('%', '/').rstrip('/')}/{parts[8]}"
    if kind not in ("MP", "MS") or len(parts) < 13:
        return None
    topic, type_name, qos = parts[9].replace("%", "/"), ros_type(parts[10]), parts[12].split(":")
    if not type_name or len(qos) < 2:
        return None
    endpoint = Entity(topic, type_name, parts[10], parts[11], qos[1] == _TRANSIENT_LOCAL, qos[0] != _BEST_EFFORT, node)
    return _Token((session, f"{parts[3]}/{number}/{kind}"), kind, node, endpoint)


def _by_topic(endpoints: Iterable[Entity]) -> dict[tuple[str, str], set[str]]:
    """Return the names of the nodes of endpoints by topic and type."""
    found: dict[tuple[str, str], set[str]] = {}
    for one in endpoints:
        found.setdefault((one.topic, one.type), set()).add(one.node)
    return found


def _decoder(wish: TopicWish) -> Decode:
    """Return a function that decodes the messages of a publisher, by the definition that has its hash.

    Raises:
        DecodeError: the type is unknown, or its known definitions have another hash, so that numbers could be wrong.
    """
    texts = definitions_of(wish.type)
    remedy = "add its .msg files with robowidgets.messages.add_definitions(folder), or use feeds.foxglove"
    if not texts:
        raise DecodeError(f"{wish.topic} comes as {wish.type}, a type that is not known here: {remedy}")
    if wish.hash == _NO_HASH:  # Humble: its definition is the default one, and the others follow if it fails
        return decoder_for(wish.type)
    for text in texts:
        if hash_of(wish.type, text) == wish.hash:
            return decoder_for(wish.type, text)
    raise DecodeError(
        f"{wish.topic} comes as {wish.type} with other fields than known here (its hash is {wish.hash}): {remedy}"
    )
