"""The laser view: a scan as hard data, after the paper's laser visualization."""

from __future__ import annotations

import struct
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
import traitlets

from ._core.base_widget import check_given, refuse_unnamed
from ._core.front_end import bundle
from ._core.timed_frame import FRAME_HEADER
from ._core.traits import Angle, Angles, BandTrait, Flag
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
"""Metres; no picture reaches farther."""


class ViewRange(traitlets.TraitType[Any, Any]):
    """The range of the picture: "sensor", "data", "auto", or metres above 0."""

    info_text = (
        '"sensor" (range_max), "data" (fit to the readings), "auto" (one of them), '
        f"or metres above 0, {FARTHEST:,} at most"
    )

    def validate(self, obj: Any, value: Any) -> str | float:
        """The setting, metres as a float."""
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
        """The distances as floats."""
        try:
            metres = [_metres(v) for v in value]
        except TypeError:
            metres = [None]
        distances = tuple(v for v in metres if v is not None)
        if len(metres) > 50 or len(distances) < len(metres):
            self.error(obj, value)
        return distances


class LaserWidget(
    HasTrail,  # trail, spread: scans before it; and from its bases own_angles, footprint: how scanner and robot stand
    HasGhost,  # ghost: the scan that it is compared with
    HasSonars,  # sonars: the ring whose cones are on its picture
    HasDepth,  # rows, calibrate: the scan that rows of a depth image are
    HasSectors,  # sectors, selection, pins, highlight, distance, code: what is pointed at
    DrawsShapes[Scan],  # draw, drawn: the shapes of programs; and from RobotWidget what all widgets of samples have
):
    """A laser scan, live: its detection area to scale, range arcs, labelled rays, and every ray with its number.

    The reader sees a gray sector from range_min to range_max over the swept angle, the robot at its centre, forward up
    and left on the left (REP-103); a red dot per reading; gray marks for rays that are too close, see nothing, hold no
    measurement or lie outside the limits (REP-117), each counted in the legend. Hovering names a ray, clicking pins it,
    space freezes, the wheel zooms; none of it needs the kernel. A message that cannot be shown leaves the last picture
    and says why above it.

    Args:
        title: what is shown, for the header; usually the topic.
        arc_count: range arcs that divide the view in equal parts, 0 to 50; None: at steps of 1, 2 or 5.
        arc_distances: distances of the arcs in metres, instead.
        ray_count: radial lines that divide the swept angle in equal parts, 0 to 360; None: at round angles from
            forward, and at both ends. Each says angle and index of a ray.
        ray_angles: angles of the lines, radians or text like "20deg", instead; each stands at the closest ray.
        view_range: "sensor", "data", metres, or "auto": "data" if the readings of the first scan fill less than a third
            of range_max, else "sensor". The view writes it, too: at that scan, and when a person zooms.
        forward: where the robot's forward is in the picture: "up", "left", "down" or "right".
        angle_offset: radians, or text like "20deg", added to every angle, within ±2 pi, for a scanner whose header lies
            about where it points. How the scanner stands on the robot is known by tf, or by `footprint`.
        own_angles: whether angles are shown as the scanner counts them, if it is turned on the robot. The view writes
            it, too.
        marks: which rays without a reading are drawn: of "too_close", "nothing_in_range", "no_measurement",
            "outside_limits".
        color_by_intensity: whether the intensities colour the dots.
        echo: which echo of each ray is shown of a scanner that sends several: "first", "last" or "strongest".
        band: of clouds of points, the lower and the upper height in metres of those that are shown as a scan; None:
            all.
        rows: of depth images, how many rows around the axis of the camera are shown as a scan; or the first row, and
            the one after the last.
        index_view: whether distance over index stands below the picture, as a program sees the array.
        sectors: kept sectors by name, each drawn with its name; see `sectors`.
        pins: indices of rays by name, each drawn with its name.
        angle_unit: in which all angles are shown, "deg" or "rad". The view writes it too.
        formula: whether the pop-up of the pinned ray shows how its angle is worked out. The view writes it too.
        free_space: whether the ground shows what the scanner has seen to be free.
        trail: how many scans before the one on show are behind it, the oldest palest, 0 (none) to 100: by odometry
            where a path is in its view, else in the scanner's frame.
        spread: over how many scans the spread of each ray is drawn, 2 to 100; 0: it is not.
        paused: whether the picture is frozen.
        history: seconds for which the page keeps samples to step back through while frozen, 0 (none) to 600.
        header, footer: whether they are there; without them the picture alone is fit for a paper.

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
        None, allow_none=True, min=0, max=50, help="Range arcs that divide the view in equal parts; None: at 1, 2 or 5."
    ).tag(sync=True)
    arc_distances = ArcDistances((), help="Distances of the range arcs in metres, instead of arc_count.").tag(sync=True)
    ray_count = traitlets.Int(
        None,
        allow_none=True,
        min=0,
        max=360,
        help="Radial lines that divide the swept angle in equal parts; None: at round angles.",
    ).tag(sync=True)
    ray_angles = Angles((), help="Angles of the radial lines in radians, instead of ray_count.").tag(sync=True)
    view_range = ViewRange("sensor", help="How far the picture reaches. Python and the view write it.").tag(sync=True)
    forward = traitlets.Enum(("up", "left", "down", "right"), "up", help="Where forward is.").tag(sync=True)
    angle_offset = Angle(0.0, help="Radians added to every angle, within ±2 pi.").tag(sync=True)
    marks = traitlets.List(traitlets.Enum(_MARKS), list(_MARKS), help="Marks that are drawn.").tag(sync=True)
    color_by_intensity = Flag(False, help="Whether intensities colour the dots.").tag(sync=True)
    echo = traitlets.Enum(CHOICES, "first", help="Which of several echoes of a ray is shown.").tag(sync=True)
    band = BandTrait(None, allow_none=True, help="Heights of the points of a cloud that are a scan.").tag(sync=True)
    free_space = Flag(False, help="Whether the ground shows what the scanner has seen to be free.").tag(sync=True)
    index_view = Flag(False, help="Whether distance over index stands below the picture.").tag(sync=True)
    angle_unit = traitlets.Enum(("deg", "rad"), "deg", help="Unit of all angles. Python and the view write it.").tag(
        sync=True
    )
    formula = Flag(False, help="Whether the pinned pop-up shows its formula. Python and the view write it.").tag(
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

        It only stores, and may be called from any thread at any rate; the newest wins.

        Args:
            message: a sensor_msgs/LaserScan or MultiEchoLaserScan of rclpy, rospy or rosbags, a rosbridge dictionary,
                or a `Scan`; or a `Cloud`, or a message with one, whose points within `band` are shown: the nearest of
                each half degree; or a depth image, of which `rows` are shown, once `calibrate` knows its camera.
            *unnamed: refused, with the call that takes numbers by name.
            **fields: instead of a message, its fields: ranges (R metres), angle_min and angle_increment (radians),
                range_min and range_max (metres), and if there are any intensities (R).

        Raises:
            TypeError: no such message, or an unknown field. ValueError: its numbers cannot be shown. In a callback
                (another thread; a task, timer or button of a notebook) nothing is raised; widget and log say it.
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
        """See `RobotWidget`: of a scan, or of a message with a cloud or a depth image."""
        try:
            scan = self.mounted(self.scan_in(sample)).echo(self.echo).turned(self.angle_offset)
        except (TypeError, ValueError) as error:  # what a recording has of a cloud or an image
            return {"error": f"{error}."}, self._pack(_NO_SCAN)
        judged = self._watches.judged_on(scan if len(scan) else None)
        return about_scan(scan, self.angle_offset) | self._drawn_on(scan) | judged, self._pack(scan)

    def scan_in(self, given: Any) -> Scan:
        """Return the scan that is given, or the scan of a cloud from above, or of the rows of a depth image.

        Raises:
            TypeError: no such message. ValueError: its numbers cannot be shown.
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
        """See `RobotWidget`: ranges, then intensities and sources if there are any."""
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
        """Show these heights of the next cloud: that on show is not kept."""
        self._band = change["new"]

    @traitlets.observe("echo")
    def _choose_echo(self, change: Any) -> None:
        """Show another echo of the scan on show too: it may be the only one that comes."""
        with self._newest.lock:
            self._echo = change["new"]
            newest = self._newest.sample
            if newest is not None:
                self._show(newest.echo(self._echo), self._newest.about, counts=False)

    @traitlets.observe("angle_offset")
    def _turn(self, change: Any) -> None:
        """Turn the scan on show too: it may be the only one that comes."""
        with self._newest.lock:
            self._offset = change["new"]
            newest = self._newest.sample
            if newest is not None:
                self._show(newest.turned(change["new"] - change["old"]), self._newest.about, counts=False)


