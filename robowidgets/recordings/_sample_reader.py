"""The samples in a source of messages."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from typing import Any, TypeVar

from ..kinds import Kind, is_standard, is_undecided, kind_of_message, kind_of_shape, kinds_of_type
from ..messages.channel import Channel
from ..messages.decoding import ENCODINGS, DecodeError, decoder_of, may_go_on, one_line, shape_of
from ..messages.event import LOG_TYPES, line_level
from ..messages.protobuf import NO_PROTOBUF, has_protobuf
from ..messages.standard import ODOMETRY
from ..notebook.progress import Progress
from ..poses.transforms import TRANSFORMS, Transform, transforms_of
from ..repair import Message, RecordingError, RemoteError, Source
from ..runtime.text import listed, many
from ..samples import Problem
from ..samples.event import Event, Level
from ..samples.staleness import OPEN_END
from ._mounts import RecordedMounts
from .columns._decoders import Decoder, ScanDecoder
from .columns._fields import Fields
from .columns._memory import Memory
from .columns._messages import MessageDecoder
from .columns._store import Store
from .columns.series import Series, series_of
from .events import read_events
from .program_log import TEXT
from .topics import Moment, TimedMessage, Topic

_SHORTEST = 1e-3
_BURST, _BURST_OF_MANY = 1.0, 0.1
"""Seconds within which a few messages, such as those when a node starts, are a burst, and within which many messages
are. A burst has no rate."""
_BURST_SHARE = 0.1
"""A topic whose messages span more than this share of the recording is not a burst, however short the recording is."""
_SHORTEST_LOOK_NS = 1_000_000
_MOST_AT_ONCE = 64
"""Messages that are decoded together while samples are iterated over."""

_FIRST_ONES = 100
"""Messages at the start of a topic that are always read: a value that is published only once is among them."""

_LEAST = 20
"""Messages that a topic needs for a usual step: with fewer, a long pause or a short burst means little."""

_REPAIR = "robowidgets repair writes all that can be read to a file that every tool reads"
_SILENT = "did its node or its sensor start late, or stop early?"
_LEFT_OUT = "see what publishes them"
_OTHER_VERSION = "if another version of {} wrote them, add its files with robowidgets.messages.add_definitions"
"""Definitions from outside the file may be of another version than the one on the robot."""
_LEFT_OVER = "nodes of ROS ignore them, too; if a field is missing, record with the definitions that its publisher has"
_SEVERAL = "do two sensors publish to one topic? Give each its own"

Found = TypeVar("Found")


class Messages:
    """The samples of a recording in the order of their times. A message is decoded when its sample is read.

    Args:
        source: the messages. It is closed with this object.
    """

    def __init__(self, source: Source) -> None:
        self._source = source
        self.start_ns, self.end_ns = source.start_ns, source.end_ns
        self._decoders: dict[int, Decoder] = {}
        self._shown: defaultdict[str, list[Channel]] = defaultdict(list)
        self._kinds: dict[str, tuple[Kind, str]] = {}
        """The kind of each topic, and the message type that decided it."""
        self._left_out: dict[str, Problem] = {}
        self._stopped: list[str] = []
        self._left_over: defaultdict[int, list[str]] = defaultdict(list)
        """Topics by the number of bytes that follow the last field of their messages."""
        self._has_looked = False
        # For each topic, the sample that `last` found last, and a time before which no other one follows: during a long
        # silence the same sample is requested repeatedly.
        self._last: dict[tuple[str, bool], tuple[Moment, int]] = {}
        self._readers: dict[int, MessageDecoder | str] = {}
        """By channel, the reader of its raw messages, or the reason why they cannot be read."""
        self._closed = False
        span_ns = self.start_ns or 0, self.end_ns or 0
        self.mounts = RecordedMounts(source.channels, self._transforms_between, span_ns)
        # Channels without a message last: if a topic has several types, the type of the first message is shown.
        by_count = sorted(source.channels, key=lambda channel: not channel.count)
        found = {channel.id: self._understand(channel) for channel in by_count}
        self.topics = self._list([(channel, *found[channel.id]) for channel in source.channels])
        self._silences = self._about_silences()

    @property
    def problems(self) -> tuple[Problem, ...]:
        """The parts that could not be read so far, each with its remedy."""
        alike: defaultdict[str, list[str]] = defaultdict(list)
        for topic in self.topics:
            if topic.problem and topic.count:
                alike[topic.problem].append(topic.name)
        unread = [f"{listed(names)}: {problem}" for problem, names in alike.items()]
        left_over = [
            f"{listed(names)}: {many(left, 'byte')} after each message that its definition does not describe, ignored"
            for left, names in self._left_over.items()
        ]
        found = (
            (self._source.problems, _REPAIR),
            (unread, ""),
            (self._silences, _SILENT),
            (self._about_frames(), _SEVERAL),
            (self._stopped, _REPAIR),
            (left_over, _LEFT_OVER),
        )
        return (*(Problem(line, remedy) for lines, remedy in found for line in lines), *self._left_out.values())

    def moments(self, topics: Collection[str], start_ns: int | None, stop_ns: int | None) -> Iterator[Moment]:
        """Yield the samples of these topics from ``start_ns`` up to, not including, ``stop_ns``; None is no limit."""
        channels = [channel for topic in topics for channel in self._shown[topic]]
        batch: list[Message] = []
        most = 1
        try:
            for message in self._source.messages(channels, start_ns, stop_ns):
                batch.append(message)
                if len(batch) == most:
                    yield from self._moments(batch)
                    batch, most = [], min(2 * most, _MOST_AT_ONCE)
        except RecordingError as error:
            self._stop(error)
        yield from self._moments(batch)

    def messages(
        self,
        topics: Collection[str],
        start_ns: int | None,
        stop_ns: int | None,
        *,
        every: int = 1,
        is_wanted: Callable[[Message], bool] | None = None,
    ) -> Iterator[TimedMessage]:
        """Yield the messages of topics of any type from ``start_ns`` up to, not including, ``stop_ns``.

        Args:
            topics: names of topics.
            start_ns: the start in nanoseconds, or None.
            stop_ns: the end in nanoseconds, or None.
            every: 2 to read about every second message, and so on; see `Thinning`.
            is_wanted: returns True for a message that is to be read, or None to read all.
        """
        channels = [channel for topic in topics for channel in self._readable(topic)]
        thinning = Thinning(every)
        try:
            for message in self._source.messages(channels, start_ns, stop_ns):
                if thinning.keeps(message[0]) and (is_wanted is None or is_wanted(message)):
                    yield from self._as_messages([message])
        except RecordingError as error:
            self._stop(error)

    def events(self, topics: Collection[str], stop_ns: int | None, every_line: int = 1) -> Iterator[tuple[int, Event]]:
        """Return the events of topics up to, not including, a time, each with its time and roughly in order.

        Of log lines below a warning, only every ``every_line``-th is read, or none if it is 0.
        """
        lines: defaultdict[int, int] = defaultdict(int)

        def is_wanted(message: Message) -> bool:
            channel, _, raw = message
            if channel.type not in LOG_TYPES or line_level(channel.type, channel.encoding, raw) >= Level.WARN:
                return True
            lines[channel.id] += 1
            return every_line > 0 and (lines[channel.id] - 1) % every_line == 0

        wanted = None if every_line == 1 else is_wanted
        return read_events(self.messages(topics, None, stop_ns, is_wanted=wanted), self._note_left_out)

    def fields(self, topic: str, memory: Memory) -> Fields:
        """Return the messages of a topic as columns of their fields.

        If the topic has several types, the type that decided its kind is read, or else the type of the first channel
        with a message.
        """
        channels = sorted(self._readable(topic), key=lambda channel: not channel.count)
        of_kind = self._kinds[topic][1] if topic in self._kinds else channels[0].type
        first = next(channel for channel in channels if channel.type == of_kind)
        decoders = {channel.id: self._reader(channel) for channel in channels}
        alike = [channel for channel in channels if _is_alike(decoders[channel.id], decoders[first.id])]
        for other in channels:
            if other not in alike and other.count:
                another = "another definition of it" if other.type == first.type else other.type
                line = f"{topic}: the columns have the fields of {first.type}; messages of {another} are left out"
                self._left_out.setdefault(f"{topic} as {other.type}", Problem(line, _LEFT_OUT))
        own = {channel.id: decoders[channel.id] for channel in alike if not isinstance(decoders[channel.id], str)}
        return Fields(Store(self._source, alike, own, memory, self._note, self._stop), self.start_ns or 0)  # type: ignore[arg-type]

    @property
    def publishers(self) -> dict[str, tuple[str, ...]]:
        """The names of the nodes that published each topic, if the file has them."""
        found: defaultdict[str, dict[str, None]] = defaultdict(dict)
        for channel in self._source.channels:
            found[channel.topic].update(dict.fromkeys(channel.callers))
        return {topic: tuple(sorted(names)) for topic, names in found.items()}

    def why_unreadable(self, topic: str) -> str:
        """Return the reason why no message of a topic can be read, or an empty text if they can be read."""
        channels = [channel for channel in self._source.channels if channel.topic == topic]
        if self._readable(topic):
            return ""
        return next((why for channel in channels if isinstance(why := self._reader(channel), str)), "")

    def last(self, topic: str, time_ns: int, *, as_messages: bool = False) -> Moment | None:
        """Return the last sample or message of a topic at or before a time, or None before the first."""
        channels = self._readable(topic) if as_messages else self._shown[topic]
        read, key = (self._as_messages if as_messages else self._moments), (topic, as_messages)
        count = sum(channel.count for channel in channels)
        if not count or self.start_ns is None or self.end_ns is None:
            return None
        stop = min(time_ns, self.end_ns) + 1
        before, until = self._last.get(key, (None, stop))
        if before is None or before.time_ns >= stop:
            before, until = None, self.start_ns
        look = max(2 * (self.end_ns - self.start_ns) // count, _SHORTEST_LOOK_NS)
        begin = stop
        while begin > until:
            begin, end = max(begin - look, until), begin
            try:
                found = list(self._source.messages(channels, begin, end))
            except RecordingError as error:
                self._stop(error)
                return None
            moments = (moment for message in reversed(found) for moment in read([message]))
            if (last := next(moments, None)) is not None:
                self._last[key] = last, stop
                return last
            look *= 4
        if before is not None:
            self._last[key] = before, max(until, stop)
        return before

    def series(self, topic: str, memory: Memory) -> Series[Any]:
        """Return the samples of a topic as columns."""
        channels = self._shown[topic]
        store: Store = Store(self._source, channels, self._decoders, memory, self._note, self._stop)
        series: Series[Any] = series_of(self._kinds[topic][0])(store, self.start_ns or 0)
        return series

    def transforms(self, every: int = 1, odometry: bool = True) -> Iterator[Transform]:
        """Yield the transforms of tf and odometry in the order of time, from about every ``every``-th message."""
        channels = [channel for channel in self._transforming if odometry or channel.type != ODOMETRY]
        return self._read(channels, transforms_of, "Reading where the robot was", every)

    @property
    def transform_count(self) -> int:
        """The number of messages that `transforms` reads."""
        return sum(channel.count for channel in self._transforming)

    @property
    def _transforming(self) -> list[Channel]:
        return [channel for channel in self._source.channels if channel.type in (ODOMETRY, *TRANSFORMS)]

    def forget_scans(self) -> None:
        """Make the next scans be read again with their new mount."""
        self._last.clear()
        for decoder in self._decoders.values():
            if isinstance(decoder, ScanDecoder):
                decoder.forget()

    def _transforms_between(
        self, channels: Sequence[Channel], start_ns: int | None, stop_ns: int | None
    ) -> Iterator[Transform]:
        """Yield the transforms of tf between two times; a message without a pose is left out and noted."""
        channels = [channel for channel in channels if channel.encoding in ENCODINGS]
        try:
            decoders = {channel.id: decoder_of(channel) for channel in channels}
            for channel, time_ns, raw in self._source.messages(channels, start_ns, stop_ns):
                try:
                    yield from transforms_of(decoders[channel.id](raw), channel.topic, time_ns)
                except ValueError as error:  # noqa: PERF203  # the other messages still count
                    self._note(channel, time_ns, error)
        except (RecordingError, ValueError) as error:
            self._stop(error)

    def texts(self, is_wanted: Callable[[str], bool]) -> Iterator[tuple[str, float, str]]:
        """Yield topic, seconds and text of the ``std_msgs/String`` messages on some topics, in the order of time."""
        channels = [channel for channel in self._source.channels if channel.type == TEXT and is_wanted(channel.topic)]
        return self._read(
            channels, lambda message, topic, time_ns: [(topic, self._seconds(time_ns), message.data)], "Reading texts"
        )

    def size_of(self, topic: str) -> int:
        """Return the number of bytes to read for all messages of a topic, or 0 if it is unknown."""
        return self._source.size_of([channel for channel in self._source.channels if channel.topic == topic])

    def close(self) -> None:
        """Close the file; closing it again does nothing."""
        self._closed = True
        self._source.close()

    def check_topics(self) -> None:
        """Read the first message of each topic once, so that `problems` has the reasons for unreadable topics."""
        if self._has_looked or self._closed:
            return
        self._has_looked = True
        problems: dict[tuple[str, str], str] = {}
        for channel in self._source.channels:
            reader = self._reader(channel) if channel.count else ""
            if isinstance(reader, str):
                problems.setdefault((channel.topic, channel.type), reader)
                continue
            try:
                first = next(self._source.messages([channel]), None)
                if first is not None:
                    self._check(reader, first)
            except RecordingError as error:
                self._stop(error)
        self.topics = tuple(
            topic if topic.problem else topic._replace(problem=problems.get((topic.name, topic.type), ""))
            for topic in self.topics
        )

    def _check(self, reader: MessageDecoder, message: Message) -> None:
        """Note a problem of a message of a channel, and bytes that its definition does not describe."""
        channel, time_ns, raw = message
        try:
            left = reader.left_over(raw)
        except ValueError as error:
            self._note(channel, time_ns, error)
            return
        if left:
            self._left_over[left].append(channel.topic)
        if channel.id in self._decoders and channel in self._shown[channel.topic]:
            list(self._moments([message]))

    def _understand(self, channel: Channel) -> tuple[Kind | None, str]:
        """Make the decoder of a channel; return its kind, and the reason if it cannot be read."""
        if why := self._why_encoding(channel):
            return None, why
        kinds = kinds_of_type(channel.type)
        if not kinds and is_standard(channel.type):
            return None, ""
        try:
            if is_undecided(channel.type):
                kind = self._decided(channel)
            else:
                kind = kinds[0] if kinds else kind_of_shape(shape_of(channel))
            if kind is None:
                return None, ""
            decoder = series_of(kind).decoder(channel, kind)
            if isinstance(decoder, ScanDecoder):
                decoder.mounts = self.mounts
            self._decoders[channel.id] = decoder
        except ValueError as error:
            return None, str(error)
        first, type_name = self._kinds.setdefault(channel.topic, (kind, channel.type))
        if first is not kind:
            return None, f"its messages of {type_name} are shown, messages of {channel.type} are left out"
        self._shown[channel.topic].append(channel)
        return kind, ""

    def _decided(self, channel: Channel) -> Kind | None:
        """Return the kind of a channel whose type has several kinds, from its first message."""
        decode = decoder_of(channel)
        try:
            first = next(self._source.messages([channel]), None)
            return kind_of_message(decode(first[2]), channel.type) if first else None
        except RemoteError:
            raise
        except (RecordingError, ValueError):
            return None

    def _read(
        self, channels: Sequence[Channel], read: Callable[[Any, str, int], Iterable[Found]], what: str, every: int = 1
    ) -> Iterator[Found]:
        """Yield the results of a function that takes a message that is not a sample, its topic and its time."""
        channels = [channel for channel in channels if channel.encoding in ENCODINGS]
        thinning = Thinning(every)
        try:
            decoders = {channel.id: decoder_of(channel) for channel in channels}
            with Progress(sum(channel.count for channel in channels), what) as bar:
                for channel, time_ns, raw in self._source.messages(channels):
                    bar.update(1)
                    if not thinning.keeps(channel):
                        continue
                    try:
                        yield from read(decoders[channel.id](raw), channel.topic, time_ns)
                    except ValueError as error:
                        self._note(channel, time_ns, error)
        except (RecordingError, ValueError) as error:
            self._stop(error)

    def _list(self, found: list[tuple[Channel, Kind | None, str]]) -> tuple[Topic, ...]:
        """Return the topics of channels, with their kinds and the reasons why they cannot be read."""
        by_topic: defaultdict[tuple[str, str], list[tuple[Channel, Kind | None, str]]] = defaultdict(list)
        for one in found:
            by_topic[one[0].topic, one[0].type].append(one)
        topics = []
        for (name, type_name), own in by_topic.items():
            channels = [channel for channel, _, _ in own]
            kind = next((kind for _, kind, _ in own if kind), None)
            topics.append(
                Topic(
                    name,
                    type_name,
                    count=sum(channel.count for channel in channels),
                    rate=self._rate(channels),
                    widget=kind.name if kind else None,
                    commanded=kind is not None and kind.is_command(name, type_name),
                    problem=next((problem for _, _, problem in own if problem), ""),
                )
            )
        return tuple(topics)

    def _rate(self, channels: Sequence[Channel]) -> float | None:
        """Return the mean rate of the messages of these channels, from the first to the last, or None for a burst."""
        count = sum(channel.count for channel in channels)
        if count < 2:
            return None
        first, last = self._span(channels)
        whole = self._seconds(self.end_ns or 0)
        burst = _BURST if count < _LEAST else max(_SHORTEST, min(_BURST_OF_MANY, _BURST_SHARE * whole))
        return (count - 1) / (last - first) if last - first >= burst else None

    def _about_silences(self) -> list[str]:
        """Return lines on topics that begin late or end early, but not on touches and commands, which may be silent."""
        lines: list[str] = []
        for topic, channels in self._shown.items():
            kind, type_name = self._kinds[topic]
            count = sum(channel.count for channel in channels)
            if count >= _LEAST and kind.goes_stale and not kind.is_command(topic, type_name):
                lines += silences(topic, count, *self._span(channels), self._seconds(self.end_ns or 0))
        return lines

    def _about_frames(self) -> Iterator[str]:
        """Yield lines on topics whose messages, of those read so far, have several coordinate frames."""
        for topic, channels in self._shown.items():
            kind, type_name = self._kinds[topic]
            # Copied, because another thread may be reading messages of a further frame.
            found = [name or "(empty)" for channel in channels for name in [*self._decoders[channel.id].frame_ids]]
            names = list(dict.fromkeys(found))
            if len(names) > 1 and not kind.is_command(topic, type_name):
                yield f"{topic}: {kind.noun} of {many(len(names), 'frame')}: {listed(names)}"

    def _span(self, channels: Sequence[Channel]) -> tuple[float, float]:
        """Return seconds of the first and the last message of these channels, or of the recording without an index."""
        known = [span for channel in channels if channel.count and (span := self._source.span_ns(channel))]
        first = min((span[0] for span in known), default=self.start_ns or 0)
        last = max((span[1] for span in known), default=self.end_ns or 0)
        return self._seconds(first), self._seconds(last)

    def _moments(self, messages: Sequence[Message]) -> Iterator[Moment]:
        """Yield the samples in some messages, in their order."""
        by_channel: defaultdict[int, list[int]] = defaultdict(list)
        for place, message in enumerate(messages):
            by_channel[message[0].id].append(place)
        samples: dict[int, Any] = {}
        for number, places in by_channel.items():
            left_out: set[int] = set()

            def note(i: int, error: Exception, places: list[int] = places, left_out: set[int] = left_out) -> None:
                left_out.add(places[i])
                self._note(*messages[places[i]][:2], error)

            raws, times = [messages[i][2] for i in places], [messages[i][1] for i in places]
            chunks = self._decoders[number].decode(raws, times, note)
            decoded = (chunk.sample(row) for chunk in chunks for row in range(len(chunk)))
            samples.update(zip((place for place in places if place not in left_out), decoded, strict=True))
        for place, sample in sorted(samples.items()):
            channel, time_ns, _ = messages[place]
            yield Moment(channel.topic, time_ns, sample, self._seconds(time_ns))

    def _as_messages(self, messages: Sequence[Message]) -> Iterator[TimedMessage]:
        """Yield some messages as they are, without those that do not match their type."""
        for channel, time_ns, raw in messages:
            reader = self._reader(channel)
            assert not isinstance(reader, str)
            try:
                message = reader.read(raw)
            except ValueError as error:
                self._note(channel, time_ns, error)
                continue
            yield TimedMessage(channel.topic, time_ns, message, self._seconds(time_ns))

    def _readable(self, topic: str) -> list[Channel]:
        """Return the channels of a topic whose messages can be read."""
        channels = [channel for channel in self._source.channels if channel.topic == topic]
        return [channel for channel in channels if not isinstance(self._reader(channel), str)]

    def _reader(self, channel: Channel) -> MessageDecoder | str:
        if channel.id not in self._readers:
            try:
                self._readers[channel.id] = self._why_encoding(channel) or MessageDecoder(channel)
            except ValueError as error:
                self._readers[channel.id] = str(error)
        return self._readers[channel.id]

    def _why_encoding(self, channel: Channel) -> str:
        """Return the reason why the encoding of a channel cannot be read, or an empty text if it can be read."""
        if channel.encoding in ENCODINGS:
            return ""
        if channel.encoding == "protobuf" and not has_protobuf():
            return NO_PROTOBUF
        return f"its messages are encoded as {channel.encoding!r}: expected {' or '.join(ENCODINGS)}"

    def _note(self, channel: Channel, time_ns: int, error: Exception) -> None:
        is_other_version = isinstance(error, DecodeError) and not may_go_on(channel)
        remedy = _OTHER_VERSION.format(channel.type.partition("/")[0]) if is_other_version else _LEFT_OUT
        self._note_left_out(channel.topic, time_ns, error, remedy)

    def _note_left_out(self, topic: str, time_ns: int, error: Exception, remedy: str = _LEFT_OUT) -> None:
        if topic not in self._left_out:
            self._left_out[topic] = Problem(
                f"{topic}: messages that cannot be shown are left out, the first at "
                f"{self._seconds(time_ns):.2f} s: {one_line(error)}",
                remedy,
            )

    def _seconds(self, time_ns: int) -> float:
        return (time_ns - (self.start_ns or 0)) / 1e9

    def _stop(self, error: Exception) -> None:
        """Note that the file can be read no further; raise the error instead if the file was closed, or is remote."""
        if self._closed or isinstance(error, RemoteError):
            raise error
        line = f"the file can be read no further: {one_line(error)}"
        if line not in self._stopped:
            self._stopped.append(line)


class Thinning:
    """Chooses messages of each channel: the first hundred, the last one, and about every second, third and so on.

    The others are chosen without a rhythm, because messages of several publishers may alternate on a topic. The choice
    is always the same.

    Args:
        every: one message is chosen of this many.
    """

    def __init__(self, every: int) -> None:
        self._every = every
        self._numbers: defaultdict[int, int] = defaultdict(int)

    def keeps(self, channel: Channel) -> bool:
        """Return True if the next message of a channel is chosen."""
        if self._every <= 1:
            return True
        number = self._numbers[channel.id]
        self._numbers[channel.id] = number + 1
        # Multiples of the golden ratio: their bits have no rhythm that a robot could have, too.
        scattered = (number * 0x9E3779B1 & 0xFFFFFFFF) >> 8
        return number < _FIRST_ONES or number + 1 == channel.count or scattered % self._every == 0


def _is_alike(one: MessageDecoder | str, other: MessageDecoder | str) -> bool:
    """Return True if two channels have messages with the same fields."""
    if isinstance(one, str) or isinstance(other, str):
        return False
    return one.type == other.type and one.leaves == other.leaves


def silences(topic: str, count: int, first: float, last: float, end: float) -> list[str]:
    """Return lines on a topic that begins long after its recording does, or ends long before it.

    Long is more than 5 s, and more than ten times the mean time between two messages of the topic.

    Args:
        topic: the name of the topic.
        count: the number of its messages, more than one.
        first: seconds of the first message from the start of the recording.
        last: seconds of the last message.
        end: seconds of the end of the recording.
    """
    long = OPEN_END.after((last - first) / (count - 1))
    before = [f"{topic}: nothing before {first:.2f} s of {end:.2f} s"] * (first > long)
    return [*before, *[f"{topic}: nothing after {last:.2f} s of {end:.2f} s"] * (end - last > long)]
