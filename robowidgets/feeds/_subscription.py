"""A topic to which widgets or functions are connected."""

from __future__ import annotations

import inspect
import sys
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import update_wrapper
from typing import Any, NamedTuple, TypeGuard

from ..drive_widget import DriveWidget
from ..kinds import on_demand_row, role_of, sensor_of
from ..runtime.log_once import LogOnce, log_in_thread
from ..widget.robot_widget import RobotWidget
from ..widget.sample_widget import SampleWidget
from ._topics import FeedTopic, no_such
from ._two_scanners import TwoScanners

SOON = 5.0
"""Seconds within which a message arrives that a publisher kept, even from a robot with hundreds of topics."""

RARE = 2.0
"""The least seconds between messages of a topic whose last message is kept."""

_PACKAGE = __name__.partition(".")[0]


class OfSensor:
    """A method of a widget with several sensors or topics, bound to one of them, so that it takes only a message.

    Args:
        method: a method that takes the name of the sensor or topic, and a message.
        sensor: the name.
    """

    def __init__(self, method: Callable[[str, Any], object], sensor: str) -> None:
        update_wrapper(self, method)
        del vars(self)["__wrapped__"]  # its signature is a message only
        self._method, self._sensor = method, sensor

    def __call__(self, message: Any) -> object:
        return self._method(self._sensor, message)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, OfSensor) and (self._method, self._sensor) == (other._method, other._sensor)

    def __hash__(self) -> int:
        return hash((self._method, self._sensor))


class Target(NamedTuple):
    """A function that gets the messages of a topic, and its widget, if any. Functions of a program are not targets.

    With ``on_missed`` it gets every message instead of the newest, and ``on_missed`` gets the number of lost messages.
    ``on_replaced`` gets the number of messages that were replaced by the next one.
    """

    call: Callable[[Any], object]
    widget: SampleWidget | None
    on_missed: Callable[[int], object] | None = None
    on_replaced: Callable[[int], object] | None = None

    @property
    def is_primary(self) -> bool:
        """True for the main topic of the widget, False for a commanded speed next to a measured one, for example."""
        return self.widget is not None and self.title == "title"

    @property
    def title(self) -> str:
        """The trait in which the widget names the topic."""
        method = getattr(self.call, "__name__", "")
        return "title" if method == "update" else f"{method}_title"

    @property
    def is_of_sensor(self) -> bool:
        """True if the topic is one of several that the widget shows together."""
        return isinstance(self.call, OfSensor)

    @property
    def is_ours(self) -> bool:
        """True if it is code of this package, which the transport's thread and the thread that sends speeds may call.

        `FunctionCaller` calls methods that a user's widget class defines, as it calls functions.
        """
        return self.widget is None or str(getattr(self.call, "__module__", "")).partition(".")[0] == _PACKAGE


def _target_of(topic: str, given: Any) -> Target | Callable[[Any], object]:
    """Return the target for a widget or a method of a widget (`SpeedWidget.command`), or a function unchanged."""
    if _is_widget(given):
        update = getattr(given, "update", None)
        if callable(update):
            return _of_widget(topic, update, given)
    elif callable(given) and not isinstance(given, type):
        owner = getattr(given, "__self__", None)
        if _is_widget(owner):
            return _of_widget(topic, given, owner)
        function: Callable[..., object] = given
        _check_arguments(function)
        return function
    hint = f"; make one of it: {given.__name__}()" if isinstance(given, type) else ""
    if isinstance(given, DriveWidget):
        hint = "; a pad that drives is connected to a feed: pad.connect(feed)"
    raise TypeError(
        f"expected a widget, a method of one like speed.command, or a function of a message; got {given!r}{hint}"
    )


