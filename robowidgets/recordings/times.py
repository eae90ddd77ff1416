"""Times of a recording: seconds from its start, nanoseconds of its clock, and dates."""

from __future__ import annotations

import re
from datetime import datetime, timedelta, timezone
from math import isfinite
from numbers import Real
from typing import Any

from ..repair import REAL_FROM_NS, RecordingError
from ..runtime.text import as_date

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)
_LONGEST = 2**62 / 1e9
_UTC = re.compile(r"\s*(UTC|Z)$", re.IGNORECASE)


def to_ns(start_ns: int | None, name: str, seconds: Any) -> int:
    """Return the clock time in nanoseconds for seconds from the start; raise TypeError or ValueError otherwise."""
    if isinstance(seconds, bool) or not isinstance(seconds, Real):
        raise TypeError(f"{name}: expected seconds from the start of the recording, got {seconds!r}")
    if not isfinite(seconds) or abs(float(seconds)) > _LONGEST:
        raise ValueError(f"{name}: expected seconds from the start of the recording, got {seconds!r}")
    return (start_ns or 0) + round(float(seconds) * 1e9)


def span_ns(start_ns: int | None, start: Any, end: Any) -> tuple[int | None, int | None]:
    """Return the clock times of a start and an end in seconds from the start, as in `to_ns`; None stays None.

    Raises:
        TypeError, ValueError: one of them is not a number of seconds, or the end lies before the start.
    """
    first = None if start is None else to_ns(start_ns, "start", start)
    last = None if end is None else to_ns(start_ns, "end", end)
    if first is not None and last is not None and last < first:
        raise ValueError(f"end: expected seconds from the start of the recording, {start:g} or more, got {end:g}")
    return first, last


def has_date(time_ns: int) -> bool:
    """Return True if a clock with this time has the right date."""
    return time_ns >= REAL_FROM_NS


def seconds_at(when: datetime | str, file: str, start_ns: int | None, end_ns: int | None) -> float:
    """Return the seconds from the start of a file's recording at a date and time of day: see `Recording.seconds_at`."""
    when_ns = _since_epoch(when)
    if start_ns is None or end_ns is None or not has_date(start_ns):
        why = "holds no message" if start_ns is None else f"has no date: its clock begins at {start_ns / 1e9:g} s"
        raise RecordingError(f"{file} {why}; its times are seconds from the start, 0 to its duration")
    # Start times are displayed to the second, so accept times from the start of that second.
    if not start_ns // 10**9 * 10**9 <= when_ns <= end_ns:
        lies = "before" if when_ns < start_ns else "after"
        span = f"from {as_date(start_ns)} to {as_date(end_ns)}"
        raise ValueError(f"when: {as_date(when_ns)} lies {lies} the recording {file}, which is {span}")
    return max(0, when_ns - start_ns) / 1e9


def _since_epoch(when: datetime | str) -> int:
    expected = 'when: expected a datetime, or text such as "2024-05-03T14:32:05"'
    if isinstance(when, str):
        try:
            when = datetime.fromisoformat(_UTC.sub("+00:00", when.strip()))
        except ValueError:
            raise ValueError(f"{expected}; got {when!r}") from None
    if not isinstance(when, datetime):
        raise TypeError(f"{expected}; got {when!r}")
    aware = when if when.utcoffset() is not None else when.replace(tzinfo=timezone.utc)
    return (aware - _EPOCH) // timedelta(microseconds=1) * 1000
