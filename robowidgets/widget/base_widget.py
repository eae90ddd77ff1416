"""The base of all widgets: front end, title, and errors for unknown keywords and traits."""

from __future__ import annotations

import logging
import reprlib
from collections.abc import Callable, Collection, Mapping, Sequence
from functools import partial
from typing import Any, ClassVar

import traitlets

from ..runtime.log_once import LogOnce
from ..runtime.text import nearest_name
from .front_end import FrontEndWidget
from .in_words import CLOSED, InWords
from .traits import Flag

log = logging.getLogger("robowidgets")

_HOST_TRAITS = ("layout", "tooltip", "tabbable")


class NamedWidget(InWords, FrontEndWidget):
    """A widget with a title, which refuses unknown keywords and traits, and logs each error once."""

    title = traitlets.Unicode(help="Title in the header, such as the topic. Plain text.").tag(sync=True)
    header = Flag(True, help="True to show the title and the controls above the picture.").tag(sync=True)

    _unnamed = 0
    """The number of arguments without a name: of some widgets the first is a feed."""
    _keywords: tuple[str, ...] = ()
    """Keywords that are not traits."""
    _usual = "title='/topic'"
    """An example of a keyword, for errors."""
    _meant: ClassVar[Mapping[str, str]] = {}
    """Names of keywords and attributes by likely wrong names, for hints. Entries of the base classes count, too."""
    _instead: ClassVar[Mapping[str, str]] = {"show": "display(widget)"}
    """Code that does what a likely wrong name stands for, for hints. Entries of the base classes count, too."""
    _closed = False

    def __new__(cls, *unnamed: Any, **kwargs: Any) -> Any:
        """Refuse positional arguments before anything is created."""
        for extra in unnamed[cls._unnamed :]:
            raise TypeError(f"{cls.__name__}() takes keywords only, like {cls._usual}; got {reprlib.repr(extra)}")
        return super().__new__(cls, **kwargs)

    def __init__(self, **kwargs: Any) -> None:
        self._error_log = LogOnce(log.error)
        self._named_after: dict[str, str] = {}
        settable = [*self._keywords, *filter(self._is_ours, self.trait_names())]
        for name in kwargs:
            if name not in settable and name != "_dom_classes":  # set by views that place it
                meant = self._hint("_meant", name)
                raise TypeError(_unknown(f"{type(self).__name__}()", "keyword", name, settable, meant))
        super().__init__(**kwargs)

    def __setattr__(self, name: str, value: Any) -> None:
        if not name.startswith("_") and not hasattr(type(self), name):
            settable = [n for n in self.trait_names() if self._is_ours(n)]
            raise AttributeError(_unknown(type(self).__name__, "trait", name, settable, self._hint("_meant", name)))
        if getattr(getattr(type(self), name, None), "fset", True) is None:
            instead = self._hint("_instead", name)
            hint = f"; did you mean {instead!r}?" if instead else ""
            raise AttributeError(f"{type(self).__name__}.{name} cannot be set{hint}")
        super().__setattr__(name, value)

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        self._closed = True

    def check_open(self, call: str) -> None:
        """Raise RuntimeError, which begins with the call, if the widget is closed: the page has forgotten it."""
        if self.comm is None:
            raise RuntimeError(f"{call}: this widget is closed; show a new one")

    def __repr__(self) -> str:
        if self._closed:
            return CLOSED
        name, shown = f"{type(self).__name__} {self.title}".rstrip(), self._summary()
        return f"<{name}: {shown}>" if shown else f"<{name}>"

    def _summary(self) -> str:
        """Return one line on what the widget shows, for its repr."""
        return ""

    @classmethod
    def _is_ours(cls, name: str) -> bool:
        if name in _HOST_TRAITS:
            return True
        return not name.startswith("_") and any(name in vars(c) for c in cls.__mro__ if issubclass(c, FrontEndWidget))

    @classmethod
    def _hint(cls, table: str, name: str) -> str:
        """Return the entry for a name in `_meant` or `_instead` of the class, or else of a base; empty without any."""
        return next((vars(c)[table][name] for c in cls.__mro__ if name in vars(c).get(table, ())), "")

    def name_after(self, topic: str, trait: str = "title") -> None:
        """Set the title to a topic, instead of the previous topic, unless the user gave a title."""
        call_observers = self.name_quietly(topic, trait)
        if call_observers is not None:
            call_observers()

    def name_quietly(self, topic: str, trait: str = "title") -> Callable[[], None] | None:
        """Do what `name_after` does, except for the call of observers.

        Returns:
            A function that calls the observers, or None if the title has not changed. Observers may be code of the
            user: call them without a lock, and not in a thread that carries speeds.
        """
        before, title = self._named_after.get(trait), getattr(self, trait)
        if topic == before or title not in ("", before):
            return None
        self._named_after[trait] = topic
        if topic == title:
            return None
        self._trait_values[trait] = topic
        change = traitlets.Bunch(name=trait, old=title, new=topic, owner=self, type="change")
        return partial(self.notify_change, change)

    def _log_once(self, text: str) -> None:
        self._error_log(f"{type(self).__name__} {self.title}: {text}", text)


def refuse_unnamed(method: str, unnamed: Sequence[Any], call: str) -> None:
    """Raise TypeError if there are arguments without a name; it shows the call that takes them by name."""
    if unnamed:
        raise TypeError(
            f"{method}() takes one message, or numbers by name: {call}; got {', '.join(map(reprlib.repr, unnamed))}"
        )


def check_given(
    method: str, message: Any, named: Collection[str], instead: str, known: Collection[str] = (), noun: str = "fields"
) -> None:
    """Raise TypeError unless there is either a message, or values by known names.

    Args:
        method: the name of the method that got them.
        message: the message, or None.
        named: the names of the values.
        instead: the values that it takes instead of a message: ``"or linear and angular (three numbers each)"``.
        known: the accepted names. If empty, any name is accepted.
        noun: for the values.
    """
    unknown = [name for name in named if name not in known] if known else []
    if unknown:
        near = [meant for name in unknown if (meant := nearest_name(name, known))]
        hint = f"; did you mean {', '.join(map(repr, near))}? It" if near else "; it"
        raise TypeError(f"{method}() has no field {', '.join(map(repr, unknown))}{hint} takes a message, {instead}")
    if message is None and not named:
        raise TypeError(f"{method}() needs a message, {instead}")
    if message is not None and named:
        raise TypeError(f"{method}() takes a message or {noun}, not both; got a message and {', '.join(named)}")


def _unknown(of: str, what: str, name: str, known: list[str], meant: str) -> str:
    near = meant or nearest_name(name, known)
    hint = f"; did you mean {near!r}?" if near else "."
    return f"{of} has no {what} {name!r}{hint} It takes: {', '.join(sorted(known))}"
