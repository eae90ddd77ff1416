"""The wires of a running robot: who publishes and subscribes to what, and what the notebook does with it."""

from __future__ import annotations

import threading
from collections.abc import Collection, Iterable
from functools import partial
from math import isfinite
from typing import Any

from .._core.clock import Scheduler
from .._core.clock import scheduler as threads
from .._core.observed import Observed
from .._core.rate import RateMeter
from .._core.text import many
from ..behaviors.machine import Machine
from ..behaviors.program import ENDED, Program
from ..message_widget import MessageWidget
from ..messages.brief import brief
from ..messages.infrastructure import is_infrastructure, is_large
from ..samples import Speed
from ..wires_widget import NotebookPart, Wire, Wiring
from ._connection import Connection
from ._subscription import Target
from ._topics import FeedTopic, sample_of, unlisted
from .middleware import FeedError

PERIOD = 0.5
"""Seconds between two looks at the wires."""

SEEN_FOR = 40.0
"""Seconds for which it counts that a page shows the wires. A page says so every ten."""

MOST_HEARD = 60
"""Topics that are listened to, beside those that are connected to something."""


_MOST_GOT = 120
"""Characters for all that a step got."""


class _Heard:
    """The messages of a topic, as far as they are counted and the last one is kept."""

    def __init__(self) -> None:
        self.target: Target | None = None
        self.count, self.came_at, self.message = 0, 0.0, None
        self.rate: float | None = None
        self._meter = RateMeter()

    def measure(self) -> None:
        """Measure the rate; again and again, since the meter sees the counter only then."""
        rate = self._meter.rate(self.count, self.came_at)
        self.rate = round(rate, 2) if isfinite(rate) else None


