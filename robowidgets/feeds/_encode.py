"""Encoding speeds without ROS."""

from __future__ import annotations

import threading
from collections.abc import Mapping
from functools import lru_cache
from typing import Any

from rosbags.interfaces import Nodetype
from rosbags.typesys import Stores, get_typestore
from rosbags.typesys.store import Typestore

_lock = threading.Lock()  # rosbags generates the code of a store without locking
_STORES = {"cdr": Stores.ROS2_HUMBLE, "ros1": Stores.ROS1_NOETIC}


def encode(encoding: str, message_type: str, fields: Mapping[str, Any]) -> bytes:
    """The bytes of a message without arrays in ``cdr`` or ``ros1``; a field that is left out is zero or empty."""
    with _lock:
        store = _store(encoding)
        write = store.serialize_ros1 if encoding == "ros1" else store.serialize_cdr
        return bytes(write(_message(store, message_type, fields), message_type))


@lru_cache
def _store(encoding: str) -> Typestore:
    """One store for the process: generating the code of a type takes milliseconds."""
    return get_typestore(_STORES[encoding])


def _message(store: Typestore, type_name: str, fields: Mapping[str, Any]) -> Any:
    values: dict[str, Any] = {}
    definition: Any = store.fielddefs[type_name][1]
    for name, (kind, what) in definition:
        if kind == Nodetype.NAME:
            values[name] = _message(store, what, fields.get(name, {}))
        else:
            values[name] = fields.get(name, "" if what[0] == "string" else 0)
    return store.types[type_name](**values)
