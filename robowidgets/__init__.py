"""The raw data of a robot's sensors, live in the notebook in which the robot is programmed."""

from __future__ import annotations

import sys
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

if sys.platform == "emscripten":
    from .notebook import in_browser

    in_browser.prepare()
    in_browser.check_numpy()

from .runtime.short_traceback import shorten_tracebacks

if TYPE_CHECKING:
    from . import conditions, feeds, fleet, lessons, simulator
    from . import rooms as rooms
    from ._compare import compare as compare
    from ._plot import plot as plot
    from .assistants import assistant as assistant
    from .camera import CameraModel as CameraModel
    from .camera import depth_scan
    from .cloud_widget import CloudWidget
    from .drive_widget import DriveWidget
    from .events_widget import EventsWidget
    from .fleet import drives, summary
    from .fleet import find as find
    from .fleet import index as index
    from .image_widget import ImageWidget
    from .laser.footprint import Footprint
    from .laser_widget import LaserWidget
    from .lines_widget import LinesWidget
    from .machine_widget import MachineWidget
    from .message_widget import MessageWidget
    from .messages.map_grid import load_map
    from .path_widget import PathWidget
    from .plot_widget import PlotWidget
    from .program_widget import ProgramWidget
    from .recording import Recording
    from .recording import open as open
    from .recordings import RecordingError
    from .recordings.search.lines import decisions as decisions
    from .samples import (
        CameraInfo,
        Cloud,
        Event,
        Image,
        MapGrid,
        Mount,
        Range,
        Ranges,
        Ray,
        Scan,
        Sector,
        Speed,
        Touch,
        TouchMode,
        TouchState,
        Validity,
        spread,
    )
    from .scanogram_widget import ScanogramWidget
    from .screens.screen import screen
    from .shapes import Arc, Arrow, Line, Points, Polygon, Text
    from .sonar_widget import SonarWidget
    from .speed_widget import SpeedWidget
    from .touch_widget import TouchWidget
    from .widget.front_end import set_theme
    from .wires_widget import WiresWidget

__version__ = "0.1.0"

SAMPLE = Path(__file__).parent / "data" / "sample.mcap"
"""A small recording of a simulated robot that drives through rooms and bumps into things."""

# Without `open`: a star import must not replace Python's `open`.
__all__ = [
    "SAMPLE",
    "Arc",
    "Arrow",
    "CameraInfo",
    "CameraModel",
    "Cloud",
    "CloudWidget",
    "DriveWidget",
    "Event",
    "EventsWidget",
    "Footprint",
    "Image",
    "ImageWidget",
    "LaserWidget",
    "Line",
    "LinesWidget",
    "MachineWidget",
    "MapGrid",
    "MessageWidget",
    "Mount",
    "PathWidget",
    "PlotWidget",
    "Points",
    "Polygon",
    "ProgramWidget",
    "Range",
    "Ranges",
    "Ray",
    "Recording",
    "RecordingError",
    "Scan",
    "ScanogramWidget",
    "Sector",
    "SonarWidget",
    "Speed",
    "SpeedWidget",
    "Text",
    "Touch",
    "TouchMode",
    "TouchState",
    "TouchWidget",
    "Validity",
    "WiresWidget",
    "assistant",
    "compare",
    "conditions",
    "decisions",
    "depth_scan",
    "drives",
    "feeds",
    "find",
    "fleet",
    "index",
    "lessons",
    "load_map",
    "plot",
    "screen",
    "set_theme",
    "simulator",
    "spread",
    "summary",
]

_LATER = {
    "._compare": ("compare",),
    "._plot": ("plot",),
    ".assistants": ("assistant",),
    ".camera": ("CameraModel", "depth_scan"),
    ".cloud_widget": ("CloudWidget",),
    ".drive_widget": ("DriveWidget",),
    ".events_widget": ("EventsWidget",),
    ".fleet": ("drives", "find", "index", "summary"),
    ".image_widget": ("ImageWidget",),
    ".laser.footprint": ("Footprint",),
    ".laser_widget": ("LaserWidget",),
    ".lines_widget": ("LinesWidget",),
    ".machine_widget": ("MachineWidget",),
    ".message_widget": ("MessageWidget",),
    ".messages.map_grid": ("load_map",),
    ".path_widget": ("PathWidget",),
    ".plot_widget": ("PlotWidget",),
    ".program_widget": ("ProgramWidget",),
    ".recording": ("Recording", "open"),
    ".recordings": ("RecordingError",),
    ".recordings.search.lines": ("decisions",),
    ".samples": (
        *("CameraInfo", "Cloud", "Event", "Image", "MapGrid", "Mount", "Range", "Ranges", "Ray", "Scan", "Sector"),
        *("Speed", "Touch", "TouchMode", "TouchState", "Validity", "spread"),
    ),
    ".scanogram_widget": ("ScanogramWidget",),
    ".screens.screen": ("screen",),
    ".shapes": ("Arc", "Arrow", "Line", "Points", "Polygon", "Text"),
    ".sonar_widget": ("SonarWidget",),
    ".speed_widget": ("SpeedWidget",),
    ".touch_widget": ("TouchWidget",),
    ".widget.front_end": ("set_theme",),
    ".wires_widget": ("WiresWidget",),
}
"""Public names by their modules. These are imported at the first use, because one widget needs few of them."""

_MODULE_OF = {name: module for module, names in _LATER.items() for name in names}

_MODULES = ("conditions", "feeds", "fleet", "lessons", "rooms", "simulator")
"""Public modules that `dir` lists. Other modules are imported at the first use, too."""

shorten_tracebacks()


def __getattr__(name: str) -> Any:
    """Import a public name at its first use."""
    if name in _MODULE_OF:
        return getattr(import_module(_MODULE_OF[name], __name__), name)
    if name == "Pose":
        from .runtime.renamed import renamed
        from .shapes import Arrow

        return renamed(__name__, name, {name: Arrow})
    if not name.startswith("_") and find_spec(f"{__name__}.{name}"):
        return import_module(f".{name}", __name__)
    from difflib import get_close_matches  # Imported lazily: few names are wrong.

    lower = {known.lower(): known for known in __all__}
    alike = get_close_matches(name.lower(), lower, n=1) or [known for known in lower if known.startswith(name.lower())]
    near = [lower[known] for known in alike]
    hint = f"; did you mean {near[0]!r}?" if near and not name.startswith("_") else ""
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{hint}")


def __dir__() -> list[str]:
    """Return the names for completion."""
    return sorted({*globals(), *_MODULE_OF, *_MODULES})
