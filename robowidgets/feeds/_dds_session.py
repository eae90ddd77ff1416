"""A participant in a DDS domain with its readers and writers. One thread reads while another may publish."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Iterable, Mapping
from contextlib import suppress
from typing import Any, NamedTuple
from uuid import UUID

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import DDSException, GuardCondition, InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from ..messages.decoding import Decode, DecodeError
from ..messages.infrastructure import is_large
from ..runtime.clock import Clock, scheduler
from ._dds_domain import configured
from ._dds_types import NODES, dds_topic, definition_of, opaque, ros_topic, struct, type_hash
from ._guard.mark import MARK
from ._ros2_common import (
    TopicReports,
    adverts_of,
    nobody_left,
    not_coming,
    not_received,
    queue_depth,
    speed_types,
    unconfirmed,
    unknown_type,
)
from ._ros2_types import decoder_for, ros_type
from ._zeros import Zeros
from .middleware import EVENTS, MOST_UNREAD, Advert, FeedError, Listener

_MANY = 1000
_AT_ONCE = 100
"""The number of messages that are taken from a reader in one call."""

_DEEPEST = 10 * MOST_UNREAD
"""Length of the queue in Cyclone DDS for a reader of every message. It fills only while other code holds the GIL."""

_LOOK = duration(milliseconds=500)
_NEW = ViewState.Any | SampleState.NotRead | InstanceState.Any
_LATCHED = (Policy.Durability.TransientLocal, Policy.Durability.Transient, Policy.Durability.Persistent)

_MATCHING = 0.3
"""Seconds for which the first message on a topic waits until subscribers match."""

_SETTLING = 0.05
"""Seconds for which it waits after that. The subscriber must also discover our writer, and DDS does not report when it
has. Otherwise a best-effort subscriber would lose the message, and a reliable one would get it 0.1 s later."""

_CONFIRMING = 0.3
"""Seconds within which a reliable subscriber confirms zero."""

_OURS = b"reader=robowidgets;"
"""The user data of our readers. A kernel's readers also match the writers of its guard, but they are not a robot."""

_POLICIES = {
    2: "durability",
    4: "deadline",
    6: "ownership",
    8: "liveliness",
    11: "reliability",
    23: "data representation",
    24: "type consistency",
}
"""The policies that can make a publisher and a subscriber incompatible, by their numbers in the DDS specification."""


class Endpoint(NamedTuple):
    """A publisher or subscriber. ``type_id`` is None unless the endpoint describes the fields of its type to DDS."""

    topic: str
    type: str
    latched: bool
    reliable: bool
    user_data: bytes
    type_id: Any


class Wish(NamedTuple):
    """A reader to create. ``definition`` comes from `definition_of`; ``each`` requests every message.

    ``reliable`` requests lost packets again, which works only if all publishers offer it.
    """

    topic: str
    type: str
    latched: bool
    described: bool
    definition: str = ""
    each: bool = False
    reliable: bool = False


class _Reader(NamedTuple):
    """A reader of DDS. ``waiting`` contains the messages that were taken from DDS and not passed on yet."""

    reader: Any
    condition: Any
    decode: Decode
    waiting: deque[Any]


