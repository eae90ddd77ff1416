"""From messages to events: the events of each type, repeated events only if they change, and their list."""

from __future__ import annotations

from itertools import pairwise
from math import inf
from types import SimpleNamespace as Message
from typing import Any

import numpy as np
import pytest

from robowidgets import Event, Touch, TouchMode
from robowidgets.messages.event import EventReader
from robowidgets.samples.event import Level, holds, to_level
from robowidgets.samples.event_log import EventLog, shortened, thinned


def said(reader: EventReader, message: Any, time_ns: int = 0) -> list[tuple[str, str, str]]:
    return [(event.level.name, event.source, event.text) for _, event in reader.read(message, time_ns)]


def status(name: str, level: Any, text: str) -> dict[str, Any]:
    return {"name": name, "level": level, "message": text, "hardware_id": "", "values": []}


class TestTheReader:
    def test_reads_lines_of_ros_2_by_the_numbers_of_their_levels_also_those_between(self) -> None:
        reader = EventReader("/rosout")
        stamp = {"sec": 5, "nanosec": 7}
        levels = {10: "DEBUG", 20: "INFO", 30: "WARN", 40: "ERROR", 50: "FATAL", 25: "INFO", 0: "DEBUG", 99: "FATAL"}
        for number, name in levels.items():
            line = {"stamp": stamp, "level": number, "name": "nav.planner", "msg": "no way", "file": "", "line": 3}
            ((_, event),) = reader.read(line)
            assert event == Event("no way", Level[name], "nav.planner", "/rosout", 5_000_000_007)

    def test_reads_lines_of_ros_1_whose_levels_are_bits(self) -> None:
        reader = EventReader("/rosout")
        for number, name in {1: "DEBUG", 2: "INFO", 4: "WARN", 8: "ERROR", 16: "FATAL"}.items():
            line = Message(
                header=Message(stamp=Message(secs=3, nsecs=1)), level=number, name="/amcl", msg="lost", topics=["/scan"]
            )
            ((_, event),) = reader.read(line)
            assert event == Event("lost", Level[name], "/amcl", "/rosout", 3_000_000_001)

    @pytest.mark.parametrize("as_sent", [lambda n: n, lambda n: bytes([n]), lambda n: [n], str])
    def test_tells_changes_of_a_status_whatever_a_byte_is_sent_as(self, as_sent: Any) -> None:
        reader = EventReader()
        array = {"header": {}, "status": [status("motor", as_sent(0), "fine"), status("cpu", as_sent(1), "hot")]}
        assert said(reader, array) == [("INFO", "motor", "OK: fine"), ("WARN", "cpu", "hot")]
        assert said(reader, array) == []
        array["status"][0] = status("motor", as_sent(2), "stuck")
        assert said(reader, array) == [("ERROR", "motor", "stuck")]
        array["status"][0] = status("motor", as_sent(3), "stuck")
        assert said(reader, array) == [("WARN", "motor", "stale: stuck")]
        assert said(reader, {"status": [status("motor", as_sent(0), "")]}) == [("INFO", "motor", "OK")]

    def test_tells_parameters_that_were_declared_changed_and_deleted(self) -> None:
        def parameter(name: str, kind: int, **value: Any) -> dict[str, Any]:
            return {"name": name, "value": {"type": kind, **value}}

        message = {
            "stamp": {"sec": 2, "nanosec": 0},
            "node": "/amcl",
            "new_parameters": [
                parameter("sim", 1, bool_value=True), parameter("beams", 7, integer_array_value=np.array([1, 2]))
            ],
            "changed_parameters": [parameter("speed", 3, double_value=0.3), parameter("mode", 4, string_value="fast")],
            "deleted_parameters": [parameter("old", 0)],
        }  # fmt: skip
        reader = EventReader("/parameter_events")
        assert said(reader, message) == [
            ("INFO", "/amcl", "declared sim = True, beams = [1, 2]"),
            ("INFO", "/amcl", "speed = 0.3"),
            ("INFO", "/amcl", "mode = fast"),
            ("INFO", "/amcl", "deleted old"),
        ]
        assert reader.read(message)[0][1].stamp_ns == 2_000_000_000

    def test_tells_changes_of_goals_of_both_ros(self) -> None:
        def goals(*states: int) -> dict[str, Any]:
            infos = [{"goal_id": {"uuid": np.full(16, 0xA0 + i, np.uint8)}} for i in range(len(states))]
            return {"status_list": [{"goal_info": i, "status": s} for i, s in zip(infos, states, strict=True)]}

        reader = EventReader("/go/_action/status")
        assert said(reader, goals(2)) == [("INFO", "", "goal a0a0a0a0 executing")]
        assert said(reader, goals(2)) == []
        assert said(reader, goals(6, 4)) == [
            ("ERROR", "", "goal a0a0a0a0 aborted"), ("INFO", "", "goal a1a1a1a1 succeeded")
        ]  # fmt: skip
        old = {"header": {}, "status_list": [{"goal_id": {"id": "/nav-1", "stamp": {}}, "status": 5, "text": "no way"}]}
        assert said(EventReader(), old) == [("ERROR", "", "goal /nav-1 rejected: no way")]

    def test_tells_a_calibration_once_until_it_changes(self) -> None:
        info = {
            "header": {"frame_id": "lens", "stamp": {"sec": 1, "nanosec": 0}},
            "width": 640, "height": 480, "distortion_model": "plumb_bob", "d": [0.1, 0, 0, 0, 0],
            "k": [320.0, 0, 320, 0, 320, 240, 0, 0, 1],
        }  # fmt: skip
        reader = EventReader()
        assert said(reader, info) == [("INFO", "lens", "640 × 480 pixels, sees 90° × 74°, plumb_bob")]
        assert said(reader, info) == []
        assert len(said(reader, info | {"d": [0.2, 0, 0, 0, 0]})) == 1
        assert said(reader, info | {"k": [0] * 9}) == [("INFO", "lens", "640 × 480 pixels, not calibrated")]

    def test_reads_a_byte_in_base64_as_rosbridge_sends_it(self) -> None:
        assert said(EventReader(), status("motor", "Ag==", "stuck")) == [("ERROR", "motor", "stuck")]

    def test_tells_presses_and_releases_of_buttons_by_index(self) -> None:
        reader = EventReader()
        joy = [{"axes": [], "buttons": buttons} for buttons in ([0, 0, 1], [0, 0, 1], [1, 0, 0], [1, 0], [])]
        assert [[text for *_, text in said(reader, one)] for one in joy] == [
            ["button 2 pressed"],
            [],
            ["button 0 pressed", "button 2 released"],
            [],
            [],
        ]

    def test_tells_each_text_also_the_same_again(self) -> None:
        reader = EventReader("/chatter")
        assert said(reader, {"data": "hello"}) == [("INFO", "", "hello")]
        assert said(reader, {"data": "hello"}) == [("INFO", "", "hello")]
        assert said(reader, "by hand") == [("INFO", "", "by hand")]

    def test_tells_when_a_sensor_is_touched_and_released_but_not_that_it_never_was(self) -> None:
        reader = EventReader("/bumper")
        assert said(reader, {"left": False, "right": None}) == []
        assert said(reader, {"left": True, "right": False}) == [("INFO", "", "left touched")]
        assert said(reader, {"left": True}) == []
        assert said(reader, {"left": False}) == [("INFO", "", "left released")]

    def test_tells_the_end_of_a_touch_that_a_source_lists_no_more_at_its_time(self) -> None:
        reader = EventReader()
        touch = Touch({"left": True}, mode=TouchMode.PRESENCE)
        assert [at for at, _ in reader.read(touch, 1_000_000_000)] == [1_000_000_000]
        (released,) = reader.read(Touch({"right": True}, mode=TouchMode.PRESENCE), 5_000_000_000)[:1]
        assert (released[0], released[1].text) == (1_150_000_000, "left released")
        assert [(at, event.text) for at, event in reader.due(inf)] == [(5_150_000_000, "right released")]

    @pytest.mark.parametrize(
        ("message", "error", "text"),
        [
            ({"pose": 1}, TypeError, "expected text, a message like one of rcl_interfaces/Log.*the keys pose"),
            ({"msg": "x", "name": "n", "level": "much"}, ValueError, "level: expected a whole number, got 'much'"),
            ({"status": [{"name": "x", "level": b"", "message": ""}]}, ValueError, "level: expected a whole number"),
        ],
    )
    def test_says_what_it_cannot_read(self, message: Any, error: type[Exception], text: str) -> None:
        with pytest.raises(error, match=text):
            EventReader().read(message)


