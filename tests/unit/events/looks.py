"""The states of an events widget whose looks are kept."""

from __future__ import annotations

from robowidgets import EventsWidget

from ...looks import Look


def _events() -> EventsWidget:
    events = EventsWidget(title="robot")
    events.add("started", time=0.5)
    events.add("lost the line", level="WARN", source="follower", time=1.25)
    events.add("stopped: <b>bumper</b>", level="ERROR", source="driver", time=2.0)
    return events


LOOKS = {
    "events/empty": Look(make=lambda: EventsWidget(title="robot")),
    "events/events": Look(make=_events),
}