class DdsSession:
    """Our participant in a domain. Only the thread that made it may use it, except for `wake` and `publish`.

    Args:
        domain: its number.
        listener: gets messages and reports.
        interface: the network interface to use.
        no_robot: the text to report after a moment without a robot, until one is discovered.
        clock: the clock of its waits, except for waits in Cyclone DDS.
        mark: for a guard, the mark of its publishers. Publishers with the mark of our guards are not other programs.

    Raises:
        DDSException: the network cannot be used.
    """

    def __init__(
        self,
        domain: int,
        listener: Listener,
        interface: str | None = None,
        no_robot: str = "",
        clock: Clock = scheduler.clock,
        mark: str = "",
    ) -> None:
        self._clock, self._mark = clock, f"guard={mark};".encode() if mark else b""
        self._listener = listener
        self._reports = TopicReports(listener, no_robot, clock)
        self._domain = configured(domain, interface, alone=bool(mark))
        self._participant = DomainParticipant(domain)
        self._own = self._participant.guid
        self._waitset = WaitSet(self._participant)
        self._guard = GuardCondition(self._participant)
        self._waitset.attach(self._guard)
        self._publications = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._subscriptions = BuiltinDataReader(self._participant, BuiltinTopicDcpsSubscription)
        self._offers: dict[UUID, Endpoint] = {}
        self._wants: dict[UUID, Endpoint] = {}
        self._node_names: dict[bytes, Mapping[bytes, str]] = {}
        """By participant, the names of the nodes by the GUIDs of their writers and readers."""
        self._conditions = [ReadCondition(r, _NEW) for r in (self._publications, self._subscriptions)]
        for condition in self._conditions:
            self._waitset.attach(condition)
        self._readers: dict[Wish, _Reader] = {}
        self._followed: tuple[set[str], frozenset[str]] | None = None
        self._writing = threading.Lock()
        self._writers: dict[tuple[str, str], Any] = {}
        self._zeros = Zeros(self._clock)
        self._changed = True

    def close(self) -> None:
        """End the participant and everything that it made. Otherwise it lives while anything refers to it.

        Before that, zero is repeated for best-effort subscribers.
        """
        with self._writing:
            with suppress(DDSException):  # the network is gone
                for topic, kind, raw in self._zeros.last(self._all_confirm):
                    writer = self._writers[topic, kind]
                    writer.write(writer.data_type(raw))
            # cyclonedds does the same on garbage collection. It has no other call to end a participant.
            self._participant.__del__()
            self._domain = None  # it ends with the last reference

    def wake(self) -> None:
        """Make `wait` return."""
        self._guard.set(True)

    def wait(self) -> None:
        """Wait for a message, a change of the topics, or `wake`."""
        if not any(reader.waiting for reader in self._readers.values()):
            self._waitset.wait(_LOOK)
        self._guard.take()

    def look(self) -> None:
        """Report the topics, if they changed, and the subscribers that do not receive our messages."""
        self._take(self._publications, self._offers)
        self._take(self._subscriptions, self._wants)
        for wish in [wish for wish in self._readers if wish.topic == NODES]:
            self.pass_on(wish)
        if self._changed:
            self._changed, self._followed = False, None
            for topic in {topic for topic, _ in list(self._writers)}:
                if missing := self._without_writer(topic):
                    with self._writing:
                        self._create_writers(topic, missing)
            self._reports.change(self._adverts())
        self._reports.look()
        self._report_unheard()
        self._repeat_zeros()

    def follow(self, topics: Iterable[str], each: frozenset[str]) -> None:
        """Create readers for the publishers of these topics, and another reader if every message is wanted.

        All other readers are removed.
        """
        topics = {*topics, NODES}
        if (topics, each) != self._followed:
            self._followed = topics, each
            self._set_readers(topics, each)
        for wish, reader in self._readers.items():
            status = reader.reader.get_requested_incompatible_qos_status()
            if status.total_count_change > 0:
                self._listener.on_trouble(wish.topic, not_coming(wish.topic, _policy(status)))
            if wish.each and (missed := reader.reader.get_sample_lost_status().total_count_change):
                self._listener.on_missed(wish.topic, missed)

    def _set_readers(self, topics: set[str], each: frozenset[str]) -> None:
        wishes = {wish for topic in topics for wish in _wishes(topic, self._offers.values())}
        wishes |= {_wish_for_each(wish, self._offers.values()) for wish in wishes if wish.topic in each}
        for wish in self._readers.keys() - wishes:
            self._waitset.detach(self._readers.pop(wish).condition)
        for wish in wishes - self._readers.keys():
            self._create_reader(wish)

    def pass_on(self, wish: Wish) -> bool:
        """Pass on the next message of a reader. Return False if it has none."""
        reader, replaced = self._readers[wish], 0
        if not (wish.each and reader.waiting):
            replaced = self._take_all(reader)
            if wish.each and replaced:
                self._listener.on_missed(wish.topic, replaced)
        taken = [reader.waiting.popleft()] if reader.waiting else []
        for sample in taken:
            if not hasattr(sample, "raw"):  # a sample without data: the publisher is gone
                continue
            try:
                message = reader.decode(sample.raw)
            except DecodeError as error:
                self._listener.on_trouble(wish.topic, f"a message of {wish.topic} cannot be read: {error}")
            else:
                if wish.topic != NODES:
                    self._listener.on_trouble(wish.topic, "")
                    each = wish.each or not any(one.each and one.topic == wish.topic for one in self._readers)
                    self._listener.on_message(
                        wish.topic, message, newest=not wish.each, each=each, replaced=0 if wish.each else replaced
                    )
                elif hasattr(message, "node_entities_info_seq"):
                    self._node_names[_guid(message.gid)] = _node_names(message)
                    self._changed = True
        return bool(taken)

    def _take_all(self, reader: _Reader) -> int:
        """Take all messages of a reader from DDS. Return the number of messages that do not fit in and are dropped."""
        before, count = len(reader.waiting), 0
        while samples := reader.reader.take(N=_AT_ONCE):
            count += len(samples)
            reader.waiting.extend(samples)
            if len(samples) < _AT_ONCE:
                break
        # If the queue in DDS was full, at least one message was replaced in it.
        return before + count - len(reader.waiting) + (count >= _DEEPEST)

    @property
    def wishes(self) -> list[Wish]:
        """The readers, except the reader of the names of nodes."""
        return [wish for wish in self._readers if wish.topic != NODES]

    def publish(self, topic: str, type_name: str, raw: bytes, *, is_zero: bool) -> None:
        """Write a message from any thread. The first message on a topic waits a moment until subscribers match.

        Zero waits until each reliable subscriber has confirmed it, which takes about one round trip.

        Raises:
            FeedError: Cyclone DDS refuses it.
            TimeoutError: the message is a zero that a subscriber has not confirmed, or that has no subscriber any more.
        """
        with self._writing:
            try:
                if (topic, type_name) not in self._writers:
                    self._create_writers(topic, {type_name} | self._without_writer(topic))
                writer = self._writers[topic, type_name]
                writer.write(writer.data_type(raw))
            except (DDSException, DecodeError) as error:
                raise FeedError(f"cannot publish on {topic}: {error}") from None
            subscribers = len(self._subscribers(topic))
            if not is_zero:
                self._zeros.note_speed(topic, subscribers)
                return
            self._zeros.note_zero(topic, type_name, raw, subscribers)
            if not self._is_confirmed(writer):
                raise TimeoutError(unconfirmed(topic))
            if self._zeros.is_unheard(topic, subscribers):
                raise TimeoutError(nobody_left(topic))

    def _is_confirmed(self, writer: Any) -> bool:
        """Return True if each reliable subscriber confirms what was written within `_CONFIRMING`."""
        try:
            return bool(writer.wait_for_acks(duration(seconds=_CONFIRMING)))
        except (AttributeError, DDSException):  # on a timeout, cyclonedds looks up its error code on the wrong class
            return False

    def _repeat_zeros(self) -> None:
        """Repeat the zeros that subscribers may have missed. If another thread is writing, do it at the next look."""
        if not self._writing.acquire(blocking=False):
            return
        try:
            for topic in self._zeros.topics():
                there = self._subscribers(topic)
                due = self._zeros.due(topic, len(there), all_confirm=all(map(_is_reliable, there)))
                for kind, raw in due.items():
                    writer = self._writers[topic, kind]
                    with suppress(DDSException):  # the next requested zero reports it
                        writer.write(writer.data_type(raw))
        finally:
            self._writing.release()

    def _take(self, builtin: Any, known: dict[UUID, Endpoint]) -> None:
        while samples := builtin.take(N=_MANY):
            self._changed = True
            for sample in samples:
                topic, kind = ros_topic(sample.topic_name or ""), ros_type(sample.type_name or "")
                if sample.sample_info.instance_state != InstanceState.Alive:
                    known.pop(sample.key, None)
                elif topic and kind and sample.participant_key != self._own:
                    endpoint = _endpoint(topic, kind, sample)
                    if MARK.encode() not in endpoint.user_data:
                        known[sample.key] = endpoint

    def _create_reader(self, wish: Wish) -> None:
        try:
            decode = decoder_for(wish.type, wish.definition)
            kind = struct(wish.type, wish.definition) if wish.described else opaque(wish.type)
            user_data = Policy.Userdata(type_hash(wish.type, wish.definition) + _OURS)
        except DecodeError:
            self._listener.on_trouble(wish.topic, unknown_type(wish.topic, wish.type))
            return
        # A queue with a limit never rejects a message. A reliable reader that rejects one blocks its publisher.
        room = MOST_UNREAD if wish.each else EVENTS if wish.topic == NODES else queue_depth(wish.type)
        # If only the newest message is needed, the others are only counted.
        depth = _DEEPEST if wish.each else room if is_large(wish.type) else MOST_UNREAD
        qos = Qos(
            Policy.Reliability.Reliable(0) if wish.latched or wish.reliable else Policy.Reliability.BestEffort,
            Policy.Durability.TransientLocal if wish.latched else Policy.Durability.Volatile,
            Policy.History.KeepLast(depth),
            user_data,
        )
        reader = DataReader(self._participant, Topic(self._participant, dds_topic(wish.topic), kind), qos)
        condition = ReadCondition(reader, _NEW)
        self._waitset.attach(condition)
        self._readers[wish] = _Reader(reader, condition, decode, deque(maxlen=room))

    def _without_writer(self, topic: str) -> set[str]:
        """Return the types of speeds that the subscribers of a topic expect and that have no writer yet."""
        types = speed_types(want.type for want in list(self._wants.values()) if want.topic == topic)
        return {kind for kind in types if (topic, kind) not in self._writers}

    def _create_writers(self, topic: str, types: Iterable[str]) -> None:
        """Create the missing writers, and wait until the first ones of a topic match. Called with the lock held."""
        is_first = all(name != topic for name, _ in self._writers)
        new = [self._create_writer(topic, kind) for kind in types if (topic, kind) not in self._writers]
        until = self._clock.now() + _MATCHING * is_first
        while not all(map(self._is_settled, new)) and self._clock.now() < until:
            self._clock.sleep(0.005)
        if is_first and any(map(self._matched, new)):
            self._clock.sleep(_SETTLING)

    def _create_writer(self, topic: str, type_name: str) -> Any:
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.Volatile,
            Policy.History.KeepLast(1),  # a write never blocks: it replaces what a slow subscriber has not taken
            Policy.Userdata(type_hash(type_name) + self._mark),
        )
        writer = DataWriter(self._participant, Topic(self._participant, dds_topic(topic), struct(type_name)), qos)
        self._writers[topic, type_name] = writer
        return writer

    def _is_settled(self, writer: Any) -> bool:
        return bool(self._matched(writer) or writer.get_offered_incompatible_qos_status().total_count)

    def _matched(self, writer: Any) -> set[UUID]:
        """Return the GUIDs of the subscribers that match a writer, except ours."""
        return {one.key for one in self._matches(writer)}

    def _matches(self, writer: Any) -> list[Any]:
        there = map(writer.get_matched_subscription_data, writer.get_matched_subscriptions())
        return [one for one in there if one is not None and one.participant_key != self._own]

    def _subscribers(self, topic: str) -> list[Any]:
        """Return the subscribers of other programs that match our writers of a topic."""
        writers = [writer for (name, _), writer in list(self._writers.items()) if name == topic]
        return [one for writer in writers for one in self._matches(writer) if _OURS not in _user_data(one)]

    def _all_confirm(self, topic: str) -> bool:
        return all(map(_is_reliable, self._subscribers(topic)))

    def _report_unheard(self) -> None:
        reasons: dict[str, str] = {}
        for (topic, kind), writer in list(self._writers.items()):
            status = writer.get_offered_incompatible_qos_status()
            reasons.setdefault(topic, "")
            if status.total_count and self._wants_of(topic, kind) - self._matched(writer):
                reasons[topic] = not_received(topic, _policy(status))
        for topic, reason in reasons.items():
            self._listener.on_unheard(topic, reason)

    def _wants_of(self, topic: str, kind: str) -> set[UUID]:
        return {key for key, want in self._wants.items() if (want.topic, want.type) == (topic, kind)}

    def _adverts(self) -> list[Advert]:
        names = {key: name for nodes in self._node_names.values() for key, name in nodes.items()}
        offered, wanted = (_by_topic(endpoints, names) for endpoints in (self._offers, self._wants))
        return [advert for advert in adverts_of(offered, wanted) if advert.name != NODES]


