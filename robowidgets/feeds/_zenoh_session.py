"""A session of Zenoh that speaks the protocol of rmw_zenoh. One thread reads while another may publish."""

from __future__ import annotations

import os
import secrets
import struct
import threading
import time
from collections.abc import Iterable
from itertools import count
from typing import Any, NamedTuple

import zenoh
from zenoh import ext
from zenoh.handlers import Callback, RingChannel

from ..messages.decoding import Decode, DecodeError
from ..runtime.clock import Clock
from ..samples.staleness import ROBOT_GONE, ROBOT_SILENCE
from ._guard.mark import MARK
from ._ros2_common import TopicReports, adverts_of, nobody_left, queue_depth, unconfirmed, unknown_type
from ._ros2_types import dds_type, decoder_for, definitions_of, hash_of, ros_type
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

_AREA = "@ros2_lv"
_NO_HASH = "TypeHashNotSupported"
"""The hash of every type on a robot with Humble, which has no hashes."""

_TRANSIENT_LOCAL = "1"
"""The durability of a publisher that keeps its last messages, in the quality of service of its token."""

_SENSOR_QOS, _LATCHED_QOS, _SPEED_QOS = "2::,5:,:,:,,", ":1:,1:,:,:,,", "::,1:,:,:,,"
"""Reliability, durability, history and depth, deadline, lifespan and liveliness of our subscribers and publishers."""

_GID_SIZE = 16
_HEAD = struct.Struct("<qqB")
"""The start of an attachment: sequence number, nanoseconds since 1970, and the size of the identifier that follows."""


class RouterLostError(Exception):
    """The router is lost. The text is the reason."""


class Entity(NamedTuple):
    """A publisher or subscriber of another node, as its token reports it."""

    kind: str
    """``MP`` for a publisher, ``MS`` for a subscriber."""
    topic: str
    type: str
    hash: str
    latched: bool
    node: str


