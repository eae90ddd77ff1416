"""A robot on DDS, in a process of its own: lines of JSON, on its input what it does, on its output what it heard.

It is written with dataclasses and Cyclone DDS's own reading and writing, and shares no code with the feed.
"""

import json
import struct
import sys
import threading
from dataclasses import asdict, dataclass
from typing import Any

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


KINDS = (Image, LaserScan, Mystery, OtherScan, Twist, TwistStamped)
TYPES: dict[str, Any] = {kind.__name__: kind for kind in KINDS}


def scan(ranges: list[float], increment: float) -> LaserScan:
    return LaserScan(Header(Time(1, 2), "laser"), -1.0, 1.0, increment, 0.0, 0.1, 0.1, 10.0, ranges, [])


def make(kind: str, *values: Any) -> Any:
    if kind == "LaserScan":
        return scan(*values)
    if kind == "Twist":
        return Twist(Vector3(values[0], 0.0, 0.0), Vector3(0.0, 0.0, 0.0))
    if kind == "Image":
        return Image(Header(Time(1, 2), "x"), 1, values[0], "mono8", 0, values[0], bytes(values[0]))
    return TYPES[kind](*values)


def tell(what: Any) -> None:
    sys.stdout.write(json.dumps(what) + "\n")
    sys.stdout.flush()


def hear(reader: Any) -> None:
    for message in reader.take_iter(timeout=duration(seconds=60)):
        tell(asdict(message))


def main(domain: int) -> None:
    held = Domain(domain, LOOPBACK)
    participant = DomainParticipant(domain)
    writers: dict[tuple[str, int], Any] = {}
    for line in sys.stdin:
        do, topic, kind, *values = json.loads(line)
        if do == "stop":
            writers.pop((topic, kind))
            continue
        if do == "hear":
            reliable = Qos(Policy.Reliability.Reliable(duration(seconds=1)))
            reader = DataReader(participant, Topic(participant, f"rt{topic}", TYPES[kind]), reliable)
            threading.Thread(target=hear, args=(reader,), daemon=True).start()
            tell("ready")
            continue
        key = topic, kind
        if key not in writers:
            durability = Policy.Durability.TransientLocal if do == "latch" else Policy.Durability.Volatile
            qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), durability, Policy.History.KeepLast(1))
            writers[key] = DataWriter(participant, Topic(participant, f"rt{topic}", TYPES[kind]), qos)
        writers[key].write(make(kind, *values))
    del participant, held


if __name__ == "__main__":
    main(int(sys.argv[1]))
