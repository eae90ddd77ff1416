"""The system's Chromium, headless."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from playwright.sync_api import Browser, Locator, Playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
SHELL = "chromium-headless-shell"
"""Chromium without windows: pages are the same, but no process draws the bars of a window for each of them."""
FLAGS = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
)
SCREENSHOTS = Path(__file__).resolve().parents[1] / "screenshots"
PICTURES = "PICTURES" in os.environ
"""True to take pictures that only people look at: there are hundreds, and each takes time."""

LOOKS = [("light", 1), ("dark", 2)] if PICTURES else [("dark", 2)]
"""Theme and scale, for tests that hold in any theme. People look at their pictures in both."""


def launch(playwright: Playwright, *, is_shell_enough: bool = False) -> Browser:
    """Start the system's Chromium, which `make test-browser` installs; without it, the tests fail."""
    names = (SHELL, *NAMES) if is_shell_enough else NAMES
    found = [path for name in names if (path := shutil.which(name))]
    if not found:
        raise RuntimeError(f"no Chromium on PATH (looked for {', '.join(NAMES)}): run scripts/chromium.sh")
    return playwright.chromium.launch(executable_path=found[0], args=FLAGS)


def photograph(shown: Locator, name: str) -> Path:
    """Save the picture of an element in tests/screenshots, at the scale of its page: NAME@1x.png or NAME@2x.png."""
    scale = shown.page.evaluate("() => window.devicePixelRatio")
    file = SCREENSHOTS / f"{name}@{scale}x.png"
    shown.screenshot(path=file, animations="disabled")
    return file


def shoot(shown: Locator, name: str) -> None:
    """Photograph an element for the people who judge pictures, if pictures are asked for."""
    if PICTURES:
        photograph(shown, name)
