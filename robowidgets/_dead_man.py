"""Handing speeds on, and a zero when nobody renews them."""

from __future__ import annotations

import atexit
import logging
import os
import threading
import time
from collections.abc import Callable

log = logging.getLogger("robowidgets")

Speed2 = tuple[float, float]
"""Linear in m/s and angular in rad/s."""

HOLD = 0.5
"""Seconds that a speed holds unless it is renewed."""

PATIENCE = 1.0
"""Seconds that an end waits for a sink that hangs."""

ZERO = (0.0, 0.0)


class DeadMan:
    """Calls a sink with speeds, and with zero once a speed was not renewed for half a second.

    The sink is called by one thread of its own, which lives from the first speed to the zero after the last: a sink
    that takes long delays nobody, misses speeds that were replaced meanwhile, and gets zero when it comes back late.
    Whatever is raised in it, be it a SystemExit, ends nothing but the press.

    Args:
        drive: the sink, of linear m/s and angular rad/s.
        halt: asks the robot to stop.
        told: called with every speed that was handed on.
        failed: called with what the sink raised, and at which speed. The robot is asked to stop after that.
    """

    def __init__(
        self,
        drive: Callable[[float, float], object],
        halt: Callable[[], object],
        told: Callable[[Speed2], None],
        failed: Callable[[BaseException, Speed2], None],
    ) -> None:
        self._drive, self._halt, self._told, self._failed = drive, halt, told, failed
        self._changed = threading.Condition()
        self._wanted: Speed2 | None = None
        self._until = 0.0
        self._entered: float | None = None
        self._thread: threading.Thread | None = None

    @property
    def hangs_for(self) -> float:
        """Seconds that the sink has not come back; 0 while that is no longer than a speed holds."""
        entered = self._entered
        passed = time.monotonic() - entered if entered is not None else 0.0
        return passed if passed > HOLD else 0.0

    def drive(self, speed: Speed2) -> None:
        """Hand a speed on, or renew it."""
        self._want(speed, time.monotonic() + HOLD)

    def stop(self) -> None:
        """Hand zero on, now."""
        self._want(None, 0.0)

    def close(self) -> None:
        """Hand zero on if a speed still holds, and wait a moment until it was."""
        thread = self._thread
        if thread is None:
            return
        self.stop()
        if thread is not threading.current_thread():
            thread.join(PATIENCE)

    def _want(self, speed: Speed2 | None, until: float) -> None:
        with self._changed:
            self._wanted, self._until = speed, until
            self._changed.notify()
            if self._thread is None:
                thread = threading.Thread(target=self._run, name="robowidgets-drive", daemon=True)
                thread.start()
                self._thread = thread
                _moving.add(self)

    def _run(self) -> None:
        while True:
            with self._changed:
                while self._wanted is None and (left := self._until - time.monotonic()) > 0:
                    self._changed.wait(left)
                # What waited for a slow sink may have lapsed by now.
                speed = self._wanted if time.monotonic() < self._until else None
                self._wanted = None
            if speed is not None:
                if self._call(speed):
                    continue
                with self._changed:
                    self._wanted, self._until = None, 0.0
            self._call(ZERO)
            with self._changed:
                if self._until <= time.monotonic():
                    self._thread = None
                    _moving.discard(self)
                    return

    def _call(self, speed: Speed2) -> bool:
        self._entered = time.monotonic()
        try:
            if speed == ZERO:
                self._halt()
            else:
                self._drive(*speed)
        except BaseException as error:
            self._entered = None
            _say(self._failed, error, speed)
            return False
        self._entered = None
        _say(self._told, speed)
        return True


def _say(tell: Callable[..., None], *what: object) -> None:
    """Tell something; whoever cannot be told must not keep zero from being handed on."""
    try:
        tell(*what)
    except BaseException:
        log.exception("what was handed on could not be told")


_moving: set[DeadMan] = set()
"""Those that must hand zero on before the process ends."""


def _stop_all() -> None:
    for dead_man in list(_moving):
        dead_man.close()


atexit.register(_stop_all)
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_moving.clear)
