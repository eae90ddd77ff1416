"""The tree of the fields of a message: its nodes, which seldom change, and the value of each node."""

from __future__ import annotations

from collections import deque
from collections.abc import Collection, Mapping, Sequence
from contextlib import suppress
from functools import lru_cache
from itertools import islice
from math import isfinite
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..messages.any_message import get_any, names_in, time_in, value_at
from ..messages.byte_fields import byte, bytes_in
from ..messages.fields import MISSING
from ..messages.units import unit_of

if TYPE_CHECKING:
    from ..messages.schema import FieldType, Schema

MOST_NUMBERS = 1000
"""The largest array that the page gets whole. Of a larger one it gets the count, the minimum and the maximum."""

_ROOM = 1000
"""Fields that the page gets by default. Messages within the message that exceed it are folded."""

_NUMBERS = 4000
"""Numbers in arrays that the page gets by default."""

_ELEMENTS = 32
"""Messages of an array that the page gets by default."""

_UNFOLDED = 2000
"""Fields of a message, or messages of an array, that the page gets when the user unfolds it."""

_LONGEST = 1000
"""Characters of a text that the page gets."""

_LARGEST_INTEGER = 2**53
"""The largest whole number that is exact in a page. Larger ones are sent as text."""

_ORDERED = {"float32": "<f4", "float64": "<f8", "bool": "|u1"} | {
    f"{sign}int{8 * size}": f"<{sign[:1] or 'i'}{size}" for sign in ("", "u") for size in (1, 2, 4, 8)
}
_ROS_BYTES = {"byte": "uint8", "char": "uint8", "octet": "uint8"}

TreeNode = dict[str, Any]


class Tree(NamedTuple):
    """A message in the form for the page.

    ``nodes`` are its fields: dictionaries with ``name``, ``type`` and ``kind``, and optionally a ``unit``, the
    ``names`` of numbers, the ``count`` of messages in an array, and ``children``. ``values`` has the value of each node
    with the same nesting; see docs/developers/frames.md. ``numbers`` are the bytes of the arrays, and ``size`` is the
    approximate number of bytes that were read.

    The page gets all fields within the limits above; `js/message/tree_lines.ts` chooses the ones that are lines there.
    """

    nodes: list[TreeNode]
    values: list[Any]
    numbers: bytes
    size: int


def read(
    message: Any, schema: Schema | None = None, unfolded: Collection[str] = (), fields: Sequence[str] = ()
) -> Tree:
    """Return the tree of a message.

    Args:
        message: a message of any form that `messages.any_message` reads.
        schema: the known definition of its type, if any.
        unfolded: paths of the parts that the user has unfolded. They are complete in the tree.
        fields: paths, to get only these fields. Fields that the message does not have are left out.
    """
    return _Reader(schema, frozenset(unfolded)).tree(message, fields)


class _Inner(NamedTuple):
    """A message, or an array of messages, whose fields are still to read."""

    value: Any
    type: str
    path: str
    node: TreeNode
    values: list[Any]
    is_array: bool


