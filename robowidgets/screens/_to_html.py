"""The content of a page in a file, from a player and its recording."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from functools import partial
from itertools import islice
from math import floor
from typing import Any

from ..export.html import Heading, Page
from ..export.models import Models
from ..export.segments import segment
from ..laser.row import LASER
from ..message.frames import OF_TOPIC
from ..notebook.cells import close_all
from ..recordings import RecordingData
from ..recordings.times import has_date, to_ns
from ..repair import RecordingError
from ..runtime.text import as_date
from ..scanogram.overview import is_planar, whole_drive
from ..scanogram_widget import ScanogramWidget
from ..speed_widget import SpeedWidget
from ..tracks import Track
from ..widget.timed_frame import FRAME_HEADER, TimedFrame
from ._parts import PagedPlayer, followers

SEGMENT_BYTES = 400_000
"""The approximate size of the frames in a segment of a page, small enough to be unpacked between two pictures."""

LONGEST_SEGMENT = 60.0
"""The maximum length of a segment in seconds, so that the first picture needs little of a sparse recording."""

ROUNDING = 0.01
"""Seconds by which an end may lie after the end of the recording: times are displayed with two decimals."""

_LINES = 12
_NUMBERS = 8
_ADVICE = "select a span (start=, end=), fewer topics, or every second scan (every=2)"


@dataclass(frozen=True)
class Wanted:
    """The request for a page: seconds from the start of the recording, texts, and the step of scans.

    ``time`` is the time that it shows first, or None for the player's time. ``segment`` is the length of its segments
    in seconds, or None to choose it by the bytes of a second.
    """

    start: float | None = None
    end: float | None = None
    title: str = ""
    note: str = ""
    every: int = 1
    time: float | None = None
    segment: float | None = None


@contextmanager
def page_of(player: PagedPlayer, wanted: Wanted, scanogram: bool | None = None) -> Iterator[Page]:
    """Make the page of a player.

    It opens the recording again, so that the player can keep reading.

    Args:
        player: the player.
        wanted: the span and the texts.
        scanogram: True to make a scanogram if the player has none, or None to make it only if that is quick.

    Raises:
        ValueError: the span is not in the recording. TypeError: a time is not a number. RecordingError: no widget shows
            any topic of the recording, or the player is closed.
    """
    if player.bar.comm is None:
        raise RecordingError(f"{player.recording.path.name}: this player is closed; show the recording again")
    if not player.views:
        raise RecordingError(f"{player.recording.path.name}: no topic for a page: no widget shows any")
    with ExitStack() as stack:
        recording = stack.enter_context(player.recording.reopened())
        start, end = _stretch(recording, wanted)
        if isinstance(wanted.every, bool) or not isinstance(wanted.every, int) or wanted.every < 1:
            raise ValueError(f"every: expected 1 for all scans, 2 for every second ..., got {wanted.every!r}")
        tracks = player.tracks_of(recording)
        picture = _scanogram(player, recording, (start, end), scanogram)
        if picture:
            stack.callback(close_all, picture)
        seconds = wanted.segment or _segment_seconds(tracks, start, end)
        time = player.bar.time if wanted.time is None else wanted.time
        models = _models(player, recording, picture, (start, end), seconds, time)
        yield Page(
            _heading(player, recording, wanted, (start, end)),
            models.assets(),
            models.part(
                player.model_id,
                player=player.bar.model_id,
                scanogram=_drawn_here(player, picture),
                begin=start,
                name=player.recording.path.stem,
            ),
            range(floor(start / seconds), floor(end / seconds) + 1),
            partial(_segment, player, tracks, (start, end), seconds, wanted.every),
            _ADVICE,
        )


def _stretch(recording: RecordingData, wanted: Wanted) -> tuple[float, float]:
    """Return the start and the end of the page.

    Raises: as `page_of`.
    """
    duration = recording.duration
    times = []
    for name, seconds, default in (("start", wanted.start, 0.0), ("end", wanted.end, duration)):
        if seconds is None:
            times.append(default)
            continue
        to_ns(0, name, seconds)
        if not 0 <= seconds <= duration + ROUNDING:
            raise ValueError(f"{name}: expected seconds from 0 to {duration:.2f}, got {seconds:g}")
        times.append(min(float(seconds), duration))
    start, end = times
    if start > end or (start == end and duration):
        raise ValueError(f"expected a start before the end, got start={start:g} and end={end:g}")
    return start, end


def _scanogram(
    player: PagedPlayer, recording: RecordingData, span: tuple[float, float], wanted: bool | None
) -> ScanogramWidget | None:
    """Make the scanogram of the span, with the settings of the player's scanogram."""
    choices = [view.choice for view in player.views]
    scanned = next((choice.topic for choice in choices if choice.kind.name == LASER.name), "")
    own = player.scanogram
    if not recording.duration or not scanned:
        return None
    # Open at the end of the recording, so that its last sample is included.
    ends = (span[0], None if span[1] == recording.duration else span[1])
    beside = [name for choice in choices if not choice.takes_messages for name in choice.topics]
    picture, _ = whole_drive(recording, scanned, beside, True if own and not own.is_thinned else wanted, ends)
    if picture and own:
        for name in ("title", "header", "footer", "color_range", "selection"):
            setattr(picture, name, getattr(own, name))
        picture.view = _clipped(own.view, span)
    return picture


def _drawn_here(player: PagedPlayer, picture: ScanogramWidget | None) -> dict[str, Any] | None:
    """Return the scanogram that the page draws from scans, and the number of the widget that shows them."""
    if picture is None:
        return None
    lasers = (i for i, view in enumerate(player.views) if view.choice.kind.name == LASER.name)
    return {"model": picture.model_id, "track": next(lasers)}


