"""Every field of any topic as a column, and the messages themselves."""

from __future__ import annotations

import re
import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

import robowidgets
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import decoder_of, store_of
from robowidgets.messages.layout import FieldPath, Layouts
from robowidgets.recordings.columns._fields import Fields, UnknownFieldError

from . import recorded

IMU = "sensor_msgs/msg/Imu"
JOINTS = "sensor_msgs/msg/JointState"
BATTERY = "sensor_msgs/msg/BatteryState"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
LOOKED_AT = 50
"""Messages of each topic: from its beginning to its end, or all if it has fewer."""
SUFFIXES = {".bag", ".db3", ".mcap", ".gz", ".zstd"}


def recordings_in(data: Path) -> list[Path]:
    """The files and folders of all real recordings."""
    files = sorted(path for path in data.rglob("*") if path.suffix in SUFFIXES)
    return list(dict.fromkeys(path.parent if (path.parent / "metadata.yaml").exists() else path for path in files))


def values_at(value: Any, path: str) -> Iterator[Any]:
    """The values of a field in a message as rosbags read it, in order; arrays of numbers unchanged."""
    name, _, rest = path.partition(".")
    inner = getattr(value, name.removesuffix("[]"))
    for one in inner if name.endswith("[]") else [inner]:
        if rest:
            yield from values_at(one, rest)
        elif isinstance(one, list):
            yield from (item.sec * 10**9 + item.nanosec if hasattr(item, "nanosec") else item for item in one)
        elif hasattr(one, "nanosec"):
            yield one.sec * 10**9 + one.nanosec
        else:
            yield one


def bits(values: list[Any]) -> list[Any]:
    """Comparable values: NaN differs from itself, and -0.0 equals 0.0, so compare their bits."""
    return [struct.pack("<d", value) if isinstance(value, float) else value for value in values]


def assert_equal(column: Any, messages: Sequence[Any], name: str) -> None:
    """Fail unless a column holds the values and the type of a field in messages that rosbags read."""
    for row, message in zip(column, messages, strict=True):
        expected = list(values_at(message, name))
        if expected and isinstance(expected[0], np.ndarray):
            array = np.concatenate(expected)
            assert (row.dtype, row.tobytes()) == (array.dtype, array.tobytes()), name
        else:
            found = row.tolist() if isinstance(row, (np.ndarray, np.generic)) else row
            assert bits(found if isinstance(found, list) else [found]) == bits(expected), name


