"""What cannot be in a browser says so, and what to do instead."""

from __future__ import annotations

import importlib
from collections.abc import Callable

import pytest

from robowidgets import feeds, recordings
from robowidgets._core import in_browser
from robowidgets.feeds import FeedError


@pytest.mark.parametrize(
    "open_feed",
    [
        feeds.dds,
        feeds.ros1,
        feeds.ros2,
        lambda: feeds.rosbridge("ws://localhost:9"),
        lambda: feeds.foxglove("ws://localhost:9"),
    ],
    ids=["dds", "ros1", "ros2", "rosbridge", "foxglove"],
)
def test_a_real_robot_is_not_reached(open_feed: Callable[[], object], monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    with pytest.raises(FeedError, match=r"cannot be used in a browser.*no real robot is driven.*feeds\.simulator\(\)"):
        open_feed()


def test_a_robot_has_no_process(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    with pytest.raises(ValueError, match=r"process: expected False, because Python in a browser starts no processes"):
        feeds.simulator(process=True)


def test_recordings_name_what_is_missing_to_unpack_them(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(in_browser, "IN_BROWSER", True)
    monkeypatch.setattr("importlib.util.find_spec", lambda _: None)
    spec = importlib.machinery.SourceFileLoader("robowidgets.recordings", str(recordings.__file__))
    with pytest.raises(ImportError, match=r"no lz4 and no zstd.*recording\.to_html\(\)"):
        exec(spec.get_code("robowidgets.recordings") or "", {"__name__": "x", "__package__": "robowidgets.recordings"})
