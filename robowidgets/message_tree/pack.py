"""The bytes of a tree as the page reads them; docs/developers/frames.md describes them."""

from __future__ import annotations

import json
import struct

from .read import Tree

_LENGTH = struct.Struct("<I")


def pack(tree: Tree) -> bytes:
    """The values of a tree: the length of their JSON, the JSON, and the numbers of arrays."""
    text = json.dumps(tree.values, ensure_ascii=False, allow_nan=False, separators=(",", ":"))
    # Half a surrogate pair, as a text from outside may have, is no UTF-8.
    raw = text.encode("utf-8", "replace")
    return b"".join([_LENGTH.pack(len(raw)), raw, tree.numbers])
