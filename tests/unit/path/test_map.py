"""The path widget as a map: its inputs, the frame of its drawing, and the data for the page."""

from __future__ import annotations

import re
import zlib
from collections.abc import Callable, Sequence
from math import cos, degrees, hypot, inf, nan, pi, radians, sin, sqrt
from pathlib import Path
from threading import Thread
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from rosbags.highlevel import AnyReader

import robowidgets
from robowidgets import Line, MapGrid, PathWidget, Range, load_map
from robowidgets.messages.map_grid import to_map_grid
from robowidgets.messages.map_item import to_map_item
from robowidgets.path.layers import Layers
from robowidgets.path.packing import _GRID, pack_grid, pack_layers, unpack_layers
from robowidgets.path.placing import EAST_NORTH, Placed
from robowidgets.poses.local_plane import LocalPlane
from robowidgets.poses.transforms import Transform
from robowidgets.samples import Pose
from robowidgets.samples.map_item import NO_FIX, MapItem, Scatter

from ... import map_scene as scene
from ..pages import synced
from ..recordings import recorded
from ..waiting import wait_for


def shown(path: PathWidget) -> dict[str, Placed]:
    """The content of each layer, by its name, as the page gets it."""
    path.send_newest()
    names = {layer["number"]: layer["name"] for layer in path.get_state()["_map"]["layers"]}
    frame = path.get_state()["_frame"]
    return {names[one.number]: one for one in unpack_layers(bytes(frame)[64:])}


def missing(path: PathWidget) -> dict[str, str]:
    path.send_newest()
    found: dict[str, str] = path.get_state()["_about"].get("missing", {})
    return found


def stamped(frame: str, x: float, y: float, yaw: float, seconds: float = 1.0) -> Any:
    return SimpleNamespace(header=scene.header(frame, seconds), pose=scene.pose(x, y, yaw))


def fix(latitude: float, longitude: float, status: int = 0) -> Any:
    return {
        "header": {"frame_id": "gps", "stamp": {"sec": 1, "nanosec": 0}},
        "status": {"status": status},
        "latitude": latitude,
        "longitude": longitude,
        "altitude": 30.0,
    }


def scan_in(frame: str) -> Any:
    limits = {"angle_min": 0.0, "angle_increment": 0.1, "range_min": 0.1, "range_max": 9.0}
    return SimpleNamespace(header=scene.header(frame, 1.0), ranges=[1.0], **limits)


def drawn_in(path: PathWidget) -> dict[str, str | None]:
    """The frame in which each layer is drawn, as sent to the page, or None."""
    path.send_newest()
    return {layer["name"]: layer.get("frame") for layer in path.get_state()["_map"]["layers"]}


class TestItems:
    def test_poses_of_all_types_have_their_place_their_frame_and_how_sure_they_are(self) -> None:
        assert to_map_item(stamped("/map", 1.5, -2.0, 0.5)).frame_id == "map"
        assert to_map_item(stamped("map", 1.5, -2.0, 0.5)).pose == pytest.approx((1.5, -2.0, 0.5))
        assert to_map_item(scene.pose(1.0, 2.0, 0.0)).frame_id == ""
        assert to_map_item({"x": 1.0, "y": 2.0, "theta": 0.25}).pose == (1.0, 2.0, 0.25)
        amcl = to_map_item(scene.amcl(Pose(1.0, 2.0, 0.0), 3.0))
        assert amcl.scatter == (0.03, 0.01, 0.02)
        assert to_map_item(scene.odometry(Pose(1.0, 2.0, 0.0), 3.0)).scatter is None, "all 0 is not known"
        assert to_map_item(scene.odometry(Pose(1.0, 2.0, 0.0), 3.0)).child_frame_id == "base_link"

    def test_points_and_transforms_have_a_place(self) -> None:
        header = {"frame_id": "/map", "stamp": {"sec": 1, "nanosec": 0}}
        point = to_map_item({"header": header, "point": {"x": 1.0, "y": 2.0, "z": 3.0}})
        assert (point.kind, point.frame_id, point.pose[:2], point.stamp_ns) == ("pose", "map", (1.0, 2.0), 10**9)
        assert np.isnan(point.pose.yaw)
        turn = {"x": 0.0, "y": 0.0, "z": sin(0.25), "w": cos(0.25)}
        transform = {"translation": {"x": 1.0, "y": 2.0, "z": 0.0}, "rotation": turn}
        placed = to_map_item({"header": header, "child_frame_id": "marker", "transform": transform})
        assert (placed.frame_id, placed.pose) == ("map", pytest.approx((1.0, 2.0, 0.5)))

    def test_a_sonar_is_a_cone_up_to_its_reading_or_its_range(self) -> None:
        met = to_map_item(Range(2.0, 0.1, 4.0, field_of_view=0.5, frame_id="/sonar"))
        assert (met.kind, met.frame_id, met.pose) == ("cone", "sonar", (0.0, 0.0, 0.0))
        assert np.hypot(*met.points.T) == pytest.approx([0.0, *[2.0] * (len(met.points) - 1)])
        assert np.arctan2(met.points[1:, 1], met.points[1:, 0])[[0, -1]] == pytest.approx([-0.25, 0.25])
        nothing = to_map_item(Range(inf, 0.1, 4.0, radiation="infrared"))
        assert np.isnan(nothing.pose.x)
        assert np.ptp(np.arctan2(nothing.points[1:, 1], nothing.points[1:, 0])) == pytest.approx(radians(3))
        assert not len(to_map_item(Range(nan, 0.1, 4.0)).points)
        for close in (Range(-inf, 0.3, 4.0), Range(0.1, 0.3, 4.0)):
            near = to_map_item(close)
            assert near.pose == (0.0, 0.0, 0.0)
            assert np.hypot(*near.points[1:].T) == pytest.approx(0.3)

    def test_a_path_is_a_line_and_an_array_of_poses_has_headings(self) -> None:
        path = to_map_item(scene.plan([(0, 0), (1, 2), (nan, 3)], 1.0))
        assert (path.kind, path.frame_id, path.points.tolist()) == ("path", "map", [[0, 0], [1, 2]])
        array = SimpleNamespace(header=scene.header("map", 1.0), poses=[scene.pose(1, 2, 0.5)])
        poses = to_map_item(array)
        assert (poses.kind, poses.points.tolist()) == ("poses", [pytest.approx([1, 2, 0.5])])
        empty = SimpleNamespace(header=scene.header("map", 1.0), poses=[])
        assert to_map_item(empty).points.shape == (0, 3)

    def test_what_has_no_place_is_refused_with_what_is_taken(self) -> None:
        with pytest.raises(TypeError, match=r"expected a message like nav_msgs/Odometry.*keys data"):
            to_map_item({"data": "hello"})

    def test_a_pose_that_is_not_finite_is_nowhere_and_a_covariance_that_cannot_be_is_not_known(self) -> None:
        assert str(to_map_item(stamped("map", nan, 1.0, 0.0)).pose.x) == "nan"
        wrong = scene.amcl(Pose(0, 0, 0), 1.0, xx=0.01, xy=5.0, yy=0.01)
        assert to_map_item(wrong).scatter is None


