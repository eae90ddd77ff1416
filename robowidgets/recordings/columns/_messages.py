"""Chunks of messages of any type: their bytes, and the positions of their fields in them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...messages.channel import Channel
from ...messages.decoding import DecodeError, decoder_of
from ...messages.layout import FieldPath, Layout, Layouts, Leaf, as_rows
from ._decoders import NoteUnread
from .chunks import Chunk

_OVERHEAD = 200
"""Approximate bytes of memory that a message takes in addition to its data."""


class MessageDecoder:
    """A decoder that keeps messages as they are, and finds the positions of their fields; see `Decoder`.

    Args:
        channel: the channel of the messages.

    Raises:
        DecodeError: their type is not known.
    """

    def __init__(self, channel: Channel) -> None:
        self.frame_ids: dict[str, None] = {}
        self.type, self.read = channel.type, decoder_of(channel)
        self._layouts = Layouts(channel)
        self.leaves: Sequence[Leaf] = self._layouts.leaves
        stamps = [i for i, leaf in enumerate(self.leaves) if leaf.name == "header.stamp" and leaf.type == "time"]
        self._stamp = FieldPath(stamps[0]) if stamps else None

    def left_over(self, raw: bytes) -> int:
        """Return the number of bytes after the last field of a message. Raises DecodeError if it cannot be read."""
        return self._layouts.of(raw).left

    def decode(self, raws: Sequence[bytes], times: Sequence[int], note: NoteUnread) -> list[Any]:
        """See `Decoder`."""
        kept: list[int] = []
        layouts: list[Layout] = []
        for i, raw in enumerate(raws):
            try:
                layouts.append(self._layouts.of(raw))
            except DecodeError as error:
                note(i, error)
                continue
            kept.append(i)
        if not kept:
            return []
        own_raws, own_layouts = np.empty(len(kept), object), np.empty(len(kept), object)
        own_raws[:] = [raws[i] for i in kept]
        own_layouts[:] = layouts
        own_times = np.array([times[i] for i in kept], np.int64)
        chunk = MessageChunk(0, own_times, np.zeros(len(kept), np.int64), own_raws, own_layouts, self)
        if self._stamp is not None:
            for layout, rows, group in chunk.groups():
                stamps = layout.values(as_rows(group), self.leaves[self._stamp.leaf], self._stamp)[:, 0]
                chunk.stamps_ns[rows] = np.maximum(stamps, 0)
        return [chunk]


@dataclass(frozen=True)
class MessageChunk(Chunk):
    """Consecutive messages.

    Args:
        raws: shape (N,), their bytes.
        layouts: shape (N,), the `Layout` of each.
        decoder: the decoder that reads them.
    """

    raws: NDArray[np.object_]
    layouts: NDArray[np.object_]
    decoder: MessageDecoder

    @property
    def nbytes(self) -> int:
        """Estimated size in bytes."""
        return sum(map(len, self.raws)) + _OVERHEAD * len(self)

    def sample(self, i: int) -> Any:
        """See `Chunk`: the message, as rosbags reads it."""
        return self.decoder.read(self.raws[i])

    def groups(self) -> Iterator[tuple[Layout, NDArray[np.int64], list[bytes]]]:
        """Yield the layouts, each with its rows and their messages."""
        by_layout: dict[int, list[int]] = {}
        for row, layout in enumerate(self.layouts):
            by_layout.setdefault(id(layout), []).append(row)
        for rows in by_layout.values():
            yield self.layouts[rows[0]], np.array(rows, np.int64), [self.raws[row] for row in rows]
