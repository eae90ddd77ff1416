"""Scanners that are mounted turned or upside down: by tf or by hand, all angles are the robot's."""

from __future__ import annotations

import pickle
from math import cos, degrees, inf, pi, radians, sin
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets import Footprint, LaserWidget, Mount, Scan, Sector
from robowidgets.messages.standard import scan_message
from robowidgets.poses.frame_tree import FrameTree
from robowidgets.poses.live_mounts import LiveMounts
from robowidgets.poses.mounts import mount_of, robot_frame, scanner_mount
from robowidgets.poses.transforms import Transform
from robowidgets.samples.sector import SECTORS

RAYS = 360
LEFT = Mount(pi / 2)
HANGING = Mount(0.0, upside_down=True)
TURNED_AND_HANGING = Mount(radians(-120), upside_down=True)


def turn_of(yaw: float, roll: float = 0.0, pitch: float = 0.0) -> tuple[float, float, float, float]:
    """The quaternion x, y, z, w of a frame that is turned about its x, then y, then z of the outer frame."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(half), sin(half)) for half in (roll / 2, pitch / 2, yaw / 2))
    return (
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
        cr * cp * cy + sr * sp * sy,
    )


def transform(child: str, *turn: float, parent: str = "base_link", static: bool = True, time_ns: int = 0) -> Transform:
    return Transform(parent, child, time_ns, time_ns, (0.1, 0.0, 0.2, *turn_of(*turn)), static)


def tf(child: str, *turn: float, parent: str = "base_link") -> dict[str, Any]:
    x, y, z, w = turn_of(*turn)
    pose = {"translation": {"x": 0.1, "y": 0.0, "z": 0.0}, "rotation": {"x": x, "y": y, "z": z, "w": w}}
    return {"transforms": [{"header": {"frame_id": parent}, "child_frame_id": child, "transform": pose}]}


def own_scan(mount: Mount, wall: float = 0.75, at: float = 0.0, **more: Any) -> Scan:
    """The measurement of a scanner with a mount: a wall 40 degrees wide, at an angle of the robot in degrees."""
    own = -pi + np.arange(RAYS) * radians(1)
    robot = np.array([mount.to_robot(angle) for angle in own])
    is_wall = np.abs((robot - radians(at) + pi) % (2 * pi) - pi) <= radians(20)
    ranges = np.where(is_wall, wall, inf)
    return Scan(ranges, -pi, radians(1), 0.1, 12.0, frame_id="laser", **more)


def message(scan: Scan) -> Any:
    """The plain message with a scan's own angles."""
    return SimpleNamespace(**scan_message(scan, 0, "")[1])


