"""Conversion of maps of the floor: nav_msgs/OccupancyGrid, costmaps, and files of map_server."""

from __future__ import annotations

import os
import re
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..samples import MapGrid, Pose, yaw_of
from ..samples.checks import finite
from .byte_fields import bytes_in
from .fields import frame_id, get, has, stamp_ns, unwrap

_MODES = ("trinary", "scale", "raw")
_COST = 254
"""The cost in nav2_msgs/Costmap of a cell in which the robot would collide; 255 is unknown."""

_HEADER = re.compile(rb"(P[25])\s+(?:#[^\n]*\s+)*(\d+)\s+(?:#[^\n]*\s+)*(\d+)\s+(?:#[^\n]*\s+)*(\d+)\s")


def is_map_grid(message: Any) -> bool:
    """Return True if a message has the fields of an OccupancyGrid or a Costmap."""
    return has(message, "data") and (
        has(message, "info.width", "info.height", "info.resolution")
        or has(message, "metadata.size_x", "metadata.size_y", "metadata.resolution")
    )


def to_map_grid(message: Any) -> MapGrid:
    """Return the grid in a nav_msgs/OccupancyGrid or a nav2_msgs/Costmap.

    Raises:
        TypeError: the message is neither. ValueError: its numbers do not fit.
    """
    message = unwrap(message)
    if isinstance(message, MapGrid):
        return message
    if not is_map_grid(message):
        raise TypeError(f"map: expected a nav_msgs/OccupancyGrid, or the path of a YAML file, got {repr(message)[:60]}")
    is_cost = has(message, "metadata")
    about = "metadata" if is_cost else "info"
    width, height = (
        get(message, f"{about}.{name}") for name in (("size_x", "size_y") if is_cost else ("width", "height"))
    )
    resolution, data = get(message, f"{about}.resolution"), get(message, "data")
    if is_cost:  # uint8[], which rosbridge sends in base64; an OccupancyGrid has int8[], sent as numbers
        data = bytes_in("map: data", data)
    try:
        values = np.frombuffer(data, np.uint8) if isinstance(data, (bytes, bytearray)) else np.asarray(data, np.int16)
    except (TypeError, ValueError, OverflowError):
        raise TypeError(f"map: expected data as whole numbers from -1 to 100, got {repr(data)[:60]}") from None
    if width * height != values.size:
        raise ValueError(f"map: expected {width} x {height} cells, as its info says, got {values.size}")
    x, y = (get(message, f"{about}.origin.position.{axis}", 0.0) for axis in "xy")
    turn = [get(message, f"{about}.origin.orientation.{axis}", float(axis == "w")) for axis in "xyzw"]
    # Files of map_server and some nodes leave all of the orientation at 0, which is not a valid quaternion.
    yaw = float(yaw_of(*turn)) if any(turn) else 0.0
    cells = values.astype(np.uint8).reshape(height, width)
    return MapGrid(
        cells, float(resolution), Pose(x, y, yaw), _COST if is_cost else 100, stamp_ns(message), frame_id(message)
    )


def load_map(path: str | os.PathLike[str], frame: str = "map") -> MapGrid:
    """Return a map from files of map_server: a YAML file that names an image, in PGM or, with Pillow installed, PNG.

    Args:
        path: the YAML file, with image, resolution and origin; and mode (trinary, scale or raw), negate,
            occupied_thresh and free_thresh, unless these are the defaults of map_server.
        frame: the coordinate frame of the map, which the files do not name.

    Raises:
        OSError: a file cannot be read. ValueError: a file has invalid content; the text says what was expected.

    Examples:
        >>> path.ground = robowidgets.load_map("map.yaml")  # doctest: +SKIP
    """
    # Imported lazily: few programs have a map.
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    path = Path(path)
    try:
        about = YAML(typ="safe", pure=True).load(path.read_text(encoding="utf-8"))
    except (YAMLError, UnicodeDecodeError):
        about = None
    if not isinstance(about, dict) or not {"image", "resolution", "origin"} <= about.keys():
        raise ValueError(f"{path.name}: expected the YAML file of a map, with image, resolution and origin")
    mode = about.get("mode", "trinary")
    if mode not in _MODES:
        raise ValueError(f"{path.name}: expected mode {', '.join(_MODES[:-1])} or {_MODES[-1]}, got {mode!r}")
    pixels, alpha = _image(path.parent / str(about["image"]))
    occupied = finite("occupied_thresh", about.get("occupied_thresh", 0.65), "share")
    free = finite("free_thresh", about.get("free_thresh", 0.196), "share")
    if not free < occupied:
        raise ValueError(f"{path.name}: expected free_thresh below occupied_thresh, got {free:g} and {occupied:g}")
    origin = about["origin"]
    if not isinstance(origin, Sequence) or len(origin) != 3:
        raise ValueError(f"origin: expected [x, y, yaw], got {origin!r}")
    # map_server takes the alpha of an image as a fourth colour if mode is trinary, and as "unknown" if it is scale.
    if mode == "trinary" and alpha is not None:
        pixels = (3 * pixels + alpha) / 4
    cells = _cells(pixels, mode, bool(about.get("negate")), occupied, free)
    if mode == "scale" and alpha is not None:
        cells = np.where(alpha < 1, np.uint8(255), cells)
    return MapGrid(cells[::-1], about["resolution"], Pose(*origin), frame_id=frame)


def _cells(brightness: NDArray[np.float64], mode: str, negate: bool, occupied: float, free: float) -> NDArray[np.uint8]:
    """Return cells for pixels, as map_server reads them."""
    if mode == "raw":
        shade = np.rint(brightness * 255)
        return np.where(shade <= 100, shade, 255).astype(np.uint8)
    chance = brightness if negate else 1 - brightness
    between = np.full(chance.shape, 255.0)
    if mode == "scale":
        between = np.rint((chance - free) / (occupied - free) * 100).clip(0, 100)
    return np.where(chance > occupied, 100, np.where(chance < free, 0, between)).astype(np.uint8)


def _image(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    """Return the brightness of the pixels of an image, and their alpha or None without alpha, both 0 to 1."""
    content = path.read_bytes()
    header = _HEADER.match(content)
    if header is None:
        return _by_pillow(path)
    kind, width, height, most = header[1], *(int(header[i]) for i in (2, 3, 4))
    if not 0 < most < 256:
        raise ValueError(f"{path.name}: expected brightness up to 255, got up to {most}")
    if kind == b"P5":
        pixels = np.frombuffer(content[header.end() :], dtype=np.uint8).astype(np.float64)
    else:
        pixels = np.array(content[header.end() :].split(), dtype=np.float64)
    if pixels.size < width * height or not pixels.size:
        raise ValueError(f"{path.name}: expected {width} x {height} pixels, got {pixels.size}: the file is cut off")
    return pixels[: width * height].reshape(height, width) / most, None


def _by_pillow(path: Path) -> tuple[NDArray[np.float64], NDArray[np.float64] | None]:
    try:
        from PIL import Image, UnidentifiedImageError
    except ImportError:
        raise ValueError(
            f"{path.name}: expected an image in PGM; map_saver writes one with --fmt pgm, and with Pillow installed "
            "other images are read"
        ) from None
    try:
        with Image.open(path) as image:
            has_alpha = "A" in image.getbands() or "transparency" in image.info
            pixels = np.asarray(image.convert("RGBA"), np.float64) / 255
    except (UnidentifiedImageError, Image.DecompressionBombError):
        raise ValueError(f"{path.name}: expected an image in PGM; map_saver writes one with --fmt pgm") from None
    return pixels[..., :3].mean(axis=2), pixels[..., 3] if has_alpha else None
