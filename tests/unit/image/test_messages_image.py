"""Pictures: the messages and arrays that are understood, and the errors for others."""

from __future__ import annotations

import array
import base64
import io
import struct
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import PIL.Image
import pytest

import robowidgets
from robowidgets.image import HEADER, Form, as_numbers, checked_region, pack, statistics
from robowidgets.messages import to_image
from robowidgets.messages.image import layout_of
from robowidgets.samples import Image


def message(values: np.ndarray[Any, Any], encoding: str, *, fill: int = 0, big: bool = False) -> SimpleNamespace:
    """An Image with this number of extra bytes after each row."""
    rows, columns = values.shape[:2]
    data = np.ascontiguousarray(values.astype(values.dtype.newbyteorder(">" if big else "<")))
    lines = data.reshape(rows, -1).view(np.uint8)
    lines = np.hstack([lines, np.full((rows, fill), 99, np.uint8)])
    header = SimpleNamespace(stamp=SimpleNamespace(sec=1, nanosec=5), frame_id="camera")
    return SimpleNamespace(
        header=header,
        height=rows,
        width=columns,
        encoding=encoding,
        is_bigendian=int(big),
        step=lines.shape[1],
        data=lines.tobytes(),
    )


def compressed(kind: str, values: np.ndarray[Any, Any], before: bytes = b"", said: str = "") -> dict[str, Any]:
    file = io.BytesIO()
    PIL.Image.fromarray(values).save(file, kind)
    return {"format": said or kind.lower(), "data": before + file.getvalue(), "header": {"frame_id": "camera"}}


RAMP = np.arange(6 * 8 * 4).reshape(6, 8, 4)


def rvl(pixels: np.ndarray[Any, Any]) -> bytes:
    """A depth image as compressed_depth_image_transport packs it with RVL."""
    nibbles: list[int] = []

    def put(number: int) -> None:
        while number > 7:
            nibbles.append(8 | (number & 7))
            number >>= 3
        nibbles.append(number)

    left, before = pixels.ravel().tolist(), 0
    while left:
        empty = next((i for i, one in enumerate(left) if one), len(left))
        full = next((i for i, one in enumerate(left[empty:]) if not one), len(left) - empty)
        put(empty)
        put(full)
        for one in left[empty : empty + full]:
            step = one - before
            put(2 * step if step >= 0 else -2 * step - 1)
            before = one
        left = left[empty + full :]
    nibbles += [0] * (-len(nibbles) % 8)
    words = [int("".join(f"{one:x}" for one in nibbles[i : i + 8]), 16) for i in range(0, len(nibbles), 8)]
    rows, columns = pixels.shape
    return struct.pack(f"<II{len(words)}I", columns, rows, *words)


