"""`LaserWidget`: its Python interface, without a page."""

from __future__ import annotations

import logging
import threading
from array import array
from collections.abc import Iterator
from math import inf, nan, pi, radians

import numpy as np
import pandas as pd
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import LaserWidget, Scan, Validity
from robowidgets.widget.pacer import pacer
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..pages import Page, get_newest, parse_sample

GEOMETRY = {"angle_min": -0.5, "angle_increment": 0.5, "range_min": 0.1, "range_max": 30.0}
STAMP = 1_700_000_000_000_000_001
MESSAGE = {"ranges": [1.0, 2.0, 3.0], **GEOMETRY}
INCREMENT = r"\(missing: angle_increment\); angle_increment = \(angle_max - angle_min\) / \(len\(ranges\) - 1\)$"


@pytest.fixture
def laser() -> Iterator[LaserWidget]:
    widget = LaserWidget(title="/scan")
    yield widget
    widget.close()


@pytest.fixture
def page(laser: LaserWidget) -> Page:
    return Page(laser)


def shown(laser: LaserWidget, frame: bytes) -> Scan:
    """The scan in a frame, as the page would read it."""
    return parse_sample(laser, frame)


def same(a: Scan, b: Scan) -> bool:
    return (
        np.array_equal(a.ranges, b.ranges, equal_nan=True)
        and np.array_equal(a.intensities, b.intensities, equal_nan=True)
        and all(
            getattr(a, name) == getattr(b, name)
            for name in ("angle_min", "angle_increment", "range_min", "range_max", "stamp_ns", "frame_id")
        )
    )


