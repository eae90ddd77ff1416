"""The laser widget: a scan as raw data, after the paper's laser visualization."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import traitlets

from .laser.depth import HasDepth, is_image
from .laser.ghost import HasGhost
from .laser.sectors import HasSectors
from .laser.sonars import HasSonars
from .laser.trail import HasTrail
from .messages import to_cloud, to_scan
from .messages.cloud import is_cloud
from .messages.fields import unwrap
from .samples import Mount, Problem, Scan, Validity
from .samples.age import note_arrival
from .samples.echoes import CHOICES, Sources
from .samples.scan import MAX_RAYS
from .shapes.drawing import DrawsShapes
from .widget.base_widget import check_given, refuse_unnamed
from .widget.front_end import bundle
from .widget.timed_frame import FRAME_HEADER
from .widget.traits import Angle, Angles, BandTrait, Flag

_GEOMETRY = struct.Struct("<5d")
_FLOAT = np.dtype("<f4")
_FIELDS = (
    "ranges", "angle_min", "angle_max", "angle_increment", "range_min", "range_max", "intensities", "header",
    "time_increment", "scan_time",
)  # fmt: skip
_BY_NAME = "update(ranges=..., angle_min=..., angle_increment=..., range_min=..., range_max=...)"
_INSTEAD = f"or: {', '.join(_FIELDS)}"
_MARKS = tuple(kind.name.lower() for kind in Validity if kind is not Validity.READING)

_NO_SCAN = Scan(np.empty(0, np.float32), 0.0, 0.0, 0.0, 10.0)

FARTHEST = 100_000
"""The farthest metres in a picture."""


class ViewRange(traitlets.TraitType[Any, Any]):
    """The range of the picture: "sensor", "data", "auto", or metres above 0."""

    info_text = (
        '"sensor" (range_max), "data" (fit to the readings), "auto" (one of them), '
        f"or metres above 0, {FARTHEST:,} at most"
    )

    def validate(self, obj: Any, value: Any) -> str | float:
        """Return the setting, with metres as a float."""
        if isinstance(value, str) and value in ("sensor", "data", "auto"):
            return value
        metres = _metres(value)
        if metres is None:
            self.error(obj, value)
        return metres


class ArcDistances(traitlets.TraitType[Any, Any]):
    """Up to 50 distances in metres above 0."""

    info_text = f"up to 50 distances in metres above 0, {FARTHEST:,} at most"

    def validate(self, obj: Any, value: Any) -> tuple[float, ...]:
        """Return the distances as floats."""
        try:
            metres = [_metres(v) for v in value]
        except TypeError:
            metres = [None]
        distances = tuple(v for v in metres if v is not None)
        if len(metres) > 50 or len(distances) < len(metres):
            self.error(obj, value)
        return distances


class LaserWidget(
    HasTrail,  # trail, spread: earlier scans; and from its bases own_angles, footprint: the poses of scanner and robot
    HasGhost,  # ghost: a scan to compare with
    HasSonars,  # sonars: the cones of a ring on the picture
    HasDepth,  # rows, calibrate: rows of a depth image as a scan
    HasSectors,  # sectors, selection, pins, highlight, distance, code: marks
    DrawsShapes[Scan],  # draw, drawn: the shapes of programs; and from RobotWidget the parts of all widgets of samples
):
    """A live laser scan: its detection area to scale, range arcs, labelled rays, and every ray with its number.

    The widget shows a gray sector from range_min to range_max over the swept angle, the robot at its centre, forward up
    and left on the left (REP-103); a red dot for each reading; and gray marks for rays that are too close, see nothing,
    have no measurement or lie outside the limits (REP-117), with their numbers in the legend. Hovering shows a ray,
    clicking pins it, space freezes, the wheel zooms; all this works without the kernel. If a message cannot be shown,
    the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the topic.
        arc_count: range arcs that divide the view in equal parts, 0 to 50; by default at steps of 1, 2 or 5.
        arc_distances: distances of the arcs in metres, instead of a count.
        ray_count: radial lines that divide the swept angle in equal parts, 0 to 360; by default at round angles from
            forward, and at both ends. Each shows the angle and the index of a ray.
        ray_angles: angles of the lines, radians or text like "20deg", instead of a count; each is drawn at the closest
            ray.
        view_range: "sensor", "data", metres, or "auto": "data" if the readings of the first scan fill less than a third
            of range_max, else "sensor". The view writes it, too: at that scan, and when the user zooms.
        forward: the direction of the robot's forward in the picture: "up", "left", "down" or "right".
        angle_offset: radians, or text like "20deg", added to every angle, within ±2 pi, for a scanner with wrong angles
            in its messages. The mount of the scanner on the robot comes from tf, or from `footprint`.
        own_angles: True to show angles in the frame of the scanner, if it is turned on the robot. The view writes it,
            too.
        marks: kinds of rays without a reading to draw: "too_close", "nothing_in_range", "no_measurement",
            "outside_limits".
        color_by_intensity: True to colour the dots by intensity.
        echo: the echo of each ray to show, for a scanner that sends several: "first", "last" or "strongest".
        band: for clouds of points, the lower and the upper height in metres of the points to show as a scan; by default
            all.
        rows: for depth images, the number of rows around the axis of the camera to show as a scan; or the first row and
            the row after the last.
        index_view: True to show distance over index below the picture, like the array in a program.
        sectors: kept sectors by name, each drawn with its name; see `sectors`.
        pins: indices of rays by name, each drawn with its name.
        angle_unit: the unit of all angles, "deg" or "rad". The view writes it, too.
        formula: True to show the formula of the angle in the pop-up of the pinned ray. The view writes it, too.
        free_space: True to mark the ground that the scanner has seen to be free.
        trail: the number of earlier scans behind the one on show, the oldest palest, 0 (none) to 100; placed by
            odometry if a path is in its view, else in the scanner's frame.
        spread: the number of scans for the spread of each ray, 2 to 100, or 0 for none.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: False to hide them, for example to use the picture in a paper.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: sensor_msgs/LaserScan; Campusano and Fabry, "From Robots to Humans: Visualizations for Robot Sensor Data".

    Examples:
        >>> laser = LaserWidget(title="/scan", ray_angles=["-20deg", 0, "20deg"])
        >>> laser.update(ranges=[1.0, 1.5, 2.0], angle_min=-0.5, angle_increment=0.5, range_min=0.1, range_max=4.0)
        >>> laser.scan.distance()
        1.0
    """

    _esm, _css = bundle("laser_widget")
    _meant: ClassVar = {"arcs": "arc_count", "rays": "ray_count", "offset": "angle_offset"}
    _instead: ClassVar = {"ranges": "widget.scan.ranges", "angles": "widget.scan.angles"}
    _keywords = ("sectors", "pins")
    column = "wide"
    sample_name = "scan"
    frame_traits = ("angle_offset", "band", "echo", "rows", "_edition", "trail", "_robot")
    judges_frames = True

    arc_count = traitlets.Int(
        None,
        allow_none=True,
        min=0,
        max=50,
        help="Range arcs that divide the view in equal parts; at 1, 2 or 5 by default.",
    ).tag(sync=True)
    arc_distances = ArcDistances((), help="Distances of the range arcs in metres, instead of arc_count.").tag(sync=True)
    ray_count = traitlets.Int(
        None,
        allow_none=True,
        min=0,
        max=360,
        help="Radial lines that divide the swept angle in equal parts; at round angles by default.",
    ).tag(sync=True)
    ray_angles = Angles((), help="Angles of the radial lines in radians, instead of ray_count.").tag(sync=True)
    view_range = ViewRange("sensor", help="The range of the picture. Python and the view write it.").tag(sync=True)
    forward = traitlets.Enum(("up", "left", "down", "right"), "up", help="The direction of forward.").tag(sync=True)
    angle_offset = Angle(0.0, help="Radians added to every angle, within ±2 pi.").tag(sync=True)
    marks = traitlets.List(traitlets.Enum(_MARKS), list(_MARKS), help="Marks that are drawn.").tag(sync=True)
    color_by_intensity = Flag(False, help="True to colour the dots by intensity.").tag(sync=True)
    echo = traitlets.Enum(CHOICES, "first", help="The echo to show if a ray has several.").tag(sync=True)
    band = BandTrait(None, allow_none=True, help="Heights of the points of a cloud that are shown as a scan.").tag(
        sync=True
    )
    free_space = Flag(False, help="True to mark the ground that the scanner has seen to be free.").tag(sync=True)
    index_view = Flag(False, help="True to show distance over index below the picture.").tag(sync=True)
    angle_unit = traitlets.Enum(("deg", "rad"), "deg", help="Unit of all angles. Python and the view write it.").tag(
        sync=True
    )
    formula = Flag(False, help="True to show the formula in the pinned pop-up. Python and the view write it.").tag(
        sync=True
    )
    hovered = traitlets.Int(
        None,
        allow_none=True,
        min=0,
        max=MAX_RAYS,
        help="Index of the ray under the pointer, or None. The view writes it.",
    ).tag(sync=True, echo_update=False)
    pinned = traitlets.Int(
        None,
        allow_none=True,
        min=0,
        max=MAX_RAYS,
        help="Index of the pinned ray, or None. Python and the view write it.",
    ).tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        self._offset, self._echo = 0.0, "first"
        self._band: tuple[float, float] | None = None
        sectors, pins = kwargs.pop("sectors", {}), kwargs.pop("pins", {})
        super().__init__(**kwargs)
        try:
            self.sectors, self.pins = sectors, pins
        except (TypeError, ValueError):
            self.close()
            raise

    def update(self, message: Any = None, *unnamed: Any, **fields: Any) -> None:
        """Show a scan in the next animation frame.

        It only stores the scan, and may be called from any thread at any rate; the newest wins.

        Args:
            message: a sensor_msgs/LaserScan or MultiEchoLaserScan of rclpy, rospy or rosbags, a rosbridge dictionary,
                or a `Scan`; or a `Cloud`, or a message with one, to show its nearest point within `band` in each half
                degree; or a depth image, to show its `rows`, after `calibrate`.
            *unnamed: raises an error with the call that takes numbers by name.
            **fields: instead of a message, its fields: ranges (R metres), angle_min and angle_increment (radians),
                range_min and range_max (metres), and optionally intensities (R).

        Raises:
            TypeError: not such a message, or an unknown field. ValueError: its numbers cannot be shown. A callback
                (another thread; a task, timer or button of a notebook) raises nothing; the widget and the log show the
                error.
        """
        try:
            refuse_unnamed("update", unnamed, _BY_NAME)
            check_given("update", message, fields, _INSTEAD, _FIELDS)
            given = fields if message is None else message
            _refuse_array(unwrap(given))
            scan = self.scan_in(given)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            with self._newest.lock:
                self._show(self.mounted(scan).echo(self._echo).turned(self._offset))

    @property
    def scan(self) -> Scan | None:
        """The scan on show: the frozen one while paused, else the newest; None before the first."""
        return self._sample_on_show()

    @property
    def frozen(self) -> Scan | None:
        """The scan on show while frozen, which may be stepped back to; None while live and before the first."""
        return self.scan if self.paused else None

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. The sample is a scan, or a message with a cloud or a depth image."""
        try:
            scan = self.mounted(self.scan_in(sample)).echo(self.echo).turned(self.angle_offset)
        except (TypeError, ValueError) as error:  # a cloud or an image in a recording
            return {"error": f"{error}."}, self._pack(_NO_SCAN)
        judged = self._watches.judged_on(scan if len(scan) else None)
        return about_scan(scan, self.angle_offset) | self._drawn_on(scan) | judged, self._pack(scan)

    def scan_in(self, given: Any) -> Scan:
        """Return a given scan, or the scan of a cloud from above, or of rows of a depth image.

        Raises:
            TypeError: not such a message. ValueError: its numbers cannot be shown.
        """
        if is_image(given):
            return self._scan_of_image(given)
        if not is_cloud(given):
            return to_scan(given)
        cloud = to_cloud(given)
        return cloud.scan() if self._band is None else cloud.scan(z=self._band)

    def _describe(self) -> str:
        return repr(self.scan).strip("<>") if self.scan else ""

    def _about_sample(self, sample: Scan) -> dict[str, Any]:
        about = about_scan(sample, self._offset) | self._placed(sample)
        meter = self._newest.meter
        usual = meter.usual if meter.has_sagged else 0.0
        if usual:
            sagged = (
                f"scans come at less than half of their usual {usual:.2g} Hz",
                "is the network slow, or the robot's computer busy?",
            )
            about["problems"] = (*about.get("problems", ()), sagged)
        return about

    def arrays_of(self, frame: bytes) -> tuple[int, int]:
        """See `RobotWidget`. The arrays are ranges, and intensities and sources if there are any."""
        *_, count = _GEOMETRY.unpack_from(frame, FRAME_HEADER.size)
        head = FRAME_HEADER.size + _GEOMETRY.size
        return head, (len(frame) - head) // (4 * int(count)) if count else 0

    def _pack(self, sample: Scan) -> bytes:
        ranges, intensities = sample.ranges, sample.intensities
        head = _GEOMETRY.pack(sample.angle_min, sample.angle_increment, sample.range_min, sample.range_max, ranges.size)
        columns = [ranges, intensities] if intensities.size else [ranges]
        if sample.sources:
            numbers = sample.sources.numbers
            none = np.full(ranges.size, np.nan, _FLOAT)
            columns = [ranges, intensities if intensities.size else none, np.where(numbers < 0, none, numbers)]
        return b"".join([head, *[column.astype(_FLOAT, copy=False).data for column in columns]])

    def _unpack(self, frame: bytes, about: Mapping[str, Any] | None = None) -> Scan:
        _, _, stamp_ns, arrived = FRAME_HEADER.unpack_from(frame)
        angle_min, angle_increment, range_min, range_max, count = _GEOMETRY.unpack_from(frame, FRAME_HEADER.size)
        values = np.frombuffer(frame, _FLOAT, offset=FRAME_HEADER.size + _GEOMETRY.size)
        ranges, intensities, numbers = (values[i * int(count) : (i + 1) * int(count)] for i in range(3))
        texts = self._frozen_about if about is None else about
        sources = None
        if numbers.size:
            made_of, code = texts.get("made_of", ("", ""))
            sources = Sources(made_of, code, np.where(np.isnan(numbers), -1, numbers).astype(np.int32))
        known = (*([texts["empty"]] if "empty" in texts else []), *texts.get("problems", ()))
        scan = Scan(
            ranges=ranges,
            angle_min=angle_min,
            angle_increment=angle_increment,
            range_min=range_min,
            range_max=range_max,
            intensities=intensities[:0] if sources and np.isnan(intensities).all() else intensities,
            stamp_ns=stamp_ns or None,
            frame_id=texts.get("frame_id", ""),
            header_problems=tuple(Problem(*problem) for problem in known),
            sources=sources,
            mount=mount_from(texts),
        )
        note_arrival(scan, arrived)
        return scan

    @traitlets.observe("band")
    def _choose_band(self, change: Any) -> None:
        """Use these heights from the next cloud on: the cloud on show is not kept."""
        self._band = change["new"]

    @traitlets.observe("echo")
    def _choose_echo(self, change: Any) -> None:
        """Change the echo of the scan on show, too, because no other may come."""
        with self._newest.lock:
            self._echo = change["new"]
            newest = self._newest.sample
            if newest is not None:
                self._show(newest.echo(self._echo), self._newest.about, counts=False)

    @traitlets.observe("angle_offset")
    def _turn(self, change: Any) -> None:
        """Turn the scan on show, too, because no other may come."""
        with self._newest.lock:
            self._offset = change["new"]
            newest = self._newest.sample
            if newest is not None:
                self._show(newest.turned(change["new"] - change["old"]), self._newest.about, counts=False)


