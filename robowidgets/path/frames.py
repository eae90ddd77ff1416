"""The tracks of a map of a recording: its layers at every time, in one frame."""

from __future__ import annotations

from collections.abc import Iterator
from heapq import merge
from math import isfinite, nan
from typing import Any, NamedTuple

import numpy as np

from ..kinds.choice import WidgetChoice
from ..messages.map_item import to_map_item
from ..path_widget import PathPoint, PathWidget
from ..poses.frame_tree import FrameTree
from ..poses.live_frames import held_between, notes_on
from ..poses.local_plane import LocalPlane
from ..poses.mounts import ROBOT
from ..poses.path import Path
from ..poses.transforms import TRANSFORMS
from ..recordings import RecordingData
from ..recordings.topics import UPDATES, Moment, TimedMessage, updates_in
from ..runtime.text import many
from ..samples import Pose
from ..samples.map_item import SENSED, MapItem
from ..tracks import BEFORE, NEW, SampleFrames, Track
from ..widget.timed_frame import FRAME_HEADER, TimedFrame
from .layers import kind_of
from .packing import PackedGrid, is_small, pack_grid
from .placing import Floats, Placed, by_plane, place, poses_in, world_of, worlds_of_map

MOST_POSES = 200_000
"""The maximum number of poses of a path; of more, evenly chosen ones."""

MOST_READ = 30_000
"""The approximate maximum number of messages that are read of a layer with a path; of more, evenly chosen ones."""

MOST_TRANSFORMS = 100_000
"""The approximate maximum number of messages with transforms that are read."""

MOST_GRIDS = 20
"""The maximum number of large grids of a layer that a page gets; of more, every second, every third, and so on."""

TOGETHER = 0.02
"""Seconds within which updates of the layers are shown in one frame."""


def path_track(recording: RecordingData, choice: WidgetChoice, widget: PathWidget) -> Track:
    """Return the `Track` of a path widget: a path for one topic of odometry, otherwise a map."""
    return MapFrames(recording, choice, widget) if choice.takes_messages else PathFrames(recording, choice, widget)


class _Told(NamedTuple):
    """The last item of a layer, and its time."""

    item: MapItem
    seconds: float
    time_ns: int
    version: int = 0
    """The version of a large grid."""


class _LargeGrid(NamedTuple):
    """A large grid that the page already has, without its cells."""

    told: _Told
    packed: PackedGrid