class TestSettings:
    @pytest.mark.parametrize(
        ("name", "value", "text"),
        [
            ("arc_count", -1, "The value of the 'arc_count' trait of a LaserWidget instance should not be less than 0"),
            ("arc_count", 51, "'arc_count' trait of a LaserWidget instance should not be greater than 50"),
            ("arc_count", 10**400, "should not be greater than 50"),
            ("arc_count", 2.5, "The 'arc_count' trait of a LaserWidget instance expected an int, not the float 2.5."),
            ("arc_count", "4", "expected an int, not the str '4'."),
            ("ray_angles", "20deg", 'ray_angles: expected up to 360 angles, in radians or as text like "20deg"; got'),
            ("ray_angles", [0.1] * 361, "; got 361"),
            ("ray_angles", [0, 20], "ray_angles[1]: expected radians within ±2 pi, got 20.0; math.radians"),
            ("ray_angles", [nan], "ray_angles[0]: expected a finite number of radians, got nan"),
            ("ray_count", -1, "'ray_count' trait of a LaserWidget instance should not be less than 0"),
            ("ray_count", 361, "'ray_count' trait of a LaserWidget instance should not be greater than 360"),
            ("ray_count", nan, "expected an int, not the float nan."),
            ("forward", "north", "expected any of ['up', 'left', 'down', 'right'], not the str 'north'."),
            ("color_by_intensity", "yes", "expected a boolean, not the str 'yes'."),
            ("paused", 1.5, "expected a boolean, not the float 1.5."),
            ("title", 5, "expected a unicode string, not the int 5."),
            ("hovered", -1, "'hovered' trait of a LaserWidget instance should not be less than 0"),
            ("hovered", 0.5, "expected an int, not the float 0.5."),
            ("pinned", -1, "'pinned' trait of a LaserWidget instance should not be less than 0"),
            ("pinned", 10**30, "'pinned' trait of a LaserWidget instance should not be greater than 1000000"),
            ("pinned", "3", "expected an int, not the str '3'."),
            ("angle_offset", "1", "expected radians, or degrees as in \"20deg\", got '1'"),
        ],
    )
    def test_a_bad_value_is_named_with_what_was_expected(
        self, laser: LaserWidget, name: str, value: object, text: str
    ) -> None:
        before = getattr(laser, name)
        with pytest.raises(TraitError) as refusal:
            setattr(laser, name, value)
        assert text in str(refusal.value)
        assert getattr(laser, name) == before
        with pytest.raises(TraitError):
            LaserWidget(**{name: value})

    @pytest.mark.parametrize(
        ("value", "came"),
        [
            (0, "the int 0"),
            (-2.0, "the float -2.0"),
            (nan, "the float nan"),
            (inf, "the float inf"),
            (100_001, "the int 100001"),
            (True, "the bool True"),
            ("fit", "the str 'fit'"),
            ("5", "the str '5'"),
            (None, "the NoneType None"),
            (np.complex128(1), "the complex128"),
            (10**400, "the int 1000"),
        ],
    )
    def test_a_view_range_is_a_word_or_metres(self, laser: LaserWidget, value: object, came: str) -> None:
        with pytest.raises(TraitError) as refusal:
            laser.view_range = value
        assert str(refusal.value).startswith(
            "The 'view_range' trait of a LaserWidget instance expected "
            '"sensor" (range_max), "data" (fit to the readings), "auto" (one of them), or metres above 0, '
            f"100,000 at most, not {came}"
        )
        assert laser.view_range == "sensor"

    @pytest.mark.parametrize("value", ["data", "sensor", "auto", 4, 2.5, np.float32(2.5), np.int64(7), 1e-3, 100_000])
    def test_good_view_ranges_are_taken(self, laser: LaserWidget, page: Page, value: object) -> None:
        laser.view_range = 12.0
        laser.view_range = value
        pacer.flush()
        assert laser.view_range == page.state["view_range"] == value
        assert type(laser.view_range) is (str if isinstance(value, str) else float)

    @pytest.mark.parametrize(
        ("value", "came"),
        [
            (3.0, "the float 3.0"),
            (None, "the NoneType None"),
            ("123", "the str '123'"),
            (["1", "2"], "the list ['1', '2']"),
            ([1.0, 0.0], "the list [1.0, 0.0]"),
            ([1.0, -2.0], "the list [1.0, -2.0]"),
            ([nan], "the list [nan]"),
            ([inf], "the list [inf]"),
            ([1e6], "the list [1000000.0]"),
            ([True], "the list [True]"),
            ([[1.0, 2.0]], "the list [[1.0, 2.0]]"),
            ([10**400], "the list [1000"),
            (range(1, 52), "the range range(1, 52)"),
        ],
    )
    def test_arc_distances_are_metres_above_0(self, laser: LaserWidget, value: object, came: str) -> None:
        laser.arc_distances = [1.0]
        with pytest.raises(TraitError) as refusal:
            laser.arc_distances = value
        assert str(refusal.value).startswith(
            "The 'arc_distances' trait of a LaserWidget instance expected up to 50 distances in metres above 0, "
            f"100,000 at most, not {came}"
        )
        assert laser.arc_distances == (1.0,)

    @pytest.mark.parametrize("value", [[], (0.5, 2), np.array([1, 2.5], np.float32), range(1, 51), (v for v in [4.0])])
    def test_good_arc_distances_are_taken(self, laser: LaserWidget, page: Page, value: object) -> None:
        expected = (4.0,) if not hasattr(value, "__len__") else tuple(float(v) for v in value)
        laser.arc_distances = [9.0]
        laser.arc_distances = value
        pacer.flush()
        assert laser.arc_distances == tuple(page.state["arc_distances"]) == expected

    def test_angles_of_rays_may_be_in_degrees(self, laser: LaserWidget, page: Page) -> None:
        laser.ray_angles = ("-90deg", 0, np.float32(0.5))
        pacer.flush()
        assert laser.ray_angles == tuple(page.state["ray_angles"]) == (-np.pi / 2, 0.0, 0.5)

    def test_marks_belong_to_the_classes_without_a_reading(self, laser: LaserWidget) -> None:
        assert laser.marks == ["too_close", "nothing_in_range", "no_measurement", "outside_limits"]
        laser.marks = ["too_close"]
        with pytest.raises(TraitError, match="'too_close', 'nothing_in_range', 'no_measurement', 'outside_limits'"):
            laser.marks = ["reading"]
        assert laser.marks == ["too_close"]

    def test_settings_reach_the_page_while_it_runs(self, laser: LaserWidget, page: Page) -> None:
        laser.update(MESSAGE)
        for name, value in {"arc_count": 7, "ray_count": 0, "forward": "left", "marks": [], "pinned": 2}.items():
            setattr(laser, name, value)
            pacer.flush()
            assert page.state[name] == value

    def test_the_page_sends_the_actions_of_the_user(self, laser: LaserWidget, page: Page) -> None:
        laser.set_state({"hovered": 5, "pinned": 7, "view_range": 2.5})
        assert (laser.hovered, laser.pinned, laser.view_range) == (5, 7, 2.5)
        laser.set_state({"hovered": None, "pinned": None})
        assert (laser.hovered, laser.pinned) == (None, None)
        assert page.sent("hovered") == [], "the page needs no echo of its pointer"

    def test_a_ray_can_be_pinned_and_let_go(self, laser: LaserWidget, page: Page) -> None:
        for index in (2, None):
            laser.pinned = index
            pacer.flush()
        assert page.sent("pinned") == [2, None]

    def test_an_unknown_setting_is_refused_by_name(self, laser: LaserWidget) -> None:
        with pytest.raises(
            AttributeError, match=r"^LaserWidget has no trait 'arcs_count'; did you mean 'arc_count'\? It "
        ):
            laser.arcs_count = 3
        with pytest.raises(
            TypeError,
            match=r"^LaserWidget\(\) has no keyword 'radius'\. It takes: angle_offset, angle_unit, ",
        ):
            LaserWidget(radius=3)

    @pytest.mark.parametrize(("word", "meant"), [("arcs", "arc_count"), ("rays", "ray_count"), ("freeze", "paused")])
    def test_what_people_call_a_setting_leads_to_its_name(self, word: str, meant: str) -> None:
        with pytest.raises(TypeError, match=rf"^LaserWidget\(\) has no keyword '{word}'; did you mean '{meant}'\?"):
            LaserWidget(**{word: 3})

    def test_several_arguments_are_refused_with_the_call_that_works(self, laser: LaserWidget) -> None:
        with pytest.raises(
            TypeError, match=r"^update\(\) takes one message, or numbers by name: update\(ranges=\.\.\., "
        ):
            laser.update([1.0, 2.0], -0.5, 0.5)

    def test_the_scan_on_show_is_not_set(self, laser: LaserWidget) -> None:
        with pytest.raises(AttributeError):
            laser.scan = Scan(**MESSAGE)


