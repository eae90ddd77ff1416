"""Shapes that a program draws on a scan: lines, points, polygons, arcs, arrows and text."""

from typing import TYPE_CHECKING, Any

from ..runtime.renamed import renamed
from .forms import Arc, Arrow, Line, Points, Polygon, Shape, Text

__all__ = ["Arc", "Arrow", "Line", "Points", "Polygon", "Shape", "Text"]

if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        return renamed(__name__, name, {"Pose": Arrow})
