"""Animated pictures of a user's actions in a page. They draw the pointer, which screenshots lack."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from pathlib import Path

from PIL import Image
from playwright.sync_api import FloatRect, Page

from .chromium import SCREENSHOTS

_POINTER = """() => {
    const pointer = document.createElement("div");
    pointer.style.cssText = "position:fixed;z-index:9999;left:0;top:0;width:22px;height:22px;pointer-events:none;"
        + "background:#1b1f24;clip-path:path('M2 1 L2 17 L6.5 13 L9.5 19.5 L12.5 18 L9.5 12 L15.5 12 Z');"
        + "filter:drop-shadow(0 0 1px white)";
    document.body.append(pointer);
    addEventListener("pointermove", ({ clientX, clientY }) => {
        pointer.style.transform = `translate(${clientX}px, ${clientY}px)`;
    }, true);
}"""
STEPS = 5
"""Frames for a way of the pointer."""
MOVE_MS = 80
LIVE_MS = 120
"""The shortest time from frame to frame of a page that goes on by itself, in milliseconds."""


class MovingPicture:
    """Frames of a part of a page.

    Args:
        page: where the person acts.
        clip: the part, in CSS pixels of the window.
    """

    def __init__(self, page: Page, clip: FloatRect) -> None:
        self._page = page
        self._clip = clip
        self._frames: list[Image.Image] = []
        self._durations: list[int] = []
        self._at = (clip["x"] + clip["width"] * 0.8, clip["y"] + clip["height"] * 0.8)
        page.evaluate(_POINTER)
        page.mouse.move(*self._at)

    def take(self, ms: int) -> None:
        """Add the picture of this moment, shown for some milliseconds."""
        shot = self._page.screenshot(clip=self._clip)
        self._frames.append(Image.open(io.BytesIO(shot)).convert("RGB"))
        self._durations.append(ms)

    def move(self, x: float, y: float) -> None:
        """Move the pointer to a place of the window, slower at both ends."""
        from_x, from_y = self._at
        for i in range(1, STEPS + 1):
            part = i / STEPS
            part = part * part * (3 - 2 * part)
            self.jump(from_x + part * (x - from_x), from_y + part * (y - from_y))

    def jump(self, x: float, y: float) -> None:
        """Move the pointer at once, for one frame."""
        self._at = (x, y)
        self._page.mouse.move(x, y)
        self.take(MOVE_MS)

    def run(self, seconds: float, until: Callable[[], bool] = lambda: False) -> None:
        """Show the page as it goes on by itself, as fast as it moves: for some seconds, or until a condition holds."""
        end = time.monotonic() + seconds
        while time.monotonic() < end and not until():
            self.take_live()

    def take_live(self) -> None:
        """Add the picture of this moment, shown for the time that this call takes."""
        start = time.monotonic()
        self.take(0)
        time.sleep(max(0.0, start + LIVE_MS / 1000 - time.monotonic()))
        self._durations[-1] = round(1000 * (time.monotonic() - start))

    def save(self, name: str) -> Path:
        """Write tests/screenshots/NAME.webp, which plays for ever."""
        file = SCREENSHOTS / f"{name}.webp"
        first, *rest = self._frames
        first.save(file, save_all=True, append_images=rest, duration=self._durations, loop=0, quality=82, method=4)
        return file
