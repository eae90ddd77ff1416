"""A span from `Recording.find`, as a slice of the recording and as a selection."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
import traitlets

import robowidgets
from robowidgets import Recording, conditions

from . import robot, sweeps


@pytest.fixture
def drive(tmp_path: Path) -> Iterator[Recording]:
    """See `robot.write`: the left bumper is down from 2 to 3 s."""
    with robowidgets.open(robot.write(tmp_path / "drive")) as recording:
        yield recording


def test_a_span_picks_its_samples(drive: Recording) -> None:
    span = drive.find(conditions.touched())[0]
    part = drive[span]
    assert [moment.seconds for moment in part] == [moment.seconds for moment in drive[2:3]]
    assert len(part.scans()) == 10
    assert part.rays == slice(None)
    assert repr(part) == "drive from 2.00 to 3.00 s"


def test_a_span_of_no_time_picks_what_came_then(tmp_path: Path) -> None:
    rows = ((seconds, sweeps.scan(sweeps.START_NS, [seen])) for seconds, seen in ((0, 5), (1, 0.2), (1, 5), (2, 5)))
    with robowidgets.open(sweeps.write(tmp_path / "x", rows)) as recording:
        (span,) = recording.find(conditions.nearest_below(0.3))
        assert span.start == span.end
        assert [moment.seconds for moment in recording[span]] == [1, 1]


def test_a_span_that_lasts_to_the_end_has_the_last_sample(tmp_path: Path) -> None:
    with robowidgets.open(sweeps.write(tmp_path / "x", sweeps.numbered(20))) as recording:
        span = recording.find(lambda scan: scan.ranges[0] > 1.145)[-1]
        for which in (span, span[:2], list(span[:2])):
            part = recording[which]
            assert [moment.seconds for moment in part] == [1.5, 1.6, 1.7, 1.8, 1.9]
            assert len(part.scans()) == 5
            assert repr(part) == "x from 1.50 to 1.90 s"
        assert len(recording[1.5:1.9].scans()) == 4, "by seconds, the end is not included"


def test_a_span_is_selected(drive: Recording) -> None:
    span = drive.find(conditions.touched())[0]
    player = drive.show(scanogram=True)
    player.selection = span
    assert player.selection == (2, 3)
    assert player.scanogram is not None
    assert player.scanogram.selection == (2, 3)
    player.scanogram.selection = drive.find(conditions.touched())[1]
    assert player.scanogram.selection == (6, 7)
    with pytest.raises(traitlets.TraitError, match="0 <= start < end; got Span"):
        player.selection = span._replace(end=2.0)
    player.close()


@pytest.mark.parametrize(
    ("which", "text", "error"),
    [
        (slice("a", 2), "start: expected seconds from the start of the recording, got 'a'", TypeError),
        (slice(1, "b"), "end: expected seconds from the start of the recording, got 'b'", TypeError),
        (slice(5, 2), "end: expected seconds from the start of the recording, 5 or more, got 2", ValueError),
        (slice(float("nan"), 2), "start: expected seconds from the start of the recording, got nan", ValueError),
    ],
)
def test_what_are_not_seconds_is_refused_at_once(
    drive: Recording, which: slice, text: str, error: type[Exception]
) -> None:
    with pytest.raises(error, match=text):
        drive[which]


def test_an_end_before_the_start_is_refused_instead_of_empty(drive: Recording) -> None:
    for read in (
        lambda: drive.samples("/scan", 5, 2),
        lambda: drive.messages("/scan", 5, 2),
        lambda: drive.scans("/scan").between(5, 2),
        lambda: drive.speeds("/odom").between(5, 2),
    ):
        with pytest.raises(ValueError, match="end: expected seconds from the start of the recording, 5 or more, got 2"):
            read()
    assert list(drive.samples("/scan", 5, 5)) == []
