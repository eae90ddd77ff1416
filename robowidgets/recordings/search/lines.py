"""The lines of a function over a recording: their values at any moment, and when a line was reached, or true."""

from __future__ import annotations

import inspect
from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from html import escape
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from ...behaviors.drive import Drive
from ...behaviors.lines.differences import first_difference
from ...behaviors.lines.shown import FLAG, levels_of, lines_of
from ...behaviors.lines.texts import line_texts
from ...behaviors.lines.values import glimpse, text_of
from ...behaviors.lines.watch import LineWatch, WatchedCall, WatchedStep, error_text
from ...behaviors.program import Program
from ...behaviors.robot import GIVEN, ODOMETRY
from ...behaviors.simulation import ProgramRun
from ...behaviors.version import RATE
from ...kinds import KINDS, sample_names
from ...notebook.progress import Progress, without_bars
from ...reasons.places import FunctionSource
from ...runtime.tables import HasTable, Table
from ...samples.checks import finite
from ..span import Span
from ._search import Search
from ._steps import NO, YES, spans, steps
from ._stops import StopsCondition
from .base import names_of, topics_to_read
from .instant import Instant, NoSampleYetError, Now, samples_of, together
from .spans import Spans

if TYPE_CHECKING:
    from .. import RecordingData

_WIDEST = 60
"""Characters of code in front of values."""
_SHOWN = 20
_NOT_REACHED, _REACHED, _FALSE, _TRUE = range(4)
"""Of each step one of these is kept for each line."""


class MadeStep(NamedTuple):
    """A step: its time by the clock of the recording, its notes, its return value, and the error that ended it."""

    time_ns: int
    step: WatchedStep
    returned: Any
    error: str


class StepText:
    """The lines of one step, printed as text: each line of code with its values.

    Attributes:
        seconds: the time of the step, from the start of the recording.
        returned: the value that the function returned, or None if it failed.
        error: the error that ended it, empty without one.
    """

    def __init__(self, seconds: float, made: MadeStep) -> None:
        self.seconds, self.returned = seconds, made.returned
        self._calls = made.step.calls
        self.error = made.error

    def __getitem__(self, line: int) -> str:
        """Return the value of a line by its number in the file or cell, or empty if it has none or was not reached."""
        for call in self._calls:
            for values in lines_of(call):
                if call.source.first + values.number == line:
                    return values.value
        return ""

    def __repr__(self) -> str:
        texts = [text for call in self._calls for text in _texts(call)]
        if self.error and not any(call.error for call in self._calls):  # such as a value that is not a speed
            texts.append(f"! {self.error}")
        return "\n".join((f"at {self.seconds:.2f} s", *texts))

    def _repr_html_(self) -> str:
        return f"<pre>{escape(repr(self))}</pre>"


