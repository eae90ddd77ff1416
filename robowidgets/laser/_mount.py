"""The mount of the scanner of a laser widget."""

from __future__ import annotations

from collections.abc import Callable

from .._core.robot_widget import RobotWidget
from .._core.traits import Flag
from ..samples import Scan
from .footprint import Footprint, HasFootprint


class HasMount(HasFootprint, RobotWidget[Scan]):
    """A laser widget whose angles are the robot's if it is known how the scanner stands on it: by hand, else by tf."""

    own_angles = Flag(
        False, help="Whether angles are shown as the scanner counts them. Python and the view write it."
    ).tag(sync=True)

    _offset: float
    _mounted_by: Callable[[Scan], Scan] | None = None

    def take_mounts(self, mounted_by: Callable[[Scan], Scan] | None) -> None:
        """Take what makes scans of messages those of a scanner on its robot: a feed or a player gives it."""
        self._mounted_by = mounted_by

    def mounted(self, scan: Scan) -> Scan:
        """A scan with the angles of the robot: by the footprint if that has a yaw, else by feed or recording."""
        by_hand = self._footprint.mount if self._footprint else None
        if by_hand is not None:
            return scan.mounted(by_hand)
        return self._mounted_by(scan) if self._mounted_by and scan.mount is None else scan

    def _on_footprint(self, before: Footprint | None) -> None:
        """See `HasFootprint`: the scan on show stands otherwise now."""
        with self._newest.lock:
            newest = self._newest.sample
            if newest is None or (before and before.mount) == (self._footprint and self._footprint.mount):
                return
            own = newest.turned(-self._offset).unmounted()
            self._show(self.mounted(own).turned(self._offset), self._newest.about, counts=False)
