"""`SonarWidget` and `Ranges`: their Python interface, without a page."""

from __future__ import annotations

import logging
import pickle
from collections.abc import Iterator
from math import inf, isinf, isnan, nan, pi

import numpy as np
import pytest
from traitlets import TraitError

from robowidgets import LaserWidget, Range, Ranges, SonarWidget
from robowidgets.samples import Pose, age
from robowidgets.samples.staleness import LIVE
from robowidgets.widget import newest_sample

from ... import map_scene as scene
from ..forms import FORMS
from ..waiting import Clock, wait_for


def message(measured: object = 0.42, frame: str = "front", **changed: object) -> dict:
    limits = {"radiation_type": 0, "field_of_view": 0.5, "min_range": 0.1, "max_range": 5.0}
    header = {"stamp": {"sec": 5, "nanosec": 0}, "frame_id": frame}
    return {"header": header, **limits, "range": measured, **changed}


@pytest.fixture
def sonars() -> Iterator[SonarWidget]:
    widget = SonarWidget(title="sonars")
    yield widget
    widget.close()


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    for module in (age, newest_sample):
        monkeypatch.setattr(module, "time", made)
    return made


class TestRanges:
    def test_stand_in_the_order_of_their_numbers(self) -> None:
        ranges = Ranges({name: Range(1.0) for name in ("front_10", "rear", "front_2", "3", "a1", "a")})
        assert list(ranges) == ["3", "a", "a1", "front_2", "front_10", "rear"]
        assert len(ranges) == 6
        assert "rear" in ranges

    def test_name_the_existing_ones_if_one_is_missing(self) -> None:
        with pytest.raises(KeyError, match="no sensor 'fornt'; there are: front, left"):
            Ranges({"front": Range(1.0), "left": Range(2.0)})["fornt"]
        with pytest.raises(KeyError, match="no sensor 'front'; no sensor has sent anything yet"):
            Ranges({})["front"]

    @pytest.mark.parametrize(
        ("ranges", "nearest"),
        [
            ((1.5, 0.4, 2.0), "b"),
            ((1.5, 0.4, -inf), "c"),
            ((inf, nan, 7.0), None),
            ((inf, 0.0, 3.0), "c"),
            ((), None),
        ],
    )
    def test_name_the_nearest_by_what_counts_as_a_distance(self, ranges: tuple, nearest: str | None) -> None:
        readings = {name: Range(one, 0.1, 5.0) for name, one in zip("abc", ranges, strict=False)}
        assert Ranges(readings).nearest == nearest

    def test_are_as_old_as_the_newest_and_tell_by_how_much_others_are_older(self, clock: Clock) -> None:
        first = Range(1.0)
        clock.now += 2
        ranges = Ranges({"a": first, "b": Range(2.0, stamp_ns=7)}).expecting(["c"])
        clock.now += 1
        assert ranges.age == 1
        assert ranges.behind == {"a": 2.0, "b": 0.0, "c": inf}
        assert ranges.stamp_ns == 7
        assert isnan(ranges["c"].range)
        assert isinf(ranges["c"].age)

    def test_may_tell_times_of_another_clock(self) -> None:
        ranges = Ranges({"a": Range(1.0), "b": Range(2.0)}, {"a": 12.5, "b": 10.0})
        assert ranges.behind == {"a": 0.0, "b": 2.5}
        assert ranges.newest is ranges["a"]

    def test_are_read_only_and_survive_a_pickle(self) -> None:
        ranges = Ranges({"a": Range(1.0)})
        with pytest.raises(TypeError):
            ranges.readings["b"] = Range(2.0)  # type: ignore[index]
        copied = pickle.loads(pickle.dumps(ranges))
        assert copied == ranges
        assert (repr(copied), copied.times) == ("<Ranges of 1 sensor, nearest 1.00 m at a>", ranges.times)


