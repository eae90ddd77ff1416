"""Repair of damaged files, broken clocks and CARMEN logs, so that all other parts read a clean source.

The readers walk through a file from its start, do not trust its index, and use no more memory than its size justifies,
whatever lengths it claims. `Source.problems` lists the repairs; `write.write` writes a source as an MCAP file.
"""

from ._carmen import is_carmen
from ._clock import JITTER_NS, LEAP_NS, REAL_FROM_NS, RESET_NS, Arrivals, has_clock_step, joined, may_precede_clock
from ._open import SUFFIX, find_files, is_being_written, is_finished, natural, open_repaired
from ._sqlite import files_beside, is_cut
from .source import Message, RecordingError, RemoteError, Source

__all__ = [
    "JITTER_NS",
    "LEAP_NS",
    "REAL_FROM_NS",
    "RESET_NS",
    "SUFFIX",
    "Arrivals",
    "Message",
    "RecordingError",
    "RemoteError",
    "Source",
    "files_beside",
    "find_files",
    "has_clock_step",
    "is_being_written",
    "is_carmen",
    "is_cut",
    "is_finished",
    "joined",
    "may_precede_clock",
    "natural",
    "open_repaired",
]
