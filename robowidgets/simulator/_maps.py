"""Maps of robots as floors of cells: nav_msgs/OccupancyGrid, and the files of map_server."""

from __future__ import annotations

import re
from collections.abc import Sequence
from math import atan2
from os import PathLike
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..messages.fields import MISSING, get, unwrap
from ..samples.checks import finite
from ._grid import Grid

_OCCUPIED = 65
"""Percent from which a cell of a message is a wall, as map_server has it."""

_HEADER = re.compile(rb"(P[25])\s+(?:#[^\n]*\s+)*(\d+)\s+(?:#[^\n]*\s+)*(\d+)\s+(?:#[^\n]*\s+)*(\d+)\s")


def grid_of_map(source: Any) -> Grid:
    """A map as `World.from_map` takes it."""
    grid = _of_file(Path(source)) if isinstance(source, (str, PathLike)) else _of_message(unwrap(source))
    if not grid.free.any():
        raise ValueError("map: expected free cells; all are occupied or unknown")
    return grid


def _of_message(message: Any) -> Grid:
    names = ("info.width", "info.height", "info.resolution", "data")
    width, height, resolution, data = (get(message, name) for name in names)
    if MISSING in (width, height, resolution) or data is MISSING:
        raise TypeError(f"map: expected a nav_msgs/OccupancyGrid, or the path of a YAML file, got {repr(message)[:60]}")
    try:
        percent = np.asarray(data, dtype=np.int16)
    except (TypeError, ValueError):
        raise TypeError(f"map: expected data as whole numbers from -1 to 100, got {repr(data)[:60]}") from None
    if width * height != percent.size:
        raise ValueError(f"map: expected {width} x {height} cells, as its info says, got {percent.size}")
    cells = percent.reshape(height, width)
    x, y = (get(message, f"info.origin.position.{axis}", 0.0) for axis in "xy")
    z, w = (get(message, f"info.origin.orientation.{axis}", default) for axis, default in (("z", 0.0), ("w", 1.0)))
    return _grid(cells >= _OCCUPIED, (cells >= 0) & (cells < _OCCUPIED), resolution, (x, y, 2 * atan2(z, w)))


def _of_file(path: Path) -> Grid:
    # Imported lazily: few rooms are maps.
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        about = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    except (YAMLError, UnicodeDecodeError):
        about = None
    if not isinstance(about, dict) or not {"image", "resolution", "origin"} <= about.keys():
        raise ValueError(f"{path.name}: expected the YAML file of a map, with image, resolution and origin")
    mode = about.get("mode", "trinary")
    if mode not in ("trinary", "scale"):
        raise ValueError(f"{path.name}: expected mode trinary or scale, got {mode!r}")
    brightness = _pgm(path.parent / str(about["image"]))
    chance = brightness if about.get("negate") else 1 - brightness
    occupied = chance > finite("occupied_thresh", about.get("occupied_thresh", 0.65), "share")
    free = chance < finite("free_thresh", about.get("free_thresh", 0.196), "share")
    return _grid(occupied, free, about["resolution"], about["origin"])


def _pgm(path: Path) -> NDArray[np.float64]:
    """The brightness of the pixels of an image in PGM, 0 to 1, the lowest row first."""
    content = path.read_bytes()
    header = _HEADER.match(content)
    if header is None:
        raise ValueError(f"{path.name}: expected an image in PGM; map_saver writes one with --fmt pgm")
    kind, width, height, most = header[1], *(int(header[i]) for i in (2, 3, 4))
    if not 0 < most < 256:
        raise ValueError(f"{path.name}: expected brightness up to 255, got up to {most}")
    if kind == b"P5":
        pixels = np.frombuffer(content[header.end() :], dtype=np.uint8).astype(np.float64)
    else:
        pixels = np.array(content[header.end() :].split(), dtype=np.float64)
    if pixels.size < width * height or not pixels.size:
        raise ValueError(f"{path.name}: expected {width} x {height} pixels, got {pixels.size}: the file is cut off")
    return pixels[: width * height].reshape(height, width)[::-1] / most


def _grid(occupied: Any, free: Any, resolution: Any, origin: Any) -> Grid:
    if finite("resolution", resolution, "metres") <= 0:
        raise ValueError(f"resolution: expected metres above 0, got {resolution!r}")
    if not isinstance(origin, Sequence) or len(origin) != 3:
        raise ValueError(f"origin: expected [x, y, yaw], got {origin!r}")
    x, y, yaw = (finite("origin", value, "metres and radians") for value in origin)
    return Grid(occupied, free, float(resolution), (x, y, yaw))
