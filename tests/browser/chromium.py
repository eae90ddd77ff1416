"""The system's Chromium, headless."""

from __future__ import annotations

import shutil
from pathlib import Path

from playwright.sync_api import Browser, Locator, Playwright

NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
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


def launch(playwright: Playwright) -> Browser:
    """Start the system's Chromium, which `make test-browser` sees to; a machine without one fails the tests."""
    found = [path for name in NAMES if (path := shutil.which(name))]
    if not found:
        raise RuntimeError(f"no Chromium on PATH (looked for {', '.join(NAMES)}): run scripts/chromium.sh")
    return playwright.chromium.launch(executable_path=found[0], args=FLAGS)


def shoot(shown: Locator, name: str) -> Path:
    """Photograph an element into tests/screenshots, at the scale of its page: NAME@1x.png or NAME@2x.png."""
    scale = shown.page.evaluate("() => window.devicePixelRatio")
    file = SCREENSHOTS / f"{name}@{scale}x.png"
    shown.screenshot(path=file, animations="disabled")
    return file
