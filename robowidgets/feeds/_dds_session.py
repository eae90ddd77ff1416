"""A participant in a DDS domain with its readers and writers, all in the hands of one thread."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsPublication, BuiltinTopicDcpsSubscription
from cyclonedds.core import DDSStatus, GuardCondition, InstanceState, ReadCondition, SampleState, ViewState, WaitSet
from cyclonedds.domain import DomainParticipant
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

from ..recordings.ros_types import Decode
from ..recordings.source import RecordingError
from ._dds_types import decoder, opaque, ros_topic, ros_type, struct, type_hash
from .middleware import EVENTS, Advert, Listener, is_event

_MANY = 1000
_DEPTH = 5
"""Messages that wait for us, as for sensor data."""
_LOOK = duration(milliseconds=500)
_MATCHING = duration(milliseconds=200)
_NEW = ViewState.Any | SampleState.NotRead | InstanceState.Any
_LATCHED = (Policy.Durability.TransientLocal, Policy.Durability.Transient, Policy.Durability.Persistent)

_POLICIES = {
    2: "keeps no message for those who come late",
    4: "promises no rate (deadline)",
    6: "wants to be the only one (exclusive ownership)",
    8: "promises no sign of life (liveliness)",
    11: "is best-effort",
    23: "encodes its messages in another way (XCDR2)",
    24: "defines the fields of its type in another way",
}
"""What a publisher does that no reader of ours puts up with, by the number of the policy in the DDS specification."""


class Endpoint(NamedTuple):
    """Somebody who publishes or subscribes. ``described``: it tells the fields of its type, not only the name."""

    topic: str
    type: str
    latched: bool
    described: bool


class Wish(NamedTuple):
    """A reader that we should have."""

    topic: str
    type: str
    latched: bool
    described: bool


class _Reader(NamedTuple):
    reader: Any
    condition: Any
    decode: Decode


class Session:
    """Everything we have in a domain; the thread that made it uses it, only `wake` may be called from others.

    Raises:
        DDSException: the network cannot be used.
    """

    def __init__(self, domain: int, listener: Listener) -> None:
        self._listener = listener
        self._participant = DomainParticipant(domain)
        self._own = self._participant.guid
        self._waitset = WaitSet(self._participant)
        self._guard = GuardCondition(self._participant)
        self._waitset.attach(self._guard)
        self._publications = BuiltinDataReader(self._participant, BuiltinTopicDcpsPublication)
        self._subscriptions = BuiltinDataReader(self._participant, BuiltinTopicDcpsSubscription)
        self._offers: dict[Any, Endpoint] = {}
        self._wants: dict[Any, Endpoint] = {}
        self._conditions = [ReadCondition(r, _NEW) for r in (self._publications, self._subscriptions)]
        for condition in self._conditions:
            self._waitset.attach(condition)
        self._readers: dict[Wish, _Reader] = {}
        self._writers: dict[tuple[str, str], Any] = {}
        self._troubles: dict[str, str] = {}
        self._told: list[Advert] | None = None

    def wake(self) -> None:
        """Let `wait` return."""
        self._guard.set(True)

    def wait(self) -> None:
        """Wait for a message, a change of the topics, or `wake`."""
        self._waitset.wait(_LOOK)
        self._guard.take()

    def look(self) -> None:
        """Tell the topics, if they changed."""
        self._take(self._publications, self._offers)
        self._take(self._subscriptions, self._wants)
        adverts = _adverts(self._offers.values(), self._wants.values())
        if adverts != self._told:
            self._told = adverts
            self._listener.on_topics(adverts)

    def follow(self, topics: Iterable[str]) -> None:
        """Have readers for what is published on these topics, and for nothing else."""
        topics = set(topics)
        wishes = {wish for topic in topics for wish in _wishes(topic, self._offers.values())}
        for wish in self._readers.keys() - wishes:
            self._waitset.detach(self._readers.pop(wish).condition)
        for topic in self._troubles.keys() - topics:
            del self._troubles[topic]
        for wish in wishes - self._readers.keys():
            self._begin(wish)
        for wish, reader in self._readers.items():
            status = reader.reader.get_requested_incompatible_qos_status()
            if status.total_count_change > 0:
                does = _POLICIES.get(status.last_policy_id, f"disagrees on policy {status.last_policy_id}")
                self._trouble(wish.topic, f"a publisher of {wish.topic} {does}, so its messages do not come")

    def messages(self, wish: Wish) -> None:
        """Hand on the next message of a reader, if one came."""
        reader = self._readers[wish]
        for sample in reader.reader.take(N=1):
            if not hasattr(sample, "raw"):  # the publisher is gone, which comes as a sample without data
                continue
            try:
                message = reader.decode(sample.raw)
            except RecordingError as error:
                self._trouble(wish.topic, f"a message of {wish.topic} cannot be read: {error}")
            else:
                self._trouble(wish.topic, "")
                self._listener.on_message(wish.topic, message)

    @property
    def wishes(self) -> list[Wish]:
        """The readers there are."""
        return list(self._readers)

    def write(self, topic: str, type_name: str, raw: bytes) -> None:
        """Publish a message."""
        writer = self._writers.get((topic, type_name))
        if writer is None:
            writer = self._writers[topic, type_name] = self._writer(topic, type_name)
        writer.write(writer.data_type(raw))

    def _take(self, builtin: Any, known: dict[Any, Endpoint]) -> None:
        while samples := builtin.take(N=_MANY):
            for sample in samples:
                info = sample.sample_info
                topic, kind = (ros_topic(sample.topic_name or ""), ros_type(sample.type_name or ""))
                if info.instance_state != InstanceState.Alive:
                    known.pop(sample.key, None)
                elif topic and kind and sample.participant_key != self._own:
                    known[sample.key] = Endpoint(topic, kind, _is_latched(sample.qos), sample.type_id is not None)

    def _begin(self, wish: Wish) -> None:
        try:
            decode = decoder(wish.type)
            kind = struct(wish.type) if wish.described else opaque(wish.type)
        except RecordingError:
            self._trouble(
                wish.topic,
                f"{wish.topic} comes as {wish.type}, a type that is not known here; feeds.ros2 and feeds.foxglove can "
                "read it, as the robot defines it for them",
            )
            return
        reliability = (
            (Policy.Reliability.Reliable(0), Policy.Durability.TransientLocal)
            if wish.latched
            else (Policy.Reliability.BestEffort, Policy.Durability.Volatile)
        )
        topic = Topic(self._participant, f"rt{wish.topic}", kind)
        depth = EVENTS if is_event(wish.type) else _DEPTH
        reader = DataReader(self._participant, topic, Qos(*reliability, Policy.History.KeepLast(depth)))
        condition = ReadCondition(reader, _NEW)
        self._waitset.attach(condition)
        self._readers[wish] = _Reader(reader, condition, decode)

    def _writer(self, topic: str, type_name: str) -> Any:
        qos = Qos(
            Policy.Reliability.Reliable(duration(milliseconds=100)),
            Policy.Durability.Volatile,
            Policy.History.KeepLast(1),
            Policy.Userdata(type_hash(type_name)),
        )
        writer = DataWriter(self._participant, Topic(self._participant, f"rt{topic}", struct(type_name)), qos)
        if any((want.topic, want.type) == (topic, type_name) for want in self._wants.values()):
            _await_match(self._participant, writer)
        return writer

    def _trouble(self, topic: str, words: str) -> None:
        if self._troubles.get(topic, "") != words:
            self._troubles[topic] = words
            self._listener.on_trouble(topic, words)


def _await_match(participant: Any, writer: Any) -> None:
    """Wait until somebody hears a new writer: what it writes before is lost, and it may be a zero."""
    waitset = WaitSet(participant)
    writer.set_status_mask(DDSStatus.PublicationMatched)
    waitset.attach(writer)
    waitset.wait(_MATCHING)
    waitset.detach(writer)


def _is_latched(qos: Any) -> bool:
    return qos[Policy.Durability] in _LATCHED and isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable)


def _wishes(topic: str, offers: Iterable[Endpoint]) -> set[Wish]:
    """A reader for each type on a topic. It asks for what is kept only where all publishers keep: it hears all then."""
    by_type: dict[str, list[Endpoint]] = {}
    for offer in offers:
        if offer.topic == topic:
            by_type.setdefault(offer.type, []).append(offer)
    return {
        Wish(topic, kind, all(o.latched for o in same), any(o.described for o in same))
        for kind, same in by_type.items()
    }


def _adverts(offers: Iterable[Endpoint], wants: Iterable[Endpoint]) -> list[Advert]:
    offered = {(o.topic, o.type) for o in offers}
    wanted = {(w.topic, w.type) for w in wants}
    return [Advert(*key, key in offered, key in wanted) for key in sorted(offered | wanted)]
