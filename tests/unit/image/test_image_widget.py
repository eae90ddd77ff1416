"""The image widget: pictures, history, answers and refusals."""

from __future__ import annotations

import io
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest
import traitlets

from robowidgets import ImageWidget, image_widget
from robowidgets.image import HEADER
from robowidgets.widget import large_frames
from robowidgets.widget.pacer import pacer
from robowidgets.widget.timed_frame import FRAME_HEADER

from ..pages import Page, from_page
from ..waiting import wait_for

COLORS = np.arange(4 * 6 * 3, dtype=np.uint8).reshape(4, 6, 3)


@pytest.fixture
def widget() -> Iterator[ImageWidget]:
    widget = ImageWidget(title="/camera")
    yield widget
    widget.close()


@pytest.fixture
def page(widget: ImageWidget) -> Page:
    return Page(widget)


def ask(widget: ImageWidget, question: dict[str, Any]) -> None:
    from_page(widget, question)


def test_pixels_and_regions_are_read_as_of_an_array(widget: ImageWidget) -> None:
    with pytest.raises(IndexError, match=r"^no picture has come yet; update\(\.\.\.\) shows one$"):
        widget[0, 0]
    widget.update(COLORS)
    assert widget[1, 2].tolist() == COLORS[1, 2].tolist()
    np.testing.assert_array_equal(widget[1:3, 2:5], COLORS[1:3, 2:5])
    widget.region = (1, 3, 2, 5)
    np.testing.assert_array_equal(widget.marked, COLORS[1:3, 2:5])
    assert repr(widget) == "<ImageWidget /camera: Image: 6 x 4 rgb8>"


def test_the_page_gets_the_pixels_and_their_description(widget: ImageWidget, page: Page) -> None:
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    frame = page.state["_frame"]
    assert HEADER.unpack_from(frame, FRAME_HEADER.size) == (1, 4, 6, 1, 0, 1)
    assert frame[FRAME_HEADER.size + HEADER.size :] == COLORS.tobytes()
    assert page.state["_about"]["channels"] == "rgb"
    assert page.state["_about"]["encoding"] == "rgb8"


def test_what_cannot_be_understood_is_reported_and_the_last_picture_stays(widget: ImageWidget, page: Page) -> None:
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    with pytest.raises(ValueError, match="encoding: expected one of"):
        widget.update({"height": 1, "width": 1, "step": 1, "encoding": "huh", "data": b"1"})
    ask(widget, {"drawn": 1, "page": "one"})
    wait_for(lambda: "error" in page.state["_about"], "the page got it")
    assert len(page.sent("_frame")) == 1
    widget.update(COLORS)
    ask(widget, {"drawn": 1, "page": "one"})
    wait_for(lambda: "error" not in page.state["_about"], "a good one followed")


def test_a_file_that_cannot_be_unpacked_is_reported_once_and_the_last_picture_stays(
    widget: ImageWidget, page: Page, caplog: pytest.LogCaptureFixture
) -> None:
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    ask(widget, {"drawn": 1, "page": "one"})
    jpeg = b"\xff\xd8\xff\xc0\x00\x11\x08" + (9000).to_bytes(2, "big") * 2 + bytes(100)
    widget.update({"format": "jpeg", "data": jpeg})
    wait_for(lambda: len(page.sent("_frame")) == 2, "the last good one went once more")
    ask(widget, {"drawn": 2, "page": "one"})
    wait_for(lambda: "is damaged" in page.state["_about"].get("error", ""), "the page got it")
    assert page.state["_frame"][FRAME_HEADER.size :] == page.sent("_frame")[0][FRAME_HEADER.size :]
    pacer.flush()
    assert len(caplog.records) == 1


def test_a_gray_file_has_no_letters_for_its_channel(widget: ImageWidget) -> None:
    pictures = pytest.importorskip("PIL.Image")
    for values, letters in ((COLORS[..., 0], None), (COLORS, "rgb")):
        file = io.BytesIO()
        pictures.fromarray(np.ascontiguousarray(values)).save(file, "PNG")
        about, _ = widget.frame_of({"format": "png", "data": file.getvalue()})
        assert about.get("channels") == letters


def test_the_page_asks_for_exact_values_of_the_picture_that_it_shows(widget: ImageWidget, page: Page) -> None:
    depth = np.arange(1000 * 2000, dtype=np.uint32).reshape(1000, 2000).astype(np.float32)
    widget.update(depth)
    wait_for(lambda: page.messages, "it was sent")
    assert HEADER.unpack_from(page.state["_frame"], FRAME_HEADER.size)[3] > 1
    widget.update(COLORS)
    ask(widget, {"drawn": 1, "page": "one"})
    wait_for(lambda: len(page.messages) == 2, "the next was sent")
    ask(widget, {"pixel": [3, 5], "of": 1})
    ask(widget, {"region": [0, 1, 1, 4], "of": 1})
    ask(widget, {"pixel": [3, 5], "of": 2})
    assert page.customs == [
        {"pixel": [3, 5], "of": 1, "values": [6005.0]},
        {
            "region": [0, 1, 1, 4],
            "of": 1,
            "statistics": {"of": 3, "count": 3, "channels": [[1.0, 2.0, 2.0, 3.0]]},
        },
        {"pixel": [3, 5], "of": 2, "values": [69, 70, 71]},
    ]


