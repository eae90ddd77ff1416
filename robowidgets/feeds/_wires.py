"""The graph of a running robot: publishers and subscribers of each topic, and the parts of the notebook that use it."""

from __future__ import annotations

from collections.abc import Collection, Iterable
from contextlib import suppress
from typing import Any

from ..behaviors.machine import Machine
from ..behaviors.program import ENDED, Program
from ..message_widget import MessageWidget
from ..messages.brief import brief
from ..messages.infrastructure import is_infrastructure
from ..runtime.text import many
from ..samples import Speed
from ..widget.observed import Observed
from ..wires_widget import NotebookPart, Wire, Wiring
from ._connection import Connection
from ._subscription import Target
from ._topics import FeedTopic, brief_of, unlisted
from .middleware import FeedError

_MOST_GOT = 120
"""The largest number of characters for the inputs of a step."""


class FeedWires(Observed):
    """The graph of a feed, for its widget. See `robowidgets.wires_widget.WiresSource`.

    It follows topics, and makes the middleware request nodes, while the widget is in view and for a moment after that.

    Args:
        connection: the connection of the feed.
    """

    def __init__(self, connection: Connection) -> None:
        super().__init__()
        self._connection = connection

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
        self._connection.listening.look(self._on_update, self._topics_to_follow if is_seen else None)

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
            note = "the robot does not report nodes, only topics"
        elif tells and unasked:
            asked = len(connection.adverts) - unasked
            note = f"requesting publishers and subscribers: {asked} of {many(len(connection.adverts), 'topic')} so far"
        return Wiring(tuple(wires), parts, tells, note)

    def _on_update(self, is_seen: bool) -> None:
        """Show the newest values, or end that. It runs in the thread of timers."""
        with suppress(FeedError):  # the feed was closed in the meantime, and reports it itself
            self._connection.middleware.ask_for_nodes(is_seen)
        self._call_observers()

    def _topics_to_follow(self) -> list[str]:
        """Return the topics to follow. Topics that every node has are followed only if another target gets them."""
        topics, used = self._connection.topics, self._connection.listening.used
        others = [topic.name for topic in topics if topic.name not in used and not is_infrastructure(topic.name)]
        return [*used, *others]

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
        listening = self._connection.listening
        stats = listening.of(topic.name)
        if stats is None:
            return wire
        note = self._connection.trouble_of(topic.name)
        if not stats.count:
            return wire._replace(is_heard=True, note=note)
        return wire._replace(
            is_heard=True,
            rate=stats.rate,
            value=brief_of(stats.message, topic),
            age=stats.age(listening.now),
            is_glanced_at=not stats.shows_silence,
            note=note,
        )

    def _parts(self, connected: dict[str, tuple[Target, ...]]) -> Iterable[NotebookPart]:
        connection = self._connection
        watchdog = connection.watchdog
        for function in connection.functions.functions:
            drives = watchdog in function.driven
            got, gave = ("", "") if not function.runs else (brief_of(function.got, None), brief(function.gave))
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
    got = ", ".join(f"{name} {brief_of(value, None)}" for name, value in program.got.items())
    drive = program.returned
    speed = brief(Speed((drive.linear, drive.lateral, 0.0), (0.0, 0.0, drive.angular)))
    gave = f"{state}{'as before, ' if program.kept else ''}{speed}" if program.steps else ""
    problem = program.error or program.waiting
    return NotebookPart(
        "program", program.name, program.topics, (), True, program.steps, got[:_MOST_GOT], gave, problem
    )
