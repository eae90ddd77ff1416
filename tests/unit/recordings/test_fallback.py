"""A source over a file that looks complete, and a repaired source that takes over at the first damage."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import pytest

from robowidgets.files._fallback import FallbackSource
from robowidgets.messages.channel import Channel
from robowidgets.repair import Message, RecordingError

SCAN = Channel(7, "/scan", "sensor_msgs/msg/LaserScan", "cdr", "", 5)
SPEED = Channel(8, "/odom", "nav_msgs/msg/Odometry", "cdr", "", 5)


class Held:
    """A source over messages in memory that breaks at one of them."""

    def __init__(self, messages: list[Message], breaks_at: int | None = None, problems: tuple[str, ...] = ()) -> None:
        self.messages_held, self.breaks_at, self.problems = messages, breaks_at, problems
        self.channels = tuple(dict.fromkeys(channel for channel, _, _ in messages))
        self.start_ns, self.end_ns = messages[0][1], messages[-1][1]
        self.closed = 0

    def messages(
        self, channels: Collection[Channel], start_ns: int | None = None, stop_ns: int | None = None
    ) -> Iterator[Message]:
        for number, (channel, time_ns, raw) in enumerate(self.messages_held):
            if number == self.breaks_at:
                raise AssertionError("damage in the middle")
            if channel in channels and (start_ns or 0) <= time_ns < (stop_ns or 10**9):
                yield channel, time_ns, raw

    def span_ns(self, channel: Channel) -> tuple[int, int] | None:
        if self.breaks_at is not None:
            raise AssertionError("damage in the index")
        times = [time_ns for other, time_ns, _ in self.messages_held if other == channel]
        return times[0], times[-1]

    def close(self) -> None:
        self.closed += 1


def held(scan: Channel = SCAN, speed: Channel = SPEED) -> list[Message]:
    return [(scan, 1, b"a"), (speed, 2, b"b"), (scan, 2, b"c"), (scan, 2, b"d"), (speed, 3, b"e"), (scan, 4, b"f")]


@pytest.mark.parametrize("breaks_at", [None, 0, 1, 2, 3, 4, 5])
def test_every_message_comes_once_wherever_the_first_one_breaks(breaks_at: int | None) -> None:
    repaired = Held(held(SCAN._replace(id=1), SPEED._replace(id=2)))
    source = FallbackSource(Held(held(), breaks_at), lambda: repaired)
    assert list(source.messages([SCAN, SPEED])) == held()
    assert list(source.messages([SCAN, SPEED])) == held()


@pytest.mark.parametrize("breaks_at", [None, 0, 3, 5])
def test_a_part_of_the_time_and_of_the_topics_stays_that_part(breaks_at: int | None) -> None:
    source = FallbackSource(Held(held(), breaks_at), lambda: Held(held(SCAN._replace(id=1))))
    assert [raw for _, _, raw in source.messages([SCAN], 2, 4)] == [b"c", b"d"]


def test_the_repaired_one_is_opened_only_when_it_is_needed() -> None:
    def refuse() -> Held:
        raise AssertionError("opened without need")

    assert len(list(FallbackSource(Held(held()), refuse).messages([SCAN, SPEED]))) == 6


def test_a_file_that_is_read_in_turns_is_repaired_once() -> None:
    opened: list[Held] = []

    def repair() -> Held:
        opened.append(Held(held()))
        return opened[-1]

    source = FallbackSource(Held(held(), 2), repair)
    for messages in zip(source.messages([SCAN, SPEED]), source.messages([SCAN, SPEED]), strict=True):
        assert messages[0] == messages[1]
    source.close()
    assert [repaired.closed for repaired in opened] == [1]


def test_what_is_wrong_is_reported_once_it_is_known() -> None:
    source = FallbackSource(Held(held(), 2), lambda: Held(held(), problems=("damaged in 1 place",)))
    assert source.problems == ()
    list(source.messages([SCAN]))
    assert source.problems == ("damaged in 1 place",)


def test_when_the_repaired_one_cannot_help_its_reason_is_given() -> None:
    def refuse() -> Held:
        raise RecordingError("nothing can be saved")

    messages = FallbackSource(Held(held(), 2), refuse).messages([SCAN, SPEED])
    assert [next(messages)[2], next(messages)[2]] == [b"a", b"b"]
    with pytest.raises(RecordingError, match="nothing can be saved"):
        next(messages)


def test_an_index_that_is_damaged_tells_no_span() -> None:
    assert FallbackSource(Held(held()), lambda: Held(held())).span_ns(SPEED) == (2, 3)
    assert FallbackSource(Held(held(), 2), lambda: Held(held())).span_ns(SPEED) is None


def test_closing_closes_both() -> None:
    first, repaired = Held(held(), 2), Held(held())
    source = FallbackSource(first, lambda: repaired)
    list(source.messages([SCAN]))
    source.close()
    assert (first.closed, repaired.closed) == (1, 1)


def test_a_source_that_is_closed_meanwhile_is_not_opened_again() -> None:
    def refuse() -> Held:
        raise AssertionError("opened after it was closed")

    source = FallbackSource(Held(held(), 2), refuse)
    messages = source.messages([SCAN, SPEED])
    next(messages)
    source.close()
    next(messages)
    with pytest.raises(RecordingError, match="is closed"):
        next(messages)
