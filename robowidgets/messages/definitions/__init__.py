"""Message definitions that users' robots need and that neither their files nor rosbags contain.

A file ``<package>.txt`` for each package has the fields of each message in their order, the same for ROS 1 and ROS 2.
Its first line names the source and its licence; `NOTICE.txt` says more.
"""

from __future__ import annotations

import os
import re
from contextlib import suppress
from functools import lru_cache
from importlib.resources import files
from pathlib import Path

SAME_AS = {
    "gps_common": "gps_msgs",
    "kobuki_ros_interfaces": "kobuki_msgs",
    "ros_ign_interfaces": "ros_gz_interfaces",
}
"""Packages with the messages of another package, under their own name."""

_NAME = re.compile(r"^\[(\w+)\]\n", re.MULTILINE)
_TYPE = re.compile(r"(\w+)/msg/(\w+)")
_FEEDBACK = re.compile(r"(\w+)/(?:msg/(\w+)_Feedback|action/(\w+)_FeedbackMessage)")
_ACTION_PARTS = re.compile(r"^---[ \t]*$", re.MULTILINE)
_OWN_TYPE = re.compile(r"^([ \t]*)([A-Z]\w*)(?=[ \t\[])", re.MULTILINE)
"""The type of a field without its package."""
_PACKAGE = re.compile(r"[a-z]\w*")


@lru_cache
def definitions(package: str) -> dict[str, str]:
    """Return type name (``kobuki_msgs/msg/BumperEvent``) to text for a package, empty if the package is unknown."""
    held_as = SAME_AS.get(package, package)
    file = files(__name__) / f"{held_as}.txt"
    if not _PACKAGE.fullmatch(package) or not file.is_file():
        return {}
    _, *parts = _NAME.split(file.read_text(encoding="utf-8"))
    names, texts = parts[::2], parts[1::2]
    return {
        f"{package}/msg/{name}": text.strip().replace(f"{held_as}/", f"{package}/")
        for name, text in zip(names, texts, strict=True)
    }


_added: dict[str, str] = {}
_version = 0


def add(texts: dict[str, str]) -> None:
    """Add definitions by type name, with precedence over all others except the definitions in a file."""
    global _version
    _added.update(texts)
    _version += 1


def version() -> int:
    """Return a number that changes when definitions are added."""
    return _version


def added(type_name: str) -> str:
    """Return the text of an added definition, or an empty text."""
    return _added.get(type_name, "")


def all_added() -> dict[str, str]:
    """Return the texts of all added definitions, by type name."""
    return {name: text for name, text in _added.items() if text}


def installed() -> str:
    """Return the package folders of a sourced ROS 2, separated as in PATH, or an empty text without ROS 2."""
    return os.environ.get("AMENT_PREFIX_PATH", "")


def feedback_definitions(package: str, action: str, text: str) -> dict[str, str]:
    """Return the definitions of an action's feedback, and of the messages of its topic, by type name.

    In ROS the feedback belongs to ``action``, here to ``msg``, because rosbags cannot write definitions that use types
    outside ``msg``. Names of messages do not contain ``_``, so it does not collide with a message.

    Args:
        package: the package of the action.
        action: its name, such as ``NavigateToPose``.
        text: the text of its ``.action`` file.

    Raises:
        ValueError: the text does not have the three parts of an action.
    """
    parts = _ACTION_PARTS.split(text.replace("\r", ""))
    if len(parts) != 3:
        raise ValueError(
            f"{package}/action/{action}: expected a goal, a result and a feedback with a line '---' between them; "
            f"got {len(parts)} {'part' if len(parts) == 1 else 'parts'}"
        )
    feedback = f"{package}/msg/{action}_Feedback"
    return {
        # A type without a package is a message of the same package, not an action.
        feedback: _OWN_TYPE.sub(rf"\1{package}/msg/\2", parts[2]),
        f"{package}/action/{action}_FeedbackMessage": f"unique_identifier_msgs/UUID goal_id\n{feedback} feedback\n",
    }


def elsewhere(type_name: str) -> str:
    """Return the definition of a type that rosbags does not know, or an empty text.

    A sourced ROS 2 comes first, then the definitions in this package.
    """
    if found := _FEEDBACK.fullmatch(type_name):
        package, name = found[1], found[2] or found[3]
        with suppress(ValueError):  # the file is missing, or not an action
            return feedback_definitions(package, name, _installed_text(package, "action", name))[type_name]
    if found := _TYPE.fullmatch(type_name):
        package, name = found.groups()
        return _installed_text(package, "msg", name) or definitions(package).get(type_name, "")
    return ""


def _installed_text(package: str, kind: str, name: str) -> str:
    """Return the text of a file of a sourced ROS 2, or an empty text if the file does not exist."""
    for prefix in filter(None, installed().split(os.pathsep)):
        with suppress(OSError):
            file = Path(prefix) / "share" / package / kind / f"{name}.{kind}"
            return file.read_text(encoding="utf-8", errors="replace")
    return ""
