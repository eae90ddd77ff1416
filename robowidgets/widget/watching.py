"""The watches of a widget: conditions on its samples, and numbers that a program plots."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from numbers import Real
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol

from ..runtime.user_function import name_of
from ..samples.checks import number
from .frame_judge import FrameJudge
from .judge import Judge, JudgedWidget
from .newest_sample import NewestSample
from .plotted_numbers import PlottedNumbers
from .watch import Watch

LONGEST_NAME = 40
"""Characters of the name of a watch."""


class WatchedWidget(JudgedWidget, Protocol):
    """A widget on which conditions and numbers can be watched."""

    @property
    def sample_name(self) -> str:
        """The name of one sample in programs, such as ``"scan"``."""

    @property
    def packs_now(self) -> bool:
        """True if a frame shows the state when it is packed, and not a sample."""

    @property
    def driven_by_player(self) -> bool:
        """True while a player moves it."""

    @property
    def judges_frames(self) -> bool:
        """True if a player shows the verdicts on each sample."""


class Hooks(NamedTuple):
    """The functions that the watches of a widget call.

    Args:
        to_judge: returns the sample to judge for a sample on show, or None before the first.
        why_unknown: returns why the present state is unknown, or empty while the newest sample is not stale.
        say_more: sends the newest sample again with later texts on it.
        renew_frames: makes a player show its samples again.
    """

    to_judge: Callable[[Any], Any]
    why_unknown: Callable[[], str]
    say_more: Callable[[], None]
    renew_frames: Callable[[], None]


class Watches:
    """The watches of a widget: conditions, which a `Judge` judges on its samples, and numbers, which it plots.

    Attributes:
        judge: judges the conditions, or None before the first.
        numbers: the plotted numbers.
    """

    def __init__(self, widget: WatchedWidget, newest: NewestSample[Any], hooks: Hooks) -> None:
        self._widget, self._newest, self._hooks = widget, newest, hooks
        self.judge: Judge | None = None
        self._frames: FrameJudge | None = None
        """Judges the samples of a recording, or None before the first."""
        self.numbers = PlottedNumbers()

    def watch(self, condition: Any, name: Any) -> Any:
        """See `RobotWidget.watch`."""
        if isinstance(condition, str):
            return self._plot(condition, name)
        widget = self._widget
        if widget.driven_by_player and not widget.judges_frames:
            raise ValueError(
                "watch: a player moves this widget; give the condition to recording.find, and the spans to player.marks"
            )
        self._check(condition)
        named = default_name(condition) if name is None else name
        if not isinstance(named, str):
            hint = f'; a number comes after its name: watch("r", {named!r})' if isinstance(named, Real) else ""
            raise TypeError(f"name: expected text, got {named!r}{hint}")
        check_watch_name(named)
        if named in self.numbers:
            raise ValueError(f"watch: {named!r} is the name of a number; unwatch({named!r}) removes it")
        watch = Watch(named, condition, widget.sample_name, self._hooks.why_unknown)
        if self.judge is None:
            self.judge = Judge(widget, self._newest, self._hooks.to_judge, waits=not widget.packs_now)
        self.judge.put(watch)
        self._hooks.renew_frames()
        return watch

    def unwatch(self, name: str) -> None:
        """See `RobotWidget.unwatch`."""
        if name in self.numbers:
            with self._newest.lock:
                self.numbers.remove(name)
            self._hooks.say_more()
            return
        if self.judge is None or name not in self.judge.watches:
            raise KeyError(f"no watch {name!r}: there are {', '.join(self.by_name) or 'none'}")
        self.judge.remove(name)
        self._hooks.renew_frames()

    @property
    def by_name(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return MappingProxyType(self.judge.watches if self.judge else {})

    def judged_on(self, sample: Any) -> dict[str, Any]:
        """Return the verdicts on a sample of a recording, or on None before the first, as a text on it."""
        watches = list(self.by_name.values())
        if not watches:
            return {}
        frames = self._frames = self._frames or FrameJudge()
        return {"lamps": [frames.lamp_on(watch, sample) for watch in watches], "judged": 0}

    def make_locks(self) -> None:
        """Make free locks; see `NewestSample.make_locks`."""
        self._frames = None
        if self.judge:
            self.judge.make_runner()

    def end_late(self) -> None:
        """See `Judge.end_late`."""
        if self.judge:
            self.judge.end_late()

    def close(self) -> None:
        """End the thread, and the waits for its watches."""
        if self._frames:
            self._frames.close()
        if self.judge:
            self.judge.close()

    def _plot(self, name: str, value: Any) -> float:
        if value is None or isinstance(value, str):
            raise TypeError(
                f"watch({name!r}): expected a number after its name, as watch({name!r}, 0.42), "
                f"or a condition before it; got {value!r}"
            )
        if self._widget.driven_by_player:
            raise ValueError(
                f"watch({name!r}): a player moves this widget; robowidgets.plot(recording, ...) plots numbers"
            )
        shown = number(f"watch({name!r})", value)
        check_watch_name(name)
        if name in self.by_name:
            raise ValueError(f"watch({name!r}): a condition has this name; unwatch({name!r}) removes it")
        with self._newest.lock:
            self.numbers.put(name, shown, self._newest.sequence)
        self._hooks.say_more()
        return shown

    def _check(self, condition: Any) -> None:
        """Raise TypeError or ValueError for a condition that cannot be judged on samples of this widget."""
        sample_name = self._widget.sample_name
        if hasattr(condition, "judge"):
            others = condition.reads - {sample_name}
            if others:
                raise ValueError(
                    f"watch: {condition} reads a {' and a '.join(sorted(others))}; "
                    f"this is a {type(self._widget).__name__}, which has a {sample_name}"
                )
            return
        if not callable(condition):
            raise TypeError(
                f"watch: expected a function of one {sample_name}, or one of robowidgets.conditions, got {condition!r}"
            )
        if inspect.iscoroutinefunction(condition):
            raise TypeError(f"watch: expected a plain function, got the coroutine function {name_of(condition)}")
        if not _takes_one(condition):
            raise TypeError(
                f"watch: expected a function of one {sample_name}; "
                f"{name_of(condition)} takes {inspect.signature(condition)}"
            )


def check_watch_name(name: str) -> None:
    """Raise ValueError for a name that is empty or too long."""
    if not 0 < len(name.strip()) <= LONGEST_NAME:
        raise ValueError(f"name: expected 1 to {LONGEST_NAME} characters, got {name!r}")


def _takes_one(function: Callable[..., Any]) -> bool:
    """Return True if a function can be called with one argument, or if its signature is unknown."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return True
    try:
        signature.bind(None)
    except TypeError:
        return False
    return True


def default_name(condition: Any) -> str:
    """Return the name of a condition for which no name was given. Raise TypeError for a lambda, which has no name."""
    if hasattr(condition, "judge"):
        return str(condition)[:LONGEST_NAME]
    name = name_of(condition)
    if "<lambda>" in name:
        raise TypeError('watch: a lambda has no name; give one, as in name="wall"')
    return name.rpartition(".")[2][:LONGEST_NAME]
