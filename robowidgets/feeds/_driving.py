"""The settings for driving the robot of a feed, and the reasons why it may not move as commanded."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

from ..driving.command_watchdog import HOLD, MAX_ANGULAR, MAX_LINEAR, Velocity
from ..kinds import is_command
from ..messages.twist import TWIST, TWIST_STAMPED
from ..runtime.log_once import LogOnce
from ..samples.checks import OF_DEGREES, finite, is_angle
from ..widget.limit_traits import is_past
from .middleware import Advert, FeedError

log = logging.getLogger("robowidgets")

LONG_HOLD = 60.0
"""Seconds. A longer hold is logged, because it may have been meant in milliseconds."""

USUAL = "/cmd_vel"
"""The topic on which speeds are published, unless another topic is set or is the only one with a subscriber."""


@dataclass(frozen=True)
class Driving:
    """The settings for driving the robot of a feed.

    Args:
        topic: the topic on which speeds are published. None means /cmd_vel, or if that has no subscriber, the only
            velocity topic that has one.
        max_linear: limit in m/s, forward and backward; greater speeds are cut.
        max_angular: limit in rad/s, both ways; greater speeds are cut.
        hold: seconds for which a speed is valid, at most half a second for a pad. Zero follows if it is not renewed.
        needs_page: True to refuse speeds while no page shows the feed or one of its pads, so that a robot stops when
            the browser is closed. A page that is busy or hidden for minutes counts as closed; so does a page whose
            messages a busy kernel does not receive.
        max_lateral: limit in m/s of a base that moves sideways, both ways; greater speeds are cut. 0 means that it does
            not move sideways, and a speed with a sideways part is refused.

    Raises:
        TypeError: a limit is not a number, the topic is not text, or needs_page is neither True nor False.
        ValueError: a limit is not finite and above 0 (`max_lateral` may be 0), or the topic is empty.
    """

    topic: str | None = None
    max_linear: float = MAX_LINEAR
    max_angular: float = MAX_ANGULAR
    hold: float = HOLD
    needs_page: bool = False
    max_lateral: float = 0.0

    def __post_init__(self) -> None:
        if not isinstance(self.topic, str | None):
            raise TypeError(f"topic: expected the name of a topic as text, or None, got {self.topic!r}")
        if self.topic is not None and not self.topic.strip():
            raise ValueError(f"topic: expected the name of a topic, such as /cmd_vel, got {self.topic!r}")
        if not isinstance(self.needs_page, bool):
            raise TypeError(f"needs_page: expected True or False, got {self.needs_page!r}")
        for name in ("max_linear", "max_angular", "hold", "max_lateral"):
            value = finite(name, getattr(self, name), "SI units")
            least = "of 0 or more" if name == "max_lateral" else "above 0"
            if value < 0 or (value == 0 and least == "above 0"):
                raise ValueError(f"{name}: expected a limit {least}, got {value!r}")
        if self.hold > LONG_HOLD:
            log.warning(
                "hold: each speed is valid for %g s, so a robot drives on for %g s after the program that sent it; "
                "it is in seconds: 0.5 is half a second",
                self.hold,
                self.hold,
            )

    def within(self, wanted: Velocity) -> Velocity:
        """Return a speed, cut to the limits.

        Raises:
            TypeError, ValueError: a part of it is not a finite number.
            FeedError: it leads sideways, and the robot cannot move sideways.
        """
        linear, angular, lateral = wanted
        cut = Velocity(
            _cut(finite("linear", linear, "m/s"), self.max_linear),
            _cut(finite("angular", angular, "rad/s"), self.max_angular),
            _cut(finite("lateral", lateral, "m/s"), self.max_lateral),
        )
        if lateral and not self.max_lateral:
            raise FeedError(
                f"cannot drive: lateral is {lateral:g} m/s, but this robot is not known to move sideways; "
                "if it does, set its limit: feed.driving = feeds.Driving(max_lateral=0.3)"
            )
        return cut

    def cut(self, wanted: Velocity) -> str:
        """Return a text for the part of a speed that `within` cuts, or empty if it cuts nothing."""
        linear, angular, lateral = wanted
        given = (
            (linear, self.max_linear, "m/s"),
            (angular, self.max_angular, "rad/s"),
            (lateral, self.max_lateral, "m/s sideways"),
        )
        cuts = [
            f"{value:g} {unit} is cut to {_cut(value, limit):g}"
            for value, limit, unit in given
            if is_past(value, (-limit, limit))
        ]
        if cuts and abs(angular) > self.max_angular and not is_angle(angular):
            cuts.append(f"in degrees? {OF_DEGREES}")
        return "; ".join(cuts)


def _cut(value: float, limit: float) -> float:
    return max(-limit, min(limit, value))


class DriveStatus:
    """The reasons why the robot may not move as commanded.

    Attributes:
        cut: text for the cut of the last speed, or empty if it was not cut.
        unheard: by topic, the reason why a subscriber does not receive speeds, as the middleware reports it.
        refused: the reason why the last speed was not published to some subscribers, or empty if it was to all.
        taken: text for the topic that was chosen instead of the usual one, or empty.
        stalled: text for the standstill after which the robot was stopped, or empty after a `stop`.
    """

    def __init__(self) -> None:
        self.cut = self.refused = self.taken = self.stalled = ""
        self.unheard: dict[str, str] = {}
        self._log = LogOnce(log.warning)

    def reasons(self, topic: str, adverts: Sequence[Advert] | None) -> list[str]:
        """Return all reasons for a command topic. ``adverts`` are all topics, or None if they are not known yet."""
        reasons = (
            "" if adverts is None else unheard(topic, adverts),
            self.unheard.get(topic),
            self.refused,
            _contested(topic, adverts or ()),
            self.cut,
            self.stalled,
        )
        return list(filter(None, reasons))

    def log(self, where: str, topic: str, adverts: Sequence[Advert] | None) -> None:
        """Log each reason once. A cut is logged once regardless of its numbers, because speeds may come at any rate.

        A standstill is logged when it is detected.
        """
        reasons = (reason for reason in self.reasons(topic, adverts) if reason != self.stalled)
        for reason in filter(None, (self.taken, *reasons)):
            self._log(f"{where}: {reason}", "cut" if reason == self.cut else reason)


def unheard(name: str, adverts: Sequence[Advert]) -> str:
    """Return a text for a topic without a subscriber, with the velocity topics that have one; else empty."""
    here = [advert.wanted for advert in adverts if advert.name == name]
    # If a middleware reports no subscriber on any topic, it may be unable to.
    tells = not adverts or any(advert.wanted is not None for advert in adverts)
    if any(wanted is not False for wanted in here) if here else not tells:
        return ""
    heard = heard_speeds(adverts)
    return f"{name} has no subscriber" + (f", unlike {' and '.join(heard)}" if heard else "")


def heard_speeds(adverts: Sequence[Advert]) -> list[str]:
    """Return the velocity topics that have a subscriber. Some bridges do not report their types."""
    return list(
        dict.fromkeys(
            advert.name
            for advert in adverts
            if advert.wanted
            and is_command(advert.name)
            and (advert.type in (TWIST, TWIST_STAMPED) if advert.type else advert.name.endswith(USUAL))
        )
    )


def _contested(name: str, adverts: Sequence[Advert]) -> str:
    """Return a text for a topic on which another node publishes speeds, too; or empty."""
    others = [a.publishers for a in adverts if a.name == name and a.offered and a.publishers is not None]
    names = dict.fromkeys(publisher for publishers in others for publisher in publishers)
    return f"{', '.join(names) or 'another node'} publishes {name}, too" if others else ""
