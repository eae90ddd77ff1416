from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

import robowidgets
from robowidgets import ScanogramWidget
from robowidgets.recordings import UnknownTopicError
from robowidgets.samples import Scan
from robowidgets.scanogram import of_recording as source

from ..pages import synced
from ..scanogram.pictures import get_picture, get_size
from . import robot, sweeps


@pytest.fixture
def sample() -> Iterator[robowidgets.Recording]:
    with robowidgets.open(robowidgets.SAMPLE) as recording:
        yield recording


def test_every_scan_of_a_recording_is_in_it(sample: robowidgets.Recording) -> None:
    widget = sample.scanogram()
    assert widget.title == "/scan"
    picture = get_picture(widget)
    moments = list(sample.samples("/scan"))
    for number in (0, 100, len(moments) - 1):
        scan = moments[number].sample
        assert isinstance(scan, Scan)
        assert np.array_equal(picture.levels.scans.read(number, number + 1)[0], scan.ranges, equal_nan=True)
        assert picture.clock.starts[number] == pytest.approx(moments[number].seconds, abs=1e-6)
    assert len(picture.clock) == len(moments)
    assert picture.duration >= sample.duration


def test_speed_and_touch_stand_under_it(sample: robowidgets.Recording) -> None:
    picture = get_picture(sample.scanogram("/scan"))
    assert picture.speed
    assert picture.speed.title == "/odom"
    assert picture.touch
    first = next(m.seconds for m in sample.samples("/bumper") if any(m.sample.touched.values()))
    assert picture.touch.spans[0][0] == pytest.approx(first, abs=1e-6)


def test_a_real_bump_is_where_it_was(data: Path) -> None:
    with robowidgets.open(data / "good" / "neato_fsm") as recording:
        picture = get_picture(recording.scanogram())
    assert picture.touch
    assert picture.touch.sensors == ["left front", "right front"]
    assert picture.touch.spans[:, 0] == pytest.approx([21.96, 21.96], abs=0.01)


def test_a_recording_too_large_for_memory_is_read_again_on_access(
    sample: robowidgets.Recording, monkeypatch: pytest.MonkeyPatch
) -> None:
    held = get_picture(sample.scanogram())
    monkeypatch.setattr(source, "MEMORY_BYTES", 1000)
    sample.memory = 1 << 20
    widget = sample.scanogram()
    sample.close()
    picture = get_picture(widget)
    assert widget._file
    assert widget._file.memory == 1 << 20
    assert isinstance(picture.levels.scans, source.ScansInFile)
    assert np.array_equal(picture.levels.scans.read(40, 90), held.levels.scans.read(40, 90), equal_nan=True)
    assert (picture.levels.codes(2, 0, 20) == held.levels.codes(2, 0, 20)).all()
    widget.close()


def written(folder: Path, scans: list[list[float]], increments: list[float] | None = None) -> robowidgets.Recording:
    """A recording of scans, a tenth of a second apart."""
    steps = increments or [0.1] * len(scans)
    raw = [sweeps.scan(0, ranges, increment=step) for ranges, step in zip(scans, steps, strict=True)]
    return robowidgets.open(sweeps.write(folder / "scans", [(i / 10, one) for i, one in enumerate(raw)]))


@pytest.mark.parametrize("held", [1 << 28, 100])
def test_scans_that_count_their_rays_differently_are_drawn_by_angle(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, held: int
) -> None:
    monkeypatch.setattr(source, "MEMORY_BYTES", held)
    # A circle of 100 rays, and of 91 to 99; the wall behind is at 1 m, all else at 5.
    counts = [100 if i % 10 == 0 else 90 + i % 10 for i in range(60)]
    scans = [[1.0 if abs(i / count - 0.5) < 0.1 else 5.0 for i in range(count)] for count in counts]
    with written(tmp_path, scans, [2 * np.pi / count for count in counts]) as recording:
        widget = recording.scanogram()
    picture = get_picture(widget)
    assert synced(widget, "_about")["notes"][0] == "the scans have 91 to 100 rays: drawn by angle, without indices"
    assert picture.levels.sweep.by_angle
    assert picture.levels.counts.tolist() == [6000, 0, 0, 0, 0]
    assert picture.clock.starts == pytest.approx(np.arange(60) / 10)
    seen = picture.levels.scans.read(0, 60)
    assert seen.shape == (60, 100)
    assert (seen[:, 42:59] == 1).all()
    assert (seen[:, :39] == 5).all()
    widget.close()


def test_scans_that_take_too_much_when_they_are_as_fine_as_the_finest_are_read_again(tmp_path: Path) -> None:
    scans = [[1.0] * (100 if i % 10 else 199) for i in range(60)]
    with written(tmp_path, scans) as recording:
        recording.memory = 40_000
        widget = recording.scanogram()
    assert sum(4 * len(scan) for scan in scans) < 40_000 < 4 * 199 * 60
    assert isinstance(get_picture(widget).levels.scans, source.ScansInFile)
    widget.close()