@pytest.mark.parametrize(
    "question",
    [
        {"pixel": [9, 9], "of": 1},
        {"pixel": [0, 0], "of": 7},
        {"pixel": [0, 0]},
        {"of": 1},
        {"of": "x", "pixel": [0, 0]},
    ],
)
def test_what_is_not_there_is_not_answered(widget: ImageWidget, page: Page, question: dict[str, Any]) -> None:
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    ask(widget, question)
    assert page.customs == []


def test_an_invalid_question_is_answered_with_the_reason(widget: ImageWidget, page: Page) -> None:
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    ask(widget, {"region": [3, 1, 0, 2], "of": 1})
    assert "the ends above the starts" in page.customs[0]["why"]


def test_no_more_pictures_are_kept_than_have_room(monkeypatch: pytest.MonkeyPatch, widget: ImageWidget) -> None:
    monkeypatch.setattr(large_frames, "MOST_KEPT_BYTES", 3 * COLORS.nbytes)
    for _ in range(10):
        widget.update(COLORS)
        widget.get_state()
    assert len(widget._kept) == 3


def test_colors_that_come_often_go_as_jpegs_whose_exact_values_are_here(
    monkeypatch: pytest.MonkeyPatch, widget: ImageWidget, page: Page
) -> None:
    pytest.importorskip("PIL", reason="Pillow is not installed")
    monkeypatch.setattr(ImageWidget, "rate", 30.0)
    smooth = np.dstack([np.tile(np.arange(640, dtype=np.uint8), (480, 1))] * 3)
    widget.update(smooth)
    wait_for(lambda: page.messages, "it was sent")
    form, *_, is_exact = HEADER.unpack_from(page.state["_frame"], FRAME_HEADER.size)
    assert (form, is_exact) == (0, 0)
    assert len(page.state["_frame"]) < smooth.nbytes / 10
    ask(widget, {"pixel": [3, 200], "of": 1})
    assert page.customs == [{"pixel": [3, 200], "of": 1, "values": [200, 200, 200]}]


def test_a_picture_that_comes_while_another_is_packed_is_not_taken_for_it(
    monkeypatch: pytest.MonkeyPatch, widget: ImageWidget, page: Page
) -> None:
    real, newer = image_widget.pack, [COLORS + 1]

    def packing(image: Any, most: int, **more: Any) -> Any:
        if newer:
            widget.update(newer.pop())
        return real(image, most, **more)

    monkeypatch.setattr(image_widget, "pack", packing)
    widget.update(COLORS)
    wait_for(lambda: page.messages, "it was sent")
    ask(widget, {"pixel": [3, 5], "of": 1})
    assert page.customs == [{"pixel": [3, 5], "of": 1, "values": COLORS[3, 5].tolist()}]


def test_the_frozen_picture_is_the_picture_on_the_page(widget: ImageWidget) -> None:
    widget.update(COLORS)
    widget.paused = True
    widget.update(COLORS + 1)
    assert widget.image is not None
    np.testing.assert_array_equal(widget.image.pixels, COLORS)
    assert widget.frozen is widget.image
    widget.paused = False
    assert widget.frozen is None
    np.testing.assert_array_equal(widget.image.pixels, COLORS + 1)


def test_a_calibration_gives_its_four_numbers(widget: ImageWidget) -> None:
    widget.calibrate({"width": 640, "height": 480, "k": [500, 0, 320, 0, 510, 240, 0, 0, 1]})
    assert widget.camera == (500, 510, 320, 240)
    with pytest.raises(TypeError, match="expected a message like sensor_msgs/CameraInfo"):
        widget.calibrate({"p": 1})


def test_a_calibration_is_scaled_to_the_size_of_the_pictures(widget: ImageWidget) -> None:
    info = {"width": 640, "height": 480, "k": [500, 0, 319.5, 0, 500, 239.5, 0, 0, 1]}
    widget.calibrate(info)
    widget.update(np.ones((240, 320), np.float32))
    assert widget.camera == (250, 250, 159.5, 119.5)
    widget.calibrate(info)
    assert widget.camera == (250, 250, 159.5, 119.5)
    widget.update(np.ones((240, 240), np.float32))
    assert widget.camera is None
    (note,) = widget.get_state()["_about"]["notes"]
    assert note.startswith("Pixels have no x, y and z: camera_info is for another picture: of 640 x 480")
    with pytest.raises(ValueError, match="camera_info is for another picture"):
        widget.calibrate(info)
    widget.camera = (1, 1, 0, 0)
    assert widget.frame_of(np.ones((300, 240), np.float32))[0].get("notes") is None
    assert widget.camera == (1, 1, 0, 0)
    widget.frame_of(np.ones((480, 640), np.float32))
    assert widget.camera == (500, 500, 319.5, 239.5)


@pytest.mark.parametrize(
    ("name", "value", "text"),
    [
        ("color_range", (3.0, 1.0), "color_range: expected two numbers, the first below the second"),
        ("region", (5, 5, 0, 1), "the ends above the starts"),
        ("camera", (0.0, 1.0, 1.0, 1.0), "camera: expected fx, fy, cx and cy"),
    ],
)
def test_settings_that_cannot_be_are_refused(widget: ImageWidget, name: str, value: Any, text: str) -> None:
    with pytest.raises(traitlets.TraitError, match=text):
        setattr(widget, name, value)
