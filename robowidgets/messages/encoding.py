"""Encoding of messages, without ROS."""

from __future__ import annotations

from collections.abc import Mapping
from math import nan
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any

import numpy as np

from .byte_fields import bytes_in
from .channel import Channel
from .decoding import DecodeError, one_line, store_of
from .fields import MISSING, reader

if TYPE_CHECKING:
    from rosbags.typesys.store import Typestore

_IN_ROS1 = {"sec": "secs", "nanosec": "nsecs"}
_FLOATS = ("float32", "float64")


def encode(encoding: str, message_type: str, message: Any, definition: str = "") -> bytes:
    """Return the bytes of a message in ``cdr`` or ``ros1``, given as an object or as its fields, of ROS 1 or ROS 2.

    Without a definition, the type has to be a known one. Omitted fields are zero or empty. Fields that the type does
    not have, such as ``header.seq``, are ignored. As in rosbridge's JSON, null stands for NaN, and a text for bytes in
    base64.

    Raises:
        ValueError: the type is unknown, or a value does not fit. The text is one line for users.
    """
    try:
        store = store_of(Channel(0, "", message_type, encoding, definition, 0))
    except DecodeError:
        package = message_type.partition("/")[0]
        raise ValueError(
            f"{message_type} is not a known type; robowidgets.messages.add_definitions(folder) takes the .msg files of "
            f"{package}"
        ) from None
    write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
    try:
        return bytes(write(_message(store, message_type, message), message_type))
    except Exception as error:  # rosbags and numpy raise many types for a value that does not fit
        raise ValueError(f"a message does not fit {message_type}: {one_line(error)}") from None


def as_message(encoding: str, message_type: str, fields: Mapping[str, Any]) -> Any:
    """Return an object with attributes, as rosbags decodes it, for the fields of a message from JSON.

    Arrays of numbers, including base64 in JSON, become NumPy arrays, and null becomes NaN. A message keeps its names
    and values if its type is unknown or does not fit.
    """
    try:
        return _message(store_of(Channel(0, "", message_type, encoding, "", 0)), message_type, fields)
    except Exception:  # an unknown type, or any error of rosbags and numpy for a value that does not fit
        return _guessed(fields)


def _guessed(value: Any) -> Any:
    if isinstance(value, Mapping):
        return SimpleNamespace(**{str(name): _guessed(field) for name, field in value.items()})
    if not isinstance(value, list):
        return value
    if value and all(item is None or (isinstance(item, (int, float)) and type(item) is not bool) for item in value):
        return np.array(value, np.float64 if any(type(item) is not int for item in value) else None)
    return [_guessed(item) for item in value]


def _message(store: Typestore, type_name: str, message: Any) -> Any:
    get = reader(message)
    values: dict[str, Any] = {}
    for name, (kind, what) in store.fielddefs[type_name][1]:
        given = get(name, MISSING)
        if given is MISSING and name in _IN_ROS1:
            given = get(_IN_ROS1[name], MISSING)
        values[name] = _value(store, kind, what, given)
    return store.types[type_name](**values)


def _value(store: Typestore, kind: int, what: Any, given: Any) -> Any:
    from rosbags.interfaces import Nodetype

    if given is None and kind == Nodetype.BASE and what[0] in _FLOATS:
        return nan
    if given is MISSING:
        given = None
    if kind == Nodetype.NAME:
        return _message(store, what, {} if given is None else given)
    if kind == Nodetype.BASE:
        return given if given is not None else "" if what[0] == "string" else 0
    (inner, name), count = what
    is_numeric = inner == Nodetype.BASE and name[0] != "string"
    if given is None:
        given = [0 if is_numeric else None] * (count if kind == Nodetype.ARRAY else 0)
    if is_numeric:
        # rospy has bytes for uint8[], and rosbridge has a text.
        given = bytes_in("an array", given)
        return np.frombuffer(given, np.uint8) if isinstance(given, bytes) else np.asarray(given, name[0])
    return [_value(store, inner, name, item) for item in given]
