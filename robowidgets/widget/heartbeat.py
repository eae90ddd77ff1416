"""A sign of life that a widget sends to the page while it has nothing new to show."""

from __future__ import annotations

import time
from typing import Any

import traitlets

from ..samples.staleness import BEAT
from .base_widget import NamedWidget
from .pacer import pacer


class BeatingWidget(NamedWidget):
    """A widget that sends a beat every second, if its class says so.

    Without beats, a widget that seldom changes, such as a paused state machine, looks the same when the kernel is gone.
    """

    beats = False
    """True if it sends beats."""

    _beat = traitlets.Int(0, help="Number of beats, or 0 if it sends none.").tag(sync=True, echo_update=False)
    _beat_at = 0.0
    """The monotonic time of the next beat."""

    def __init__(self, **kwargs: Any) -> None:
        self._heart = _Heart(self)
        super().__init__(**kwargs)

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        pacer.forget(self._heart)

    def _due_beat(self) -> list[str]:
        """Return the name of the trait if a beat is due, else nothing. Called at each send, with the send lock."""
        if not self.beats:
            return []
        now, names = time.monotonic(), []
        if now >= self._beat_at:
            self._beat_at = now + BEAT
            self._trait_values["_beat"] = self._beat + 1  # without sending it, as setting the trait would
            names = ["_beat"]
        pacer.mark_at(self._heart, self._beat_at)
        return names


class _Heart:
    """Sends the widget when a beat is due. The widget itself may be due at another time."""

    def __init__(self, widget: BeatingWidget) -> None:
        self._widget = widget

    def send_newest(self) -> int:
        """Mark the widget. The pacer calls this."""
        pacer.mark(self._widget)
        return 0
