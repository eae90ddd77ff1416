"""A robot and a bare subscriber, each in a separate process, that use one middleware without robowidgets' feeds.

`python -m benchmarks.middleware publish NAME WHERE` prints its address, and obeys the lines of its input: `put NUMBER`
publishes a scan, and `pace FIRST HZ SECONDS FILE` publishes scans and writes their times to FILE. `beside` adds all
topics of `topics_robot`, `once` publishes a message on each of them, `go` publishes them from then on, and `rate`
prints their messages per second. A publisher's WHERE is empty.
`python -m benchmarks.middleware hear NAME WHERE` records the arrival of each scan in its callback; `take FILE` writes
the times to FILE. `python -m benchmarks.middleware obey NAME FILE` publishes a scan ten times a second, and writes each
command on /cmd_vel with its arrival time to FILE, like a robot without a watchdog.
"""

from __future__ import annotations

import os
import random
import socket
import sys
import threading
import time
from array import array
from contextlib import closing
from typing import Any

import numpy as np

from .scan import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN, encode
from .topics_robot import Robot

DOMAIN = int(os.environ.setdefault("BENCHMARK_DOMAIN", str(1 + os.getpid() % 59)))
"""The DDS domain of this run and its processes, separate from other runs and the tests on this machine."""
SYSTEM = "/usr/lib/python3/dist-packages"
"""The folder of rospy in Debian's packages."""
FIELDS = ("angle_min", "angle_max", "angle_increment", "time_increment", "scan_time", "range_min", "range_max")
GEOMETRY = (ANGLE_MIN, -ANGLE_MIN, ANGLE_INCREMENT, 0.0, 0.025, RANGE_MIN, RANGE_MAX)


class Dds:
    """Cyclone DDS, on loopback."""

    def __init__(self, _where: str) -> None:
        from cyclonedds.domain import Domain, DomainParticipant
        from cyclonedds.topic import Topic

        from tests.unit.feeds.dds_robot import LOOPBACK, LaserScan

        self._domain = Domain(DOMAIN, LOOPBACK)
        self._participant = DomainParticipant(DOMAIN)
        self._topic = Topic(self._participant, "rt/scan", LaserScan)
        self.where = str(DOMAIN)

    def publisher(self) -> Any:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.util import duration

        from tests.unit.feeds.dds_robot import Header, LaserScan, Time

        qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepLast(1))
        writer = DataWriter(self._participant, self._topic, qos)

        def publish(number: int) -> None:
            ranges = encode(number).tolist()
            writer.write(LaserScan(Header(Time(number, 0), "laser"), *GEOMETRY, ranges, []))

        return publish

    def sender(self, topic: str, kind: str) -> Any:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.pub import DataWriter
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        from robowidgets.feeds._dds_types import struct

        raw = struct(kind)  # with bytes as messages
        qos = Qos(Policy.Reliability.Reliable(duration(milliseconds=100)), Policy.History.KeepLast(10))
        writer = DataWriter(self._participant, Topic(self._participant, f"rt{topic}", raw), qos)
        return lambda message: writer.write(raw(message))

    def obey(self, call: Any) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.sub import DataReader
        from cyclonedds.topic import Topic
        from cyclonedds.util import duration

        from tests.unit.feeds.dds_robot import Twist

        qos = Qos(Policy.Reliability.Reliable(duration(seconds=1)), Policy.History.KeepAll)
        reader = DataReader(self._participant, Topic(self._participant, "rt/cmd_vel", Twist), qos)
        for message in reader.take_iter(timeout=duration(seconds=3600)):
            call(message.linear.x, message.angular.z)

    def hear(self, call: Any) -> None:
        from cyclonedds.core import Policy, Qos
        from cyclonedds.sub import DataReader
        from cyclonedds.util import duration

        reader = DataReader(
            self._participant, self._topic, Qos(Policy.Reliability.BestEffort, Policy.History.KeepLast(1))
        )
        for message in reader.take_iter(timeout=duration(seconds=3600)):
            call(message.header.stamp.sec)


