"""Scanners with several echoes of each ray: messages, samples, recordings, players and the widget."""

from __future__ import annotations

import copy
import pickle
from math import nan
from pathlib import Path

import numpy as np
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import LaserWidget, Scan, Validity
from robowidgets.kinds.choice import choose_widgets
from robowidgets.messages import to_scan
from robowidgets.tracks import track_of

from ..forms import FORMS
from ..pages import parse_sample
from ..recordings.recorded import stamped, write

RAYS = [[1.0, 4.5, 5.0], [2.0], [], [0.5, 3.0]]
LIT = [[10.0, 30.0, 20.0], [5.0], [], [9.0, 9.0]]
KIND = "sensor_msgs/msg/MultiEchoLaserScan"


def several(rays: list[list[float]] = RAYS, lit: list[list[float]] | None = LIT) -> dict:
    """The fields of a MultiEchoLaserScan."""
    return {
        "header": stamped(5_000_000_000, "laser"),
        "angle_min": -0.5,
        "angle_max": -0.5 + 0.1 * (len(rays) - 1),
        "angle_increment": 0.1,
        "time_increment": 0.0,
        "scan_time": 0.0,
        "range_min": 0.1,
        "range_max": 30.0,
        "ranges": [{"echoes": echoes} for echoes in rays],
        "intensities": [{"echoes": echoes} for echoes in lit or []],
    }


def values(scan: Scan) -> list[list[float | None]]:
    """The range, the intensity and the number of the echo of each ray."""
    return [[None if np.isnan(ray.range) else ray.range, ray.intensity, ray.source] for ray in scan]


FIRST = [[1.0, 10.0, 0], [2.0, 5.0, 0], [None, pytest.approx(nan, nan_ok=True), None], [0.5, 9.0, 0]]
LAST = [[5.0, 20.0, 2], [2.0, 5.0, 0], [None, pytest.approx(nan, nan_ok=True), None], [3.0, 9.0, 1]]
STRONGEST = [[4.5, 30.0, 1], [2.0, 5.0, 0], [None, pytest.approx(nan, nan_ok=True), None], [0.5, 9.0, 0]]


@pytest.mark.parametrize("form", FORMS, ids=lambda form: form.__name__)
def test_a_message_of_every_source_has_the_first_echo_and_gives_the_last_and_the_strongest(form) -> None:
    scan = to_scan(form("sensor_msgs/MultiEchoLaserScan", several()))
    assert values(scan) == FIRST
    assert values(scan.echo("last")) == LAST
    assert values(scan.echo("strongest")) == STRONGEST
    assert values(scan.echo("last").echo("first")) == FIRST
    assert scan[2].validity is Validity.NO_MEASUREMENT
    assert (scan.frame_id, scan.problems(), scan.echo("last").age) == ("laser", (), pytest.approx(scan.age, abs=1))
    assert scan.echo("last").turned(0.1).angle_min == pytest.approx(-0.4)
    assert values(scan.echo("last").turned(0.1)) == LAST


def test_a_scan_with_several_echoes_survives_copies_and_pickles() -> None:
    for scan in (copy.deepcopy(to_scan(several())), pickle.loads(pickle.dumps(to_scan(several())))):
        assert values(scan.echo("last")) == LAST
        with pytest.raises(ValueError, match="read-only"):
            scan.echoes.ranges[0] = 0


def test_a_scan_of_one_echo_is_all_of_its_echoes() -> None:
    scan = Scan([1.0, 2.0], 0.0, 0.1, 0.1, 30.0)
    assert scan.echo("strongest") is scan
    assert scan[0].source is None
    with pytest.raises(ValueError, match=r"^echo: expected 'first', 'last', 'strongest', got 'second'$"):
        scan.echo("second")


