"""The ring of sonars whose cones a laser widget shows."""

from __future__ import annotations

from typing import Any

import traitlets

from .._core.robot_widget import RobotWidget
from ..samples import Scan


class HasSonars(RobotWidget[Scan]):
    """A laser widget that shows the cones of a sonar widget."""

    _sonar_of = traitlets.Unicode(help="The model of a sonar widget; empty: none.").tag(sync=True)

    _sonars: Any = None

    @property
    def sonars(self) -> Any:
        """The `SonarWidget` whose cones are on the picture, to compare both; None: none.

        Each cone starts where its sensor is on the robot, and ends at what it measured. Sensors whose place is not
        known are left out. `Footprint.scanner` says where the scanner is on the robot; without it, it is in the middle.

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
