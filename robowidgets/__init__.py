"""The hard data of a robot's sensors, live in the notebook where the robot is programmed."""

from .laser_widget import LaserWidget
from .samples import Ray, Scan, Speed, Touch, TouchMode, TouchState, Validity

__version__ = "0.1.0"

__all__ = ["LaserWidget", "Ray", "Scan", "Speed", "Touch", "TouchMode", "TouchState", "Validity"]
