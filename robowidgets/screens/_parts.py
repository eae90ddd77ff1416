"""Protocols of a player for its followers and its pages in files."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple, Protocol

from ..kinds.choice import WidgetChoice
from ..player_widget import PlayerWidget
from ..poses.places import Places
from ..recordings import RecordingData
from ..scanogram_widget import ScanogramWidget
from ..tracks import Track
from ..widget.sample_widget import SampleWidget
from .layout import ScreenPlaces


class PlayerView(NamedTuple):
    """A widget of the player, its choice, and its track."""

    widget: SampleWidget
    choice: WidgetChoice
    track: Track


def followers(views: Sequence[PlayerView], scanogram: ScanogramWidget | None) -> list[str]:
    """Return the models of the widgets that show the time themselves and let the user choose it."""
    own = [view.widget.model_id for view in views if view.widget.has_trait("time")]
    return [*([scanogram.model_id] if scanogram else []), *own]


class LeadingPlayer(Protocol):
    """A player that another one follows."""

    recording: RecordingData
    bar: PlayerWidget
    time: float

    @property
    def followed(self) -> LeadingPlayer | None:
        """The player that this one follows, or None."""

    def places(self) -> Places:
        """Return the places of the robot at its scans."""

    def observe(self, handler: Callable[[Any], None], names: str) -> None:
        """Call a function when a trait changes."""

    def unobserve(self, handler: Callable[[Any], None], names: str) -> None:
        """Stop calling a function when a trait changes."""


class PagedPlayer(Protocol):
    """A player from which a page in a file is made."""

    model_id: str
    recording: RecordingData
    views: Sequence[PlayerView]
    bar: PlayerWidget
    scanogram: ScanogramWidget | None
    rerun: Any

    @property
    def duration(self) -> float:
        """Seconds of the recording."""

    @property
    def problems(self) -> list[str]:
        """The problems of the recording that are problems of the screen, too."""

    def tracks_of(self, recording: RecordingData) -> list[tuple[SampleWidget, Track]]:
        """Return its widgets, each with a track that reads the given recording."""

    def rooms_of(self, places: ScreenPlaces) -> list[dict[str, Any]]:
        """Return widgets for the page, by their places."""

    def arranged(self, scanogram: ScanogramWidget | None) -> ScreenPlaces:
        """Return the places of all widgets, with the given scanogram among them."""
