"""The same place in two recordings: by the odometry of both, in Python and by two players."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

from robowidgets import compare
from robowidgets.poses.places import Places
from robowidgets.recording import open
from robowidgets.recordings import RecordingError
from robowidgets.recordings.odometry import places_of
from robowidgets.samples import Pose
from robowidgets.screens.player import Player

from ..pages import synced
from . import corridor, recorded, sweeps
from .recorded import START_NS

ORIGIN = Pose(1.0, 2.0, pi / 2)

Show = Callable[[str], Player]


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The runs fast (forth and back), slow (forth, at half the speed), elsewhere (slow, with another origin)."""
    folder = tmp_path_factory.mktemp("runs")
    corridor.write(folder / "fast")
    corridor.write(folder / "slow", speed=0.4)
    corridor.write(folder / "elsewhere", speed=0.4, origin=ORIGIN)
    corridor.write(folder / "blind", odometry=False)
    return folder


@pytest.fixture
def show(runs: Path) -> Iterator[Show]:
    made: list[Player] = []

    def show(name: str) -> Player:
        with open(runs / name) as recording:
            made.append(recording.show(scanogram=False))
        return made[-1]

    yield show
    for player in made:
        player.close()


def test_a_recording_tells_when_the_robot_was_at_a_place(runs: Path) -> None:
    with open(runs / "fast") as fast, open(runs / "slow") as slow:
        pose = fast.at("/odom", 2.0).sample.pose
        assert slow.seconds_near(pose) == pytest.approx(4.0)
        assert (fast.at("/scan", 2.0).sample - slow.at("/scan", 4.0).sample) == pytest.approx(0.0, abs=1e-6)
        on_the_way_back = fast.at("/odom", 8.0).sample.pose
        assert on_the_way_back.x == pytest.approx(pose.x)
        assert slow.seconds_near(on_the_way_back) is None, "the heading is another one"
        assert slow.seconds_near((4.4, 0, "0deg"), within=0.3) is None
        assert slow.seconds_near((4.4, 0, "0deg")) == pytest.approx(10.0)


def test_the_place_of_a_scan_is_between_two_poses_and_unknown_long_after_the_last(tmp_path: Path) -> None:
    poses = [
        (seconds, "/odom", {"pose": {"pose": {"orientation": {"z": sin(yaw / 2), "w": cos(yaw / 2)}}}})
        for seconds, yaw in ((0.0, 3.0), (1.0, -3.0))
    ]
    scans = [(seconds, "/scan", sweeps.scan(START_NS, [1.0])) for seconds in (0.5, 1.9, 2.1)]
    path = recorded.write(tmp_path / "turn", {"/odom": "nav_msgs/msg/Odometry", "/scan": sweeps.TYPE}, poses + scans)
    with open(path) as recording:
        assert places_of(recording).poses[:, 2] == pytest.approx([pi, 2 * pi - 3.0, np.nan], nan_ok=True)


def test_the_place_of_a_scan_is_unknown_while_odometry_was_silent(tmp_path: Path) -> None:
    poses = [
        (seconds, "/odom", {"pose": {"pose": {"position": {"x": x}, "orientation": {"w": 1.0}}}})
        for seconds, x in ((0.0, 0.0), (60.0, 10.0), (61.0, 11.0))
    ]
    scans = [(seconds, "/scan", sweeps.scan(START_NS, [1.0])) for seconds in (0.0, 30.0, 58.9, 60.0, 60.5)]
    path = recorded.write(tmp_path / "gap", {"/odom": "nav_msgs/msg/Odometry", "/scan": sweeps.TYPE}, poses + scans)
    with open(path) as recording:
        assert places_of(recording).poses[:, 0] == pytest.approx([0.0, np.nan, np.nan, 10.0, 10.5], nan_ok=True)
        assert recording.seconds_near((5.0, 0.0, 0.0)) is None


def test_what_is_not_a_place_is_refused(runs: Path) -> None:
    with open(runs / "slow") as slow, open(runs / "blind") as blind:
        with pytest.raises(RecordingError, match=r"blind has no odometry.*record nav_msgs/Odometry"):
            blind.seconds_near((0, 0, 0))
        with pytest.raises(TypeError, match=r"pose: expected x and y in metres and yaw in radians, got \(1, 2\)"):
            slow.seconds_near((1, 2))
        with pytest.raises(ValueError, match="pose: expected a finite number of metres, got nan"):
            slow.seconds_near((np.nan, 0, 0))
        with pytest.raises(ValueError, match="within: expected a finite number of metres, got nan"):
            slow.seconds_near((0, 0, 0), within=np.nan)


def test_a_player_follows_another_to_the_same_place_and_stays_if_there_is_none(show: Show) -> None:
    fast, slow = show("fast"), show("slow")
    fast.time = 1.0
    slow.follow(fast)
    assert slow.time == pytest.approx(2.0)
    fast.time = 3.0
    assert slow.time == pytest.approx(6.0)
    lasers = [player.views[0].widget for player in (fast, slow)]
    assert lasers[0].scan - lasers[1].scan == pytest.approx(0.0, abs=1e-6)
    fast.time = 8.0
    assert slow.time == pytest.approx(6.0)
    slow.time = 1.0
    assert fast.time == 8.0
    slow.follow(None)
    fast.time = 3.0
    assert slow.time == 1.0
    assert synced(slow.bar, "_leader") == {}


