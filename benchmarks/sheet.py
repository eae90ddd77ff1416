"""A contact sheet of 5,000 moments: the time to the picture, and the cost of scrolling through all of it."""

from __future__ import annotations

from dataclasses import dataclass
from statistics import median
from typing import Any

from .stage import Stage

COUNT = 5000
SCREEN = 21
"""The number of pictures on the first screen, at the width of the page."""

SEEN = """([path, cell, count]) => new Promise((done) => {
    const from = performance.now();
    driver.start(path, cell);
    let first = 0;
    const look = () => {
        if (!first && document.querySelector(".rw-sheet-item")) first = performance.now() - from;
        if (document.querySelectorAll("[data-painted]").length >= count) done([first, performance.now() - from]);
        else if (performance.now() - from > 60000) done([first, Infinity]);
        else requestAnimationFrame(look);
    };
    look();
})"""
"""Milliseconds from the start of the cell to the moments, and to the pictures of the first screen."""

SCROLL = """async ([steps, jumps]) => {
    const tasks = [];
    const observer = new PerformanceObserver((list) => tasks.push(...list.getEntries().map((one) => one.duration)));
    observer.observe({ type: "longtask" });
    const scroll = document.querySelector(".rw-sheet-scroll");
    const frame = () => new Promise((next) => requestAnimationFrame(() => setTimeout(next)));
    const height = scroll.scrollHeight - scroll.clientHeight;
    for (let i = 0; i <= steps; i++) {
        scroll.scrollTop = (height * i) / steps;
        await frame();
    }
    for (let i = 0; i < jumps; i++) {
        scroll.scrollTop = (height * ((i * 7) % jumps)) / jumps;
        for (let wait = 0; wait < 5; wait++) await frame();
    }
    await new Promise((next) => setTimeout(next, 200));
    observer.disconnect();
    return [tasks, document.querySelectorAll(".rw-sheet-item").length];
}"""
STEPS, JUMPS = 300, 20


@dataclass(frozen=True)
class Sheet:
    """Milliseconds, and the number and the longest of the long tasks (above 50 ms), or 0 without any."""

    there: float
    seen: float
    cpu: float
    """The time of the page's main thread for one step of scrolling."""
    long_tasks: float
    longest: float
    items: float
    """The number of moments on the page at the end."""


def measured(stage: Stage, repeats: int) -> Sheet:
    """Return the medians of some fresh notebooks."""
    found = [_once(stage) for _ in range(repeats)]
    return Sheet(*(median(values) for values in zip(*(vars(one).values() for one in found), strict=True)))


def _once(stage: Stage) -> Sheet:
    with stage.show("sheet", count=COUNT, module="sheet_kernel") as show:
        page: Any = show.notebook.page
        cell = show.notebook.append("source.show()")
        there, seen = page.evaluate(SEEN, [show.notebook.path, cell, SCREEN])
        before = show.page_cpu()
        tasks, items = page.evaluate(SCROLL, [STEPS, JUMPS])
        cpu = (show.page_cpu() - before) / (STEPS + JUMPS)
        one = Sheet(there, seen, cpu, len(tasks), max(tasks, default=0.0), items)
        print(f"sheet: {one}", flush=True)
        return one