@pytest.mark.slow
def test_every_field_of_every_topic_matches_rosbags_to_the_last_bit(data: Path) -> None:
    topics = columns = 0
    for path in recordings_in(data):
        try:
            recording = robowidgets.open(path)
        except robowidgets.RecordingError:
            continue  # nothing in it can be read
        with recording:
            for topic in recording.topics:
                if topic.problem or not topic.count:
                    continue
                fields = recording.fields(topic.name)
                assert len(fields) == topic.count or recording.problems
                every = -(-len(fields) // LOOKED_AT)
                messages = [fields[row].message for row in range(0, len(fields), every)]
                for name, column in fields._columns(fields.names).items():
                    assert_equal(column[::every], messages, name)
                    columns += 1
                topics += 1
    assert topics > 150
    assert columns > 2000


def imu(folder: Path) -> Path:
    messages = [
        (0.1 * i, "/imu", {"header": recorded.stamped(10**9 * i + 5, "body"), "linear_acceleration": {"x": i / 3}})
        for i in range(10)
    ]
    return recorded.write(folder, {"/imu": IMU}, messages)


@pytest.fixture
def fields(tmp_path: Path) -> Fields:
    return robowidgets.open(imu(tmp_path / "x")).fields("/imu")


def test_a_number_is_a_column_of_its_own_type(fields: Fields) -> None:
    column = fields["linear_acceleration.x"]
    assert column.dtype == np.float64
    assert column.tolist() == [i / 3 for i in range(10)]


def test_times_are_nanoseconds_and_their_parts_are_there_too(fields: Fields) -> None:
    assert fields["header.stamp"].tolist() == [10**9 * i + 5 for i in range(10)]
    assert fields["header.stamp.sec"].tolist() == list(range(10))
    assert fields["header.stamp.nanosec"].tolist() == [5] * 10
    assert fields.stamps_ns.tolist() == fields["header.stamp"].tolist()


def test_text_is_a_column(fields: Fields) -> None:
    assert fields["header.frame_id"].tolist() == ["body"] * 10


def test_an_array_of_fixed_length_has_a_column_for_each_number(fields: Fields) -> None:
    assert fields["orientation_covariance"].shape == (10, 9)
    assert fields["orientation_covariance[8]"].shape == (10,)


def test_messages_have_their_times(fields: Fields) -> None:
    moment = fields[3]
    assert (moment.topic, moment.seconds) == ("/imu", pytest.approx(0.3))
    assert moment.message.linear_acceleration.x == 1.0
    assert fields.at(0.52).message.linear_acceleration.x == 5 / 3
    assert [moment.message.linear_acceleration.x for moment in fields[2:4]] == [2 / 3, 1.0]


def test_names_select_columns_and_the_name_of_a_message_those_in_it(fields: Fields) -> None:
    some = fields[["linear_acceleration", "header.stamp"]].between(0.2, 0.4)
    assert some.names == ("linear_acceleration.x", "linear_acceleration.y", "linear_acceleration.z", "header.stamp")
    assert list(some.to_numpy()) == ["times_ns", "seconds", "stamps_ns", *some.names]
    assert some["linear_acceleration.x"].tolist() == [2 / 3, 1.0]


def test_types_match_the_definition(fields: Fields) -> None:
    assert list(fields.types.items())[:4] == [
        ("header.stamp", "time"),
        ("header.frame_id", "string"),
        ("orientation.x", "float64"),
        ("orientation.y", "float64"),
    ]
    assert fields.types["orientation_covariance"] == "float64[9]"


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("linear_acceleration.w", "did you mean 'linear_acceleration.z' or "),
        ("linear_accelaration.x", "did you mean 'linear_acceleration.x'"),
        ("frame_id", "did you mean 'header.frame_id'? Its fields are header{stamp, frame_id}, orientation{x, y, z, w}"),
        (
            "linear_acceleration",
            "is not a single field but a message: name fields in it, such as 'linear_acceleration.x'",
        ),
        ("header.frame_id[0]", "no field 'header.frame_id[0]'"),
        ("header.stamp.nsec", "no field"),
        ("orientation_covariance[9]", "no message has 'orientation_covariance[9]': its arrays are shorter"),
        ("<script>alert(1)</script>", "no field '<script>alert(1)</script>'. Its fields"),
        ("", "no field ''"),
    ],
)
def test_a_field_that_does_not_exist_is_an_error_with_the_nearest_names_and_the_tree(
    fields: Fields, name: str, says: str
) -> None:
    with pytest.raises(UnknownFieldError, match=re.escape(says)):
        fields[name]
    assert isinstance(fields["linear_acceleration.x"], np.ndarray)


def test_arrays_whose_length_changes_are_values_of_one_column(tmp_path: Path) -> None:
    messages = [
        (0.0, "/joints", {"name": ["a", "b"], "position": [1.0, 2.0]}),
        (1.0, "/joints", {"name": [], "position": []}),
        (2.0, "/joints", {"name": ["a", "bcd", "é"], "position": [3.0, float("nan"), 5.0]}),
    ]
    fields = robowidgets.open(recorded.write(tmp_path / "x", {"/joints": JOINTS}, messages)).series("/joints")
    assert isinstance(fields, Fields)
    assert [row.tolist() for row in fields["position"][:2]] == [[1.0, 2.0], []]
    assert np.array_equal(fields["position[0]"], [1.0, np.nan, 3.0], equal_nan=True)
    assert np.array_equal(fields["position[2]"], [np.nan, np.nan, 5.0], equal_nan=True)
    assert fields["name"].tolist() == [["a", "b"], [], ["a", "bcd", "é"]]
    assert fields["name[1]"].tolist() == ["b", None, "bcd"]
    assert fields[::2]["position"].dtype == object
    assert fields[:1]["position"].tolist() == [[1.0, 2.0]]


