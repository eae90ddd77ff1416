"""Frames as Python packs them, for the tests of both halves; `docs/developers/frames.md` describes the layout.

`python -m tests.vectors` rewrites them in vectors.json. It also writes the readings in sectors, their code, the
spread of rays, and the times at which a source is silent. The rest of the file is written by hand: scans with their
classes, counts and indices, and speeds with their limits.
"""

from __future__ import annotations

import base64
import json
import tempfile
from math import inf, isfinite, nan, pi
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np

import robowidgets
from robowidgets import (
    CloudWidget,
    EventsWidget,
    ImageWidget,
    LaserWidget,
    MapGrid,
    MessageWidget,
    PathWidget,
    PlotWidget,
    Range,
    Scan,
    ScanogramWidget,
    Sector,
    SonarWidget,
    Speed,
    SpeedWidget,
    TouchWidget,
    spread,
)
from robowidgets.cloud_widget import FORMS, selection_code
from robowidgets.export.segments import pack_tracks
from robowidgets.image import as_numbers, statistics
from robowidgets.messages import to_image
from robowidgets.messages.image import layout_of
from robowidgets.samples import Mount, Pose, staleness
from robowidgets.samples.sector import SECTORS as SECTORS_BY_NAME
from robowidgets.samples.sector_code import for_array, for_message, for_scan
from robowidgets.samples.stretches import sector_of, stretches
from robowidgets.scanogram.by_angle import rays_at
from robowidgets.scanogram.scans import Sweep
from robowidgets.tracks import pack
from robowidgets.widget.robot_widget import RobotWidget
from robowidgets.widget.timed_frame import TimedFrame

from .unit.recordings import sweeps

FILE = Path(__file__).with_suffix(".json")
ARRIVED = 12.5
"""Seconds of the monotonic clock."""


MOUNTS = (None, Mount(1.5707963), Mount(-2.0, upside_down=True, by="hand"), Mount(upside_down=True))
"""The mounts of the scanners in the code examples."""


def read() -> dict[str, Any]:
    """The committed vectors: scans, limits and frames."""
    vectors: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
    return vectors


def make() -> dict[str, Any]:
    """By name, the bytes of a frame in base64, and the values that the front end reads from them."""
    clock = patch.multiple("time", monotonic=lambda: ARRIVED, monotonic_ns=lambda: round(ARRIVED * 1e9))
    with clock, patch.object(RobotWidget, "rate", 30.0):
        made = {
            "laser": _laser(),
            "echoes": _echoes(),
            "speed": _speed(),
            "touch": _touch(),
            "sonar": _sonar(),
            "cloud": _cloud(),
            "events": _events(),
            "message": _message(),
            "plot": _plot(),
            "map": _map(),
            **_scanogram(),
            "segment": _segment(),
        }
        made |= _packed_tracks()
    return {
        name: {"base64": base64.b64encode(raw).decode(), "reads": _in_words(reads)}
        for name, (raw, reads) in made.items()
    }


def to_scan(case: dict[str, Any]) -> Scan:
    """A scan of the file."""
    ranges = [float(v) for v in case.get("ranges", [case.get("fill", 0)] * case.get("count", 0))]
    for index, value in case.get("differ", {}).items():
        ranges[int(index)] = float(value)
    return Scan(
        ranges=ranges,
        angle_min=case["angle_min"],
        angle_increment=float(case["angle_increment"]),
        range_min=case["range_min"],
        range_max=case["range_max"],
        intensities=[float(v) for v in case.get("intensities", [])],
        stamp_ns=case.get("stamp_ns"),
    )


SECTORS = (
    Sector("-15deg", "15deg"),
    SECTORS_BY_NAME["back"],
    Sector("-180deg", "180deg"),
    Sector(0.1, 0.35),
    Sector("170.5deg", "-170.25deg"),
    Sector("2.5deg", "-2.5deg"),
    Sector(0.35, 0.1),
)


