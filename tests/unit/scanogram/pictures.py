"""The scans that a scanogram shows, and the size of its levels."""

from robowidgets import ScanogramWidget
from robowidgets.scanogram.levels import Levels
from robowidgets.scanogram_widget import Picture


def get_picture(widget: ScanogramWidget | None) -> Picture:
    """Return the picture of a scanogram that shows scans."""
    assert widget is not None
    picture = widget._picture
    assert picture is not None
    return picture


def get_size(levels: Levels) -> int:
    """Return the bytes of the levels that are kept."""
    return sum(codes.nbytes for codes in levels._kept)
