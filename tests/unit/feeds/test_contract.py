"""The contract of all middlewares, with an adapter for each. ROS 1 has its own file, in `tests/ros1`."""

from __future__ import annotations

import sys
from typing import Any

import foxglove
import numpy as np
import pytest
from foxglove.websocket import Capability, ServerListener

from robowidgets import SAMPLE
from robowidgets.feeds.foxglove import Foxglove
from robowidgets.feeds.middleware import Middleware
from robowidgets.feeds.replay import Played
from robowidgets.feeds.ros2 import Ros2
from robowidgets.feeds.rosbridge import Rosbridge
from robowidgets.feeds.simulator import Simulated
from robowidgets.messages.encoding import encode
from robowidgets.recordings import RecordingData
from robowidgets.simulator import Robot as SimulatedRobot
from robowidgets.simulator import World

from ...reserved import free_port
from . import bridge, processes
from .contract import SCAN, TWIST, Robot, RobotContract, Source, SourceContract, fixture_of
from .fake_rclpy import QoSProfile, get_message, install
from .fox import cdr, definition
from .test_ros2 import Robot as RclpyListener


class Replayed(Source):
    """The sample, in a loop at a high speed."""

    other = "/odom"

    def middleware(self) -> Middleware:
        return Played(RecordingData(SAMPLE), 20.0, True)


class SimulatedSource(Source):
    """The simulated robot, which measures all the time."""

    other = "/odom"

    def middleware(self) -> Middleware:
        return Simulated(SimulatedRobot(World.rooms()), 100.0, True, False)


class FoxgloveRobot(Robot):
    """The server of the SDK of Foxglove, with the channels of a bridge."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(monkeypatch)
        self._port, self._heard = free_port(), list[float]()
        self._server: Any = None
        self._start()

    def _start(self) -> None:
        heard = self._heard

        class Taken(ServerListener):
            def on_message_data(self, _client: Any, _channel_id: int, data: bytes) -> None:
                heard.append(float(np.frombuffer(data[4:12])[0]))

        self._context, self._channels = foxglove.Context(), dict[str, foxglove.Channel]()
        self._server = foxglove.start_server(
            host="127.0.0.1",
            port=self._port,
            context=self._context,
            capabilities=[Capability.ClientPublish],
            supported_encodings=["cdr"],
            server_listener=Taken(),
        )

    def middleware(self) -> Middleware:
        return Foxglove(f"ws://127.0.0.1:{self._port}")

    def send(self, topic: str, rays: int = 2) -> None:
        self._log(topic, SCAN, cdr(rays))

    def send_other_type(self, topic: str) -> None:
        self._log(topic, TWIST, encode("cdr", TWIST, {}))

    def _log(self, topic: str, kind: str, payload: bytes) -> None:
        if self._server is None:
            self._start()
        if topic not in self._channels:
            schema = foxglove.Schema(name=kind, encoding="ros2msg", data=definition(kind).encode())
            self._channels[topic] = foxglove.Channel(
                topic, schema=schema, message_encoding="cdr", context=self._context
            )
        self._channels[topic].log(bytes(payload))

    def withdraw(self, topic: str) -> None:
        self._channels.pop(topic).close()

    def listen(self) -> None:
        pass

    @property
    def speeds(self) -> list[float]:
        return self._heard

    def die(self) -> None:
        self._server.stop()
        self._server = None

    def close(self) -> None:
        if self._server is not None:
            self.die()


class RosbridgeRobot(Robot):
    """A rosbridge."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(monkeypatch)
        monkeypatch.setattr(sys.modules["robowidgets.feeds.rosbridge"], "_POLL", 0.3)
        for limit in ("_websocket.SEND_TIMEOUT", "_websocket._GOODBYE", "_threaded.CLOSE_TIMEOUT"):
            monkeypatch.setattr(f"robowidgets.feeds.{limit}", 120.0)  # for a busy machine
        self._port = free_port()
        self._server: Any = None
        self._start()

    def _start(self) -> None:
        self._server = bridge.Rosbridge({}, self._port)
        self._server.__enter__()

    def middleware(self) -> Middleware:
        return Rosbridge(f"ws://127.0.0.1:{self._port}")

    def send(self, topic: str, rays: int = 2) -> None:
        self._publish(topic, SCAN, {"ranges": np.ones(rays, np.float32)})

    def send_other_type(self, topic: str) -> None:
        self._publish(topic, TWIST, {"linear": {"x": 1.0}})

    def _publish(self, topic: str, kind: str, message: dict[str, Any]) -> None:
        if self._server is None:
            self._start()
        self._server.topics = {**self._server.topics, topic: kind}
        if self._server.subscribed.get(topic, {}).get("type") == kind:
            self._server.publish(topic, message)

    def withdraw(self, topic: str) -> None:
        self._server.topics = {name: kind for name, kind in self._server.topics.items() if name != topic}

    def listen(self) -> None:
        self._server.topics = {**self._server.topics, self.speed: TWIST}
        self._server.listeners[self.speed] = ["/base"]

    @property
    def speeds(self) -> list[float]:
        return [message["linear"]["x"] for _, message in self._server.published]

    def die(self) -> None:
        self._server.__exit__()
        self._server = None

    def close(self) -> None:
        if self._server is not None:
            self.die()