@pytest.mark.parametrize(
    ("rays", "lit", "said"),
    [
        (RAYS, None, ()),
        (RAYS, [[], [], [], []], ()),
        (RAYS, [[1.0], [1.0], [], [1.0]], ("3 intensities for 6 echoes: not used",)),
        (RAYS, [[1.0, 2.0, 3.0]], ("3 intensities for 6 echoes: not used",)),
    ],
)
def test_without_usable_intensities_the_strongest_echo_is_unknown(rays, lit, said) -> None:
    scan = to_scan(several(rays, lit))
    assert tuple(problem.what for problem in scan.problems()) == said
    strongest = scan.echo("strongest")
    assert np.isnan(strongest.distance())
    assert strongest.problems()[0].what == "no intensities: the strongest echo is unknown"
    assert values(strongest.echo("last"))[0] == [5.0, None, 2]
    assert len(strongest.echo("last").problems()) == len(said)


def test_rays_without_any_echo_are_not_measurements() -> None:
    scan = to_scan(several([[], []], []))
    assert scan.counts[Validity.NO_MEASUREMENT] == 2
    assert len(to_scan(several([], []))) == 0


@pytest.mark.parametrize(
    ("ranges", "text"),
    [
        ([{"echoes": [1.0]}, {"echo": [1.0]}], "ranges: expected a list of echoes for each ray"),
        ([{"echoes": [1.0]}, {"echoes": 2.0}], "ranges: expected a list of echoes for each ray"),
        ([{"echoes": ["a"]}], "ranges: expected a one-dimensional array of numbers"),
        ([{"echoes": [1.0] * 101}], "ranges: expected at most 100 echoes of a ray, got 101"),
    ],
)
def test_invalid_echoes_are_refused(ranges, text) -> None:
    with pytest.raises((TypeError, ValueError), match=text):
        to_scan({**several(), "ranges": ranges})


def test_the_widget_shows_the_chosen_echo_with_its_number_live_frozen_and_when_another_is_chosen() -> None:
    laser = LaserWidget(echo="last")
    laser.update(several())
    assert values(laser.scan) == LAST
    assert laser.get_state()["_about"]["made_of"] == ["last echo", "ranges[{ray}].echoes[{number}]"]
    laser.echo = "strongest"
    assert values(laser.scan) == STRONGEST
    assert laser.get_state()["_about"]["made_of"][0] == "strongest echo"
    laser.paused = True
    assert values(laser.frozen) == STRONGEST
    laser.paused = False
    laser.angle_offset = 0.5
    laser.update(several(lit=None))
    laser.echo = "first"
    laser.paused = True
    assert [row[::2] for row in values(laser.frozen)] == [row[::2] for row in FIRST]
    assert laser.frozen.intensities.size == 0
    assert laser.frozen.angle_min == pytest.approx(0.0)
    with pytest.raises(TraitError, match="'last'"):
        laser.echo = "second"
    laser.close()


def test_a_recording_has_all_echoes_of_each_scan_and_a_player_shows_the_chosen_one(tmp_path: Path) -> None:
    other = several([[7.0, 8.0], [2.5], [6.0], []], [[1.0, 2.0], [3.0], [4.0], []])
    folder = write(tmp_path / "glass", {"/glass": KIND}, [(0, "/glass", several()), (1, "/glass", other)])
    with robowidgets.open(folder) as recording:
        (topic,) = recording.topics
        assert (topic.widget, topic.problem) == ("laser", "")
        scans = recording.scans("/glass")
        assert scans.ranges[:, 0].tolist() == [1.0, 7.0]
        assert scans.distances().tolist() == [0.5, 2.5]
        assert values(scans[0].sample.echo("last")) == LAST
        assert [ray.source for ray in scans[1].sample.echo("last")] == [1, 0, 0, None]
        assert recording.at("/glass", 1.0).sample.echo("last").ranges[0] == 8.0

        (choice, *_) = choose_widgets(recording.topics, ["/glass"])
        laser = choice.make()
        laser.follow_player()
        track = track_of(recording, choice, laser)

        def shown() -> set[float]:
            return {float(parse_sample(laser, timed.frame).ranges[0]) for timed in track.frames(0.0, 2.0)}

        first = shown()
        laser.echo = "last"
        assert (first, shown()) == ({1.0, 7.0}, {5.0, 8.0})
        laser.close()
        page = recording.to_html(tmp_path / "glass.html")
        assert page.stat().st_size > 0
