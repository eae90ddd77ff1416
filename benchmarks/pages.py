"""A recording as a page in a file: the time from opening it to its pictures, and the frame rate while it plays."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import robowidgets

from .player import SCRIPT, Playing
from .player_kernel import HZ
from .recordings import write
from .scan import BITS
from .stage import Stage

SECONDS = 60
LASER = ".rw-laser"
# The times of the pictures, in milliseconds from opening the page.
FIRST = """
window.first = {};
const seen = {
  laser: () => document.querySelector(".rw-laser .rw-nearest")?.textContent,
  scanogram: () => document.querySelector(".rw-scanogram .rw-empty")?.hidden,
};
const look = () => {
  for (const [name, there] of Object.entries(seen)) if (there()) first[name] ??= performance.now();
  if (Object.keys(first).length < 2) requestAnimationFrame(look);
};
look();
"""
SEEK = """(time) => {
  const slider = document.querySelector(".rw-slider");
  slider.value = time;
  slider.dispatchEvent(new Event("input"));
}"""


@dataclass
class Opened:
    """A page: megabytes, and milliseconds from opening it to the laser and to the scanogram."""

    size: float
    laser: float
    scanogram: float


def compare(stage: Stage, repeats: int, seconds: float) -> tuple[Opened, Playing]:
    """Measure the page of a minute of 1040 rays at 40 Hz, opened again each time."""
    scans = int(SECONDS * HZ)
    drive, page = stage.lab.files / "minute.mcap", stage.lab.files / "minute.html"
    write(drive, [*range(scans - BITS), *(1 << bit for bit in range(BITS))])
    with robowidgets.open(drive) as recording:
        recording.to_html(page)
    shown = [_open(stage, page, scans, seconds) for _ in range(repeats)]
    opened, played = zip(*shown, strict=True)
    size = page.stat().st_size / 1e6
    drive.unlink()
    page.unlink()
    return (
        Opened(size, *(median(getattr(one, name) for one in opened) for name in ("laser", "scanogram"))),
        Playing(*(median(getattr(one, name) for one in played) for name in ("frames", "painted", "passed"))),
    )


def _open(stage: Stage, file: Path, scans: int, seconds: float) -> tuple[Opened, Playing]:
    with stage.open_file(file, FIRST) as page:
        page.wait_for_function("() => Object.keys(first).length === 2")
        first = page.evaluate("first")
        page.evaluate("(laser) => bench.firstPaint(() => {}, laser, null)", LASER)
        _seek(page, 0)
        page.evaluate("bench.learn(null)")
        for bit in range(BITS):
            _seek(page, scans - BITS + bit)
            page.evaluate("(bit) => bench.learn(bit)", bit)
        page.evaluate(SCRIPT.read_text(encoding="utf-8"))
        _seek(page, 0)
        page.locator(".rw-play-speed").select_option("10")
        page.get_by_title("Play (space)").click()
        counted = page.evaluate("(seconds) => playing.count(seconds)", min(seconds, SECONDS / 10 - 1))
    played = Playing(counted["frames"], counted["painted"], counted["passed"] / HZ)
    return Opened(0, first["laser"], first["scanogram"]), played


def _seek(page: Any, scan: int) -> None:
    """Show a scan."""
    page.evaluate(SEEK, (scan + 0.2) / HZ)
