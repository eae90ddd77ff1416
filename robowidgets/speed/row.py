"""The row of speeds. Odometry also has a map, in the room `robowidgets.path`."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from typing import TYPE_CHECKING, Any

from ..kinds import Kind, Role
from ..messages import to_speed
from ..messages.fields import FLOATS, MessageShape
from ..messages.standard import ODOMETRY, speed_message
from ..messages.twist import TWIST
from ..path.row import PATH
from ..samples import Speed

if TYPE_CHECKING:
    from ..recordings.columns.speeds import Speeds
    from ..simulator import Robot
    from ..simulator.offers import Offer
    from ..speed_widget import SpeedWidget
    from .rerun_log import SpeedLog


def _widget() -> type[SpeedWidget]:
    from ..speed_widget import SpeedWidget

    return SpeedWidget


def _columns() -> type[Speeds]:
    from ..recordings.columns.speeds import Speeds

    return Speeds


def _rerun() -> type[SpeedLog]:
    from .rerun_log import SpeedLog

    return SpeedLog


def _simulated(robot: Robot) -> list[Offer]:
    """Return the topics of odometry and of the commanded speed."""
    from ..simulator.offers import Offer

    return [Offer("/odom", ODOMETRY, robot.speed), Offer("/cmd_vel", TWIST, robot.command, obeyed=True)]


def _has_twist(shape: MessageShape) -> bool:
    twist: Any = shape
    while isinstance(twist, Mapping):
        if all(_is_vector(twist.get(part)) for part in ("linear", "angular")):
            return True
        twist = twist.get("twist")
    return False


def _is_vector(shape: Any) -> bool:
    return isinstance(shape, Mapping) and all(shape.get(axis) in FLOATS for axis in "xyz")


_STEERED = frozenset({"ackermann_msgs/msg/AckermannDrive", "ackermann_msgs/msg/AckermannDriveStamped"})
SPEED = Kind(
    name="speed",
    sample_name="speed",
    noun="speeds",
    sample=Speed,
    read=to_speed,
    types=_STEERED
    | {f"geometry_msgs/msg/Twist{suffix}" for suffix in ("", "Stamped", "WithCovariance", "WithCovarianceStamped")}
    | {ODOMETRY},
    widget=_widget,
    nothing=Speed((nan, nan, nan), (nan, nan, nan)),
    has_shape=_has_twist,
    columns=_columns,
    rerun=_rerun,
    roles=(
        Role(name="measured"),
        Role(name="commanded", take="command", commanded=True, standalone_options={"bars": "commanded"}),
    ),
    to_message=lambda: speed_message,
    simulated=_simulated,
    # No topic contains the speed limits of its robot.
    options={"linear_limits": None, "angular_limits": None},
    also=(PATH,),
    command_types=_STEERED,
)
