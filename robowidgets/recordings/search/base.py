"""The base of all conditions: true, false or unknown at each time, joined with others, or a function of one moment."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from math import inf
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ...kinds import KINDS, sample_names
from ...messages.decoding import one_line
from ...reasons.look import Look, Reasons
from ...repair import RecordingError
from ...samples import HasAge, Ray
from ...samples.checks import number
from ...samples.verdict import Verdict
from ...widget.watch import Watch
from ..topics import Topic, UnknownTopicError, UnnamedTopicError, check_known, shown
from ._silence import mark_stale
from ._steps import NO, UNKNOWN, YES, Steps, combined, inverted, spans, steps
from .instant import TIME, Instant, NoSampleYetError, Now, OneSample, samples_of, together
from .seconds import Possible, SecondRows

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search

VALUES = {NO: False, UNKNOWN: None, YES: True}
"""The values of steps, as values of verdicts."""

_BAR_EVERY = 500
_READY_MADE = f"{__package__}.conditions"


class ConditionError(RecordingError):
    """An error in a function of the user, which is its `__cause__`."""


class Curve(NamedTuple):
    """A number over time: nanoseconds by the clock of the recording, and values, each of shape (N,)."""

    times_ns: NDArray[np.int64]
    values: NDArray[np.float64]


class Condition(ABC):
    """A condition, which is true, false or unknown at each time of a recording."""

    @abstractmethod
    def topics(self, recording: RecordingData, asked: Any) -> list[str]:
        """Return the topics that `steps` reads, once for each reading; ``asked`` is as in `Recording.find`."""

    @abstractmethod
    def steps(self, search: Search) -> Steps:
        """Return the steps of the condition, up to the end of the search."""

    def looked_at(self, search: Search) -> list[str]:
        """Return the topics that `steps` used in a search."""
        return self.topics(search.recording, search.topics)

    def possible(self, rows: SecondRows) -> Possible:
        """Return the possible values in some seconds of an index: both, if the index does not contain the answer."""
        anything = np.ones(len(rows), bool)
        return Possible(anything, anything)

    @abstractmethod
    def judge(self, moment: Any) -> Verdict:
        """Return the verdict of the condition on one moment.

        Args:
            moment: a `Scan`, `Speed` or `Touch`, or an object that has the last samples as attributes ``scan``,
                ``speed`` and ``touch``, and by topic as ``moment[topic]``. If a sample is missing (None), or reading it
                raises `NoSampleYetError`, it has not come yet, and the condition is unknown.

        Raises:
            TypeError: the sample is of another kind, or the condition needs more than one moment.
        """

    def number(self, recording: RecordingData) -> Curve | None:  # noqa: ARG002
        """Return the number that it compares, over a whole recording, or None for no number or a distance."""
        return None

    @property
    @abstractmethod
    def reads(self) -> frozenset[str]:
        """The names that `judge` reads: of samples, such as ``{"scan"}``, or of a topic with a field: ``{"/imu.x"}``.

        A function of a moment has no names.

        Raises:
            TypeError: the condition needs more than one moment.
        """

    @property
    def of_moment(self) -> Condition:
        """The condition on one moment, without its conditions over time, for pictures of a moment."""
        return self

    def for_longer(self, seconds: float) -> Condition:
        """Return the condition that this one is true without a pause for longer than some seconds: the whole span.

        `Recording.find` finds it, as the other conditions over time: a single moment does not decide.

        Args:
            seconds: the time, above 0.

        Raises:
            TypeError, ValueError: it is not a number above 0.

        Examples:
            >>> from robowidgets import conditions
            >>> print(conditions.nearest_below(0.3).for_longer(2))
            nearest below 0.3 m for longer than 2 s
        """
        return _ForLonger(self, _seconds("for_longer", seconds))

    def within(self, seconds: float, after: Condition | Callable[..., Any]) -> Condition:
        """Return the condition that this one is true while another one is, or at most some seconds after it.

        Args:
            seconds: the time, above 0.
            after: the other condition.

        Raises:
            TypeError, ValueError: it is not a number above 0, or not a condition.

        Examples:
            >>> from robowidgets import conditions
            >>> print(conditions.speed_above(0.1).within(1, after=conditions.touched()))
            (linear.x above 0.1 m/s within 1 s after anything touched)
        """
        return _Within(self, _seconds("within", seconds), condition(after))

    def count(self, times: int, within: float) -> Condition:
        """Return the condition that this one is true in one of several spans that begin within some seconds.

        Args:
            times: the number of spans, 2 or more.
            within: seconds from the start of the first of them to the start of the last.

        Raises:
            TypeError, ValueError: an argument is not such a number.

        Examples:
            >>> from robowidgets import conditions
            >>> print(conditions.touched().count(3, within=10))
            anything touched, 3 times within 10 s
        """
        if isinstance(times, bool) or not isinstance(times, int):
            raise TypeError(f"times: expected a whole number, got {times!r}")
        if times < 2:
            raise ValueError(f"times: expected 2 or more, got {times!r}")
        return _Counted(self, times, _seconds("within", within))

    def first_of_drive(self) -> Condition:
        """Return the condition that this one is true for the first time in its recording: its first span."""
        return _First(self)

    def __and__(self, other: Any) -> Condition:
        return _Joined(" & ", np.min, self, other)

    def __rand__(self, other: Any) -> Condition:
        return _Joined(" & ", np.min, other, self)

    def __or__(self, other: Any) -> Condition:
        return _Joined(" | ", np.max, self, other)

    def __ror__(self, other: Any) -> Condition:
        return _Joined(" | ", np.max, other, self)

    def __invert__(self) -> Condition:
        return _Not(self)

    def __repr__(self) -> str:
        return f"<{self}>"

    def __bool__(self) -> bool:
        raise TypeError(
            "a condition is neither true nor false by itself: join conditions with &, | and ~ (in brackets); "
            "a range is field.between(1, 3)"
        )


class FunctionCondition(Condition):
    """A condition that is true while a function returns a true value, until a sample that it read becomes stale.

    Args:
        function: takes an `Instant`, or the samples that its parameters name. It is called again only if a value that
            it read last time has changed.
        names: the names of the samples that it takes, if its parameters have other names.
        text: the text of the condition, or empty for the name of the function.
    """

    def __init__(self, function: Callable[..., Any], names: Sequence[str] | None = None, text: str = "") -> None:
        self._look = Look(function)
        self._look.prepare()
        self._text = text or str(getattr(function, "__name__", type(function).__name__))
        self._names = names_of(function) if names is None else tuple(names)

    @property
    def function(self) -> Callable[..., Any]:
        """The function."""
        return self._look.function

    @property
    def reads(self) -> frozenset[str]:
        """See `Condition`."""
        return frozenset(self._names)

    def judge(self, moment: Any) -> Verdict:
        """See `Condition`."""
        try:
            result, reasons = self._result(OneSample(moment) if isinstance(moment, HasAge) else moment)
        except NoSampleYetError:
            return Verdict(None)
        return reasons.verdict(result)

    def _result(self, moment: Any) -> tuple[Any, Reasons]:
        """Return the result of the function with its reasons; raise NoSampleYetError if a sample has not come yet."""
        if not self._names:
            return self._look(moment)
        samples = [getattr(moment, name) for name in self._names]
        for name, sample in zip(self._names, samples, strict=True):
            if sample is None:
                raise NoSampleYetError(name)
        return self._look(*samples)

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:
        """See `Condition`."""
        return [topic.name for topic in topics_to_read(recording, asked)]

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        recording = search.recording
        topics = topics_to_read(recording, search.topics)
        now = Now(recording.start_ns or 0)
        instant = Instant(recording.path.name, topics, now, recording.preferred)
        # One list, so that after an interrupt all times have values.
        rounds: list[tuple[int, int, frozenset[str]]] = []
        calls: list[tuple[int, tuple[float, Ray] | None]] = []
        going_stale: dict[str, list[int]] = {t.name: [] for t in topics if t.widget and KINDS[t.widget].goes_stale}
        value = UNKNOWN
        used: frozenset[str] = frozenset()
        sets: dict[frozenset[str], frozenset[str]] = {}
        looked = 0
        try:
            for time_ns, samples in together({topic.name: samples_of(recording, topic.name) for topic in topics}):
                if time_ns > search.end_ns and search.is_cut:
                    break
                now.put(time_ns, samples)
                if not rounds or TIME in now.read or not now.read.isdisjoint(samples):
                    value, met = self._call(instant, now)
                    calls.append((time_ns, met))
                    used = frozenset(now.read)
                    # One set for all samples for which the function read the same.
                    used = sets.setdefault(used, used)
                for topic in going_stale.keys() & samples:
                    going_stale[topic].append(time_ns)
                rounds.append((time_ns, value, used))
                looked += len(samples)
                if looked >= _BAR_EVERY:
                    search.looked_at(looked)
                    looked = 0
        except KeyboardInterrupt:
            search.cut(rounds[-1][0] if rounds else recording.start_ns or 0)
        search.looked_at(looked)
        search.read[self] = frozenset().union(*sets)
        rays = [met for _, met in calls if met]
        search.met(
            np.array([time_ns for time_ns, _ in calls], np.int64),
            np.array([met is not None for _, met in calls], bool),
            np.array([away for away, _ in rays], np.float64),
            np.array([ray.index for _, ray in rays], np.int64),
            np.array([ray.angle for _, ray in rays], np.float64),
        )
        rests_on = (
            (np.array(came, np.int64), np.array([name in names for _, _, names in rounds], bool))
            for name, came in going_stale.items()
        )
        times, values = [time_ns for time_ns, _, _ in rounds], [value for _, value, _ in rounds]
        return mark_stale(steps(times, values), rests_on, search.end_ns)

    def looked_at(self, search: Search) -> list[str]:
        """See `Condition`: the topics that the function read."""
        return [topic for topic in self.topics(search.recording, search.topics) if topic in search.read.get(self, ())]

    def _call(self, instant: Instant, now: Now) -> tuple[int, tuple[float, Ray] | None]:
        """Return the value of the function, and the distance and the ray to the nearest thing if it is true."""
        now.read.clear()
        try:
            result, reasons = self._result(instant)
            value = reasons.value(result)
            return _code(value), reasons.met() if value else None
        except NoSampleYetError:
            return UNKNOWN, None
        except UnnamedTopicError:
            raise
        except Exception as error:
            raise ConditionError(
                f"the condition {self} failed at {now.seconds:.2f} s: {type(error).__name__}: {one_line(error)}"
            ) from error

    def __str__(self) -> str:
        return self._text


def condition(given: Any) -> Condition:
    """Return the condition of a condition, a `Watch` or a function of one moment; raise TypeError otherwise."""
    if isinstance(given, Condition):
        return given
    if isinstance(given, Watch):
        own = given.condition
        return own if isinstance(own, Condition) else FunctionCondition(own, [given.sample_name], given.name)
    if callable(given) and getattr(given, "__module__", "") == _READY_MADE:
        raise TypeError(
            f"condition: {given.__name__} makes a condition: call it, as in conditions.{given.__name__}(...)"
        )
    if callable(given):
        return FunctionCondition(given)
    raise TypeError(f"condition: expected a function of one moment, or one of robowidgets.conditions, got {given!r}")


def names_of(function: Callable[..., Any]) -> tuple[str, ...]:
    """Return the names of the samples that a function takes, from its parameters: ``lambda scan, speed: ...``.

    Return no names if it takes a moment: its one parameter has another name, or its parameters are unknown.

    Raises:
        TypeError: it has several parameters, and not all of them name samples.
    """
    try:
        parameters = inspect.signature(function).parameters.values()
    except (TypeError, ValueError):
        return ()
    given = [
        p.name for p in parameters if p.default is p.empty and p.kind in (p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD)
    ]
    known = sample_names()
    if given and set(given) <= set(known):
        return tuple(given)
    if len(given) > 1:
        raise TypeError(
            f"condition: expected a function of one moment, or of samples by name ({', '.join(known)}); "
            f"it takes {', '.join(given)}"
        )
    return ()


def topics_to_read(recording: RecordingData, asked: Any) -> list[Topic]:
    """Return the topics that a function may read; raise UnknownTopicError without topics."""
    there = shown(recording.topics)
    names = there if asked is None else [asked] if isinstance(asked, str) else list(asked)
    if not names:
        first = next((topic.name for topic in recording.topics), "/imu")
        why = f"{recording.path.name} has no topic that a widget shows" if asked is None else "topics is empty"
        raise UnknownTopicError(f"{why}: name the topics that the function reads, as in topics={[first]!r}")
    # For a topic with messages of two types, the type that is shown.
    return [
        there.get(name) or check_known(name, recording.topics, recording.path.name) for name in dict.fromkeys(names)
    ]


def _code(value: bool | None) -> int:
    return UNKNOWN if value is None else YES if value else NO


class UndecidedCondition(Condition):
    """A condition on a whole recording, which no single moment decides."""

    why: ClassVar[str] = "one moment does not decide it"
    """The reason why a moment does not decide it."""

    def judge(self, moment: Any) -> Verdict:  # noqa: ARG002
        """See `Condition`."""
        raise self._undecided()

    @property
    def reads(self) -> frozenset[str]:
        """See `Condition`."""
        raise self._undecided()

    def _undecided(self) -> TypeError:
        return TypeError(f"{self}: {self.why}, so only Recording.find finds it")


class _OfParts(Condition):
    def __init__(self, *parts: Condition) -> None:
        self._parts = parts

    @property
    def _part(self) -> Condition:
        return self._parts[0]

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:
        return [topic for part in self._parts for topic in part.topics(recording, asked)]

    def looked_at(self, search: Search) -> list[str]:
        return [topic for part in self._parts for topic in part.looked_at(search)]

    def number(self, recording: RecordingData) -> Curve | None:
        return next((one for part in self._parts if (one := part.number(recording))), None)

    @property
    def reads(self) -> frozenset[str]:
        return frozenset().union(*(part.reads for part in self._parts))


class _Joined(_OfParts):
    def __init__(self, word: str, how: Callable[..., Any], *parts: Any) -> None:
        super().__init__(*map(condition, parts))
        self._word, self._how = word, how

    def steps(self, search: Search) -> Steps:
        return combined([search.steps_of(part) for part in self._parts], self._how)

    def possible(self, rows: SecondRows) -> Possible:
        true, false = zip(*(part.possible(rows) for part in self._parts), strict=True)
        other = np.max if self._how is np.min else np.min
        return Possible(self._how(true, axis=0), other(false, axis=0))

    def judge(self, moment: Any) -> Verdict:
        verdicts = [part.judge(moment) for part in self._parts]
        value = VALUES[int(self._how([_code(verdict.value) for verdict in verdicts]))]
        text = " · ".join(dict.fromkeys(verdict.text for verdict in verdicts if verdict.text))
        rays = np.unique(np.concatenate([verdict.rays for verdict in verdicts]))
        nearest = min((v.nearest for v in verdicts if v.nearest), key=lambda ray: ray.range, default=None)
        return Verdict(value, text, rays, nearest) if value else Verdict(value, text)

    @property
    def of_moment(self) -> Condition:
        return _Joined(self._word, self._how, *(part.of_moment for part in self._parts))

    def __str__(self) -> str:
        return f"({self._word.join(map(str, self._parts))})"


class _Not(_OfParts):
    def steps(self, search: Search) -> Steps:
        return inverted(search.steps_of(self._part, is_negated=True))

    def possible(self, rows: SecondRows) -> Possible:
        true, false = self._part.possible(rows)
        return Possible(false, true)

    def judge(self, moment: Any) -> Verdict:
        verdict = self._part.judge(moment)
        return Verdict(None if verdict.value is None else not verdict.value, verdict.text)

    def __str__(self) -> str:
        return f"~{self._part}"

    @property
    def of_moment(self) -> Condition:
        return _Not(self._part.of_moment)


class _OverTime(UndecidedCondition, _OfParts):
    """The condition that the first of some others is true at times that depend on other times."""

    def number(self, recording: RecordingData) -> Curve | None:
        return self._part.number(recording)

    @property
    def of_moment(self) -> Condition:
        return self._part.of_moment

    def possible(self, rows: SecondRows) -> Possible:
        return Possible(self._part.possible(rows).true, np.ones(len(rows), bool))


class _OfSpans(_OverTime):
    """The condition that another one is true in some of its spans."""

    @abstractmethod
    def chosen(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> NDArray[np.bool_]:
        """Return True for each span that counts, of its start and its end in nanoseconds, shape (N,) each."""

    def steps(self, search: Search) -> Steps:
        part = search.steps_of(self._part)
        found = np.array(spans(part, search.end_ns), np.int64).reshape(-1, 2)
        if not len(found):
            return part
        is_chosen = self.chosen(found[:, 0], found[:, 1])
        # Each true step lies in the last span that began.
        place = np.searchsorted(found[:, 0], part.times, side="right") - 1
        values = np.where((part.values == YES) & ~is_chosen[place], NO, part.values)
        return Steps(part.times, values.astype(np.int8))


class _ForLonger(_OfSpans):
    def __init__(self, part: Condition, seconds: float) -> None:
        super().__init__(part)
        self._seconds = seconds

    def chosen(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> NDArray[np.bool_]:
        is_longer: NDArray[np.bool_] = ends - starts > self._seconds * 1e9
        return is_longer

    def __str__(self) -> str:
        return f"{self._part} for longer than {self._seconds:g} s"


class _Counted(_OfSpans):
    def __init__(self, part: Condition, times: int, seconds: float) -> None:
        super().__init__(part)
        self._times, self._seconds = times, seconds

    def chosen(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> NDArray[np.bool_]:  # noqa: ARG002
        more = self._times - 1
        begins = starts[more:] - starts[: max(len(starts) - more, 0)] <= self._seconds * 1e9
        found = np.zeros(len(starts), bool)
        for later in range(self._times):
            found[later : later + len(begins)] |= begins
        return found

    def __str__(self) -> str:
        return f"{self._part}, {self._times} times within {self._seconds:g} s"


class _First(_OfSpans):
    def chosen(self, starts: NDArray[np.int64], ends: NDArray[np.int64]) -> NDArray[np.bool_]:  # noqa: ARG002
        is_first = np.zeros(len(starts), bool)
        is_first[:1] = True
        return is_first

    def __str__(self) -> str:
        return f"{self._part} for the first time"


class _Within(_OverTime):
    def __init__(self, part: Condition, seconds: float, after: Condition) -> None:
        super().__init__(part, after)
        self._seconds = seconds

    def steps(self, search: Search) -> Steps:
        part, after = (search.steps_of(one) for one in self._parts)
        longer = round(self._seconds * 1e9)
        edges: list[tuple[int, int]] = []
        for start, end in spans(after, search.end_ns):
            if edges and edges[-1][0] >= start:
                edges.pop()
            else:
                edges.append((start, YES))
            # "At most" includes the time itself.
            edges += [(end + longer, YES), (end + longer, NO)]
        lasting = steps([search.recording.start_ns or 0, *(at for at, _ in edges)], [NO, *(one for _, one in edges)])
        return combined([part, combined([after, lasting], np.max)], np.min)

    def __str__(self) -> str:
        return f"({self._part} within {self._seconds:g} s after {self._parts[1]})"


def _seconds(name: str, given: Any) -> float:
    seconds = number(name, given)
    if not 0 < seconds < inf:
        raise ValueError(f"{name}: expected seconds above 0, got {seconds!r}")
    return seconds