class Foxglove:
    """The server of foxglove-sdk, and tornado's client."""

    def __init__(self, where: str) -> None:
        self.where = where
        self.call: Any = lambda *_: None

    def obey(self, call: Any) -> None:
        self.call = call

    def publisher(self) -> Any:
        import foxglove
        import foxglove.websocket
        from rosbags.typesys import Stores, get_typestore

        store = get_typestore(Stores.ROS2_HUMBLE)
        kind = "sensor_msgs/msg/LaserScan"
        text, _ = store.generate_msgdef(kind, ros_version=2)
        robot = self

        class Listener(foxglove.websocket.ServerListener):  # type: ignore[misc]
            def on_message_data(self, _client: Any, _channel: Any, data: bytes) -> None:
                twist = store.deserialize_cdr(data, "geometry_msgs/msg/Twist")
                robot.call(twist.linear.x, twist.angular.z)

        server = foxglove.start_server(
            host="127.0.0.1",
            port=0,
            capabilities=[foxglove.Capability.ClientPublish],
            supported_encodings=["cdr"],
            server_listener=Listener(),
        )
        self.where = f"ws://127.0.0.1:{server.port}"
        schema = foxglove.Schema(name=kind, encoding="ros2msg", data=text.encode())
        channel = foxglove.Channel("/scan", schema=schema, message_encoding="cdr")
        time_type, header = store.types["builtin_interfaces/msg/Time"], store.types["std_msgs/msg/Header"]

        def publish(number: int) -> None:
            stamp = header(time_type(number, 0), "laser")
            message = store.types[kind](stamp, *GEOMETRY, encode(number), np.empty(0, np.float32))
            channel.log(bytes(store.serialize_cdr(message, kind)))

        return publish

    def sender(self, topic: str, kind: str) -> Any:
        import foxglove
        from rosbags.typesys import Stores, get_typestore

        text, _ = get_typestore(Stores.ROS2_HUMBLE).generate_msgdef(kind, ros_version=2)
        schema = foxglove.Schema(name=kind, encoding="ros2msg", data=text.encode())
        return foxglove.Channel(topic, schema=schema, message_encoding="cdr").log

    def hear(self, call: Any) -> None:
        import asyncio
        import json
        import struct

        from tornado.httpclient import HTTPRequest
        from tornado.websocket import websocket_connect

        async def listen() -> None:
            client = await websocket_connect(HTTPRequest(self.where), subprotocols=["foxglove.sdk.v1"])
            while (said := await client.read_message()) is not None:
                if isinstance(said, bytes):
                    call(struct.unpack_from("<i", said, 1 + 4 + 8 + 4)[0])
                elif (told := json.loads(said))["op"] == "advertise":
                    # The server loses a subscription that comes at once.
                    await asyncio.sleep(0.1)
                    asked = [{"id": 1, "channelId": channel["id"]} for channel in told["channels"]]
                    await client.write_message(json.dumps({"op": "subscribe", "subscriptions": asked}))

        asyncio.run(listen())


class Ros1:
    """rospy, with the master at ROS_MASTER_URI."""

    def __init__(self, where: str) -> None:
        sys.path.append(SYSTEM)
        import rospy

        self.where = where
        rospy.init_node("robot", anonymous=True, disable_signals=True)

    def publisher(self) -> Any:
        import rospy
        from sensor_msgs.msg import LaserScan

        topic = rospy.Publisher("/scan", LaserScan, queue_size=1, tcp_nodelay=True)

        def publish(number: int) -> None:
            message = LaserScan(None, *GEOMETRY, encode(number), [])
            message.header.stamp.secs, message.header.frame_id = number, "laser"
            topic.publish(message)

        return publish

    def obey(self, call: Any) -> None:
        import rospy
        from geometry_msgs.msg import Twist

        rospy.Subscriber("/cmd_vel", Twist, lambda message: call(message.linear.x, message.angular.z), tcp_nodelay=True)

    def hear(self, call: Any) -> None:
        import rospy
        from sensor_msgs.msg import LaserScan

        rospy.Subscriber("/scan", LaserScan, lambda message: call(message.header.stamp.secs), tcp_nodelay=True)
        threading.Event().wait()


