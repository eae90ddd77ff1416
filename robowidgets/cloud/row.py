"""The row of clouds."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ..kinds import OnDemandWidget
from ..messages.cloud import CLOUD_TYPES
from ..samples import Cloud

if TYPE_CHECKING:
    from ..cloud_widget import CloudWidget
    from .frames import CloudFrames
    from .rerun_log import CloudLog


def _widget() -> type[CloudWidget]:
    from ..cloud_widget import CloudWidget

    return CloudWidget


def _frames() -> type[CloudFrames]:
    from .frames import CloudFrames

    return CloudFrames


def _rerun() -> type[CloudLog]:
    from .rerun_log import CloudLog

    return CloudLog


CLOUD = OnDemandWidget(
    name="cloud",
    types=CLOUD_TYPES,
    widget=_widget,
    nothing=Cloud(np.empty(0, [(axis, np.float32) for axis in "xyz"])),
    frames=_frames,
    rerun=_rerun,
)
