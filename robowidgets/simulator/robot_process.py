"""The robot in real time, in a process of its own, which ends with this one, however this one ends."""

from __future__ import annotations

import contextlib
import os
import pickle
import socket
import subprocess
import sys
import threading
import traceback
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from functools import partial
from importlib import import_module
from typing import IO, Any

from .._core.import_path import import_path
from .offers import MakeOffers
from .real_time import RealTime
from .robot import Robot

SERVE = "import sys; sys.path += {path!r}; from robowidgets.simulator.robot_process import serve; serve()"
"""The standard library comes first in the path: a file of the user with such a name is not imported."""

STATE, WORLD, MISSED = "state", "world", "missed"
"""Names of messages that are not those of a topic."""

MOST_WAITING = 1000
"""Samples of a topic that wait to be read, where each is wanted; when more come, the oldest are dropped and counted."""

ALONE = 0.5
"""Seconds between two looks whether the other process is still there."""


class RobotProcess:
    """Runs a robot as `RealTime` does, in another process. Any thread may call each method.

    The robot of this process follows that one, and what is changed of it here, such as on the page, is changed there.

    Args:
        robot, hz, wander, offers: as `RealTime` takes them; the functions are those of modules.
        guard: what takes speeds in the process, ``"module:name"``: a function of a socket and of `RealTime.drive`,
            which runs in a thread of its own. Empty: none.
        on_guard: called in a thread of its own with the other end of that socket, for each process.

    Attributes:
        pid: the number of the process; 0 before the first.
    """

    def __init__(
        self,
        robot: Robot,
        hz: float,
        wander: bool,
        offers: Sequence[MakeOffers],
        guard: str = "",
        on_guard: Callable[[socket.socket], object] = lambda _: None,
    ) -> None:
        self._guard, self._on_guard = guard, on_guard
        self._robot, self._rest = robot, (hz, wander, offers)
        self._wanted: tuple[Collection[str], Collection[str]] = (), ()
        self._starting = threading.Lock()
        self._ended = False
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: IO[bytes] | None = None
        """Its standard input, once it has got the robot."""
        self._writing = threading.Lock()
        self._follower: threading.Thread | None = None
        """The thread in which the robot follows the other one."""
        self._edits = 0
        """Number of changes that were sent to the process; what it sent before the last one is no news."""
        self._known = robot.pose, robot.world, robot.resets
        """What both processes have, as far as this one knows."""
        robot.observe(self._on_edit)

    @property
    def pid(self) -> int:
        """The number of the process; 0 before the first."""
        return self._process.pid if self._process is not None else 0

    def want(self, topics: Collection[str], each: Collection[str] = ()) -> None:
        """See `RealTime`."""
        self._wanted = topics, each
        with contextlib.suppress(OSError):  # the next process gets them
            self._tell("want", topics, each)

    def drive(self, linear: float, angular: float, lateral: float) -> None:
        """See `RealTime`. ConnectionRefusedError if the process has not started; OSError if it cannot be reached."""
        self._tell("drive", linear, angular, lateral)

    def end(self) -> None:
        """End the process, and start no other."""
        self._robot.unobserve(self._on_edit)
        with self._starting:
            self._ended = True
            if self._process is not None:
                self._process.kill()

    def run(
        self,
        on_sample: Callable[..., object],
        on_start: Callable[[], object],
        on_missed: Callable[[str, int], object],
    ) -> str:
        """Run a process, with the robot as it is here, until it ends; returns why, for a person.

        Args:
            on_sample: called as that of `RealTime`, with ``newest=False`` for a sample that was replaced already.
            on_start: called when the robot there has moved for the first time.
            on_missed: called with a topic of which each sample is wanted, and how many of them were dropped.
        """
        with self._starting:
            if self._ended:
                return ""
            process, guarded = self._start()
            self._process = process
        self._follower = threading.current_thread()
        assert process.stdin
        assert process.stdout
        try:
            with self._writing:
                pickle.dump((self._robot, *self._rest, self._edits, self._guard, guarded), process.stdin)
                # With the lock held: topics that are wanted from now on come after these, and replace them.
                pickle.dump(("want", *self._wanted), process.stdin)
                process.stdin.flush()
                self._pipe = process.stdin
            is_started = False
            while True:
                messages = pickle.load(process.stdout)
                last = {name: number for number, (name, _) in enumerate(messages)}
                for number, (name, value) in enumerate(messages):
                    if not is_started:
                        is_started = True
                        on_start()
                    if name == MISSED:
                        on_missed(*value)
                    else:
                        self._take(partial(on_sample, newest=number == last[name]), name, value)
        except (EOFError, OSError, pickle.UnpicklingError):
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

    def _start(self) -> tuple[subprocess.Popen[bytes], int]:
        """Start a process; the number of its end of the socket of its guard, or 0."""
        ours, its = socket.socketpair() if self._guard else (None, None)
        command = [sys.executable, "-I", "-c", SERVE.format(path=import_path())]
        number = its.fileno() if its else 0
        # In a session of its own an interrupt of the kernel does not reach it.
        process = subprocess.Popen(
            command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            start_new_session=True,
            pass_fds=[number] if its else (),
        )
        if ours and its:
            its.close()
            threading.Thread(target=self._on_guard, args=(ours,), name="robowidgets-guard", daemon=True).start()
        return process, number

    def _take(self, on_sample: Callable[[str, Any], object], name: str, value: Any) -> None:
        if name == STATE:
            edits, snapshot = value
            if edits == self._edits:
                self._robot.restore(snapshot)
                self._known = self._robot.pose, *self._known[1:]
        elif name == WORLD:
            self._robot.restore({**self._robot.snapshot(), "_world": value})
        else:
            on_sample(name, value)

    def _on_edit(self) -> None:
        """Send what was changed of the robot here. It is called, too, when the robot follows the other."""
        if threading.current_thread() is not self._follower:
            robot, (pose, world, resets), self._edits = self._robot, self._known, self._edits + 1
            self._known = robot.pose, robot.world, robot.resets
            with contextlib.suppress(OSError):  # the next process gets the robot as it is then
                moved = None if robot.pose == pose else robot.pose
                changed = None if robot.world is world else robot.world
                odometry = None if robot.resets == resets else robot.odometry
                self._tell("edit", self._edits, moved, changed, odometry)

    def _tell(self, *message: Any) -> None:
        with self._writing:
            if self._pipe is None:
                raise ConnectionRefusedError("the process of the simulated robot has not started")
            try:
                pickle.dump(message, self._pipe)
                self._pipe.flush()
            except (OSError, ValueError) as error:
                raise ConnectionError(f"the process of the simulated robot cannot be reached: {error}") from None


