"""The gas sensor of the page on a new sensor is listed, found, played and fed like the sensors of robowidgets."""

from __future__ import annotations

import logging
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

import robowidgets
from robowidgets import RecordingError, conditions, feeds
from robowidgets.behaviors import simulate
from robowidgets.behaviors.machine import Machine
from robowidgets.feeds import Advert, Feed
from robowidgets.kinds import KINDS, add_installed, kind_of_type
from robowidgets.recording import Recording
from robowidgets.recordings import UnknownTopicError
from robowidgets.simulator import Robot, World

from ... import gas_package
from ..feeds.scripted import SCAN, Scripted
from ..waiting import wait_for

GAS, STATUS = Advert("/gas", gas_package.GAS), Advert("/gas/status", gas_package.STATUS)
BROKEN = {
    "absent": "gas_sensor.row:ABSENT",
    "lost": "no_such_module:ROW",
    "taken": "taken_room:TAKEN",
    "word": "gas_sensor.row:__name__",
}
"""Entry points that cannot be used."""
TAKEN = """
from dataclasses import replace
from gas_sensor.row import GAS

TAKEN = replace(GAS, name="laser")
"""


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Path]:
    folder = tmp_path_factory.mktemp("site")
    (folder / "taken_room.py").write_text(TAKEN)
    with gas_package.installed(folder, BROKEN):
        yield folder


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return gas_package.drive(tmp_path_factory.mktemp("gas") / "drive")


@pytest.fixture(autouse=True)
def _rows(site: Path) -> None:
    add_installed()


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def test_its_topics_are_listed_with_its_widget(recording: Recording) -> None:
    assert {topic.name: topic.widget for topic in recording.topics} == {
        "/gas": "gas", "/gas/status": "gas_status", "/cliff": "touch"
    }  # fmt: skip
    assert recording.problems == ()
    rows = [line.split() for line in recording.info().splitlines()]
    assert {row[0]: row[-1] for row in rows if row and row[0].startswith("/gas")} == {
        "/gas": "gas", "/gas/status": "gas"
    }  # fmt: skip


def test_samples_come_in_the_order_of_time_with_their_stamp(recording: Recording) -> None:
    moments = list(recording.samples("/gas"))
    assert [moment.sample.ppm for moment in moments] == [10.0 * i for i in range(gas_package.COUNT)]
    assert moments[30].sample.stamp_ns == moments[30].time_ns
    assert [moment.sample.text for moment in recording.samples("/gas/status")] == ["warming up", "ok"]
    assert recording.at("/gas/status", 1.0).sample.text == "warming up"


def test_a_series_has_their_times_and_samples(recording: Recording) -> None:
    series = recording.series("/gas")
    assert len(series) == gas_package.COUNT
    assert series.seconds.tolist() == pytest.approx([i * gas_package.STEP for i in range(gas_package.COUNT)])
    assert [moment.sample.ppm for moment in series[10:13]] == [100.0, 110.0, 120.0]
    assert sum(len(chunk) for chunk in series.chunks()) == gas_package.COUNT


def test_a_topic_of_another_kind_is_refused_in_the_words_of_the_row(recording: Recording) -> None:
    with pytest.raises(UnknownTopicError, match="'/gas' is a topic of gas sensors; topics of laser scans: none"):
        recording.scans("/gas")


def test_a_function_finds_by_the_names_of_both_samples(recording: Recording) -> None:
    spans = recording.find(lambda moment: moment.gas.ppm > 200)
    assert [(span.start, span.end) for span in spans] == [(pytest.approx(2.1), pytest.approx(4.9))]
    both = recording.find(lambda gas, gas_status: gas.ppm > 100 and gas_status.text == "warming up")
    assert [(span.start, span.end) for span in both] == [(pytest.approx(1.1), pytest.approx(2.0))]
    with pytest.raises(RecordingError, match=r"no 'volume' here: there are scan, speed, touch, .*gas"):
        recording.find(lambda moment: moment.volume > 2)


def test_a_silence_of_them_is_a_gap(recording: Recording) -> None:
    assert not recording.find(conditions.gap(0.15, "/gas"))
    spans = recording.find(conditions.gap(0.05, "/gas"))
    assert spans
    assert {span.silent for span in spans} == {("/gas",)}


def test_a_player_shows_both_topics_in_one_widget_at_any_time(recording: Recording) -> None:
    player = recording.show()
    try:
        assert [type(view.widget).__name__ for view in player.views] == ["TouchWidget", "GasWidget"]
        view = player.views[1]
        assert view.choice.topics == ("/gas", "/gas/status")
        for seconds, shown in ((3.05, "{'status': 'ok'}"), (0.55, "{'status': 'warming up'}")):
            player.time = seconds
            assert str(view.widget.get_state()["_about"]) == shown
            assert view.widget.wait(0).ppm == pytest.approx(100 * int(seconds * 10) / 10)
        frames = list(view.track.frames(1.85, 2.15))
        assert [frame.seconds for frame in frames] == pytest.approx([1.8, 1.9, 2.0, 2.0, 2.1])
        assert [frame.about["status"] for frame in frames] == ["warming up"] * 2 + ["ok"] * 3
        assert [frame.about["new"] for frame in frames] == [["gas"], ["gas"], ["status"], ["gas"], ["gas"]]
        _, packed = view.widget.frame_of(recording.at("/gas", 1.8).sample)
        assert frames[0].frame.endswith(packed)
    finally:
        player.close()


