"""The robot in real time, in a separate process, which ends with this process even after a crash."""

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

from ..runtime.import_path import import_path
from .offers import MakeOffers
from .real_time import RealTime
from .robot import Robot

SERVE = "import sys; sys.path += {path!r}; from robowidgets.simulator.robot_process import serve; serve()"
"""The standard library comes first in the path, so that it is not hidden by a file of the user with the same name."""

STATE, WORLD, MISSED = "state", "world", "missed"
"""The names of messages other than samples of a topic."""

MOST_WAITING = 1000
"""The highest number of waiting samples of a topic if each is wanted. The oldest are dropped and counted."""

ALONE = 0.5
"""Seconds between two checks if the other process is still running."""


class RobotProcess:
    """A robot that runs like `RealTime` in another process. Any thread may call each method.

    The robot of this process follows the robot of the other process. Changes of the robot in this process, such as on
    the page, are sent to the other process.

    Args:
        robot, hz, wander, offers: as in `RealTime`; each function must be a global function of a module.
        guard: the function that receives speeds in the other process, as ``"module:name"``. It is called in a separate
            thread with a socket and `RealTime.drive`. Empty for no guard.
        on_guard: called for each process, in a separate thread, with the other end of the socket.

    Attributes:
        pid: the id of the process; 0 before the first process.
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
        self._stands = False
        self._starting = threading.Lock()
        self._ended = False
        self._process: subprocess.Popen[bytes] | None = None
        self._pipe: IO[bytes] | None = None
        """The standard input of the process, once it has received the robot."""
        self._writing = threading.Lock()
        self._follower: threading.Thread | None = None
        """The thread in which the robot follows the other robot."""
        self._edits = 0
        """The number of changes sent to the process. States from before the last change are ignored."""
        self._known = robot.pose, robot.world, robot.resets
        """The last state known to be the same in both processes."""
        robot.observe(self._on_edit)

    @property
    def pid(self) -> int:
        """The id of the process; 0 before the first process."""
        return self._process.pid if self._process is not None else 0

    def want(self, topics: Collection[str], each: Collection[str] = ()) -> None:
        """See `RealTime`."""
        self._wanted = topics, each
        with contextlib.suppress(OSError):  # the next process receives them
            self._tell("want", topics, each)

    def stand(self, stands: bool) -> None:
        """See `RealTime`."""
        if stands != self._stands:
            self._stands = stands
            with contextlib.suppress(OSError):  # the next process receives it
                self._tell("stand", stands)

    def drive(self, linear: float, angular: float, lateral: float) -> None:
        """See `RealTime`; ConnectionRefusedError if the process has not started, OSError if it cannot be reached."""
        self._tell("drive", linear, angular, lateral)

    def end(self) -> None:
        """End the process, and start no other process."""
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
        """Run a process with the present state of the robot until it ends. Return the reason of its end, for the user.

        Args:
            on_sample: called as in `RealTime`, with ``newest=False`` for a sample that is already replaced.
            on_start: called when the first message of the process has come.
            on_missed: called with a topic in ``each``, and the number of its samples that were dropped.
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
                # With the lock held, so that later calls of `want` and `stand` come after these, and replace them.
                pickle.dump(("want", *self._wanted), process.stdin)
                pickle.dump(("stand", self._stands), process.stdin)
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
        """Start a process. Return it with the file descriptor of its end of the guard's socket, or 0."""
        ours, its = socket.socketpair() if self._guard else (None, None)
        command = [sys.executable, "-I", "-c", SERVE.format(path=import_path())]
        number = its.fileno() if its else 0
        # In a new session, because an interrupt of the kernel must not reach it.
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
        """Send changes of the robot in this process. Calls while the robot follows the other robot are ignored."""
        if threading.current_thread() is not self._follower:
            robot, (pose, world, resets), self._edits = self._robot, self._known, self._edits + 1
            self._known = robot.pose, robot.world, robot.resets
            with contextlib.suppress(OSError):  # the next process receives the robot with its present state
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
    """The messages to write in the process of the robot: the newest of each name, as fast as they are read.

    Attributes:
        each: the names for which every message is written.
    """

    def __init__(self) -> None:
        self.each: Collection[str] = ()
        self._lock = threading.RLock()
        self._changed = threading.Condition(self._lock)
        self._waiting: dict[str, list[Any]] = {}
        self._missed: Counter[str] = Counter()

    def put(self, name: str, message: Any) -> None:
        """Add a message. It replaces a waiting message of its name if the newest is enough."""
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
        """Wait a moment for messages, and return all messages to write."""
        with self._lock:
            self._changed.wait_for(lambda: self._waiting, ALONE)
            messages = [(name, message) for name, waiting in self._waiting.items() for message in waiting]
            missed = [(MISSED, counted) for counted in self._missed.items()]
            self._waiting, self._missed = {}, Counter()
        return [*messages, *missed]

    def write(self, out: IO[bytes], parent: int) -> None:
        """Write until the reader or the parent process has ended, then end this process."""
        try:
            while os.getppid() == parent:
                if messages := self.take():
                    pickle.dump(messages, out)
                    out.flush()
        except OSError:
            pass  # the reader has ended
        except Exception:
            traceback.print_exc()
        os._exit(1)


def serve() -> None:
    """Run the robot from standard input in this process, until standard input ends."""
    given, out, parent = sys.stdin.buffer, sys.stdout.buffer, os.getppid()
    sys.stdout = sys.stderr  # prints must not mix with the messages
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
                except ValueError:  # the robot has moved, and the change does not fit any more
                    outbox.put(WORLD, robot.world)
            else:
                if act == "want":
                    outbox.each = rest[1]
                getattr(real_time, act)(*rest)
    os._exit(0)
