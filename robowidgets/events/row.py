"""The row of events."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..kinds import OnDemandWidget
from ..messages.event import SAID_TYPES

if TYPE_CHECKING:
    from ..events_widget import EventsWidget
    from .frames import EventFrames


def _widget() -> type[EventsWidget]:
    from ..events_widget import EventsWidget

    return EventsWidget


def _frames() -> type[EventFrames]:
    from .frames import EventFrames

    return EventFrames


EVENTS = OnDemandWidget(
    name="events",
    types=SAID_TYPES,
    widget=_widget,
    frames=_frames,
    shared=True,
    every_message=True,
    goes_stale=False,
)
