"""A quick source, and a patient one that goes on where it fails."""

from __future__ import annotations

from collections.abc import Collection, Iterator

import pytest
from robowidgets.recordings.relay import Relay

from robowidgets.repair.source import Channel, RecordingError

SCAN = Channel(7, "/scan", "sensor_msgs/msg/LaserScan", "cdr", "", 5)
SPEED = Channel(8, "/odom", "nav_msgs/msg/Odometry", "cdr", "", 5)
Message = tuple[Channel, int, bytes]


class Held:
    """A source over messages in memory, that breaks at one of them."""

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
                raise AssertionError("rosbags stumbles")
            if channel in channels and (start_ns or 0) <= time_ns < (stop_ns or 10**9):
                yield channel, time_ns, raw

    def close(self) -> None:
        self.closed += 1


def held(scan: Channel = SCAN, speed: Channel = SPEED) -> list[Message]:
    return [(scan, 1, b"a"), (speed, 2, b"b"), (scan, 2, b"c"), (scan, 2, b"d"), (speed, 3, b"e"), (scan, 4, b"f")]


@pytest.mark.parametrize("breaks_at", [None, 0, 1, 2, 3, 4, 5])
def test_every_message_comes_once_wherever_the_quick_one_breaks(breaks_at: int | None) -> None:
    patient = Held(held(SCAN._replace(id=1), SPEED._replace(id=2)))
    relay = Relay(Held(held(), breaks_at), lambda: patient)
    assert list(relay.messages([SCAN, SPEED])) == held()
    assert list(relay.messages([SCAN, SPEED])) == held()


@pytest.mark.parametrize("breaks_at", [None, 0, 3, 5])
def test_a_part_of_the_time_and_of_the_topics_stays_that_part(breaks_at: int | None) -> None:
    relay = Relay(Held(held(), breaks_at), lambda: Held(held(SCAN._replace(id=1))))
    assert [raw for _, _, raw in relay.messages([SCAN], 2, 4)] == [b"c", b"d"]


def test_the_patient_one_is_opened_only_when_it_is_needed() -> None:
    def refuse() -> Held:
        raise AssertionError("opened without need")

    assert len(list(Relay(Held(held()), refuse).messages([SCAN, SPEED]))) == 6


def test_what_is_wrong_is_told_once_it_is_known() -> None:
    relay = Relay(Held(held(), 2), lambda: Held(held(), problems=("damaged in 1 place",)))
    assert relay.problems == ()
    list(relay.messages([SCAN]))
    assert relay.problems == ("damaged in 1 place",)


def test_when_the_patient_one_cannot_help_its_reason_is_given() -> None:
    def refuse() -> Held:
        raise RecordingError("nothing can be saved")

    messages = Relay(Held(held(), 2), refuse).messages([SCAN, SPEED])
    assert [next(messages)[2], next(messages)[2]] == [b"a", b"b"]
    with pytest.raises(RecordingError, match="nothing can be saved"):
        next(messages)


def test_closing_closes_both() -> None:
    quick, patient = Held(held(), 2), Held(held())
    relay = Relay(quick, lambda: patient)
    list(relay.messages([SCAN]))
    relay.close()
    assert (quick.closed, patient.closed) == (1, 1)
