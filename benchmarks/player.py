"""A recording in the player: the time from a click to the picture, and the frame rate while it plays."""

from __future__ import annotations

import json
import random
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from statistics import median
from typing import Any, NamedTuple

import numpy as np

from .player_kernel import HZ
from .recordings import write
from .scan import BITS
from .stage import Stage

POINTED = "click on the slider, to what the page did not have until the pointer rested there for 100 ms"
AWAY = "click on either, to what the page does not have, as soon as the pointer is there"


class Target(NamedTuple):
    """The target of clicks: an element, the event that counts, and pixels before and after its time axis.

    If a resting pointer already shows its moment, a click has nothing new to show.
    """

    name: str
    selector: str
    event: str
    before: float
    after: float
    shows_pointed: bool


TARGETS = (
    Target("click on the scanogram", ".rw-scanogram .rw-picture", "pointerup", 64, 16, True),
    Target("click on the slider", ".rw-player .rw-slider", "input", 6, 6, False),
)

REST_MS = 100
SCRIPT = Path(__file__).with_name("player.js")
LASER = ".rw-laser"
ROUND_TRIP = "a bare round trip of a widget's message"
FRAMED = "the same, to the end of the next frame"
BUSY = "import time\nend = time.time() + {seconds}\nwhile time.time() < end:\n    pass"
SETTLED = """
import time
while True:
    there = len(source.player._prefetcher._sent)
    time.sleep(1.0)
    if len(source.player._prefetcher._sent) == there:
        break
"""


@dataclass
class Waiting:
    """The median and the 95th percentile in milliseconds."""

    middle: float
    late: float

    @classmethod
    def of(cls, times: list[float]) -> Waiting:
        return cls(median(times), float(np.percentile(times, 95)))


@dataclass
class Playing:
    """The figures of playing at 10 times speed, per second."""

    frames: float
    painted: float
    passed: float
    """Seconds of the recording."""


@dataclass
class Player:
    """The measurements of one recording."""

    waits: dict[str, Waiting]
    plays: dict[str, Playing]


def compare(stage: Stage, scans: int, repeats: int, clicks: int, seconds: float) -> Player:
    """Measure all figures of a written recording, each repeat in a fresh notebook."""
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
    """A player in a fresh notebook. The page reads back the numbers of its laser."""

    def __init__(self, notebook: Any, scans: int) -> None:
        self._notebook = notebook
        self._seconds = int(scans / HZ)
        self._page = notebook.page

    @classmethod
    @contextmanager
    def open(cls, stage: Stage, name: str, scans: int) -> Iterator[Shown]:
        """Display the player, and learn the picture of its numbers."""
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
        """Run code in the kernel, and return its prints."""
        return str(self._notebook.python(code))

    def count(self, seconds: float) -> Playing:
        """Return the paints of the page in some seconds."""
        found = self._page.evaluate("(seconds) => playing.count(seconds)", seconds)
        return Playing(found["frames"], found["painted"], found["passed"] / HZ)

    def play(self, seconds: float, *, busy: bool = False) -> Playing:
        """Play some seconds that the page does not have yet; with ``busy``, while the kernel runs a busy loop."""
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
        """Return milliseconds from clicks to their pictures, and of bare round trips, in turn."""
        chance = random.Random(seed)
        self.python(SETTLED)
        times: dict[str, list[float]] = {}
        for _ in range(clicks):
            for target in TARGETS:
                for what in (target.name, AWAY) if target.shows_pointed else (target.name, POINTED, AWAY):
                    for trip, took in zip((ROUND_TRIP, FRAMED), self._page.evaluate("roundTrip()"), strict=True):
                        times.setdefault(trip, []).append(took)
                    # The page has all or nothing of the clicked second and of the next pixel.
                    lacking = self._lacking()
                    there = [second for second in range(self._seconds) if second not in lacking]
                    second = self._far(chance, there if what == target.name else lacking)
                    took = self._click(target, second, rests=what == POINTED)
                    times.setdefault(what, []).append(took)
        return times

    def _lacking(self) -> list[int]:
        """Return the seconds that the page does not have."""
        found: list[int] = json.loads(self.python("print(source.lacking())"))
        return found

    def _far(self, chance: random.Random, seconds: list[int]) -> int:
        """Return one of these seconds far from the time on show, because it is sent late, with missing neighbours."""
        now = self._now()
        alike = [second for second in seconds if {second - 1, second + 1} <= set(seconds)]
        alike.sort(key=lambda second: abs(second - now))
        return chance.choice(alike[len(alike) // 2 :])

    def _click(self, target: Target, second: int, *, rests: bool) -> float:
        """Click on a second, with or without a rest of the pointer before. Return milliseconds from the event to the
        paint."""
        element = self._page.locator(target.selector)
        element.scroll_into_view_if_needed()
        box = element.bounding_box()
        width = box["width"] - target.before - target.after
        x = box["x"] + target.before + width * (second + 0.5) / self._seconds
        y = box["y"] + box["height"] / 2
        if rests:
            self._page.mouse.move(x, y)
            self._page.wait_for_timeout(REST_MS)
        self._page.evaluate("(kind) => playing.watch(kind)", target.event)
        self._page.mouse.click(x, y)
        took, number = self._page.evaluate("playing.seen()")
        now = self._now()
        if abs(number - HZ * now) > 2 or abs(now - second - 0.5) > 1.5:
            raise RuntimeError(f"at {now} s scan {number} was painted, expected {HZ * now:.0f} at about {second} s")
        return float(took)

    def _now(self) -> float:
        """Return the time on show in seconds."""
        return float(self._page.locator(".rw-play-now").text_content())

    def _button(self, title: str) -> None:
        self._page.get_by_title(title).click()
