"""Our message definitions, against the hashes of the ROS originals, and definitions that users add."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

import robowidgets
from robowidgets.command import main
from robowidgets.messages import add_definitions
from robowidgets.messages import definitions as known
from robowidgets.messages.channel import Channel
from robowidgets.messages.decoding import DecodeError, shape_of
from robowidgets.messages.definitions import SAME_AS, definitions
from robowidgets.messages.schema import Schema
from robowidgets.messages.touch import TOUCH_TYPES

from . import recorded

pytestmark = pytest.mark.usefixtures("no_added_definitions")
FOLDER = Path(known.__file__).parent
PACKAGES = (*(file.stem for file in FOLDER.glob("*.txt") if file.stem != "NOTICE"), *SAME_AS)

# The first 16 digits of RIHS01, from the code that ROS 2 generates for these packages.
ROS2 = {
    "kobuki_ros_interfaces/msg/BumperEvent": "ca5b8abfc41495a1",
    "kobuki_ros_interfaces/msg/ButtonEvent": "f826413de9f26534",
    "kobuki_ros_interfaces/msg/CliffEvent": "a44cab1e368d1eca",
    "kobuki_ros_interfaces/msg/SensorState": "a508b53460c5282c",
    "kobuki_ros_interfaces/msg/WheelDropEvent": "93672e804bcf316e",
    "turtlebot3_msgs/msg/SensorState": "e35bc7db55e7a7ae",
    "gazebo_msgs/msg/ContactsState": "1dc585e627c16551",
    "ros_gz_interfaces/msg/Contact": "ba5acbac280b8650",
    "ros_gz_interfaces/msg/Entity": "266a26f377057ebb",
    "ros_gz_interfaces/msg/JointWrench": "aa50610f0bc1a9f1",
}

# The MD5 sums of ROS 1, which include the constants.
ROS1 = {
    "ackermann_msgs/msg/AckermannDriveStamped": "1fd5d7f58889cefd44d29f6653240d0c",
    "ca_msgs/msg/Bumper": "18fe5b1d31e6a8db180b924157ac665e",
    "control_msgs/msg/GripperCommand": "680acaff79486f017132a7f198d40f08",
    "control_msgs/msg/JointControllerState": "987ad85e4756f3aef7f1e5e7fe0595d1",
    "control_msgs/msg/JointJog": "1685da700c8c2e1254afc92a5fb89c96",
    "control_msgs/msg/JointTrajectoryControllerState": "10817c60c2486ef6b33e97dcd87f4474",
    "control_msgs/msg/PidState": "b138ec00e886c10e73f27e8712252ea6",
    "gazebo_msgs/msg/ContactState": "48c0ffb054b8c444f870cecea1ee50d9",
    "gazebo_msgs/msg/ContactsState": "acbcb1601a8e525bf72509f18e6f668d",
    "gazebo_msgs/msg/PerformanceMetrics": "884f71fd5037b886ec5e126b83c4425a",
    "geographic_msgs/msg/GeoPointStamped": "ea50d268b03080563c330351a21edc89",
    "geographic_msgs/msg/GeoPose": "778680b5172de58b7c057d973576c784",
    "gps_common/msg/GPSFix": "3db3d0a7bc53054c67c528af84710b70",
    "kobuki_msgs/msg/BumperEvent": "ffe360cd50f14f9251d9844083e72ac5",
    "kobuki_msgs/msg/CliffEvent": "c5b106efbb1427a94f517c5e05f06295",
    "kobuki_msgs/msg/PowerSystemEvent": "f6464657d6c911b00c7bc7b43a154bf8",
    "map_msgs/msg/OccupancyGridUpdate": "b295be292b335c34718bd939deebe1c9",
    "map_msgs/msg/PointCloud2Update": "6c58e4f249ae9cd2b24fb1ee0f99195e",
    "map_msgs/msg/ProjectedMap": "7bbe8f96e45089681dc1ea7d023cbfca",
    "neato_node/msg/Bump": "459d87767ce0f2ebdc162046e9ad2c13",
    "nmea_msgs/msg/Sentence": "9f221efc5f4b3bac7ce4af102b32308b",
    "pcl_msgs/msg/ModelCoefficients": "ca27dea75e72cb894cd36f9e5005e93e",
    "pcl_msgs/msg/PolygonMesh": "45a5fc6ad2cde8489600a790acc9a38a",
    "rosbridge_msgs/msg/ConnectedClients": "d0d53b0c0aa23aa7e4cf52f49bca4b69",
    "turtlebot3_msgs/msg/SensorState": "7250c1dc0b61c4190e78f528f599285f",
    "turtlebot3_msgs/msg/VersionInfo": "43e0361461af2970a33107409403ef3c",
    "turtlesim/msg/Color": "353891e354491c51aabe32df673fb446",
    "turtlesim/msg/Pose": "863b248d5016ca62ea2e895ae5265cf9",
    "velodyne_msgs/msg/VelodyneScan": "50804fc9533a0e579e6322c04ae70566",
}


@cache
def store(base: Stores) -> Typestore:
    result = get_typestore(base)
    types = dict(get_typestore(Stores.ROS2_HUMBLE).fielddefs) if base is not Stores.ROS2_HUMBLE else {}
    types = {name: fields for name, fields in types.items() if name not in result.fielddefs}
    for package in PACKAGES:
        for name, text in definitions(package).items():
            types.update(get_types_from_msg(text, name))
    result.register(types)
    return result


@pytest.mark.parametrize("name", ROS2)
def test_fields_match_ros_2(name: str) -> None:
    assert store(Stores.ROS2_HUMBLE).hash_rihs01(name).removeprefix("RIHS01_")[:16] == ROS2[name]


@pytest.mark.parametrize("name", ROS1)
def test_fields_match_ros_1(name: str) -> None:
    assert store(Stores.ROS1_NOETIC).generate_msgdef(name)[1] == ROS1[name]


@pytest.mark.parametrize("package", PACKAGES)
def test_all_messages_of_a_package_are_readable(package: str) -> None:
    assert definitions(package)
    for name in definitions(package):
        assert shape_of(Channel(0, "", name, "cdr", "", 0))


@pytest.mark.parametrize("package", sorted({*PACKAGES} - {*SAME_AS}))
def test_the_source_and_the_licence_of_a_package_are_named(package: str) -> None:
    first = (FOLDER / f"{package}.txt").read_text(encoding="utf-8").splitlines()[0]
    assert first.startswith("# For ")
    assert "github.com/" in first
    # "BSD" alone is from a package that does not name the version; the notice explains it.
    assert any(
        f". {licence}: " in first for licence in ("BSD-3-Clause", "BSD", "Apache-2.0", "MIT", "No licence is stated")
    )


def test_every_touch_dialect_has_a_definition_here_or_in_rosbags() -> None:
    assert store(Stores.ROS2_HUMBLE).fielddefs.keys() >= TOUCH_TYPES


def test_an_unknown_package_has_no_definitions() -> None:
    assert definitions("sensor_msgs") == {}
    assert definitions("../messages") == {}
    assert definitions("NOTICE") == {}


STATUS = "MSG: my_msgs/Status\nstd_msgs/Header header\nfloat32 charge\nPart[] parts\n"
PART = "MSG: my_msgs/Part\nstring name\n"


def unknown_recording(folder: Path) -> Path:
    """A database as ROS 2 Humble writes it: without the definitions of the messages."""
    add_definitions(STATUS + PART)
    message = {"header": recorded.stamped(7), "charge": 0.5, "parts": [{"name": "arm"}]}
    path = recorded.write(folder, {"/status": "my_msgs/msg/Status"}, [(0, "/status", message)], StoragePlugin.SQLITE3)
    return recorded.forget_definitions(path)


def test_a_topic_without_a_definition_says_why_and_what_to_do(tmp_path: Path) -> None:
    why = "no definition of its messages in the file, nor among those that are known: "
    what = "robowidgets.messages.add_definitions(folder) takes the .msg files of my_msgs"
    with robowidgets.open(unknown_recording(tmp_path / "x")) as recording:
        assert recording.problems[0] == f"/status: {why}{what}"
        assert any(str(problem).startswith(f"/status: {why}{what}") for problem in recording.doctor().problems)
        for read in (recording.fields, recording.messages, recording.series):
            with pytest.raises(robowidgets.RecordingError, match=r"takes the .msg files of my_msgs$"):
                read("/status")
        with pytest.raises(robowidgets.RecordingError, match=r"takes the .msg files of my_msgs"):
            recording.show("/status")


def package(root: Path, name: str = "my_msgs", texts: str = STATUS + PART) -> Path:
    """A folder of a ROS package with the messages of a text."""
    folder = root / name / "msg"
    folder.mkdir(parents=True)
    for part in texts.split("MSG: ")[1:]:
        head, _, body = part.partition("\n")
        (folder / f"{head.split('/')[1]}.msg").write_text(body)
    return folder.parent


@pytest.mark.parametrize("which", ["", "my_msgs", "my_msgs/msg"])
def test_the_msg_files_of_a_folder_make_it_readable(tmp_path: Path, which: str) -> None:
    path = unknown_recording(tmp_path / "x")
    workspace = package(tmp_path / "src").parent
    assert set(add_definitions(workspace / which)) == {"my_msgs/msg/Status", "my_msgs/msg/Part"}
    with robowidgets.open(path) as recording:
        assert recording.fields("/status")["parts[0].name"].tolist() == ["arm"]
        assert recording.fields("/status")["header.stamp"].tolist() == [7]


def test_the_package_is_named_by_its_package_xml(tmp_path: Path) -> None:
    folder = package(tmp_path, "some-folder")
    (folder / "package.xml").write_text("<package><name>my_msgs</name></package>")
    assert "my_msgs/msg/Part" in add_definitions(folder / "msg" / "Part.msg")


def test_definitions_of_a_sourced_ros_2_are_known(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = unknown_recording(tmp_path / "x")
    package(tmp_path / "opt" / "share")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path / 'opt'}")
    known.add({})
    with robowidgets.open(path) as recording:
        assert recording.fields("/status")["charge"].tolist() == [0.5]


def test_a_definition_in_a_file_comes_before_one_that_was_added(tmp_path: Path) -> None:
    own = get_typestore(Stores.ROS2_HUMBLE)
    own.register(get_types_from_msg("float32 charge\n", "my_msgs/msg/Status"))
    add_definitions("MSG: my_msgs/Status\nfloat64 other\n")
    with Writer(tmp_path / "x", version=9, storage_plugin=StoragePlugin.MCAP) as writer:
        connection = writer.add_connection("/status", "my_msgs/msg/Status", typestore=own)
        raw = own.serialize_cdr(own.types["my_msgs/msg/Status"](0.5), "my_msgs/msg/Status")
        writer.write(connection, recorded.START_NS, raw)
    with robowidgets.open(tmp_path / "x") as recording:
        assert recording.fields("/status").names == ("charge",)


def test_one_that_was_added_comes_before_ours_and_before_the_standard() -> None:
    pose, limits = "turtlesim/msg/Pose", "sensor_msgs/msg/Range"
    for name in (pose, limits):
        assert len(shape_of(Channel(0, "", name, "cdr", "", 0))) > 1
        add_definitions(f"MSG: {name}\nfloat32 only\n")
        assert shape_of(Channel(0, "", name, "cdr", "", 0)) == {"only": "float32"}


@pytest.mark.parametrize(
    ("source", "error", "says"),
    [
        ("/nowhere/at/all", ValueError, "no .msg or .action file in '/nowhere/at/all': expected a folder with .msg or"),
        ("float32 charge\n", ValueError, "text with a line such as 'MSG: my_msgs/Status' before each definition"),
        ("MSG: my_msgs/Odd\nfloat32 1: %%%\n", ValueError, "my_msgs/msg/Odd cannot be understood"),
        (STATUS, ValueError, "my_msgs/msg/Part, which they use, is not known: give its .msg file, too"),
        ("MSG: my_msgs/Loop\nLoop inside\n", ValueError, "a message contains itself"),
        (3, TypeError, "got 3"),
    ],
)
def test_what_is_not_a_definition_is_an_error_and_adds_none(source: str, error: type[Exception], says: str) -> None:
    with pytest.raises(error, match=says):
        add_definitions(source)
    for name in ("my_msgs/msg/Odd", "my_msgs/msg/Status", "my_msgs/msg/Loop"):
        with pytest.raises(DecodeError):
            shape_of(Channel(0, "", name, "cdr", "", 0))


def test_an_empty_folder_is_an_error(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"no .msg or .action file in"):
        add_definitions(tmp_path)


FEEDBACK_FIELDS = "uint8 DRIVING = 1\nuint8 TURNING = 2\nuint8 state\nfloat32 left\nPart[] parts\n"
GO = f"geometry_msgs/Pose goal\n---\nbool arrived\n---\n{FEEDBACK_FIELDS}"
FEEDBACK, STATUS_TYPE = "my_msgs/action/Go_FeedbackMessage", "action_msgs/msg/GoalStatusArray"


def action_package(root: Path, action: str = GO) -> Path:
    """A folder of a ROS package with an action that uses a message of the package."""
    folder = package(root, texts=PART)
    (folder / "action").mkdir()
    (folder / "action" / "Go.action").write_text(action)
    return folder


def action_recording(folder: Path, feedback: dict[str, object], action: str = GO) -> Path:
    """A database as ROS 2 Humble writes it, with both topics of an action to which one goal was sent."""
    add_definitions(action_package(folder / "src", action))
    goal = {"uuid": list(range(16))}
    messages = [
        (0, "/go/_action/feedback", {"goal_id": goal, "feedback": feedback}),
        (1, "/go/_action/status", {"status_list": [{"goal_info": {"goal_id": goal}, "status": 4}]}),
    ]
    topics = {"/go/_action/feedback": FEEDBACK, "/go/_action/status": STATUS_TYPE}
    return recorded.forget_definitions(recorded.write(folder / "x", topics, messages, StoragePlugin.SQLITE3))


DRIVING = {"state": 1, "left": 0.5, "parts": [{"name": "arm"}]}


def test_the_action_files_of_a_folder_make_feedback_readable(tmp_path: Path) -> None:
    path = action_recording(tmp_path, DRIVING)
    names = add_definitions(tmp_path / "src" / "my_msgs")
    assert set(names) == {"my_msgs/msg/Part", "my_msgs/msg/Go_Feedback", FEEDBACK}
    with robowidgets.open(path) as recording:
        fields = recording.fields("/go/_action/feedback")
        assert fields["feedback.left"].tolist() == [0.5]
        assert fields["feedback.parts[0].name"].tolist() == ["arm"]
        assert fields["goal_id.uuid"].tolist() == [list(range(16))]
        (message,) = recording.messages("/go/_action/feedback")
        assert message.message.feedback.state == 1


def test_the_numbers_of_feedback_have_the_names_of_the_action_file(tmp_path: Path) -> None:
    add_definitions(action_package(tmp_path))
    schema = Schema(Channel(0, "", FEEDBACK, "cdr", "", 0))
    assert schema.fields("my_msgs/msg/Go_Feedback")["state"].names == {"1": "DRIVING", "2": "TURNING"}


def test_feedback_of_a_ros_2_that_is_sourced_is_readable(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = action_recording(tmp_path, DRIVING)
    action_package(tmp_path / "opt" / "share")
    monkeypatch.setenv("AMENT_PREFIX_PATH", f"/nowhere:{tmp_path / 'opt'}")
    known.add({})
    with robowidgets.open(path) as recording:
        assert recording.fields("/go/_action/feedback")["feedback.left"].tolist() == [0.5]


def test_feedback_without_fields_is_readable(tmp_path: Path) -> None:
    path = action_recording(tmp_path, {}, "bool go\n---\n---\n")
    add_definitions(tmp_path / "src" / "my_msgs")
    with robowidgets.open(path) as recording:
        assert recording.fields("/go/_action/feedback").names == ("goal_id.uuid",)
        assert len(list(recording.messages("/go/_action/feedback"))) == 1


@pytest.mark.parametrize("definition", ["float32 charge\n", "float64 charge\nfloat64 volts\n"])
def test_a_message_of_another_version_is_not_read_and_says_what_to_do(tmp_path: Path, definition: str) -> None:
    add_definitions("MSG: my_msgs/Power\nfloat32 charge\nfloat32 volts\n")
    message = {"charge": 0.5, "volts": 12}
    path = recorded.write(tmp_path / "x", {"/p": "my_msgs/msg/Power"}, [(0, "/p", message)], StoragePlugin.SQLITE3)
    recorded.forget_definitions(path)
    add_definitions(f"MSG: my_msgs/Power\n{definition}")
    with robowidgets.open(path) as recording:
        assert len(recording.fields("/p")) == 0
        assert recording.problems[0].startswith("/p: messages that cannot be shown are left out")
        remedy = "if another version of my_msgs wrote them, add its files with robowidgets.messages.add_definitions"
        assert any(remedy in str(problem) for problem in recording.doctor().problems)


def test_feedback_of_another_version_of_an_action_is_not_read(tmp_path: Path) -> None:
    path = action_recording(tmp_path, DRIVING)
    add_definitions(action_package(tmp_path / "newer", GO.replace("float32 left", "float64 left")))
    with robowidgets.open(path) as recording:
        assert "/go/_action/feedback: messages that cannot be shown are left out" in recording.info()


def test_repair_writes_feedback_with_its_definition(tmp_path: Path) -> None:
    path = action_recording(tmp_path, DRIVING)
    add_definitions(tmp_path / "src" / "my_msgs")
    output = tmp_path / "repaired.mcap"
    assert main(["repair", str(path), "--output", str(output)]) == 0
    known._added.clear()
    known.add({})
    with robowidgets.open(output) as recording:
        assert recording.fields("/go/_action/feedback")["feedback.parts[0].name"].tolist() == ["arm"]


def test_the_status_of_actions_is_readable_without_a_definition(tmp_path: Path) -> None:
    with robowidgets.open(action_recording(tmp_path, DRIVING)) as recording:
        assert recording.fields("/go/_action/status")["status_list[0].status"].tolist() == [4]


@pytest.mark.parametrize("is_sourced", [False, True])
def test_feedback_without_a_definition_names_the_action_files(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, is_sourced: bool
) -> None:
    path = action_recording(tmp_path, DRIVING)
    if is_sourced:  # with a file that is not an action
        action_package(tmp_path / "opt" / "share", "bool go\n")
        monkeypatch.setenv("AMENT_PREFIX_PATH", str(tmp_path / "opt"))
        known.add({})
    with robowidgets.open(path) as recording:
        assert recording.problems[0].startswith("/go/_action/feedback: no definition of its messages in the file")
        assert recording.problems[0].endswith(
            "robowidgets.messages.add_definitions(folder) takes the .action files of my_msgs"
        )


@pytest.mark.parametrize(("action", "parts"), [("bool go\n", "1 part"), (GO + "---\n", "4 parts")])
def test_an_action_file_without_three_parts_is_an_error(tmp_path: Path, action: str, parts: str) -> None:
    with pytest.raises(
        ValueError, match=rf"my_msgs/action/Go: expected a goal, a result and a feedback .* got {parts}$"
    ):
        add_definitions(action_package(tmp_path, action))
