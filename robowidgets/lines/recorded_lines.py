"""The lines of a function over a recording, with the values at the time that a player shows."""

from __future__ import annotations

import json
import sys
from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import partial
from typing import Any, NamedTuple

from ..behaviors.lines.packed import packed_function, packed_step
from ..behaviors.recorded_program import RecordedProgramError, recorded_program
from ..behaviors.version import RATE
from ..recordings import RecordingData
from ..recordings.program_log import ProgramVersion
from ..recordings.search.lines import MadeStep
from ..recordings.search.spans import Spans
from ..widget.robot_widget import RobotWidget
from .lines_at_time import LinesAtTime
from .traits import LinesTraits

OFFER = "Run this code over the recording"
"""The button of a program whose text is in the recording: nothing of a file runs before the user has read it."""
MOST_MARKED = 2000
"""Spans of a line that are marked."""


class _Shown(NamedTuple):
    """A time, and the step that is shown at it, or None without one."""

    seconds: float
    made: MadeStep | None


class RecordedLinesWidget(LinesTraits, RobotWidget[_Shown]):
    """The lines of a function, or of the recorded programs, at the time that a player shows.

    `ask` computes the values of a time in another thread; the newest time wins.

    Args:
        recording: the recording, which is opened again to compute steps.
        function: the function or the program, or None for the programs whose text is in the recording.
        rate: steps a second of a function that is stepped through time.
        topics: the topics that a function of one moment may read, or None for all that a widget shows.
        on_spans: called with the spans of a line that the user chooses, or None.
        **kwargs: keywords of the widget.
    """

    _unnamed = 4

    column = "wide"
    goes_stale = False
    has_rate = False
    sample_name = "step"
    send_interval = 0.1

    _job: LinesAtTime | None = None

    def __init__(
        self,
        recording: RecordingData,
        function: Any = None,
        rate: float = RATE,
        topics: str | Iterable[str] | None = None,
        on_spans: Callable[[Spans | None], object] = lambda _: None,
        **kwargs: Any,
    ) -> None:
        self._recording, self._function = recording, function
        self._versions: Sequence[ProgramVersion] = () if function is not None else recording.programs
        self._version: ProgramVersion | None = None
        self._is_allowed = function is not None
        self._wanted = 0.0
        self._told_complete = False
        self._on_spans = on_spans
        super().__init__(history=0, **kwargs)
        self.on_msg(self._on_page)
        self.observe(self._on_folded, "folded")
        if function is not None:
            self._begin(lambda: function, rate, topics, (), None, ("", 0))
            self.name_after(str(getattr(function, "name", "") or getattr(function, "__name__", "lines")))
        self.ask(0.0)

    def ask(self, seconds: float) -> None:
        """Show the values at a time of the recording. Any thread may call this."""
        self._wanted = seconds
        if self._function is None:
            self._follow(seconds)
        if self._job is not None and not self.folded:
            self._job.ask(seconds)

    def compute(self) -> None:
        """Run the recorded code, whose values are then shown."""
        self._is_allowed, self._version = True, None
        self.ask(self._wanted)

    def when(self, line: int) -> Spans:
        """Return the spans in which a line was true, or reached, as `RecordedLines.when` does.

        Raises:
            RuntimeError: the recording has not been computed to its end yet.
            ValueError: no code is on this line.
        """
        job = self._job
        if job is None or job.lines is None or not job.is_complete:
            raise RuntimeError("the lines over the whole recording are still being computed: ask again in a moment")
        return job.lines.when(line)

    def choose(self, line: int | None) -> None:
        """Mark the spans of a line, by its number in the file or cell, or of none."""
        found = None if line is None else self.when(line)
        self._chosen = {} if found is None else {"line": line, "spans": len(found), "what": found.condition}
        self._on_spans(None if found is None else found[:MOST_MARKED])

    def close(self) -> None:
        """Remove the widget from the page."""
        if "_watches" in vars(self):  # else the constructor raised before it set them
            if self._job is not None:
                self._job.close()
            super().close()

    def _describe(self) -> str:
        return f"{self._code.get('name', '')} at {self._wanted:.2f} s".strip()

    # -- versions ------------------------------------------------------------------------------------------------------

    def _follow(self, seconds: float) -> None:
        """Show the version that was in force at a time, or the first one."""
        at = next((i for i in reversed(range(len(self._versions))) if self._versions[i].seconds <= seconds), 0)
        version = self._versions[at] if self._versions else None
        if version is None or version is self._version:
            return
        self._version = version
        if self._job is not None:
            self._job.close()
        self._job = None
        self.choose(None)
        self.name_after(version.name)
        key = version.name, version.number
        try:
            program = recorded_program(version.name, version.text, f"<{version.name}, version {version.number}>")
        except RecordedProgramError as error:
            self._set("_code", _code_of(key, [_unread(version, str(error))]))
            self._set("_offer", "")
            return
        self._set("_code", _code_of(key, [_without_values(program.name, program.first, program.lines)]))
        self._set("_drive", {"from": 0.0, "to": self._recording.duration})
        self._set("_offer", "" if self._is_allowed else OFFER)
        self._show(_Shown(seconds, None))
        if self._is_allowed:
            end = self._versions[at + 1].seconds if at + 1 < len(self._versions) else self._recording.duration
            notebook: Mapping[str, Any] = vars(sys.modules["__main__"])
            make = partial(program.make, notebook)
            self._begin(make, program.rate, None, program.topics.values(), (version.seconds, end), key)

    def _begin(
        self,
        make: Callable[[], Any],
        rate: float,
        topics: Any,
        preferred: Iterable[str],
        span: tuple[float, float] | None,
        key: tuple[str, int],
    ) -> None:
        self._key, self._span = key, span or (0.0, self._recording.duration)
        self._told_complete = False
        self._job = LinesAtTime(
            self._recording.reopened,
            make,
            self._on_result,
            rate=rate,
            topics=topics,
            preferred=(*self._recording.preferred, *preferred),
            span=span,
        )
        self._set("_drive", {"from": self._span[0], "to": self._span[1]})

    # -- from the thread of the steps ----------------------------------------------------------------------------------

    def _on_result(self) -> None:
        job = self._job
        if job is None:
            return
        shown = job.shown
        calls = [*(job.lines.calls if job.lines is not None else []), *(shown.step.calls if shown is not None else [])]
        functions = list({call.source.key: packed_function(call) for call in calls}.values())
        if functions:
            code = _code_of((self._key[0] or self.title, self._key[1]), functions)
            if code != self._code:
                self._set("_code", code)
        if job.graphs is not None and job.is_complete and not self._told_complete:
            self._told_complete = True
            self._set("_drive", {"from": self._span[0], "to": self._span[1], **job.graphs.packed()})
        at = job.shown_at
        self._show(_Shown(self._wanted if at is None else at, shown))

    def _set(self, name: str, value: Any) -> None:
        """Set a trait without its observers, in any thread."""
        self._trait_values[name] = value
        self.send_state(name)

    def _about_sample(self, sample: _Shown) -> dict[str, Any]:
        job = self._job
        if job is None:
            return {"version": self._version.number if self._version else 0}
        made = sample.made
        said = made.error if made is not None and not any(call.error for call in made.step.calls) else ""
        notes = [note for note in (job.error, said) if note]
        return {"version": self._key[1], "assumes": self._assumes(job), "notes": notes}

    def _assumes(self, job: LinesAtTime) -> str:
        """Return in words what the values assume, since not all that the function read is recorded."""
        if job.lines is None:
            return ""
        maker = job.lines.maker
        how = "called at each recorded sample"
        if maker.is_program:
            how = f"stepped {maker.rate:g} times a second from {self._span[0]:.2f} s on, with a state of its own"
        reading = "" if job.is_complete or job.error else "; the rest of the recording is being computed"
        return f"computed again: {how}; what is outside of the function is as it is now{reading}"

    def _pack(self, sample: _Shown) -> bytes:
        job, made = self._job, sample.made
        step: dict[str, Any] = {"number": 0, "time": sample.seconds, "at": sample.seconds, "given": [], "calls": []}
        if made is not None and job is not None:
            seconds = job.seconds_of(made)
            step = {**packed_step(made.step), "time": seconds, "at": seconds}
        lines = job.lines if job is not None else None
        packed = {
            "key": self._code.get("key", ""),
            "steps": [step],
            "total": len(lines) if lines is not None else 0,
            "totals": lines.counts() if lines is not None else {},
        }
        return json.dumps(packed).encode()

    # -- from the page -------------------------------------------------------------------------------------------------

    def _on_folded(self, _change: Any) -> None:
        self.ask(self._wanted)

    def _on_page(self, _widget: Any, content: Any, _buffers: Any) -> None:
        """Mark the spans of a line, or compute the values. Called in the main thread or in a subshell's."""
        if not isinstance(content, dict):
            return
        if content.get("compute"):
            self.compute()
        elif "when" in content:
            line = content["when"]
            try:
                self.choose(line if isinstance(line, int) else None)
            except (RuntimeError, ValueError) as error:
                self.send({"refused": str(error)})


def _code_of(key: tuple[str, int], functions: list[dict[str, Any]]) -> dict[str, Any]:
    name, number = key
    return {"key": f"{name} {number}", "name": name, "version": number, "functions": functions}


def _unread(version: ProgramVersion, why: str) -> dict[str, Any]:
    """Return the text of a version, which makes no function, for the page."""
    texts = version.text.rstrip("\n").split("\n")
    return _without_values(version.name, 1, texts, why)


def _without_values(name: str, first: int, texts: Sequence[str], why: str = "") -> dict[str, Any]:
    return {"key": name, "name": name, "first": first, "texts": texts, "code": [], "why": why}
