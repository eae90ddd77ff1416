"""`MessageWidget`: packing of messages of any type, refusals, and the values that Python receives."""

from __future__ import annotations

import array
import base64
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from math import inf, isnan, nan
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any, ClassVar

import numpy as np
import pytest
from traitlets import TraitError

import robowidgets
from robowidgets import MessageWidget, Scan
from robowidgets.message import MOST_NUMBERS

from ..messages_made import Sent, header, made, sent, vector
from ..recordings.test_fields import recordings_in


@pytest.fixture
def widget() -> Iterator[MessageWidget]:
    made = MessageWidget(title="/imu")
    yield made
    made.close()


def test_a_sample_on_a_topic_of_another_type_has_its_own_fields(widget: MessageWidget) -> None:
    widget.set_source({"type": "nav_msgs/msg/Odometry"})
    widget.update(robowidgets.Speed((0.25, 0.0, 0.0), (0.0, 0.0, 0.5)))
    state = widget.get_state()
    got = Sent(state["_about"], bytes(state["_frame"])[32:])
    assert got.about["type"] == "Speed"
    assert {"linear", "angular"} <= got.nodes.keys()


def battery(**changed: Any) -> Any:
    fields = {
        "header": header(),
        **dict.fromkeys(("temperature", "current", "charge", "capacity", "design_capacity"), nan),
        "voltage": 16.21,
        "percentage": 0.867,
        "power_supply_status": 2,
        "power_supply_health": 1,
        "power_supply_technology": 3,
        "present": True,
        "cell_voltage": np.array([4.07, 4.05], np.float32),
        "cell_temperature": np.empty(0, np.float32),
        "location": "",
        "serial_number": "B-17",
    }
    return made("sensor_msgs/msg/BatteryState", **fields | changed)


class TestPackedContent:
    def test_is_each_field_with_its_type_its_unit_and_the_names_of_its_numbers(self) -> None:
        got = sent(battery())
        assert got.about["type"] == "sensor_msgs/BatteryState"
        assert got.nodes["voltage"] == {"name": "voltage", "kind": "number", "type": "float32", "unit": "V"}
        assert got.values["voltage"] == 16.21
        assert got.nodes["power_supply_status"]["names"]["2"] == "DISCHARGING"
        assert got.values["power_supply_status"] == 2
        assert got.values["charge"] == "nan"
        assert got.nodes["charge"]["unit"] == "Ah"
        assert got.values["present"] is True
        assert got.nodes["present"]["kind"] == "flag"
        assert got.nodes["header.stamp"]["kind"] == "time"
        assert got.values["header.stamp"] == [5, 250_000_000]
        assert got.values["header.frame_id"] == "base_link"
        assert got.about["frame_id"] == "base_link"
        assert got.values["cell_temperature"][0] == 0
        assert list(got.values) == [*dict.fromkeys(got.values)]

    def test_of_an_array_is_its_summary_and_its_numbers_which_nan_does_not_hide(self) -> None:
        ranges = np.array([0.2, nan, 5.0, inf, nan], np.float32)
        got = sent({"ranges": ranges})
        assert got.values["ranges"] == [5, float(np.float32(0.2)), 5.0, 2, 1, 0]
        assert got.array("ranges").tobytes() == ranges.tobytes()

    def test_of_many_numbers_is_a_summary_alone(self) -> None:
        got = sent({"data": np.arange(MOST_NUMBERS + 1, dtype=np.uint8)})
        assert got.values["data"] == [MOST_NUMBERS + 1, 0, 255, 0, 0, -1]
        assert got.array("data") is None
        assert len(got.packed) < 100

    def test_is_exact_where_a_page_would_round_or_json_has_no_number(self) -> None:
        got = sent({"big": 2**60 + 1, "small": -(2**60) - 1, "nan": nan, "low": -inf, "tenth": 0.1})
        assert got.values == {
            "big": str(2**60 + 1),
            "small": str(-(2**60) - 1),
            "nan": "nan",
            "low": "-inf",
            "tenth": 0.1,
        }
        arrays = sent({"a": np.array([2**60 + 1, -3], np.int64), "b": np.array([2**64 - 1], np.uint64)})
        assert arrays.array("a").tolist() == [2**60 + 1, -3]
        assert arrays.values["b"][1] == str(2**64 - 1)

    def test_of_a_long_text_is_its_beginning(self) -> None:
        got = sent({"text": "é" * 3_000_000, "half": "\ud800"})
        assert got.values["text"] == ["é" * 1000, 3_000_000]
        assert got.values["half"] == "?"
        assert len(got.packed) < 3000

    def test_of_2000_fields_within_a_message_is_their_number_until_they_are_asked_for(self) -> None:
        message = {"a": 1, "many": {f"f{i}": i for i in range(2000)}, "b": 2}
        got = sent(message)
        assert got.nodes["many"]["folded"] == 2000
        assert "children" not in got.nodes["many"]
        assert len(got.packed) < 100
        asked = sent(message, folds={"many": True})
        assert len(asked.nodes["many"]["children"]) == 2000
        assert asked.values["many.f1999"] == 1999

    def test_of_2000_fields_at_the_root_are_the_first_and_how_many_there_are(self) -> None:
        got = sent({f"f{i}": i for i in range(2000)})
        assert len(got.values) == 1000

    def test_of_a_long_array_of_messages_are_the_first_ones(self) -> None:
        message = {"list": [{"a": i} for i in range(500)]}
        got = sent(message)
        node = got.nodes["list"]
        assert (node["kind"], node["count"], len(node["children"]), node["more"]) == ("messages", 500, 32, 468)
        assert got.values["list[31].a"] == 31
        assert sent(message, folds={"list": True}).values["list[499].a"] == 499

    def test_of_fields_that_are_shown_alone_is_nothing_else(self) -> None:
        got = sent(battery(), fields=["percentage", "cell_voltage[1]", "header.frame_id"])
        assert got.values == {
            "percentage": 0.867,
            "cell_voltage[1]": float(np.float32(4.05)),
            "header.frame_id": "base_link",
        }
        assert got.nodes["percentage"]["type"] == "float32"

    def test_has_the_same_nodes_from_message_to_message_which_are_sent_once(self, widget: MessageWidget) -> None:
        widget.update(battery())
        first = widget.get_state()["_about"]
        widget.update(battery(voltage=15.0))
        assert widget.get_state()["_about"]["tree"] is first["tree"]

    def test_follows_a_type_that_changes_within_a_topic(self, widget: MessageWidget) -> None:
        widget.update({"a": 1})
        widget.get_state()
        widget.update({"a": "text", "b": [1.0]})
        state = widget.get_state()
        assert Sent(state["_about"], bytes(state["_frame"])[32:]).values["a"] == "text"


