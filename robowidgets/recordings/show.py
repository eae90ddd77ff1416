"""A recording on the page: the widgets that fit its topics, and a slider through its time."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterable, Sequence
from html import escape
from math import ceil, isfinite, nan
from typing import Any, NamedTuple

import ipywidgets
import numpy as np

from .._layout import WIDE, columns
from .._picks import Pick, picks
from ..samples import Scan, Speed
from ..touch_widget import TouchWidget
from .recording import Recording
from .timeline import Topic
from .touch_history import TouchHistory

TICK = 0.1
"""Seconds of the recording, and of the clock on the wall, from one picture to the next while it plays."""

_NO_SCAN = Scan(np.empty(0, np.float32), 0.0, 0.0, 0.0, 1.0, notes=("no scan up to this time of the recording",))
_NO_SPEED = Speed((nan, nan, nan), (nan, nan, nan))
_EARLY = 0.1
_STEPS = 100


Seek = Callable[[float], None]
"""Makes a widget show a topic at a time, in seconds from the start."""


class View(NamedTuple):
    """A widget, and by the name of each topic that it shows what makes it show a time of that."""

    widget: Any
    seeks: dict[str, Seek]


class Player(ipywidgets.VBox):  # type: ignore[misc]  # ipywidgets has no types
    """What `Recording.show` gives: the widgets for topics of a recording, and a slider for the time that they show.

    Each widget shows the last sample at that time or before it; a commanded speed is a tick on the bars of the measured
    one. `close` takes all of it off the page and closes the recording.

    Args:
        recording: what is shown. Nothing else may read it meanwhile.
        topics: names of topics in it; none: all that have a widget.

    Raises:
        UnknownTopicError: it has no such topic, or one that no widget shows.
    """

    def __init__(self, recording: Recording, topics: Sequence[str] = ()) -> None:
        self.recording = recording
        self.views: tuple[View, ...] = ()
        recording.samples(topics or None)
        self.views = _views(recording, [t for t in recording.topics if t.widget and (not topics or t.name in topics)])
        self._seeking = threading.Lock()
        self.slider = ipywidgets.FloatSlider(
            value=_step(_first_look(recording, self.views)),
            max=_step(max(recording.duration, TICK)),
            step=1 / _STEPS,
            description="Time (s)",
            layout=ipywidgets.Layout(flex="1 1 200px", width="auto"),
        )
        self._play = ipywidgets.Play(max=ceil(recording.duration / TICK), interval=round(1000 * TICK))
        self._play.observe(self._on_play, "value")
        self.slider.observe(self._on_slide, "value")
        controls = ipywidgets.Box([self._play, self.slider], layout=WIDE)
        self._problems = ipywidgets.HTML()
        moves = recording.duration and self.views
        super().__init__([self._problems, *([controls] if moves else []), self._widgets()])
        self._on_slide(None)

    def seek(self, seconds: float) -> None:
        """Show a time, in seconds from the start of the recording, to the next hundredth: the slider's step.

        Raises:
            ValueError: it is no time.
        """
        if not isfinite(seconds):
            raise ValueError(f"seconds: expected seconds from the start of the recording, got {seconds!r}")
        self.slider.value = _step(seconds)

    def close(self) -> None:
        """Take it off the page and close the recording."""
        for view in self.views:
            view.widget.close()
        super().close()
        self.recording.close()

    def _widgets(self) -> ipywidgets.Box:
        """Lasers in the wide column, the rest one under the other beside them, or below where room is short."""
        for view in self.views:
            view.widget.live = False
        widgets = [view.widget for view in self.views]
        return ipywidgets.Box(columns(widgets), layout=WIDE)

    def _on_slide(self, _change: Any) -> None:
        seconds = self.slider.value
        # Moves of the slider may come in a thread of their own while a cell runs.
        with self._seeking:
            for view in self.views:
                for seek in view.seeks.values():
                    seek(seconds)
            self._tell_problems()
        if self._apart():
            self._play.value = round(seconds / TICK)

    def _tell_problems(self) -> None:
        """Some are found only where they lie, on the way through the recording."""
        lines = [f"⚠ {escape(line)}" for line in self.recording.problems]
        self._problems.value = "<br>".join(lines)
        self._problems.layout.display = None if lines else "none"

    def _on_play(self, _change: Any) -> None:
        if self._apart():
            self.slider.value = min(self._play.value * TICK, self.slider.max)

    def _apart(self) -> bool:
        """Whether playing and slider are at different times: the finer steps of the slider do not count."""
        return bool(abs(self._play.value * TICK - self.slider.value) > 0.6 * TICK)


def _views(recording: Recording, topics: Iterable[Topic]) -> tuple[View, ...]:
    return tuple(_view(recording, pick) for pick in picks(topics))


def _view(recording: Recording, pick: Pick) -> View:
    widget, name = pick.make(), pick.topic
    if pick.widget == "laser":
        return View(widget, {name: _newest(recording, name, widget.update, _NO_SCAN)})
    if pick.widget == "touch":
        return View(widget, {name: _replay(recording, name, widget)})
    seeks = {name: _newest(recording, name, widget.update, _NO_SPEED)}
    if pick.command:
        seeks[pick.command] = _newest(recording, pick.command, widget.command, _NO_SPEED)
    return View(widget, seeks)


def _newest(recording: Recording, topic: str, update: Callable[[Any], None], nothing: Any) -> Seek:
    """Hands on the sample of a time, when it is another one than before."""
    before: list[int | None] = [-1]

    def seek(seconds: float) -> None:
        moment = recording.at(topic, seconds)
        time_ns = moment.time_ns if moment else None
        if time_ns != before[0]:
            before[0] = time_ns
            update(moment.sample if moment else nothing)

    return seek


def _replay(recording: Recording, topic: str, widget: TouchWidget) -> Seek:
    history = TouchHistory(recording, topic)

    def seek(seconds: float) -> None:
        time_ns = (recording.start_ns or 0) + round(seconds * 1e9)
        widget.show(history.at(time_ns), time_ns)

    return seek


def _first_look(recording: Recording, views: Iterable[View]) -> float:
    """The earliest time at which every topic that starts early has something to show."""
    firsts = (next(recording.samples(topic), None) for view in views for topic in view.seeks)
    seconds = [first.seconds for first in firsts if first]
    return max((s for s in seconds if s <= _EARLY * recording.duration), default=min(seconds, default=0.0))


def _step(seconds: float) -> float:
    """The slider's step at a time or next after it, where what was measured at that time is on show.

    The page rounds a value between two steps, perhaps to the one before.
    """
    return ceil(round(seconds * _STEPS, 8)) / _STEPS
