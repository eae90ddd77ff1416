"""The scanogram: every scan of a recording in one picture."""

from __future__ import annotations

import os
from collections.abc import Collection, Iterable, Sequence
from dataclasses import replace
from math import isfinite
from typing import Any, Protocol

import numpy as np
import traitlets
from numpy.typing import ArrayLike, NDArray

from .samples import AXES, Scan
from .samples.scan_problems import of_ranges
from .scanogram.levels import BUDGET, COARSEST, MEDIAN, NEAREST, Levels
from .scanogram.page_parts import detail, overview, pack
from .scanogram.picture import Picture
from .scanogram.scan_times import ScanTimes, Thinned
from .scanogram.scans import ScanRanges, ScansInMemory, Sweep
from .scanogram.strips import SpeedStrip, TouchStrip
from .widget.base_widget import NamedWidget
from .widget.front_end import bundle
from .widget.limit_traits import Pair
from .widget.png import Png, Saving
from .widget.time_traits import Marks, States, TimeSpan
from .widget.traits import Flag, bytes_trait


class ScannedRecording(Protocol):
    """A `Recording` with scans."""

    def scanogram(
        self, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
    ) -> ScanogramWidget:
        """Return all scans of a topic in one picture."""


class OpenFile(Protocol):
    """A file from which details of a picture are read."""

    def close(self) -> None:
        """Close it."""


