"""The bytes of a tree for the page; docs/developers/frames.md describes them."""

from __future__ import annotations

import json
import struct

from .read import Tree

_LENGTH = struct.Struct("<I")


def pack(tree: Tree) -> bytes:
    """Return the values of a tree as bytes: the length of their JSON, the JSON, and the numbers of arrays."""
    text = json.dumps(tree.values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    # Half a surrogate pair, which a text from outside may contain, cannot be encoded as UTF-8.
    raw = text.encode("utf-8", "replace")
    return b"".join([_LENGTH.pack(len(raw)), raw, tree.numbers])