class FeedWires(Observed):
    """The wires of a feed, for its widget: see `robowidgets.wires_widget.WiresSource`.

    It listens to topics, and has the middleware ask for nodes, while somebody looks, and for a moment after that.

    Args:
        connection: that of the feed.
        scheduler: has the time.
    """

    def __init__(self, connection: Connection, scheduler: Scheduler = threads) -> None:
        super().__init__()
        self._connection, self._scheduler = connection, scheduler
        self._now = scheduler.clock.now
        self._lock = threading.RLock()
        self._heard: dict[str, _Heard] = {}
        self._seen_until = float("-inf")
        self._ticks = False

    @property
    def name(self) -> str:
        """See `WiresSource`."""
        return self._connection.where

    @property
    def robot(self) -> str:
        """See `WiresSource`."""
        return self._connection.page_name

    @property
    def status(self) -> str:
        """See `WiresSource`."""
        return self._connection.status

    def look(self, is_seen: bool) -> None:
        """See `WiresSource`."""
        with self._lock:
            self._seen_until = self._now() + SEEN_FOR if is_seen else float("-inf")
            if not is_seen or self._ticks:
                return
            self._ticks = True
        self._scheduler.call_at(self._now(), self._tick)

    def show(self, topic: str, widget: MessageWidget) -> None:
        """See `WiresSource`."""
        self._connection.connect(topic, widget)

    def hide(self, topic: str, widget: MessageWidget) -> None:
        """See `WiresSource`."""
        self._connection.disconnect(topic, widget)

    @property
    def wiring(self) -> Wiring:
        """See `WiresSource`."""
        connection = self._connection
        topics = {topic.name: topic for topic in connection.topics}
        publishers: dict[str, set[str]] = {}
        subscribers: dict[str, set[str]] = {}
        unasked = 0
        for advert in connection.adverts:
            publishers.setdefault(advert.name, set()).update(advert.publishers or ())
            subscribers.setdefault(advert.name, set()).update(advert.subscribers or ())
            unasked += advert.subscribers is None
        tells = any(map(any, (publishers.values(), subscribers.values())))
        connected = connection.connected
        parts = tuple(self._parts(connected))
        named = {name for part in parts for name in (*part.reads, *part.writes)} - topics.keys()
        everything = [*topics.values(), *(unlisted(name)._replace(offered=False) for name in sorted(named))]
        wires = [
            self._wire(topic, publishers.get(topic.name, ()), subscribers.get(topic.name, ())) for topic in everything
        ]
        note = ""
        if not tells and topics:
            note = "the robot tells no nodes: topics alone"
        elif tells and unasked:
            asked = len(connection.adverts) - unasked
            note = f"asking who publishes what: {asked} of {many(len(connection.adverts), 'topic')} so far"
        return Wiring(tuple(wires), parts, tells, note)

    def _tick(self) -> None:
        """Listen to what is to be seen, and have it shown; or end that. In the thread of timers."""
        with self._lock:
            is_seen = self._now() < self._seen_until and not self._connection.is_closed
            self._ticks = is_seen
        try:
            self._connection.middleware.ask_for_nodes(is_seen)
            self._hear(self._wanted() if is_seen else ())
        except FeedError:  # it was closed meanwhile, and says so
            pass
        for heard in self._heard.values():
            heard.measure()
        self._call_observers()
        if is_seen:
            self._scheduler.call_at(self._now() + PERIOD, self._tick)

    def _wanted(self) -> list[str]:
        """The topics to listen to: small ones, and those that are listened to anyway."""
        topics, connected = self._connection.topics, self._connection.connected
        used = {function.topic for function in self._connection.functions.functions}
        for name, targets in connected.items():
            heard = self._heard.get(name)
            if any(heard is None or target is not heard.target for target in targets):
                used.add(name)
        small = [topic.name for topic in topics if topic.name not in used and _is_small(topic)]
        return [topic.name for topic in topics if topic.name in used] + small[:MOST_HEARD]

    def _hear(self, wanted: Iterable[str]) -> None:
        names = set(wanted)
        for name in self._heard.keys() - names:
            heard = self._heard.pop(name)
            if heard.target is not None:
                self._connection.detach(name, heard.target)
        for name in names - self._heard.keys():
            self._heard[name] = heard = _Heard()
            heard.target = Target(partial(self._take, heard), None)
            self._connection.attach_target(name, heard.target)

    def _take(self, heard: _Heard, message: Any) -> None:
        """Keep a message. In the thread of the transport."""
        heard.count, heard.came_at, heard.message = heard.count + 1, self._now(), message

    def _wire(self, topic: FeedTopic, publishers: Collection[str], subscribers: Collection[str]) -> Wire:
        wire = Wire(
            topic.name,
            topic.type,
            tuple(sorted(publishers)),
            tuple(sorted(subscribers)),
            topic.offered,
            topic.wanted,
            is_infrastructure=is_infrastructure(topic.name),
        )
        heard = self._heard.get(topic.name)
        if heard is None:
            return wire
        note = self._connection.trouble_of(topic.name)
        if not heard.count:
            return wire._replace(is_heard=True, note=note)
        return wire._replace(
            is_heard=True,
            rate=heard.rate,
            value=_brief(heard.message, topic),
            age=round(self._now() - heard.came_at, 2),
            note=note,
        )

    def _parts(self, connected: dict[str, tuple[Target, ...]]) -> Iterable[NotebookPart]:
        connection = self._connection
        watchdog = connection.watchdog
        for function in connection.functions.functions:
            drives = watchdog in function.driven
            got, gave = ("", "") if not function.runs else (_brief(function.got, None), brief(function.gave))
            yield NotebookPart(
                "function", function.name, (function.topic,), (), drives, function.runs, got, gave, function.problem
            )
        reads: dict[Any, list[str]] = {}
        for name, targets in connected.items():
            for target in targets:
                if target.widget is not None:
                    reads.setdefault(target.widget, []).append(name)
        for widget, names in reads.items():
            yield NotebookPart("widget", type(widget).__name__, tuple(names))
            for watch in list(getattr(widget, "watched", {}).values()):
                verdict = watch.verdict
                said = {True: "true", False: "false", None: "unknown"}[watch.value]
                gave = ": ".join(filter(None, (said, verdict.text)))
                got = "" if watch.sample is None else brief(watch.sample)
                yield NotebookPart("condition", watch.name, tuple(names), (), False, watch.runs, got, gave, watch.error)
        program = connection.programs.current
        if program is not None and program.mode != ENDED:
            yield _part_of(program)
        if connection.sent_count:
            topic, count = connection.driver.topic, connection.sent_count
            sent = brief(watchdog.sent.as_speed)
            yield NotebookPart("speeds", "speeds", writes=(topic,), runs=count, got=watchdog.driver, gave=sent)


def _part_of(program: Program) -> NotebookPart:
    function = program.version.function
    state = f"{function.active_text}: " if isinstance(function, Machine) else ""
    got = ", ".join(f"{name} {_brief(value, None)}" for name, value in program.got.items())
    drive = program.returned
    speed = brief(Speed((drive.linear, drive.lateral, 0.0), (0.0, 0.0, drive.angular)))
    gave = f"{state}{'as before, ' if program.kept else ''}{speed}" if program.steps else ""
    problem = program.error or program.waiting
    return NotebookPart(
        "program", program.name, program.topics, (), True, program.steps, got[:_MOST_GOT], gave, problem
    )


def _is_small(topic: FeedTopic) -> bool:
    is_known = topic.offered and topic.type and not is_infrastructure(topic.name)
    return bool(is_known) and not is_large(topic.type)


def _brief(message: Any, topic: FeedTopic | None) -> str:
    """A message in a few words, as the sample in it where there is one."""
    try:
        return brief(message if topic is None else sample_of(message, topic))
    except (TypeError, ValueError):
        return brief(message)
