"""Making messages of ROS 2 from their fields. Importing this module imports no ROS."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from .middleware import FeedError


def message_class(message_type: str) -> Any:
    """The class of a message; LookupError, with a text for a person, where it is not installed."""
    from rosidl_runtime_py.utilities import get_message

    try:
        return get_message(message_type)
    except (ImportError, AttributeError, LookupError, ValueError):
        package = message_type.partition("/")[0]
        raise LookupError(
            f"the package {package} is not installed here, or lacks it; install "
            f"ros-<distro>-{package.replace('_', '-')}, or source the workspace that has it, and restart the kernel"
        ) from None


def fill(message: Any, fields: Mapping[str, Any]) -> None:
    """Set the fields of a message, nested ones too; FeedError for an unknown field or an unfit value."""
    for name, value in fields.items():
        if not hasattr(message, name):
            raise FeedError(f"a {type(message).__name__} has no field {name!r}")
        if isinstance(value, Mapping):
            fill(getattr(message, name), value)
        else:
            _set(message, name, value)


def _set(message: Any, name: str, value: Any) -> None:
    try:
        setattr(message, name, value)
    except (AssertionError, TypeError, ValueError) as error:
        raise FeedError(f"{name} of a {type(message).__name__} cannot be {value!r}: {error}") from None
