"""The contract of all middlewares for ROS 1."""

from __future__ import annotations

import importlib
import itertools
import subprocess
import threading
from collections.abc import Callable, Iterator

import pytest

from robowidgets.feeds.middleware import Middleware

from ..unit.feeds.contract import STAMPED, Robot, RobotContract
from .conftest import set_send_timeout

MODULE = importlib.import_module("robowidgets.feeds.ros1")  # under its name the package has the function in it
NUMBERS = itertools.count()


class Ros1Robot(Robot):
    """Nodes in processes of their own. All tests share a master, so the topics of each have other names."""

    type = STAMPED
    spare = 8  # the master's own connections to the node come and go

    def __init__(self, monkeypatch: pytest.MonkeyPatch, start: Callable[..., subprocess.Popen[str]]) -> None:
        super().__init__(monkeypatch)
        monkeypatch.setattr(MODULE, "POLL", 0.1)
        monkeypatch.setattr(MODULE, "CONNECT_TIMEOUT_S", 0.5)
        set_send_timeout(monkeypatch, 3.0)  # the machine may be busy
        self.scan, self.other, self.speed = (f"/contract_{next(NUMBERS)}/{name}" for name in ("scan", "other", "speed"))
        self._start, self._heard = start, list[float]()
        self._publishers = dict[str, tuple[int, subprocess.Popen[str]]]()
        self._listener: tuple[subprocess.Popen[str], threading.Thread] | None = None

    def middleware(self) -> Middleware:
        return MODULE.Ros1()

    def send(self, topic: str, rays: int = 2) -> None:
        if self._publishers.get(topic, (rays,))[0] != rays:
            self.withdraw(topic)
        if topic not in self._publishers:
            self._publishers[topic] = rays, self._start(topic, "scan", rays)

    def send_other_type(self, topic: str) -> None:
        if topic not in self._publishers:
            self._publishers[topic] = 0, self._start(topic, "odom")

    def withdraw(self, topic: str) -> None:
        _, publisher = self._publishers.pop(topic)
        publisher.terminate()
        publisher.wait()

    def listen(self) -> None:
        process = self._start(self.speed, "hear")
        thread = threading.Thread(target=lambda: self._heard.extend(map(float, process.stdout)))
        thread.start()
        self._listener = process, thread

    @property
    def speeds(self) -> list[float]:
        return self._heard

    def die(self) -> None:
        for _, publisher in self._publishers.values():
            publisher.kill()
            publisher.wait()
        self._publishers.clear()

    def close(self) -> None:
        if self._listener:
            process, thread = self._listener
            process.kill()
            thread.join()


class TestRos1(RobotContract):
    @pytest.fixture
    def robot(
        self, monkeypatch: pytest.MonkeyPatch, publish: Callable[..., subprocess.Popen[str]]
    ) -> Iterator[Ros1Robot]:
        made = Ros1Robot(monkeypatch, publish)
        yield made
        made.close()
