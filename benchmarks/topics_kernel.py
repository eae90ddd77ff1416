"""What runs in the notebook's kernel to measure the laser beside thirty topics: `feed.show` of a robot of such."""

from __future__ import annotations

import time
from typing import Any

from IPython.display import display

from . import feed_kernel
from .topics_robot import TOPICS

CARDS = ("/imu.angular_velocity.z", "/joint_states as message", "/rosout as events", "/pose")
"""What is asked for beside the laser and the speed: a plot and a message at 1 kHz, events, a map."""
SHOWN: dict[str, tuple[str, ...]] = {
    "alone": ("/scan",),
    "beside": ("/scan",),
    "listed": (),
    "cards": ("/scan", "/odom", *CARDS),
}
"""What is on show; none: what `feed.show()` shows."""


class Source(feed_kernel.Source):
    """The view of a feed.

    Args:
        name: the middleware and what is on show: ``dds-cards``.
    """

    _robot: feed_kernel.Outside

    def __init__(self, name: str, _count: int) -> None:
        middleware, _, what = name.partition("-")
        super().__init__(middleware, 0)
        if what != "alone":
            self._robot.publish_beside()
        feed = self._robot.feed
        wanted = {"/scan"} if what == "alone" else {"/scan", *TOPICS}
        while not wanted <= {topic.name for topic in feed.topics}:
            time.sleep(0.05)
        self._view: Any = feed.show(*SHOWN[what])
        self._view.topic_list.folded = False

    def show(self) -> None:
        """Display the view."""
        while "/scan" not in self._view.widgets:
            time.sleep(0.05)
        self._lasers = [self._view.widgets["/scan"]]
        self.put(0)
        display(self._view)  # type: ignore[no-untyped-call]

    def rate(self) -> float:
        """How many messages per second the robot sends beside its scans."""
        return self._robot.rate()
