"""The code in the notebook's kernel that measures the laser of a robot with thirty topics: `feed.show`."""

from __future__ import annotations

import time
from typing import Any

import numpy as np
from IPython.display import display

from robowidgets import Scan

from . import feed_kernel
from .rivals import bare
from .scan import encode
from .topics_robot import TOPICS

CARDS = (
    "/imu.angular_velocity.z",
    "/wheel/left.data",
    "/joint_states as message",
    "/rosout as events",
    "/pose",
    "/range/front",
)
"""The topics in addition to laser and speed: a plot and a message at 1 kHz, a plot, events, a map, a sonar."""
SHOWN: dict[str, tuple[str, ...]] = {
    "alone": ("/scan",),
    "beside": ("/scan",),
    "cards": ("/scan", "/odom", *CARDS),
    "listed": (),
}
"""The topics of each view, or nothing for the default of `feed.show()`."""
ONE_TOPIC = ("bare", "alone")
"""The views of a robot with only the laser."""


class Source(feed_kernel.Source):
    """The view of a feed, or a bare canvas instead.

    Args:
        name: the middleware and the view: ``dds-cards``.
    """

    _robot: feed_kernel.Outside

    def __init__(self, name: str, _count: int) -> None:
        middleware, _, self._what = name.partition("-")
        self._view: Any = None
        super().__init__(middleware, 0)
        if self._what == "bare":
            self._view, self._update = bare.make(encode(0))
            self._robot.feed.connect("/scan", self._hand)
            return
        if self._what != "alone":
            self._robot.beside("beside")
        feed = self._robot.feed
        wanted = {"/scan"} if self._what == "alone" else {"/scan", *TOPICS}
        while not wanted <= {topic.name for topic in feed.topics}:
            time.sleep(0.05)
        self._view = feed.show(*SHOWN[self._what])
        self._view.topic_list.folded = self._what != "listed"

    def show(self) -> None:
        """Display the view."""
        if self._what != "bare":
            while "/scan" not in self._view.widgets:
                time.sleep(0.05)
            self._lasers = [self._view.widgets["/scan"]]
            self.put(0)
        display(self._view)  # type: ignore[no-untyped-call]

    def put(self, number: int) -> None:
        """See `feed_kernel.Source`."""
        if self._what == "bare" and self._view is not None:
            self._update(encode(number))
        super().put(number)

    def beside(self, do: str) -> None:
        """Publish the other topics of the robot, once ("once") or from now on ("go")."""
        if self._what not in ONE_TOPIC:
            self._robot.beside(do)

    def rate(self) -> float:
        """Return the messages per second of the robot without its scans."""
        return self._robot.rate()

    def _hand(self, scan: Scan) -> None:
        self._update(np.asarray(scan.ranges, np.float32))
