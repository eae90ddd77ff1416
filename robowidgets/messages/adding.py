"""Message definitions that the user adds."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from .decoding import Types, UnknownTypeError, complete, one_line, parsed, shape_in
from .definitions import add, added, feedback_definitions

_HEAD = re.compile(r"^(?:=+\n)?MSG:[ \t]*(\w+)/(?:msg/)?(\w+)[ \t]*\n", re.MULTILINE)
_NAME = re.compile(r"<name>\s*(\w+)\s*</name>")
_HOW = (
    "expected a folder with .msg or .action files, such as a ROS package or workspace, one such file, "
    "or text with a line such as 'MSG: my_msgs/Status' before each definition"
)


def add_all(sources: tuple[str | os.PathLike[str], ...]) -> tuple[str, ...]:
    """See `robowidgets.messages.add_definitions`."""
    texts: dict[str, str] = {}
    for source in sources:
        texts.update(_texts(source))
    types: Types = {name: _parsed(name, text) for name, text in texts.items()}
    before = {name: added(name) for name in texts}
    add(texts)
    try:
        known = complete(types)
        for name in types:
            shape_in(known, name)
    except (ValueError, RecursionError) as error:
        add(before)
        if isinstance(error, UnknownTypeError):
            raise ValueError(f"{error.type_name}, which they use, is not known: give its .msg file, too") from None
        what = "a message contains itself" if isinstance(error, RecursionError) else str(error)
        raise ValueError(f"the definitions cannot be used: {what}") from None
    return tuple(texts)


def _parsed(name: str, text: str) -> Any:
    try:
        return parsed(name, text)[name]
    except Exception as error:  # rosbags raises many types
        raise ValueError(
            f"the definition of {name} cannot be understood: {one_line(error)}; "
            f"`ros2 interface show {name}` prints a right one"
        ) from None


def _texts(source: str | os.PathLike[str]) -> Iterator[tuple[str, str]]:
    """Yield the type names and texts of the definitions in a folder, a file or a text."""
    if not isinstance(source, (str, os.PathLike)):
        raise TypeError(f"{_HOW}; got {source!r}")
    if isinstance(source, str) and "\n" in source:
        yield from _in_text(source)
        return
    path = Path(source).expanduser()
    found = [*path.rglob("*.msg"), *path.rglob("*.action")] if path.is_dir() else [path] if path.is_file() else []
    files = sorted(found)
    if not files:
        raise ValueError(f"no .msg or .action file in {str(source)!r}: {_HOW}")
    for file in files:
        package, text = _get_package(file.absolute()), file.read_text(encoding="utf-8", errors="replace")
        if file.suffix == ".action":
            yield from feedback_definitions(package, file.stem, text).items()
        else:
            yield f"{package}/msg/{file.stem}", text


def _in_text(text: str) -> Iterator[tuple[str, str]]:
    before, *parts = _HEAD.split(text.replace("\r", ""))
    if before.strip(" \t\n=") or not parts:
        raise ValueError(_HOW)
    for package, name, definition in zip(parts[::3], parts[1::3], parts[2::3], strict=True):
        yield f"{package}/msg/{name}", re.sub(r"^=+\s*\Z", "", definition, flags=re.MULTILINE)


def _get_package(file: Path) -> str:
    """Return the package of a file: the name in package.xml, else the folder above ``msg`` or ``action``."""
    folder = file.parent.parent if file.parent.name in ("msg", "action") else file.parent
    about = folder / "package.xml"
    found = _NAME.search(about.read_text(encoding="utf-8", errors="replace")) if about.is_file() else None
    return found[1] if found else folder.name
