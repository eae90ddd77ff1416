"""The row of messages of any type."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..kinds import OnDemandWidget

if TYPE_CHECKING:
    from ..message_widget import MessageWidget
    from .frames import TreeFrames


def _widget() -> type[MessageWidget]:
    from ..message_widget import MessageWidget

    return MessageWidget


def _frames() -> type[TreeFrames]:
    from .frames import TreeFrames

    return TreeFrames


MESSAGE = OnDemandWidget(name="message", widget=_widget, frames=_frames)
"""For messages of any type, if no other row names it."""
