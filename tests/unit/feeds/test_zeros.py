"""Repeated zeros: which ones are published again, and when."""

from __future__ import annotations

import pytest

from robowidgets.driving.command_watchdog import RECENT
from robowidgets.feeds._zeros import AGAIN, LAST, LAST_PAUSE, LOOK, Zeros

from ..clocks import ManualClock


class Sent:
    """A topic with subscribers and a published speed and zero; the time at which zero is due again."""

    def __init__(self, subscribers: int = 1) -> None:
        self.clock = ManualClock(0.0)
        self.zeros = Zeros(self.clock)
        self.zeros.note_speed("/cmd_vel", subscribers)
        self.zeros.note_zero("/cmd_vel", "Twist", "zero", subscribers)

    def due(self, seconds: float, subscribers: int = 1, *, all_confirm: bool = False) -> list[float]:
        """Look for some seconds; return the times at which zero was due."""
        times = []
        end = self.clock.now() + seconds
        while self.clock.now() < end:
            self.clock.advance(LOOK)
            for topic in self.zeros.topics():
                if found := self.zeros.due(topic, subscribers, all_confirm=all_confirm):
                    assert found == {"Twist": "zero"}
                    times.append(round(self.clock.now()))
        return times


def test_zero_is_due_again_several_times_if_it_is_not_confirmed() -> None:
    assert Sent().due(100.0) == list(AGAIN)
    assert Sent().due(100.0, all_confirm=True) == []


def test_zero_is_due_again_when_a_subscriber_comes_however_late() -> None:
    sent = Sent()
    assert sent.due(1000.0, 0, all_confirm=True) == []
    assert sent.due(20.0, 1, all_confirm=True) == [1000]
    assert sent.due(60.0, 2) == [1020, *(1020 + pause for pause in AGAIN)]


def test_zero_is_not_due_again_after_a_while_without_missing_subscribers() -> None:
    sent = Sent()
    assert sent.due(RECENT + 1, all_confirm=True) == []
    assert sent.due(100.0, 2) == []


def test_a_speed_that_follows_ends_it() -> None:
    sent = Sent()
    assert sent.due(1.5) == [1]
    sent.zeros.note_speed("/cmd_vel", 1)
    assert sent.due(100.0, 2) == []


def test_a_zero_without_a_speed_before_it_is_not_due_again() -> None:
    zeros = Zeros(ManualClock())
    zeros.note_zero("/cmd_vel", "Twist", "zero", 1)
    assert zeros.topics() == []


@pytest.mark.parametrize("heard", [True, False])
def test_a_zero_counts_as_unheard_for_a_while_when_no_subscriber_of_the_speed_is_left(heard: bool) -> None:
    sent = Sent(int(heard))
    assert not sent.zeros.is_unheard("/cmd_vel", 1)
    assert sent.zeros.is_unheard("/cmd_vel", 0) == heard
    sent.clock.advance(RECENT)
    assert not sent.zeros.is_unheard("/cmd_vel", 0)
    assert not sent.zeros.is_unheard("/another", 0)


def test_before_the_end_zero_is_due_some_more_times_for_a_while_if_it_is_not_confirmed() -> None:
    sent, got = Sent(), []

    def end(*, all_confirm: bool = False) -> list[tuple[str, str, str]]:
        got.clear()
        ending = sent.clock.beside(lambda: got.extend(sent.zeros.last(lambda _: all_confirm)))
        while ending.is_alive():
            sent.clock.advance(LAST_PAUSE)
        return got

    assert end() == [("/cmd_vel", "Twist", "zero")] * LAST
    assert end(all_confirm=True) == []
    sent.due(AGAIN[-1] + 1)
    assert end() == []
    sent.zeros.note_speed("/cmd_vel", 1)
    assert end() == []
