"""The same message as each source hands it over."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

import numpy as np

Fields = dict[str, Any]


def rosbags(type_name: str, fields: Fields) -> Any:
    """Attributes, NumPy arrays, `sec` and `nanosec`, and the type in `__msgtype__`."""
    package, name = type_name.split("/")
    return _object(fields, {"__msgtype__": f"{package}/msg/{name}"}, _numpy)


def rospy(type_name: str, fields: Fields) -> Any:
    """Attributes, tuples, `secs` and `nsecs`, and the type in `_type`."""
    return _object(_renamed(fields, {"sec": "secs", "nanosec": "nsecs"}), {"_type": type_name}, _tuple)


def rclpy(type_name: str, fields: Fields) -> Any:
    """Properties over underscored slots, in a module named as the generated ones are."""
    package, name = type_name.split("/")
    message = _generated(package, name, tuple(fields))()
    for field, value in fields.items():
        setattr(message, f"_{field}", _object(value, {}, list) if isinstance(value, (dict, list)) else value)
    return message


def rosbridge(type_name: str, fields: Fields) -> Any:
    """A dictionary as it came over the wire."""
    return fields


def envelope(type_name: str, fields: Fields) -> Any:
    """The dictionary of a whole rosbridge answer."""
    return {"op": "publish", "topic": "/any", "msg": fields}


FORMS: tuple[Callable[[str, Fields], Any], ...] = (rosbags, rospy, rclpy, rosbridge, envelope)


@cache
def _generated(package: str, name: str, fields: tuple[str, ...]) -> type:
    properties = {f: property(lambda self, f=f: getattr(self, f"_{f}")) for f in fields}
    slots = {"__slots__": tuple(f"_{f}" for f in fields), "__module__": f"{package}.msg._{name.lower()}"}
    return type(name, (), {**properties, **slots})


@cache
def _message(*extra: tuple[str, str]) -> type:
    return type("Message", (SimpleNamespace,), dict(extra))


def _object(value: Any, extra: Fields, to_array: Callable[[list[Any]], Any]) -> Any:
    if isinstance(value, dict):
        return _message(*extra.items())(**{name: _object(v, {}, to_array) for name, v in value.items()})
    if isinstance(value, list):
        return to_array([_object(v, {}, to_array) for v in value])
    return value


def _numpy(values: list[Any]) -> Any:
    return values if values and isinstance(values[0], SimpleNamespace) else np.array(values, np.float32)


def _tuple(values: list[Any]) -> Any:
    return tuple(values)


def _renamed(value: Any, names: dict[str, str]) -> Any:
    if isinstance(value, dict):
        return {names.get(k, k): _renamed(v, names) for k, v in value.items()}
    return [_renamed(v, names) for v in value] if isinstance(value, list) else value