class _Outbox:
    """In the process of the robot: writes the newest message of each name, as fast as they are read.

    Attributes:
        each: the names of which each message is written.
    """

    def __init__(self) -> None:
        self.each: Collection[str] = ()
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._waiting: dict[str, list[Any]] = {}
        self._missed: Counter[str] = Counter()

    def put(self, name: str, message: Any) -> None:
        """Write a message, in place of one of its name that waits if the newest is enough."""
        with self._lock:
            waiting = self._waiting.setdefault(name, [])
            if name not in self.each:
                waiting.clear()
            elif len(waiting) >= MOST_WAITING:
                del waiting[0]
                self._missed[name] += 1
            waiting.append(message)
            self._changed.notify()

    def take(self) -> list[tuple[str, Any]]:
        """Wait a moment for what is to be written."""
        with self._lock:
            self._changed.wait_for(lambda: self._waiting, ALONE)
            messages = [(name, message) for name, waiting in self._waiting.items() for message in waiting]
            missed = [(MISSED, counted) for counted in self._missed.items()]
            self._waiting, self._missed = {}, Counter()
        return [*messages, *missed]

    def write(self, out: IO[bytes], parent: int) -> None:
        """Write until nobody reads any more, or the process that started this one is gone; then end this one."""
        try:
            while os.getppid() == parent:
                if messages := self.take():
                    pickle.dump(messages, out)
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
        robot, hz, wander, offers, edits, guard, number = pickle.load(given)
        real_time, outbox = RealTime(robot, hz, wander, offers), _Outbox()
        robot.observe(lambda: outbox.put(STATE, (edits, robot.snapshot())))
        threading.Thread(target=outbox.write, args=(out, parent), daemon=True).start()
        threading.Thread(target=real_time.run, args=(outbox.put,), daemon=True).start()
        if guard:
            module, _, name = guard.partition(":")
            take = getattr(import_module(module), name)
            threading.Thread(target=take, args=(socket.socket(fileno=number), real_time.drive), daemon=True).start()
        while True:
            act, *rest = pickle.load(given)
            if act == "edit":
                edits, pose, world, odometry = rest
                try:
                    robot.place(world or robot.world, pose or robot.pose, odometry=odometry)
                except ValueError:  # it has moved to where there is no room for that any more
                    outbox.put(WORLD, robot.world)
            else:
                if act == "want":
                    outbox.each = rest[1]
                getattr(real_time, act)(*rest)
    os._exit(0)
