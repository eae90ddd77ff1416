"""Logging a recording to Rerun, column by column and in pieces."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..kinds import KINDS, ON_DEMAND, OnDemandWidget, load
from ..messages import to_cloud
from ..poses.frame_tree import Poses
from ..recordings import RecordingData
from ..recordings.columns.chunks import ScanChunk
from ..recordings.topics import Topic, wanted
from ..samples import AXES, Cloud, Scan, TouchState
from ..samples.cloud import AXES as CLOUD_AXES
from ._sdk import library
from ._world import WorldFrame

SECONDS, CLOCK = "recording_time", "message_log_time"
"""The timelines: the time since the start of the recording, as in the widgets, and the clock of the recorder, with the
name that Rerun uses for MCAP files."""

_PIECE_BYTES = 1 << 20
_ROOM = 3.0
"""Metres to show around the path."""

_WORLD, _PLOT, _LANE, _MOST_LANES = 300.0, 100.0, 24.0, 5
"""The relative heights of the views, and the highest number of lanes that add height."""

_COLOURS = ((0, 140, 149), (180, 83, 9), (88, 80, 176), (190, 24, 93))
_STATE_NAMES = {TouchState.FREE: "free", TouchState.TOUCHED: "touched", TouchState.UNKNOWN: ""}


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
                self._parts.append(load(kind.rerun)(self, of_kind))
        self._parts += [load(row.rerun)(self, messages[row.name]) for row in on_demand if messages[row.name]]

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
        views = [(first, _WORLD), *(view for part in self._parts for view in part.views())]
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
    """Logs the topics of one kind, whose row names its class.

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
            yield from self._log_scans(stream, topic.name, world, _COLOURS[number % len(_COLOURS)])

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
            colour = _COLOURS[-1 - number % len(_COLOURS)]
            stream.log(entity, rr.Points3D.from_fields(colors=colour, radii=rr.Radius.ui_points(1.0)), static=True)
            for time_ns, cloud in self._clouds(topic.name):
                times, stamps = np.array([[time_ns], [cloud.stamp_ns or 0]], np.int64)
                positions = np.column_stack([cloud.points[axis] for axis in CLOUD_AXES]).astype(np.float32)
                points = rr.Points3D.columns(positions=positions).partition([len(cloud)])
                log.send(stream, entity, times, [*points, *log.transforms(world.poses(cloud.frame_id, times, stamps))])
                yield

    def _clouds(self, topic: str) -> Iterator[tuple[int, Cloud]]:
        """Yield log times and clouds, without messages that are not clouds."""
        for moment in self._recording.messages(topic):
            with suppress(TypeError, ValueError):
                yield moment.time_ns, to_cloud(moment.message)


class SpeedLog(TopicLog):
    """Logs speeds as curves, one for each axis."""

    def views(self) -> list[tuple[Any, float]]:
        """See `TopicLog`."""
        views = []
        for name, axes in (("Linear, m/s", AXES[:3]), ("Angular, rad/s", AXES[3:])):
            lines = [entity for topic in self._topics for entity in self._moving(topic.name, axes)]
            if lines:
                views.append((self._rr.blueprint.TimeSeriesView(origin="speeds", contents=lines, name=name), _PLOT))
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


class TouchLog(TopicLog):
    """Logs touch sensors as lanes of states."""

    def views(self) -> list[tuple[Any, float]]:
        """See `TopicLog`."""
        sensors = sum(len(self._recording.touches(topic.name).labels) for topic in self._topics)
        if not sensors:
            return []
        height = _PLOT + min(sensors, _MOST_LANES) * _LANE
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


def _is_of(topic: Topic, row: OnDemandWidget, names: Sequence[str]) -> bool:
    """Return True if a topic has a type of the row and was requested, by its name or because no names were given."""
    is_there = topic.count and not topic.problem and not row.types.isdisjoint(topic.type.split(", "))
    return bool(is_there) and (not names or topic.name in names)


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
