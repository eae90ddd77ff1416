"""A part of the circle round a scanner."""

from __future__ import annotations

from dataclasses import dataclass, fields
from math import degrees, isnan, pi, radians
from typing import Any, Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .checks import ANGLE_ROUNDING, decimals, finite, in_radians, not_negative
from .hints import give_hint

HYSTERESIS = 0.05
"""Metres."""

STATES = {"stop": "stop", "warning": "warning", "near": "occupied"}
"""The limits of a sector and the states that they set, the most severe first."""


def _metres(name: str, value: Any) -> float:
    given = finite(name, value, "metres")
    if given <= 0:
        raise ValueError(f"{name}: expected metres above 0, got {given!r}")
    return given


@dataclass(frozen=True, init=False)
class Sector:
    """The rays between two angles, for any scanner: its first angle and its direction do not matter.

    A sector may have limits. It is "occupied" while the nearest thing in it is nearer than `near`, and in "warning" or
    "stop" below these distances, as with safety scanners. A state lasts until the distance exceeds its limit by the
    hysteresis, so that noise does not make it flicker.

    Args:
        start, end: angles in radians, or degrees as text (``"20deg"``), within a full turn either way; the sector goes
            from the first counter-clockwise to the second. Two angles a full turn apart are the whole circle.
        near: metres below which the sector is occupied, or None.
        warning, stop: metres below which it is in that state, or None; stop is not above warning.
        hysteresis: metres.

    Raises:
        TypeError: a value is not a number.
        ValueError: an angle is beyond a full turn, a limit is not above 0, or stop is above warning.

    Examples:
        >>> Sector("-15deg", "15deg", near=0.5)
        Sector('-15deg', '15deg', near=0.5)
    """

    start: float
    end: float
    near: float | None = None
    warning: float | None = None
    stop: float | None = None
    hysteresis: float = HYSTERESIS

    def __init__(
        self,
        start: float | str,
        end: float | str,
        *,
        near: float | None = None,
        warning: float | None = None,
        stop: float | None = None,
        hysteresis: float = HYSTERESIS,
    ) -> None:
        put = object.__setattr__
        put(self, "start", in_radians("sector", start))
        put(self, "end", in_radians("sector", end))
        for name, value in (("near", near), ("warning", warning), ("stop", stop)):
            put(self, name, None if value is None else _metres(name, value))
        put(self, "hysteresis", not_negative("hysteresis", hysteresis, "metres"))
        if self.stop is not None and self.warning is not None and self.stop > self.warning:
            raise ValueError(
                f"stop: expected a distance up to warning ({self.warning:g} m), got {self.stop:g}; are the two swapped?"
            )

    def __repr__(self) -> str:
        angles = [repr(angle_text(angle) or angle) for angle in (self.start, self.end)]
        return f"Sector({', '.join(angles + [f'{name}={value!r}' for name, value in self._more().items()])})"

    @property
    def sweep(self) -> float:
        """Radians from the first angle to the second, above 0 and up to a full turn; 0 for a single direction."""
        turned = self.end - self.start
        return 2 * pi if turned >= 2 * pi else turned % (2 * pi)

    def state(self, distance: float, before: str = "free") -> str:
        """Return the state for a distance: "stop", "warning", "occupied" (`near`), "free", or "unknown" for NaN.

        Args:
            distance: metres to the nearest thing, as `Scan.distance` returns it.
            before: the state at the previous scan, which lasts up to the hysteresis.
        """
        if isnan(distance):
            return "unknown"
        severity = [*STATES.values()]
        was = severity.index(before) if before in severity else len(severity)
        for i, (name, state) in enumerate(STATES.items()):
            limit = getattr(self, name)
            if limit is not None and distance < limit + (self.hysteresis if was <= i else 0.0):
                return state
        return "free"

    def to_json(self) -> dict[str, float | str]:
        """Return plain values for JSON; ``Sector(**values)`` restores the sector."""
        return {"start": angle_text(self.start) or self.start, "end": angle_text(self.end) or self.end, **self._more()}

    def _more(self) -> dict[str, float]:
        """Return the fields other than the angles that differ from their defaults."""
        return {f.name: v for f in fields(self)[2:] if (v := getattr(self, f.name)) != f.default}


class HasSector(Protocol):
    """An object with a sector, such as the selection of a laser widget."""

    @property
    def sector(self) -> Sector:
        """The sector."""


SectorLike: TypeAlias = Sector | tuple[float | str, float | str] | str | HasSector
"""A sector as an argument: a `Sector`, two angles (radians, or text like ``"20deg"``), a name in `SECTORS`, or an
object with a sector."""

