"""The small pictures of a contact sheet: the view of a condition at one moment, as bytes for the page."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from functools import partial
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..laser.row import LASER
from ..messages.decoding import one_line
from ..recordings import RecordingData
from ..recordings.search.base import Condition, Curve
from ..recordings.search.instant import Instant, NoSampleYetError, Now
from ..recordings.topics import shown
from ..samples import Scan
from ..samples.distances import ray_distances
from ..samples.event import Event
from ..samples.verdict import UNKNOWN, Verdict
from ..touch.row import TOUCH
from ._hit import Hit

MOST_RAYS = 400
"""The maximum number of rays of a picture: as many as a circle of 120 pixels has dots. Otherwise each dot is the
nearest of several."""

POINTS = 64
"""The number of points of a number's line."""

_AROUND = 1.0
"""The minimum number of seconds of a line before and after its span; half of the span if that is longer."""

_HEAD = struct.Struct("<IBxHfffHxx")
"""Number of the hit, form, count of rays or points, two facts of the form, metres of a step, bytes of the text."""

RAYS, LINE, WORDS = 1, 2, 3
_LIT, _MOST = 0x8000, 0x7FFF
_FINEST = 0.002
_LONGEST = 300


class Thumbnail(NamedTuple):
    """The content of the tile of a hit.

    Attributes:
        form: RAYS, LINE or WORDS.
        values: for rays, uint16: steps of distance in the low 15 bits, 0 for no reading, and in the highest bit 1 if
            the condition is true for the ray; for a line, float32. Shape (N,).
        facts: for rays, the angle of the first and the angle between two, in radians; for a line, its start and its end
            in seconds from the start of the span.
        step: metres.
        words: the text of the comparison or the event.
    """

    form: int
    values: NDArray[Any]
    facts: tuple[float, float] = (0.0, 0.0)
    step: float = 0.0
    words: str = ""

    def pack(self, number: int) -> bytes:
        """Return bytes for the page, whose length is a multiple of 4: js/sheet/pictures.ts."""
        words = self.words.encode()[:_LONGEST]
        head = _HEAD.pack(number, self.form, len(self.values), *self.facts, self.step, len(words))
        body = self.values.tobytes() + words
        return head + body + bytes(-len(body) % 4)


def pictures(recording: RecordingData, hits: Mapping[int, Hit], wanted: Condition | None) -> Iterator[bytes]:
    """Yield the packed pictures of hits in one recording.

    Args:
        recording: the recording.
        hits: the hits by their numbers.
        wanted: the condition, or None if it is unknown: then only the nearest ray is lit.
    """
    number = None if wanted is None else _number(recording, wanted)
    for key, hit in hits.items():
        yield _picture(recording, hit, wanted, number).pack(key)


def unreadable(reason: str) -> Thumbnail:
    """Return a replacement for a picture that cannot be made."""
    return Thumbnail(WORDS, np.empty(0, np.uint8), words=reason)


def _picture(recording: RecordingData, hit: Hit, wanted: Condition | None, number: Curve | None) -> Thumbnail:
    topics = hit.topic.split(", ")
    recording.preferred = frozenset(topics)
    seconds = hit.moment
    verdict = _judged(recording, hit, wanted, seconds)
    words = verdict.text or (f"nothing on {', '.join(hit.silent)}" if hit.silent else "")
    known = shown(recording.topics)
    scanned = next((name for name in topics if name in known and known[name].widget == LASER.name), None)
    is_touch = all(name in known and known[name].widget == TOUCH.name for name in topics)
    # For a touch, a scan shows what touched the robot. For a label, only the time is known.
    if not scanned and (is_touch or not hit.topic):
        scanned = next((name for name, topic in known.items() if topic.widget == LASER.name), None)
    scan = recording.at(scanned, seconds) if scanned else None
    if scan is not None and len(scan.sample):
        return _of_scan(scan.sample, hit, verdict)._replace(words=words)
    if number is not None and len(number.times_ns):
        return _of_number(number, hit)._replace(words=words)
    return Thumbnail(WORDS, np.empty(0, np.uint8), words=words)


