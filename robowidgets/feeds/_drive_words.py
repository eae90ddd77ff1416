"""What keeps a robot from moving as it is told, in words."""

from __future__ import annotations

import logging
from collections.abc import Mapping

from ._topics import Topic

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

    def of(self, topic: str, there: Mapping[str, Topic] | None) -> str:
        """What is known against driving by a topic, of those there are; empty when it is nothing."""
        return "; ".join(filter(None, (_unheard(topic, there), self.unheard.get(topic), self.cut)))

    def log(self, where: str, topic: str, there: Mapping[str, Topic] | None) -> None:
        """Log it: each topic that nobody hears once, and that speeds are cut once, whatever the numbers."""
        unheard = _unheard(topic, there)
        for kind, words in ((unheard, unheard), ("cut", self.cut)):
            if words and kind not in self._logged:
                self._logged.add(kind)
                log.warning("%s: %s", where, words)


def _unheard(name: str, there: Mapping[str, Topic] | None) -> str:
    """Words for a topic to which nobody listens, with those to which speeds go; empty where somebody may."""
    if there is None:
        return ""
    topic = there.get(name)
    # A middleware that tells of no listener at all may not be able to.
    tells = any(known.wanted is not None for known in there.values())
    if topic.wanted is not False if topic else there and not tells:
        return ""
    heard = [t.name for t in there.values() if t.widget == "speed" and t.commanded and t.wanted]
    return f"nobody listens to {name}" + (f"; speeds go to {', '.join(heard)}" if heard else "")
