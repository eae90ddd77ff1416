"""Topics that end long before their recording does."""

from __future__ import annotations

LEAST = 20
"""Messages of a topic; what fewer say of its pace is little."""

_LONG = 5.0
_STEPS = 10


def about_end(topic: str, count: int, last_ns: int, start_ns: int, end_ns: int) -> str:
    """A line about a topic that ends long before its recording; empty about one that does not.

    That is more than 5 s before, and more than ten times what lies between two of its messages on average.

    Args:
        topic: its name.
        count: its messages, `LEAST` or more.
        last_ns: when the last of them came.
        start_ns: when the recording starts.
        end_ns: when it ends.
    """
    length, at = (end_ns - start_ns) / 1e9, (last_ns - start_ns) / 1e9
    is_early = length - at > max(_LONG, _STEPS * length / (count - 1))
    return f"{topic}: nothing after {at:.2f} s of {length:.2f} s" if is_early else ""
