"""The speeds of a recording in Rerun."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np

from ..in_rerun.rerun_log import PLOT_HEIGHT, TopicLog
from ..in_rerun.world import WorldFrame
from ..recordings.topics import Topic
from ..samples import AXES


class SpeedLog(TopicLog):
    """Logs speeds as curves, one for each axis."""

    def views(self) -> list[tuple[Any, float]]:
        """See `TopicLog`."""
        views = []
        for name, axes in (("Linear, m/s", AXES[:3]), ("Angular, rad/s", AXES[3:])):
            lines = [entity for topic in self._topics for entity in self._moving(topic.name, axes)]
            if lines:
                view = self._rr.blueprint.TimeSeriesView(origin="speeds", contents=lines, name=name)
                views.append((view, PLOT_HEIGHT))
        return views

    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:  # noqa: ARG002  # speeds are in no frame
        """See `TopicLog`."""
        for topic in self._topics:
            self._log_speeds(stream, topic)
            yield

    def _log_speeds(self, stream: Any, topic: Topic) -> None:
        rr, speeds = self._rr, self._recording.speeds(topic.name)
        # A commanded speed is valid until the next one.
        between = rr.components.InterpolationMode.StepAfter if topic.commanded else None
        for axis, column in zip(AXES, speeds.values.T, strict=True):
            known = np.isfinite(column)
            if known.any():
                entity = self._log.entity("speeds", topic.name, axis)
                style = rr.SeriesLines(names=f"{topic.name} {axis}", interpolation_mode=between)
                stream.log(entity, style, static=True)
                self._log.send(stream, entity, speeds.times_ns[known], rr.Scalars.columns(scalars=column[known]))

    def _moving(self, topic: str, axes: Sequence[str]) -> list[str]:
        """Return the entities of the axes that are not always 0. Of a robot in the plane, these are at most three."""
        values = dict(zip(AXES, np.nan_to_num(self._recording.speeds(topic).values).T, strict=True))
        return [self._log.entity("speeds", topic, axis) for axis in axes if values[axis].any()]
