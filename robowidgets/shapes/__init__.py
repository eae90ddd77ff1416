"""What a program draws on a scan: lines, points, polygons, arcs, poses and text."""

from .forms import Arc, Line, Points, Polygon, Pose, Shape, Text

__all__ = ["Arc", "Line", "Points", "Polygon", "Pose", "Shape", "Text"]