class WholeMap:
    """The parts of a recording that are read once: its transforms, and the paths and the large grids of its layers.

    Args:
        recording: the recording.
        names: the topics of the layers.
        frames: True if the robot's frame, from tf, is a layer.
        asked: the frame of the map, or empty to find one.
    """

    def __init__(self, recording: RecordingData, names: list[str], frames: bool, asked: str) -> None:
        self.asked, self.names = asked, names
        self._start_ns = recording.start_ns or 0
        self.notes: list[str] = []
        self.plane: LocalPlane | None = None
        """The local plane of the first fix, for all layers."""
        self.errors: dict[str, str] = {}
        self.grids: dict[str, list[_LargeGrid]] = {}
        every = -(-recording.transform_count // MOST_TRANSFORMS) or 1
        if every > 1:
            self.notes.append(f"transforms: about 1 of {every} of {many(recording.transform_count, 'message')}")
        self.tree = FrameTree(recording.transforms(every))
        self._read(recording)
        self.base = next((name for name in ROBOT if frames and self.tree.history(name)), "")
        firsts = self._firsts.values()
        worlds = worlds_of_map(self.tree, [item for item in firsts if not item.is_nowhere] or firsts, asked)
        self.frame = worlds[0] or (self.tree.chain(self.base)[-1] if self.base else "")
        worlds[0] = self.frame
        first_frames = {name: item.frame_id for name, item in self._firsts.items()}
        self.frame_of = {name: world_of(self.tree, worlds, frame) for name, frame in first_frames.items()}
        """The map frame of each layer, or None if no transform joins the layer to one."""
        self.layers = [*names]
        if self.base:
            world = world_of(self.tree, worlds, self.base) or self.tree.chain(self.base)[-1]
            if world != self.base:
                self.layers.append(f"{world}->{self.base}")
                self.frame_of[self.layers[-1]] = world

    def about(self) -> dict[str, Any]:
        """Return the data for the page on the layers."""
        layers = []
        for number, name in enumerate(self.layers):
            item = self._firsts.get(name)
            about: dict[str, Any] = {"name": name, "number": number, "kind": kind_of(name, item) if item else "pose"}
            if frame := self.frame_of.get(name):
                about["frame"] = frame
            if item and item.grid is not None:
                about["most"] = item.grid.most
            if item and not item.frame_id:
                about["note"] = "names no frame"
            if updates := self._updates.get(name):
                about["note"] = f"{many(updates, 'update')} on {name}{UPDATES} not drawn"
            if every := self._thinned.get(name):
                about["note"] = f"path from about 1 of {every} of {many(self._counts[name], 'message')}"
            if (large := self.grids.get(name)) and self._counts[name] > len(large):
                about["note"] = f"{len(large)} of {many(self._counts[name], 'map')} shown"
            layers.append(about)
        frames: dict[str, None] = {}
        for item in self._firsts.values():
            if item.frame_id and item.kind not in SENSED and not item.is_nowhere:
                frames |= dict.fromkeys(reversed(self.tree.chain(item.frame_id)))
        return {"layers": layers, "frames": list(frames)}

    def tracks(self) -> list[tuple[int, Floats]]:
        """Return the paths of the layers, in the frame of the map."""
        found = []
        for number, name in enumerate(self.layers):
            rows = self._rows.get(name, [])
            if number >= len(self.names):
                rows = self._of_base()
            if not rows:
                continue
            numbers = np.array([row[:4] for row in rows])
            times, stamps = (np.array([row[i] for row in rows], np.int64) for i in (4, 5))
            frame = self.base if number >= len(self.names) else self._firsts[name].frame_id
            world = self.frame_of[name] or self.frame
            poses = poses_in(self.tree, frame, world, times, stamps, numbers[:, 1:])
            if poses is not None:
                found.append((number, _way(numbers[:, 0], poses, times)))
        return found

    def _of_base(self) -> list[tuple[float, float, float, float, int, int]]:
        """Return the times of the robot's frame: the times of all transforms that move it."""
        moving = [self.tree.history(name) for name in self.tree.chain(self.base)]
        all_times = [(h.times_ns, h.stamps_ns) for h in moving if h is not None and not h.static]
        rows = {int(t): int(s) for times, stamps in all_times for t, s in zip(times, stamps, strict=True)}
        return [((t - self._start_ns) / 1e9, 0.0, 0.0, 0.0, t, rows[t]) for t in sorted(rows)]

    def moves(self, start: float, end: float) -> list[tuple[float, float, float, float, int, int]]:
        """Return the times at which the frame of the robot moved in a span."""
        return [row for row in self._of_base() if start <= row[0] < end]

    def told_by(self, name: str, moment: Moment | TimedMessage | None) -> _Told | None:
        """Return the item in a message of a topic, or None if it has no place on a map."""
        if moment is None:
            return None
        large = self.grids.get(name)
        if large:
            return next((one.told for one in reversed(large) if one.told.time_ns <= moment.time_ns), None)
        try:
            item, _ = by_plane(to_map_item(moment), self.plane)
        except (TypeError, ValueError) as error:
            self.errors[name] = f"not drawn: {error}"
            return None
        return _Told(item, moment.seconds, moment.time_ns)

    def place(
        self, now: dict[str, _Told | None], seconds: float, time_ns: int
    ) -> tuple[list[Placed], dict[str, str], list[str]]:
        """Return the placed items at a time, the reasons why layers are missing, and notes on old transforms."""
        shown, missing, held = [], {}, []
        for number, name in enumerate(self.layers):
            told = now.get(name)
            if number >= len(self.names):
                item = MapItem("pose", self.base, None, Pose(0.0, 0.0, 0.0))
                told = _Told(item, seconds, time_ns)
            if told is None:
                if name in self.errors:
                    missing[name] = self.errors[name]
                continue
            world = self.frame_of.get(name) or self.frame
            placed = place(self.tree, world, told.item, told.time_ns, number, told.seconds)
            if name in self._firsts and self._firsts[name].is_nowhere:
                missing[name] = "not drawn: no message has a place"
            elif placed is None:
                missing[name] = f"not drawn: no transform to {world}"
            else:
                shown.append(placed._replace(version=told.version))
                frame = told.item.frame_id or world
                held.append(held_between(self.tree, frame, world, told.time_ns, told.item.stamp_ns))
        return shown, missing, notes_on(held)

    def _read(self, recording: RecordingData) -> None:
        """Read the first item of each layer, all poses of layers with a path, and all large grids."""
        self._firsts: dict[str, MapItem] = {}
        self._thinned: dict[str, int] = {}
        self._rows: dict[str, list[tuple[float, float, float, float, int, int]]] = {}
        self._counts = {topic.name: topic.count or 0 for topic in recording.topics}
        self._updates = updates_in(recording.topics)
        for name in self.names:
            rows = self._rows[name] = []
            step = max(1, -(-self._counts[name] // MOST_GRIDS))
            every = max(1, -(-self._counts[name] // MOST_READ))
            for i, moment in enumerate(recording.thinned_messages(name, every)):
                if i % step and name in self.grids:
                    continue
                try:
                    item, self.plane = by_plane(to_map_item(moment), self.plane)
                except (TypeError, ValueError) as error:
                    self.errors.setdefault(name, f"not drawn: {error}")
                    continue
                if name not in self._firsts or self._firsts[name].is_nowhere:
                    self._firsts[name] = item
                if item.grid is not None and not is_small(item.grid):
                    self._keep(name, moment, item)
                elif item.kind == "pose" and kind_of(name, item) == "pose":
                    if every > 1:
                        self._thinned[name] = every
                    if isfinite(item.pose.x):
                        rows.append((moment.seconds, *item.pose, moment.time_ns, item.stamp_ns or 0))
                else:
                    break  # its items are read at each moment

    def _keep(self, name: str, moment: TimedMessage, item: MapItem) -> None:
        assert item.grid is not None
        packed = pack_grid(self.names.index(name), item.grid)
        stub = MapItem("grid", item.frame_id, item.stamp_ns, item.grid.origin)
        told = _Told(stub, moment.seconds, moment.time_ns, packed.version)
        self.grids.setdefault(name, []).append(_LargeGrid(told, packed))


class MapFrames:
    """A `Track` of the layers of a map: the last item of each of its topics, in one frame.

    It includes the newest scans of the recording. The transforms of the recording join the frames.

    Args:
        recording: the recording.
        choice: the topics.
        widget: the map, which gets the paths and the large grids of the whole recording.
    """

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: PathWidget) -> None:
        self._recording, self._widget = recording, widget
        types = {topic.name: topic.type for topic in recording.topics}
        self._topics = [name for name in choice.topics if types.get(name) not in TRANSFORMS]
        asks_tf = any(types.get(name) in TRANSFORMS for name in choice.own)
        whole = widget.whole_map
        if not isinstance(whole, WholeMap) or whole.asked != widget.frame:
            whole = WholeMap(recording, self._topics, asks_tf, widget.frame)
            widget.whole_map = whole
            grids = [
                (self._topics.index(name), one.told.seconds, one.packed)
                for name, own in whole.grids.items()
                for one in own
            ]
            widget.show_map(whole.about(), whole.tracks(), grids)
        self._whole: WholeMap = whole
        self._before: tuple[Any, ...] = ()

    def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
        """See `Track`."""
        whole = self._whole
        now = self._now(start)
        nothing = (BEFORE, self._recording.start_ns or 0)
        seconds, time_ns = max(((one.seconds, one.time_ns) for one in now.values() if one), default=nothing)
        if whole.base:
            seconds, time_ns = start, self._time_ns(start)
        # The first frame shows the place of the robot at that time, even without a message.
        began, came = seconds, not whole.base
        each = [self._recording.messages(name, start, end) for name in self._topics]
        if whole.base:
            each.append(self._ticks(start, end))
        for moment in merge(*each, key=lambda moment: moment.time_ns):
            if moment.seconds - began >= TOGETHER or seconds < 0:
                yield self._shown(now, seconds, time_ns, came)
                began = moment.seconds
            if moment.topic and (told := whole.told_by(moment.topic, moment)):
                now[moment.topic] = told
            seconds, time_ns, came = moment.seconds, moment.time_ns, True
        yield self._shown(now, seconds, time_ns, came)

    def seek(self, seconds: float) -> None:
        """See `Track`."""
        now = self._now(seconds)
        times = tuple(one and one.time_ns for one in now.values())
        if times == self._before and not self._whole.base:
            return
        self._before = times
        about, point = self._point(now, seconds, self._time_ns(seconds))
        self._widget.show_moment(point, about)

    def _now(self, seconds: float) -> dict[str, _Told | None]:
        return {name: self._whole.told_by(name, self._recording.message_at(name, seconds)) for name in self._topics}

    def _ticks(self, start: float, end: float) -> Iterator[TimedMessage]:
        """Yield the times at which the robot's frame moved."""
        for seconds, *_, time_ns, _ in self._whole.moves(start, end):
            yield TimedMessage("", time_ns, None, seconds)

    def _time_ns(self, seconds: float) -> int:
        return (self._recording.start_ns or 0) + round(seconds * 1e9)

    def _shown(self, now: dict[str, _Told | None], seconds: float, time_ns: int, came: bool) -> TimedFrame:
        about, point = self._point(now, seconds, time_ns)
        drawn, frame = self._widget.frame_of(point)
        news: dict[str, Any] = {} if came else {NEW: []}
        return TimedFrame(seconds, {**drawn, **about, **news}, FRAME_HEADER.pack(0.0, nan, 0, 0.0) + frame)

    def _point(self, now: dict[str, _Told | None], seconds: float, time_ns: int) -> tuple[dict[str, Any], PathPoint]:
        placed, missing, old = self._whole.place(now, seconds, time_ns)
        about: dict[str, Any] = {"frame_id": self._whole.frame}
        if missing:
            about["missing"] = missing
        if notes := [*self._whole.notes, *old]:
            about["notes"] = notes
        return about, PathPoint(seconds, nan, nan, nan, layers=tuple(placed))


def _way(seconds: Floats, poses: Floats, times_ns: Any) -> Floats:
    """Reduce a path to as many points as a page needs."""
    path = Path()
    for at, pose, time_ns in zip(seconds.tolist(), poses.tolist(), times_ns.tolist(), strict=True):
        path.add(at, Pose(*pose), clock=time_ns / 1e9)
    return path.points


class PathFrames(SampleFrames):
    """A `Track` of the odometry poses, on the path of the whole recording; see `SampleFrames`."""

    def __init__(self, recording: RecordingData, choice: WidgetChoice, widget: PathWidget) -> None:
        super().__init__(recording, choice, widget)
        if not len(widget.points):
            widget.show_whole(_path_of(recording, choice.topic))

    def _frame(self, seconds: float, sample: Any, **_: Any) -> TimedFrame:
        x, y, yaw = sample.pose
        return super()._frame(seconds, PathPoint(seconds, x, y, yaw, sample.stamp_ns))


def _path_of(recording: RecordingData, topic: str) -> Path:
    """Return the path of a topic of odometry, from all of its poses, or from evenly chosen ones if there are many."""
    path, start_ns = Path(), recording.start_ns or 0
    speeds = recording.speeds(topic)
    step = -(-len(speeds) // MOST_POSES) or 1
    for chunk in speeds.chunks():
        times, poses = chunk.times_ns, chunk.poses
        # The last pose of each chunk, too: the path must end at the robot.
        chosen = np.unique(np.append(np.arange(0, len(times), step), np.arange(len(times))[-1:]))
        for time_ns, pose in zip(times[chosen].tolist(), poses[chosen].tolist(), strict=True):
            path.add((time_ns - start_ns) / 1e9, Pose(*pose), clock=time_ns / 1e9)
    return path
