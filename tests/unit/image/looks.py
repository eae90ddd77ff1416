"""The states of an image widget whose looks are kept."""

from __future__ import annotations

import numpy as np

from robowidgets import ImageWidget

from ...looks import Look


def _color() -> ImageWidget:
    camera = ImageWidget(title="/camera")
    camera.update(np.arange(12 * 16 * 3, dtype=np.uint8).reshape(12, 16, 3))
    return camera


def _depth() -> ImageWidget:
    camera = ImageWidget(title="/camera/depth")
    camera.update(np.linspace(0.5, 3, 12 * 16, dtype=np.float32).reshape(12, 16))
    camera.region = (2, 6, 3, 9)
    return camera


LOOKS = {
    "image/empty": Look(make=lambda: ImageWidget(title="/camera")),
    "image/color": Look(make=_color),
    "image/depth": Look(make=_depth),
}
