"""A black box: the last minute of a robot, written to a file when something happens."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..behaviors.program import FAILED
from ..messages.event import SEVERE_TYPES, EventReader
from ..notebook.cells import take_the_place
from ..recordings.ring import saved_files
from ..recordings.ring_writer import Finder, FoundCause, RingLimits, RingWriter
from ..runtime.text import many
from ..samples.checks import finite
from ..samples.event import Level
from ..touch.row import TOUCH
from ..widget.watching import check_watch_name, default_name
from ._feed_watch import FeedWatch
from ._tap import FeedTap, is_shown
from ._topics import FeedTopic
from .middleware import FeedError

if TYPE_CHECKING:
    from ._connection import Connection

STOP = "Stop"
_TF = "tf2_msgs/msg/TFMessage"
_TOUCHED = "touched"
_LONGEST = 200
"""Characters of a cause."""


class BlackBox(FeedTap):
    """The last minute of a robot on the disk, and a file for each thing that happens. `Feed.black_box` returns it.

    It begins a file at a bump, Stop, an error that the robot reports, a lost connection, an error of the program, a
    condition that becomes true, and a call of `save`. The file appears some seconds later, so that it contains what
    follows, and has each cause as a mark. There are at most four files a minute: causes in between share one, unless
    the last minute has too many bytes to wait.

    Args:
        connection: the connection of the feed.
        topics: names of topics, or none for the topics that widgets show.
        when: conditions by name.
        folder: the folder of the files.
        limits: what it keeps.
        earlier: the black box that this one replaces, once it is complete.

    Attributes:
        folder: the folder of the files.
        refresh: takes topics that have appeared. The feed calls it.
    """

    _writer: RingWriter

    def __init__(
        self,
        connection: Connection,
        topics: tuple[str, ...],
        when: Mapping[str, Any],
        folder: Path,
        limits: RingLimits,
        earlier: BlackBox | None,
    ) -> None:
        self.folder, self._limits = folder, limits
        self._readers: dict[str, EventReader] = {}
        self._events_of: dict[str, bool] = {}
        """By topic of which events are causes, True for touches and False for errors."""
        self._is_stopped = connection.watchdog.stopped
        self._is_lost = bool(connection.status)
        self._failed = ""
        self._is_ready = False
        """True while the screen shows its state: not before it is complete."""
        self._shown_unjudged: tuple[str, ...] = ()
        finder = Finder(self._causes_in, self._on_second, self._show)
        writer = RingWriter(folder, limits, finder, connection.clock)
        super().__init__(connection, writer, topics)
        self._triggers: list[_Trigger] = []
        try:
            self._begin()
            connection.observe(self._on_connection)
            connection.watchdog.observe(self._on_stop)
            for name, condition in when.items():
                self._triggers.append(_Trigger(connection, condition, name, writer.add_cause))
        except BaseException:
            self.close()
            raise
        take_the_place(self)  # a wrong call leaves the earlier one as it is
        if earlier is not None:
            earlier.close()
        self._is_ready = True
        self._show()

    @property
    def files(self) -> tuple[Path, ...]:
        """The files of black boxes in the folder, oldest first."""
        return tuple(saved_files(self.folder))

    @property
    def problems(self) -> tuple[str, ...]:
        """The messages that it misses, failures of the disk, and conditions that are not judged, one line each."""
        return (*super().problems, *self._unjudged)

    @property
    def _unjudged(self) -> tuple[str, ...]:
        """The conditions that are not judged now, with the reasons."""
        return tuple(f"{one.name}: {why}" for one in list(self._triggers) if (why := one.why_not_judged))

    def save(self, cause: str = "a call") -> None:
        """Write a file for a cause of your own, some seconds later; return at once.

        Args:
            cause: plain text, which marks the moment in the file.

        Raises:
            TypeError, ValueError: the cause is not text, or empty or too long.
            FeedError: the black box is closed.
        """
        if not isinstance(cause, str):
            raise TypeError(f"save: expected a cause as text, got {cause!r}")
        text = " ".join(cause.split())
        if not 0 < len(text) <= _LONGEST:
            raise ValueError(f"save: expected a cause of 1 to {_LONGEST} characters, got {cause!r}")
        if self._closed or self._connection.is_forked:
            why = "belongs to the parent of this forked process" if self._connection.is_forked else "is closed"
            raise FeedError(f"the black box {why}: call black_box() of a feed again")
        self._writer.add_cause(text)

    def close(self) -> None:
        """Keep nothing more, and write the file that is due. Calling it again completes what an interrupt cut short.

        It waits for the disk for at most two seconds.
        """
        self._closed = True
        if self._connection.is_forked:  # the parent keeps on
            return
        self._connection.unobserve(self._on_connection)
        self._connection.watchdog.unobserve(self._on_stop)
        for trigger in self._triggers:
            trigger.end("the black box is closed")
        if self._is_ready:
            self._connection.show_black_box("")
            self._is_ready = False
        self._leave()

    def __repr__(self) -> str:
        lines = [f"{self._line}, in {self.folder}", *(f"⚠ {problem}" for problem in self.problems)]
        return "\n".join(lines)

    @property
    def _line(self) -> str:
        """The state in one line."""
        if self._closed:
            return f"black box: closed, {many(len(self.files), 'file')}"
        if self._writer.trouble:
            return "black box: in trouble"
        seconds = self._writer.kept if self._writer.is_cut_short else self._limits.seconds
        less = f" of {self._limits.seconds:g} s, which need more megabytes" if self._writer.is_cut_short else ""
        return f"black box: last {seconds:.4g} s{less}, {many(len(self.files), 'file')}"

    def _show(self) -> None:
        """Show the files and the troubles."""
        if self._is_ready and not self._closed:
            troubles = tuple(f"black box: {line}" for line in (*self._writer.trouble, *self._shown_unjudged))
            self._connection.show_black_box(self._line, troubles)

    def _on_second(self) -> None:
        """Take the topics that widgets show now, and show the conditions that are not judged."""
        self.refresh()
        unjudged = self._unjudged
        if unjudged != self._shown_unjudged:
            self._shown_unjudged = unjudged
            self._show()

    # -- in the threads of the feed and of the program: they never wait ------------------------------------------------

    def _is_wanted(self, topic: FeedTopic) -> bool:
        is_touch = topic.widget == TOUCH.name
        if is_touch or topic.type in SEVERE_TYPES:
            self._events_of[topic.name] = is_touch
            return True
        chosen = self._names or self._on_screen
        is_chosen = topic.name in chosen if chosen else is_shown(topic)
        return is_chosen or topic.commanded or topic.type == _TF

    @property
    def _on_screen(self) -> set[str]:
        """The topics that widgets show."""
        connected = self._connection.connected.items()
        return {topic for topic, targets in connected if any(target.widget is not None for target in targets)}

    def _refresh(self) -> None:
        super()._refresh()
        if self._closed or self._names:
            return
        there = {topic.name: topic for topic in self._connection.topics}
        for name in [name for name in self._targets if name in there and not self._is_wanted(there[name])]:
            self._connection.detach(name, self._targets.pop(name))

    def _on_stop(self) -> None:
        """Note that Stop was pressed. The thread that latches it calls this."""
        with self._lock:
            before, self._is_stopped = self._is_stopped, self._connection.watchdog.stopped
        if self._is_stopped and not before and not self._closed and not self._connection.is_closed:
            self._writer.add_cause(STOP)

    def _on_connection(self) -> None:
        """Note a lost connection, or close with the feed."""
        if self._connection.is_closed:
            self.close()  # in the thread that closes the feed, which waits for it
            return
        status = self._connection.status
        with self._lock:
            before, self._is_lost = self._is_lost, bool(status)
        if status and not before and not self._closed:
            self._writer.add_cause(status[:_LONGEST], is_error=True)

    def _on_step(self) -> None:
        """Note an error of the program, and what a recorder takes of it."""
        super()._on_step()
        program = self._connection.programs.current
        failed = f"{program.name}: {program.error}" if program is not None and program.mode == FAILED else ""
        with self._lock:
            before, self._failed = self._failed, failed
        if failed and failed != before and not self._closed:
            self._writer.add_cause(" ".join(failed.split())[:_LONGEST], is_error=True)

    def _causes_in(self, topic: str, _type: str, time_ns: int, message: Any) -> list[FoundCause]:
        """Return the touches and the errors that a message reports."""
        is_touch = self._events_of.get(topic)
        if is_touch is None:
            return []
        reader = self._readers.setdefault(topic, EventReader(topic))
        events = [event for _, event in reader.read(message, time_ns)]
        if is_touch:
            return [FoundCause(f"bump: {one.text} ({topic})") for one in events if one.text.endswith(_TOUCHED)]
        errors = (": ".join(filter(None, (one.source, one.text))) for one in events if one.level >= Level.ERROR)
        return [FoundCause(" ".join(text[: 2 * _LONGEST].split())[:_LONGEST], is_error=True) for text in errors]


class _Trigger(FeedWatch):
    """A condition that causes a file when it becomes true.

    Args:
        connection, given, name: as for `FeedWatch`.
        on_true: called with the name, in the thread that judges.
    """

    def __init__(self, connection: Connection, given: Any, name: str, on_true: Callable[[str], object]) -> None:
        self._on_true = on_true
        super().__init__(connection, given, name, {})

    @property
    def why_not_judged(self) -> str:
        """The reason why it is switched off, or cannot be judged now, or empty."""
        if self.error:
            return f"switched off, {self.error}"
        return "" if self._ended else self._why_unknown()

    def judge(self, sample: Any) -> None:
        """See `FeedWatch`."""
        before = self._verdict.value
        super().judge(sample)
        if self._verdict.value and not before:
            text = self._verdict.text
            self._on_true(f"{self.name}: {text}" if text and text != self.name else self.name)


def named_conditions(when: Any) -> dict[str, Any]:
    """Return the conditions that a user gives, by name: one, several, or a dictionary.

    Raises:
        TypeError: a lambda has no name; ValueError: two have the same name, or a name is empty.
    """
    if isinstance(when, Mapping):
        named = dict(when)
    else:
        given = list(when) if isinstance(when, Iterable) and not callable(when) else [when]
        named = {_name_of(one): one for one in given}
        if len(named) < len(given):
            raise ValueError(f"when: two conditions have one name; give names, as in {{{next(iter(named))!r}: ...}}")
    for name in named:
        if not isinstance(name, str):
            raise TypeError(f"when: expected names as text, got {name!r}")
        check_watch_name(name)
    return named


def _name_of(condition: Any) -> str:
    try:
        return default_name(condition)
    except TypeError:
        raise TypeError("when: a lambda has no name; give one, as in when={'wall': lambda scan: ...}") from None


def limits_of(seconds: float, after: float, files: int, megabytes: float) -> RingLimits:
    """Return the limits that a user gives; raise TypeError or ValueError if one is not usable."""
    if not 1 <= finite("seconds", seconds, "seconds") <= 3600:
        raise ValueError(f"seconds: expected 1 to 3600 seconds, got {seconds!r}")
    if not 0 <= finite("after", after, "seconds") <= 600:
        raise ValueError(f"after: expected 0 to 600 seconds, got {after!r}")
    if isinstance(files, bool) or not isinstance(files, int):
        raise TypeError(f"files: expected a whole number, got {files!r}")
    if files < 1:
        raise ValueError(f"files: expected 1 or more, got {files!r}")
    if finite("megabytes", megabytes, "MB") < 1:
        raise ValueError(f"megabytes: expected 1 or more, got {megabytes!r}")
    return RingLimits(float(seconds), float(after), files, int(megabytes * 1e6))


def folder_of(folder: Any) -> Path:
    """Return the folder of the files, which is made if it is missing.

    Raises:
        TypeError: it is not a path. ValueError: it is empty. OSError: it cannot be made, or is a file, or may
            not be written.
    """
    if not isinstance(folder, (str, os.PathLike)):
        raise TypeError(f"folder: expected the path of a folder, got {folder!r}")
    if not os.fsdecode(folder):
        raise ValueError("folder: expected the path of a folder, got an empty text")
    path = Path(os.path.realpath(Path(os.fsdecode(folder)).expanduser()))
    if path.exists() and not path.is_dir():
        raise NotADirectoryError(f"folder: {str(path)!r} is a file; name a folder for the files of the black box")
    path.mkdir(parents=True, exist_ok=True)
    return path
