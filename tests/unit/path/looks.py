"""The states of a map whose looks are kept."""

from __future__ import annotations

import numpy as np

from robowidgets import MapGrid, PathWidget
from robowidgets.samples import Pose

from ...looks import Look


def _path() -> PathWidget:
    path = PathWidget(title="/odom")
    for i in range(9):
        path.update(x=0.25 * i, y=0.02 * i * i, yaw=0.1 * i, time=i / 2)
    return path


def _map() -> PathWidget:
    path = _path()
    cells = np.array([[0, 0, 100, 255], [0, 50, 100, 255], [0, 0, 0, 255]], np.uint8)
    path.put("/map", MapGrid(cells, 0.5, Pose(-0.5, -0.5, 0.0), frame_id="odom"), time=4.0)
    goal = {"position": {"x": 1, "y": 1}, "orientation": {"x": 0, "y": 0, "z": 0, "w": 1}}
    path.put("goal", {"header": {"frame_id": "odom"}, "pose": goal}, time=4.0)
    return path


LOOKS = {
    "path/empty": Look(make=lambda: PathWidget(title="/odom")),
    "path/path": Look(make=_path),
    "path/map": Look(make=_map),
}
