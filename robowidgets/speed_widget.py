"""The speed widget: a velocity as bars up and down from zero, after the paper's speed visualization."""

from __future__ import annotations

import struct
from dataclasses import dataclass, replace
from math import isnan, nan
from numbers import Real
from typing import Any, ClassVar

import traitlets

from .messages import to_speed
from .samples import AXES, Speed
from .samples.age import arrival_of, note_arrival
from .widget.base_widget import check_given, refuse_unnamed
from .widget.front_end import bundle
from .widget.limit_traits import AxisLimits, Limits, Pair, is_past, unit_of
from .widget.robot_widget import RobotWidget
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import Flag, HistorySeconds

_FRAME = struct.Struct("<ddqd26d")
"""After the header: the known speeds (1: measured, 2: commanded), resets of the peaks, stamp of the commanded speed in
ns (0 without one) and its time of arrival, then the measured, the commanded, the least and the greatest speed by axis;
last the measured and the commanded steering angle, NaN without one."""

_MEASURED, _COMMANDED = 1, 2
_NO_VALUES = (nan,) * 6
OUT_OF_PLANE = slice(2, 5)
"""Linear z, angular x and y among `AXES`, which a planar widget does not show."""
_NO_SPEED: dict[str, Any] = {"linear": _NO_VALUES[:3], "angular": _NO_VALUES[3:]}


@dataclass(frozen=True)
class Reading:
    """The content of a speed widget: the measured and the commanded speed, and the peaks of the measured one."""

    measured: Speed | None = None
    commanded: Speed | None = None
    least: tuple[float, ...] = _NO_VALUES
    greatest: tuple[float, ...] = _NO_VALUES
    resets: int = 0

    @property
    def stamp_ns(self) -> int | None:
        """The stamp of the measured speed."""
        return self.measured.stamp_ns if self.measured else None

    def moved(self, speed: Speed) -> Reading:
        """Return the reading after the next measured speed. NaN does not change the peaks."""
        return replace(
            self,
            measured=speed,
            least=tuple(v if v < old or isnan(old) else old for v, old in zip(speed.values, self.least, strict=True)),
            greatest=tuple(
                v if v > old or isnan(old) else old for v, old in zip(speed.values, self.greatest, strict=True)
            ),
        )

    def reset(self, resets: int) -> Reading:
        """Return the reading with peaks that restart at the last measured speed."""
        values = self.measured.values if self.measured else _NO_VALUES
        return replace(self, least=values, greatest=values, resets=resets)