def test_a_widget_prints_the_scan_on_show(laser: LaserWidget) -> None:
    laser.title = "/scan"
    laser.update(MESSAGE)
    shown = repr(laser)
    assert shown == f"<LaserWidget /scan: {repr(laser.scan)[1:-1]}>"
    assert shown.startswith("<LaserWidget /scan: Scan of ")
    laser.paused = True
    laser.update({**MESSAGE, "ranges": []})
    assert repr(laser) == shown.replace(": ", ": frozen, ", 1)


class TestUpdate:
    def test_a_message_a_dictionary_and_fields_are_one(self, laser: LaserWidget) -> None:
        scan = Scan(**MESSAGE)
        laser.update(scan)
        assert laser.scan is scan
        laser.update(MESSAGE)
        assert same(laser.scan, scan)
        laser.update(**MESSAGE)
        assert same(laser.scan, scan)

    @pytest.mark.parametrize(
        ("given", "fields", "text"),
        [
            ((), {}, r"^update\(\) needs a message, or: ranges, angle_min, angle_max, angle_increment, "),
            ((None,), {}, r"^update\(\) needs a message, or: ranges, "),
            (
                (MESSAGE,),
                {"ranges": [1.0], "range_max": 3.0},
                r"^update\(\) takes a message or fields, not both; got a message and ranges, range_max$",
            ),
            ((), {**MESSAGE, "rangs": []}, r"^update\(\) has no field 'rangs'; did you mean 'ranges'\? It takes a m"),
            (
                (),
                {"range": []},
                r"^update\(\) has no field 'range'; did you mean 'ranges'\? It takes a message, or: ranges, ",
            ),
            (
                (),
                {"angle_inc": 0.1},
                r"^update\(\) has no field 'angle_inc'; did you mean 'angle_increment'\? It takes",
            ),
            (
                (),
                {"range": [], "angle_mn": 0.1},
                r"'range', 'angle_mn'; did you mean 'ranges', 'angle_min'\? It takes",
            ),
            ((), {"xyz": []}, r"^update\(\) has no field 'xyz'; it takes a message, or: ranges, angle_min, "),
            (
                ([1.0, 2.0],),
                {},
                r"^update\(\) got a list without the scanner's geometry; plain numbers go by name: update\(ranges=",
            ),
            ((np.ones(3),), {}, r"^update\(\) got a ndarray without the scanner's geometry"),
            ((np.ma.ones(3),), {}, r"^update\(\) got a MaskedArray without the scanner's geometry"),
            ((pd.Series([1.0, 2.0]),), {}, r"^update\(\) got a Series without the scanner's geometry"),
            ((pd.DataFrame({"a": [1.0]}),), {}, r"^update\(\) got a DataFrame without the scanner's geometry"),
            ((array("f", [1.0]),), {}, r"^update\(\) got a array without the scanner's geometry"),
            ((), {k: MESSAGE[k] for k in MESSAGE if k != "angle_increment"} | {"angle_max": 0.5}, INCREMENT),
            ((), {"ranges": [1.0, 2.0]}, r"\(missing: angle_min, angle_increment, range_min, range_max\)$"),
            (("scan",), {}, r"^expected a message like sensor_msgs/LaserScan, with ranges, .*; got a str"),
            ((), {**MESSAGE, "angle_min": 10**400}, r"^angle_min: expected a number, got 1000"),
        ],
    )
    def test_what_is_not_a_scan_is_refused(self, laser: LaserWidget, given: tuple, fields: dict, text: str) -> None:
        with pytest.raises(TypeError, match=text):
            laser.update(*given, **fields)
        assert laser.scan is None

    def test_a_moment_of_a_recording_is_taken(self, laser: LaserWidget) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            moment = next(recording.samples("/scan"))
        laser.update(moment)
        assert laser.scan is moment.sample

    def test_a_row_of_a_table_is_taken(self, laser: LaserWidget) -> None:
        laser.update(pd.DataFrame([MESSAGE]).iloc[0])
        assert laser.scan.ranges.tolist() == [1.0, 2.0, 3.0]

    def test_a_name_that_no_field_has_is_refused_though_a_message_had_it(self, laser: LaserWidget) -> None:
        laser.update({**MESSAGE, "rangez": 0})
        with pytest.raises(TypeError, match=r"^update\(\) has no field 'rangez'"):
            laser.update(**MESSAGE, rangez=0)

    @pytest.mark.parametrize(
        ("changed", "text"),
        [
            ({"range_min": 30.0, "range_max": 0.1}, r"^range_max: .* got 0.1; are the two swapped\?$"),
            ({"range_max": nan}, r"^range_max: expected a finite number of metres, got nan$"),
            ({"angle_increment": 0.0}, r"^angle_increment: expected a finite step in radians other than 0 for 3 rays"),
            ({"ranges": np.ones((2, 3))}, r"^ranges: expected a one-dimensional array, got shape \(2, 3\)$"),
            ({"ranges": np.ones(1_000_001)}, r"^ranges: expected at most 1,000,000 rays, got 1,000,001$"),
        ],
    )
    def test_numbers_that_cannot_be_shown_are_refused_and_the_last_good_scan_stays(
        self, laser: LaserWidget, page: Page, changed: dict, text: str
    ) -> None:
        laser.update(MESSAGE)
        with pytest.raises(ValueError, match=text) as refusal:
            laser.update(MESSAGE | changed)
        pacer.flush()
        assert laser.scan.ranges.tolist() == [1.0, 2.0, 3.0]
        assert shown(laser, page.state["_frame"]).ranges.tolist() == [1.0, 2.0, 3.0]
        assert page.state["_about"]["error"].rstrip(".") == str(refusal.value)
        laser.update(MESSAGE)
        pacer.flush()
        assert "error" not in page.state["_about"]

    def test_in_a_callback_nothing_is_raised(
        self, laser: LaserWidget, page: Page, caplog: pytest.LogCaptureFixture
    ) -> None:
        laser.update(MESSAGE)
        thread = threading.Thread(target=laser.update, args=("nonsense",))
        thread.start()
        thread.join()
        pacer.flush()
        assert page.state["_about"]["error"].startswith("expected a message like sensor_msgs/LaserScan")
        assert [record.levelno for record in caplog.records] == [logging.ERROR]
        assert laser.scan.ranges.tolist() == [1.0, 2.0, 3.0]

    def test_what_was_odd_is_reported(self, laser: LaserWidget, page: Page) -> None:
        laser.update(**MESSAGE, intensities=[1.0], header={"frame_id": "base_laser"})
        pacer.flush()
        assert page.state["_about"] == {
            "frame_id": "base_laser",
            "problems": (("1 intensities for 3 rays: not used", "the driver should send one for each, or none"),),
        }

    def test_a_rate_that_falls_below_half_is_reported_and_goes_when_it_recovers(
        self, laser: LaserWidget, page: Page
    ) -> None:
        get_newest(laser).meter._rates.extend([10.0] * 20 + [4.0] * 3)
        laser.update(**MESSAGE)
        pacer.flush()
        ((what, remedy),) = page.state["_about"]["problems"]
        assert what == "scans come at less than half of their usual 10 Hz"
        assert remedy.startswith("is the network slow")
        get_newest(laser).meter._rates.append(9.0)
        laser.update(**MESSAGE)
        pacer.flush()
        assert "problems" not in page.state["_about"]

    def test_why_there_is_no_reading_is_apart_and_a_frozen_scan_has_the_same_problems(
        self, laser: LaserWidget, page: Page
    ) -> None:
        laser.update(**MESSAGE | {"ranges": [nan, nan, nan]}, scan_time=-1.0)
        pacer.flush()
        assert page.state["_about"]["empty"][0] == "no readings: all 3 rays say NaN, no measurement"
        assert [what for what, _ in page.state["_about"]["problems"]] == ["scan_time is -1 s: not used"]
        live = laser.scan.problems()
        laser.paused = True
        assert laser.scan.problems() == live
        assert len(live) == 2

    def test_a_stamp_that_no_clock_can_have_is_not_a_stamp(self, laser: LaserWidget) -> None:
        laser.update(MESSAGE | {"header": {"stamp": {"sec": 10**30, "nanosec": 0}, "frame_id": ""}})
        assert FRAME_HEADER.unpack_from(laser.get_state()["_frame"])[2] == 0