class TestLevels:
    def test_are_named_by_a_word_in_any_case_or_by_their_number(self) -> None:
        assert [to_level("level", one) for one in ("warn", "WARNING", 30, Level.WARN)] == [Level.WARN] * 4

    @pytest.mark.parametrize(
        ("given", "error"), [("loud", ValueError), (31, ValueError), (True, TypeError), (None, TypeError)]
    )
    def test_that_there_are_not_are_refused(self, given: Any, error: type[Exception]) -> None:
        with pytest.raises(error, match="level: expected"):
            to_level("level", given)

    def test_filter_with_words_of_text_or_source(self) -> None:
        event = Event("No Way", Level.WARN, "Planner")
        assert holds(event, None, "no w")
        assert holds(event, Level.WARN, "plan")
        assert not holds(event, Level.ERROR, "")
        assert not holds(event, None, "path")


class TestTheLog:
    def test_makes_one_row_of_events_that_repeat_each_other(self) -> None:
        log = EventLog(10, 100, 1000)
        for seconds, text in enumerate("aaaba"):
            log.add(Event(text), float(seconds))
        assert [(row.number, row.seconds, row.until, row.text, row.count) for row in log.rows] == [
            (0, 0.0, 2.0, "a", 3),
            (1, 3.0, 3.0, "b", 1),
            (2, 4.0, 4.0, "a", 1),
        ]
        assert (log.count, log.first, log.stop) == (5, 0, 3)

    def test_forgets_the_oldest_rows_beyond_its_rows_and_its_characters(self) -> None:
        log = EventLog(3, 4, 10)
        for i in range(5):
            log.add(Event(f"{i}"), float(i))
        assert ([row.text for row in log.rows], log.first) == (["2", "3", "4"], 2)
        for i in range(3):
            log.add(Event(f"{i}" + "x" * 1_000_000), 9.0)
        assert [(row.text, row.length) for row in log.rows] == [("1xxx", 1_000_001), ("2xxx", 1_000_001)]

    def test_texts_that_differ_beyond_the_kept_part_are_rows_of_their_own(self) -> None:
        log = EventLog(5, 4, 100)
        for seconds, text in enumerate(["aaaaa", "aaaaaa", "aaaaab", "aaaaab"]):
            log.add(Event(text), float(seconds))
        assert [(row.length, row.count) for row in log.rows] == [(5, 1), (6, 1), (6, 2)]

    def test_is_thinned_to_what_matters_most_and_evenly_where_not_all_have_room(self) -> None:
        log = EventLog(None, 100, 10**6)
        for i in range(100):
            log.add(Event(f"{i}", Level.ERROR if i == 70 else Level.WARN if i % 50 == 3 else Level.INFO), float(i))
        kept = thinned(log.rows, 13)
        assert [row.text for row in kept if row.level > Level.INFO] == ["3", "53", "70"]
        assert len(kept) == 13
        gaps = [b.number - a.number for a, b in pairwise(kept) if b.level == a.level]
        assert max(gaps) < 15
        assert thinned(log.rows, 100) == list(log.rows)

    def test_texts_of_errors_and_warnings_are_shortened_last(self) -> None:
        log = EventLog(None, 1000, None)
        for i in range(10):
            log.add(Event(f"{i}" * 1000, Level.ERROR if i == 5 else Level.INFO), float(i))
        by_level = {row.level: len(row.text) for row in shortened(log.rows, 3000)}
        assert by_level == {Level.ERROR: 1000, Level.INFO: 125}
        assert sum(len(row.text) for row in shortened(log.rows, 300)) <= 300

    def test_texts_are_shortened_until_all_have_room(self) -> None:
        log = EventLog(None, 1000, 10**6)
        for i in range(10):
            log.add(Event(f"{i}" * 1000), float(i))
        short = shortened(log.rows, 3000)
        assert {len(row.text) for row in short} == {250}
        assert {row.length for row in short} == {1000}
