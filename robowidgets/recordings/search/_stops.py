"""The condition that a program tells the robot to stop, judged on recorded samples."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import numpy as np

from ...behaviors.drive import STANDSTILL
from ...behaviors.program import Program
from ...behaviors.robot import ODOMETRY, POSE
from ...behaviors.simulation import ProgramRun
from ...behaviors.version import to_rate
from ...kinds import KINDS, kind_of_parameter
from ...messages.decoding import one_line
from ...samples.staleness import TO_DRIVE_BY, usual_step
from ..odometry import odometry
from ..topics import UnnamedTopicError, shown
from ._steps import NO, UNKNOWN, YES, Steps, steps
from .base import ConditionError, UndecidedCondition
from .instant import Instant, NoSampleYetError, Now, samples_of, together

if TYPE_CHECKING:
    from .. import RecordingData
    from ._search import Search

_BAR_EVERY = 500


class StopsCondition(UndecidedCondition):
    """The condition that a program tells the robot to stop, given the recorded samples.

    Args:
        program: a function or a class, or the program that a feed made of one.
        rate: steps per second.
    """

    why = "a program is stepped through time"

    def __init__(self, program: Any, rate: float) -> None:
        own = program.version if isinstance(program, Program) else None
        self._program = own.function if own else program  # without its feed, so that it can be sent to another process
        run = ProgramRun(program)
        self._name, self._asks_for, self._topics = run.name, run.asks_for, dict(run.topics)
        self._rate = to_rate(rate)

    def topics(self, recording: RecordingData, asked: Any) -> list[str]:  # noqa: ARG002
        """See `Condition`: the topics of the program's samples."""
        return list(dict.fromkeys(name for names in self._read(recording).values() for name in names))

    def steps(self, search: Search) -> Steps:
        """See `Condition`."""
        run = ProgramRun(self._program)
        # One list, so that an interrupt leaves no time without its value.
        rounds: list[tuple[int, int]] = []
        try:
            for time_ns, seconds, samples in self.moments(search, run):
                rounds.append((time_ns, UNKNOWN if samples is None else self._step(run, seconds, samples)))
        except KeyboardInterrupt:
            search.cut(rounds[-1][0] if rounds else search.recording.start_ns or 0)
        return steps([time_ns for time_ns, _ in rounds], [value for _, value in rounds])

    def moments(
        self, search: Search, run: ProgramRun, since_ns: int | None = None
    ) -> Iterator[tuple[int, float, Mapping[str, Callable[[], Any]] | None]]:
        """The steps of a run: nanoseconds, its seconds, and what makes its samples, or None if one is too old.

        It begins at a time, or without one at the start of the recording.
        """
        recording = search.recording
        since_ns = (recording.start_ns or 0) if since_ns is None else since_ns
        read = self._read(recording)
        all_topics = shown(recording.topics)
        now = Now(recording.start_ns or 0)
        instant = Instant(recording.path.name, list(all_topics.values()), now, recording.preferred)
        longest = {
            topic: TO_DRIVE_BY.after(usual_step(recording.series(topic).seconds))
            for names in read.values()
            for topic in names
            if KINDS[all_topics[topic].widget or ""].goes_stale
        }
        samples = {name: partial(self._sample, instant, name) for name in read if name != POSE}
        for time_ns in self._ticks(search, now, run, read, since_ns):
            is_old = any(now.seconds - now.seconds_of.get(topic, -np.inf) > most for topic, most in longest.items())
            yield time_ns, (time_ns - since_ns) / 1e9, None if is_old else samples

    def __str__(self) -> str:
        return f"{self._name} stops"

    def _ticks(
        self, search: Search, now: Now, run: ProgramRun, read: dict[str, list[str]], since_ns: int
    ) -> Iterator[int]:
        """Yield the times of the program's steps, and set ``now`` to each."""
        recording, period = search.recording, round(1e9 / self._rate)
        names = dict.fromkeys(name for names in read.values() for name in names)
        next_ns, looked = since_ns, 0
        for time_ns, samples in together({name: samples_of(recording, name) for name in names}):
            while next_ns < time_ns and next_ns <= search.end_ns:
                now.time_ns = next_ns
                yield next_ns
                next_ns += period
            now.put(time_ns, samples)
            for topic in read.get(POSE, ()) if time_ns >= since_ns else ():
                if topic in samples and (pose := samples[topic]().pose) is not None:
                    run.odometer.add(pose)
            looked += len(samples)
            if looked >= _BAR_EVERY:
                search.looked_at(looked)
                looked = 0
        search.looked_at(looked)
        while next_ns <= search.end_ns:
            now.time_ns = next_ns
            yield next_ns
            next_ns += period

    def _step(self, run: ProgramRun, seconds: float, samples: Mapping[str, Callable[[], Any]]) -> int:
        try:
            return YES if run.step(seconds, samples) == STANDSTILL else NO
        except NoSampleYetError:
            return UNKNOWN
        except UnnamedTopicError:
            raise
        except Exception as error:
            raise ConditionError(
                f"the program {self._name} failed at {seconds:.2f} s: {type(error).__name__}: {one_line(error)}"
            ) from error

    def _read(self, recording: RecordingData) -> dict[str, list[str]]:
        """Return the topics that are read for each parameter; odometry has the name of the pose."""
        found: dict[str, list[str]] = {}
        for name in self._asks_for:
            kind = kind_of_parameter(name)
            if name in ODOMETRY:
                found[POSE] = [recording.speeds(self._topics.get(POSE) or odometry(recording.topics)).topic]
            elif name in self._topics:
                recording.check(self._topics[name])
                found[name] = [self._topics[name]]
            elif kind is not None:
                same = [topic.name for topic in recording.topics if topic.widget == kind.name]
                found[name] = same if same and kind.roles[0].combine else [recording.only(kind.name)]
        return found

    def _sample(self, instant: Instant, name: str) -> Any:
        return instant[self._topics[name]] if name in self._topics else getattr(instant, name)
