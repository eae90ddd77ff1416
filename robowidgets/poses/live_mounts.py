"""The mounts of the scanners of a running robot: set by hand, or else by tf."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from typing import Any

from ..messages.fields import unwrap
from ..samples import Mount, Scan
from ..samples.age import arrival_of
from .live_frames import LiveFrames
from .mounts import robot_frame, scanner_mount
from .transforms import transforms_in


class LiveMounts:
    """The mounts of scanners by frame. All methods are thread-safe."""

    def __init__(self) -> None:
        self._lock = threading.RLock()
        self._frames = LiveFrames()
        self._by_hand: dict[str, Mount] = {}
        self._fixed: dict[str, Mount] = {}
        """Mounts of scanners that only static transforms join to the robot."""

    def take(self, message: Any, *, static: bool) -> None:
        """Take a message of tf; invalid transforms are ignored."""
        inner, now_ns = unwrap(message), round(time.monotonic() * 1e9)
        with self._lock:
            edition = self._frames.edition
            with suppress(ValueError):  # raised after the valid transforms
                for one in transforms_in(inner, static, now_ns):
                    self._frames.add(one)
            if static or edition != self._frames.edition:
                self._fixed = {}

    def put(self, frame_id: str, mount: Mount | None) -> None:
        """Set a mount by hand, or None to use tf again."""
        with self._lock:
            self._by_hand.pop(frame_id.lstrip("/"), None)
            if mount is not None:
                self._by_hand[frame_id.lstrip("/")] = mount

    def of(self, frame_id: str, time_ns: int | None = None, stamp_ns: int | None = None) -> Mount | None:
        """Return the mount of a scanner, or None if it is unknown.

        Args:
            frame_id: the coordinate frame of its scans.
            time_ns: the time of arrival of a scan by the monotonic clock, for a scanner that moves on its robot, or
                None for now.
            stamp_ns: the stamp of the scan.
        """
        frame = frame_id.lstrip("/")
        with self._lock:
            known = self._by_hand.get(frame) or self._fixed.get(frame)
            if known is not None:
                return known
            at = round(time.monotonic() * 1e9) if time_ns is None else time_ns
            found = scanner_mount(self._frames, frame, at, stamp_ns)
            if found is not None and self.is_fixed(frame):
                self._fixed[frame] = found
            return found

    def is_fixed(self, frame_id: str) -> bool:
        """Return True if the mount is set by hand, or known only by static transforms."""
        frame = frame_id.lstrip("/")
        with self._lock:
            if frame in self._by_hand or frame in self._fixed:
                return True
            base = robot_frame(self._frames, frame)
            return bool(base) and self._frames.is_static(frame, base)

    def mounted(self, sample: Any) -> Any:
        """Return a scan with the robot's angles if its mount is known, or another sample as it is."""
        if not isinstance(sample, Scan):
            return sample
        if sample.mount is not None and sample.frame_id.lstrip("/") not in self._by_hand:
            return sample
        mount = self.of(sample.frame_id, round(arrival_of(sample) * 1e9), sample.stamp_ns)
        return sample if mount is None else sample.mounted(mount)
