"""One stream of messages of one type, as a file names it."""

from __future__ import annotations

from typing import NamedTuple


class Channel(NamedTuple):
    """One stream of messages of one type.

    ``id`` is unique within a source, and only there. ``type`` is written as ``sensor_msgs/msg/LaserScan``, for ROS 1
    too. ``encoding`` is ``"ros1"`` or ``"cdr"``; messages in any other encoding are listed but cannot be read.
    ``definition`` is the text of the message definition in ROS's ``.msg`` syntax with its dependencies after lines of
    80 ``=``; or in IDL, after such a line and ``IDL: `` with the type; empty when the file holds none. ``count`` is the
    number of messages.
    """

    id: int
    topic: str
    type: str
    encoding: str
    definition: str
    count: int  # type: ignore[assignment]  # hides tuple.count, which nobody asks of a channel


_MESSAGE = ("ros1msg", "ros2msg")
_IDL = ("ros2idl", "omgidl")
_LINE = "=" * 80


def definition_text(encoding: str, type_name: str, text: str) -> str:
    """The text of a definition as `Channel` holds it; empty when it is in a language that is not ROS's."""
    if encoding in _IDL and text and not text.startswith(_LINE):
        return f"{_LINE}\nIDL: {type_name}\n{text}"
    return text if encoding in _MESSAGE or encoding in _IDL else ""


def is_idl(definition: str) -> bool:
    """Whether the definition of a `Channel` is in IDL."""
    return definition.startswith(f"{_LINE}\nIDL: ")
