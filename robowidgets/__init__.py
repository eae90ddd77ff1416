"""The raw data of a robot's sensors, live in the notebook in which the robot is programmed."""

from __future__ import annotations

from difflib import get_close_matches
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .notebook import in_browser

if in_browser.IN_BROWSER:
    in_browser.prepare()
    in_browser.check_numpy()

from . import rooms as rooms
from .cloud_widget import CloudWidget
from .drive_widget import DriveWidget
from .events_widget import EventsWidget
from .image_widget import ImageWidget
from .laser.footprint import Footprint
from .laser_widget import LaserWidget
from .message_widget import MessageWidget
from .messages.map_grid import load_map
from .path_widget import PathWidget
from .plot_widget import PlotWidget
from .runtime.renamed import renamed
from .runtime.short_traceback import shorten_tracebacks
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

if TYPE_CHECKING:
    from . import feeds, fleet, lessons, simulator
    from ._compare import compare as compare
    from ._plot import plot as plot
    from .assistants import assistant as assistant
    from .camera import CameraModel as CameraModel
    from .camera import depth_scan
    from .fleet import drives, summary
    from .fleet import find as find
    from .fleet import index as index
    from .lines_widget import LinesWidget
    from .machine_widget import MachineWidget
    from .program_widget import ProgramWidget
    from .recording import Recording
    from .recording import open as open
    from .recordings import RecordingError
    from .recordings.search import conditions
    from .recordings.search.lines import decisions as decisions
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
    "simulator",
    "spread",
    "summary",
]

shorten_tracebacks()

_RENAMED = {"Pose": Arrow}

_LATER = {
    "CameraModel": ".camera",
    "LinesWidget": ".lines_widget",
    "MachineWidget": ".machine_widget",
    "ProgramWidget": ".program_widget",
    "Recording": ".recording",
    "assistant": ".assistants",
    "compare": "._compare",
    "decisions": ".recordings.search.lines",
    "depth_scan": ".camera",
    "drives": ".fleet",
    "find": ".fleet",
    "index": ".fleet",
    "summary": ".fleet",
    "RecordingError": ".recordings",
    "WiresWidget": ".wires_widget",
    "open": ".recording",
    "plot": "._plot",
}


def __getattr__(name: str) -> Any:
    """Import feeds, lessons, recordings and the simulator at the first use: a widget does not need them."""
    if name in ("feeds", "fleet", "lessons", "simulator"):
        return import_module(f".{name}", __name__)
    if name == "conditions":
        return import_module(".recordings.search.conditions", __name__)
    if name in _LATER:
        return getattr(import_module(_LATER[name], __name__), name)
    if name in _RENAMED:
        return renamed(__name__, name, _RENAMED)
    lower = {known.lower(): known for known in __all__}
    alike = get_close_matches(name.lower(), lower, n=1) or [known for known in lower if known.startswith(name.lower())]
    near = [lower[known] for known in alike]
    hint = f"; did you mean {near[0]!r}?" if near and not name.startswith("_") else ""
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}{hint}")
