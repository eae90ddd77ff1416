"""The settings for driving the robot of a feed, and the reasons why it may not move as commanded."""

from __future__ import annotations

import logging
from collections.abc import Sequence
from dataclasses import dataclass

from .._core.limit_traits import is_past
from .._core.log_once import LogOnce
from ..driving.command_watchdog import HOLD, MAX_ANGULAR, MAX_LINEAR, Velocity
from ..kinds import is_command
from ..messages.twist import TWIST, TWIST_STAMPED
from ..samples.checks import OF_DEGREES, finite, is_angle
from .middleware import Advert, FeedError

log = logging.getLogger("robowidgets")

USUAL = "/cmd_vel"
"""The topic on which speeds are published where no other one is set, nor alone has somebody who listens."""


@dataclass(frozen=True)
class Driving:
    """The settings for driving the robot of a feed.

    Args:
        topic: the topic on which speeds are published. None: /cmd_vel, or where nobody listens to that, the only topic
            of speeds to which somebody does.
        max_linear: limit in m/s, forward and backward; greater speeds are cut.
        max_angular: limit in rad/s, both ways; greater speeds are cut.
        hold: seconds for which a speed is valid, one of a pad for half a second at most; zero follows if it is not
            renewed.
        needs_page: whether speeds are refused while no page shows the feed or a pad of it, so that a robot stops when
            the browser is closed. A page that is busy or hidden for minutes counts as closed; so does a page whose
            messages a busy kernel does not receive.
        max_lateral: limit in m/s of a base that moves sideways, both ways; greater speeds are cut. 0: it does not, and
            a speed with a sideways part is refused.

    Raises:
        TypeError: something is not a number, the topic no text, or needs_page neither True nor False.
        ValueError: a limit that is not finite and above 0 (`max_lateral` may be 0), or an empty topic.
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

    def within(self, wanted: Velocity) -> Velocity:
        """A speed, cut to the limits.

        Raises:
            TypeError, ValueError: a part of it is no finite number.
            FeedError: it leads sideways, and the robot does not.
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
        """A text for the part of a speed that `within` cuts; empty if it cuts nothing."""
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
        cut: a text for the cut of the last speed; empty if it was not cut.
        unheard: for each topic, the reason why a subscriber does not receive speeds, as the middleware reports it.
        refused: the reason why the last speed was not published for some of the subscribers; empty if it was for all.
        taken: a text for the topic that was taken in place of the usual one; empty if none was.
        stalled: text for the standstill after which the robot was stopped; empty if there was none since the last
            `stop`.
    """

    def __init__(self) -> None:
        self.cut = self.refused = self.taken = self.stalled = ""
        self.unheard: dict[str, str] = {}
        self._log = LogOnce(log.warning)

    def reasons(self, topic: str, adverts: Sequence[Advert] | None) -> list[str]:
        """All reasons for a command topic, with all topics; None: these are not known yet."""
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
        """Log each reason once, a cut only once whatever its numbers: speeds may come at any rate.

        A standstill is logged when it is found.
        """
        reasons = (reason for reason in self.reasons(topic, adverts) if reason != self.stalled)
        for reason in filter(None, (self.taken, *reasons)):
            self._log(f"{where}: {reason}", "cut" if reason == self.cut else reason)


def unheard(name: str, adverts: Sequence[Advert]) -> str:
    """Text for a topic without a subscriber, naming the topics of speeds that have one; empty when one may exist."""
    here = [advert.wanted for advert in adverts if advert.name == name]
    # If a middleware reports no subscriber on any topic, it may be unable to.
    tells = not adverts or any(advert.wanted is not None for advert in adverts)
    if any(wanted is not False for wanted in here) if here else not tells:
        return ""
    heard = heard_speeds(adverts)
    return f"nobody listens to {name}" + (f", but to {' and '.join(heard)}" if heard else "")


def heard_speeds(adverts: Sequence[Advert]) -> list[str]:
    """The topics of commanded speeds that somebody subscribes to. Some bridges do not tell their types."""
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
    """Text for a topic on which another node publishes speeds, too; empty when none does."""
    others = [a.publishers for a in adverts if a.name == name and a.offered and a.publishers is not None]
    names = dict.fromkeys(publisher for publishers in others for publisher in publishers)
    return f"{', '.join(names) or 'somebody else'} publishes {name}, too" if others else ""