class TestAMessage:
    def test_of_rclpy_is_read_by_the_types_that_it_tells(self) -> None:
        class Status:  # as rosidl makes it: names with an underscore in its slots
            __slots__ = ("_header", "_level", "_names", "_values")
            __module__ = "my_msgs.msg._status"

            @classmethod
            def get_fields_and_field_types(cls) -> dict[str, str]:
                return {"level": "octet", "values": "sequence<double>", "names": "sequence<string>"}

            level, values, names = b"\x02", array.array("d", [0.5, nan]), ["a", "b"]

        got = sent(Status())
        assert got.values["values"][:4] == [2, 0.5, 0.5, 1]
        assert got.values["names"] == [2, ["a", "b"]]
        assert got.about["type"] == "my_msgs/Status"

    def test_of_rclpy_has_its_single_bytes_as_numbers_with_names(self) -> None:
        kind = type("DiagnosticStatus", (), {"__module__": "diagnostic_msgs.msg._diagnostic_status"})
        status: Any = kind()
        status.level, status.name, status.message, status.hardware_id, status.values = b"\x02", "lidar", "", "", []
        got = sent(status)
        assert got.values["level"] == 2
        assert got.nodes["level"]["names"]["2"] == "ERROR"

    @pytest.mark.parametrize(("level", "number"), [("Ag==", 2), (2, 2), ("much", "much")])
    def test_of_rosbridge_has_its_single_bytes_as_numbers_with_names(self, level: Any, number: Any) -> None:
        status = {"level": level, "name": "lidar", "message": "", "hardware_id": "", "values": []}
        got = sent(status, type="diagnostic_msgs/msg/DiagnosticStatus")
        assert got.values["level"] == number
        assert got.nodes["level"].get("names", {}).get("2") == ("ERROR" if number == 2 else None)

    def test_of_rospy_is_read_by_the_definition_that_it_carries(self) -> None:
        class Gauge:
            __slots__ = ("header", "level", "mode")
            _type = "my_msgs/Gauge"
            _full_text = "Header header\nfloat32 level\nuint8 MODE_OFF=0\nuint8 MODE_ON=1\nuint8 mode\n" + (
                "=" * 80 + "\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n"
            )

        gauge = Gauge()
        gauge.header = SimpleNamespace(seq=3, stamp=SimpleNamespace(secs=7, nsecs=5), frame_id="tank")
        gauge.level, gauge.mode = 0.5, 1
        got = sent(gauge)
        assert got.nodes["level"]["type"] == "float32"
        assert got.nodes["mode"]["names"] == {"0": "OFF", "1": "ON"}
        assert got.values["header.stamp"] == [7, 5]
        assert got.about["type"] == "my_msgs/Gauge"

    def test_of_rosbridge_has_null_for_nan_and_bytes_as_text(self) -> None:
        data = base64.b64encode(bytes([1, 2, 255])).decode()
        image = {"op": "publish", "msg": {"header": {}, "data": data, "encoding": "mono8"}}
        got = sent(image, type="sensor_msgs/msg/Image")
        assert got.array("data").tolist() == [1, 2, 255]
        assert got.about["keyed"]
        scan = sent({"ranges": [0.5, None, 1.0]}, type="sensor_msgs/LaserScan")
        assert scan.nodes["ranges"]["type"] == "float32"
        assert [isnan(value) for value in scan.array("ranges").tolist()] == [False, True, False]
        assert sent({"range": None}).values["range"] is None

    def test_may_be_a_dataclass_a_sample_or_any_object_with_fields(self) -> None:
        @dataclass
        class Arm:
            joints: tuple[float, float]
            is_open: bool
            KINDS: ClassVar = ("a", "b")

        assert sent(Arm((0.5, 1.5), True)).values == {"joints": [2, 0.5, 1.5, 0, 0, 0], "is_open": True}
        scan = Scan(np.ones(4, np.float32), 0.0, 0.1, 0.1, 10.0)
        assert sent(scan).values["ranges"][0] == 4
        assert sent(SimpleNamespace(x=1, inner=SimpleNamespace(y="two"))).values["inner.y"] == "two"

    def test_of_a_recording_belongs_to_its_moment(self) -> None:
        with robowidgets.open(robowidgets.SAMPLE) as recording:
            moment = recording.message_at("/odom", 5.0)
            assert moment is not None
            got = sent(moment)
            assert got.values["twist.twist.linear.x"] == moment.message.twist.twist.linear.x
            assert got.nodes["twist.twist.linear.x"]["unit"] == "m/s"

    @pytest.mark.parametrize("wrong", [3, "text", None, [1, 2], b"raw", {}])
    def test_that_is_invalid_is_refused(self, widget: MessageWidget, wrong: Any) -> None:
        with pytest.raises(TypeError, match=r"expected a message with fields, such as \{'speed': 0.3\}, got"):
            widget.update(wrong)

    def test_may_hold_anything_which_is_named(self) -> None:
        got = sent({"module": ModuleType("odd"), "set": {1}, "mixed": [1, "a", {"b": 2}], "matrix": np.eye(2)})
        assert got.values["set"] == "{1}"
        assert got.values["mixed[2].b"] == 2
        assert got.array("matrix[1]").tolist() == [0.0, 1.0]


