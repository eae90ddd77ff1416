"""Conditions that are evaluated on everything that a robot sends."""

from __future__ import annotations

import inspect
import logging
import time
from collections import deque
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any, Protocol, TypeVar

import numpy as np

from ..behaviors.robot import DRIVEN, ODOMETRY, TURNED, NotReadyError
from ..kinds import KINDS, topic_and_field
from ..recordings.search.base import Condition, FunctionCondition, condition
from ..recordings.search.instant import NoSampleYetError
from ..runtime.log_once import LogOnce
from ..runtime.policies import CONDITION
from ..runtime.runner import Call, Runner
from ..runtime.user_function import name_of
from ..samples.staleness import LIVE, STEPS, is_steady, usual_step
from ..widget.watch import Watch
from ._program_inputs import FeedInputs
from ._topics import check_name

if TYPE_CHECKING:
    from ._connection import Connection

log = logging.getLogger("robowidgets")


class Reader(Protocol):
    """A reader of topics for a watch, until it is closed."""

    def close(self) -> None:
        """End the subscriptions."""


R = TypeVar("R", bound=Reader)


class FeedWatch(Watch):
    """A condition that is evaluated with each message of the topics that it reads. `Feed.watch` returns it.

    Args:
        connection: the connection of the feed.
        given: the condition or function.
        name: its name.
        topics: for parameters of the function, the topics that they are read from.

    Raises:
        TypeError: it is not a condition, reads an unknown name, or needs more than one moment.
    """

    def __init__(self, connection: Connection, given: Any, name: str, topics: Mapping[str, str]) -> None:
        super().__init__(name, _condition(given, topics), "moment", self._why_unknown)
        if "event" in self.condition.reads:
            raise TypeError(f"{self.condition}: an EventsWidget that is connected watches it: events.watch(condition)")
        self.connection, self._topics = connection, topics
        self._inputs: dict[str, FeedInputs] = {}
        """The readers of samples, by the name under which they are read."""
        self._messages: dict[str, _Newest] = {}
        self._began: dict[str, float] = {}
        """The first values of odometry, because metres and radians count from there."""
        self._missing: set[str] = set()
        """The names that could not be read in the last evaluation."""
        self._runner = Runner(self._turn, self._lock, "robowidgets-judge", CONDITION, on_look=lambda: None)
        self._log = LogOnce(log.error)
        try:
            for name in sorted(self.condition.reads):  # from its first message on
                with suppress(NoSampleYetError):
                    self.read(name) if name in self.names else self.message(
                        topic_and_field(name, self.topic_names())[0]
                    )
        except BaseException:
            self.end("it could not begin")
            raise
        connection.observe(self._on_change)
        self._wake_judge()

    @property
    def names(self) -> tuple[str, ...]:
        """The names that a moment has, in addition to topics."""
        return (*_known(), *self._topics)

    def topic_names(self) -> list[str]:
        """Return the topics that are known now."""
        return [topic.name for topic in self.connection.topics]

    def read(self, name: str) -> Any:
        """Return the newest value of one of the `names`, or the newest sample or message of a topic.

        Raises:
            NoSampleYetError: the value has not come yet, or is too old.
        """
        inputs = self._reader(name, self._inputs, self._make_inputs)
        try:
            value = inputs.take()[name]
        except NotReadyError:
            self._missing.add(name)
            raise NoSampleYetError(name) from None
        return value - self._began.setdefault(name, value) if name in (DRIVEN, TURNED) else value

    def message(self, topic: str) -> Any:
        """Return the newest message of a topic as received.

        Raises:
            NoSampleYetError: no message has come, or a topic with a steady rate sends no more.
        """
        newest = self._reader(topic, self._messages, self._make_newest)
        if newest.why_missing():
            self._missing.add(topic)
            raise NoSampleYetError(topic)
        return newest.message

    def judge(self, sample: Any) -> None:
        """See `Watch`. An unknown value before the first verdict is not counted."""
        super().judge(sample)
        if self._verdict.value is None and not self._changes:
            self._sample = None

    def end(self, reason: str) -> None:
        """See `Watch`."""
        super().end(reason)
        self.connection.unobserve(self._on_change)
        self._runner.detach()
        with self._lock:  # `_reader` adds none after the end
            readers: list[Reader] = [*self._inputs.values(), *self._messages.values()]
        for reader in readers:
            reader.close()

    def _reader(self, name: str, there: dict[str, R], make: Callable[[str], R]) -> R:
        """Return the reader of a name. It is made on the first read.

        Raises:
            NoSampleYetError: the watch has ended while its condition still runs.
        """
        reader = there.get(name)
        if reader is not None:
            return reader
        made = make(name)  # without the lock, because it subscribes
        with self._lock:
            kept = None if self._ended else there.setdefault(name, made)
        if kept is not made:
            made.close()
        if kept is None:
            raise NoSampleYetError(name)
        return kept

    def _make_inputs(self, name: str) -> FeedInputs:
        inputs = FeedInputs(self.connection, self._wake_judge, silence=LIVE, wakes_each=True)
        inputs.choose({name: self._topics.get(name, None if name in self.names else name)}, None)
        return inputs

    def _make_newest(self, topic: str) -> _Newest:
        return _Newest(self.connection, topic, self._wake_judge)

    def _wake_judge(self) -> None:
        if not self._why_off:
            self._runner.wake()

    def _on_change(self) -> None:
        """Evaluate it again, because topics may have appeared; end it if its feed is closed."""
        if self.connection.is_closed:
            self.end("its feed is closed")
        else:
            self._wake_judge()

    def _turn(self, call: Call) -> None:
        self._missing = set()
        call(self.judge, FeedMoment(self), of=self)
        if self.error:
            self._log(f"{self.name}: {self.error}", self.error)

    def _why_unknown(self) -> str:
        if self._runner.is_late:
            return f"has not returned for {self._runner.busy_for:.1f} s{self._runner.where(self.condition)}"
        inputs = {name: one.why_not_ready() for name, one in list(self._inputs.items())}
        messages = {topic: one.why_missing() for topic, one in list(self._messages.items())}
        is_known = self._verdict.value is not None  # then the missing values did not matter
        left_out = self._missing if is_known else ()
        return next((why for name, why in {**inputs, **messages}.items() if why and name not in left_out), "")


