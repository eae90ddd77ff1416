"""Clouds of points: messages and arrays to samples, their properties, and a band of heights as a scan."""

from __future__ import annotations

import base64
import copy
import pickle
from array import array
from math import inf, nan, pi
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import robowidgets
from robowidgets.messages import to_cloud, to_scan
from robowidgets.samples.cloud import MAX_POINTS

from ..forms import FORMS
from ..recordings.recorded import stamped

CODES = {"i1": 1, "u1": 2, "i2": 3, "u2": 4, "i4": 5, "u4": 6, "f4": 7, "f8": 8}
FULL = [(name, "f4") for name in ("x", "y", "z", "intensity")] + [("ring", "u2"), ("time", "f8"), ("near", "i1")]


def cloud_message(points: np.ndarray, rows: int = 1, padding: int = 0, after: int = 0, **changed: Any) -> dict:
    """The fields of a PointCloud2 with these points, and unused bytes after each point and each row."""
    kind = points.dtype
    is_big = any(kind[name].base.byteorder == ">" for name in kind.names)
    step = kind.itemsize + padding
    wide = np.dtype({"names": kind.names, "formats": [kind[n] for n in kind.names],
                     "offsets": [kind.fields[n][1] for n in kind.names], "itemsize": step})  # fmt: skip
    packed = np.zeros(points.size, wide)
    for name in kind.names:
        packed[name] = points[name]
    each = [row.tobytes() + b"\xff" * after for row in packed.reshape(rows, -1)]
    fields = [
        {
            "name": name,
            "offset": kind.fields[name][1],
            "datatype": CODES[kind[name].base.str[1:]],
            "count": int(np.prod(kind[name].shape)),
        }
        for name in kind.names
    ]
    return {
        "header": stamped(5_000_000_000, "velodyne"),
        "height": rows,
        "width": points.size // rows,
        "fields": fields,
        "is_bigendian": is_big,
        "point_step": step,
        "row_step": len(each[0]) if each else 0,
        "data": np.frombuffer(b"".join(each), np.uint8),
        "is_dense": False,
        **changed,
    }


def points_of(count: int, kind: Any = FULL, order: str = "<") -> np.ndarray:
    """Points with other numbers in each field."""
    points = np.zeros(count, np.dtype(kind).newbyteorder(order))
    for i, name in enumerate(points.dtype.names):
        points[name] = np.arange(count).reshape(-1, *[1] * (points[name].ndim - 1)) % 100 + i
    return points


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize(("rows", "padding", "after"), [(1, 0, 0), (4, 0, 0), (1, 5, 3), (4, 5, 7)])
def test_any_layout_gives_every_field_as_it_was_sent(order: str, rows: int, padding: int, after: int) -> None:
    sent = points_of(12, order=order)
    cloud = to_cloud(cloud_message(sent, rows, padding, after))
    for name in sent.dtype.names:
        assert cloud.points[name].tolist() == sent[name].tolist(), name
    assert (len(cloud), cloud.rows, cloud.columns, cloud.fields) == (12, rows, 12 // rows, sent.dtype.names)
    assert (cloud.frame_id, cloud.stamp_ns, cloud.problems) == ("velodyne", 5_000_000_000, ())
    point = cloud[7]
    assert (point.index, point.x, point.fields["ring"], point.fields["time"]) == (7, 7.0, 11, 12.0)
    assert (point.row, point.column) == (divmod(7, 3) if rows > 1 else (None, None))
    assert point.distance == pytest.approx(np.sqrt(7**2 + 8**2 + 9**2))


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
def test_a_message_of_every_source_is_a_cloud(form) -> None:
    fields = cloud_message(points_of(3), data=cloud_message(points_of(3))["data"].tobytes())
    assert to_cloud(form("sensor_msgs/PointCloud2", fields)).points["intensity"].tolist() == [3.0, 4.0, 5.0]


@pytest.mark.parametrize(
    "make", [bytes, bytearray, list, tuple, lambda raw: array("B", raw), lambda raw: base64.b64encode(raw).decode()]
)
def test_bytes_come_in_every_container(make) -> None:
    message = cloud_message(points_of(3))
    assert to_cloud({**message, "data": make(message["data"].tobytes())}).x.tolist() == [0.0, 1.0, 2.0]


def test_what_cannot_change_is_not_copied_and_what_can_change_is() -> None:
    message = cloud_message(points_of(3))
    raw = message["data"].tobytes()
    assert np.shares_memory(
        to_cloud({**message, "data": np.frombuffer(raw, np.uint8)}).points, np.frombuffer(raw, np.uint8)
    )
    reused = bytearray(raw)
    cloud = to_cloud({**message, "data": np.frombuffer(reused, np.uint8)})
    reused[:] = bytes(len(reused))
    assert cloud.x.tolist() == [0.0, 1.0, 2.0]
    with pytest.raises(ValueError, match="read-only"):
        cloud.points["x"][0] = 5


def test_fields_of_several_numbers_are_kept() -> None:
    kind = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("normal", "f4", (3,))]
    cloud = to_cloud(cloud_message(points_of(4, kind)))
    assert cloud.points["normal"].shape == (4, 3)
    assert cloud[2].fields["normal"] == (5.0, 5.0, 5.0)