class RecordedLines(HasTable):
    """A function with the results of its lines over a recording. Printed, it is a table of its lines.

    `Recording.lines` makes it. A function of samples or of one moment is called at each of them. A program, and a
    function that takes other inputs of programs, is stepped through time. Only a byte per line and step is stored. The
    values of a moment are computed again on request.

    Attributes:
        maker: makes its steps.
        seconds: the times of its steps, from the start of the recording.
        error: the error that ended it, with its time; empty without one.
    """

    def __init__(
        self,
        recording: RecordingData,
        function: Any,
        rate: float,
        topics: Any,
        *,
        span: tuple[float, float] | None = None,
        is_filled: bool = True,
    ) -> None:
        self.maker = StepMaker(recording, function, rate, topics, span)
        self._start_ns = recording.start_ns or 0
        self._end_ns = self._start_ns
        self._functions: dict[str, WatchedCall] = {}
        """A call of each function."""
        self._codes: dict[tuple[str, int], bytearray] = {}
        """A byte for each step, by function and number of the line."""
        self._times: list[int] = []
        self.error = ""
        self.seconds = np.zeros(0)
        if is_filled:
            with _bar() as bar:
                for _ in self.fill(bar):
                    pass

    def fill(self, bar: Progress) -> Iterator[MadeStep]:
        """Make all steps, one for each that the caller asks for, up to one that fails."""
        for made in self.maker.walk(bar):
            self._add(made)
            yield made
        for codes in list(self._codes.values()):
            codes.extend(bytes(len(self._times) - len(codes)))
        self._end_ns = self.maker.end_ns
        self.seconds = (np.array(self._times, np.int64) - self._start_ns) / 1e9

    def _add(self, made: MadeStep) -> None:
        number = len(self._times)
        self._times.append(made.time_ns)
        for call in made.step.calls:
            source = call.source
            self._functions.setdefault(source.key, call)
            for line, (kind, level) in levels_of(call).items():
                codes = self._codes.setdefault((source.key, source.first + line), bytearray())
                codes.extend(bytes(number + 1 - len(codes)))
                codes[number] = _REACHED if kind != FLAG else _TRUE if level == 1.0 else _FALSE
        if made.error:
            self.error = f"{made.error} at {(made.time_ns - self._start_ns) / 1e9:.2f} s"

    def __len__(self) -> int:
        return len(self._times)

    @property
    def calls(self) -> list[WatchedCall]:
        """A call of each function, in the order of their lines."""
        return sorted(self._functions.values(), key=lambda call: call.source.first)

    def counts(self) -> dict[str, list[list[int]]]:
        """Return for the lines of each function, from 0, in how many steps they were reached, and in how many true."""
        found: dict[str, list[list[int]]] = {}
        for (key, line), codes in list(self._codes.items()):
            number = line - self._functions[key].source.first
            found.setdefault(key, []).append([number, len(codes) - codes.count(_NOT_REACHED), codes.count(_TRUE)])
        return found

    def at(self, seconds: float) -> StepText:
        """Return the lines of the last step up to a time, computed again.

        Raises:
            ValueError: the time is before the first step. TypeError: the time is not a number.
        """
        time_ns = self._start_ns + round(finite("seconds", seconds, "seconds from the start") * 1e9)
        index = bisect_right(self._times, time_ns) - 1
        if index < 0:
            first = f"the first one is at {self.seconds[0]:.2f} s" if self._times else "there is none"
            raise ValueError(f"seconds: no step was made up to {seconds:g} s; {first}")
        made = self.maker.make(index)
        return StepText(float(self.seconds[index]), made)

    def when(self, line: int) -> Spans:
        """Return the spans in which a line was true, or was reached if it is not a condition.

        A condition in a loop was true in a step if it was true in any pass.

        Args:
            line: the number of the line in its file or cell, as errors and the table name it.

        Raises:
            ValueError: no code is on this line, or it was in no step.
        """
        reachable = sorted({number for call in self._functions.values() for number in call.source.reach})
        if line not in reachable:
            there = f"{reachable[0]} to {reachable[-1]}" if reachable else "none"
            raise ValueError(f"line: expected the number of a line with code, {there}, got {line!r}")
        codes = np.zeros(len(self), np.uint8)
        for (_, number), of_line in list(self._codes.items()):
            if number == line:
                known = np.frombuffer(bytes(of_line), np.uint8)[: len(codes)]
                codes[: len(known)] = np.maximum(codes[: len(known)], known)
        is_flag = bool(np.any(codes >= _FALSE))
        values = np.where(codes == _TRUE if is_flag else codes != _NOT_REACHED, YES, NO)
        found = [
            Span((a - self._start_ns) / 1e9, (b - self._start_ns) / 1e9, (b - a) / 1e9, a, b)
            for a, b in spans(steps(self._times, values), self._end_ns)
        ]
        return Spans(f"line {line} was {'true' if is_flag else 'reached'}", found)

    def _table(self) -> Table:
        if not self._times:
            return Table(f"{self.maker.name}: no step, as a sample that it reads never came", (), ())
        calls = self.calls
        rows = [row for call in calls for row in self._rows(call.source)]
        why = [f"{call.source.name} runs as it is, and shows no values: {call.why}" for call in calls if call.why]
        heading = f"{self.maker.name}: {len(self):,} steps"
        problems = [self.error] if self.error else []
        return Table(heading, ("line", "code", "reached", "true"), rows, right=(0, 2, 3), notes=why, problems=problems)

    def _rows(self, source: FunctionSource) -> Iterator[tuple[str, str, str, str]]:
        for number, text in enumerate(source.texts, source.first):
            codes = self._codes.get((source.key, number), b"")
            true, false = codes.count(_TRUE), codes.count(_FALSE)
            reached = f"{len(codes) - codes.count(_NOT_REACHED):,}" if number in source.reach else ""
            indent = len(text) - len(text.lstrip())
            code = "\N{NO-BREAK SPACE}" * indent + text.lstrip()  # a page would leave out spaces
            yield str(number), code, reached, f"{true:,}" if true or false else ""


