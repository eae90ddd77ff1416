"""MCAP files from other programs than ROS's recorder: names, summaries and definitions."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from mcap.writer import Writer
from rosbags.typesys import Stores, get_typestore

import robowidgets
from robowidgets.messages.encoding import encode

START_NS = 1_700_000_000_000_000_000
SCAN = {
    "angle_min": -1.0,
    "angle_max": 1.0,
    "angle_increment": 0.1,
    "range_min": 0.1,
    "range_max": 10.0,
    "ranges": np.full(21, 2.0, np.float32),
}
STORE = get_typestore(Stores.ROS2_HUMBLE)


def text_of(name: str) -> bytes:
    """The text of the definition of a type."""
    return STORE.generate_msgdef(name, ros_version=2)[0].encode()


def write(
    path: Path,
    topics: Mapping[str, tuple[str, str, bytes, str]],
    messages: Iterable[tuple[float, str, bytes]],
    profile: str = "ros2",
    **options: Any,
) -> Path:
    """An MCAP file; each topic has the name, the language and the text of its schema, and an encoding."""
    with path.open("wb") as file:
        writer = Writer(file, **options)
        writer.start(profile, "test")
        channels = {
            topic: writer.register_channel(topic, encoding, writer.register_schema(name, language, text))
            for topic, (name, language, text, encoding) in topics.items()
        }
        for seconds, topic, raw in messages:
            time_ns = START_NS + round(seconds * 1e9)
            writer.add_message(channels[topic], time_ns, raw, time_ns)
        writer.finish()
    return path


def scans(count: int = 40) -> list[tuple[float, str, bytes]]:
    return [(i / 10, "/scan", encode("cdr", "sensor_msgs/msg/LaserScan", SCAN)) for i in range(count)]


def test_a_schema_name_of_two_parts_is_the_name_of_the_type(tmp_path: Path) -> None:
    scan = ("sensor_msgs/LaserScan", "ros2msg", text_of("sensor_msgs/msg/LaserScan"), "cdr")
    number = ("std_msgs/Float64", "ros2msg", b"float64 data", "cdr")
    numbers = [(i / 10, "/v", encode("cdr", "std_msgs/msg/Float64", {"data": i})) for i in range(40)]
    with robowidgets.open(write(tmp_path / "x.mcap", {"/scan": scan, "/v": number}, scans() + numbers)) as recording:
        assert [topic.type for topic in recording.topics] == ["sensor_msgs/msg/LaserScan", "std_msgs/msg/Float64"]
        assert recording.scans().ranges.shape == (40, 21)
        assert recording.fields("/v")["data"].tolist() == list(range(40))
        assert "!" not in recording.info()


def test_public_converters_files_are_read(data: Path) -> None:
    with robowidgets.open(data / "reports/mcap_two_part_names/two_part.mcap") as recording:
        assert {topic.name: topic.count for topic in recording.topics} == dict.fromkeys(
            ("/scan", "/odom", "/v", "/text", "/joints"), 40
        )
        assert (len(recording.scans()), len(recording.speeds())) == (40, 40)
        assert len(recording.fields("/joints")) == len(list(recording.messages("/text"))) == 40
        assert "!" not in recording.info()


@pytest.mark.parametrize(
    "left_out",
    [
        dict.fromkeys(names, False)
        for count in (1, 2)
        for names in itertools.combinations(
            ("repeat_channels", "repeat_schemas", "use_statistics", "use_summary_offsets"), count
        )
    ],
    ids=" ".join,
)
@pytest.mark.parametrize("chunks", [True, False], ids=["chunks", "no chunks"])
def test_a_summary_that_leaves_something_out_loses_no_message(
    tmp_path: Path, left_out: dict[str, bool], chunks: bool
) -> None:
    kind = ("sensor_msgs/msg/LaserScan", "ros2msg", text_of("sensor_msgs/msg/LaserScan"), "cdr")
    path = write(tmp_path / "x.mcap", {"/scan": kind}, scans(), use_chunking=chunks, chunk_size=2000, **left_out)
    with robowidgets.open(path) as recording:
        assert recording.scans().ranges.shape == (40, 21)
        assert recording.duration == pytest.approx(3.9)
        assert recording.problems == ()


IDL = """\
================================================================================
IDL: my_msgs/msg/Battery
// generated from my_msgs/msg/Battery.msg
#include "std_msgs/msg/Header.idl"

