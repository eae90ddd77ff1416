"""`python -m benchmarks` measures all and writes RESULTS.md; `--quick` and `--only` measure less and only print."""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

from . import (
    columns,
    drives,
    feeds,
    hour,
    large,
    layers,
    leaks,
    measure,
    memory,
    pages,
    player,
    plots,
    programs,
    recordings,
    sheet,
    simulator,
    stopping,
    table,
    topics,
)
from .rivals import NAMES
from .stage import Stage, open_stage, versions

RESULTS = Path(__file__).with_name("RESULTS.md")
OURS, LIMIT = "laser", "bare"
HOUR = "\n## An hour"
"""Begins the section that comes from a run of its own, and is kept."""
PLOTS = "\n## A plot of an hour at 1 kHz\n"

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
  process, and of the page's main thread, per `update`, at 40 Hz; that of the page until the first paint begins with the
  cell. What reads the picture back is part of it, and the same for all.
- Flooded: as many updates as the library takes, three times. Its newest scan counts as never shown after
  {patience:.0f} s.
- Imports are timed in fresh processes that have loaded ipykernel, ipywidgets and NumPy.
- Everything on: four sectors, two conditions, of which one is lit, a ghost, the index view, and twenty shapes that are
  drawn anew with each scan. A drag is pointer moves in each animation frame, at most the display's.
- A plot has 3.6 million values of one line, of which one stands out. It counts from the start of its cell until the
  canvas has ink (of WebGL: until it is there). A step of the wheel, and of the pointer, counts to the end of the frame
  after it, the longest beside the median. Then values come at 1 kHz: the CPU is that of the kernel's process, and of
  the page's main thread. uPlot gets every value, as the page of ours never does.
- A recording is opened and its topics are listed; then it is opened and every sample is made that a widget can show
  (of the topics that both know), where rosbags makes its messages. In one process, in turn.
- A recording of 25,000 scans of 1040 rays is opened, and all its scans are made one array; it is opened, and its
  scanogram is made with all its levels of detail; and its bytes are read into Python: in one process, in turn, the file
  in the system's cache. The first round does not count.
- All scans of a topic are made one array, from `open` on, where rosbags opens the file and deserialises the same
  messages; rounds as above. In "changing" scan_time and time_increment are others in each scan.
- Memory is the most that a process takes above what it takes with the file open, `memory` at 64 MB.
- A program drives at 30 Hz in a real kernel, beside a connected function that never comes back, and a robot in another
  process that has no watchdog of its own logs each command with its time. Zero counts from its cause: the last speed
  (`hold`, half a second), `feed.stop()`, the release of a pad, `feed.close()`, the kernel's interrupt, its end,
  SIGTERM, SIGHUP, the death of its server, for which it looks once a second; and with a `@feed.program`, a step that
  raises, the begin of one that loops for ever, Stop, the interrupt between cells. A zero after which something moves
  again does not count. ros2 is a stand-in that waits and wakes as rclpy does, and logs what leaves its process.
- The cell of a program that steps 20 times a second runs again and again in a real kernel, and counts from the request
  until the first step of the new version. What a step costs is the CPU of the program's thread from step to step, at
  200 Hz on the simulator, for a function that asks for scan and variables, and for a machine of three levels that
  judges two events, one of which asks for a distance, whose own cost is beside it; without a `MachineWidget` and with.
- The kernel keeps a widget until it is closed. A closed one leaves as much as the canvas, whose model the page keeps,
  too. `show` closes what its cell showed before; the nodes that it leaves are those of ipywidgets' boxes, which their
  models keep. Listeners of widgets that the kernel keeps go when these are closed: one for each that shows samples.
- A page in a file, of a minute of such a recording, is opened from disk; it counts from there to the first frame with
  the numbers of the laser, and with the scanogram, which the page makes of all scans.
