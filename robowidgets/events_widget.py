"""The events of a robot as a list over time: log lines, changed statuses, pressed buttons and others."""

from __future__ import annotations

import json
import struct
import time
from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import inf
from typing import Any, ClassVar

import traitlets

from .behaviors.machine import Fired, Machine
from .behaviors.programs import Programs
from .behaviors.version import Version
from .messages.event import EventReader
from .messages.fields import MISSING
from .runtime.text import many
from .samples.age import note_arrival
from .samples.checks import finite
from .samples.event import Event, Level, to_level
from .samples.event_log import EventLog, EventRow
from .samples.staleness import LIVE
from .samples.state_span import spelled
from .widget.base_widget import refuse_unnamed
from .widget.front_end import bundle
from .widget.pacer import pacer
from .widget.robot_widget import RobotWidget
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import bytes_trait

MOST_ROWS = 2000
"""The most rows of a live list; the oldest are dropped."""

MOST_TEXT = 2000
"""The most characters of a text that the page gets."""

MOST_CHARACTERS = 400_000
"""The most characters of all texts that the page gets."""

_FRAME = struct.Struct("<dd")
"""After the header: seconds of the moment on show, and the number of rows up to it (infinity: decided by the time)."""

_SPACING = 1.0
"""The shortest time in seconds between two sends of all rows. New rows are sent with each frame."""

_FEW = 50
"""The most new rows that are sent repeatedly before all rows are sent."""

_BY_NAME = 'update("/rosout", message), update(message), or add("it hit the wall", level="WARN")'


