"""The states of a speed widget whose looks are kept."""

from __future__ import annotations

from robowidgets import Speed, SpeedWidget

from ...looks import Look


def _measured(**options: object) -> SpeedWidget:
    speed = SpeedWidget(title="/odom", **options)
    speed.update(Speed((0.3, 0, 0), (0, 0, -0.5), stamp_ns=7))
    return speed


def _commanded() -> SpeedWidget:
    speed = _measured(linear_limits=0.5, planar=True)
    speed.command_title = "/cmd_vel"
    speed.command(Speed((0.4, 0, 0), (0, 0, 0.2)))
    return speed


def _past_the_limit() -> SpeedWidget:
    return _measured(linear_limits=0.2)


LOOKS = {
    "speed/empty": Look(make=lambda: SpeedWidget(title="/odom")),
    "speed/commanded": Look(make=_commanded),
    "speed/past_the_limit": Look(make=_past_the_limit),
    "speed/stale": Look(make=_measured, traits={"_silence": 6.0}),
}
