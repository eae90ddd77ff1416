"""Trying again."""

import threading

from robowidgets.feeds._again import FIRST, JITTER, LONGEST, Again


def test_the_pauses_double_up_to_a_longest_one_and_are_never_longer_than_said():
    again = Again()
    pauses = [again.next_pause() for _ in range(7)]
    for pause, most in zip(pauses, (0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0), strict=True):
        assert (1 - JITTER) * most <= pause <= most
    assert pauses[-1] <= LONGEST


def test_two_that_lost_the_same_robot_do_not_come_back_in_step():
    assert len({Again().next_pause() for _ in range(20)}) > 1


def test_the_first_pause_is_short_again_once_it_worked():
    again = Again()
    for _ in range(5):
        again.next_pause()
    again.worked()
    assert again.next_pause() <= FIRST


def test_a_wait_passes_or_ends_at_once_when_it_is_closed():
    again = Again()
    assert again.wait(0.001)
    ended = []
    waiting = threading.Thread(target=lambda: ended.append(again.wait(60.0)))
    waiting.start()
    again.close()
    again.close()
    waiting.join(5.0)
    assert ended == [False]
    assert again.closed
    assert not again.wait(60.0)