class Rosbridge:
    """The server of the tests, and tornado's client, in CBOR."""

    def __init__(self, where: str) -> None:
        self.where = where

    def publisher(self) -> Any:
        from tests.unit.feeds.bridge import Rosbridge as Server

        server = Server({"/scan": "sensor_msgs/msg/LaserScan", "/cmd_vel": "geometry_msgs/msg/Twist"}).__enter__()
        server.listeners["/cmd_vel"] = ["/base"]
        self.where, self._server = server.address, server
        fields = dict(zip(FIELDS, GEOMETRY, strict=True))

        def publish(number: int) -> None:
            header = {"stamp": {"sec": number, "nanosec": 0}, "frame_id": "laser"}
            if "/scan" in server.subscribed:
                server.publish("/scan", {"header": header, **fields, "ranges": encode(number), "intensities": []})

        return publish

    def obey(self, call: Any) -> None:
        count = 0
        while True:
            published = self._server.published[count:]
            for _, message in published:
                call(message["linear"]["x"], message["angular"]["z"])
            count += len(published)
            time.sleep(0.0005)

    def hear(self, call: Any) -> None:
        import asyncio
        import json

        import cbor2
        from tornado.websocket import websocket_connect

        async def listen() -> None:
            client = await websocket_connect(self.where)
            await client.write_message(json.dumps({"op": "subscribe", "topic": "/scan", "compression": "cbor"}))
            while (said := await client.read_message()) is not None:
                if isinstance(said, bytes):
                    call(cbor2.loads(said)["msg"]["header"]["stamp"]["sec"])

        asyncio.run(listen())


class Ros2:
    """rclpy, if it is installed."""

    def __init__(self, where: str) -> None:
        import rclpy

        self.where = where
        rclpy.init(args=[], domain_id=DOMAIN)
        self._node = rclpy.create_node("robot" if not where else "bare")

    def publisher(self) -> Any:
        from rclpy.qos import qos_profile_sensor_data
        from sensor_msgs.msg import LaserScan

        self.where = str(DOMAIN)
        topic = self._node.create_publisher(LaserScan, "/scan", qos_profile_sensor_data)
        message = LaserScan()
        for name, value in zip(FIELDS, GEOMETRY, strict=True):
            setattr(message, name, value)

        def publish(number: int) -> None:
            message.header.stamp.sec = number
            message.ranges = array("f", encode(number).tobytes())
            topic.publish(message)

        return publish

    def hear(self, call: Any) -> None:
        import rclpy
        from rclpy.qos import qos_profile_sensor_data
        from sensor_msgs.msg import LaserScan

        def heard(message: Any) -> None:
            call(message.header.stamp.sec)

        self._node.create_subscription(LaserScan, "/scan", heard, qos_profile_sensor_data)
        rclpy.spin(self._node)