def test_fields_of_messages_in_arrays_are_reached_for_all_and_for_one(tmp_path: Path) -> None:
    def status(level: int, *keys: str) -> dict[str, Any]:
        return {"level": level, "values": [{"key": key} for key in keys]}

    messages = [
        (0.0, "/diagnostics", {"status": [status(0, "a"), status(2, "b", "c")]}),
        (1.0, "/diagnostics", {"status": [status(1)]}),
    ]
    fields = robowidgets.open(recorded.write(tmp_path / "x", {"/diagnostics": DIAGNOSTICS}, messages)).fields(
        "/diagnostics"
    )
    assert [row.tolist() for row in fields["status[].level"]] == [[0, 2], [1]]
    assert fields["status[0].level"].tolist() == [0, 1]
    assert fields["status[1].level"].tolist() == [2, None]
    assert np.ma.isMaskedArray(fields["status[1].level"])
    assert fields["status[].values[].key"].tolist() == [["a", "b", "c"], []]
    assert fields["status[1].values[].key"].tolist() == [["b", "c"], []]
    assert fields["status[].values[0].key"].tolist() == [["a", "b"], []]
    assert fields["status[1].values[1].key"].tolist() == ["c", None]


@pytest.mark.parametrize("plugin", [StoragePlugin.MCAP, StoragePlugin.SQLITE3])
def test_a_topic_that_has_a_widget_keeps_its_series_and_has_fields_too(tmp_path: Path, plugin: StoragePlugin) -> None:
    messages = [(i, "/odom", {"pose": {"pose": {"position": {"x": i}}}}) for i in range(3)]
    path = recorded.write(tmp_path / "x", {"/odom": "nav_msgs/msg/Odometry"}, messages, plugin)
    with robowidgets.open(path) as recording:
        assert type(recording.series("/odom")).__name__ == "Speeds"
        fields = recording.fields("/odom")
        assert fields["pose.pose.position.x"].tolist() == [0, 1, 2]
        assert fields["pose.covariance"].shape == (3, 36)
        at = recording.message_at("/odom", 1.5)
        assert at is not None
        assert at.message.pose.pose.position.x == 1
        assert recording.message_at("/odom", -1) is None
        assert [one.message.pose.pose.position.x for one in recording.messages("/odom", 1, 2)] == [1]
        assert recording[1:2].fields("/odom")["pose.pose.position.x"].tolist() == [1]
        assert [one.seconds for one in recording[1:].messages("/odom")] == [1, 2]


def test_tables_have_every_field(tmp_path: Path) -> None:
    messages = [
        (0.0, "/battery", {"voltage": 12.5, "present": True, "cell_voltage": [3.1, 3.2], "location": "left"}),
        (1.0, "/battery", {"voltage": 12.0, "present": False, "cell_voltage": [3.0], "location": ""}),
    ]
    fields = robowidgets.open(recorded.write(tmp_path / "x", {"/battery": BATTERY}, messages)).fields("/battery")
    pandas = pytest.importorskip("pandas")
    frame = fields.to_pandas()
    assert frame["voltage"].tolist() == [12.5, 12.0]
    assert frame["location"].tolist() == ["left", ""]
    assert frame["present"].tolist() == [True, False]
    assert [list(cells) for cells in frame["cell_voltage"]] == [pytest.approx([3.1, 3.2]), [3.0]]
    assert isinstance(frame, pandas.DataFrame)
    pytest.importorskip("polars")
    assert fields.to_polars()["cell_voltage"].to_list()[1] == [3.0]
    pytest.importorskip("pyarrow")
    table = fields.to_arrow()
    assert table["location"].to_pylist() == ["left", ""]
    assert fields[["cell_voltage[1]", "voltage"]].to_arrow()["voltage"].to_pylist() == [12.5, 12.0]


