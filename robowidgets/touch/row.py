"""The row of touch sensors."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..kinds import Kind
from ..messages import to_touch
from ..messages.standard import RANGE, ContactMessages
from ..messages.touch import TOUCH_TYPES
from ..samples import Touch
from ..samples.touch_tracker import TouchesBetween

if TYPE_CHECKING:
    from ..recordings.columns.touches import Touches
    from ..simulator import Robot
    from ..simulator.offers import Offer
    from ..touch_widget import TouchWidget
    from .frames import TouchFrames
    from .rerun_log import TouchLog


def _widget() -> type[TouchWidget]:
    from ..touch_widget import TouchWidget

    return TouchWidget


def _columns() -> type[Touches]:
    from ..recordings.columns.touches import Touches

    return Touches


def _frames() -> type[TouchFrames]:
    from .frames import TouchFrames

    return TouchFrames


def _rerun() -> type[TouchLog]:
    from .rerun_log import TouchLog

    return TouchLog


def _simulated(robot: Robot) -> list[Offer]:
    """Return the topic of the bumpers, with messages of the robot's model."""
    from ..simulator.offers import Offer

    model = robot.model
    return [Offer("/bumper", model.touch_type, robot.touch, model.to_message)] if model.touch_type else []


TOUCH = Kind(
    name="touch",
    sample_name="touch",
    noun="touch sensors",
    sample=Touch,
    read=to_touch,
    # The last type belongs to the simulator, and has no message.
    types=TOUCH_TYPES | {"robowidgets/msg/Touch"},
    # A Range whose min and max are equal is a binary touch sensor (REP 117), another one is a sonar.
    undecided=frozenset({RANGE}),
    widget=_widget,
    nothing=Touch({}),
    columns=_columns,
    frames=_frames,
    rerun=_rerun,
    to_message=ContactMessages,
    simulated=_simulated,
    gathered=TouchesBetween,
    goes_stale=False,
    every_message=True,
)
