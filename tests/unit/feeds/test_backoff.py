"""Pauses between attempts."""

from robowidgets.feeds._threaded import FIRST, JITTER, LONGEST, Backoff


def test_the_pauses_double_up_to_a_longest_one_and_are_never_longer_than_said():
    backoff = Backoff()
    pauses = [backoff.next_pause() for _ in range(7)]
    for pause, most in zip(pauses, (0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0), strict=True):
        assert (1 - JITTER) * most <= pause <= most
    assert pauses[-1] <= LONGEST


def test_two_that_lost_the_same_robot_do_not_come_back_in_step():
    assert len({Backoff().next_pause() for _ in range(20)}) > 1


def test_the_first_pause_is_short_again_once_it_worked():
    backoff = Backoff()
    for _ in range(5):
        backoff.next_pause()
    backoff.reset()
    assert backoff.next_pause() <= FIRST
