"""Readable texts of counts, sizes, dates and angles."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from datetime import datetime, timedelta, timezone
from math import degrees

_EPOCH = datetime(1970, 1, 1, tzinfo=timezone.utc)


def many(count: int, word: str) -> str:
    """Return a number with a noun: ``1 topic``, ``1,200 messages``."""
    return f"{count:,} {word}{'' if count == 1 else 's'}"


def often(count: int) -> str:
    """Return a number of times: ``once``, ``12 times``."""
    return "once" if count == 1 else f"{count:,} times"


def megabytes(size: float) -> str:
    """Return a number of bytes: ``450 kB``, ``12.3 MB``, ``1.5 GB``."""
    if size < 1e6:
        return f"{size / 1e3:.0f} kB"
    return f"{size / 1e6:,.1f} MB" if size < 1e9 else f"{size / 1e9:,.1f} GB"


def listed(names: Sequence[str], most: int = 3) -> str:
    """Return the first names, and the number of the others."""
    return ", ".join(names[:most]) + (f" and {len(names) - most:,} more" if len(names) > most else "")


def as_date(time_ns: int) -> str:
    """Return nanoseconds since the epoch as date and time of day: ``2024-05-03 14:32:05 UTC``."""
    return f"{_EPOCH + timedelta(seconds=time_ns // 10**9):%Y-%m-%d %H:%M:%S} UTC"


def degrees_of(angle: float) -> str:
    """Return an angle in radians as degrees: ``−31.2°``."""
    return f"{degrees(angle):.1f}°".replace("-", "\N{MINUS SIGN}")


def nearest_name(name: str, known: Iterable[str]) -> str | None:
    """Return the most similar known name: one that starts with it, else one spelt alike, or None without any."""
    names = list(known)
    longer = [other for other in names if other.startswith(name)]
    from difflib import get_close_matches  # Imported lazily: few names are wrong.

    return next(iter(get_close_matches(name, longer or names, n=1)), None)