def test_the_page_gets_when_and_where_to(show: Show) -> None:
    fast, slow = show("fast"), show("slow")
    slow.follow(fast, within=0.25)
    state = synced(slow.bar, "_leader")
    times, seconds = (np.frombuffer(state[name]) for name in ("times", "seconds"))
    assert state["model"] == fast.bar.model_id
    assert state["lost"] == "no place within 0.25 m of fast"
    assert times == pytest.approx(np.arange(101) / 10)
    assert seconds[[0, 20, 50]] == pytest.approx([0.0, 4.0, 10.0])
    assert np.isnan(seconds[51:]).all()


def test_a_follower_takes_the_place_where_its_odometry_starts(show: Show) -> None:
    fast, elsewhere = show("fast"), show("elsewhere")
    elsewhere.follow(fast, origin=(1, 2, "90deg"))
    fast.time = 3.0
    assert elsewhere.time == pytest.approx(6.0)
    with pytest.raises(ValueError, match=r"elsewhere never comes within 0\.5 m of a place of fast, .* give origin="):
        elsewhere.follow(fast)
    fast.time = 2.0
    assert elsewhere.time == pytest.approx(4.0), "it follows as before"


def test_a_player_whose_scans_and_poses_have_different_times_follows_no_player(show: Show, tmp_path: Path) -> None:
    pose = (0.0, "/odom", {"pose": {"pose": {"orientation": {"w": 1.0}}}})
    scan = (5.0, "/scan", sweeps.scan(START_NS, [1.0]))
    path = recorded.write(tmp_path / "late", {"/odom": "nav_msgs/msg/Odometry", "/scan": sweeps.TYPE}, [pose, scan])
    with pytest.raises(ValueError, match=r"^follow: in late or in fast, no scan was made within 1 s of a pose of odom"):
        show(str(path)).follow(show("fast"))


def test_a_player_that_cannot_be_followed_is_refused(show: Show) -> None:
    fast, slow, blind = show("fast"), show("slow"), show("blind")
    slow.follow(fast)
    for player, other in ((fast, fast), (fast, slow)):
        with pytest.raises(ValueError, match="expected another player, which does not follow this one; got <Player"):
            player.follow(other)
    for player, other in ((fast, blind), (blind, fast)):
        with pytest.raises(RecordingError, match="blind has no odometry"):
            player.follow(other)
    with pytest.raises(TypeError, match="follow: expected another player or None, got Recording"):
        fast.follow(slow.recording)  # type: ignore[arg-type]


def test_a_follower_that_is_closed_lets_the_other_go_on(show: Show) -> None:
    fast, slow = show("fast"), show("slow")
    slow.follow(fast)
    slow.close()
    fast.time = 3.0
    assert fast.time == 3.0


def test_a_page_in_a_file_follows_no_player(show: Show, tmp_path: Path) -> None:
    slow = show("slow")
    slow.follow(show("fast"))
    assert slow.to_html(tmp_path / "slow.html").is_file()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("file", "until", "most"), [("good/turtlebot3_gazebo.bag", 46.0, 0.1), ("good/edmonton.log.gz", 450.0, 0.5)]
)
def test_real_scans_of_a_second_round_resemble_the_first(data: Path, file: str, until: float, most: float) -> None:
    with open(data / file) as recording:
        places, topic = places_of(recording), recording.scans().topic
        first, second = (
            Places(places.seconds[rows], places.poses[rows])
            for rows in (places.seconds < until, places.seconds >= until)
        )
        seconds, apart = second.nearest(first)
        same = apart <= 0.5
        assert same.sum() >= 10

        def difference(one: float, other: float) -> float:
            scans = (recording.at(topic, time) for time in (one, other))
            before, after = (moment.sample for moment in scans if moment)
            change = np.abs(before - after)
            return float(np.median(change[np.isfinite(change)]))

        there = [difference(*times) for times in zip(first.seconds[same], seconds[same], strict=True)]
        later = [difference(*times) for times in zip(first.seconds[same], seconds[same] - 10, strict=True)]
        assert np.median(there) < most < np.median(later) / 4


def test_a_topic_of_odometry_without_a_message_is_not_the_one_that_counts(tmp_path: Path) -> None:
    topics = dict.fromkeys(("/camera/odom", "/odom"), "nav_msgs/msg/Odometry")
    way = [
        (i / 10, "/odom", {"pose": {"pose": {"position": {"x": i / 10}, "orientation": {"w": 1.0}}}}) for i in range(20)
    ]
    path = recorded.write(tmp_path / "run", topics, way)
    with open(path) as recording:
        assert recording.seconds_near((0.5, 0.0, 0.0)) == pytest.approx(0.5)
    assert compare(path, path).map is not None
