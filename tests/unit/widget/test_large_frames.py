"""Large frames: the next one is sent when the page has drawn the last one, and none queues."""

from __future__ import annotations

from collections.abc import Iterator

import pytest

from robowidgets.widget.credit import BUDGET_BYTES, BUDGET_INTERVAL, LATE, LONGEST, Credit
from robowidgets.widget.large_frames import LargeFrameWidget
from robowidgets.widget.pacer import pacer

from ..clocks import ManualClock
from ..pages import Page, from_page
from ..senders import turn_of
from ..waiting import wait_for
from .number_widget import Number, NumberWidget, head_of, in_a_thread, number_in


class LargeNumber(LargeFrameWidget[Number], NumberWidget):
    """The smallest widget whose frames count as large."""

    def _size_of(self, sample: Number) -> int:  # noqa: ARG002
        return 8


class Cell:
    """True while one is running."""

    runs = False

    def __call__(self) -> bool:
        return self.runs


@pytest.fixture
def clock() -> ManualClock:
    # Later than any time of the pacer, which checks again only on demand.
    return ManualClock(1e9)


@pytest.fixture
def cell() -> Cell:
    return Cell()


@pytest.fixture
def credit(clock: ManualClock, cell: Cell) -> Credit:
    return Credit(clock.now, cell)


class TestCredit:
    def test_the_next_one_goes_when_the_last_one_is_drawn_however_late_that_is(
        self, credit: Credit, clock: ManualClock
    ) -> None:
        assert credit.may_send()
        credit.sent(1, 1000)
        for _ in range(100):
            clock.advance(1)
            assert not credit.may_send()
        assert credit.on_drawn("page", 1)
        assert credit.may_send()

    @pytest.mark.parametrize(("draws_in", "most"), [(5, 0), (60, 2), (66, 2), (100, 4), (1000, 31)])
    def test_what_is_drawn_was_the_newest_when_it_went_and_none_waits_on_its_way(
        self, credit: Credit, clock: ManualClock, draws_in: int, most: int
    ) -> None:
        every, newest, sent, sent_at, behind = 33, 0, 0, 0, []
        for now in range(10_000):  # milliseconds that a page needs for one frame
            newest = now // every + 1
            if sent and now == sent_at + draws_in:
                behind.append(newest - sent)
                credit.on_drawn("page", sent)
            if newest > sent and credit.may_send():
                sent, sent_at = newest, now
                credit.sent(sent, 1000)
            clock.advance(0.001)
        assert max(behind) == most
        assert len(behind) >= 10_000 // (draws_in + every) - 1

    def test_a_page_that_has_drawn_an_older_one_still_has_the_last_to_draw(self, credit: Credit) -> None:
        credit.on_drawn("page", 0)
        credit.sent(5, 1000)
        assert not credit.on_drawn("page", 4)
        assert not credit.may_send()

    def test_one_that_improves_the_last_is_drawn_too_before_the_next(self, credit: Credit) -> None:
        credit.sent(1, 1000)
        credit.on_drawn("page", 1)
        credit.sent(1, 1000)
        assert not credit.may_send()
        assert credit.on_drawn("page", 1)

    def test_a_page_that_is_slow_or_gone_delays_another_by_a_second_once(
        self, credit: Credit, clock: ManualClock
    ) -> None:
        credit.sent(1, 1000)
        credit.on_drawn("gone", 1)
        credit.on_drawn("here", 1)
        credit.sent(2, 1000)
        assert not credit.on_drawn("here", 2)
        clock.advance(LATE - 0.01)
        assert not credit.may_send()
        clock.advance(0.01)
        assert credit.may_send()
        credit.sent(3, 1000)
        assert credit.on_drawn("here", 3)
        credit.on_drawn("gone", 3)
        credit.sent(4, 1000)
        assert not credit.on_drawn("here", 4)

    def test_pages_that_do_not_answer_are_asked_ever_less_often(self, credit: Credit, clock: ManualClock) -> None:
        began = clock.now()
        credit.sent(1, 1000)
        asked = []
        while clock.now() < began + 100:
            clock.advance(credit.look_at - clock.now())
            assert not credit.may_send()
            assert credit.asks() == 1
            assert credit.asks() is None
            asked.append(clock.now() - began)
        assert asked == pytest.approx([1, 3, 7, 15, 31, 61, 91, 121][: len(asked)])
        assert asked[-1] - asked[-2] == LONGEST

    def test_one_that_was_lost_on_its_way_is_no_longer_waited_for(self, credit: Credit) -> None:
        credit.on_drawn("page", 0)
        credit.sent(7, 1000)
        assert not credit.on_drawn("page", 0, lacks=6)
        assert credit.on_drawn("page", 0, lacks=7)

    @pytest.mark.parametrize(("size", "interval"), [(1000, BUDGET_INTERVAL), (BUDGET_BYTES, 1.0)])
    def test_a_budget_takes_over_while_a_cell_keeps_answers_from_being_heard(
        self, credit: Credit, clock: ManualClock, cell: Cell, size: int, interval: float
    ) -> None:
        credit.on_drawn("page", 0)  # in the main thread, as in a host without another thread for it
        credit.sent(1, size)
        cell.runs = True
        assert credit.says_paced
        assert credit.look_at == clock.now() + interval
        clock.advance(interval - 0.01)
        assert not credit.may_send()
        clock.advance(0.01)
        assert credit.may_send()
        assert credit.asks() is None
        credit.sent(2, size)
        cell.runs = False
        clock.advance(interval)
        assert not credit.may_send()
        assert not credit.says_paced

    def test_a_running_cell_changes_nothing_if_answers_arrive_meanwhile(
        self, credit: Credit, clock: ManualClock, cell: Cell
    ) -> None:
        in_a_thread(credit.on_drawn, "page", 0)
        credit.sent(1, 1000)
        cell.runs = True
        clock.advance(BUDGET_INTERVAL)
        assert not credit.says_paced
        assert not credit.may_send()


