"""The ring of sonars whose cones a laser widget shows."""

from __future__ import annotations

from typing import Any

import traitlets

from ..samples import Scan
from ..widget.robot_widget import RobotWidget


class HasSonars(RobotWidget[Scan]):
    """A laser widget that shows the cones of a sonar widget."""

    _sonar_of = traitlets.Unicode(help="The model of a sonar widget, or empty.").tag(sync=True)

    _sonars: Any = None

    @property
    def sonars(self) -> Any:
        """The `SonarWidget` whose cones are drawn on the picture, to compare both, or None.

        Each cone starts at the position of its sensor on the robot, and ends at the measured distance. Sensors at an
        unknown position are left out. `Footprint.scanner` is the position of the scanner on the robot; without it, the
        scanner is in the middle.

        Raises:
            TypeError: something else is assigned.
        """
        return self._sonars

    @sonars.setter
    def sonars(self, sonars: Any) -> None:
        if sonars is not None and getattr(sonars, "sample_name", None) != "sonars":
            raise TypeError(f"sonars: expected a SonarWidget or None, got {sonars!r}")
        self._sonars = sonars
        self._sonar_of = "" if sonars is None else sonars.model_id
