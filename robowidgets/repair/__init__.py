"""Damaged files, broken clocks and CARMEN logs become one clean source before anything else reads them.

The readers walk a file from its start, trust no index in it, and take no more memory than there are bytes for, whatever
the file claims. `Source.problems` tells what was wrong.
"""

from ._clock import JITTER_NS, LEAP_NS, REAL_FROM_NS, RESET_NS, Arrivals, was_set
from ._open import find_files, has_messages, open_repaired
from .source import Message, RecordingError, Source

__all__ = [
    "JITTER_NS",
    "LEAP_NS",
    "REAL_FROM_NS",
    "RESET_NS",
    "Arrivals",
    "Message",
    "RecordingError",
    "Source",
    "find_files",
    "has_messages",
    "open_repaired",
    "was_set",
]