class Zenoh:
    """The nodes of zenoh-ros2-sdk, at a router in the same process."""

    def __init__(self, where: str) -> None:
        from tests.unit.feeds.zenoh_router import open_router

        self.where = where
        if not where:
            with closing(socket.socket()) as probe:
                probe.bind(("127.0.0.1", 0))
                self.where = f"tcp/127.0.0.1:{probe.getsockname()[1]}"
            self._router = open_router(self.where)

    def _node(self, kind: str) -> dict[str, Any]:
        from rosbags.typesys import Stores, get_typestore

        store = get_typestore(Stores.ROS2_HUMBLE)
        text, _ = store.generate_msgdef(kind, ros_version=2)
        port = int(self.where.rpartition(":")[2])
        return {"msg_definition": text, "type_hash": store.hash_rihs01(kind), "router_port": port, "domain_id": 0}

    def publisher(self) -> Any:
        from zenoh_ros2_sdk import ROS2Publisher

        kind = "sensor_msgs/msg/LaserScan"
        topic = ROS2Publisher("/scan", kind, **self._node(kind))
        types = topic.session_mgr.store.types
        time_type, header = types["builtin_interfaces/msg/Time"], types["std_msgs/msg/Header"]
        fields = dict(zip(FIELDS, GEOMETRY, strict=True))

        def publish(number: int) -> None:
            stamp = header(time_type(number, 0), "laser")
            topic.publish(header=stamp, **fields, ranges=encode(number), intensities=np.empty(0, np.float32))

        return publish

    def obey(self, call: Any) -> None:
        from zenoh_ros2_sdk import ROS2Subscriber

        kind = "geometry_msgs/msg/Twist"
        self._heard = ROS2Subscriber("/cmd_vel", kind, lambda it: call(it.linear.x, it.angular.z), **self._node(kind))

    def hear(self, call: Any) -> None:
        from zenoh_ros2_sdk import ROS2Subscriber

        kind = "sensor_msgs/msg/LaserScan"
        self._heard = ROS2Subscriber("/scan", kind, lambda it: call(it.header.stamp.sec), **self._node(kind))
        threading.Event().wait()


NAMES = {"dds": Dds, "foxglove": Foxglove, "ros1": Ros1, "ros2": Ros2, "rosbridge": Rosbridge, "zenoh": Zenoh}


def now_us() -> int:
    return time.time_ns() // 1000


def publish(name: str, where: str) -> None:
    robot = NAMES[name](where)
    send = robot.publisher()
    print(robot.where, flush=True)
    beside: Robot | None = None
    for line in sys.stdin:
        do, *given = line.split()
        if do == "beside":
            sys.setswitchinterval(0.0005)  # both threads of the robot must be on time
            beside = Robot(robot.sender)
            continue
        if do in ("once", "go"):
            assert beside is not None
            (beside.say_once if do == "once" else beside.start)()
            continue
        if do == "rate":
            print(beside.rate() if beside else 0.0, flush=True)
            continue
        if do == "put":
            send(int(given[0]))
            continue
        first, hz, seconds = int(given[0]), float(given[1]), float(given[2])
        stamps, due, wander = [], time.perf_counter(), random.Random(first)
        for number in range(first, first + round(hz * seconds)):
            stamps.append(now_us())
            send(number)
            due += wander.uniform(0.9, 1.1) / hz  # to meet every phase of the display
            time.sleep(max(0.0, due - time.perf_counter()))
        np.save(given[3], np.array(stamps))
        print("done", flush=True)


def hear(name: str, where: str) -> None:
    heard: list[tuple[int, int]] = []
    subscriber = NAMES[name](where)
    listen = lambda: subscriber.hear(lambda number: heard.append((number, now_us())))  # noqa: E731
    threading.Thread(target=listen, daemon=True).start()
    print("ready", flush=True)
    for line in sys.stdin:
        np.save(line.split()[1], np.array(heard).reshape(-1, 2))
        print("done", flush=True)


def obey(name: str, path: str) -> None:
    robot = NAMES[name]("")
    send = robot.publisher()
    log = open(path, "a", buffering=1)  # noqa: SIM115  # until the process is killed

    def note(linear: float, angular: float) -> None:
        print(time.monotonic(), linear, angular, file=log)

    threading.Thread(target=robot.obey, args=(note,), daemon=True).start()
    print(robot.where, flush=True)
    for number in range(10**9):
        send(number % 1000)
        time.sleep(0.1)


if __name__ == "__main__":
    {"publish": publish, "hear": hear, "obey": obey}[sys.argv[1]](sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else "")
    os._exit(0)
