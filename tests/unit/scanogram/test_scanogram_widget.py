from __future__ import annotations

import json
from typing import Any

import numpy as np
import pytest
import traitlets

from robowidgets import ScanogramWidget

from ..pages import synced
from .pictures import get_picture

SECOND = 1_000_000_000
GEOMETRY = {"angle_min": -1.0, "angle_increment": 0.01, "range_min": 0.1, "range_max": 30.0}


def scans(count: int = 50, rays: int = 20, **changed: Any) -> dict[str, Any]:
    made = {"times_ns": 7 * SECOND + np.arange(count) * SECOND // 10, "ranges": np.full((count, rays), 5.0)}
    return {**made, **GEOMETRY, **changed}


@pytest.fixture
def scanogram() -> ScanogramWidget:
    widget = ScanogramWidget(title="/scan")
    widget.update(**scans())
    return widget


def facts_of(packed: bytes) -> dict[str, Any]:
    length = int.from_bytes(packed[:4], "little")
    facts: dict[str, Any] = json.loads(packed[4 : 4 + length])
    return facts


def test_it_sends_all_scans_ahead(scanogram: ScanogramWidget) -> None:
    facts = facts_of(synced(scanogram, "_frame"))
    assert (facts["scan_count"], facts["ray_count"], facts["level"]) == (50, 20, 0)
    assert facts["class_counts"] == [1000, 0, 0, 0, 0]
    assert facts["duration"] == pytest.approx(5.0)


def test_it_shows_what_it_was_given_also_when_the_arrays_are_used_again(scanogram: ScanogramWidget) -> None:
    given = scans(count=2_000, rays=100)
    arrays = {"times_ns": given["times_ns"], "ranges": given["ranges"].astype(np.float32)}
    scanogram.update(**{**given, **arrays})
    arrays["ranges"][:], arrays["times_ns"][:] = 1.0, 0
    shown = get_picture(scanogram).levels.scans
    assert np.unique(shown.read(0, 2_000)).tolist() == [5.0]
    assert shown.times_ns[-1] == 7 * SECOND + 1_999 * SECOND // 10


@pytest.mark.parametrize(
    ("changed", "error", "text"),
    [
        ({"ranges": np.zeros(5)}, ValueError, r"ranges: expected an array of 2 dimensions, got shape \(5,\)"),
        ({"ranges": [["a"]]}, TypeError, "ranges: expected an array of numbers, got <U1"),
        (
            {"times_ns": [0.5] * 50},
            TypeError,
            "times_ns: expected an array of whole numbers of nanoseconds, got float64",
        ),
        ({"times_ns": [1, 2]}, ValueError, "times_ns: expected one for each of 50 scans, got 2"),
        (
            {"ranges": np.zeros((50, 0))},
            ValueError,
            "ranges: expected at least one scan of one ray, got",
        ),
        ({"range_max": 0.0}, ValueError, "range_max: expected metres above range_min"),
        ({"angle_increment": 0.0}, ValueError, "angle_increment: expected a finite step"),
    ],
)
def test_arrays_that_do_not_fit_are_refused_with_words(
    changed: dict[str, Any], error: type[Exception], text: str
) -> None:
    with pytest.raises(error, match=text):
        ScanogramWidget().update(**scans(**changed))


@pytest.mark.parametrize("value", [(1, 2), [1.0, 2.0], None, (1, 2, 0, 20)])
def test_a_selection_is_a_plain_value(scanogram: ScanogramWidget, value: Any) -> None:
    scanogram.selection = value
    assert scanogram.selection == (value if value is None else tuple(value))


@pytest.mark.parametrize(
    "value", [(2, 1), (1,), (1, 2, 3), (-1, 2), (0, np.nan), "ab", 5, (True, 2), (0, 1, 3, 3), (0, 1, 0.5, 2)]
)
def test_what_is_not_a_selection_is_refused_with_words(scanogram: ScanogramWidget, value: Any) -> None:
    with pytest.raises(traitlets.TraitError, match=r"selection: expected .*got"):
        scanogram.selection = value
    assert scanogram.selection is None


def test_marks_are_kept_in_the_order_of_time(scanogram: ScanogramWidget) -> None:
    scanogram.marks = [(2, 3, "late"), (1, 1, "early")]
    assert scanogram.get_state("marks") == {"marks": ((1.0, 1.0, "early"), (2.0, 3.0, "late"))}
    with pytest.raises(traitlets.TraitError, match=r"marks: expected \(start, end, text\), .*got \(2, 1, 'x'\)"):
        scanogram.marks = [(2, 1, "x")]


def test_rays_belong_to_no_view(scanogram: ScanogramWidget) -> None:
    scanogram.view = (1, 2)
    with pytest.raises(traitlets.TraitError, match=r"view: expected None or \(start, end\)"):
        scanogram.view = (1, 2, 0, 5)


@pytest.mark.parametrize("value", [(2, 1), (-1, 5), (1, float("inf"))])
def test_colours_run_from_near_to_far(scanogram: ScanogramWidget, value: tuple[float, float]) -> None:
    with pytest.raises(traitlets.TraitError, match="color_range: expected None or"):
        scanogram.color_range = value


def test_the_time_cursor_is_a_finite_time_that_links(scanogram: ScanogramWidget) -> None:
    other = ScanogramWidget()
    traitlets.link((scanogram, "time"), (other, "time"))
    scanogram.time = 2.5
    assert other.time == 2.5
    with pytest.raises(traitlets.TraitError, match="time: expected seconds from the start, got nan"):
        scanogram.time = float("nan")


def test_it_answers_what_the_page_looks_at(scanogram: ScanogramWidget) -> None:
    scanogram.update(**scans(count=20_000, rays=100))
    assert facts_of(synced(scanogram, "_frame"))["level"] == 3
    scanogram.set_state({"_wanted": [100.0, 101.0, 800.0]})
    facts = facts_of(synced(scanogram, "_detail"))
    assert (facts["level"], facts["span"], facts["edition"]) == (
        0,
        [100.0, 101.0],
        facts_of(synced(scanogram, "_frame"))["edition"],
    )
    scanogram.update(**scans())
    assert synced(scanogram, "_detail") == b"", "details of earlier scans are gone"


def test_it_sends_medians_instead_of_the_nearest_when_asked() -> None:
    ranges = np.full((20_000, 100), 5.0)
    ranges[::4] = 1.0
    widget = ScanogramWidget()
    widget.update(**scans(count=20_000, rays=100, ranges=ranges))

    def shown(packed: bytes) -> tuple[str, int]:
        facts = facts_of(packed)
        cells = np.frombuffer(packed[-2 * {name: size for name, _, size in facts["arrays"]}["cells"] :], "<u2")
        return facts.get("pixel", ""), round((np.median(cells) - 1) * 29.9 / 65_000 + 0.1)

    assert shown(synced(widget, "_frame")) == ("nearest", 1)
    widget.pixel = "median"
    assert shown(synced(widget, "_frame")) == ("median", 5)
    widget.set_state({"_wanted": [0.0, 1000.0, 400.0]})
    assert shown(synced(widget, "_detail")) == ("", 5)
    with pytest.raises(traitlets.TraitError, match="pixel"):
        widget.pixel = "mean"


@pytest.mark.parametrize("call", ["update", "set_speeds", "set_touches"])
def test_it_answers_the_same_question_again_when_something_new_is_shown(call: str) -> None:
    many = scans(count=20_000, rays=100)
    widget = ScanogramWidget()
    widget.update(**many)
    widget.set_state({"_wanted": [100.0, 101.0, 800.0]})
    before = facts_of(synced(widget, "_detail"))["edition"]
    if call == "update":
        widget.update(**many)
    elif call == "set_speeds":
        widget.set_speeds(times_ns=many["times_ns"], values=np.zeros((20_000, 6)))
    else:
        widget.set_touches([(1.0, 2.0, "left")])
    assert (synced(widget, "_detail"), synced(widget, "_wanted")) == (b"", [])
    widget.set_state({"_wanted": [100.0, 101.0, 800.0]})
    assert facts_of(synced(widget, "_detail"))["edition"] == before + 1


def test_a_file_that_is_gone_leaves_the_coarse_picture_and_a_word(caplog: pytest.LogCaptureFixture) -> None:
    class Gone:
        times_ns = np.arange(20_000) * SECOND // 10

        def chunks(self) -> Any:
            yield np.full((20_000, 100), 5.0, np.float32)

        def read(self, *_numbers: int) -> Any:
            raise OSError("the disk is out")

    whole = ScanogramWidget()
    whole.update(**scans())
    whole.show_scans(Gone(), get_picture(whole).levels.sweep._replace(ray_count=100), 0)
    whole.set_state({"_wanted": [100.0, 101.0, 800.0]})
    assert synced(whole, "_about")["error"] == "no finer detail: the disk is out"
    assert "no finer detail: the disk is out" in caplog.text


def test_speeds_and_touches_come_after_scans() -> None:
    widget = ScanogramWidget()
    with pytest.raises(RuntimeError, match=r"set_speeds\(\): there are no scans yet; call update"):
        widget.set_speeds(times_ns=[0], values=np.zeros((1, 6)))
    with pytest.raises(RuntimeError, match=r"set_touches\(\): there are no scans yet; call update"):
        widget.set_touches([])


def test_speeds_and_touches_lie_on_the_same_axis(scanogram: ScanogramWidget) -> None:
    times = 7 * SECOND + np.arange(60) * SECOND // 10
    scanogram.set_speeds(times_ns=times, values=np.zeros((60, 6)), title="/odom", limits={"linear.x": (-0.2, 0.5)})
    scanogram.set_touches([(3.0, 4.0, "right"), (1.0, 2.0, "left")], title="/bumper")
    facts = facts_of(synced(scanogram, "_frame"))
    assert facts["speed"]["limits"] == [[-0.2, 0.5], None]
    assert facts["touch"] == {"title": "/bumper", "sensors": ["left", "right"]}
    assert facts["duration"] == pytest.approx(5.9)
    with pytest.raises(ValueError, match=r"values: expected the shape \(60, 6\), got \(60, 3\)"):
        scanogram.set_speeds(times_ns=times, values=np.zeros((60, 3)))
    with pytest.raises(ValueError, match=r"spans: expected .* with start <= end, got"):
        scanogram.set_touches([(2.0, 1.0, "left")])


def test_it_says_that_the_clock_goes_back() -> None:
    widget = ScanogramWidget()
    widget.update(**scans(count=3, times_ns=[5, 9, 7]))
    assert synced(widget, "_about")["notes"] == ["the clock goes back once: shown in the order of arrival"]


def test_an_unknown_keyword_is_refused() -> None:
    with pytest.raises(TypeError, match="has no keyword 'tme'; did you mean 'time'"):
        ScanogramWidget(tme=3)