class TestFieldsThatDoNotExist:
    def test_are_an_error_with_the_nearest_names(self) -> None:
        widget = MessageWidget(fields=["angular_velocity.w"])
        with pytest.raises(
            ValueError, match=r"no field 'angular_velocity.w'; did you mean 'angular_velocity.[xyz]' or"
        ):
            widget.update(SimpleNamespace(angular_velocity=vector(0, 0, 1)))
        widget.close()

    def test_are_a_note_where_others_exist(self) -> None:
        got = sent({"voltage": 3.0, "x": [1]}, fields=["voltage", "volts", "x[3]"])
        assert got.values == {"voltage": 3.0}
        (note,) = got.about["notes"]
        assert note.startswith("no field 'volts'; did you mean 'voltage'? There, the message has voltage, x")

    @pytest.mark.parametrize(
        ("path", "error"),
        [
            ("a.b.d", "no field 'a.b.d'; did you mean 'a.b.c'? There, a.b has c"),
            ("a.list[7]", "a.list[7]: no list[7] in the message; its arrays are shorter"),
            ("z", "no field 'z'; the message has a"),
            ("a.list.x", "no field 'a.list.x'; a.list is a list: '[1, 2]'"),
        ],
    )
    def test_are_a_key_error_where_a_program_asks(self, widget: MessageWidget, path: str, error: str) -> None:
        widget.update({"a": {"b": {"c": 1}, "list": [1, 2]}})
        assert widget["a.list[1]"] == 2
        with pytest.raises(KeyError) as caught:
            widget[path]
        assert caught.value.args[0] == error

    def test_are_refused_where_they_are_too_many(self) -> None:
        with pytest.raises(TraitError, match="fields: expected the paths of at most 32 fields, got 33"):
            MessageWidget(fields=[f"f{i}" for i in range(33)])