class _Reader:
    """Reads the fields of a message, and then the fields of messages within it, as long as there is room."""

    def __init__(self, schema: Schema | None, unfolded: Collection[str]) -> None:
        self._schema, self._unfolded = schema, unfolded
        self._root = schema.type if schema else ""
        self._room, self._number_room = _ROOM, _NUMBERS
        self._inner: deque[_Inner] = deque()
        self._numbers: list[bytes] = []
        self._size = self._read = 0

    def tree(self, message: Any, fields: Sequence[str]) -> Tree:
        root: TreeNode = {}
        values: list[Any] = []
        if fields:
            root["children"] = []
            for path in fields:
                try:
                    value = value_at(message, path)
                except ValueError:
                    continue
                self._add(root["children"], values, value, path, path, self._type_at(path))
        else:
            self._expand(_Inner(message, self._root, "", root, values, False))
        while self._inner:
            self._expand(self._inner.popleft())
        return Tree(root.get("children", []), values, b"".join(self._numbers), self._read)

    def _type_at(self, path: str) -> FieldType | None:
        """Return the type of a field by its path."""
        found, of_type = None, self._root
        for part in path.split("."):
            name, _, index = part.partition("[")
            found = self._types(of_type).get(name)
            if found is None:
                return None
            found = found._replace(is_array=found.is_array and not index)
            of_type = found.type if found.is_message else ""
        return found

    def _types(self, of_type: str) -> Mapping[str, FieldType]:
        return self._schema.fields(of_type) if self._schema and of_type else {}

    def _expand(self, inner: _Inner) -> None:
        """Add the fields of a message, or the messages of an array, to its node, as long as there is room."""
        types = {} if inner.is_array else self._types(inner.type)
        names: Sequence[str] = () if inner.is_array else names_in(inner.value)
        if types and not isinstance(inner.value, Mapping):  # classes of rosbags have constants, too
            names = tuple(types)
        count = len(inner.value) if inner.is_array else len(names)
        is_asked = inner.path in self._unfolded
        most = _ELEMENTS if inner.is_array else count
        room = min(count, _UNFOLDED) if is_asked else min(count, most, self._room)
        if not is_asked and inner.path and not inner.is_array and room < count:
            inner.node["folded"] = count
            return
        self._room -= 0 if is_asked else room
        children: list[TreeNode] = []
        inner.node["children"] = children
        if room < count:
            inner.node["more"] = count - room
        if inner.is_array:
            for i, value in enumerate(islice(inner.value, room)):
                name = f"[{i}]"
                self._add_message(children, inner.values, value, name, f"{inner.path}{name}", inner.type)
            return
        for name in islice(names, room):
            path = f"{inner.path}.{name}" if inner.path else name
            self._add(children, inner.values, get_any(inner.value, name), name, path, types.get(name))

    def _add(
        self, nodes: list[TreeNode], values: list[Any], value: Any, name: str, path: str, known: FieldType | None
    ) -> None:
        """Add a field with its value."""
        node: TreeNode = {"name": name}
        ros_type = known.type if known else ""
        if known and isinstance(value, (str, bytes)) and _ROS_BYTES.get(ros_type, ros_type) == "uint8":
            with suppress(ValueError):  # a plain text
                value = bytes_in(name, value) if known.is_array else byte(name, value)
        kind = type(value)
        # Common types come first: a check of an abstract class is slow.
        if kind is bool or kind is np.bool_:
            nodes.append({**node, "kind": "flag", "type": "bool"})
            values.append(bool(value))
        elif kind is str:
            nodes.append({**node, "kind": "text", "type": ros_type or "string"})
            values.append(_cut(value))
            self._read += len(value)
        elif kind is float or kind is int or value is None or value is MISSING or isinstance(value, Real):
            nodes.append(self._number_node(node, value, path, known))
            values.append(None if value is None or value is MISSING else plain(value))
        elif (time := time_in(value)) is not None:
            nodes.append({**node, "kind": "time", "type": ros_type or "time", "unit": "s"})
            values.append(list(time))
        elif isinstance(value, str):  # of a subclass, such as an enumeration
            nodes.append({**node, "kind": "text", "type": ros_type or "string"})
            values.append(_cut(str(value)))
        elif names := names_in(value):
            self._add_message(nodes, values, value, name, path, ros_type if known and known.is_message else "", names)
        else:
            self._add_array(nodes, values, value, node, path, known)

    def _number_node(self, node: TreeNode, value: Any, path: str, known: FieldType | None) -> TreeNode:
        kind = known.type if known and not known.is_message else _type_of(value)
        node |= {"kind": "number", "type": _ROS_BYTES.get(kind, kind)}
        if unit := _unit_of(self._root, path):
            node["unit"] = unit
        if known and known.names:
            node["names"] = known.names
        return node

    def _add_message(
        self,
        nodes: list[TreeNode],
        values: list[Any],
        value: Any,
        name: str,
        path: str,
        of_type: str,
        names: Collection[str] | None = None,
    ) -> None:
        """Add a message within the message, whose fields are read later."""
        if names is None and not names_in(value):  # in an array of different things
            self._add(nodes, values, value, name, path, None)
            return
        node: TreeNode = {"name": name, "kind": "message", "type": of_type}
        inner: list[Any] = []
        nodes.append(node)
        values.append(inner)
        self._inner.append(_Inner(value, of_type, path, node, inner, False))

    def _add_array(
        self, nodes: list[TreeNode], values: list[Any], value: Any, node: TreeNode, path: str, known: FieldType | None
    ) -> None:
        numbers = _numbers_in(value, known)
        if numbers is not None:
            node |= {"kind": "numbers", "type": str(numbers.dtype)}
            if unit := _unit_of(self._root, f"{path}[0]"):
                node["unit"] = unit
            if known and known.names:
                node["names"] = known.names
            nodes.append(node)
            values.append(self._summary(numbers, path))
            return
        if not hasattr(value, "__len__") or not hasattr(value, "__getitem__"):
            nodes.append({**node, "kind": "text", "type": type(value).__name__})
            values.append(_cut(repr(value)))
            return
        if len(value) and isinstance(value[0], str):
            nodes.append({**node, "kind": "texts", "type": "string"})
            values.append([len(value), [_cut(str(text)) for text in islice(value, _ELEMENTS)]])
            return
        inner: list[Any] = []
        node |= {"kind": "messages", "type": known.type if known and known.is_message else "", "count": len(value)}
        nodes.append(node)
        values.append(inner)
        self._inner.append(_Inner(value, node["type"], path, node, inner, True))

    def _summary(self, numbers: NDArray[Any], path: str) -> list[Any]:
        """Return the count, minimum, maximum, NaNs, infinities, and the position of the numbers in the bytes, or -1."""
        count, place = len(numbers), -1
        self._read += numbers.nbytes
        finite = numbers[np.isfinite(numbers)] if numbers.dtype.kind == "f" else numbers
        ends = [plain(finite.min()), plain(finite.max())] if len(finite) else [None, None]
        if count <= MOST_NUMBERS and (count <= self._number_room or path in self._unfolded):
            self._number_room -= count
            raw = numbers.astype(_ORDERED[str(numbers.dtype)]).tobytes()
            place, self._size = self._size, self._size + len(raw)
            self._numbers.append(raw)
        nans = int(np.isnan(numbers).sum()) if numbers.dtype.kind == "f" else 0
        return [count, *ends, nans, count - len(finite) - nans, place]