def _judged(recording: RecordingData, hit: Hit, wanted: Condition | None, seconds: float) -> Verdict:
    """Return the verdict of the condition on the moment, or unknown if it needs more than one moment."""
    if wanted is None or hit.silent:
        return UNKNOWN
    try:
        return wanted.of_moment.judge(_At(recording, seconds))
    except NoSampleYetError:
        return UNKNOWN
    except Exception as error:  # from a user's function, which may need more than this moment
        return Verdict(None, f"cannot be judged again: {type(error).__name__}: {one_line(error)}")


def _of_scan(scan: Scan, hit: Hit, verdict: Verdict) -> Thumbnail:
    away = ray_distances(scan.ranges, scan)
    is_lit: Any = np.zeros(len(scan), bool)
    is_lit[verdict.rays[verdict.rays < len(scan)]] = True
    if not is_lit.any() and hit.index is not None and hit.index < len(scan):
        is_lit[hit.index] = True
    each = -(-len(scan) // MOST_RAYS)
    away = np.where(np.isfinite(away), away, np.inf)
    start = scan.angle_min + (each - 1) / 2 * scan.angle_increment
    if each > 1:
        spare = -len(scan) % each
        away = np.pad(away, (0, spare), constant_values=np.inf).reshape(-1, each).min(axis=1)
        is_lit = np.pad(is_lit, (0, spare)).reshape(-1, each).any(axis=1)
    is_there = np.isfinite(away)
    step = max(_FINEST, float(away[is_there].max()) / _MOST) if is_there.any() else _FINEST
    steps = np.clip(np.rint(np.where(is_there, away, 0) / step), 1, _MOST)
    codes = np.where(is_there, steps, 0).astype("<u2") | np.where(is_lit, _LIT, 0).astype("<u2")
    return Thumbnail(RAYS, codes, (start, each * scan.angle_increment), step)


def _number(recording: RecordingData, wanted: Condition) -> Curve | None:
    """Return the number that a condition compares, or None if it compares none, or if this recording has none."""
    try:
        return wanted.number(recording)
    except (KeyError, TypeError):  # from conditions joined by |: the recording may lack the topic of one of them
        return None


def _of_number(number: Curve, hit: Hit) -> Thumbnail:
    pad = round(max(_AROUND, hit.seconds / 2) * 1e9)
    times = np.linspace(hit.start_ns - pad, hit.end_ns + pad, POINTS).astype(np.int64)
    last = np.searchsorted(number.times_ns, times, side="right") - 1
    values = np.where(last < 0, np.nan, number.values[last]).astype("<f4")
    values[times > number.times_ns[-1]] = np.nan
    return Thumbnail(LINE, values, (-pad / 1e9, hit.seconds + pad / 1e9))


class _At(Instant):
    """The last samples of a recording up to a time, in the form for conditions: by kind, by topic, as messages."""

    def __init__(self, recording: RecordingData, seconds: float) -> None:
        self._recording, self._at = recording, seconds
        now = Now(recording.start_ns or 0)
        topics = list(recording.topics)
        now.put(
            (recording.start_ns or 0) + round(seconds * 1e9),
            {one.name: partial(self._read, one.name) for one in topics},
        )
        super().__init__(recording.path.name, topics, now, recording.preferred)

    @property
    def messages(self) -> Mapping[str, Any]:
        return _Messages(self._recording, self._at)

    @property
    def event(self) -> Event | None:
        """The last event up to the time."""
        time_ns = (self._recording.start_ns or 0) + round(self._at * 1e9)
        last = None
        for at_ns, event in self._recording.timed_events(stop_ns=time_ns + 1):
            last = event if at_ns <= time_ns else last
        return last

    def _read(self, topic: str) -> Any:
        at = self._recording.at if topic in shown(self._recording.topics) else self._recording.message_at
        found = at(topic, self._at)
        if found is None:
            raise NoSampleYetError(topic)
        return found.sample


class _Messages(Mapping[str, Any]):
    """The last message of each topic by name."""

    def __init__(self, recording: RecordingData, seconds: float) -> None:
        self._recording, self._at = recording, seconds

    def __getitem__(self, topic: str) -> Any:
        found = self._recording.message_at(topic, self._at)
        return None if found is None else found.message

    def __iter__(self) -> Iterator[str]:
        return (topic.name for topic in self._recording.topics)

    def __len__(self) -> int:
        return len(self._recording.topics)
