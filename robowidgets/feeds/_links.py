"""Who is connected to which topics, and what each widget is told of them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from .._core.robot_widget import RobotWidget
from ._functions import FunctionCaller
from ._link import Link, Target
from ._topics import Topic


class Links:
    """The links of a feed, by topic. One thread at a time may use them.

    Args:
        down: why nothing comes at all, to begin with.
        functions: the functions that are connected, too.

    Attributes:
        there: the topics there are, by name; None until that is known.
        down: why nothing comes at all; empty when all is well.
    """

    def __init__(self, down: str, functions: FunctionCaller) -> None:
        self._functions = functions
        self.by_topic: dict[str, Link] = {}
        self.there: dict[str, Topic] | None = None
        self.down = down
        self._widgets: dict[RobotWidget[Any], list[tuple[Link, Target]]] = {}

    def connect(self, topic: str, targets: Sequence[Target]) -> None:
        """Add targets to a topic; those that it has already are not added again."""
        link = self.by_topic.get(topic)
        if link is None:
            link = self.by_topic[topic] = Link(topic)
            link.listed((self.there or {}).get(topic))
        for target in targets:
            if target in link.targets:
                continue
            link.targets += (target,)
            if target.widget is not None:
                self._widgets.setdefault(target.widget, []).append((link, target))
        self.tell(link)

    def disconnect(self, topic: str, targets: Sequence[Target]) -> None:
        """Take targets off a topic."""
        link = self.by_topic.get(topic)
        if link is None:
            return
        link.targets = tuple(target for target in link.targets if target not in targets)
        for target in targets:
            if target.widget is not None:
                self._leave(target.widget, link, target)
        self.prune()

    def prune(self) -> None:
        """Forget the topics to which nothing is connected any more."""
        used = {function.topic for function in self._functions.functions}
        self.by_topic = {topic: link for topic, link in self.by_topic.items() if link.targets or topic in used}

    def learn(self, there: dict[str, Topic]) -> None:
        """Learn which topics there are now."""
        self.there = there
        for link in self.by_topic.values():
            link.listed(there.get(link.topic))
        self.tell_all()

    def lose(self, why: str) -> None:
        """Learn that nothing comes any more, until it does again."""
        self.down = why
        for link in self.by_topic.values():
            link.came = False
        self.tell_all()

    def words_of(self, topic: str) -> str:
        """What a person should know of a topic, connected or not; empty when all is well."""
        words = self.down or (self.by_topic.get(topic) or Link(topic)).words(self.there)
        return "; ".join(filter(None, (words, self._functions.status_of(topic))))

    def tell(self, link: Link) -> None:
        """Tell the widgets of a link what is to be known."""
        for target in link.targets:
            if target.widget is not None:
                self._say(target.widget)

    def tell_all(self) -> None:
        """Tell every widget what is to be known."""
        for widget in self._widgets:
            self._say(widget)

    def _leave(self, widget: RobotWidget[Any], link: Link, target: Target) -> None:
        left = [pair for pair in self._widgets.pop(widget, []) if pair != (link, target)]
        if left:
            self._widgets[widget] = left
        self._say(widget)

    def _say(self, widget: RobotWidget[Any]) -> None:
        links = sorted(self._widgets.get(widget, []), key=_rank)
        if not links:
            widget._source = {}
            return
        _name(widget, links)
        first = links[0][0]
        words = [link.words(self.there, leads=link is first) for link, _ in self._unmended(widget, links)]
        told = self.down or "; ".join(dict.fromkeys(filter(None, words)))
        failed = "; ".join(filter(None, (self._functions.status_of(link.topic) for link, _ in links)))
        widget._source = {
            "topic": first.topic,
            "type": first.type,
            "words": told,
            "error": failed,
            "lost": bool(self.down) and not first.came,
        }

    def _unmended(self, widget: RobotWidget[Any], links: Sequence[tuple[Link, Target]]) -> list[tuple[Link, Target]]:
        """The links without topics that are not there, where one that was connected later delivers in their place."""
        made = self._widgets[widget]
        return [
            (link, target)
            for link, target in links
            if self.there is None
            or link.topic in self.there
            or not any(later.ever and target == other for later, other in made[made.index((link, target)) + 1 :])
        ]


def _rank(pair: tuple[Link, Target]) -> tuple[bool, bool, bool]:
    """First what leads, and of that what delivers, or did before all was lost."""
    link, target = pair
    return not target.leads, not link.came, not link.ever


def _name(widget: RobotWidget[Any], links: Sequence[tuple[Link, Target]]) -> None:
    """Have its titles tell the first of its own topics, and the first that it takes commands from."""
    first, target = links[0]
    if target.leads:
        widget._name_after(first.topic)
    command = getattr(widget, "command", None)
    for link in [link for link, target in links if target.hand == command][:1]:
        widget._name_after(link.topic, "command_title")
