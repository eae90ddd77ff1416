"""The poses of the robot of a recording, by odometry."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..kinds import kind_of_class
from ..messages.standard import ODOMETRY
from ..poses.places import Places
from ..poses.recent import poses_at
from ..samples import Scan
from ._readable import ReadableRecording
from .topics import Topic, UnknownTopicError, named


def odometry(topics: Iterable[Topic]) -> str | None:
    """Return the topic of odometry, or None without one; of several topics with messages, the first by name."""
    there = (topic for topic in topics if topic.widget and topic.type == ODOMETRY)
    first = min(there, key=lambda topic: (not topic.count, topic.name), default=None)
    return first.name if first else None


def places_of(recording: ReadableRecording) -> Places:
    """Return the places of the robot at each of its scans, by odometry; without scans, at each odometry message.

    Raises:
        UnknownTopicError: the recording has no odometry.
    """
    topic = odometry(recording.topics)
    speeds = recording.speeds(topic) if topic else None
    poses = speeds.poses if speeds else np.empty((0, 3))
    known = np.isfinite(poses).all(axis=1)
    if not speeds or not known.any():
        raise UnknownTopicError(
            f"{recording.path.name} has no odometry, so its places are unknown: record nav_msgs/Odometry, too"
        )
    times, (x, y, yaw) = speeds.seconds[known], poses[known].T
    scanned = named(recording.topics, kind_of_class(Scan).name)
    seconds = ((recording.scans(scanned[0]) if scanned else None) or speeds).seconds
    return Places(seconds, poses_at(seconds, times, (x, y, np.unwrap(yaw))).T)