def test_a_player_shows_its_status_alone_as_a_message(recording: Recording) -> None:
    player = recording.show("/gas/status")
    try:
        assert [type(view.widget).__name__ for view in player.views] == ["MessageWidget"]
    finally:
        player.close()


def test_a_robot_feeds_them() -> None:
    script = Scripted(GAS, STATUS, SCAN)
    with Feed(script) as feed:
        view = feed.show()
        assert {name: type(widget).__name__ for name, widget in view.widgets.items()} == {
            "/scan": "LaserWidget", "/gas": "GasWidget"
        }  # fmt: skip
        widget = view.widgets["/gas"]
        script.listener.on_message("/gas/status", {"status": "warming up"})
        wait_for(lambda: widget.get_state()["_about"].get("status") == "warming up", "the status before a sample")
        script.listener.on_message("/gas", {"ppm": 2.5})
        assert widget.wait().ppm == 2.5
        assert widget.get_state()["_about"] == {"status": "warming up"}
        script.listener.on_message("/gas", {"ppm": "much"})
        wait_for(lambda: "error" in widget.get_state()["_about"], "its widget says so")


def test_each_of_several_sensors_has_the_status_of_its_own() -> None:
    names = ("/gas_left", "/gas_right", "/hall/gas")
    adverts = [Advert(f"{name}{end}", one.type) for name in names for end, one in (("/status", STATUS), ("", GAS))]
    script = Scripted(*adverts)
    with Feed(script) as feed:
        widgets = feed.show().widgets
        assert tuple(widgets) == names
        for name in names:
            script.listener.on_message(f"{name}/status", {"status": name})
        for name in names:
            shown = lambda widget=widgets[name]: widget.get_state()["_about"].get("status")  # noqa: E731
            wait_for(lambda name=name, shown=shown: shown() == name, "its own status")


def test_a_recording_feeds_them(path: Path) -> None:
    with feeds.recording(path, speed=20.0, loop=True) as feed:
        widget = feed.show("/gas", "/gas/status").widgets["/gas"]
        wait_for(lambda: widget.get_state()["_about"].get("status") == "ok", "the status")
        values: list[float] = []
        feed.connect("/gas", lambda sample: values.append(sample.ppm))
        wait_for(lambda: len(values) > 3, "four samples")


def test_without_its_row_the_topics_are_only_listed(path: Path) -> None:
    del KINDS["gas"], KINDS["gas_status"]
    assert kind_of_type(gas_package.GAS) is None
    with robowidgets.open(path) as recording:
        assert {topic.name: topic.widget for topic in recording.topics} == {
            "/gas": None, "/gas/status": None, "/cliff": "touch"
        }  # fmt: skip
    add_installed.cache_clear()


def test_rerun_which_the_row_does_not_name_leaves_them_out(recording: Recording, tmp_path: Path) -> None:
    chunk = pytest.importorskip("rerun.chunk", reason="Rerun is not installed: pip install 'robowidgets[rerun]'")
    written = chunk.RrdReader(recording.to_rerun(tmp_path / "gas.rrd")).stream().collect().stream()
    entities = {piece.entity_path for piece in written}
    assert any("cliff" in entity for entity in entities)
    assert not any("gas" in entity for entity in entities)


def test_a_program_gets_them_if_the_robot_has_the_sensor() -> None:
    class Tank:
        def filling(gas=None, gas_status=None): ...  # noqa: N805

        emptying = None
        moves = "filling -> emptying after 1"

    assert {"gas", "gas_status"} <= {*Machine(Tank).asks_for}
    with pytest.raises(
        ValueError, match="a program asks for gas, but the simulated robot has no gas sensors: remove the parameter"
    ):
        next(simulate(lambda gas: gas, Robot(World.rooms()), 1.0))


def test_broken_rows_of_other_packages_are_logged_by_name_and_left_out(caplog: pytest.LogCaptureFixture) -> None:
    add_installed.cache_clear()
    with caplog.at_level(logging.WARNING):
        for _ in range(2):
            add_installed()
    texts = sorted(record.getMessage() for record in caplog.records)
    assert [text.partition(": ")[0] for text in texts] == [
        f"the room {name!r} of {place} is left out, update its package" for name, place in BROKEN.items()
    ]
    assert "AttributeError" in texts[0]
    assert "ModuleNotFoundError" in texts[1]
    assert "name: expected an identifier other than" in texts[2]
    assert "expected a kinds.Kind or a kinds.OnDemandWidget, got 'gas_sensor.row'" in texts[3]


def test_a_widget_that_cannot_be_imported_leaves_other_widgets_alone(
    path: Path, site: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "gas_sensor.gas_widget", None)
    with feeds.Feed(Scripted(GAS)) as feed:
        laser = robowidgets.LaserWidget()
        feed.connect("/scan", laser)
        with pytest.raises(ModuleNotFoundError, match="gas_widget"):
            feed.show("/gas")


def test_reading_a_recording_imports_no_widget(site: Path, path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delitem(sys.modules, "gas_sensor.gas_widget", raising=False)
    with robowidgets.open(path) as recording:
        assert recording.at("/gas", 1.0) is not None
    assert "gas_sensor.gas_widget" not in sys.modules
