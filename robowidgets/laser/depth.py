"""Rows of a depth image as the scan of a laser widget."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import traitlets

from ..messages import to_camera_info, to_image
from ..messages.fields import has, unwrap
from ..messages.image import IMAGE_TYPES
from ..samples import CameraInfo, Image, Scan
from ..widget.robot_widget import RobotWidget


class RowsTrait(traitlets.TraitType[Any, Any]):
    """A number of rows around the axis of a camera, or the first row and the row after the last."""

    info_text = "a number of rows above 0, or the first row and the row after the last"

    def validate(self, obj: Any, value: Any) -> int | tuple[int, int]:
        """Return the rows as whole numbers."""
        rows = value if isinstance(value, (tuple, list)) else (0, value)
        if len(rows) != 2 or not all(type(row) is int for row in rows) or not 0 <= rows[0] < rows[1]:
            self.error(obj, value)
        return (rows[0], rows[1]) if rows is value else int(value)


class HasDepth(RobotWidget[Scan]):
    """A laser widget that shows rows of a depth image, as the node depthimage_to_laserscan does."""

    rows = RowsTrait(1, help="Rows of a depth image that are shown as a scan.")

    _info: CameraInfo | None = None

    def calibrate(self, message: Any) -> None:
        """Take the calibration of the camera whose depth images are shown, a sensor_msgs/CameraInfo.

        Raises:
            TypeError: not such a message. ValueError: its numbers are impossible. A callback raises nothing; the widget
                and the log show the error.
        """
        try:
            self._info = to_camera_info(message)
        except (TypeError, ValueError) as error:
            self._refuse(error)

    def topics_beside(self, topics: Mapping[str, str]) -> list[tuple[str, Callable[[Any], object]]]:
        """See `TakesTopics` in `poses.live_frames`: the calibration of the camera of a depth image."""
        from ..kinds import info_of  # Imported lazily: a widget without a feed needs no table of kinds.

        topic = str(self._source.get("topic") or self.title)
        near = info_of(topic, topics) if topics.get(topic) in IMAGE_TYPES else ""
        return [(near, self.calibrate)] if near and not self.driven_by_player else []

    def _scan_of_image(self, given: Any) -> Scan:
        from ..camera import depth_scan  # Imported lazily: few laser widgets show a depth image.

        image = to_image(given)
        if not image.is_depth:
            raise ValueError(f"a picture in {image.encoding} has no distances: a scan needs a depth image")
        if self._info is None:
            raise ValueError(
                "no camera_info: the angles of a depth image are unknown without the calibration of its camera; "
                "calibrate() takes it"
            )
        return depth_scan(image, self._info, self.rows)


def is_image(message: Any) -> bool:
    """Return True for a picture, or a message with one."""
    message = unwrap(message)
    return isinstance(message, Image) or (has(message, "data") and (has(message, "encoding") or has(message, "format")))