class TestPython:
    def test_hears_the_message_on_show_the_frozen_one_while_paused(self, widget: MessageWidget) -> None:
        first, second = battery(), battery(voltage=15.0)
        widget.update(first)
        widget.paused = True
        widget.update(second)
        assert widget.message is first
        assert widget.frozen is first
        assert widget["voltage"] == 16.21
        widget.paused = False
        assert widget.message is second
        assert widget.frozen is None

    def test_hears_the_message_to_which_the_user_stepped_back(self, widget: MessageWidget) -> None:
        messages = [battery(voltage=float(i)) for i in range(3)]
        frames = []
        for message in messages:
            widget.update(message)
            frames.append(bytes(widget.get_state()["_frame"]))
        widget.paused = True
        widget._frozen_frame = frames[1]
        assert widget.message is messages[1]

    def test_keeps_few_large_messages(self, widget: MessageWidget) -> None:
        for i in range(8):
            widget.update({"i": i, "data": np.zeros(10_000_000, np.uint8)})
            widget.get_state()
        assert sum(size for _, _, size in widget._kept) < 40_000_000

    def test_waits_for_the_next_message_and_judges_conditions_on_it(self, widget: MessageWidget) -> None:
        low = widget.watch(lambda message: message.percentage < 0.2, name="low")
        message = battery(percentage=0.1)
        widget.update(message)
        assert widget.wait(1) is message
        assert low.wait(60)

    def test_reads_no_definition_for_a_dictionary(self) -> None:
        code = "import sys, robowidgets\nw = robowidgets.MessageWidget()\nw.update({'a': 1})\nw.get_state()\n"
        code += "assert not any(name.startswith('rosbags') for name in sys.modules)"
        subprocess.run([sys.executable, "-c", code], check=True)


def differences(value: Any, got: Sent, path: str) -> Iterator[str]:
    """The paths at which the page's values differ from a message of rosbags."""
    if hasattr(value, "__msgtype__"):
        if path in got.nodes and got.nodes[path]["kind"] == "time":
            if got.values[path] != [value.sec, value.nanosec]:
                yield path
            return
        for name in value.__dataclass_fields__:
            inner = f"{path}.{name}" if path else name
            if name == "__msgtype__" or (name.isupper() and inner not in got.nodes):  # constants
                continue
            yield from differences(getattr(value, name), got, inner)
        return
    if "structure_needs_at_least_one_member" in path:
        return
    if isinstance(value, np.ndarray):
        page = got.array(path)
        if (page is None) != (len(value) > MOST_NUMBERS) or (page is not None and page.tobytes() != value.tobytes()):
            yield path
    elif isinstance(value, list) and value and hasattr(value[0], "__msgtype__"):
        for i, one in enumerate(value):
            yield from differences(one, got, f"{path}[{i}]")
    elif isinstance(value, list):
        if got.values[path] != ([len(value), value[:32]] if value else []):
            yield path
    elif isinstance(value, float) and isnan(value):
        if got.values[path] != "nan":
            yield path
    elif isinstance(value, str):
        if got.values[path] != (value if len(value) <= 1000 else [value[:1000], len(value)]):
            yield path
    elif float(got.values[path]) != value or type(got.values[path]) not in (type(value), str):
        yield path


@pytest.mark.slow
def test_the_page_has_each_number_of_real_recordings_to_the_last_bit(data: Path) -> None:
    compared = 0
    for path in recordings_in(data / "topics") + recordings_in(data / "good"):
        with robowidgets.open(path) as recording:
            for topic in recording.topics:
                if topic.problem or not topic.count:
                    continue
                for moment in islice(recording.messages(topic.name), 8):
                    got = _all_of(moment.message)
                    wrong = list(islice(differences(moment.message, got, ""), 5))
                    assert not wrong, (path.name, topic.name, wrong)
                    compared += len(got.values)
    assert compared > 10_000


def _all_of(message: Any) -> Sent:
    """The message data in the page after the user has unfolded all of it."""
    widget = MessageWidget()
    try:
        while True:
            got = Sent(*widget.frame_of(message))
            asked = {path for path, node in got.nodes.items() if {"folded", "more"} & node.keys()}
            asked |= {path for path, node in got.nodes.items() if node["kind"] == "numbers"}
            if asked <= widget.folds.keys():
                return got
            widget.folds = dict.fromkeys({*widget.folds, *asked}, True)
    finally:
        widget.close()