def make_sectors() -> dict[str, list[Any]]:
    """By the name of a scan: the readings in its sectors, and its rays' own sectors."""
    return {case["name"]: _in_words(_sectors_of(to_scan(case))) for case in read()["scans"]}


def _sectors_of(scan: Scan) -> list[Any]:
    held = []
    for sector in SECTORS:
        nearest, rays = scan.nearest(sector), scan.indices(sector)
        readings = scan.ranges[rays][scan.valid[rays]]
        found = [list(one) for one in stretches(scan, sector)]
        median = float(np.median(readings.astype(float))) if readings.size else nan
        distance = scan.distance(sector)
        held.append([found, distance, -1 if nearest is None else nearest.index, median, int(readings.size)])
    last = len(scan) - 1
    pairs = [(i, j) for i, j in ((0, 0), (last, last), (0, last), (last // 3, last // 2)) if last >= 0]
    own = [[*pair, sector_of(scan, *pair)] for pair in pairs]
    return [held, [[first, to, sector.start, sector.end] for first, to, sector in own]]


def make_codes() -> list[Any]:
    """Sectors with an offset and a mount, and their code: for a scan, for a message, for the array of a scan."""
    scan = to_scan(read()["scans"][0])
    cases = [(sector, offset, mount) for sector in SECTORS for offset in (0.0, 0.35) for mount in MOUNTS]
    return [
        [
            *(sector.start, sector.end, offset, {**mount.to_json(), "words": mount.words} if mount else None),
            *(for_scan(sector), for_message(sector, offset, mount), for_array(sector, scan)),
        ]
        for sector, offset, mount in cases
    ]


def make_rays() -> list[Any]:
    """The rays of two sweeps (angle of the first, step, number), and the first sweep's ray for each of the second."""
    circle, front = Sweep(0.0, 2 * pi / 460, 0.1, 30.0, 460), Sweep(-0.5, 0.1, 0.1, 30.0, 10)
    others = [Sweep(0.0, 2 * pi / count, 0.1, 30.0, count) for count in (455, 230)]
    turned = [Sweep(-pi, pi / 180, 0.1, 30.0, 360), Sweep(1.0, -pi / 180, 0.1, 30.0, 360)]
    short = [Sweep(-0.3, 0.1, 0.1, 30.0, 3), Sweep(0.2, 0.0, 0.1, 30.0, 1)]
    pairs = [(of, circle) for of in (circle, *others, *turned)] + [(of, front) for of in short]
    rays_of = [(one.angle_min, one.angle_increment, one.ray_count) for pair in pairs for one in pair]
    return [
        [list(of), list(on), rays_at(*pair).tolist()]
        for of, on, pair in zip(rays_of[::2], rays_of[1::2], pairs, strict=True)
    ]


BANDS = (
    {"z": (0.1, 0.5)},
    {"x": (0.0, 2.5), "y": (-1.0, 1.0), "z": (-0.25, 0.5)},
    {"x": (-2.0, 2.0), "y": (-1e-7, 1e16)},
    {"ring": (3.0, 7.0)},
    {"ring": (3.0, 7.0), "distance": (0.00001, 123456789.0625)},
    {"intensity": (0.30000000000000004, 12.5), "class": (1.0, 5.0)},
    {'a"]; __import__("os").system("id") #': (1.0, 5.0), "x": (0.0, 9.0)},
    {"points": (1.0, 5.0), "np": (0.0, 4.0), "self": (1.0, 9.0)},
    {"gr\u00f6\u00dfe": (1.0, 5.0), "a b\\\n\U0001f916": (2.0, 5.0)},
)
"""Bounds of points by field; some fields have names that need escaping in code."""


def make_selections() -> list[Any]:
    """Bounds of points, and the code that selects them by form; null where a form has no such fields."""
    made = []
    for bands in BANDS:
        forms = FORMS if {*bands} <= {*"xyz"} else FORMS[:2]
        codes = {form: selection_code(bands, form) if form in forms else None for form in FORMS}
        made.append([{name: list(band) for name, band in bands.items()}, codes])
    return made


SCATTERED = (
    [1.0, 2.0, 3.0, nan, inf],
    [1.25, nan, 3.0, 4.0, -inf],
    [1.5, 2.5, 0.0, nan, 20.0],
    [9.0, inf, 3.5, nan, nan],
    [1.125, 2.25, 3.0, nan, 0.0],
)
"""Ranges of scans whose limits are 0.1 m and 10 m."""


def make_spreads() -> list[list[Any]]:
    """The ranges of the first scans, two and more, and the spread of each ray over them."""
    scans = [Scan(ranges, 0.0, 0.1, 0.1, 10.0) for ranges in SCATTERED]
    counts = range(2, len(scans) + 1)
    return [_in_words([[*SCATTERED[:n]], spread(scans[:n]).tolist()]) for n in counts]


def make_silences() -> list[list[Any]]:
    """Usual steps in seconds, and the times without a sample after which a source is silent: on show, and in a list."""
    steps = (0.0, 0.025, 0.25, 0.5, 1.0, 2.0, 3.0, 5.0, inf)
    return [_in_words([step, staleness.LIVE.after(step), staleness.LISTED.after(step)]) for step in steps]


def make_steps() -> list[list[Any]]:
    """Times of samples, and their usual step, or infinity if it is unknown."""
    cases = (
        [],
        [5.0],
        [5.0, 5.0],
        [0.0, 1.0, 2.0, 100.0],
        [0.0, 0.0, 0.0, 3.0, 3.0, 3.0, 7.0],
        [0.0, 1.0, 3.0, 6.0, 7.0],
    )
    return [_in_words([times, staleness.usual_step(np.array(times)) or inf]) for times in cases]


def make_beats() -> dict[str, float]:
    """Rules whose numbers alone the page needs."""
    return {"beat": staleness.BEAT, "page": staleness.PAGE_SILENCE, "scan gap": staleness.SCAN_GAP.steps}


RANGED = (0.1, 0.0195, 0.0194, 0.09, 0.0, -1.0, 2.5, 5.0, 5.01, nan, inf, -inf)
"""Ranges of one sensor."""


def make_ranges() -> list[list[Any]]:
    """Ranges of sensors with limits, their class, and the distance that a program uses."""
    ranges = [Range(one, low, high) for one in RANGED for low, high in ((0.1, 5.0), (0.0, inf), (0.01, 2.5))]
    return _in_words([[r.range, r.min_range, r.max_range, int(r.validity), r.distance] for r in ranges])


ENCODINGS = (
    *("mono8", "rgb8", "bgr8", "rgba8", "bgra8", "8UC1", "8UC2", "8UC3", "8UC4", "8SC1", "8SC3", "mono16", "rgb16"),
    *("bgr16", "bgra16", "16UC1", "16UC3", "16SC1", "32SC1", "32FC1", "32FC3", "64FC1", "yuv422", "yuv422_yuy2"),
    "bayer_rggb8",
)
PIXEL, REGION = (0, 2), (0, 2, 1, 4)
"""The pixel and the region read from a picture of 2 rows and 4 columns."""


def make_images() -> list[Any]:
    """By encoding: a frame, its description, and the page's texts for a pixel and for a region without Python.

    Values and letters of the pixel, and the statistics, come from the message, or from the colors as shown.
    """
    return [_image(encoding) for encoding in ENCODINGS]


def _image(encoding: str) -> list[Any]:
    (dtype, channels), rows, columns = layout_of(encoding), 2, 4
    numbers = (np.arange(1.0, 1 + rows * columns * channels) * 37) % 251
    if dtype.kind == "f":
        numbers /= 256 if channels > 1 else 9
    elif dtype.itemsize > 1:
        numbers = numbers * 256 + 44 if dtype.itemsize == 2 else numbers * 2**23 + 1
    if dtype.kind == "i":
        numbers -= 2.0 ** (8 * dtype.itemsize - 1)
    data = numbers.astype(dtype)
    step = data.nbytes // rows
    message = {"height": rows, "width": columns, "encoding": encoding, "step": step, "data": data.view(np.uint8)}
    image = to_image(message)
    widget = ImageWidget()
    about, frame = widget.frame_of(image)
    widget.close()
    about = {name: about[name] for name in ("channels", "recolored") if name in about}
    is_rounded = encoding in ("32SC1", "64FC1")
    why = "as shown (8 bit)" if "recolored" in about else "rounded to float32" if is_rounded else ""
    shown = to_image(as_numbers(image)) if why and not is_rounded else image
    values = np.atleast_1d((image.depth if image.is_depth else shown.pixels)[PIXEL])
    values = values.astype(np.float32) if is_rounded else values
    letters = "".join(shown.channels) if values.size > 1 else ""
    is_mosaic = encoding.startswith("bayer")
    is_whole = shown.pixels.dtype.kind in "ui" and not (image.is_depth or is_rounded or is_mosaic)
    found = statistics(shown, REGION)["channels"] if is_whole else None
    why = f"nearest of every 2nd row and column\n{why}" if is_mosaic else why
    frame = np.array([1, 30, nan, ARRIVED]).astype("<f8").tobytes() + frame
    return [encoding, base64.b64encode(frame).decode(), about, letters, _in_words(values.tolist()), why, found]


def _laser() -> tuple[bytes, dict[str, Any]]:
    ranges, intensities = [1.0, inf, -inf, nan, 0.0], [1.0, 2.5, nan, 0.0, 9.0]
    laser = LaserWidget()
    laser.update(
        Scan(ranges, 0.5, -0.25, 0.125, 30.0, intensities=intensities, stamp_ns=1_700_000_000_000_000_001),
    )
    frame = laser.get_state()["_frame"]
    laser.close()
    geometry = {"angleMin": 0.5, "angleIncrement": -0.25, "minRange": 0.125, "maxRange": 30.0, "count": 5}
    head = {"sequence": 1, "rate": 30.0, "arrived": 12.5}
    return frame, head | geometry | {
        "ranges": ranges,
        "kinds": [0, 2, 1, 3, 4],
        "intensities": intensities,
        "sources": [],
    }


def _echoes() -> tuple[bytes, dict[str, Any]]:
    laser = LaserWidget(echo="last")
    rays = [{"echoes": [1.0, 2.5]}, {"echoes": []}, {"echoes": [4.0]}]
    laser.update(ranges=rays, angle_min=0.5, angle_increment=-0.25, range_min=0.125, range_max=30.0)
    frame = laser.get_state()["_frame"]
    laser.close()
    columns = {"ranges": [2.5, nan, 4.0], "kinds": [0, 3, 0], "intensities": [], "sources": [1, nan, 0]}
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5, "count": 3, **columns}


def _speed() -> tuple[bytes, dict[str, Any]]:
    measured, commanded = [0.5, -0.25, nan, inf, 0, -1.24], [0.6, 0, 0, 0, nan, -1.1]
    speed = SpeedWidget()
    speed.update(linear=(9, 9, 9), angular=(9, 9, 9))
    speed.reset_peaks()
    speed.update(Speed(measured[:3], measured[3:], 7))
    speed.command(Speed(commanded[:3], commanded[3:], 6, steering=-0.25))
    frame = speed.get_state()["_frame"]
    peaks = [list(speed.peaks[axis]) for axis in robowidgets.samples.AXES]
    speed.close()
    least, greatest = ([float(peak[i]) for peak in peaks] for i in (0, 1))
    head = {"sequence": 2, "rate": 30.0, "arrived": 12.5, "resets": 1}
    values = {"measured": [*measured, nan], "commanded": [*commanded, -0.25]}
    return frame, head | values | {"least": least, "greatest": greatest}


def _touch() -> tuple[bytes, dict[str, Any]]:
    touch = TouchWidget()
    touch.update({"größe": True, "right": None, "left": False})
    frame = touch.get_state()["_frame"]
    touch.close()
    sensors = [
        {"name": "größe", "state": "touched", "touches": 1, "seconds": 0},
        {"name": "right", "state": "unknown", "touches": 0, "seconds": None},
        {"name": "left", "state": "free", "touches": 0, "seconds": 0},
    ]
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5, "sensors": sensors}


def _plot() -> tuple[bytes, dict[str, Any]]:
    plot = PlotWidget()
    plot.set_line("a", [0.0, 0.25, 0.5, 3.0], [1.0, nan, 0.1, -2.0])
    plot.set_line("b", [4.5], [7.0])
    frame = plot.get_state()["_lines"]
    plot.close()
    a = {
        "total": 4,
        "times": [0.0, 0.25, 0.5, 1.75, 3.0],
        "values": [1.0, nan, 0.1, nan, -2.0],
        "counts": [1.0, 0.0, 1.0, -1.0, 1.0],
        "sums": [1.0, 0.0, 0.1, 0.0, -2.0],
    }
    b = {"total": 1, "times": [4.5], "values": [7.0], "counts": [1.0], "sums": [7.0]}
    return frame, {"edition": 2, "whole": [0.0, 4.5], "span": [0.0, 4.5], "columns": 1000, "lines": [a, b]}


def _sonar() -> tuple[bytes, dict[str, Any]]:
    sonar = SonarWidget(poses={"rear": pi})
    ranges = [
        Range(1.5, 0.125, 4.0, 0.5, "ultrasound", pose=Pose(0.5, -0.25, 1.5)),
        Range(inf),
        Range(nan, 0.125, 4.0),
        Range(0.0, 0.125, 4.0),
    ]
    sonar.update({f"front_{i + 8}": one for i, one in enumerate(ranges)})
    frame = sonar.get_state()["_frame"]
    sonar.close()
    rows = [
        *([1.5, 0, 0.0, 10.0, 0.125, 4.0, 0.5], [inf, 2, 0.0, 10.0, 0.0, inf, 0.0]),
        *([nan, 3, 0.0, 10.0, 0.125, 4.0, 0.0], [0.0, 4, 0.0, 10.0, 0.125, 4.0, 0.0]),
        [nan, 3, inf, 10.0, 0.0, inf, 0.0],
    ]
    keys = ("range", "kind", "behind", "silentAfter", "minRange", "maxRange", "fieldOfView")
    poses = [[0.5, -0.25, 1.5], None, None, None, None]
    sonars = [dict(zip(keys, row, strict=True), pose=pose) for row, pose in zip(rows, poses, strict=True)]
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5, "sonars": sonars}