def _by_topic(endpoints: Mapping[UUID, Endpoint], names: Mapping[bytes, str]) -> dict[tuple[str, str], set[str]]:
    """Return the names of the nodes of endpoints by topic and type. An unknown name is empty."""
    found: dict[tuple[str, str], set[str]] = {}
    for key, endpoint in endpoints.items():
        found.setdefault((endpoint.topic, endpoint.type), set()).add(names.get(key.bytes, ""))
    return found


def _policy(status: Any) -> str:
    """Return the name of the policy that last made an endpoint incompatible with ours."""
    return _POLICIES.get(status.last_policy_id, f"policy {status.last_policy_id}")


def _endpoint(topic: str, kind: str, sample: Any) -> Endpoint:
    qos = sample.qos
    reliable = isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable)
    latched = reliable and qos[Policy.Durability] in _LATCHED
    return Endpoint(topic, kind, latched, reliable, _user_data(sample), sample.type_id)


def _user_data(endpoint: Any) -> bytes:
    return bytes(endpoint.qos[Policy.Userdata].data) if Policy.Userdata in endpoint.qos else b""


def _is_reliable(endpoint: Any) -> bool:
    return isinstance(endpoint.qos[Policy.Reliability], Policy.Reliability.Reliable)


def _node_names(entities: Any) -> dict[bytes, str]:
    """Return the names of the nodes in a ``ParticipantEntitiesInfo`` by the GUIDs of their writers and readers."""
    return {
        _guid(gid): f"{node.node_namespace.rstrip('/')}/{node.node_name}"
        for node in entities.node_entities_info_seq
        for gid in (*node.writer_gid_seq, *node.reader_gid_seq)
    }


