"""The states of a laser widget whose looks are kept."""

from __future__ import annotations

from contextlib import suppress
from math import inf, nan, pi, sin

from robowidgets import Arrow, Footprint, LaserWidget, Line, Scan

from ...looks import Look


def _scan() -> Scan:
    """A room, with a ray of each class."""
    ranges = [1 + 0.3 * sin(i) for i in range(31)]
    ranges[5:9] = [inf, nan, 0.02, -inf]
    return Scan(ranges, -pi / 2, pi / 30, 0.1, 5.0, stamp_ns=7)


def _live() -> LaserWidget:
    laser = LaserWidget(title="/scan")
    laser.update(_scan())
    return laser


def _layers() -> LaserWidget:
    laser = LaserWidget(title="/scan", sectors={"front": "front"}, pins={"corner": 22}, view_range=2.0)
    laser.footprint = Footprint(radius=0.18, bumpers={"left": ("15deg", "80deg")})
    laser.draw("wall", Line((1, -1), (1, 1)))
    laser.draw("way", Arrow((0.6, -0.3), "-30deg"))
    laser.update(_scan())
    laser.highlight(slice(10, 14))
    return laser


def _sectors() -> LaserWidget:
    laser = LaserWidget(title="/scan", sectors={"left": ("40deg", "80deg"), "front": "front"}, index_view=True)
    laser.update(_scan())
    laser.highlight(slice(2, 5))
    return laser


def _frozen() -> LaserWidget:
    laser = _live()
    laser.get_state()
    laser.paused = True
    laser.update(_scan())
    return laser


def _failed() -> LaserWidget:
    laser = _live()
    with suppress(ValueError):  # it is shown on the widget, too
        laser.update(ranges=[1.0, 2.0], angle_min=0.0, angle_increment=0.1, range_min=5.0, range_max=1.0)
    return laser


LOOKS = {
    "laser/empty": Look(make=lambda: LaserWidget(title="/scan")),
    "laser/live": Look(make=_live),
    "laser/layers": Look(make=_layers, height=320),
    "laser/picked": Look(make=_sectors, traits={"_selection": {"name": "front"}}, height=320),
    "laser/stale": Look(make=_live, traits={"_silence": 6.0}),
    "laser/frozen": Look(make=_frozen),
    "laser/failed": Look(make=_failed),
    "laser/popup": Look(make=_live, steps=({"event": "pointermove", "at": (140, 100)},)),
    "laser/help": Look(make=_live, steps=({"event": "keydown", "key": "?"},)),
}
