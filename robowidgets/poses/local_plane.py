"""Conversion of latitude and longitude to metres on a plane that touches the earth."""

from __future__ import annotations

from math import cos, radians, sin, sqrt
from typing import NamedTuple

_A = 6_378_137.0
_F = 1 / 298.257223563
"""Metres of the equator's radius, and the flattening, of the ellipsoid of WGS 84."""
_E2 = _F * (2 - _F)


class LocalPlane(NamedTuple):
    """The plane that touches the ellipsoid of WGS 84 at an origin, with coordinates in metres east and north of it.

    The conversion is exact: by earth-centred coordinates (EPSG 9836, 9837), not by the length of a degree.

    Args:
        latitude, longitude: degrees of the origin.
        altitude: metres of the origin above the ellipsoid.
    """

    latitude: float
    longitude: float
    altitude: float

    def east_north(self, latitude: float, longitude: float, altitude: float) -> tuple[float, float]:
        """Return the metres of a place east and north of the origin."""
        here, there = _from_centre(*self), _from_centre(latitude, longitude, altitude)
        dx, dy, dz = (b - a for a, b in zip(here, there, strict=True))
        phi, lam = radians(self.latitude), radians(self.longitude)
        east = -sin(lam) * dx + cos(lam) * dy
        north = -sin(phi) * cos(lam) * dx - sin(phi) * sin(lam) * dy + cos(phi) * dz
        return east, north


def _from_centre(latitude: float, longitude: float, altitude: float) -> tuple[float, float, float]:
    """Return earth-centred metres: towards longitude 0 on the equator, 90 degrees east of it, and the north pole."""
    phi, lam = radians(latitude), radians(longitude)
    normal = _A / sqrt(1 - _E2 * sin(phi) ** 2)
    across = (normal + altitude) * cos(phi)
    return across * cos(lam), across * sin(lam), (normal * (1 - _E2) + altitude) * sin(phi)
