"""Topics that every node has, and types with large messages."""

from __future__ import annotations

import re

_EVERY_NODE = re.compile(
    r"/(?:rosout|rosout_agg|parameter_events|client_count|connected_clients|bond|_.*"
    r"|.*/(?:_\w+|_action/.*|transition_event|bond|parameter_descriptions|parameter_updates))"
)
_LARGE = re.compile("Image|PointCloud|LaserEcho|Grid|Costmap|Map$|Mesh|Voxel|Video|Packet|Disparity|Chunk|Tile")


def is_infrastructure(topic: str) -> bool:
    """Return True if a topic is one that every node has, or that belongs to an action or a set of parameters."""
    return _EVERY_NODE.fullmatch(topic) is not None


def is_large(type_name: str) -> bool:
    """Return True if messages of a type are usually large: pictures, clouds, maps."""
    return _LARGE.search(type_name) is not None
