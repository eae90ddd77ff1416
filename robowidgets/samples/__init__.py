"""The waist: what every source produces and every widget consumes.

A sample is immutable, in SI units and in the body frame of REP-103 (x forward, y left, z up; yaw grows
counter-clockwise). It knows neither ROS nor a page.
"""

from ._age import HasAge
from .scan import Ray, Scan, Validity
from .speed import AXES, Speed
from .touch import Touch, TouchMode, TouchState

__all__ = ["AXES", "HasAge", "Ray", "Scan", "Speed", "Touch", "TouchMode", "TouchState", "Validity"]
