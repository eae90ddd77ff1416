"""Message definitions as recordings name them."""

from __future__ import annotations

_MESSAGE = ("ros1msg", "ros2msg")
_IDL = ("ros2idl", "omgidl")
_LINE = "=" * 80


def definition(encoding: str, type_name: str, text: str) -> str:
    """The text of a definition as `Channel` holds it; empty when it is in a language that is not ROS's."""
    if encoding in _IDL and text and not text.startswith(_LINE):
        return f"{_LINE}\nIDL: {type_name}\n{text}"
    return text if encoding in _MESSAGE or encoding in _IDL else ""
