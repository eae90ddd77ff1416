"""A robot on DDS, in its own process: reads commands as lines of JSON, and writes received messages as lines of JSON.

It is written with dataclasses and Cyclone DDS's own reading and writing, and shares no code with the feed.
"""

import json
import struct
import sys
import threading
import time
from dataclasses import asdict, dataclass
from typing import Any

from cyclonedds.builtin import BuiltinDataReader, BuiltinTopicDcpsSubscription
from cyclonedds.core import InstanceState, ReadCondition, SampleState, ViewState
from cyclonedds.domain import Domain, DomainParticipant
from cyclonedds.idl import IdlStruct, types
from cyclonedds.pub import DataWriter
from cyclonedds.qos import Policy, Qos
from cyclonedds.sub import DataReader
from cyclonedds.topic import Topic
from cyclonedds.util import duration

LOOPBACK = (
    '<CycloneDDS><Domain><General><Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>'
    "<AllowMulticast>false</AllowMulticast></General><Discovery><ParticipantIndex>auto</ParticipantIndex>"
    '<MaxAutoParticipantIndex>60</MaxAutoParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers>'
    "</Discovery></Domain></CycloneDDS>"
)


@dataclass
class Time(IdlStruct, typename="builtin_interfaces::msg::dds_::Time_"):
    sec: types.int32
    nanosec: types.uint32


@dataclass
class Header(IdlStruct, typename="std_msgs::msg::dds_::Header_"):
    stamp: Time
    frame_id: str


@dataclass
class LaserScan(IdlStruct, typename="sensor_msgs::msg::dds_::LaserScan_"):
    header: Header
    angle_min: types.float32
    angle_max: types.float32
    angle_increment: types.float32
    time_increment: types.float32
    scan_time: types.float32
    range_min: types.float32
    range_max: types.float32
    ranges: types.sequence[types.float32]
    intensities: types.sequence[types.float32]


@dataclass
class Vector3(IdlStruct, typename="geometry_msgs::msg::dds_::Vector3_"):
    x: types.float64
    y: types.float64
    z: types.float64


@dataclass
class Twist(IdlStruct, typename="geometry_msgs::msg::dds_::Twist_"):
    linear: Vector3
    angular: Vector3


@dataclass
class TwistStamped(IdlStruct, typename="geometry_msgs::msg::dds_::TwistStamped_"):
    header: Header
    twist: Twist


@dataclass
class String(IdlStruct, typename="std_msgs::msg::dds_::String_"):
    data: str


@dataclass
class Log(IdlStruct, typename="rcl_interfaces::msg::dds_::Log_"):
    stamp: Time
    level: types.uint8
    name: str
    msg: str
    file: str
    function: str
    line: types.uint32


@dataclass
class Range(IdlStruct, typename="sensor_msgs::msg::dds_::Range_"):
    header: Header
    radiation_type: types.uint8
    field_of_view: types.float32
    min_range: types.float32
    max_range: types.float32
    range: types.float32
    variance: types.float32


@dataclass
class OldRange(IdlStruct, typename="sensor_msgs::msg::dds_::Range_"):
    header: Header
    radiation_type: types.uint8
    field_of_view: types.float32
    min_range: types.float32
    max_range: types.float32
    range: types.float32


@dataclass
class Gid(IdlStruct, typename="rmw_dds_common::msg::dds_::Gid_"):
    data: types.array[types.uint8, 16]


@dataclass
class NodeEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::NodeEntitiesInfo_"):
    node_namespace: str
    node_name: str
    reader_gid_seq: types.sequence[Gid]
    writer_gid_seq: types.sequence[Gid]


@dataclass
class ParticipantEntitiesInfo(IdlStruct, typename="rmw_dds_common::msg::dds_::ParticipantEntitiesInfo_"):
    gid: Gid
    node_entities_info_seq: types.sequence[NodeEntitiesInfo]


@dataclass
class OtherScan(IdlStruct, typename="sensor_msgs::msg::dds_::LaserScan_"):
    text: str