class TestFrame:
    @pytest.mark.parametrize(
        "scan",
        [
            Scan([1.0, inf, -inf, nan, 0.0], **GEOMETRY, intensities=[1, 2.5, nan, 0, 9], stamp_ns=STAMP),
            Scan([1.0, 2.0], **GEOMETRY),
            Scan([10.47], **(GEOMETRY | {"angle_increment": nan})),
            Scan([], **GEOMETRY),
            Scan([inf] * 40, **GEOMETRY),
            Scan(np.linspace(0, 31, 1040), -2.2, -0.004, 0.12, 3.5, intensities=np.arange(1040)),
        ],
        ids=["intensities", "plain", "one ray", "empty", "no reading", "clockwise"],
    )
    def test_packed_content_is_read_again(self, laser: LaserWidget, scan: Scan) -> None:
        laser.update(scan)
        frame = laser.get_state()["_frame"]
        assert isinstance(frame, bytes)
        assert same(shown(laser, frame), scan)
        assert len(frame) == FRAME_HEADER.size + 40 + 4 * (scan.ranges.size + scan.intensities.size)

    def test_ray_counts_may_change_from_scan_to_scan(self, laser: LaserWidget, page: Page) -> None:
        for count in (360, 1, 720, 0, 3):
            laser.update(MESSAGE | {"ranges": np.full(count, 2.0)})
            pacer.flush()
            assert len(shown(laser, page.state["_frame"])) == count

    def test_a_million_rays_are_taken(self, laser: LaserWidget) -> None:
        laser.update(MESSAGE | {"ranges": np.ones(1_000_000), "angle_increment": 1e-6})
        assert len(laser.scan) == 1_000_000

    def test_a_scan_without_a_reading_is_a_scan(self, laser: LaserWidget) -> None:
        for value, kind in [
            (inf, Validity.NOTHING_IN_RANGE),
            (-inf, Validity.TOO_CLOSE),
            (nan, Validity.NO_MEASUREMENT),
            (0.0, Validity.OUTSIDE_LIMITS),
        ]:
            laser.update(MESSAGE | {"ranges": [value] * 3})
            assert laser.scan.counts[kind] == 3
            assert laser.scan.nearest() == (laser.scan[0] if kind is Validity.TOO_CLOSE else None)


