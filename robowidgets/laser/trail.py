"""The scans before the one on show: the trail behind it, and their spread."""

from __future__ import annotations

import time
from contextlib import suppress
from typing import Any

import numpy as np
import traitlets

from ..messages import to_pose
from ..messages.fields import get, stamp_ns, unwrap
from ..poses.live_frames import Frames, LiveFrames, held_between, notes_on
from ..poses.mounts import ODOM, ROBOT
from ..poses.recent import RecentPoses
from ..poses.transforms import transforms_in
from ..samples import Pose, Scan, yaw_of
from ..samples.age import arrival_of
from ._mount import HasMount

MOST_SCANS = 100


class HasTrail(HasMount):
    """A laser widget that also shows earlier scans that the page keeps."""

    trail = traitlets.Int(0, min=0, max=MOST_SCANS, help="Number of earlier scans behind the one on show.").tag(
        sync=True
    )
    spread = traitlets.Int(
        0, min=0, max=MOST_SCANS, help="Number of scans for the spread of each ray, 2 or more, or 0 for none."
    ).tag(sync=True)

    def __init__(self, **kwargs: Any) -> None:
        self._recent, self._frames = RecentPoses(), LiveFrames()
        super().__init__(**kwargs)

    @traitlets.validate("spread")
    def _before_spread(self, proposal: Any) -> Any:
        if proposal["value"] == 1:
            raise traitlets.TraitError("spread: expected a number of scans, 2 or more, or 0 for none, got 1")
        return proposal["value"]

    def scanner_at(self, robot: Pose | None) -> dict[str, Any]:
        """Return the texts for the page on a scan of a robot at a pose: the pose of the scanner in the odometry frame.

        It has the heading of the robot, like the angles of the scan. Without a footprint, it has the position of the
        robot.
        """
        if robot is None:
            return {}
        scanner = robot.offset(self.footprint.scanner[0], self.footprint.scanner[1], 0.0) if self.footprint else robot
        return {"pose": [round(value, 5) for value in scanner]}

    @property
    def frame_topics(self) -> str:
        """See `TakesFrames` in `poses.live_frames`: needed for a trail, in case its view has no path widget."""
        return "odometry" if self.trail and not self.driven_by_player else ""

    def take_frames(self, message: Any) -> None:
        """Take the newest message of odometry or of tf of the robot, and ignore messages without a pose."""
        self._take_frames(message, static=False)

    def take_static_frames(self, message: Any) -> None:
        """Take a message of tf with static transforms."""
        self._take_frames(message, static=True)

    def _take_frames(self, message: Any, *, static: bool) -> None:
        inner = unwrap(message)
        now = time.monotonic()
        transforms = get(inner, "transforms", None)
        with self._newest.lock, suppress(TypeError, ValueError):
            if transforms is not None:
                for one in transforms_in(inner, static, round(now * 1e9)):
                    self._frames.add(one)
            else:
                self._recent.add(to_pose(inner), now, getattr(inner, "stamp_ns", None) or stamp_ns(inner))

    def _placed(self, scan: Scan) -> dict[str, Any]:
        """Return the pose of a live scan, by the first path widget by name in the laser's view that has one.

        Without one, by the odometry from a feed, or by tf.
        """
        if not self.trail or self.driven_by_player:
            return {}
        paths = sorted((one for one in self._group if one.sample_name == "pose"), key=lambda path: str(path.title))
        robot = next((at for path in paths if (at := path.robot_at(scan))), None)
        if robot is not None:
            return self.scanner_at(robot)
        with self._newest.lock:
            robot = self._recent.at(arrival_of(scan), scan.stamp_ns)
            return self.scanner_at(robot) if robot else scanner_in(self._frames, scan, round(arrival_of(scan) * 1e9))


def scanner_in(frames: Frames, scan: Scan, time_ns: int) -> dict[str, Any]:
    """Return the texts for the page on a scan, with its pose from tf in the odometry frame, else in the root frame.

    They are empty if tf does not contain the motion of the robot.
    """
    frame = scan.frame_id.lstrip("/")
    chain = frames.chain(frame)
    world = next((name for name in chain if name == ODOM), chain[-1])
    if world == frame or world.rpartition("/")[2] in ROBOT:
        return {}  # no frame in which the robot moves
    at = frames.poses(frame, world, np.array([time_ns], np.int64), np.array([scan.stamp_ns or 0], np.int64))
    (x, y, _), yaw = at.positions[0], yaw_of(*at.orientations[0]) - (scan.mount.yaw if scan.mount else 0.0)
    notes = notes_on([held_between(frames, frame, world, time_ns, scan.stamp_ns)])
    pose = [round(float(value), 5) for value in (x, y, yaw)]
    return {"pose": pose, "placed_by": "tf", **({"notes": notes} if notes else {})}
