"""The view of a camera: pixels of points, depth images as scans, and overlays on a picture."""

from __future__ import annotations

from math import atan2, degrees, hypot, inf, nan, pi, radians, tan
from typing import Any

import numpy as np
import pytest

from robowidgets.camera import depth_rays, depth_scan
from robowidgets.camera._outline import Outlines
from robowidgets.camera.model import CameraModel
from robowidgets.camera.overlay import ScanOnPicture, cones
from robowidgets.camera.place import NoTransformError, ground_frame, place_in_camera, pose_by_hand
from robowidgets.messages.camera_info import to_camera_info
from robowidgets.poses.live_frames import LiveFrames
from robowidgets.poses.transforms import Transform
from robowidgets.samples import Range, Scan, Sector
from robowidgets.samples.camera_info import CameraInfo, PixelBox

K = [525.0, 0.0, 319.5, 0.0, 520.0, 239.5, 0.0, 0.0, 1.0]
PLUMB_BOB = [-0.28, 0.09, 0.0012, -0.0007, -0.011]
FISHEYE = [-0.013, 0.021, -0.018, 0.004]


def info(**changes: object) -> CameraInfo:
    given = {"width": 640, "height": 480, "k": K, "frame_id": "camera_optical_frame"} | changes
    return CameraInfo(**given)  # type: ignore[arg-type]


def one(model: CameraModel, *point: float) -> list[float]:
    return [float(value) for value in model.project([point])[0]]


# -- messages ----------------------------------------------------------------------------------------------------------


def message(**changes: object) -> dict[str, object]:
    roi = {"x_offset": 0, "y_offset": 0, "width": 0, "height": 0, "do_rectify": False}
    header = {"stamp": {"sec": 3, "nanosec": 5}, "frame_id": "/camera_optical_frame"}
    fields = {"header": header, "width": 640, "height": 480, "distortion_model": "plumb_bob", "d": PLUMB_BOB, "k": K}
    return {**fields, "r": [], "p": [], "binning_x": 0, "binning_y": 0, "roi": roi} | changes


def test_a_camera_info_of_ros_1_and_ros_2_says_the_same() -> None:
    new = to_camera_info(message())
    old = message()
    for name in "dkrp":
        old[name.upper()] = old.pop(name)
    old["header"] = {"stamp": {"secs": 3, "nsecs": 5}, "frame_id": "camera_optical_frame"}
    given = to_camera_info(old)
    for name in ("k", "d", "r", "p"):
        assert getattr(new, name).tolist() == getattr(given, name).tolist()
    assert (new.frame_id, new.stamp_ns, new.binning) == (given.frame_id, given.stamp_ns, given.binning)
    assert (new.frame_id, new.stamp_ns, new.binning) == ("camera_optical_frame", 3_000_000_005, (1, 1))


@pytest.mark.parametrize(
    ("given", "error"),
    [
        ({"ranges": []}, "sensor_msgs/CameraInfo, with width, height and k; got a dict with the keys ranges"),
        (message(k=K[:8]), "k: expected 9 numbers, got 8"),
        (message(d=[nan] * 5), "d: expected finite numbers"),
        (message(width=-1), "width: expected pixels, 0 or more, got -1"),
    ],
)
def test_what_is_not_a_calibration_says_what_is_wrong(given: dict[str, object], error: str) -> None:
    with pytest.raises((TypeError, ValueError), match=error):
        to_camera_info(given)


# -- projection --------------------------------------------------------------------------------------------------------


def test_a_rectified_picture_goes_by_p_with_the_shift_of_the_second_camera() -> None:
    p = [400.0, 0, 320, -48.0, 0, 400, 240, 0, 0, 0, 1, 0]
    model = CameraModel(info(p=p, d=PLUMB_BOB, distortion_model="plumb_bob"), rectified=True)
    # u = (400 * 0.5 + 320 * 2 - 48) / 2
    assert one(model, 0.5, -0.25, 2.0) == [396.0, 190.0]
    assert model.points([[396.0, 190.0]], 2.0)[0] == pytest.approx([0.5, -0.25, 2.0])


def test_a_point_behind_the_camera_or_outside_the_picture_has_no_pixel() -> None:
    model = CameraModel(info())
    points = np.array([[0, 0, -1], [0, 0, 0], [1.3, 0, 2], [-1.3, 0, 2], [0, 0.95, 2], [nan, 0, 1]])
    assert np.isnan(model.project(points)).all()
    # The first and the last pixel reach half a pixel around their middles.
    edge = model.points([[-0.49, 0], [639.49, 479.49]], 1.0)
    assert np.isfinite(model.project(edge)).all()


