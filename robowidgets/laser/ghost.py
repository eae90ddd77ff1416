"""The scan that a laser widget shows in the background, to compare the live one with."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import traitlets

from ..samples import Scan
from ..samples.age import arrival_of
from ..widget.robot_widget import RobotWidget
from ..widget.timed_frame import FRAME_HEADER
from ..widget.traits import bytes_trait


class HasGhost(RobotWidget[Scan]):
    """A laser widget with a scan to compare with: a pinned one, an earlier one, or the scan of another widget."""

    _ghost = bytes_trait()
    """The frame of the pinned scan; empty without one. Python and the view write it."""
    _ghost_ago = traitlets.Int(0, min=0, help="Number of scans before the one on show, or 0 for none.").tag(sync=True)
    _ghost_of = traitlets.Unicode(help="The model of another laser widget, or empty.").tag(sync=True)

    _ghost_widget: HasGhost | None = None
    _ghost_scan: Scan | None = None

    @property
    def ghost(self) -> Any:
        """The scan to compare with: gray dots under the scan on show, and the difference in the index view.

        It can be set to a `Scan`, such as ``laser.scan``, which stays; to a whole number, for the scan so many before
        the one on show; to another laser widget, for the scan that it shows; or to None for no ghost. The view pins
        scans, too.

        Raises:
            TypeError: another type. ValueError: a number below 1, or the widget itself. RuntimeError: the widget is
                closed.
        """
        if self._ghost_of:
            return self._ghost_widget
        if self._ghost_ago:
            return self._ghost_ago
        return self._ghost_scan

    @ghost.setter
    def ghost(self, value: Any) -> None:
        frame, ago, other = b"", 0, None
        if isinstance(value, Scan):
            # The newest one already has the mount of this widget.
            value = value if value is self._newest.sample else self.mounted(value)
            frame = self._frame_to_keep(value)
        elif isinstance(value, HasGhost):
            if value is self:
                raise ValueError("ghost: expected another laser widget, got this one")
            value.check_open("ghost")
            other = value
        elif isinstance(value, int) and not isinstance(value, bool):
            if value < 1:
                raise ValueError(f"ghost: expected how many scans ago, 1 or more, got {value}")
            if self.driven_by_player:
                raise ValueError("ghost: a player keeps no earlier scans; set a scan, such as recording.at(...).sample")
            ago = value
        elif value is not None:
            raise TypeError(
                f"ghost: expected a Scan, how many scans ago, another laser widget or None, got {repr(value)[:60]}"
            )
        self._ghost_widget = other
        with self.hold_trait_notifications():
            self._ghost, self._ghost_ago = frame, ago
            self._ghost_of = "" if other is None else other.model_id
        self._ghost_scan = value if frame else None

    @traitlets.observe("_ghost")
    def _after_ghost(self, _change: Any) -> None:
        frame = self._ghost
        self._ghost_scan = self._unpack(frame, self._about_of(frame)) if frame else None

    def _unpack(self, frame: bytes, about: Mapping[str, Any] | None = None) -> Scan:
        """See `RobotWidget`; with the texts on the sample, by default the texts on the frozen one."""
        raise NotImplementedError

    def mounted(self, scan: Scan) -> Scan:
        """See `HasMount`."""
        raise NotImplementedError

    def _frame_to_keep(self, scan: Scan) -> bytes:
        """Return a frame of a scan. If it is the newest one, it has the same number, so that the page knows its age."""
        newest = self._newest
        number = float(newest.sequence) if scan is newest.sample else 0.0
        head = FRAME_HEADER.pack(number, float("nan"), scan.stamp_ns or 0, arrival_of(scan))
        return head + self._pack(scan)
