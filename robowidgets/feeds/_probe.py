"""Which widget shows a message whose type nobody knows by name."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..kinds import Widget, is_command, is_standard
from ..messages import to_scan, to_speed, to_touch
from ..samples import Touch
from ._topics import RANGE, Topic


def is_open(topic: Topic) -> bool:
    """Whether only a message can tell the widget of a topic."""
    if topic.widget or not topic.offered or not topic.type:
        return False
    return topic.type == RANGE or not is_standard(topic.type)


def decided(topic: Topic, message: Any) -> Topic:
    """The topic with the widget that shows its messages, if one does.

    A Range is shown that says if something is there; those that measure a distance are not.
    """
    kind: Widget | None = None
    if topic.type == RANGE or isinstance(getattr(message, "sample", message), Touch):
        kind = "touch" if _reads(to_touch, message, badly=False) else None
    elif _reads(to_scan, message):
        kind = "laser"
    elif _reads(to_speed, message):
        kind = "speed"
    return topic._replace(widget=kind, commanded=kind == "speed" and is_command(topic.name))


def _reads(read: Callable[[Any], Any], message: Any, *, badly: bool = True) -> bool:
    """Whether it is such a message; ``badly`` also one whose numbers cannot be shown."""
    try:
        read(message)
    except TypeError:
        return False
    except ValueError:
        return badly
    return True