class TopicWish(NamedTuple):
    """A subscription to make. ``each`` requests every message."""

    topic: str
    type: str
    hash: str
    latched: bool
    each: bool


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
        self._domain, self._listener, self._clock = domain, listener, clock
        self._reports = TopicReports(listener, no_robot, clock)
        self._lock = threading.RLock()
        self._news = clock.condition(self._lock)
        self._is_woken = False
        self._entities: dict[str, Entity] = {}
        """By the keys of their tokens, what other nodes have. Zenoh's thread changes it with the lock."""
        self._changed = True
        self._wishes: dict[TopicWish, _Subscription] = {}
        self._followed: tuple[frozenset[str], frozenset[str]] | None = None
        self._unreadable: set[str] = set()
        """The topics with a publisher whose messages cannot be decoded."""
        self._has_passed = False
        """True if messages were passed on since the last wait, so that more may have come."""
        self._writing = threading.Lock()
        self._publishers: dict[tuple[str, str, str], _Publisher] = {}
        """By topic, type and hash."""
        self._zeros = Zeros(clock)
        self._asked_at: float | None = None
        """The time of the question that the router has not answered yet, or None."""
        self._ask_at = clock.now()
        self._is_silent = False
        self._numbers = count(1)
        self._session = zenoh.open(_config(locator))
        self._own = f"{_AREA}/{domain}/{self._session.info.zid()}/"
        """The start of the keys of our tokens."""
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
        if self._has_passed:
            self._has_passed = False
            return
        until = self._clock.now() + (POLL_PERIOD_S if self._wishes else PING_PERIOD_S)
        with self._lock:
            while not (self._is_woken or self._changed) and self._news.wait_until(until):
                pass
            self._is_woken = False

    def look(self) -> None:
        """Report the topics, if they changed, and repeat zeros.

        Raises:
            RouterLostError: the router has ended the connection, or does not answer.
        """
        self._check_router()
        with self._lock:
            changed, self._changed = self._changed, False
        if changed:
            self._followed = None
            self._reports.change(self._adverts())
        self._reports.look()
        self._repeat_zeros()

    def follow(self, topics: frozenset[str], each: frozenset[str]) -> None:
        """Subscribe to the publishers of these topics, to every message if wanted, and to nothing else."""
        if (topics, each) == self._followed:
            return
        self._followed = topics, each
        offers = [one for one in self._all("MP") if one.topic in topics]
        latched = {(one.topic, one.type, one.hash) for one in offers if one.latched}
        versions = {(one.topic, one.type, one.hash) for one in offers}
        wishes = {TopicWish(*one, latched=one in latched, each=one[0] in each) for one in versions}
        for wish in self._wishes.keys() - wishes:
            self._wishes.pop(wish).end()
        before, self._unreadable = self._unreadable, set()
        for wish in sorted(wishes - self._wishes.keys()):
            self._subscribe(wish)
        for topic in before - self._unreadable:
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
        self._has_passed = True
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
            FeedError: no subscriber is there any more, the router does not answer, or Zenoh refuses the message.
            TimeoutError: the message is a zero, and the router has not answered, or the subscriber is gone.
        """
        with self._writing:
            there = [one for one in self._subscribers(topic) if one.type == type_name]
            known = [key for key in self._publishers if key[:2] == (topic, type_name)]
            if not there and not known:
                raise NotConnectedYetError(f"{topic} has no subscriber for {type_name} yet")
            if not there and not is_zero:
                raise FeedError(f"{topic} has no subscriber any more")
            if not is_zero and (silence := self._silence) >= ROBOT_SILENCE:  # it would reach the robot late
                raise FeedError(
                    f"the Zenoh router has not answered for {silence:.1f} s: until it does, only zero is sent"
                )
            try:
                for key in {*known, *((topic, type_name, one.hash) for one in there)}:
                    self._publisher(key).write(raw)
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

    def _publisher(self, key: tuple[str, str, str]) -> _Publisher:
        """Return the publisher of a topic, a type and its hash. A new one declares its token first."""
        if key not in self._publishers:
            token = self._declare("MP", *key, _SPEED_QOS)
            publisher = self._publishers[key] = _Publisher(self._session, self._data_key(*key), token)
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

    def _check_router(self) -> None:
        """Raise RouterLostError if the router is lost. Ask it from time to time, without a wait."""
        now = self._clock.now()
        if not self._session.info.routers_zid():
            raise RouterLostError("the Zenoh router has ended the connection")
        if self._silence >= ROBOT_GONE:
            raise RouterLostError(f"the Zenoh router has not answered for {ROBOT_GONE:g} s")
        if self._asked_at is None and now >= self._ask_at:
            self._asked_at, self._ask_at = now, now + PING_PERIOD_S
            self._ask(self._on_answer, 2 * ROBOT_GONE)
        is_silent = self._silence >= ROBOT_SILENCE
        if is_silent != self._is_silent:
            self._is_silent = is_silent
            reason = "the Zenoh router does not answer: until it does, only zero is sent" if is_silent else ""
            for topic in {topic for topic, *_ in list(self._publishers)}:
                self._listener.on_unheard(topic, reason)

    @property
    def _silence(self) -> float:
        """Seconds since the question that the router has not answered yet, or 0."""
        asked_at = self._asked_at
        return 0.0 if asked_at is None else self._clock.now() - asked_at

    def _on_answer(self) -> None:
        """Note an answer of the router. Zenoh's thread calls it."""
        self._asked_at = None

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
        nothing = f"{self._own}0/0/nothing"
        handler: Callback[Any] = Callback(lambda _reply: None, drop=then, indirect=False)
        self._session.liveliness().get(nothing, handler, timeout=timeout)

    def _on_token(self, sample: Any) -> None:
        """Note a publisher or subscriber that appears or disappears. Zenoh's thread calls it."""
        key = str(sample.key_expr)
        entity = _parse_token(key)
        if entity is None or key.startswith(self._own) or entity.node.rpartition("/")[2].startswith(MARK):
            return
        with self._lock:
            if sample.kind == zenoh.SampleKind.PUT:
                self._entities[key] = entity
            else:
                self._entities.pop(key, None)
            self._changed = True
            self._news.notify_all()

    def _all(self, kind: str) -> list[Entity]:
        """Return the publishers (``MP``) or the subscribers (``MS``)."""
        with self._lock:
            return [one for one in self._entities.values() if one.kind == kind]

    def _subscribers(self, topic: str) -> list[Entity]:
        """Return the subscribers of a topic that may be a robot."""
        return [one for one in self._all("MS") if one.topic == topic and "/robowidgets_" not in one.node]

    def _adverts(self) -> list[Advert]:
        return adverts_of(_by_topic(self._all("MP")), _by_topic(self._all("MS")))

    def _subscribe(self, wish: TopicWish) -> None:
        try:
            decode = _decoder(wish)
        except DecodeError as error:
            self._unreadable.add(wish.topic)
            self._listener.on_trouble(wish.topic, str(error))
            return
        version = wish.topic, wish.type, wish.hash
        key = self._data_key(*version)
        ring: RingChannel[Any] = RingChannel(MOST_UNREAD if wish.each else queue_depth(wish.type))
        subscriber: Any
        if wish.latched:
            history = ext.HistoryConfig(detect_late_publishers=True)
            subscriber = ext.declare_advanced_subscriber(self._session, key, ring, history=history)
        else:
            subscriber = self._session.declare_subscriber(key, ring)
        token = self._declare("MS", *version, _LATCHED_QOS if wish.latched else _SENSOR_QOS)
        self._wishes[wish] = _Subscription(subscriber, token, decode)

    def _data_key(self, topic: str, type_name: str, type_hash: str) -> str:
        """Return the key of the messages of a topic."""
        return f"{self._domain}/{topic.strip('/')}/{dds_type(type_name)}/{type_hash}"

    def _declare(self, kind: str, topic: str, type_name: str, type_hash: str, qos: str) -> Any:
        """Declare the token of a publisher (``MP``) or a subscriber (``MS``) of ours, and return it."""
        parts = (topic.replace("/", "%"), dds_type(type_name), type_hash, qos)
        return self._session.liveliness().declare_token("/".join((self._token(kind, next(self._numbers)), *parts)))

    def _token(self, kind: str, number: int) -> str:
        """Return the key of the token of our node (``NN``), or the start of the key of another token of it."""
        return f"{self._own}0/{number}/{kind}/%/%/{self._node}"


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


