"""The samples in a file of messages."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterator
from typing import Any

from .._core.progress import Progress
from .._core.text import listed
from ..kinds import Widget, is_command, is_standard, widget_by_shape, widget_by_type
from ..messages.decoding import ENCODINGS, decoder_of, one_line, shape_of
from ..messages.touch import to_touch
from ..poses.transforms import ODOMETRY, TRANSFORMS, Joint, joints_of
from ..repair.source import Channel, RecordingError, Source, latest
from .columns import TouchColumns, scan_columns, speed_columns
from .endings import LEAST, about_end
from .quick import ScanReader, SpeedReader
from .raw_feed import RawFeed
from .timeline import Moment, Sample, Topic

Read = Callable[[bytes], Sample]

_RANGE = "sensor_msgs/msg/Range"
_SHORTEST = 1e-3
_SHORTEST_LOOK_NS = 1_000_000


class MessageTimeline:
    """See `Timeline`. Every message is read when it is asked for."""

    def __init__(self, source: Source) -> None:
        self._source = source
        self.start_ns, self.end_ns = source.start_ns, source.end_ns
        self._reads: dict[int, Read] = {}
        self._shown: defaultdict[str, list[Channel]] = defaultdict(list)
        self._widgets: dict[str, tuple[Widget, str]] = {}
        """By the name of a topic its widget, and the type that it is picked for."""
        self._left_out: dict[str, str] = {}
        self._stopped: list[str] = []
        # Those without a message last: of several types of a topic, the first that came is shown.
        found = {c.id: self._understand(c) for c in sorted(source.channels, key=lambda channel: not channel.count)}
        self.topics = self._list([(channel, *found[channel.id]) for channel in source.channels])
        self._ended = self._about_ends()

    @property
    def problems(self) -> tuple[str, ...]:
        """See `Timeline`."""
        alike: defaultdict[str, list[str]] = defaultdict(list)
        for topic in self.topics:
            if topic.problem and topic.count:
                alike[topic.problem].append(topic.name)
        unread = [f"{listed(names)}: {problem}" for problem, names in alike.items()]
        return (*self._source.problems, *unread, *self._ended, *self._stopped, *self._left_out.values())

    def moments(self, topics: Collection[str], start_ns: int | None, stop_ns: int | None) -> Iterator[Moment]:
        """See `Timeline`."""
        channels = [channel for topic in topics for channel in self._shown[topic]]
        try:
            for message in self._source.messages(channels, start_ns, stop_ns):
                if moment := self._moment(*message):
                    yield moment
        except RecordingError as error:
            self._stop(error)

    def last(self, topic: str, time_ns: int) -> Moment | None:
        """See `Timeline`."""
        channels = self._shown[topic]
        count = sum(channel.count for channel in channels)
        if not count or self.start_ns is None or self.end_ns is None:
            return None
        stop = min(time_ns, self.end_ns) + 1
        look = max(2 * (self.end_ns - self.start_ns) // count, _SHORTEST_LOOK_NS)
        while stop > self.start_ns:
            begin = max(stop - look, self.start_ns)
            try:
                found = sorted(self._source.messages(channels, begin, stop), key=lambda message: message[1])
            except RecordingError as error:
                self._stop(error)
                return None
            for message in reversed(found):
                if moment := self._moment(*message):
                    return moment
            stop, look = begin, 4 * look
        return None

    def feed(self, topic: str) -> RawFeed[Any]:
        """See `Timeline`."""
        channels = self._shown[topic]
        columns = {channel.id: self._columns(channel) for channel in channels}
        return RawFeed(self._source, channels, columns, self._note, self._stop)

    def joints(self) -> Iterator[Joint]:
        """See `Timeline`."""
        channels = [c for c in self._source.channels if c.type in (ODOMETRY, *TRANSFORMS) and c.encoding in ENCODINGS]
        try:
            decoders = {channel.id: decoder_of(channel) for channel in channels}
            with Progress(sum(channel.count for channel in channels), "Reading where the robot was") as bar:
                for channel, time_ns, raw in self._source.messages(channels):
                    yield from self._joints(channel, time_ns, decoders[channel.id], raw)
                    bar.update(1)
        except RecordingError as error:
            self._stop(error)

    def close(self) -> None:
        """See `Timeline`."""
        self._source.close()

    def _columns(self, channel: Channel) -> Any:
        read = self._reads[channel.id]
        if isinstance(read, ScanReader):
            return scan_columns(read)
        return speed_columns(read) if isinstance(read, SpeedReader) else TouchColumns(read)  # type: ignore[arg-type]

    def _understand(self, channel: Channel) -> tuple[Widget | None, str]:
        """The widget for a channel, whose reader is made, and why it cannot be read."""
        if channel.encoding not in ENCODINGS:
            return None, f"its messages are encoded as {channel.encoding!r}: expected {' or '.join(ENCODINGS)}"
        widget = widget_by_type(channel.type)
        if widget is None and is_standard(channel.type):
            return None, ""
        try:
            shape = shape_of(channel)
            widget = widget or widget_by_shape(shape)
            decode = decoder_of(channel)
        except RecordingError as error:
            return None, str(error)
        if widget == "laser":
            self._reads[channel.id] = ScanReader(decode, shape, channel.encoding)
        elif widget == "speed":
            self._reads[channel.id] = SpeedReader(decode, shape, channel.encoding)
        elif widget == "touch":
            self._reads[channel.id] = lambda raw: to_touch(decode(raw))
            if channel.type == _RANGE and not self._speaks(channel):
                return None, ""
        if widget:
            first = self._widgets.setdefault(channel.topic, (widget, channel.type))
            if first[0] != widget:
                return None, f"its messages of {first[1]} are shown, those of {channel.type} are left out"
            self._shown[channel.topic].append(channel)
        return widget, ""

    def _speaks(self, channel: Channel) -> bool:
        """Whether a Range says if something is there: some measure distance, and only a message tells which."""
        for _, _, raw in self._source.messages([channel]):
            try:
                self._reads[channel.id](raw)
            except (RecordingError, ValueError):
                return False
            return True
        return False

    def _list(self, found: list[tuple[Channel, Widget | None, str]]) -> tuple[Topic, ...]:
        topics: dict[tuple[str, str], Topic] = {}
        for channel, widget, problem in found:
            key = (channel.topic, channel.type)
            told = topics.get(key) or Topic(*key, 0, None, widget, widget == "speed" and is_command(channel.topic), "")
            topics[key] = told._replace(
                count=told.count + channel.count, widget=told.widget or widget, problem=told.problem or problem
            )
        seconds = ((self.end_ns or 0) - (self.start_ns or 0)) / 1e9
        if seconds < _SHORTEST:
            return tuple(topics.values())
        return tuple(t._replace(rate=(t.count - 1) / seconds) if t.count > 1 else t for t in topics.values())

    def _about_ends(self) -> tuple[str, ...]:
        """Lines about topics that end early: of touches and commands none can, they may be silent for long."""
        lines = []
        for topic, channels in self._shown.items():
            count = sum(channel.count for channel in channels)
            if count < LEAST or self._widgets[topic][0] == "touch" or is_command(topic):
                continue
            last = latest(self._source.last_ns(channel) for channel in channels if channel.count)
            if last is not None and self.start_ns is not None and self.end_ns is not None:
                lines.append(about_end(topic, count, last, self.start_ns, self.end_ns))
        return tuple(filter(None, lines))

    def _joints(self, channel: Channel, time_ns: int, decode: Callable[[bytes], Any], raw: bytes) -> list[Joint]:
        try:
            return list(joints_of(decode(raw), channel.topic, time_ns))
        except (RecordingError, ValueError) as error:
            self._note(channel, time_ns, error)
            return []

    def _moment(self, channel: Channel, time_ns: int, raw: bytes) -> Moment | None:
        try:
            return Moment(channel.topic, time_ns, self._reads[channel.id](raw), self._seconds(time_ns))
        except (RecordingError, TypeError, ValueError) as error:
            self._note(channel, time_ns, error)
            return None

    def _note(self, channel: Channel, time_ns: int, error: Exception) -> None:
        if channel.topic not in self._left_out:
            self._left_out[channel.topic] = (
                f"{channel.topic}: messages that cannot be shown are left out, the first at "
                f"{self._seconds(time_ns):.2f} s: {one_line(error)}"
            )

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - (self.start_ns or 0)) / 1e9

    def _stop(self, error: RecordingError) -> None:
        line = f"the file can be read no further: {one_line(error)}"
        if line not in self._stopped:
            self._stopped.append(line)
