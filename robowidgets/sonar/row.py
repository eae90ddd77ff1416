"""The row of sonars."""

from __future__ import annotations

from functools import partial
from math import nan
from typing import TYPE_CHECKING

from ..kinds import Kind, Role
from ..messages import to_range
from ..messages.standard import RANGE, range_message
from ..samples import Range, Ranges

if TYPE_CHECKING:
    from ..recordings.columns.distances import Distances
    from ..simulator import Robot
    from ..simulator.offers import Offer
    from ..sonar_widget import SonarWidget
    from .frames import SonarFrames


def _widget() -> type[SonarWidget]:
    from ..sonar_widget import SonarWidget

    return SonarWidget


def _columns() -> type[Distances]:
    from ..recordings.columns.distances import Distances

    return Distances


def _frames() -> type[SonarFrames]:
    from .frames import SonarFrames

    return SonarFrames


def _simulated(robot: Robot) -> list[Offer]:
    """Return a topic for each sonar. The sonars measure in turn."""
    from ..simulator.offers import Offer

    return [Offer(f"/sonar/{name}", RANGE, partial(robot.sonar, name)) for name in robot.sonars.poses]


SONAR = Kind(
    name="sonar",
    sample_name="sonar",
    noun="sonars",
    sample=Range,
    read=to_range,
    types=frozenset({RANGE}),
    # A Range whose min and max are equal is a binary touch sensor (REP 117).
    undecided=frozenset({RANGE}),
    widget=_widget,
    nothing=Range(nan),
    columns=_columns,
    frames=_frames,
    roles=(Role(name="sonars", combine=Ranges),),
    to_message=lambda: range_message,
    simulated=_simulated,
)
