"""Sectors, the rays in them, and the code that computes their distance."""

from __future__ import annotations

import json
import re
import threading
import warnings
from collections.abc import Callable
from functools import partial
from math import inf, isnan, nan, pi, radians
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from robowidgets import LaserWidget, Scan, Sector, conditions
from robowidgets.laser.sectors import _plain
from robowidgets.reasons.look import Look
from robowidgets.samples.sector import ALL_ROUND
from robowidgets.samples.sector_code import for_scan
from robowidgets.samples.stretches import parse, sector_of, stretches

from ...vectors import SECTORS, read, to_scan
from ..pages import synced

SCANS = {case["name"]: case for case in read()["scans"]}
FORMS = (Sector("20deg", "30deg"), ("20deg", "30deg"), (radians(20), radians(30)))


def circle(step: float = 1.0, first: float = 0.0) -> Scan:
    """A full circle whose ranges are 1 m and a hundredth of the index."""
    ranges = 1 + np.arange(round(360 / abs(step))) / 100
    return Scan(ranges, radians(first), radians(step), 0.1, 30.0)


def pasted(code: str, **names: Any) -> Any:
    """The output of a cell into which code was pasted."""
    *lines, last = code.rstrip().split("\n")
    values = {"np": np, **names}
    exec("\n".join(lines), values)
    return eval(last, values)


