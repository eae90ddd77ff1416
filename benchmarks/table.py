"""The figures as Markdown."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from math import inf, isinf, isnan
from statistics import median

from . import simulator
from .columns import Decoding, Whole
from .feeds import Endurance as FeedEndurance
from .feeds import Figures as FeedFigures
from .hour import Hour
from .large import NAMES as PICTURES
from .large import Large
from .layers import Cost
from .leaks import LIMIT, NAMES, Leak
from .measure import Endurance, Four
from .pages import Opened
from .player import FRAMED, ROUND_TRIP, Playing, Waiting
from .plots import Plotted
from .programs import Found
from .recordings import Reading
from .stopping import Stopped
from .topics import NAMES as SHOWN
from .topics import Beside

COLUMNS = {
    "first_paint": "cell to first paint, ms",
    "page_first": "page CPU until then, ms",
    "latency_10hz": "latency at 10 Hz, ms",
    "latency_10hz_p95": "p95",
    "latency_40hz": "latency at 40 Hz, ms",
    "latency_40hz_p95": "p95",
    "painted_40hz": "painted per s of 40",
    "cpu": "kernel CPU per update, ms",
    "page_cpu": "page CPU per update, ms",
    "bytes": "bytes per scan",
    "flooded_painted": "flooded: painted per s",
    "flooded_latency": "latency, ms",
    "flooded_late": "newest shown late by, ms",
    "flooded_shown": "newest shown at all, of 1",
    "imports": "import, ms",
}
MORE_IS_BETTER = ("painted_40hz", "flooded_painted", "flooded_shown")
LIMITS = {
    "latency_10hz": 1.2,
    "latency_10hz_p95": 1.2,
    "latency_40hz": 1.2,
    "latency_40hz_p95": 1.2,
    "painted_40hz": 1.2,
    "flooded_painted": 1.2,
    "flooded_latency": 1.2,
    "bytes": 1.1,
}
"""The limits of our figures as multiples of the bare canvas's figures."""


def figures(rows: Mapping[str, dict[str, float]]) -> str:
    """Return the figures, one line per library."""
    body = [[name, *(say(row[column]) for column in COLUMNS)] for name, row in rows.items()]
    return markdown(["", *COLUMNS.values()], body)


def rooms(speeds: Mapping[str, simulator.Room]) -> str:
    """Return the speed of the simulated robot as a multiple of real time, one line per room."""
    body = [[name, str(room.walls), say(room.speed)] for name, room in speeds.items()]
    return markdown(["room", "walls", "times real time"], body)


def stops(found: Iterable[Stopped]) -> str:
    """Return the worst and the median seconds from a cause to zero, one line per cause."""
    by_cause: dict[str, dict[str, list[float]]] = {}
    for stopped in found:
        by_cause.setdefault(stopped.cause, {})[stopped.feed] = stopped.seconds
    feeds = list(next(iter(by_cause.values()), {}))
    heads = [head for feed in feeds for head in (f"{feed}, worst", "median")]
    body = [
        [cause, *(f"{figure(tries[feed]):.3f}" for feed in feeds for figure in (max, median))]
        for cause, tries in by_cause.items()
    ]
    return markdown(["", *heads], body)


def programs(found: Found) -> str:
    """Return milliseconds to the first step of a version, and per step."""
    heads = ["cell to first step, median", "p95", "a step", "with a machine", "and its widget", "its one distance"]
    heads += ["a step of three sectors", "with the values of its lines"]
    values = [found.first_step_median, found.first_step_p95, found.plain, found.machine, found.watched, found.event]
    values += [found.sectors, found.lines]
    return markdown(heads, [[f"{value:.3f}" for value in values]])


def ratios(rows: Mapping[str, dict[str, float]], ours: str) -> str:
    """Return the advantage of robowidgets in each figure, one line per other library."""
    body = []
    for name, row in rows.items():
        if name != ours:
            body.append([name, *(times(advantage(column, rows[ours], row)) for column in COLUMNS)])
    return markdown(["robowidgets is better by", *COLUMNS.values()], body)


def advantage(column: str, ours: dict[str, float], theirs: dict[str, float]) -> float:
    """Return the ratio of their figure to ours: above 1 is better, infinite if theirs never came."""
    more, less = (ours, theirs) if column in MORE_IS_BETTER else (theirs, ours)
    return more[column] / less[column] if less[column] else inf


def misses(rows: Mapping[str, dict[str, float]], ours: str, limit: str) -> list[str]:
    """Return a text for each target that these figures miss."""
    found = []
    for name, row in rows.items():
        if name == ours:
            continue
        for column, title in COLUMNS.items():
            least = 1 / LIMITS.get(column, inf) if name == limit else 1.0
            better = advantage(column, rows[ours], row)
            if better < least:
                found.append(f"{title} ({column}): {better:.2f} times as good as {name}, expected {least:.2f}")
    return found