class TestWidget:
    @pytest.fixture
    def widget(self, credit: Credit) -> Iterator[LargeNumber]:
        widget = LargeNumber()
        widget._credit = credit
        yield widget
        widget.close()

    @pytest.fixture
    def page(self, widget: LargeNumber) -> Page:
        return Page(widget)

    @staticmethod
    def draw(widget: LargeNumber, number: float, **more: object) -> None:
        """Answer as a page, in a separate thread as with ipykernel 7."""
        answer = {"drawn": number, "page": "one", **more}
        in_a_thread(from_page, widget, answer)

    def test_only_the_newest_follows_what_the_page_has_drawn(self, widget: LargeNumber, page: Page) -> None:
        widget.update(0)
        wait_for(lambda: page.messages, "the first was sent")
        for value in range(1, 10):
            widget.update(value)
            widget.send_newest()
        assert len(page.messages) == 1
        self.draw(widget, 1)
        wait_for(lambda: len(page.messages) == 2, "the next was sent")
        assert [number_in(frame) for frame in page.sent("_frame")] == [0, 9]
        assert [about["value"] for about in page.sent("_about")] == [0, 9]

    def test_others_wait_for_it_only_if_the_page_does_not_report_that_it_is_drawn(
        self, widget: LargeNumber, page: Page, cell: Cell, clock: ManualClock
    ) -> None:
        with turn_of(pacer):  # so that it does not send it
            widget.update(1)
            assert widget.send_newest() == 0
            cell.runs = True
            from_page(widget, {"drawn": 1, "page": "one"})
            clock.advance(LATE)
            widget.update(2)
            assert widget.send_newest() == len(page.state["_frame"])
        assert [number_in(frame) for frame in page.sent("_frame")] == [1, 2]

    def test_settings_and_the_state_of_a_new_page_wait_for_nothing(self, widget: LargeNumber, page: Page) -> None:
        widget.update(1)
        wait_for(lambda: page.messages, "the first was sent")
        widget.update(2)
        widget.color = "blue"
        wait_for(lambda: page.state["color"] == "blue", "the colour was sent")
        assert number_in(page.state["_frame"]) == 1
        assert number_in(widget.get_state()["_frame"]) == 2

    def test_a_page_that_lacks_what_was_sent_is_asked_and_gets_the_newest(
        self, widget: LargeNumber, page: Page, clock: ManualClock
    ) -> None:
        widget.update(1)
        wait_for(lambda: page.messages, "the first was sent")
        widget.update(2)
        widget.send_newest()
        clock.advance(LATE)
        widget.look_again()
        assert page.customs == [{"asks": 1.0}]
        self.draw(widget, 0, lacks=1)
        wait_for(lambda: number_in(page.state["_frame"]) == 2, "the newest was sent")

    def test_a_notebook_that_no_page_shows_has_the_last_of_a_cell(self, widget: LargeNumber, page: Page) -> None:
        widget.update(1)
        wait_for(lambda: page.messages, "the first was sent")
        widget.update(2)
        widget.send_newest()
        pacer.flush()
        assert number_in(page.state["_frame"]) == 2

    def test_the_page_knows_that_it_gets_fewer_while_a_cell_runs(
        self, widget: LargeNumber, page: Page, cell: Cell, clock: ManualClock
    ) -> None:
        cell.runs = True
        from_page(widget, {"drawn": 0, "page": "one"})
        widget.update(1)
        wait_for(lambda: page.messages, "the first was sent")
        assert "while a cell runs" in page.state["_about"]["pace"]
        widget.update(2)
        widget.send_newest()
        clock.advance(BUDGET_INTERVAL)
        widget.look_again()
        wait_for(lambda: number_in(page.state["_frame"]) == 2, "the second was sent")
        assert head_of(page.state["_frame"])[0] == 2

    @pytest.mark.parametrize(
        "content",
        [
            None,
            {"drawn": 1},
            {"drawn": "1", "page": "one"},
            {"drawn": float("nan"), "page": "one"},
            {"drawn": 1, "page": 2},
            {"drawn": 1, "page": "one", "lacks": []},
        ],
    )
    def test_a_message_that_no_page_sends_is_not_an_answer(
        self, widget: LargeNumber, page: Page, content: object
    ) -> None:
        widget.update(1)
        wait_for(lambda: page.messages, "the first was sent")
        from_page(widget, content)
        widget.update(2)
        widget.send_newest()
        assert [number_in(frame) for frame in page.sent("_frame")] == [1]

    def test_the_frames_of_a_player_need_no_answer(self, widget: LargeNumber, page: Page) -> None:
        widget.follow_player()
        wait_for(lambda: page.state["_answers"] is False, "the page got it")