class TestScan:
    @pytest.mark.parametrize("mount", [LEFT, HANGING, TURNED_AND_HANGING, Mount(pi), Mount(-2.0)])
    def test_all_angles_are_the_robots_and_indices_and_ranges_stay(self, mount: Mount) -> None:
        own = own_scan(mount)
        scan = own.mounted(mount)
        assert {name: scan.distance(name) for name in SECTORS} == {
            "front": 0.75,
            "left": inf,
            "back": inf,
            "right": inf,
        }
        assert scan.at(0).range == 0.75
        assert abs(scan.nearest("front").angle) <= radians(20.5)
        assert (scan.ranges == own.ranges).all()
        ahead_left = own[scan.at("10deg").index].angle
        assert cos(ahead_left - mount.to_scanner(radians(10))) == pytest.approx(1, abs=1e-3)
        assert np.abs(scan.angles).max() <= 2 * pi + 1e-6

    def test_left_of_a_scanner_on_its_head_is_its_right(self) -> None:
        scan = own_scan(HANGING, at=90.0)
        assert scan.distance("right") == 0.75
        assert scan.mounted(HANGING).distance("left") == 0.75

    @pytest.mark.parametrize("mount", [LEFT, TURNED_AND_HANGING, Mount(pi, turns=0)])
    def test_the_scanners_own_angles_come_back(self, mount: Mount) -> None:
        for first in (-pi, 0.0, -2.0):
            own = Scan([1.0] * 100, first, radians(3.6), 0.1, 9.0, stamp_ns=7, frame_id="laser")
            again = own.mounted(mount).unmounted()
            assert again.angle_min == pytest.approx(first, abs=1e-12)
            assert again.angle_increment == own.angle_increment
            assert again.mount is None
            assert own.mounted(mount).mounted(LEFT).unmounted().angle_min == pytest.approx(first, abs=1e-12)

    def test_a_mount_that_turns_nothing_leaves_the_scan_as_it_is(self) -> None:
        own = own_scan(Mount())
        assert own.mounted(Mount(1e-5)) is own
        assert own.mounted(None) is own

    def test_the_mount_stays_in_the_next_scan_in_an_echo_and_in_a_pickle(self) -> None:
        scan = own_scan(LEFT).mounted(LEFT)
        for other in (scan.again(scan.ranges, None, None), scan.echo("last"), pickle.loads(pickle.dumps(scan))):
            assert other.mount == LEFT
            assert other.distance("front") == 0.75

    def test_a_tilted_scanner_is_reported_and_one_that_stands_on_edge_keeps_its_angles(self) -> None:
        tilted = own_scan(Mount()).mounted(mount_of(*turn_of(pi / 2, pitch=radians(20))))
        assert [str(problem) for problem in tilted.problems()] == [
            "the scanner is tilted by 20° by tf: distances are along its rays, not on the floor; a map or a cloud "
            "shows where its rays go; if it is not tilted, correct tf"
        ]
        assert tilted.angle_min == pytest.approx(-pi / 2)
        on_edge = own_scan(Mount()).mounted(mount_of(*turn_of(0.3, roll=pi / 2)))
        assert on_edge.angle_min == -pi
        assert "its own angles are shown" in str(on_edge.problems()[0])
        assert on_edge.unmounted().problems() == ()

    def test_words(self) -> None:
        assert LEFT.words == "turned 90.0° by tf"
        assert HANGING.words == "upside down by tf"
        assert Mount.by_hand("-120deg", upside_down=True).words == "upside down and turned -120.0° by hand"
        assert Mount().words == ""

    def test_wrong_numbers_are_named(self) -> None:
        with pytest.raises(ValueError, match=r"yaw: expected radians within ±2 pi, got 90"):
            Mount.by_hand(90)
        with pytest.raises(TypeError, match="upside_down: expected True or False, got 1"):
            Mount.by_hand(0.0, upside_down=1)  # type: ignore[arg-type]


class TestTransforms:
    @pytest.mark.parametrize(
        ("turn", "yaw", "upside_down"),
        [((pi / 2,), 90, False), ((0.0, pi), 0, True), ((0.0, 0.0, pi), 180, True), ((1.0, pi), degrees(1), True)],
    )
    def test_a_quaternion_is_a_turn_on_the_floor_and_a_side_that_is_up(
        self, turn: tuple[float, ...], yaw: float, upside_down: bool
    ) -> None:
        found = mount_of(*turn_of(*turn))
        assert abs(degrees(found.yaw)) == pytest.approx(yaw, abs=1e-6)
        assert found.upside_down is upside_down
        assert found.tilt == pytest.approx(0, abs=1e-6)

    def test_the_frame_of_the_robot_is_found_by_its_name_else_below_odometry(self) -> None:
        tree = FrameTree([
            transform("base_link", 0.0, parent="base_footprint"),
            transform("laser", 1.0),
            transform("two/laser", 1.0, parent="two/base_link"),
            transform("body", 0.0, parent="odom"),
            transform("lidar", 1.0, parent="body"),
            transform("alone", 1.0, parent="map"),
        ])  # fmt: skip
        found = [robot_frame(tree, frame) for frame in ("laser", "two/laser", "lidar", "alone", "nowhere", "base_link")]
        assert found == ["base_link", "two/base_link", "body", "", "", "base_footprint"]

    def test_the_base_itself_and_scanners_that_no_transform_names(self) -> None:
        tree = FrameTree([transform("laser", 1.0)])
        assert scanner_mount(tree, "base_link") == Mount()
        assert scanner_mount(tree, "other") is None
        assert scanner_mount(tree, "") is None
        assert scanner_mount(tree, "/laser").yaw == pytest.approx(1.0)

    def test_turns_add_up_along_the_chain(self) -> None:
        tree = FrameTree([transform("plate", pi / 2), transform("laser", pi / 2, pi, parent="plate")])
        found = scanner_mount(tree, "laser")
        assert (degrees(found.yaw) % 360, found.upside_down) == (pytest.approx(180), True)

    def test_a_live_mount_may_move_and_one_by_hand_comes_first(self) -> None:
        mounts = LiveMounts()
        scan = own_scan(LEFT)
        assert mounts.mounted(scan) is scan
        mounts.take(tf("laser", 1.0), static=False)
        assert not mounts.is_fixed("laser")
        assert mounts.of("laser").yaw == pytest.approx(1.0)
        mounts.take(tf("laser", pi / 2), static=True)
        assert mounts.is_fixed("laser")
        assert mounts.mounted(scan).distance("front") == 0.75
        mounts.take(tf("laser", -pi / 2), static=True)
        assert mounts.mounted(scan).distance("back") == 0.75
        mounts.put("/laser", Mount.by_hand("90deg"))
        assert mounts.mounted(mounts.mounted(scan)).mount.by == "hand"
        mounts.put("laser", None)
        assert mounts.of("laser").by == "tf"