def _cloud() -> tuple[bytes, dict[str, Any]]:
    """Rows of three points; every second row and column is left out; one field of a byte, and one of two numbers."""
    kind = [("x", ">f4"), ("y", "<f4"), ("z", "<f8"), ("ring", "<u1"), ("rgb", "<f4"), ("pair", "<i2", (2,))]
    points = np.zeros((2, 3), kind)
    points["x"], points["y"], points["z"] = [[3, 0, nan], [1, 1, 1]], 4.0, 0.0
    points["ring"], points["pair"] = [[7, 8, 9], [0, 0, 0]], [[[1, -2], [3, 4], [5, -6]]] * 2
    cloud = CloudWidget(most_points=2)
    cloud.update(points)
    frame = cloud.get_state()["_frame"]
    cloud.close()
    facts = {"total": 6, "rows": 2, "columns": 3, "unmeasured": 1, "step": 2, "count": 2}
    fields = {"ring": [7, 9], "pair": [1, -2, 5, -6], "distance": [5, nan]}
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5} | facts | {"x": [3, nan], "z": [0, 0]} | fields


def _map() -> tuple[bytes, dict[str, Any]]:
    path = PathWidget()
    point = {"position": {"x": 1.5, "y": -2.0}, "orientation": {"x": 0.0, "y": 0.0, "z": 1.0, "w": 0.0}}
    covariance = [0.25, 0.125, 0, 0, 0, 0, 0.125, 0.5, *[0] * 28]
    path.put("/amcl", {"header": {"frame_id": "map"}, "pose": {"pose": point, "covariance": covariance}}, time=0.5)
    path.put("/poses", {"header": {"frame_id": "map"}, "poses": [point, point]}, time=1.0)
    path.put(
        "/costmap", MapGrid(np.array([[0, 99, 255]], np.uint8), 0.5, Pose(1.0, 2.0, 0.0), frame_id="map"), time=2.0
    )
    frame = path.get_state()["_frame"]
    path.close()
    places = [{"x": 1.5, "y": -2.0, "yaw": float(np.float32(pi))}] * 2
    cells = {"rows": 1, "columns": 3, "size": 0.5, "step": 1, "data": [0, 99, 255]}
    unknown = [nan] * 3
    layers = [
        [0, 0.5, 1.5, -2.0, pi, [0.25, 0.125, 0.5], [], 0, 0, None],
        [1, 1.0, nan, nan, nan, unknown, places, 2, 0, None],
        [2, 2.0, 1.0, 2.0, 0.0, unknown, [], 0, 0, cells],
    ]
    keys = ("number", "time", "x", "y", "yaw", "scatter", "points", "total", "version", "cells")
    reads = {"sequence": 3, "rate": 30.0, "arrived": 12.5, "time": 2.0, "x": nan, "y": nan, "yaw": nan}
    return frame, {**reads, "layers": [dict(zip(keys, row, strict=True)) for row in layers]}


