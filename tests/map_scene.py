"""A robot with a map, from the sample recording: its scans and odometry are real, the map is made from its scans.

Transforms, the pose of a localisation with its covariance, a plan and a goal are worked out from its odometry.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, sin
from types import SimpleNamespace
from typing import Any

import numpy as np

import robowidgets
from robowidgets import MapGrid, PathWidget
from robowidgets.samples import Pose

RESOLUTION = 0.05
DRIFT = (0.15, -0.1, 0.02)
"""The pose of the odometry frame in the map frame, at the end of the drive."""


def stamp(seconds: float) -> SimpleNamespace:
    whole, rest = divmod(round(seconds * 1e9), 1_000_000_000)
    return SimpleNamespace(sec=whole + 1000, nanosec=rest)


def header(frame: str, seconds: float) -> SimpleNamespace:
    return SimpleNamespace(frame_id=frame, stamp=stamp(seconds))


def pose(x: float, y: float, yaw: float) -> SimpleNamespace:
    turn = SimpleNamespace(x=0.0, y=0.0, z=sin(yaw / 2), w=cos(yaw / 2))
    return SimpleNamespace(position=SimpleNamespace(x=x, y=y, z=0.0), orientation=turn)


def odometry(at: Pose, seconds: float) -> SimpleNamespace:
    return SimpleNamespace(
        header=header("odom", seconds),
        child_frame_id="base_link",
        pose=SimpleNamespace(pose=pose(*at), covariance=[0.0] * 36),
    )


def amcl(at: Pose, seconds: float, xx: float = 0.03, xy: float = 0.01, yy: float = 0.02) -> SimpleNamespace:
    covariance = [0.0] * 36
    covariance[0], covariance[1], covariance[6], covariance[7] = xx, xy, xy, yy
    return SimpleNamespace(header=header("map", seconds), pose=SimpleNamespace(pose=pose(*at), covariance=covariance))


def tf(parent: str, child: str, at: tuple[float, float, float], seconds: float) -> SimpleNamespace:
    where = pose(*at)
    transform = SimpleNamespace(translation=where.position, rotation=where.orientation)
    one = SimpleNamespace(header=header(parent, seconds), child_frame_id=child, transform=transform)
    return SimpleNamespace(transforms=[one])


def tf_of_rosbridge(*joined: tuple[str, str, float | None]) -> dict[str, Any]:
    """A tf2_msgs/TFMessage as rosbridge sends it, from parents, children and distances in metres along x."""
    turn = {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}
    return {
        "transforms": [
            {
                "header": {"frame_id": parent, "stamp": {"sec": 1, "nanosec": 0}},
                "child_frame_id": child,
                "transform": {"translation": {"x": x, "y": 0.0, "z": 0.0}, "rotation": turn},
            }
            for parent, child, x in joined
        ]
    }


def plan(places: list[tuple[float, float]], seconds: float, frame: str = "map") -> SimpleNamespace:
    poses = [SimpleNamespace(header=header(frame, seconds), pose=pose(x, y, 0.0)) for x, y in places]
    return SimpleNamespace(header=header(frame, seconds), poses=poses)


def drift(seconds: float, end: float) -> Pose:
    share = seconds / end
    return Pose(*(share * value for value in DRIFT))


def occupancy(grid: MapGrid, frame: str = "map") -> SimpleNamespace:
    """A grid as a nav_msgs/OccupancyGrid."""
    rows, columns = grid.cells.shape
    info = SimpleNamespace(width=columns, height=rows, resolution=grid.resolution, origin=pose(*grid.origin))
    return SimpleNamespace(header=header(frame, 0.0), info=info, data=grid.cells.view(np.int8).ravel())


def map_of(path: Any = robowidgets.SAMPLE) -> MapGrid:
    """The cells that the scans of a recording saw free and occupied."""
    with robowidgets.open(path) as recording:
        moments = list(recording.samples("/scan"))[::4]
        end = recording.duration
        hits, free = [], []
        for moment in moments:
            last = recording.at("/odom", moment.seconds)
            if last is None:
                continue
            at = drift(moment.seconds, end).offset(*last.sample.pose)
            turn = np.array([[cos(at.yaw), -sin(at.yaw)], [sin(at.yaw), cos(at.yaw)]])
            points = moment.sample.xy @ turn.T
            hits.append(points + at[:2])
            free += [points * share + at[:2] for share in np.linspace(0.02, 0.97, 90)]
    ends, through = np.vstack(hits), np.vstack(free)
    corner = np.floor((ends.min(axis=0) - 0.5) / RESOLUTION) * RESOLUTION
    columns, rows = np.ceil((ends.max(axis=0) + 0.5 - corner) / RESOLUTION).astype(int)
    cells = np.full((rows, columns), 255, np.uint8)
    for places, value in ((through, 0), (ends, 100)):
        column, row = ((places - corner) / RESOLUTION).astype(int).T
        cells[row, column] = value
    return MapGrid(cells, RESOLUTION, Pose(*corner, 0.0), frame_id="map")


def drive(path: PathWidget, until: float = 33.2) -> None:
    """Show the drive up to a time on a map, as a feed would."""
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        end = recording.duration
        path.put("/map", occupancy(map_of()), time=0.0)
        path.put("/tf_static", tf("base_link", "laser", (0.0, 0.0, 0.0), 0.0), time=0.0)
        nearest = list(recording.samples("/odom", 0.0, until))
        for i, moment in enumerate(nearest):
            seconds, at = moment.seconds, moment.sample.pose
            shift = drift(seconds, end)
            path.put("/tf", tf("map", "odom", tuple(shift), seconds), time=seconds)
            path.put("/odom", odometry(at, seconds), time=seconds)
            if i % 10 == 0:
                path.put("/amcl_pose", amcl(shift.offset(*at), seconds), time=seconds)
        scan = recording.at("/scan", until)
        assert scan is not None
        path.put("/scan", scan, time=scan.seconds)
        where = shift.offset(*at)
        goal = (where.x - 1.5, where.y - 3.6)
        path.put(
            "/nav/plan",
            plan([(where.x + 0.05, where.y), (where.x - 0.6, where.y - 1.6), goal], until - 0.6),
            time=until - 0.6,
        )
        path.put("/nav/goal", SimpleNamespace(header=header("map", 31.6), pose=pose(*goal, -1.2)), time=until)


TYPES = {
    "/map": "nav_msgs/msg/OccupancyGrid",
    "/local_costmap": "nav_msgs/msg/OccupancyGrid",
    "/tf": "tf2_msgs/msg/TFMessage",
    "/tf_static": "tf2_msgs/msg/TFMessage",
    "/odom": "nav_msgs/msg/Odometry",
    "/amcl_pose": "geometry_msgs/msg/PoseWithCovarianceStamped",
    "/particles": "geometry_msgs/msg/PoseArray",
    "/plan": "nav_msgs/msg/Path",
    "/scan": "sensor_msgs/msg/LaserScan",
}


def plain(value: Any) -> Any:
    """A message as dictionaries and lists."""
    if isinstance(value, SimpleNamespace):
        return {name: plain(one) for name, one in vars(value).items()}
    return [plain(one) for one in value] if isinstance(value, list) else value


def messages(until: float = 20.0) -> Iterator[tuple[float, str, dict[str, Any]]]:
    """The messages of a robot with a map, in the order of time: seconds, topic and fields."""
    random = np.random.default_rng(5)
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        end = recording.duration
        yield 0.0, "/map", plain(occupancy(map_of()))
        yield 0.0, "/tf_static", plain(tf("base_link", "laser", (0.0, 0.0, 0.0), 0.0))
        i = -1
        for moment in recording.samples(("/odom", "/scan"), 0.0, until):
            seconds, sample = moment.seconds, moment.sample
            if moment.topic == "/scan":
                limits = {
                    name: getattr(sample, name) for name in ("angle_min", "angle_increment", "range_min", "range_max")
                }
                ranges = np.array(sample.ranges)
                yield seconds, "/scan", {"header": plain(header("laser", seconds)), **limits, "ranges": ranges}
                continue
            i += 1
            shift, at = drift(seconds, end), sample.pose
            where = shift.offset(*at)
            yield seconds, "/tf", plain(tf("map", "odom", tuple(shift), seconds))
            yield seconds, "/odom", plain(odometry(at, seconds))
            if i % 20 == 0:
                yield seconds, "/amcl_pose", plain(amcl(where, seconds))
                cells = np.zeros((60, 60), np.uint8)
                cells[20:40, 30:44], cells[26:34, 34:40] = 40, 100
                costs = MapGrid(cells, RESOLUTION, Pose(at.x - 1.5, at.y - 1.5, 0.0))
                yield seconds, "/local_costmap", plain(occupancy(costs, "odom"))
                spots = [pose(*(where + random.normal(0, 0.1, 3))) for _ in range(40)]
                yield seconds, "/particles", plain(SimpleNamespace(header=header("map", seconds), poses=spots))
            if i % 100 == 0:
                line = [(where.x, where.y), (where.x + 1.0, where.y + 0.5), (where.x + 2.5, where.y + 1.2)]
                yield seconds, "/plan", plain(plan(line, seconds))