LENSES = {
    "plumb_bob": PLUMB_BOB,
    "rational_polynomial": [0.35, -0.08, 0.0007, 0.0002, 0.004, 0.68, -0.04, 0.01],
    "equidistant": FISHEYE,
}


def by_hand(name: str, d: list[float], x: float, y: float) -> tuple[float, float]:
    """The formulas of OpenCV's documentation, for one point."""
    r2 = x * x + y * y
    if name == "equidistant":
        theta = atan2(hypot(x, y), 1.0)
        bent = theta * (1 + d[0] * theta**2 + d[1] * theta**4 + d[2] * theta**6 + d[3] * theta**8)
        scale = bent / hypot(x, y)
        return x * scale, y * scale
    k1, k2, p1, p2, k3, k4, k5, k6 = [*d, 0.0, 0.0, 0.0][:8]
    radial = (1 + k1 * r2 + k2 * r2**2 + k3 * r2**3) / (1 + k4 * r2 + k5 * r2**2 + k6 * r2**3)
    return (
        x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
        y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
    )


@pytest.mark.parametrize("name", LENSES)
def test_a_raw_picture_is_bent_as_opencv_says_and_unbent_again(name: str) -> None:
    d = LENSES[name]
    model = CameraModel(info(d=d, distortion_model=name))
    for x, y in ((0.31, -0.22), (-0.4, 0.1), (0.0, 0.33), (0.5, 0.4)):
        bent_x, bent_y = by_hand(name, d, x, y)
        expected = [525 * bent_x + 319.5, 520 * bent_y + 239.5]
        assert one(model, 3 * x, 3 * y, 3.0) == pytest.approx(expected, abs=1e-9)
    columns, rows = np.meshgrid(np.linspace(0, 639, 17), np.linspace(0, 479, 13))
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    points = model.points(pixels, np.linspace(0.5, 9.0, len(pixels)))
    assert np.abs(model.project(points) - pixels).max() < 1e-3


def test_an_ideal_fisheye_bends_as_one_whose_numbers_are_nearly_0() -> None:
    ideal, near = (CameraModel(info(d=[d, 0, 0, 0], distortion_model="equidistant")) for d in (0.0, 1e-12))
    assert ideal.bends
    points = [[0.5, 0.0, 1.0], [-0.3, 0.4, 1.0], [0.0, 0.0, 1.0]]
    np.testing.assert_allclose(ideal.project(points), near.project(points), atol=1e-6)
    assert one(ideal, 0.5, 0.0, 1.0) == pytest.approx([525 * atan2(0.5, 1.0) + 319.5, 239.5])
    assert not CameraModel(info(d=[0.0] * 5, distortion_model="plumb_bob")).bends
    assert not CameraModel(info(d=[0.0] * 4, distortion_model="equidistant"), rectified=True).bends


def test_a_point_far_outside_the_picture_is_not_bent_back_into_it() -> None:
    # With k1 alone, x (1 + k1 x x) comes back to the middle at x = 1 / sqrt(-k1) = 1.83.
    model = CameraModel(info(d=[-0.3, 0, 0, 0, 0], distortion_model="plumb_bob"))
    points = [[x, 0.0, 1.0] for x in np.linspace(0.75, 3.0, 50)]
    assert np.isnan(model.project(points)).all()
    assert np.isnan(model.project(points[10:], beyond=True)).all()


def test_binning_and_a_part_of_the_sensor_move_the_pixels() -> None:
    part = CameraModel(info(binning=(2, 2), roi=PixelBox(100, 60, 400, 300)))
    assert part.size == (200, 150)
    u, v = 525 * 0.1 + 319.5, 520 * 0.1 + 239.5
    assert one(part, 0.1, 0.1, 1.0) == pytest.approx([(u - 100) / 2, (v - 60) / 2])


def test_a_picture_that_was_scaled_has_its_pixels_scaled_and_another_one_is_refused() -> None:
    half = CameraModel(info(), size=(320, 240))
    u, v = 525 * 0.1 + 319.5, 520 * 0.1 + 239.5
    assert one(half, 0.1, 0.1, 1.0) == pytest.approx([(u + 0.5) / 2 - 0.5, (v + 0.5) / 2 - 0.5])
    with pytest.raises(ValueError, match="for another picture: of 640 x 480 pixels, and this one has 640 x 360"):
        CameraModel(info(), size=(640, 360))


