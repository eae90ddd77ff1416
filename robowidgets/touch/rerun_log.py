"""The touch sensors of a recording in Rerun."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np

from ..in_rerun.rerun_log import PLOT_HEIGHT, TopicLog
from ..in_rerun.world import WorldFrame
from ..samples import TouchState

_LANE, _MOST_LANES = 24.0, 5
"""The height of a sensor in relation to other views, and the highest number of sensors that add height."""

_STATE_NAMES = {TouchState.FREE: "free", TouchState.TOUCHED: "touched", TouchState.UNKNOWN: ""}


class TouchLog(TopicLog):
    """Logs touch sensors as lanes of states."""

    def views(self) -> list[tuple[Any, float]]:
        """See `TopicLog`."""
        sensors = sum(len(self._recording.touches(topic.name).labels) for topic in self._topics)
        if not sensors:
            return []
        height = PLOT_HEIGHT + min(sensors, _MOST_LANES) * _LANE
        return [(self._rr.blueprint.StateTimelineView(origin="touches", name="Touch"), height)]

    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:  # noqa: ARG002  # touches are in no frame
        """See `TopicLog`."""
        for topic in self._topics:
            self._log_touches(stream, topic.name)
            yield

    def _log_touches(self, stream: Any, topic: str) -> None:
        rr, touches = self._rr, self._recording.touches(topic)
        for label, states in zip(touches.labels, touches.states.T, strict=True):
            entity = self._log.entity("touches", topic, label)
            style = rr.StateConfiguration(values=["free", "touched"], colors=[(200, 205, 210), (220, 38, 38)])
            stream.log(entity, style, static=True)
            changed = np.flatnonzero(np.diff(states, prepend=np.uint8(255)))
            names = [_STATE_NAMES[TouchState(int(state))] for state in states[changed]]
            self._log.send(stream, entity, touches.times_ns[changed], rr.StateChange.columns(state=names))