def test_a_frame_of_pandas_has_a_column_for_each_number_of_a_fixed_array(fields: Fields) -> None:
    pytest.importorskip("pandas")
    frame = fields[["angular_velocity_covariance", "header.stamp"]].to_pandas()
    assert list(frame) == [*(f"angular_velocity_covariance[{i}]" for i in range(9)), "header.stamp"]


def test_missing_integers_are_missing_in_tables(tmp_path: Path) -> None:
    messages = [(0.0, "/diagnostics", {"status": [{"level": 2}]}), (1.0, "/diagnostics", {})]
    fields = robowidgets.open(recorded.write(tmp_path / "x", {"/diagnostics": DIAGNOSTICS}, messages)).fields(
        "/diagnostics"
    )[["status[0].level"]]
    pandas = pytest.importorskip("pandas")
    assert fields.to_pandas()["status[0].level"].tolist() == [2, pandas.NA]
    arrow = pytest.importorskip("pyarrow")
    column = fields.to_arrow()["status[0].level"]
    assert column.to_pylist() == [2, None]
    assert column.type == arrow.int8()
    polars = pytest.importorskip("polars")
    assert fields.to_polars()["status[0].level"].to_list() == [2, None]
    assert fields.to_polars()["status[0].level"].dtype == polars.Int8


LENGTHS = {"none": [], "equal": [2, 2], "several": [2, 0, 3]}
"""The fields of the arrays in each message."""


def lists_of(folder: Path, lengths: list[int]) -> Fields:
    messages = [
        (float(i), "/joints", {"name": ["wheel"] * length, "position": [0.5] * length})
        for i, length in enumerate(lengths)
    ]
    return robowidgets.open(recorded.write(folder, {"/joints": JOINTS}, messages)).fields("/joints")


@pytest.mark.parametrize("lengths", LENGTHS.values(), ids=LENGTHS)
def test_a_column_of_a_table_has_the_type_of_the_field_whatever_the_messages_hold(
    tmp_path: Path, lengths: list[int]
) -> None:
    fields = lists_of(tmp_path / "x", lengths)[["header.frame_id", "name", "position"]]
    pandas, polars = pytest.importorskip("pandas"), pytest.importorskip("polars")
    arrow = pytest.importorskip("pyarrow")
    names = [["wheel"] * length for length in lengths]
    table = fields.to_arrow()
    assert table.schema.types[3:] == [arrow.string(), arrow.list_(arrow.string()), arrow.list_(arrow.float64())]
    assert table["name"].to_pylist() == names
    assert table["position"].to_pylist() == [[0.5] * length for length in lengths]
    frame = fields.to_polars()
    assert frame.dtypes[3:] == [polars.String, polars.List(polars.String), polars.List(polars.Float64)]
    assert frame["name"].to_list() == names
    assert frame["position"].to_list() == [[0.5] * length for length in lengths]
    texts = pandas.Series(["a"]).dtype
    assert fields.to_pandas().dtypes.tolist() == [texts, object, object]
    assert [list(one) for one in fields.to_pandas()["name"]] == names


def test_arrays_of_any_length_take_as_many_bytes_in_a_table_as_in_the_messages(tmp_path: Path) -> None:
    topics = {"/bytes": "std_msgs/msg/UInt8MultiArray", "/floats": "std_msgs/msg/Float32MultiArray"}
    messages = [(float(i), topic, {"data": [i] * (1000 + i)}) for i in range(3) for topic in topics]
    recording = robowidgets.open(recorded.write(tmp_path / "x", topics, messages))
    arrow, polars = pytest.importorskip("pyarrow"), pytest.importorskip("polars")
    kinds = {"/bytes": (arrow.uint8(), polars.UInt8, 1), "/floats": (arrow.float32(), polars.Float32, 4)}
    for topic, (kind, polars_kind, size) in kinds.items():
        column = recording.fields(topic).to_arrow()["data"]
        assert column.type == arrow.list_(kind)
        assert column.nbytes == pytest.approx(3003 * size, abs=4 * 4)  # and the start of each
        assert recording.fields(topic).to_polars()["data"].dtype == polars.List(polars_kind)


