"""The plot: its inputs, its refusals, and its messages to the page."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from math import inf, nan
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import traitlets

import robowidgets
from robowidgets import PlotWidget
from robowidgets.plots import line as lines
from robowidgets.plots._thin import ThinRows, thinned
from robowidgets.plots.frame import pack
from robowidgets.plots.line import GrowingLine, slope
from robowidgets.recordings import RecordingError
from robowidgets.widget.pacer import pacer

from ..pages import from_page, synced
from ..recordings import recorded
from ..senders import turn_of


@pytest.fixture
def plot() -> Iterator[PlotWidget]:
    widget = PlotWidget(title="run")
    yield widget
    widget.close()


def rows_of(frame: bytes) -> list[tuple[int, ThinRows]]:
    """The number of values of each line in a frame, and its rows."""
    numbers = np.frombuffer(frame, "<f8")
    found, at = [], 7
    for _ in range(int(numbers[6])):
        total, count = map(int, numbers[at : at + 2])
        columns = numbers[at + 2 : at + 2 + 4 * count].reshape(4, count)
        found.append((total, ThinRows(*columns)))
        at += 2 + 4 * count
    assert at == len(numbers)
    return found


def sent(plot: PlotWidget) -> list[tuple[int, ThinRows]]:
    """The data of all lines for a new page."""
    return rows_of(plot.get_state()["_lines"])


# Lines on show


def test_each_value_of_an_array_reaches_the_page_to_the_last_bit(plot: PlotWidget) -> None:
    seconds = np.cumsum(np.random.default_rng(1).uniform(0.001, 0.1, 500))
    values = np.random.default_rng(2).normal(size=500)
    plot.set_line("v", seconds, values)
    ((total, rows),) = sent(plot)
    assert total == 500
    assert np.array_equal(rows.times, seconds)
    assert np.array_equal(rows.values, values)
    times, same = plot["v"]
    assert np.array_equal(times, seconds)
    assert np.array_equal(same, values)


def test_values_that_come_one_by_one_are_added_to_their_lines(plot: PlotWidget) -> None:
    for i in range(1000):
        plot.update({"/odom.v": i / 10}, time=i / 100)
    plot.update(time=10.0, w=np.float32(0.5), up=True)
    assert plot.names == ("/odom.v", "w", "up")
    assert [(total, rows.values[-1]) for total, rows in sent(plot)] == [(1000, 99.9), (1, 0.5), (1, 1.0)]
    assert plot.get_state()["_facts"]["live"] is True
    assert repr(plot) == "<PlotWidget run: /odom.v (1,000), w (1), up (1)>"


def test_a_value_that_comes_while_a_frame_is_made_is_in_the_next(
    plot: PlotWidget, monkeypatch: pytest.MonkeyPatch
) -> None:
    def pack_late(*given: Any) -> bytes:
        monkeypatch.setattr("robowidgets.plot_widget.pack", pack)
        plot.update(v=2.0, time=2.0)
        return pack(*given)

    monkeypatch.setattr("robowidgets.plot_widget.pack", pack_late)
    with turn_of(pacer):  # it makes frames, too, but not now
        plot.update(v=1.0, time=1.0)
        assert sent(plot)[0][1].values.tolist() == [1.0]
        assert sent(plot)[0][1].values.tolist() == [1.0, 2.0]


def test_what_is_not_finite_is_a_gap(plot: PlotWidget) -> None:
    plot.set_line("a", [0, 1, 2], np.ma.masked_array([1, 2, 3], [False, True, False]))
    plot.set_line("b", [0, 1, 2], [1.0, inf, nan])
    plot.update(c=nan, time=0.0)
    plot.update({"c": None}, time=1.0)  # type: ignore[dict-item]
    for _, rows in sent(plot):
        assert np.isnan(rows.values).any()
        assert not np.isinf(rows.values).any()
        assert rows.sums.sum() in (4.0, 1.0, 0.0)


def test_a_line_is_replaced_cleared_and_restarted(plot: PlotWidget) -> None:
    plot.update(v=1.0, time=100.0)
    plot.set_line("v", [0.0], [5.0])
    assert [(total, rows.values.tolist()) for total, rows in sent(plot)] == [(1, [5.0])]
    plot.clear("v")
    assert plot.names == ()
    assert plot.get_state()["_facts"]["live"] is False
    plot.update(v=1.0, time=0.5)
    with pytest.raises(KeyError, match=r"clear\('w'\): the lines are v"):
        plot.clear("w")


def test_while_frozen_values_are_taken_and_the_time_on_show_is_kept(plot: PlotWidget) -> None:
    plot.update(v=1.0, time=3.0)
    plot.paused = True
    plot.update(v=2.0, time=4.0)
    assert plot.get_state()["_frozen_at"] == 3.0
    assert plot["v"][1].tolist() == [1.0, 2.0]
    plot.paused = False
    assert plot.get_state()["_frozen_at"] is None


def test_many_threads_lose_no_value(plot: PlotWidget) -> None:
    def run(name: str) -> None:
        for i in range(300):
            plot.update({name: i}, time=i)

    threads = [threading.Thread(target=run, args=(name,)) for name in "abcd"]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [plot[name][1].sum() for name in "abcd"] == [299 * 150] * 4


# Thinning


def test_no_extreme_is_lost_among_a_million_values() -> None:
    times = np.arange(1_000_000) / 1000
    values = np.random.default_rng(3).normal(size=len(times))
    values[345_678], values[777_777] = 50.0, -60.0
    rows = thinned(times, values, 0.0, times[-1], 500)
    assert len(rows.times) <= 2100
    for low in range(0, 1_000_000, 100_000):
        part = slice(low, low + 100_000)
        inside = (rows.times >= times[part][0]) & (rows.times <= times[part][-1])
        assert rows.values[inside].min() == values[part].min()
        assert rows.values[inside].max() == values[part].max()


def test_each_row_is_a_value_at_its_own_time_and_the_means_cover_all_values() -> None:
    times = np.sort(np.random.default_rng(4).uniform(0, 100, 20_000))
    values = np.random.default_rng(5).normal(3, 1, len(times))
    values[5000:5100] = nan
    rows = thinned(times, values, 20.0, 70.0, 200)
    places = np.searchsorted(times, rows.times)
    assert np.array_equal(rows.values, values[places], equal_nan=True)
    first, last = places[0], places[-1]
    assert rows.counts[1:].sum() == np.isfinite(values[first + 1 : last + 1]).sum()
    assert rows.sums[1:].sum() == pytest.approx(np.nansum(values[first + 1 : last + 1]))
    assert rows.times[0] < 20.0 < rows.times[1]
    assert rows.times[-2] <= 70.0 < rows.times[-1]


def test_a_gap_of_one_value_among_many_is_kept() -> None:
    values = np.zeros(100_000)
    values[50_321] = nan
    assert np.isnan(thinned(np.arange(100_000.0), values, 0, 1e5, 100).values).sum() == 1


def test_a_line_ends_where_nothing_came_for_long() -> None:
    times = np.concatenate([np.arange(0, 5, 0.1), np.arange(9, 12, 0.1)])
    rows = thinned(times, np.ones(len(times)), 0.0, 12.0, 1000)
    (at,) = np.flatnonzero(rows.counts < 0)
    assert np.isnan(rows.values[at])
    assert rows.times[at - 1] == times[49] < rows.times[at] < rows.times[at + 1] == 9.0
    slow = np.arange(0, 100, 5.0)
    assert (thinned(slow, slow, 0.0, 100.0, 1000).counts == 1).all()


def test_a_topic_with_a_message_a_minute_is_a_line_with_a_gap_after_three_minutes() -> None:
    times = np.array([0.0, 60.0, 120.0, 299.0, 359.0, 540.0, 600.0])
    rows = thinned(times, times, 0.0, 600.0, 1000)
    assert rows.times[rows.counts < 0].tolist() == [449.5]


def test_nothing_and_times_that_are_all_the_same_can_be_packed() -> None:
    empty = np.empty(0)
    assert rows_of(pack(1, [(empty, empty)], (0.0, 0.0), 100))[0][0] == 0
    same = np.full(5000, 2.0)
    ((total, rows),) = rows_of(pack(1, [(same, np.arange(5000.0))], (2.0, 2.0), 10))
    assert total == 5000
    assert (rows.values.min(), rows.values.max()) == (0, 4999)


def test_a_part_that_the_page_looks_at_comes_with_each_value(plot: PlotWidget) -> None:
    times = np.arange(1_000_000) / 1000
    plot.set_line("v", times, times)
    assert len(sent(plot)[0][1].times) < 5000
    plot.set_state({"_wanted": [500.0, 501.0, 800.0]})
    total, rows = rows_of(plot.get_state()["_detail"])[0]
    assert total == 1_000_000
    assert np.array_equal(rows.times[1:-1], times[500_000:501_001])
    plot.set_state({"_wanted": []})
    assert plot.get_state()["_detail"] == b""


def test_the_newest_of_a_long_line_comes_with_each_value_as_long_as_it_is_followed(plot: PlotWidget) -> None:
    plot.window = 2.0
    for i in range(20_000):
        plot.update(v=i, time=i / 100)
    detail = rows_of(plot.get_state()["_detail"])[0][1]
    assert detail.values[-200:].tolist() == list(range(19_800, 20_000))
    plot.view = (0.0, 100.0)
    assert plot.get_state()["_detail"] == b""


def test_what_is_on_show_of_a_long_line_rests_after_each_time_as_long_as_that_costs(
    plot: PlotWidget, monkeypatch: pytest.MonkeyPatch
) -> None:
    now = 1000.0

    def pack_slowly(*of: Any) -> bytes:
        nonlocal now
        now += 1 / 64
        return pack(*of)

    monkeypatch.setattr("robowidgets.plot_widget.pack", pack_slowly)
    monkeypatch.setattr("robowidgets.plot_widget.clock", SimpleNamespace(monotonic=lambda: now))
    with turn_of(pacer):  # so that it sends nothing of it meanwhile
        plot.set_line("v", np.arange(10_000) / 1000, np.zeros(10_000))
        plot.send_newest()
        came = []
        for i in range(9):
            plot.update(v=i, time=10 + i / 1000)
            now += 3 / 64
            plot.send_newest()
            came.append(rows_of(synced(plot, "_detail"))[0][1].values[-1])
        assert came == [0] * 7 + [7] * 2
        plot.window = 1.0
        plot.send_newest()
        assert rows_of(synced(plot, "_detail"))[0][1].values[-1] == 8, "the visible part comes at once"


def test_the_oldest_values_go_when_there_are_too_many(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(lines, "MOST_VALUES", 1000)
    line = GrowingLine()
    for i in range(1500):
        line.append(i, i)
    assert line.times[-1] == 1499
    assert np.array_equal(line.times, np.arange(line.times[0], 1500))
    assert 750 <= len(line.times) <= 1000


def test_a_slope_is_the_change_per_second() -> None:
    found = slope(np.array([0.0, 1.0, 1.0, 3.0]), np.array([0.0, 2.0, 5.0, 1.0]))
    assert np.array_equal(found, [nan, 2.0, nan, -2.0], equal_nan=True)


# Refusals


@pytest.mark.parametrize(
    ("seconds", "values", "kind", "text"),
    [
        ([0, 1], [1.0], ValueError, r"v: expected a time for each value, got 2 and 1"),
        ([0, 2, 1], [1, 2, 3], ValueError, r"v: .*index 2 is 1 s, after 2 s; sort them first"),
        ([-1, 0], [1, 2], ValueError, r"v: expected seconds from 0 on, got .*-1.0.* at index 0"),
        ([0, nan], [1, 2], ValueError, r"v: expected seconds from 0 on, got .*nan.* at index 1"),
        ([0, 1], ["a", "b"], TypeError, r"v: values: expected an array of numbers, got <U1"),
        ([0], [[1, 2]], ValueError, r"v: values: expected an array of one dimension, got shape \(1, 2\)"),
    ],
)
def test_an_array_that_is_not_a_line_is_refused_with_the_reason(
    plot: PlotWidget, seconds: Any, values: Any, kind: type[Exception], text: str
) -> None:
    with pytest.raises(kind, match=text):
        plot.set_line("v", seconds, values)
    assert plot.names == ()


@pytest.mark.parametrize(
    ("call", "kind", "text"),
    [
        (lambda plot: plot.update(), TypeError, r"update\(\) needs numbers by name: update\(v=0.3, time=1.2\)"),
        (lambda plot: plot.update(0.3), TypeError, r"update\(\) takes numbers by name: .*; got 0.3"),
        (lambda plot: plot.update(1.2, {"v": 0.3}), TypeError, r"takes one message, or numbers by name"),
        (lambda plot: plot.update(v="fast"), TypeError, r"v: expected a number, got 'fast'"),
        (lambda plot: plot.update(v=[1]), TypeError, r"v: expected a number, got \[1\]"),
        (lambda plot: plot.update(v=1, time=-1), ValueError, r"time: expected seconds from 0 on, got -1"),
        (lambda plot: plot.update(v=1, time=inf), ValueError, r"time"),
        (lambda plot: plot.update(w=1, a=2, time=1), ValueError, r"time: 1 s is before the last value of 'w', at 5 s"),
        (lambda plot: plot.update({f"l{i}": i for i in range(9)}), ValueError, r"expected at most 8 lines, got 10"),
    ],
)
def test_an_invalid_value_is_refused_with_the_reason_and_nothing_is_added(
    plot: PlotWidget, call: Any, kind: type[Exception], text: str
) -> None:
    plot.update(w=0.0, time=5.0)
    with pytest.raises(kind, match=text):
        call(plot)
    assert (plot.names, len(plot["w"][0])) == (("w",), 1)
    assert plot.get_state()["_facts"]["error"]
    plot.clear()
    assert plot.get_state()["_facts"]["error"] == ""


def test_an_error_stays_until_its_line_gets_a_value(plot: PlotWidget) -> None:
    for name, error in (("w", True), ("v", False)):
        with pytest.raises(TypeError):
            plot.update(v="fast")  # type: ignore[arg-type]
        plot.update({name: 1.0}, time=6.0)
        assert bool(plot.get_state()["_facts"]["error"]) is error


def test_in_another_thread_the_widget_says_what_was_wrong(plot: PlotWidget, caplog: pytest.LogCaptureFixture) -> None:
    thread = threading.Thread(target=lambda: plot.update(v="fast"))  # type: ignore[arg-type]
    thread.start()
    thread.join()
    assert plot.get_state()["_facts"]["error"] == "v: expected a number, got 'fast'."
    assert "a value could not be shown: v: expected a number, got 'fast'" in caplog.text


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("window", 0.0, "window: expected seconds above 0, or None for all, got 0.0"),
        ("time", nan, "time: expected seconds, or None for no cursor, got nan"),
        ("view", (3, 2), "view"),
        ("marks", [(1, 0, "x")], "marks: expected"),
    ],
)
def test_a_trait_out_of_its_range_is_refused(plot: PlotWidget, name: str, value: Any, text: str) -> None:
    with pytest.raises(traitlets.TraitError, match=text):
        setattr(plot, name, value)


def test_what_people_look_for_is_named() -> None:
    with pytest.raises(TypeError, match="did you mean 'units'"):
        PlotWidget(unit="m/s")


# Recordings


def test_fields_of_a_recording_have_their_values_their_times_and_their_units() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        plot = robowidgets.plot(recording, "/odom.twist.twist.linear.x", "/odom.pose.pose.position")
        fields = recording.fields("/odom")
        times, values = plot["/odom.twist.twist.linear.x"]
        assert np.array_equal(times, fields.seconds)
        assert np.array_equal(values, fields["twist.twist.linear.x"])
    assert plot.names[1:] == tuple(f"/odom.pose.pose.position.{axis}" for axis in "xyz")
    assert plot.units["/odom.twist.twist.linear.x"] == "m/s"
    assert plot.units["/odom.pose.pose.position.y"] == "m"
    assert plot.title == "/odom"


def test_a_part_of_a_recording_and_a_derivative_can_be_plotted() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        field = "/odom.twist.twist.linear.x"
        plot = robowidgets.plot(recording[2:5], field, derivative=True, units={field: "knots"}, title="speed")
    assert plot.names == (field, f"d/dt {field}")
    assert (plot.units[field], plot.units[f"d/dt {field}"], plot.title) == ("knots", "m/s²", "speed")
    times, _ = plot[field]
    assert 2 <= times[0] < times[-1] < 5


@pytest.mark.parametrize(
    ("fields", "kind", "text"),
    [
        ((), TypeError, r"plot\(\) needs a field, as plot\(recording, "),
        (
            ("/odom.twist.twist.linar.x",),
            KeyError,
            r"no field 'twist.twist.linar.x'; did you mean 'twist.twist.linear.x'",
        ),
        (("/odm.twist",), RecordingError, r"no topic '/odm'"),
        (("/odom",), TypeError, r"'/odom' is not one number; there are /odom.pose.pose.position.x, "),
        (("/odom.child_frame_id",), TypeError, r"is not one number; there are child_frame_id \(string\)"),
        (("/odom.pose.covariance",), TypeError, r"is not one number; there are pose.covariance \(float64\[36\]\)"),
        (("/odom.pose.pose", "/odom.twist.twist"), ValueError, r"expected at most 8 lines, got /odom.pose.pose"),
        ((3,), TypeError, r"expected a topic with a field, like '/odom.twist.twist.linear.x', got 3"),
    ],
)
def test_what_is_not_a_number_of_a_recording_is_refused_with_the_available_ones(
    fields: Any, kind: type[Exception], text: str
) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording, pytest.raises(kind, match=text):
        robowidgets.plot(recording, *fields)
    with pytest.raises(TypeError, match=r"plot\(\) takes a recording or a feed, and fields"):
        robowidgets.plot([1, 2, 3], "v")  # type: ignore[arg-type]


def test_one_number_of_an_array_can_be_plotted() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        assert robowidgets.plot(recording, "/odom.pose.covariance[7]").names == ("/odom.pose.covariance[7]",)


# Pages


def test_a_page_has_the_values_and_is_written_again_after_more_came(plot: PlotWidget, tmp_path: Path) -> None:
    plot.update(v=1.0, time=0.0)
    first = plot.to_html(tmp_path / "plot.html").read_text(encoding="utf-8")
    assert "run" in first
    plot.update(v=2.0, time=1.0)
    assert plot.to_html(tmp_path / "plot.html").read_text(encoding="utf-8") != first
    assert len(sent(plot)[0][1].times) == 2


def test_a_page_of_a_long_line_that_is_on_show_has_its_finer_columns(
    plot: PlotWidget, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    plot.set_line("v", np.arange(100_000) / 1000, np.random.default_rng(3).normal(size=100_000))
    ((_, coarse),) = sent(plot)
    written: list[bytes] = []
    monkeypatch.setattr(
        "robowidgets.export.widget_page.write", lambda widget, *_: written.append(synced(widget, "_lines"))
    )
    plot.to_html(tmp_path / "plot.html")
    ((total, rows),) = rows_of(written[0])
    assert total == 100_000
    assert len(rows.times) > 3.5 * len(coarse.times)
    assert len(sent(plot)[0][1].times) == len(coarse.times)


def test_the_licence_of_the_plot_library_comes_with_its_code() -> None:
    script = (Path(robowidgets.__file__).parent / "static" / "plot_widget.js").read_text(encoding="utf-8")
    assert "Copyright (c) 2022 Leon Sorokin" in script
    assert "THE SOFTWARE IS PROVIDED" in script


class TestWithOthers:
    def test_a_message_adds_the_fields_of_its_topic(self) -> None:
        plot = PlotWidget("/a.v.x", "/a.w[1]", "/b.c.x", "/b.c.cmd")
        plot.update("/a", {"v": {"x": 1.0}, "w": [2, 3]}, time=0.5)
        plot.update("/b.c", {"x": 4, "cmd": True}, time=0.5)
        plot.update("/other", {"x": 4})
        plot.update("/a", None)
        assert {name: plot[name][1].tolist() for name in plot.names} == {
            "/a.v.x": [1.0],
            "/a.w[1]": [3.0],
            "/b.c.x": [4.0],
            "/b.c.cmd": [1.0],
        }
        with pytest.raises(ValueError, match="no field 'w'"):
            plot.update("/a", {"v": {"x": 1.0}})

    def test_units_and_steps_are_known_by_the_names(self) -> None:
        plot = PlotWidget(
            "/odom.twist.twist.linear.x", "/cmd_vel.linear.x", units={"/odom.twist.twist.linear.x": "km/h"}
        )
        assert plot.units == {"/odom.twist.twist.linear.x": "km/h", "/cmd_vel.linear.x": "m/s"}
        assert plot.steps == ["/cmd_vel.linear.x"]

    @pytest.mark.parametrize("fields", [("/odom",), (3,), tuple(f"/a.b[{i}]" for i in range(9))])
    def test_what_is_not_a_field_is_refused(self, fields: tuple[Any, ...]) -> None:
        with pytest.raises((TypeError, ValueError), match=r"a topic with a field|at most 8 lines"):
            PlotWidget(*fields)

    def test_ghosts_are_moved(self) -> None:
        plot = PlotWidget(ghosts=["b"], shift=1.5)
        plot.set_line("a", [0, 1], [0, 1])
        plot.set_line("b", [0, 1], [0, 1])
        rows = [rows for _, rows in sent(plot)]
        assert [row.times.tolist() for row in rows] == [[0, 1], [1.5, 2.5]]
        plot.shift = -0.5
        assert [row.times.tolist() for _, row in sent(plot)] == [[0, 1], [-0.5, 0.5]]

    def test_a_page_adds_lines_and_takes_them_out(self) -> None:
        plot = PlotWidget()
        plot.set_line("a", [0, 1], [0, 1])
        plot.offer(["b", "c"], lambda name: plot.set_line(name, [0], [1]))
        from_page(plot, {"add": "b"})
        assert plot.names == ("a", "b")
        from_page(plot, {"take_out": "a"})
        assert plot.names == ("b",)
        from_page(plot, {"take_out": "a"})
        assert plot.names == ("b",)


class TestTwoRecordings:
    FIELD = "/odom.twist.twist.linear.x"

    def test_the_same_field_of_another_is_a_ghost_by_time(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording, robowidgets.open(robowidgets.SAMPLE) as other:
            plot = robowidgets.plot(recording, self.FIELD, beside=other, shift=2.0)
            assert plot.names == (self.FIELD, f"{self.FIELD} (sample.mcap)")
            assert plot.ghosts == [f"{self.FIELD} (sample.mcap)"]
            assert plot.units[plot.ghosts[0]] == "m/s"

    def test_by_place_it_has_the_values_of_when_the_robot_was_there(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording, robowidgets.open(robowidgets.SAMPLE) as other:
            plot = robowidgets.plot(recording, self.FIELD, beside=other, by="place")
            times, values = plot[plot.ghosts[0]]
            own_times, own = plot[self.FIELD]
            here = own[np.searchsorted(own_times, times, "right") - 1]
            assert np.isfinite(values).all()
            assert np.median(np.abs(values - here)) < 1e-6
            with pytest.raises(ValueError, match=r"no place within 0.5 m"):
                robowidgets.plot(recording, self.FIELD, beside=other, by="place", origin=(100, 0, 0))

    def test_what_makes_no_sense_is_refused(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            with pytest.raises(TypeError, match="beside: expected another recording"):
                robowidgets.plot(recording, self.FIELD, beside=3)  # type: ignore[arg-type]
            with pytest.raises(ValueError, match="by: expected 'time' or 'place'"):
                robowidgets.plot(recording, self.FIELD, beside=recording, by="here")

    def test_a_condition_marks_its_spans(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            backward = robowidgets.conditions.field(self.FIELD) < 0
            plot = robowidgets.plot(recording, self.FIELD, marks=backward)
            assert len(plot.marks) == 6
            assert plot.marks[0][2] == f"{self.FIELD} < 0"


def test_a_player_has_the_fields_in_one_plot_that_follows_its_time() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        player = recording.show("/scan", "/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x")
    (plot,) = (view.widget for view in player.views if isinstance(view.widget, PlotWidget))
    assert plot.names == ("/odom.twist.twist.linear.x", "/cmd_vel.twist.linear.x")
    assert plot.model_id in synced(player.bar, "_followers")
    (view,) = (view for view in player.views if view.widget is plot)
    times = [timed.seconds for timed in view.track.frames(10.0, 11.0)]
    before = [max(plot[name][0][plot[name][0] <= 10.0]) for name in plot.names]
    assert times[0] == max(before), "the last value holds until the next"
    assert 20 <= len(times) <= 42
    assert times == sorted(times)
    player.close()


def test_a_player_of_fields_steps_from_value_to_value() -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        player = recording.show("/bumper.bumper")
    values = sorted({moment.seconds for moment in player.recording.samples("/bumper")})
    (view,) = player.views
    assert values[0] > 12
    assert [timed.seconds for timed in view.track.frames(8.0, 9.0)] == [-1.0], "there is no value yet"
    later = [timed.seconds for i in range(int(values[0]), 59) for timed in view.track.frames(i, i + 1)]
    assert sorted({*later}) == pytest.approx([-1.0, *values])
    player.close()


def test_a_player_of_fields_alone_plays_and_a_page_has_it(tmp_path: Path) -> None:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        player = recording.show("/odom.twist.twist.linear.x")
        names = [view.widget.names for view in player.views]
        player.close()
        assert names == [("/odom.twist.twist.linear.x",)]
        page = recording.to_html(tmp_path / "plot.html", topics=["/odom.twist.twist.linear.x"], start=10, end=20)
        assert page.stat().st_size < 1_000_000
        with pytest.raises(KeyError, match=r"did you mean .twist.twist.linear.x."):
            recording.show("/odom.twist.twist.linea.x")


def test_a_topic_of_numbers_is_plotted_in_a_player_and_in_a_page(tmp_path: Path) -> None:
    messages = [(i / 10, "/lux", {"illuminance": float(i)}) for i in range(20)]
    folder = recorded.write(tmp_path / "x", {"/lux": "sensor_msgs/msg/Illuminance"}, messages)
    with robowidgets.open(folder) as recording:
        for topics in ((), ("/lux",)):
            player = recording.show(*topics)
            (plot,) = (view.widget for view in player.views)
            assert plot["/lux.illuminance"][1].tolist() == [float(i) for i in range(20)]
            assert plot.units == {"/lux.illuminance": "lx"}
            player.close()
        assert recording.to_html(tmp_path / "x.html", topics=["/lux"]).stat().st_size < 1_000_000