def test_the_older_type_has_its_channels_as_fields() -> None:
    message = {
        "header": stamped(1, "laser"),
        "points": [{"x": 1.0, "y": 2.0, "z": None}, {"x": 3.0, "y": 4.0, "z": 0.5}],
        "channels": [{"name": "intensity", "values": [7.0, 8.0]}, {"name": "short", "values": [1.0]}],
    }
    cloud = to_cloud(message)
    assert cloud.points["intensity"].tolist() == [7.0, 8.0]
    assert (cloud.valid.tolist(), len(cloud.fields)) == ([False, True], 4)
    assert cloud.problems[0].what == "channel 'short' has 1 values for 2 points: not used"


@pytest.mark.parametrize(
    ("given", "rows"),
    [
        ([[1, 2, 3], [4, 5, 6]], 1),
        (np.float32([[1, 2, 3], [4, 5, 6]]), 1),
        (np.asfortranarray([[1.0, 2, 3], [4, 5, 6]]), 1),
        (np.ma.masked_equal([[1.0, 2, 3], [4, 5, 6], [9, 9, 9]], 9)[:2], 1),
        (np.float64([[[1, 2, 3]], [[4, 5, 6]]]), 2),
    ],
)
def test_an_array_is_a_cloud(given, rows) -> None:
    cloud = to_cloud(given)
    assert np.column_stack([cloud.x, cloud.y, cloud.z]).tolist() == [[1, 2, 3], [4, 5, 6]]
    assert cloud.rows == rows
    assert to_cloud(cloud) is cloud


def test_a_structured_array_is_a_cloud_with_its_fields() -> None:
    assert to_cloud(points_of(6)).fields == tuple(name for name, _ in FULL)
    assert to_cloud(points_of(6).reshape(2, 3)).rows == 2


def test_nothing_is_a_cloud_without_points() -> None:
    for cloud in (to_cloud([]), to_cloud(np.empty((0, 3))), to_cloud(cloud_message(points_of(0)))):
        assert (len(cloud), cloud.nearest(), len(cloud.scan())) == (0, None, 720)


OVER = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("rgb", "f4")]


def field(name: str, offset: int, datatype: int = 7, count: int = 1) -> dict:
    return {"name": name, "offset": offset, "datatype": datatype, "count": count}


XYZ = [field("x", 0), field("y", 4), field("z", 8)]


def test_a_row_step_of_all_rows_counts_as_the_step_of_one() -> None:
    message = cloud_message(points_of(6, OVER))
    of_rows = to_cloud({**message, "height": 2, "width": 3, "row_step": 3 * message["point_step"]})
    of_all = to_cloud({**message, "height": 2, "width": 3, "row_step": 6 * message["point_step"]})
    assert of_all.points.tobytes() == of_rows.points.tobytes()
    assert of_all.problems == ()


