"""The scans before the one on show: the trail behind it, and how far they scatter."""

from __future__ import annotations

from typing import Any

import traitlets

from .._core.robot_widget import RobotWidget
from ..samples import Pose, Scan
from .footprint import HasFootprint

MOST_SCANS = 100


class HasTrail(HasFootprint, RobotWidget[Scan]):
    """A laser widget that shows earlier scans, too, of those that the page keeps."""

    trail = traitlets.Int(0, min=0, max=MOST_SCANS, help="How many scans before the one on show are behind it.").tag(
        sync=True
    )
    spread = traitlets.Int(
        0, min=0, max=MOST_SCANS, help="Over how many scans the spread of each ray is drawn, 2 or more; 0: none."
    ).tag(sync=True)

    @traitlets.validate("spread")
    def _before_spread(self, proposal: Any) -> Any:
        if proposal["value"] == 1:
            raise traitlets.TraitError("spread: expected a number of scans, 2 or more, or 0 for none, got 1")
        return proposal["value"]

    def scanner_at(self, robot: Pose | None) -> dict[str, Any]:
        """What the page is told of a scan of a robot at a pose: the scanner's pose in the frame of odometry.

        Without a footprint the scanner is where the robot is.
        """
        if robot is None:
            return {}
        scanner = robot.offset(*self.footprint.scanner) if self.footprint else robot
        return {"pose": [round(value, 5) for value in scanner]}

    def _placed(self, scan: Scan) -> dict[str, Any]:
        """The pose of a live scan, by the path in the laser's view; the first by name where there are several."""
        if not self.trail or self.driven_by_player:
            return {}
        paths = sorted((one for one in self._group if one.sample_name == "pose"), key=lambda path: str(path.title))
        return self.scanner_at(paths[0].robot_at(scan) if paths else None)