def test_an_array_larger_than_the_memory_is_an_error_that_says_what_to_do(tmp_path: Path) -> None:
    text = "x" * 2_000_000
    path = recorded.write(tmp_path / "x", {"/t": "std_msgs/msg/String"}, [(i, "/t", {"data": text}) for i in range(5)])
    with robowidgets.open(path) as recording:
        recording.memory = 5_000_000
        fields = recording.fields("/t")
        with pytest.raises(robowidgets.RecordingError, match=r"the limit is 5\.0 MB: take a part of it"):
            fields["data"]
        assert fields[:2]["data"].tolist() == [text, text]
        assert [len(moment.message.data) for moment in recording.messages("/t")] == [2_000_000] * 5


def test_a_message_that_cannot_be_read_is_left_out_with_a_line(tmp_path: Path) -> None:
    bad_text = b"\x00\x01\x00\x00\x03\x00\x00\x00\xff\xfe\x00"
    messages = [(0.0, "/t", {"data": "a"}), (1.0, "/t", b"\x00\x01\x00\x00\xff"), (2.0, "/t", bad_text)]
    path = recorded.write(tmp_path / "x", {"/t": "std_msgs/msg/String"}, messages)
    with robowidgets.open(path) as recording:
        assert recording.fields("/t")["data"].tolist() == ["a"]
        assert [one.message.data for one in recording.messages("/t")] == ["a"]
        line = "/t: messages that cannot be shown are left out, the first at 1.00 s: "
        assert any(problem.startswith(line) for problem in recording.problems)


def test_of_a_topic_of_two_types_the_first_is_read_with_a_line(tmp_path: Path) -> None:
    store = get_typestore(Stores.ROS2_HUMBLE)
    path = tmp_path / "x"
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        for second, (kind, value) in enumerate({"std_msgs/msg/String": "a", "std_msgs/msg/Float64": 1.5}.items()):
            connection = writer.add_connection("/t", kind, typestore=store)
            raw = store.serialize_cdr(store.types[kind](value), kind)
            writer.write(connection, recorded.START_NS + second * 10**9, raw)
    with robowidgets.open(path) as recording:
        assert [moment.message.data for moment in recording.messages("/t")] == ["a", 1.5]
        assert recording.fields("/t")["data"].tolist() == ["a"]
        line = "/t: the columns have the fields of std_msgs/msg/String; messages of std_msgs/msg/Float64 are left out"
        assert line in recording.problems


def test_a_topic_without_a_message_has_empty_columns(tmp_path: Path) -> None:
    path = recorded.write(tmp_path / "x", {"/imu": IMU, "/t": "std_msgs/msg/String"}, [(0, "/t", {})])
    fields = robowidgets.open(path).fields("/imu")
    assert {name: column.shape for name, column in fields.to_numpy().items() if "linear" in name} == {
        **{f"linear_acceleration.{axis}": (0,) for axis in "xyz"},
        "linear_acceleration_covariance": (0, 9),
    }


def test_a_topic_that_does_not_exist_is_an_error_with_the_nearest_names(tmp_path: Path) -> None:
    with robowidgets.open(imu(tmp_path / "x")) as recording:
        with pytest.raises(robowidgets.RecordingError, match=r"has no topic '/imo'.*did you mean '/imu'"):
            recording.fields("/imo")
        with pytest.raises(TypeError, match="expected the name of a topic as text, got 3"):
            recording.messages(3)  # type: ignore[arg-type]
        with pytest.raises(robowidgets.RecordingError, match=r"recording.fields\('/imu'\) read its messages"):
            recording.at("/imu", 0.0)