class TestSector:
    def test_is_a_value(self) -> None:
        sector = Sector("-15deg", radians(15), near=0.5)
        assert sector == Sector(radians(-15), "15deg", near=0.5)
        assert len({sector, Sector("-15deg", "15deg", near=0.5), Sector("-15deg", "15deg")}) == 2
        with pytest.raises(AttributeError):
            sector.near = 1.0  # type: ignore[misc]

    @pytest.mark.parametrize("sector", [*SECTORS, Sector("0deg", "1deg", warning=2, stop=1, hysteresis=0.1)])
    def test_is_made_again_of_its_repr_and_of_json(self, sector: Sector) -> None:
        assert eval(repr(sector)) == sector
        assert Sector(**json.loads(json.dumps(sector.to_json()))) == sector  # type: ignore[arg-type]

    @pytest.mark.parametrize(
        ("given", "error", "text"),
        [
            ({"start": 0, "end": 90}, ValueError, r"^sector: expected radians within ±2 pi, got 90.0; "),
            ({"start": "a", "end": 0}, TypeError, r"^sector: expected radians, or degrees as in "),
            ({"near": 0}, ValueError, r"^near: expected metres above 0, got 0.0$"),
            ({"warning": "1"}, TypeError, r"^warning: expected a number, got '1'$"),
            ({"hysteresis": -1}, ValueError, r"^hysteresis: expected metres, 0 or more, got -1.0$"),
            (
                {"warning": 1, "stop": 2},
                ValueError,
                r"^stop: expected a distance up to warning \(1 m\), got 2; are the",
            ),
        ],
    )
    def test_what_cannot_be_is_refused(self, given: dict[str, Any], error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            Sector(**{"start": 0, "end": 1} | given)

    def test_a_state_holds_until_the_distance_is_larger_by_the_hysteresis(self) -> None:
        sector = Sector(0, 1, near=2, warning=1, stop=0.5, hysteresis=0.1)
        rows = [
            (0.49, "free", "stop"), (0.55, "stop", "stop"), (0.55, "free", "warning"), (1.05, "stop", "warning"),
            (1.05, "occupied", "occupied"), (2.05, "warning", "occupied"), (2.05, "free", "free"),
            (inf, "stop", "free"), (nan, "stop", "unknown"),
        ]  # fmt: skip
        assert [sector.state(distance, before) for distance, before, _ in rows] == [state for *_, state in rows]


class TestRays:
    @pytest.mark.parametrize("sector", FORMS)
    def test_every_form_of_a_sector_is_taken(self, sector: Any) -> None:
        scan = circle()
        assert scan.indices(sector).tolist() == list(range(20, 31))
        assert (scan.distance(sector), scan.nearest(sector).index) == (1.2, 20)  # type: ignore[union-attr]
        assert conditions.nearest_below(1.21, sector).judge(scan).value
        assert not conditions.nearest_below(1.19, sector).judge(scan).value
        assert LaserWidget(sectors={"a": sector}).sectors["a"] == FORMS[0]

    def test_a_selection_is_taken_wherever_a_sector_is(self) -> None:
        laser = LaserWidget()
        laser.update(circle())
        laser.selection = ("20deg", "30deg")
        scan, picked = laser.scan, laser.selection
        assert scan is not None
        assert picked is not None
        assert (scan.distance(picked), scan.indices(picked).tolist()) == (1.2, list(range(20, 31)))
        assert scan.nearest(picked).index == 20  # type: ignore[union-attr]
        assert conditions.nearest_below(1.21, picked).judge(scan).value
        assert not conditions.nearest_below(1.19, picked).judge(scan).value
        assert Look(lambda scan: scan.distance(picked) < 1.21).judge(scan).rays.tolist() == [20]
        assert laser.distance(picked) == scan.distance(picked)
        assert laser.code(picked) == 'scan.distance(("20deg", "30deg"))'
        laser.sectors["kept"] = picked
        laser.selection = None
        laser.selection = picked
        assert laser.sectors["kept"] == laser.selection.sector == FORMS[0]
        laser.highlight(picked)
        assert synced(laser, "_highlight") == {"text": "", "sector": _plain(FORMS[0])}
        laser.close()

    def test_no_selection_is_not_a_sector_rather_than_all_rays(self) -> None:
        laser = LaserWidget()
        laser.update(circle())
        scan, none = laser.scan, laser.selection
        assert scan is not None
        assert none is None
        calls: list[Callable[[Any], Any]] = [
            *(scan.distance, scan.nearest, scan.indices, laser.distance),
            *(lambda one: conditions.nearest_below(1, one), lambda one: laser.sectors.update(kept=one)),
            lambda one: Look(lambda scan: scan.distance(one) < 1).judge(scan),
        ]
        for call in calls:
            with pytest.raises(TypeError, match=r"^sector: expected two angles, .*, got None: is nothing selected\? "):
                call(none)
        assert scan.distance() == scan.distance(ALL_ROUND) == 1.0
        laser.close()

    @pytest.mark.parametrize(
        ("swapped", "words"),
        [
            (
                ("20deg", "-20deg"),
                '("20deg", "-20deg") covers 320°: it goes counter-clockwise from the first angle to the second. '
                '("-20deg", "20deg") covers the 40° between them: are the two swapped? '
                'If not, ("20deg", "340deg") says so',
            ),
            ((0.25, -0.25), "(0.25, -0.25) covers 331.4°: "),
            (("135deg", "45deg"), '("45deg", "135deg") covers the 90° between them: are the two swapped? '),
        ],
    )
    def test_angles_that_are_probably_swapped_get_a_hint_at_the_line_that_gives_them(
        self, swapped: Any, words: str
    ) -> None:
        scan = circle()
        for call in (scan.distance, scan.nearest, scan.indices, lambda sector: conditions.nearest_below(1, sector)):
            with pytest.warns(UserWarning, match=f"^sector .*{re.escape(words)}") as told:
                call(swapped)
            assert told[0].filename == __file__
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            pasted(for_scan(Sector(*swapped)), scan=scan)

    def test_the_hint_comes_once_for_a_line_of_a_thread_though_warnings_are_forgotten(self) -> None:
        scan = circle()

        def step() -> None:
            for _ in range(3):
                scan.distance(("20deg", "-20deg"))

        for target, told in ((step, 1), (partial(scan.distance, ("20deg", "-20deg")), 0)):
            with warnings.catch_warnings(record=True) as warned:
                warnings.simplefilter("always")
                thread = threading.Thread(target=target)
                thread.start()
                thread.join()
            assert [warning.filename for warning in warned] == [__file__] * told

    @pytest.mark.parametrize(
        "meant",
        [("135deg", "-135deg"), ("350deg", "10deg"), ("-170deg", "170deg"), ("20deg", "340deg"), ("90deg", "-90deg")],
    )
    def test_a_sector_across_the_seam_gets_no_index(self, meant: Any) -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            circle().distance(meant)
            circle().distance(Sector("20deg", "-20deg"))

    def test_they_are_in_the_order_of_the_sector_across_the_seam_and_for_any_scanner(self) -> None:
        assert circle().indices(("-2deg", "2deg")).tolist() == [358, 359, 0, 1, 2]
        assert circle(-1).indices(("-2deg", "2deg")).tolist() == [2, 1, 0, 359, 358]
        assert circle().indices("front").tolist() == [*range(315, 360), *range(46)]
        assert circle().indices().tolist() == list(range(360))
        assert stretches(circle(-1), Sector("-2deg", "2deg")) == [(358, 360), (0, 3)]

    @pytest.mark.parametrize("step", [1.0, -1.0, 0.25, -0.25, 0.3515625])
    @pytest.mark.parametrize("first", [0.0, -180.0, 33.3])
    def test_the_sector_of_rays_holds_these_and_no_others(self, step: float, first: float) -> None:
        scan = circle(step, first)
        for low, high in ((0, 0), (7, 7), (3, 50), (100, len(scan) - 1), (len(scan) - 5, len(scan) + 5)):
            rays = {index % len(scan) for index in range(low, high + 1)}
            assert set(scan.indices(sector_of(scan, low, high)).tolist()) == rays

    def test_text_names_rays_as_slices_do(self) -> None:
        rays = list(range(360))
        rows = [
            ("ranges[240:300]", rays[240:300]),
            ("[-10:]", rays[-10:]),
            ("msg.ranges[ :3]", rays[:3]),
            ("ranges[350:] + ranges[:10]", rays[350:] + rays[:10]),
            ("ranges[-1]", rays[-1:]),
        ]
        for text, expected in rows:
            assert parse(text, 360).tolist() == expected
        for text in ("ranges[1:9:2]", "range[1:2]", "ranges[]", "", "ranges[1:2]; x", "__import__('os')"):
            with pytest.raises(ValueError, match=r'^expected text like "ranges\[240:300\]"'):
                parse(text, 360)
        with pytest.raises(ValueError, match=r"^ranges\[400:\] names no ray: this scan has 360$"):
            parse("ranges[400:]", 360)


@pytest.mark.parametrize("name", SCANS)
@pytest.mark.parametrize("offset", [0.0, 0.35])
def test_code_gives_the_number_in_the_picture(name: str, offset: float) -> None:
    case = SCANS[name]
    sent = to_scan(case)
    laser = LaserWidget(angle_offset=offset)
    laser.update(sent)
    scan = laser.scan
    assert scan is not None
    message = SimpleNamespace(
        ranges=sent.ranges.tolist(),
        angle_min=sent.angle_min,
        angle_increment=float(case["angle_increment"]),
        range_min=case["range_min"],
        range_max=case["range_max"],
    )
    for sector in (*SECTORS, "front", "left", *range(0, len(scan), 97)):
        number = scan.distance(sector_of(scan, sector, sector) if isinstance(sector, int) else sector)
        for form, names in (("scan", {"scan": scan}), ("message", {"msg": message})):
            found = pasted(laser.code(sector, form=form), **names)
            assert np.float32(found) == np.float32(number) or (isnan(found) and isnan(number)), (sector, form)
        if not isinstance(sector, int):
            part = pasted(laser.code(sector, form="slice"), ranges=scan.ranges)
            assert sorted(map(str, part)) == sorted(map(str, scan.ranges[scan.indices(sector)]))
    laser.close()


class TestWidget:
    def laser(self, **given: Any) -> LaserWidget:
        laser = LaserWidget(**given)
        laser.update(circle())
        return laser

    def test_sectors_are_a_mapping_that_the_page_shares(self) -> None:
        laser = self.laser(sectors={"ahead": ("-15deg", "15deg")})
        laser.sectors["door"] = Sector("80deg", "100deg", near=0.5)
        laser.sectors["front"] = ("-5deg", "5deg")
        assert list(laser.sectors) == ["ahead", "door", "front"]
        assert laser.get_state()["_sectors"]["door"] == {
            "start": radians(80), "end": radians(100), "near": 0.5, "hysteresis": 0.05
        }  # fmt: skip
        laser.set_state({"_sectors": {"drawn": {"start": 0.0, "end": 1.0}}, "_selection": {"name": "drawn"}})
        assert dict(laser.sectors) == {"drawn": Sector(0, 1)}
        assert laser.selection is not None
        assert laser.selection.name == "drawn"
        assert laser.sectors["left"] == Sector("45deg", "135deg")
        assert "left" not in laser.sectors
        del laser.sectors["drawn"]
        assert laser.selection is None
        with pytest.raises(KeyError, match=r"no sector 'x'; there are: front, left, back, right"):
            laser.sectors["x"]

    def test_sectors_are_saved_and_loaded(self, tmp_path: Any) -> None:
        laser, other = self.laser(sectors={"größe": Sector("-15deg", 0.3, stop=1)}), self.laser()
        laser.sectors.save(tmp_path / "sectors.json")
        other.sectors.load(tmp_path / "sectors.json")
        assert dict(other.sectors) == dict(laser.sectors)
        (tmp_path / "bad.json").write_text('{"a": {"start": 0}}')
        with pytest.raises(ValueError, match=r"bad.json: expected sectors as save\(\) writes them: "):
            other.sectors.load(tmp_path / "bad.json")
        assert dict(other.sectors) == dict(laser.sectors)

    def test_the_selection_has_the_rays_of_the_scan_on_show(self) -> None:
        laser = self.laser(sectors={"ahead": ("-2deg", "2deg")})
        assert laser.selection is None
        laser.selection = ("20deg", "30deg")
        picked = laser.selection
        assert picked is not None
        assert (picked.name, picked.slice, picked.expression) == ("", slice(20, 31), "ranges[20:31]")
        assert picked.values.tolist() == laser.scan.ranges[20:31].tolist()
        assert np.flatnonzero(picked.mask).tolist() == list(range(20, 31))
        laser.selection = "ahead"
        picked = laser.selection
        assert picked is not None
        assert (picked.slice, picked.expression) == (None, "ranges[358:] + ranges[:3]")
        assert (picked.distance, picked.nearest.index) == (1.0, 0)  # type: ignore[union-attr]
        assert laser.code() == 'scan.distance(("-2deg", "2deg"))'
        laser.sectors = {}
        assert laser.selection is None
        laser.selection = ("20deg", "30deg")
        laser.sectors = {}
        assert laser.selection is not None  # it was not in `sectors`
        laser.selection = None
        laser.pinned = 30
        assert laser.code() == 'scan.distance(("29.9deg", "30.1deg"))'
        assert laser.code(form="slice") == "ranges[30]"

    def test_own_names_go_before_the_ready_made_ones(self) -> None:
        laser = self.laser(sectors={"front": ("20deg", "30deg")})
        assert (laser.distance("front"), laser.distance("left"), laser.distance()) == (1.2, 1.45, 1.0)
        assert laser.code("front") == 'scan.distance(("20deg", "30deg"))'
        assert laser.code("left") == 'scan.distance("left")'
        assert isnan(LaserWidget().distance("left"))

    def test_rays_are_lit_by_every_way_to_name_them(self) -> None:
        laser = self.laser(sectors={"ahead": ("-2deg", "2deg")})
        mask = np.zeros(360, bool)
        mask[240:300] = True
        for rays in (slice(240, 300), range(240, 300), mask, np.arange(240, 300), "ranges[240:300]"):
            laser.highlight(rays)
            assert laser.get_state()["_highlight"] == {"text": "ranges[240:300]", "stretches": [[240, 300]]}
        laser.highlight("ahead")
        assert laser.get_state()["_highlight"]["sector"]["end"] == radians(2)
        laser.highlight(Sector(-pi, pi))
        assert laser.get_state()["_highlight"]["sector"]["end"] == pi
        laser.highlight(-1)
        assert laser.get_state()["_highlight"]["stretches"] == [[359, 360]]
        before = laser.get_state()["_highlight"]
        for rays, text in (
            ([400], r"^rays: expected indices of the 360 rays of this scan, got \[400\]$"),
            (2.5, r"^rays: expected a slice, indices, a mask of 360 values, a sector or text like "),
            ("ranges[9:5]", r"^ranges\[9:5\] names no ray: this scan has 360$"),
            ("nowhere", r"^sector: expected ahead, front, left, back, right or two angles, got 'nowhere'$"),
        ):
            with pytest.raises((TypeError, ValueError), match=text):
                laser.highlight(rays)
        laser.sectors["front"] = ("-5deg", "5deg")
        with pytest.raises(ValueError, match=r"^sector: expected ahead, front, left, back, right or two angles, got"):
            laser.highlight("nowhere")
        assert laser.get_state()["_highlight"] == before
        laser.highlight(None)
        assert laser.get_state()["_highlight"] == {}

    @pytest.mark.parametrize(
        ("given", "text"),
        [
            ({"sectors": {"": (0, 1)}}, r"^sectors: expected a name of 1 to 40 characters, got ''$"),
            ({"sectors": [(0, 1)]}, r"^sectors: expected a dictionary by name, got \[\(0, 1\)\]$"),
            ({"sectors": {"a": (0, 90)}}, r"^sector: expected radians within ±2 pi, got 90.0; "),
            ({"pins": {"a": -1}}, r"^pins: expected the index of a ray, 0 or more, got -1$"),
        ],
    )
    def test_what_cannot_be_kept_is_refused(self, given: dict[str, Any], text: str) -> None:
        with pytest.raises((TypeError, ValueError), match=text):
            LaserWidget(**given)
        laser = self.laser()
        ((name, value),) = given.items()
        with pytest.raises((TypeError, ValueError), match=text):
            setattr(laser, name, value)
        assert not getattr(laser, name)

    def test_code_that_cannot_be_says_why(self) -> None:
        laser = LaserWidget()
        for ask, text in (
            (lambda: laser.code(), r"^code\(\) needs a sector: nothing is selected and no ray is pinned$"),
            (lambda: laser.code(5), r"^sector: expected a ray of the scan on show, got 5: no scan has come$"),
            (lambda: laser.code("front", form="slice"), r"^code\(\) of a slice needs a scan: no scan has come$"),
            (lambda: laser.code("front", form="c"), r"^form: expected 'scan', 'message', 'slice', got 'c'$"),
        ):
            with pytest.raises(ValueError, match=text):
                ask()
        assert laser.code("front") == 'scan.distance("front")'