def test_a_camera_that_is_not_calibrated_and_an_unknown_lens_say_so() -> None:
    with pytest.raises(ValueError, match="not calibrated: k of its camera_info is all 0"):
        CameraModel(info(k=np.zeros(9)))
    with pytest.raises(ValueError, match="distortion_model 'thin_prism' with 12 numbers is not supported"):
        CameraModel(info(d=[0.1] * 12, distortion_model="thin_prism"))
    CameraModel(info(d=[0.1] * 12, distortion_model="thin_prism"), rectified=True)


# -- depth images ------------------------------------------------------------------------------------------------------


def by_node(depth: np.ndarray, first: int, last: int, low: float, high: float) -> tuple[list[float], float, float]:
    """The scan of depthimage_to_laserscan, computed in its own steps, pixel by pixel."""
    fx, cx, width = np.float32(K[0]), np.float32(K[2]), depth.shape[1]
    left, right = (np.array([(u - K[2]) / K[0], 0.0, 1.0]) for u in (0, width - 1))
    ahead = np.array([0.0, 0.0, 1.0])

    def between(a: np.ndarray, b: np.ndarray) -> float:
        return float(np.arccos(a @ b / (np.linalg.norm(a) * np.linalg.norm(b))))

    angle_max, angle_min = np.float32(between(left, ahead)), np.float32(-between(ahead, right))
    increment = np.float32((float(angle_max) - float(angle_min)) / (width - 1))
    constant_x = np.float32(1.0 / float(fx))
    ranges = [nan] * width
    for v in range(first, last):
        for u in range(width):
            value = float(depth[v, u])
            th = -atan2(float((np.float32(u) - cx) * constant_x), 1.0)
            index = int((th - float(angle_min)) / float(increment))
            r = value
            if np.isfinite(value):
                r = hypot(float(np.float32(u) - cx) * value * float(constant_x), value)
            old = ranges[index]
            if not np.isfinite(r) and not np.isfinite(old):
                use = not np.isnan(r)
            else:
                use = low <= r <= high and (not np.isfinite(old) or r < old)
            if use:
                ranges[index] = r
    return ranges, float(angle_min), float(increment)


def test_a_band_of_a_depth_image_is_the_scan_that_depthimage_to_laserscan_sends() -> None:
    rng = np.random.default_rng(3)
    depth = rng.uniform(0.3, 12.0, (480, 640)).astype(np.float32)
    depth[rng.random(depth.shape) < 0.3] = nan
    depth[rng.random(depth.shape) < 0.05] = inf
    depth[:, 200:220] = nan
    scan = depth_scan(depth, info(), 10)
    ranges, angle_min, increment = by_node(depth, 234, 244, 0.45, 10.0)
    assert (scan.angle_min, scan.angle_increment) == (angle_min, increment)
    assert np.allclose(scan.ranges, np.array(ranges, np.float32), rtol=1e-6, equal_nan=True)
    assert scan.frame_id == "camera_frame"
    assert np.isnan(scan.ranges).any()
    assert np.isinf(depth_scan(np.full((480, 640), inf), info()).ranges).any()


@pytest.mark.parametrize(
    ("axis", "rows", "first"),
    [(240.0, 1, 240), (239.5, 1, 239), (243.2, 1, 243), (243.2, 3, 242), (243.7, 3, 242), (243.2, 10, 238)],
)
def test_an_odd_number_of_rows_are_the_rows_that_the_node_reads(axis: float, rows: int, first: int) -> None:
    depth = np.repeat(np.arange(480, dtype=np.float32)[:, None] * 0.01 + 1, 640, axis=1)  # each row has one distance
    calibration = CameraInfo(640, 480, k=[525, 0, 319.5, 0, 525, axis, 0, 0, 1], frame_id="c")
    assert np.nanmin(depth_scan(depth, calibration, rows).ranges) == pytest.approx(depth[first, 0], abs=1e-5)


