"""A running robot: its topics, the widgets that show them, and driving it."""

from __future__ import annotations

import os
import weakref
from collections.abc import Callable, Iterator, Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

from ..behaviors.drive import Drive
from ..behaviors.variables import Variables
from ..driving.command_watchdog import Velocity
from ..notebook.cells import CellNote, name_in_cells
from ..runtime.clock import Clock, scheduler
from ..runtime.inform import inform
from ..runtime.tables import Table
from ..samples import Mount, Scan
from ..samples.checks import finite
from ..widget.watch import Watch
from ..widget.watching import check_watch_name, default_name
from ._callbacks import ConnectedFunction
from ._connection import Connection
from ._driving import Driving
from ._scan_iterator import scans_of
from ._topics import FeedTopic, table_of
from .middleware import FeedError, Middleware

if TYPE_CHECKING:
    from ..behaviors.program import Program
    from ..wires_widget import WiresView
    from ._black_box import BlackBox
    from ._feed_view import FeedView
    from ._feed_watch import FeedWatch
    from ._recorder import Recorder


class Feed:
    """A connection to a robot, a simulated robot or a recording; each function of `robowidgets.feeds` returns one.

    Its printed form is a table of its topics. It reconnects by itself and shows its status on its widgets. Any thread
    may call any method. As a context manager it closes at the end; a new run of the cell that opened it closes it, too.

    Args:
        middleware: the connection, which the feed opens.
        clock: for tests, the clock of its waits and its driving. A middleware has another clock.

    Raises:
        FeedError: the feed can never work. The text gives the reason and the next step.

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
        self._black_box: BlackBox | None = None
        self.connection.open()

    # -- for users -----------------------------------------------------------------------------------------------------

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
        """The problem of the connection, or empty."""
        return self.connection.status

    @property
    def driving(self) -> Driving:
        """The settings of `drive`: topic, limits, and how long a speed is valid. Setting it stops the robot."""
        return self.driver.driving

    @driving.setter
    def driving(self, driving: Driving) -> None:
        self.driver.driving = driving

    @property
    def drive_status(self) -> str:
        """The reasons why the robot may not move as commanded, or empty.

        Reasons are a topic without subscribers, incompatible subscribers, other publishers, and a cut of the last
        speed.
        """
        return self.driver.status

    @property
    def idle_motion(self) -> str:
        """The cause that moves the robot while no speeds are sent, or "" if it stands still."""
        return ""

    @property
    def stopped(self) -> bool:
        """True while stop is latched: all driving is refused until it is released.

        Setting it to True sends zero and latches, False releases. The buttons on the page do the same.
        """
        return self.watchdog.stopped

    @stopped.setter
    def stopped(self, stopped: bool) -> None:
        self.watchdog.stopped = bool(stopped)

    @property
    def functions(self) -> tuple[ConnectedFunction, ...]:
        """The connected functions."""
        return self.connection.functions.functions

    def connect(self, topic: str, *targets: Any, raw: bool = False, each: bool = False) -> None:
        """Pass the messages of a topic to widgets and functions. The topic may appear later.

        Functions are called in a separate thread, one at a time, with the newest message: a `Scan`, `Speed` or `Touch`
        if a widget can show the topic, or the message as received. Functions of a touch sensor get every message. A
        function with two required arguments also gets the time at which the message arrived, in nanoseconds since the
        epoch. The widgets of a topic report a function that raises an error or has not returned for a second. A
        function replaces a previous function of its name, in the notebook or in a reloaded module, and the functions
        that an earlier run of the same cell connected.

        Args:
            topic: its name.
            *targets: widgets, whose `update` gets the messages and whose title becomes the topic if it is empty; their
                methods, such as `speed.command`; or functions of a sample.
            raw: True to pass messages to functions as received.
            each: True to pass every message to functions, in order, instead of the newest. At most 1,000 messages wait;
                the printed feed shows how many were lost.

        Raises:
            TypeError: the topic is not text, no target is given, or a target is neither a widget nor a function.
            ValueError: the topic is empty.
            FeedError: the feed is closed.
        """
        if not isinstance(each, bool):
            raise TypeError(f"each: expected True or False, got {each!r}")
        self.connection.connect(topic, *targets, raw=raw, each=each)

    def disconnect(self, topic: str, *targets: Any) -> None:
        """Stop passing messages of a topic to these targets of `connect`, or to all targets by default.

        Programs, recorders and loops over its scans still get them.
        """
        self.connection.disconnect(topic, *targets)

    def mount_of(self, frame_id: str) -> Mount | None:
        """Return the mount of a scanner on the robot, as set by `mount` or known from tf, or None if unknown.

        tf is followed once a widget, a function or a program receives scans.

        Args:
            frame_id: the coordinate frame of its scans.

        Raises:
            TypeError: frame_id is not text.
        """
        if not isinstance(frame_id, str):
            raise TypeError(f"frame_id: expected the name of a coordinate frame, got {frame_id!r}")
        return self.connection.mounts.of(frame_id)

    def mount(self, frame_id: str, yaw: float | str | None, *, upside_down: bool = False) -> None:
        """Set the mount of a scanner on the robot, instead of tf. From now on, its scans have the robot's angles.

        Args:
            frame_id: the coordinate frame of its scans.
            yaw: radians, or degrees as text (``"90deg"``), by which its forward direction is turned from the robot's,
                counter-clockwise; or None to use tf again.
            upside_down: True if it is mounted upside down.

        Raises:
            TypeError: frame_id is not text, or yaw is not an angle. ValueError: yaw is beyond ±2 pi.

        Examples:
            >>> feed.mount("laser", "180deg", upside_down=True)  # doctest: +SKIP
        """
        self.mount_of(frame_id)
        self.connection.mounts.put(frame_id, None if yaw is None else Mount.by_hand(yaw, upside_down=upside_down))

    def scans(self, topic: str, timeout: float = 0.5) -> Iterator[Scan]:
        """Yield the scans of a topic from now on, each once. A loop that is slower than the scanner gets the newest.

        Args:
            topic: its name.
            timeout: seconds to wait for the next scan. The wait for the first scan is at least 10 s.

        Raises:
            TimeoutError: no scan came in time. The text gives the reason, if it is known.
            TypeError, ValueError: the name or the timeout is invalid, or a message is not a scan.
            FeedError: the feed is closed.

        Examples:
            >>> for scan in feed.scans("/scan", timeout=0.5):  # doctest: +SKIP
            ...     feed.drive(0.2 if scan.distance() > 0.6 else 0.0)
        """
        if finite("timeout", timeout, "seconds") <= 0:
            raise ValueError(f"timeout: expected seconds above 0, got {timeout!r}")
        self.connection.check_open(topic)
        return scans_of(self.connection, topic, timeout)

    def show(self, *topics: str, beside: bool = False, arrangement: Any = None) -> FeedView:
        """Return a view with a live widget for each topic that has one, and for the program and its state machine.

        It waits a moment for the first list of topics. Without names, topics and programs that appear later get a
        widget, too. A named topic gets its widget when it appears.

        Args:
            *topics: names of topics of any type, or of fields such as ``"/odom.twist.twist.linear.x"``; the program is
                not shown then. A name may include the widget: ``"/points as laser"``. Without names: all topics that
                have a widget, or, if no topic has a widget, a few that show the fields of messages.
            beside: True to open the view next to the notebook, in JupyterLab. The cell then has a bar with Stop.
            arrangement: the entries to show, and the cards that were arranged by hand, from `FeedView.arrangement` of
                an earlier view.

        Raises:
            TypeError: a name is not text but, for example, a list of names; or beside is neither True nor False.
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
        """Return a widget that shows the room of a simulated robot from above, or None for any other robot."""
        return None

    def wires(self, **options: Any) -> WiresView:
        """Return the nodes and topics of the robot as a graph, with the parts of the notebook. See `WiresWidget`.

        Args:
            **options: keywords of `WiresWidget`.

        Raises:
            TypeError: a keyword is unknown.
            FeedError: the feed is closed.

        Examples:
            >>> feed.wires()  # doctest: +SKIP
        """
        from ..wires_widget import WiresView
        from ._wires import FeedWires

        self.connection.check_open()
        return WiresView(FeedWires(self.connection), **options)

    def record(self, path: str | os.PathLike[str], *topics: str, everything: bool = False) -> Recorder:
        """Write the messages of the robot to an MCAP file until the result is closed, by `close` or by ``with``.

        In addition to topics, the file contains the sent speeds, and the text and the states of each version of the
        program. `robowidgets.open` and other tools can read it, even if the process dies before it is closed. Writing
        delays neither the robot nor the program: `problems` of the result lists what the file lacks.

        Args:
            path: the file, such as ``"run.mcap"``, which must not exist yet.
            *topics: names of topics, which may appear later, or none for all topics that have a widget.
            everything: True to write, without names, all topics of any type, including cameras and point clouds, which
                then all use the network. `problems` of the result lists topics that cannot be written, for example
                because the definition of their type is unknown.

        Raises:
            TypeError: the path is not a path, a name is not text, or ``everything`` is neither True nor False.
            ValueError: the name does not end in ``.mcap``.
            OSError: the file exists, or cannot be written.
            FeedError: the feed is closed.

        Examples:
            >>> with feed.record("run.mcap"):  # doctest: +SKIP
            ...     time.sleep(10)
        """
        from ._recorder import Recorder

        if not isinstance(everything, bool) or (everything and topics):
            raise TypeError(f"everything: expected True or False, and no names of topics with True, got {everything!r}")
        self.connection.check_open(*topics)
        return Recorder(self.connection, path, topics, everything)

    def black_box(
        self,
        *topics: str,
        seconds: float = 60.0,
        after: float = 5.0,
        when: Any = (),
        folder: str | os.PathLike[str] = "black_box",
        files: int = 20,
        megabytes: float = 1000.0,
    ) -> BlackBox:
        """Keep the last minute, and write it to an MCAP file when something happens, until it is closed.

        A bump, Stop, an error on ``/rosout`` or ``/diagnostics``, a lost connection, an error of the program, a
        condition that becomes true, and `BlackBox.save` begin a file. It appears some seconds later, and each cause is
        a mark in its player. There are at most four files a minute: causes in between share one. An error that comes
        again within ten minutes is only a mark. If the kernel is killed, the next black box in this folder, or
        ``robowidgets repair`` of the folder, writes what is left of it.

        Speeds, transforms, touches, and the text and states of the program are always in it. A feed has one black box:
        another call replaces it.

        Args:
            *topics: names of topics, or none for the topics that widgets show, or could show if none is shown.
            seconds: the time before a cause, 1 to 3600.
            after: the time after it, 0 to 600. A cause in this time extends the file.
            when: conditions as for `watch`: one, several, or a dictionary of conditions by name.
            folder: the folder of the files. Several kernels may use the same one.
            files: the largest number of files in the folder; older ones are deleted.
            megabytes: the limit for all of it: a quarter for the last minute of each kernel, half for the files.

        Raises:
            TypeError, ValueError: an argument is invalid, or a condition, as for `watch`.
            OSError: the folder cannot be made or written. FeedError: the feed is closed.

        Examples:
            >>> feed.black_box(seconds=60)  # doctest: +SKIP
        """
        from ._black_box import BlackBox, folder_of, limits_of, named_conditions

        self.connection.check_open(*topics)
        limits, named = limits_of(seconds, after, files, megabytes), named_conditions(when)
        self._black_box = BlackBox(self.connection, topics, named, folder_of(folder), limits, self._black_box)
        return self._black_box

    def drive(self, linear: float = 0.0, angular: float = 0.0, *, lateral: float = 0.0) -> None:
        """Publish a speed, cut to the limits of `driving`. Zero follows unless the speed is renewed in time.

        At most 50 speeds a second are published, and the newest wins. Zero is published at once. `drive_status` reports
        a cut until the next speed that is not cut, and the log reports it once. The first call waits at most two
        seconds for a subscriber to connect.

        Args:
            linear: forward, m/s.
            angular: counter-clockwise, rad/s.
            lateral: to the left, m/s, for a robot that moves sideways. See `max_lateral` of `driving`.

        Raises:
            TypeError: an argument is not a number. ValueError: it is NaN or infinite.
            FeedError: the robot cannot be reached, driven, or driven sideways; a hand holds a pad; stop is latched; or
                the feed is closed. Nothing is sent then.
        """
        if isinstance(linear, Drive):
            raise TypeError(
                f"drive(): expected numbers, as in feed.drive(0.2, 0.5); got {linear}, as a program returns it"
            )
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
        """The values that programs read and that the user sets on the page, such as ``variables.near = 0.6``."""
        return self.programs.variables

    def program(
        self,
        function: Callable[..., Any] | None = None,
        *,
        rate: float | None = None,
        on: str | None = None,
        **topics: str,
    ) -> Any:
        """Drive the robot by a function, step by step. It can be used as a decorator.

        One program at a time drives a robot. A program that is defined again under its name, usually by running its
        cell again, is replaced at the next step. A program of another name ends it.

        The function gets the inputs that its parameters name: the newest ``scan``, ``speed`` and ``touch`` of the
        robot; ``time``, the seconds since its first step in which it could make steps; ``state``, which it keeps from
        step to step and from version to version; ``variables``, which the user sets. It returns a
        `robowidgets.behaviors.Drive`, or None to keep the speed. It must return at once: after half a second it is
        abandoned. The robot is stopped if the function raises an error, or if a sample is missing or old.

        Args:
            function: the function, or a class that describes a state machine, see `robowidgets.behaviors.Machine`.
                Without it, `program` returns a decorator.
            rate: steps per second, at most 200. The default is 10 without `on`.
            on: a topic. Each of its messages causes a step, or the newest one if they come too fast.
            **topics: for a parameter, the topic that it is read from: ``scan="/base_scan"``. A parameter of any other
                name gets the messages of its topic.

        Raises:
            TypeError: the function is not a function, or has an unknown parameter. ValueError: the rate is out of
                range.
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
        for name, topic in topics.items():
            if not isinstance(topic, str):
                raise TypeError(
                    f"program: {name}={topic!r}: expected the name of a topic as text for the parameter {name!r}; "
                    "the other arguments are rate= and on="
                )
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
        self._program_note.print(lambda: f"{self.where}: {self._state_in_words(program)}")
        return program

    def _state_in_words(self, program: Program) -> str:
        shown = f"{name_in_cells(self, 'feed')}.show()"
        if self.stopped:
            return f"{program.name} drives when you press Allow driving in {shown}, because Stop is pressed"
        if program.error:
            return f"{program.name} has an error and does not drive: correct it and run the cell again"
        return f"{program.name} drives from now on, also after this cell; {shown} shows it, with Stop"

    def watch(self, condition: Any, name: str | None = None, /, **topics: str) -> Watch:
        """Evaluate a condition whenever the robot sends a message on any of the topics that it reads.

        It is evaluated in a separate thread, on the newest messages. A condition that raises an error is switched off,
        and `error` of the result gives the reason. A program may wait for it: see `robowidgets.conditions` and
        `Watch`. Unlike `watch` of a widget it has no lamp.

        Args:
            condition: one of `robowidgets.conditions`, several that are joined, or a function that returns True, False,
                or None for unknown. A function may have the inputs of a program: ``scan``, ``speed``, ``touch``,
                ``sonars``, ``pose``, and ``driven`` and ``turned`` since the watch began. Or it has one parameter of
                another name, and gets the moment, which contains all of them, and ``moment[topic]``.
            name: plain text. A watch of the same name is replaced. The default is the name of the function, or the text
                of the condition.
            **topics: for a parameter, the topic that it is read from: ``imu="/imu"``.

        Raises:
            TypeError: the condition is invalid, a lambda without a name, or reads an unknown name.
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
        if before is not None:  # not `if before`, because its truth value is its verdict
            before.end("another condition has its name now")
        return watch

    def unwatch(self, name: str) -> None:
        """End a watch.

        Raises:
            KeyError: no watch has this name.
        """
        gone = self._watches.pop(name, None)
        if gone is None:  # not `if not gone`, because its truth value is its verdict
            raise KeyError(f"no watch {name!r}: there are {', '.join(self._watches) or 'none'}")
        gone.end("it is no longer watched")

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return MappingProxyType(self._watches)

    def close(self) -> None:
        """Stop the robot if it is driven, disconnect, and end every thread. Calling it again does nothing.

        It takes a few seconds at most, even if the robot or a connected function does not respond.
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
        there = self.connection
        notes = (self.driver.sender, there.black_box, *there.black_box_troubles)
        tables = [table_of(self.where, self.topics, self.status, *notes)]
        if self.functions:
            tables.append(self.connection.functions.table())
        return tables