@dataclass
class Mystery(IdlStruct, typename="nobody_msgs::msg::dds_::Mystery_"):
    text: str


@dataclass
class Image(IdlStruct, typename="sensor_msgs::msg::dds_::Image_"):
    header: Header
    height: types.uint32
    width: types.uint32
    encoding: str
    is_bigendian: types.uint8
    step: types.uint32
    data: types.sequence[types.uint8]

    def serialize(self, **_: Any) -> bytes:  # Cyclone DDS takes seconds for a hundred million bytes
        size = len(self.data)
        head = struct.pack("<iII2s2xIII6sBxII", 1, 2, 2, b"x", 1, size, 6, b"mono8", 0, size, size)
        return b"\0\1\0\0" + head + self.data


KINDS = (Image, LaserScan, Log, Mystery, OldRange, OtherScan, Range, String, Twist, TwistStamped)
TYPES: dict[str, Any] = {kind.__name__: kind for kind in KINDS}
USER_DATA = {
    "OldRange": b"typehash=RIHS01_9430b1915b94d4268ff903679e8ecd09b6a67d331bd028738ec1eeb592891ebd;",
    "Range": b"typehash=RIHS01_b42b62562e93cbfe9d42b82fe5994dfa3d63d7d5c90a317981703f7388adff3a;",
}
"""The user data in which publishers of ROS 2 describe their type, if a test requests it."""

NODES = "ros_discovery_info"
KEPT = Policy.Reliability.Reliable(duration(seconds=1)), Policy.Durability.TransientLocal


def scan(ranges: list[float], increment: float) -> LaserScan:
    return LaserScan(Header(Time(1, 2), "laser"), -1.0, 1.0, increment, 0.0, 0.1, 0.1, 10.0, ranges, [])


def make(kind: str, *values: Any) -> Any:
    if kind == "LaserScan":
        return scan(*values)
    if kind == "Twist":
        return Twist(Vector3(values[0], 0.0, 0.0), Vector3(0.0, 0.0, 0.0))
    if kind == "Log":
        return Log(Time(1, 2), *values, "main.cpp", "main", 42)
    if kind == "Image":
        return Image(Header(Time(1, 2), "x"), 1, values[0], "mono8", 0, values[0], bytes(values[0]))
    if kind in ("OldRange", "Range"):
        return TYPES[kind](Header(Time(1, 2), "sonar"), 0, *values)
    return TYPES[kind](*values)


def tell(what: Any) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


def hear(reader: Any) -> None:
    while not reader.get_matched_publications():
        time.sleep(0.002)
    tell("matched")
    # Whatever the state of the writer, as the middleware of ROS does: by default samples of a deleted writer remain.
    condition = ReadCondition(reader, ViewState.Any | SampleState.NotRead | InstanceState.Any)
    for message in reader.take_iter(condition=condition, timeout=duration(seconds=60)):
        if isinstance(message, IdlStruct):  # otherwise a sample without data
            tell(asdict(message))