def about_scan(scan: Scan, offset: float = 0.0) -> dict[str, Any]:
    """Return the texts on a scan: its frame, and its problems, if any, as pairs of problem and remedy.

    The problem of a scan without a reading is separate: it is shown in the picture instead of the readings.

    Args:
        scan: the scan.
        offset: radians that were added to the angles of the scanner.
    """
    about: dict[str, Any] = {"frame_id": scan.frame_id, **({"angle_offset": offset} if offset else {})}
    if scan.mount and scan.mount.words:
        about["mount"] = {**scan.mount.to_json(), "words": scan.mount.words}
    if scan.sources:
        about["made_of"] = [scan.sources.made_of, scan.sources.code]
    odd = scan.problems()
    if odd and not scan.valid.any():
        about["empty"], *odd = odd  # type: ignore[assignment]
    return {**about, "problems": odd} if odd else about


def mount_from(about: Mapping[str, Any]) -> Mount | None:
    """Return the mount in the texts on a scan by `about_scan`, or None without one."""
    given = {name: value for name, value in about.get("mount", {}).items() if name != "words"}
    return Mount(**given) if given else None


def _metres(value: Any) -> float | None:
    """Return a distance as a float; None if it is not a number, not above 0, or absurdly far."""
    is_number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return float(value) if is_number and 0 < value <= FARTHEST else None


def _refuse_array(message: Any) -> None:
    """Raise TypeError for plain numbers. Messages pass, even if they are tuples."""
    is_array = hasattr(message, "__array__") or (
        isinstance(message, Sequence) and not isinstance(message, (str, bytes))
    )
    if is_array and not hasattr(message, "ranges"):
        raise TypeError(
            f"update() got a {type(message).__name__} without the scanner's geometry; plain numbers go by name: "
            f"{_BY_NAME}"
        )