class FeedMoment:
    """The newest data of a robot: ``moment.scan``, ``moment.pose``, ``moment["/imu"]``. A value that was read stays.

    Attributes:
        messages: by topic, the newest message as received.
    """

    def __init__(self, watch: FeedWatch) -> None:
        self._watch = watch
        self._values: dict[str, Any] = {}
        self.messages = _Messages(watch)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__") or name not in self._watch.names:
            raise AttributeError(f"no {name!r} here: there are {', '.join(self._watch.names)} and moment[topic]")
        return self._value(name)

    def __getitem__(self, topic: str) -> Any:
        check_name(topic)
        return self._value(topic)

    def __dir__(self) -> list[str]:
        return [*self._watch.names, "messages"]

    def __repr__(self) -> str:
        read = {**self._values, **self.messages.read}
        return f"<moment: {', '.join(f'{name} {value!r}' for name, value in read.items()) or 'nothing was read'}>"

    def _value(self, name: str) -> Any:
        if name not in self._values:
            self._values[name] = self._watch.read(name)
        return self._values[name]


class _Messages(Mapping[str, Any]):
    """The newest message of each topic at a moment, as received."""

    def __init__(self, watch: FeedWatch) -> None:
        self._watch = watch
        self.read: dict[str, Any] = {}

    def __getitem__(self, topic: str) -> Any:
        if topic not in self.read:
            self.read[topic] = self._watch.message(topic)
        return self.read[topic]

    def __iter__(self) -> Iterator[str]:
        return iter(self._watch.topic_names())

    def __len__(self) -> int:
        return len(self._watch.topic_names())


class _Newest:
    """The newest message of a topic as received."""

    def __init__(self, connection: Connection, topic: str, wake: Callable[[], None]) -> None:
        self._connection, self._topic, self._on_message = connection, topic, wake
        self.message: Any = None
        self._times: deque[float] = deque(maxlen=STEPS)
        self._target = connection.attach(topic, self._put)

    def close(self) -> None:
        """Stop receiving messages."""
        self._connection.detach(self._topic, self._target)

    def why_missing(self) -> str:
        """Return why the message is missing or too old, or empty if there is a recent message."""
        times = np.array(self._times)
        if not times.size:
            return self._connection.status_of(self._topic) or f"waiting for {self._topic}"
        kind = self._connection.topic_of(self._topic).widget
        if not (KINDS[kind].goes_stale if kind else is_steady(times)):
            return ""
        if time.monotonic() - times[-1] <= LIVE.after(usual_step(times)):
            return ""
        return self._connection.status_of(self._topic) or f"no message comes on {self._topic} any more"

    def _put(self, message: Any) -> None:
        self.message = message
        self._times.append(time.monotonic())
        self._on_message()


def _known() -> tuple[str, ...]:
    return (*(kind.parameter for kind in KINDS.values()), *ODOMETRY)


def _condition(given: Any, topics: Mapping[str, str]) -> Condition:
    """Return the condition to evaluate. It may be a function of the values that its parameters name, or of a moment."""
    if isinstance(given, (Condition, Watch)) or not callable(given):
        if topics:
            raise TypeError(f"watch: {', '.join(topics)}: only parameters of a function can name topics")
        return condition(given)
    name = name_of(given)
    if inspect.iscoroutinefunction(given):
        raise TypeError(f"watch: expected a plain function, got the coroutine function {name}")
    asked = [
        one.name
        for one in inspect.signature(given).parameters.values()
        if one.default is one.empty and one.kind in (one.POSITIONAL_ONLY, one.POSITIONAL_OR_KEYWORD)
    ]
    if unused := [one for one in topics if one not in asked]:
        raise TypeError(f"watch: {unused[0]}={topics[unused[0]]!r} names a topic, but {name} has no such parameter")
    if asked and set(asked) <= {*_known(), *topics}:
        return FunctionCondition(given, asked)
    if len(asked) != 1:
        raise TypeError(
            f"watch: expected a function of {', '.join(_known())}, of parameters for which topics are named, as in "
            f"watch(function, imu='/imu'), or of one moment; {name} takes {', '.join(asked) or 'nothing'}"
        )
    return FunctionCondition(given, ())