class Decision(NamedTuple):
    """A span in which two versions decided otherwise.

    Attributes:
        start, end, seconds: the span, from the start of the recording.
        line: the number of the first line of the new version that was otherwise, or None if it is not known.
        old_value, new_value: the text of this line in both versions, "not reached" if it was not.
        old, new: the values that both returned at the start of the span, or the errors that they raised.
    """

    start: float
    end: float
    seconds: float
    line: int | None
    old_value: str
    new_value: str
    old: Any
    new: Any


class Decisions(HasTable, Sequence[Decision]):
    """A table of the spans in which two versions of a function decided otherwise; see `decisions`.

    Attributes:
        spans: the same spans as `Recording.find` returns them.
        steps: the number of steps that were compared, and of those in which they decided otherwise.
    """

    def __init__(self, name: str, found: Sequence[Decision], start_ns: int, steps_: tuple[int, int]) -> None:
        self._name, self._found, self.steps = name, tuple(found), steps_
        ends = ((round(one.start * 1e9) + start_ns, round(one.end * 1e9) + start_ns) for one in found)
        rows = [Span(one.start, one.end, one.seconds, a, b) for one, (a, b) in zip(found, ends, strict=True)]
        self.spans = Spans(f"{name} decides otherwise", rows)

    def __getitem__(self, index: Any) -> Any:
        return self._found[index]

    def __len__(self) -> int:
        return len(self._found)

    def _table(self) -> Table:
        compared, otherwise = self.steps
        heading = f"{self._name}: decided otherwise in {otherwise:,} of {compared:,} steps"
        rows = [
            (
                f"{one.start:.2f}", f"{one.end:.2f}", f"{one.seconds:.2f}", "" if one.line is None else str(one.line),
                one.old_value, one.new_value, _short(one.old), _short(one.new),
            )
            for one in self._found[:_SHOWN]
        ]  # fmt: skip
        more = [f"  ... and {len(self) - _SHOWN:,} more"] if len(self) > _SHOWN else []
        heads = ("start", "end", "seconds", "line", "old value", "new value", "old", "new")
        return Table(heading, heads, rows, right=range(4), notes=more)


