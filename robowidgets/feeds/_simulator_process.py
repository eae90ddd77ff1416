"""The simulated robot in real time, in a process of its own, which ends with this one, however this one ends."""

from __future__ import annotations

import contextlib
import os
import pickle
import subprocess
import sys
import threading
import traceback
from collections.abc import Mapping
from typing import IO, Any

from ..simulator import Robot
from ._simulated import Simulated, check_driven, topics_of
from ._threaded import ThreadedMiddleware
from .middleware import FeedError, Listener, NotYetError

SERVE = "import sys; sys.path[:] = {path!r}; from robowidgets.feeds._simulator_process import serve; serve()"

STATE, WORLD = "state", "world"
"""Names of messages that are not those of a topic."""

ALONE = 0.5
"""Seconds between two looks whether the other process is still there."""


class SimulatedProcess(ThreadedMiddleware):
    """A simulated robot as a `Middleware`: see `Simulated`. It runs in a process of its own.

    The robot of this process follows that one, and what is changed of it here, such as on the page, is changed there.
    A process that has ended is started anew, with the robot as it was.

    Args:
        robot, hz, wander: as `Simulated` takes them.
    """

    def __init__(self, robot: Robot, hz: float, wander: bool = True) -> None:
        super().__init__()
        self._robot, self._rest = robot, (hz, wander)
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: IO[bytes] | None = None
        """Its standard input, once it has got the robot."""
        self._writing = threading.Lock()
        self._edits = 0
        """Number of changes that were sent to the process; what it sent before the last one is no news."""
        self._known = (robot.pose, robot.world)
        """What both processes have, as far as this one knows."""

    @property
    def where(self) -> str:
        """See `Middleware`."""
        return "the simulated robot"

    def open(self, listener: Listener) -> None:
        """See `Middleware`."""
        listener.on_topics(topics_of(self._robot))
        self._robot.watch(self._on_edit)
        self._start_thread("robowidgets-simulator", listener)

    def publish(self, topic: str, message_type: str, message: Mapping[str, Any]) -> None:
        """See `Middleware`."""
        check_driven(topic)
        self._tell("publish", topic, message_type, message)

    def close(self) -> None:
        """See `Middleware`."""
        self._robot.forget(self._on_edit)
        super().close()

    def _wake(self) -> None:
        if not self._closed.is_set():
            with contextlib.suppress(FeedError):  # the next process gets all wanted topics
                self._tell("want", self._wanted)
        elif self._process is not None:
            self._process.kill()

    def _run_session(self, listener: Listener) -> str:
        with self._lock:
            if self._closed.is_set():
                return ""
            command = [sys.executable, "-c", SERVE.format(path=sys.path)]
            # In a session of its own an interrupt of the kernel does not reach it.
            process = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, start_new_session=True)
            self._process = process
        assert process.stdin
        assert process.stdout
        try:
            with self._writing:
                pickle.dump((self._robot, *self._rest), process.stdin)
                self._pipe, self._edits = process.stdin, 0
            self._tell("want", self._wanted)
            is_connected = False
            while True:
                for name, value in pickle.load(process.stdout):
                    if not is_connected:
                        is_connected = True
                        self._backoff.reset()
                        listener.on_connected()
                    self._take(listener, name, value)
        except (EOFError, FeedError, OSError, pickle.UnpicklingError):
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(ALONE)
        finally:
            process.kill()
            process.wait()
            with self._writing, contextlib.suppress(OSError):
                self._pipe = None
                process.stdout.close()
                process.stdin.close()
        return f"its process has ended, with code {process.returncode}"

    def _take(self, listener: Listener, name: str, value: Any) -> None:
        if name == STATE:
            edits, snapshot = value
            if edits == self._edits:
                self._robot.restore(snapshot)
                self._known = self._robot.pose, self._known[1]
        elif name == WORLD:
            self._robot.restore({**self._robot.snapshot(), "_world": value})
        else:
            listener.on_message(name, value)

    def _on_edit(self) -> None:
        """Send what was changed of the robot here. It is called, too, when the robot follows the other."""
        if threading.current_thread() is not self._thread:
            robot, (pose, world), self._edits = self._robot, self._known, self._edits + 1
            self._known = robot.pose, robot.world
            with contextlib.suppress(FeedError):  # the next process gets the robot as it is then
                moved = None if robot.pose == pose else robot.pose
                changed = None if robot.world is world else robot.world
                self._tell("edit", self._edits, moved, changed)

    def _tell(self, *message: Any) -> None:
        with self._writing:
            if self._pipe is None:
                raise NotYetError("the process of the simulated robot has not started")
            try:
                pickle.dump(message, self._pipe)
                self._pipe.flush()
            except (OSError, ValueError) as error:
                raise FeedError(f"the process of the simulated robot cannot be reached: {error}") from None


class _Newest:
    """The listener in the process of the robot: writes the newest message of each topic, as fast as they are read."""

    def __init__(self) -> None:
        self._changed = threading.Condition()
        self._waiting: dict[str, Any] = {}

    def on_connected(self) -> None:
        """See `Listener`."""

    def on_topics(self, topics: Any) -> None:
        """See `Listener`."""

    def on_message(self, name: str, message: Any) -> None:
        """See `Listener`."""
        with self._changed:
            self._waiting[name] = message
            self._changed.notify()

    def write(self, out: IO[bytes], parent: int) -> None:
        """Write until nobody reads any more, or the process that started this one is gone; then end this one."""
        try:
            while os.getppid() == parent:
                with self._changed:
                    self._changed.wait_for(lambda: self._waiting, ALONE)
                    messages, self._waiting = self._waiting, {}
                if messages:
                    pickle.dump([*messages.items()], out)
                    out.flush()
        except OSError:
            pass  # nobody reads any more
        except Exception:
            traceback.print_exc()
        os._exit(1)


def serve() -> None:
    """Run the robot that standard input has, in its process, until standard input ends."""
    given, out, parent = sys.stdin.buffer, sys.stdout.buffer, os.getppid()
    sys.stdout = sys.stderr  # what is printed must not get among the messages
    with contextlib.suppress(EOFError, OSError):
        robot, hz, wander = pickle.load(given)
        simulated, newest, edits = Simulated(robot, hz, wander), _Newest(), 0
        threading.Thread(target=newest.write, args=(out, parent), daemon=True).start()
        robot.watch(lambda: newest.on_message(STATE, (edits, robot.snapshot())))
        simulated.open(newest)  # type: ignore[arg-type]
        while True:
            act, *rest = pickle.load(given)
            if act == "want":
                (simulated._wanted,) = rest
            elif act == "edit":
                edits, pose, world = rest
                try:
                    robot.world = world or robot.world
                    robot.move_to(*(pose or robot.pose))
                except ValueError:  # it has moved to where there is no room for that any more
                    newest.on_message(WORLD, robot.world)
            else:
                getattr(simulated, act)(*rest)
    os._exit(0)
