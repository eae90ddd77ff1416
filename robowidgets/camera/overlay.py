"""What other sensors measure and a program draws, over the picture of a camera."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from math import cos, isfinite, pi, sin
from typing import Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..poses.frame_tree import Poses
from ..samples import Range, Scan, Sector, Validity
from ._outline import Outlines
from .model import CameraModel

Floats = NDArray[np.float64]

FARTHEST = 100.0
"""Metres; what a scanner sees farther away is no surface on the ground of a picture."""

_TURN = pi / 90
"""Radians of an arc that one of its straight pieces spans."""

THIN = pi / 60
"""Radians of an infrared beam that does not tell its width."""

_TIP = 0.3
"""Metres of the arrow of a program."""

SeenKind = Literal["area", "sector", "cone", "arc", "line", "points", "text"]


class Seen(NamedTuple):
    """Something in a picture, in pixels.

    Attributes:
        kind: an area and a cone are surfaces, whose single piece is closed; points are single places.
        name: for a person.
        pieces: shape (N, 2) each.
        words: what else is to be said of it.
        color: of a program's; empty: the usual one.
        dashed: whether nothing was seen up to its end.
    """

    kind: SeenKind
    name: str
    pieces: list[Floats]
    words: str = ""
    color: str = ""
    dashed: bool = False


@dataclass(frozen=True)
class Overlay:
    """What lies over a picture.

    Args:
        scan: the scan whose readings it shows; None without one.
        pixels: where the reading of each ray is in the picture, shape (R, 2), NaN for one that is not in it.
        drawn: surfaces and lines, from the ground up.
        missing: why something is not there, for a person.
        apart: seconds by which the scan is younger than the picture; None without stamps.
    """

    scan: Scan | None = None
    pixels: Floats = field(default_factory=lambda: np.empty((0, 2)))
    drawn: tuple[Seen, ...] = ()
    missing: tuple[str, ...] = ()
    apart: float | None = None


class ScanOnPicture:
    """A scan and what belongs to it, as a camera sees it.

    Args:
        model: of the camera.
        at: the pose of the scanner in the frame of the camera.
        scan: the scan.
        ground: the pose of the ground in the frame of the camera, on which surfaces lie; None: they lie in the plane of
            the scanner.
    """

    def __init__(self, model: CameraModel, at: Poses, scan: Scan, ground: Poses | None = None) -> None:
        self._model, self._at, self._scan, self._ground = model, at, scan, ground
        self._outlines = Outlines(model)

    def pixels(self) -> Floats:
        """The pixels of the readings, shape (R, 2); NaN for a ray without one, and for one outside the picture."""
        scan = self._scan
        readings = np.column_stack([scan.x, scan.y, np.zeros(len(scan))])
        seen = np.full((len(scan), 2), np.nan)
        seen[scan.valid] = self._model.project(self._at.moved(readings[scan.valid]))
        return seen

    def area(self) -> Seen:
        """What the scanner has seen to be free, on the ground: up to the readings, or as far as it sees."""
        scan = self._scan
        reach = np.full(len(scan), scan.range_min)
        reach[scan.valid] = scan.ranges[scan.valid]
        reach[scan.validity == Validity.NOTHING_IN_RANGE] = scan.range_max
        return Seen("area", "", self._wedge(scan.angles, np.minimum(reach, FARTHEST), scan.range_min))

    def sectors(self, sectors: Mapping[str, Sector]) -> list[Seen]:
        """The sectors of a laser widget on the ground, up to the largest of their limits, or as far as it sees."""
        drawn = []
        for name, sector in sectors.items():
            limits = [limit for limit in (sector.near, sector.warning, sector.stop) if limit is not None]
            reach = min(max(limits, default=self._scan.range_max), FARTHEST)
            width = (sector.end - sector.start) % (2 * pi) or 2 * pi
            angles = sector.start + np.linspace(0.0, width, max(2, int(width / _TURN)))
            drawn.append(Seen("sector", name, self._wedge(angles, np.full(len(angles), reach), 0.0)))
        return drawn

    def shapes(self, forms: Iterable[Mapping[str, Any]]) -> list[Seen]:
        """What a program draws on the scan, in the plane of the scanner; not what names a ray without a reading."""
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
        """The surface on the ground between two distances."""
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
    """The cones of sonars, each to what it measured, with an arc where that may be.

    Args:
        model: of the camera.
        ranges: by the name of the sensor its range, and its pose in the frame of the camera.
        beam: the opening angle in radians of those that do not tell theirs.
    """
    outlines, drawn = Outlines(model), []
    for name, (one, at) in ranges.items():
        seen = one.validity is Validity.READING
        reach = one.range if seen else one.max_range
        if one.validity not in (Validity.READING, Validity.NOTHING_IN_RANGE) or not isfinite(reach):
            continue
        half = (one.field_of_view or (min(THIN, beam) if one.radiation == "infrared" else beam)) / 2
        arc = _arc(min(reach, FARTHEST), -half, half)
        rim = at.moved(_flat(arc))
        cone = outlines.surface(np.vstack([at.positions, rim]))
        words = f"{one.range:.2f} m" if seen else "nothing"
        if len(cone):
            drawn.append(Seen("cone", name, [cone], words, dashed=not seen))
            if seen:
                drawn.append(Seen("arc", name, outlines.line(rim)))
    return drawn


def _arc(radius: float, start: float, end: float) -> Floats:
    turn = end - start if end - start >= 2 * pi else (end - start) % (2 * pi)
    angles = start + np.linspace(0.0, turn, max(2, int(turn / _TURN) + 1))
    return radius * np.column_stack([np.cos(angles), np.sin(angles)])


def _flat(places: Floats) -> Floats:
    return np.column_stack([places, np.zeros(len(places))])