def _events() -> tuple[bytes, dict[str, Any]]:
    events = EventsWidget()
    events.add("started", time=0.5)
    events.add("stopped", time=1.25)
    frame = events.get_state()["_frame"]
    events.close()
    return frame, {"sequence": 2.0, "rate": 30.0, "arrived": ARRIVED, "seconds": 1.25, "stop": 2.0}


def _message() -> tuple[bytes, dict[str, Any]]:
    widget = MessageWidget()
    ids = np.array([-3, 2**60 + 1], np.int64)
    widget.update({"speed": 0.1, "nan": nan, "big": 2**60 + 1, "in": {"text": "\u00e9"}, "ids": ids, "on": True})
    frame = widget.get_state()["_frame"]
    widget.close()
    values = [0.1, "nan", str(2**60 + 1), ["\u00e9"], [2, -3, str(2**60 + 1), 0, 0, 0], True]
    return frame, {"sequence": 1, "rate": 30.0, "arrived": 12.5, "values": values, "ids": [-3, str(2**60 + 1)]}


def _scanogram() -> dict[str, tuple[bytes, dict[str, Any]]]:
    ranges = np.array([[1, 2, 3], [1.5, inf, nan], [2, 0.01, -inf]], np.float32)
    scanogram = ScanogramWidget()
    scanogram.update(
        times_ns=np.arange(3) * 500_000_000, ranges=ranges, angle_min=-0.5, angle_increment=0.5, range_min=0.125,
        range_max=8.0,
    )  # fmt: skip
    scanogram.set_touches([(0.25, 0.75, "left")], title="/bumper")
    scanogram._wanted = [0.0, 1.0, 100]
    state = scanogram.get_state()
    scanogram.close()
    sweep = {"angleMin": -0.5, "angleIncrement": 0.5, "minRange": 0.125, "maxRange": 8.0, "count": 3}
    whole = {
        "scanCount": 3, "pause": 0.5, "counts": [5, 1, 1, 1, 1], "sweep": sweep, "startsAt": [0.0, 0.5, 1.0],
        "spans": [{"start": 0.25, "end": 0.75, "name": "left"}],
    }  # fmt: skip
    detail = {"span": [0.0, 1.0], "ranges": ranges.ravel().tolist()}
    return {"scanogram": (state["_frame"], whole), "scanogram_detail": (state["_detail"], detail)}