module my_msgs {
  module msg {
    module Battery_Constants {
      const uint8 FULL = 2;
    };
    typedef double double__4[4];
    @verbatim (language="comment", text=
      "#1 of the batteries")
    struct Battery {
      std_msgs::msg::Header header;
      @unit (value="V")
      float voltage;
      sequence<float> cells;
      string<16> name;
      double__4 matrix;
      boolean charging;
    };
  };
};
================================================================================
IDL: std_msgs/msg/Header
#include "builtin_interfaces/msg/Time.idl"
module std_msgs {
  module msg {
    struct Header {
      builtin_interfaces::msg::Time stamp;
      string frame_id;
    };
  };
};
================================================================================
IDL: builtin_interfaces/msg/Time
module builtin_interfaces {
  module msg {
    struct Time {
      int32 sec;
      uint32 nanosec;
    };
  };
};
"""
MSG = "std_msgs/Header header\nfloat32 voltage\nfloat32[] cells\nstring<=16 name\nfloat64[4] matrix\nbool charging\n"


@pytest.mark.parametrize("line_end", ["\n", "\r\n"], ids=["LF", "CR LF"])
def test_an_own_type_in_idl_is_read_by_its_definition(tmp_path: Path, line_end: str) -> None:
    held = [
        {"voltage": 12.5 - i / 100, "cells": [4.0] * i, "name": f"no. {i}", "matrix": [1.0, 2.0, 3.0, i]}
        for i in range(5)
    ]
    raws = [(i / 10, "/battery", encode("cdr", "my_msgs/msg/Battery", one, MSG)) for i, one in enumerate(held)]
    schema = ("my_msgs/msg/Battery", "ros2idl", IDL.replace("\n", line_end).encode(), "cdr")
    with robowidgets.open(write(tmp_path / "x.mcap", {"/battery": schema}, raws)) as recording:
        read = [one.message for one in recording.messages("/battery")]
        assert [(one.name, len(one.cells), one.matrix[3]) for one in read] == [(f"no. {i}", i, i) for i in range(5)]
        assert recording.fields("/battery")["voltage"].tolist() == pytest.approx([12.5, 12.49, 12.48, 12.47, 12.46])


def test_idl_of_a_recorder_is_read(data: Path) -> None:
    with robowidgets.open(data / "reports/mcap_ros2idl/ros2idl.mcap") as recording:
        voltage = recording.fields("/battery")["voltage"]
        assert (len(voltage), voltage[0], voltage[-1]) == (30, pytest.approx(12.5), pytest.approx(12.21))
        assert len(recording.scans("/scan")) == 30
        assert "!" not in recording.info()


@pytest.mark.parametrize("profile", ["", "ros1", "ros2"])
def test_a_file_with_an_index_is_not_walked_through_whatever_its_profile_and_its_languages(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, profile: str
) -> None:
    topics = {
        "/scan": ("sensor_msgs/msg/LaserScan", "ros2msg", text_of("sensor_msgs/msg/LaserScan"), "cdr"),
        "/state": ("State", "jsonschema", b"{}", "json"),
    }
    states = [(i / 10, "/state", b'{"gear": %d}' % i) for i in range(40)]
    path = write(tmp_path / "drive.mcap", topics, sorted([*scans(), *states]), profile)
    whole = topics_and_values(path)

    def refused(*_: Any) -> None:
        raise AssertionError("the file is walked through")

    monkeypatch.setattr("robowidgets.files.open_repaired", refused)
    assert topics_and_values(path) == whole
    assert whole[1] == [float(i) for i in range(40)]


def topics_and_values(path: Path) -> tuple[Any, list[float], int]:
    with robowidgets.open(path) as recording:
        assert not recording.problems
        gears = [moment.message.gear for moment in recording.messages("/state")]
        return recording.topics, gears, len(recording.scans())