class SpeedWidget(RobotWidget[Reading]):
    """The live speed of a robot: linear x, y, z in m/s and angular x, y, z in rad/s as bars with exact numbers.

    The widget shows a bar for each axis, up from zero for a positive speed and down for a negative one, in the body
    frame of REP-103: linear x forward, y left, z up; angular about x (roll), y (pitch) and z (yaw, counter-clockwise).
    Limits are dashed; a bar past its limit turns red, with a mark and a text, and a bar longer than the scale is cut
    off. A commanded speed is a tick on the measured bar. A car also has a bar for its steering angle in rad, left is
    up. NaN is shown as "no value", never as 0. Hovering over an axis or walking with the arrow keys shows its exact
    value, limits, command and peaks; space freezes; all this works without the kernel. If a message cannot be shown,
    the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the topic.
        command_title: title of commanded speeds in the header; usually the topic.
        linear_limits: (min, max) in m/s with min <= 0 <= max, or one number for both sides. None for no limits, and a
            scale up to the fastest speed since the last reset of the peaks.
        angular_limits: the same in rad/s.
        limits: limits by axis, which replace these two: ``{"linear.x": (-0.2, 0.5), "angular.z": 1.8}``. To change it,
            set another dictionary.
        planar: True to show only linear x, linear y and yaw (angular z). The view writes it, too.
        bars: "commanded" if `update` gets commanded speeds and nothing is measured, which bars, legend and header then
            show; else "measured".
        over_time: seconds of each axis that are shown as lines below the bars, 0 (none) to 600; at most `history`.
        hold_peaks: True to mark the least and the greatest speed since the last reset.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them, for example to use the picture in a paper.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: limits that are not numbers, not finite, in the wrong order, or without zero between them;
            an unknown axis.

    Source: geometry_msgs/Twist, nav_msgs/Odometry, REP-103; Campusano and Fabry, "From Robots to Humans: Visualizations
    for Robot Sensor Data".

    Examples:
        >>> speed = SpeedWidget(title="/odom", linear_limits=(-0.2, 0.5), planar=True)
        >>> speed.update(linear=(0.62, 0.0, 0.0), angular=(0.0, 0.0, -0.3))
        >>> speed.over_limits
        {'linear.x': 0.62}
    """

    _esm, _css = bundle("speed_widget")
    _meant: ClassVar = {
        "max_speed": "linear_limits",
        "max_linear": "linear_limits",
        "max_angular": "angular_limits",
        "peaks": "hold_peaks",
    }
    _instead: ClassVar = {
        "linear": "widget.speed.linear",
        "angular": "widget.speed.angular",
    }

    sample_name = "speed"

    command_title = traitlets.Unicode(help="Title of commanded speeds in the header. Plain text.").tag(sync=True)
    linear_limits = Limits((-1.0, 1.0), "m/s", help="(min, max) of the linear speeds, m/s, or None.").tag(sync=True)
    angular_limits = Limits((-1.0, 1.0), "rad/s", help="(min, max) of the angular speeds, rad/s, or None.").tag(
        sync=True
    )
    limits = AxisLimits(help="(min, max) by axis, m/s and rad/s, instead of linear_limits and angular_limits.").tag(
        sync=True, to_json=lambda value, _: dict(value)
    )
    planar = Flag(False, help="Only linear x, y and angular z. Python and the view write it.").tag(sync=True)
    bars = traitlets.Enum(
        ("measured", "commanded"), "measured", help="The kind of speeds that `update` gets and the bars show."
    ).tag(sync=True)
    over_time = HistorySeconds(
        0.0, help="Seconds of each axis that are shown below the bars, 0 (none) to 600. Python and the view write it."
    ).tag(sync=True)
    hold_peaks = Flag(False, help="True to mark least and greatest speeds.").tag(sync=True)
    _resets = traitlets.Int(0, help="Number of resets of the peaks. Python and the view write it.").tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        self._reading = Reading()
        self._errors: dict[str, str] = {}
        self._planar_by_itself = False
        super().__init__(**kwargs)

    def update(self, message: Any = None, *unnamed: Any, **fields: Any) -> None:
        """Show a measured speed in the next animation frame.

        It only stores the speed, and may be called from any thread at any rate; the newest wins, but the peaks include
        all.

        Args:
            message: a geometry_msgs/Twist, TwistStamped, TwistWithCovariance(Stamped) or nav_msgs/Odometry of rclpy,
                rospy or rosbags, a rosbridge dictionary, or a `Speed`; or an ackermann_msgs/AckermannDrive(Stamped).
            *unnamed: raises an error with the call that takes numbers by name.
            **fields: instead of a message, linear (x, y, z in m/s) and angular (x, y, z in rad/s); an omitted one has
                no value.

        Raises:
            TypeError: not such a message, or an unknown field. ValueError: not three numbers. A callback (another
                thread; a task, timer or button of a notebook) raises nothing; the widget and the log show the error.
        """
        self._take("update", message, unnamed, fields)

    def command(self, message: Any = None, *unnamed: Any, **fields: Any) -> None:
        """Show a commanded speed, as a tick on each measured bar. See `update` for the arguments and errors."""
        self._take("command", message, unnamed, fields)

    def show_used_axes(self) -> None:
        """Set `planar` while the other axes are 0, measured and commanded, or until it is set by other code."""
        self.planar = self._planar_by_itself = True

    def reset_peaks(self) -> None:
        """Restart the peaks at the last measured speed."""
        self._resets += 1

    @property
    def speed(self) -> Speed | None:
        """The measured speed on show: the frozen one while paused, else the newest; None before the first.

        A frozen one has no pose. Use `wait` in loops, which returns the newest one with its pose, frozen or not.
        """
        return self._sample_on_show().measured

    @property
    def frozen(self) -> Speed | None:
        """The measured speed on show while frozen, which may be stepped back to; None while live."""
        return self.speed if self.paused else None

    @property
    def commanded(self) -> Speed | None:
        """The commanded speed on show, or None before the first."""
        return self._sample_on_show().commanded

    @property
    def over_limits(self) -> dict[str, float]:
        """The measured speeds on show that are past their limits, by axis. All six axes count, even if planar."""
        speed = self.speed
        values = speed.values if speed else _NO_VALUES
        return {axis: v for axis, v in zip(AXES, values, strict=True) if is_past(v, self.limits_of(axis))}

    @property
    def peaks(self) -> dict[str, Pair]:
        """The least and the greatest measured speed by axis, from the last reset to the speed on show.

        NaN before the first value. They are kept even if `hold_peaks` does not mark them.
        """
        reading = self._sample_on_show()
        return dict(zip(AXES, zip(reading.least, reading.greatest, strict=True), strict=True))

    def frame_of(self, sample: Any, commanded: Speed | None = None) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. The samples are speeds. Peaks are left out, because a player shows times in any order."""
        return {"frame_id": sample.frame_id}, self._pack(Reading(sample, commanded))

    def limits_of(self, axis: str) -> Pair | None:
        """Return the limits (min, max) of one axis, such as "linear.x", or None without limits."""
        group = self.linear_limits if axis.startswith("linear") else self.angular_limits
        pair: Pair | None = self.limits.get(axis, group)
        return pair

    def _describe(self) -> str:
        shown = self._sample_on_show()
        both = ((self.bars, shown.measured), ("commanded", shown.commanded))
        return "; ".join(f"{name} {_in_words(speed)}" for name, speed in both if speed)

    def _take(self, method: str, message: Any, unnamed: tuple[Any, ...], fields: dict[str, Any]) -> None:
        try:
            if unnamed or isinstance(message, Real):
                refuse_unnamed(method, (message, *unnamed), f"{method}(linear=(0.2, 0, 0), angular=(0, 0, 0.5))")
            check_given(method, message, fields, "or linear and angular (three numbers each)", ("linear", "angular"))
            speed = to_speed(Speed(**{**_NO_SPEED, **fields}) if message is None else message)
        except (TypeError, ValueError) as error:
            if method == "command" and "command()" not in str(error):
                error = type(error)(f"command(): {error}")
            self._errors[method] = f"{error}."
            self._refuse(error)
            return
        with self._newest.lock:
            self._errors.pop(method, None)
            if method == "update":
                self._reading = self._reading.moved(speed)
            else:
                self._reading = replace(self._reading, commanded=speed)
            # Rate and count belong to the measured speed, once there is one.
            self._put_up(counts=method == "update" or self._reading.measured is None)
        if self._planar_by_itself and any(value and not isnan(value) for value in speed.values[OUT_OF_PLANE]):
            self.planar = False

    def _put_up(self, *, counts: bool) -> None:
        shown = self._reading.measured or self._reading.commanded
        about: dict[str, Any] = {"frame_id": shown.frame_id if shown else ""}
        if self._errors:
            about["error"] = " ".join(self._errors.values())
        self._show(self._reading, about, counts=counts)

    @traitlets.observe("planar")
    def _leave_planar(self, _change: Any) -> None:
        self._planar_by_itself = False

    @traitlets.observe("_resets")
    def _reset(self, _change: Any) -> None:
        with self._newest.lock:
            self._reading = self._reading.reset(self._resets)
            if self._reading.measured or self._reading.commanded:
                self._put_up(counts=False)

    def _to_judge(self, shown: Reading | None) -> Speed | None:
        return shown.measured if shown else None

    def _newest_measured(self) -> Speed | None:
        return self._reading.measured

    def _sample_on_show(self) -> Reading:
        return super()._sample_on_show() or Reading()

    def _pack(self, sample: Reading) -> bytes:
        measured, commanded = sample.measured, sample.commanded
        return _FRAME.pack(
            (_MEASURED if measured else 0) + (_COMMANDED if commanded else 0),
            sample.resets,
            (commanded.stamp_ns or 0) if commanded else 0,
            arrival_of(commanded) if commanded else 0.0,
            *(measured.values if measured else _NO_VALUES),
            *(commanded.values if commanded else _NO_VALUES),
            *sample.least,
            *sample.greatest,
            *(nan if speed is None or speed.steering is None else speed.steering for speed in (measured, commanded)),
        )

    def _unpack(self, frame: bytes) -> Reading:
        _, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
        there, resets, commanded_ns, commanded_arrived, *values = _FRAME.unpack_from(frame, FRAME_HEADER.size)
        frame_id = self._frozen_about.get("frame_id", "")
        angles = [None if isnan(angle) else angle for angle in values[24:]]
        measured = Speed(tuple(values[:3]), tuple(values[3:6]), stamp_ns or None, frame_id, steering=angles[0])
        note_arrival(measured, arrived)
        commanded = Speed(tuple(values[6:9]), tuple(values[9:12]), commanded_ns or None, steering=angles[1])
        note_arrival(commanded, commanded_arrived)
        return Reading(
            measured if int(there) & _MEASURED else None,
            commanded if int(there) & _COMMANDED else None,
            tuple(values[12:18]),
            tuple(values[18:24]),
            int(resets),
        )


def _in_words(speed: Speed) -> str:
    """Return the axes that move, with their values, such as "linear.x 0.50 m/s"."""
    known = {axis: value for axis, value in zip(AXES, speed.values, strict=True) if not isnan(value)}
    moving = [f"{axis} {value:.2f} {unit_of(axis)}" for axis, value in known.items() if value]
    if speed.steering:
        moving.append(f"steering {speed.steering:.2f} rad")
    return ", ".join(moving) or ("at rest" if known else "unknown")
