"""Message definitions that the robots of our users need and that neither their files nor rosbags hold.

A file for each package, ``<package>.txt``: the fields of each message, in their order, are those of the package of that
name, the same for ROS 1 and ROS 2. Its first line names the source and its licence; `NOTICE.txt` says more.
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
"""Packages that hold the messages of another under their own name."""

_NAME = re.compile(r"^\[(\w+)\]\n", re.MULTILINE)
_TYPE = re.compile(r"(\w+)/msg/(\w+)")
_PACKAGE = re.compile(r"[a-z]\w*")


@lru_cache
def definitions(package: str) -> dict[str, str]:
    """Type name (``kobuki_msgs/msg/BumperEvent``) to text, for each message of a package; none for an unknown one."""
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
    """Take definitions of a user's own, by type name, before all others but those of a file."""
    global _version
    _added.update(texts)
    _version += 1


def version() -> int:
    """A number that changes when definitions are added."""
    return _version


def added(type_name: str) -> str:
    """The text of a definition that was added; empty if there is none."""
    return _added.get(type_name, "")


def all_added() -> dict[str, str]:
    """The texts of all definitions that were added, by type name."""
    return {name: text for name, text in _added.items() if text}


def installed() -> str:
    """Where a ROS 2 that is installed and sourced here has its packages; empty without one."""
    return os.environ.get("AMENT_PREFIX_PATH", "")


def elsewhere(type_name: str) -> str:
    """The text of the definition of a type that rosbags does not know; empty if there is none.

    The one of a ROS 2 that is installed and sourced here comes first, then ours.
    """
    found = _TYPE.fullmatch(type_name)
    if found is None:
        return ""
    package, name = found.groups()
    for prefix in filter(None, installed().split(os.pathsep)):
        file = Path(prefix) / "share" / package / "msg" / f"{name}.msg"
        with suppress(OSError):
            return file.read_text(encoding="utf-8", errors="replace")
    return definitions(package).get(type_name, "")
