"""Python code that computes the distance of a sector, to copy and paste. The page has the same texts."""

from __future__ import annotations

from math import degrees

from .checks import decimals
from .mount import Mount
from .scan import Scan
from .sector import SECTORS, Sector, angles_code, radians_code
from .stretches import expression, stretches

MESSAGE = '''\
import numpy as np


def distance(msg, start={start}, sweep={sweep}):
    """Metres to the nearest thing, {words}: 0 too close, inf nothing met, nan unknown."""
    r = np.array(msg.ranges, np.float32)
    angles = msg.angle_min + np.arange(r.size) * (msg.angle_increment if r.size > 1 else 0)
    r = r[(angles - start + 1e-6) % (2 * np.pi) <= sweep + 2e-6]
    low, high = np.float32(msg.range_min), np.float32(msg.range_max)
    code = (r < low) & (r < 0.0195) & (r > -np.inf)  # 0.0 and the like: nothing was seen
    r[r > high] = np.inf
    r[r < low] = 0
    r[code] = np.nan
    return float(np.fmin.reduce(r, initial=np.nan))


distance(msg)
'''


def for_scan(sector: Sector) -> str:
    """Return an expression for a `Scan` named ``scan``."""
    name = next((name for name, known in SECTORS.items() if (known.start, known.end) == (sector.start, sector.end)), "")
    asked = f'"{name}"' if name else angles_code(sector)
    return f"scan.distance({asked})"


def for_message(sector: Sector, angle_offset: float = 0.0, mount: Mount | None = None) -> str:
    """Return a function of a sensor_msgs/LaserScan that needs only NumPy, and its call for a message named ``msg``.

    Args:
        sector: the sector as seen in a picture of the message.
        angle_offset: radians by which the picture is turned.
        mount: the mount of the scanner, if the picture has the robot's angles, or None if unknown.
    """
    words = f"from {_degrees(sector.start)} to {_degrees(sector.end)}"
    start = sector.start - angle_offset
    if mount and mount.turns_angles:
        words += f" of the robot, with the scanner {mount.words}"
        # A scanner that is upside down reaches the end of the sector first.
        start = mount.yaw - (sector.end - angle_offset) if mount.upside_down else start - mount.yaw
    if angle_offset:
        words += f" of a picture turned by {_degrees(angle_offset)}"
    return MESSAGE.format(start=radians_code(start), sweep=radians_code(sector.sweep), words=words)


def for_array(sector: Sector, scan: Scan) -> str:
    """Return an expression for the part of ``ranges`` in a sector, for this scan; it works for lists and arrays."""
    found = stretches(scan, sector)
    if len(found) < 2:
        return expression(found, len(scan))
    return f"np.concatenate(({expression(found, len(scan)).replace(' +', ',')}))"


def _degrees(angle: float) -> str:
    return f"{decimals(degrees(angle), 1)}°"
