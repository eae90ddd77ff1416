"""Messages of protobuf as plain fields, by the definitions in a file, if the package protobuf is installed."""

from __future__ import annotations

from base64 import b64decode
from collections.abc import Callable
from importlib import import_module
from typing import Any

NO_PROTOBUF = "its messages are encoded as 'protobuf': pip install protobuf to read them"


def has_protobuf() -> bool:
    """Return True if the package protobuf is installed."""
    try:
        import_module("google.protobuf")  # optional, and imported with the first such file
    except ImportError:
        return False
    return True


def reader_of(type_name: str, definition: str) -> Callable[[bytes], dict[str, Any]]:
    """Return a function that reads messages of a type.

    Args:
        type_name: such as ``foxglove.LaserScan``.
        definition: a FileDescriptorSet, in base64.

    Raises:
        ValueError: the definition is invalid, or lacks the type. The returned function raises it for invalid bytes.
    """
    descriptors, pools, factory = (
        import_module(f"google.protobuf.{name}") for name in ("descriptor_pb2", "descriptor_pool", "message_factory")
    )
    wrong_bytes: type[Exception] = import_module("google.protobuf.message").DecodeError
    pool = pools.DescriptorPool()
    try:
        files = descriptors.FileDescriptorSet.FromString(b64decode(definition)).file
        left = {file.name: file for file in files}
        while left:  # files after the files that they depend on
            ready = [file for file in left.values() if left.keys().isdisjoint(file.dependency)]
            if not ready:
                raise ValueError("its files depend on each other in a circle, or on a missing file")
            for file in ready:
                pool.Add(left.pop(file.name))
        kind = factory.GetMessageClass(pool.FindMessageTypeByName(type_name))
    except (wrong_bytes, KeyError, TypeError, ValueError) as error:
        raise ValueError(f"the definition of {type_name} in protobuf cannot be understood: {error}") from None

    def read(raw: bytes) -> dict[str, Any]:
        try:
            return _fields(kind.FromString(raw))
        except wrong_bytes as error:
            raise ValueError(f"{len(raw)} bytes are not a valid {type_name}: {error}") from None

    return read


def _fields(message: Any) -> dict[str, Any]:
    """Return the fields of a message; times have seconds and nanoseconds."""
    if message.DESCRIPTOR.full_name in ("google.protobuf.Timestamp", "google.protobuf.Duration"):
        return {"sec": message.seconds, "nsec": message.nanos}
    found: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if hasattr(value, "items"):  # a map of protobuf
            value = {str(key): _plain(item) for key, item in value.items()}
        elif hasattr(value, "extend"):
            value = [_plain(item) for item in value]
        else:
            value = _plain(value)
        found[field.name] = value
    return found


def _plain(value: Any) -> Any:
    return _fields(value) if hasattr(value, "DESCRIPTOR") else value
