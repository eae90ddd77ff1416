"""Frames as Python packs them, which the tests of both halves read; `docs/frames.md` describes the layout.

`python -m tests.vectors` writes them anew into vectors.json. What stands beside them there is written by hand: scans
with their classes, counts and indices, and speeds with their limits.
"""

from __future__ import annotations

import base64
import json
import tempfile
from math import inf, isfinite, nan
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import robowidgets
from robowidgets import LaserWidget, Scan, ScanogramWidget, Speed, SpeedWidget, TouchWidget
from robowidgets._core.robot_widget import RobotWidget

from .unit.recordings import sweeps

FILE = Path(__file__).with_suffix(".json")
ARRIVED = 12.5
"""Seconds of the monotonic clock."""


def read() -> dict[str, Any]:
    """The committed vectors: scans, limits and frames."""
    vectors: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return vectors


def make() -> dict[str, Any]:
    """By name, the bytes of a frame in base64, and what the front end reads in them."""
    clock = patch.multiple("time", monotonic=lambda: ARRIVED, monotonic_ns=lambda: round(ARRIVED * 1e9))
    with clock, patch.object(RobotWidget, "rate", 30.0):
        made = {"laser": _laser(), "speed": _speed(), "touch": _touch(), **_scanogram(), "segment": _segment()}
    return {
        name: {"base64": base64.b64encode(raw).decode(), "reads": _in_words(reads)}
        for name, (raw, reads) in made.items()
    }


def _laser() -> tuple[bytes, dict[str, Any]]:
    ranges, intensities = [1.0, inf, -inf, nan, 0.0], [1.0, 2.5, nan, 0.0, 9.0]
    laser = LaserWidget()
    laser.update(
        Scan(ranges, 0.5, -0.25, 0.125, 30.0, intensities=intensities, stamp_ns=1_700_000_000_000_000_001),
    )
    frame = laser.get_state()["_frame"]
    laser.close()
    geometry = {"angleMin": 0.5, "angleIncrement": -0.25, "minRange": 0.125, "maxRange": 30.0, "count": 5}
    head = {"sequence": 1, "rate": 30.0, "arrived": 12.5}
    return frame, head | geometry | {"ranges": ranges, "kinds": [0, 2, 1, 3, 4], "intensities": intensities}


def _speed() -> tuple[bytes, dict[str, Any]]:
    measured, commanded = [0.5, -0.25, nan, inf, 0, -1.24], [0.6, 0, 0, 0, nan, -1.1]
    speed = SpeedWidget()
    speed.update(linear=(9, 9, 9), angular=(9, 9, 9))
    speed.reset_peaks()
    speed.update(Speed(measured[:3], measured[3:], 7))
    speed.command(Speed(commanded[:3], commanded[3:], 6))
    frame = speed.get_state()["_frame"]
    peaks = [list(speed.peaks[axis]) for axis in robowidgets.samples.AXES]
    speed.close()
    least, greatest = ([float(peak[i]) for peak in peaks] for i in (0, 1))
    head = {"sequence": 2, "rate": 30.0, "arrived": 12.5, "resets": 1}
    return frame, head | {"measured": measured, "commanded": commanded, "least": least, "greatest": greatest}


def _touch() -> tuple[bytes, dict[str, Any]]:
    touch = TouchWidget()
    touch.update({"größe": True, "right": None, "left": False})
    frame = touch.get_state()["_frame"]
    touch.close()
    sensors = [
        {"name": "größe", "state": "touched", "touches": 1, "seconds": 0},
        {"name": "right", "state": "unknown", "touches": 0, "seconds": None},
        {"name": "left", "state": "free", "touches": 0, "seconds": 0},
    ]
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5, "sensors": sensors}


def _scanogram() -> dict[str, tuple[bytes, dict[str, Any]]]:
    ranges = np.array([[1, 2, 3], [1.5, inf, nan], [2, 0.01, -inf]], np.float32)
    scanogram = ScanogramWidget()
    scanogram.update(
        times_ns=np.arange(3) * 500_000_000, ranges=ranges, angle_min=-0.5, angle_increment=0.5, range_min=0.125,
        range_max=8.0,
    )  # fmt: skip
    scanogram.set_touches([(0.25, 0.75, "left")], title="/bumper")
    scanogram._wanted = [0.0, 1.0, 100]
    state = scanogram.get_state()
    scanogram.close()
    sweep = {"angleMin": -0.5, "angleIncrement": 0.5, "minRange": 0.125, "maxRange": 8.0, "count": 3}
    whole = {
        "scanCount": 3, "pause": 0.5, "counts": [5, 1, 1, 1, 1], "sweep": sweep, "startsAt": [0.0, 0.5, 1.0],
        "spans": [{"start": 0.25, "end": 0.75, "name": "left"}],
    }  # fmt: skip
    detail = {"span": [0.0, 1.0], "ranges": ranges.ravel().tolist()}
    return {"scanogram": (state["_frame"], whole), "scanogram_detail": (state["_detail"], detail)}


def _segment() -> tuple[bytes, dict[str, Any]]:
    scans = [(0.0, sweeps.scan(sweeps.START_NS, [1.0, 2.0])), (0.5, sweeps.scan(sweeps.START_NS + 1, [1.5, inf]))]
    with tempfile.TemporaryDirectory() as folder:
        player = robowidgets.open(sweeps.write(Path(folder) / "scans", scans)).show()
        first = player.bar.get_state()["_first"]
        player.close()
    (track,), (abouts,) = first["tracks"], first["abouts"]
    assert len(abouts) == 1
    return track, {"times": [0.0, 0.0, 0.5], "abouts": [0, 0, 0], "ranges": [[1.0, 2.0], [1.0, 2.0], [1.5, inf]]}


def _in_words(value: Any) -> Any:
    """A value for JSON, which has no NaN and no infinity."""
    if isinstance(value, dict):
        return {key: _in_words(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_in_words(one) for one in value]
    return str(value) if isinstance(value, float) and not isfinite(value) else value


def write() -> None:
    """Put the frames of this Python into the file."""
    vectors = read() | {"frames": make()}
    FILE.write_text(_to_text(vectors), encoding="utf-8")


def _to_text(vectors: dict[str, Any]) -> str:
    """JSON with a line for each case."""
    parts = []
    for name, cases in vectors.items():
        lines = (
            [f"{json.dumps(key)}: {json.dumps(case, ensure_ascii=False)}" for key, case in cases.items()]
            if isinstance(cases, dict)
            else [json.dumps(case, ensure_ascii=False) for case in cases]
        )
        opening, closing = "{}" if isinstance(cases, dict) else "[]"
        parts.append(f"  {json.dumps(name)}: {opening}\n    " + ",\n    ".join(lines) + f"\n  {closing}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


if __name__ == "__main__":
    write()
