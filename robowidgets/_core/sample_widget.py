"""A widget of samples, as feeds and players know it."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any, Protocol


class GroupedWidget(Protocol):
    """A widget that is frozen, released and stepped with others. See `FreezableWidget`."""

    paused: bool

    def join_group(self, name: str, group: weakref.WeakSet[Any]) -> None:
        """Be frozen, released and stepped with the widgets of a group from now on."""

    def on_group(self) -> None:
        """Called when all widgets of a new group are in it."""


class SampleWidget(GroupedWidget, Protocol):
    """What feeds and players use of a widget. See `RobotWidget`, which describes each of these."""

    title: str
    history: float
    has_rate: bool
    driven_by_player: bool
    column: str
    frame_traits: tuple[str, ...]
    comm: Any
    """None once it is closed."""

    @property
    def model_id(self) -> str:
        """The name by which the page knows it."""

    @property
    def update(self) -> Callable[..., Any]:
        """Takes a message or a sample; of a widget of several sensors, the name of one before it."""

    def miss(self, count: int) -> None:
        """Note that so many messages came that it does not get; of a widget that gets each message."""

    def has_trait(self, name: str) -> bool:
        """Whether it has a trait of that name."""

    def observe(self, handler: Callable[[Any], Any], names: Sequence[str]) -> None:
        """Have a function called when one of some traits changes."""

    def follow_player(self) -> None:
        """Have a player in the page say what is on show."""

    def name_after(self, topic: str, trait: str = "title") -> None:
        """Set a title to a topic, unless the user gave one."""

    def name_quietly(self, topic: str, trait: str = "title") -> Callable[[], None] | None:
        """Do so, except for the call of observers; returns what calls them, or None if the title is as it was."""

    def set_source(self, source: dict[str, Any], missing: str = "") -> None:
        """Show where its samples come from, and the status of that."""

    def on_source_closed(self) -> None:
        """Note that its source is closed: whatever works on its samples, and does not return, is ended."""

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """The text on a sample, and its frame without the header."""

    def within(self, start: float, end: float) -> dict[str, Any]:
        """What of its traits differs in a page of a stretch of a recording, in seconds."""

    def arrays_of(self, frame: bytes) -> tuple[int, int]:
        """What a frame holds: bytes before arrays of float32 of equal lengths, and their number."""

    def close(self) -> None:
        """Remove it from the page."""
