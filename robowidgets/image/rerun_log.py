"""Logging the pictures of cameras to Rerun, in the world if the calibration and the pose of the camera are known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np

from ..camera import CameraModel
from ..in_rerun.rerun_log import Log, TopicLog
from ..in_rerun.sdk import library
from ..in_rerun.world import WorldFrame
from ..messages import to_camera_info, to_image
from ..recordings.calibration import first_info
from ..recordings.topics import Topic
from ..samples import Image
from .packing import as_numbers

_VIEW = 220.0
"""The height of the view with all cameras."""


class ImageLog(TopicLog):
    """Logs pictures unchanged, and depth images with the scale of their metres."""

    is_large = stands_apart = True

    def __init__(self, log: Log, topics: Sequence[Topic]) -> None:
        super().__init__(log, topics)
        self._components = library("rerun.components")
        self._models = {topic.name: self._model_of(topic.name) for topic in topics}

    def frames(self) -> list[str]:
        """See `TopicLog`."""
        return [model.info.frame_id for model in self._models.values() if model is not None]

    def views(self) -> list[tuple[Any, float]]:
        """See `TopicLog`."""
        blueprint = self._rr.blueprint
        each = [blueprint.Spatial2DView(origin=self._entity(topic.name), name=topic.name) for topic in self._topics]
        return [(blueprint.Horizontal(*each), _VIEW)]

    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:
        """See `TopicLog`."""
        rr, log = self._rr, self._log
        for topic in self._topics:
            entity, model = self._entity(topic.name), self._placed(topic.name)
            if model is not None:
                matrix = [[model.focus[0], 0, model.middle[0]], [0, model.focus[1], model.middle[1]], [0, 0, 1]]
                pinhole = rr.Pinhole(image_from_camera=matrix, resolution=model.size, camera_xyz=rr.ViewCoordinates.RDF)
                stream.log(entity, pinhole, static=True)
            for time_ns, image in self._images(topic.name):
                times, stamps = np.array([[time_ns], [image.stamp_ns or 0]], np.int64)
                columns = [*self._columns(image)]
                if model is not None:
                    columns += log.transforms(world.poses(model.info.frame_id, times, stamps))
                log.send(stream, entity, times, columns)
                yield

    def _model_of(self, topic: str) -> CameraModel | None:
        """Return the model of the camera of a topic, or None if it is not calibrated."""
        info = first_info(self._recording, topic)
        if info is None:
            return None
        with suppress(TypeError, ValueError):
            # A pinhole of Rerun has no distortion.
            first = next((image for _, image in self._images(topic)), None)
            size = (first.shape[1], first.shape[0]) if first else None
            return CameraModel(to_camera_info(info), rectified=True, size=size)
        return None

    def _placed(self, topic: str) -> CameraModel | None:
        """Return the model of the camera of a topic if its pose is known, or None."""
        model, world = self._models[topic], self._log.world
        return model if model and world and world.has(model.info.frame_id) else None

    def _entity(self, topic: str) -> str:
        return self._log.entity("world/cameras" if self._placed(topic) else "cameras", topic)

    def _images(self, topic: str) -> Iterator[tuple[int, Image]]:
        """Yield log times and pictures, without messages that are not pictures."""
        for moment in self._recording.messages(topic):
            with suppress(TypeError, ValueError):
                yield moment.time_ns, to_image(moment.message)

    def _columns(self, image: Image) -> Any:
        rr = self._rr
        if image.compressed:
            return rr.EncodedImage.columns(blob=[image.compressed], media_type=[f"image/{image.encoding}"])
        values = as_numbers(image)
        kind = {"u1": rr.ChannelDatatype.U8, "u2": rr.ChannelDatatype.U16, "f4": rr.ChannelDatatype.F32}
        rows, columns = values.shape[:2]
        common = {"width": columns, "height": rows, "channel_datatype": kind[values.dtype.str[1:]]}
        if image.is_depth:
            held = self._components.ImageFormat(**common)
            meter = 1000.0 if values.dtype == np.uint16 else 1.0
            return rr.DepthImage.columns(buffer=[values.tobytes()], format=[held], meter=[meter])
        colors = {1: rr.ColorModel.L, 3: rr.ColorModel.RGB, 4: rr.ColorModel.RGBA}
        held = self._components.ImageFormat(**common, color_model=colors[1 if values.ndim == 2 else values.shape[2]])
        return rr.Image.columns(buffer=[values.tobytes()], format=[held])
