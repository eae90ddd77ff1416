"""Encoding messages without ROS."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

import numpy as np
from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

from .middleware import FeedError

_lock = threading.Lock()  # rosbags generates the code of a store without locking
_STORES = {"cdr": Stores.ROS2_HUMBLE, "ros1": Stores.ROS1_NOETIC}


class Encoder:
    """Encodes messages of the standard types, given as their fields; any thread may call it."""

    def encode(self, encoding: str, message_type: str, fields: Mapping[str, Any]) -> bytes:
        """The bytes of a message in ``cdr`` or ``ros1``; a field that is left out is zero, false or empty.

        Raises:
            FeedError: the type is unknown, it has no such field, or a value does not fit.
        """
        with _lock:
            store = _store(encoding)
            if message_type not in store.fielddefs:
                raise FeedError(f"{message_type} cannot be published: only messages of standard ROS types can")
            try:
                message = _message(store, message_type, fields)
                write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
                return bytes(write(message, message_type))
            except FeedError:
                raise
            except Exception as error:  # whatever rosbags and numpy raise for a value that does not fit
                raise FeedError(f"{dict(fields)!r} is no {message_type}: {error}") from None


@lru_cache
def _store(encoding: str) -> Typestore:
    """One store for the process: generating the code of a type takes milliseconds."""
    return get_typestore(_STORES[encoding])


def _message(store: Typestore, type_name: str, fields: Any) -> Any:
    definition = store.fielddefs[type_name][1]
    names = [name for name, _ in definition]
    if not isinstance(fields, Mapping):
        raise FeedError(f"expected the fields of a {type_name}, {', '.join(names)}; got {fields!r}")
    for name in fields:
        if name not in names:
            raise FeedError(f"a {type_name} has no field {name!r}; it has {', '.join(names)}")
    values = {name: _value(store, kind, what, fields.get(name)) for name, (kind, what) in definition}
    return store.types[type_name](**values)


def _value(store: Typestore, kind: int, what: Any, given: Any) -> Any:
    if kind == Nodetype.NAME:
        return _message(store, what, {} if given is None else given)
    if kind == Nodetype.BASE:
        return _single(what[0], given)
    (inner, name), count = what
    items = list(given) if given is not None else [None] * (count if kind == Nodetype.ARRAY else 0)
    values = [_value(store, inner, name, item) for item in items]
    if inner == Nodetype.BASE and name[0] != "string":
        return np.array(values, name[0])
    return values


def _single(kind: str, given: Any) -> Any:
    if kind == "string":
        return "" if given is None else str(given)
    if kind == "bool":
        return bool(given)
    return (float if kind.startswith("float") else int)(0 if given is None else given)
