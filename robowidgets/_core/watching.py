"""The methods of a widget that judge conditions on its samples."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from numbers import Real
from types import MappingProxyType
from typing import Any, overload

from ..samples.checks import number
from .judge import Judge
from .newest_sample import NewestSample
from .plotted_numbers import PlottedNumbers
from .user_function import name_of
from .watch import Watch

LONGEST_NAME = 40
"""Characters of the name of a watch."""


class JudgesConditions:
    """A widget on which conditions can be watched."""

    sample_name = "sample"
    """What programs call one sample: ``"scan"``."""

    driven_by_player = False
    judges_frames = False
    """Whether a player shows the verdicts on each sample of this widget."""

    _edition: int
    _judge: Judge | None = None
    _newest: NewestSample[Any]
    _plotted: PlottedNumbers

    @overload
    def watch(self, name: str, value: float, /) -> float: ...
    @overload
    def watch(self, condition: Any, name: str | None = None) -> Watch: ...
    def watch(self, condition: Any, name: Any = None) -> Any:
        """Judge a condition on each sample, ``watch(condition, name)``; or plot a number, ``watch(name, value)``.

        What comes first decides. A condition gets a lamp below the picture, a name gets a line there with its numbers
        of the last ten seconds. Conditions are judged in a thread of their own, on the newest sample. What raises is
        switched off, and the lamp says why. The changes are kept, and a program may wait for it: see `Watch`.

        Args:
            condition: a function of one sample that returns True or False, or None for unknown; or one of
                `robowidgets.conditions` that looks at samples of this widget. Or, for a number, its name.
            name: of the lamp, plain text. A watch of the same name is replaced. None: the name of the function, or the
                text of the condition. Or the number: it is plotted at the time of the newest sample; NaN and infinities
                are gaps.

        Returns:
            The `Watch` of the condition; or the number, so that the call may stand where the number is used.

        Raises:
            TypeError: no such condition, a lambda without a name, or no number.
            ValueError: the condition looks at samples of another widget; the name is empty or too long, or both a
                condition and a number would have it; there are more than eight numbers; a player of a recording moves
                this widget, and shows verdicts on lasers only: `Recording.find` finds the condition.

        Example:
            >>> from robowidgets import LaserWidget
            >>> laser = LaserWidget()
            >>> wall = laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
            >>> laser.watch("r", 0.42)
            0.42
        """
        if isinstance(condition, str):
            return self._plot(condition, name)
        if self.driven_by_player and not self.judges_frames:
            raise ValueError(
                "watch: a player moves this widget; give the condition to recording.find, and the spans to player.marks"
            )
        self._check(condition)
        named = _default_name(condition) if name is None else name
        if not isinstance(named, str):
            hint = f'; a number comes after its name: watch("r", {named!r})' if isinstance(named, Real) else ""
            raise TypeError(f"name: expected text, got {named!r}{hint}")
        _check_name(named)
        if named in self._plotted:
            raise ValueError(f"watch: {named!r} is the name of a number; unwatch({named!r}) removes it")
        watch = Watch(named, condition, self.sample_name, self._why_unknown)
        if self._judge is None:
            self._judge = Judge(self)  # type: ignore[arg-type]  # what is missing is in RobotWidget
        self._judge.put(watch)
        if self.driven_by_player:
            self._edition += 1
        return watch

    def unwatch(self, name: str) -> None:
        """Judge a condition no more, and remove its lamp; or remove a number with its line.

        Raises:
            KeyError: there is no watch of that name.
        """
        if name in self._plotted:
            with self._newest.lock:
                self._plotted.remove(name)
            self._say_more()
            return
        if name not in self.watched:
            raise KeyError(f"no watch {name!r}: there are {', '.join(self.watched) or 'none'}")
        if self._judge:
            self._judge.remove(name)
        if self.driven_by_player:
            self._edition += 1

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return MappingProxyType(self._judge.watches if self._judge else {})

    def _judged_on(self, sample: Any) -> dict[str, Any]:
        """The verdicts on a sample of a recording, as a text on it; None before the first sample."""
        watches = list(self.watched.values())
        return {"lamps": [watch.lamp_on(sample) for watch in watches], "judged": 0} if watches else {}

    def _plot(self, name: str, value: Any) -> float:
        if value is None or isinstance(value, str):
            raise TypeError(
                f"watch({name!r}): expected a number after its name, as watch({name!r}, 0.42), "
                f"or a condition before it; got {value!r}"
            )
        if self.driven_by_player:
            raise ValueError(f"watch({name!r}): a player moves this widget, and its samples are not of now")
        shown = number(f"watch({name!r})", value)
        _check_name(name)
        if name in self.watched:
            raise ValueError(f"watch({name!r}): a condition has this name; unwatch({name!r}) removes it")
        with self._newest.lock:
            self._plotted.put(name, shown, self._newest.sequence)
        self._say_more()
        return shown

    def _say_more(self) -> None:
        """Have the page told what else there is to say of the newest sample."""
        raise NotImplementedError

    def _why_unknown(self) -> str:
        """Why nothing is known of the present; empty while the newest sample is not stale."""
        raise NotImplementedError

    def _check(self, condition: Any) -> None:
        """TypeError or ValueError for what cannot be judged on samples of this widget."""
        if hasattr(condition, "judge"):
            others = condition.reads - {self.sample_name}
            if others:
                raise ValueError(
                    f"watch: {condition} looks at a {' and a '.join(sorted(others))}; "
                    f"this is a {type(self).__name__}, which has a {self.sample_name}"
                )
            return
        if not callable(condition):
            raise TypeError(
                f"watch: expected a function of one {self.sample_name}, or one of robowidgets.conditions, "
                f"got {condition!r}"
            )
        if inspect.iscoroutinefunction(condition):
            raise TypeError(f"watch: expected a plain function, got the coroutine function {name_of(condition)}")
        if not _takes_one(condition):
            raise TypeError(
                f"watch: expected a function of one {self.sample_name}; "
                f"{name_of(condition)} takes {inspect.signature(condition)}"
            )


def _check_name(name: str) -> None:
    if not 0 < len(name.strip()) <= LONGEST_NAME:
        raise ValueError(f"name: expected 1 to {LONGEST_NAME} characters, got {name!r}")


def _takes_one(function: Callable[..., Any]) -> bool:
    """Whether a function can be called with one argument; True where it does not tell."""
    try:
        signature = inspect.signature(function)
    except (TypeError, ValueError):
        return True
    try:
        signature.bind(None)
    except TypeError:
        return False
    return True


def _default_name(condition: Any) -> str:
    if hasattr(condition, "judge"):
        return str(condition)[:LONGEST_NAME]
    name = name_of(condition)
    if "<lambda>" in name:
        raise TypeError('watch: a lambda has no name; give one, as in name="wall"')
    return name.rpartition(".")[2][:LONGEST_NAME]