@pytest.mark.parametrize(
    ("changed", "what"),
    [
        ({"fields": [*XYZ, field("rgb", 12), field("rgba", 12, 6)]}, "the fields rgb and rgba share bytes"),
        ({"fields": [*XYZ, field("x", 12)]}, "field 'x' comes twice"),
        ({"fields": [*XYZ, field("", 12)]}, "a field has no name"),
        ({"height": 2, "width": 2, "row_step": 5}, "row_step is 5 for rows of 2 points of 16 bytes: not used"),
        ({"width": 3}, "16 bytes after the last point: not used"),
    ],
)
def test_what_is_odd_is_reported_and_the_points_are_read(changed: dict, what: str) -> None:
    cloud = to_cloud({**cloud_message(points_of(4, OVER)), "row_step": 48, **changed})
    assert [problem.what for problem in cloud.problems] == [what]
    assert cloud.z.tolist()[:3] == [2.0, 3.0, 4.0]


@pytest.mark.parametrize(
    ("changed", "text"),
    [
        ({"fields": XYZ[:2]}, r"expected points with x, y and z; got the fields x, y \(missing: z\)"),
        ({"fields": []}, "fields: expected at least x, y and z, got none"),
        ({"fields": [*XYZ, field("ring", 14)]}, "field 'ring': it ends at byte 18 of a point, but point_step is 16"),
        ({"fields": [*XYZ, field("ring", 12, 9)]}, "field 'ring': expected a datatype from 1 to 8, got 9"),
        ({"fields": [field("x", 0, count=2), *XYZ[1:]]}, "x: expected one number for each point"),
        ({"width": 5, "row_step": 80}, "data: expected 80 bytes for 1 x 5 points of 16 bytes, got 64"),
        ({"width": -1}, "width: expected a whole number, 0 or more, got -1.0"),
        ({"data": "%"}, "data: expected bytes, or text in base64"),
        ({"data": None}, "data: expected bytes, got"),
        ({"fields": "x"}, "fields: expected a list of sensor_msgs/PointField"),
        ({"width": 10_000_000}, "expected at most 5,000,000 points, got 10,000,000; take every n-th, or a filter"),
    ],
)
def test_what_are_not_points_is_refused_with_one_line(changed: dict, text: str) -> None:
    with pytest.raises((TypeError, ValueError), match=text):
        to_cloud({**cloud_message(points_of(4, OVER)), **changed})


@pytest.mark.parametrize(
    ("given", "text"),
    [
        ([[1, 2], [3, 4]], r"points: expected numbers of shape \(N, 3\), or \(H, W, 3\), got shape \(2, 2\)"),
        ([[1, 2, 3], [4, 5]], "rows of different lengths"),
        ([["a", "b", "c"]], r"points: expected numbers of shape \(N, 3\), got <U1"),
        (
            np.zeros((MAX_POINTS + 1, 3), np.float32),
            "expected at most 5,000,000 points, got 5,000,001; take every n-th",
        ),
        ({"packets": [], "header": {}}, "packets of a scanner are not decoded"),
        ({"ranges": [1.0]}, "expected a message like sensor_msgs/PointCloud2 or PointCloud"),
        ({"fields": [], "point_step": 1, "data": b""}, r"\(missing: height, width, is_bigendian, row_step\)"),
    ],
)
def test_what_is_not_a_cloud_is_refused_with_what_came(given: Any, text: str) -> None:
    with pytest.raises((TypeError, ValueError), match=text):
        to_cloud(given)


def test_points_without_numbers_are_kept_in_their_place_and_are_never_nearest() -> None:
    cloud = to_cloud([[nan, nan, nan], [2.0, 0.0, 0.0], [inf, 0.0, 0.0], [1.0, 0.0, nan]])
    assert cloud.valid.tolist() == [False, True, False, False]
    assert cloud.nearest().index == 1
    assert cloud.inside(x=(-inf, inf)).tolist() == [False, True, False, False]


def test_parts_are_chosen_by_any_field_with_bounds_that_belong_to_them() -> None:
    cloud = to_cloud(points_of(5))
    assert cloud.inside(x=(1, 3), ring=(6, 99)).tolist() == [False, False, True, True, False]
    assert cloud.inside(distance=(0, 3)).tolist() == [True, False, False, False, False]
    for bands, text in [
        ({"reflectivity": (0, 1)}, "reflectivity: this cloud has the fields x, y, z, intensity"),
        ({"z": (1, 0)}, "z: expected the lower bound first, got 1 and 0"),
        ({"z": 5}, "z: expected a lower and an upper bound, got 5"),
    ]:
        with pytest.raises(ValueError, match=text):
            cloud.inside(**bands)


