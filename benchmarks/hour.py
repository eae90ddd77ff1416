"""An hour of a robot at 40 Hz. A user freezes, steps and zooms, and the page is hidden for a sixth of the time."""

from __future__ import annotations

import statistics
import time
from dataclasses import dataclass

import numpy as np

from tests.browser.page_memory import PageMemory

from .stage import Stage

WARM_UP = 90.0
"""Seconds until histories are full and all objects that are made once exist."""

STEPS = 20
SEEN_FOR_MS = 1500
"""The time to watch the page after it is visible again."""

# A hidden page gets messages but no animation frames. Headless Chromium cannot hide a page.
HIDE = """() => {
    const [frame, cancel] = [window.requestAnimationFrame, window.cancelAnimationFrame];
    const held = new Map();
    let last = 1e9;
    window.requestAnimationFrame = (call) => (held.set(++last, call), last);
    window.cancelAnimationFrame = (id) => held.delete(id) || cancel(id);
    window.seeAgain = () => {
        [window.requestAnimationFrame, window.cancelAnimationFrame] = [frame, cancel];
        for (const call of held.values()) frame(call);
    };
}"""
# The time when the page is visible, and after each later frame the time and the number on show.
SEE = """(ms) => new Promise((done) => {
    const from = Date.now();
    const value = document.querySelector(".rw-speed [data-axis='0'] .rw-value");
    const rows = [];
    const look = () => {
        rows.push([Date.now(), parseFloat(value.textContent.replaceAll(/[^0-9.]/g, ""))]);
        if (Date.now() - from < ms) requestAnimationFrame(look);
        else done([from, rows]);
    };
    seeAgain();
    requestAnimationFrame(look);
})"""


@dataclass(frozen=True)
class Minute:
    """The memory of page and kernel at some time."""

    seconds: float
    nodes: int
    listeners: int
    page: int
    """Bytes of the page's heap."""
    kernel: int
    """Bytes of the kernel's process."""


@dataclass(frozen=True)
class Hour:
    """The results of a run."""

    minutes: list[Minute]
    hidden: float
    """Seconds for which the page was hidden."""
    late: float
    """Milliseconds from when the page became visible to the first frame with a sample of that time or later."""
    age: float
    """Milliseconds by which the sample in that frame is older than the frame."""
    usual_age: float
    """The same for the frames of the next second, for comparison."""

    @property
    def ends(self) -> tuple[Minute, Minute]:
        """The medians of the first third and of the last third."""
        third = max(1, len(self.minutes) // 3)
        return _middle(self.minutes[:third]), _middle(self.minutes[-third:])


def run(stage: Stage, minutes: float) -> Hour:
    """Watch a robot for some minutes, and the memory of page and kernel."""
    with stage.show("robot", module="hour_kernel") as shown:
        notebook = shown.notebook
        page, memory = notebook.page, PageMemory(notebook.page)
        notebook.run(notebook.append("source.show()"))
        page.locator(".rw-freeze").first.wait_for()
        page.wait_for_timeout(1000 * min(WARM_UP, 30 * minutes))
        found: list[Minute] = []
        began = time.monotonic()
        hides_at, hidden = 20 * minutes, 10 * minutes
        late = age = usual_age = float("nan")
        seen: tuple[float, list[list[float]]] | None = None
        while (passed := time.monotonic() - began) < 60 * minutes:
            if seen is None and passed >= hides_at:
                page.evaluate(HIDE)
                page.wait_for_timeout(1000 * hidden)
                seen = page.evaluate(SEE, SEEN_FOR_MS)
            _use(page)
            kept = memory.kept()
            kernel = int(notebook.python("print(source.resident())"))
            found.append(Minute(passed, kept.nodes, kept.listeners, kept.heap, kernel))
            page.evaluate("bench.take()")
            page.wait_for_timeout(max(0.0, 1000 * min(60.0, 6 * minutes) - 5000))
        notebook.python("source.stop()")
        stamps = np.load(notebook.lab.files / "stamps.npy")
    if seen:
        at, rows = seen
        due = int(np.searchsorted(stamps[1:], at))  # the number of the last sample at that time
        shown_at, number = next(((when, int(number)) for when, number in rows if number >= due), (float("inf"), 0))
        late, age = shown_at - at, shown_at - float(stamps[number])
        ages = [when - float(stamps[int(number)]) for when, number in rows if when > shown_at]
        usual_age = statistics.median(ages) if ages else float("nan")
    return Hour(found, hidden, late, age, usual_age)


def _use(page: object) -> None:
    """Freeze all widgets, step back and forward, zoom out and in, and release."""
    laser = page.locator(".rw-laser")  # type: ignore[attr-defined]
    laser.locator(".rw-freeze").click()
    for key in [","] * STEPS + ["."] * (STEPS // 2):
        laser.locator(".rw-picture").press(key)
    for name in ("Zoom in (+)", "Zoom out (\u2212)"):
        laser.get_by_role("button", name=name).click()
    laser.locator(".rw-freeze").click()


def _middle(minutes: list[Minute]) -> Minute:
    return Minute(*(statistics.median(getattr(minute, name) for minute in minutes) for name in vars(minutes[0])))