- A player shows a recording whose scans carry their numbers, and its page reads them back. A click on scanogram or
  slider counts from its event to the end of the frame that shows the new moment; a bare round trip is one message of a
  widget that only answers, from page to kernel and back, in the same page, in turn with the clicks; to the end of the
  next frame, it is the least in which anything from the kernel can be seen. Before each click the kernel is asked what
  the page has. It has the second that is clicked on; or it has not, and the pointer rests there for 100 ms before (of
  the slider alone: the scanogram shows what is pointed at without a click); or it has not, and the pointer comes,
  presses and lets go at once, quicker than a hand: that must wait for an answer and for the frame that shows it. It
  plays at 10 times speed from where the page has nothing yet, the kernel idle, and in a
  busy loop that began before. What the page paints at most is counted while nothing plays: its animation frames, with
  the same reading back.
- Of a feed: a robot in a process of its own publishes scans at 40 Hz. When they come is noted by a bare subscriber's
  callback in another process, by a function that is connected to the feed, and by the page that has painted them. The
  widget alone is handed scans by a cell, in turn with the feed. The steps from scan to scan vary by a tenth, so that
  all phases of the display are met. What the feed adds is the mean time from the bare subscriber's callback to paint,
  less the mean time from `update` to paint of the widget alone, with the interval that holds it with 95 % (bootstrap of
  blocks of 20 scans). A recording and the simulator have no other process: their scans are published when they are due.
  CPU is that of the kernel's whole process, with four widgets on the feed.
- A robot of 30 topics says some 2,500 messages per second beside its scans at 40 Hz, an Imu and a JointState at 1 kHz
  among them. Its laser is shown by `feed.show`, alone and beside others, each in fresh notebooks, in turn, and counts
  from publishing to the end of the frame that shows the scan. CPU is that of the kernel's process, and of the page's
  main thread, the same reading back in all.
- A picture or a cloud is updated by a thread beside a laser at 40 Hz, both in view, and the next one goes when the page
  has drawn the last one, of the bare canvas too. Its latency is from `update` until the kernel has heard that it is
  drawn, with the way back; "newer by then" is how many came meanwhile, in the middle and at most. CPU is that of the
  kernel's process, and of the page's main thread.
- A cell that makes a widget and shows it runs again and again, and the kernel keeps every widget. Nodes, listeners and
  heap are those of the page after garbage collection, less those before, per run: JupyterLab's own are among them.
- The simulated robot wanders for 20 s of its time with a scanner of 1040 rays at 40 Hz, each scan made, against the CPU
  time of the process; the map is 30 m by 30 m with single occupied cells of 0.1 m. The median of {repeats}.
- Every library starts in a fresh kernel and page, {repeats} times, in turn. Figures are medians of these.