_unit_of = lru_cache(4096)(unit_of)


def plain(value: Any) -> Any:
    """Return a number for JSON without loss: as text if a page would round it, or if JSON cannot express it."""
    if type(value) is float:
        return value if isfinite(value) else str(value)
    if isinstance(value, (Integral, np.bool_)):
        whole = int(value)
        return whole if abs(whole) <= _LARGEST_INTEGER else str(whole)
    number = float(value)
    return number if isfinite(number) else str(number)


def _type_of(value: Any) -> str:
    """Return the type of a number without a known definition."""
    if isinstance(value, np.generic):
        return str(value.dtype)
    return "int64" if isinstance(value, Integral) else "float64"


def _cut(text: str) -> Any:
    """Return a text, or the beginning of a long one with its length."""
    return text if len(text) <= _LONGEST else [text[:_LONGEST], len(text)]


def _numbers_in(value: Any, known: FieldType | None) -> NDArray[Any] | None:
    """Return the numbers of an array in the type of its definition, or None if it contains other things."""
    if isinstance(value, (bytes, bytearray, memoryview)):
        value = np.frombuffer(value, np.uint8)
    wanted = known.type if known and known.is_array and not known.is_message else ""
    wanted = _ROS_BYTES.get(wanted, wanted)
    if not isinstance(value, np.ndarray):
        if not isinstance(value, Sequence) and not hasattr(value, "__array__") and not hasattr(value, "tobytes"):
            return None
        first = next(iter(value), None)
        if first is None and not len(value):
            return np.empty(0, wanted if wanted in _ORDERED else "float64") if not known or wanted in _ORDERED else None
        if not (first is None or isinstance(first, (Real, np.bool_))):
            return None
        try:
            # rosbridge sends null for NaN.
            value = np.asarray([np.nan if one is None else one for one in value] if None in value else value)
        except (TypeError, ValueError):
            return None
    if value.ndim != 1 or value.dtype.kind not in "biuf":
        return None
    kind = wanted if wanted in _ORDERED else str(value.dtype)
    if kind not in _ORDERED:  # float16, longdouble
        kind = "float64"
    if kind.lstrip("u").startswith("int") and value.dtype.kind == "f":
        kind = "float64"
    numbers: NDArray[Any] = value.astype(kind)
    return numbers
