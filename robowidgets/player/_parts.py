"""A player, as its followers and its pages in files know it."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

from ipywidgets import Widget

from .._core.sample_widget import SampleWidget
from .._layout import OneScreen
from .._widget_choice import WidgetChoice
from ..player_widget import PlayerWidget
from ..poses.places import Places
from ..recordings import RecordingData
from ..scanogram_widget import ScanogramWidget
from ._frames import Track


class PlayerView(NamedTuple):
    """A widget of the player, its choice, and its track."""

    widget: SampleWidget
    choice: WidgetChoice
    track: Track


def followers(views: Sequence[PlayerView], scanogram: ScanogramWidget | None) -> list[str]:
    """The names of the models that show the time itself, and let a person choose it."""
    own = [view.widget.model_id for view in views if view.widget.has_trait("time")]
    return [*([scanogram.model_id] if scanogram else []), *own]


class LeadingPlayer(Protocol):
    """A player that another one follows."""

    recording: RecordingData
    bar: PlayerWidget
    time: float

    @property
    def followed(self) -> LeadingPlayer | None:
        """The player that it follows itself; None: none."""

    def places(self) -> Places:
        """Where the robot was at each of its scans."""

    def observe(self, handler: Callable[[Any], None], names: str) -> None:
        """Have a function called when a trait changes."""

    def unobserve(self, handler: Callable[[Any], None], names: str) -> None:
        """End that."""


class PagedPlayer(Protocol):
    """A player of which a page in a file is made."""

    recording: RecordingData
    views: Sequence[PlayerView]
    bar: PlayerWidget
    scanogram: ScanogramWidget | None
    rerun: Any
    _dom_classes: Sequence[str]
    """As ipywidgets names them."""

    @property
    def duration(self) -> float:
        """Seconds of the recording."""

    @property
    def left_out(self) -> tuple[Any, ...]:
        """What the page has in another way, or cannot have."""

    def tracks_of(self, recording: RecordingData) -> list[tuple[SampleWidget, Track]]:
        """Its widgets, with their tracks in its recording, opened anew."""

    def arranged(self, scanogram: ScanogramWidget | None, screen: OneScreen) -> Sequence[Widget]:
        """All that it shows, from top to bottom, with a scanogram of its own or another, in its screen or another."""