def _models(
    player: PagedPlayer,
    recording: RecordingData,
    picture: ScanogramWidget | None,
    span: tuple[float, float],
    seconds: float,
    time: float,
) -> Models:
    models = Models()
    bar = player.bar
    marks, labels = (
        [one for one in named if one[0] <= span[1] and one[1] >= span[0]] for named in (bar.marks, bar.labels)
    )
    time = time if span[0] <= time <= span[1] else span[0]
    has_read_speeds = player.scanogram is not None and not player.scanogram.is_thinned
    for view in player.views:
        changed: dict[str, Any] = {"_frame": b"", "_about": {}, "_source": {}, "_silence": 0.0}
        if picture and not has_read_speeds and isinstance(view.widget, SpeedWidget):
            changed["planar"] = view.widget.planar or is_planar(recording, view.choice.topics)
        if view.widget.has_trait("time"):
            changed["time"] = time
        models.add(view.widget, changed | view.widget.within(*span))
    shown_at = {"time": time, "marks": marks}
    selection = _clipped(bar.selection, span)
    models.add(
        bar,
        {
            **shown_at,
            "labels": labels,
            # The scanogram shows all rows.
            "states": bar.states[: 1 if picture else None],
            "playing": False,
            "selection": selection,
            "duration": span[1],
            "_begin": span[0],
            "_segment": seconds,
            "_followers": followers(player.views, picture),
            "_first": [],
            "_leader": {},
            "_status": "",
            "_note": "",
        },
    )
    if picture:
        models.add(picture, {**shown_at, "_frame": picture.frame_without_scans()})
    # A page has no list of topics. Its heading shows the problems.
    places = {name: widgets for name, widgets in player.arranged(picture).items() if name != "topics"}
    models.add(player, {"_children": player.rooms_of(places), "_notes": []})
    return models


def _clipped(chosen: Any, span: tuple[float, float]) -> tuple[float, float] | None:
    """Return the part of a chosen span in the page, or None if they do not overlap."""
    if not chosen:
        return None
    start, end = max(chosen[0], span[0]), min(chosen[1], span[1])
    return (start, end) if start < end else None


def _segment_seconds(tracks: Sequence[tuple[Any, Track]], start: float, end: float) -> float:
    """Return the length of the segments of a page in whole seconds, from the bytes of one second in its middle."""
    middle = (start + end) / 2
    size = sum(len(timed.frame) for _, track in tracks for timed in track.frames(middle, middle + 1.0))
    return float(min(LONGEST_SEGMENT, max(1, SEGMENT_BYTES // max(1, size))))


def _segment(
    player: PagedPlayer,
    tracks: Sequence[tuple[Any, Track]],
    span: tuple[float, float],
    seconds: float,
    every: int,
    number: int,
) -> bytes:
    start = max(span[0], number * seconds)
    end = (number + 1) * seconds if span[1] == player.duration else min(span[1], (number + 1) * seconds)
    packed = []
    for (widget, track), view in zip(tracks, player.views, strict=True):
        frames = [_without_arrival(timed) for timed in track.frames(start, max(start, end))]
        packed.append((_thinned(frames, every) if view.choice.kind.name == LASER.name else frames, widget.arrays_of))
    return segment(number, packed)


def _without_arrival(timed: TimedFrame) -> TimedFrame:
    """Return a frame without the time at which its sample was read, which is of no use on a page.

    Fields of messages keep this time, which is in seconds from the start of the recording.
    """
    if OF_TOPIC in timed.about:
        return timed
    sequence, rate, stamp_ns, _ = FRAME_HEADER.unpack_from(timed.frame)
    head = FRAME_HEADER.pack(sequence, rate, stamp_ns, 0.0)
    return timed._replace(frame=head + timed.frame[FRAME_HEADER.size :])


def _thinned(frames: list[TimedFrame], every: int) -> list[TimedFrame]:
    """Return the first frame of a segment, and every so many of the others."""
    return frames if every == 1 else [*frames[:1], *frames[1::every]]


def _heading(player: PagedPlayer, recording: RecordingData, wanted: Wanted, span: tuple[float, float]) -> Heading:
    start, end = span
    name, duration = recording.path.name, recording.duration
    stretch = f"{duration:.2f} s" if end - start == duration else f"{start:.2f} to {end:.2f} s of {duration:.2f} s"
    start_ns = recording.start_ns or 0
    choices = [view.choice for view in player.views]
    topics = list(dict.fromkeys(one for choice in choices if not choice.takes_messages for one in choice.topics))
    titles = list(dict.fromkeys(title for choice in choices for title in choice.titles))
    facts = [
        *([name] if wanted.title else []),
        stretch,
        *([as_date(start_ns + round(start * 1e9))] if has_date(start_ns) else []),
        ", ".join(titles),
        *([f"one of every {wanted.every} scans"] if wanted.every > 1 else []),
        *(["without Rerun's viewer"] if player.rerun else []),
    ]
    samples = islice(recording.samples(topics, start, end), _LINES) if topics else ()
    return Heading(
        wanted.title or name,
        " · ".join(facts),
        player.problems,
        wanted.note,
        [_line(moment.seconds, moment.topic, moment.sample) for moment in samples],
    )


def _line(seconds: float, topic: str, sample: Any) -> str:
    ranges = getattr(sample, "ranges", ())
    some = ", ".join(f"{distance:.3f}" for distance in ranges[:_NUMBERS])
    return f"{seconds:.3f} s  {topic}  {sample!r}" + (f"  ranges: {some} ..." if some else "")