class TestFixes:
    @pytest.mark.parametrize("latitude", [0.0, 52.1, -33.9, 89.0])
    def test_metres_east_and_north_follow_the_radii_of_the_ellipsoid(self, latitude: float) -> None:
        a, e2 = 6_378_137.0, 0.00669437999014
        squared = 1 - e2 * sin(radians(latitude)) ** 2
        across, along = a / sqrt(squared), a * (1 - e2) / squared**1.5
        plane = LocalPlane(latitude, 4.4, 0.0)
        step = 1e-4
        east, _ = plane.east_north(latitude, 4.4 + step, 0.0)
        _, north = plane.east_north(latitude + step, 4.4, 0.0)
        assert east == pytest.approx(radians(step) * across * cos(radians(latitude)), rel=1e-6)
        assert north == pytest.approx(radians(step) * along, rel=1e-5)
        assert plane.east_north(latitude, 4.4, 0.0) == (0.0, 0.0)

    def test_the_first_fix_is_the_origin_and_the_frame_says_so(self) -> None:
        path = PathWidget()
        path.put("/fix", fix(52.0, 4.0))
        path.put("/fix", fix(52.001, 4.0))
        assert shown(path)["/fix"].pose.y == pytest.approx(111.26, abs=0.01)
        assert path.get_state()["_about"]["frame_id"] == EAST_NORTH == "east, north of the first fix"

    def test_no_fix_is_nowhere(self) -> None:
        for none in (fix(52.0, 4.0, status=-1), fix(nan, 4.0), fix(0.0, 0.0)):
            item = to_map_item(none)
            assert (item.fix, item.is_nowhere) == (NO_FIX, True)
        with pytest.raises(ValueError, match="latitude within ±90"):
            to_map_item(fix(152.0, 4.0))

    def test_a_receiver_that_has_no_fix_at_first_is_drawn_from_its_first_fix_on(self) -> None:
        path = PathWidget()
        path.put("/fix", fix(nan, nan, status=-1))
        path.put("/fix", fix(52.0, 4.0))
        path.put("/fix", fix(52.001, 4.0))
        assert shown(path)["/fix"].pose.y == pytest.approx(111.26, abs=0.01)
        assert (path.get_state()["_about"]["frame_id"], missing(path)) == (EAST_NORTH, {})

    def test_a_receiver_without_a_fix_is_not_a_frame_of_the_map(self) -> None:
        path = PathWidget()
        path.put("/fix", fix(0.0, 0.0))
        path.put("/pose", stamped("odom", 1.0, 2.0, 0.0))
        assert shown(path)["/pose"].pose[:2] == (1.0, 2.0)
        assert path.get_state()["_about"]["frame_id"] == "odom"