def _guid(gid: Any) -> bytes:
    """Return the GUID in a ``rmw_dds_common/Gid``: its first 16 bytes. Up to Humble, a Gid has 24 bytes."""
    return bytes(gid.data)[:16]


def _wishes(topic: str, offers: Iterable[Endpoint]) -> set[Wish]:
    """Return a reader for each type on a topic. It is latched only if all publishers are, so that it matches all."""
    by_type: dict[str, list[Endpoint]] = {}
    for offer in offers:
        if offer.topic == topic:
            by_type.setdefault(offer.type, []).append(offer)
    return {_wish(topic, kind, same) for kind, same in by_type.items()}


def _wish_for_each(wish: Wish, offers: Iterable[Endpoint]) -> Wish:
    """Return the reader of every message for a reader. It is reliable only if all publishers are."""
    same = [offer.reliable for offer in offers if (offer.topic, offer.type) == (wish.topic, wish.type)]
    return wish._replace(each=True, reliable=all(same))


def _wish(topic: str, kind: str, offers: Iterable[Endpoint]) -> Wish:
    type_ids = [offer.type_id for offer in offers if offer.type_id is not None]
    definition = definition_of(kind, [offer.user_data for offer in offers], type_ids)
    return Wish(topic, kind, all(offer.latched for offer in offers), bool(type_ids), definition)
