"""Recordings of scans only, written for a test: any times, any number of rays."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from rosbags.rosbag2 import CompressionMode, StoragePlugin

from robowidgets.messages.encoding import encode

from . import recorded
from .recorded import START_NS, stamped

TYPE = "sensor_msgs/msg/LaserScan"


def scan(
    stamp_ns: int,
    ranges: Sequence[float],
    intensities: Sequence[float] = (),
    angle_min: float = -0.5,
    increment: float = 0.1,
    frame_id: str = "laser",
) -> bytes:
    """The bytes of a scan, with limits of 0.1 and 30 m, and rays so many radians apart."""
    fields = {
        "header": stamped(stamp_ns, frame_id),
        "angle_min": angle_min,
        "angle_max": 0.5,
        "angle_increment": increment,
        "range_min": 0.1,
        "range_max": 30.0,
        "ranges": ranges,
        "intensities": intensities,
    }
    return encode("cdr", TYPE, fields)


def write(
    folder: Path,
    scans: Iterable[tuple[float, bytes]],
    plugin: StoragePlugin = StoragePlugin.MCAP,
    compression: CompressionMode = CompressionMode.NONE,
    silent: Sequence[str] = (),
) -> Path:
    """A folder with scans on /scan, each with its log time in seconds after the start; nothing on silent topics."""
    messages = ((seconds, "/scan", raw) for seconds, raw in scans)
    return recorded.write(folder, dict.fromkeys(("/scan", *silent), TYPE), messages, plugin, compression)


def numbered(count: int, rays: int = 4) -> list[tuple[float, bytes]]:
    """Scans a tenth of a second apart; every range of scan i is 1 + i / 100."""
    return [(i / 10, scan(START_NS + i * 10**8, [1 + i / 100] * rays)) for i in range(count)]