def _segment() -> tuple[bytes, dict[str, Any]]:
    scans = [(0.0, sweeps.scan(sweeps.START_NS, [1.0, 2.0])), (0.5, sweeps.scan(sweeps.START_NS + 1, [1.5, inf]))]
    with (
        tempfile.TemporaryDirectory() as folder,
        robowidgets.open(sweeps.write(Path(folder) / "scans", scans)) as recording,
    ):
        player = recording.show()
        first = player.bar.get_state()["_first"][0]
        player.close()
    (track,), (abouts,) = first["tracks"], first["abouts"]
    assert len(abouts) == 1
    return track, {"times": [0.0, 0.0, 0.5], "abouts": [0, 0, 0], "ranges": [[1.0, 2.0], [1.0, 2.0], [1.5, inf]]}


def _packed_tracks() -> dict[str, tuple[bytes, dict[str, Any]]]:
    """Tracks as exported pages hold them, with the values that the page must read: the same bytes as a player gets."""
    laser, speed, touch = LaserWidget(), SpeedWidget(), TouchWidget()
    # In steps of a millimetre, with values that are not numbers: special values, a jump, another NaN, minus zero.
    odd = np.array([0x7FC00001, 0x80000000, 0x3F800001], np.uint32).view(np.float32)
    in_steps = [
        Scan(
            [*(i / 1000 for i in range(500, 530)), nan, inf, -inf, 0.0, 65.0, *odd[:n]],
            0,
            0.1,
            0,
            99,
            [7, 8] * 17 + [9] * (n + 1),
        )
        for n in (3, 2, 0)
    ]
    without_steps = [Scan(np.sqrt(np.arange(n, n + 40)), 0, 0.1, 0, 99) for n in (2, 3)]
    moved = [Speed((0.1 * n, 0, 0), (0, 0, nan)) for n in range(4)]
    touched = [{"left": n % 2 == 1} for n in range(3)]
    made = {}
    for name, widget, samples in (
        ("packed_scans", laser, in_steps),
        ("packed_scans_without_steps", laser, without_steps),
        ("packed_no_scan", laser, [Scan([], 0, 0, 0, 10), in_steps[0]]),
        ("packed_speeds", speed, moved),
        ("packed_touches", touch, touched),
    ):
        frames = []
        for i, sample in enumerate(samples):
            widget.update(sample)
            frames.append(TimedFrame(i / 8, {"notes": ["odd"] if i else []}, widget.get_state()["_frame"]))
        facts, parts = pack_tracks([(frames, widget.arrays_of)])
        _, track = pack(frames)
        made[name] = b"".join(parts), {"facts": facts, "track": base64.b64encode(track).decode()}
    for widget in (laser, speed, touch):
        widget.close()
    return made


