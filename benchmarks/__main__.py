"""`python -m benchmarks` measures all and writes RESULTS.md; `--quick` and `--only` measure less and only print."""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

from . import columns, feeds, measure, recordings, table
from .rivals import NAMES
from .stage import Stage, open_stage, versions

RESULTS = Path(__file__).with_name("RESULTS.md")
OURS, LIMIT = "laser", "bare"

ABOUT = """# Measured

`make bench` writes this file. One run, everything on one machine: 2 cores, Chromium headless with software rendering.
Absolute figures depend on the machine and move by a third from run to run; ratios hold.

- A scan of 1040 rays carries a number in its ranges: bits of 43 rays at 3 or 5 m, each range off by up to 2 cm, as it
  is with real scanners. After every animation frame the page reads the number back from the pixels of the canvases, or,
  of libraries that draw SVG, from the places of the elements. Where a bit is drawn is learned from scans that differ in
  that bit alone. So "painted" means the same for all.
- Scans are handed over by a running cell. Latency is from the call of `update` in the kernel to the end of the frame
  that shows the scan, by the machine's one clock, over the scans that were painted.
- Bytes are those of all websocket messages that reach the page, per scan, at 10 Hz. CPU is that of the kernel's whole
  process, per `update`, at 40 Hz.
- Flooded: as many updates as the library takes, three times. Its newest scan counts as never shown after
  {patience:.0f} s.
- Imports are timed in fresh processes that have loaded ipykernel, ipywidgets and NumPy.
- A recording is opened and its topics are listed; then it is opened and every sample is made that a widget can show
  (of the topics that both know), where rosbags makes its messages. In one process, in turn.
- All scans of a topic are decoded into one array, where rosbags deserialises the same messages, and mcap-ros2-support
  the first 500 of them (MCAP files only): each on a file that is open already, in one process, in turn. Of short
  recordings most of the time goes into the code that rosbags makes for a type of messages, for either.
- Of a feed: a robot in a process of its own publishes scans at 40 Hz. When they come is noted by a bare subscriber's
  callback in another process, by a function that is connected to the feed, and by the page that has painted them. The
  widget alone is handed scans by a cell. CPU is that of the kernel's whole process, with four widgets on the feed.
- Every library starts in a fresh kernel and page, {repeats} times, in turn. Figures are medians of these.

{versions}
"""


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one short repeat, to see that all works; writes nothing")
    parser.add_argument("--feeds", action="store_true", help="feeds only; writes nothing")
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, help="libraries; writes nothing")
    options = parser.parse_args()
    repeats, seconds, long = (1, 1.0, 6.0) if options.quick else (3, 3.0, 60.0)
    if options.feeds:
        with open_stage() as stage:
            print("\n".join(feed_parts(stage, 2 * seconds, repeats, long)))
        return
    names = {name: measure.facts(name)["NAME"] for name in options.only}

    imports = {name: measure.import_time(name, repeats + 2) for name in names}
    collected: dict[str, list[measure.Figures]] = {name: [] for name in names}
    with open_stage() as stage:
        for repeat in range(repeats):
            for name in names:
                collected[name].append(measure.compare(stage, name, seconds))
                said = ", ".join(f"{column} {value:.2f}" for column, value in vars(collected[name][-1]).items())
                print(f"{names[name]}, {repeat + 1} of {repeats}: {said}", flush=True)
        rows = {
            names[name]: {**vars(measure.middle(figures)), "imports": imports[name]}
            for name, figures in collected.items()
        }
        parts = [ABOUT, "## Beside other libraries\n", table.figures(rows)]
        if OURS in names:
            parts += ["", table.ratios(rows, names[OURS])]
            print("four widgets, and a long flood", flush=True)
            paced, flooded = measure.four(stage, 2 * seconds)
            first, last, late = measure.flood_long(stage, long, long / 6)
            parts += ["\n## Four widgets at once\n", table.fours({"at 40 Hz": paced, "flooded": flooded})]
            parts += [f"\n## Flooded for {long:.0f} s\n", table.endurance({"first sixth": first, "last sixth": last})]
            parts += [f"\nIts newest scan was shown late by {late:.0f} ms."]
            parts += feed_parts(stage, 2 * seconds, repeats, long)
        about = {"Chromium": stage.chromium, "Python": platform.python_version(), **versions()}
    if OURS in names:
        print("recordings", flush=True)
        read = recordings.compare(1000 if options.quick else 10_000, repeats + 2)
        parts += ["\n## Recordings, beside rosbags alone\n", table.readings(read)]
        decoded, peaks = columns.compare(2000 if options.quick else 20_000, repeats)
        parts += ["\n## All scans as one array\n", table.decodings(decoded)]
        parts += [
            f"\nA walk through the written file takes {peaks[0]:.0f} MB, through ten times as much {peaks[1]:.0f} MB."
        ]
    text = "\n".join(parts).format(
        patience=measure.PATIENCE,
        repeats=repeats,
        versions=", ".join(f"{name} {version}" for name, version in about.items()) + ".",
    )
    print(text)
    if OURS in names:
        for line in table.misses(rows, names[OURS], measure.facts(LIMIT)["NAME"]):
            print("missed:", line)
    if not options.quick and tuple(options.only) == NAMES:
        RESULTS.write_text(text + "\n", encoding="utf-8")


def feed_parts(stage: Stage, seconds: float, repeats: int, long: float) -> list[str]:
    """What is said of feeds."""
    print("feeds", flush=True)
    figures = {name: feeds.compare(stage, name, seconds, repeats) for name in feeds.available()}
    first, last = feeds.endure(stage, "dds", long, long / 6)
    return [
        "\n## Feeds, from another process to paint\n",
        table.feeds(figures),
        f"\n## A feed at 1000 Hz for {long:.0f} s\n",
        table.feed_endurance({"first sixth": first, "last sixth": last}),
    ]


if __name__ == "__main__":
    main()
