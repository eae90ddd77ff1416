"""Every readable topic of the real recordings is shown by a fitting widget."""

from __future__ import annotations

from collections import defaultdict
from pathlib import Path

import pytest

import robowidgets
from robowidgets.kinds.choice import choose_widgets
from robowidgets.recording import Recording
from robowidgets.repair import RecordingError
from robowidgets.tracks import track_of

FITTING = {
    "LaserScan": "laser", "Twist": "speed", "TwistStamped": "speed", "Odometry": "speed", "Range": "sonar",
    "PoseStamped": "path", "PoseWithCovarianceStamped": "path", "PoseArray": "path", "NavSatFix": "path",
    "TFMessage": "path", "OccupancyGrid": "path", "Path": "path", "String": "events", "Log": "events",
    "DiagnosticArray": "events", "Imu": "plot", "BatteryState": "message", "JointState": "message",
    "PointCloud2": "cloud", "PointCloud": "cloud", "MultiEchoLaserScan": "laser",
    "Image": "image", "MarkerArray": "message", "Float64": "plot",
}  # fmt: skip
"""Short types, and the name of the best widget for each."""


def recordings_in(folder: Path) -> list[Path]:
    found = [path for path in sorted(folder.rglob("*")) if (path / "metadata.yaml").exists()]
    files = [path for path in sorted(folder.rglob("*")) if path.suffix in (".bag", ".mcap", ".db3", ".log")]
    return [*found, *(path for path in files if path.parent not in found)]


def shown(recording: Recording, topic: str) -> str:
    """The name of the widget of a topic, which has packed its first message."""
    (choice, *_) = choose_widgets(recording.topics, [topic])
    widget = choice.make()
    widget.follow_player()
    try:
        track = track_of(recording, choice, widget)
        assert list(track.frames(0.0, 0.5)), topic
    finally:
        widget.close()
    return choice.shown.name


@pytest.mark.slow
def test_every_readable_topic_with_a_message_is_shown_by_a_widget_that_fits(data: Path) -> None:
    """One topic of each type is packed, too: the topic with the fewest messages in the first recording that has it."""
    tried: dict[str, str] = {}
    without: defaultdict[str, list[str]] = defaultdict(list)
    for path in recordings_in(data):
        try:
            recording = robowidgets.open(path)
        except RecordingError:
            continue
        with recording:
            for topic in sorted(recording.topics, key=lambda topic: topic.count):
                if not topic.count or topic.problem or recording.why_unreadable(topic.name):
                    continue
                if not choose_widgets(recording.topics, [topic.name]):
                    without[path.name].append(topic.name)
                elif topic.type not in tried and topic.count < 20_000:
                    tried[topic.type] = shown(recording, topic.name)
    assert without == {}
    assert len(tried) > 80
    by_type = {name.rpartition("/")[2]: widget for name, widget in tried.items()}
    assert {name: by_type[name] for name in FITTING if name in by_type} == {
        name: widget for name, widget in FITTING.items() if name in by_type
    }


@pytest.mark.slow
def test_a_recording_that_opened_to_nothing_opens_to_what_it_has(data: Path) -> None:
    with robowidgets.open(data / "topics" / "car_gps") as recording:
        player = recording.show()
        assert [view.choice.shown.name for view in player.views][:1] == ["path"]
        player.close()
