import numpy as np

from robowidgets import LaserWidget, Line, conditions

from ..scan import FAR, encode
from .laser import GEOMETRY

NAME = "robowidgets, everything on"
QUARTERS = {"front": "front", "left": "left", "right": "right", "ahead": ("-15deg", "15deg")}


def make(ranges):
    """Four sectors, two conditions (one of them true), a ghost, the index view, and twenty shapes with each scan."""
    laser = LaserWidget(title="/scan", index_view=True, sectors=QUARTERS)
    laser.watch(lambda scan: scan.distance("front") < 1, name="close")
    laser.watch(conditions.nearest_below(FAR, ("-20deg", "20deg")), name="seen")
    places = [(2 * np.cos(angle), 2 * np.sin(angle)) for angle in np.linspace(-2, 2, 20)]

    def update(ranges):
        laser.update(ranges=ranges, **GEOMETRY)
        near = float(ranges[-1])
        for i, (x, y) in enumerate(places):
            laser.draw(f"shape {i}", Line((x, y), (x, y + near / 20)))

    update(encode(0))
    laser.ghost = laser.scan
    update(ranges)
    return laser, update
