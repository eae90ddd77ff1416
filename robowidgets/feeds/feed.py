"""A running robot: its topics, the widgets that show them, and driving it."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Iterator, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from .._core.cells import CellNote, name_in_cells
from .._core.clock import Clock, scheduler
from .._core.inform import inform
from .._core.tables import Table
from .._core.watch import Watch
from .._core.watching import check_watch_name, default_name
from ..behaviors.variables import Variables
from ..driving.command_watchdog import Velocity
from ..samples import Mount, Scan
from ..samples.checks import finite
from ._callbacks import ConnectedFunction
from ._connection import Connection
from ._driving import Driving
from ._scan_iterator import scans_of
from ._topics import FeedTopic, table_of
from .middleware import FeedError, Middleware

if TYPE_CHECKING:
    from ..behaviors.program import Program
    from ..wires_widget import WiresView
    from ._feed_view import FeedView
    from ._feed_watch import FeedWatch
    from ._recorder import Recorder


class Feed:
    """A connection to a robot, a simulated robot or a recording; each function of `robowidgets.feeds` returns one.

    Its printed form is a table of its topics. It reconnects by itself and shows its status on its widgets. All methods
    may be called from any thread. A context manager closes it; so does a new run of the cell that opened it.

    Args:
        middleware: the connection, which the feed opens.
        clock: for tests, what its waits and its driving go by; a middleware has its own.

    Raises:
        FeedError: it can never work. The text gives the reason and the next step.

    Examples:
        >>> from robowidgets import LaserWidget, feeds
        >>> laser = LaserWidget()
        >>> with feeds.simulator() as feed:
        ...     feed.connect("/scan", laser)
    """

    def __init__(self, middleware: Middleware, *, clock: Clock = scheduler.clock) -> None:
        deleted = weakref.ref(self)
        self.connection = Connection(middleware, lambda: deleted() is None, clock)
        self.driver, self.watchdog = self.connection.driver, self.connection.watchdog
        self.programs = self.connection.programs
        self._drive_note, self._program_note = CellNote(), CellNote()
        self._watches: dict[str, FeedWatch] = {}
        self.connection.open()

    # -- what a person uses --------------------------------------------------------------------------------------------

    @property
    def where(self) -> str:
        """The name of the connection, such as ``ROS 2, domain 0``."""
        return self.connection.where

    @property
    def topics(self) -> tuple[FeedTopic, ...]:
        """The topics that are known now."""
        return self.connection.topics

    @property
    def status(self) -> str:
        """The problem of the connection; empty if there is none."""
        return self.connection.status

    @property
    def driving(self) -> Driving:
        """The settings of `drive`: topic, limits, and the hold of a speed. Setting it stops the robot."""
        return self.driver.driving

    @driving.setter
    def driving(self, driving: Driving) -> None:
        self.driver.driving = driving

    @property
    def drive_status(self) -> str:
        """The reasons why the robot may not move as commanded; empty if there are none.

        Reasons are a topic without subscribers, incompatible subscribers, other publishers, and a cut of the last
        speed.
        """
        return self.driver.status

    @property
    def idle_motion(self) -> str:
        """The cause that moves the robot while no speeds are sent, or "" if it stands still then."""
        return ""

    @property
    def stopped(self) -> bool:
        """Whether stop is latched: all driving is refused until it is released.

        True sends zero and latches, False releases; so do the buttons on the page.
        """
        return self.watchdog.stopped

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        self.watchdog.stopped = bool(stopped)

    @property
    def functions(self) -> tuple[ConnectedFunction, ...]:
        """The functions that are connected."""
        return self.connection.functions.functions

    def connect(self, topic: str, *targets: Any, raw: bool = False, each: bool = False) -> None:
        """Pass the messages of a topic to widgets and functions; the topic may appear later.

        Functions are called in a thread of their own, one at a time, with the newest message: a `Scan`, `Speed` or
        `Touch` if a widget can show the topic, else the message as received. Functions of a touch sensor get every
        message. A function that needs two arguments also gets the time at which the message came, in nanoseconds since
        the epoch. The widgets of a topic name a function that raises, and one that has not returned for a second. A
        function replaces the one that had its name before, in the notebook or in a module that is loaded again, and the
        functions that an earlier run of the same cell connected.

        Args:
            topic: its name.
            *targets: widgets, whose `update` takes the messages and whose title becomes the topic if it is empty; their
                methods, such as `speed.command`; or functions of a sample.
            raw: whether functions get the messages as received.
            each: whether functions get each message in its order, and not just the newest. At most 1,000 wait for them;
                the printed feed says how many they did not get.

        Raises:
            TypeError: the topic is no text, there is no target, or a target is neither a widget nor a function.
            ValueError: the topic is empty.
            FeedError: the feed is closed.
        """
        if not isinstance(each, bool):
            raise TypeError(f"each: expected True or False, got {each!r}")
        self.connection.connect(topic, *targets, raw=raw, each=each)

    def disconnect(self, topic: str, *targets: Any) -> None:
        """Pass no more messages of a topic to these targets of `connect`; without targets, to none of them.

        Programs, recorders and loops over its scans still get them.
        """
        self.connection.disconnect(topic, *targets)

    def mount_of(self, frame_id: str) -> Mount | None:
        """How a scanner stands on the robot: as `mount` says, else by tf, as far as that has come; None if unknown.

        tf is followed once a widget, a function or a program takes scans.

        Args:
            frame_id: the coordinate frame of its scans.

        Raises:
            TypeError: frame_id is not a text.
        """
        if not isinstance(frame_id, str):
            raise TypeError(f"frame_id: expected the name of a coordinate frame, got {frame_id!r}")
        return self.connection.mounts.of(frame_id)

    def mount(self, frame_id: str, yaw: float | str | None, *, upside_down: bool = False) -> None:
        """Say how a scanner stands on the robot, in place of tf: angles of its scans are the robot's from now on.

        Args:
            frame_id: the coordinate frame of its scans.
            yaw: radians, or degrees as text (``"90deg"``), by which its forward is turned from the robot's,
                counter-clockwise, or None to use tf again.
            upside_down: True if it stands on its head.

        Raises:
            TypeError: frame_id is not a text, or yaw is not an angle. ValueError: yaw is beyond ±2 pi.

        Examples:
            >>> feed.mount("laser", "180deg", upside_down=True)  # doctest: +SKIP
        """
        self.mount_of(frame_id)
        self.connection.mounts.put(frame_id, None if yaw is None else Mount.by_hand(yaw, upside_down=upside_down))

    def scans(self, topic: str, timeout: float = 0.5) -> Iterator[Scan]:
        """The scans of a topic from now on, each once. A loop that is slower than the scanner gets the newest.

        Args:
            topic: its name.
            timeout: seconds to wait for the next scan. The first one is awaited for 10 s at least.

        Raises:
            TimeoutError: no scan came in time; the text gives the reason, if it is known.
            TypeError, ValueError: no name, or no number of seconds above 0, or a message is no scan.
            FeedError: the feed is closed.

        Examples:
            >>> for scan in feed.scans("/scan", timeout=0.5):  # doctest: +SKIP
            ...     feed.drive(0.2 if scan.distance() > 0.6 else 0.0)
        """
        if finite("timeout", timeout, "seconds") <= 0:
            raise ValueError(f"timeout: expected seconds above 0, got {timeout!r}")
        self.connection.check_open(topic)
        return scans_of(self.connection, topic, timeout)

    def show(self, *topics: str, beside: bool = False, arrangement: Sequence[Any] | None = None) -> FeedView:
        """One widget per topic it knows how to show, live, and those of its program and state machine.

        It waits a moment for the first list of topics. Without names, topics and programs that appear later get a
        widget too; a named topic gets its own when it appears.

        Args:
            *topics: names of the topics to show, of any type, or of fields: ``"/odom.twist.twist.linear.x"``, without
                the program, also with the widget that is to show them: ``"/points as laser"``; none: all that have a
                widget, or, where none has, a few that show what there is.
            beside: whether the view stands beside the notebook, in JupyterLab; the cell has a bar with Stop then.
            arrangement: what to show, as `FeedView.arrangement` of an earlier one returned it.

        Raises:
            TypeError: a name is no text, but a list of them, say; or beside is neither True nor False.
            FeedError: the feed is closed.

        Examples:
            >>> feed.show("/scan", "/odom")  # doctest: +SKIP
        """
        from ._feed_view import FeedView

        if not isinstance(beside, bool):
            raise TypeError(f"beside: expected True or False, got {beside!r}")
        self.connection.check_open(*topics)
        self.connection.await_topics(topics)
        return FeedView(self, topics, beside=beside, arrangement=arrangement)

    def room_view(self) -> Any:
        """A widget that shows the room of a simulated robot from above; None for any other robot."""
        return None

    def wires(self, **options: Any) -> WiresView:
        """The nodes and topics of the robot as a graph, with what the notebook does with them: see `WiresWidget`.

        Args:
            **options: keywords of `WiresWidget`.

        Raises:
            TypeError: an unknown keyword.
            FeedError: the feed is closed.

        Examples:
            >>> feed.wires()  # doctest: +SKIP
        """
        from ..wires_widget import WiresView
        from ._wires import FeedWires

        self.connection.check_open()
        return WiresView(FeedWires(self.connection), **options)

    def record(self, path: str | os.PathLike[str], *topics: str, everything: bool = False) -> Recorder:
        """Write what the robot sends into an MCAP file, until the result is closed, as a context manager or by `close`.

        Beside the topics it has the speeds that are sent, and the text and the states of each version of the program.
        `robowidgets.open` and other tools read it, also when the process dies before it is closed. Writing holds up
        neither the robot nor the program: `problems` of the result says what is missing in the file.

        Args:
            path: the file, such as ``"run.mcap"``, which must not exist yet.
            *topics: names of topics, which may appear later; none: all that have a widget.
            everything: whether, without names, all topics are written, of any type: cameras and point clouds, too,
                which then all come over the network. What cannot be, such as a type of which nobody knows the
                definition, `problems` of the result names.

        Raises:
            TypeError: no path, a name is no text, or ``everything`` is neither True nor False.
            ValueError: the name does not end in ``.mcap``.
            OSError: the file exists, or cannot be written.
            FeedError: the feed is closed.

        Examples:
            >>> with feed.record("run.mcap"):  # doctest: +SKIP
            ...     time.sleep(10)
        """
        from ._recorder import Recorder

        if not isinstance(everything, bool) or (everything and topics):
            raise TypeError(f"everything: expected True or False, and no names beside it, got {everything!r}")
        self.connection.check_open(*topics)
        return Recorder(self.connection, path, topics, everything)

    def drive(self, linear: float = 0.0, angular: float = 0.0, *, lateral: float = 0.0) -> None:
        """Publish a speed, cut to the limits of `driving`; unless it is renewed in time, zero follows.

        At most 50 speeds a second are published, the newest wins; zero is published at once. `drive_status` names a cut
        until the next speed that is not cut, and the log names it once. The first call waits two seconds at most for a
        subscriber to connect.

        Args:
            linear: forward, m/s.
            angular: counter-clockwise, rad/s.
            lateral: to the left, m/s, of a robot that moves sideways: see `max_lateral` of `driving`.

        Raises:
            TypeError: no number. ValueError: NaN or infinite.
            FeedError: the robot cannot be reached or driven, or not sideways; a hand holds a pad, or stop is latched;
                the feed is closed. Nothing is sent then.
        """
        self.driver.drive(Velocity(linear, angular, lateral))
        self._drive_note.print(
            lambda: (
                f"{self.where}: each speed on {self.driver.topic} holds for {self.driving.hold:g} s; "
                f"{name_in_cells(self, 'feed')}.show() shows the robot"
            )
        )

    def stop(self) -> None:
        """Publish zero now, and return when it is sent.

        Raises:
            FeedError: zero was not sent, now or when the feed was closed. The text gives the reason, and whether zero
                is sent on reconnection.
        """
        if not self.connection.is_closed or self.connection.is_forked:
            self.driver.stop()
        elif self.connection.unsent:
            raise FeedError(f"cannot stop: zero could not be sent when the feed was closed: {self.connection.unsent}")

    @property
    def variables(self) -> Variables:
        """The values that programs read and that a person sets on the page, such as ``variables.near = 0.6``."""
        return self.programs.variables

    def program(
        self,
        function: Callable[..., Any] | None = None,
        *,
        rate: float | None = None,
        on: str | None = None,
        **topics: str,
    ) -> Any:
        """Have a function drive the robot, step by step; a decorator.

        One program at a time drives a robot. Defined again under its name, usually by running its cell again, it is
        replaced at the next step. A program of another name ends it.

        The function gets what it names as parameters: the newest ``scan``, ``speed`` and ``touch`` of the robot;
        ``time``, the seconds since its first step in which it could make steps; ``state``, which it keeps from step to
        step and from version to version; ``variables``, which a person sets. It returns a
        `robowidgets.behaviors.Drive`, or None to keep the speed. It must return at once: after half a second it is
        abandoned. When it raises, and when a sample is
        missing or old, the robot is stopped.

        Args:
            function: the function, or a class that describes a state machine, see `robowidgets.behaviors.Machine`;
                without it, `program` returns a decorator.
            rate: steps a second, at most 200; 10 without `on`.
            on: a topic; there is one step for each of its messages, the newest if they come too fast.
            **topics: for a parameter, the topic that it is read from: ``scan="/base_scan"``. A parameter of any other
                name gets the messages of its topic.

        Raises:
            TypeError: no function, or it asks for something unknown. ValueError: the rate is out of range.
            FeedError: the feed is closed.

        Examples:
            >>> from robowidgets import feeds
            >>> from robowidgets.behaviors import Drive
            >>> with feeds.simulator(wander=False) as robot:
            ...     @robot.program(rate=10)
            ...     def avoid(scan):
            ...         return Drive(0.2) if scan.distance("front") > 0.6 else Drive(0, 0.8)
            >>> avoid.mode
            'ended'
        """
        self.connection.check_open(*topics.values(), *(() if on is None else (on,)))
        if function is not None:
            return self._install(function, rate, on, topics)
        return lambda given: self._install(given, rate, on, topics)

    def _install(
        self, function: Callable[..., Any], rate: float | None, on: str | None, topics: dict[str, str]
    ) -> Program:
        program = self.connection.install(function, rate, on, topics)
        steps, hold = program.version.rate, self.driving.hold
        if on is None and steps * hold <= 1:
            inform(
                f"program {program.name}: a step each {1 / steps:.3g} s, but a speed holds for {hold:.3g} s, so the "
                f"robot stands before the next one; choose a rate above {1 / hold:.3g}"
            )
        self._program_note.print(
            lambda: (
                f"{self.where}: {program.name} drives from now on, also after this cell; "
                f"{name_in_cells(self, 'feed')}.show() shows it, with Stop"
            )
        )
        return program

    def watch(self, condition: Any, name: str | None = None, /, **topics: str) -> Watch:
        """Judge a condition whenever the robot sends something that it reads, of any of its topics.

        It is judged in a thread of its own, on the newest messages. What raises is switched off, and `error` of the
        result says why; a program may wait for it: see `robowidgets.search.conditions` and `Watch`. Unlike `watch` of a
        widget it has no lamp.

        Args:
            condition: one of `robowidgets.conditions`, or several that are joined; or a function that returns True,
                False, or None for unknown. A function takes what a program may take: ``scan``, ``speed``, ``touch``,
                ``sonars``, ``pose``, and ``driven`` and ``turned`` since the watch began; or it has one parameter of
                another name, and gets the moment, which has all of them, and ``moment[topic]``.
            name: plain text; a watch of the same name is replaced. None: the name of the function, or the text of the
                condition.
            **topics: for a parameter, the topic that it is read from: ``imu="/imu"``.

        Raises:
            TypeError: no such condition, a lambda without a name, or something unknown is asked for.
            ValueError: the name is empty or too long. FeedError: the feed is closed.

        Examples:
            >>> from robowidgets import conditions, feeds
            >>> with feeds.simulator() as robot:
            ...     near = robot.watch(conditions.nearest_below(5.0) & (conditions.field("/odom.linear[0]") < 1.0))
            ...     moment = near.wait()
            >>> near.value is None  # the feed is closed
            True
        """
        from ._feed_watch import FeedWatch

        self.connection.check_open(*topics.values())
        named = default_name(condition) if name is None else name
        if not isinstance(named, str):
            raise TypeError(f"name: expected text, got {named!r}")
        check_watch_name(named)
        watch = FeedWatch(self.connection, condition, named, topics)
        before, self._watches[named] = self._watches.get(named), watch
        if before is not None:  # as a truth value it is its verdict
            before.end("another condition has its name now")
        return watch

    def unwatch(self, name: str) -> None:
        """Judge a condition no more.

        Raises:
            KeyError: there is no watch of that name.
        """
        gone = self._watches.pop(name, None)
        if gone is None:  # as a truth value it is its verdict
            raise KeyError(f"no watch {name!r}: there are {', '.join(self._watches) or 'none'}")
        gone.end("it is no longer watched")

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return MappingProxyType(self._watches)

    def close(self) -> None:
        """Stop the robot if it is driven, disconnect, end every thread; doing it again does nothing.

        It takes a few seconds at most, whatever the robot and connected functions do.
        """
        self.connection.close()

    def __enter__(self) -> Feed:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        return "\n".join(table.to_text() for table in self._tables())

    def _repr_html_(self) -> str:
        return "".join(table.to_html() for table in self._tables())

    def _tables(self) -> list[Table]:
        tables = [table_of(self.where, self.topics, self.status, self.driver.sender)]
        if self.functions:
            tables.append(self.connection.functions.table())
        return tables