def test_a_wall_in_a_depth_image_is_a_wall_in_the_scan_and_its_columns_are_known() -> None:
    millimetres = np.full((480, 640), 2000, np.uint16)
    millimetres[:, 400:] = 0
    scan = depth_scan(millimetres, info(), (230, 240))
    # A column is on a ray up to half a step to its side.
    assert np.allclose(scan.x[scan.valid], 2.0, atol=0.003)
    # The right side of the picture is at the right of the scanner, where the scan begins.
    rays = depth_rays(CameraModel(info(), rectified=True))
    assert np.isnan(scan.ranges[rays[401:]]).all()
    assert np.isfinite(scan.ranges[rays[:400]]).all()
    assert scan.angles[rays[0]] == pytest.approx(atan2(319.5, 525), abs=0.002)


def test_a_message_with_a_depth_image_is_a_scan_of_its_time() -> None:
    millimetres = np.full((480, 640), 1500, np.uint16)
    header = {"stamp": {"sec": 7, "nanosec": 0}, "frame_id": "depth_optical_frame"}
    fields = {"height": 480, "width": 640, "encoding": "16UC1", "step": 1280, "is_bigendian": 0}
    scan = depth_scan({"header": header, **fields, "data": millimetres.tobytes()}, info())
    assert (scan.stamp_ns, scan.distance()) == (7_000_000_000, pytest.approx(1.5))
    np.testing.assert_allclose(scan.ranges, depth_scan(millimetres, info()).ranges, rtol=1e-6)


def test_nothing_in_range_is_the_same_in_a_message_as_in_an_array() -> None:
    metres = np.full((480, 640), inf, np.float32)
    metres[:, :100] = nan
    metres[:, 600:] = 3.0
    fields = {"height": 480, "width": 640, "encoding": "32FC1", "step": 2560, "is_bigendian": 0}
    scan = depth_scan({"header": {"frame_id": "c"}, **fields, "data": metres.tobytes()}, info())
    np.testing.assert_array_equal(scan.ranges, depth_scan(metres, info()).ranges)
    assert np.isposinf(scan.at(0.0).range)  # type: ignore[union-attr]
    assert scan.distance("front") == scan[int(np.nanargmin(scan.ranges))].range < inf


@pytest.mark.parametrize("kind", [np.uint16, np.float32])
def test_a_depth_of_zero_is_no_reading_even_without_a_least_range(kind: type) -> None:
    depth = np.zeros((480, 640), kind)
    scan = depth_scan(depth, info(), range_min=0.0)
    assert np.isnan(scan.ranges).all()


@pytest.mark.parametrize(
    ("depth", "rows", "error"),
    [
        (np.zeros((4, 4, 3)), 1, r"expected an image of shape \(H, W\), got shape \(4, 4, 3\)"),
        (np.zeros((480, 640), complex), 1, "depth: expected metres as floats, or millimetres as whole numbers"),
        (np.zeros((480, 640)), (470, 490), "rows: expected rows of an image of 480, got 470 to 490"),
        (np.zeros((100, 640)), 1, "for another picture"),
    ],
)
def test_what_is_not_a_depth_image_says_what_is_wrong(depth: np.ndarray, rows: object, error: str) -> None:
    with pytest.raises((TypeError, ValueError), match=error):
        depth_scan(depth, info(), rows)  # type: ignore[arg-type]


# -- poses -------------------------------------------------------------------------------------------------------------

OPTICAL = (-0.5, 0.5, -0.5, 0.5)


def frames(*more: Transform) -> LiveFrames:
    found = LiveFrames()
    for parent, child, pose in (
        ("base_footprint", "base_link", (0, 0, 0.1, 0, 0, 0, 1)),
        ("base_link", "laser", (0.1, 0, 0.1, 0, 0, 0, 1)),
        ("base_link", "camera_link", (0.2, 0, 0.4, 0, 0, 0, 1)),
        ("camera_link", "camera_optical_frame", (0, 0, 0, *OPTICAL)),
    ):
        found.add(Transform(parent, child, 0, 0, pose, static=True))  # type: ignore[arg-type]
    for one_more in more:
        found.add(one_more)
    return found


def test_the_scanner_is_placed_by_tf_or_by_the_user() -> None:
    by_tf = place_in_camera(frames(), "laser", "camera_optical_frame", when=(0, 0), then=(0, 0))
    # 1 m ahead of the scanner, 0.5 m to its left: to the left of the camera, and below it.
    assert by_tf.moved(np.array([[1.0, 0.5, 0.0]]))[0] == pytest.approx([-0.5, 0.3, 0.9])
    by_a_person = pose_by_hand((0.1, 0, 0.3, 0, 0, 0))
    assert by_a_person.moved(np.array([[1.0, 0.5, 0.0]]))[0] == pytest.approx([-0.5, 0.3, 0.9])
    down = pose_by_hand((0, 0, 1.0, 0, "45deg", 0))
    assert down.moved(np.array([[1.0, 0.0, 0.0]]))[0] == pytest.approx([0, 0, 2**0.5])
    assert ground_frame(frames(), "laser") == "base_footprint"
    with pytest.raises(TypeError, match=r"camera_pose: expected x, y, z, roll, pitch and yaw, got 1\.0"):
        pose_by_hand(1.0)  # type: ignore[arg-type]