class ScanogramWidget(NamedWidget):
    """Many scans as one picture: time across, ray angle up, colour for distance, speed and touch under it.

    The widget shows a column for each moment and a row for each ray, counter-clockwise angles above (REP-103), and near
    things dark. A wall that comes nearer is a band that darkens, a passing pedestrian is a streak. Rays that are too
    close, see nothing, have no measurement or lie outside the limits (REP-117) have colours of their own, with numbers
    in the legend. Times without scans have no colour. If several readings share a place, the nearest is shown.

    Pointing shows time, index, angle and distance; a click moves the time cursor; dragging selects a span of time, with
    shift of rays, too; the wheel zooms in time down to single scans. All this works without the kernel, but finer
    detail comes when it is free.

    Args:
        title: title in the header; usually the topic.
        time: the time cursor, in seconds from the start. The view writes it, too.
        selection: (start, end) in seconds from the start, end not included; with rays (start, end, first, stop), index
            stop not included; or None. The view writes it, too. ``recording[selection]`` has its samples.
        view: the span on show, (start, end) in seconds, or None for all. The view writes it, too.
        color_range: (near, far) in metres, the ends of the colors, or None to fit them to the readings of all scans
            without the nearest and the farthest hundredth.
        pixel: the reading to show if several scans or rays share a pixel: "nearest", to keep all near things, or
            "median", to see what was there most of the time. The view writes it, too.
        marks: marks above the scans, (start, end, text) in seconds from the start, or the result of `Recording.find`;
            keys n and p go from one to the next.
        states: rows of (start, end, path), the states of a program below the scans, outer machines first. A path looks
            like "Walker.avoid.turn". The states of a recording are shown by default.
        header, footer: False to hide them, for example to use the picture in a paper.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: sensor_msgs/LaserScan, REP-117.

    Examples:
        >>> scanogram = ScanogramWidget(title="/scan")
        >>> scanogram.update(
        ...     times_ns=[0, 100_000_000], ranges=[[1.0, 2.0], [1.1, 2.0]],
        ...     angle_min=-0.5, angle_increment=1.0, range_min=0.1, range_max=4.0,
        ... )
        >>> scanogram.selection = (0.0, 0.1)
    """

    _esm, _css = bundle("scanogram_widget")

    time = traitlets.Float(0.0, help="Seconds from the start. Python and the view write it.").tag(sync=True)
    selection = TimeSpan(rays=True, help="Seconds, and indices of rays. Python and the view write it.").tag(sync=True)
    view = TimeSpan(help="Seconds on show, or None for all. Python and the view write it.").tag(sync=True)
    color_range = traitlets.Tuple(
        traitlets.Float(),
        traitlets.Float(),
        default_value=None,
        allow_none=True,
        help="Metres at the ends of the colors; fitted by default.",
    ).tag(sync=True)
    pixel = traitlets.Enum(
        (NEAREST, MEDIAN), NEAREST, help="The reading to show if several share a pixel. The view writes it, too."
    ).tag(sync=True)
    marks = Marks(help="Marks above the scans: (start, end, text), in seconds from the start.").tag(sync=True)

    states = States(help="Rows of states below the scans, outer machines first: (start, end, path), in seconds.").tag(
        sync=True
    )

    footer = Flag(True, help="True to show the legend below the picture.").tag(sync=True)

    _frame = bytes_trait(echo_update=False)
    _about = traitlets.Dict().tag(sync=True, echo_update=False)
    _wanted = traitlets.List(traitlets.Float(), help="Start, end and columns of the part that the page shows.").tag(
        sync=True, echo_update=False
    )
    _detail = bytes_trait(echo_update=False)

    def __init__(self, **kwargs: Any) -> None:
        self._file: OpenFile | None = None
        self._picture: Picture | None = None
        self._edition = 0
        self._png_error = ""
        self._png = Png(self, self._set_png_error)
        super().__init__(**kwargs)

    @staticmethod
    def of(
        recording: ScannedRecording, topic: str | None = None, beside: Collection[str] | None = None, **options: Any
    ) -> ScanogramWidget:
        """Return the scanogram of a recording, with the speed and the touches of the same robot.

        It reads the file separately: the recording may be used, or closed. It is closed when its cell runs again.

        Args:
            recording: the recording with the scans.
            topic: name of the topic with the scans; by default the first one with scans.
            beside: names of the topics whose speed and touches may be shown; by default all except topics that share
                more of their namespace with other scans.
            **options: keywords of the widget.

        Raises:
            UnknownTopicError: it has no such topic, or the topic has no scans.
            RecordingError: the file does not exist any more, or contains no scan.
        """
        return recording.scanogram(topic, beside, **options)

    def update(
        self,
        *,
        times_ns: ArrayLike,
        ranges: ArrayLike,
        angle_min: float,
        angle_increment: float,
        range_min: float,
        range_max: float,
        start_ns: int | None = None,
    ) -> None:
        """Show scans, which replace earlier ones.

        Args:
            times_ns: times of N scans in nanoseconds, in the order of arrival.
            ranges: metres, shape (N, R), kept as float32; NaN and infinities as in REP-117.
            angle_min: angle of ray 0, radians or text like "-135deg".
            angle_increment: angle from one ray to the next, in the same form.
            range_min: metres; a range from range_min to range_max, both included, is a reading.
            range_max: metres.
            start_ns: the time of 0 s; by default the time of the first scan.

        Raises:
            TypeError: not numbers. ValueError: shapes that do not fit, no scan, or a geometry that `Scan` would refuse.
        """
        distances = _array("ranges", ranges, np.float32, 2)
        times = _array("times_ns", times_ns, np.int64, 1)
        if len(times) != len(distances):
            raise ValueError(f"times_ns: expected one for each of {len(distances)} scans, got {len(times)}")
        if not distances.size:
            raise ValueError(f"ranges: expected at least one scan of one ray, got shape {distances.shape}")
        scan = Scan(distances[0], angle_min, angle_increment, range_min, range_max)
        start = int(times[0]) if start_ns is None else start_ns
        odd = (*scan.header_problems, *of_ranges(distances.ravel(), scan.range_min, scan.range_max))
        self.show_scans(ScansInMemory(times, [distances]), Sweep.of(scan), start, notes=list(map(str, odd)))

    def _summary(self) -> str:
        picture = self._picture
        return f"{self.scans_shown}, {picture.duration:.1f} s" if picture else "nothing yet"

    @property
    def scans_shown(self) -> str:
        """The number of scans, and of how many if it shows only some of the drive."""
        picture = self._picture
        of = f" of {picture.thinned.of:,}" if picture and picture.thinned else ""
        return f"{len(picture.clock) if picture else 0:,}{of} scans"

    def set_speeds(
        self,
        *,
        times_ns: ArrayLike,
        values: ArrayLike,
        title: str = "",
        limits: dict[str, Pair] | None = None,
    ) -> None:
        """Show speeds under the scans.

        Args:
            times_ns: times of M speeds in nanoseconds, by the clock of the scans.
            values: shape (M, 6): linear x, y, z in m/s, angular x, y, z in rad/s; NaN without a value.
            title: the source of the speeds; usually the topic.
            limits: limits (min, max) by axis. A speed past its limits is marked.

        Raises:
            RuntimeError: there are no scans yet. TypeError: not numbers. ValueError: shapes do not fit.
        """
        picture = self._scans_first("set_speeds()")
        times, speeds = _array("times_ns", times_ns, np.int64, 1), _array("values", values, np.float64, 2)
        if speeds.shape != (len(times), len(AXES)) or not len(times):
            raise ValueError(f"values: expected the shape ({max(1, len(times))}, {len(AXES)}), got {speeds.shape}")
        strip = SpeedStrip(title, ScanTimes(times, picture.start_ns), speeds, limits or {})
        duration = max(picture.duration, float(strip.clock.starts[-1]))
        self._draw(replace(picture, speed=strip, duration=duration))

    def set_touches(self, spans: Iterable[tuple[float, float, str]], title: str = "") -> None:
        """Show spans of touches under the scans.

        Args:
            spans: (start, end, name of the sensor), in seconds from the start.
            title: the source of the touches; usually the topic.

        Raises:
            RuntimeError: there are no scans yet. ValueError: a span that ends before it starts.
        """
        picture = self._scans_first("set_touches()")
        listed = list(spans)
        for span in listed:
            if not _is_touch(span):
                raise ValueError(f"spans: expected (start, end, sensor) with start <= end, got {span!r}")
        listed.sort()
        sensors = sorted({name for _, _, name in listed})
        numbers = [(start, end, sensors.index(name)) for start, end, name in listed]
        strip = TouchStrip(title, sensors, np.array(numbers, np.float64).reshape(-1, 3))
        self._draw(replace(picture, touch=strip))

    def close(self) -> None:
        """Remove the widget from the page."""
        super().close()
        if self._file is not None:
            self._file.close()

    def show_scans(
        self,
        scans: ScanRanges,
        sweep: Sweep,
        start_ns: int,
        *,
        begin: float = 0.0,
        duration: float = 0.0,
        notes: Sequence[str] = (),
        budget: int = BUDGET,
        file: OpenFile | None = None,
        thinned: Thinned | None = None,
    ) -> None:
        """Show scans, in memory or in a file, which is closed with the widget.

        ``thinned`` has the facts about scans that are only some of the drive. They are not merged into coarser cells,
        which would cover times between them.
        """
        self._file = file
        clock = ScanTimes(scans.times_ns, start_ns, thinned)
        levels = Levels(scans, sweep, budget, len(scans.times_ns) if thinned else COARSEST)
        # The last scan lasts to the end of the recording, or for a while if it is the last message.
        end = duration if duration > clock.starts[-1] else float(clock.ends[-1])
        self._draw(Picture(levels, clock, start_ns, end, begin, thinned=thinned), (*notes, *clock.notes))

    @property
    def is_thinned(self) -> bool:
        """True if it shows only some scans of the drive, evenly spread over it."""
        return self._picture is not None and self._picture.thinned is not None

    def _draw(self, picture: Picture, notes: Sequence[str] | None = None) -> None:
        self._picture = picture
        with self.hold_sync():
            if notes is not None:
                self._about = {"notes": list(notes)}
            self._edition += 1
            self._frame = self._pack(picture)
            self._detail = b""
            # Cleared, so that the same request of the page is a change again.
            self._wanted = []

    def _set_png_error(self, error: str) -> None:
        if error != self._png_error:
            notes = [note for note in self._about.get("notes", ()) if note != self._png_error]
            self._png_error = error
            self._about = {**self._about, "notes": [*notes, error] if error else notes}

    def save_png(self, path: str | os.PathLike[str]) -> Saving:
        """Save the picture of the widget as a PNG file; the page that shows it draws the picture a moment later.

        To have the file within the cell, use ``await scanogram.save_png("drive.png")``. See `LaserWidget.save_png`.
        """
        return self._png.save(path)

    def _scans_first(self, call: str) -> Picture:
        if self._picture is None:
            raise RuntimeError(f"{call}: there are no scans yet; call update(...) first, which sets the time axis")
        return self._picture

    def frame_without_scans(self) -> bytes:
        """Return the overview without its cells, for a page that has the scans themselves."""
        picture = self._scans_first("frame_without_scans()")
        return pack(self._facts(picture), **picture.strips())

    def _pack(self, picture: Picture) -> bytes:
        """Return the overview."""
        return overview(picture.levels, picture.clock, self.pixel).pack(self._facts(picture), **picture.strips())

    def _facts(self, picture: Picture) -> dict[str, Any]:
        return {**picture.facts(), "edition": self._edition, "pixel": self.pixel}

    @traitlets.observe("pixel")
    def _on_pixel(self, _change: Any) -> None:
        if self._picture is not None:
            self._draw(self._picture)

    @traitlets.observe("_wanted")
    def _look_closer(self, change: Any) -> None:
        """Send the part that the page shows in its full detail."""
        picture = self._picture
        if picture is None or len(change["new"]) != 3:
            return
        start, end, columns = change["new"]
        try:
            cells = detail(picture.levels, picture.clock, start, end, int(columns), self.pixel)
        except Exception as error:  # any error of reading the file again: the coarse picture stays
            self._about = {**self._about, "error": f"no finer detail: {error}"}
            self._log_once(f"no finer detail: {error}")
            return
        self._detail = cells.pack({"edition": self._edition, "span": [start, end]}, **picture.speeds(start, end))

    @traitlets.validate("time")
    def _is_time(self, proposal: Any) -> float:
        seconds = float(proposal["value"])
        if not isfinite(seconds):
            raise traitlets.TraitError(f"time: expected seconds from the start, got {seconds!r}")
        return seconds

    @traitlets.validate("color_range")
    def _near_before_far(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is not None and not (0 <= value[0] < value[1] < np.inf):
            raise traitlets.TraitError(
                f"color_range: expected None or (near, far) in metres, 0 <= near < far; got {value!r}"
            )
        return value


def _is_touch(span: Any) -> bool:
    """Return True for (start, end, sensor)."""
    try:
        start, end, name = span
        return isinstance(name, str) and isfinite(start) and isfinite(end) and start <= end
    except (TypeError, ValueError):
        return False


def _array(name: str, values: ArrayLike, kind: type[Any], dimensions: int) -> NDArray[Any]:
    array = np.asarray(values)
    if array.dtype.kind not in ("iu" if kind is np.int64 else "iuf"):
        what = "whole numbers of nanoseconds" if kind is np.int64 else "numbers"
        raise TypeError(f"{name}: expected an array of {what}, got {array.dtype}")
    if array.ndim != dimensions:
        raise ValueError(f"{name}: expected an array of {dimensions} dimensions, got shape {array.shape}")
    return array.astype(kind)  # a copy, because the caller may change the array
