"""The sonar widget: a ring of sensors that measure one distance each, as cones from above."""

from __future__ import annotations

import struct
from array import array as array_type
from collections.abc import Iterable, Mapping
from contextlib import suppress
from math import inf, isnan, nan, radians
from numbers import Real
from typing import Any, ClassVar

import numpy as np
import traitlets

from .messages import to_range
from .messages.fields import MISSING, get, has, unwrap
from .poses.mounts import mounts_of
from .poses.transforms import Transform, transforms_in
from .samples import Pose, Problem, Range, Ranges
from .samples.age import arrival_of, note_arrival
from .samples.checks import finite, in_radians, shortest
from .samples.staleness import LIVE
from .widget.base_widget import refuse_unnamed
from .widget.front_end import bundle
from .widget.rate import RateMeter
from .widget.robot_widget import RobotWidget
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import Angle

MOST_SENSORS = 100

_COUNT = struct.Struct("<d")
_FLOAT = np.dtype("<f4")
_ROWS = 9
_NO_POSE = (nan, nan, nan)
_BY_NAME = 'update("front", 0.42), or update(front=0.42, left=1.5)'


class SonarWidget(RobotWidget[Ranges]):
    """A live ring of sonars or infrared sensors: a cone to scale for each, with its index, name, distance and angle.

    The widget shows the robot from above, forward up and left on the left (REP-103). Each cone is as wide as its beam
    and as long as the range of its sensor, and bright up to the nearest thing in it, which is a red arc: the thing may
    be anywhere on it. A sensor that is too close, sees nothing, has no measurement or is outside its limits is labelled
    (REP-117). A distance below `near` is filled with red, with a mark. The cone of a silent sensor turns pale. Hovering
    shows a sensor, clicking keeps it, space freezes, the wheel zooms; all this works without the kernel. If a message
    cannot be read, the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the name of the topics.
        poses: poses of sensors on the robot by name, instead of the poses in their readings: (x, y, yaw) in metres and
            radians in the robot's frame, or only the angle, in radians or text like "20deg". Sensors without a pose are
            spread evenly in the order of their names, counter-clockwise from forward, and the picture says so.
        near: metres; a distance below it is an alarm. No alarm by default.
        field_of_view: the opening angle of sensors whose messages do not contain it, radians or text like "20deg".
        view_range: metres from the robot to the edge of the picture; by default the range of the sensors. The view
            writes it, too.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them, for example to use the picture in a paper.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: sensor_msgs/Range, REP-103, REP-117.

    Examples:
        >>> sonars = SonarWidget(title="sonars", poses={"left": "90deg", "front": 0.0}, near=0.3)
        >>> sonars.update("front", 0.42)
        >>> sonars.update(left=Range(1.5, min_range=0.1, max_range=5.0))
        >>> sonars["front"].distance, sonars.nearest
        (0.42, 'front')
    """

    _esm, _css = bundle("sonar_widget")
    _meant: ClassVar = {
        "angles": "poses",
        "limit": "near",
        "stop": "near",
        "fov": "field_of_view",
    }
    _instead: ClassVar = {"distances": "widget.ranges"}
    column = "wide"
    sample_name = "sonars"

    poses = traitlets.Dict(
        key_trait=traitlets.Unicode(),
        help="x, y in metres and yaw in radians in the robot's frame, by the name of the sensor.",
    ).tag(sync=True)
    near = traitlets.Float(None, allow_none=True, help="Metres below which a distance is an alarm, above 0.").tag(
        sync=True
    )
    field_of_view = Angle(
        radians(15), help="Opening angle in radians of sensors without one in their messages, above 0 and up to 2 pi."
    ).tag(sync=True)
    view_range = traitlets.Float(
        None, allow_none=True, help="Metres to the edge of the picture, above 0. Python and the view write it."
    ).tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        self._ranges = Ranges({})
        self._meters: dict[str, tuple[RateMeter, int]] = {}
        """The meter of the rate of each sensor, and the number of its readings."""
        self._silences: dict[str, float] = {}
        """The seconds without a reading after which each sensor is silent, by its rate or set by a player."""
        self._errors: dict[str, str] = {}
        self._transforms: dict[str, Transform] = {}
        self._mounts: dict[str, Pose] = {}
        """Poses from tf, by frame."""
        super().__init__(**kwargs)

    def update(self, sensor: Any = None, reading: Any = MISSING, /, *unnamed: Any, **readings: Any) -> None:
        """Show readings of sensors in the next animation frame.

        It only stores the readings, and may be called from any thread at any rate; the newest of each sensor wins.

        Args:
            sensor: the name of a sensor; or a mapping of names to readings; or a message, which is named by its
                frame_id.
            reading: the reading of that sensor: metres, None for no measurement, a `Range`, or a sensor_msgs/Range of
                rclpy, rospy, rosbags or rosbridge. A std_msgs/Float32MultiArray, or another array of metres, is a
                sensor for each of its numbers: ``"ir_0"``, ``"ir_1"`` for the name ``"ir"``.
            *unnamed: raises an error with the call that takes readings by name.
            **readings: instead, readings by the names of their sensors.

        Raises:
            TypeError: not such a message. ValueError: its numbers cannot be shown. The readings of other sensors in the
                same call are shown. A callback (another thread; a task, timer or button of a notebook) raises nothing;
                the widget and the log show the error.
        """
        try:
            refuse_unnamed("update", unnamed, _BY_NAME)
            given = _by_name(sensor, reading, readings)
            given = given if isinstance(given, Ranges) else _each(given)
        except (TypeError, ValueError) as error:
            self._note("", error)
            self._refuse(error)
            return
        if isinstance(given, Ranges):
            with self._newest.lock:
                self._errors.clear()
                self._put_up(given)
            return
        read = {name: self._read(name, value) for name, value in given.items()}
        good = {name: one for name, one in read.items() if isinstance(one, Range)}
        bad = {name: one for name, one in read.items() if isinstance(one, Exception)}
        with self._newest.lock:
            for name in ("", *good):
                self._errors.pop(name, None)
            if good:
                for name, one in good.items():
                    self._count(name, one)
                self._put_up(self._ranges.updated(good))
            for name, wrong in bad.items():
                self._note(name, wrong)
        if bad:
            self._refuse(next(iter(bad.values())))

    def expect(self, *names: str) -> None:
        """Show sensors before their first reading. Sensors in `poses` are always shown."""
        with self._newest.lock:
            if not self._ranges.keys() >= set(names):
                self._put_up(self._ranges.expecting(names), counts=False)

    @property
    def frame_topics(self) -> str:
        """See `TakesFrames` in `poses.live_frames`. It needs tf, unless a player sets the poses."""
        return "" if self.driven_by_player else "tf"

    def take_frames(self, message: Any) -> None:
        """Take the newest message of tf, which may contain the poses of sensors. `poses` has priority."""
        with self._newest.lock:
            with suppress(ValueError):
                for one in transforms_in(unwrap(message), True, 0):
                    self._transforms[one.child] = one
            mounts = mounts_of(self._transforms.values())
            if mounts != self._mounts:
                self._mounts = mounts
                self._put_up(self._ranges, counts=False)

    def take_static_frames(self, message: Any) -> None:
        """See `take_frames`. Sensors do not move on their robot."""
        self.take_frames(message)

    def be_silent_after(self, seconds: Mapping[str, float]) -> None:
        """Set the seconds without a reading after which sensors are silent, instead of by their rates."""
        with self._newest.lock:
            self._silences.update(seconds)

    def reset(self) -> None:
        """Forget all sensors, such as an unplugged one. Each is back with its next reading."""
        with self._newest.lock:
            for kept in (self._meters, self._silences, self._errors):
                kept.clear()
            self._put_up(Ranges({}).expecting(self.poses), counts=False)

    @property
    def ranges(self) -> Ranges:
        """The newest range of each sensor on show, by name: the frozen ones while paused."""
        return self._sample_on_show() or Ranges({})

    @property
    def frozen(self) -> Ranges | None:
        """The ranges on show while frozen, or None while live."""
        return self.ranges if self.paused else None

    @property
    def nearest(self) -> str | None:
        """The name of the sensor on show with the nearest thing; None if nothing is in range, or if all is unknown."""
        return self.ranges.nearest

    def __getitem__(self, name: str) -> Range:
        return self.ranges[name]

    def __iter__(self) -> Any:
        return iter(self.ranges)

    def frame_of(self, sample: Ranges) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. It is for players, in which the shown time stands still."""
        return {**self._about_sample(sample), "still": True}, self._pack(sample)

    def arrays_of(self, frame: bytes) -> tuple[int, int]:
        """See `RobotWidget`."""
        (count,) = _COUNT.unpack_from(frame, FRAME_HEADER.size)
        return FRAME_HEADER.size + _COUNT.size, _ROWS if count else 0

    def _describe(self) -> str:
        return repr(self.ranges).strip("<>") if self.ranges else ""

    def _read(self, name: Any, value: Any) -> Range | Exception:
        """Return the range of a sensor in a given value, or the error in it."""
        try:
            return self._range_of(name, value)
        except (TypeError, ValueError) as error:
            return type(error)(f"{name}: {error}")

    def _range_of(self, name: Any, value: Any) -> Range:
        if not isinstance(name, str) or not name:
            raise TypeError(f"expected the name of a sensor, got {name!r}")
        if name not in self._ranges and len(self._ranges) >= MOST_SENSORS:
            raise ValueError(f"expected at most {MOST_SENSORS} sensors; reset() forgets them")
        if value is None or (isinstance(value, Real) and not isinstance(value, bool)):
            return Range(nan if value is None else float(value))
        if isinstance(value, (bool, str)):
            raise TypeError(f"expected metres, a Range or a message like sensor_msgs/Range, got {value!r}")
        return to_range(value)

    def _count(self, name: str, reading: Range) -> None:
        """Set the seconds after which a sensor is silent."""
        meter, count = self._meters.get(name) or (RateMeter(), 0)
        self._meters[name] = meter, count + 1
        rate = meter.rate(count + 1, arrival_of(reading))
        self._silences[name] = LIVE.after(1 / rate if rate > 0 else inf)

    def _put_up(self, ranges: Ranges, *, counts: bool = True) -> None:
        """Show ranges, and the errors of sensors that cannot be shown. Called with the lock of the samples."""
        self._ranges = ranges
        self._show(ranges, {"error": " ".join(self._errors.values())} if self._errors else {}, counts=counts)

    def _note(self, name: str, error: Exception) -> None:
        """Keep the error of a sensor until its next good reading."""
        with self._newest.lock:
            self._errors[name] = f"{error}."

    def _refuse(self, error: Exception) -> None:
        """See `RobotWidget`. The errors of other sensors stay."""
        try:
            super()._refuse(error)
        finally:
            with self._newest.lock:
                self._newest.about = {**self._newest.about, "error": " ".join(self._errors.values())}
                self._say_more()

    def _about_sample(self, sample: Ranges) -> dict[str, Any]:
        about: dict[str, Any] = {
            "sensors": [[name, reading.radiation, reading.frame_id] for name, reading in sample.items()]
        }
        odd = [
            Problem(f"{name}: {problem.what}", problem.remedy)
            for name, reading in sample.items()
            for problem in reading.problems
        ]
        return {**about, "problems": odd} if odd else about

    def _pack(self, sample: Ranges) -> bytes:
        behind = sample.behind
        rows = [
            (
                reading.range,
                behind[name],
                self._silences.get(name, LIVE.longest),
                reading.min_range,
                reading.max_range,
                reading.field_of_view,
                *(reading.pose or self._mounts.get(reading.frame_id.lstrip("/")) or _NO_POSE),
            )
            for name, reading in sample.items()
        ]
        return b"".join([_COUNT.pack(len(rows)), np.array(rows, _FLOAT).T.tobytes()])

    def _unpack(self, frame: bytes) -> Ranges:
        _, _, _, arrived = FRAME_HEADER.unpack_from(frame)
        (count,) = _COUNT.unpack_from(frame, FRAME_HEADER.size)
        columns = np.frombuffer(frame, _FLOAT, offset=FRAME_HEADER.size + _COUNT.size).reshape(_ROWS, int(count))
        sensors = self._frozen_about.get("sensors", ())
        readings, times = {}, {}
        for (name, radiation, frame_id), row in zip(sensors, columns.T, strict=False):
            measured, behind, _, least, most, view, *place = row.tolist()
            pose = None if isnan(place[0]) else Pose(*map(shortest, place))
            readings[name] = Range(measured, least, most, view, radiation, frame_id=frame_id, pose=pose)
            times[name] = arrived - behind
            note_arrival(readings[name], times[name])
        return Ranges(readings, times)

    def _newest_measured(self) -> Ranges | None:
        newest: Ranges | None = self._newest.sample
        return newest if newest and newest.age < inf else None

    def _to_judge(self, shown: Ranges | None) -> Ranges | None:
        return shown if shown and shown.age < inf else None

    @traitlets.observe("poses")
    def _show_placed(self, _change: Any) -> None:
        self.expect(*self.poses)

    @traitlets.validate("poses")
    def _placed(self, proposal: Any) -> Any:
        try:
            return {name: _pose(f"poses[{name!r}]", pose) for name, pose in proposal["value"].items()}
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None

    @traitlets.validate("near", "view_range")
    def _metres(self, proposal: Any) -> Any:
        name, value = proposal["trait"].name, proposal["value"]
        if value is not None and not 0 < value <= _FARTHEST:
            raise traitlets.TraitError(
                f"{name}: expected metres above 0, {_FARTHEST:,} at most, or None, got {value!r}"
            )
        return value

    @traitlets.validate("field_of_view")
    def _opening(self, proposal: Any) -> Any:
        if proposal["value"] <= 0:
            raise traitlets.TraitError(
                f"field_of_view: expected radians above 0, up to 2 pi, got {proposal['value']!r}"
            )
        return proposal["value"]


_FARTHEST = 100_000
"""The farthest metres in a picture."""


def _by_name(sensor: Any, reading: Any, readings: Mapping[str, Any]) -> Mapping[Any, Any]:
    """Return the arguments of `update` as readings by sensor name."""
    if sensor is None:
        if not readings:
            raise TypeError(f"update() needs readings: {_BY_NAME}")
        return readings
    if readings:
        raise TypeError(f"update() takes one reading, a mapping or readings by name, not several of these: {_BY_NAME}")
    if isinstance(sensor, str):
        if reading is MISSING:
            raise TypeError(f"update() needs the reading of {sensor!r} too: {_BY_NAME}")
        return {sensor: reading}
    if reading is not MISSING:
        raise TypeError(f"update() takes the name of a sensor first: {_BY_NAME}; got {type(sensor).__name__}")
    message = unwrap(sensor)
    if isinstance(message, Range) or has(message, "range", "min_range", "max_range"):
        measured = to_range(message)
        if not measured.frame_id:
            raise ValueError('update() needs the name of the sensor: update("front", message); it has no frame_id')
        return {measured.frame_id: measured}
    if isinstance(message, Mapping):
        return message
    raise TypeError(f"update() takes the name of a sensor and its reading: {_BY_NAME}; got {type(message).__name__}")


def _each(given: Mapping[Any, Any]) -> Mapping[Any, Any]:
    """Return readings by name, with a separate name for each number of an array."""
    found: dict[Any, Any] = {}
    for name, value in given.items():
        array = get(value, "data", value) if has(value, "layout", "data") else value
        if isinstance(array, (array_type, np.ndarray, list, tuple)) and not hasattr(array, "range"):
            found |= {f"{name}_{i}": one for i, one in enumerate(np.ravel(array).tolist())}
        else:
            found[name] = value
    return found


def _pose(name: str, given: Any) -> tuple[float, float, float]:
    """Return the metres and radians of a pose on the robot, which may be given as an angle only."""
    if isinstance(given, (str, Real)):
        return 0.0, 0.0, in_radians(name, given)
    expected = f"{name}: expected (x, y, yaw) in metres and radians, or an angle"
    if not isinstance(given, Iterable):
        raise TypeError(f"{expected}; got {given!r}")
    values = tuple(given)
    if len(values) != 3:
        raise ValueError(f"{expected}; got {given!r}")
    x, y, yaw = values
    return finite(f"{name}.x", x, "metres"), finite(f"{name}.y", y, "metres"), in_radians(f"{name}.yaw", yaw)
