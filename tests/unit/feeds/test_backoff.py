"""Pauses between attempts, and the errors that a session may raise."""

import pytest

from robowidgets.feeds import Listener
from robowidgets.feeds._threaded import FIRST, Backoff, ThreadedMiddleware

from ..waiting import wait_for
from .ears import Ears


def test_the_pauses_double_up_to_a_longest_one():
    backoff = Backoff()
    assert [backoff.next_pause() for _ in range(7)] == [0.5, 1.0, 2.0, 4.0, 8.0, 8.0, 8.0]


def test_the_first_pause_is_short_again_once_it_worked():
    backoff = Backoff()
    for _ in range(5):
        backoff.next_pause()
    backoff.reset()
    assert backoff.next_pause() == FIRST


class Failing(ThreadedMiddleware):
    """Its first session raises an unexpected error."""

    sessions = 0

    def _run_session(self, _listener: Listener) -> str:
        self.sessions += 1
        if self.sessions == 1:
            raise KeyError("what nobody thought of")
        self._closed.wait()
        return ""

    def _wake_session(self) -> None:
        pass


def test_whatever_a_session_raises_is_logged_and_another_one_follows(caplog: pytest.LogCaptureFixture) -> None:
    middleware, ears = Failing(), Ears()
    middleware._start_thread("robowidgets-failing", ears)
    wait_for(lambda: middleware.sessions == 2, "the next session")
    middleware.close()
    assert ears.lost == ["KeyError: 'what nobody thought of'"]
    assert "KeyError" in caplog.text