def decisions(
    old: Any, new: Any, recording: RecordingData, *, rate: float = RATE, topics: str | Iterable[str] | None = None
) -> Decisions:
    """Return the spans in which a new version of a function would have decided otherwise over a recording.

    Both are called at the same moments, each with a state of its own, as `Recording.lines` calls them. What the robot
    did is what was recorded: a speed that one of them asks for changes nothing that they get.

    Args:
        old: one version: a program, or a function of samples or of one moment.
        new: the other one.
        recording: the recording.
        rate: steps a second of functions that are stepped through time.
        topics: the topics that a function of one moment may read, or None for all that a widget shows.

    Raises:
        TypeError: a version is neither a program nor a function, or the recording is not a recording.

    Examples:
        >>> import robowidgets
        >>> recording = robowidgets.open(robowidgets.SAMPLE)
        >>> near = lambda limit: lambda scan: scan.distance("front") < limit
        >>> len(robowidgets.decisions(near(0.5), near(0.5), recording))
        0
    """
    if not hasattr(recording, "start_ns"):
        raise TypeError(
            "decisions(): expected the old version, the new one, and a recording, as from robowidgets.open(path), "
            f"got {recording!r} as the recording"
        )
    first, second = StepMaker(recording, old, rate, topics), StepMaker(recording, new, rate, topics)
    start_ns = recording.start_ns or 0
    is_drive = False
    kept: list[Any] = [None, None]
    found: list[Decision] = []
    open_since: _Pair | None = None
    compared = otherwise = 0
    with _bar() as bar:
        for pair in _at_same_times(first.walk(bar), second.walk(bar)):
            compared += 1
            is_drive = is_drive or any(isinstance(one.returned, Drive) for one in pair)
            for i, one in enumerate(pair):
                # A step that returns None keeps the speed.
                if one.error or one.returned is not None or not is_drive:
                    kept[i] = one.error or one.returned
            differs = _differ(*kept)
            otherwise += differs
            if differs and open_since is None:
                open_since = _Pair(*pair, *kept)
            elif not differs and open_since is not None:
                found.append(_decision(open_since, pair[1].time_ns, start_ns))
                open_since = None
    if open_since is not None:
        found.append(_decision(open_since, second.end_ns, start_ns))
    return Decisions(second.name, found, start_ns, (compared, otherwise))


class _Pair(NamedTuple):
    old: MadeStep
    new: MadeStep
    old_outcome: Any
    new_outcome: Any


def _at_same_times(first: Iterator[MadeStep], second: Iterator[MadeStep]) -> Iterator[tuple[MadeStep, MadeStep]]:
    """Yield the steps that both made at the same time. No others are kept: they hold their scans."""
    one, other = next(first, None), next(second, None)
    while one is not None and other is not None:
        if one.time_ns == other.time_ns:
            yield one, other
        at = one.time_ns, other.time_ns
        if at[0] <= at[1]:
            one = next(first, None)
        if at[1] <= at[0]:
            other = next(second, None)


@contextmanager
def _bar() -> Iterator[Progress]:
    with Progress(0, "Reading", " samples") as bar, without_bars():
        yield bar


def _differ(one: Any, other: Any) -> bool:
    """Return True if two outcomes are different: also of values such as rays, whose arrays have no single answer."""
    if type(one) in (float, int, bool, str, Drive, type(None)) and type(one) is type(other):
        return bool(one != other) and not (one != one and other != other)
    return _short(one) != _short(other)


def _short(value: Any) -> str:
    return text_of(glimpse(value))


def _decision(pair: _Pair, end_ns: int, start_ns: int) -> Decision:
    start, end = ((one - start_ns) / 1e9 for one in (pair.new.time_ns, end_ns))
    line, old_value, new_value = first_difference(pair.old.step, pair.new.step)
    return Decision(start, end, end - start, line, old_value, new_value, pair.old_outcome, pair.new_outcome)


