"""The ring of a Pioneer: sixteen topics, one widget, live and in a recording; a program drives by them."""

from __future__ import annotations

from collections.abc import Iterator
from math import cos, inf, isnan, nan, sin
from pathlib import Path

import numpy as np
import pytest

import robowidgets
from robowidgets import SonarWidget, feeds
from robowidgets.behaviors import Drive, simulate
from robowidgets.feeds import Advert, Feed
from robowidgets.poses.mounts import mounts_of
from robowidgets.poses.transforms import Transform
from robowidgets.recording import Recording
from robowidgets.samples import Ranges
from robowidgets.simulator import Robot, World
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..feeds.scripted import SCAN, Scripted
from ..recordings import recorded
from ..recordings.recorded import START_NS, stamped
from ..waiting import wait_for

RANGE = "sensor_msgs/msg/Range"
RING = [f"/sonar/{end}_{i}" for end in ("front", "rear") for i in range(8)]
SONARS, CLIFF = [Advert(name, RANGE) for name in RING], Advert("/cliff/left", RANGE)
DISTANCE = {"header": {"frame_id": "front"}, "min_range": 0.1, "max_range": 5.0, "field_of_view": 0.26}
NOTHING_BELOW = {**DISTANCE, "min_range": 0.1, "max_range": 0.1, "range": inf}


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Three seconds at 5 Hz: at second s every sonar measures 3 m - s; another sensor reports a floor."""
    names = [*RING, CLIFF.name]
    messages = (
        (i / 5, name, {**here, "header": stamped(START_NS + i * 200_000_000, name[1:].replace("/", "_"))})
        for i in range(16)
        for name in names
        for here in [NOTHING_BELOW if name == CLIFF.name else {**DISTANCE, "range": 3.0 - i / 5}]
    )
    return recorded.write(tmp_path_factory.mktemp("ring") / "drive", dict.fromkeys(names, RANGE), messages)


@pytest.fixture
def recording(path: Path) -> Iterator[Recording]:
    with robowidgets.open(path) as opened:
        yield opened


def test_distances_are_sonars_and_binary_rangers_stay_touches(recording: Recording) -> None:
    assert {topic.name: topic.widget for topic in recording.topics} == {
        **dict.fromkeys(RING, "sonar"),
        CLIFF.name: "touch",
    }
    assert recording.problems == ()


def test_a_player_shows_the_ring_in_one_widget(recording: Recording, tmp_path: Path) -> None:
    player = recording.show()
    try:
        touch, ring = player.views
        assert isinstance(ring.widget, SonarWidget)
        assert (touch.choice.topic, ring.widget.title) == (CLIFF.name, "/sonar")
        player.time = 1.3
        assert {name: one.distance for name, one in ring.widget.ranges.items()} == {
            name.rpartition("/")[2]: pytest.approx(1.8) for name in RING
        }
        frames = list(ring.track.frames(1.0, 2.0))
        assert [frame.seconds for frame in frames] == pytest.approx([1.0, 1.0, 1.2, 1.4, 1.6, 1.8])
        page = player.to_html(tmp_path / "ring.html").read_text()
    finally:
        player.close()
    assert " · /cliff/left, /sonar" in page


def test_a_series_has_ranges_and_distances(path: Path) -> None:
    odd = [{**DISTANCE, "range": number} for number in (1.5, inf, -inf, nan, 0.05, 6.0)]
    folder = recorded.write(
        path.parent / "odd", {RING[0]: RANGE}, [(i / 10, RING[0], message) for i, message in enumerate(odd)]
    )
    with robowidgets.open(folder) as recording:
        series = recording.series(RING[0])
        assert series.ranges.tolist()[:3] == [1.5, inf, -inf]
        assert series.distances.tolist()[:3] == [1.5, inf, 0.0]
        assert isnan(series.distances[3])
        assert series.distances.tolist()[4:] == [0.0, inf]
        assert series[4:].distances.tolist() == [0.0, inf]
        assert list(series.to_pandas()) == ["range", "distance"]


def test_a_function_of_sonars_finds_as_it_drives(recording: Recording) -> None:
    def is_near(sonars: Ranges) -> bool:
        return sonars["front_3"].distance < 1.1

    (span,) = recording.find(is_near)
    assert (span.start, span.end) == (pytest.approx(2.0), pytest.approx(3.0))
    ring = SonarWidget()
    watch = ring.watch(is_near)
    assert recording.find(watch)[0].start == pytest.approx(2.0)


def test_a_view_of_a_robot_whose_messages_tell_what_they_are() -> None:
    script = Scripted(SCAN, *SONARS, CLIFF)
    with Feed(script) as feed:
        view = feed.show()
        assert list(view.widgets) == ["/scan"]
        for advert in SONARS[:4]:
            script.listener.on_message(advert.name, {**DISTANCE, "range": 1.0})
        script.listener.on_message(CLIFF.name, NOTHING_BELOW)
        ring = view.widgets[RING[0]]
        assert {name for name, widget in view.widgets.items() if widget is ring} == set(RING[:4])
        assert {topic.name: topic.widget for topic in feed.topics if topic.name == CLIFF.name} == {CLIFF.name: "touch"}
        for advert in SONARS:
            script.listener.on_message(advert.name, {**DISTANCE, "range": 1.0})
            script.listener.on_message(advert.name, {**DISTANCE, "range": 2.0})
        assert [one.distance for one in ring.ranges.values()] == [2.0] * 16
        assert list(ring.ranges) == [name.rpartition("/")[2] for name in RING]


def test_a_program_asks_for_sonars_without_a_view() -> None:
    script = Scripted(SONARS[0], SONARS[1], CLIFF)
    with Feed(script) as feed:
        got: list[Ranges] = []
        program = feed.program(lambda sonars: got.append(sonars), rate=100)
        wait_for(lambda: program.waiting == "waiting for a topic with sonars", "no message has reported it yet")
        script.listener.on_message(CLIFF.name, NOTHING_BELOW)

        def sends() -> bool:
            for advert in SONARS[:2]:
                script.listener.on_message(advert.name, {**DISTANCE, "range": 1.5})
            return bool(got) and len(got[-1]) == 2

        wait_for(sends, "it gets both")
        assert [one.distance for one in got[-1].values()] == [1.5, 1.5]


def test_a_pioneer_drives_by_its_sonars_and_is_recorded_with_them(tmp_path: Path) -> None:
    def avoid(sonars: Ranges) -> Drive:
        return Drive(0.3) if min(sonars["front_3"].distance, sonars["front_4"].distance) > 0.8 else Drive(0, 0.8)

    with feeds.simulator("pioneer", wander=False) as feed:
        view = feed.show()
        wait_for(lambda: view.widgets.keys() >= set(RING), "each has reported its kind")
        ring = view.widgets[RING[0]]
        assert all(view.widgets[name] is ring for name in RING)
        with feed.record(tmp_path / "run.mcap") as recorder:
            program = feed.program(avoid)
            wait_for(lambda: all(recorder.written[name] > 2 for name in RING), "all sonars were written")
            wait_for(lambda: feed.robot.speed().linear[0] > 0, "it drives")
        assert (program.mode, program.waiting, recorder.problems) == ("running", "", ())
        assert len(ring.wait()) == 16
    with robowidgets.open(tmp_path / "run.mcap") as again:
        assert {topic.widget for topic in again.topics if topic.name in RING} == {"sonar"}
        sample = again.at(RING[0], again.duration)
        assert sample is not None
        assert (sample.sample.radiation, sample.sample.frame_id) == ("ultrasound", "sonar_front_0")


def test_a_simulated_program_gets_sonars_and_a_robot_without_says_so() -> None:
    got: list[Ranges] = []
    list(simulate(lambda sonars: got.append(sonars), Robot(World.rooms(), model="pioneer"), 0.2, rate=10))
    assert [len(ranges) for ranges in got] == [16, 16]
    assert max(got[1].behind.values()) > 0, "they measure one after the other"
    with pytest.raises(
        ValueError, match="asks for sonars, but the simulated robot has no sonars: remove the parameter"
    ):
        list(simulate(lambda sonars: got.append(sonars), Robot(World.rooms()), 0.2))


STATIC = "/tf_static"
SONAR_AT = {"front_0": (0.1, 0.2, 1.5), "rear_0": (-0.2, 0.0, 3.0)}


def _transform(parent: str, child: str, x: float, y: float, yaw: float) -> dict:
    rotation = {"x": 0.0, "y": 0.0, "z": sin(yaw / 2), "w": cos(yaw / 2)}
    transform = {"translation": {"x": x, "y": y, "z": 0.3}, "rotation": rotation}
    return {"header": stamped(START_NS, parent), "child_frame_id": child, "transform": transform}


@pytest.mark.parametrize("slash", ["", "/"])  # ROS 1 may write the names of frames with a leading slash
def test_a_player_has_each_sonar_at_its_place_by_tf_and_knows_which_one_went_silent(tmp_path: Path, slash: str) -> None:
    tree = [_transform("base_footprint", "base_link", 9.0, 9.0, 1.0), _transform("base_link", "ring", 0.1, 0.0, 0.0)]
    tree += [_transform("ring", f"sonar_{name}", x - 0.1, y, yaw) for name, (x, y, yaw) in SONAR_AT.items()]
    messages = [(0.0, STATIC, {"transforms": tree})]
    for i in range(40):
        for name in ("front_0", "rear_0", "side"):
            if name != "rear_0" or i < 20:
                fields = {**DISTANCE, "range": 1.0, "header": stamped(START_NS, f"{slash}sonar_{name}")}
                messages.append((i / 4, f"/sonar/{name}", fields))
    types = {STATIC: "tf2_msgs/msg/TFMessage", **{f"/sonar/{name}": RANGE for name in ("front_0", "rear_0", "side")}}
    with robowidgets.open(recorded.write(tmp_path / "drive", types, messages)) as recording:
        player = recording.show()
        try:
            (ring,) = player.views
            assert ring.widget.poses == {name: pytest.approx(pose) for name, pose in SONAR_AT.items()}
            (frame,) = ring.track.frames(9.0, 9.0)
            columns = np.frombuffer(frame.frame, "<f4", offset=FRAME_HEADER.size + 8).reshape(9, 3)
            assert columns[1].tolist() == pytest.approx([0.0, 4.25, 0.0])
            assert columns[2].tolist() == [2.0, 2.0, 2.0]
        finally:
            player.close()


def test_a_ring_that_a_feed_recorded_has_its_places(tmp_path: Path) -> None:
    with feeds.simulator("pioneer", wander=False) as feed, feed.record(tmp_path / "drive.mcap") as recorder:
        wait_for(lambda: recorder.written["/sonar/rear_7"] > 1, "it was recorded")
        assert recorder.written["/tf_static"] == len(RING)
        poses = feed.robot.sonars.poses
    with robowidgets.open(tmp_path / "drive.mcap") as recording:
        player = recording.show()
        try:
            ring = next(view.widget for view in player.views if isinstance(view.widget, SonarWidget))
            assert ring.poses == {name: pytest.approx(pose) for name, pose in poses.items()}
        finally:
            player.close()


def test_only_what_static_transforms_lead_to_is_mounted() -> None:
    def at(parent: str, child: str, x: float, *, static: bool = True) -> Transform:
        return Transform(parent, child, 0, 0, (x, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0), static)

    tree = [at("base_footprint", "foot", 1.0), at("a", "b", 1.0), at("b", "a", 1.0), at("odom", "base_link", 5.0)]
    tree += [at("base_link", "arm", 1.0, static=False), at("arm", "hand", 2.0), at("base_link", "eye", 3.0)]
    assert mounts_of(tree) == {"foot": (1, 0, 0), "eye": (3, 0, 0), "base_link": (0, 0, 0)}