def test_a_closed_recording_has_no_messages(tmp_path: Path) -> None:
    recording = robowidgets.open(imu(tmp_path / "x"))
    recording.close()
    with pytest.raises(robowidgets.RecordingError, match="is closed"):
        recording.messages("/imu")


@pytest.mark.slow
def test_a_message_of_two_thousand_fields_is_read(tmp_path: Path) -> None:
    text = "\n".join(f"float32 field_{i}" for i in range(2000))
    store = get_typestore(Stores.ROS2_HUMBLE)
    store.register(get_types_from_msg(text, "big_msgs/msg/Big"))
    path = tmp_path / "x"
    with Writer(path, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/big", "big_msgs/msg/Big", typestore=store)
        raw = store.serialize_cdr(store.types["big_msgs/msg/Big"](*range(2000)), "big_msgs/msg/Big")
        writer.write(connection, recorded.START_NS, raw)
    fields = robowidgets.open(path).fields("/big")
    assert len(fields.names) == 2000
    assert fields["field_1999"].tolist() == [1999]
    with pytest.raises(UnknownFieldError) as error:
        fields["field_2000"]
    assert len(str(error.value)) < 1000
    assert "(2,000 fields)" in str(error.value)


def channel(*lines: str, encoding: str = "cdr") -> Channel:
    return Channel(0, "/t", "my_msgs/msg/Thing", encoding, "\n".join(lines), 1)


def test_a_count_that_cannot_be_is_refused_at_once() -> None:
    layouts = Layouts(channel("float64[] values"))
    with pytest.raises(ValueError, match="the length at byte 4 is 4,294,967,295"):
        layouts.of(b"\x00\x01\x00\x00\xff\xff\xff\xff")


def test_big_endian_messages_are_read(tmp_path: Path) -> None:
    raw = b"\x00\x00\x00\x00" + np.array([3.25], ">f8").tobytes()
    path = recorded.write(tmp_path / "x", {"/f": "std_msgs/msg/Float64"}, [(0, "/f", raw), (1, "/f", {"data": 1.5})])
    assert robowidgets.open(path).fields("/f")["data"].tolist() == [3.25, 1.5]


@pytest.mark.parametrize("encoding", ["cdr", "ros1"])
@pytest.mark.parametrize(
    "part", ["float64 a\nuint8 b", "uint8 a\nfloat64 b\nuint8 c", "float32 a\nuint8[3] b", "uint8 a\nuint8 b", "bool a"]
)
def test_arrays_of_messages_are_read_whatever_their_alignment(encoding: str, part: str) -> None:
    """Against rosbags, which reads one message after the other."""
    text = f"uint8 first\nPart[] parts\nfloat64 last\n{'=' * 80}\nMSG: my_msgs/Part\n{part}"
    described = channel(text, encoding=encoding)
    store, layouts = store_of(described), Layouts(described)
    make, own = (store.types[f"my_msgs/msg/{name}"] for name in ("Thing", "Part"))
    count = len(store.fielddefs["my_msgs/msg/Part"][1])
    sample = np.arange(1, 4, dtype=np.uint8)
    for size in range(12):
        parts = [own(*(sample if "[3]" in part and j == 1 else (i + j) % 2 for j in range(count))) for i in range(size)]
        message = make(7, parts, 0.125)
        write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
        raw = bytes(write(message, "my_msgs/msg/Thing"))
        layout, read = layouts.of(raw), decoder_of(described)(raw)
        matrix = np.frombuffer(raw, np.uint8)[None]
        for number, leaf in enumerate(layouts.leaves):
            values = layout.values(matrix, leaf, FieldPath(number))[0]
            assert values.tolist() == np.hstack([[], *values_at(read, leaf.name)]).tolist()