class StepMaker:
    """Makes the steps of a function over a recording.

    Args:
        recording: the recording.
        function: the function, or a program.
        rate: steps a second of a function that is stepped through time.
        topics: the topics that a function of one moment may read.
        span: start and end of the steps in seconds from the start of the recording, or None for all of it.

    Attributes:
        name: the name of the function.
        is_program: True if it is stepped through time, so that a step depends on the steps before it.
        rate: steps a second, if it is.
        end_ns: the end of the last step.
    """

    def __init__(
        self,
        recording: RecordingData,
        function: Any,
        rate: float,
        topics: Any,
        span: tuple[float, float] | None = None,
    ) -> None:
        check_function(function)
        self._recording, self._function, self._topics = recording, function, topics
        self._watch = LineWatch()
        """Has the function in its rewritten form, for single steps."""
        own = function.version if isinstance(function, Program) else None
        self.rate = own.rate if own else rate
        start_ns = recording.start_ns or 0
        self._since_ns = start_ns if span is None else start_ns + round(span[0] * 1e9)
        self._until_ns = None if span is None else start_ns + round(span[1] * 1e9)
        self.is_program = _is_program(function)
        if self.is_program:
            self._stepped = StopsCondition(function, self.rate)
            self.name = str(self._stepped).removesuffix(" stops")
        else:
            self._names = names_of(function)
            self.name = str(getattr(function, "__name__", type(function).__name__))
        self.end_ns = recording.start_ns or 0

    def walk(self, bar: Progress) -> Iterator[MadeStep]:
        """Make all steps, up to one that fails."""
        return self._walk(bar, lambda _: True)

    def make(self, index: int) -> MadeStep:
        """Make a step again, after the steps that it may depend on."""
        # A function of samples knows of nothing before.
        wanted = (lambda _: True) if self.is_program else (lambda number: number >= index)
        with _bar() as bar:
            made = self._walk(bar, wanted)
            return next(one for number, one in enumerate(made, 0 if self.is_program else index) if number == index)

    def _walk(self, bar: Progress, is_wanted: Callable[[int], bool]) -> Iterator[MadeStep]:
        watch = LineWatch()
        search = Search(self._recording, self._topics, bar)
        self.end_ns = search.end_ns if self._until_ns is None else min(search.end_ns, self._until_ns)
        steps = self._walk_program(search, watch) if self.is_program else self._walk_moments(watch, is_wanted)
        for made in steps:
            if made.time_ns > self.end_ns:
                return
            yield made

    def read(self) -> None:
        """Read the samples that its steps may need from the file, so that later only the function takes time."""
        if self.is_program:
            topics = self._stepped.topics(self._recording, None)
        else:
            asked = {*(self._names or sample_names())}
            kinds = {kind.name for kind in KINDS.values() if asked & {kind.sample_name, kind.parameter}}
            there = topics_to_read(self._recording, self._topics)
            topics = [topic.name for topic in there if topic.widget in kinds]
        for name in topics:
            len(self._recording.series(name))

    def make_at(self, seconds: float) -> MadeStep | None:
        """Make the step of a function of samples at a time, of the last samples up to it; None if one is missing."""
        recording = self._recording
        topics = topics_to_read(recording, self._topics)
        start_ns = recording.start_ns or 0
        now = _NowAt(recording, [topic.name for topic in topics], seconds)
        instant = Instant(recording.path.name, topics, now, recording.preferred)
        made = self._step_at(now.time_ns, instant, now, self._watch, -1, True)
        if not isinstance(made, MadeStep):
            return None
        read = [start_ns + round(now.seconds_of[topic] * 1e9) for topic in now.read & now.seconds_of.keys()]
        return made._replace(time_ns=max(read, default=now.time_ns))

    def _walk_program(self, search: Search, watch: LineWatch) -> Iterator[MadeStep]:
        run = ProgramRun(self._function)
        run.lines = watch
        for time_ns, seconds, samples in self._stepped.moments(search, run, self._since_ns):
            if samples is None:
                continue
            before, error = watch.newest, ""
            try:
                run.step(seconds, samples)
            except NoSampleYetError:
                continue
            except Exception as raised:  # it is shown on its line
                if watch.newest is before:  # a sample could not be read
                    raise
                error = error_text(raised)
            if watch.newest is not None:
                yield MadeStep(time_ns, watch.newest, None if error else run.returned, error)
            if error:
                return

    def _walk_moments(self, watch: LineWatch, is_wanted: Callable[[int], bool]) -> Iterator[MadeStep]:
        recording = self._recording
        topics = topics_to_read(recording, self._topics)
        now = Now(recording.start_ns or 0)
        instant = Instant(recording.path.name, topics, now, recording.preferred)
        number = 0
        used: set[str] | None = None
        for time_ns, samples in together({topic.name: samples_of(recording, topic.name) for topic in topics}):
            now.put(time_ns, samples)
            if time_ns < self._since_ns:
                continue
            # Only the samples that it read last time may change its result.
            if used is not None and used.isdisjoint(samples):
                continue
            made = self._step_at(time_ns, instant, now, watch, number, is_wanted(number))
            if made is None:
                continue
            used = {*now.read} - {""} if "" not in now.read else None
            number += 1
            if isinstance(made, MadeStep):
                yield made
                if made.error:
                    return

    def _step_at(
        self, time_ns: int, instant: Instant, now: Now, watch: LineWatch, number: int, is_wanted: bool
    ) -> MadeStep | bool | None:
        """Return a step, True if it is not wanted but would be made, or None if a sample is missing."""
        now.read.clear()
        returned, error = None, ""
        function = self._function
        names = self._names
        try:
            given = {name: getattr(instant, name) for name in names}
        except NoSampleYetError:
            return None
        if not is_wanted and names:
            return True
        try:
            returned = watch.step((self.name, 0), (number + 1, now.seconds), *_arguments(function, given, instant))
        except NoSampleYetError:
            return None
        except Exception as raised:  # it is shown on its line
            error = error_text(raised)
        return MadeStep(time_ns, watch.newest, returned, error) if is_wanted and watch.newest else True