class TestGrids:
    def message(self, **changes: Any) -> Any:
        info = {"width": 3, "height": 2, "resolution": 0.5, "origin": {"position": {"x": -1.0, "y": 2.0}}}
        return {"header": {"frame_id": "map"}, "info": info, "data": [0, 100, -1, 50, 0, 0], **changes}

    def test_rows_lie_along_y_from_the_origin_and_minus_one_is_unknown(self) -> None:
        grid = to_map_grid(self.message())
        assert grid.values.tolist() == [[0, 100, -1], [50, 0, 0]]
        assert (grid[0, 1], grid[0, 2], grid.origin, grid.frame_id) == (100, -1, (-1.0, 2.0, 0.0), "map")

    def test_cells_are_given_as_any_whole_numbers(self) -> None:
        assert MapGrid(np.array([[-1, 0, 100]]), 0.1).values.tolist() == [[-1, 0, 100]]
        for wrong in ([[0.5]], [[300]], [[-2]]):
            with pytest.raises(
                ValueError, match="cells: expected whole numbers from 0 to 100, and 255 or -1 for unknown"
            ):
                MapGrid(np.array(wrong), 0.1)
        with pytest.raises(ValueError, match="expected rows and columns"):
            MapGrid(np.zeros((0, 3), np.uint8), 0.1)

    def test_costs_go_to_254(self) -> None:
        metadata = {"size_x": 2, "size_y": 1, "resolution": 0.1, "origin": {"position": {"x": 0.0, "y": 0.0}}}
        grid = to_map_grid({"header": {"frame_id": "odom"}, "metadata": metadata, "data": [254, 255]})
        assert (grid.values.tolist(), grid.most) == ([[254, -1]], 254)
        of_rosbridge = to_map_grid({"header": {"frame_id": "odom"}, "metadata": metadata, "data": "/v8="})
        assert of_rosbridge.values.tolist() == [[254, -1]]
        with pytest.raises(ValueError, match="map: data: expected bytes, or text in base64, got other text"):
            to_map_grid({"header": {"frame_id": "odom"}, "metadata": metadata, "data": "%"})

    def test_cells_that_do_not_fit_are_refused(self) -> None:
        with pytest.raises(ValueError, match="expected 3 x 2 cells, as its info says, got 2"):
            to_map_grid(self.message(data=[0, 1]))
        with pytest.raises(ValueError, match="resolution: expected metres above 0"):
            to_map_grid(self.message(info={**self.message()["info"], "resolution": 0.0}))

    def test_a_thinned_grid_loses_no_obstacle(self) -> None:
        cells = np.full((5, 7), 255, np.uint8)
        cells[4, 6], cells[0, 0], cells[2, 3] = 100, 0, 30
        thin, step = MapGrid(cells, 0.5).thinned(12)
        assert (step, thin.resolution, thin.values.tolist()) == (
            2,
            1.0,
            [[0, -1, -1, -1], [-1, 30, -1, -1], [-1, -1, -1, 100]],
        )

    def test_a_large_grid_is_sent_once_and_deflated(self) -> None:
        cells = np.zeros((200, 300), np.uint8)
        version, packed = pack_grid(3, MapGrid(cells, 0.05))
        assert _GRID.unpack_from(packed) == (3, version, 200, 300, 0.05, 1, len(packed) - _GRID.size)
        assert zlib.decompress(packed[_GRID.size :]) == cells.tobytes()
        assert len(packed) < 300
        path = PathWidget()
        path.put("/map", MapGrid(cells, 0.05, frame_id="map"))
        assert shown(path)["/map"].grid is None
        assert path.get_state()["_grids"]

    def test_a_large_grid_goes_in_one_message_with_the_first_frame_that_shows_it(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        path = PathWidget()
        sent: list[tuple[int, float, set[int]]] = []
        grids: set[int] = set()

        def send(data: dict[str, Any], buffers: Sequence[bytes] = (), **_: object) -> None:
            parts = dict(zip((name for (name,) in data["buffer_paths"]), buffers, strict=True))
            if packed := bytes(parts.get("_grids", b"")):
                grids.clear()
                grids.add(int(_GRID.unpack_from(packed)[1]))
            if frame := bytes(parts.get("_frame", b"")):
                (one,) = unpack_layers(frame[64:])
                sent.append((one.version, one.pose.x, {*grids}))

        monkeypatch.setattr(path.comm, "send", send)
        for side in (200, 240, 280):
            origin = Pose(-side / 100, 0.0, 0.0)
            path.put("/map", MapGrid(np.zeros((side, side), np.uint8), 0.05, origin, frame_id="map"))
            path.send_newest()
        assert [x for _, x, _ in sent] == [-2.0, -2.4, -2.8]
        assert [known for _, _, known in sent] == [{version} for version, _, _ in sent]
        assert len({version for version, _, _ in sent}) == 3
        path.close()

    def test_a_small_grid_comes_with_its_frame(self) -> None:
        path = PathWidget()
        path.put("/local_costmap", MapGrid(np.array([[0, 99]], np.uint8), 0.05, Pose(1.0, 2.0, 0.0), frame_id="odom"))
        grid = shown(path)["/local_costmap"].grid
        assert grid is not None
        assert (grid.values.tolist(), grid.resolution, grid.origin) == ([[0, 99]], 0.05, (1.0, 2.0, 0.0))


class TestMapFiles:
    def write(self, folder: Path, pixels: list[list[int]], **about: Any) -> Path:
        rows, columns = len(pixels), len(pixels[0])
        (folder / "map.pgm").write_bytes(
            b"P5\n# made\n%d %d\n255\n" % (columns, rows) + bytes(value for row in pixels for value in row)
        )
        known = {"image": "map.pgm", "resolution": 0.05, "origin": [-1.0, -2.0, 0.0], **about}
        (folder / "map.yaml").write_text("".join(f"{name}: {value}\n" for name, value in known.items()))
        return folder / "map.yaml"

    def test_dark_is_occupied_bright_is_free_and_gray_unknown_with_the_last_row_at_the_bottom(
        self, tmp_path: Path
    ) -> None:
        grid = load_map(self.write(tmp_path, [[0, 254, 205], [254, 254, 0]]))
        assert grid.values.tolist() == [[0, 0, 100], [100, 0, -1]]
        assert (grid.resolution, grid.origin, grid.frame_id) == (0.05, (-1.0, -2.0, 0.0), "map")

    def test_negate_turns_it_round(self, tmp_path: Path) -> None:
        assert load_map(self.write(tmp_path, [[0, 255]], negate=1)).values.tolist() == [[0, 100]]

    def test_scale_and_raw_keep_what_lies_between(self, tmp_path: Path) -> None:
        pixels = [[0, 128, 255]]
        assert load_map(self.write(tmp_path, pixels, mode="scale")).values.tolist() == [[100, 67, 0]]
        assert load_map(self.write(tmp_path, [[0, 100, 101, 255]], mode="raw")).values.tolist() == [[0, 100, -1, -1]]

    def test_a_png_is_read_too(self, tmp_path: Path) -> None:
        images = pytest.importorskip("PIL.Image")

        path = self.write(tmp_path, [[0, 255]], image="map.png")
        images.fromarray(np.array([[0, 255]], np.uint8)).save(tmp_path / "map.png")
        assert load_map(path).values.tolist() == [[100, 0]]

    @pytest.mark.parametrize(
        ("mode", "cells"),
        [
            # Trinary uses the mean of red, green, blue and alpha: 0, 0.5 and 0.75 of white for transparent pixels.
            ("trinary", [[100, 0, -1, -1, 0]]),
            # Scale: each pixel that is not opaque is unknown.
            ("scale", [[100, 0, -1, -1, -1]]),
            ("raw", [[0, -1, -1, 50, -1]]),
        ],
    )
    def test_the_alpha_of_a_png_counts_as_in_map_server(
        self, tmp_path: Path, mode: str, cells: list[list[int]]
    ) -> None:
        images = pytest.importorskip("PIL.Image")

        path = self.write(tmp_path, [[0, 255]], image="map.png", mode=mode)
        pixels = [[(0, 0, 0, 255), (255, 255, 255, 255), (255, 255, 255, 0), (50, 50, 50, 250), (255, 255, 255, 254)]]
        if mode == "trinary":
            pixels[0][3] = (100, 100, 100, 255)
        images.fromarray(np.array(pixels, np.uint8)).save(tmp_path / "map.png")
        assert load_map(path).values.tolist() == cells

    @pytest.mark.parametrize(
        ("about", "why"),
        [
            ({"mode": "colour"}, "expected mode trinary, scale or raw, got 'colour'"),
            ({"free_thresh": 0.9}, "expected free_thresh below occupied_thresh, got 0.9 and 0.65"),
            ({"resolution": 0}, "resolution: expected metres above 0, got 0"),
            ({"origin": "[1, 2]"}, r"origin: expected \[x, y, yaw\], got \[1, 2\]"),
        ],
    )
    def test_what_a_file_says_wrong_is_named(self, tmp_path: Path, about: dict[str, Any], why: str) -> None:
        with pytest.raises(ValueError, match=why):
            load_map(self.write(tmp_path, [[0, 255]], **about))

    def test_files_that_are_not_a_map_are_named(self, tmp_path: Path) -> None:
        (tmp_path / "other.yaml").write_text("a: 1")
        with pytest.raises(ValueError, match=r"other.yaml: expected the YAML file of a map"):
            load_map(tmp_path / "other.yaml")
        path = self.write(tmp_path, [[0, 255]])
        (tmp_path / "map.pgm").write_bytes(b"P5\n9 9\n255\n\0")
        with pytest.raises(ValueError, match="expected 9 x 9 pixels, got 1: the file is cut off"):
            load_map(path)
        (tmp_path / "map.pgm").write_bytes(b"GIF?")
        with pytest.raises(ValueError, match="expected an image in PGM; map_saver writes one with --fmt pgm"):
            load_map(path)

    def test_a_map_is_the_ground_and_can_be_taken_away(self, tmp_path: Path) -> None:
        path = PathWidget()
        path.ground = load_map(self.write(tmp_path, [[0, 254]]))
        assert (path.names, path.ground and path.ground.values.tolist()) == (("ground",), [[100, 0]])
        path.ground = None
        assert (path.names, path.ground) == ((), None)
        with pytest.raises(TypeError, match="ground: expected a map"):
            path.ground = stamped("map", 1, 2, 3)


class TestFrames:
    def test_layers_are_joined_by_the_transforms_at_their_own_stamps(self) -> None:
        path = PathWidget()
        path.put("/map", MapGrid(np.zeros((2, 2), np.uint8), 1.0, frame_id="map"))
        for seconds, x in ((1.0, 0.0), (2.0, 10.0), (3.0, 20.0)):
            path.put("/tf", scene.tf("map", "odom", (x, 0.0, pi / 2), seconds))
        path.put("/odom", scene.odometry(Pose(1.0, 0.0, 0.25), 1.5))
        assert shown(path)["/odom"].pose == pytest.approx((5.0, 1.0, pi / 2 + 0.25))
        assert path.get_state()["_map"]["frames"] == ["map", "odom"]

    def test_an_old_transform_has_a_note_until_a_new_one_comes(self) -> None:
        layers, second = Layers(), 10**9

        def move(parent: str, child: str, at: int) -> None:
            pose = (1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0)
            layers.add_frames(iter([Transform(parent, child, at * second, 0, pose)]), float(at))

        layers.show_frame("map->base_link")
        move("map", "odom", 1)
        layers.put("/goal", MapItem("pose", "map", pose=Pose(0.0, 0.0, 0.0)), 1.0, second)
        for at in (1, 8):
            move("odom", "base_link", at)
            layers.put("/scan", MapItem("scan", "base_link", points=np.ones((3, 2))), float(at), at * second)
            assert layers.notes() == []
        move("odom", "base_link", 43)
        assert layers.notes() == ["tf map → odom is 42 s old"]
        layers.put("/scan", MapItem("scan", "base_link", points=np.ones((3, 2))), 45.0, 45 * second)
        assert layers.notes() == ["tf map → odom is 44 s old"]
        for name, child in (("map", "odom"), ("odom", "base_link")):
            move(name, child, 46)
        layers.put("/scan", MapItem("scan", "base_link", points=np.ones((3, 2))), 46.0, 46 * second)
        assert layers.notes() == []

    def test_the_page_shows_that_a_transform_is_old(self) -> None:
        path = PathWidget()
        path.put("/tf", scene.tf("map", "odom", (0.0, 0.0, 0.0), 1.0))
        path._layers.add_frames(
            iter([Transform("odom", "base", -60 * 10**9, 0, (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0))]), 0.0
        )
        path.put("/pose", stamped("map", 1.0, 2.0, 0.0))
        path.put("/scan", scan_in("base"))
        path.send_newest()
        (note,) = path.get_state()["_about"]["notes"]
        assert re.fullmatch(r"tf odom → base is \d+ s old", note)

    def test_an_ellipse_turns_with_its_frame(self) -> None:
        path = PathWidget(frame="map")
        path.put("/tf_static", scene.tf("map", "odom", (0.0, 0.0, pi / 2), 1.0))
        message = scene.amcl(Pose(0, 0, 0), 1.0, xx=0.04, xy=0.0, yy=0.01)
        message.header.frame_id = "odom"
        path.put("/pose", message)
        assert shown(path)["/pose"].scatter == pytest.approx((0.01, 0.0, 0.04))

    def test_layers_that_nothing_joins_are_each_drawn_in_their_own_frame_until_a_transform_joins_them(self) -> None:
        path = PathWidget()
        path.put("/odom", scene.odometry(Pose(1.0, 0.0, 0.0), 1.0))
        path.put("/other", stamped("camera", 5.0, 6.0, 0.0))
        path.put("/scan", scan_in("base_link"))
        path.put("/far", scan_in("truck"))  # which is not on a map
        assert shown(path)["/other"].pose == (5.0, 6.0, 0.0)
        assert drawn_in(path) == {"/odom": "odom", "/other": "camera", "/scan": "odom", "/far": None}
        assert missing(path) == {"/far": "not drawn: no transform to odom"}
        assert np.isnan(path.distance("/odom", "/other")[1]).all()
        path.frame = "camera"
        assert drawn_in(path) == {"/odom": "odom", "/other": "camera", "/scan": "odom", "/far": None}
        assert shown(path)["/odom"].pose == (1.0, 0.0, 0.0)
        path.join("odom", "camera", (0.0, 2.0, 0.0))
        assert shown(path)["/odom"].pose == (1.0, -2.0, 0.0)
        assert drawn_in(path) == {"/odom": "camera", "/other": "camera", "/scan": "camera", "/far": None}
        for seconds in (10.0, 11.0):
            path.put("/other", stamped("camera", 5.0, 6.0, 0.0), time=seconds)
            path.put("/odom", scene.odometry(Pose(1.0, 0.0, 0.0), 2.0), time=seconds)
        assert path.distance("/odom", "/other")[1][-1] == hypot(4.0, 8.0)

    def test_two_receivers_have_one_origin_and_the_page_gets_it_once(self) -> None:
        path, listings = PathWidget(), set()
        for i in range(3):
            path.put("/front", fix(48.0, 9.0 + 1e-6 * i))
            path.put("/rear", fix(48.0, 9.00001 + 1e-6 * i))
            listings.add(path._layers.listing)
        assert len(listings) == 1
        front, rear = (shown(path)[name].pose for name in ("/front", "/rear"))
        assert rear.x - front.x == pytest.approx(0.746, abs=0.002)

    def test_odometry_joins_the_robot_where_tf_does_not(self) -> None:
        path = PathWidget()
        path.put("/odom", scene.odometry(Pose(2.0, 0.0, pi / 2), 1.0))
        path.join("base_link", "laser", (0.1, 0.0, 0.0))
        path.put("/scan", scan_in("laser"))
        assert shown(path)["/scan"].points.tolist() == [pytest.approx([2.0, 1.1])]

    def test_a_frame_of_tf_is_a_layer_by_its_name(self) -> None:
        path = PathWidget()
        path.put("map->base_link")
        assert missing(path) == {"map->base_link": "not drawn: nothing came yet"}
        path.put("/tf", scene.tf("odom", "base_link", (1.0, 0.0, 0.0), 1.0))
        path.put("/tf", scene.tf("map", "odom", (0.0, 3.0, 0.0), 1.0))
        assert shown(path)["map->base_link"].pose == pytest.approx((1.0, 3.0, 0.0))
        with pytest.raises(TypeError, match=r"put\('/odom'\) needs a message, or a name of two frames"):
            path.put("/odom")

    def test_the_poses_that_update_took_become_a_layer_with_their_way(self) -> None:
        path = PathWidget(title="/odom")
        for i in range(5):
            path.update(x=0.1 * i, y=0.0, yaw=0.0, time=float(i))
        path.ground = MapGrid(np.zeros((2, 2), np.uint8), 1.0)
        path.update(x=0.5, y=0.0, yaw=0.0, time=5.0)
        assert path.names == ("/odom", "ground")
        assert shown(path)["/odom"].pose == (0.5, 0.0, 0.0)
        assert len(path.points) == 6

    def test_shapes_lie_in_their_frame_and_move_with_it(self) -> None:
        path = PathWidget()
        path.put("/pose", stamped("map", 0.0, 0.0, 0.0))
        path.draw("door", Line((0, 0), (1, 0)), frame="odom")
        assert missing(path)["door"] == "not drawn: no transform to map"
        path.put("/tf", scene.tf("map", "odom", (2.0, 3.0, 0.5), 1.0))
        path.send_newest()
        (shape,) = path.get_state()["_about"]["shapes"]
        assert (shape["name"], shape["from"]) == ("door", pytest.approx([2.0, 3.0, 0.5]))

    def test_a_transform_with_null_is_reported_too_and_a_frame_on_show_moves_with_its_neighbours(self) -> None:
        path = PathWidget(frame="map")
        path.put("map->odom")
        message = scene.tf_of_rosbridge(("map", "camera", None), ("map", "odom", 1.0), ("map", "lens", None))
        with pytest.raises(
            ValueError, match=r"/tf: 'camera' in 'map' has no valid pose: None, 0.0, 0.0, with the quat"
        ):
            path.put("/tf", message)
        assert shown(path)["map->odom"].pose == (1.0, 0.0, 0.0)

    def test_a_transform_without_a_pose_is_reported_and_the_others_of_its_message_join(self) -> None:
        path = PathWidget(frame="map")
        wrong, right = scene.tf("map", "camera", (nan, 0.0, 0.0), 1.0), scene.tf("map", "odom", (1.0, 0.0, 0.0), 1.0)
        with pytest.raises(ValueError, match=r"/tf: 'camera' in 'map' has no valid pose: nan"):
            path.put("/tf", SimpleNamespace(transforms=[*wrong.transforms, *right.transforms]))
        path.put("/odom", scene.odometry(Pose(1.0, 0.0, 0.0), 1.0))
        assert shown(path)["/odom"].pose == (2.0, 0.0, 0.0)

    def test_dictionaries_of_rosbridge_join_too(self) -> None:
        path = PathWidget(frame="map")
        path.put("/tf", scene.tf_of_rosbridge(("map", "odom", 1.0)))
        path.put("/odom", scene.odometry(Pose(1.0, 0.0, 0.0), 1.0))
        assert shown(path)["/odom"].pose == (2.0, 0.0, 0.0)


class TestLayers:
    def test_frozen_the_map_keeps_what_it_showed(self) -> None:
        path = PathWidget()
        path.put("/pose", stamped("map", 1.0, 2.0, 0.0))
        path.paused = True
        path.put("/pose", stamped("map", 5.0, 6.0, 0.0))
        assert path.frozen is not None
        assert [one.pose for one in path.frozen.layers or ()] == [(1.0, 2.0, 0.0)]

    def test_packed_points_are_read_again_and_are_as_exact_far_from_the_origin(self) -> None:
        points = np.array([[500_000.01, 4_000_000.02], [500_001.03, 4_000_000.05]])
        one = Placed(2, 1.5, Pose(1.0, 2.0, nan), Scatter(0.1, 0.0, 0.2), points, 5, None)
        (read,) = unpack_layers(pack_layers([one]))
        assert np.abs(read.points - points).max() < 1e-6
        assert (read.number, read.seconds, read.pose[:2], read.scatter, read.total) == (
            2,
            1.5,
            (1.0, 2.0),
            (0.1, 0.0, 0.2),
            5,
        )

    def test_the_distance_from_a_plan_is_a_number_over_time(self) -> None:
        path = PathWidget()
        path.put("/odom", scene.odometry(Pose(0.0, 0.5, 0.0), 0.5), time=0.0)
        path.put("/plan", scene.plan([(0, 0), (10, 0)], 1.0, "odom"), time=1.0)
        path.put("/odom", scene.odometry(Pose(2.0, 0.25, 0.0), 2.0), time=2.0)
        path.put("/plan", scene.plan([(0, 1), (10, 1)], 3.0, "odom"), time=3.0)
        path.put("/odom", scene.odometry(Pose(4.0, 0.25, 0.0), 4.0), time=4.0)
        seconds, metres = path.distance("/odom", "/plan")
        assert seconds.tolist() == [0.0, 2.0, 4.0]
        assert metres.tolist() == [pytest.approx(nan, nan_ok=True), 0.25, 0.75]
        path.put("/amcl", stamped("odom", 4.0, 3.25, 0.0), time=4.0)
        assert path.distance("/odom", "/amcl")[1][-1] == 3.0
        with pytest.raises(KeyError, match="the layers are /odom, /plan, /amcl"):
            path.distance("/odom", "/nothing")

    def test_too_many_layers_and_what_has_no_place_are_refused_and_nothing_is_lost(
        self, caplog: pytest.LogCaptureFixture
    ) -> None:
        path = PathWidget()

        def from_feed(*names: str) -> None:
            def put() -> None:
                for name in names:
                    path.put(name, stamped("map", 1.0, 2.0, 0.0))

            thread = Thread(target=put)
            thread.start()
            thread.join()

        for i in range(30):
            path.put(f"/pose{i}", stamped("map", 1.0, 2.0, 0.0))
        with pytest.raises(ValueError, match="expected at most 30 layers"):
            path.put("/another", stamped("map", 1.0, 2.0, 0.0))
        from_feed("/another", "/pose1", "/one_more", "/another", "/pose2")
        path.send_newest()
        about = path.get_state()["_about"]
        assert (about["notes"], about.get("error")) == (["2 layers not drawn: a map has 30 at most"], None)
        assert [record.message for record in caplog.records] == [
            "PathWidget : a map has at most 30 layers; remove(name) removes one"
        ]
        with pytest.raises(TypeError, match="expected a message like"):
            path.put("/pose1", {"data": 1})
        with pytest.raises(KeyError, match="the layers are /pose0"):
            path.remove("/nothing")
        path.remove("/pose0")
        assert len(shown(path)) == 29

    def test_a_feed_gives_each_message_the_name_of_its_topic(self) -> None:
        path = PathWidget()
        path.update("/odom", scene.odometry(Pose(1.0, 0.0, 0.0), 1.0))
        assert path.pose is not None
        assert (path.pose.x, path.names) == (1.0, ()), "one topic of poses is a path, as before"
        path.update("/amcl_pose", scene.amcl(Pose(1.0, 2.0, 0.0), 1.0))
        path.update("/odom", scene.odometry(Pose(2.0, 0.0, 0.0), 2.0))
        assert path.names == ("/odom", "/amcl_pose")
        assert path.pose.x == 2.0


class TestRecordings:
    def track(self, data: Path, name: str, *topics: str) -> tuple[Any, Any]:
        player = played(data / name, *topics, scanogram=False)
        (view,) = [view for view in player.views if isinstance(view.widget, PathWidget)]
        return player, view

    @pytest.mark.parametrize(
        ("name", "topic", "place"),
        [
            ("topics/scitos_amcl.bag", "/amcl_pose", lambda message: message.pose.pose.position),
            ("topics/crazyflie_vicon", "/vicon/Group466CF/Group466CF/pose", lambda message: message.pose.position),
        ],
    )
    @pytest.mark.slow
    def test_places_match_rosbags_to_the_last_bit(
        self, data: Path, name: str, topic: str, place: Callable[[Any], Any]
    ) -> None:
        with AnyReader([data / name]) as reader:
            connections = [one for one in reader.connections if one.topic == topic]
            told = [place(reader.deserialize(raw, one.msgtype)) for one, _, raw in reader.messages(connections)]
        expected = {(one.x, one.y) for one in told}
        player, view = self.track(data, name, topic)
        frames = list(view.track.frames(0.0, player.duration + 1))
        seen = {one.pose[:2] for timed in frames for one in unpack_layers(timed.frame[64:])}
        player.close()
        assert seen
        assert seen <= expected

    def test_two_frames_that_nothing_joins_are_each_drawn_alone(self, data: Path) -> None:
        player, view = self.track(data, "topics/scitos_amcl.bag", "/odom", "/amcl_pose")
        path = view.widget
        assert [layer["name"] for layer in synced(path, "_map")["layers"]] == ["/odom", "/amcl_pose", "/scan"]
        assert synced(path, "_map")["frames"] == ["odom", "map"]
        assert drawn_in(path) == {"/odom": "odom", "/amcl_pose": "map", "/scan": None}
        (*_, last) = view.track.frames(30.0, 31.0)
        assert last.about["missing"] == {"/scan": "not drawn: no transform to odom"}
        placed = {one.number: one for one in unpack_layers(last.frame[64:])}
        told = player.recording.message_at("/amcl_pose", placed[1].seconds).message.pose.pose.position
        assert placed[1].pose[:2] == (told.x, told.y)
        player.close()

    @pytest.mark.slow
    def test_tf_draws_the_scan_where_the_robot_was(self, data: Path) -> None:
        player, view = self.track(data, "good/neato_fsm", "/odom", "/tf")
        names = [layer["name"] for layer in synced(view.widget, "_map")["layers"]]
        assert names == ["/odom", "/scan", "/stable_scan", "odom->base_link"]
        (*_, last) = view.track.frames(10.0, 11.0)
        assert "missing" not in last.about
        player.close()

    @pytest.mark.slow
    def test_fixes_are_metres_from_the_first_one(self, data: Path) -> None:
        player, view = self.track(data, "topics/car_gps", "/ins/nav_sat_fix")
        first = next(iter(player.recording.messages("/ins/nav_sat_fix"))).message
        (*_, last) = view.track.frames(60.0, 61.0)
        (place,) = unpack_layers(last.frame[64:])
        message = player.recording.message_at("/ins/nav_sat_fix", place.seconds).message
        east = radians(message.longitude - first.longitude) * 6_378_137 * cos(radians(first.latitude))
        assert place.pose.x == pytest.approx(east, rel=0.01, abs=0.05)
        assert abs(degrees(radians(message.latitude))) > 0
        player.close()


@pytest.fixture(scope="module")
def drive(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording of a robot with a map, tf, a localisation and a plan."""
    return recorded.write(tmp_path_factory.mktemp("map") / "drive", scene.TYPES, scene.messages(12.0))


def played(path: Path, *topics: str, **more: Any) -> Any:
    """The player of a recording, which opens the file itself."""
    with robowidgets.open(path) as recording:
        return recording.show(*topics, **more)


def map_of(player: Any) -> Any:
    (view,) = [view for view in player.views if isinstance(view.widget, PathWidget)]
    return view


def way_of(player: Any) -> Any:
    """The frame of the map, and the paths of its layers by their numbers."""
    whole = map_of(player).widget.whole_map
    return whole.frame, dict(whole.tracks())


class TestReadingOnlyPartsOfARecording:
    def test_a_receiver_that_has_no_fix_at_first_has_its_way_from_the_first_fix_on(self, tmp_path: Path) -> None:
        fixes = [fix(nan, nan, status=-1), *(fix(52.0 + i * 1e-5, 4.0) for i in range(10))]
        messages = [(float(i), "/fix", one) for i, one in enumerate(fixes)]
        player = played(recorded.write(tmp_path / "x", {"/fix": "sensor_msgs/msg/NavSatFix"}, messages), "/fix")
        frame, ways = way_of(player)
        assert frame == EAST_NORTH
        assert (ways[0][0, 0], ways[0][-1, 2]) == (1.0, pytest.approx(10.01, abs=0.01))
        player.close()

    def test_a_drive_that_begins_without_a_fix_is_on_show(self, data: Path) -> None:
        player = played(data / "reports/gps_cold_start/gps_nan.mcap", "/fix")
        frame, ways = way_of(player)
        assert (frame, ways[0][0, 0]) == (EAST_NORTH, pytest.approx(4.0))
        assert hypot(*ways[0][-1, 1:3]) == pytest.approx(72.5, abs=0.05)
        player.close()

    def test_a_frame_in_which_nothing_has_a_place_is_not_chosen(self, tmp_path: Path) -> None:
        types = {"/fix": "sensor_msgs/msg/NavSatFix", "/dvl": "geometry_msgs/msg/PoseStamped"}
        poses = [(i / 10, "/dvl", scene.plain(stamped("odom", float(i), 0.0, 0.0, i / 10))) for i in range(50)]
        player = played(recorded.write(tmp_path / "x", types, [(0.0, "/fix", fix(nan, nan, -1)), *poses]), *types)
        (frame, ways), view = way_of(player), map_of(player)
        assert (frame, ways[1][-1, 1]) == ("odom", 49.0)
        assert synced(view.widget, "_map")["frames"] == ["odom"]
        (*_, last) = view.track.frames(1.0, 2.0)
        assert last.about["missing"] == {"/fix": "not drawn: no message has a place"}
        player.close()

    def test_a_diver_is_on_show_in_the_frame_with_its_way(self, data: Path) -> None:
        player = played(data / "reports/map_chooses_empty_frame/diver.mcap", "/fix", "/dvl", "/depth")
        frame, ways = way_of(player)
        assert (frame, ways[1][-1, 1]) == ("odom", pytest.approx(49.5))
        player.close()

    def test_a_way_of_very_many_poses_goes_by_evenly_chosen_ones_to_its_end(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("robowidgets.path.frames.MOST_READ", 150)
        poses = [(i / 200, "/pose", scene.plain(stamped("world", i / 10, 0.0, 0.0, i / 200))) for i in range(1200)]
        path = recorded.write(tmp_path / "x", {"/pose": "geometry_msgs/msg/PoseStamped"}, poses)
        ways = []
        for _ in range(2):
            player = played(path, "/pose")
            ways.append(way_of(player)[1][0])
            (layer,) = synced(map_of(player).widget, "_map")["layers"]
            player.close()
        assert layer["note"] == "path from about 1 of 8 of 1,200 messages"
        assert ways[0].tobytes() == ways[1].tobytes()
        assert (ways[0][0, 1], ways[0][-1, 1]) == (0.0, 119.9)
        assert 200 < len(ways[0]) < 300
        assert np.diff(ways[0][:, 0]).max() < 0.5

    def test_transforms_of_a_very_long_drive_are_chosen_so_that_no_publisher_is_left_out(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        monkeypatch.setattr("robowidgets.path.frames.MOST_TRANSFORMS", 1000)
        frames = [("map", "odom"), ("odom", "base_link")]  # in turns
        tf = [(i / 50, "/tf", scene.plain(scene.tf(*frames[i % 2], (i / 100, 0.0, 0.0), i / 50))) for i in range(4000)]
        player = played(recorded.write(tmp_path / "x", {"/tf": scene.TYPES["/tf"]}, tf), "/tf")
        whole = map_of(player).widget.whole_map
        for name in ("odom", "base_link"):
            times = whole.tree.history(name).times_ns
            assert times[-1] - times[0] > 78e9
            assert np.diff(times).max() < 2e9
        assert whole.notes == ["transforms: about 1 of 4 of 4,000 messages"]
        player.close()

    def test_updates_of_a_grid_that_are_not_drawn_are_named(self, tmp_path: Path) -> None:
        types = {"/map": scene.TYPES["/map"], "/map_updates": "map_msgs/msg/OccupancyGridUpdate"}
        grid = scene.plain(scene.occupancy(MapGrid(np.zeros((20, 20), np.uint8), 0.05)))
        update = {"x": 1, "y": 2, "width": 1, "height": 1, "data": np.array([99], np.int8)}
        path = recorded.write(tmp_path / "x", types, [(0.0, "/map", grid), (1.0, "/map_updates", update)])
        player = played(path, "/map")
        (layer,) = synced(map_of(player).widget, "_map")["layers"]
        assert layer["note"] == "1 update on /map_updates not drawn"
        player.close()
        with robowidgets.open(path) as recording:
            assert "/map: 1 update on /map_updates change it, and a map does not draw them" in str(recording.doctor())


class TestPlayer:
    @pytest.mark.slow
    def test_topics_that_are_asked_for_are_on_one_map_with_scan_and_tf(self, drive: Path) -> None:
        player = played(drive, "/map", "/odom", "/amcl_pose", "/plan", "/particles", "/local_costmap")
        view = map_of(player)
        names = [layer["name"] for layer in synced(view.widget, "_map")["layers"]]
        assert names == ["/odom", "/map", "/amcl_pose", "/plan", "/particles", "/local_costmap", "/scan"]
        (*_, last) = view.track.frames(8.0, 9.0)
        placed = {names[one.number]: one for one in unpack_layers(last.frame[64:])}
        assert placed.keys() == set(names)
        assert ("missing" in last.about, last.about["frame_id"]) == (False, "map")
        assert placed["/map"].grid is None, "it is in the trait, once"
        assert placed["/local_costmap"].grid is not None
        assert placed["/local_costmap"].pose[:2] != (0.0, 0.0)
        player.close()

    @pytest.mark.slow
    def test_odometry_and_localisation_agree_where_tf_joins_them(self, drive: Path) -> None:
        player = played(drive, "/odom", "/amcl_pose")
        view = map_of(player)
        tracks = dict(view.widget._whole_tracks)
        seconds, x, y = tracks[1][-1][:3]
        assert [np.interp(seconds, tracks[0][:, 0], tracks[0][:, i]) for i in (1, 2)] == pytest.approx([x, y], abs=0.1)
        player.seek(6.0)
        wait_for(lambda: view.widget.pose is not None, "it shows a moment")
        assert {one.number for one in view.widget.pose.layers} == {0, 1, 2}
        player.close()

    def test_another_frame_may_be_chosen(self, drive: Path) -> None:
        player = played(drive, "/odom", "/amcl_pose")
        view = map_of(player)
        view.widget.frame = "odom"
        (track,) = [track for widget, track in player.tracks_of(player.recording) if widget is view.widget]
        (*_, last) = track.frames(8.0, 9.0)
        assert last.about["frame_id"] == "odom"
        at = player.recording.at("/odom", 8.99).sample.pose
        (odom,) = [one for one in unpack_layers(last.frame[64:]) if one.number == 0]
        assert odom.pose[:2] == at[:2]
        player.close()

    def test_a_moment_has_a_note_on_a_transform_that_is_old_by_then(self, tmp_path: Path) -> None:
        types = {"/tf": scene.TYPES["/tf"], "/goal": "geometry_msgs/msg/PoseStamped"}
        join = scene.plain(scene.tf("map", "odom", (1.0, 0.0, 0.0), 0.0))
        goals = [(float(t), "/goal", scene.plain(stamped("odom", 1.0, 0.0, 0.0, t))) for t in (1, 5, 45)]
        path = recorded.write(tmp_path / "held", types, [(0.0, "/tf", join), *goals])
        player = played(path, "/goal")
        view = map_of(player)
        view.widget.frame = "map"
        (track,) = [track for widget, track in player.tracks_of(player.recording) if widget is view.widget]
        notes = [timed.about.get("notes") for timed in track.frames(4.0, 50.0)]
        assert notes == [None, None, ["tf map → odom is 45 s old"]]
        player.close()

    def test_a_page_has_the_layers_of_its_stretch(self, drive: Path, tmp_path: Path) -> None:
        player = played(drive, "/map", "/odom", "/amcl_pose")
        within = map_of(player).widget.within(2.0, 4.0)
        assert within["_grids"] == synced(map_of(player).widget, "_grids"), "the map, which came before"
        assert 0 < len(within["_tracks"]) < len(synced(map_of(player).widget, "_tracks"))
        page = player.to_html(tmp_path / "map.html", start=2, end=4)
        assert page.stat().st_size < 1_500_000
        player.close()

    def test_a_map_that_is_sent_often_is_thinned_and_says_so(self, tmp_path: Path) -> None:
        grid = MapGrid(np.zeros((200, 200), np.uint8), 0.05)
        told = scene.plain(scene.occupancy(grid))
        often = ((0.5 * i, "/map", told) for i in range(50))
        path = recorded.write(tmp_path / "often", {"/map": scene.TYPES["/map"]}, often)
        player = played(path, "/map")
        (layer,) = synced(map_of(player).widget, "_map")["layers"]
        assert layer["note"] == "17 of 50 maps shown"
        player.close()

    @pytest.mark.slow
    def test_a_laser_without_odometry_takes_tf_for_its_trail(self, tmp_path: Path) -> None:
        said = [one for one in scene.messages(4.0) if one[1] in ("/scan", "/tf_static")]
        base = [(s, "/tf", scene.plain(scene.tf("odom", "base_link", (s, 2.0, 0.0), s))) for s in (0.0, 2.0, 4.0)]
        types = {name: scene.TYPES[name] for name in ("/scan", "/tf", "/tf_static")}
        path = recorded.write(tmp_path / "tf", types, sorted([*said, *base], key=lambda one: one[0]))
        player = played(path, "/scan", scanogram=False)
        (view,) = player.views
        view.widget.trail = 5
        (*_, last) = view.track.frames(2.0, 3.0)
        assert last.about["pose"] == [pytest.approx(last.seconds, abs=0.02), 2.0, 0.0]
        player.close()
