"""Rows of other installed packages, by their entry points."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from importlib import invalidate_caches
from pathlib import Path

import pytest

import robowidgets
from robowidgets import feeds
from robowidgets.behaviors import simulate
from robowidgets.kinds import KINDS, add_installed
from robowidgets.simulator import Robot, World

from ...fourth_kind import drive
from ..feeds.scripted import Scripted

ROW = """
from dataclasses import replace
from tests.fourth_kind.number import NUMBER

def _widget():
    from depth_widget import DepthWidget
    return DepthWidget

DEPTH = replace(NUMBER, name="depth", sample_name="depth", noun="depths", widget=_widget)
WORD = "depth"
TAKEN = replace(NUMBER, name="laser")
"""
WIDGET = """
from tests.fourth_kind.number_widget import NumberWidget

class DepthWidget(NumberWidget):
    pass
"""
POINTS = """[robowidgets.rooms]
absent = depth_room:ABSENT
depth = depth_room:DEPTH
lost = no_such_module:ROW
taken = depth_room:TAKEN
word = depth_room:WORD
"""


@pytest.fixture(autouse=True)
def _installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """A package with a row, and with entry points that cannot be used."""
    about = tmp_path / "depth_room-1.0.dist-info"
    about.mkdir()
    (about / "METADATA").write_text("Metadata-Version: 2.1\nName: depth-room\nVersion: 1.0\n")
    (about / "entry_points.txt").write_text(POINTS)
    (tmp_path / "depth_room.py").write_text(ROW)
    (tmp_path / "depth_widget.py").write_text(WIDGET)
    monkeypatch.syspath_prepend(tmp_path)
    invalidate_caches()
    before = dict(KINDS)
    add_installed.cache_clear()
    yield
    add_installed.cache_clear()
    KINDS.clear()
    KINDS.update(before)
    for name in ("depth_room", "depth_widget"):
        sys.modules.pop(name, None)


def test_show_the_topics_of_a_recording(tmp_path: Path) -> None:
    with robowidgets.open(drive.write(tmp_path / "drive")) as recording:
        assert {topic.name for topic in recording.topics if topic.widget == "depth"} == {"/depth", "/level"}
        assert "depth_widget" not in sys.modules, "reading a recording imports no widget"
        player = recording.show("/depth")
        assert [type(view.widget).__name__ for view in player.views] == ["DepthWidget"]
        player.close()


def test_show_the_topics_of_a_feed() -> None:
    with feeds.Feed(Scripted(feeds.Advert("/depth", "std_msgs/msg/Float64"))) as feed:
        assert [topic.widget for topic in feed.topics] == ["depth"]


def test_give_their_samples_to_programs() -> None:
    with pytest.raises(ValueError, match="a program asks for depth, and the simulated robot has no depths"):
        next(simulate(lambda depth: depth, Robot(World.rooms()), 1.0))


def test_are_logged_by_name_and_left_out_if_they_are_broken(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    path = drive.write(tmp_path / "drive")
    for _ in range(2):
        robowidgets.open(path).close()
    texts = sorted(record.getMessage() for record in caplog.records)
    assert [text.partition(": ")[0] for text in texts] == [
        f"the room {name!r} of {place} is left out"
        for name, place in (
            ("absent", "depth_room:ABSENT"),
            ("lost", "no_such_module:ROW"),
            ("taken", "depth_room:TAKEN"),
            ("word", "depth_room:WORD"),
        )
    ]
    assert "AttributeError" in texts[0]
    assert "ModuleNotFoundError" in texts[1]
    assert "name: expected an identifier other than" in texts[2]
    assert "expected a kinds.Kind or a kinds.OnDemandWidget, got 'depth'" in texts[3]


def test_with_a_widget_that_cannot_be_imported_leave_other_widgets_alone(tmp_path: Path) -> None:
    (tmp_path / "depth_widget.py").write_text("import no_such_module")
    with feeds.Feed(Scripted(feeds.Advert("/depth", "std_msgs/msg/Float64"))) as feed:
        laser = robowidgets.LaserWidget()
        feed.connect("/scan", laser)
        with pytest.raises(ModuleNotFoundError, match="no_such_module"):
            feed.show("/depth")
