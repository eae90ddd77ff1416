"""`CloudWidget`, and a cloud in a `LaserWidget`: their Python interface, without a page."""

from __future__ import annotations

from collections.abc import Iterator
from math import inf, nan
from pathlib import Path

import numpy as np
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import CloudWidget, LaserWidget
from robowidgets import cloud_widget as module
from robowidgets.kinds.choice import choose_widgets
from robowidgets.messages import to_cloud
from robowidgets.tracks import track_of
from robowidgets.widget.large_frames import MOST_KEPT_BYTES

from ...vectors import BANDS
from ..pages import parse_sample
from ..recordings.recorded import write
from ..screens.test_to_html import parts
from .test_cloud import OVER, cloud_message, points_of

Bands = dict[str, tuple[float, float]]
POINTS = [[1.0, 0.0, 0.2], [2.0, 0.5, 1.4], [0.5, -1.0, 0.5], [nan, nan, nan]]


@pytest.fixture
def clouds() -> Iterator[CloudWidget]:
    widget = CloudWidget(title="/points")
    yield widget
    widget.close()


def test_it_shows_the_newest_cloud_and_tells_what_came_of_it(clouds: CloudWidget) -> None:
    assert (clouds.cloud, repr(clouds)) == (None, "<CloudWidget /points: nothing yet>")
    clouds.update(POINTS)
    assert repr(clouds) == "<CloudWidget /points: Cloud of 4 points, nearest 1.02 m at points[0]>"
    assert clouds.get_state()["_about"] == {"frame_id": ""}
    clouds.update(
        cloud_message(points_of(4, OVER), fields=[]) | {"fields": cloud_message(points_of(4, OVER))["fields"]}
    )
    assert clouds.cloud.frame_id == "velodyne"


def test_what_is_selected_is_counted_and_is_the_points_that_its_code_gives(clouds: CloudWidget) -> None:
    with pytest.raises(ValueError, match=r"^selected: no cloud has come yet; update\(\.\.\.\) shows one$"):
        _ = clouds.selected
    with pytest.raises(ValueError, match=r"^code: nothing is selected;"):
        clouds.code()
    clouds.update(POINTS)
    clouds.selection = {"x": (0, 1.5), "z": (0.2, 0.5)}
    assert clouds.get_state()["_about"]["selected"] == [{"x": [0.0, 1.5], "z": [0.2, 0.5]}, 2]
    points = clouds.cloud.points
    names = {**{axis: points[axis] for axis in "xyz"}, "points": points, "cloud": clouds.cloud, "np": np}
    for form, given in (("points", {}), ("cloud", {}), ("array", {"points": np.array(POINTS)})):
        assert len(eval(clouds.code(form), {**names, **given})) == 2, form
    assert clouds.selected["x"].tolist() == [1.0, 0.5]
    clouds.selection = {"ring": (0, 1)}
    assert clouds.get_state()["_about"]["selected"][1] == 0
    for form, text in (("array", "an array of shape .N, 3. has no ring"), ("C", "form: expected 'points'")):
        with pytest.raises(ValueError, match=text):
            clouds.code(form)


@pytest.mark.parametrize("bands", BANDS, ids=lambda bands: ", ".join(map(ascii, bands)))
def test_code_gives_the_points_that_are_counted_whatever_was_not_measured(clouds: CloudWidget, bands: Bands) -> None:
    names = {name: None for name in ("x", "y", "z", "ring", "intensity", *bands) if name != "distance"}
    points = np.zeros(12, [(name, np.float32) for name in names])
    for number, name in enumerate(names):
        points[name] = (np.arange(12) * (number + 1)) % 7 / (4 if number < 3 else 1)
    for i, (axis, value) in enumerate([("x", nan), ("y", inf), ("z", -inf), ("z", nan)]):
        points[axis][2 * i + 2] = value
    points[["x", "y", "z"]][1] = (nan, nan, nan)
    clouds.update(points.reshape(3, 4))
    clouds.selection = bands
    given = {**{name: points[name] for name in names}, "np": np, "points": points, "distance": clouds.cloud.distance}
    for form in ("points", "cloud", "array"):
        if form == "array" and not {*bands} <= {"x", "y", "z"}:
            continue
        rows = np.column_stack([points[axis] for axis in "xyz"]) if form == "array" else points
        found = eval(clouds.code(form), {**given, "cloud": clouds.cloud, "points": rows})
        assert len(found) == len(clouds.selected) == clouds.get_state()["_about"]["selected"][1], form


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("selection", {"z": (1, 0)}, "selection.'z'.: expected the lower bound first, got 1 and 0"),
        ("selection", {"z": (0, inf)}, "selection: expected finite bounds"),
        ("color_range", (2, 1), "color_range: expected the lower bound first"),
        ("color_range", (nan, 1), "color_range: expected the lower bound first, got nan and 1"),
        ("view", "below", "'view'.* any of .*'above', 'side'"),
        ("view_range", 0, "view_range: expected metres above 0, or None"),
        ("most_points", 0, "should not be less than 1"),
    ],
)
def test_invalid_settings_are_refused(clouds: CloudWidget, name: str, value: object, text: str) -> None:
    with pytest.raises(TraitError, match=text):
        setattr(clouds, name, value)


