"""Logging a recording to Rerun, column by column and in pieces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import KINDS, ON_DEMAND, OnDemandWidget
from ..poses.frame_tree import Poses
from ..recordings import RecordingData
from ..recordings.topics import Topic, wanted
from .sdk import library
from .world import WorldFrame

SECONDS, CLOCK = "recording_time", "message_log_time"
"""The timelines: the time since the start of the recording, as in the widgets, and the clock of the recorder, with the
name that Rerun uses for MCAP files."""

_ROOM = 3.0
"""Metres to show around the path."""

WORLD_HEIGHT, PLOT_HEIGHT = 300.0, 100.0
"""The relative heights of the views."""

COLOURS = ((0, 140, 149), (180, 83, 9), (88, 80, 176), (190, 24, 93))
"""The colours of topics in the world."""


class Log:
    """The parts of a recording that are logged to Rerun.

    Topics of a kind without a `TopicLog` in its row are skipped.

    Args:
        recording: the recording.
        topics: names of topics in it, or nothing for all topics with a widget and a message.

    Raises:
        ImportError: rerun-sdk is not installed.
        UnknownTopicError: the recording has no such topic, or no widget shows it.
    """

    def __init__(self, recording: RecordingData, topics: Sequence[str] = ()) -> None:
        self.rr = library("rerun")
        self.recording = recording
        on_demand = [row for row in ON_DEMAND.values() if row.rerun]
        messages = {row.name: [t for t in recording.topics if _is_of(t, row, topics)] for row in on_demand}
        named = {topic.name for own in messages.values() for topic in own}
        others = [name for name in topics if name not in named]
        if others or not topics:
            recording.samples(others or None)
        self._start_ns = recording.start_ns or 0
        self.world: WorldFrame | None = None
        """The world frame, which `steps` sets."""
        self._parts: list[TopicLog] = []
        for kind in KINDS.values():
            of_kind = [t for t in wanted(recording.topics, topics) if t.widget == kind.name]
            if of_kind and kind.rerun:
                self._parts.append(kind.rerun()(self, of_kind))
        self._parts += [row.rerun()(self, messages[row.name]) for row in on_demand if row.rerun and messages[row.name]]

    def stream(self) -> Any:
        """Return a new `rerun.RecordingStream` without a sink."""
        return self.rr.RecordingStream("robowidgets", send_properties=False)

    def steps(self, stream: Any) -> Iterator[None]:
        """Log the whole recording, one piece at each step, the large pieces last."""
        name = self.recording.path.name.encode("utf-8", "replace")  # a file name may contain invalid UTF-8
        stream.send_recording_name(name.decode())
        scanners, others = (
            [frame for part in self._parts if part.stands_apart is apart for frame in part.frames()]
            for apart in (False, True)
        )
        self.world = world = WorldFrame(self.recording, scanners, others)
        stream.send_blueprint(self._blueprint(world))
        self._log_world(stream, world)
        yield
        for part in sorted(self._parts, key=lambda part: part.is_large):
            yield from part.steps(stream, world)

    def send(self, stream: Any, entity: str, times_ns: NDArray[np.int64], columns: Any) -> None:
        """Log columns with their times, in nanoseconds of the recorder's clock, shape (N,)."""
        rr = self.rr
        times = [
            rr.TimeColumn(SECONDS, duration=(times_ns - self._start_ns).astype("timedelta64[ns]")),
            rr.TimeColumn(CLOCK, timestamp=times_ns.astype("datetime64[ns]")),
        ]
        stream.send_columns(entity, times, columns, strict=True)

    def transforms(self, poses: Poses) -> Any:
        """Return the columns of the transforms that place an entity at some poses."""
        return self.rr.Transform3D.columns(translation=poses.positions, quaternion=poses.orientations)

    def entity(self, *parts: str) -> str:
        """Return an entity path with one step for each part.

        The slashes of a part are escaped, because a scan of the topic /a/b would inherit the transform of /a.
        """
        first, *rest = parts
        escaped = [self.rr.escape_entity_path_part(part.strip("/").replace(" ", "_")) for part in rest]
        return "/".join([first, *escaped])

    def _log_world(self, stream: Any, world: WorldFrame) -> None:
        rr = self.rr
        stream.log("world", rr.ViewCoordinates.FLU, static=True)
        if path := world.path():
            times_ns, poses = path
            stream.log(
                "world/path",
                rr.LineStrips3D([poses.positions], colors=[130, 130, 130], radii=rr.Radius.ui_points(1.0)),
                static=True,
            )
            stream.log("world/robot", rr.TransformAxes3D(0.5), static=True)
            self.send(stream, "world/robot", times_ns, self.transforms(poses))
        if world.notes:
            stream.log("notes", rr.TextDocument("\n\n".join(world.notes)), static=True)

    def _blueprint(self, world: WorldFrame) -> Any:
        blueprint = self.rr.blueprint
        space = blueprint.Spatial3DView(origin="world", name=f"World ({world.name})", eye_controls=self._eye(world))
        unknown = blueprint.TextDocumentView(origin="notes", name="Not known")
        first = blueprint.Tabs(space, unknown, active_tab=0) if world.notes else space
        views = [(first, WORLD_HEIGHT), *(view for part in self._parts for view in part.views())]
        return blueprint.Blueprint(
            blueprint.Vertical(*(view for view, _ in views), row_shares=[height for _, height in views]),
            blueprint.TimePanel(timeline=SECONDS, state="collapsed", play_state="paused"),
            collapse_panels=True,
        )

    def _eye(self, world: WorldFrame) -> Any:
        """Return a camera above and a little behind the whole path, with room around it for the scans."""
        positions = path[1].positions if (path := world.path()) else np.zeros((1, 3))
        low, high = positions.min(axis=0), positions.max(axis=0)
        x, y, z = (low + high) / 2
        far = 0.75 * float((high - low).max()) + _ROOM
        return self.rr.blueprint.EyeControls3D(
            position=(x, y - 0.4 * far, z + far), look_target=(x, y, z), eye_up=(0.0, 0.0, 1.0)
        )


class TopicLog(ABC):
    """Logs the topics of one kind, whose row has its class.

    Args:
        log: the log of the recording.
        topics: the topics, one or more.
    """

    is_large = False
    """True to log it after the others."""

    stands_apart = False
    """True to draw it apart from the world, not at the robot, if the pose of its sensor is unknown."""

    def __init__(self, log: Log, topics: Sequence[Topic]) -> None:
        self._log, self._rr, self._recording, self._topics = log, log.rr, log.recording, topics

    def frames(self) -> list[str]:
        """Return the names of the frames of its sensors."""
        return []

    def views(self) -> list[tuple[Any, float]]:
        """Return views for the blueprint, and their heights relative to the others."""
        return []

    @abstractmethod
    def steps(self, stream: Any, world: WorldFrame) -> Iterator[None]:
        """Log all topics, a piece at each step."""


def _is_of(topic: Topic, row: OnDemandWidget, names: Sequence[str]) -> bool:
    """Return True if a topic has a type of the row and was requested, by its name or because no names were given."""
    is_there = topic.count and not topic.problem and not row.types.isdisjoint(topic.type.split(", "))
    return bool(is_there) and (not names or topic.name in names)