def _parse_token(key: str) -> Entity | None:
    """Return the publisher or subscriber of a token, or None for tokens of nodes and services and for other texts.

    A key is ``@ros2_lv/domain/session/node number/number/kind/enclave/namespace/node/topic/type/hash/qos``.
    """
    parts = key.split("/")
    if len(parts) < 13 or parts[0] != _AREA or parts[5] not in ("MP", "MS"):
        return None
    type_name, qos = ros_type(parts[10]), parts[12].split(":")
    if not type_name or len(qos) < 2:
        return None
    node = f"{parts[7].replace('%', '/').rstrip('/')}/{parts[8]}"
    topic = parts[9].replace("%", "/")
    return Entity(parts[5], topic, type_name, parts[11], qos[1] == _TRANSIENT_LOCAL, node)


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
    if not texts:
        raise DecodeError(unknown_type(wish.topic, wish.type))
    if wish.hash == _NO_HASH:  # Humble: its definition is the default one, and the others follow if it fails
        return decoder_for(wish.type)
    for text in texts:
        if hash_of(wish.type, text) == wish.hash:
            return decoder_for(wish.type, text)
    raise DecodeError(
        f"{wish.topic} comes as {wish.type} with other fields than known here (its hash is {wish.hash}): "
        "add its .msg files with robowidgets.messages.add_definitions(folder), or use feeds.foxglove"
    )
