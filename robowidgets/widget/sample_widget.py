"""The interface of widgets of samples for feeds and players."""

from __future__ import annotations

import weakref
from collections.abc import Callable, Sequence
from typing import Any, Protocol


class GroupedWidget(Protocol):
    """A widget that is frozen, released and stepped with others. See `FreezableWidget`."""

    paused: bool

    def join_group(self, name: str, group: weakref.WeakSet[Any]) -> None:
        """Join a group, with which the widget is frozen, released and stepped."""

    def on_group(self) -> None:
        """React to a new group; called once all its widgets have joined."""


class SampleWidget(GroupedWidget, Protocol):
    """The methods and attributes of a widget that feeds and players use. `RobotWidget` describes each of them."""

    title: str
    history: float
    has_rate: bool
    driven_by_player: bool
    column: str
    frame_traits: tuple[str, ...]
    comm: Any
    """None once the widget is closed."""

    @property
    def model_id(self) -> str:
        """Its name in the page."""

    @property
    def update(self) -> Callable[..., Any]:
        """A function of a message or a sample. In a widget of several sensors, the name of the sensor comes first."""

    def miss(self, count: int) -> None:
        """Note a number of messages that were missed by a widget that must get each message."""

    def has_trait(self, name: str) -> bool:
        """Return True if it has a trait of that name."""

    def observe(self, handler: Callable[[Any], Any], names: Sequence[str]) -> None:
        """Call a function when one of these traits changes."""

    def follow_player(self) -> None:
        """Follow a player in the page, which feeds this widget."""

    def name_after(self, topic: str, trait: str = "title") -> None:
        """Set a title to a topic, unless the user gave one."""

    def name_quietly(self, topic: str, trait: str = "title") -> Callable[[], None] | None:
        """Do so without calling observers; return a function that calls them, or None if the title has not changed."""

    def set_source(self, source: dict[str, Any], missing: str = "") -> None:
        """Show the source of its samples, and the status of the source."""

    def on_source_closed(self) -> None:
        """Note that its source is closed. Functions that work on its samples and do not return are ended."""

    @property
    def frame_of(self) -> Callable[..., tuple[dict[str, Any], bytes]]:
        """A function that returns the texts on a sample and its frame without the header.

        Samples of other roles follow by the names of their roles.
        """

    def within(self, start: float, end: float) -> dict[str, Any]:
        """Return the traits that differ on a page with a part of a recording, given in seconds."""

    def arrays_of(self, frame: bytes) -> tuple[int, int]:
        """Return the layout of a frame: the bytes before arrays of float32 of equal lengths, and their number."""

    def close(self) -> None:
        """Remove the widget from the page."""