class EventsWidget(RobotWidget[Event]):
    """The events of a robot as a list on a time axis: log lines, changed statuses, texts, buttons, touches.

    Each row shows the time, the level as a sign and a word, the source, and the text in one line that unfolds. Equal
    rows in sequence are merged, with their number. The list can be filtered by level and by words. In the player of a
    recording a click goes to the moment. Space freezes. All this works without the kernel. If a message cannot be read,
    the list does not change, with the reason above it.

    A live list keeps the newest 2,000 rows, and the first 2,000 characters of each text. It shows what it left out.

    Args:
        title: title in the header; usually the topics.
        level: the lowest level on show, one of "DEBUG", "INFO", "WARN", "ERROR", "FATAL". The view writes it, too.
        words: words, to show only rows with them in text, source or topic. The view writes it, too.
        time: the time cursor in seconds, or None at the newest row. A player and the view write it.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: rcl_interfaces/Log, rosgraph_msgs/Log, diagnostic_msgs/DiagnosticArray, sensor_msgs/Joy, std_msgs/String.

    Examples:
        >>> events = EventsWidget(title="robot")
        >>> events.add("lost the line", level="WARN", source="follower")
        >>> events.update("/chatter", {"data": "hello"})
        >>> [row.text for row in events.rows]
        ['lost the line', 'hello']
    """

    _esm, _css = bundle("events_widget")
    _meant: ClassVar = {"filter": "words", "text": "words", "levels": "level", "search": "words"}
    _instead: ClassVar = {"events": "widget.rows", "log": "widget.rows", "append": "widget.add(text)"}

    column = "narrow"
    sample_name = "event"
    goes_stale = False
    beats = True
    send_interval = 0.2

    level = traitlets.Enum(
        list(Level.__members__), "DEBUG", help="The lowest level on show. Python and the view write it."
    ).tag(sync=True)
    words = traitlets.Unicode(
        help="Words in the rows on show, or empty for all rows. Python and the view write it."
    ).tag(sync=True)
    time = traitlets.Float(
        None, allow_none=True, help="The time cursor in seconds. A player and the view write it."
    ).tag(sync=True)

    _old = bytes_trait(echo_update=False)
    _new = bytes_trait(echo_update=False)
    _span = traitlets.List(
        traitlets.Float(), help="Start and end of the recording in seconds, or empty for a live list."
    ).tag(sync=True, echo_update=False)
    _start = traitlets.Float(
        None, allow_none=True, help="Seconds since the epoch at second 0, or None to show seconds."
    ).tag(sync=True, echo_update=False)

    _programs: Programs | None = None

    def __init__(self, **kwargs: Any) -> None:
        self._log = EventLog(MOST_ROWS, MOST_TEXT, MOST_CHARACTERS)
        self._readers: dict[str, EventReader] = {}
        self._began: float | None = None
        self._missed = 0
        self._packed_until = 0
        """The number of the first row that is sent with each frame."""
        self._all_due = 0.0
        self._is_new = False
        self._version: Version | None = None
        self._fired: Fired | None = None
        """The last transition of the machine in the list."""
        self._program_error = ""
        self._reported = -1
        """The number of the last report about an assistant in the list."""
        self._whole: tuple[EventRow, ...] = ()
        """The rows of a recording."""
        self._notes: tuple[str, ...] = ()
        """Notes on the events of a recording, shown at each moment of it."""
        super().__init__(**kwargs)

    def update(self, topic: Any = None, message: Any = MISSING, *unnamed: Any) -> None:
        """Add the events in a message to the list.

        It only stores the events, and may be called from any thread at any rate. For DiagnosticArray, Joy and touch
        sensors, each change on a topic is an event.

        Args:
            topic: the name of the topic; or the message, if it is the only argument.
            message: text, a std_msgs/String, rcl_interfaces/Log, rosgraph_msgs/Log, diagnostic_msgs/DiagnosticArray,
                sensor_msgs/Joy or a message of touch sensors, of rclpy, rospy, rosbags or rosbridge; a moment of a
                recording; or an `Event`.
            *unnamed: raises an error with the possible calls.

        Raises:
            TypeError: not such a message. ValueError: a number in it is not a number. A callback (another thread; a
                task, timer or button of a notebook) raises nothing; the widget and the log show the error.
        """
        try:
            refuse_unnamed("update", unnamed, _BY_NAME)
            if message is MISSING:
                topic, message = "", topic
            if not isinstance(topic, str) or message is None:
                raise TypeError(f"update() takes a message, after the name of its topic if it has one: {_BY_NAME}")
            seconds = None
            if hasattr(message, "time_ns") and hasattr(message, "sample"):
                topic, seconds, message = message.topic, float(message.seconds), message.sample
            with self._newest.lock:
                reader = self._readers.get(topic) or self._readers.setdefault(topic, EventReader(topic))
                now = time.monotonic_ns()
                for at, event in reader.read(message, now if seconds is None else round(1e9 * seconds)):
                    self._put(event, self._seconds(at) if seconds is None else at / 1e9)
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def add(self, text: str, *, level: str | int = "INFO", source: str = "", time: float | None = None) -> None:
        """Add an event by hand.

        Args:
            text: the event.
            level: "DEBUG", "INFO", "WARN", "ERROR" or "FATAL".
            source: the name of the source.
            time: seconds, not before the last event; now by default.

        Raises:
            TypeError, ValueError: not a text, not a level, or not a time. A callback raises nothing; the widget and the
                log show the error.
        """
        try:
            if not isinstance(text, str) or not isinstance(source, str):
                raise TypeError(f"add(): expected text, got {text if not isinstance(text, str) else source!r}")
            event = Event(text, to_level("level", level), source)
            with self._newest.lock:
                self._put(event, self._seconds(_now_ns()) if time is None else finite("time", time, "seconds"))
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def follow(self, feed: Any) -> None:
        """Add the events of a robot's program to the list: its versions, the states of its machine, and its errors.

        The commands of an assistant that drives the robot are added, too.

        Args:
            feed: the feed. In `Feed.show` a list of events follows the program by itself.

        Raises:
            TypeError: it is not a feed.
        """
        programs = getattr(feed, "programs", None)
        if not isinstance(programs, Programs):
            raise TypeError(f"follow(): expected a feed, got {feed!r}")
        self._leave_program()
        self._programs, self._reported = programs, -1
        programs.observe(self._on_step)
        self._on_step()

    def close(self) -> None:
        """Remove the widget from the page."""
        self._leave_program()
        super().close()

    def clear(self) -> None:
        """Empty the list."""
        with self._newest.lock:
            self._log.clear()
            self._missed = self._packed_until = 0
            self._is_new, self._all_due = True, 0.0
        pacer.mark(self)

    @property
    def rows(self) -> tuple[EventRow, ...]:
        """The rows of the list, without the filter. Equal events in sequence are one row. Frozen while paused.

        In the player of a recording, these are all rows of the recording.
        """
        if self.shows_whole:
            return self._whole
        stop = inf
        if self.paused and self._frozen_frame:
            _, stop = _FRAME.unpack_from(self._frozen_frame, FRAME_HEADER.size)
        with self._newest.lock:
            return tuple(row for row in self._log.rows if row.number < stop)

    @property
    def frozen(self) -> tuple[EventRow, ...] | None:
        """The rows on show while frozen, or None while live."""
        return self.rows if self.paused else None

    def miss(self, count: int) -> None:
        """Show that so many messages came too fast, and are not in the list."""
        with self._newest.lock:
            self._missed += count
        self._say_more()

    @property
    def shows_whole(self) -> bool:
        """True if it shows the events of a recording, in a player."""
        return bool(self._span)

    def show_whole(self, rows: Sequence[EventRow], end: float, notes: Sequence[str] = ()) -> None:
        """Show the events of a recording that ends at ``end`` seconds. A player then shows one moment of it."""
        self._whole, self._span, self._notes = tuple(rows), [0.0, end], tuple(notes)
        self._old = _packed(rows)

    def show_moment(self, seconds: float) -> None:
        """Make `wait` return the last event up to a time of a recording."""
        rows = [row for row in self._whole if row.seconds <= seconds]
        if rows:
            self._show(_event_of(rows[-1]))

    def within(self, start: float, end: float) -> dict[str, Any]:
        """See `RobotWidget`."""
        rows = [row for row in self._whole if row.until >= start and row.seconds <= end]
        return {"_old": _packed(rows), "_span": [start, end]}

    def frame_at(self, seconds: float) -> tuple[dict[str, Any], bytes]:
        """Return the texts and the frame without the header, for a player at a time."""
        return ({"notes": [*self._notes]} if self._notes else {}), _FRAME.pack(seconds, inf)

    def _leave_program(self) -> None:
        if self._programs is not None:
            self._programs.unobserve(self._on_step)
            self._programs = None

    def _on_step(self) -> None:
        """Add the events of the program since the last call. The thread of the program usually calls this."""
        programs = self._programs
        if programs is None:
            return
        with self._newest.lock:
            for number, text in list(programs.reports):
                if number > self._reported:
                    self._reported = number
                    self._put(Event(text, source="assistant"), self._seconds(time.monotonic_ns()))
        program = programs.current
        if program is None:
            return
        with self._newest.lock:
            version, error = program.version, program.error
            said = []
            if version is not self._version:
                change = f": {version.change}" if version.change else ""
                said.append(Event(f"version {version.number}{change}", source=program.name))
            machine = version.function
            if isinstance(machine, Machine):
                fired = machine.last_step.fired
                seen = fired.index(self._fired) + 1 if self._fired in fired else 0
                said += [Event(f"→ {move.target}", source=spelled(move.machine)) for move in fired[seen:]]
                self._fired = fired[-1] if fired else None
            if error and error != self._program_error:
                said.append(Event(error, Level.ERROR, program.name))
            self._version, self._program_error = version, error
            for event in said:
                self._put(event, self._seconds(time.monotonic_ns()))

    # -- for the base --------------------------------------------------------------------------------------------------

    def _put(self, event: Event, seconds: float) -> None:
        """Add an event. Called with the lock of the samples."""
        rows = self._log.rows
        if rows and seconds < rows[-1].until:
            seconds = rows[-1].until  # from another topic, or after the clock was set
        self._log.add(event, seconds)
        self._is_new = True
        self._show(event)

    def _seconds(self, at_ns: int) -> float:
        """Return the seconds of a monotonic time since the first event."""
        if self._began is None:
            self._began = at_ns / 1e9
            self._start = time.time()
        return max(0.0, at_ns / 1e9 - self._began)

    def _describe(self) -> str:
        rows = self.rows
        if not rows:
            return ""
        last = rows[-1]
        return f"{many(sum(row.count for row in rows), 'event')}, the last: {last.level.name} {last.text[:60]}"

    def _longest_silence(self) -> float:
        """Return the longest time, because events have no rate."""
        return LIVE.longest

    def _pack(self, sample: Event) -> bytes:  # noqa: ARG002  # the list contains it
        rows = self._log.rows
        return _FRAME.pack(rows[-1].until if rows else 0.0, self._log.stop)

    def _unpack(self, frame: bytes) -> Event:
        _, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
        rows = self.rows
        event = replace(_event_of(rows[-1]), stamp_ns=stamp_ns or None) if rows else Event("")
        note_arrival(event, arrived)
        return event

    def _texts_now(self) -> dict[str, Any]:
        said: dict[str, Any] = {"older": self._log.first} if self._log.first else {}
        if self._missed:
            said["notes"] = [f"{many(self._missed, 'message')} came too fast, and are not in the list"]
        return said

    def _bring_up_to_date(self) -> None:
        """Send new rows with the newest frame, and from time to time all rows."""
        if self._began is not None:
            self._end_touches()
        super()._bring_up_to_date()
        with self._newest.lock:
            if not self._is_new or self.driven_by_player:
                return
            self._is_new = False
            rows = self._log.rows
            now = time.monotonic()
            values = self._trait_values
            if self._log.stop - self._packed_until > _FEW and now >= self._all_due:
                # All but the last row, which the next event may repeat.
                self._packed_until, self._all_due = max(0, self._log.stop - 1), now + _SPACING
                values["_old"] = _packed(row for row in rows if row.number < self._packed_until)
                self._unsent.add("_old")
            elif not rows:
                values["_old"] = b""
                self._unsent.add("_old")
            values["_new"] = _packed(row for row in rows if row.number >= self._packed_until)
            self._unsent.add("_new")

    def _end_touches(self) -> None:
        """Add the ends of touches without a message, and schedule a send at the next end."""
        with self._newest.lock:
            now = time.monotonic_ns()
            for reader in self._readers.values():
                for at, event in reader.due(now):
                    self._put(event, self._seconds(at))
            ends = [end for reader in self._readers.values() if (end := reader.next_due_ns) is not None]
        pacer.mark_at(self, min(ends) / 1e9 if ends else None)


def _now_ns() -> int:
    """Return the monotonic time, for a method with an argument named time."""
    return time.monotonic_ns()


def _event_of(row: EventRow) -> Event:
    return Event(row.text, row.level, row.source, row.topic)


def _packed(rows: Iterable[EventRow]) -> bytes:
    """Return rows as JSON, for the page."""
    return json.dumps([(*row,) for row in rows]).encode()
