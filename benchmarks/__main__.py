"""Measure all and write RESULTS.md: `python -m benchmarks`. `--quick` and `--only` measure less, and only print."""

from __future__ import annotations

import argparse
import platform
from pathlib import Path

from . import (
    columns,
    drives,
    feeds,
    hour,
    in_parts,
    large,
    layers,
    leaks,
    measure,
    memory,
    million,
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
"""The beginning of the sections from separate runs, which are kept."""
PLOTS = "\n## A plot of an hour at 1 kHz\n"

ABOUT = """# Measured

`make bench` writes this file. One run, everything on one machine: 2 cores, Chromium headless with software rendering.
Absolute figures depend on the machine and move by a third from run to run; ratios hold.

- A scan of 1040 rays carries a number in its ranges: bits of 43 rays at 3 or 5 m, each range off by up to 2 cm, as
  with real scanners. After every animation frame the page reads the number back from the pixels of the canvases or,
  for libraries that draw SVG, from the positions of the elements. The page learns the place of each bit from scans
  that differ only in that bit, so that "painted" means the same for all libraries.
- A running cell passes on the scans. Latency is the time from the call of `update` in the kernel to the end of the
  frame that shows the scan, by the machine's clock, for the painted scans.
- Bytes count all websocket messages to the page, per scan, at 10 Hz. CPU is measured for the kernel's whole process and
  for the page's main thread, per `update`, at 40 Hz. The page's CPU until the first paint begins with the cell. It
  includes the reading back of the picture, which is the same for all.
- Flooded: as many updates as the library takes, three times. The newest scan counts as never shown after
  {patience:.0f} s.
- Imports are timed in fresh processes that have loaded ipykernel, ipywidgets and NumPy.
- Everything on: four sectors, two conditions (one of them true), a ghost, the index view, and twenty shapes that are
  drawn again with each scan. A drag is pointer moves in each animation frame, at most at the display's rate.
- A plot has 3.6 million values of one line with one outlier. The time counts from the start of its cell until the
  canvas has ink (for WebGL: until it exists). A step of the wheel or of the pointer counts to the end of the next
  frame; the median and the longest are shown. Then values come at 1 kHz, and CPU is measured for the kernel's process
  and for the page's main thread. uPlot gets every value, which our page never does.
- A recording is opened and its topics are listed. Then it is opened, and every sample that a widget can show is made
  (for topics that both know), while rosbags makes its messages. Both run in one process, in turn.
- A recording of 25,000 scans of 1040 rays is opened and all its scans are made one array; it is opened and its
  scanogram is made with all levels of detail; and its bytes are read into Python. All run in one process, in turn,
  with the file in the system's cache. The first round does not count.
- All scans of a topic are made one array, from `open` on, while rosbags opens the file and deserialises the same
  messages; rounds as above. In "changing", scan_time and time_increment differ in each scan.
- Memory is the peak of a process minus its memory with the open file, with `memory` at 64 MB.
- A program drives at 30 Hz in a real kernel, with a connected function that never returns. A robot without a
  watchdog, in another process, logs each command with its time. The time to zero counts from its cause: the last
  speed (`hold`, half a second), `feed.stop()`, the release of a pad, `feed.close()`, the kernel's interrupt, its end,
  SIGTERM, SIGHUP, the death of its server, which the kernel checks once a second. With a `@feed.program`, the causes
  are a step that raises, the begin of a step that loops forever, Stop, and the interrupt between cells. A zero
  followed by a movement does not count. ros2 is a stand-in that waits and wakes like rclpy, and logs the messages
  that leave its process.
- The cell of a program that steps 20 times a second runs again and again in a real kernel. The time counts from the
  request until the first step of the new version. The cost of a step is the CPU of the program's thread from step to
  step, at 200 Hz on the simulator: for a function that asks for scan and variables, and for a machine of three levels
  that judges two events, without and with a `MachineWidget`. The cost of an event that asks for a distance is shown
  next to it.
- The kernel keeps a widget until it is closed. A closed widget leaves as much as a canvas, because the page keeps its
  model. `show` closes the widgets that its cell showed before; the remaining nodes belong to the boxes of ipywidgets,
  which their models keep. Listeners of kept widgets disappear when these are closed: one for each widget that shows
  samples.
- A page in a file, with a minute of such a recording, is opened from disk. The time counts from there to the first
  frame with the numbers of the laser, and with the scanogram, which the page makes of all scans.
- A player shows a recording with numbers in its scans, and its page reads them back. A click on scanogram or slider
  counts from its event to the end of the frame that shows the new moment. A bare round trip is a message to a widget
  that only answers, from page to kernel and back, in the same page, in turn with the clicks. To the end of the next
  frame, it is the shortest time in which the page can show anything from the kernel. Before each click, the kernel is
  asked for the data of the page. The page has the clicked second; or it does not, and the pointer rests there for 100
  ms before the click (only for the slider, because the scanogram shows the pointed moment without a click); or it
  does not, and the pointer comes, presses and releases at once, faster than a hand, so that the click must wait for
  an answer and for the frame that shows it. The player plays at 10 times speed a part that the page does not have
  yet, with an idle kernel and with a busy loop that began before. The highest number of paints of the page is its
  animation frames while nothing plays, with the same reading back.
- For a feed, a robot in a separate process publishes scans at 40 Hz. Their arrival is recorded by the callback of a
  bare subscriber in another process, by a function connected to the feed, and by the page that has painted them. The
  widget alone gets scans from a cell, in turn with the feed. The steps from scan to scan vary by a tenth, to meet all
  phases of the display. The time added by the feed is the mean time from the bare subscriber's callback to paint,
  minus the mean time from `update` to paint of the widget alone, with its 95 % confidence interval (bootstrap of
  blocks of 20 scans). A recording and the simulator have no other process: their scans are published when they are
  due. CPU is measured for the kernel's whole process, with four widgets on the feed.
- A robot of 30 topics sends some 2,500 messages per second in addition to its scans at 40 Hz, with an Imu and a
  JointState at 1 kHz among them. `feed.show` shows its laser, alone and with others, each in fresh notebooks, in
  turn. The time counts from publishing to the end of the frame that shows the scan. CPU is measured for the kernel's
  process and for the page's main thread, with the same reading back in all cases.
- A thread updates a picture or a cloud together with a laser at 40 Hz, both in view. It sends the next one when the
  page has drawn the last one, also for the bare canvas. Latency is the time from `update` until the page has reported
  the drawing to the kernel, including the way back. "Newer by then" is the number of pictures that came in that time,
  as median and maximum. CPU is measured for the kernel's process and for the page's main thread.
- A cell that makes and shows a widget runs again and again, and the kernel keeps every widget. The table has the
  nodes, listeners and heap of the page per run, after garbage collection and minus their values before, including
  JupyterLab's share.
- The simulated robot wanders for 20 s of simulated time with a scanner of 1040 rays at 40 Hz. Each scan is made, and
  the CPU time of the process is measured. The map is 30 m by 30 m with single occupied cells of 0.1 m. The figure is
  the median of {repeats}.
- Every library starts in a fresh kernel and page, {repeats} times, in turn. The figures are medians of these runs.

{versions}
"""


def main() -> None:
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("--quick", action="store_true", help="one short repeat, as a test; writes nothing")
    parser.add_argument("--feeds", action="store_true", help="only feeds; writes nothing")
    parser.add_argument("--stopping", action="store_true", help="only the times until a robot stops; writes nothing")
    parser.add_argument("--programs", action="store_true", help="only programs; writes nothing")
    parser.add_argument("--parts", action="store_true", help="only a drive of 23 GB, read in parts; writes nothing")
    parser.add_argument("--recordings", action="store_true", help="only recordings; writes nothing")
    parser.add_argument("--simulator", action="store_true", help="only the simulated robot; writes nothing")
    parser.add_argument("--player", action="store_true", help="only the player; writes nothing")
    parser.add_argument("--plots", action="store_true", help="only plots of an hour; writes nothing")
    parser.add_argument("--topics", action="store_true", help="only a robot of thirty topics; writes nothing")
    parser.add_argument("--large", action="store_true", help="only pictures and clouds with a laser; writes nothing")
    parser.add_argument("--sheet", action="store_true", help="only a contact sheet of 5,000 moments; writes nothing")
    parser.add_argument("--layers", action="store_true", help="only the layers of the laser; writes nothing")
    parser.add_argument("--leaks", action="store_true", help="only the leaks of views in the page; writes nothing")
    parser.add_argument(
        "--hour", nargs="?", type=float, const=60.0, metavar="MINUTES", help="only a robot for an hour; writes nothing"
    )
    parser.add_argument(
        "--drives", nargs="?", type=int, const=drives.COUNT, metavar="COUNT", help="many recordings; writes nothing"
    )
    parser.add_argument(
        "--million", nargs="?", type=int, const=million.COUNT, metavar="COUNT", help="large indexes; writes nothing"
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
    if options.parts:
        in_parts.compare()
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
    if options.million:
        million.compare(options.million)
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
                line = ", ".join(f"{column} {value:.2f}" for column, value in vars(collected[name][-1]).items())
                print(f"{names[name]}, {repeat + 1} of {repeats}: {line}", flush=True)
        rows = {
            names[name]: {**vars(measure.middle(figures)), "imports": imports[name]}
            for name, figures in collected.items()
        }
        parts = [ABOUT, "## Compared with other libraries\n", table.figures(rows)]
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
    """Measure feeds, and return their section."""
    print("feeds", flush=True)
    figures = {name: feeds.compare(stage, name, seconds, repeats) for name in feeds.available()}
    first, last = feeds.endure(stage, "dds", long, long / 6)
    absent = [name for name in ("ros1", "ros2") if name not in figures]
    return [
        "\n## Feeds, from another process to paint\n",
        table.feeds(figures),
        *[f"\n{name} was not measured: its Python package is not installed." for name in absent],
        f"\n## A feed at 1000 Hz for {long:.0f} s\n",
        table.feed_endurance({"first sixth": first, "last sixth": last}),
    ]


def sheet_parts(stage: Stage, repeats: int) -> list[str]:
    """Measure a contact sheet, and return its section."""
    found = sheet.measured(stage, repeats)
    return [
        f"\n## A contact sheet of {sheet.COUNT:,} moments\n",
        f"The moments are on the page {found.there:.0f} ms after the start of the cell, with all pictures of the first "
        f"screen after {found.seen:.0f} ms. Scrolling to the end in {sheet.STEPS} steps, and {sheet.JUMPS} jumps, take "
        f"{found.cpu:.1f} ms of the page's main thread each, and make "
        f"{found.long_tasks:.0f} tasks above 50 ms, the longest of {found.longest:.0f} ms; {found.items:.0f} moments "
        "are on the page.",
    ]


def stopping_parts(times: int) -> list[str]:
    """Measure the times until a robot stops, and return their section."""
    print("stopping", flush=True)
    found = [stopped for name in stopping.available() for stopped in stopping.measured(name, times)]
    return [
        "\n## From a cause to zero at the robot\n",
        table.stops(found),
        f"\nSeconds, for {times} tries each, and a third as many for the end of a kernel.",
    ]


def program_parts(*, quick: bool) -> list[str]:
    """Measure programs, and return their section."""
    print("programs", flush=True)
    found = programs.measured(*((10, 200) if quick else (programs.VERSIONS, programs.STEPS)))
    return ["\n## Programs, in ms\n", table.programs(found)]


def recording_parts(repeats: int, *, quick: bool) -> list[str]:
    """Measure the reading of recordings, and return its sections."""
    print("recordings", flush=True)
    read = recordings.compare(1000 if quick else 10_000, repeats + 2)
    with recordings.written(2500 if quick else 25_000) as made:
        whole = columns.whole(made["scans"], repeats + 2)
        decoded = columns.compare({name: made[name] for name in ("scans", "changing")}, repeats + 2)
        peaks = memory.compare(made["scans"], made["large"])
    return [
        "\n## Recordings, compared with rosbags alone\n",
        table.readings(read),
        "\n## A recording, compared with reading its bytes\n",
        table.whole(whole),
        "\n## All scans as one array, compared with rosbags alone\n",
        table.decodings(decoded),
        "\n## Memory for a recording and for ten times as much\n",
        table.peaks(peaks),
    ]


def simulator_parts(repeats: int) -> list[str]:
    """Measure the simulated robot, and return its section."""
    print("simulator", flush=True)
    return ["\n## The simulated robot, as fast as it can\n", table.rooms(simulator.compare(repeats))]


def player_parts(stage: Stage, repeats: int, seconds: float, *, quick: bool) -> list[str]:
    """Measure the player, and return its sections."""
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
    """Measure the layers of the laser, and return their section."""
    print("layers", flush=True)
    costs, drags = layers.compare(stage, repeats, seconds), layers.drags(stage, seconds)
    return ["\n## The laser with everything on\n", table.layers(costs, drags)]


def plot_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """Measure plots, and return their section."""
    print("plots", flush=True)
    return [PLOTS, table.plots(plots.compare(stage, repeats, 2 * seconds))]


def topic_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """Measure a robot of thirty topics, and return its sections."""
    print("topics", flush=True)
    found = {name: topics.compare(stage, name, seconds, repeats) for name in topics.MIDDLEWARES}
    return [
        part
        for name, one in found.items()
        for part in (
            f"\n## The laser of a robot of 30 topics, over {name}\n",
            table.topics(one.figures),
            f"\n{one.load:.1f} processes ran or waited for the cores, including these.",
        )
    ]


def large_parts(stage: Stage, repeats: int, seconds: float) -> list[str]:
    """Measure pictures and clouds together with a laser, and return their section."""
    print("large", flush=True)
    return ["\n## Pictures and clouds with a laser at 40 Hz\n", table.large(large.compare(stage, seconds, repeats))]


def leak_parts(stage: Stage, *, quick: bool) -> list[str]:
    """Measure the leaks of views in the page, and return their section."""
    print("leaks", flush=True)
    runs = 20 if quick else 200
    return [
        f"\n## A cell that ran {runs} times, in the page\n",
        table.leaks(leaks.compare(stage, runs)),
    ]


if __name__ == "__main__":
    main()
