"""A topic to which somebody is connected."""

from __future__ import annotations

import logging
from collections.abc import Callable
from typing import Any, NamedTuple

from .._core.named_widget import MOST_LOGGED
from .._core.robot_widget import RobotWidget
from ..drive_widget import DriveWidget
from ._geometry import Geometry
from ._topics import Topic, no_such

log = logging.getLogger("robowidgets")


class Target(NamedTuple):
    """What takes the messages of a topic at once, in the transport's thread, and the widget that it belongs to, if any.

    It is code of this package: functions of a program are called by `FunctionCaller`.
    """

    hand: Callable[[Any], object]
    widget: RobotWidget[Any] | None

    @property
    def leads(self) -> bool:
        """Whether the topic is the widget's own; else it is one beside it, as a commanded speed is."""
        return self.widget is not None and getattr(self.hand, "__name__", "") == "update"


def target_of(given: Any) -> Target | Callable[[Any], object]:
    """The target that a widget, or a method of one (`SpeedWidget.command`), stands for; a function as it is."""
    if isinstance(given, RobotWidget):
        hand = getattr(given, "update", None)
        if callable(hand):
            return Target(hand, given)
    elif callable(given) and not isinstance(given, type):
        owner = getattr(given, "__self__", None)
        return Target(given, owner) if isinstance(owner, RobotWidget) else given
    hint = f"; make one of it: {given.__name__}()" if isinstance(given, type) else ""
    if isinstance(given, DriveWidget):
        hint = "; a pad that drives is connected to a feed: pad.connect(feed)"
    raise TypeError(
        f"expected a widget, a method of one like speed.command, or a function of a message; got {given!r}{hint}"
    )


class Link:
    """A topic, those to whom its messages go, and what is to be said of it."""

    def __init__(self, topic: str) -> None:
        self.topic = topic
        self.targets: tuple[Target, ...] = ()
        self.type = ""
        self.trouble = ""
        self.came = False
        self.ever = False
        self._retyped = ""
        self._failed = ""
        self._geometry = Geometry()
        self._logged: set[str] = set()

    def take(self, message: Any) -> bool:
        """Hand a message on; says whether there may be other words now. Raises nothing."""
        failed = ""
        for target in self.targets:
            failed = self._hand(target, message) or failed
        before = (self.came, self._failed, self._geometry.words)
        self._geometry.see(message)
        self.came, self.ever, self._failed = True, True, failed
        return before != (True, failed, self._geometry.words)

    def listed(self, topic: Topic | None) -> None:
        """Learn what is now known of the topic; None when it is not there."""
        if topic is None or not topic.offered:
            self.came = False
        kind = topic.type if topic else ""
        if kind and self.type and kind != self.type:
            self._retyped = f"{self.topic} was {self.type} and is now {kind}"
        self.type = kind or self.type

    def words(self, there: dict[str, Topic] | None, *, leads: bool = True) -> str:
        """What a person should know of the topic; empty when all is well.

        Beside another topic it need not be waited for: nobody may want to drive.
        """
        if self.came:
            several = f"{self.topic} is published as {self.type.replace(', ', ' and as ')}" if ", " in self.type else ""
            all_of_it = (self.trouble, self._failed, several or self._retyped, self._geometry.words)
            return "; ".join(filter(None, all_of_it))
        topic = there.get(self.topic) if there is not None else None
        gone = no_such(self.topic, there) if there is not None and topic is None and not self.ever else ""
        if gone or self.trouble:
            return "; ".join(filter(None, (gone, self.trouble)))
        if not leads:
            return ""
        if there is not None and (topic is None or not topic.offered):
            return f"nobody publishes {self.topic} {'any more' if self.ever else 'yet'}"
        return f"waiting for {self.topic}"

    def _hand(self, target: Target, message: Any) -> str:
        """Words where the target raised."""
        try:
            target.hand(message)
        except (Exception, SystemExit) as error:  # one that ends the thread would end the feed without a word
            words = f"a message of {self.topic} could not be used: {type(error).__name__}: {error}"
            self._log(words)
            return words
        return ""

    def _log(self, words: str) -> None:
        if words not in self._logged and len(self._logged) < MOST_LOGGED:
            self._logged.add(words)
            log.exception(words)
