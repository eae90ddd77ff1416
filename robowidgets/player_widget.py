"""The bar that plays a recording, with one time for all widgets that show it."""

from __future__ import annotations

from typing import Any

import traitlets

from ._core.front_end import FrontEndWidget, bundle
from ._core.platform_fixes import route_by_message
from ._core.time_traits import Marks, PlaybackSpeed, Seconds, States, TimeSpan
from ._core.traits import Flag


class PlayerWidget(FrontEndWidget):
    """Buttons and a slider to play, stop, step, jump and drag through a recording; none of it needs the kernel.

    It shows frames in the widgets whose models it is given, from segments of the recording that Python sends ahead.
    Space plays and stops, `,` and `.` step from scan to scan, arrow keys jump, `n` and `p` go from mark to mark,
    `l` plays it again and again, `+` and `-` change the speed, `a` gives a name to the selected span, or to one from
    here to where it is pressed again: all over the player that it is part of, where what has the focus has no use for
    the key. Beside the seconds stands the date and time of day, in UTC, if there is one.

    Args:
        duration: seconds of the recording.
    """

    _esm, _css = bundle("player_widget")

    time = Seconds(help="Seconds from the start, on show now. Python and the view write it.").tag(sync=True)
    duration = traitlets.Float(0.0, min=0.0, help="Seconds of the recording.").tag(sync=True)
    playing = Flag(False, help="Whether it plays. Python and the view write it.").tag(sync=True)
    speed = PlaybackSpeed(1.0, help="Seconds of the recording in one on the wall.").tag(sync=True)
    loop = Flag(False, help="Whether it begins again at the end; of the selection, if there is one.").tag(sync=True)
    selection = TimeSpan(help="What is looped: (start, end) in seconds from the start, or None.").tag(sync=True)
    marks = Marks(help="What is marked on the slider: (start, end, text), in seconds from the start.").tag(sync=True)
    states = States(help="Rows of states below the slider: (start, end, path), in seconds.").tag(sync=True)

    labels = Marks(help="Spans to which people gave a name: (start, end, name), in seconds from the start.").tag(
        sync=True
    )

    _begin = traitlets.Float(0.0, help="Seconds at which it begins.").tag(sync=True)
    _segment = traitlets.Float(1.0).tag(sync=True)
    _targets = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _pauses = traitlets.List(traitlets.Float()).tag(sync=True)
    _followers = traitlets.List(traitlets.Unicode()).tag(sync=True)
    _first = traitlets.List(traitlets.Dict()).tag(sync=True, echo_update=False)
    _start = traitlets.Float(None, allow_none=True, help="Seconds since the epoch; None: no date.").tag(sync=True)
    _shown = traitlets.Float(None, allow_none=True, help="Seconds that the widgets show; the view writes it.").tag(
        sync=True, echo_update=False
    )
    _leader = traitlets.Dict(help="The player that this one follows, and where to; empty: none.").tag(sync=True)
    _status = traitlets.Unicode().tag(sync=True)
    _unpacking = traitlets.Int(help="Bytes of the data that an exported page unpacks; 0 with a kernel.").tag(sync=True)
    _note = traitlets.Unicode(help="A line under it, which stays.").tag(sync=True)

    def open(self) -> None:
        """Connect to the page."""
        super().open()
        route_by_message(self.comm, only="label")

    @property
    def span(self) -> tuple[float, float]:
        """The span that is played, (start, end) in seconds."""
        start, end = self.selection if self.loop and self.selection else (0.0, self.duration)
        return min(start, self.duration), min(end, self.duration)

    def follow(self, leader: dict[str, Any]) -> None:
        """Move with another player in the page: see `robowidgets.player._leader.Leader`; empty: with none."""
        self._leader = leader

    def complain(self, problem: str) -> None:
        """Show why the recording can be read no further."""
        self._status = problem

    def _summary(self) -> str:
        return f"{'playing' if self.playing else 'stopped'} at {self.time:.2f} s of {self.duration:.1f} s"