def evaluate(code: str, msg: Any) -> float:
    names: dict[str, Any] = {"msg": msg}
    *before, last = code.strip().splitlines()
    exec("\n".join(before), names)
    return float(eval(last, names))


class TestCode:
    @pytest.mark.parametrize("mount", [None, LEFT, HANGING, TURNED_AND_HANGING])
    @pytest.mark.parametrize("offset", [0.0, 0.5])
    def test_copied_code_gives_of_the_plain_message_what_the_picture_shows(
        self, mount: Mount | None, offset: float
    ) -> None:
        ranges = 1 + np.arange(RAYS) / RAYS
        own = Scan(ranges, -pi, radians(1), 0.1, 12.0, frame_id="laser")
        laser = LaserWidget(angle_offset=offset)
        laser.update(own.mounted(mount))
        for sector in (*SECTORS, Sector("10deg", "20deg"), Sector("170deg", "-170deg"), Sector("-20deg", "-10deg")):
            code = laser.code(sector, "message")
            assert evaluate(code, message(own)) == pytest.approx(laser.distance(sector)), code
        assert ("scanner turned 90.0° by tf" in laser.code("front", "message")) is (mount == LEFT)
        laser.close()


class TestWidget:
    def test_the_page_gets_angles_of_the_robot_and_the_mount_and_a_frozen_scan_keeps_it(self) -> None:
        laser = LaserWidget()
        laser.take_mounts(lambda scan: scan.mounted(LEFT))
        laser.update(message(own_scan(LEFT)))
        assert laser.get_state()["_about"]["mount"] == {"yaw": pi / 2, "words": "turned 90.0° by tf"}
        laser.paused = True
        assert laser.frozen.mount == LEFT
        assert laser.frozen.distance("front") == 0.75
        assert laser.own_angles is False
        laser.close()

    def test_without_a_turn_there_is_no_note(self) -> None:
        laser = LaserWidget()
        laser.take_mounts(lambda scan: scan.mounted(Mount()))
        laser.update(message(own_scan(Mount())))
        assert "mount" not in laser.get_state()["_about"]
        laser.close()

    def test_a_yaw_by_hand_on_the_footprint_comes_before_tf_and_turns_the_scan_on_show(self) -> None:
        laser = LaserWidget()
        laser.take_mounts(lambda scan: scan if scan.mount else scan.mounted(Mount(-1.0)))
        laser.update(message(own_scan(TURNED_AND_HANGING)))
        assert laser.distance("front") == inf
        laser.footprint = Footprint(radius=0.2, scanner=(0.1, 0.0, "-120deg"), upside_down=True)
        assert laser.distance("front") == 0.75
        assert laser.scan.mount.words == "upside down and turned -120.0° by hand"
        laser.footprint = Footprint(radius=0.2, scanner=(0.1, 0.0))
        assert laser.scan.mount == Mount(-1.0)
        laser.close()

    def test_upside_down_needs_a_yaw(self) -> None:
        with pytest.raises(ValueError, match=r"upside_down: expected a scanner with a yaw, \(x, y, yaw\), got"):
            Footprint(radius=0.2, upside_down=True)