def _in_words(value: Any) -> Any:
    """A value for JSON, which has no NaN and no infinity."""
    if isinstance(value, dict):
        return {key: _in_words(one) for key, one in value.items()}
    if isinstance(value, list):
        return [_in_words(one) for one in value]
    return str(value) if isinstance(value, float) and not isfinite(value) else value


def write() -> None:
    """Put the frames of this Python into the file."""
    vectors = read() | {"frames": make(), "sectors": make_sectors(), "codes": make_codes(), "spreads": make_spreads()}
    vectors |= {"rays": make_rays(), "silences": make_silences(), "steps": make_steps(), "beats": make_beats()}
    vectors |= {"ranges": make_ranges(), "images": make_images(), "selections": make_selections()}
    FILE.write_text(_to_text(vectors), encoding="utf-8")


def _to_text(vectors: dict[str, Any]) -> str:
    """JSON with a line for each case."""
    parts = []
    for name, cases in vectors.items():
        lines = (
            [f"{json.dumps(key)}: {json.dumps(case, ensure_ascii=False)}" for key, case in cases.items()]
            if isinstance(cases, dict)
            else [json.dumps(case, ensure_ascii=False) for case in cases]
        )
        opening, closing = "{}" if isinstance(cases, dict) else "[]"
        parts.append(f"  {json.dumps(name)}: {opening}\n    " + ",\n    ".join(lines) + f"\n  {closing}")
    return "{\n" + ",\n".join(parts) + "\n}\n"


if __name__ == "__main__":
    write()