ALL_ROUND = Sector("-180deg", "180deg")
"""All rays of any scanner."""

SECTORS: dict[str, Sector] = {
    "front": Sector("-45deg", "45deg"),
    "left": Sector("45deg", "135deg"),
    "back": Sector("135deg", "225deg"),
    "right": Sector("-135deg", "-45deg"),
}
"""Quarters of the circle by name, centred on 0, 90, 180 and -90 degrees; together they cover all directions."""

_TWO_ANGLES = 'two angles, like ("-15deg", "15deg") or in radians'


def to_sector(sector: Any) -> Sector:
    """Return a sector from a value as in `SectorLike`.

    Raises:
        TypeError: the value is not a pair of angles.
        ValueError: the name is unknown, or an angle is beyond a full turn, infinite or NaN.
    """
    if isinstance(sector, Sector):
        return sector
    if isinstance(of_it := getattr(sector, "sector", None), Sector):
        return of_it
    if sector is None:
        hint = "is nothing selected? Leave the sector out for all rays"
        raise TypeError(f"sector: expected {_TWO_ANGLES}, got None: {hint}")
    if isinstance(sector, str):
        if sector not in SECTORS:
            raise ValueError(f"sector: expected {', '.join(SECTORS)} or {_TWO_ANGLES}, got {sector!r}")
        return SECTORS[sector]
    try:
        start, end = sector
    except (TypeError, ValueError):
        raise TypeError(f"sector: expected {_TWO_ANGLES}, got {sector!r}") from None
    found = Sector(start, end)
    if _is_long_way_back(found):
        given, swapped = f"({angle_code(found.start)}, {angle_code(found.end)})", angles_code(Sector(end, start))
        long, short = (f"{decimals(degrees(angle), 1)}°" for angle in (found.sweep, 2 * pi - found.sweep))
        give_hint(
            "sector {given} covers {long}: it goes counter-clockwise from the first angle to the second. {swapped} "
            "covers the {short} between them: are the two swapped? If not, {as_meant} says so",
            given=given,
            long=long,
            swapped=swapped,
            short=short,
            as_meant=angles_code(found),
        )
    return found


def angles_code(sector: Sector) -> str:
    """Return code for the two angles of a sector; the second is larger if the sector covers more than half a circle."""
    turns = (0, 0)
    if _is_long_way_back(sector):
        turns = (0, 1) if sector.end <= 0 else (-1, 0)
    return f"({angle_code(sector.start, turns[0])}, {angle_code(sector.end, turns[1])})"


def angle_code(angle: float, turns: int = 0) -> str:
    """Return code for an angle plus some full turns: ``"20deg"`` if that is exact, else radians."""
    if angle_text(angle):
        return f'"{decimals(degrees(angle) + 360 * turns, 4)}deg"'
    return radians_code(angle + 2 * pi * turns)


def radians_code(angle: float) -> str:
    """Return code for an angle in radians."""
    text = decimals(angle, 7)
    return text if "." in text else f"{text}.0"


def _is_long_way_back(sector: Sector) -> bool:
    """Return True if a sector covers more than half a circle and ends at a smaller angle: a likely swap."""
    return sector.start > sector.end and sector.sweep > pi


def in_sector(angles: NDArray[np.float64], sector: Sector) -> NDArray[np.bool_]:
    """Return True for each angle in radians that lies in a sector, its ends included."""
    inside: NDArray[np.bool_] = _turned(angles, sector) <= sector.sweep + 2 * ANGLE_ROUNDING
    return inside


def order_in_sector(angles: NDArray[np.float64], sector: Sector) -> NDArray[np.intp]:
    """Return the indices of the angles in a sector, counter-clockwise from its start."""
    turned = _turned(angles, sector)
    order = np.argsort(turned, kind="stable")
    return order[turned[order] <= sector.sweep + 2 * ANGLE_ROUNDING]


def angle_text(angle: float) -> str | None:
    """Return an angle in radians as ``"20deg"``, or None if four decimals of degrees are not exactly that angle."""
    text = decimals(degrees(angle), 4)
    return f"{text}deg" if radians(float(text)) == angle else None


def _turned(angles: NDArray[np.float64], sector: Sector) -> NDArray[np.float64]:
    """Return radians counter-clockwise from the start of a sector to each angle, plus the tolerance of rounding."""
    turned: NDArray[np.float64] = (angles - sector.start + ANGLE_ROUNDING) % (2 * pi)
    return turned
