"""The number of messages that a topic lacks while it is recorded."""

from __future__ import annotations

import random
from collections.abc import Iterable
from typing import Any

import pytest

from robowidgets.recordings.gaps import Gaps


def numbered(number: int) -> dict[str, Any]:
    return {"header": {"seq": number, "stamp": {"secs": 1, "nsecs": number}}}


def stamped(seconds: float) -> dict[str, Any]:
    return {"header": {"stamp": {"sec": int(seconds), "nanosec": int(seconds % 1 * 1e9)}}}


def missing(messages: Iterable[Any]) -> int:
    gaps = Gaps()
    for message in messages:
        gaps.see(message)
    return gaps.missing


@pytest.mark.parametrize("hz", [5, 40, 1000])
def test_lost_messages_of_a_steady_topic_are_counted_by_its_stamps(hz: int) -> None:
    lost = {50, 70, 71, 72, 90, 92, 150}
    assert missing(stamped(1000 + i / hz) for i in range(200) if i not in lost) == len(lost)


def test_stamps_that_waver_by_a_fifth_count_no_message_too_many() -> None:
    wavering = random.Random(1)
    stamps = [1000 + i / 40 + wavering.uniform(-0.0025, 0.0025) for i in range(400)]
    assert missing(map(stamped, stamps)) == 0
    assert missing(stamped(stamp) for i, stamp in enumerate(stamps) if not 100 <= i < 110) == 10


def test_messages_that_only_come_late_are_not_missing() -> None:
    stamps = [1000 + i / 100 for i in range(100)]
    late = [1000.59 + i / 10000 if 50 <= i < 60 else stamp for i, stamp in enumerate(stamps)]
    assert missing(map(stamped, late)) == 0


def test_a_topic_that_becomes_slower_or_pauses_or_has_no_pace_lacks_nothing() -> None:
    slower = [1000 + i / 30 for i in range(100)] + [1003.3 + i / 10 for i in range(100)]
    assert missing(map(stamped, slower)) == 0
    paused = [1000 + i / 40 for i in range(100)] + [1010 + i / 40 for i in range(100)]
    assert missing(map(stamped, paused)) == 0
    chance = random.Random(2)
    by_hand = [1000 + chance.uniform(0, 100) for _ in range(300)]
    assert missing(map(stamped, sorted(by_hand))) == 0


def test_messages_without_a_stamp_and_few_of_them_lack_nothing() -> None:
    assert missing([{"data": 1.0}] * 50) == 0
    assert missing(map(stamped, [1000.0, 1000.1, 1000.5, 1001.0])) == 0


def test_numbers_of_ros_1_are_exact() -> None:
    gaps = Gaps()
    for number in (7, 8, 11, 12, 13, 20, 21):
        gaps.see(numbered(number))
    assert (gaps.missing, gaps.by_number) == (8, True)


def test_numbers_of_two_publishers_count_nothing() -> None:
    gaps = Gaps()
    for i in range(50):
        gaps.see(numbered(i + 1))
        gaps.see(numbered(1000 + i))
    assert (gaps.missing, gaps.by_number) == (0, False)