def fours(parts: Mapping[str, Four]) -> str:
    """Return the table of four widgets at once."""
    titles = ["four laser widgets", "messages per s, at most", "painted per s each", "latency, ms", "p95"]
    body = [
        [name, say(f.messages), say(f.painted), say(f.latency), say(f.latency_p95), yes(f.newest_shown), yes(f.dropped)]
        for name, f in parts.items()
    ]
    return markdown([*titles, "newest shown on each", "anything dropped"], body)


def endurance(parts: Mapping[str, Endurance]) -> str:
    """Return the table of a long flood."""
    titles = ["one laser widget, flooded", "painted per s", "latency, ms", "p95"]
    memories = ["page's heap, MB", "kernel, MB", "server, MB"]
    body = [[name, *map(say, vars(part).values())] for name, part in parts.items()]
    return markdown([*titles, *memories], body)


def feeds(figures: Mapping[str, FeedFigures]) -> str:
    """Return the table of feeds, one line each."""
    titles = ["", "bare subscriber's callback, ms", "handed on by the feed", "painted", "p95"]
    more = ["the widget alone, `update` to paint", "added by the feed", "four widgets: % of one core"]
    body = []
    for name, one in figures.items():
        added, low, high = one.added
        times = map(say, (one.bare, one.handed, one.painted, one.painted_p95, one.widget))
        body.append([name, *times, f"{added:.2f} ({low:.2f} to {high:.2f})", say(one.core)])
    return markdown([*titles, *more], body)


def feed_endurance(parts: Mapping[str, FeedEndurance]) -> str:
    """Return the table of a feed at 1000 Hz for a long time."""
    titles = ["a feed at 1000 Hz", "latency, ms", "p95", "page's heap, MB", "kernel, MB"]
    return markdown(titles, [[name, *map(say, vars(part).values())] for name, part in parts.items()])


def whole(file: Whole) -> str:
    """Return the times from `open` to all scans and to the scanogram of a file, and of reading its bytes."""
    body = [
        ["its bytes, read into Python", say(file.read), ""],
        ["all scans as one array", say(file.array), times(file.array / file.read)],
        ["its scanogram", say(file.scanogram), times(file.scanogram / file.read)],
    ]
    return markdown([f"{file.megabytes:.0f} MB", "ms", "times the reading"], body)


def decodings(files: Mapping[str, Decoding]) -> str:
    """Return the times to decode scans, one line per topic."""
    body = [
        [name, f"{d.scans:,} of {d.rays:,} rays", say(d.ours), say(d.rosbags), times(d.rosbags / d.ours)]
        for name, d in files.items()
    ]
    return markdown(["", "scans", "ms", "rosbags, ms", "times as fast"], body)


def peaks(work: Mapping[str, tuple[float, float]]) -> str:
    """Return the memory, one line per kind of work."""
    body = [[name, say(one), say(ten), say(ten - one)] for name, (one, ten) in work.items()]
    return markdown(["most memory, MB", "the written file", "ten times as much", "more by"], body)


def waits(kinds: Mapping[str, Waiting]) -> str:
    """Return the times from clicks to paint, and of the bare round trip."""
    bare, framed = kinds[ROUND_TRIP].middle, kinds[FRAMED].middle
    body = [
        [name, say(one.middle), say(one.late), times(one.middle / bare), times(one.middle / framed)]
        for name, one in kinds.items()
    ]
    return markdown(["", "median, ms", "p95", "of a bare round trip", "of one to the end of the next frame"], body)


def plays(kinds: Mapping[str, Playing]) -> str:
    """Return the figures of playing, and the frames of a page without playing."""
    body = [[name, *map(say, vars(one).values())] for name, one in kinds.items()]
    return markdown(["", "animation frames per s", "painted per s", "seconds of the recording per s"], body)


def opened(page: Opened) -> str:
    """Return the times of a page in a file, from opening it."""
    return markdown(["MB", "laser, ms", "scanogram, ms"], [[say(page.size), say(page.laser), say(page.scanogram)]])


def readings(files: Mapping[str, Reading]) -> str:
    """Return the figures of recordings. Ratios are ratios of times: below 1 is faster than rosbags."""
    head = ["", "open, ms", "rosbags", "ratio", "samples per s", "rosbags", "ratio"]
    body = []
    for name, r in files.items():
        opened = [say(r.open_ours), say(r.open_theirs), f"{r.open_ours / r.open_theirs:.2f}"]
        body.append([name, *opened, say(r.rate_ours), say(r.rate_theirs), f"{r.rate_theirs / r.rate_ours:.2f}"])
    return markdown(head, body)


