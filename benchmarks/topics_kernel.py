"""What runs in the notebook's kernel to measure the laser beside thirty topics: `feed.show` of a robot of such."""

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
"""What is asked for beside the laser and the speed: a plot and a message at 1 kHz, a plot, events, a map, a sonar."""
SHOWN: dict[str, tuple[str, ...]] = {
    "alone": ("/scan",),
    "beside": ("/scan",),
    "cards": ("/scan", "/odom", *CARDS),
    "listed": (),
}
"""What is on show; none: what `feed.show()` shows."""
ONE_TOPIC = ("bare", "alone")
"""Of a robot that has the laser alone."""


class Source(feed_kernel.Source):
    """The view of a feed, or a bare canvas in its place.

    Args:
        name: the middleware and what is on show: ``dds-cards``.
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
        """Have the robot publish what it has beside its scans: "once", or from now on ("go")."""
        if self._what not in ONE_TOPIC:
            self._robot.beside(do)

    def rate(self) -> float:
        """How many messages per second the robot sends beside its scans."""
        return self._robot.rate()

    def _hand(self, scan: Scan) -> None:
        self._update(np.asarray(scan.ranges, np.float32))