def test_a_cloud_survives_copies_and_pickles() -> None:
    cloud = to_cloud(cloud_message(points_of(6), rows=2))
    for other in (copy.deepcopy(cloud), pickle.loads(pickle.dumps(cloud))):
        assert (other.points.tolist(), other.rows, other.frame_id) == (cloud.points.tolist(), 2, "velodyne")
        assert not other.points.flags.writeable


def test_a_band_of_heights_is_a_scan_whose_rays_know_their_points() -> None:
    cloud = to_cloud(
        [[1.0, 0.0, 0.3], [0.5, 0.0, 1.9], [3.0, 0.0, 0.2], [0.0, 2.0, 0.5], [0.0, -2.0, -0.1], [nan, 0, 0]]
    )
    scan = cloud.scan(z=(0.1, 0.5), angle_increment="1deg")
    assert len(scan) == 360
    met = [(round(ray.angle, 6), ray.range, ray.source) for ray in scan if ray.source is not None]
    assert met == [(0.0, 1.0, 0), (round(pi / 2, 6), 2.0, 3)]
    assert scan.sources.code.replace("{number}", "3") == "points[3]"
    assert scan.sources.made_of == "points from 0.1 m to 0.5 m high"
    assert scan.distance("right") == inf
    assert cloud.scan(z=(0.1, 0.5), range_min=1.5)[180 * 2].range == 3.0
    assert cloud.scan(angle_min="-95deg", angle_increment="90deg", ray_count=3).ranges.tolist() == [2.0, 0.5, 2.0]


def test_the_ray_of_a_point_is_the_one_that_pointcloud_to_laserscan_gives_it() -> None:
    points = np.random.default_rng(1).normal(0, 3, (3000, 3)).astype(np.float32)
    scan = to_cloud(points).scan(z=(-0.5, 0.7))
    # As in its C++: the angle in double, minus angle_min and divided by angle_increment as float32 in its message.
    first, step = float(np.float32(-pi)), float(np.float32(pi / 360))
    ranges = np.full(720, np.inf, np.float32)
    for x, y, z in points:
        index = int((np.arctan2(float(y), float(x)) - first) / step)
        if -0.5 <= z <= np.float32(0.7) and index < 720:
            ranges[index] = min(ranges[index], np.float32(np.hypot(float(x), float(y))))
    assert np.isfinite(ranges).sum() > 300
    np.testing.assert_array_equal(scan.ranges, ranges)


def test_the_cloud_of_a_real_scanner_is_its_scan(data: Path) -> None:
    """A SICK LMS1xx sends each scan twice, as a LaserScan and as a cloud.

    Its own angles in the cloud are up to 0.0005 degrees off those in the header of the scan.
    """
    path = data / "topics" / "sick_laser_and_radar.bag"
    if not path.exists():
        pytest.skip("the recording is not there")
    with robowidgets.open(path) as recording:
        scans = [to_scan(moment.message) for moment in recording.messages("/sick_lms_1xx/scan")]
        clouds = [to_cloud(moment.message) for moment in recording.messages("/cloud")]
        radar = to_cloud(next(iter(recording.messages("/cloud_radar_track"))).message)
    assert (len(scans), len(clouds)) == (89, 89)
    assert radar.fields == ("x", "y", "z", "vx", "vy", "vz", "objLen", "objId")
    for scan, cloud in zip(scans, clouds, strict=True):
        assert cloud.stamp_ns == scan.stamp_ns
        last_bit = np.spacing(scan.ranges)
        assert (np.abs(cloud.distance - scan.ranges) <= last_bit).all()
        far = scan.ranges > 0
        off = np.arctan2(cloud.y, cloud.x, dtype=float) - scan.angles
        assert np.abs((off + pi) % (2 * pi) - pi)[far].max() < 1e-5
        assert (cloud.points["intensity"] == scan.intensities).all()

        # A ray takes the points from its angle on, so start half a ray earlier.
        again = cloud.scan(
            angle_min=scan.angle_min - scan.angle_increment / 2,
            angle_increment=scan.angle_increment,
            ray_count=len(scan),
            range_min=1e-6,
        )
        assert (np.abs(again.ranges - scan.ranges)[far] <= last_bit[far]).all()
        assert (again.sources.numbers == np.where(far, np.arange(len(scan)), -1)).all()
