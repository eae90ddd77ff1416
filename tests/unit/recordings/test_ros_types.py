"""Messages from bytes, with any definition in the file."""

from __future__ import annotations

import struct
from typing import Any

import pytest

from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import DecodeError, decoder_of, shape_of


def channel(name: str, definition: str = "", encoding: str = "cdr") -> Channel:
    return Channel(1, "/topic", name, encoding, definition, 1)


def read(raw: bytes, name: str, definition: str = "", encoding: str = "cdr") -> Any:
    return decoder_of(channel(name, definition, encoding))(raw)


def test_a_type_is_read_by_the_definition_in_the_file() -> None:
    message = read(b"\0\1\0\0\x07\x09", "my_msgs/msg/Pair", "uint8 first\nuint8 second\n")
    assert (message.first, message.second) == (7, 9)


def test_a_type_without_a_definition_is_read_by_ours() -> None:
    message = read(b"\0\1\0\0\x02\x01", "kobuki_ros_interfaces/msg/BumperEvent")
    assert (message.bumper, message.state) == (2, 1)


def test_a_type_without_a_definition_is_read_by_the_definition_of_ros() -> None:
    assert read(b"\0\1\0\0\x01", "std_msgs/msg/Bool").data is True
    header = struct.pack("<IIII", 5, 1, 2, 3) + b"map"
    assert read(header, "std_msgs/msg/Header", encoding="ros1").frame_id == "map"


def test_types_that_a_definition_uses_and_leaves_out_are_those_of_ros() -> None:
    message = read(b"\0\1\0\0" + struct.pack("<3d", 1, 2, 3), "my_msgs/msg/Push", "geometry_msgs/Vector3 force\n")
    assert message.force.z == 3.0


def test_constants_are_not_fields_however_they_are_named() -> None:
    definition = "uint8 Button0 = 0\nuint8 Button1 = 1\nstring NAME=#1 = one\n\nuint8 button\nuint8 state\n"
    message = read(b"\x01\x01", "kobuki_msgs/msg/ButtonEvent", definition, "ros1")
    assert (message.button, message.state) == (1, 1)


def test_definitions_from_windows_and_in_idl_are_read() -> None:
    assert read(b"\0\1\0\0\x07", "my_msgs/msg/One", "# one\r\nuint8 value\r\n").value == 7
    idl = "=" * 80 + "\nIDL: my_msgs/msg/One\nmodule my_msgs { module msg { struct One { uint8 value; }; }; };\n"
    assert read(b"\0\1\0\0\x07", "my_msgs/msg/One", idl).value == 7


def test_a_definition_that_cannot_be_understood_gives_way_to_a_known_one() -> None:
    assert read(b"\0\1\0\0\x01", "std_msgs/msg/Bool", "this is --- no definition").data is True


def test_two_definitions_of_one_type_in_a_file_each_hold_for_their_own() -> None:
    short = decoder_of(channel("my_msgs/msg/Point", "uint8 x\n"))
    long = decoder_of(channel("my_msgs/msg/Point", "uint16 x\n"))
    assert (short(b"\0\1\0\0\x07").x, long(b"\0\1\0\0\x07\x01").x) == (7, 263)


def test_a_type_that_no_file_defines_is_read_as_its_encoding_has_it() -> None:
    stamp = struct.pack("<II", 5, 6)
    new = decoder_of(channel("std_msgs/msg/Header"))(b"\0\1\0\0" + stamp + struct.pack("<I", 4) + b"map\0")
    old = decoder_of(channel("std_msgs/msg/Header", encoding="ros1"))(
        struct.pack("<I", 7) + stamp + struct.pack("<I", 3) + b"map"
    )
    assert (new.frame_id, new.stamp.sec, old.frame_id, old.seq) == ("map", 5, "map", 7)


@pytest.mark.parametrize("definition", ["", "int64 a\n---\nint64 sum\n"])
def test_an_unknown_type_is_refused(definition: str) -> None:
    with pytest.raises(DecodeError, match=r"nor among those that are known|no other is known"):
        decoder_of(channel("led_array_msgs/msg/Status", definition))
    with pytest.raises(DecodeError, match=r"nor among those that are known|no other is known"):
        shape_of(channel("led_array_msgs/msg/Status", definition))


@pytest.mark.parametrize("raw", [b"", b"\0\1\0\0", b"\xff" * 40, b"\0\1\0\0" + b"\xff" * 30])
def test_bytes_that_are_not_such_a_message_are_refused_in_a_line(raw: bytes) -> None:
    with pytest.raises(DecodeError, match=r"^\d+ bytes are not a valid sensor_msgs/msg/LaserScan: ") as caught:
        read(raw, "sensor_msgs/msg/LaserScan")
    assert "\n" not in str(caught.value)


def test_a_message_that_ends_early_is_refused_in_plain_words() -> None:
    with pytest.raises(
        DecodeError, match=r"^7 bytes are not a valid sensor_msgs/msg/LaserScan: they end within a field$"
    ):
        read(b"\0\1\0\0\0\0\0", "sensor_msgs/msg/LaserScan")


def test_a_shape_names_every_field_down_to_the_numbers() -> None:
    definition = "std_msgs/Header header\nfloat32[] ranges\nfloat64[36] covariance\ngeometry_msgs/Point[] points\n"
    shape = shape_of(channel("my_msgs/msg/All", definition))
    assert shape == {
        "header": {"stamp": "Time", "frame_id": "string"},
        "ranges": "float32[]",
        "covariance": "float64[36]",
        "points": "geometry_msgs/msg/Point[]",
    }