class TestScanOnShow:
    def test_is_none_before_the_first(self, laser: LaserWidget) -> None:
        assert laser.scan is None

    def test_is_the_newest_at_once(self, laser: LaserWidget) -> None:
        for distance in range(1, 30):
            laser.update(MESSAGE | {"ranges": [distance] * 3})
            assert laser.scan.nearest().range == distance

    def test_is_the_frozen_one_while_paused(self, laser: LaserWidget) -> None:
        laser.update(MESSAGE | {"header": {"stamp": {"sec": 5, "nanosec": 7}, "frame_id": "laser"}})
        assert laser.frozen is None
        laser.paused = True
        laser.update(MESSAGE | {"ranges": [9.0] * 5})
        pacer.flush()
        assert laser.scan.ranges.tolist() == laser.frozen.ranges.tolist() == [1.0, 2.0, 3.0]
        assert (laser.scan.stamp_ns, laser.scan.frame_id) == (5_000_000_007, "laser")
        assert laser.scan.nearest().index == 0
        laser.paused = False
        assert laser.scan.ranges.tolist() == [9.0] * 5
        assert laser.frozen is None

    def test_is_the_one_on_the_page_when_the_user_froze_it(self, laser: LaserWidget, page: Page) -> None:
        laser.update(MESSAGE)
        pacer.flush()
        on_the_page = page.state["_frame"]
        laser.update(MESSAGE | {"ranges": [9.0]})
        laser.set_state({"_frozen_frame": memoryview(on_the_page), "paused": True})
        assert laser.scan.ranges.tolist() == [1.0, 2.0, 3.0]
        laser.set_state({"_frozen_frame": memoryview(b""), "paused": False})
        assert laser.scan.ranges.tolist() == [9.0]

    def test_has_the_frame_of_the_sample_that_was_stepped_to(self, laser: LaserWidget, page: Page) -> None:
        frames = []
        for name in ("front", "rear", "front"):
            laser.update(**MESSAGE, header={"frame_id": name})
            pacer.flush()
            frames.append(page.state["_frame"])
        for frame, name in zip(frames, ("front", "rear", "front"), strict=True):
            laser.set_state({"_frozen_frame": memoryview(frame), "paused": True})
            assert laser.frozen.frame_id == name

    def test_is_none_while_it_was_frozen_before_the_first(self) -> None:
        laser = LaserWidget(paused=True)
        laser.update(MESSAGE)
        assert laser.scan is None
        laser.paused = False
        assert len(laser.scan) == 3
        laser.close()


