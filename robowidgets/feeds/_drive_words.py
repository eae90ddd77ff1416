"""What keeps a robot from moving as it is told, in words."""

from __future__ import annotations

import logging
from collections.abc import Sequence

from ..kinds import SPEED, is_command
from .middleware import Advert

log = logging.getLogger("robowidgets")


class DriveWords:
    """What is said against driving, for whoever asks, and once in the log: speeds may come at any rate.

    Attributes:
        cut: how the last speed was cut; empty when it was not.
        unheard: by topic, why a subscriber does not receive speeds, as the middleware says.
    """

    def __init__(self) -> None:
        self.cut = ""
        self.unheard: dict[str, str] = {}
        self._logged: set[str] = set()

    def of(self, topic: str, adverts: Sequence[Advert]) -> str:
        """What is known against driving by a topic, of those there are; empty when it is nothing."""
        words = (_unheard(topic, adverts), self.unheard.get(topic), _contested(topic, adverts), self.cut)
        return "; ".join(filter(None, words))

    def log(self, where: str, topic: str, adverts: Sequence[Advert]) -> None:
        """Log it: each topic that nobody hears once, and that speeds are cut once, whatever the numbers."""
        unheard, contested = _unheard(topic, adverts), _contested(topic, adverts)
        for kind, words in ((unheard, unheard), (contested, contested), ("cut", self.cut)):
            if words and kind not in self._logged:
                self._logged.add(kind)
                log.warning("%s: %s", where, words)


def _unheard(name: str, adverts: Sequence[Advert]) -> str:
    """Words for a topic to which nobody listens, with those to which speeds go; empty where somebody may."""
    here = [advert.wanted for advert in adverts if advert.name == name]
    # A middleware that tells of no listener at all may not be able to.
    tells = not adverts or any(advert.wanted is not None for advert in adverts)
    if any(wanted is not False for wanted in here) if here else not tells:
        return ""
    heard = dict.fromkeys(a.name for a in adverts if a.wanted and is_command(a.name) and a.type in SPEED.types)
    return f"nobody listens to {name}" + (f"; speeds go to {', '.join(heard)}" if heard else "")


def _contested(name: str, adverts: Sequence[Advert]) -> str:
    """Words for a topic on which somebody else publishes speeds; empty where nobody does."""
    others = [advert for advert in adverts if advert.name == name and advert.offered]
    names = dict.fromkeys(publisher for advert in others for publisher in advert.publishers)
    return f"{', '.join(names) or 'somebody else'} publishes {name}, too" if others else ""