def test_without_a_transform_it_says_between_which_frames() -> None:
    with pytest.raises(NoTransformError, match=r"^no tf from scanner to camera_optical_frame$"):
        place_in_camera(frames(), "scanner", "camera_optical_frame", when=(0, 0), then=(0, 0))
    with pytest.raises(NoTransformError, match="no tf for a sensor without a frame_id"):
        place_in_camera(frames(), "", "camera_optical_frame", when=(0, 0), then=(0, 0))


def test_a_scan_is_where_it_was_measured_while_the_robot_drives_on() -> None:
    second = 1_000_000_000
    drive = [
        Transform("odom", "base_footprint", t * second, t * second, (0.5 * t, 0, 0, 0, 0, 0, 1)) for t in range(1, 4)
    ]
    at = place_in_camera(
        frames(*drive), "laser", "camera_optical_frame", when=(second, second), then=(3 * second, 3 * second)
    )
    # In two seconds the robot drove 1 m.
    assert at.moved(np.array([[2.0, 0.0, 0.0]]))[0] == pytest.approx([0.0, 0.3, 0.9])


# -- over the picture --------------------------------------------------------------------------------------------------


def room_scan(distance: float = 2.0, count: int = 181) -> Scan:
    """A wall across, at this distance ahead."""
    angles = np.linspace(radians(-60), radians(60), count)
    return Scan(
        (distance / np.cos(angles)).astype(np.float32), angles[0], angles[1] - angles[0], 0.1, 30.0, frame_id="laser"
    )


def on_picture(scan: Scan, **camera: object) -> ScanOnPicture:
    found = frames()
    at = place_in_camera(found, "laser", "camera_optical_frame", when=(0, 0), then=(0, 0))
    ground = place_in_camera(found, "base_footprint", "camera_optical_frame", when=(0, 0), then=(0, 0))
    return ScanOnPicture(CameraModel(info(**camera)), at, scan, ground)


def test_readings_fall_on_the_wall_that_they_measure() -> None:
    scan = room_scan()
    pixels = on_picture(scan).pixels()
    seen = np.isfinite(pixels).all(axis=1)
    # The wall is 1.9 m ahead of the camera, which looks 31 degrees to each side from behind it.
    assert np.allclose(pixels[seen, 1], 520 * 0.3 / 1.9 + 239.5, atol=1e-3)
    assert np.allclose(pixels[seen, 0], 319.5 - 525 * scan.y[seen] / 1.9, atol=1e-3)
    assert seen.sum() == (np.abs(319.5 - 525 * scan.y / 1.9 - 319.5) < 320).sum()


def inside(polygon: np.ndarray, x: float, y: float) -> bool:
    after = np.roll(polygon, -1, axis=0)
    (x1, y1), (x2, y2) = polygon.T, after.T
    with np.errstate(all="ignore"):
        crosses = ((y1 > y) != (y2 > y)) & (x < x1 + (y - y1) * (x2 - x1) / (y2 - y1))
    return bool(crosses.sum() % 2)


@pytest.mark.parametrize("lens", [{}, {"d": PLUMB_BOB, "distortion_model": "plumb_bob"}])
def test_the_area_lies_on_the_ground_and_ends_at_the_readings(lens: dict[str, object]) -> None:
    scan = room_scan()
    (area,) = on_picture(scan, **lens).area().pieces
    model = CameraModel(info(**lens))
    # The ground is 0.5 m below the camera; the wall stands 1.9 m ahead.
    columns, rows = np.meshgrid(np.linspace(0, 639, 31), np.linspace(0, 479, 31))
    pixels = np.column_stack([columns.ravel(), rows.ravel()])
    for (u, v), (x, down, _) in zip(pixels, model.rays(pixels), strict=True):
        if down <= 0.02:
            assert not inside(area, u, v)
            continue
        ahead, aside = 0.5 / down, 0.5 * x / down
        distance, angle = hypot(ahead + 0.1, aside), abs(atan2(aside, ahead + 0.1))
        if min(abs(ahead - 1.9), abs(angle - radians(60)), abs(distance - 0.1)) > 0.02:
            assert inside(area, u, v) == (ahead < 1.9 and angle < radians(60) and distance > 0.1), (u, v)