class TestAngleOffset:
    def test_turns_what_comes(self, laser: LaserWidget) -> None:
        laser.angle_offset = pi
        laser.update(MESSAGE)
        assert laser.scan.angles.tolist() == pytest.approx([pi - 0.5, pi, pi + 0.5])

    def test_turns_the_present_scan_too(self, laser: LaserWidget, page: Page) -> None:
        laser.update(**MESSAGE, header={"frame_id": "laser"})
        laser.angle_offset = radians(90)
        laser.angle_offset = radians(-90)
        pacer.flush()
        assert laser.scan.angle_min == pytest.approx(-0.5 - pi / 2)
        assert shown(laser, page.state["_frame"]).angle_min == pytest.approx(-0.5 - pi / 2)
        assert FRAME_HEADER.unpack_from(page.state["_frame"])[0] == 1, "it is still the only scan that came"
        assert page.state["_about"]["frame_id"] == "laser"
        laser.angle_offset = 0
        assert laser.scan.angle_min == pytest.approx(-0.5)

    def test_turns_what_comes_at_the_same_moment(self, laser: LaserWidget, monkeypatch: pytest.MonkeyPatch) -> None:
        laser.update(MESSAGE)
        laser.angle_offset = 1.0
        turned, setters = Scan.turned, []

        def slowly(scan: Scan, by: float) -> Scan:
            if not setters:
                setters.append(threading.Thread(target=lambda: setattr(laser, "angle_offset", 2.0)))
                setters[0].start()
                setters[0].join(0.2)
            return turned(scan, by)

        monkeypatch.setattr(Scan, "turned", slowly)
        laser.update(MESSAGE)
        setters[0].join()
        assert laser.scan.angle_min == pytest.approx(1.5)

    def test_may_be_given_in_degrees(self, laser: LaserWidget) -> None:
        laser.angle_offset = "90deg"
        assert laser.angle_offset == pi / 2
        laser.update(**{**MESSAGE, "angle_min": "-20deg"})
        assert laser.scan.angle_min == pytest.approx(radians(70))

    def test_leaves_the_frozen_scan(self, laser: LaserWidget) -> None:
        laser.update(MESSAGE)
        laser.paused = True
        laser.angle_offset = 1.0
        assert laser.scan.angle_min == -0.5
        laser.paused = False
        assert laser.scan.angle_min == 0.5

    @pytest.mark.parametrize(
        ("value", "text"),
        [
            (nan, "a finite number of radians, got nan"),
            (inf, "a finite number of radians, got inf"),
            (180.0, "radians within ±2 pi, got 180.0; math.radians() makes them of degrees"),
            (-6.3, "radians within ±2 pi, got -6.3; math.radians() makes them of degrees"),
        ],
    )
    def test_is_in_radians(self, laser: LaserWidget, value: float, text: str) -> None:
        with pytest.raises(TraitError) as refusal:
            laser.angle_offset = value
        assert str(refusal.value) == f"angle_offset: expected {text}"
        assert laser.angle_offset == 0
