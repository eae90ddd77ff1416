"""The states of a cloud widget whose looks are kept."""

from __future__ import annotations

import numpy as np

from robowidgets import CloudWidget

from ...looks import Look


def _points(**options: object) -> CloudWidget:
    steps = np.arange(12) / 3
    cloud = CloudWidget(title="/points", **options)
    cloud.update(np.stack([1 + np.cos(steps), np.sin(steps), steps / 4], axis=1))
    return cloud


LOOKS = {
    "cloud/empty": Look(make=lambda: CloudWidget(title="/points")),
    "cloud/points": Look(make=_points),
    "cloud/selected": Look(make=lambda: _points(selection={"z": (0.1, 0.5)})),
}
