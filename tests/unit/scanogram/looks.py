"""The states of a scanogram whose looks are kept."""

from __future__ import annotations

from math import inf, nan

import numpy as np

from robowidgets import ScanogramWidget

from ...looks import Look


def _scans() -> ScanogramWidget:
    ranges = 1 + np.abs(np.sin(np.arange(20 * 31).reshape(20, 31) / 9))
    ranges[3, 5:8] = [inf, nan, 0.01]
    scanogram = ScanogramWidget(title="/scan")
    scanogram.update(
        times_ns=np.arange(20) * 100_000_000,
        ranges=ranges.astype(np.float32),
        angle_min=-1.5,
        angle_increment=0.1,
        range_min=0.1,
        range_max=8.0,
    )
    scanogram.set_touches([(0.25, 0.75, "left")], title="/bumper")
    return scanogram


def _selected() -> ScanogramWidget:
    scanogram = _scans()
    scanogram.selection = (0.5, 1.0)
    return scanogram


LOOKS = {
    "scanogram/empty": Look(make=lambda: ScanogramWidget(title="/scan")),
    "scanogram/scans": Look(make=_scans),
    "scanogram/selected": Look(make=_selected),
}