class DdsRobot(Robot):
    """A participant of DDS in another process."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        pytest.importorskip("cyclonedds", reason="cyclonedds is not installed: pip install cyclonedds")
        super().__init__(monkeypatch)
        self._robot, self._heard = processes.DdsRobot("1s"), list[float]()

    def middleware(self) -> Middleware:
        from robowidgets.feeds.dds import Dds

        return Dds(processes.DOMAIN, interface="lo")

    def send(self, topic: str, rays: int = 2) -> None:
        self._robot.do("write", topic, "LaserScan", [1.0] * rays, 0.5)

    def send_other_type(self, topic: str) -> None:
        self._robot.do("write", topic, "Twist", 0.5)

    def withdraw(self, topic: str) -> None:
        self._robot.do("stop", topic, "LaserScan")

    def listen(self) -> None:
        self._robot.hear(self.speed, "Twist")

    @property
    def speeds(self) -> list[float]:
        while self._robot.unread:
            self._heard.append(self._robot.heard()["linear"]["x"])
        return self._heard

    def die(self) -> None:
        self._robot.kill()
        self._robot = processes.DdsRobot("1s")

    def close(self) -> None:
        self._robot.kill()


class ZenohRobot(Robot):
    """Nodes of the SDK of ROBOTIS at a router, in two other processes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        pytest.importorskip("zenoh", reason="eclipse-zenoh is not installed: pip install eclipse-zenoh")
        pytest.importorskip("zenoh_ros2_sdk", reason="the robot is not installed: pip install zenoh-ros2-sdk")
        super().__init__(monkeypatch)
        self._port, self._heard = free_port(), list[float]()
        self._router = processes.Process("zenoh_router.py", self._port)
        assert self._router.heard() == "ready"
        self._robot = processes.Process("zenoh_robot.py", self._port, 0)

    def middleware(self) -> Middleware:
        from robowidgets.feeds.zenoh import Zenoh

        return Zenoh(f"tcp/127.0.0.1:{self._port}")

    def send(self, topic: str, rays: int = 2) -> None:
        self._robot.do("write", topic, SCAN, {"ranges": [1.0] * rays})

    def send_other_type(self, topic: str) -> None:
        self._robot.do("write", topic, TWIST, {})

    def withdraw(self, topic: str) -> None:
        self._robot.do("stop", topic, SCAN)

    def listen(self) -> None:
        self._robot.do("hear", self.speed, TWIST)
        assert self._robot.heard() == "ready"

    @property
    def speeds(self) -> list[float]:
        while self._robot.unread:
            self._heard.append(self._robot.heard()[0])
        return self._heard

    def die(self) -> None:
        self._robot.kill()
        self._robot = processes.Process("zenoh_robot.py", self._port, 0)

    def close(self) -> None:
        self._robot.kill()
        self._router.kill()


class RclpyRobot(Robot):
    """Nodes on a stand-in for rclpy; `test_ros2_real` has the real one."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        super().__init__(monkeypatch)
        self._graph = install(monkeypatch)
        self._publishers = dict[str, Any]()
        self._listener: RclpyListener | None = None

    def middleware(self) -> Middleware:
        return Ros2(domain_id=7)

    def send(self, topic: str, rays: int = 2) -> None:
        message = get_message(SCAN)()
        message.ranges = np.ones(rays, np.float32)
        self._publisher(topic, SCAN).publish(message)

    def send_other_type(self, topic: str) -> None:
        self._publisher(topic, TWIST).publish(get_message(TWIST)())

    def _publisher(self, topic: str, kind: str) -> Any:
        if topic not in self._publishers:
            node = self._graph.node()
            self._publishers[topic] = node.create_publisher(get_message(kind), topic, QoSProfile(depth=1))
        return self._publishers[topic]

    def withdraw(self, topic: str) -> None:
        self._publishers.pop(topic).node.destroy_node()

    def listen(self) -> None:
        self._listener = RclpyListener(self._graph)
        self._listener.__enter__()

    @property
    def speeds(self) -> list[float]:
        return self._listener.speeds if self._listener else []

    def die(self) -> None:
        for topic in list(self._publishers):
            self.withdraw(topic)

    def close(self) -> None:
        if self._listener:
            self._listener.__exit__()
        assert self._graph.warnings == []


class TestReplay(SourceContract):
    robot = fixture_of(Replayed)


class TestSimulator(SourceContract):
    robot = fixture_of(SimulatedSource)


class TestFoxglove(RobotContract):
    robot = fixture_of(FoxgloveRobot)


class TestRosbridge(RobotContract):
    robot = fixture_of(RosbridgeRobot)


class TestDds(RobotContract):
    robot = fixture_of(DdsRobot)


class TestZenoh(RobotContract):
    robot = fixture_of(ZenohRobot)


class TestRclpy(RobotContract):
    robot = fixture_of(RclpyRobot)