def test_scans_that_break_off_keep_the_indices_of_their_rays(tmp_path: Path) -> None:
    with written(tmp_path, [[1.0] * 8, [2.0] * 5, [1.0] * 8, []]) as recording:
        widget = recording.scanogram()
    picture = get_picture(widget)
    assert not picture.levels.sweep.by_angle
    assert synced(widget, "_about")["notes"][0] == "1 of 4 scans have no rays, or more than 8: not in the picture"
    seen = picture.levels.scans.read(1, 2)[0]
    assert np.array_equal(seen, [2] * 5 + [np.nan] * 3, equal_nan=True)
    assert len(picture.clock) == 4, "a scan has the number that it has in the recording"


def test_a_scanner_that_is_turned_is_drawn_by_angle(tmp_path: Path) -> None:
    raw = [sweeps.scan(0, [1.0, 2.0, 3.0, 4.0], angle_min=first) for first in (-0.5, -0.5, -0.3)]
    with robowidgets.open(sweeps.write(tmp_path / "scans", [(i / 10, one) for i, one in enumerate(raw)])) as recording:
        widget = recording.scanogram()
    said = "the scans have rays at other angles now and then: drawn by angle, without indices"
    assert synced(widget, "_about")["notes"][0] == said
    seen = get_picture(widget).levels.scans.read(2, 3)[0]
    assert np.array_equal(seen, [np.nan, np.nan, 1, 2], equal_nan=True)


def test_one_scan_with_far_more_rays_does_not_make_all_others_as_large(tmp_path: Path) -> None:
    with written(tmp_path, [[1.0] * 4] * 20 + [[2.0] * 100_000]) as recording:
        widget = recording.scanogram()
    assert synced(widget, "_about")["notes"][0] == "1 of 21 scans have no rays, or more than 4: not in the picture"
    assert get_picture(widget).levels.sweep.ray_count == 4


def test_under_the_scans_of_a_robot_stand_its_own_speed_and_touches(tmp_path: Path) -> None:
    with robowidgets.open(robot.write(tmp_path / "two", robots=("/one", "/two"))) as recording:
        for name in ("/one", "/two"):
            picture = get_picture(recording.scanogram(f"{name}/scan"))
            assert picture.speed
            assert picture.speed.title == f"{name}/odom"
            assert picture.touch
            assert picture.touch.title == f"{name}/bumper"
        chosen = get_picture(ScanogramWidget.of(recording, "/one/scan", ["/one/cmd_vel"]))
        assert chosen.speed
        assert (chosen.speed.title, chosen.touch) == ("/one/cmd_vel", None)
        player = recording.show("/two/scan", "/two/bumper")
    assert player.scanogram
    shown = get_picture(player.scanogram)
    assert shown.touch
    assert (shown.speed, shown.touch.title) == (None, "/two/bumper")
    player.close()


def test_its_levels_take_a_quarter_of_the_memory_of_a_recording(sample: robowidgets.Recording) -> None:
    usual = get_picture(sample.scanogram()).levels
    size = get_size(usual)
    sample.memory = 4 * size // 3
    levels = get_picture(sample.scanogram()).levels
    assert get_size(levels) < size / 3
    for level in range(usual.last + 1):
        assert (levels.codes(level, 0, 1 << 20) == usual.codes(level, 0, 1 << 20)).all()


def test_a_topic_without_scans_is_refused_with_words(sample: robowidgets.Recording) -> None:
    with pytest.raises(UnknownTopicError, match="/odom"):
        sample.scanogram("/odom")


def test_a_selection_picks_its_samples(sample: robowidgets.Recording) -> None:
    widget = sample.scanogram()
    widget.selection = (2.0, 4.0, 10, 20)
    part = sample[widget.selection]
    assert [m.seconds for m in part] == [m.seconds for m in sample.samples(start=2.0, end=4.0)]
    assert len(list(part)) == len(list(part)), "it may be read again"
    assert {m.topic for m in part.samples("/scan")} == {"/scan"}
    assert part.scans("/scan").ranges[:, part.rays].shape == (len(part.scans("/scan")), 10)
    assert len(part.speeds("/odom")) == len(list(part.samples("/odom")))
    assert part.touches("/bumper").labels
    assert repr(part) == f"{sample.path.name} from 2.00 to 4.00 s"


def test_a_slice_of_seconds_picks_too(sample: robowidgets.Recording) -> None:
    assert len(list(sample[2:4])) == len(list(sample[2.0, 4.0]))
    assert len(list(sample[2:])) + len(list(sample[:2])) == len(list(sample))
    assert sample[2:].rays == slice(None)


@pytest.mark.parametrize(
    ("which", "error"), [("/scan", TypeError), (3, TypeError), ((4, 2), ValueError), (slice(0, 9, 2), TypeError)]
)
def test_what_is_not_a_span_of_time_is_refused_with_words(
    sample: robowidgets.Recording, which: object, error: type[Exception]
) -> None:
    with pytest.raises(error, match=r"recording\[\.\.\.\]: expected .*; got"):
        sample[which]  # type: ignore[index]
