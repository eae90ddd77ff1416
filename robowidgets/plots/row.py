"""The row of plots."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..kinds import OnDemandWidget

if TYPE_CHECKING:
    from ..plot_widget import PlotWidget
    from .frames import PlotFrames


def _widget() -> type[PlotWidget]:
    from ..plot_widget import PlotWidget

    return PlotWidget


def _frames() -> type[PlotFrames]:
    from .frames import PlotFrames

    return PlotFrames


_XYZ = ("x", "y", "z")
_ON_THE_FLOOR = ("linear.x", "linear.y", "angular.z")
_FORCES = (*(f"force.{axis}" for axis in _XYZ), *(f"torque.{axis}" for axis in _XYZ))
_WHOLE_NUMBERS = (f"{sign}{bits}" for sign in ("Int", "UInt") for bits in (8, 16, 32, 64))
PLOTTED: dict[str, tuple[str, ...]] = {
    **{f"std_msgs/msg/{name}": ("data",) for name in ("Float32", "Float64", *_WHOLE_NUMBERS)},
    "sensor_msgs/msg/Imu": ("angular_velocity.z", "linear_acceleration.x", "linear_acceleration.y"),
    "sensor_msgs/msg/MagneticField": tuple(f"magnetic_field.{axis}" for axis in _XYZ),
    "sensor_msgs/msg/Illuminance": ("illuminance",),
    "sensor_msgs/msg/FluidPressure": ("fluid_pressure",),
    "sensor_msgs/msg/Temperature": ("temperature",),
    "sensor_msgs/msg/RelativeHumidity": ("relative_humidity",),
    "geometry_msgs/msg/Point": _XYZ,
    "geometry_msgs/msg/Vector3": _XYZ,
    "geometry_msgs/msg/Vector3Stamped": tuple(f"vector.{axis}" for axis in _XYZ),
    "geometry_msgs/msg/Accel": _ON_THE_FLOOR,
    "geometry_msgs/msg/AccelStamped": tuple(f"accel.{name}" for name in _ON_THE_FLOOR),
    "geometry_msgs/msg/Wrench": _FORCES,
    "geometry_msgs/msg/WrenchStamped": tuple(f"wrench.{name}" for name in _FORCES),
}
"""The default fields in a plot of a topic: the numbers of most interest."""

PLOT = OnDemandWidget(
    name="plot",
    types=frozenset(PLOTTED),
    widget=_widget,
    frames=_frames,
    shared=True,
    plots_fields=True,
    fields=PLOTTED,
    goes_stale=False,
    every_message=True,
)
