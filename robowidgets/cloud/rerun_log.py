"""The clouds of a recording in Rerun."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from typing import Any

import numpy as np

from ..in_rerun.rerun_log import COLOURS, TopicLog
from ..in_rerun.world import WorldFrame
from ..messages import to_cloud
from ..samples import Cloud
from ..samples.cloud import AXES


class CloudLog(TopicLog):
    """Logs all points of clouds in the world."""

    is_large = True

    def frames(self) -> list[str]:
        """See `TopicLog`."""
        firsts = (next(self._clouds(topic.name), None) for topic in self._topics)
        return [first[1].frame_id for first in firsts if first]

    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:
        """See `TopicLog`."""
        rr, log = self._rr, self._log
        for number, topic in enumerate(self._topics):
            entity = log.entity("world/clouds", topic.name)
            colour = COLOURS[-1 - number % len(COLOURS)]
            stream.log(entity, rr.Points3D.from_fields(colors=colour, radii=rr.Radius.ui_points(1.0)), static=True)
            for time_ns, cloud in self._clouds(topic.name):
                times, stamps = np.array([[time_ns], [cloud.stamp_ns or 0]], np.int64)
                positions = np.column_stack([cloud.points[axis] for axis in AXES]).astype(np.float32)
                points = rr.Points3D.columns(positions=positions).partition([len(cloud)])
                log.send(stream, entity, times, [*points, *log.transforms(world.poses(cloud.frame_id, times, stamps))])
                yield

    def _clouds(self, topic: str) -> Iterator[tuple[int, Cloud]]:
        """Yield log times and clouds, without messages that are not clouds."""
        for moment in self._recording.messages(topic):
            with suppress(TypeError, ValueError):
                yield moment.time_ns, to_cloud(moment.message)
