"""Freezing widgets, alone or in groups, from the page or from Python."""

from __future__ import annotations

import threading
import weakref
from collections import deque
from collections.abc import Iterable, Mapping
from typing import Any, ClassVar
from uuid import uuid4

import traitlets

from .base_widget import NamedWidget
from .sample_widget import GroupedWidget
from .timed_frame import FRAME_HEADER
from .traits import Flag, bytes_trait

MOST_ABOUTS = 12_000
"""The number of texts on samples that are kept: one for each sample that the page keeps."""


class FreezableWidget(NamedWidget):
    """A widget whose picture can be frozen, and stepped back to earlier samples in the page.

    Subclasses implement `_bring_up_to_date`, and add the texts on the samples that they send to `_abouts`.
    """

    _meant: ClassVar[Mapping[str, str]] = {"freeze": "paused", "frozen": "paused"}
    _instead: ClassVar = {"freeze": "widget.paused = True", "frozen": "widget.paused = True"}

    paused = Flag(False, help="True while the picture is frozen. Python and the view write it.").tag(sync=True)

    driven_by_player = False
    """True while a player in the page feeds this widget; Python then sends no frames."""

    _together = traitlets.Unicode(help="Name of the group that is frozen and stepped together; empty without one.").tag(
        sync=True, echo_update=False
    )
    _frame = bytes_trait(echo_update=False)
    _frozen_frame = bytes_trait(echo_update=False)
    _about = traitlets.Dict().tag(sync=True, echo_update=False)

    _send_lock: threading.RLock

    def __init__(self, **kwargs: Any) -> None:
        self._group: weakref.WeakSet[FreezableWidget] = weakref.WeakSet()
        self._abouts: deque[tuple[int, dict[str, Any]]] = deque([(0, {})], MOST_ABOUTS)
        """The texts on samples, each with the sequence number of its first sample."""
        self._frozen_about: dict[str, Any] = {}
        super().__init__(**kwargs)

    def _bring_up_to_date(self) -> None:
        """Pack the newest sample into `_frame` and `_about` without sending them, as setting the traits would."""
        raise NotImplementedError

    def join_group(self, name: str, group: weakref.WeakSet[FreezableWidget]) -> None:
        """Join a group, with which the widget is frozen, released and stepped. See `freeze_together`."""
        self._group, self._together = group, name

    def on_group(self) -> None:
        """React to a new group; called once all its widgets have joined."""

    @traitlets.validate("paused")
    def _before_paused(self, proposal: Any) -> Any:
        """Keep the shown sample before `paused` is True, because another thread may read it at any moment."""
        if proposal["value"] and not self.paused:
            self._freeze()
        return proposal["value"]

    @traitlets.observe("paused")
    def _after_paused(self, _change: Any) -> None:
        if self.paused:
            self._freeze()
        elif self._frozen_frame:
            self._frozen_frame = b""
        # A page that freezes a widget also freezes the others, at the moment on show.
        if "paused" not in self._property_lock:
            for other in list(self._group):
                other.paused = self.paused

    def _freeze(self) -> None:
        """Keep the shown sample. If the user freezes the picture in the page, the page has already kept it."""
        with self._send_lock:
            if not self._frozen_frame:
                self._bring_up_to_date()
                self._frozen_frame = self._frame

    @traitlets.observe("_frozen_frame")
    def _after_frozen_frame(self, _change: Any) -> None:
        self._frozen_about = self._about_of(self._frozen_frame)

    def _about_of(self, frame: bytes) -> dict[str, Any]:
        """Return the texts on the sample of a frame that was sent."""
        if not frame or self.driven_by_player:
            return self._about
        number, *_ = FRAME_HEADER.unpack_from(frame)
        # A copy, because the thread that sends samples adds texts meanwhile.
        return next((about for first, about in reversed(self._abouts.copy()) if first <= number), self._about)


def freeze_together(widgets: Iterable[GroupedWidget]) -> str:
    """Group widgets so that they are frozen, released and stepped together, in the page and in Python.

    Returns:
        The name of the group in the page.
    """
    group = weakref.WeakSet(widgets)
    name = uuid4().hex
    for widget in group:
        widget.join_group(name, group)
    for widget in group:
        widget.on_group()
    return name
