"""Readings of other sensors, and drawings of a program, over the picture of a camera."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import cos, inf, isfinite, pi, sin
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..poses.frame_tree import Poses
from ..samples import Range, Scan, Sector, Validity
from ._outline import Outlines
from .model import CameraModel

Floats = NDArray[np.float64]

FARTHEST = 100.0
"""Metres. Surfaces on the ground are drawn up to this distance."""

_TURN = pi / 90
"""Radians of a straight piece of an arc."""

THIN = pi / 60
"""Radians. The opening angle of infrared sensors that do not report it."""

_TIP = 0.3
"""Length of the arrow of a program in metres."""

SeenKind = Literal["area", "sector", "cone", "arc", "line", "points", "text"]


class Seen(NamedTuple):
    """A drawing in a picture, in pixels.

    Attributes:
        kind: areas, sectors and cones are surfaces with a single closed piece; points are single places.
        name: its label.
        pieces: pixels, shape (N, 2) each.
        words: further text, such as a distance.
        color: the colour of a program's shape, or empty for the default.
        dashed: True if nothing was seen up to its end.
    """

    kind: SeenKind
    name: str
    pieces: list[Floats]
    words: str = ""
    color: str = ""
    dashed: bool = False


@dataclass(frozen=True)
class Overlay:
    """The overlay of a picture.

    Args:
        scan: the scan whose readings it shows, or None.
        pixels: the pixel of the reading of each ray, shape (R, 2), NaN if it is not in the picture.
        drawn: surfaces and lines, from the ground up.
        missing: reasons why something is not shown.
        apart: seconds by which the scan is younger than the picture, or None if no scan came.
    """

    scan: Scan | None = None
    pixels: Floats = field(default_factory=lambda: np.empty((0, 2)))
    drawn: tuple[Seen, ...] = ()
    missing: tuple[str, ...] = ()
    apart: float | None = None


class ScanOnPicture:
    """A scan with its sectors and shapes in the picture of a camera.

    Args:
        model: the model of the camera.
        at: the pose of the scanner in the frame of the camera.
        scan: the scan.
        ground: the pose of the ground in the frame of the camera, or None to draw surfaces in the plane of the scanner.
    """

    def __init__(self, model: CameraModel, at: Poses, scan: Scan, ground: Poses | None = None) -> None:
        self._model, self._at, self._scan, self._ground = model, at, scan, ground
        self._outlines = Outlines(model)

    def pixels(self) -> Floats:
        """Return the pixels of the readings, shape (R, 2); NaN without a reading or outside the picture."""
        scan = self._scan
        readings = np.column_stack([scan.x, scan.y, np.zeros(len(scan))])
        seen = np.full((len(scan), 2), np.nan)
        seen[scan.valid] = self._model.project(self._at.moved(readings[scan.valid]))
        return seen

    def area(self) -> Seen:
        """Return the free area on the ground: up to the readings, or up to range_max if nothing is in range."""
        scan = self._scan
        reach = np.full(len(scan), scan.range_min)
        reach[scan.valid] = scan.ranges[scan.valid]
        reach[scan.validity == Validity.NOTHING_IN_RANGE] = scan.range_max
        return Seen("area", "", self._wedge(scan.angles, np.minimum(reach, FARTHEST), scan.range_min))

    def sectors(self, sectors: Mapping[str, Sector]) -> list[Seen]:
        """Return the sectors of a laser widget on the ground, up to their largest limit, or else up to range_max."""
        drawn = []
        for name, sector in sectors.items():
            limits = [limit for limit in (sector.near, sector.warning, sector.stop) if limit is not None]
            reach = min(max(limits, default=self._scan.range_max), FARTHEST)
            width = (sector.end - sector.start) % (2 * pi) or 2 * pi
            angles = sector.start + np.linspace(0.0, width, max(2, int(width / _TURN)))
            drawn.append(Seen("sector", name, self._wedge(angles, np.full(len(angles), reach), 0.0)))
        return drawn

    def shapes(self, forms: Iterable[Mapping[str, Any]]) -> list[Seen]:
        """Return the shapes of a program in the plane of the scanner, without shapes at a ray without a reading."""
        return [drawn for form in forms if (drawn := self._shape(form)) is not None]

    def _shape(self, form: Mapping[str, Any]) -> Seen | None:
        places = np.array([self._place(at) for at in form["at"]], np.float64).reshape(-1, 2)
        if not np.isfinite(places).all():
            return None
        kind: str = form["kind"]
        name, color = form["name"], form.get("color", "")
        if kind in ("text", "points"):
            pixels = self._model.project(self._at.moved(_flat(places)))
            pieces = [pixels[np.isfinite(pixels).all(axis=1)]]
            return Seen("text" if kind == "text" else "points", name, pieces, form.get("text", ""), color)
        if kind == "polygon":
            places = np.vstack([places, places[:1]])
        elif kind == "arc":
            places = places + _arc(form["radius"], form["start"], form["end"])
        elif kind == "arrow":
            (x, y), yaw = places[0], form["yaw"]
            tip = np.array([x + _TIP * cos(yaw), y + _TIP * sin(yaw)])
            barbs = [tip + 0.3 * _TIP * np.array([cos(yaw + turn), sin(yaw + turn)]) for turn in (2.6, -2.6)]
            places = np.array([(x, y), tip, barbs[0], tip, barbs[1]])
        return Seen("line", name, self._outlines.line(self._at.moved(_flat(places))), "", color)

    def _place(self, at: Any) -> tuple[float, float]:
        if not isinstance(at, int):
            return float(at[0]), float(at[1])
        scan = self._scan
        return (float(scan.x[at]), float(scan.y[at])) if at < len(scan) else (np.nan, np.nan)

    def _wedge(self, angles: Floats, outer: Floats, inner: float) -> list[Floats]:
        """Return the surface on the ground between two distances."""
        rim = np.column_stack([outer * np.cos(angles), outer * np.sin(angles)])
        back = angles[::-1][:: max(1, len(angles) // 90)] if inner else angles[:1]
        near = inner * np.column_stack([np.cos(back), np.sin(back)])
        corners = self._at.moved(_flat(np.vstack([rim, near])))
        if self._ground is not None:
            low = self._ground.inverse().moved(corners)
            low[:, 2] = 0.0
            corners = self._ground.moved(low)
        return [surface] if len(surface := self._outlines.surface(corners)) else []


def cones(model: CameraModel, ranges: Mapping[str, tuple[Range, Poses]], beam: float) -> list[Seen]:
    """Return the cones of sonars up to their readings, with an arc at the reading, or at min_range if it is too close.

    Args:
        model: the model of the camera.
        ranges: the range of each sensor by name, and its pose in the frame of the camera.
        beam: the opening angle in radians of sensors that do not report it.
    """
    outlines, drawn = Outlines(model), []
    for name, (one, at) in ranges.items():
        seen, met = one.validity is Validity.READING, one.distance < inf
        reach = max(one.distance, one.min_range) if met else one.max_range
        if not (met or one.validity is Validity.NOTHING_IN_RANGE) or not isfinite(reach):
            continue
        half = (one.field_of_view or (min(THIN, beam) if one.radiation == "infrared" else beam)) / 2
        arc = _arc(min(reach, FARTHEST), -half, half)
        rim = at.moved(_flat(arc))
        cone = outlines.surface(np.vstack([at.positions, rim]))
        words = f"{one.range:.2f} m" if seen else "too close" if met else "nothing"
        if len(cone):
            drawn.append(Seen("cone", name, [cone], words, dashed=not met))
            if met:
                drawn.append(Seen("arc", name, outlines.line(rim)))
    return drawn


def _arc(radius: float, start: float, end: float) -> Floats:
    turn = end - start if end - start >= 2 * pi else (end - start) % (2 * pi)
    angles = start + np.linspace(0.0, turn, max(2, int(turn / _TURN) + 1))
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _flat(places: Floats) -> Floats:
    return np.column_stack([places, np.zeros(len(places))])
