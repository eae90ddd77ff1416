"""The events of a running robot: its topics, and the actions of its program."""

from __future__ import annotations

from collections.abc import Iterator
from types import SimpleNamespace as Message

import pytest

from robowidgets import EventsWidget, conditions
from robowidgets.feeds import Advert, Feed

from ..waiting import wait_for
from .scripted import CMD_VEL, SCAN, Scripted

ROSOUT = Advert("/rosout", "rcl_interfaces/msg/Log")
BUMPER = Advert("/bumper", "std_msgs/msg/Bool")


@pytest.fixture
def script() -> Scripted:
    return Scripted(SCAN, CMD_VEL, ROSOUT, BUMPER)


@pytest.fixture
def robot(script: Scripted) -> Iterator[Feed]:
    with Feed(script) as opened:
        yield opened


def line(text: str, level: int = 20) -> Message:
    return Message(level=level, name="node", msg=text, stamp=Message(sec=1, nanosec=0))


def test_each_line_is_listed_and_none_replaces_another(robot: Feed, script: Scripted) -> None:
    events = EventsWidget()
    robot.connect("/rosout", events)
    assert "/rosout" in script.each
    for i in range(500):
        script.listener.on_message("/rosout", line(f"{i}"))
    assert [row.text for row in events.rows] == [f"{i}" for i in range(500)]
    script.listener.on_missed("/rosout", 7)
    assert "7 messages came too fast" in events.get_state()["_about"]["notes"][0]
    assert events.title == "/rosout"
    events.close()


def test_a_view_lists_topics_that_are_asked_for_together_and_the_others_as_before(
    robot: Feed, script: Scripted
) -> None:
    view = robot.show("/rosout", "/scan")
    events = view.widgets["/rosout"]
    assert isinstance(events, EventsWidget)
    script.listener.on_message("/rosout", line("lost", 30))
    wait_for(lambda: len(events.rows) == 1, "the line is there")
    assert events.rows[0].topic == "/rosout"
    view.close()
    assert "/rosout" not in robot.show().widgets


def test_what_its_program_does_is_listed_with_its_errors(robot: Feed) -> None:
    events = EventsWidget()
    events.follow(robot)

    @robot.program(rate=50)
    class Escapement:
        tick = tock = None
        moves = "tick -> tock after 0.05", "tock -> tick after 0.05"

    wait_for(lambda: [row.text for row in events.rows][:3] == ["version 1", "→ tock", "→ tick"], "its states are there")
    assert {row.source for row in events.rows} == {"Escapement"}

    @robot.program(rate=50)
    def broken(time: float) -> None:
        raise ValueError("a bad idea")

    wait_for(lambda: any("a bad idea" in row.text for row in events.rows), "its error is there")
    failed = next(row for row in events.rows if "a bad idea" in row.text)
    assert (failed.level.name, failed.source) == ("ERROR", "broken")
    events.close()
    with pytest.raises(TypeError, match="follow\\(\\): expected a feed"):
        EventsWidget().follow("robot")


def test_the_end_of_a_touch_without_a_message_is_listed_at_its_time(robot: Feed) -> None:
    from robowidgets import Touch, TouchMode

    events = EventsWidget()
    events.update("/contacts", Touch({"left": True}, mode=TouchMode.PRESENCE))
    wait_for(lambda: [row.text for row in events.rows] == ["left touched", "left released"], "the release is there")
    assert events.rows[1].seconds == pytest.approx(0.15, abs=1e-6)
    events.close()


def test_a_watch_of_a_whole_feed_says_where_events_are_watched(robot: Feed) -> None:
    with pytest.raises(TypeError, match="an EventsWidget that is connected watches it"):
        robot.watch(conditions.event(level="WARN"), "warned")
