"""A call that many threads request and one at a time carries out."""

from __future__ import annotations

import threading

import pytest

from robowidgets.runtime.coalesced_call import CoalescedCall


def test_a_request_during_a_run_returns_at_once_and_is_run_by_the_same_thread() -> None:
    runs: list[threading.Thread] = []

    def run() -> None:
        runs.append(threading.current_thread())
        if len(runs) == 1:
            other = threading.Thread(target=call)
            other.start()
            other.join(120)
            assert not other.is_alive()
            assert len(runs) == 1

    call = CoalescedCall(run)
    call()
    assert runs == [threading.current_thread()] * 2


def test_many_requests_during_a_run_make_one_more_run() -> None:
    runs: list[int] = []

    def run() -> None:
        runs.append(len(runs))
        if len(runs) == 1:
            for _ in range(10):
                call()

    call = CoalescedCall(run)
    call()
    assert runs == [0, 1]


def test_after_an_error_the_next_call_runs_again() -> None:
    errors = [KeyboardInterrupt(), ValueError()]

    def run() -> None:
        if errors:
            raise errors.pop()

    call = CoalescedCall(run)
    for error in (ValueError, KeyboardInterrupt):
        with pytest.raises(error):
            call()
    call()
    assert errors == []


def test_of_many_threads_the_last_request_is_always_followed_by_a_run() -> None:
    newest, seen = [0], [0]
    call = CoalescedCall(lambda: seen.__setitem__(0, newest[0]))

    def request(number: int) -> None:
        for _ in range(1000):
            newest[0] += 1 + number
            call()

    threads = [threading.Thread(target=request, args=(number,)) for number in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert seen == newest
