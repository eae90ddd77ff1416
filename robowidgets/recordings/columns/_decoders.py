"""Decoding the messages of one channel into chunks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from itertools import takewhile
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from ...messages import to_scan, to_speed
from ...messages.channel import Channel
from ...messages.decoding import decoder_of
from ...messages.layout import Layout, Layouts, Rows, as_rows
from ...samples import Scan, Speed, yaw_of
from ._template import MessageTemplate, scan_template, speed_template
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

    make_template: Callable[[bytes, Any, Layout], MessageTemplate | None]

    def __init__(self, channel: Channel) -> None:
        self.read = decoder_of(channel)
        self.frame_ids: dict[str, None] = {}
        self._layouts = Layouts(channel)
        self._last: tuple[bytes, Any] | None = None
        """The message that was read in full last, with its sample, until it is the template."""
        self._template: MessageTemplate | None = None
        # The number of messages that are compared at once: fewer after messages that differed.
        self._look = _FIRST_LOOK

    def decode(self, raws: Sequence[bytes], times: Sequence[int], note: NoteUnread) -> list[Any]:
        """See `Decoder`."""
        chunks = merged(self._chunks(raws, np.array(times, np.int64), note))
        self.frame_ids.update(dict.fromkeys(chunk.frame_id for chunk in chunks))
        return chunks

    def forget(self) -> None:
        """Read the next message in full."""
        self._last = self._template = None

    def _chunks(self, raws: Sequence[bytes], times: NDArray[np.int64], note: NoteUnread) -> Iterator[Any]:
        at = 0
        while at < len(raws):
            template = self._template_for(raws[at])
            if template:
                rows = _rows(raws[at : at + self._look])
                count = template.count_alike(rows)
                self._look = 4 * self._look if count == len(rows) else _CAREFUL_LOOK
                if count:
                    yield self._cut(template, times[at : at + count], rows[:count])
                    at += count
                    continue
            try:
                sample, chunk = self._single(raws[at], int(times[at]))
                self._last, self._template = None if sample is None else (raws[at], sample), None
                yield chunk
            except (TypeError, ValueError) as error:
                note(at, error)
            at += 1

    def _template_for(self, raw: bytes) -> MessageTemplate | None:
        """Return the template of messages of this size, if the last one that was read in full had this size too."""
        if self._last is not None and len(self._last[0]) == len(raw):
            self._template = self.make_template(*self._last, self._layouts.of(self._last[0]))
            self._last = None
        return self._template if self._template and self._template.size == len(raw) else None

    def _single(self, raw: bytes, time_ns: int) -> tuple[Any, Any]:
        """Read a message in full. Return its sample, or None if later messages cannot repeat it, and its chunk."""
        raise NotImplementedError

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> Any:
        raise NotImplementedError


class ScanDecoder(TemplateDecoder):
    """A decoder of LaserScan-like messages into scans, in the angles of the robot if `mounts` has the mount."""

    mounts: Mounts | None = None
    make_template = staticmethod(scan_template)

    def _single(self, raw: bytes, time_ns: int) -> tuple[Scan | None, ScanChunk]:
        scan = to_scan(self.read(raw))
        moves = False
        if self.mounts is not None:
            scan = self.mounts.mounted(scan, time_ns)
            moves = self.mounts.moves(scan.frame_id)
        return None if moves or scan.echoes else scan, single_scan(scan, time_ns)

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> ScanChunk:
        ranges, intensities = (template.cut(rows, part, "<f4") for part in ("ranges", "intensities"))
        one_echo = np.empty((len(rows), 0), object)  # scans with several echoes are read one by one
        return ScanChunk(0, times, template.stamps(rows), ranges, intensities, template.sample, one_echo)


class SpeedDecoder(TemplateDecoder):
    """A decoder of Twist and Odometry-like messages."""

    make_template = staticmethod(speed_template)

    def _single(self, raw: bytes, time_ns: int) -> tuple[Speed, SpeedChunk]:
        speed = to_speed(self.read(raw))
        return speed, single_speed(speed, time_ns)

    def _cut(self, template: MessageTemplate, times: NDArray[np.int64], rows: Rows) -> SpeedChunk:
        values, poses = (template.cut(rows, part, "<f8") for part in ("twist", "pose"))
        if poses.size:
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
    return as_rows(list(takewhile(lambda raw: len(raw) == size, raws)))
