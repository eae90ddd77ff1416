"""Speeds as columns."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...kinds import Kind
from ...messages.channel import Channel
from ...samples import AXES, Speed
from ._decoders import SpeedDecoder
from .series import Series


class Speeds(Series[Speed]):
    """The speeds of a topic as columns; see `Series` for the ways to select from them.

    Examples:
        >>> speeds = recording.speeds("/odom")  # doctest: +SKIP
        >>> speeds.linear[:, 0].max()  # doctest: +SKIP
    """

    @staticmethod
    def decoder(channel: Channel, _kind: Kind) -> SpeedDecoder:
        """See `Series`."""
        return SpeedDecoder(channel)

    @property
    def values(self) -> NDArray[np.float64]:
        """All six numbers, shape (N, 6), in the order of `AXES`; NaN for missing values.

        Raises:
            RecordingError: the array would be larger than `Recording.memory`.
        """
        return self._array("speeds", len(AXES), np.float64, lambda chunk: chunk.values)

    @property
    def linear(self) -> NDArray[np.float64]:
        """X forward, y left, z up, in m/s, shape (N, 3)."""
        return self.values[:, :3]

    @property
    def angular(self) -> NDArray[np.float64]:
        """About x, y and z (yaw, counter-clockwise), in rad/s, shape (N, 3)."""
        return self.values[:, 3:]

    @property
    def poses(self) -> NDArray[np.float64]:
        """X and y in metres and yaw in radians from odometry, shape (N, 3); NaN for speeds without a pose."""
        return self._array("poses", 3, np.float64, lambda chunk: chunk.poses if chunk.poses.size else np.nan)

    @property
    def steering(self) -> NDArray[np.float64]:
        """Steering angles of car commands in radians, left positive, shape (N,); NaN for speeds without one."""
        column = self._array("steering", 1, np.float64, lambda chunk: chunk.steering if chunk.steering.size else np.nan)
        return column[:, 0]

    def to_numpy(self) -> dict[str, NDArray[Any]]:
        """Return the times, and the six numbers by the names in `AXES`; for cars also ``steering``."""
        steering = self.steering
        more = {} if np.isnan(steering).all() else {"steering": steering}
        return {**super().to_numpy(), **dict(zip(AXES, self.values.T, strict=True)), **more}
