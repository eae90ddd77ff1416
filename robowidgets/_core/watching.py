"""The methods of a widget that judge conditions on its samples."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Any

from .judge import Judge
from .user_function import name_of
from .watch import Watch

LONGEST_NAME = 40
"""Characters of the name of a watch."""


class JudgesConditions:
    """A widget on which conditions can be watched."""

    sample_name = "sample"
    """What programs call one sample: ``"scan"``."""

    driven_by_player = False
    _judge: Judge | None = None

    def watch(self, condition: Any, name: str | None = None) -> Watch:
        """Judge a condition on each sample from now on, and show its verdict as a lamp below the picture.

        The condition is judged in a thread of its own, on the newest sample. What raises is switched off, and the lamp
        says why. The changes are kept, and a program may wait for it: see `Watch`.

        Args:
            condition: a function of one sample that returns True or False, or None for unknown; or one of
                `robowidgets.conditions` that looks at samples of this widget.
            name: of the lamp, plain text. A watch of the same name is replaced. None: the name of the function, or the
                text of the condition.

        Raises:
            TypeError: no such condition, or a lambda without a name.
            ValueError: the condition looks at samples of another widget; the name is empty or too long; a player of a
                recording moves this widget, so `Recording.find` is what finds the condition.

        Example:
            >>> from robowidgets import LaserWidget
            >>> laser = LaserWidget()
            >>> wall = laser.watch(lambda scan: scan.distance("front") < 0.5, name="wall")
        """
        if self.driven_by_player:
            raise ValueError(
                "watch: a player moves this widget; give the condition to recording.find, and the spans to player.marks"
            )
        self._check(condition)
        named = _default_name(condition) if name is None else name
        if not isinstance(named, str):
            raise TypeError(f"name: expected text, got {named!r}")
        if not 0 < len(named.strip()) <= LONGEST_NAME:
            raise ValueError(f"name: expected 1 to {LONGEST_NAME} characters, got {named!r}")
        watch = Watch(named, condition, self.sample_name, self._why_unknown)
        if self._judge is None:
            self._judge = Judge(self)  # type: ignore[arg-type]  # what is missing is in RobotWidget
        self._judge.put(watch)
        return watch

    def unwatch(self, name: str) -> None:
        """Judge a condition no more, and remove its lamp.

        Raises:
            KeyError: there is no watch of that name.
        """
        if name not in self.watched:
            raise KeyError(f"no watch {name!r}: there are {', '.join(self.watched) or 'none'}")
        if self._judge:
            self._judge.remove(name)

    @property
    def watched(self) -> Mapping[str, Watch]:
        """The watches by name."""
        return MappingProxyType(self._judge.watches if self._judge else {})

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