{versions}
"""


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one short repeat, to see that all works; writes nothing")
    parser.add_argument("--feeds", action="store_true", help="feeds only; writes nothing")
    parser.add_argument("--stopping", action="store_true", help="how soon a robot stops only; writes nothing")
    parser.add_argument("--programs", action="store_true", help="programs only; writes nothing")
    parser.add_argument("--recordings", action="store_true", help="recordings only; writes nothing")
    parser.add_argument("--simulator", action="store_true", help="the simulated robot only; writes nothing")
    parser.add_argument("--player", action="store_true", help="the player only; writes nothing")
    parser.add_argument("--plots", action="store_true", help="plots of an hour only; writes nothing")
    parser.add_argument("--topics", action="store_true", help="a robot of thirty topics only; writes nothing")
    parser.add_argument("--large", action="store_true", help="pictures and clouds beside a laser only; writes nothing")
    parser.add_argument("--sheet", action="store_true", help="a contact sheet of 5,000 moments only; writes nothing")
    parser.add_argument("--layers", action="store_true", help="the layers of the laser only; writes nothing")
    parser.add_argument("--leaks", action="store_true", help="what views leave in the page only; writes nothing")
    parser.add_argument(
        "--hour", nargs="?", type=float, const=60.0, metavar="MINUTES", help="a robot for an hour only; writes nothing"
    )
    parser.add_argument(
        "--drives", nargs="?", type=int, const=drives.COUNT, metavar="COUNT", help="many recordings; writes nothing"
    )
    parser.add_argument("--only", nargs="+", choices=NAMES, default=NAMES, help="libraries; writes nothing")
    options = parser.parse_args()
    repeats, seconds, long = (1, 1.0, 6.0) if options.quick else (3, 3.0, 60.0)
    if options.feeds:
        with open_stage() as stage:
            print("\n".join(feed_parts(stage, 2 * seconds, repeats, long)))
        return
    if options.stopping:
        print("\n".join(stopping_parts(2 if options.quick else stopping.TIMES)))
        return
    if options.programs:
        print("\n".join(program_parts(quick=options.quick)))
        return
    if options.recordings:
        print("\n".join(recording_parts(repeats, quick=options.quick)))
        return
    if options.simulator:
        print("\n".join(simulator_parts(repeats)))
        return
    if options.player:
        with open_stage() as stage:
            print("\n".join(player_parts(stage, repeats, seconds, quick=options.quick)))
        return
    if options.plots:
        with open_stage() as stage:
            print("\n".join(plot_parts(stage, repeats, seconds)))
        return
    if options.topics:
        with open_stage() as stage:
            print("\n".join(topic_parts(stage, repeats, 2 * seconds)))
        return
    if options.large:
        with open_stage() as stage:
            print("\n".join(large_parts(stage, repeats, 2 * seconds)))
        return
    if options.sheet:
        with open_stage() as stage:
            print("\n".join(sheet_parts(stage, repeats)))
        return
    if options.layers:
        with open_stage() as stage:
            print("\n".join(layer_parts(stage, repeats, seconds)))
        return
    if options.leaks:
        with open_stage() as stage:
            print("\n".join(leak_parts(stage, quick=options.quick)))
        return
    if options.drives:
        drives.compare(options.drives)
        return
    if options.hour:
        with open_stage() as stage:
            print(table.hour(hour.run(stage, options.hour)))
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
            parts += layer_parts(stage, repeats, seconds)
            parts += plot_parts(stage, repeats, seconds)
            parts += feed_parts(stage, 2 * seconds, repeats, long)
            parts += topic_parts(stage, repeats, 2 * seconds)
            parts += large_parts(stage, repeats, 2 * seconds)
            parts += player_parts(stage, repeats, seconds, quick=options.quick)
            parts += sheet_parts(stage, repeats)
            parts += leak_parts(stage, quick=options.quick)
            parts += stopping_parts(2 if options.quick else stopping.TIMES)
            parts += program_parts(quick=options.quick)
        about = {"Chromium": stage.chromium, "Python": platform.python_version(), **versions()}
    if OURS in names:
        parts += recording_parts(repeats, quick=options.quick)
        parts += simulator_parts(repeats)
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
        _, *hour_part = RESULTS.read_text(encoding="utf-8").partition(HOUR)
        RESULTS.write_text(f"{text}\n{''.join(hour_part)}", encoding="utf-8")


def feed_parts(stage: Stage, seconds: float, repeats: int, long: float) -> list[str]:
    """What is said of feeds."""
    print("feeds", flush=True)
    figures = {name: feeds.compare(stage, name, seconds, repeats) for name in feeds.available()}
    first, last = feeds.endure(stage, "dds", long, long / 6)
    absent = [name for name in ("ros1", "ros2") if name not in figures]
    return [
        "\n## Feeds, from another process to paint\n",
        table.feeds(figures),
        *[f"\n{name} was not measured: its Python package is not here." for name in absent],
        f"\n## A feed at 1000 Hz for {long:.0f} s\n",
        table.feed_endurance({"first sixth": first, "last sixth": last}),
    ]


def sheet_parts(stage: Stage, repeats: int) -> list[str]:
    """What is said of a contact sheet."""
    found = sheet.measured(stage, repeats)
    return [
        f"\n## A contact sheet of {sheet.COUNT:,} moments\n",
        f"The moments stand there {found.there:.0f} ms after the start of the cell, with all pictures of the first "
        f"screen after {found.seen:.0f} ms. Scrolling to the end in {sheet.STEPS} steps, and {sheet.JUMPS} jumps, take "
        f"{found.cpu:.1f} ms of the page's main thread each, and make "
        f"{found.long_tasks:.0f} tasks above 50 ms, the longest of {found.longest:.0f} ms; {found.items:.0f} moments "
        "are on the page.",
    ]


def stopping_parts(times: int) -> list[str]:
    """What is said of how soon a robot stops."""
    print("stopping", flush=True)
    found = [stopped for name in stopping.available() for stopped in stopping.measured(name, times)]
    return [
        "\n## From a cause to zero at the robot\n",
        table.stops(found),
        f"\nSeconds, of {times} tries each, of a third as many ends of a kernel.",
    ]


def program_parts(*, quick: bool) -> list[str]:
    """What is said of programs."""
    print("programs", flush=True)
    found = programs.measured(*((10, 200) if quick else (programs.VERSIONS, programs.STEPS)))
    return ["\n## Programs, in ms\n", table.programs(found)]


def recording_parts(repeats: int, *, quick: bool) -> list[str]:
    """What is said of reading recordings."""
    print("recordings", flush=True)
    read = recordings.compare(1000 if quick else 10_000, repeats + 2)
    with recordings.written(2500 if quick else 25_000) as made:
        whole = columns.whole(made["scans"], repeats + 2)
        decoded = columns.compare({name: made[name] for name in ("scans", "changing")}, repeats + 2)
        peaks = memory.compare(made["scans"], made["large"])
    return [
        "\n## Recordings, beside rosbags alone\n",
        table.readings(read),
        "\n## A recording, beside its bytes\n",
        table.whole(whole),
        "\n## All scans as one array, beside rosbags alone\n",
        table.decodings(decoded),
        "\n## Memory for a recording and for ten times as much\n",
        table.peaks(peaks),
    ]


def simulator_parts(repeats: int) -> list[str]:
    """What is said of the simulated robot."""
    print("simulator", flush=True)
    return ["\n## The simulated robot, as fast as it can\n", table.rooms(simulator.compare(repeats))]


def player_parts(stage: Stage, repeats: int, seconds: float, *, quick: bool) -> list[str]:
    """What is said of the player."""
    print("player", flush=True)
    found = player.compare(stage, 20_000, repeats, 3 if quick else 15, 2 * seconds)
    opened, played = pages.compare(stage, repeats, 2 * seconds)
    return [
        "\n## The player, from a click to the new moment\n",
        table.waits(found.waits),
        "\n## The player at 10 times speed\n",
        table.plays({**found.plays, "plays in a page in a file": played}),
        "\n## A minute of 1040 rays at 40 Hz, as a page in a file\n",
        table.opened(opened),
    ]


def layer_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """What is said of the layers of the laser."""
    print("layers", flush=True)
    costs, drags = layers.compare(stage, repeats, seconds), layers.drags(stage, seconds)
    return ["\n## The laser with everything on\n", table.layers(costs, drags)]


def plot_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """What is said of plots."""
    print("plots", flush=True)
    return [PLOTS, table.plots(plots.compare(stage, repeats, 2 * seconds))]


def topic_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """What is said of a robot of thirty topics."""
    print("topics", flush=True)
    found = {name: topics.compare(stage, name, seconds, repeats) for name in topics.MIDDLEWARES}
    return [
        part
        for name, one in found.items()
        for part in (
            f"\n## The laser of a robot of 30 topics, over {name}\n",
            table.topics(one.figures),
            f"\n{one.load:.1f} processes ran or waited for the cores meanwhile, these among them.",
        )
    ]


def large_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """What is said of pictures and clouds beside a laser."""
    print("large", flush=True)
    return ["\n## Pictures and clouds beside a laser at 40 Hz\n", table.large(large.compare(stage, seconds, repeats))]


def leak_parts(stage: Stage, *, quick: bool) -> list[str]:
    """What is said of what views leave in the page."""
    print("leaks", flush=True)
    runs = 20 if quick else 200
    return [
        f"\n## A cell that ran {runs} times, in the page\n",
        table.leaks(leaks.compare(stage, runs)),
    ]


if __name__ == "__main__":
    main()