class Robot:
    """Its publishers and subscribers in a domain, by topic and kind."""

    def __init__(self, domain: int) -> None:
        self.participant = DomainParticipant(domain)
        self.writers: dict[tuple[str, str], Any] = {}
        self.readers: dict[tuple[str, str], Any] = {}

    def topic(self, topic: str, kind: Any) -> Any:
        return Topic(self.participant, f"rt{topic}", kind)

    def writer(self, topic: str, kind: str, *policies: Any) -> Any:
        if (topic, kind) not in self.writers:
            policies = policies or (Policy.Reliability.Reliable(duration(seconds=1)),)
            qos = Qos(*policies, Policy.History.KeepLast(1))
            self.writers[topic, kind] = DataWriter(self.participant, self.topic(topic, TYPES[kind]), qos)
        return self.writers[topic, kind]

    def write(self, topic: str, kind: str, *values: Any) -> None:
        self.writer(topic, kind).write(make(kind, *values))

    def burst(self, topic: str, kind: str, readings: list[float]) -> None:
        """Publish a scan with each of these readings, at once, and report the end."""
        writer = self.writer(topic, kind)
        for message in [scan([reading] * 360, 0.01) for reading in readings]:
            writer.write(message)
        tell("written")

    def latch(self, topic: str, kind: str, *values: Any) -> None:
        self.writer(topic, kind, *KEPT).write(make(kind, *values))

    def hashed(self, topic: str, kind: str, *values: Any) -> None:
        """Publish as ROS 2 does since Iron."""
        self.writer(topic, kind, Policy.Userdata(USER_DATA[kind])).write(make(kind, *values))

    def flood(self, topic: str, kind: str, pause: float, *values: Any) -> None:
        writer, message = self.writer(topic, kind), make(kind, *values)

        def run() -> None:
            while True:
                writer.write(message)
                time.sleep(pause)

        threading.Thread(target=run, daemon=True).start()

    def hear(self, topic: str, kind: str, reliable: bool = True) -> None:
        policy = Policy.Reliability.Reliable(duration(seconds=1)) if reliable else Policy.Reliability.BestEffort
        qos = Qos(policy, Policy.History.KeepLast(100))
        reader = DataReader(self.participant, self.topic(topic, TYPES[kind]), qos)
        tell("ready")  # before the first message
        threading.Thread(target=hear, args=(reader,), daemon=True).start()

    def want_kept(self, topic: str, kind: str) -> None:
        """Request the messages that are kept for late subscribers."""
        self.readers[topic, kind] = DataReader(self.participant, self.topic(topic, TYPES[kind]), Qos(*KEPT))

    def stop(self, topic: str, kind: str) -> None:
        for held in (self.writers, self.readers):
            held.pop((topic, kind), None)

    def end(self) -> None:
        """Leave the domain."""
        self.participant.__del__()

    def name(self, topic: str, kind: str, namespace: str, name: str) -> None:
        """Announce which node publishes a topic and has all kept readers, as ROS 2 does."""
        own, key = (Gid(list(one.guid.bytes)) for one in (self.participant, self.writer(topic, kind)))
        readers = [Gid(list(reader.guid.bytes)) for reader in self.readers.values()]
        info = ParticipantEntitiesInfo(own, [NodeEntitiesInfo(namespace, name, readers, [key])])
        self.names = DataWriter(self.participant, Topic(self.participant, NODES, ParticipantEntitiesInfo), Qos(*KEPT))
        self.names.write(info)

    def best_effort(self, topic: str, kind: str) -> None:
        """From now on, publish on a best-effort basis, as drivers of sensors do."""
        self.writer(topic, kind, Policy.Reliability.BestEffort)

    def subscribers(self, topic: str, _: str) -> None:
        """Report the user data of the subscribers of a topic."""
        tell([qos[Policy.Userdata].data.decode() if Policy.Userdata in qos else "" for qos in self.wanted(topic)])

    def reliable_subscribers(self, topic: str) -> None:
        """Report True for each reliable subscription to a topic, False for each other one."""
        tell(sorted(isinstance(qos[Policy.Reliability], Policy.Reliability.Reliable) for qos in self.wanted(topic)))

    def wanted(self, topic: str) -> list[Any]:
        samples = BuiltinDataReader(self.participant, BuiltinTopicDcpsSubscription).take(N=1000)
        there = [sample for sample in samples if sample.sample_info.instance_state == InstanceState.Alive]
        return [sample.qos for sample in there if sample.topic_name == f"rt{topic}"]


def main(domain: int, lease: str = "10s") -> None:
    """Join a domain; others consider it gone if they have heard nothing from it during its lease."""
    held = Domain(domain, LOOPBACK.replace("</Discovery>", f"<LeaseDuration>{lease}</LeaseDuration></Discovery>"))
    robot = Robot(domain)
    for line in sys.stdin:
        do, *what = json.loads(line)
        getattr(robot, do)(*what)
    del robot, held


if __name__ == "__main__":
    main(int(sys.argv[1]), *sys.argv[2:])
