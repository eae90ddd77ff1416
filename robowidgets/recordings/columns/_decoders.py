"""Decoding the messages of one channel into chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import takewhile
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...messages import to_scan, to_speed
from ...messages.channel import Channel
from ...messages.decoding import decoder_of, shape_of
from ...samples import Scan, yaw_of
from ._template import MessageTemplate, Rows, scan_template, speed_template
from .chunks import SampleChunk, ScanChunk, SpeedChunk, merged, single_scan, single_speed

NoteUnread = Callable[[int, Exception], None]
"""Called for a message that cannot be shown, with its index in the given messages and the error."""

_FIRST_LOOK, _CAREFUL_LOOK = 1024, 32


class Decoder(Protocol):
    """A decoder of the messages of one channel; `frame_ids` are the frames of all scans and speeds so far."""

    frame_ids: dict[str, None]

    def decode(self, raws: Sequence[bytes], times: Sequence[int], note: NoteUnread) -> list[Any]:
        """Decode some messages into chunks in their order, without the messages that cannot be shown.

        Args:
            raws: the messages.
            times: their log times in nanoseconds.
            note: called for each message that cannot be shown.
        """


class Mounts(Protocol):
    """The mounts of scanners; see `recordings._mounts.RecordedMounts`."""

    def mounted(self, scan: Scan, time_ns: int) -> Scan:
        """Return a scan with its angles in the frame of the robot, if its mount is known."""

    def moves(self, frame_id: str) -> bool:
        """Return True if the scanner moves on its robot."""


class TemplateDecoder:
    """A decoder of many messages at a time if they differ only in their numbers, and of all others one by one.

    Subclasses read one message in full, and cut the chunk of the messages that match its template.
    """

    def __init__(self, channel: Channel) -> None:
        self.shape, self.encoding = shape_of(channel), channel.encoding
        self.read = decoder_of(channel)
        self.frame_ids: dict[str, None] = {}
        self._template: MessageTemplate | None = None
        """The message that was read in full last, or None if the next one is to be read in full."""
        # The number of messages that are compared at once: fewer after messages that differed.
        self._look = _FIRST_LOOK

    def decode(self, raws: Sequence[bytes], times: Sequence[int], note: NoteUnread) -> list[Any]:
        """See `Decoder`."""
        chunks = merged(self._chunks(raws, np.array(times, np.int64), note))
        self.frame_ids.update(dict.fromkeys(chunk.frame_id for chunk in chunks))
        return chunks

    def forget(self) -> None:
        """Read the next message in full."""
        self._template = None

    def _chunks(self, raws: Sequence[bytes], times: NDArray[np.int64], note: NoteUnread) -> Iterator[Any]:
        at = 0
        while at < len(raws):
            template = self._template
            if template and len(raws[at]) == template.size:
                rows = _rows(raws[at : at + self._look])
                count = template.count_alike(rows)
                self._look = 4 * self._look if count == len(rows) else _CAREFUL_LOOK
                if count:
                    yield self._cut(template, times[at : at + count], rows[:count])
                    at += count
                    continue
            try:
                self._template, chunk = self._single(raws[at], int(times[at]))
                yield chunk
            except (TypeError, ValueError) as error:
                note(at, error)
            at += 1

    def _single(self, raw: bytes, time_ns: int) -> tuple[MessageTemplate | None, Any]:
        raise NotImplementedError

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> Any:
        raise NotImplementedError


class ScanDecoder(TemplateDecoder):
    """A decoder of LaserScan-like messages into scans, in the angles of the robot if `mounts` has the mount."""

    mounts: Mounts | None = None

    def _single(self, raw: bytes, time_ns: int) -> tuple[MessageTemplate | None, ScanChunk]:
        message = self.read(raw)
        scan = to_scan(message)
        moves = False
        if self.mounts is not None:
            scan = self.mounts.mounted(scan, time_ns)
            moves = self.mounts.moves(scan.frame_id)
        template = None if moves else scan_template(raw, message, scan, self.shape, self.encoding)
        return template, single_scan(scan, time_ns)

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> ScanChunk:
        ranges, intensities = (template.cut(rows, part, np.dtype("<f4")) for part in (template.numbers, template.more))
        one_echo = np.empty((len(rows), 0), object)  # scans with several echoes are read one by one
        return ScanChunk(0, times, template.stamps(rows), ranges, intensities, template.sample, one_echo)


class SpeedDecoder(TemplateDecoder):
    """A decoder of Twist and Odometry-like messages."""

    def _single(self, raw: bytes, time_ns: int) -> tuple[MessageTemplate | None, SpeedChunk]:
        speed = to_speed(self.read(raw))
        return speed_template(raw, speed, self.shape, self.encoding), single_speed(speed, time_ns)

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> SpeedChunk:
        values, poses = (template.cut(rows, part, np.dtype("<f8")) for part in (template.numbers, template.more))
        if template.more:
            x, y, _, *quaternion = poses.T
            poses = np.stack([x, y, yaw_of(*quaternion)], axis=1)
        steering = np.empty((len(rows), 0))  # messages with a steering angle are read one by one
        return SpeedChunk(0, times, template.stamps(rows), values, poses, template.sample.frame_id, steering)


class SampleDecoder:
    """A decoder of messages of any kind, one by one; a message that repeats the previous one is not read again.

    Args:
        channel: the channel of the messages.
        read: makes a sample of a message.
    """

    def __init__(self, channel: Channel, read: Callable[[Any], Any]) -> None:
        self._decode, self._read = decoder_of(channel), read
        # One topic may have messages of many touch sensors, each in its own frame.
        self.frame_ids: dict[str, None] = {}

    def decode(self, raws: Sequence[bytes], times: Sequence[int], note: NoteUnread) -> list[Any]:
        """See `Decoder`."""
        rows: list[int] = []
        samples: list[Any] = []
        before = None
        for i, raw in enumerate(raws):
            if raw != before:
                before = None
                try:
                    sample = self._read(self._decode(raw))
                except (TypeError, ValueError) as error:
                    note(i, error)
                    continue
                before = raw
            rows.append(i)
            samples.append(sample)
        if not rows:
            return []
        column = np.empty(len(rows), object)
        column[:] = samples
        stamps = np.array([getattr(sample, "stamp_ns", None) or 0 for sample in samples], np.int64)
        return [SampleChunk(0, np.array([times[i] for i in rows], np.int64), stamps, column)]


def _rows(raws: Sequence[bytes]) -> Rows:
    """Return the first messages as rows, up to one of another size."""
    size = len(raws[0])
    alike = list(takewhile(lambda raw: len(raw) == size, raws))
    return np.frombuffer(b"".join(alike), np.uint8).reshape(len(alike), size)