class TestImages:
    @pytest.mark.parametrize("fill", [0, 3])
    @pytest.mark.parametrize("big", [False, True])
    @pytest.mark.parametrize(
        ("encoding", "dtype", "channels"),
        [
            *((name, np.uint8, 3) for name in ("rgb8", "bgr8", "8UC3")),
            *((name, np.uint8, 4) for name in ("rgba8", "bgra8", "8UC4")),
            *((name, np.uint8, 1) for name in ("mono8", "8UC1", "bayer_rggb8", "bayer_gbrg8")),
            *((name, np.uint16, 1) for name in ("mono16", "16UC1", "bayer_bggr16")),
            *((name, np.uint16, 3) for name in ("rgb16", "bgr16", "16UC3")),
            ("16SC1", np.int16, 1),
            ("32SC1", np.int32, 1),
            ("32FC1", np.float32, 1),
            ("32FC3", np.float32, 3),
            ("64FC1", np.float64, 1),
        ],
    )
    def test_pixels_match_the_message_whatever_fills_its_rows_and_its_byte_order(
        self, encoding: str, dtype: type, channels: int, big: bool, fill: int
    ) -> None:
        values = RAMP[..., :channels].astype(dtype) * (100 if np.dtype(dtype).itemsize > 1 else 1)
        values = values[..., 0] if channels == 1 else values
        image = to_image(message(values, encoding, fill=fill, big=big))
        assert image.pixels.dtype == dtype
        np.testing.assert_array_equal(image.pixels, values)
        assert (image.shape, image.frame_id, image.stamp_ns) == ((6, 8), "camera", 1_000_000_005)
        assert pack(image).data

    def test_bytes_come_in_all_that_the_middleware_has(self) -> None:
        made = message(RAMP[..., :3].astype(np.uint8), "rgb8")
        raw = made.data
        forms: list[Any] = [bytearray(raw), memoryview(raw), array.array("B", raw), np.frombuffer(raw, np.uint8)]
        for data in [*forms, list(raw), tuple(raw), base64.b64encode(raw).decode()]:
            made.data = data
            np.testing.assert_array_equal(to_image(made).pixels, RAMP[..., :3])

    def test_a_picture_stays_as_it_came_when_the_memory_of_its_message_is_used_again(self) -> None:
        made = message(RAMP[..., :3].astype(np.uint8), "rgb8")
        forms: list[Any] = [
            bytearray(made.data),
            array.array("B", made.data),
            np.frombuffer(made.data, np.uint8).copy(),
        ]
        for data in forms:
            made.data = data
            image = to_image(made)
            data[0], data[1] = 255 - data[0], 255 - data[1]
            np.testing.assert_array_equal(image.pixels, RAMP[..., :3])

    def test_yuv_has_its_values_and_is_shown_in_colors(self) -> None:
        gray, red = (128, 235, 128, 16), (90, 81, 240, 81)
        for encoding, order in (("yuv422", [0, 1, 2, 3]), ("yuv422_yuy2", [1, 0, 3, 2])):
            pairs = np.array([gray, red], np.uint8)[:, order].reshape(2, 2, 2)
            image = to_image(message(pairs, encoding))
            assert image[0].tolist() == [[235, 128, 128], [16, 128, 128]]
            assert image.channels == ("y", "u", "v")
            shown = np.frombuffer(pack(image).data[HEADER.size :], np.uint8).reshape(2, 2, 3)
            assert shown[0].tolist() == [[235, 235, 235], [16, 16, 16]]
            assert shown[1, 0, 0] > 200 > 60 > shown[1, 0, 1:].max()

    @pytest.mark.parametrize("pattern", ["rggb", "bggr", "gbrg", "grbg"])
    def test_a_mosaic_is_shown_as_one_color_for_each_block(self, pattern: str) -> None:
        level = {"r": 200, "g": 100, "b": 50}
        block = np.array([level[letter] for letter in pattern], np.uint8).reshape(2, 2)
        packed = pack(to_image(message(np.tile(block, (3, 4)), f"bayer_{pattern}8")))
        assert packed.every == 2
        shown = np.frombuffer(packed.data[HEADER.size :], np.uint8).reshape(3, 4, 3)
        assert (shown == [200, 100, 50]).all()

    @pytest.mark.parametrize("shape", [(5, 7), (1, 4), (3, 1), (1, 1)])
    def test_a_mosaic_of_odd_size_has_colors_up_to_its_edge(self, shape: tuple[int, int]) -> None:
        values = np.tile(np.array([[200, 100], [100, 50]], np.uint8), (3, 4))[: shape[0], : shape[1]]
        image = to_image(values, "bayer_rggb8")
        packed = pack(image)
        rows, columns = ((size + 1) // 2 for size in shape)
        shown = np.frombuffer(packed.data[HEADER.size :], np.uint8).reshape(rows, columns, 3)
        assert (shown[:, :, 0] == 200).all()
        if min(shape) > 1:
            assert (shown == [200, 100, 50]).all()
        assert as_numbers(image).shape == (*shape, 3)

    def test_distances_are_metres_and_nothing_is_none(self) -> None:
        millimetres = np.array([[0, 1500], [65535, 1]], np.uint16)
        image = to_image(message(millimetres, "16UC1"))
        np.testing.assert_array_equal(image.depth, np.array([[np.nan, 1.5], [65.535, 0.001]], np.float32))
        metres = np.array([[np.nan, np.inf], [-1.0, 2.5]], np.float32)
        np.testing.assert_array_equal(to_image(metres).depth, np.array([[np.nan, np.nan], [np.nan, 2.5]], np.float32))
        assert (image.distance(0, 1), image.distance(-2, -1), image.distance(1, 0)) == (1.5, 1.5, np.float32(65.535))
        with pytest.raises(IndexError, match="index 7 is out of bounds for axis 0 with size 2"):
            image.distance(7, 0)

    @pytest.mark.parametrize("encoding", ["mono8", "mono16", "rgb8"])
    def test_a_picture_without_distances_says_so(self, encoding: str) -> None:
        dtype, channels = layout_of(encoding)
        image = to_image(np.zeros((2, 2, channels), dtype), encoding)
        for ask in (lambda: image.depth, lambda: image.distance(0, 1)):
            with pytest.raises(ValueError, match=rf"expected a depth image .*, got {encoding}"):
                ask()

    @pytest.mark.parametrize(
        ("values", "encoding"),
        [
            (np.zeros((2, 3), np.uint8), "mono8"),
            (np.zeros((2, 3, 1), np.uint8), "mono8"),
            (np.zeros((2, 3), bool), "mono8"),
            (np.zeros((2, 3, 3), np.uint8), "rgb8"),
            (np.zeros((2, 3, 4), np.uint8), "rgba8"),
            (np.zeros((2, 3), np.uint16), "16UC1"),
            (np.zeros((2, 3), np.float16), "32FC1"),
            (np.zeros((2, 3), np.float64), "64FC1"),
            (np.zeros((2, 3), np.int32), "32SC1"),
        ],
    )
    def test_an_array_is_what_arrays_usually_are(self, values: Any, encoding: str) -> None:
        assert to_image(values).encoding == encoding

    def test_an_array_is_copied_and_may_have_another_encoding(self) -> None:
        values = np.zeros((2, 3, 3), np.uint8)
        image = to_image(values, "bgr8")
        values[:] = 9
        assert image.channels == ("b", "g", "r")
        assert image.pixels.max() == 0


class TestCompressed:
    @pytest.mark.parametrize("kind", ["JPEG", "PNG"])
    def test_a_gray_file_has_one_channel_as_its_pixels_have(self, kind: str) -> None:
        for values, is_gray in ((np.full((20, 30), 90, np.uint8), True), (np.full((20, 30, 3), 90, np.uint8), False)):
            image = to_image(compressed(kind, values))
            assert (image.is_gray, image.pixels.ndim == 2) == (is_gray, is_gray)
        if kind == "PNG":
            image = to_image(compressed(kind, np.eye(20, dtype=bool)))
            assert (image.is_gray, image.pixels.shape) == (False, (20, 20, 3))

    def test_a_jpeg_passes_as_it_is_and_is_unpacked_when_it_is_asked_for(self) -> None:
        made = compressed("JPEG", np.full((20, 30, 3), 90, np.uint8))
        image = to_image(made)
        assert (image.encoding, image.shape, image.values) == ("jpeg", (20, 30), None)
        packed = pack(image).data
        assert HEADER.unpack_from(packed)[:3] == (Form.FILE, 20, 30)
        assert packed[HEADER.size :] == made["data"]
        assert abs(int(image[5, 5, 0]) - 90) < 3

    def test_a_png_passes_as_it_is_and_has_its_values(self) -> None:
        values = RAMP[..., :3].astype(np.uint8)
        image = to_image(compressed("PNG", values))
        assert pack(image).data[HEADER.size :].startswith(b"\x89PNG")
        np.testing.assert_array_equal(image.pixels, values)

    def test_a_depth_png_has_its_16_bits(self) -> None:
        values = np.array([[0, 1500], [40_000, 65_535]], np.uint16)
        for said, before in (("16UC1; compressedDepth png", bytes(12)), ("16UC1; png compressed ", b"")):
            image = to_image(compressed("PNG", values, before, said))
            np.testing.assert_array_equal(image.pixels, values)
            assert image.distance(0, 1) == 1.5

    def test_inverse_depth_is_metres(self) -> None:
        before = struct.pack("<iff", 0, 100.0, -10.0)
        values = np.array([[0, 90], [40, 190]], np.uint16)
        image = to_image(compressed("PNG", values, before, "32FC1; compressedDepth png"))
        np.testing.assert_allclose(image.depth, [[np.nan, 1.0], [2.0, 0.5]])

    def test_an_inverse_depth_of_0_is_nothing(self, recwarn: pytest.WarningsRecorder) -> None:
        values = np.array([[10, 110]], np.uint16)
        before = struct.pack("<iff", 0, 100.0, 10.0)
        image = to_image(compressed("PNG", values, before, "32FC1; compressedDepth png"))
        np.testing.assert_allclose(image.depth, [[np.nan, 1.0]])
        assert not recwarn.list

    def test_without_pillow_pictures_pass_and_the_rest_says_what_to_install(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        color, depth = RAMP[..., :3].astype(np.uint8), np.ones((2, 2), np.uint16)
        made = compressed("JPEG", color), compressed("PNG", depth, bytes(12), "16UC1; compressedDepth png")
        monkeypatch.setitem(sys.modules, "PIL.Image", None)
        image = to_image(made[0])
        assert pack(image).data
        for ask in (lambda: image.pixels, lambda: to_image(made[1])):
            with pytest.raises(ValueError, match=r"^its pixels need Pillow: pip install 'robowidgets\[images\]'$"):
                ask()


class TestRefused:
    @pytest.mark.parametrize(
        ("change", "error", "text"),
        [
            ({"encoding": "nv21"}, ValueError, "encoding: expected one of rgb8, bgr8, .*; got 'nv21'"),
            ({"encoding": "bayer_rgrg8"}, ValueError, "encoding: expected one of"),
            ({"step": 20}, ValueError, "step: expected at least 24 bytes for 8 pixels of rgb8, got 20"),
            ({"data": bytes(100)}, ValueError, "data: expected 144 bytes, 6 rows of 24, got 100; the message is cut"),
            ({"height": 0}, ValueError, "the picture is empty: height 0, width 8"),
            ({"width": -1}, ValueError, "width: expected a whole number, 0 or more, got -1"),
            ({"width": None}, TypeError, "width: expected a whole number, got None"),
            ({"data": "%%"}, ValueError, "data: expected bytes, or text in base64"),
            ({"data": [300] * 144}, TypeError, "data: expected bytes, got"),
        ],
    )
    def test_what_does_not_fit_is_reported_in_one_line(self, change: dict[str, Any], error: type, text: str) -> None:
        made = message(RAMP[..., :3].astype(np.uint8), "rgb8")
        vars(made).update(change)
        with pytest.raises(error, match=f"^{text}"):
            to_image(made)

    @pytest.mark.parametrize(
        ("data", "text"),
        [
            (b"", "the picture is empty: no bytes in data"),
            (b"RIFFxxxx", "data: expected a JPEG or PNG, as format 'jpeg' says, got bytes that begin with 52 49 46 46"),
            (b"\xff\xd8\xff\xd9", "the picture is damaged: a JPEG without a size"),
            (b"\x89PNG\r\n\x1a\n", "the picture is damaged: a PNG of 8 bytes"),
        ],
    )
    def test_an_invalid_file_is_reported_in_one_line(self, data: bytes, text: str) -> None:
        with pytest.raises(ValueError, match=f"^{text}"):
            to_image({"format": "jpeg", "data": data})

    def test_another_packing_of_depth_is_named(self) -> None:
        with pytest.raises(ValueError, match="expected 12 bytes and a PNG for 'compressedDepth zlib', got another"):
            to_image({"format": "16UC1; compressedDepth zlib", "data": bytes(40)})

    @pytest.mark.parametrize(
        ("packed", "text"),
        [
            (b"", "expected the size of an image in RVL, got 0 bytes"),
            (struct.pack("<II", 0, 4), "the picture is empty or damaged: 4 rows of 0 pixels in RVL"),
            (struct.pack("<III", 8, 1, 0x08000000), "damaged or cut off: 0 of 8 pixels"),
            (struct.pack("<III", 8, 1, 0xFFFFFFFF), "damaged or cut off: 0 of 8 pixels"),
            (struct.pack("<IIIII", 8, 1, *3 * [0xFFFFFFFF])[:-1] + b"\0", "damaged or cut off|without an end"),
        ],
    )
    def test_invalid_rvl_is_reported_in_one_line(self, packed: bytes, text: str) -> None:
        with pytest.raises(ValueError, match=text):
            to_image({"format": "16UC1; compressedDepth rvl", "data": bytes(12) + packed})

    @pytest.mark.parametrize("holes", [0.0, 0.4, 1.0])
    def test_rvl_has_the_pixels_that_were_packed(self, holes: float) -> None:
        chance = np.random.default_rng(3)
        pixels = chance.integers(1, 65536, (13, 17)).astype(np.uint16)
        pixels[chance.random(pixels.shape) < holes] = 0
        image = to_image({"format": "16UC1; compressedDepth rvl", "data": bytes(12) + rvl(pixels)})
        assert (image.encoding, image.depth_scale) == ("16UC1", 0.001)
        assert np.array_equal(image.pixels, pixels)

    def test_rvl_of_a_camera_has_its_millimetres(self, data: Path) -> None:
        expected = np.load(data / "reports/depth_rvl/millimetres.npy")
        with robowidgets.open(data / "reports/depth_rvl/rvl.mcap") as recording:
            read = [to_image(one.message).pixels for one in recording.messages("/depth/compressedDepth")]
        assert len(read) == 3
        assert all(np.array_equal(one, expected) for one in read)

    @pytest.mark.parametrize(
        ("values", "text"),
        [
            (np.zeros(3), r"expected an array of shape .*, got \(3,\)"),
            (np.zeros((2, 2, 2), np.uint8), "expected an array of shape"),
            (np.zeros((2, 2, 3), np.float32), "expected an array of uint8 .*, got float32 with 3 channels"),
            (np.zeros((0, 2), np.uint8), "expected a picture of 1 to 100,000,000 pixels, got 0 rows x 2 columns"),
        ],
    )
    def test_an_array_that_is_not_a_picture_is_refused(self, values: Any, text: str) -> None:
        with pytest.raises(ValueError, match=text):
            to_image(values)

    def test_what_is_not_a_message_is_described(self) -> None:
        with pytest.raises(
            TypeError, match=r"expected a message like sensor_msgs/Image .*; got a dict with the keys x"
        ):
            to_image({"x": 1})
        with pytest.raises(ValueError, match="expected 3 channels of uint8 for encoding 'rgb8', got 1 of uint8"):
            to_image(np.zeros((2, 2), np.uint8), "rgb8")


class TestPacked:
    def test_a_small_picture_goes_as_it_is(self) -> None:
        for values, form in ((RAMP.astype(np.uint8), Form.RGBA), (RAMP[..., 0].astype(np.uint16), Form.UINT16)):
            packed = pack(to_image(values))
            assert HEADER.unpack_from(packed.data)[:4] == (form, 6, 8, 1)
            assert packed.data[HEADER.size :] == values.tobytes()

    @pytest.mark.parametrize(("rows", "columns"), [(480, 640), (720, 1280), (4000, 5000), (999, 3333)])
    def test_a_large_depth_image_has_every_so_many_rows_and_columns_within_the_limit(
        self, rows: int, columns: int
    ) -> None:
        values = np.arange(rows * columns, dtype=np.uint32).reshape(rows, columns).astype(np.uint16)
        data, every = pack(to_image(values), 500_000)
        assert len(data) <= 500_000 + 20_000
        np.testing.assert_array_equal(np.frombuffer(data[HEADER.size :], "<u2"), values[::every, ::every].reshape(-1))

    def test_a_large_color_image_is_a_jpeg_or_thinned_without_pillow(self, monkeypatch: pytest.MonkeyPatch) -> None:
        values = np.zeros((720, 1280, 3), np.uint8)
        values[:, 640:] = 200
        data, every = pack(to_image(values))
        assert (HEADER.unpack_from(data)[0], every) == (Form.FILE, 1)
        monkeypatch.setitem(sys.modules, "PIL.Image", None)
        data, every = pack(to_image(values))
        assert (HEADER.unpack_from(data)[0], every) == (Form.RGB, 2)

    def test_colors_that_come_often_go_as_a_jpeg_where_that_saves_much_and_distances_never(
        self, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        smooth = np.dstack([np.tile(np.arange(640, dtype=np.uint8), (480, 1))] * 3)
        noise = np.random.default_rng(1).integers(0, 255, (480, 640, 3), np.uint8)
        forms = [HEADER.unpack_from(pack(to_image(values), often=True).data) for values in (smooth, noise)]
        assert [form[:4] for form in forms] == [(Form.FILE, 480, 640, 1), (Form.RGB, 480, 640, 1)]
        assert HEADER.unpack_from(pack(to_image(smooth)).data)[0] == Form.RGB
        assert HEADER.unpack_from(pack(to_image(smooth[..., 0].astype(np.uint16)), often=True).data)[0] == Form.UINT16
        monkeypatch.setitem(sys.modules, "PIL.Image", None)
        assert HEADER.unpack_from(pack(to_image(smooth), often=True).data)[0] == Form.RGB

    def test_bgr_is_shown_as_rgb(self) -> None:
        packed = pack(to_image(np.array([[[1, 2, 3]]], np.uint8), "bgr8"))
        assert packed.data[HEADER.size :] == bytes([3, 2, 1])


class TestRegion:
    def test_slices_are_a_region(self) -> None:
        assert checked_region(np.s_[120:180, 300:360]) == checked_region((120, 180, 300, 360)) == (120, 180, 300, 360)
        for bad in ((1, 1, 0, 2), (3, 1, 0, 2), (-1, 1, 0, 2)):
            with pytest.raises(ValueError, match="the ends above the starts"):
                checked_region(bad)
        for worse in (5, (1, 2, 3), (0.5, 1, 0, 1), "abcd", np.s_[1:, 2:3]):
            with pytest.raises(TypeError, match="region: expected"):
                checked_region(worse)

    def test_statistics_leave_out_pixels_without_a_distance(self) -> None:
        image = to_image(np.array([[1.0, np.nan], [3.0, 8.0]], np.float32))
        found = statistics(image, (0, 2, 0, 2))
        assert found == {"of": 4, "count": 3, "channels": [[1.0, 4.0, 3.0, 8.0]]}
        assert statistics(image, (0, 1, 1, 2)) == {"of": 1, "count": 0, "channels": [None]}
        assert statistics(image, (5, 6, 5, 6))["of"] == 0
        colors = statistics(to_image(RAMP[..., :3].astype(np.uint8)), (0, 2, 0, 2))
        assert len(colors["channels"]) == 3

    def test_an_image_is_not_equal_to_another_and_prints_in_a_line(self) -> None:
        assert repr(to_image(np.zeros((2, 3), np.uint8))) == "<Image: 3 x 2 mono8>"
        assert isinstance(to_image(np.zeros((2, 3), np.uint8)), Image)
