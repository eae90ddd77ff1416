"""The interface of a plot for feeds and players: a widget among others, which takes the numbers in messages."""

from __future__ import annotations

import weakref
from collections.abc import Iterable
from typing import Any

import traitlets

from ..messages.fields import FieldOf
from ..widget.base_widget import NamedWidget
from ..widget.pacer import pacer
from ..widget.timed_frame import TimedFrame


class PlotCard(NamedWidget):
    """A plot among other widgets; see `SampleWidget` in `robowidgets.widget.sample_widget`."""

    sample_name = ""
    """A plot has no samples that the other widgets of its group could use; see `RobotWidget`."""

    column = "wide"
    history = 0.0
    has_rate = False
    frame_traits: tuple[str, ...] = ()
    driven_by_player = False
    """True if a player moves its time."""

    paused: bool
    _together = traitlets.Unicode(help="Name of the group that is frozen together; empty without one.").tag(
        sync=True, echo_update=False
    )

    def __init__(self, **kwargs: Any) -> None:
        self._group: weakref.WeakSet[Any] = weakref.WeakSet()
        self._readers: dict[str, dict[str, FieldOf]] = {}
        """The readers of the fields of each topic, by the names of their lines."""
        self._status = ""
        self._missed = 0
        super().__init__(**kwargs)

    def send_newest(self) -> int:
        """Send new values to the page. The pacer calls this."""
        raise NotImplementedError

    def follow_player(self) -> None:
        """See `RobotWidget`."""
        self.driven_by_player = True

    def join_group(self, name: str, group: weakref.WeakSet[Any]) -> None:
        """See `FreezableWidget`."""
        self._group, self._together = group, name

    def on_group(self) -> None:
        """See `FreezableWidget`."""

    def set_source(self, source: dict[str, Any], missing: str = "") -> None:  # noqa: ARG002
        """Show why no message comes, or cannot be used; see `RobotWidget`."""
        status = "; ".join(filter(None, (source.get("status", ""), source.get("error", ""))))
        if status != self._status:
            self._status = status
            pacer.mark(self)

    def on_source_closed(self) -> None:
        """See `RobotWidget`. No function works on its numbers."""

    def miss(self, count: int) -> None:
        """Note a number of messages that it missed."""
        self._missed += count
        pacer.mark(self)

    def within(self, start: float, end: float) -> dict[str, Any]:
        """Return the traits that differ on a page with a part of a recording, which it shows without adding lines."""
        return {"view": (start, end), "_choices": []}

    def sent_frames(self) -> list[TimedFrame]:
        """Return no frames for `to_html` to play, since all of its history is on show."""
        return []

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:  # noqa: ARG002
        """Return no texts and no bytes: all of a recording is in its lines."""
        return {}, b""

    def arrays_of(self, frame: bytes) -> tuple[int, int]:
        """Return the layout of a frame, which has no arrays."""
        return len(frame), 0

    def _numbers_in(self, topic: str, message: Any, fields: Iterable[str]) -> dict[str, Any]:
        """Return the numbers in a message of a topic, for the lines that are fields of this topic.

        Raises:
            ValueError: the message does not have such a field.
        """
        if topic not in self._readers:
            own = [name for name in fields if name.startswith(f"{topic}.")]
            self._readers[topic] = {name: FieldOf(name[len(topic) + 1 :], name) for name in own}
        return {name: read(message) for name, read in self._readers[topic].items()}

    @traitlets.observe("paused")
    def _tell_group(self, _change: Any) -> None:
        # A page that freezes one widget of a group freezes the others itself.
        if "paused" not in self._property_lock:
            for other in list(self._group):
                other.paused = self.paused
