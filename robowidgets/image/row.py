"""The row of pictures."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..kinds import OnDemandWidget
from ..messages.image import IMAGE_TYPES
from .packing import NO_PICTURE

if TYPE_CHECKING:
    from ..image_widget import ImageWidget
    from .frames import ImageFrames
    from .rerun_log import ImageLog


def _widget() -> type[ImageWidget]:
    from ..image_widget import ImageWidget

    return ImageWidget


def _frames() -> type[ImageFrames]:
    from .frames import ImageFrames

    return ImageFrames


def _rerun() -> type[ImageLog]:
    from .rerun_log import ImageLog

    return ImageLog


IMAGE = OnDemandWidget(
    name="image", types=IMAGE_TYPES, widget=_widget, nothing=NO_PICTURE, frames=_frames, rerun=_rerun
)
"""On demand, because all cameras of a robot together would overload a network."""
