"""Messages of any type in the classes of the libraries, for tests."""

from __future__ import annotations

import json
from typing import Any

import numpy as np

from robowidgets import MessageWidget
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import store_of


def made(type_name: str, **fields: Any) -> Any:
    """A message in the class of rosbags."""
    return store_of(Channel(0, "", type_name, "cdr", "", 0)).types[type_name](**fields)


def header(frame_id: str = "base_link") -> Any:
    """A header of second 5."""
    stamp = made("builtin_interfaces/msg/Time", sec=5, nanosec=250_000_000)
    return made("std_msgs/msg/Header", stamp=stamp, frame_id=frame_id)


def vector(x: float, y: float, z: float) -> Any:
    """A Vector3."""
    return made("geometry_msgs/msg/Vector3", x=x, y=y, z=z)


class Sent:
    """The part of a message that the page received: the nodes and the value of each field, by its path."""

    def __init__(self, about: dict[str, Any], packed: bytes) -> None:
        self.about, self.packed = about, packed
        length = int.from_bytes(packed[:4], "little")
        self._numbers = packed[4 + length :]
        self.nodes: dict[str, dict[str, Any]] = {}
        self.values: dict[str, Any] = {}
        self._enter(about.get("tree", []), json.loads(packed[4 : 4 + length]), "")

    def _enter(self, nodes: list[dict[str, Any]], values: list[Any], within: str) -> None:
        for node, value in zip(nodes, values, strict=True):
            name = node["name"]
            path = within + name if name.startswith("[") else f"{within}.{name}".lstrip(".")
            self.nodes[path], self.values[path] = node, value
            self._enter(node.get("children", []), value if "children" in node else [], path)

    def array(self, path: str) -> Any:
        """The numbers of an array as the page reads them, or None if they were not sent."""
        count, *_, place = self.values[path]
        kind = np.dtype(self.nodes[path]["type"]).newbyteorder("<")
        return None if place < 0 else np.frombuffer(self._numbers, kind, count, place)


def sent(message: Any, **options: Any) -> Sent:
    """The message data in the page of a new widget."""
    widget = MessageWidget(**options)
    try:
        widget.update(message)
        state = widget.get_state()
    finally:
        widget.close()
    return Sent(state["_about"], bytes(state["_frame"])[32:])
