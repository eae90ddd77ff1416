"""Recording bursts of scans, with any middleware."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import robowidgets
from robowidgets.feeds import Feed
from robowidgets.messages import to_scan

from ..pages import get_newest
from ..waiting import wait_for

BURSTS, OF = 10, 20
LAST = 9.0
"""The first reading of the scan that comes after all bursts; scans before the first burst have 0."""


class Recorded:
    """The result of ten bursts of 20 scans, whose first readings are 0.01, 0.02, ...

    ``there``: the readings in the file. ``missing``: the number in ``problems``. ``shown``: the number of scans that a
    function of the newest got.
    """

    def __init__(self, there: list[float], problems: tuple[str, ...], shown: int) -> None:
        self.there, self.problems, self.shown = there, problems, shown
        self.missing = sum(
            int(found[1]) for found in map(re.compile(r": (\d+) messages? lost").search, problems) if found
        )


def record_bursts(middleware: Any, path: Path, send: Callable[[list[float]], object]) -> Recorded:
    """Record the bursts while a laser shows them; ``send`` publishes scans on /scan, as fast as it can."""
    laser, seen = robowidgets.LaserWidget(), [float("nan")]
    with Feed(middleware) as feed:
        feed.connect("/scan", laser)
        wait_for(lambda: send([0.0]) or laser.scan, "scans come")
        with feed.record(path, "/scan") as recorder:
            feed.connection.attach("/scan", lambda said: seen.append(float(to_scan(said).ranges[0])), lambda _: None)
            wait_for(lambda: send([0.0]) or len(seen) > 2, "each is recorded")
            before = get_newest(laser).sequence
            for burst in range(BURSTS):
                send([(burst * OF + i + 1) / 100 for i in range(OF)])
            wait_for(lambda: send([LAST]) or seen[-1] == LAST, "the last came")
            shown = get_newest(laser).sequence - before
        problems = recorder.problems
    with robowidgets.open(path) as recording:
        readings = [round(float(moment.sample.ranges[0]), 2) for moment in recording.samples("/scan")]
    return Recorded([one for one in readings if 0 < one < LAST], problems, shown)


EVERY = [(i + 1) / 100 for i in range(BURSTS * OF)]
"""The readings of all bursts."""
