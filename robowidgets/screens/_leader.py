"""The player that another one follows to the same places."""

from __future__ import annotations

from math import isnan, nan
from typing import Any

import numpy as np

from ..poses.places import to_place
from ..poses.recent import FARTHEST
from ..samples.checks import not_negative
from ._parts import LeadingPlayer


class Leader:
    """A player that another one follows, and the times at which the follower's robot was nearest to its places."""

    def __init__(self, follower: LeadingPlayer, player: LeadingPlayer, origin: Any, within: float) -> None:
        one: LeadingPlayer | None = player
        while one:
            if one is follower:
                raise ValueError("follow: expected another player, which does not follow this one; got " + repr(player))
            one = one.followed
        within, origin = not_negative("within", within, "metres"), to_place("origin", origin)
        own, theirs = follower.places(), player.places()
        seconds, apart = own.seen_from(origin).nearest(theirs)
        name = player.recording.path.name
        if not np.isfinite(apart).any():
            raise ValueError(
                f"follow: in {follower.recording.path.name} or in {name}, no scan was made within {FARTHEST:g} s of a "
                "pose of odometry, so the place of the robot is unknown"
            )
        if not (apart <= within).any():
            raise ValueError(
                f"follow: {follower.recording.path.name} never comes within {within:g} m of a place of {name}, only "
                f"within {np.nanmin(apart):.2f} m. Odometry starts at the place where a robot is switched on: give "
                "origin=(x, y, yaw), the start of this odometry in the other's"
            )
        self.player, self._follower = player, follower
        self._times, self._seconds = theirs.seconds, np.where(apart <= within, seconds, nan)
        self.state = {
            "model": player.bar.model_id,
            "times": self._times.tobytes(),
            "seconds": self._seconds.tobytes(),
            "lost": f"no place within {within:g} m of {name}",
        }
        """The state for the page, which moves the follower without the kernel."""
        player.observe(self._on_time, "time")
        self._on_time()

    def leave(self) -> None:
        """Stop following."""
        self.player.unobserve(self._on_time, "time")

    def _on_time(self, _change: Any = None) -> None:
        # If the user moves the leader on the page, the page moves the follower itself.
        if "time" in self.player.bar._property_lock:
            return
        row = int(np.searchsorted(self._times, self.player.time, "right")) - 1
        if row >= 0 and not isnan(self._seconds[row]):
            self._follower.time = float(self._seconds[row])
