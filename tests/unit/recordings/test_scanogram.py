from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robowidgets
from robowidgets import ScanogramWidget
from robowidgets.recordings import UnknownTopicError
from robowidgets.recordings import scanogram as source
from robowidgets.samples import Scan
from robowidgets.scanogram.codes import fold


@pytest.fixture
def sample() -> Iterator[robowidgets.Recording]:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        yield recording


def picture_of(widget: ScanogramWidget) -> robowidgets.scanogram_widget.Picture:
    assert widget._picture
    return widget._picture


def test_every_scan_of_a_recording_is_in_it(sample: robowidgets.Recording) -> None:
    widget = sample.scanogram()
    assert widget.title == "/scan"
    picture = picture_of(widget)
    moments = list(sample.samples("/scan"))
    for number in (0, 100, len(moments) - 1):
        scan = moments[number].sample
        assert isinstance(scan, Scan)
        assert np.array_equal(picture.levels.scans.read(number, number + 1)[0], scan.ranges, equal_nan=True)
        assert picture.clock.starts[number] == pytest.approx(moments[number].seconds, abs=1e-6)
    assert len(picture.clock) == len(moments)
    assert picture.duration >= sample.duration


def test_speed_and_touch_stand_under_it(sample: robowidgets.Recording) -> None:
    picture = picture_of(sample.scanogram("/scan"))
    assert picture.speed
    assert picture.speed.title == "/odom"
    assert picture.touch
    first = next(m.seconds for m in sample.samples("/bumper") if any(m.sample.touched.values()))
    assert picture.touch.spans[0][0] == pytest.approx(first, abs=1e-6)


def test_a_real_bump_is_where_it_was(data: Path) -> None:
    with robowidgets.open(data / "good" / "neato_fsm") as recording:
        picture = picture_of(recording.scanogram())
    assert picture.touch
    assert picture.touch.sensors == ["left front", "right front"]
    assert picture.touch.spans[:, 0] == pytest.approx([21.96, 21.96], abs=0.01)


def test_a_recording_too_large_to_hold_is_read_again_where_it_is_looked_at(
    sample: robowidgets.Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = picture_of(sample.scanogram())
    monkeypatch.setattr(source, "HELD_BYTES", 1000)
    sample.memory = 1 << 20
    widget = sample.scanogram()
    sample.close()
    picture = picture_of(widget)
    assert widget._file
    assert widget._file.memory == 1 << 20
    assert isinstance(picture.levels.scans, source.Read)
    assert np.array_equal(picture.levels.scans.read(40, 90), held.levels.scans.read(40, 90), equal_nan=True)
    assert (picture.levels.codes(2, 0, 20) == held.levels.codes(2, 0, 20)).all()
    widget.close()


def test_its_levels_take_a_quarter_of_the_memory_of_a_recording(sample: robowidgets.Recording) -> None:
    usual = picture_of(sample.scanogram()).levels
    size = sum(codes.nbytes for codes in usual._kept)
    sample.memory = 4 * size // 3
    levels = picture_of(sample.scanogram()).levels
    assert sum(codes.nbytes for codes in levels._kept) < size / 3
    assert levels._first > usual._first
    assert (levels._kept[0] == fold(usual._kept[0], 1 << (levels._first - usual._first))).all()


def test_a_topic_without_scans_is_refused_with_words(sample: robowidgets.Recording) -> None:
    with pytest.raises(UnknownTopicError, match="/odom"):
        sample.scanogram("/odom")


def test_a_selection_picks_its_samples(sample: robowidgets.Recording) -> None:
    widget = sample.scanogram()
    widget.selection = (2.0, 4.0, 10, 20)
    stretch = sample[widget.selection]
    assert [m.seconds for m in stretch] == [m.seconds for m in sample.samples(start=2.0, end=4.0)]
    assert len(list(stretch)) == len(list(stretch)), "it may be read again"
    assert {m.topic for m in stretch.samples("/scan")} == {"/scan"}
    assert stretch.scans("/scan").ranges[:, stretch.rays].shape == (len(stretch.scans("/scan")), 10)
    assert len(stretch.speeds("/odom")) == len(list(stretch.samples("/odom")))
    assert stretch.touches("/bumper").labels
    assert repr(stretch) == f"{sample.path.name} from 2.00 to 4.00 s"


def test_a_slice_of_seconds_picks_too(sample: robowidgets.Recording) -> None:
    assert len(list(sample[2:4])) == len(list(sample[2.0, 4.0]))
    assert len(list(sample[2:])) + len(list(sample[:2])) == len(list(sample))
    assert sample[2:].rays == slice(None)


@pytest.mark.parametrize(
    ("which", "error"), [("/scan", TypeError), (3, TypeError), ((4, 2), ValueError), (slice(0, 9, 2), TypeError)]
)
def test_what_is_no_span_of_time_is_refused_with_words(
    sample: robowidgets.Recording, which: object, error: type[Exception]
) -> None:
    with pytest.raises(error, match=r"recording\[\.\.\.\]: expected .*; got"):
        sample[which]  # type: ignore[index]
