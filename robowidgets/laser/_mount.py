"""The mount of the scanner of a laser widget."""

from __future__ import annotations

from collections.abc import Callable

from ..samples import Scan
from ..widget.robot_widget import RobotWidget
from ..widget.traits import Flag
from .footprint import Footprint, HasFootprint


class HasMount(HasFootprint, RobotWidget[Scan]):
    """A laser widget that shows angles of the robot if the mount of its scanner is known, by hand or from tf."""

    own_angles = Flag(False, help="True to show angles in the frame of the scanner. Python and the view write it.").tag(
        sync=True
    )

    _offset: float
    _mounted_by: Callable[[Scan], Scan] | None = None

    def take_mounts(self, mounted_by: Callable[[Scan], Scan] | None) -> None:
        """Take the function that adds the mount of the scanner to a scan, from a feed or a player."""
        self._mounted_by = mounted_by

    def mounted(self, scan: Scan) -> Scan:
        """Return a scan with the angles of the robot: by the footprint if it has a yaw, else by feed or recording."""
        by_hand = self._footprint.mount if self._footprint else None
        if by_hand is not None:
            return scan.mounted(by_hand)
        return self._mounted_by(scan) if self._mounted_by and scan.mount is None else scan

    def _on_footprint(self, before: Footprint | None) -> None:
        """See `HasFootprint`: the mount of the scan on show may change."""
        with self._newest.lock:
            newest = self._newest.sample
            if newest is None or (before and before.mount) == (self._footprint and self._footprint.mount):
                return
            own = newest.turned(-self._offset).unmounted()
            self._show(self.mounted(own).turned(self._offset), self._newest.about, counts=False)
