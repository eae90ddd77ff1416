"""The layers of a live map by name."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..poses.live_frames import LiveFrames, OldTransform, held_between, notes_on
from ..poses.local_plane import LocalPlane
from ..poses.path import Path
from ..poses.transforms import Transform
from ..samples import Pose
from ..samples.map_item import SENSED, MapItem
from . import _distances
from .packing import PackedGrid, is_small, pack_grid
from .placing import Placed, by_plane, place, pose_of_frame, world_of, worlds_of_map

MOST_LAYERS = 30
MOST_PLANS = 200
"""Plans to keep for each layer, for the distance of the robot from them."""
ARROW = "->"

Floats = NDArray[np.float64]


class TooManyLayersError(ValueError):
    """The map has the most layers already."""


class Layer:
    """One layer: its newest item, and the place of that in the frame of the map."""

    def __init__(self, number: int, name: str) -> None:
        self.number, self.name = number, name
        self.item: MapItem | None = None
        self.is_placed = False
        """True once an item had a place. Until then its frame says nothing about the map."""
        self.frame: str | None = ""
        """The frame of the map that it is drawn in, or None if no transform joins it to one."""
        self.seconds = 0.0
        self.time_ns = 0
        self.placed: Placed | None = None
        self.held: OldTransform | None = None
        """The old transform that was used to place it, or None."""
        self.track = Path()
        self.plans: list[tuple[float, Floats]] = []
        self.packed_grid: PackedGrid | None = None
        """Its large grid, or None."""

    @property
    def about(self) -> dict[str, Any]:
        """The description of the layer for the page."""
        item = self.item
        if item is None:
            return {"name": self.name, "kind": "pose"}
        about: dict[str, Any] = {"name": self.name, "kind": kind_of(self.name, item)}
        if self.frame:
            about["frame"] = self.frame
        if item.grid is not None:
            about["most"] = item.grid.most
        if not item.frame_id:
            about["note"] = "names no frame"
        return about


def kind_of(name: str, item: MapItem) -> str:
    """Return the kind that a layer is drawn as: a pose is a goal if its name says so and it is not odometry."""
    return "goal" if item.kind == "pose" and "goal" in name.lower() and not item.child_frame_id else item.kind


def frames_in(name: str) -> tuple[str, str] | None:
    """Return the two frames in a name such as "map->base_link", or None for another name."""
    parent, arrow, child = name.partition(ARROW)
    return (
        (parent.strip().lstrip("/"), child.strip().lstrip("/")) if arrow and parent.strip() and child.strip() else None
    )


class Layers:
    """The layers of a live map in one frame. The widget holds its lock during each call.

    Layers that no transform joins to that frame are drawn in the root of their tree, on a separate map.

    Attributes:
        frames: the coordinate frames by tf and odometry.
        asked: the frame that the user chose, or empty for the common frame.
        edition: the number of changes of tracks.
    """

    def __init__(self) -> None:
        self.frames = LiveFrames()
        self.asked = ""
        self.edition = self._listing = 0
        self._worlds = [""]
        self._settled: tuple[int, str] = (-1, "")
        self._plane: LocalPlane | None = None
        """The plane at the first fix, for all layers."""
        self._by_name: dict[str, Layer] = {}

    def __bool__(self) -> bool:
        return bool(self._by_name)

    def __iter__(self) -> Iterator[Layer]:
        return iter(self._by_name.values())

    @property
    def frame(self) -> str:
        """The frame that the map is drawn in."""
        return self._worlds[0]

    @property
    def listing(self) -> int:
        """The number of changes of the list of layers and of the frames."""
        return self._listing + self.frames.edition

    def put(self, name: str, item: MapItem, seconds: float, time_ns: int) -> None:
        """Show the newest item of a layer, which is added if it is new."""
        layer = self._layer(name)
        item, self._plane = by_plane(item, self._plane)
        is_placed = layer.is_placed or not item.is_nowhere
        before = layer.item and (layer.item.kind, layer.item.frame_id, layer.is_placed)
        if before != (item.kind, item.frame_id, is_placed):
            layer.is_placed = is_placed
            self._listing += 1
        layer.item, layer.seconds, layer.time_ns, layer.placed = item, seconds, time_ns, None
        if item.child_frame_id and item.frame_id and item.pose == item.pose:
            half = item.pose.yaw / 2
            turn = (0.0, 0.0, float(np.sin(half)), float(np.cos(half)))
            pose = (item.pose.x, item.pose.y, 0.0, *turn)
            self.frames.add(
                Transform(item.frame_id, item.child_frame_id, time_ns, item.stamp_ns or 0, pose, odometry=True)
            )
        self._settle()
        self._place(layer)

    def add_frames(self, transforms: Iterator[Transform], seconds: float) -> None:
        """Take transforms of tf, and move the layers that show a frame. Errors in them are raised after that."""
        moved: dict[str, Transform] = {}
        try:
            for one in transforms:
                self.frames.add(one)
                moved[one.child] = one
        finally:
            self._settle()
            self._move(moved, seconds)

    def _move(self, moved: dict[str, Transform], seconds: float) -> None:
        """Move the layers that show a frame which these transforms moved."""
        for layer in self:
            pair = frames_in(layer.name)
            if pair is None or not (newest := self._newest(pair[1], moved)):
                continue
            stamp = newest.stamp_ns or None
            pose = pose_of_frame(self.frames, pair[1], pair[0], newest.time_ns, stamp)
            if pose is not None:
                self.put(
                    layer.name, MapItem("pose", pair[0], stamp, pose, child_frame_id=pair[1]), seconds, newest.time_ns
                )
                layer.held = layer.held or held_between(self.frames, pair[1], pair[0], newest.time_ns, stamp)

    def show_frame(self, name: str) -> None:
        """Add a layer for a frame in another, by a name such as "map->base_link"."""
        self._layer(name)

    def remove(self, name: str) -> None:
        """Remove a layer; raise KeyError if the name is unknown."""
        del self._by_name[name]
        self.edition += 1
        self._listing += 1
        self._settle()

    def choose(self, frame: str) -> None:
        """Draw in a frame, or in the common frame if it is empty."""
        self.asked = frame
        self._settle()

    def show_placed(self) -> tuple[list[Placed], dict[str, str]]:
        """Return the content of each layer, and the reasons why some layers are empty, by name."""
        shown, missing = [], {}
        for layer in self:
            if layer.item is None:
                missing[layer.name] = "not drawn: nothing came yet"
            elif placed := self._place(layer):
                shown.append(placed)
            else:
                missing[layer.name] = f"not drawn: no transform to {self.frame}"
        return shown, missing

    def notes(self) -> list[str]:
        """Return notes on the old transforms that were used to place layers."""
        return notes_on(layer.held for layer in self if layer.placed is not None)

    @property
    def known_frames(self) -> list[str]:
        """The frames that the map may be drawn in, the root first."""
        names: dict[str, None] = {}
        for layer in self:
            if layer.item is not None and layer.item.frame_id and layer.item.kind not in SENSED:
                names |= dict.fromkeys(reversed(self.frames.chain(layer.item.frame_id)))
        return list(names)

    def tracks(self) -> list[tuple[int, Floats]]:
        """Return the numbers and tracks of the layers with a track."""
        return [(layer.number, layer.track.points) for layer in self if layer.item and layer.item.kind == "pose"]

    def grids(self) -> list[PackedGrid]:
        """Return the large grids that are placed."""
        return [layer.packed_grid for layer in self if layer.packed_grid is not None]

    def distance(self, name: str, other: str) -> tuple[Floats, Floats]:
        """Return the seconds of each point of a layer's track, and its metres from another track or from a plan.

        The metres are NaN if no transform joins both.
        """
        one, two = self._by_name[name], self._by_name[other]
        track = one.track.points
        if one.frame != two.frame:
            return track[:, 0], np.full(len(track), np.nan)
        if two.item is not None and two.item.kind == "path":
            return track[:, 0], _distances.to_plans(track, two.plans)
        return track[:, 0], _distances.to_track(track, two.track.points)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of the layers, in the order in which they were added."""
        return tuple(self._by_name)

    def _layer(self, name: str) -> Layer:
        if name not in self._by_name:
            if len(self._by_name) >= MOST_LAYERS:
                raise TooManyLayersError(
                    f"put({name!r}): expected at most {MOST_LAYERS} layers; remove(name) removes one"
                )
            number = 1 + max((layer.number for layer in self), default=-1)
            self._by_name[name] = Layer(number, name)
            self._listing += 1
        return self._by_name[name]

    def _newest(self, frame: str, moved: dict[str, Transform]) -> Transform | None:
        """Return the newest of some transforms that moves a frame, or None."""
        found = [moved[name] for name in self.frames.chain(frame) if name in moved and not moved[name].static]
        return max(found, key=lambda one: one.stamp_ns, default=None)

    def _settle(self) -> None:
        """Choose the frames of the map. A layer in another frame starts a new track, because the old one is invalid."""
        if self._settled == (self.listing, self.asked):
            return
        placed = [layer.item for layer in self if layer.item is not None and layer.is_placed]
        items = placed or [layer.item for layer in self if layer.item is not None]
        self._worlds = worlds_of_map(self.frames, items, self.asked)
        for layer in self:
            frame = "" if layer.item is None else world_of(self.frames, self._worlds, layer.item.frame_id)
            if frame == layer.frame:
                continue
            layer.frame, layer.placed, layer.track, layer.plans = frame, None, Path(), []
            self.edition += 1
            self._listing += 1
        self._settled = (self.listing, self.asked)

    def _place(self, layer: Layer) -> Placed | None:
        item = layer.item
        if layer.placed is not None or item is None or layer.frame is None:
            return layer.placed
        placed = place(self.frames, layer.frame, item, layer.time_ns, layer.number, layer.seconds)
        if placed is None:
            return None
        frame = item.frame_id or layer.frame
        layer.held = held_between(self.frames, frame, layer.frame, layer.time_ns, item.stamp_ns)
        if item.kind == "pose":
            measured = item.stamp_ns / 1e9 if item.stamp_ns else None
            layer.track.add(layer.seconds, Pose(*placed.pose), measured)
            self.edition += 1
        elif item.kind == "path":
            layer.plans = [*layer.plans[1 - MOST_PLANS :], (layer.seconds, placed.points)]
        elif item.grid is not None:
            layer.packed_grid = None if is_small(item.grid) else pack_grid(layer.number, item.grid)
            placed = placed._replace(version=layer.packed_grid.version if layer.packed_grid else 0)
        layer.placed = placed
        return placed