class _NowAt(Now):
    """The last samples up to a time, read only if a function asks for them."""

    def __init__(self, recording: RecordingData, topics: Iterable[str], seconds: float) -> None:
        start_ns = recording.start_ns or 0
        super().__init__(start_ns)
        self.time_ns = start_ns + round(seconds * 1e9)
        self._recording, self._at = recording, seconds
        self.samples = {topic: partial(self._sample, topic) for topic in topics}

    def _sample(self, topic: str) -> Any:
        moment = self._recording.at(topic, self._at)
        if moment is None:
            raise NoSampleYetError(topic)
        self.seconds_of[topic] = moment.seconds
        return moment.sample


def _arguments(function: Any, given: dict[str, Any], instant: Instant) -> tuple[Any, dict[str, Any]]:
    """Return a function and its arguments by name. A function of one moment gets the moment by its first parameter."""
    if given:
        return function, given
    first = next(iter(inspect.signature(function).parameters))
    return function, {first: instant}


def check_function(function: Any) -> None:
    """Raise TypeError for something that has no lines, because it is neither a function nor a program."""
    if not callable(function):
        raise TypeError(f"lines: expected a program, or a function of samples or of one moment, got {function!r}")


def _is_program(function: Any) -> bool:
    """Return True if a function is stepped through time: it takes more than samples, or is a program or a machine."""
    if isinstance(function, (Program, type)) or hasattr(function, "asks_for"):
        return True
    try:
        parameters = inspect.signature(function).parameters
    except (TypeError, ValueError):
        return False
    return any(name in (*GIVEN, *ODOMETRY) for name in parameters) or not parameters


def _texts(call: WatchedCall) -> Iterator[str]:
    """Yield each line of a call with its values, and the passes of its loops."""
    source = call.source
    width = min(_WIDEST, max((len(text) for text in source.texts), default=0))
    if call.why:
        yield f"  {source.name} runs as it is, and shows no values: {call.why}"
    for line in line_texts(call):
        said = f"! {line.error}" if line.error else "not reached" if line.is_reached is False else line.value
        yield f"{line.number:4}  {line.code.ljust(width)}  {said}".rstrip()
        yield from (f"{'':{width + 6}}  {row}" for row in line.passes)
