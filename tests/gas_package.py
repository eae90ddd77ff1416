"""The package of `docs/developers/new_sensor.md`, a gas sensor: built and installed, with a recording of it."""

from __future__ import annotations

import re
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from importlib import invalidate_caches
from pathlib import Path
from typing import Any

from robowidgets.kinds import KINDS, ROOMS, add_installed
from robowidgets.messages import definitions

from .conftest import ROOT
from .node import ENVIRONMENT
from .unit.recordings import recorded
from .unit.recordings.recorded import START_NS, stamped

PACKAGE = ROOT / "tests" / "gas_sensor"
GAS, STATUS = "gas_msgs/msg/Gas", "gas_msgs/msg/GasStatus"
COUNT = 50
STEP = 0.1
SAYS = {0: "warming up", 2: "ok"}
"""The messages of /gas/status, by seconds."""


def build(folder: Path) -> Path:
    """Build the front end into a folder, with the command of the page."""
    command = ["node", "build.mjs", PACKAGE / "js", folder]
    subprocess.run(command, cwd=ROOT / "robowidgets" / "js", env=ENVIRONMENT, check=True)
    return folder


@contextmanager
def installed(folder: Path, points: Mapping[str, str] | None = None) -> Iterator[None]:
    """Build the package and install it into a folder, with its entry points and further ones."""
    shutil.copytree(PACKAGE / "gas_sensor", folder / "gas_sensor", ignore=shutil.ignore_patterns("__pycache__"))
    build(folder / "gas_sensor" / "static")
    project = (PACKAGE / "pyproject.toml").read_text("utf-8")
    section = project.partition(f'[project.entry-points."{ROOMS}"]')[2].partition("\n[")[0]
    named = {**dict(re.findall(r'^(\w+) = "(.+)"$', section, re.MULTILINE)), **(points or {})}
    about = folder / "gas_sensor-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: gas-sensor\nVersion: 1.0\n")
    lines = "".join(f"{name} = {place}\n" for name, place in named.items())
    (about / "entry_points.txt").write_text(f"[{ROOMS}]\n{lines}")
    before = dict(KINDS)
    sys.path.insert(0, str(folder))
    invalidate_caches()
    add_installed.cache_clear()
    try:
        yield
    finally:
        sys.path.remove(str(folder))
        add_installed.cache_clear()
        KINDS.clear()
        KINDS.update(before)
        for name in [name for name in sys.modules if name.partition(".")[0] == "gas_sensor"]:
            del sys.modules[name]


def drive(folder: Path) -> Path:
    """Five seconds at 10 Hz: number i of /gas is 10 i ppm; the sensor is ready after two seconds; a bumper."""
    header = "std_msgs/Header header\n"
    definitions.add({GAS: f"{header}float32 ppm", STATUS: f"{header}string status"})
    return recorded.write(folder, {"/gas": GAS, "/gas/status": STATUS, "/cliff": "sensor_msgs/msg/Range"}, _messages())


def _messages() -> Iterator[tuple[float, str, dict[str, Any]]]:
    for i in range(COUNT):
        seconds = i * STEP
        header = stamped(START_NS + round(seconds * 1e9), "front")
        if seconds in SAYS:
            yield seconds, "/gas/status", {"header": header, "status": SAYS[int(seconds)]}
        yield seconds, "/gas", {"header": header, "ppm": 10.0 * i}
        yield seconds, "/cliff", {"header": header, "min_range": 0.3, "max_range": 0.3, "range": float("inf")}
