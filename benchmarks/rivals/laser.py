from robowidgets import LaserWidget

from ..scan import ANGLE_INCREMENT, ANGLE_MIN, RANGE_MAX, RANGE_MIN

NAME = "robowidgets"
GEOMETRY = {
    "angle_min": ANGLE_MIN,
    "angle_increment": ANGLE_INCREMENT,
    "range_min": RANGE_MIN,
    "range_max": RANGE_MAX,
}


def make(ranges):
    laser = LaserWidget(title="/scan")

    def update(ranges):
        laser.update(ranges=ranges, **GEOMETRY)

    update(ranges)
    return laser, update
