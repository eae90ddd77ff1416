"""A recording in the player: from a click to the picture, and how often it paints while it plays."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np

from .player_kernel import HZ
from .recordings import write
from .scan import BITS
from .stage import Stage

AWAY = "click on either, to what the page does not have"
TARGETS = (
    ("click on the scanogram", ".rw-scanogram .rw-picture", "pointerup"),
    ("click on the slider", ".rw-player .rw-slider", "input"),
)

SCRIPT = Path(__file__).with_name("player.js")
LASER = ".rw-laser"
ROUND_TRIP = "a bare round trip of a widget's message"
FRAMED = "the same, to the end of the next frame"
BUSY = "import time\nend = time.time() + {seconds}\nwhile time.time() < end:\n    pass"
SETTLED = """
import time
while True:
    there = len(source.player._sender._sent)
    time.sleep(1.0)
    if len(source.player._sender._sent) == there:
        break
"""


@dataclass
class Waiting:
    """Milliseconds: median and 95th percentile."""

    middle: float
    late: float

    @classmethod
    def of(cls, times: list[float]) -> Waiting:
        return cls(median(times), float(np.percentile(times, 95)))


@dataclass
class Playing:
    """A stretch of playing at 10 times speed, each a second."""

    frames: float
    painted: float
    passed: float
    """Seconds of the recording."""


@dataclass
class Player:
    """What was measured of one recording."""

    waits: dict[str, Waiting]
    plays: dict[str, Playing]


def compare(stage: Stage, scans: int, repeats: int, clicks: int, seconds: float) -> Player:
    """All figures of a written recording, each repeat in a fresh notebook."""
    path = stage.lab.files / "drive.mcap"
    write(path, [*range(scans - BITS), *(1 << bit for bit in range(BITS))])
    times: dict[str, list[float]] = {}
    plays: dict[str, list[Playing]] = {}
    for repeat in range(repeats):
        with Shown.open(stage, path.stem, scans) as shown:
            plays.setdefault("nothing plays", []).append(shown.count(seconds))
            plays.setdefault("plays, the kernel idle", []).append(shown.play(seconds))
            plays.setdefault("plays, the kernel in a busy loop", []).append(shown.play(seconds, busy=True))
            for name, took in shown.seek(clicks, repeat).items():
                times.setdefault(name, []).extend(took)
    path.unlink()
    return Player(
        {name: Waiting.of(took) for name, took in times.items()},
        {
            name: Playing(*(median(getattr(one, of) for one in ones) for of in ("frames", "painted", "passed")))
            for name, ones in plays.items()
        },
    )


class Shown:
    """A player in a fresh notebook, the numbers of whose laser the page reads back."""

    def __init__(self, notebook: Any, scans: int) -> None:
        self._notebook = notebook
        self._scans = scans
        self._page = notebook.page

    @classmethod
    @contextmanager
    def open(cls, stage: Stage, name: str, scans: int) -> Iterator[Shown]:
        """Display it, and learn how its numbers look."""
        with stage.show(name, count=scans, module="player_kernel") as show:
            shown = cls(show.notebook, scans)
            page = show.notebook.page
            cell = show.notebook.append("source.show()")
            page.evaluate(
                "([path, cell, laser]) => bench.firstPaint(() => driver.start(path, cell), laser, null)",
                [show.notebook.path, cell, LASER],
            )
            page.evaluate("bench.learn(null)")
            for bit in range(BITS):
                shown.python(f"source.to_scan({bit - BITS})")
                page.evaluate("(bit) => bench.learn(bit)", bit)
            page.evaluate(SCRIPT.read_text(encoding="utf-8"))
            shown.python("source.to_scan(0)")
            yield shown

    def python(self, code: str) -> str:
        """Run code in the kernel; what it prints."""
        return str(self._notebook.python(code))

    def count(self, seconds: float) -> Playing:
        """What the page paints for a while."""
        found = self._page.evaluate("(seconds) => playing.count(seconds)", seconds)
        return Playing(found["frames"], found["painted"], found["passed"] / HZ)

    def play(self, seconds: float, *, busy: bool = False) -> Playing:
        """Play for a while from where nothing was sent yet; if asked, while the kernel runs a busy loop."""
        lacking = self._lacking()
        self.python(f"source.player.time = {lacking[0] if lacking else 0}")
        if busy:
            cell = self._notebook.append(BUSY.format(seconds=seconds + 5))
            self._notebook.start(cell)
        self._button("Play (space)")
        self._page.get_by_title("Stop here (space)").wait_for()
        played = self.count(seconds)
        self._button("Stop here (space)")
        if busy:
            self._notebook.wait(cell)
        return played

    def seek(self, clicks: int, seed: int) -> dict[str, list[float]]:
        """Milliseconds from clicks to what they show, and of bare round trips, in turn."""
        chance = random.Random(seed)
        self.python(SETTLED)
        times: dict[str, list[float]] = {}

        def add(name: str, took: float) -> None:
            times.setdefault(name, []).append(took)

        for _ in range(clicks):
            for name, selector, kind in TARGETS:
                for trip, took in zip((ROUND_TRIP, FRAMED), self._page.evaluate("roundTrip()"), strict=True):
                    add(trip, took)
                lacking = self._lacking()
                # A click on the slider's knob, where it is, moves nothing.
                part = (self._now() * HZ / self._scans + chance.uniform(0.1, 0.9)) % 1.0
                took, second = self._click(selector, kind, 0.1 + 0.8 * part)
                add(AWAY if second in lacking else name, took)
        return times

    def _lacking(self) -> list[int]:
        """The seconds of which the page has nothing."""
        found: list[int] = json.loads(self.python("print(source.lacking())"))
        return found

    def _click(self, selector: str, kind: str, part: float) -> tuple[float, int]:
        """Click at a part of the width of an element; milliseconds from the event until its moment is painted, and the
        second in which that lies."""
        target = self._page.locator(selector)
        target.scroll_into_view_if_needed()
        box = target.bounding_box()
        self._page.evaluate("(kind) => playing.watch(kind)", kind)
        self._page.mouse.click(box["x"] + part * box["width"], box["y"] + box["height"] / 2)
        took, number = self._page.evaluate("playing.seen()")
        now = self._now()
        if abs(number - HZ * now) > 2:
            raise RuntimeError(f"at {now} s scan {number} was painted, expected {HZ * now:.0f}")
        return float(took), int(now)

    def _now(self) -> float:
        """The time on show, in seconds."""
        return float(self._page.locator(".rw-play-now").text_content())

    def _button(self, title: str) -> None:
        self._page.get_by_title(title).click()