def plots(found: Mapping[str, Plotted]) -> str:
    """Return the figures of plots of an hour, one line per library."""
    heads = ["", "seen after, ms", "MB", "a step of the wheel, ms", "at most", "of the pointer, ms"]
    more = ["kernel CPU at 1 kHz, of a core", "page CPU"]
    return markdown([*heads, *more], [[name, *map(say, vars(one).values())] for name, one in found.items()])


def hour(found: Hour) -> str:
    """Return the memory of page and kernel in the first and the last third, and the delay of a page that reappears."""
    heads = ["", "seconds", "nodes", "listeners", "page's heap, MB", "kernel, MB"]
    body = [
        [name, say(one.seconds), say(one.nodes), say(one.listeners), say(one.page / 1e6), say(one.kernel / 1e6)]
        for name, one in zip(("first third", "last third"), found.ends, strict=True)
    ]
    seen = (
        f"\nHidden for {found.hidden:.0f} s, the page showed the newest {found.late:.0f} ms after it was seen again; "
        f"that sample was {found.age:.0f} ms old. In the second after, samples were {found.usual_age:.0f} ms old."
    )
    return markdown(heads, body) + "\n" + seen


def leaks(found: Mapping[str, Leak]) -> str:
    """Return the increase of the page by each run of a cell, one line per widget."""
    limit = found[LIMIT].kilobytes
    body = [
        [
            NAMES[name],
            *(say(figure) for figure in (leak.nodes, leak.listeners, leak.kilobytes)),
            times(leak.kilobytes / limit),
            say(leak.closed_kilobytes),
        ]
        for name, leak in found.items()
    ]
    heads = ["nodes", "listeners", "heap, kB", "of the bare canvas's", "heap once all are closed, kB"]
    return markdown(["each run of a cell adds", *heads], body)


def layers(costs: Mapping[str, Cost], drags: Mapping[int, float]) -> str:
    """Return the cost of all layers and of the plain widget, and the frames per second of a drag."""
    plain, full = costs["laser"], costs["layers"]
    body = [
        [what, say(before), say(after), times(after / before)]
        for what, before, after in (
            ("painted per s of 40", plain.painted, full.painted),
            ("latency, ms", plain.latency, full.latency),
            ("kernel CPU per scan, ms", plain.cpu, full.cpu),
        )
    ]
    followed = [[f"{count:,}", say(frames)] for count, frames in drags.items()]
    heads = ["", "plain", "everything on", "ratio"]
    return f"{markdown(heads, body)}\n\n{markdown(['rays', 'frames per s in which a drag follows'], followed)}"


def topics(found: Mapping[str, Beside]) -> str:
    """Return the latency of the laser with other topics, one line per view."""
    alone = found["alone"]
    body = [
        [
            SHOWN[name],
            *(say(figure) for figure in (one.bare, one.handed, one.painted, one.painted_p95)),
            times(one.painted / alone.painted),
            *(say(figure) for figure in (one.per_second, one.kernel, one.page, one.rate)),
        ]
        for name, one in found.items()
    ]
    heads = [
        *("on show", "bare subscriber's callback, ms", "handed on by the feed", "painted", "p95", "of alone"),
        *("painted per s of 40", "kernel: % of one core", "page: %", "messages per s without the scans"),
    ]
    return markdown(heads, body)


def large(found: Mapping[str, Large]) -> str:
    """Return the figures of pictures and clouds together with a laser, one line each."""
    body = [
        [PICTURES[name], *(say(getattr(one, field.name)) for field in fields(Large))] for name, one in found.items()
    ]
    heads = [
        *("with the laser", "`update` to drawn, ms", "p95", "drawn per s", "newer by then", "at most"),
        *("laser painted, ms", "p95", "kernel: % of one core", "page: %"),
    ]
    return markdown(heads, body)


def markdown(head: Sequence[str], body: Iterable[Sequence[str]]) -> str:
    """Return a table."""
    lines = [head, ["---"] * len(head), *body]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def say(value: float) -> str:
    """Return a figure with a suitable number of digits."""
    if isinf(value) or isnan(value):
        return "never" if isinf(value) else ""
    return f"{value:.2f}" if abs(value) < 10 else f"{value:,.0f}".replace(",", "\u202f")


def times(ratio: float) -> str:
    return "never comes" if isinf(ratio) else f"{ratio:.2f}"


def yes(value: bool) -> str:
    return "yes" if value else "no"