class TestUpdate:
    @pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
    def test_takes_a_message_of_every_source_by_name(self, sonars: SonarWidget, form) -> None:
        sonars.update("left", form("sensor_msgs/Range", message()))
        assert sonars["left"] == Range(0.42, 0.1, 5.0, 0.5, "ultrasound", 5_000_000_000, "front")

    def test_takes_a_message_by_its_frame(self, sonars: SonarWidget) -> None:
        sonars.update(message(1.5, "rear_2"))
        assert list(sonars) == ["rear_2"]
        with pytest.raises(ValueError, match=r"needs the name of the sensor: .* it has no frame_id"):
            sonars.update(message(1.5, ""))

    @pytest.mark.parametrize("metres", [0.42, np.float32(0.42), 0.42 + 1e-9])
    def test_takes_plain_numbers(self, sonars: SonarWidget, metres: float) -> None:
        sonars.update("front", metres)
        assert sonars["front"].distance == 0.42

    def test_takes_many_at_once(self, sonars: SonarWidget) -> None:
        sonars.update(front=0.42, left=None)
        sonars.update({"right 1": Range(1.0), "front": 1})
        assert [(name, reading.range) for name, reading in sonars.ranges.items() if name != "left"] == [
            ("front", 1.0),
            ("right 1", 1.0),
        ]
        assert isnan(sonars["left"].distance)
        sonars.update(sensor=1.5, reading=2.5)
        assert (sonars["sensor"].range, sonars["reading"].range) == (1.5, 2.5), "any name may be the name of a sensor"

    def test_takes_all_ranges_of_a_moment_instead_of_its_own(self, sonars: SonarWidget) -> None:
        sonars.update("front", 0.42)
        ranges = Ranges({"a": Range(1.0)}, {"a": 3.0})
        sonars.update(ranges)
        assert sonars.ranges is ranges

    @pytest.mark.parametrize(
        ("given", "named", "error", "text"),
        [
            (
                (),
                {},
                TypeError,
                r'^update\(\) needs readings: update\("front", 0.42\), or update\(front=0.42, left=1.5\)',
            ),
            (("front",), {}, TypeError, r"^update\(\) needs the reading of 'front' too: update"),
            (("front", 1.0), {"left": 1.0}, TypeError, r"^update\(\) takes one reading, a mapping or readings by name"),
            (("front", 1.0, 2.0), {}, TypeError, r"^update\(\) takes one message, or numbers by name: .* got 2.0"),
            ((0.42,), {}, TypeError, r"^update\(\) takes the name of a sensor and its reading: .* got float"),
            ((0, 0.42), {}, TypeError, r"^update\(\) takes the name of a sensor first: .* got int"),
            (("front", "near"), {}, TypeError, r"^front: expected metres, a Range or a message .*, got 'near'"),
            (("front", True), {}, TypeError, r"^front: expected metres, a Range or a message .*, got True"),
            (("front", {"data": 1}), {}, TypeError, r"^front: expected a message like sensor_msgs/Range, .* keys data"),
            (({3: 1.0},), {}, TypeError, r"^3: expected the name of a sensor, got 3"),
            (
                ("cliff", message(inf, min_range=0.3, max_range=0.3)),
                {},
                ValueError,
                r"^cliff: max_range: .* for both; .* a touch widget shows it",
            ),
        ],
    )
    def test_refuses_what_is_not_a_reading(
        self, sonars: SonarWidget, given: tuple, named: dict, error: type[Exception], text: str
    ) -> None:
        with pytest.raises(error, match=text):
            sonars.update(*given, **named)

    def test_shows_the_others_if_one_is_wrong_and_keeps_its_error_until_it_is_right(self, sonars: SonarWidget) -> None:
        with pytest.raises(TypeError, match=r"^left: expected metres"):
            sonars.update({"front": 0.42, "left": "x", "right": 1.0})
        assert list(sonars) == ["front", "right"]
        with pytest.raises(TypeError, match=r"^rear: expected metres"):
            sonars.update("rear", "y")
        sonars.update("front", 0.5)
        error = sonars.get_state()["_about"]["error"]
        assert error.count("left: expected metres") == error.count("rear: expected metres") == 1
        sonars.update(left=1.0)
        assert "left:" not in sonars.get_state()["_about"]["error"]
        sonars.update(rear=1.0)
        assert "error" not in sonars.get_state()["_about"]

    def test_logs_in_a_callback(
        self, sonars: SonarWidget, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        monkeypatch.setattr("robowidgets.widget.robot_widget.called_from_cell", lambda: False)
        with caplog.at_level(logging.ERROR):
            sonars.update("front", "near")
        assert "SonarWidget sonars: a message could not be shown: front: expected metres" in caplog.text

    def test_refuses_endless_names(self, sonars: SonarWidget) -> None:
        sonars.update({f"s{i}": 1.0 for i in range(100)})
        with pytest.raises(ValueError, match=r"^s100: expected at most 100 sensors; reset\(\) forgets them"):
            sonars.update("s100", 1.0)
        sonars.reset()
        sonars.update("s100", 1.0)
        assert list(sonars) == ["s100"]


class TestShown:
    def test_hold_still_while_frozen_and_know_their_ages(self, sonars: SonarWidget, clock: Clock) -> None:
        sonars.update("front", Range(0.42, 0.1, 5.0, 0.5, "infrared", frame_id="ir", pose=Pose(0.1, 0.0, 1.5)))
        clock.now += 2
        sonars.update("left", 1.5)
        assert sonars.frozen is None
        sonars.paused = True
        clock.now += 1
        sonars.update(front=3.0, right=2.0)
        assert (
            sonars.frozen
            == sonars.ranges
            == {
                "front": Range(0.42, 0.1, 5.0, 0.5, "infrared", frame_id="ir", pose=Pose(0.1, 0.0, 1.5)),
                "left": Range(1.5),
            }
        )
        assert (sonars["front"].age, sonars["left"].age) == (3.0, 1.0)
        assert sonars.nearest == "front"
        sonars.paused = False
        assert sonars["front"].distance == 3.0
        assert sonars.nearest == "left"

    def test_sensors_with_a_place_are_there_before_they_measure(self, sonars: SonarWidget) -> None:
        sonars.poses = {"front": 0.0, "left": "90deg"}
        assert list(sonars) == ["front", "left"]
        assert isnan(sonars["left"].distance)
        assert sonars.nearest is None
        with pytest.raises(TimeoutError, match="had nothing to show"):
            sonars.wait(0)
        sonars.update("front", 0.42)
        assert sonars.wait(0)["front"].distance == 0.42
        sonars.reset()
        assert isinf(sonars["front"].age)

    def test_ranges_of_a_feed_are_expected_by_name(self, sonars: SonarWidget) -> None:
        sonars.update("sonar_1", 1.0)
        sonars.expect("sonar_0", "sonar_1")
        assert list(sonars) == ["sonar_0", "sonar_1"]
        assert sonars["sonar_1"].distance == 1.0

    def test_conditions_are_judged_on_all_of_them_once_one_has_come(self, sonars: SonarWidget) -> None:
        sonars.poses = {"front": 0.0, "left": "90deg"}
        wall = sonars.watch(lambda sonars: sonars["front"].distance < 0.5, name="wall")
        sonars.update("left", 0.2)
        sonars.update("front", 0.42)
        assert wall.wait(240)

    def test_a_condition_on_a_sensor_that_has_not_come_yet_is_unknown_says_so_and_goes_on(
        self, sonars: SonarWidget
    ) -> None:
        near = sonars.watch(lambda ring: ring["left"].distance < 0.3, name="near")
        sonars.update(front=0.42)
        wait_for(lambda: near.verdict.text == "no sensor 'left'; there are: front", "it is judged")
        assert (near.value, near.error) == (None, "")
        assert "unknown: no sensor 'left'; there are: front" in repr(near)
        sonars.update(left=0.2)
        assert near.wait(120)["left"].distance == pytest.approx(0.2)

    def test_the_repr_names_the_nearest(self, sonars: SonarWidget) -> None:
        assert repr(sonars) == "<SonarWidget sonars: nothing yet>"
        sonars.update(front=0.42, left=1.0)
        assert repr(sonars) == "<SonarWidget sonars: Ranges of 2 sensors, nearest 0.42 m at front>"

    def test_odd_numbers_are_reported_with_their_sensor(self, sonars: SonarWidget) -> None:
        sonars.update("front", message(field_of_view=30.0))
        assert [str(what) for what, _ in sonars.get_state()["_about"]["problems"]] == [
            "front: field_of_view is 30 rad: not used"
        ]

    def test_a_sensor_is_silent_after_three_of_its_own_periods(self, sonars: SonarWidget, clock: Clock) -> None:
        for i in range(40):
            sonars.update("fast", 1.0)
            if i % 10 == 0:
                sonars.update("slow", 1.0)
            clock.now += 0.1
        frame = sonars.get_state()["_frame"]
        count = int(np.frombuffer(frame, "<f8", 1, 32)[0])
        silences = np.frombuffer(frame, "<f4", offset=40).reshape(9, count)[2]
        assert dict(zip(sonars, silences.tolist(), strict=True)) == pytest.approx(
            {"fast": LIVE.after(0.1), "slow": LIVE.after(1.0)}, rel=1e-5
        )


class TestTraits:
    def test_places_are_poses_or_angles(self, sonars: SonarWidget) -> None:
        sonars.poses = {"a": (0.1, -0.2, "90deg"), "b": 0.5, "c": "-20deg", "d": [0, 0, np.float32(1)]}
        assert sonars.poses == {
            "a": (0.1, -0.2, pi / 2),
            "b": (0.0, 0.0, 0.5),
            "c": (0.0, 0.0, pytest.approx(-pi / 9)),
            "d": (0.0, 0.0, 1.0),
        }

    @pytest.mark.parametrize(
        ("given", "text"),
        [
            ({"poses": {"a": (1, 2)}}, r"^poses\['a'\]: expected \(x, y, yaw\) in metres and radians, or an angle"),
            ({"poses": {"a": None}}, r"^poses\['a'\]: expected \(x, y, yaw\) .*; got None"),
            ({"poses": {"a": (inf, 0, 0)}}, r"^poses\['a'\].x: expected a finite number of metres, got inf"),
            ({"poses": {"a": 90}}, r"^poses\['a'\]: expected radians within ±2 pi, got 90.0; math.radians"),
            ({"near": 0}, r"^near: expected metres above 0, 100,000 at most, or None, got 0.0"),
            ({"view_range": nan}, r"^view_range: expected metres above 0, .*, got nan"),
            ({"field_of_view": 0.0}, r"^field_of_view: expected radians above 0, up to 2 pi, got 0.0"),
            ({"field_of_view": "fast"}, r'^field_of_view: expected radians, or degrees as in "20deg", got \'fast\''),
        ],
    )
    def test_values_of_no_use_are_refused(self, given: dict, text: str) -> None:
        with pytest.raises(TraitError, match=text):
            SonarWidget(**given)

    @pytest.mark.parametrize(("given", "meant"), [("angles", "poses"), ("fov", "field_of_view"), ("limit", "near")])
    def test_what_people_call_them_is_understood(self, given: str, meant: str) -> None:
        with pytest.raises(TypeError, match=rf"has no keyword '{given}'; did you mean '{meant}'\?"):
            SonarWidget(**{given: 1})


def test_frames_of_a_player_stand_still(sonars: SonarWidget) -> None:
    about, frame = sonars.frame_of(Ranges({"a": Range(1.0, radiation="infrared", frame_id="ir")}))
    assert about == {"sensors": [["a", "infrared", "ir"]], "still": True}
    assert len(frame) == 8 + 9 * 4
    assert sonars.arrays_of(bytes(32) + frame) == (40, 9)
    assert sonars.arrays_of(bytes(32) + sonars.frame_of(Ranges({}))[1]) == (40, 0)


def test_an_array_is_one_sensor_for_each_of_its_numbers(sonars: SonarWidget) -> None:
    sonars.update("ir", {"layout": {"dim": [], "data_offset": 0}, "data": [0.3, None, inf]})
    assert list(sonars) == ["ir_0", "ir_1", "ir_2"]
    assert (sonars["ir_0"].distance, sonars["ir_2"].distance) == (0.3, inf)
    sonars.update({"us": np.array([1.0, 2.0], np.float32)})
    assert sonars["us_1"].distance == 2.0
    with pytest.raises(
        TypeError, match=r"ir_0: expected metres, a Range or a message like sensor_msgs/Range, got 'far'"
    ):
        sonars.update("ir", ["far"])


def test_sensors_are_placed_by_tf_and_the_users_table_comes_first(sonars: SonarWidget) -> None:
    sonars.update("front", message(frame="sonar_front"))
    sonars.update("left", message(frame="sonar_left"))
    sonars.poses = {"left": "90deg"}
    half = 0.5**0.5
    turn = {"x": 0.0, "y": 0.0, "z": -half, "w": half}
    placed = [
        {
            "header": {"frame_id": "base_link", "stamp": {"sec": 1, "nanosec": 0}},
            "child_frame_id": frame,
            "transform": {"translation": {"x": 0.2, "y": 0.0, "z": 0.1}, "rotation": turn},
        }
        for frame in ("sonar_front", "sonar_left")
    ]
    sonars.take_frames({"transforms": placed})
    sonars.send_newest()
    frame = sonars.get_state()["_frame"]
    rows = np.frombuffer(frame, "<f4", offset=len(frame) - 9 * 2 * 4).reshape(9, 2)
    assert rows[6:, 0] == pytest.approx([0.2, 0.0, -pi / 2])
    # The page uses the table before the reading.
    assert sonars.get_state()["poses"]["left"][2] == pytest.approx(pi / 2)


@pytest.mark.parametrize("wrong", [nan, None])
def test_a_transform_without_a_pose_does_not_move_other_sonars(sonars: SonarWidget, wrong: float | None) -> None:
    sonars.take_frames(
        scene.tf_of_rosbridge(("base_link", "front", 0.2), ("base_link", "wheel", wrong), ("base_link", "left", 0.1))
    )
    assert sonars._mounts == {"front": (0.2, 0.0, 0.0), "left": (0.1, 0.0, 0.0)}


def test_a_laser_names_the_ring_whose_cones_it_shows(sonars: SonarWidget) -> None:
    laser = LaserWidget()
    laser.sonars = sonars
    assert laser.get_state()["_sonar_of"] == sonars.model_id
    laser.sonars = None
    assert laser.get_state()["_sonar_of"] == ""
    with pytest.raises(TypeError, match="sonars: expected a SonarWidget or None, got 3"):
        laser.sonars = 3
    laser.close()
