"""The image widget: the picture of a camera, with the number of every pixel."""

from __future__ import annotations

from contextlib import suppress
from math import isfinite
from typing import Any, ClassVar

import numpy as np
import traitlets

from .camera import CameraModel
from .image import checked_region, is_recolored, pack, statistics
from .image.overlay import HasOverlay
from .image.packing import MOST_BYTES, NO_PICTURE
from .messages import to_image
from .samples import Image
from .widget.front_end import bundle

OFTEN = 5.0
"""The rate in pictures a second from which color pictures are sent as JPEGs."""


class ImageWidget(HasOverlay):
    """The live picture of a camera, as large as the card and never stretched.

    The widget shows the picture, and for the pixel under the pointer its row, its column, its index in the data of the
    message and its values. A drag marks a region, with its statistics and the code that reads it. A depth image is
    shown in false colors with their scale; 0 and NaN mean no reading, and have no color. With the calibration of the
    camera, a pixel of a depth image also has x, y and z, in metres in the camera frame. Space freezes, the wheel zooms;
    all this works without the kernel. The page gets the next picture when it has drawn the last one. It gets only every
    second, third ... row and column of a large picture, and says so; the values under the pointer then come from
    Python. If a message cannot be read, the last picture stays, with the reason above it.

    Args:
        title: title in the header; usually the name of the topic.
        color_range: metres at the ends of the colors of a depth image, or numbers for another image with one channel;
            by default fitted to each picture. The view writes it, too.
        region: first row, row after the last, first column and column after the last of the marked region, or None. The
            view writes it, too.
        camera: fx, fy, cx and cy of the camera in pixels, or None if unknown. `calibrate` takes them from a message.
        overlay: True to draw known readings of a laser and of sonars over the picture.
        camera_pose: the pose of the camera in the frame of the scanner, instead of tf: x, y, z, roll, pitch, yaw.
        rectified: True if straight edges are straight in the picture; by default decided by the name of its topic.
        paused: True while the picture is frozen.
        history: seconds for which the page keeps pictures to step back through while frozen, 0 (none) to 600; fewer of
            large pictures, because it keeps 8 MB.
        header, footer: False to hide them.

    Raises:
        TypeError: an unknown keyword.
        traitlets.TraitError: a value out of its range.

    Source: sensor_msgs/Image, sensor_msgs/CompressedImage, REP-118.

    Examples:
        >>> camera = ImageWidget(title="/camera/depth")
        >>> camera.update(np.full((480, 640), 1.5, np.float32))
        >>> camera[240, 320], camera.image.distance(240, 320)
        (1.5, 1.5)
    """

    _esm, _css = bundle("image_widget")
    _meant: ClassVar = {
        "topic": "title",
        "limits": "color_range",
        "scale": "color_range",
        "roi": "region",
        "camera_info": "camera",
    }
    _instead: ClassVar = {"data": "widget.image.pixels", "array": "widget.image.pixels", "depth": "widget.image.depth"}
    _keywords = ("camera_pose",)
    column = "wide"
    sample_name = "image"

    color_range = traitlets.Tuple(
        traitlets.Float(),
        traitlets.Float(),
        default_value=None,
        allow_none=True,
        help="Numbers at the ends of the colors; fitted by default.",
    ).tag(sync=True)
    region = traitlets.Tuple(
        *(traitlets.Int() for _ in range(4)),
        default_value=None,
        allow_none=True,
        help="First row, row after the last, first column and column after the last of the marked region.",
    ).tag(sync=True)
    camera = traitlets.Tuple(
        *(traitlets.Float() for _ in range(4)),
        default_value=None,
        allow_none=True,
        help="fx, fy, cx and cy of the camera in pixels, or None if unknown.",
    ).tag(sync=True)

    most_bytes = MOST_BYTES
    """The most bytes of a picture for the page. A player sets it, because it sends many in advance."""

    def __init__(self, **kwargs: Any) -> None:
        self._bad: Image | None = None
        self._picture_size: tuple[int, int] | None = None
        self._fitted: tuple[float, ...] | None = None
        """The camera that `calibrate` has set, to distinguish it from a camera set by hand."""
        self._camera_note = ""
        self._last_good = pack(NO_PICTURE).data
        super().__init__(**kwargs)

    def update(self, message: Any, encoding: str = "") -> None:
        """Show a picture in the next animation frame.

        It only stores the picture, and may be called from any thread at any rate; the newest wins. A message is not
        copied: do not change it afterwards.

        Args:
            message: a sensor_msgs/Image or sensor_msgs/CompressedImage of rclpy, rospy, rosbags or rosbridge; an array
                of NumPy, which is copied; or an `Image`.
            encoding: the encoding of an array, as in a message. By default uint8 is mono8, rgb8 or rgba8, and uint16
                and float are depth images in millimetres and metres.

        Raises:
            TypeError: not such a message. ValueError: its encoding is unknown, or its size does not fit its data. A
                callback (another thread; a task, timer or button of a notebook) raises nothing; the widget and the log
                show the error, and the last picture stays.
        """
        try:
            image = to_image(message, encoding)
        except (TypeError, ValueError) as error:
            self._refuse(error)
        else:
            self._fit_camera_to(image)
            self._show(image)

    def calibrate(self, message: Any) -> None:
        """Take fx, fy, cx and cy from a sensor_msgs/CameraInfo, so that pixels of a depth image have x, y and z.

        If the pictures are scaled, the values are scaled with them.

        Raises:
            TypeError: not such a message. ValueError: the camera is not calibrated, or the pictures have another shape.
        """
        try:
            super().calibrate(message)
            self._fit_camera()
        except (TypeError, ValueError, traitlets.TraitError) as error:
            self._refuse(error)

    def _fit_camera_to(self, image: Image) -> None:
        """Fit the calibration to the size of a picture."""
        size = (image.shape[1], image.shape[0])
        if image is not NO_PICTURE and size != self._picture_size:
            self._picture_size = size
            with suppress(ValueError):  # the note shows it
                self._fit_camera()

    def _fit_camera(self) -> None:
        info = self._beside.info
        if info is None:
            return
        self._camera_note = ""
        try:
            # Depth images are rectified at their source.
            model = CameraModel(info, rectified=True, size=self._picture_size)
        except ValueError as error:
            if info.is_calibrated:
                self._camera_note = f"Pixels have no x, y and z: {error}."
            if self.camera == self._fitted:
                self.set_trait("camera", None)
            raise
        self._fitted = (*map(float, model.focus), *map(float, model.middle))
        self.camera = self._fitted

    @property
    def image(self) -> Image | None:
        """The picture on show: the frozen one while paused, or None before the first.

        While paused it is also None if the page has stepped back to a picture that is no longer kept in Python, which
        keeps about 64 MB.
        """
        return self._sample_on_show()

    @property
    def frozen(self) -> Image | None:
        """The picture on show while frozen, which may be stepped back to; None while live."""
        return self.image if self.paused else None

    @property
    def marked(self) -> Any:
        """The pixels of the marked region, in metres for a depth image, or None without a region."""
        image = self.image
        if image is None or self.region is None:
            return None
        top, bottom, left, right = self.region
        return (image.depth if image.is_depth else image.pixels)[top:bottom, left:right]

    def __getitem__(self, where: Any) -> Any:
        image = self.image
        if image is None:
            raise IndexError("no picture has come yet; update(...) shows one")
        return image[where].item() if np.ndim(image[where]) == 0 else image[where]

    def frame_of(self, sample: Any) -> tuple[dict[str, Any], bytes]:
        """See `RobotWidget`. The sample is a message, or an `Image`."""
        about: dict[str, Any] = {}
        try:
            image = to_image(sample)
            self._fit_camera_to(image)
            packed = pack(image, self.most_bytes).data
        except (TypeError, ValueError) as error:
            about, image = {"notes": [f"A picture could not be shown: {error}."]}, NO_PICTURE
            packed = pack(image).data
        nothing = {"nothing": True} if image is NO_PICTURE else {}
        return {**self._about_sample(image), **about, **nothing}, packed

    # -- to the page ---------------------------------------------------------------------------------------------------

    def _describe(self) -> str:
        shown = self._newest.sample
        return repr(shown).strip("<>") if shown is not None else ""

    def _about_sample(self, sample: Image) -> dict[str, Any]:
        about: dict[str, Any] = {"encoding": sample.encoding, "frame_id": sample.frame_id}
        letters = ("" if sample.is_gray else "rgb") if sample.compressed else "".join(sample.channels)
        about |= {"channels": letters} if letters else {}
        about |= {"recolored": True} if is_recolored(sample) else {}
        about |= {"notes": [self._camera_note]} if self._camera_note and sample.is_depth and self.camera is None else {}
        if sample.step and sample.values is not None:
            each = sample.values.dtype.itemsize * (sample.values.shape[2] if sample.values.ndim == 3 else 1)
            about |= {"row_bytes": sample.step, "pixel_bytes": 2 if letters == "yuv" else each}
        return about | self._over_live(sample)

    def _pack(self, sample: Image) -> bytes:
        try:
            self._last_good = pack(sample, self.most_bytes, often=self.rate > OFTEN).data
        except ValueError as error:  # a large file that had to be decoded
            with self._newest.lock:
                is_new = self._bad is not sample
                self._bad = sample
            if is_new:
                self._refuse_later(error)
        return self._last_good

    def _refuse_later(self, error: ValueError) -> None:
        """Show why a picture that was accepted cannot be shown."""
        with self._newest.lock:
            self._newest.about = {**self._newest.about, "error": f"{error}."}
        self._log_once(f"a picture could not be shown: {error}")
        self._say_more()

    def _size_of(self, sample: Image) -> int:
        return len(sample.compressed) or sample.pixels.nbytes

    # -- from the page -------------------------------------------------------------------------------------------------

    def _on_message(self, content: dict[str, Any]) -> None:
        """Answer a question of the page on a picture: the values of a pixel, or the statistics of a region."""
        number, pixel, region = content.get("of"), content.get("pixel"), content.get("region")
        if not isinstance(number, (int, float)):
            return
        image = self._kept.get(number)
        if image is None:
            return
        try:
            if region is not None:
                where = checked_region(region)
                self.send({"region": region, "of": number, "statistics": statistics(image, where)})
            elif pixel is not None:
                row, column = (int(one) for one in pixel)
                rows, columns = image.shape
                if 0 <= row < rows and 0 <= column < columns:
                    values = np.atleast_1d(image[row, column]).tolist()
                    self.send({"pixel": pixel, "of": number, "values": [v if isfinite(v) else str(v) for v in values]})
        except (TypeError, ValueError) as error:
            self.send({"of": number, "why": str(error)})

    # -- checks --------------------------------------------------------------------------------------------------------

    @traitlets.validate("region")
    def _region_is_one(self, proposal: Any) -> Any:
        if proposal["value"] is None:
            return None
        try:
            return checked_region(proposal["value"])
        except (TypeError, ValueError) as error:
            raise traitlets.TraitError(str(error)) from None

    @traitlets.validate("color_range")
    def _range_is_one(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is None:
            return None
        if not all(map(isfinite, value)) or not value[0] < value[1]:
            raise traitlets.TraitError(
                f"color_range: expected two numbers, the first below the second, or None; got {value!r}"
            )
        return value

    @traitlets.validate("camera")
    def _camera_is_one(self, proposal: Any) -> Any:
        value = proposal["value"]
        if value is None:
            return None
        if not all(map(isfinite, value)) or not min(value[:2]) > 0:
            raise traitlets.TraitError(
                f"camera: expected fx, fy, cx and cy in pixels, fx and fy above 0; got {value!r}"
            )
        return value