def test_a_bad_cloud_leaves_the_last_good_one_and_says_why(clouds: CloudWidget) -> None:
    clouds.update(POINTS)
    with pytest.raises(ValueError, match="expected at most 5,000,000 points, got 10,000,000"):
        clouds.update(cloud_message(points_of(4, OVER), width=10_000_000))
    assert len(clouds.cloud) == 4
    assert "10,000,000" in clouds.get_state()["_about"]["error"]
    clouds.update(POINTS[:1])
    assert "error" not in clouds.get_state()["_about"]


def sent(clouds: CloudWidget) -> int:
    """Bytes of the newest frame."""
    return len(clouds.get_state()["_frame"])


def test_what_the_page_gets_is_bounded_and_what_is_kept_to_step_back_too(
    clouds: CloudWidget, monkeypatch: pytest.MonkeyPatch
) -> None:
    big = np.zeros((300_000, 3), np.float32)
    clouds.update(big)
    assert sent(clouds) < 12 * module.STILL_POINTS + 500
    monkeypatch.setattr(CloudWidget, "rate", 10.0)
    clouds.update(big)
    assert sent(clouds) < 12 * module.LIVE_POINTS + 500
    clouds.most_points = 1000
    assert sent(clouds) < 12_500
    for i in range(30):
        clouds.update(big + np.float32(i))
        sent(clouds)
    assert sum(cloud.points.nbytes for cloud in clouds._kept.values()) <= MOST_KEPT_BYTES
    clouds.paused = True
    assert clouds.frozen.x[0] == 29


def test_rows_are_thinned_by_rows_and_columns_alike(clouds: CloudWidget) -> None:
    clouds.most_points = 1000
    clouds.update(np.zeros((64, 512, 3), np.float32))
    facts = module._pack(clouds.cloud, 1000)
    assert b'"step": 6' in facts
    assert b'"drawn": 946' in facts  # 11 rows of 86


def test_a_laser_shows_a_band_of_heights_whose_rays_know_their_points() -> None:
    laser = LaserWidget(band=(0.1, 0.6))
    laser.update(cloud_message(np.array([(1, 0, 0.2), (0.5, 0, 1.4)], [(axis, "f4") for axis in "xyz"])))
    (ray,) = [ray for ray in laser.scan if ray.source is not None]
    assert (ray.angle, ray.range, ray.source) == (0.0, 1.0, 0)
    assert laser.get_state()["_about"]["made_of"] == ["points from 0.1 m to 0.6 m high", "points[{number}]"]
    laser.paused = True
    assert [ray.source for ray in laser.frozen if ray.source is not None] == [0]
    laser.paused = False
    laser.band = None
    laser.update(to_cloud(POINTS))
    assert sorted(ray.source for ray in laser.scan if ray.source is not None) == [0, 1, 2]
    with pytest.raises(TraitError, match="band: expected the lower bound first"):
        laser.band = (2, 1)
    laser.close()


def test_a_recording_shows_its_clouds_and_a_band_of_them_as_a_scan_and_says_what_it_cannot_read(tmp_path: Path) -> None:
    sent = [cloud_message(points_of(count, OVER)) for count in (3, 6)]
    broken = cloud_message(points_of(4, OVER), data=np.zeros(3, np.uint8))
    kind = "sensor_msgs/msg/PointCloud2"
    messages = [(i * 0.4, "/points", message) for i, message in enumerate([*sent, broken])]
    folder = write(tmp_path / "drive", {"/points": kind}, messages)
    with robowidgets.open(folder) as recording:
        assert [choice.shown.name for choice in choose_widgets(recording.topics, ["/points"])] == ["cloud"]
        for name, expected in (("cloud", [0, 3, 6, 0]), ("scan", [0, 3, 6, 0])):
            (choice,) = choose_widgets(recording.topics, [f"/points as {name}"])
            widget = choice.make()
            widget.follow_player()
            track = track_of(recording, choice, widget)
            frames = list(track.frames(-1.0, 2.0))
            counts = [count_in(widget, timed.frame) for timed in frames]
            assert counts == expected, name
            assert frames[-1].about["error"].startswith("data: expected 64 bytes for 1 x 4 points of 16 bytes, got 3")
            track.seek(0.5)
            shown = widget.cloud if name == "cloud" else widget.scan
            assert len(shown) == (6 if name == "cloud" else 720)
            widget.close()
        page = recording.to_html(tmp_path / "page.html").read_text(encoding="utf-8")
        assert any(
            b"CloudWidget" in part or b"cloud_widget" in part or b"rw-cloud" in part for part in parts(page, "program")
        )


def count_in(widget: CloudWidget | LaserWidget, frame: bytes) -> int:
    """The number of points in a frame, or of rays with a point."""
    if isinstance(widget, LaserWidget):
        return sum(ray.source is not None for ray in parse_sample(widget, frame))
    facts = frame[36 : frame.index(b"}") + 1]
    return int(facts.split(b'"total": ')[1].split(b",")[0])