def about_scan(scan: Scan, offset: float = 0.0) -> dict[str, Any]:
    """The texts on a scan: its frame, and its problems, if there are any, as pairs of words and remedy.

    The problem of a scan without a reading is apart: it stands in the picture, where the readings would be.

    Args:
        scan: the scan.
        offset: radians that were added to the scanner's own angles.
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
    """The mount in the texts on a scan, as `about_scan` wrote it; None if there is none."""
    given = {name: value for name, value in about.get("mount", {}).items() if name != "words"}
    return Mount(**given) if given else None


def _metres(value: Any) -> float | None:
    """A distance as a float; None for what is no number, not above 0, or absurdly far."""
    is_number = isinstance(value, (int, float, np.integer, np.floating)) and not isinstance(value, bool)
    return float(value) if is_number and 0 < value <= FARTHEST else None


def _refuse_array(message: Any) -> None:
    """TypeError for plain numbers; messages pass, also those that are tuples."""
    is_array = hasattr(message, "__array__") or (
        isinstance(message, Sequence) and not isinstance(message, (str, bytes))
    )
    if is_array and not hasattr(message, "ranges"):
        raise TypeError(
            f"update() got a {type(message).__name__} without the scanner's geometry; plain numbers go by name: "
            f"{_BY_NAME}"
        )