def test_rays_that_see_nothing_reach_the_scanners_range_and_unknown_ones_nowhere() -> None:
    scan = room_scan()
    ranges = scan.ranges.copy()
    ranges[:90], ranges[90:] = nan, inf
    (area,) = on_picture(Scan(ranges, scan.angle_min, scan.angle_increment, 0.1, 30.0)).area().pieces
    # Far ahead to the left it sees all of the ground, to the right none.
    assert inside(area, 200, 265)
    assert not inside(area, 440, 265)


def test_a_line_that_leaves_the_picture_and_comes_back_is_in_two_pieces() -> None:
    outlines = Outlines(CameraModel(info()))
    places = np.array([[-0.2, 0, 1], [0, -3, 1], [0.2, 0, 1], [0.2, 0, -1]], float)
    first, second = outlines.line(places)
    assert first[0] == pytest.approx([319.5 - 105, 239.5])
    assert second[1] == pytest.approx([319.5 + 105, 239.5])
    assert outlines.line(np.array([[0, 0, -1.0], [1, 1, -2.0]])) == []


def test_sectors_and_what_a_program_draws_lie_in_the_picture_with_their_names() -> None:
    drawn = on_picture(room_scan())
    (front,) = drawn.sectors({"front": Sector("-10deg", "10deg", near=1.5)})
    assert front.name == "front"
    assert front.pieces[0][:, 1].min() > 239.5
    forms: list[dict[str, Any]] = [
        {"name": "wall", "kind": "line", "at": [90, [1.0, 0.0]], "color": "green"},
        {"name": "gone", "kind": "points", "at": [5000]},
        {"name": "door", "kind": "text", "at": [[2.0, 0.0]], "text": "here"},
        {"name": "zone", "kind": "arc", "at": [[0.0, 0.0]], "radius": 1.0, "start": -0.5, "end": 0.5},
        {"name": "goal", "kind": "arrow", "at": [[1.5, 0.2]], "yaw": 0.3},
        {"name": "box", "kind": "polygon", "at": [[1.0, 0.1], [1.5, 0.1], [1.5, 0.3]]},
    ]
    found = {one.name: one for one in drawn.shapes(forms)}
    assert list(found) == ["wall", "door", "zone", "goal", "box"]
    assert found["wall"].color == "green"
    assert found["wall"].pieces[0][0] == pytest.approx([319.5, 520 * 0.3 / 1.9 + 239.5], abs=0.1)
    assert found["door"].words == "here"
    assert all(len(one.pieces[0]) for one in found.values())


def test_cones_end_where_something_is_or_say_that_there_is_nothing() -> None:
    at = place_in_camera(frames(), "laser", "camera_optical_frame", when=(0, 0), then=(0, 0))
    ranges = {
        "front": (Range(1.5, 0.1, 4.0, field_of_view=0.4), at),
        "far": (Range(inf, 0.1, 4.0), at),
        "dead": (Range(nan, 0.1, 4.0), at),
        "near": (Range(-inf, 1.0, 4.0), at),
        "nearer": (Range(0.2, 1.0, 4.0), at),
    }
    drawn = cones(CameraModel(info()), ranges, radians(15))
    assert [(one.kind, one.name, one.words, one.dashed) for one in drawn] == [
        ("cone", "front", "1.50 m", False),
        ("arc", "front", "", False),
        ("cone", "far", "nothing", True),
        ("cone", "near", "too close", False),
        ("arc", "near", "", False),
        ("cone", "nearer", "too close", False),
        ("arc", "nearer", "", False),
    ]
    # The arc is as wide as the beam, 1.5 m from the sensor.
    (arc,) = drawn[1].pieces
    half = 525 * 1.5 * np.sin(0.2) / (1.5 * np.cos(0.2) - 0.1)
    assert np.ptp(arc[:, 0]) == pytest.approx(2 * half, rel=1e-3)


def test_the_opening_of_a_camera_is_given_in_radians() -> None:
    across, down = CameraModel(info()).view
    assert degrees(across) == pytest.approx(2 * degrees(atan2(320, 525)))
    assert tan(down / 2) == pytest.approx(240 / 520)
    assert 0 < down < across < pi
