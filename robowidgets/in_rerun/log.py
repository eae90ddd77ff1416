"""A recording as Rerun takes it: column by column, a piece at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..poses.tracks import Poses
from ..recording import Recording
from ..recordings.chunks import ScanChunk
from ..samples import AXES, Scan, TouchState
from .sdk import library
from .world import World

SECONDS, CLOCK = "recording_time", "message_log_time"
"""The timelines: since the start of the recording, as all widgets tell it; and by the recorder's clock, as Rerun calls
that when it opens an MCAP by itself."""

_PIECE_BYTES = 1 << 20
_ROOM = 3.0
"""Metres round the path."""

_WORLD, _PLOT, _LANE, _MOST_LANES = 300.0, 100.0, 24.0, 5
"""Heights in the viewer, as they relate to each other."""

_COLOURS = ((0, 140, 149), (180, 83, 9), (88, 80, 176), (190, 24, 93))
_TOUCHED = {TouchState.FREE: "free", TouchState.TOUCHED: "touched", TouchState.UNKNOWN: ""}


class Log:
    """What of a recording goes to Rerun.

    Args:
        recording: whose.
        topics: names of topics in it; none: all that have a widget.

    Raises:
        ImportError: rerun-sdk is not installed.
        UnknownTopicError: it has no such topic, or one that no widget shows.
    """

    def __init__(self, recording: Recording, topics: Sequence[str] = ()) -> None:
        self._rr = library("rerun")
        self._recording = recording
        recording.samples(topics or None)
        shown = [t for t in recording.topics if t.widget and (not topics or t.name in topics)]
        self._topics = {kind: [t.name for t in shown if t.widget == kind] for kind in ("laser", "speed", "touch")}
        self._commanded = {t.name for t in shown if t.commanded}
        self._start_ns = recording.start_ns or 0

    def stream(self) -> Any:
        """A new `rerun.RecordingStream` for it, that leads nowhere yet."""
        return self._rr.RecordingStream("robowidgets", send_properties=False)

    def steps(self, stream: Any) -> Iterator[None]:
        """Log all of it, a piece at each step, the large pieces last."""
        stream.send_recording_name(self._recording.path.name)
        firsts = (next(self._recording.samples(topic), None) for topic in self._topics["laser"])
        scanners = [first.sample.frame_id for first in firsts if first and isinstance(first.sample, Scan)]
        world = World(self._recording, scanners)
        stream.send_blueprint(self._blueprint(world))
        self._log_world(stream, world)
        yield
        for topic in self._topics["speed"]:
            self._log_speeds(stream, topic)
            yield
        for topic in self._topics["touch"]:
            self._log_touches(stream, topic)
            yield
        for number, topic in enumerate(self._topics["laser"]):
            yield from self._log_scans(stream, topic, world, _COLOURS[number % len(_COLOURS)])

    def _log_world(self, stream: Any, world: World) -> None:
        rr = self._rr
        stream.log("world", rr.ViewCoordinates.FLU, static=True)
        if path := world.path():
            times_ns, poses = path
            stream.log(
                "world/path",
                rr.LineStrips3D([poses.places], colors=[130, 130, 130], radii=rr.Radius.ui_points(1.0)),
                static=True,
            )
            stream.log("world/robot", rr.TransformAxes3D(0.5), static=True)
            self._send(stream, "world/robot", times_ns, self._at(poses))
        if world.notes:
            stream.log("notes", rr.TextDocument("\n\n".join(world.notes)), static=True)

    def _log_scans(self, stream: Any, topic: str, world: World, colour: Sequence[int]) -> Iterator[None]:
        rr, entity = self._rr, self._entity("world/scans", topic)
        labelled = 0
        stream.log(entity, rr.Points3D.from_fields(colors=colour, radii=rr.Radius.ui_points(2.0)), static=True)
        for chunk in self._recording.scans(topic).chunks():
            rays = chunk.ranges.shape[1]
            if rays > labelled:
                # Once for all scans: every ray is logged, also those that read nothing, so each keeps its number.
                labels = [f"ranges[{ray}]" for ray in range(rays)]
                stream.log(entity, rr.Points3D.from_fields(labels=labels, show_labels=False), static=True)
                labelled = rays
            rows = max(_PIECE_BYTES // (12 * rays + 64), 1)
            for first in range(0, len(chunk), rows):
                piece = chunk.part(slice(first, first + rows))
                poses = world.poses(chunk.like.frame_id, piece.times_ns, piece.stamps_ns)
                points = rr.Points3D.columns(positions=_points(piece)).partition([rays] * len(piece))
                self._send(stream, entity, piece.times_ns, [*points, *self._at(poses)])
                yield

    def _log_speeds(self, stream: Any, topic: str) -> None:
        rr, speeds = self._rr, self._recording.speeds(topic)
        # What was asked for holds until something else is.
        between = rr.components.InterpolationMode.StepAfter if topic in self._commanded else None
        for axis, column in zip(AXES, speeds.values.T, strict=True):
            known = np.isfinite(column)
            if known.any():
                entity = self._entity("speeds", topic, axis)
                stream.log(entity, rr.SeriesLines(names=f"{topic} {axis}", interpolation_mode=between), static=True)
                self._send(stream, entity, speeds.times_ns[known], rr.Scalars.columns(scalars=column[known]))

    def _log_touches(self, stream: Any, topic: str) -> None:
        rr, touches = self._rr, self._recording.touches(topic)
        for label, states in zip(touches.labels, touches.states.T, strict=True):
            entity = self._entity("touches", topic, label)
            style = rr.StateConfiguration(values=["free", "touched"], colors=[(200, 205, 210), (220, 38, 38)])
            stream.log(entity, style, static=True)
            changed = np.flatnonzero(np.diff(states, prepend=np.uint8(255)))
            told = [_TOUCHED[TouchState(int(state))] for state in states[changed]]
            self._send(stream, entity, touches.times_ns[changed], rr.StateChange.columns(state=told))

    def _at(self, poses: Poses) -> Any:
        return self._rr.Transform3D.columns(translation=poses.places, quaternion=poses.turns)

    def _send(self, stream: Any, entity: str, times_ns: NDArray[np.int64], columns: Any) -> None:
        rr = self._rr
        times = [
            rr.TimeColumn(SECONDS, duration=(times_ns - self._start_ns).astype("timedelta64[ns]")),
            rr.TimeColumn(CLOCK, timestamp=times_ns.astype("datetime64[ns]")),
        ]
        stream.send_columns(entity, times, columns, strict=True)

    def _blueprint(self, world: World) -> Any:
        blueprint = self._rr.blueprint
        space = blueprint.Spatial3DView(origin="world", name=f"World ({world.name})", eye_controls=self._eye(world))
        unknown = blueprint.TextDocumentView(origin="notes", name="Not known")
        views = [blueprint.Tabs(space, unknown, active_tab=0) if world.notes else space]
        shares = [_WORLD]
        for name, axes in (("Speed, m/s", AXES[:3]), ("Turn, rad/s", AXES[3:])):
            lines = [entity for topic in self._topics["speed"] for entity in self._moving(topic, axes)]
            if lines:
                views.append(blueprint.TimeSeriesView(origin="speeds", contents=lines, name=name))
                shares.append(_PLOT)
        sensors = sum(len(self._recording.touches(topic).labels) for topic in self._topics["touch"])
        if sensors:
            views.append(blueprint.StateTimelineView(origin="touches", name="Touch"))
            shares.append(_PLOT + min(sensors, _MOST_LANES) * _LANE)
        return blueprint.Blueprint(
            blueprint.Vertical(*views, row_shares=shares),
            blueprint.TimePanel(timeline=SECONDS, state="collapsed", play_state="paused"),
            collapse_panels=True,
        )

    def _moving(self, topic: str, axes: Sequence[str]) -> list[str]:
        """The axes that a robot of this kind moves along: a plane one is always 0 along the others."""
        values = dict(zip(AXES, np.nan_to_num(self._recording.speeds(topic).values).T, strict=True))
        return [self._entity("speeds", topic, axis) for axis in axes if values[axis].any()]

    def _eye(self, world: World) -> Any:
        """From above, a little behind: all of the path, with room for what the scans see round it."""
        places = path[1].places if (path := world.path()) else np.zeros((1, 3))
        low, high = places.min(axis=0), places.max(axis=0)
        x, y, z = (low + high) / 2
        far = 0.75 * float((high - low).max()) + _ROOM
        return self._rr.blueprint.EyeControls3D(
            position=(x, y - 0.4 * far, z + far), look_target=(x, y, z), eye_up=(0.0, 0.0, 1.0)
        )

    def _entity(self, *parts: str) -> str:
        """A path of which each part is one step, whatever is in a topic's name: else a scan would ride on another."""
        first, *rest = parts
        escaped = [self._rr.escape_entity_path_part(part.strip("/").replace(" ", "_")) for part in rest]
        return "/".join([first, *escaped])


def _points(chunk: ScanChunk) -> NDArray[np.float32]:
    """X, y and z in metres in the frame of the scanner, shape (N * R, 3); NaN where a ray is no reading."""
    ranges = np.where(
        (chunk.ranges >= chunk.range_min) & (chunk.ranges <= chunk.range_max), chunk.ranges, np.float32(np.nan)
    )
    angles = chunk.angle_min + np.arange(ranges.shape[1]) * chunk.angle_increment
    points = np.zeros((*ranges.shape, 3), np.float32)
    np.multiply(ranges, np.cos(angles), out=points[..., 0], casting="same_kind")
    np.multiply(ranges, np.sin(angles), out=points[..., 1], casting="same_kind")
    return points.reshape(-1, 3)