def _check_arguments(function: Callable[..., object]) -> None:
    """Raise TypeError if a function can be called neither with a message nor with a message and its time."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):  # some functions in C, such as `print`, have no signature
        return
    for given in ((None,), (None, 0)):
        with suppress(TypeError):
            signature.bind(*given)
            return
    name = getattr(function, "__name__", repr(function))
    raise TypeError(
        f"expected a function of a message, or of a message and the time at which it came; got {name}{signature}"
    )


def _is_widget(given: Any) -> TypeGuard[SampleWidget]:
    """Return True if it shows the messages of topics, as a kind of sensor or on request."""
    return isinstance(given, RobotWidget) or on_demand_row(type(given)) is not None


def _of_widget(topic: str, method: Callable[..., object], widget: SampleWidget) -> Target:
    row = on_demand_row(type(widget))
    if row is not None:
        call = OfSensor(method, topic) if row.shared else method
        return Target(
            call, widget, widget.miss if row.every_message else None, None if row.shared else _counter(widget)
        )
    role = role_of(type(widget), getattr(method, "__name__", ""))
    if role is not None and role.combine:
        return Target(OfSensor(method, sensor_of(topic)), widget)
    is_update = getattr(method, "__name__", "") == "update"
    return Target(method, widget, on_replaced=_counter(widget) if is_update else None)


def _counter(widget: SampleWidget) -> Callable[[int], object] | None:
    """Return the method with which a widget that shows a rate counts replaced messages, or None."""
    return widget.count_replaced if isinstance(widget, RobotWidget) else None


def sorted_targets(topic: str, targets: Sequence[Any]) -> tuple[list[Target], list[Callable[[Any], object]]]:
    """Return the targets of `connect` to a topic, separated into targets of widgets and functions."""
    every = [_target_of(topic, target) for target in targets]
    of_widgets = [one for one in every if isinstance(one, Target)]
    return of_widgets, [one for one in every if not isinstance(one, Target)]


class Subscription:
    """A topic, the targets of its messages, and its status.

    Args:
        topic: its name.
        now: the clock.

    Attributes:
        trouble: the reason why no message comes or can be read, as the middleware reports it.
        receives: True while messages come.
        has_received: True once a message has come.
    """

    def __init__(self, topic: str, now: Callable[[], float]) -> None:
        self.topic, self._now = topic, now
        self._since = now()
        """The earliest time at which messages could come, with a connection, a robot and the topic."""
        self._is_offered = self._is_of_sensor = False
        self._count, self._first_at, self._last_at = 0, 0.0, 0.0
        self._last: Any = None
        self.targets: tuple[Target, ...] = ()
        self.type = ""
        self.trouble = ""
        self.receives = False
        self.has_received = False
        self._retyped = ""
        self._failed = ""
        self._scanners = TwoScanners()
        self._log = LogOnce(lambda text: log_in_thread(text, sys.exc_info()[1]))

    @property
    def passes_each(self) -> bool:
        """True if a target gets every message."""
        return any(target.on_missed for target in self.targets)

    def take(self, message: Any, *, newest: bool = True, each: bool = True, replaced: int = 0) -> bool:
        """Pass a message to the targets that are ours. Return True if the status may have changed. Raises nothing.

        Args:
            message: the message.
            newest: True to pass it to the targets of the newest message.
            each: True to pass it to the targets of every message.
            replaced: the number of messages that this message replaced.
        """
        if newest:
            self._note(message)
        before = (self.receives, self._failed, self._scanners.status)
        takers = [one for one in self.targets if one.is_ours and (newest if one.on_missed is None else each)]
        for target in takers if replaced else ():
            if target.on_replaced is not None:
                target.on_replaced(replaced)
        failures = [self._pass_on(target, message) for target in takers]
        if newest:
            self._scanners.see(message)
        self._failed = next(filter(None, reversed(failures)), "")
        self.receives = self.has_received = True
        return before != (True, self._failed, self._scanners.status)

    def _note(self, message: Any) -> None:
        now = self._now()
        if not self._count:
            self._first_at = now
        self._count, self._last_at, self._last = self._count + 1, now, message

    @property
    def kept(self) -> tuple[Any, ...]:
        """The last message if its publisher keeps it for new subscribers, or nothing.

        This works for any middleware: a publisher is assumed to keep its last message if the first one came as soon as
        it was requested, and later ones rarely. A sensor's message is not kept, because a program may drive by it.
        """
        came_at_once = self._count and self._first_at - self._since < SOON
        is_rare = self._count == 1 or self._last_at - self._first_at > RARE * (self._count - 1)
        return (self._last,) if came_at_once and is_rare and self.receives and not self._is_of_sensor else ()

    def pass_kept(self, kept: tuple[Any, ...], targets: Sequence[Target]) -> None:
        """Pass the `kept` message to new targets, except targets of every message."""
        for message in kept:
            for target in targets:
                if target.is_ours and target.on_missed is None:
                    self._pass_on(target, message)

    def begin(self) -> None:
        """Note that messages can come from now on, because the robot is connected, perhaps again."""
        self._since, self._count, self._last = self._now(), 0, None

    def miss(self, count: int) -> None:
        """Report the number of lost messages to the targets of every message."""
        for target in self.targets:
            if target.on_missed is not None:
                target.on_missed(count)

    def update(self, topic: FeedTopic | None) -> None:
        """Update the type of the topic, or note that the topic is missing if None."""
        is_offered = topic is not None and topic.offered
        if not is_offered:
            self.receives = False
        elif not self._is_offered:
            self.begin()
        self._is_offered, self._is_of_sensor = is_offered, topic is not None and topic.widget is not None
        kind = topic.type if topic else ""
        if kind and self.type and kind != self.type:
            self._retyped = f"{self.topic} was {self.type} and is now {kind}"
        self.type = kind or self.type

    def status(self, topics: dict[str, FeedTopic] | None, *, is_primary: bool = True) -> str:
        """Return the problems of the topic, or empty.

        A topic that is not primary may stay silent: commanded speeds come only while the robot is driven.
        """
        if self.receives:
            several = f"{self.topic} is published as {self.type.replace(', ', ' and as ')}" if ", " in self.type else ""
            return "; ".join(
                filter(None, (self.trouble, self._failed, several or self._retyped, self._scanners.status))
            )
        topic = topics.get(self.topic) if topics is not None else None
        missing = self.why_missing(topics)
        if missing or self.trouble:
            return "; ".join(filter(None, (missing, self.trouble)))
        if not is_primary:
            return ""
        if topics is not None and (topic is None or not topic.offered):
            return f"{self.topic} has no publisher {'any more' if self.has_received else 'yet'}"
        return f"waiting for {self.topic}"

    def why_missing(self, topics: dict[str, FeedTopic] | None) -> str:
        """Return a text for a topic that does not exist and never did, or empty if it may exist."""
        is_missing = topics is not None and self.topic not in topics and not self.has_received
        return no_such(self.topic, topics) if topics is not None and is_missing else ""

    def _pass_on(self, target: Target, message: Any) -> str:
        """Call a target. Return its error as text, or empty if it raised none."""
        try:
            target.call(message)
        except (Exception, SystemExit) as error:  # otherwise the transport's thread and the feed would end
            failure = f"a message of {self.topic} could not be used: {type(error).__name__}: {error}"
            self._log(failure)
            return failure
        return ""
