"""Images of a recording: shown on request, thinned for the player, with their calibration."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from ipywidgets import Widget
from rosbags.rosbag2 import Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets import ImageWidget
from robowidgets.image import HEADER
from robowidgets.image.frames import BYTES_PER_SECOND
from robowidgets.widget.timed_frame import FRAME_HEADER

HZ, COUNT = 10, 15


@pytest.fixture(scope="module")
def bag(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Depth images at 10 Hz, one of them cut off, and their calibration."""
    path = tmp_path_factory.mktemp("images") / "bag"
    store = get_typestore(Stores.ROS2_HUMBLE)
    types = store.types
    with Writer(path, version=9) as writer:
        kinds = {"image_rect": "Image", "camera_info": "CameraInfo"}
        topics = {
            name: writer.add_connection(f"/depth/{name}", f"sensor_msgs/msg/{kind}", typestore=store)
            for name, kind in kinds.items()
        }
        for number in range(COUNT):
            time_ns = 1_700_000_000_000_000_000 + number * 10**9 // HZ
            stamp = types["builtin_interfaces/msg/Time"](time_ns // 10**9, time_ns % 10**9)
            header = types["std_msgs/msg/Header"](stamp, "camera")
            pixels = np.full((480, 640), 1000 + number, np.uint16)
            data = pixels.view(np.uint8).reshape(-1)[: 10 if number == 3 else None]
            image = types["sensor_msgs/msg/Image"](header, 480, 640, "16UC1", 0, 1280, data)
            writer.write(topics["image_rect"], time_ns, store.serialize_cdr(image, "sensor_msgs/msg/Image"))
            if number == 0:
                k = np.array([500.0, 0, 320, 0, 500, 240, 0, 0, 1])
                p = np.array([500.0, 0, 320, 0, 0, 500, 240, 0, 0, 0, 1, 0])
                roi = types["sensor_msgs/msg/RegionOfInterest"](0, 0, 0, 0, False)
                info = types["sensor_msgs/msg/CameraInfo"](
                    header, 480, 640, "plumb_bob", np.zeros(5), k, np.eye(3).reshape(-1), p, 0, 0, roi
                )
                writer.write(topics["camera_info"], time_ns, store.serialize_cdr(info, "sensor_msgs/msg/CameraInfo"))
    return path


def inside(widget: Widget) -> Iterator[Widget]:
    """A widget and all in it."""
    yield widget
    for child in getattr(widget, "children", ()):
        yield from inside(child)


def test_a_player_shows_them_thinned_and_says_which_could_not_be_shown(bag: Path, tmp_path: Path) -> None:
    with robowidgets.open(bag) as recording:
        player = recording.show("/depth/image_rect")
        widget = next(one for one in inside(player) if isinstance(one, ImageWidget))
        assert widget.camera == (500, 500, 320, 240)
        player.seek(1.0)
        assert widget.image is not None
        assert widget.image.distance(0, 0) == pytest.approx(1.010)
        messages = [moment.message for moment in recording.messages("/depth/image_rect")]
        frames = [widget.frame_of(message) for message in messages]
        every = HEADER.unpack_from(frames[0][1])[3]
        assert every > 1
        assert sum(len(frame) for _, frame in frames) <= 1.1 * BYTES_PER_SECOND * COUNT / HZ
        assert "the message is cut off" in frames[3][0]["notes"][0]
        assert FRAME_HEADER.size + len(frames[0][1]) < 250_000
        player.close()
        page = recording.to_html(tmp_path / "page.html", topics=["/depth/image_rect"])
        assert page.stat().st_size > 20_000
