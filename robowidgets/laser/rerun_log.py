"""The scans of a recording in Rerun."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..in_rerun.rerun_log import COLOURS, TopicLog
from ..in_rerun.world import WorldFrame
from ..recordings.columns.chunks import ScanChunk
from ..samples import Scan

_PIECE_BYTES = 1 << 20


class ScanLog(TopicLog):
    """Logs scans as points in the world."""

    is_large = True

    def frames(self) -> list[str]:
        """See `TopicLog`."""
        firsts = (next(self._recording.samples(topic.name), None) for topic in self._topics)
        return [first.sample.frame_id for first in firsts if first and isinstance(first.sample, Scan)]

    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:
        """See `TopicLog`."""
        for number, topic in enumerate(self._topics):
            yield from self._log_scans(stream, topic.name, world, COLOURS[number % len(COLOURS)])

    def _log_scans(self, stream: Any, topic: str, world: WorldFrame, colour: Sequence[int]) -> Iterator[None]:
        rr, log, entity = self._rr, self._log, self._log.entity("world/scans", topic)
        labelled = 0
        stream.log(entity, rr.Points3D.from_fields(colors=colour, radii=rr.Radius.ui_points(2.0)), static=True)
        for chunk in self._recording.scans(topic).chunks():
            rays = chunk.ranges.shape[1]
            if rays > labelled:
                # Once for all scans. Rays without a reading are logged, too, so that each ray keeps its index.
                labels = [f"ranges[{ray}]" for ray in range(rays)]
                stream.log(entity, rr.Points3D.from_fields(labels=labels, show_labels=False), static=True)
                labelled = rays
            rows = max(_PIECE_BYTES // (12 * rays + 64), 1)
            for first in range(0, len(chunk), rows):
                piece = chunk.part(slice(first, first + rows), chunk.start + first)
                poses = world.poses(chunk.like.frame_id, piece.times_ns, piece.stamps_ns)
                points = rr.Points3D.columns(positions=_points(piece)).partition([rays] * len(piece))
                log.send(stream, entity, piece.times_ns, [*points, *log.transforms(poses)])
                yield


def _points(chunk: ScanChunk) -> NDArray[np.float32]:
    """Return x, y and z in metres in the frame of the scanner, shape (N * R, 3); NaN for rays without a reading."""
    ranges = np.where(
        (chunk.ranges >= chunk.range_min) & (chunk.ranges <= chunk.range_max), chunk.ranges, np.float32(np.nan)
    )
    angles = chunk.like.unmounted().angles
    points = np.zeros((*ranges.shape, 3), np.float32)
    np.multiply(ranges, np.cos(angles), out=points[..., 0], casting="same_kind")
    np.multiply(ranges, np.sin(angles), out=points[..., 1], casting="same_kind")
    return points.reshape(-1, 3)
