"""`EventsWidget`: its Python interface, without a page."""

from __future__ import annotations

import json
import logging
from collections.abc import Iterator
from typing import Any

import pytest
from traitlets import TraitError

from robowidgets import Event, EventsWidget, conditions
from robowidgets.events_widget import MOST_ROWS
from robowidgets.samples.event import Level


@pytest.fixture
def events() -> Iterator[EventsWidget]:
    widget = EventsWidget(title="robot")
    yield widget
    widget.close()


def sent(widget: EventsWidget) -> list[Any]:
    """The texts of the rows as the page merges them: the block that is sent seldom, and the rows after it."""
    state = widget.get_state()
    old, new = (json.loads(bytes(state[name]) or b"[]") for name in ("_old", "_new"))
    first = new[0][0] if new else float("inf")
    return [row[5] for row in old if row[0] < first] + [row[5] for row in new]


def test_it_lists_what_messages_of_several_topics_say(events: EventsWidget) -> None:
    line = {"level": 30, "name": "planner", "msg": "no way", "stamp": {"sec": 0, "nanosec": 0}}
    events.update("/rosout", line)
    events.update("/chatter", {"data": "hello"})
    events.update({"data": "without a topic"})
    events.update("a text alone")
    assert [(row.level.name, row.source, row.text, row.topic) for row in events.rows] == [
        ("WARN", "planner", "no way", "/rosout"),
        ("INFO", "", "hello", "/chatter"),
        ("INFO", "", "without a topic", ""),
        ("INFO", "", "a text alone", ""),
    ]
    assert events.wait(timeout=0).text == "a text alone"


def test_each_topic_has_statuses_of_its_own(events: EventsWidget) -> None:
    array = {"header": {}, "status": [{"name": "motor", "level": 0, "message": "fine"}]}
    for topic in ("/a", "/a", "/b"):
        events.update(topic, array)
    assert [row.topic for row in events.rows] == ["/a", "/b"]


def test_events_are_added_by_hand_with_a_time_that_does_not_go_back(events: EventsWidget) -> None:
    events.add("first", time=2.0, level="error", source="me")
    events.add("second", time=1.0)
    assert [(row.seconds, row.level, row.text) for row in events.rows] == [
        (2.0, Level.ERROR, "first"),
        (2.0, Level.INFO, "second"),
    ]


@pytest.mark.parametrize(
    ("call", "error", "text"),
    [
        (lambda e: e.update(), TypeError, "takes a message"),
        (lambda e: e.update("/t", None), TypeError, "takes a message"),
        (lambda e: e.update("/t", {"data": "x"}, 3), TypeError, "got 3"),
        (lambda e: e.update({"data": 3.5}), TypeError, "expected text, a message like one of"),
        (lambda e: e.add(3), TypeError, "expected text, got 3"),
        (lambda e: e.add("x", level="loud"), ValueError, "expected one of DEBUG, INFO"),
        (lambda e: e.add("x", time=float("nan")), ValueError, "time"),
    ],
)
def test_what_is_not_an_event_is_refused_and_the_list_stays(
    events: EventsWidget, call: Any, error: type[Exception], text: str
) -> None:
    events.add("good")
    with pytest.raises(error, match=text):
        call(events)
    assert [row.text for row in events.rows] == ["good"]


def test_the_page_has_each_row_once_whichever_way_it_was_sent(events: EventsWidget) -> None:
    texts: list[str] = []
    for i in range(300):
        texts.append(f"line {i}")
        events.add(texts[-1])
        if i % 7 == 0:
            assert sent(events) == texts
    assert sent(events) == texts


def test_a_repeated_line_is_counted_also_after_it_was_sent(events: EventsWidget) -> None:
    for i in range(100):
        events.add(f"line {i}")
    sent(events)
    events.add("line 99")
    sent(events)
    assert json.loads(bytes(events.get_state()["_new"]))[-1][5:8] == ["line 99", "", 2]


def test_the_oldest_rows_go_and_their_number_is_reported(events: EventsWidget) -> None:
    for i in range(MOST_ROWS + 5):
        events.add(f"line {i}")
    assert len(events.rows) == MOST_ROWS
    assert events.get_state()["_about"]["older"] == 5
    events.clear()
    assert (events.rows, sent(events)) == ((), [])


def test_missed_messages_are_reported(events: EventsWidget) -> None:
    events.miss(3)
    events.add("x")
    assert events.get_state()["_about"]["notes"] == ["3 messages came too fast, and are not in the list"]


def test_while_frozen_the_rows_are_those_that_were_there(events: EventsWidget) -> None:
    events.add("before")
    events.paused = True
    events.add("after")
    assert [row.text for row in events.rows] == ["before"]
    assert events.frozen == events.rows
    events.paused = False
    assert [row.text for row in events.rows] == ["before", "after"]
    assert events.frozen is None


def test_a_condition_on_events_is_watched(events: EventsWidget) -> None:
    watch = events.watch(conditions.event(level="WARN", text="motor"))
    events.add("motor hot", level="ERROR")
    watch.wait(timeout=60)
    assert watch
    with pytest.raises(ValueError, match="reads a scan"):
        events.watch(conditions.nearest_below(0.3))


def test_in_a_callback_it_logs_what_it_refuses(events: EventsWidget, caplog: pytest.LogCaptureFixture) -> None:
    from threading import Thread

    with caplog.at_level(logging.ERROR):
        thread = Thread(target=events.update, args=({"pose": 1},))
        thread.start()
        thread.join()
    assert "expected text" in caplog.text
    assert events.get_state()["_about"]["error"].startswith("expected text")


def test_its_filter_takes_levels_that_there_are_alone(events: EventsWidget) -> None:
    with pytest.raises(TraitError):
        events.level = "LOUD"
    with pytest.raises(TypeError, match="did you mean 'words'"):
        EventsWidget(filter="x")


def test_a_repr_says_how_many_and_the_last(events: EventsWidget) -> None:
    assert repr(events) == "<EventsWidget robot: nothing yet>"
    events.update(Event("over current", Level.ERROR, "motor"))
    assert repr(events) == "<EventsWidget robot: 1 event, the last: ERROR over current>"
