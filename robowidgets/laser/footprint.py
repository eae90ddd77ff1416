"""The robot to scale on a laser widget: its outline, its bumpers and its speed."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import traitlets

from ..samples import Mount
from ..samples.checks import finite, in_radians
from ..samples.sector import SectorLike, to_sector
from ..widget.freezing import FreezableWidget

FARTHEST = 100.0
"""Metres from the middle of a robot to its outline."""
MOST_CORNERS = 200


@dataclass(frozen=True)
class Footprint:
    """The outline of a robot from above, in its own frame: x forward and y to the left in metres (REP-103).

    Args:
        radius: the radius of a round robot in metres.
        polygon: instead of a radius, three or more corners (x, y) in order around the middle of the robot.
        bumpers: the part of the outline that each touch sensor covers, by the name of the sensor: two angles
            counter-clockwise, or another form of a sector.
        scanner: the position of the scanner on the robot: (x, y) in metres, or (x, y, yaw) with radians or text like
            "180deg". With a yaw, angles are the robot's, and tf is ignored.
        upside_down: True if the scanner is mounted upside down, which needs a yaw.
        speed: the `SpeedWidget` whose measured speed is the arrow; by default the one in the laser's view.
        touch: the `TouchWidget` whose sensors are the bumpers; by default the one in the laser's view.

    Raises:
        TypeError: a value is not a number, not a sector or not such a widget.
        ValueError: neither a radius nor a polygon is given, or both are, or a number is out of range.

    Examples:
        >>> body = Footprint(radius=0.18, bumpers={"left": ("15deg", "80deg"), "right": ("-80deg", "-15deg")})
    """

    radius: float | None = None
    polygon: Sequence[tuple[float, float]] = ()
    bumpers: Mapping[str, SectorLike] = field(default_factory=dict)
    scanner: Sequence[Any] = (0.0, 0.0)
    speed: Any = None
    touch: Any = None
    upside_down: bool = False
    mount: Mount | None = field(init=False, default=None)
    """The mount of the scanner, or None if no yaw was given."""

    def __post_init__(self) -> None:
        corners = tuple(_numbers("polygon", corner, "(x, y)") for corner in self.polygon)
        if (self.radius is None) != bool(corners):
            raise ValueError(
                f"Footprint: expected a radius or a polygon, got {self.radius!r} and {len(corners)} corners"
            )
        if corners and not 3 <= len(corners) <= MOST_CORNERS:
            raise ValueError(f"polygon: expected 3 to {MOST_CORNERS} corners, got {len(corners)}")
        if self.radius is not None:
            radius = finite("radius", self.radius, "metres")
            if not 0 < radius <= FARTHEST:
                raise ValueError(f"radius: expected metres above 0, {FARTHEST:g} at most, got {self.radius!r}")
            object.__setattr__(self, "radius", radius)
        if not isinstance(self.bumpers, Mapping) or not all(isinstance(name, str) for name in self.bumpers):
            raise TypeError(f"bumpers: expected sectors by the names of touch sensors, got {self.bumpers!r}")
        is_turned = len(self.scanner) == 3
        *place, yaw = self.scanner if is_turned else (*self.scanner, 0.0)
        scanner = (*_numbers("scanner", place, "(x, y) or (x, y, yaw)"), in_radians("yaw of the scanner", yaw))
        if self.upside_down and not is_turned:
            raise ValueError(f"upside_down: expected a scanner with a yaw, (x, y, yaw), got {self.scanner!r}")
        for name, widget in (("speed", self.speed), ("touch", self.touch)):
            if widget is not None and getattr(widget, "sample_name", None) != name:
                raise TypeError(f"{name}: expected a {name.title()}Widget, got {widget!r}")
        object.__setattr__(self, "polygon", corners)
        object.__setattr__(self, "bumpers", MappingProxyType({n: to_sector(s) for n, s in self.bumpers.items()}))
        object.__setattr__(self, "scanner", scanner)
        mount = Mount.by_hand(yaw, upside_down=self.upside_down) if is_turned else None
        object.__setattr__(self, "mount", mount)


class HasFootprint(FreezableWidget):
    """A laser widget that shows the robot to scale."""

    _robot = traitlets.Dict(help="The fields of a footprint, and the models of its widgets; empty without one.").tag(
        sync=True, echo_update=False
    )

    _footprint: Footprint | None = None

    @property
    def footprint(self) -> Footprint | None:
        """The robot to scale, with its bumpers and an arrow to its position in two seconds, or None for an arrow head.

        Bumpers and speed belong to the moment on show, frozen or not.

        Raises:
            TypeError: something else is assigned.

        Examples:
            >>> laser.footprint = Footprint(radius=0.18, speed=speed, touch=touch)  # doctest: +SKIP
        """
        return self._footprint

    @footprint.setter
    def footprint(self, footprint: Footprint | None) -> None:
        if footprint is not None and not isinstance(footprint, Footprint):
            raise TypeError(f"footprint: expected a Footprint or None, got {footprint!r}")
        before, self._footprint = self._footprint, footprint
        self._on_footprint(before)
        if footprint is None:
            self._robot = {}
            return
        sectors = {name: to_sector(sector) for name, sector in footprint.bumpers.items()}
        self._robot = {
            "radius": footprint.radius,
            "polygon": [list(corner) for corner in footprint.polygon],
            "bumpers": {name: {"start": one.start, "end": one.end} for name, one in sectors.items()},
            # The picture shows angles of the robot.
            "scanner": [*footprint.scanner[:2], 0.0],
            "speed": self._model_of("speed", footprint.speed),
            "touch": self._model_of("touch", footprint.touch),
        }

    def _on_footprint(self, before: Footprint | None) -> None:
        """React to a new footprint, given the one before."""

    def on_group(self) -> None:
        """See `FreezableWidget`: take the widgets of this group."""
        self.footprint = self._footprint

    def _model_of(self, kind: str, widget: Any) -> str:
        """Return the model of a widget, or of the only one of its kind in this view; empty without an open one."""
        found = [one for one in self._group if one.sample_name == kind] if widget is None else [widget]
        still_open = [one for one in found if one.comm is not None]
        return still_open[0].model_id if len(still_open) == 1 else ""


def _numbers(name: str, values: Any, form: str) -> tuple[float, ...]:
    try:
        x, y = values
    except (TypeError, ValueError):
        raise TypeError(f"{name}: expected {form} in metres, got {values!r}") from None
    given = tuple(finite(name, value, "metres") for value in (x, y))
    if max(map(abs, given)) > FARTHEST:
        raise ValueError(f"{name}: expected metres within ±{FARTHEST:g}, got {values!r}")
    return given
