"""A way to end a subscription of rclpy while another thread spins its node. Imports rclpy."""

from __future__ import annotations

import threading
from typing import Any

from rclpy.callback_groups import CallbackGroup


class Gate(CallbackGroup):  # type: ignore[misc]
    """The callback group of one subscription: one callback at a time, and none any more once it is shut.

    An executor asks its group before it takes a message. Up to Iron, one that takes a message of a subscription that
    was destroyed meanwhile raises InvalidHandle, which would end the program's own `rclpy.spin`.
    """

    def __init__(self) -> None:
        super().__init__()
        self._moved = threading.Condition()
        self._inside = self._shut = False

    def can_execute(self, _entity: Any) -> bool:
        """Whether a callback may begin."""
        with self._moved:
            return not (self._inside or self._shut)

    def beginning_execution(self, _entity: Any) -> bool:
        """Begin a callback, if it may."""
        with self._moved:
            if self._inside or self._shut:
                return False
            self._inside = True
            return True

    def ending_execution(self, _entity: Any) -> None:
        """A callback has ended."""
        with self._moved:
            self._inside = False
            self._moved.notify_all()

    @property
    def is_inside(self) -> bool:
        """Whether a callback has begun and not ended; for ever, if its message could not be taken."""
        return self._inside

    def shut(self, patience: float) -> None:
        """Let no callback begin, and wait up to so many seconds for one that has."""
        with self._moved:
            self._shut = True
            self._moved.wait_for(lambda: not self._inside, patience)
