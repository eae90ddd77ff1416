"""A real ROS 1: a master and publishers, each in its own process, from the packages of the system."""

from __future__ import annotations

import os
import socket
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from ..patience import be_patient
from ..reserved import free_port
from ..unit.waiting import wait_for

be_patient()

PYTHON = "/usr/bin/python3"
PACKAGES = "/usr/lib/python3/dist-packages"
PUBLISHER = Path(__file__).with_name("publisher.py")


def set_send_timeout(patch: pytest.MonkeyPatch, seconds: float) -> None:
    """Set the seconds within which a subscriber must take a message."""
    patch.setattr("robowidgets.feeds._ros1_publications.SEND_TIMEOUT", seconds)


class Master:
    """The only rosmaster of a process: the process has one rospy node, tied to one master."""

    def __init__(self) -> None:
        self.port = free_port()
        self._process: subprocess.Popen[bytes] | None = None

    def start(self) -> None:
        assert self._process is None
        self._process = subprocess.Popen(
            [PYTHON, "-c", "import rosmaster; rosmaster.rosmaster_main()", "--core", "-p", str(self.port)],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        wait_for(self._answers, "the master answers")

    def kill(self) -> None:
        assert self._process is not None
        self._process.kill()
        self._process.wait()
        self._process = None

    def _answers(self) -> bool:
        with socket.socket() as trial:
            return trial.connect_ex(("127.0.0.1", self.port)) == 0


@pytest.fixture(scope="session")
def master(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Master]:
    # At the end of the path: Debian's packages must not come before the packages of the venv.
    sys.path.append(PACKAGES)
    reason = "no ROS 1 here: scripts/ros1.sh installs it on Debian and Ubuntu"
    for module in ("rospy", "rosmaster", "sensor_msgs.msg", "geometry_msgs.msg", "nav_msgs.msg"):
        pytest.importorskip(module, reason=reason, exc_type=ImportError)
    started = Master()
    os.environ["ROS_MASTER_URI"] = f"http://127.0.0.1:{started.port}"
    os.environ["ROS_IP"] = "127.0.0.1"
    os.environ["ROS_HOME"] = str(tmp_path_factory.mktemp("ros"))
    started.start()
    yield started
    started.kill()


@pytest.fixture
def publish(master: Master) -> Iterator[Callable[..., subprocess.Popen[str]]]:
    """`publish(topic, what, number, NAME="value")` starts publisher.py, with NAME in its environment."""
    started: list[subprocess.Popen[str]] = []

    def start(topic: str, what: str, number: int = 5, **environ: str) -> subprocess.Popen[str]:
        command = [PYTHON, str(PUBLISHER), topic, what, str(number)]
        process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=os.environ | environ)
        started.append(process)
        assert process.stdout is not None
        assert process.stdout.readline() == "ready\n"
        return process

    yield start
    for process in started:
        process.kill()
        process.wait()
        assert process.stdout is not None
        process.stdout.close()
