"""The states of a sonar widget whose looks are kept."""

from __future__ import annotations

from math import inf, nan, pi

from robowidgets import Range, SonarWidget

from ...looks import Look


def _ring() -> SonarWidget:
    sonars = SonarWidget(title="/sonar", poses={"left": pi / 2, "front": 0.0, "right": -pi / 2}, near=0.5)
    sonars.update({"left": Range(1.5, 0.1, 4.0, 0.5), "front": Range(0.42, 0.1, 4.0, 0.5), "right": Range(inf)})
    return sonars


def _bars() -> SonarWidget:
    sonars = SonarWidget(title="/sonar")
    sonars.update({"left": Range(1.5, 0.1, 4.0), "right": Range(nan, 0.1, 4.0)})
    return sonars


LOOKS = {
    "sonar/empty": Look(make=lambda: SonarWidget(title="/sonar")),
    "sonar/ring": Look(make=_ring),
    "sonar/bars": Look(make=_bars),
    "sonar/stale": Look(make=_ring, traits={"_silence": 12.0}),
}
