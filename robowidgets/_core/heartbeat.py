"""A sign of life for the page of a widget that has nothing new to show."""

from __future__ import annotations

import time
from typing import Any

import traitlets

from ..samples.staleness import BEAT
from .base_widget import NamedWidget
from .pacer import pacer


class BeatingWidget(NamedWidget):
    """A widget that sends a beat every second, if its class says so.

    What moves only at times, such as a state machine that is paused, looks the same beside a kernel that is gone.
    """

    beats = False
    """Whether it sends beats."""

    _beat = traitlets.Int(0, help="Number of beats; 0: it sends none.").tag(sync=True, echo_update=False)
    _beat_at = 0.0
    """The monotonic time of the next one."""

    def __init__(self, **kwargs: Any) -> None:
        self._heart = _Heart(self)
        super().__init__(**kwargs)

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        pacer.forget(self._heart)

    def _due_beat(self) -> list[str]:
        """The name of the trait if a beat is due, else nothing. Called at each send, with the lock of those."""
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
    """Has the widget sent when a beat is due, beside the time that the widget may have with the pacer."""

    def __init__(self, widget: BeatingWidget) -> None:
        self._widget = widget

    def send_newest(self) -> int:
        """The pacer calls it."""
        pacer.mark(self._widget)
        return 0
