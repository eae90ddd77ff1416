"""The bar that plays a recording, with one time for all widgets that show it."""

from __future__ import annotations

from typing import Any

import traitlets

from .runtime.platform_fixes import route_by_message
from .widget.front_end import FrontEndWidget, bundle
from .widget.time_traits import Marks, PlaybackSpeed, Seconds, States, TimeSpan
from .widget.traits import Flag


class PlayerWidget(FrontEndWidget):
    """Buttons and a slider to play, stop, step, jump and drag through a recording, without the kernel.

    It shows frames in the widgets of the given models, from segments of the recording that Python sends in advance.
    Space plays and stops, `,` and `.` step from scan to scan, arrow keys jump, `n` and `p` go from mark to mark, `l`
    plays in a loop, `+` and `-` change the speed, `a` gives a name to the selected span, or to the span up to the next
    press. The keys work everywhere in the player, unless the focused element uses them. Next to the seconds it shows
    the date and time of day in UTC, if known.

    Args:
        duration: seconds of the recording.
    """

    _esm, _css = bundle("player_widget")

    time = Seconds(help="The time on show in seconds from the start. Python and the view write it.").tag(sync=True)
    duration = traitlets.Float(0.0, min=0.0, help="Seconds of the recording.").tag(sync=True)
    playing = Flag(False, help="True while it plays. Python and the view write it.").tag(sync=True)
    speed = PlaybackSpeed(1.0, help="Seconds of the recording in one second.").tag(sync=True)
    loop = Flag(False, help="True to play the selection, or else the recording, in a loop.").tag(sync=True)
    selection = TimeSpan(help="The span to loop: (start, end) in seconds from the start, or None.").tag(sync=True)
    marks = Marks(help="Marks on the slider: (start, end, text), in seconds from the start.").tag(sync=True)
    states = States(help="Rows of states below the slider: (start, end, path), in seconds.").tag(sync=True)

    labels = Marks(help="Spans that users have named: (start, end, name), in seconds from the start.").tag(sync=True)

    _begin = traitlets.Float(0.0, help="Seconds at which it begins.").tag(sync=True)
    _segment = traitlets.Float(1.0).tag(sync=True)
    _targets = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _pauses = traitlets.List(traitlets.Float()).tag(sync=True)
    _followers = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _first = traitlets.List(traitlets.Dict()).tag(sync=True, echo_update=False)
    _start = traitlets.Float(None, allow_none=True, help="Seconds since the epoch, or None without a date.").tag(
        sync=True
    )
    _shown = traitlets.Float(
        None, allow_none=True, help="The time on show in the widgets, in seconds. The view writes it."
    ).tag(sync=True, echo_update=False)
    _leader = traitlets.Dict(help="The player that this one follows, with the times; empty without one.").tag(sync=True)
    _status = traitlets.Unicode().tag(sync=True)
    _unpacking = traitlets.Int(help="Bytes of data that an exported page unpacks; 0 with a kernel.").tag(sync=True)
    _note = traitlets.Unicode(help="A permanent line below it.").tag(sync=True)

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm, only="label")

    @property
    def span(self) -> tuple[float, float]:
        """The span to play, (start, end) in seconds."""
        start, end = self.selection if self.loop and self.selection else (0.0, self.duration)
        return min(start, self.duration), min(end, self.duration)

    @property
    def moment(self) -> float:
        """The time on show in the widgets of the page, in seconds: the frozen one while they are frozen."""
        return self.time if self._shown is None else self._shown

    def follow(self, leader: dict[str, Any]) -> None:
        """Move with another player in the page: see `robowidgets.screens._leader.Leader`. Empty ends that."""
        self._leader = leader

    def complain(self, problem: str) -> None:
        """Show why the rest of the recording cannot be read."""
        self._status = problem

    def _summary(self) -> str:
        return f"{'playing' if self.playing else 'stopped'} at {self.time:.2f} s of {self.duration:.1f} s"
