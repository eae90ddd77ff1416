"""Searches of recordings whose message definitions are added afterwards."""

from __future__ import annotations

from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from robowidgets import conditions
from robowidgets.fleet import doctor, find
from robowidgets.messages import add_definitions, definitions

from ..recordings import recorded

pytestmark = pytest.mark.usefixtures("no_added_definitions")
STATUS = "MSG: my_msgs/Status\nfloat32 charge\n"
LOW = conditions.field("/status.charge") < 0.25


@pytest.fixture
def unknown(tmp_path: Path) -> Path:
    """A folder with two databases as ROS 2 Humble writes them: without the definitions of the messages."""
    for name in ("a", "b"):
        add_definitions(STATUS)
        messages = [(i / 10, "/status", {"charge": i / 10}) for i in range(10)]
        folder = recorded.write(
            tmp_path / "runs" / name, {"/status": "my_msgs/msg/Status"}, messages, StoragePlugin.SQLITE3
        )
        recorded.forget_definitions(folder)
    return tmp_path / "runs"


def test_the_same_search_finds_what_could_not_be_read_once_its_definition_is_added(unknown: Path) -> None:
    before = find(LOW, unknown / "a")
    assert "add_definitions" in before.unread[0].problem
    add_definitions(STATUS)
    after = find(LOW, unknown / "a")
    assert (len(after), after.unread) == (1, ())


def test_a_check_up_tells_no_more_of_a_definition_that_was_added(unknown: Path) -> None:
    assert "add_definitions" in repr(doctor(unknown / "a"))
    add_definitions(STATUS)
    assert "add_definitions" not in repr(doctor(unknown / "a"))


@pytest.mark.slow
def test_the_processes_of_a_search_have_the_definitions_that_were_added(unknown: Path) -> None:
    assert len(find(LOW, unknown).unread) == 2
    add_definitions(STATUS)
    after = find(LOW, unknown)
    assert (len(after), after.unread) == (2, ())


def test_what_could_not_be_searched_is_read_again(unknown: Path, tmp_path: Path) -> None:
    """A rebuilt workspace has definitions that it had not before."""
    assert len(find(LOW, unknown / "a").unread) == 1
    package = tmp_path / "install" / "share" / "my_msgs" / "msg"
    package.mkdir(parents=True)
    with pytest.MonkeyPatch.context() as environment:
        environment.setenv("AMENT_PREFIX_PATH", str(tmp_path / "install"))
        definitions.add({})
        assert len(find(LOW, unknown / "a").unread) == 1
        (package / "Status.msg").write_text("float32 charge\n")
        definitions.add({})
        assert len(find(LOW, unknown / "a")) == 1
