"""The page is kept supplied with a recording, ahead of its time."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager

import pytest

from robowidgets.notebook import progress
from robowidgets.recordings import RecordingError
from robowidgets.runtime.clock import Clock, scheduler
from robowidgets.screens import _prefetcher as module
from robowidgets.screens._prefetcher import Cursor, Prefetcher
from robowidgets.widget.timed_frame import TimedFrame

from ..clocks import ManualClock
from ..waiting import threads_named, wait_for

PLAYER = "robowidgets-prefetcher"


class Track:
    """Frames of a given size, one at the start of each segment."""

    def __init__(self, size: int = 10, fails_at: float = 1e9, error: Exception | None = None) -> None:
        self.size, self.fails_at, self.error = size, fails_at, error

    def frames(self, start: float, _end: float) -> Iterator[TimedFrame]:
        if start >= self.fails_at and self.error:
            raise self.error
        yield TimedFrame(start, {}, b"x" * self.size)


class Page:
    def __init__(self) -> None:
        self.has: list[int] = []
        self.dropped: list[list[int]] = []
        self.words: list[str] = []
        self.bytes: dict[int, int] = {}

    def take(self, content: dict, buffers: list[bytes]) -> None:
        for index in content["drop"]:
            self.bytes.pop(index)
        self.has.append(content["segment"])
        self.dropped.append(content["drop"])
        self.bytes[content["segment"]] = sum(map(len, buffers))


@contextmanager
def sending(
    track: Track, duration: float, clock: Clock = scheduler.clock, page: Page | None = None
) -> Iterator[tuple[Prefetcher, Page]]:
    page = page or Page()

    @contextmanager
    def tracks() -> Iterator[list[Track]]:
        yield [track]

    prefetcher = Prefetcher(tracks, page.take, duration, page.words.append, clock)
    try:
        yield prefetcher, page
    finally:
        prefetcher.close()


def test_a_page_that_is_silent_for_three_seconds_gets_only_the_present_view() -> None:
    clock = ManualClock()
    with sending(Track(), 100, clock) as (prefetcher, page):
        prefetcher.set_time(40.2, 0.0, (0.0, 100.0))
        clock.advance(2.999)
        assert page.has == []
        clock.advance(60.0)
        assert page.has == [40, 41, 39, *range(42, 51)]
        prefetcher.set_time(40.3, 0.0, (0.0, 100.0))
        clock.advance(60.0)
        assert len(page.has) == 12


def test_what_plays_is_ten_seconds_ahead_while_nothing_is_heard() -> None:
    clock = ManualClock()
    with sending(Track(), 1000, clock) as (prefetcher, page):
        prefetcher.set_time(0.0, 1.0, (0.0, 1000.0))
        clock.advance(4.5)  # it looks each quarter of a second
        for passed in range(4, 20):
            assert max(page.has) == passed + 10
            clock.advance(1.0)


def test_the_time_on_show_comes_first_then_what_follows_and_one_before() -> None:
    with sending(Track(), 100) as (prefetcher, page):
        prefetcher.set_time(40.2, 0.0, (0.0, 100.0))
        prefetcher.start()
        wait_for(lambda: len(page.has) == 101, "all came")
        assert page.has[:12] == [40, 41, 39, *range(42, 51)]
        assert page.has[12:20] == [38, 37, 51, 52, 36, 53, 54, 55]
        assert page.has[-1] == 0


def test_a_seek_is_served_before_the_rest() -> None:
    with sending(Track(), 1000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.has) > 11, "the start came")
        prefetcher.set_time(700.5, 0.0, (0.0, 1000.0))
        wait_for(lambda: 710 in page.has, "what was sought came")
        assert page.has[page.has.index(700) :][:4] == [700, 701, 699, 702]


def test_what_plays_fast_is_further_ahead_and_goes_on_while_nothing_is_heard() -> None:
    with sending(Track(), 1000) as (prefetcher, page):
        prefetcher.start()
        prefetcher.set_time(0.0, 10.0, (0.0, 1000.0))
        wait_for(lambda: max(page.has, default=0) >= 110, "it was reckoned where the page must be")


def test_a_page_that_waits_gets_what_it_waits_for_however_fast_it_plays() -> None:
    class Slow(Track):
        def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
            time.sleep(0.02)
            return super().frames(start, end)

    with sending(Slow(), 1000) as (prefetcher, page):
        prefetcher.start()
        prefetcher.set_time(50.0, 100.0, (0.0, 1000.0))
        wait_for(lambda: len(page.has) >= 20, "some came")
        wanted = [index for index in page.has if index >= 50]
        assert wanted == list(range(50, 50 + len(wanted)))


def test_its_thread_shows_no_bar_in_a_cell(capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    class Long(Track):
        def frames(self, start: float, end: float) -> Iterator[TimedFrame]:
            with progress.Progress(2, "Reading") as bar:
                bar.update(1)
            return super().frames(start, end)

    monkeypatch.setattr(progress, "SHOWN_AFTER", 0)
    with sending(Long(), 3) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.has) == 4, "all came")
    assert capsys.readouterr().err == ""


def test_what_is_stale_is_dropped_from_the_page() -> None:
    with sending(Track(), 1000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.bytes) > 20, "the start came")
        prefetcher.set_time(900.0, 0.0, (0.0, 1000.0))
        prefetcher.start()
        wait_for(lambda: any(page.dropped), "something was dropped")
        first = next(i for i, dropped in enumerate(page.dropped) if dropped)
        assert page.has[first] == 900, "the time on show comes again"
        assert {*page.dropped[first], 900} == {*page.has[:first], 900}


def test_at_the_end_of_a_loop_its_start_follows() -> None:
    with sending(Track(), 1000) as (prefetcher, page):
        prefetcher.set_time(52.0, 1.0, (20.0, 54.0), loops=True)
        prefetcher.start()
        wait_for(lambda: {52, 53, 54, 20, 21} <= set(page.has), "the start of the loop came")


def test_a_page_that_was_reloaded_gets_all_again() -> None:
    with sending(Track(), 3) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: page.has == [0, 1, 2, 3], "all came")
        prefetcher.start()
        wait_for(lambda: page.has == [0, 1, 2, 3] * 2, "all came again")


def test_a_full_page_gets_what_lies_around_a_time_and_loses_what_is_far(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_BYTES", 40_000)
    with sending(Track(1000), 10_000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.bytes) > 35, "the page is full")
        prefetcher.set_time(5000.5, 0.0, (0.0, 10_000.0))
        wait_for(lambda: set(range(4995, 5025)) <= page.bytes.keys(), "what lies around came")
        prefetcher.close()
        assert len(page.has) == len(set(page.has))


def test_the_page_keeps_no_more_than_it_may(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_BYTES", 40_000)
    with sending(Track(1000), 10_000) as (prefetcher, page):
        prefetcher.start()
        for seconds in (0, 50, 100, 150):
            prefetcher.set_time(seconds, 0.0, (0.0, 10_000.0))
            wait_for(lambda at=seconds: {at, at + 10} <= page.bytes.keys(), "what was sought came")
            assert sum(page.bytes.values()) <= 40_000
            assert len(page.bytes) < 40


def test_the_moment_under_the_pointer_is_sent_when_its_caller_goes_on(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "ANSWER", 30.0)
    with sending(Track(), 50_000) as (prefetcher, page):
        prefetcher.start()
        for seconds, index in ((40_000.5, 40_000), (30_000.0, 30_000), (1e6, 50_000), (-1.0, 0)):
            prefetcher.point(seconds)
            assert index in page.bytes
        assert not {29_999, 30_001, 39_999, 40_001, 49_999} & page.bytes.keys()


def test_a_caller_goes_on_after_the_moment_is_sent_to_its_end(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "ANSWER", 30.0)
    found: list[bool] = []

    class SlowPage(Page):
        def take(self, content: dict, buffers: list[bytes]) -> None:
            if content["segment"] == 0:
                pointing.start()
                pointing.join(0.1)  # it would be over
            super().take(content, buffers)

    page = SlowPage()
    pointing = threading.Thread(target=lambda: (prefetcher.point(0.5), found.append(0 in page.bytes)))
    with sending(Track(), 10, page=page) as (prefetcher, _):
        prefetcher.start()
        wait_for(lambda: found, "the caller goes on")
    assert found == [True]


def test_playing_comes_before_pointing_and_no_caller_waits_for_pointing(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(module, "ANSWER", 1000.0)  # a waiting caller waits too long for it
    with sending(Track(), 1000) as (prefetcher, page):
        prefetcher.set_time(50.0, 10.0, (0.0, 1000.0))
        prefetcher.start()
        prefetcher.point(700.5)
        wait_for(lambda: 700 in page.has, "it came")
        assert set(range(50, 150)) <= set(page.has[: page.has.index(700)])


def test_a_full_page_keeps_the_moment_under_the_pointer_until_it_is_another(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_BYTES", 40_000)
    with sending(Track(1000), 10_000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.bytes) > 35, "the page is full")
        prefetcher.point(5000.5)
        for seconds in (1000, 2000):
            prefetcher.set_time(seconds, 0.0, (0.0, 10_000.0))
            wait_for(lambda at=seconds: {*range(at - 4, at + 20)} <= page.bytes.keys(), "what lies around came")
            assert 5000 in page.bytes
            assert sum(page.bytes.values()) <= 40_000
        for seconds in range(6000, 6000 + module.POINTED):
            prefetcher.point(seconds)
        prefetcher.set_time(9000, 0.0, (0.0, 10_000.0))
        wait_for(lambda: 5000 not in page.bytes, "it made room")
        assert sum(page.bytes.values()) <= 40_000


def test_a_page_that_keeps_a_few_segments_only_keeps_none_that_is_pointed_at(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_BYTES", 4000)
    with sending(Track(1000), 1000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: page.has, "it began")
        prefetcher.point(500.0)
        prefetcher.set_time(700.0, 0.0, (0.0, 1000.0))
        wait_for(lambda: {700, 701} <= page.bytes.keys(), "what was sought came")
        assert 500 not in page.has


def test_a_clock_that_jumps_by_years_takes_no_more_time_or_room(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_SEGMENTS", 40)
    with sending(Track(), 1e9) as (prefetcher, page):
        prefetcher.start()
        for seconds in (5e8, 0.0, 1e9):
            began = time.thread_time()
            prefetcher.set_time(seconds, 0.0, (0.0, 1e9))
            assert time.thread_time() - began < 10.0
            wait_for(lambda at=int(seconds): at in page.bytes and len(page.bytes) == 40, "it is there with the others")


def test_what_is_soon_shown_takes_half_of_what_a_page_keeps_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "KEPT_BYTES", 40_000)
    with sending(Track(1000), 10_000) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.bytes) > 5, "it began")
        prefetcher.set_time(50.0, 10.0, (0.0, 10_000.0))
        wait_for(lambda: 80 in page.has, "it went on")
        assert sum(page.bytes.values()) <= 40_000


def test_a_recording_that_cannot_be_read_on_is_reported() -> None:
    with sending(Track(fails_at=2.0, error=RecordingError("drive.bag: cut off")), 100) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: page.words, "it was set_to")
        assert (page.has, page.words) == ([0, 1], ["drive.bag: cut off"])


def test_an_unforeseen_error_is_reported_and_logged(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.ERROR), sending(Track(fails_at=0.0, error=KeyError("x")), 10) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: page.words, "it was set_to")
        assert page.words == ["KeyError: 'x'"]
        assert "can be played no further" in caplog.text


def test_closed_it_leaves_no_thread_and_may_be_closed_again() -> None:
    with sending(Track(), 1e6) as (prefetcher, page):
        prefetcher.start()
        wait_for(lambda: len(page.has) >= 11, "some came")
        assert threads_named(PLAYER) == 1
        prefetcher.close()
        prefetcher.close()
        assert threads_named(PLAYER) == 0


def test_with_nothing_to_do_for_ten_minutes_it_has_no_thread_and_no_file_until_there_is(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    clock = ManualClock()
    with sending(Track(), 1000, clock) as (prefetcher, page):
        monkeypatch.setattr(module, "KEPT_BYTES", 200)
        prefetcher.start()
        clock.advance(599.0)
        assert page.has[:2] == [0, 1]
        assert threads_named(PLAYER) == 1
        clock.advance(10.0)
        assert threads_named(PLAYER) == 0
        prefetcher.set_time(900.5, 0.0, (0.0, 1000.0))
        clock.advance(1.0)
        assert 900 in page.has
        clock.advance(600.0)
        assert threads_named(PLAYER) == 0


def test_its_thread_ends_at_once_when_all_was_sent_and_begins_again_for_a_page_that_was_loaded_again() -> None:
    with sending(Track(), 3) as (prefetcher, page):
        for times in (1, 2):
            prefetcher.start()
            wait_for(lambda: threads_named(PLAYER) == 0, "the thread ended")
            assert page.has == [0, 1, 2, 3] * times


def test_between_two_words_the_time_is_reckoned_up_to_the_end() -> None:
    now = [100.0]
    cursor = Cursor(lambda: now[0])
    cursor.set_time(5.0, 2.0, (0.0, 9.0))
    now[0] += 1.5
    assert cursor.seconds == 8.0
    now[0] += 60
    assert cursor.seconds == 9.0
    cursor.set_time(8.0, 2.0, (4.0, 9.0), loops=True)
    now[0] += 1.5
    assert cursor.seconds == 6.0
    cursor.set_time(3.0, 0.0, (0.0, 9.0))
    now[0] += 60
    assert cursor.seconds == 3.0
