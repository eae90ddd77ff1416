"""The frames that are sent ahead to the page equal the frames that the widgets show at each time."""

from __future__ import annotations

import json
import random
import struct
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from robowidgets import SAMPLE, LaserWidget, PathWidget, SpeedWidget, TouchWidget
from robowidgets.recording import open
from robowidgets.screens.player import Player
from robowidgets.touch.frames import TICK
from robowidgets.tracks import NEW, pack
from robowidgets.widget.timed_frame import FRAME_HEADER, TimedFrame

from ..pages import parse_sample
from . import robot


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return robot.write(tmp_path_factory.mktemp("recordings") / "drive")


@pytest.fixture
def player(path: Path) -> Iterator[Player]:
    with open(path) as recording:
        player = recording.show()
    yield player
    player.close()


def shown_at(frames: list[TimedFrame], seconds: float) -> TimedFrame:
    return [timed for timed in frames if timed.seconds <= seconds][-1]


def agree(player: Player, seed: int) -> None:
    times = random.Random(seed)
    for _ in range(12):
        seconds = times.uniform(0, player.recording.duration)
        start = float(int(seconds))
        player.time = seconds
        for view in player.views:
            timed = shown_at(list(view.track.frames(start, start + 1)), seconds)
            frame, about = view.widget.get_state()["_frame"], view.widget.get_state()["_about"]
            about_frame = {name: text for name, text in timed.about.items() if name != NEW}
            assert about == about_frame, (seconds, view.choice.topic)
            if isinstance(view.widget, SpeedWidget):
                was, now = parse_sample(view.widget, frame), parse_sample(view.widget, timed.frame)
                assert repr((was.measured, was.commanded)) == repr((now.measured, now.commanded)), seconds
            elif isinstance(view.widget, LaserWidget | PathWidget):
                assert frame[FRAME_HEADER.size :] == timed.frame[FRAME_HEADER.size :], (seconds, view.choice.topic)
            else:
                states = view.widget.states
                assert {row[0]: row[1] for row in rows(timed)} == {n: s.name.lower() for n, s in states.items()}
                ages = {row[0]: row[3] for row in rows(timed)}
                for name, _, _, age in rows(TimedFrame(0, {}, frame)):
                    assert age is None or 0 <= age - ages[name] <= TICK + 1e-6


def rows(timed: TimedFrame) -> list:
    return json.loads(timed.frame[FRAME_HEADER.size :])


def test_a_robot_that_drives(player: Player) -> None:
    agree(player, 1)


@pytest.mark.slow
@pytest.mark.parametrize("name", ["good/neato_fsm", "good/turtlebot3_gazebo.bag", "good/tilt_laser.bag"])
def test_a_real_robot(data: Path, name: str) -> None:
    with open(data / name) as recording:
        player = recording.show()
    agree(player, 2)
    player.close()


def test_each_segment_begins_with_what_holds_and_goes_on_in_order(player: Player) -> None:
    for track in [view.track for view in player.views]:
        for start in (0.0, 3.0, 10.0):
            seconds = [timed.seconds for timed in track.frames(start, start + 1)]
            assert seconds[0] <= start
            assert all(start <= later for later in seconds[1:])
            assert seconds == sorted(seconds)
            assert seconds[-1] < start + 1


def news(player: Player, kind: type, role: str = "") -> list[float]:
    """The times of the frames of a widget with a new sample, segment by segment as the page reads them."""
    (view,) = (view for view in player.views if isinstance(view.widget, kind))
    found = []
    for start in range(int(player.recording.duration) + 1):
        held, *rest = view.track.frames(start, start + 1)
        if held.seconds >= start and (not rest or held.seconds != rest[0].seconds):
            rest.insert(0, held)
        for timed in rest:
            roles = timed.about.get(NEW, [role])
            if role in roles or (roles and not role):
                found.append(timed.seconds)
    return found


@pytest.mark.parametrize("of", ["robot", pytest.param("sample", marks=pytest.mark.slow)])
def test_frames_tell_with_which_of_them_a_message_came(path: Path, of: str) -> None:
    with open(path if of == "robot" else SAMPLE) as recording:
        player = recording.show()
    of_topic = {
        name: [moment.seconds for moment in player.recording.samples(name)]
        for name in ("/scan", "/odom", "/cmd_vel", "/bumper")
    }
    assert news(player, LaserWidget) == of_topic["/scan"]
    assert news(player, SpeedWidget, "measured") == of_topic["/odom"]
    assert news(player, SpeedWidget, "commanded") == of_topic["/cmd_vel"]
    assert news(player, TouchWidget) == of_topic["/bumper"]
    player.close()


def test_frames_of_speeds_have_no_peaks_because_a_peak_is_of_one_moment(player: Player) -> None:
    (view,) = (view for view in player.views if isinstance(view.widget, SpeedWidget))
    readings = [parse_sample(view.widget, timed.frame) for timed in view.track.frames(0.0, 2.0)]
    assert any(reading.measured for reading in readings)
    assert np.isnan([(*reading.least, *reading.greatest) for reading in readings]).all()


def test_a_page_reads_times_and_frames_by_a_table_before_them() -> None:
    said, more = {"frame_id": "a"}, {"frame_id": "b"}
    abouts, raw = pack([TimedFrame(1.0, said, b"one"), TimedFrame(1.5, more, b"three"), TimedFrame(1.7, said, b"")])
    assert abouts == [said, more]
    assert struct.unpack_from("<10d", raw) == (3, 1.0, 0, 3, 1.5, 1, 8, 1.7, 0, 8)
    assert raw[80:] == b"onethree"
